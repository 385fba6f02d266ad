//! Cuts through vertex hierarchies: whatever the camera does, a cut is a mesh, within its budget, and what a replay of
//! its operations makes of the original.

#![cfg(feature = "bake")]

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{Mat3, Quat, Vec2, Vec3};
use lod_budget::bake::deviation::{Options, deviation};
use lod_budget::bake::hierarchy;
use lod_budget::bake::shapes::{icosphere, terrain, torus_knot};
use lod_budget::bake::simplify::{Contraction, GarlandHeckbert, Topology, quietly};
use lod_budget::bake::{Mesh, Surface};
use lod_budget::hierarchy::{Budget, Cut, Hierarchy};
use lod_budget::select::{Coarsest, Finest, Selector};
use lod_budget::{FrameInput, LevelRecord, LodTable, Object, Objects, Predictive, Runtime, RuntimeOptions};
use lod_budget::{Sphere, View, ViewInput};
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
struct Shape {
    euler: i64,
    borders: usize,
}

/// Refuses edges that more than one triangle goes along in the same direction. `count_borders` is off for meshes whose
/// border has fewer and fewer edges.
fn topology(triangles: &[[u32; 3]], nodes: &mut Vec<u32>, edges: &mut Vec<u64>) -> Shape {
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
    Shape { euler: corners - all + triangles.len() as i64, borders: (2 * all - directed) as usize }
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

fn walk_through(hierarchy: &Hierarchy) -> Walk {
    let bounds = hierarchy.bounds();
    let (low, high) = (bounds.center - bounds.radius, bounds.center + bounds.radius);
    Walk { rng: Pcg64Mcg::seed_from_u64(1), eye: high, target: low, low, high }
}

/// Walks for so many frames, and checks every one of them.
fn walk(surface: Surface, frames: usize, upright: bool, with_twin: bool) {
    let hierarchy = hierarchy_of(surface);
    let facings = facings(&hierarchy);
    let below = if with_twin { dependencies(&hierarchy) } else { Vec::new() };
    let mut walk = walk_through(&hierarchy);
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

/// Eight rows of octahedra that touch at their tips.
fn beads() -> Surface {
    let mut all = Surface::default();
    for (row, bead) in (0..8).flat_map(|row| (0..6).map(move |bead| (row, bead))) {
        let first = all.positions.len() as u32;
        let center = Vec3::new(2.0 * bead as f32, 3.0 * row as f32, (row * bead) as f32 / 7.0);
        let corners = [Vec3::NEG_X, Vec3::X, Vec3::NEG_Y, Vec3::Y, Vec3::NEG_Z * 0.5, Vec3::Z * 0.7];
        all.positions.extend(corners.map(|corner| center + corner));
        let tip = |corner: u32| if bead > 0 && corner == 0 { first - 5 } else { first + corner };
        let faces = [[1, 3, 5], [3, 0, 5], [0, 2, 5], [2, 1, 5], [3, 1, 4], [0, 3, 4], [2, 0, 4], [1, 2, 4]];
        all.triangles.extend(faces.map(|face| face.map(tip)));
    }
    all
}

/// Where a part goes altogether, its last vertices are no longer neighbours: their order has to be known all the same.
#[test]
fn parts_that_go_come_back_in_order() {
    for pairs in [0.0, 3.0] {
        let method = GarlandHeckbert { topology: Topology::Free, pairs, ..GarlandHeckbert::default() };
        let hierarchy = hierarchy::of(&Mesh::from(beads()), &method, &mut quietly).expect("a good shape");
        let below = dependencies(&hierarchy);
        let mut walk = walk_through(&hierarchy);
        let mut cut = Cut::new(Arc::new(hierarchy));
        for _ in 0..200 {
            let triangles = walk.rng.random_range(0..cut.hierarchy().triangles());
            let report = cut.update(&[walk.step()], &Budget::triangles(triangles));
            assert!(report.triangles <= triangles.max(cut.hierarchy().base_triangles()), "{report:?}");
            check_against_replay(&cut, &below);
        }
    }
}

#[test]
fn a_walk_around_and_through_a_sphere() {
    walk(icosphere(10), 1_000, false, false);
}

/// A terrain that is cut small, and a camera at its edge that looks across.
fn vista() -> (Cut, View) {
    let cut = Cut::new(hierarchy_of(terrain(40, 3)));
    (cut, camera(Vec3::new(0.5, -0.1, 0.25), Vec3::new(0.5, 0.5, 0.0)))
}

#[test]
fn a_still_camera_comes_to_rest_and_costs_nothing() {
    let (mut cut, view) = vista();
    for changes in [usize::MAX, 10] {
        for triangles in [50, 400, 1_000, 130, 400] {
            let budget = Budget { changes, ..Budget::triangles(triangles) };
            let settled = (0..500).find(|_| cut.update(&[view], &budget).is_settled);
            assert!(settled.is_some(), "{budget:?}");
            let report = cut.update(&[view], &budget);
            assert_eq!((report.splits, report.merges, report.evaluated), (0, 0, 0));
            assert!(cut.changed().is_empty());
        }
    }
}

/// Whatever the way, what a camera that stays sees is as good as what it would have seen at once.
#[test]
fn a_teleport_is_as_good_as_a_start_there() {
    let (mut cut, view) = vista();
    let budget = Budget { hysteresis: 0.0, ..Budget::triangles(600) };
    let fresh = Cut::new(cut.hierarchy().clone()).update(&[view], &budget);
    cut.update(&[camera(Vec3::new(0.5, 1.2, 0.3), Vec3::new(0.5, 0.0, 0.0))], &budget);
    let landed = cut.update(&[view], &budget);
    assert!(landed.splits > 50 && landed.merges > 50, "{landed:?}");
    assert!(landed.max_error_px < 1.5 * fresh.max_error_px, "{landed:?} {fresh:?}");
}

/// What is near gets more than it would if the camera were at the other end.
#[test]
fn detail_is_where_the_camera_is() {
    let mut cut = Cut::new(hierarchy_of(terrain(60, 3)));
    let mut near_from = |y: f32| {
        cut.update(&[camera(Vec3::new(0.5, y, 0.25), Vec3::new(0.5, 0.5, 0.0))], &Budget::triangles(1_500));
        let positions = cut.hierarchy().positions();
        cut.triangles().iter().filter(|t| positions[t[0] as usize].y < 0.3).count() as f32
    };
    let (here, there) = (near_from(-0.1), near_from(1.1));
    assert!(here > 1.5 * there, "{here} {there}");
}

#[test]
fn good_enough_is_not_made_better() {
    let (mut cut, view) = vista();
    let whole = cut.hierarchy().triangles();
    let at = |cut: &mut Cut, enough_px| {
        cut.update(&[view], &Budget { enough_px, hysteresis: 0.0, ..Budget::triangles(usize::MAX) })
    };
    let [coarse, fine, exact] = [20.0, 2.0, 0.0].map(|enough| at(&mut cut, enough));
    assert!(coarse.triangles < fine.triangles && fine.triangles < exact.triangles);
    assert!(coarse.max_error_px <= 20.0 && fine.max_error_px <= 2.0);
    assert_eq!((exact.triangles, exact.max_error_px), (whole, 0.0));
    let again = at(&mut cut, 20.0);
    assert!(again.max_error_px <= 20.0 && again.triangles <= coarse.triangles + 20, "{again:?}");
}

#[test]
fn no_budget_leaves_the_base_and_a_broken_view_what_is_there() {
    let (mut cut, view) = vista();
    cut.update(&[view], &Budget::triangles(300));
    let before = cut.triangles().to_vec();
    let broken = View { eye: Vec3::NAN, ..view };
    let report = cut.update(&[broken], &Budget::triangles(300));
    assert_eq!((report.broken_views, cut.triangles()), (1, &before[..]));
    assert!(cut.update(&[], &Budget::triangles(200)).triangles <= 200);
    let report = cut.update(&[view, broken], &Budget::triangles(0));
    assert_eq!((report.triangles, report.broken_views), (cut.hierarchy().base_triangles(), 1));
    assert!(cut.update(&[view], &Budget::triangles(300)).triangles > 250);
}

#[test]
fn a_camera_inside_a_sphere_sees_it() {
    let mut cut = Cut::new(hierarchy_of(icosphere(8)));
    let report = cut.update(&[camera(Vec3::ZERO, Vec3::X)], &Budget::triangles(200));
    assert!(report.triangles > 150 && report.max_error_px.is_finite(), "{report:?}");
}

#[test]
fn two_views_share_a_cut() {
    let (mut cut, view) = vista();
    let other = camera(Vec3::new(0.5, 1.1, 0.25), Vec3::new(0.5, 0.5, 0.0));
    let budget = Budget { enough_px: 4.0, ..Budget::triangles(usize::MAX) };
    let alone = cut.update(&[view], &budget).triangles;
    let both = cut.update(&[view, other], &budget);
    assert!(both.triangles > alone && both.max_error_px <= 4.0);
    assert!(cut.update(&[other, view], &budget).max_error_px <= 4.0);
}

#[test]
fn small_and_broken_meshes_have_hierarchies() {
    let view = camera(Vec3::new(3.0, 3.0, 3.0), Vec3::ZERO);
    let triangle = Surface { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]] };
    let flat = Surface { positions: vec![Vec3::ONE; 3], triangles: vec![[0, 1, 2], [0, 1, 1]] };
    for (surface, triangles) in [(Surface::default(), 0), (triangle, 1), (flat, 1)] {
        let mut cut = Cut::new(hierarchy_of(surface));
        let report = cut.update(&[view], &Budget::triangles(10));
        assert_eq!((report.triangles, report.is_settled), (triangles, true));
    }
    let mut broken = Mesh::from(icosphere(1));
    broken.positions[3] = Vec3::INFINITY;
    let refused = hierarchy::of(&broken, &GarlandHeckbert::default(), &mut quietly);
    assert!(refused.expect_err("it is broken").to_string().contains("vertex 3"));
    let contraction = Contraction { kept: 0, gone: 99, position: Vec3::ZERO, error: 0.0 };
    let refused =
        hierarchy::build(&icosphere(1).into(), &[contraction]).expect_err("there is no such vertex");
    assert_eq!(refused.to_string(), "contraction 0: it must be of two vertices that are there");
}

/// One that was left out would keep all that rest on it from being done, up to the coarsest.
#[test]
fn a_contraction_that_would_fold_a_terrain_goes_elsewhere() {
    let surface = terrain(4, 1);
    let [kept, gone] = [12, 13];
    let position = surface.positions[kept as usize] + 5.0 * Vec3::X;
    let contraction = Contraction { kept, gone, position, error: 0.0 };
    let hierarchy = hierarchy::build(&surface.into(), &[contraction]).expect("a good record");
    assert_eq!(hierarchy.parts().operations.len(), 1);
    let cut = Cut::new(Arc::new(hierarchy));
    let positions = cut.hierarchy().positions();
    assert_eq!(cut.triangles().len(), 30);
    assert!(cut.triangles().iter().all(|&t| normal(positions, t).z > 0.0));
}

#[test]
fn parts_stay_parts() {
    let mut two = icosphere(4);
    let (count, triangles) = (two.positions.len() as u32, two.triangles.clone());
    two.positions.extend(icosphere(4).positions.iter().map(|&p| p + 3.0 * Vec3::X));
    two.triangles.extend(triangles.iter().map(|t| t.map(|v| v + count)));
    walk(two, 300, false, true);
}

/// What an update promises is measured: no point of the mesh or the cut is farther from the other than the largest
/// error that is active.
#[test]
fn errors_are_bounds() {
    for surface in [terrain(40, 1), torus_knot(60, 10)] {
        let hierarchy = hierarchy_of(surface.clone());
        let mut cut = Cut::new(hierarchy.clone());
        for triangles in [60, 200, 600] {
            cut.update(&[camera(Vec3::splat(2.0), Vec3::ZERO)], &Budget::triangles(triangles));
            let maker = |&node: &u32| (node as usize).checked_sub(hierarchy.leaves());
            let makers = cut.triangles().as_flattened().iter().filter_map(maker);
            let bound = makers.map(|o| hierarchy.parts().operations[o].error).fold(0.0, f32::max);
            let shown =
                Surface { positions: hierarchy.positions().to_vec(), triangles: cut.triangles().to_vec() };
            let apart = deviation(&surface, &shown, &Options::default()).expect("surfaces");
            assert!(apart.attained <= f64::from(bound), "{apart:?} {bound}");
        }
    }
}

/// What is put off is never put off too long: whatever is split or could be, nothing in view is off by more than is told.
#[test]
fn no_error_in_view_is_larger_than_the_largest_that_is_told() {
    let hierarchy = hierarchy_of(terrain(60, 3));
    let (leaves, operations) = (hierarchy.leaves(), &hierarchy.parts().operations);
    let mut walk = walk_through(&hierarchy);
    let mut cut = Cut::new(hierarchy.clone());
    for frame in 0..800 {
        // Steps that add up to a round, and leaps.
        let view = if frame % 400 < 300 { round(frame as f32 / 300.0) } else { walk.step() };
        let report = cut.update(&[view], &Budget::triangles(1_000 + frame % 3 * 500));
        let lens = view.lens(Default::default());
        let shown = (0..operations.len()).filter(|&o| cut.is_active((leaves + o) as u32));
        for (o, operation) in shown.map(|o| (o, &operations[o])) {
            // Errors of a terrain are upright.
            let slant = Vec3::Z.cross((operation.sphere.center - view.eye).normalize_or_zero()).length();
            let px = slant * operation.error * lens.unit_px(&operation.sphere);
            let is_seen = lens.frustum.sees(&operation.sphere);
            assert!(
                !is_seen || px <= 1.001 * report.max_error_px,
                "frame {frame}, operation {o}: {px} {report:?}"
            );
        }
    }
}

/// A camera on its way around the middle of a terrain, low above it.
fn round(share: f32) -> View {
    let at = |share: f32| Vec2::from_angle(std::f32::consts::TAU * share) * 0.35 + 0.5;
    camera(at(share).extend(0.2), at(share + 0.1).extend(0.1))
}

/// A scene of props and a terrain under one budget: the level that is chosen for the terrain is the budget of its cut.
#[test]
fn a_hierarchy_and_props_share_a_budget_with_a_certificate() {
    let (mut cut, view) = vista();
    let ground = cut.hierarchy().table("ground", 200).expect("a terrain has an extent");
    assert!(ground.levels().len() > 100 && ground.lint().is_empty(), "{:?}", ground.lint());
    assert_eq!(ground.levels()[0].triangles as usize, cut.hierarchy().triangles());
    let props = vec![LevelRecord::new(300, 160), LevelRecord::new(50, 30), LevelRecord::new(12, 8)];
    let prop = LodTable::new("prop", Sphere::new(Vec3::ZERO, 0.02), props).expect("a good table");
    let mut objects = Objects::new();
    let [ground_id, prop_id] = [&ground, &prop].map(|t| objects.add_table(t.clone()).expect("few tables"));
    objects.insert(Object::new(0, ground.bounds(), ground_id)).expect("a new object");
    for id in 1..60 {
        let at = Vec3::new((id % 8) as f32 / 8.0, (id / 8) as f32 / 8.0, 0.1);
        objects.insert(Object::new(id, Sphere::new(at, 0.02), prop_id)).expect("a new object");
    }
    let views = [ViewInput::new(view, 0)];
    let mut cost_of = |policy: Box<dyn Selector>| {
        let mut runtime = Runtime::new(RuntimeOptions::default(), policy).expect("good options");
        runtime.frame(&mut objects, &FrameInput::new(&views, 1e6)).predicted_us
    };
    let (least_us, most_us) = (cost_of(Box::new(Coarsest)), cost_of(Box::new(Finest)));
    let mut runtime =
        Runtime::new(RuntimeOptions::default(), Box::new(Predictive::default())).expect("good options");
    let mut seen = BTreeSet::new();
    for share in [0.2, 0.5, 0.8] {
        // Before anything is measured, three quarters of a budget are used.
        let budget_us = (least_us + share * (most_us - least_us)) / 0.75;
        for _ in 0..40 {
            let report = runtime.frame(&mut objects, &FrameInput::new(&views, budget_us));
            assert!(report.predicted_us <= budget_us, "{report:?}");
            assert!(report.select.certificate.is_some_and(|c| c.gap < 0.05), "{report:?}");
            let changes = runtime.changes().iter();
            for change in changes.filter(|change| change.object.0 == 0 && change.new.is_drawn()) {
                let triangles = ground.levels()[change.new.index()].triangles as usize;
                seen.insert(triangles);
                assert!(cut.update(&[view], &Budget::triangles(triangles)).triangles <= triangles);
            }
        }
    }
    assert!(seen.len() > 1, "more time must buy more ground: {seen:?}");
}

#[test]
fn an_offer_is_what_the_cut_is_worth_now() {
    let (mut cut, view) = vista();
    let table = cut.hierarchy().table("ground", 100).expect("a terrain has an extent");
    assert_eq!(cut.offer(&table).expect("a table"), table);
    let report = cut.update(&[view], &Budget::triangles(500));
    let near = cut.offer(&table).expect("a table");
    let at = |table: &LodTable| {
        let level = table.levels().iter().find(|level| level.triangles as usize <= report.triangles);
        level.expect("the base has fewer").accuracy
    };
    let radius_px = (view.lens(Default::default()).area_px2(&table.bounds()) / std::f32::consts::PI).sqrt();
    assert!((at(&near) - (1.0 - report.max_error_px / radius_px)).abs() < 0.02);
    assert!(near.lint().is_empty(), "{:?}", near.lint());
    let (split, merge) = cut.brink_px();
    assert!(split.zip(merge).is_some_and(|(split, merge)| split > 0.0 && merge > 0.0));
    assert_eq!(split, Some(report.max_error_px));
}
