//! Cuts through vertex hierarchies: whatever the camera does, a cut is a mesh, within its budget, and what a replay of
//! its operations makes of the original.

#![cfg(feature = "bake")]

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{Mat3, Quat, Vec2, Vec3};
use lod_budget::View;
use lod_budget::bake::hierarchy;
use lod_budget::bake::shapes::{icosphere, terrain, torus_knot};
use lod_budget::bake::simplify::{GarlandHeckbert, quietly};
use lod_budget::bake::{Mesh, Surface};
use lod_budget::hierarchy::{Budget, Cut, Hierarchy};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn hierarchy_of(surface: Surface) -> Arc<Hierarchy> {
    let mesh = Mesh::from(surface);
    Arc::new(hierarchy::of(&mesh, &GarlandHeckbert::default(), &mut quietly).expect("a good shape"))
}

fn camera(eye: Vec3, target: Vec3) -> View {
    let forward = (target - eye).normalize_or(Vec3::Y);
    let right = forward.cross(Vec3::Z).normalize_or(Vec3::X);
    let rotation = Quat::from_mat3(&Mat3::from_cols(right, right.cross(forward), -forward));
    let view = View::perspective(1.0, Vec2::new(1280.0, 720.0)).at(eye, rotation);
    View { near: 1e-3, ..view }
}

/// The operations that a cut has done: those above whose node, or at whose node, something is active.
fn done(cut: &Cut) -> Vec<bool> {
    let hierarchy = cut.hierarchy();
    let leaves = hierarchy.leaves();
    let operations = &hierarchy.parts().operations;
    let mut is_done: Vec<bool> =
        (leaves..leaves + operations.len()).map(|n| cut.is_active(n as u32)).collect();
    for (i, operation) in operations.iter().enumerate().rev() {
        for below in operation.ends.iter().filter_map(|&end| (end as usize).checked_sub(leaves)) {
            is_done[below] |= is_done[i];
        }
    }
    is_done
}

/// The slow twin: the operations of a set done one after another on the whole mesh. Triangles with their numbers,
/// each from its least corner.
fn replay(hierarchy: &Hierarchy, is_done: &[bool]) -> Vec<(u32, [u32; 3])> {
    let leaves = hierarchy.leaves() as u32;
    let mut nodes: Vec<u32> = (0..leaves).collect();
    for (i, operation) in hierarchy.parts().operations.iter().enumerate().filter(|&(i, _)| is_done[i]) {
        for node in nodes.iter_mut().filter(|node| operation.ends.contains(node)) {
            *node = leaves + i as u32;
        }
    }
    let named = |t: &[u32; 3]| t.map(|leaf| nodes[leaf as usize]);
    let all = (0..).zip(hierarchy.parts().triangles.iter().map(named));
    all.filter(|(_, [a, b, c])| a != b && b != c && c != a).map(|(t, nodes)| (t, from_least(nodes))).collect()
}

fn from_least(nodes: [u32; 3]) -> [u32; 3] {
    let least = (0..3).min_by_key(|&i| nodes[i]).unwrap_or(0);
    [nodes[least], nodes[(least + 1) % 3], nodes[(least + 2) % 3]]
}

/// What each operation rests on: the last operations before it that touched one of its triangles. By brute force.
fn dependencies(hierarchy: &Hierarchy) -> Vec<BTreeSet<usize>> {
    let leaves = hierarchy.leaves() as u32;
    let mut triangles = hierarchy.parts().triangles.clone();
    let mut touched: Vec<Option<usize>> = vec![None; triangles.len()];
    let mut all = Vec::new();
    for (i, operation) in hierarchy.parts().operations.iter().enumerate() {
        let mut below = BTreeSet::new();
        for (triangle, last) in triangles.iter_mut().zip(&mut touched) {
            let is_alive =
                triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0];
            if is_alive && triangle.iter().any(|node| operation.ends.contains(node)) {
                below.extend(last.replace(i));
                *triangle = triangle.map(|n| if operation.ends.contains(&n) { leaves + i as u32 } else { n });
            }
        }
        all.push(below);
    }
    all
}

/// What stays the same of a mesh whatever is done to it.
#[derive(Debug, PartialEq)]
struct Topology {
    euler: i64,
    borders: usize,
}

/// Refuses edges that more than one triangle goes along in the same direction. `count_borders` is off for meshes whose
/// border has fewer and fewer edges.
fn topology(triangles: &[[u32; 3]], nodes: &mut Vec<u32>, edges: &mut Vec<u64>) -> Topology {
    edges.clear();
    nodes.clear();
    for &[a, b, c] in triangles {
        nodes.extend([a, b, c]);
        edges.extend(
            [(a, b), (b, c), (c, a)]
                .map(|(p, q)| u64::from(p.min(q)) << 33 | u64::from(p.max(q)) << 1 | u64::from(p < q)),
        );
    }
    nodes.sort_unstable();
    nodes.dedup();
    edges.sort_unstable();
    assert!(edges.windows(2).all(|pair| pair[0] != pair[1]), "an edge has two triangles on one side");
    let directed = edges.len() as i64;
    edges.iter_mut().for_each(|edge| *edge >>= 1);
    edges.dedup();
    let (all, corners) = (edges.len() as i64, nodes.len() as i64);
    Topology { euler: corners - all + triangles.len() as i64, borders: (2 * all - directed) as usize }
}

fn normal(positions: &[Vec3], triangle: [u32; 3]) -> Vec3 {
    let [a, b, c] = triangle.map(|v| positions[v as usize]);
    (b - a).cross(c - a)
}

/// Where the triangles of the mesh face, each by its number.
fn facings(hierarchy: &Hierarchy) -> Vec<Vec3> {
    let parts = hierarchy.parts();
    parts.triangles.iter().map(|&t| normal(&parts.positions, t).normalize_or_zero()).collect()
}

/// How the camera goes on: mostly a little, sometimes elsewhere.
struct Walk {
    rng: Pcg64Mcg,
    eye: Vec3,
    target: Vec3,
    low: Vec3,
    high: Vec3,
}

impl Walk {
    fn anywhere(&mut self) -> Vec3 {
        let at = |rng: &mut Pcg64Mcg| Vec3::new(rng.random(), rng.random(), rng.random());
        self.low + at(&mut self.rng) * (self.high - self.low)
    }

    fn step(&mut self) -> View {
        let speed = match self.rng.next_u32() % 64 {
            0 => 1.0,
            1..8 => 0.0,
            _ => 0.02,
        };
        let (eye, target) = (self.anywhere(), self.anywhere());
        (self.eye, self.target) = (self.eye.lerp(eye, speed), self.target.lerp(target, speed));
        camera(self.eye, self.target)
    }
}

/// Walks for so many frames, and checks every one of them.
fn walk(surface: Surface, frames: usize, upright: bool, with_twin: bool) {
    let hierarchy = hierarchy_of(surface);
    let facings = facings(&hierarchy);
    let below = if with_twin { dependencies(&hierarchy) } else { Vec::new() };
    let bounds = hierarchy.bounds();
    let (low, high) = (bounds.center - bounds.radius, bounds.center + bounds.radius);
    let mut walk = Walk { rng: Pcg64Mcg::seed_from_u64(1), eye: high, target: low, low, high };
    let (mut nodes, mut edges) = (Vec::new(), Vec::new());
    let whole = topology(&hierarchy.parts().triangles, &mut nodes, &mut edges);
    let mut cut = Cut::new(hierarchy.clone());
    let mut twin = cut.triangles().to_vec();
    let (mut changes, mut budget) = (0, Budget::triangles(300));
    for frame in 0..frames {
        if frame % 50 == 0 {
            budget.triangles = 100 + walk.rng.random_range(0..400);
            budget.enough_px = [0.0, 0.5][frame / 50 % 2];
            budget.changes = [usize::MAX, 20][frame / 100 % 2];
        }
        let report = cut.update(&[walk.step()], &budget);
        changes += report.splits + report.merges;
        assert_eq!(report.triangles, cut.triangles().len());
        assert!(report.triangles <= budget.triangles.max(hierarchy.base_triangles()), "{report:?}");
        let topology = topology(cut.triangles(), &mut nodes, &mut edges);
        assert_eq!((topology.euler, topology.borders > 0), (whole.euler, whole.borders > 0), "frame {frame}");
        for (&triangle, &origin) in cut.triangles().iter().zip(cut.origins()) {
            let normal = normal(hierarchy.positions(), triangle).normalize_or_zero();
            // The simplifier knows where a triangle faced to a hundredth.
            assert!(
                normal.dot(facings[origin as usize]) > -0.02,
                "frame {frame}: {triangle:?} has turned over"
            );
            assert!(!upright || normal.z > 0.0, "frame {frame}: {triangle:?} faces down");
        }
        twin.resize(cut.triangles().len(), [0; 3]);
        cut.changed().iter().for_each(|&slot| twin[slot as usize] = cut.triangles()[slot as usize]);
        assert!(twin == cut.triangles(), "frame {frame}: a slot has changed and nobody was told");
        if with_twin && frame % 53 == 0 {
            check_against_replay(&cut, &below);
        }
    }
    assert!(changes > frames, "the walk must change the cut: {changes}");
}

fn check_against_replay(cut: &Cut, below: &[BTreeSet<usize>]) {
    let is_done = done(cut);
    for (i, below) in below.iter().enumerate().filter(|&(i, _)| is_done[i]) {
        assert!(below.iter().all(|&o| is_done[o]), "operation {i} is done before what it rests on");
    }
    let triangles = cut.triangles().iter().map(|&t| from_least(t));
    let mut shown: Vec<(u32, [u32; 3])> = cut.origins().iter().copied().zip(triangles).collect();
    shown.sort_unstable();
    assert_eq!(shown, replay(cut.hierarchy(), &is_done));
}

#[test]
fn ten_thousand_frames_over_a_terrain() {
    walk(terrain(100, 1), 10_000, true, false);
}

#[test]
fn a_walk_over_a_small_terrain_beside_its_twin() {
    walk(terrain(30, 2), 1_000, true, true);
}

#[test]
fn a_walk_around_and_through_a_knot_beside_its_twin() {
    walk(torus_knot(60, 8), 1_000, false, true);
}

#[test]
fn a_walk_around_and_through_a_sphere() {
    walk(icosphere(10), 1_000, false, false);
}
