//! What is better left whole: small pieces of a mesh that hang together.
//!
//! A track is a road and thousands of posts, steps and roofs. A cut through a post would lock half of what it has.

use glam::Vec3;

use crate::bake::Mesh;
use crate::bounds::Aabb;

/// A piece of more than this share of a chunk's triangles may be cut.
const OF_CHUNK: usize = 4;

/// As may be one that is longer than this share of the mesh.
const OF_MESH: f32 = 0.1;

/// Where a triangle counts as being, and with which others it stays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    pub(super) place: Vec3,
    /// The first triangle of its piece, or itself where the piece may be cut.
    pub(super) piece: u32,
}

/// Of each triangle. A piece that stays whole is at its middle, other triangles are where they are.
pub(super) fn spots(mesh: &Mesh, most: usize) -> Vec<Spot> {
    let count = mesh.triangles.len() as u32;
    let mut by_piece: Vec<(u32, u32)> = first_triangles(mesh).into_iter().zip(0..count).collect();
    by_piece.sort_unstable();
    let longest = OF_MESH * side(&around(mesh, 0..count));
    let mut spots = vec![Spot { place: Vec3::ZERO, piece: 0 }; mesh.triangles.len()];
    for piece in by_piece.chunk_by(|a, b| a.0 == b.0) {
        let bounds = around(mesh, piece.iter().map(|&(_, t)| t));
        let is_whole = piece.len() <= most / OF_CHUNK && side(&bounds) <= longest;
        for &(first, t) in piece {
            spots[t as usize] = match is_whole {
                true => Spot { place: 0.5 * (bounds.min + bounds.max), piece: first },
                false => Spot { place: center(mesh, t), piece: t },
            };
        }
    }
    spots
}

fn center(mesh: &Mesh, triangle: u32) -> Vec3 {
    mesh.corners(triangle as usize).into_iter().map(|p| mesh.positions[p as usize]).sum::<Vec3>() / 3.0
}

/// The box around some triangles.
fn around(mesh: &Mesh, triangles: impl Iterator<Item = u32>) -> Aabb {
    Aabb::around(triangles.flat_map(|t| mesh.corners(t as usize)).map(|p| mesh.positions[p as usize]))
}

/// The longest side of a box; 0 for an empty one.
pub(super) fn side(bounds: &Aabb) -> f32 {
    if bounds.is_empty() { 0.0 } else { (bounds.max - bounds.min).max_element() }
}

/// Per triangle, the first one of those that it hangs together with by positions.
fn first_triangles(mesh: &Mesh) -> Vec<u32> {
    let mut above: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t);
        join(&mut above, a, b);
        join(&mut above, b, c);
    }
    let mut first_of = vec![u32::MAX; mesh.positions.len()];
    let first = |t: u32| {
        let root = root(&mut above, mesh.corners(t as usize)[0]) as usize;
        first_of[root] = first_of[root].min(t);
        first_of[root]
    };
    (0..mesh.triangles.len() as u32).map(first).collect()
}

/// The lower root becomes that of both.
fn join(above: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(above, a), root(above, b));
    above[a.max(b) as usize] = a.min(b);
}

/// The end of the way up, which is halved for the next time.
fn root(above: &mut [u32], mut at: u32) -> u32 {
    while above[at as usize] != at {
        above[at as usize] = above[above[at as usize] as usize];
        at = above[at as usize];
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::shapes::{icosphere, terrain};

    /// A terrain of 800 triangles, and balls of 20 in a row above it.
    fn park(balls: u32) -> Mesh {
        let mut park: Mesh = terrain(20, 1).into();
        for ball in 0..balls {
            let (small, wedges) = (Mesh::from(icosphere(1)), park.wedges.len() as u32);
            park.positions
                .extend(small.positions.iter().map(|p| 0.02 * p + Vec3::new(0.1 * ball as f32, 0.5, 0.5)));
            park.wedges.extend(wedges..wedges + 12);
            park.triangles.extend(small.triangles.iter().map(|t| t.map(|w| w + wedges)));
        }
        park.groups[0].triangles.end = park.triangles.len();
        park
    }

    #[test]
    fn pieces_are_told_apart_and_small_ones_stay_whole() {
        let park = park(3);
        assert_eq!(park.check(), Ok(()));
        let spots = spots(&park, 100);
        assert!((0..800).all(|t| spots[t as usize].piece == t));
        for (t, spot) in (0..).zip(&spots).skip(800) {
            assert_eq!(spot.piece, 800 + (t - 800) / 20 * 20);
            assert!((spot.place - Vec3::new(0.1 * ((t - 800) / 20) as f32, 0.5, 0.5)).length() < 1e-3);
        }
        let cut = super::spots(&park, 79);
        assert!(
            cut.iter().zip(0..).all(|(spot, t)| spot.piece == t),
            "20 triangles are more than a quarter of 79"
        );
    }
}
