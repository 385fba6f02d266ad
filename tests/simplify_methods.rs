//! Contracts of all methods of simplification, and a slow twin for those that have one.
#![cfg(feature = "bake")]

mod simplified;

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use glam::{Vec2, Vec3};
use lod_budget::bake::deviation::{Options, deviation};
use lod_budget::bake::shapes::{icosphere, terrain, torus_knot};
use lod_budget::bake::simplify::{
    AdaptiveCluster, Cluster, Melax, Method, Representative, Simplified, Simplifier, SimplifyError, Stopped,
    Target, Task, quietly,
};
use lod_budget::bake::{Group, Mesh, Skin, Surface};
use proptest::prelude::*;
use simplified::{borders, center, check, closed, euler, is_manifold, normal, perturb};

/// The methods that keep closed what is closed and manifold what is manifold.
const TOPOLOGICAL: [Method; 1] = [Method::Melax];

fn simplify(method: Method, task: &Task) -> Simplified {
    method.simplifier().simplify(task, &mut quietly).expect("the task keeps the rules")
}

fn method() -> impl Strategy<Value = Method> {
    prop::sample::select(&Method::ALL[..])
}

fn to(method: Method, surface: &Surface, triangles: usize) -> Simplified {
    let mesh = surface.clone().into();
    let task = Task::new(&mesh, Target::triangles(triangles));
    let result = simplify(method, &task);
    check(&task, &result);
    result
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn closed_manifolds_stay_so_with_as_many_handles(
        (mesh, characteristic) in closed(),
        share in 0.0..1.0f64,
        method in prop::sample::select(&TOPOLOGICAL[..]),
    ) {
        let target = Target::triangles((share * mesh.triangles.len() as f64) as usize);
        let task = Task::new(&mesh, target);
        let result = simplify(method, &task);
        check(&task, &result);
        let surface = result.mesh.surface();
        prop_assert!(borders(&surface).is_empty() && is_manifold(&surface), "{method}");
        prop_assert_eq!(euler(&surface), characteristic, "{}", method);
    }

    #[test]
    fn sheets_stay_sheets_and_keep_their_border(
        (side, seed, share) in (5..20u32, any::<u32>(), 0.3..1.0f64),
        method in prop::sample::select(&TOPOLOGICAL[..]),
    ) {
        let mesh = Mesh::from(terrain(side, seed));
        let task = Task::new(&mesh, Target::triangles((share * mesh.triangles.len() as f64) as usize));
        let result = simplify(method, &task);
        check(&task, &result);
        let surface = result.mesh.surface();
        prop_assert!(is_manifold(&surface), "{method}");
        prop_assert_eq!(euler(&surface), 1, "{}", method);
        for (a, b) in borders(&surface) {
            let off = |v: u32| {
                let p = result.mesh.positions[v as usize];
                p.x.min(p.y).min(1.0 - p.x).min(1.0 - p.y).abs()
            };
            prop_assert!(off(a).max(off(b)) < 0.05, "{method}");
        }
    }

    #[test]
    fn anything_goes_in_and_no_nonsense_comes_out(
        triangles in prop::collection::vec([0..12u32, 0..12, 0..12], 0..60),
        points in prop::collection::vec([0..4i8, 0..4, 0..3], 12),
        (target, error, method) in (0..60usize, prop_oneof![Just(f32::INFINITY), 0.0..3.0f32], method()),
        locked in prop::collection::vec(prop::bool::weighted(0.2), 12),
        weight in prop_oneof![Just(0.0f32), Just(1e30), Just(1.0)],
    ) {
        let positions = points.iter().map(|&[x, y, z]| Vec3::new(x.into(), y.into(), z.into())).collect();
        let mesh = with_looks(Mesh::from(Surface { positions, triangles }));
        let weights: Vec<f32> = (0..mesh.triangles.len()).map(|t| if t % 3 == 0 { weight } else { 1.0 }).collect();
        let target = Target { triangles: target, error };
        let task = Task { locked: &locked, weights: &weights, ..Task::new(&mesh, target) };
        let result = simplify(method, &task);
        check(&task, &result);
        prop_assert_eq!(&result, &simplify(method, &task));
        let lasts: BTreeSet<[u32; 3]> = result.mesh.positions.iter().map(|p| p.to_array().map(f32::to_bits)).collect();
        for v in (0..12).filter(|&v| locked[v] && result.heirs[v] != Simplified::GONE) {
            prop_assert!(lasts.contains(&mesh.positions[v].to_array().map(f32::to_bits)), "{method}");
        }
    }

    #[test]
    fn results_do_not_depend_on_the_unit(cuts in 3..6u32, power in -60..60i32, method in method()) {
        let mut sphere = icosphere(cuts);
        perturb(&mut sphere, 0.01, cuts);
        let scale = (power as f32).exp2();
        let scaled = Surface { positions: sphere.positions.iter().map(|&p| p * scale).collect(), ..sphere.clone() };
        let [small, large] = [&sphere, &scaled].map(|s| to(method, s, 60));
        prop_assert_eq!(small.mesh.triangles, large.mesh.triangles, "{}", method);
        prop_assert!(small.mesh.positions.iter().zip(&large.mesh.positions).all(|(&a, &b)| a * scale == b));
        prop_assert_eq!(small.error * scale, large.error);
    }

    /// Nothing is made up: what a wedge looks like, some wedge looked like before, in the same material.
    #[test]
    fn attributes_and_groups_are_those_that_were_there(side in 3..12u32, share in 0.1..1.0f64, method in method()) {
        let mesh = patchwork(side);
        let task = Task::new(&mesh, Target::triangles((share * mesh.triangles.len() as f64) as usize));
        let result = simplify(method, &task);
        check(&task, &result);
        for (wedge, &old) in result.wedge_origins.iter().enumerate() {
            prop_assert_eq!(result.mesh.uvs[0][wedge], mesh.uvs[0][old as usize]);
        }
        for group in &result.mesh.groups {
            let charts = result.mesh.triangles[group.triangles.clone()].as_flattened();
            let chart = |w: u32| result.mesh.uvs[0][w as usize].y.floor();
            prop_assert!(charts.iter().all(|&w| chart(w) == chart(charts[0])), "{method} crosses a seam");
        }
    }
}

/// Every triangle its own wedges, coloured by its index.
fn with_looks(mut mesh: Mesh) -> Mesh {
    mesh.wedges = mesh.surface().triangles.into_flattened();
    mesh.triangles = (0..mesh.wedges.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    mesh.normals = (0..mesh.wedges.len()).map(|w| Vec3::splat((w / 4) as f32)).collect();
    mesh
}

/// A terrain of two charts of texture and two materials, apart at x = ½.
fn patchwork(side: u32) -> Mesh {
    let terrain = terrain(2 * side, 3);
    let mut mesh = Mesh { positions: terrain.positions, ..Mesh::default() };
    let (left, right): (Vec<[u32; 3]>, Vec<[u32; 3]>) =
        terrain.triangles.iter().partition(|t| t.iter().all(|&v| mesh.positions[v as usize].x < 0.501));
    let count = mesh.positions.len() as u32;
    mesh.wedges = (0..count).chain(0..count).collect();
    let uv = |(w, &v): (usize, &u32)| {
        let p = mesh.positions[v as usize];
        Vec2::new(p.x, 0.5 * p.y + 10.0 * (w as u32 / count) as f32)
    };
    mesh.uvs = vec![mesh.wedges.iter().enumerate().map(uv).collect()];
    let shifted = right.iter().map(|t| t.map(|v| v + count));
    mesh.triangles = left.iter().copied().chain(shifted).collect();
    let group = |name: &str, triangles| Group { name: name.into(), triangles, ..Group::default() };
    mesh.groups = vec![group("left", 0..left.len()), group("right", left.len()..mesh.triangles.len())];
    mesh
}

#[test]
fn names_lead_to_methods_and_back() {
    for method in Method::ALL {
        assert_eq!(method.name().parse(), Ok(method));
    }
    let refused = "garland".parse::<Method>().expect_err("no method").to_string();
    assert!(Method::ALL.iter().all(|m| refused.contains(m.name())) && refused.contains("garland"));
}

#[test]
fn nothing_becomes_nothing_and_what_is_few_enough_stays() {
    for method in Method::ALL {
        for surface in [
            Surface::default(),
            Surface { positions: vec![Vec3::NAN], triangles: vec![] },
            Surface { positions: vec![Vec3::ONE; 2], triangles: vec![[0, 1, 1], [0, 0, 0]] },
        ] {
            assert_eq!(to(method, &surface, 0).mesh.surface(), Surface::default(), "{method}");
        }
        let sphere = icosphere(3);
        let same = to(method, &sphere, 180);
        let is_old = |(&old, &p): (&u32, &Vec3)| sphere.positions[old as usize] == p;
        assert!(same.origins.iter().zip(&same.mesh.positions).all(is_old), "{method}");
        let Simplified { mesh, error, stopped, .. } = same;
        assert_eq!((mesh.triangles.len(), error, stopped), (180, 0.0, Stopped::Triangles), "{method}");
    }
}

#[test]
fn points_in_one_place_do_no_harm() {
    for method in Method::ALL {
        let mut sphere = icosphere(6);
        sphere.positions.iter_mut().skip(20).for_each(|p| *p = Vec3::splat(0.25));
        to(method, &sphere, 30);
    }
}

/// Every rim vertex of a large fan is next to its hub.
#[test]
fn a_large_fan_takes_no_square_of_its_size() {
    let rim = 50_000u32;
    let around = |i: u32| std::f32::consts::TAU * i as f32 / rim as f32;
    let mut positions = vec![Vec3::ZERO];
    positions.extend((0..rim).map(|i| Vec3::new(around(i).cos(), around(i).sin(), -0.5)));
    let cone = Surface { positions, triangles: (0..rim).map(|i| [0, 1 + i, 1 + (i + 1) % rim]).collect() };
    for method in Method::ALL {
        assert_eq!(to(method, &cone, 100).stopped, Stopped::Triangles, "{method}");
    }
}

#[test]
fn an_error_is_kept_and_spent() {
    let sphere = Mesh::from(icosphere(20));
    for method in Method::ALL {
        let [fine, coarse] = [0.02, 0.3].map(|error| {
            let task = Task::new(&sphere, Target::error(error));
            let result = simplify(method, &task);
            check(&task, &result);
            assert_eq!(result.stopped, Stopped::Exhausted, "{method}");
            result.mesh.triangles.len()
        });
        assert!(2 * coarse < fine, "{method}: {coarse} {fine}");
    }
}

/// The uniform grid takes no note of weights but in where its vertices are.
#[test]
fn weights_keep_detail_where_they_are_high() {
    let sphere = icosphere(20);
    let weights: Vec<f32> =
        sphere.triangles.iter().map(|&t| if center(&sphere, t).x > 0.0 { 100.0 } else { 1.0 }).collect();
    let mesh = Mesh::from(sphere);
    for method in Method::ALL.into_iter().filter(|&m| m != Method::Cluster) {
        let task = Task { weights: &weights, ..Task::new(&mesh, Target::triangles(1_000)) };
        let result = simplify(method, &task).mesh.surface();
        let kept = result.triangles.iter().filter(|&&t| center(&result, t).x > 0.0).count();
        assert!(3 * kept > 2 * result.triangles.len(), "{method}: {kept} of {}", result.triangles.len());
    }
}

#[test]
fn a_cancelled_task_has_the_result_so_far() {
    let sphere = Mesh::from(icosphere(40));
    let task = Task::new(&sphere, Target::triangles(10));
    for method in Method::ALL {
        let mut calls = 0;
        let result = method.simplifier().simplify(&task, &mut |progress| {
            calls += 1;
            assert!(progress.from == 32_000 && progress.target == 10 && progress.triangles <= 32_000);
            ControlFlow::Break(())
        });
        let result = result.expect("the task keeps the rules");
        check(&task, &result);
        assert_eq!((result.stopped, calls), (Stopped::Cancelled, 1), "{method}");
    }
}

#[test]
fn what_breaks_a_rule_is_refused_by_every_method() {
    let mesh = Mesh::from(icosphere(1));
    let task = Task { locked: &[true], ..Task::new(&mesh, Target::triangles(4)) };
    for method in Method::ALL {
        let refused = method.simplifier().simplify(&task, &mut quietly);
        assert_eq!(refused, Err(SimplifyError::Locked { given: 1, vertices: 12 }), "{method}");
    }
}

/// A tenth of the triangles of smooth shapes, no farther off than a few times what the best method makes of them.
#[test]
fn a_tenth_of_the_triangles_still_has_the_shape() {
    let options = Options { max_samples: 20_000, relative: 0.05, ..Options::default() };
    for surface in [torus_knot(120, 24), terrain(50, 1)] {
        let off = |method| {
            let result = to(method, &surface, surface.triangles.len() / 10).mesh.surface();
            deviation(&surface, &result, &options).expect("both are surfaces").rms()
        };
        let best = off(Method::Quadric);
        for method in Method::ALL {
            let rms = off(method);
            assert!(rms < 10.0 * best, "{method}: {rms} against {best}");
        }
    }
}

/// Neither side of a thin wall is joined with the other while the error is less than it is thick.
#[test]
fn thin_walls_stay_two_sides_in_adaptive_clusters() {
    let mut wall = icosphere(24);
    wall.positions.iter_mut().for_each(|p| p.z *= 0.02);
    let result = to(Method::AdaptiveCluster, &wall, wall.triangles.len() / 8).mesh.surface();
    let up = result.triangles.iter().filter(|&&t| normal(&result, t).z > 0.0).count();
    assert!(borders(&result).is_empty());
    assert!(up > result.triangles.len() / 3 && up < 2 * result.triangles.len() / 3, "{up}");
    let volume: f64 =
        result.triangles.iter().map(|&t| normal(&result, t).dot(center(&result, t).as_dvec3())).sum();
    let whole: f64 = wall.triangles.iter().map(|&t| normal(&wall, t).dot(center(&wall, t).as_dvec3())).sum();
    assert!(volume > 0.8 * whole, "{volume} of {whole}");
}

#[test]
fn adaptive_clusters_do_not_join_what_different_joints_move() {
    let mut mesh = Mesh::from(icosphere(16));
    let skin = |joint| Skin { joints: [joint, 0, 0, 0], weights: [1.0, 0.0, 0.0, 0.0] };
    let joint = |v: usize| u16::from(mesh.positions[v].x > 0.1);
    let joints: Vec<u16> = (0..mesh.positions.len()).map(joint).collect();
    mesh.skins = joints.iter().map(|&j| skin(j)).collect();
    let task = Task::new(&mesh, Target::error(0.05));
    let result = AdaptiveCluster::default().simplify(&task, &mut quietly).expect("a good task");
    assert!(result.mesh.triangles.len() < 2_000);
    for (old, &heir) in result.heirs.iter().enumerate().filter(|(_, h)| **h != Simplified::GONE) {
        assert_eq!(joints[result.origins[heir as usize] as usize], joints[old]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// All edges are looked at anew before each collapse.
    #[test]
    fn melax_is_the_rule_of_the_article((cuts, bump, seed) in (2..5u32, 1e-3..2e-2f32, any::<u32>())) {
        let mut sphere = icosphere(cuts);
        perturb(&mut sphere, bump, seed);
        let target = sphere.triangles.len() / 2;
        let mesh = Mesh::from(sphere);
        let fast = Melax::default().simplify(&Task::new(&mesh, Target::triangles(target)), &mut quietly);
        let fast = fast.expect("a good task");
        let slow = melax_by_the_book::simplify(&mesh.surface(), target);
        prop_assert_eq!(fast.origins, slow);
    }

    /// Triangles between three cells, found one by one.
    #[test]
    fn clusters_are_those_of_some_grid(
        (cuts, seed, target) in (2..8u32, any::<u32>(), 4..400usize),
        representative in prop::sample::select(&[Representative::Quadric, Representative::Heaviest][..]),
    ) {
        let mut sphere = icosphere(cuts);
        perturb(&mut sphere, 0.02, seed);
        let mesh = Mesh::from(sphere.clone());
        let task = Task::new(&mesh, Target::triangles(target));
        let result = Cluster { representative }.simplify(&task, &mut quietly).expect("a good task");
        check(&task, &result);
        prop_assume!(result.mesh.triangles.len() < sphere.triangles.len());
        let grids = (1..400).map(|cells| cluster_by_brute_force::groups(&sphere, cells));
        let is_it = |groups: &Vec<Vec<u32>>| cluster_by_brute_force::groups_of(&result.heirs) == *groups;
        let mut grids = grids.skip_while(|groups| !is_it(groups));
        prop_assert!(grids.next().is_some());
        for (position, &origin) in result.mesh.positions.iter().zip(&result.origins) {
            let is_old = sphere.positions[origin as usize] == *position;
            prop_assert!(is_old || representative == Representative::Quadric);
        }
    }
}

/// S. Melax's article as it reads, with the guards of ours: every step looks at every edge.
mod melax_by_the_book {
    use std::collections::BTreeSet;

    use glam::DVec3;
    use lod_budget::bake::Surface;

    struct Mesh {
        places: Vec<DVec3>,
        triangles: Vec<[u32; 3]>,
    }

    /// The vertices that are left.
    pub fn simplify(surface: &Surface, target: usize) -> Vec<u32> {
        let places = surface.positions.iter().map(|p| p.as_dvec3()).collect();
        let mut mesh = Mesh { places, triangles: surface.triangles.clone() };
        while mesh.triangles.len() > target {
            let Some((from, to)) = mesh.cheapest() else { break };
            for triangle in &mut mesh.triangles {
                *triangle = triangle.map(|v| if v == from { to } else { v });
            }
            mesh.triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
        }
        let left: BTreeSet<u32> = mesh.triangles.into_flattened().into_iter().collect();
        left.into_iter().collect()
    }

    impl Mesh {
        fn cheapest(&self) -> Option<(u32, u32)> {
            let ends = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)];
            let moves = self.triangles.iter().flat_map(ends).filter(|&(from, to)| self.may_go(from, to));
            moves.min_by(|a, b| self.cost(*a).total_cmp(&self.cost(*b)).then(a.cmp(b)))
        }

        fn of(&self, vertex: u32) -> impl Iterator<Item = [u32; 3]> {
            self.triangles.iter().copied().filter(move |t| t.contains(&vertex))
        }

        fn normal(&self, triangle: [u32; 3]) -> DVec3 {
            let [a, b, c] = triangle.map(|v| self.places[v as usize]);
            (b - a).cross(c - a).normalize()
        }

        fn cost(&self, (from, to): (u32, u32)) -> f64 {
            let between: Vec<DVec3> =
                self.of(from).filter(|t| t.contains(&to)).map(|t| self.normal(t)).collect();
            let bend = |f: DVec3| between.iter().map(|n| (1.0 - f.dot(*n)) / 2.0).fold(1.0, f64::min);
            let bend = self.of(from).map(|t| bend(self.normal(t))).fold(0.0, f64::max);
            self.places[from as usize].distance(self.places[to as usize]) * bend
        }

        /// The two have two neighbours in common and are not a tetrahedron; nothing turns over.
        fn may_go(&self, from: u32, to: u32) -> bool {
            let ring = |v: u32| -> BTreeSet<u32> { self.of(v).flatten().filter(|&n| n != v).collect() };
            let shared: Vec<u32> = ring(from).intersection(&ring(to)).copied().collect();
            let moved = |t: [u32; 3]| t.map(|v| if v == from { to } else { v });
            let turns = |t: [u32; 3]| self.normal(t).dot(self.normal(moved(t))) < f64::from(0.2f32);
            let closes = |p: u32, q: u32| {
                let side = |v: u32| self.of(v).any(|t| t.contains(&p) && t.contains(&q));
                side(from) && side(to)
            };
            shared.len() == 2
                && !closes(shared[0], shared[1])
                && !self.of(from).filter(|t| !t.contains(&to)).any(turns)
        }
    }
}

mod cluster_by_brute_force {
    use lod_budget::bake::Surface;

    /// The vertices of each cell, ordered by their first, of so many cells along the longest side.
    pub fn groups(surface: &Surface, cells: u32) -> Vec<Vec<u32>> {
        let axis = |i: usize| surface.positions.iter().map(move |p| f64::from(p[i]));
        let low = [0, 1, 2].map(|i| axis(i).fold(f64::INFINITY, f64::min));
        let high = [0, 1, 2].map(|i| axis(i).fold(f64::NEG_INFINITY, f64::max));
        let side = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
        let cell = |v: u32| {
            [0, 1, 2].map(|i| {
                let along = (f64::from(surface.positions[v as usize][i]) - low[i]) / side * f64::from(cells);
                (along as u32).min(cells - 1)
            })
        };
        let cells: Vec<[u32; 3]> = (0..surface.positions.len() as u32).map(cell).collect();
        let alive = surface.triangles.iter().map(|t| t.map(|v| cells[v as usize]));
        let alive: Vec<[u32; 3]> = alive.filter(|[a, b, c]| a != b && b != c && c != a).flatten().collect();
        grouped(&cells, |cell| alive.contains(cell))
    }

    /// The vertices of each heir, ordered by their first.
    pub fn groups_of(heirs: &[u32]) -> Vec<Vec<u32>> {
        grouped(heirs, |&heir| heir != u32::MAX)
    }

    fn grouped<T: PartialEq>(keys: &[T], counts: impl Fn(&T) -> bool) -> Vec<Vec<u32>> {
        let is_first = |&v: &usize| !keys[..v].contains(&keys[v]) && counts(&keys[v]);
        let same =
            |first: usize| (0..keys.len()).filter(|&v| keys[v] == keys[first]).map(|v| v as u32).collect();
        (0..keys.len()).filter(is_first).map(same).collect()
    }
}
