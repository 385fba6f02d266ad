//! The tree of all clusters that an octree makes: single vertices at the bottom, joined cell by cell.

use glam::{DVec3, Vec3};

use super::cloud::{Cloud, Clusters, Joined};
use crate::bake::simplify::order::spread;
use crate::bake::simplify::planes::Planes;

/// Levels of the octree below the box.
pub(in crate::bake::simplify) const DEPTH: u32 = 21;

/// How much of a cell's diagonal counts as error: enough that what is flat is joined in small cells before large ones.
const SIZE: f64 = 0.01;

/// No node, and no joint.
const NONE: u32 = u32::MAX;

/// Connected vertices of a cell.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// The node that these are a part of; [`NONE`] at a root.
    parent: u32,
    /// Planes and borders of their triangles.
    planes: Planes,
    /// Sum of the vertices, and their number.
    sum: DVec3,
    count: u32,
    /// The dominant joint of all; [`NONE`] without skin, [`MIXED`] if they differ.
    joint: u32,
    /// Where the vertex of this node is.
    place: DVec3,
    /// What orders cuts, and the error in lengths of the box; no less than those of parts.
    cost: f64,
    error: f64,
}

/// The joint of vertices that have different ones.
const MIXED: u32 = u32::MAX - 1;

/// A tree of clusters; the first nodes are the vertices.
pub(super) struct Octree {
    nodes: Vec<Node>,
    /// Per side of a triangle, sorted by its ends, the triangle.
    sides: Vec<Side>,
    /// Per side, the node in which its ends become one; [`NONE`] if they never do.
    joins: Vec<u32>,
}

/// A side of a triangle, its lower end first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    low: u32,
    high: u32,
    triangle: u32,
}

impl Octree {
    /// Joins vertices in ever larger cells. O(n log n).
    pub(super) fn new(cloud: &Cloud) -> Self {
        let sides = sides_of(cloud);
        let mut octree = Self { nodes: leaves(cloud, &sides), joins: vec![NONE; sides.len()], sides };
        octree.join_all(cloud);
        octree
    }

    /// Joins the ends of sides, those that share the smallest cells first.
    fn join_all(&mut self, cloud: &Cloud) {
        let codes: Vec<u64> = (0..self.nodes.len() as u32).map(|v| code(cloud.place(v))).collect();
        let mut by_depth = vec![Vec::new(); DEPTH as usize + 1];
        for (i, side) in (0u32..).zip(&self.sides) {
            if cloud.is_free(side.low) && cloud.is_free(side.high) {
                by_depth[shared_depth(codes[side.low as usize], codes[side.high as usize])].push(i);
            }
        }
        let mut joined = Joined::new(codes.len());
        let mut node_of: Vec<u32> = (0..codes.len() as u32).collect();
        for (depth, sides) in by_depth.iter().enumerate().rev() {
            self.join_level(depth, sides, &mut joined, &mut node_of, &codes);
        }
    }

    /// Joins the ends of sides that share cells of a depth: a new node for each set that grows.
    fn join_level(
        &mut self,
        depth: usize,
        sides: &[u32],
        joined: &mut Joined,
        node_of: &mut [u32],
        codes: &[u64],
    ) {
        let first = self.nodes.len() as u32;
        let ends = |side: u32| (self.sides[side as usize].low, self.sides[side as usize].high);
        let absorbed: Vec<u32> = sides.iter().filter_map(|&s| joined.join(ends(s).0, ends(s).1)).collect();
        for vertex in absorbed {
            let root = joined.root(vertex) as usize;
            if node_of[root] < first {
                let part = node_of[root];
                node_of[root] = self.nodes.len() as u32;
                self.nodes.push(Node { parent: NONE, ..self.nodes[part as usize] });
                self.nodes[part as usize].parent = node_of[root];
            }
            self.add_part(node_of[root], node_of[vertex as usize]);
        }
        for &side in sides {
            self.joins[side as usize] = node_of[joined.root(self.sides[side as usize].low) as usize];
        }
        for side in sides {
            let (node, low) = (self.joins[*side as usize], self.sides[*side as usize].low);
            if self.nodes[node as usize].place.is_nan() {
                self.nodes[node as usize].settle(depth, corner_of(codes[low as usize], depth));
            }
        }
    }

    /// Makes a node a part of another.
    fn add_part(&mut self, whole: u32, part: u32) {
        self.nodes[part as usize].parent = whole;
        let part = self.nodes[part as usize];
        self.nodes[whole as usize].add(&part);
    }

    /// Per triangle, the cost at which it goes; infinite if it never does, or not within the error.
    pub(super) fn ends_of_triangles(&self, cloud: &Cloud) -> Vec<f64> {
        let mut ends = vec![f64::INFINITY; cloud.triangles.len()];
        for (side, &join) in self.sides.iter().zip(&self.joins).filter(|&(_, &join)| join != NONE) {
            let node = &self.nodes[join as usize];
            let end = &mut ends[side.triangle as usize];
            *end = if node.is_within(cloud) { end.min(node.cost) } else { *end };
        }
        ends
    }

    /// The clusters of the largest nodes that cost no more than that and are within the error, and their largest error
    /// in object units.
    pub(super) fn cut(&self, cloud: &Cloud, cost: f64) -> (Clusters, f32) {
        let is_whole = |node: &Node| node.cost <= cost && node.is_within(cloud);
        let mut of: Vec<u32> = (0..self.nodes.len() as u32).collect();
        // Parts come before wholes, so what a whole is in is known before its parts ask.
        for node in (0..self.nodes.len()).rev() {
            let parent = self.nodes[node].parent as usize;
            if parent < self.nodes.len() && is_whole(&self.nodes[parent]) {
                of[node] = of[parent];
            }
        }
        let vertices = cloud.task.mesh.positions.len();
        of.truncate(vertices);
        let inner = self.nodes[vertices..].iter().map(|node| cloud.position_at(node.place));
        let positions: Vec<Vec3> = cloud.task.mesh.positions.iter().copied().chain(inner).collect();
        let error = of.iter().map(|&node| self.nodes[node as usize].error).fold(0.0, f64::max);
        (Clusters { of, positions }, cloud.in_units(error) as f32)
    }
}

impl Node {
    /// Takes another in; where its vertex is has to be settled anew.
    fn add(&mut self, part: &Self) {
        self.planes += part.planes;
        self.sum += part.sum;
        self.count += part.count;
        self.joint = if self.joint == part.joint { self.joint } else { MIXED };
        self.cost = self.cost.max(part.cost);
        self.error = self.error.max(part.error);
        self.place = DVec3::NAN;
    }

    /// Puts the vertex where its error is least within its cell, and says what that costs.
    fn settle(&mut self, depth: usize, corner: DVec3) {
        let side = (-(depth as f64)).exp2();
        let diagonal = 3f64.sqrt() * side;
        self.place = self.planes.least(self.sum / f64::from(self.count)).clamp(corner, corner + side);
        let off = self.planes.distance_at(self.place);
        self.error = self.error.max(if self.joint == MIXED { diagonal } else { off });
        let cost = self.planes.weight().sqrt() * self.error.hypot(SIZE * diagonal);
        self.cost = self.cost.max(cost.min(f64::MAX));
    }

    fn is_within(&self, cloud: &Cloud) -> bool {
        cloud.in_units(self.error) as f32 <= cloud.task.target.error
    }
}

/// A node for every vertex, with the planes of its triangles and borders.
fn leaves(cloud: &Cloud, sides: &[Side]) -> Vec<Node> {
    let joints = joints_of(cloud);
    let leaf = |vertex: u32| Node {
        parent: NONE,
        planes: Planes::NONE,
        sum: cloud.place(vertex),
        count: 1,
        joint: joints[vertex as usize],
        place: cloud.place(vertex),
        cost: 0.0,
        error: 0.0,
    };
    let mut nodes: Vec<Node> = (0..joints.len() as u32).map(leaf).collect();
    for (t, corners) in cloud.triangles.iter().enumerate() {
        let plane = cloud.plane_of(t);
        for &corner in corners {
            nodes[corner as usize].planes += plane;
        }
    }
    for same in sides.chunk_by(|a, b| (a.low, a.high) == (b.low, b.high)).filter(|same| same.len() != 2) {
        same.iter().for_each(|side| hold_border(cloud, side, &mut nodes));
    }
    nodes
}

/// Holds the ends of a border to the plane through it.
fn hold_border(cloud: &Cloud, side: &Side, nodes: &mut [Node]) {
    let places = cloud.triangles[side.triangle as usize].map(|v| cloud.place(v));
    let ends = [side.low, side.high].map(|v| cloud.place(v));
    let plane = Planes::at_border(places, ends, cloud.weight_of(side.triangle as usize));
    nodes[side.low as usize].planes += plane;
    nodes[side.high as usize].planes += plane;
}

/// Per vertex, the joint that moves it most; [`NONE`] without skin.
fn joints_of(cloud: &Cloud) -> Vec<u32> {
    let mesh = cloud.task.mesh;
    let mut joints = vec![NONE; mesh.positions.len()];
    for (&vertex, skin) in mesh.wedges.iter().zip(&mesh.skins) {
        let most = (0..4).max_by(|&i, &j| skin.weights[i].total_cmp(&skin.weights[j])).unwrap_or(0);
        joints[vertex as usize] = u32::from(skin.joints[most]);
    }
    joints
}

fn sides_of(cloud: &Cloud) -> Vec<Side> {
    let sides = |(triangle, &[a, b, c]): (u32, &[u32; 3])| {
        [(a, b), (b, c), (c, a)].map(|(p, q)| Side { low: p.min(q), high: p.max(q), triangle })
    };
    let mut sides: Vec<Side> = (0..).zip(&cloud.triangles).flat_map(sides).collect();
    sides.sort_unstable();
    sides
}

/// The cells that a place is in, from the largest down: three bits for each.
pub(in crate::bake::simplify) fn code(place: DVec3) -> u64 {
    let cells = f64::from(1 << DEPTH);
    let cell = (place * cells).max(DVec3::ZERO).min(DVec3::splat(cells - 1.0)).as_u64vec3();
    spread(cell.x) << 2 | spread(cell.y) << 1 | spread(cell.z)
}

/// How many cells below the box two places share.
pub(in crate::bake::simplify) fn shared_depth(a: u64, b: u64) -> usize {
    ((a ^ b).leading_zeros().saturating_sub(1) / 3).min(DEPTH) as usize
}

/// The lowest corner of a cell.
pub(in crate::bake::simplify) fn corner_of(code: u64, depth: usize) -> DVec3 {
    let axis = |shift: u32| {
        let bits = (0..depth as u32).map(|level| code >> (3 * (DEPTH - 1 - level) + shift) & 1);
        bits.fold(0, |axis, bit| axis << 1 | bit) as f64
    };
    DVec3::new(axis(2), axis(1), axis(0)) * (-(depth as f64)).exp2()
}
