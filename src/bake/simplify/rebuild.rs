//! From what a method leaves to a mesh: attributes, groups, and nothing that is not used.

use glam::Vec3;

use crate::bake::Mesh;
use crate::bake::simplify::order::by_key;
use crate::bake::weld::{Classes, numbered};

/// What a corner of a triangle has become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    /// Its vertex, in the method's own numbers.
    pub(super) vertex: u32,
    /// The old wedge whose attributes it has.
    pub(super) wedge: u32,
}

/// A triangle that is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Facet {
    /// The old triangle that it was, or whose group it is in.
    pub(super) old: u32,
    pub(super) corners: [Corner; 3],
}

/// A mesh of what is left.
pub(super) struct Rebuilt {
    pub(super) mesh: Mesh,
    /// Per position, its vertex in the method's own numbers; ascending.
    pub(super) vertices: Vec<u32>,
    /// Per wedge, the old one whose attributes it has.
    pub(super) wedges: Vec<u32>,
    /// Per vertex in the method's own numbers, its position; [`Rebuilt::UNUSED`] where no triangle uses it.
    pub(super) position_of: Vec<u32>,
}

impl Rebuilt {
    pub(super) const UNUSED: u32 = u32::MAX;

    /// The mesh of some facets. Corners of one vertex with one wedge become one wedge; triangles are in the order of
    /// the old ones, so that groups stay runs. O(n), and O(k log k) for a vertex of k triangles.
    pub(super) fn new(old: &Mesh, places: &[Vec3], facets: Vec<Facet>) -> Self {
        let order = by_key(facets.iter().map(|facet| facet.old), old.triangles.len());
        let facets: Vec<Facet> = order.iter().map(|&i| facets[i as usize]).collect();
        let corners: Vec<Corner> = facets.iter().flat_map(|facet| facet.corners).collect();
        let (vertices, position_of) = used(places.len(), &corners);
        let looks = corners.iter().map(|c| [position_of[c.vertex as usize], c.wedge]);
        let same = if old.has_attributes() {
            alike(&looks.collect::<Vec<_>>(), vertices.len())
        } else {
            at_one_position(looks.map(|[position, _]| position), vertices.len())
        };
        let wedges: Vec<u32> = same.firsts.iter().map(|&first| corners[first as usize].wedge).collect();
        let mut mesh = old.rows(&wedges);
        mesh.positions = vertices.iter().map(|&v| places[v as usize]).collect();
        mesh.wedges =
            same.firsts.iter().map(|&first| position_of[corners[first as usize].vertex as usize]).collect();
        mesh.triangles = same.of.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        mesh.groups = groups_of(old, &facets);
        Self { mesh, vertices, wedges, position_of }
    }
}

/// The vertices that corners use, ascending, and their places in that list.
fn used(vertices: usize, corners: &[Corner]) -> (Vec<u32>, Vec<u32>) {
    let mut position_of = vec![Rebuilt::UNUSED; vertices];
    for corner in corners {
        position_of[corner.vertex as usize] = 0;
    }
    let used: Vec<u32> = (0..vertices as u32).filter(|&v| position_of[v as usize] == 0).collect();
    for (position, &vertex) in (0..).zip(&used) {
        position_of[vertex as usize] = position;
    }
    (used, position_of)
}

/// Which corners are the same, given the position of each and what it looks like there.
fn alike(looks: &[[u32; 2]], positions: usize) -> Classes {
    let position = |&corner: &u32| looks[corner as usize][0];
    let look = |&corner: &u32| looks[corner as usize][1];
    let mut order = by_key(looks.iter().map(|&[position, _]| position), positions);
    let mut first_of = vec![0; looks.len()];
    for at_one in order.chunk_by_mut(|a, b| position(a) == position(b)) {
        at_one.sort_by_key(look);
        for same in at_one.chunk_by(|a, b| look(a) == look(b)) {
            same.iter().for_each(|&corner| first_of[corner as usize] = same[0]);
        }
    }
    numbered(&first_of)
}

/// Which corners are at the same of so many positions, given the position of each.
fn at_one_position(corners: impl ExactSizeIterator<Item = u32>, positions: usize) -> Classes {
    const NONE: u32 = u32::MAX;
    let mut class_at = vec![NONE; positions];
    let mut classes =
        Classes { of: Vec::with_capacity(corners.len()), firsts: Vec::with_capacity(positions) };
    for (corner, position) in (0..).zip(corners) {
        let class = &mut class_at[position as usize];
        if *class == NONE {
            *class = classes.firsts.len() as u32;
            classes.firsts.push(corner);
        }
        classes.of.push(*class);
    }
    classes
}

/// The groups of facets in the order of the old triangles; those without a triangle go.
fn groups_of(old: &Mesh, facets: &[Facet]) -> Vec<crate::bake::Group> {
    let before = |triangle: usize| facets.partition_point(|facet| (facet.old as usize) < triangle);
    let mut groups = old.groups.clone();
    for group in &mut groups {
        group.triangles = before(group.triangles.start)..before(group.triangles.end);
    }
    groups.retain(|group| !group.triangles.is_empty());
    groups
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::bake::Group;

    proptest! {
        /// Where all look the same.
        #[test]
        fn what_is_alike_is_at_one_position(positions in prop::collection::vec(0..9u32, 0..30)) {
            let looks: Vec<[u32; 2]> = positions.iter().map(|&position| [position, 0]).collect();
            let (found, expected) = (at_one_position(positions.into_iter(), 9), alike(&looks, 9));
            prop_assert_eq!((found.of, found.firsts), (expected.of, expected.firsts));
        }
    }

    fn corner(vertex: u32, wedge: u32) -> Corner {
        Corner { vertex, wedge }
    }

    #[test]
    fn seams_groups_and_order_are_kept() {
        let group = |triangles| Group { triangles, ..Group::default() };
        let old = Mesh {
            positions: vec![Vec3::ZERO; 4],
            wedges: vec![0, 1, 2, 3, 0],
            normals: (0..5).map(|i| Vec3::splat(i as f32)).collect(),
            triangles: vec![[0, 1, 2], [4, 2, 3]],
            groups: vec![group(0..1), group(1..2)],
            ..Mesh::default()
        };
        let facets = vec![
            Facet { old: 1, corners: [corner(5, 4), corner(3, 2), corner(9, 3)] },
            Facet { old: 0, corners: [corner(5, 0), corner(7, 1), corner(3, 2)] },
        ];
        let places: Vec<Vec3> = (0..10).map(|i| Vec3::X * i as f32).collect();
        let Rebuilt { mesh, vertices, wedges, position_of } = Rebuilt::new(&old, &places, facets);
        assert_eq!(mesh.check(), Ok(()));
        assert_eq!((vertices, wedges), (vec![3, 5, 7, 9], vec![0, 1, 2, 4, 3]));
        assert_eq!((position_of[5], position_of[4]), (1, Rebuilt::UNUSED));
        assert_eq!(mesh.surface().triangles, [[1, 2, 0], [1, 0, 3]]);
        assert_eq!(mesh.normals[mesh.triangles[1][0] as usize], Vec3::splat(4.0));
        assert_eq!(mesh.groups, [group(0..1), group(1..2)]);
    }

    #[test]
    fn a_group_that_is_gone_is_left_out() {
        let group = |triangles| Group { triangles, ..Group::default() };
        let old = Mesh {
            positions: vec![Vec3::ZERO; 3],
            wedges: vec![0, 1, 2],
            triangles: vec![[0, 1, 2]; 2],
            groups: vec![group(0..1), group(1..2)],
            ..Mesh::default()
        };
        let facets = vec![Facet { old: 1, corners: [corner(0, 0), corner(1, 1), corner(2, 2)] }];
        let rebuilt = Rebuilt::new(&old, &[Vec3::ZERO; 3], facets);
        assert_eq!(rebuilt.mesh.groups, [group(0..1)]);
        let none = Rebuilt::new(&old, &[], Vec::new());
        assert_eq!((none.mesh.check(), none.mesh.wedges.len()), (Ok(()), 0));
    }
}
