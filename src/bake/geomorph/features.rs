//! The edges of a mesh that its nearest points should keep to: borders and seams.

use glam::DVec3;

use crate::bake::{Group, Mesh, Surface};

/// Borders and seams of a mesh, and which way its surface faces.
pub(super) struct Features {
    /// Edges that have not exactly two triangles, and edges whose two triangles differ in material or attributes; as
    /// positions.
    pub(super) edges: [Vec<[u32; 2]>; 2],
    /// Per position, the sum of the normals of its triangles, by area.
    pub(super) normals: Vec<DVec3>,
}

/// A side of a triangle: its positions, the lower first, then its wedges in the same order, its group, and no more.
type Side = ([u32; 2], [u32; 2], u32);

impl Features {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let mut sides = sides(mesh);
        sides.sort_unstable();
        let mut edges = [Vec::new(), Vec::new()];
        for edge in sides.chunk_by(|a, b| a.0 == b.0) {
            match edge {
                [a, b] if is_same(mesh, a, b) => {}
                [_, _] => edges[1].push(edge[0].0),
                _ => edges[0].push(edge[0].0),
            }
        }
        Self { edges, normals: normals(mesh) }
    }

    /// Per position, whether it is on an edge of a kind.
    pub(super) fn on(&self, kind: usize) -> Vec<bool> {
        let mut on = vec![false; self.normals.len()];
        self.edges[kind].as_flattened().iter().for_each(|&p| on[p as usize] = true);
        on
    }

    /// The edges of a kind as a surface of triangles without area.
    pub(super) fn surface(&self, kind: usize, mesh: &Mesh) -> Surface {
        let triangles = self.edges[kind].iter().map(|&[a, b]| [a, b, b]).collect();
        Surface { positions: mesh.positions.clone(), triangles }
    }
}

/// The kinds of features, those that count more first.
pub(super) const KINDS: usize = 2;

fn sides(mesh: &Mesh) -> Vec<Side> {
    let material = |group: &Group| group.material.clone().unwrap_or_else(|| group.name.clone());
    let mut names: Vec<String> = mesh.groups.iter().map(material).collect();
    names.sort_unstable();
    let mut sides = Vec::with_capacity(3 * mesh.triangles.len());
    for group in &mesh.groups {
        let number = names.partition_point(|name| *name < material(group)) as u32;
        for &[a, b, c] in &mesh.triangles[group.triangles.clone()] {
            for (a, b) in [(a, b), (b, c), (c, a)] {
                let [p, q] = [a, b].map(|wedge| mesh.wedges[wedge as usize]);
                sides.push(if p < q { ([p, q], [a, b], number) } else { ([q, p], [b, a], number) });
            }
        }
    }
    sides.retain(|([p, q], ..)| p != q);
    sides
}

/// Whether two sides of an edge look the same.
fn is_same(mesh: &Mesh, a: &Side, b: &Side) -> bool {
    let alike = |(&a, &b): (&u32, &u32)| {
        let (a, b) = (a as usize, b as usize);
        let sets = mesh.uvs.iter().all(|set| set[a] == set[b]);
        a == b || sets && mesh.colours.get(a) == mesh.colours.get(b)
    };
    a.2 == b.2 && a.1.iter().zip(&b.1).all(alike)
}

fn normals(mesh: &Mesh) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; mesh.positions.len()];
    for corners in (0..mesh.triangles.len()).map(|t| mesh.corners(t)) {
        let [a, b, c] = corners.map(|p| mesh.positions[p as usize].as_dvec3());
        corners.iter().for_each(|&p| normals[p as usize] += (b - a).cross(c - a));
    }
    normals
}
