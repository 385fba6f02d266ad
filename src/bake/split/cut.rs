//! A mesh for each part, and what it shares with the others.

use super::Chunk;
use crate::bake::mesh::gather;
use crate::bake::{Group, Mesh};

/// A position or an edge that no part uses so far, and one that several do.
const NOBODY: u32 = u32::MAX;
const SEVERAL: u32 = u32::MAX - 1;

/// The chunks of these parts.
pub(super) fn chunks(mesh: &Mesh, parts: &[Vec<u32>]) -> Vec<Chunk> {
    let shared = Shared::of(mesh, parts);
    let mut numbers =
        Numbers { wedges: vec![NOBODY; mesh.wedges.len()], positions: vec![NOBODY; mesh.positions.len()] };
    parts.iter().map(|part| chunk(mesh, part, &shared, &mut numbers)).collect()
}

/// What several parts use.
struct Shared {
    /// Per position.
    positions: Vec<bool>,
    /// Edges, the lower end first; sorted.
    edges: Vec<[u32; 2]>,
}

impl Shared {
    fn of(mesh: &Mesh, parts: &[Vec<u32>]) -> Self {
        let mut owners = vec![NOBODY; mesh.positions.len()];
        for (part, triangles) in (0..).zip(parts) {
            for p in triangles.iter().flat_map(|&t| mesh.corners(t as usize)) {
                let owner = &mut owners[p as usize];
                *owner = if *owner == NOBODY || *owner == part { part } else { SEVERAL };
            }
        }
        let positions: Vec<bool> = owners.iter().map(|&owner| owner == SEVERAL).collect();
        let edges = shared_edges(mesh, parts, &positions);
        Self { positions, edges }
    }

    fn has(&self, [a, b]: [u32; 2]) -> bool {
        self.edges.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }
}

/// The edges of more than one part: of those alone whose ends are.
fn shared_edges(mesh: &Mesh, parts: &[Vec<u32>], is_shared: &[bool]) -> Vec<[u32; 2]> {
    let mut users: Vec<([u32; 2], u32)> = Vec::new();
    for (part, triangles) in (0..).zip(parts) {
        let sides = triangles.iter().flat_map(|&t| sides(mesh.corners(t as usize)));
        let candidates = sides.filter(|side| side.iter().all(|&p| is_shared[p as usize]));
        users.extend(candidates.map(|[a, b]| ([a.min(b), a.max(b)], part)));
    }
    users.sort_unstable();
    users.dedup();
    let of_several = users.chunk_by(|a, b| a.0 == b.0).filter(|users| users.len() > 1);
    of_several.map(|users| users[0].0).collect()
}

/// The sides of a triangle, in its direction.
pub(super) fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// The new numbers of wedges and positions; [`NOBODY`] between two chunks.
struct Numbers {
    wedges: Vec<u32>,
    positions: Vec<u32>,
}

fn chunk(mesh: &Mesh, part: &[u32], shared: &Shared, numbers: &mut Numbers) -> Chunk {
    let old = |&t: &u32| mesh.triangles[t as usize];
    let wedges = renumber(part.iter().flat_map(old), &mut numbers.wedges);
    let positions = renumber(wedges.iter().map(|&w| mesh.wedges[w as usize]), &mut numbers.positions);
    let new_position = |p: u32| numbers.positions[p as usize];
    let sides = part.iter().flat_map(|&t| sides(mesh.corners(t as usize)));
    let border = sides.filter(|&side| shared.has(side)).map(|side| side.map(new_position));
    let mut border: Vec<[u32; 2]> = border.collect();
    border.sort_unstable();
    let chunk = Chunk {
        mesh: Mesh {
            positions: gather(&mesh.positions, &positions),
            wedges: wedges.iter().map(|&w| new_position(mesh.wedges[w as usize])).collect(),
            triangles: part.iter().map(|t| old(t).map(|w| numbers.wedges[w as usize])).collect(),
            groups: groups(&mesh.groups, part),
            ..mesh.rows(&wedges)
        },
        locked: gather(&shared.positions, &positions),
        triangles: part.to_vec(),
        border,
    };
    wedges.iter().for_each(|&w| numbers.wedges[w as usize] = NOBODY);
    positions.iter().for_each(|&p| numbers.positions[p as usize] = NOBODY);
    chunk
}

/// What is used, in order of first use, each noted under its new number.
fn renumber(used: impl Iterator<Item = u32>, numbers: &mut [u32]) -> Vec<u32> {
    let mut kept = Vec::new();
    for old in used {
        if numbers[old as usize] == NOBODY {
            numbers[old as usize] = kept.len() as u32;
            kept.push(old);
        }
    }
    kept
}

/// The groups as far as the part has triangles of them.
fn groups(groups: &[Group], part: &[u32]) -> Vec<Group> {
    let before = |triangle: usize| part.partition_point(|&t| (t as usize) < triangle);
    let within =
        |g: &Group| Group { triangles: before(g.triangles.start)..before(g.triangles.end), ..g.clone() };
    groups.iter().map(within).filter(|group| !group.triangles.is_empty()).collect()
}
