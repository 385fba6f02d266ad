//! Positions that are the same become one; wedges that look alike become one; wedges that differ stay apart.
//!
//! Files that repeat a vertex for every attribute it has, or for every triangle (STL), tear the surface where they do
//! so. Welding mends that and loses nothing: each corner keeps the attributes it had.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::mesh::Mesh;

/// Joins positions whose coordinates are equal (−0 equals 0), then wedges of one position whose attributes are.
/// Positions and wedges stay in order of their first use. Returns how many positions went. O(n log n).
pub fn weld(mesh: &mut Mesh) -> usize {
    let same = classes(mesh.positions.iter().map(|&p| bits(p)));
    join_positions(mesh, &same)
}

/// Joins as [`weld`] does, and then each position with the first kept one that is no further than `distance`, in object
/// units. With a distance that is not above 0 or not finite it is [`weld`] alone. Returns how many positions went.
///
/// Not transitive on purpose: a row of close positions does not run together into one, and none moves further than
/// `distance`. Triangles that shrink to an edge are left for [`repair`](super::repair). O(n) expected.
pub fn weld_within(mesh: &mut Mesh, distance: f32) -> usize {
    let exactly = weld(mesh);
    if !(distance > 0.0 && distance.is_finite()) {
        return exactly;
    }
    let close = close_classes(&mesh.positions, f64::from(distance));
    exactly + join_positions(mesh, &close)
}

fn join_positions(mesh: &mut Mesh, same: &Classes) -> usize {
    let before = mesh.positions.len();
    mesh.positions = same.firsts.iter().map(|&first| mesh.positions[first as usize] + 0.0).collect();
    mesh.wedges.iter_mut().for_each(|position| *position = same.of[*position as usize]);
    join_wedges(mesh);
    before - mesh.positions.len()
}

/// Joins wedges that agree in everything, bit by bit.
fn join_wedges(mesh: &mut Mesh) {
    let mut alike = classes(mesh.wedges.iter().map(|&position| [position, 0, 0]));
    let mut refine = |column: &dyn Fn(usize) -> [u32; 2]| {
        let key = |(wedge, &class): (usize, &u32)| {
            let [a, b] = column(wedge);
            [class, a, b]
        };
        alike = classes(alike.of.iter().enumerate().map(key));
    };
    if !mesh.normals.is_empty() {
        refine(&|w| [bit(mesh.normals[w].x), bit(mesh.normals[w].y)]);
        refine(&|w| [bit(mesh.normals[w].z), 0]);
    }
    for set in &mesh.uvs {
        refine(&|w| [bit(set[w].x), bit(set[w].y)]);
    }
    for column in [&mesh.colours, &mesh.tangents].into_iter().filter(|column| !column.is_empty()) {
        refine(&|w| [bit(column[w].x), bit(column[w].y)]);
        refine(&|w| [bit(column[w].z), bit(column[w].w)]);
    }
    if !mesh.skins.is_empty() {
        let joints = |w: usize| mesh.skins[w].joints.map(u32::from);
        refine(&|w| [joints(w)[0] << 16 | joints(w)[1], joints(w)[2] << 16 | joints(w)[3]]);
        refine(&|w| [bit(mesh.skins[w].weights[0]), bit(mesh.skins[w].weights[1])]);
        refine(&|w| [bit(mesh.skins[w].weights[2]), bit(mesh.skins[w].weights[3])]);
    }
    mesh.keep_wedges(&alike.firsts);
    mesh.triangles.as_flattened_mut().iter_mut().for_each(|wedge| *wedge = alike.of[*wedge as usize]);
}

/// Which things are the same: the class of each, and the first thing of each class. Classes are numbered in order of
/// their first thing.
pub(super) struct Classes {
    pub(super) of: Vec<u32>,
    pub(super) firsts: Vec<u32>,
}

/// Things with equal keys are the same. At most 2³² things.
pub(super) fn classes(keys: impl Iterator<Item = [u32; 3]>) -> Classes {
    let packed = |(thing, key): (usize, [u32; 3])| {
        key.into_iter().chain([thing as u32]).fold(0, |all: u128, part| all << 32 | u128::from(part))
    };
    let mut sorted: Vec<u128> = keys.enumerate().map(packed).collect();
    sorted.sort_unstable();
    let mut first_of = vec![0; sorted.len()];
    for same in sorted.chunk_by(|a, b| a >> 32 == b >> 32) {
        same.iter().for_each(|&thing| first_of[thing as u32 as usize] = same[0] as u32);
    }
    numbered(&first_of)
}

/// Classes from the first thing that each is the same as: itself, or one before it that is its own first.
pub(super) fn numbered(first_of: &[u32]) -> Classes {
    let mut classes = Classes { of: Vec::with_capacity(first_of.len()), firsts: Vec::new() };
    for (thing, &first) in first_of.iter().enumerate() {
        let class = if first as usize == thing {
            classes.firsts.push(first);
            classes.firsts.len() as u32 - 1
        } else {
            classes.of[first as usize]
        };
        classes.of.push(class);
    }
    classes
}

/// Kept positions are sorted into cells as wide as the distance, so that what is close is in one of 27 cells, and a
/// cell holds few: no two kept ones are close to each other.
fn close_classes(positions: &[Vec3], distance: f64) -> Classes {
    let mut kept: HashMap<[u64; 3], Vec<u32>> = HashMap::new();
    let mut first_of = Vec::with_capacity(positions.len());
    for (i, p) in positions.iter().enumerate() {
        let cell = (p.as_dvec3() / distance).floor();
        let is_close = |&&k: &&u32| positions[k as usize].as_dvec3().distance(p.as_dvec3()) <= distance;
        let around = neighbours(cell).filter_map(|c| kept.get(&c)?.iter().find(is_close).copied());
        let first = around.min().unwrap_or(i as u32);
        if first as usize == i && p.is_finite() {
            kept.entry(key(cell)).or_default().push(first);
        }
        first_of.push(first);
    }
    numbered(&first_of)
}

fn neighbours(cell: DVec3) -> impl Iterator<Item = [u64; 3]> {
    let step = |i: u32| f64::from(i % 3) - 1.0;
    (0..27).map(move |i| key(cell + DVec3::new(step(i), step(i / 3), step(i / 9))))
}

/// Floats, and not integers, because a cell's number may be beyond any integer.
fn key(cell: DVec3) -> [u64; 3] {
    (cell + 0.0).to_array().map(f64::to_bits)
}

/// Equal for equal coordinates: −0 counts as 0.
pub(super) fn bits(p: Vec3) -> [u32; 3] {
    p.to_array().map(bit)
}

fn bit(x: f32) -> u32 {
    (x + 0.0).to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::Group;
    use glam::Vec2;
    use proptest::prelude::*;

    /// A triangle for every three positions.
    fn soup(positions: Vec<Vec3>) -> Mesh {
        let wedges: Vec<u32> = (0..positions.len() as u32).collect();
        let triangles: Vec<[u32; 3]> = wedges.as_chunks().0.to_vec();
        let groups = vec![Group { triangles: 0..triangles.len(), ..Group::default() }];
        Mesh { positions, wedges, triangles, groups, ..Mesh::default() }
    }

    /// The position of every corner.
    fn corners(mesh: &Mesh) -> Vec<Vec3> {
        mesh.triangles.iter().flatten().map(|&w| mesh.positions[mesh.wedges[w as usize] as usize]).collect()
    }

    #[test]
    fn a_soup_becomes_a_surface() {
        let (a, b, c, d) = (Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE);
        let mut mesh = soup(vec![a, b, c, c, b, d]);
        assert_eq!(weld(&mut mesh), 2);
        assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(mesh.check(), Ok(()));
    }

    #[test]
    fn minus_zero_is_zero() {
        let mut mesh = soup(vec![Vec3::ZERO, -Vec3::ZERO, Vec3::Y]);
        assert_eq!(weld(&mut mesh), 1);
        assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::Y]);
        assert!(mesh.positions[0].x.is_sign_positive());
    }

    #[test]
    fn a_seam_keeps_its_wedges() {
        let (a, b, c, d) = (Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE);
        let mut mesh = soup(vec![a, b, c, c, b, d]);
        mesh.uvs = vec![[0.0, 1.0, 2.0, 3.0, 1.0, 5.0].map(Vec2::splat).to_vec()];
        weld(&mut mesh);
        assert_eq!((mesh.positions.len(), mesh.wedges.len()), (4, 5));
        let uvs: Vec<f32> = mesh.triangles.iter().flatten().map(|&w| mesh.uvs[0][w as usize].x).collect();
        assert_eq!(uvs, [0.0, 1.0, 2.0, 3.0, 1.0, 5.0]);
    }

    #[test]
    fn a_row_of_close_positions_does_not_run_together() {
        let row = (0..9).map(|i| Vec3::X * (i as f32 * 0.75)).collect();
        let mut mesh = soup(row);
        assert_eq!(weld_within(&mut mesh, 1.0), 4);
        assert_eq!(mesh.positions.iter().map(|p| p.x).collect::<Vec<_>>(), [0.0, 1.5, 3.0, 4.5, 6.0]);
    }

    #[test]
    fn distances_that_mean_nothing_weld_exactly() {
        for distance in [0.0, -1.0, f32::NAN, f32::INFINITY, f32::MIN_POSITIVE] {
            let mut mesh =
                soup(vec![Vec3::ZERO, Vec3::splat(f32::MAX), Vec3::NAN, Vec3::ZERO, Vec3::X, Vec3::Y]);
            assert_eq!(weld_within(&mut mesh, distance), 1, "{distance}");
        }
    }

    proptest! {
        #[test]
        fn welding_moves_no_corner_and_leaves_no_equal_positions(
            coordinates in prop::collection::vec(prop::array::uniform3(-2i8..2), 0..60),
        ) {
            let positions = coordinates.iter().map(|c| Vec3::from(c.map(f32::from))).collect();
            let mut mesh = soup(positions);
            let before = corners(&mesh);
            weld(&mut mesh);
            prop_assert_eq!(corners(&mesh), before);
            prop_assert_eq!(mesh.check(), Ok(()));
            for (i, p) in mesh.positions.iter().enumerate() {
                prop_assert!(!mesh.positions[..i].contains(p));
            }
        }

        /// Against the obvious: every position looks at all kept ones before it.
        #[test]
        fn welding_within_a_distance_is_as_all_pairs_say(
            points in prop::collection::vec(prop::array::uniform3(-3.0f32..3.0), 0..80),
            distance in 0.01f32..2.0,
        ) {
            let points: Vec<Vec3> = points.into_iter().map(Vec3::from).collect();
            let mut kept: Vec<Vec3> = Vec::new();
            let close = |k: &Vec3, p: &Vec3| k.as_dvec3().distance(p.as_dvec3()) <= f64::from(distance);
            let moved: Vec<Vec3> = points.iter().map(|p| {
                let to = kept.iter().find(|k| close(k, p)).copied();
                to.unwrap_or_else(|| { kept.push(*p); *p })
            }).collect();
            let mut mesh = soup(points.clone());
            weld_within(&mut mesh, distance);
            let whole = points.len() / 3 * 3;
            prop_assert_eq!(corners(&mesh), &moved[..whole]);
        }
    }
}
