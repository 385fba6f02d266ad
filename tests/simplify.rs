//! Contracts of simplification: what every result has to be, on shapes made at random and on input that is hardly a
//! mesh.
#![cfg(feature = "bake")]

mod simplified;

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use glam::Vec3;
use lod_budget::bake::deviation::{Options, Ruler};
use lod_budget::bake::shapes::{icosphere, terrain, torus, torus_knot};
use lod_budget::bake::simplify::{
    Cost, GarlandHeckbert, Placement, Simplified, Simplifier, SimplifyError, Stopped, Target, Task, Topology,
    quietly,
};
use lod_budget::bake::{Mesh, Surface};
use proptest::prelude::*;
use simplified::{borders, center, check, closed, euler, is_manifold, normal, perturb};

const PLACEMENTS: [Placement; 5] =
    [Placement::Balanced, Placement::Optimal, Placement::Endpoint, Placement::Midpoint, Placement::Average];

fn simplify(method: &GarlandHeckbert, task: &Task) -> Simplified {
    method.simplify(task, &mut quietly).expect("the task keeps the rules")
}

fn to(surface: &Surface, triangles: usize) -> Simplified {
    let mesh = surface.clone().into();
    simplify(&GarlandHeckbert::default(), &Task::new(&mesh, Target::triangles(triangles)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn closed_manifolds_stay_so_with_as_many_handles(
        (mesh, characteristic) in closed(),
        share in 0.0..1.0f64,
        placement in prop::sample::select(&PLACEMENTS[..]),
    ) {
        let method = GarlandHeckbert { placement, ..Default::default() };
        let target = Target::triangles((share * mesh.triangles.len() as f64) as usize);
        let task = Task::new(&mesh, target);
        let result = simplify(&method, &task);
        check(&task, &result);
        let surface = result.mesh.surface();
        prop_assert!(borders(&surface).is_empty() && is_manifold(&surface));
        prop_assert_eq!(euler(&surface), characteristic);
    }

    /// The record is the twin: done again on a bare list of triangles, it leaves what the method leaves.
    #[test]
    fn the_record_done_again_is_the_result((mesh, _) in closed(), share in 0.0..1.0f64) {
        let target = Target::triangles((share * mesh.triangles.len() as f64) as usize);
        let (result, record) =
            GarlandHeckbert::default().record(&Task::new(&mesh, target), &mut quietly).expect("it keeps the rules");
        let mut positions = mesh.positions.clone();
        let mut triangles = mesh.surface().triangles;
        for step in &record {
            positions[step.kept as usize] = step.position;
            triangles.iter_mut().flatten().filter(|v| **v == step.gone).for_each(|v| *v = step.kept);
        }
        triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
        let places = |[a, b, c]: [u32; 3], of: &[Vec3]| [a, b, c].map(|v| of[v as usize]);
        let again: Vec<[Vec3; 3]> = triangles.into_iter().map(|t| places(t, &positions)).collect();
        let surface = result.mesh.surface();
        let left: Vec<[Vec3; 3]> = surface.triangles.iter().map(|&t| places(t, &surface.positions)).collect();
        prop_assert_eq!(again, left);
    }

    #[test]
    fn sheets_stay_sheets_and_keep_their_border(
        (side, seed, share) in (10..20u32, any::<u32>(), 0.2..1.0f64),
    ) {
        let mesh = Mesh::from(terrain(side, seed));
        let task = Task::new(&mesh, Target::triangles((share * mesh.triangles.len() as f64) as usize));
        let result = simplify(&GarlandHeckbert::default(), &task);
        check(&task, &result);
        let surface = result.mesh.surface();
        prop_assert!(is_manifold(&surface));
        prop_assert_eq!(euler(&surface), 1);
        for (a, b) in borders(&surface) {
            let [a, b] = [a, b].map(|v| result.mesh.positions[v as usize]);
            let off = |p: Vec3| p.x.min(p.y).min(1.0 - p.x).min(1.0 - p.y).abs();
            prop_assert!(off(a).max(off(b)) < 0.02 && off(0.5 * (a + b)) < 0.05, "{a} {b}");
        }
    }

    #[test]
    fn anything_goes_in_and_no_nonsense_comes_out(
        triangles in prop::collection::vec([0..12u32, 0..12, 0..12], 0..60),
        points in prop::collection::vec([0..4i8, 0..4, 0..3], 12),
        (target, pairs, topology, placement) in (
            0..60usize,
            prop::sample::select(&[0.0, 1.5, f32::INFINITY][..]),
            prop::sample::select(&[Topology::Preserved, Topology::Free][..]),
            prop::sample::select(&PLACEMENTS[..]),
        ),
        locked in prop::collection::vec(prop::bool::weighted(0.2), 12),
    ) {
        let positions = points.iter().map(|&[x, y, z]| Vec3::new(x.into(), y.into(), z.into())).collect();
        let mesh = Mesh::from(Surface { positions, triangles });
        let task = Task { locked: &locked, ..Task::new(&mesh, Target::triangles(target)) };
        let result = simplify(&GarlandHeckbert { placement, topology, pairs, ..Default::default() }, &task);
        check(&task, &result);
        let lasts: BTreeSet<[u32; 3]> = result.mesh.positions.iter().map(|p| p.to_array().map(f32::to_bits)).collect();
        for v in (0..12).filter(|&v| locked[v] && result.heirs[v] != Simplified::GONE) {
            prop_assert!(lasts.contains(&mesh.positions[v].to_array().map(f32::to_bits)));
        }
    }

    #[test]
    fn results_do_not_depend_on_the_unit(cuts in 3..6u32, power in -60..60i32) {
        let sphere = icosphere(cuts);
        let scale = (power as f32).exp2();
        let scaled = Surface { positions: sphere.positions.iter().map(|&p| p * scale).collect(), ..sphere.clone() };
        let [small, large] = [&sphere, &scaled].map(|s| to(s, 60).mesh);
        prop_assert_eq!(small.triangles, large.triangles);
        prop_assert!(small.positions.iter().zip(&large.positions).all(|(&a, &b)| a * scale == b));
    }
}

/// The least cosine between a triangle of a simplified surface and the nearest one of the original.
fn least_cos(surface: &Surface, share: usize) -> f64 {
    let result = to(surface, surface.triangles.len() / share).mesh.surface();
    let cos = |&triangle: &[u32; 3]| {
        let at = center(&result, triangle);
        let near = |&&t: &&[u32; 3]| (center(surface, t).distance_squared(at) * 1e6) as u64;
        let old = *surface.triangles.iter().min_by_key(near).expect("there are triangles");
        normal(&result, triangle).normalize().dot(normal(surface, old).normalize())
    };
    result.triangles.iter().map(cos).fold(1.0, f64::min)
}

#[test]
fn no_triangle_of_a_smooth_surface_turns_over() {
    for (surface, name) in [(icosphere(20), "sphere"), (torus_knot(400, 32), "knot")] {
        for share in [2, 8, 16] {
            let cos = least_cos(&surface, share);
            assert!(cos > 0.5, "{cos} at one in {share} of the {name}");
        }
    }
}

/// A ball and a small one far away, whose last triangles lie in no plane's way.
#[test]
fn an_error_keeps_parts_that_free_topology_could_drop() {
    let mut both = icosphere(6);
    let first = both.positions.len() as u32;
    let Surface { positions, triangles } = icosphere(2);
    both.positions.extend(positions.iter().map(|&p| 0.2 * p + 5.0 * Vec3::X));
    both.triangles.extend(triangles.iter().map(|t| t.map(|v| v + first)));
    let mesh = Mesh::from(both);
    let method = GarlandHeckbert { topology: Topology::Free, ..Default::default() };
    let has_small = |target| {
        let result = simplify(&method, &Task::new(&mesh, target));
        result.mesh.positions.iter().any(|p| p.x > 4.0)
    };
    assert!(has_small(Target::error(1e-3)) && !has_small(Target::triangles(8)));
}

/// A plate and a single triangle, far away: a needle, whose tip is at neither end of the edge that goes.
#[test]
fn an_error_keeps_needles_that_free_topology_could_drop() {
    let mut both = terrain(20, 0);
    let first = both.positions.len() as u32;
    both.positions.extend([[0.0, 0.0, 5.0], [0.1, 0.0, 5.0], [0.1, 0.005, 5.0]].map(Vec3::from_array));
    both.triangles.push([first, first + 1, first + 2]);
    let mesh = Mesh::from(both);
    let method = GarlandHeckbert { topology: Topology::Free, ..Default::default() };
    let has_needle = |target| {
        let result = simplify(&method, &Task::new(&mesh, target));
        result.mesh.positions.iter().any(|p| p.z > 4.0)
    };
    assert!(has_needle(Target::error(0.05)) && !has_needle(Target::error(0.2)));
}

#[test]
fn a_balanced_sphere_is_nearer_on_average_and_hardly_farther_anywhere() {
    let sphere = icosphere(20);
    let mesh = Mesh::from(sphere.clone());
    let ruler = Ruler::new(&sphere).expect("a sphere has a surface");
    for share in [4, 10, 30] {
        let target = Target::triangles(mesh.triangles.len() / share);
        let [balanced, optimal] = [Placement::Balanced, Placement::Optimal].map(|placement| {
            let method = GarlandHeckbert { placement, ..Default::default() };
            let left = simplify(&method, &Task::new(&mesh, target)).mesh.surface();
            ruler.deviation(&left, &Options::default()).expect("what is left has a surface")
        });
        assert!(balanced.rms() < 0.9 * optimal.rms(), "1 in {share}: {balanced:?}, {optimal:?}");
        assert!(balanced.hausdorff < 1.05 * optimal.hausdorff, "1 in {share}: {balanced:?}, {optimal:?}");
    }
}

/// A tube without rings along it, whose triangles are all slivers.
#[test]
fn a_plain_cylinder_gets_fewer_sides() {
    let sides = 64;
    let around = |i: u32| std::f32::consts::TAU * i as f32 / sides as f32;
    let rim = |y: f32| (0..sides).map(move |i| Vec3::new(0.16 * around(i).cos(), y, 0.16 * around(i).sin()));
    let next = |i: u32| (i + 1) % sides;
    let cylinder = Surface {
        positions: rim(0.0).chain(rim(5.0)).collect(),
        triangles: (0..sides)
            .flat_map(|i| [[i, i + sides, next(i)], [next(i), i + sides, next(i) + sides]])
            .collect(),
    };
    assert_eq!(to(&cylinder, 24).mesh.triangles.len(), 24);
}

/// Each turn was less than the guard allows, but a triangle may turn many times.
#[test]
fn turns_do_not_add_up_until_a_triangle_is_over() {
    for (rings, sides) in [(200, 16), (300, 12), (100, 20)] {
        for share in [2, 4, 8, 16, 32] {
            let cos = least_cos(&torus_knot(rings, sides), share);
            assert!(cos > 0.0, "{cos} at one in {share} of the knot of {rings} rings");
        }
    }
}

/// Two surfaces, the second moved.
fn beside(surface: &Surface, by: Vec3) -> Mesh {
    let Surface { mut positions, mut triangles } = surface.clone();
    let count = positions.len() as u32;
    positions.extend(surface.positions.iter().map(|&p| p + by));
    triangles.extend(surface.triangles.iter().map(|t| t.map(|v| v + count)));
    Mesh::from(Surface { positions, triangles })
}

/// How many parts a surface has that are not joined by a vertex.
fn parts(surface: &Surface) -> usize {
    let mut part: Vec<usize> = (0..surface.positions.len()).collect();
    for [a, b] in surface.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c]]) {
        let [old, new] = [part[a as usize], part[b as usize]];
        part.iter_mut().filter(|p| **p == old).for_each(|p| *p = new);
    }
    part.into_iter().collect::<BTreeSet<usize>>().len()
}

#[test]
fn parts_that_are_near_enough_grow_together() {
    for mesh in [beside(&torus(24, 12, 0.3), Vec3::X * 2.62), beside(&terrain(12, 1), Vec3::Z * 0.02)] {
        let joined = |pairs: f32, topology: Topology| {
            let method = GarlandHeckbert { pairs, topology, ..Default::default() };
            let task = Task::new(&mesh, Target::triangles(mesh.triangles.len() / 4));
            let result = simplify(&method, &task);
            check(&task, &result);
            parts(&result.mesh.surface()) == 1
        };
        assert!(joined(0.05, Topology::Free), "near enough");
        assert!(!joined(0.01, Topology::Free), "too far");
        assert!(!joined(0.0, Topology::Free) && !joined(0.05, Topology::Preserved), "edges alone");
    }
}

#[test]
fn a_plane_costs_nothing_and_becomes_two_triangles() {
    let mut plane = terrain(20, 0);
    plane.positions.iter_mut().for_each(|p| p.z = 0.5);
    let result = to(&plane, 2);
    assert_eq!((result.mesh.triangles.len(), result.stopped), (2, Stopped::Triangles));
    assert!(result.error < 2e-6, "{}", result.error);
    let surface = result.mesh.surface();
    let area: f64 = surface.triangles.iter().map(|&t| normal(&surface, t).length() / 2.0).sum();
    assert!((area - 1.0).abs() < 1e-5, "{area}");
}

#[test]
fn an_error_is_kept_and_spent() {
    let sphere = Mesh::from(icosphere(20));
    let [fine, coarse] = [2e-3, 2e-2].map(|error| {
        let task = Task::new(&sphere, Target::error(error));
        let result = simplify(&GarlandHeckbert::default(), &task);
        check(&task, &result);
        assert_eq!(result.stopped, Stopped::Exhausted);
        assert!(result.error > 0.5 * error, "{} of {error}", result.error);
        result.mesh.triangles.len()
    });
    assert!(4 * coarse < fine && fine < sphere.triangles.len(), "{coarse} {fine}");
}

#[test]
fn weights_keep_detail_where_they_are_high() {
    let sphere = icosphere(20);
    let weights: Vec<f32> =
        sphere.triangles.iter().map(|&t| if center(&sphere, t).x > 0.0 { 100.0 } else { 1.0 }).collect();
    let mesh = Mesh::from(sphere);
    let task = Task { weights: &weights, ..Task::new(&mesh, Target::triangles(1_000)) };
    let result = simplify(&GarlandHeckbert::default(), &task).mesh.surface();
    let kept = result.triangles.iter().filter(|&&t| center(&result, t).x > 0.0).count();
    assert!(kept > 650, "{kept}");
}

#[test]
fn end_points_are_old_vertices_bit_by_bit() {
    let knot = Mesh::from(torus_knot(60, 8));
    let method = GarlandHeckbert { placement: Placement::Endpoint, ..Default::default() };
    let result = simplify(&method, &Task::new(&knot, Target::triangles(200)));
    for (position, &origin) in result.mesh.positions.iter().zip(&result.origins) {
        assert_eq!(*position, knot.positions[origin as usize]);
    }
}

#[test]
fn shapes_that_can_become_nothing_stop_at_their_topology() {
    assert_eq!(to(&icosphere(4), 0).mesh.triangles.len(), 4);
    assert_eq!(euler(&to(&torus(12, 8, 0.3), 0).mesh.surface()), 0);
    let single = Surface { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]] };
    assert_eq!(to(&single, 0).mesh.surface(), single);
}

#[test]
fn nothing_becomes_nothing() {
    for surface in [
        Surface::default(),
        Surface { positions: vec![Vec3::NAN], triangles: vec![] },
        Surface { positions: vec![Vec3::ONE; 2], triangles: vec![[0, 1, 1], [0, 0, 0]] },
    ] {
        let result = to(&surface, 0);
        assert_eq!((result.mesh.surface(), result.stopped), (Surface::default(), Stopped::Triangles));
    }
}

#[test]
fn points_in_one_place_do_no_harm() {
    let mut sphere = icosphere(6);
    sphere.positions.iter_mut().skip(20).for_each(|p| *p = Vec3::splat(0.25));
    let sphere = Mesh::from(sphere);
    let task = Task::new(&sphere, Target::triangles(30));
    check(&task, &simplify(&GarlandHeckbert::default(), &task));
}

/// A fan of more triangles than a vertex may have to be contracted: its rim goes first.
#[test]
fn a_large_fan_is_thinned_from_its_rim() {
    let rim = 5_000u32;
    let around = |i: u32| std::f32::consts::TAU * i as f32 / rim as f32;
    let mut positions = vec![Vec3::ZERO];
    positions.extend((0..rim).map(|i| Vec3::new(around(i).cos(), around(i).sin(), -0.5)));
    let triangles = (0..rim).map(|i| [0, 1 + i, 1 + (i + 1) % rim]).collect();
    let cone = Surface { positions, triangles };
    assert_eq!(to(&cone, 100).mesh.triangles.len(), 100);
}

#[test]
fn a_cancelled_task_has_the_result_so_far() {
    let sphere = Mesh::from(icosphere(40));
    let task = Task::new(&sphere, Target::triangles(10));
    let mut calls = 0;
    let result = GarlandHeckbert::default().simplify(&task, &mut |progress| {
        calls += 1;
        assert!(progress.from == 32_000 && progress.target == 10 && progress.triangles <= 32_000);
        if calls == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let result = result.expect("the task keeps the rules");
    check(&task, &result);
    assert_eq!((result.stopped, calls), (Stopped::Cancelled, 2));
    assert!(result.mesh.triangles.len() > 10_000);
}

#[test]
fn what_breaks_a_rule_is_refused_by_name() {
    let good = Mesh::from(icosphere(1));
    let error =
        |task: Task| GarlandHeckbert::default().simplify(&task, &mut quietly).expect_err("a broken task");
    let target = Target::triangles(4);

    let mut index = good.clone();
    index.triangles[3][1] = 12;
    assert_eq!(
        error(Task::new(&index, target)),
        SimplifyError::Mesh(index.check().expect_err("a broken mesh"))
    );
    let mut nan = good.clone();
    nan.positions[11].y = f32::NAN;
    let refused = error(Task::new(&nan, target));
    assert_eq!(refused, SimplifyError::NotFinite { triangle: 0, vertex: 11 });
    assert!(refused.to_string().contains("triangle 0") && refused.to_string().contains("vertex 11"));

    let task = Task::new(&good, target);
    assert_eq!(error(Task { locked: &[true], ..task }), SimplifyError::Locked { given: 1, vertices: 12 });
    assert_eq!(error(Task { weights: &[1.0], ..task }), SimplifyError::Weights { given: 1, triangles: 20 });
    let weights: Vec<f32> = (0..20).map(|i| 2.0 - i as f32).collect();
    assert_eq!(error(Task { weights: &weights, ..task }), SimplifyError::Weight { triangle: 3 });
}

/// The algorithm of the paper as it reads: every step looks at every edge anew, with nothing remembered but the
/// quadrics, which are plain 4×4 matrices. Neither guards nor topology.
mod by_the_book {
    use glam::{DMat3, DMat4, DVec3, DVec4};
    use lod_budget::bake::Surface;

    struct Mesh {
        places: Vec<DVec3>,
        quadrics: Vec<DMat4>,
        areas: Vec<f64>,
        triangles: Vec<[usize; 3]>,
    }

    /// The largest error of a contraction, root of the mean square, after each step down to so many triangles.
    pub fn errors(surface: &Surface, target: usize) -> Vec<(usize, f64)> {
        let mut mesh = Mesh::new(surface);
        let (mut errors, mut worst) = (Vec::new(), 0f64);
        while mesh.triangles.len() > target {
            let (cost, place, [kept, gone]) = mesh.cheapest();
            mesh.contract(kept, gone, place);
            worst = worst.max((cost / mesh.areas[kept]).sqrt());
            errors.push((mesh.triangles.len(), worst));
        }
        errors
    }

    impl Mesh {
        fn new(surface: &Surface) -> Self {
            let places: Vec<DVec3> = surface.positions.iter().map(|p| p.as_dvec3()).collect();
            let triangles: Vec<[usize; 3]> =
                surface.triangles.iter().map(|t| t.map(|v| v as usize)).collect();
            let count = places.len();
            let mut mesh =
                Self { places, quadrics: vec![DMat4::ZERO; count], areas: vec![0.0; count], triangles };
            for &triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|v| mesh.places[v]);
                let across = (b - a).cross(c - a);
                let (normal, area) = (across.normalize(), across.length() / 2.0);
                let plane = normal.extend(-normal.dot(a));
                let quadric =
                    DMat4::from_cols(plane * plane.x, plane * plane.y, plane * plane.z, plane * plane.w);
                for v in triangle {
                    mesh.quadrics[v] += quadric * area;
                    mesh.areas[v] += area;
                }
            }
            mesh
        }

        fn cheapest(&self) -> (f64, DVec3, [usize; 2]) {
            let edges = self.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let costs = edges.filter(|[a, b]| a < b).map(|[a, b]| {
                let (cost, place) = self.cost(a, b);
                (cost, place, [a, b])
            });
            costs.min_by(|a, b| a.0.total_cmp(&b.0)).expect("there are edges")
        }

        fn cost(&self, a: usize, b: usize) -> (f64, DVec3) {
            let sum = self.quadrics[a] + self.quadrics[b];
            let place = -(DMat3::from_mat4(sum).inverse() * sum.w_axis.truncate());
            let at: DVec4 = place.extend(1.0);
            (at.dot(sum * at).max(0.0), place)
        }

        fn contract(&mut self, kept: usize, gone: usize, place: DVec3) {
            self.places[kept] = place;
            self.quadrics[kept] = self.quadrics[kept] + self.quadrics[gone];
            self.areas[kept] += self.areas[gone];
            for triangle in &mut self.triangles {
                *triangle = triangle.map(|v| if v == gone { kept } else { v });
            }
            self.triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// The lazy queue, the errors seen from their vertices and all else that makes it fast change nothing: the same
    /// contractions, to rounding and the weak spring.
    #[test]
    fn the_errors_are_those_of_the_paper((cuts, bump, seed) in (3..6u32, 1e-3..1e-2f32, any::<u32>())) {
        let mut sphere = icosphere(cuts);
        perturb(&mut sphere, bump, seed);
        let method = GarlandHeckbert {
            cost: Cost::Sum,
            placement: Placement::Optimal,
            least_turn: 0.0,
            least_shape: 0.0,
            ..Default::default()
        };
        let slow = by_the_book::errors(&sphere, sphere.triangles.len() / 2);
        let mesh = Mesh::from(sphere);
        for &(triangles, error) in slow.iter().step_by(7) {
            let fast = simplify(&method, &Task::new(&mesh, Target::triangles(triangles)));
            prop_assert_eq!(fast.mesh.triangles.len(), triangles);
            let fast = f64::from(fast.error);
            prop_assert!((fast - error).abs() < 0.01 * error, "{triangles} triangles: {fast} but {error}");
        }
    }
}
