//! Numbers for leaves and triangles, by which a cut knows what belongs where.

use glam::Vec3;

use super::stars::Stars;
use crate::hierarchy::{Operation, Parts};

/// No node, and no operation.
const NONE: u32 = u32::MAX;

/// The operations of a record as they were found: nodes are positions of the mesh, then one per operation.
pub(super) struct Raw {
    /// Per node.
    positions: Vec<Vec3>,
    /// With `ends` that are nodes.
    pub(super) operations: Vec<Operation>,
    /// How many positions the mesh has.
    leaves: u32,
    /// Per position, the node that it is by now.
    nodes: Vec<u32>,
    /// Per triangle, its corners in the mesh, that which is not contracted when it goes being the third.
    triangles: Vec<[u32; 3]>,
    /// Per triangle, the operation that it goes with and the node that is its third corner then.
    goes: Vec<(u32, u32)>,
}

impl Raw {
    pub(super) fn new(positions: Vec<Vec3>, triangles: &[[u32; 3]]) -> Self {
        let leaves = positions.len() as u32;
        Self {
            nodes: (0..leaves).collect(),
            positions,
            operations: Vec::new(),
            leaves,
            triangles: triangles.to_vec(),
            goes: vec![(NONE, NONE); triangles.len()],
        }
    }

    /// The operation that made what a position is by now, unless it is a leaf.
    pub(super) fn maker(&self, position: u32) -> Option<&Operation> {
        let made = self.nodes[position as usize].checked_sub(self.leaves)?;
        self.operations.get(made as usize)
    }

    /// Adds an operation on two positions with the triangles around them, and returns its index.
    pub(super) fn push(
        &mut self,
        kept: u32,
        gone: u32,
        position: Vec3,
        operation: Operation,
        star: &[u32],
        stars: &Stars,
    ) -> u32 {
        let index = self.operations.len() as u32;
        let mut triangles = 0;
        for &triangle in star {
            let corners = stars.corners(triangle);
            let apex = corners.iter().position(|&c| c != kept && c != gone);
            let uses_both = corners.contains(&kept) && corners.contains(&gone);
            if let Some(apex) = apex.filter(|_| uses_both) {
                self.triangles[triangle as usize].rotate_left(apex + 1);
                self.goes[triangle as usize] = (index, self.nodes[corners[apex] as usize]);
                triangles += 1;
            }
        }
        let ends = [kept, gone].map(|v| self.nodes[v as usize]);
        self.operations.push(Operation { ends, triangles, ..operation });
        self.positions.push(position);
        self.nodes[kept as usize] = self.leaves + index;
        index
    }
}

/// Numbers leaves so that those below a node are a run, those without a triangle left out, and sorts triangles by when
/// they go. O(n log n).
pub(super) fn number(raw: Raw) -> Parts {
    let order = leaf_order(&raw);
    let mut new = vec![NONE; raw.positions.len()];
    (0..).zip(&order).for_each(|(index, &leaf)| new[leaf as usize] = index);
    let made = raw.leaves as usize..raw.positions.len();
    (order.len() as u32..).zip(made.clone()).for_each(|(index, node)| new[node] = index);
    let mut by_going: Vec<u32> = (0..raw.triangles.len() as u32).collect();
    by_going.sort_by_key(|&t| raw.goes[t as usize].0);
    let going = by_going.iter().map(|&t| raw.goes[t as usize]).filter(|&(operation, _)| operation != NONE);
    let renamed =
        |operation: &Operation| Operation { ends: operation.ends.map(|n| new[n as usize]), ..*operation };
    Parts {
        apexes: going.map(|(_, apex)| new[apex as usize]).collect(),
        triangles: by_going.iter().map(|&t| raw.triangles[t as usize].map(|v| new[v as usize])).collect(),
        operations: raw.operations.iter().map(renamed).collect(),
        positions: order
            .iter()
            .map(|&leaf| leaf as usize)
            .chain(made)
            .map(|node| raw.positions[node])
            .collect(),
    }
}

/// The leaves that have a triangle or an operation, from root to root, the first end of each operation before the second.
fn leaf_order(raw: &Raw) -> Vec<u32> {
    let mut is_used = vec![false; raw.positions.len()];
    raw.triangles.as_flattened().iter().for_each(|&leaf| is_used[leaf as usize] = true);
    let mut is_root = vec![true; raw.positions.len()];
    for end in raw.operations.iter().flat_map(|operation| operation.ends) {
        (is_used[end as usize], is_root[end as usize]) = (true, false);
    }
    let mut order = Vec::new();
    for root in (0..raw.positions.len() as u32).filter(|&node| is_root[node as usize]) {
        let mut open = vec![root];
        while let Some(node) = open.pop() {
            match node.checked_sub(raw.leaves) {
                Some(operation) => open.extend(raw.operations[operation as usize].ends.iter().rev()),
                None if is_used[node as usize] => order.push(node),
                None => {}
            }
        }
    }
    order
}
