//! Edges and vertices that are not as on a closed surface.

use super::place_of;
use crate::bake::finding::{Defect, Findings};
use crate::bake::mesh::Mesh;
use crate::bake::read::Origins;

/// Reports borders, non-manifold and misoriented edges, and non-manifold vertices. Returns the border edges, as
/// positions. No face may use a position twice.
pub(super) fn find(mesh: &Mesh, origins: &Origins, findings: &mut Findings) -> Vec<[u32; 2]> {
    let sides = sorted_sides(mesh);
    let mut fans = Fans::of(mesh.triangles.len());
    let mut borders = Vec::new();
    for edge in sides.chunk_by(|a, b| a.ends == b.ends) {
        edge.windows(2).for_each(|pair| fans.join(&pair[0], &pair[1]));
        let defect = match edge {
            [_] => Defect::BorderEdge,
            [one, other] if one.rises == other.rises => Defect::MisorientedEdge,
            [_, _] => continue,
            _ => Defect::NonManifoldEdge,
        };
        findings.add(defect, || origins.place(edge[0].corners[0] as usize / 3));
        if edge.len() == 1 {
            borders.push(edge[0].ends);
        }
    }
    for (position, _) in fans.per_position(mesh).iter().enumerate().filter(|&(_, &fans)| fans > 1) {
        findings.add(Defect::NonManifoldVertex, || place_of(mesh.positions[position]));
    }
    borders
}

/// A face's side of an edge.
#[derive(Clone, Copy)]
struct Side {
    /// Positions, the lower first.
    ends: [u32; 2],
    /// The face's corners at these ends, counted through all faces.
    corners: [u32; 2],
    /// Whether the face runs from the lower to the higher.
    rises: bool,
}

fn sorted_sides(mesh: &Mesh) -> Vec<Side> {
    let mut sides = Vec::with_capacity(mesh.triangles.len() * 3);
    for t in 0..mesh.triangles.len() {
        let positions = mesh.corners(t);
        sides.extend([(0, 1), (1, 2), (2, 0)].map(|(i, j)| side(positions, t as u32 * 3, i, j)));
    }
    sides.sort_unstable_by_key(|side| (side.ends, side.corners));
    sides
}

fn side(positions: [u32; 3], first_corner: u32, i: usize, j: usize) -> Side {
    let (a, b) = (positions[i], positions[j]);
    let corners = [first_corner + i as u32, first_corner + j as u32];
    if a < b {
        Side { ends: [a, b], corners, rises: true }
    } else {
        Side { ends: [b, a], corners: [corners[1], corners[0]], rises: false }
    }
}

/// Corners that hang together through edges at their position: a forest of corners, each tree a fan.
struct Fans(Vec<u32>);

impl Fans {
    fn of(triangles: usize) -> Self {
        Self((0..triangles as u32 * 3).collect())
    }

    fn root(&mut self, mut corner: u32) -> u32 {
        while self.0[corner as usize] != corner {
            let above = self.0[corner as usize];
            self.0[corner as usize] = self.0[above as usize];
            corner = above;
        }
        corner
    }

    fn join(&mut self, one: &Side, other: &Side) {
        for end in [0, 1] {
            let (a, b) = (self.root(one.corners[end]), self.root(other.corners[end]));
            self.0[a.max(b) as usize] = a.min(b);
        }
    }

    fn per_position(&self, mesh: &Mesh) -> Vec<u32> {
        let mut fans = vec![0; mesh.positions.len()];
        let corners = mesh.triangles.as_flattened().iter().enumerate();
        for (_, &wedge) in corners.filter(|&(corner, _)| self.0[corner] as usize == corner) {
            fans[mesh.wedges[wedge as usize] as usize] += 1;
        }
        fans
    }
}
