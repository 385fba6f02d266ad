//! What is baked: the forest of contractions and the triangles of its leaves.

use glam::Vec3;

use super::takers::Takers;
use super::{Cone, Flaw, NONE, Part};
use crate::bounds::{Aabb, Sphere};

/// What a hierarchy is made of. *Nodes* are vertices: the leaves first, which are the vertices of the mesh, then one
/// per operation, in their order.
///
/// Leaves are numbered so that the leaves below any node are a run, those of its first end before those of its second.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parts {
    /// Per node, in object units.
    pub positions: Vec<Vec3>,
    /// Contractions in the order in which they were made.
    pub operations: Vec<Operation>,
    /// Triangles of leaves, counter-clockwise, in the order in which they go: those that no operation takes come last.
    /// The corner that is not contracted when the triangle goes is its third.
    pub triangles: Vec<[u32; 3]>,
    /// Per triangle that goes, the node that its third corner is by then.
    pub apexes: Vec<u32>,
}

/// A contraction of two nodes into one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Operation {
    /// The nodes that become one.
    pub ends: [u32; 2],
    /// How many triangles go: the next so many.
    pub triangles: u32,
    /// How far each point of the triangles around the new vertex is at most from its place on the mesh, and the other way
    /// round, in object units.
    pub error: f32,
    /// Which way from it.
    pub cone: Cone,
    /// Around all that changes, and around the spheres of its ends: then what is below is never more urgent. It need not
    /// hold the spheres of all that it rests on, which reach so far that a camera would be inside most of them.
    pub sphere: Sphere,
}

/// A mesh as a forest of contractions. Made by `bake::hierarchy` or from [`Parts`]; never changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Hierarchy {
    parts: Parts,
    /// Per operation, the first triangle that goes with it; and where those end that go.
    firsts: Vec<u32>,
    /// Per operation, the first leaf below its second end.
    middles: Vec<u32>,
    /// Per node, the operation that contracts it.
    parents: Vec<u32>,
    takers: Takers,
    bounds: Sphere,
}

impl Hierarchy {
    /// Checks the parts and completes them; O(n).
    ///
    /// # Errors
    /// The first [`Flaw`]: positions, errors and spheres must be finite, every node be contracted once at most and after
    /// it was made, and triangles go with the operation that contracts two corners of them. There may be 2³⁰ triangles
    /// and 2³¹ nodes.
    pub fn new(parts: Parts) -> Result<Self, Flaw> {
        let mut hierarchy = Self {
            firsts: Vec::new(),
            middles: Vec::new(),
            parents: vec![NONE; parts.positions.len()],
            takers: Takers::default(),
            bounds: Aabb::around(parts.positions.iter().copied()).sphere(),
            parts,
        };
        hierarchy.check_counts()?;
        let spans = hierarchy.link()?;
        hierarchy.check_triangles(&spans)?;
        let Parts { positions, apexes, .. } = &hierarchy.parts;
        hierarchy.takers = Takers::new(positions.len(), apexes, &hierarchy.firsts);
        Ok(hierarchy)
    }

    /// What it is made of.
    pub fn parts(&self) -> &Parts {
        &self.parts
    }

    /// How many nodes are vertices of the mesh.
    pub fn leaves(&self) -> usize {
        self.parts.positions.len() - self.parts.operations.len()
    }

    /// How many triangles the mesh has.
    pub fn triangles(&self) -> usize {
        self.parts.triangles.len()
    }

    /// How many triangles no operation takes: no cut has fewer.
    pub fn base_triangles(&self) -> usize {
        self.parts.triangles.len() - self.parts.apexes.len()
    }

    /// Around all nodes; no extent without nodes.
    pub fn bounds(&self) -> Sphere {
        self.bounds
    }

    /// Per node, where it is: what a vertex buffer of all cuts has.
    pub fn positions(&self) -> &[Vec3] {
        &self.parts.positions
    }

    pub(super) fn operation(&self, operation: u32) -> &Operation {
        &self.parts.operations[operation as usize]
    }

    /// The node that an operation makes.
    pub(super) fn node(&self, operation: u32) -> u32 {
        self.leaves() as u32 + operation
    }

    /// The operation that made a node, unless it is a leaf.
    pub(super) fn maker(&self, node: u32) -> Option<u32> {
        node.checked_sub(self.leaves() as u32)
    }

    /// The operation that contracts a node, unless none does.
    pub(super) fn parent(&self, node: u32) -> Option<u32> {
        Some(self.parents[node as usize]).filter(|&parent| parent != NONE)
    }

    /// The triangles that go with an operation.
    pub(super) fn going(&self, operation: u32) -> std::ops::Range<u32> {
        self.firsts[operation as usize]..self.firsts[operation as usize + 1]
    }

    /// Per triangle that goes with an operation, the node that its third corner is by then.
    pub(super) fn apexes(&self, operation: u32) -> &[u32] {
        let going = self.going(operation);
        &self.parts.apexes[going.start as usize..going.end as usize]
    }

    /// The operations that take a triangle whose third corner is a node by then, ascending.
    pub(super) fn takers(&self, node: u32) -> &[u32] {
        self.takers.of(node)
    }

    /// The end of an operation that a leaf below it is below.
    pub(super) fn end_of(&self, operation: u32, leaf: u32) -> u32 {
        let is_second = leaf >= self.middles[operation as usize];
        self.operation(operation).ends[usize::from(is_second)]
    }

    /// Per leaf, the node above it that no operation contracts.
    pub(super) fn roots(&self) -> Vec<u32> {
        let mut root: Vec<u32> = (0..self.parts.positions.len() as u32).collect();
        for (operation, parts) in self.parts.operations.iter().enumerate().rev() {
            let node = self.node(operation as u32);
            parts.ends.iter().for_each(|&end| root[end as usize] = root[node as usize]);
        }
        root.truncate(self.leaves());
        root
    }

    fn check_counts(&self) -> Result<(), Flaw> {
        let Parts { positions, operations, triangles, apexes } = &self.parts;
        let flaw = |part, index, rule| Err(Flaw { part, index, rule });
        let going: u64 = operations.iter().map(|o| u64::from(o.triangles)).sum();
        if positions.len() > MOST_NODES {
            flaw(Part::Position, positions.len(), "there may be 2147483648 nodes")
        } else if triangles.len() > MOST_TRIANGLES {
            flaw(Part::Triangle, triangles.len(), "there may be 1073741824 triangles")
        } else if operations.len() > positions.len() {
            flaw(Part::Operation, operations.len(), "there must be a node for each operation")
        } else if going != apexes.len() as u64 {
            flaw(Part::Apex, apexes.len(), "there must be as many apexes as triangles that go")
        } else if apexes.len() > triangles.len() {
            flaw(Part::Apex, apexes.len(), "there must not be more apexes than triangles")
        } else {
            Ok(())
        }
    }

    /// Completes the operations; per node, the run of leaves below it.
    fn link(&mut self) -> Result<Vec<[u32; 2]>, Flaw> {
        let at = |part, index, rule| Flaw { part, index, rule };
        if let Some(i) = self.parts.positions.iter().position(|p| !p.is_finite()) {
            return Err(at(Part::Position, i, "it must be finite"));
        }
        let mut spans: Vec<[u32; 2]> = (0..self.leaves() as u32).map(|leaf| [leaf, leaf + 1]).collect();
        let mut first = 0;
        for (i, operation) in self.parts.operations.iter().enumerate() {
            let span =
                span_of(operation, &spans, &self.parents).map_err(|rule| at(Part::Operation, i, rule))?;
            operation.ends.iter().for_each(|&end| self.parents[end as usize] = i as u32);
            self.middles.push(spans[operation.ends[1] as usize][0]);
            self.firsts.push(first);
            first += operation.triangles;
            spans.push(span);
        }
        self.firsts.push(first);
        Ok(spans)
    }

    fn check_triangles(&self, spans: &[[u32; 2]]) -> Result<(), Flaw> {
        let leaves = self.leaves() as u32;
        let beyond = |t: &[u32; 3]| t.iter().any(|&leaf| leaf >= leaves);
        if let Some(index) = self.parts.triangles.iter().position(beyond) {
            return Err(Flaw { part: Part::Triangle, index, rule: "its corners must be leaves" });
        }
        for operation in 0..self.parts.operations.len() as u32 {
            self.going(operation).try_for_each(|t| self.check_going(operation, t, spans))?;
        }
        let roots = self.roots();
        let merges = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|leaf| roots[leaf as usize]);
            a == b || b == c || c == a
        };
        let staying = &self.parts.triangles[self.parts.apexes.len()..];
        match staying.iter().position(merges) {
            Some(i) => {
                let index = self.parts.apexes.len() + i;
                Err(Flaw { part: Part::Triangle, index, rule: "it must go where two corners become one" })
            }
            None => Ok(()),
        }
    }

    /// Whether a triangle goes with the operation that contracts its first two corners, and not before.
    fn check_going(&self, operation: u32, triangle: u32, spans: &[[u32; 2]]) -> Result<(), Flaw> {
        let index = triangle as usize;
        let ends = self.operation(operation).ends;
        let [a, b, c] = self.parts.triangles[index];
        let is_below =
            |leaf: u32, node: u32| (spans[node as usize][0]..spans[node as usize][1]).contains(&leaf);
        let is_split = |a, b| is_below(a, ends[0]) && is_below(b, ends[1]);
        if !is_split(a, b) && !is_split(b, a) {
            let rule = "its first two corners must be contracted by the operation it goes with";
            return Err(Flaw { part: Part::Triangle, index, rule });
        }
        let apex = self.parts.apexes[index];
        let is_there = apex < self.node(operation)
            && !ends.contains(&apex)
            && self.parent(apex).is_none_or(|parent| parent > operation);
        if !(is_there && is_below(c, apex)) {
            let rule = "it must be the node above the third corner when the triangle goes";
            return Err(Flaw { part: Part::Apex, index, rule });
        }
        Ok(())
    }
}

/// Nodes fit 32 bits with one value to spare.
const MOST_NODES: usize = 1 << 31;

/// Three corners each fit 32 bits with one value to spare.
const MOST_TRIANGLES: usize = 1 << 30;

/// The leaves below the node that an operation makes, by those of the nodes before it.
fn span_of(operation: &Operation, spans: &[[u32; 2]], parents: &[u32]) -> Result<[u32; 2], &'static str> {
    let [first, second] = operation.ends.map(|end| spans.get(end as usize));
    let (Some(first), Some(second)) = (first, second) else {
        return Err("its ends must be nodes that were made before");
    };
    if operation.ends.iter().any(|&end| parents[end as usize] != NONE) {
        Err("its ends must not have been contracted before")
    } else if first[1] != second[0] {
        Err("the leaves of its second end must follow those of its first")
    } else if !(operation.error.is_finite() && operation.error >= 0.0) {
        Err("its error must be finite and not negative")
    } else if !operation.sphere.is_valid() {
        Err("its sphere must be finite")
    } else {
        Ok([first[0], second[1]])
    }
}
