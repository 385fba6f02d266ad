//! Contracts of baked chains: what a table says of its levels is true, whatever the mesh and the plan.
#![cfg(feature = "bake")]

use std::ops::ControlFlow;

use glam::{DVec3, Vec3};
use lod_budget::bake::chain::{
    Accuracy, BakeError, Chain, Length, Limits, Look, Plan, Preset, Progress, Reason, Stops, quietly,
};
use lod_budget::bake::deviation;
use lod_budget::bake::shapes::{icosphere, terrain, torus};
use lod_budget::bake::simplify::Method;
use lod_budget::bake::{Group, Mesh, Surface};
use lod_budget::table::{Level, MAX_LEVELS, accuracy_of};
use proptest::prelude::*;

const ACCURACIES: [Accuracy; 3] = [Accuracy::Rms, Accuracy::Hausdorff, Accuracy::Triangles];

fn bake(plan: &Plan, mesh: &Mesh) -> Chain {
    plan.bake(mesh, &mut quietly).expect("mesh and plan keep the rules")
}

fn refused(plan: &Plan, mesh: &Mesh) -> BakeError {
    plan.bake(mesh, &mut quietly).expect_err("must be refused")
}

fn plan(stops: Stops) -> Plan {
    Plan { stops, limits: Limits::NONE, ..quick() }
}

/// Few samples: root mean squares are another test's.
fn quick() -> Plan {
    let measure = deviation::Options { max_samples: 1 << 10, ..deviation::Options::default() };
    Plan { measure, look: None, ..Plan::default() }
}

fn counts(chain: &Chain) -> Vec<usize> {
    chain.levels.iter().map(|level| level.triangles()).collect()
}

fn diagonal(mesh: &Mesh) -> f64 {
    let bounds = mesh.bounds();
    (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length()
}

fn tetrahedron() -> Mesh {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    Surface { positions, triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] }.into()
}

fn one_triangle() -> Mesh {
    Surface { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]] }.into()
}

// -- the slow twin of measuring: points of one surface against every triangle of the other

fn to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = (b - a).length_squared();
    let t = if along > 0.0 { ((p - a).dot(b - a) / along).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(a + (b - a) * t)
}

/// To the plane where the foot of the perpendicular is inside, else to the nearest side.
fn to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let is_inside = [(a, b), (b, c), (c, a)].iter().all(|&(s, e)| (e - s).cross(p - s).dot(normal) >= 0.0);
    if is_inside && normal.length_squared() > 0.0 {
        return (p - a).dot(normal).abs() / normal.length();
    }
    to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a))
}

fn corners(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    let surface = mesh.surface();
    (0..surface.triangles.len()).map(|t| surface.corners(t).map(|p| p.as_dvec3())).collect()
}

/// The largest distance from points of `from`, some on every triangle, to `to`.
fn one_way(from: &[[DVec3; 3]], to: &[[DVec3; 3]]) -> f64 {
    const STEPS: u32 = 3;
    let points = from.iter().flat_map(|&[a, b, c]| {
        let place = move |i: u32, j: u32| {
            a + (b - a) * (f64::from(i) / f64::from(STEPS)) + (c - a) * (f64::from(j) / f64::from(STEPS))
        };
        (0..=STEPS).flat_map(move |i| (0..=STEPS - i).map(move |j| place(i, j)))
    });
    let distance = |p: DVec3| to.iter().map(|&t| to_triangle(p, t)).fold(f64::INFINITY, f64::min);
    points.map(distance).fold(0.0, f64::max)
}

fn sampled_distance(a: &Mesh, b: &Mesh) -> f64 {
    let (a, b) = (corners(a), corners(b));
    one_way(&a, &b).max(one_way(&b, &a))
}

/// A closed or open shape, its vertices pushed about by up to `bump`.
fn shape() -> impl Strategy<Value = Mesh> {
    let sphere = (3..8u32).prop_map(icosphere);
    let ring = (6..16u32, 5..10u32, 0.2..0.5f32).prop_map(|(r, s, tube)| torus(r, s, tube));
    let land = (6..16u32, any::<u32>()).prop_map(|(n, seed)| terrain(n, seed));
    (prop_oneof![sphere, ring, land], 0.0..0.05f32, any::<u32>()).prop_map(|(mut surface, bump, seed)| {
        let mut state = u64::from(seed) << 1 | 1;
        let mut random = || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (state >> 40) as f32 / (1 << 23) as f32 - 1.0
        };
        surface.positions.iter_mut().for_each(|p| *p += bump * Vec3::new(random(), random(), random()));
        surface.into()
    })
}

fn stops() -> impl Strategy<Value = Stops> {
    let falling = |mut shares: Vec<f64>| {
        shares.sort_by(|a, b| b.total_cmp(a));
        shares.dedup();
        shares
    };
    prop_oneof![
        (0.2..0.8).prop_map(Stops::Ratio),
        prop::collection::vec(0.05..0.95, 1..5).prop_map(move |shares| Stops::Shares(falling(shares))),
        prop::collection::btree_set(1..300usize, 1..5)
            .prop_map(|counts| Stops::Triangles(counts.into_iter().rev().collect())),
    ]
}

/// What holds of every chain.
fn check(mesh: &Mesh, chain: &Chain) {
    let level_0 = &chain.levels[0];
    assert_eq!((level_0.mesh.surface(), level_0.error), (mesh.surface(), 0.0));
    assert!(chain.levels.len() <= MAX_LEVELS);
    for (finer, level) in chain.levels.iter().zip(&chain.levels[1..]) {
        assert!(level.triangles() < finer.triangles());
        assert!(level.error >= finer.error && f64::from(level.error) >= level.deviation.hausdorff);
        assert_eq!(level.mesh.check(), Ok(()));
        let sampled = sampled_distance(mesh, &level.mesh);
        assert!(f64::from(level.error) >= sampled - 1e-12 * diagonal(mesh), "{} < {sampled}", level.error);
    }
    ACCURACIES.iter().for_each(|&accuracy| check_table(chain, accuracy));
}

fn check_table(chain: &Chain, accuracy: Accuracy) {
    let table = chain.table(accuracy).expect("a table");
    let records = table.levels();
    assert_eq!(records.len(), chain.levels.len());
    assert_eq!((records[0].accuracy, records[0].error), (1.0, Some(0.0)));
    let falls = records.windows(2).all(|pair| {
        pair[1].accuracy <= pair[0].accuracy
            && pair[1].error >= pair[0].error
            && pair[1].min_size <= pair[0].min_size
            && pair[1].bytes <= pair[0].bytes
    });
    assert!(falls && records.iter().all(|r| (0.0..=1.0).contains(&r.accuracy)), "{records:?}");
    let bound = table.bounds();
    let is_inside = |p: &Vec3| p.as_dvec3().distance(bound.center.as_dvec3()) <= f64::from(bound.radius);
    assert!(chain.levels.iter().all(|level| level.mesh.positions.iter().all(is_inside)));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    #[test]
    fn every_chain_is_coarser_farther_and_bounded(mesh in shape(), stops in stops()) {
        check(&mesh, &bake(&plan(stops), &mesh));
    }

    #[test]
    fn levels_for_target_errors_are_within_them(mesh in shape(), targets in prop::collection::vec(0.002..0.2f64, 1..4)) {
        let lengths = targets.iter().map(|&share| Length::OfDiagonal(share)).collect();
        let chain = bake(&plan(Stops::Errors(lengths)), &mesh);
        check(&mesh, &chain);
        prop_assert!(chain.levels.len() <= targets.len() + 1);
        let most = targets.iter().copied().fold(0.0, f64::max) * diagonal(&mesh);
        let mut coarser = chain.levels[1..].iter();
        prop_assert!(coarser.all(|level| level.deviation.hausdorff <= most * (1.0 + 1e-9)));
    }
}

#[test]
fn counts_of_triangles_are_met() {
    let ball = icosphere(12).into();
    let halves = bake(&Plan { limits: Limits { levels: 5, ..Limits::NONE }, ..quick() }, &ball);
    assert_eq!(counts(&halves), [2880, 1440, 720, 360, 180]);
    let named = bake(&plan(Stops::Triangles(vec![5000, 1000, 100])), &ball);
    assert_eq!(counts(&named), [2880, 1000, 100]);
    let shares = bake(&plan(Stops::Shares(vec![0.5, 0.1])), &ball);
    assert_eq!(counts(&shares), [2880, 1440, 288]);
    assert!([halves, named, shares].iter().all(|chain| chain.left_out.is_empty()));
}

/// The search has to come near its targets from below, or levels would be finer than anybody asked for.
#[test]
fn target_errors_are_used_up() {
    let ball: Mesh = icosphere(16).into();
    let targets = [0.002, 0.01, 0.05];
    let lengths = targets.iter().map(|&share| Length::OfDiagonal(share)).collect();
    let chain = bake(&plan(Stops::Errors(lengths)), &ball);
    assert_eq!(chain.levels.len(), 4);
    for (level, share) in chain.levels[1..].iter().zip(targets) {
        let of_target = level.deviation.hausdorff / (share * diagonal(&ball));
        assert!((0.7..=1.0).contains(&of_target), "{of_target} of {share}");
    }
    let units = targets.map(|share| Length::Units(share * diagonal(&ball))).to_vec();
    assert_eq!(counts(&bake(&plan(Stops::Errors(units)), &ball)), counts(&chain));
}

#[test]
fn the_automatic_chain_ends_where_its_limits_say() {
    let ball: Mesh = icosphere(16).into();
    let limits = Limits { most_error: Some(Length::OfDiagonal(0.01)), ..Limits::default() };
    let chain = bake(&Plan { limits, ..quick() }, &ball);
    let last = chain.levels.last().expect("level 0 at least");
    assert!(last.deviation.hausdorff <= 0.01 * diagonal(&ball) && last.triangles() > 16);
    assert!(!chain.left_out.is_empty() && chain.left_out.iter().all(|level| level.reason == Reason::TooFar));
    let coarse = bake(&Plan { limits: Limits { most_error: None, ..limits }, ..quick() }, &ball);
    assert!((16..32).contains(coarse.levels.last().map(|level| level.triangles()).as_ref().unwrap_or(&0)));
}

#[test]
fn what_a_method_cannot_reach_is_left_out_and_told() {
    let chain = bake(&plan(Stops::Triangles(vec![3, 2, 1])), &tetrahedron());
    assert_eq!(counts(&chain), [4]);
    assert_eq!(chain.left_out.len(), 3);
    assert!(chain.left_out.iter().all(|level| level.reason == Reason::NotCoarser && level.triangles == 4));
    let torus: Mesh = torus(12, 8, 0.3).into();
    let chain = bake(&plan(Stops::Triangles(vec![100, 8, 4])), &torus);
    assert!(chain.levels.windows(2).all(|pair| pair[1].triangles() < pair[0].triangles()));
    assert_eq!(chain.levels.len() + chain.left_out.len(), 4);
}

#[test]
fn a_level_that_saves_too_little_is_left_out() {
    let ball = icosphere(8).into();
    let stops = Stops::Shares(vec![0.9, 0.75, 0.7, 0.3]);
    let limits = Limits { least_gain: 0.2, ..Limits::NONE };
    let chain = bake(&Plan { limits, ..plan(stops) }, &ball);
    assert_eq!(counts(&chain), [1280, 960, 384]);
    assert_eq!(chain.left_out.iter().map(|level| level.triangles).collect::<Vec<_>>(), [1152, 896]);
}

#[test]
fn one_triangle_is_a_chain_of_one_level() {
    for stops in [Stops::Ratio(0.5), Stops::Shares(vec![0.5]), Stops::Errors(vec![Length::OfDiagonal(0.5)])] {
        let chain = bake(&plan(stops), &one_triangle());
        assert_eq!(counts(&chain), [1]);
        let table = chain.table(Accuracy::default()).expect("a table");
        assert_eq!(table.coarsest(), Level::FINEST);
        assert_eq!(table.levels()[0].min_size, Some(0.0));
    }
}

#[test]
fn positions_that_no_triangle_uses_do_not_count() {
    let mut mesh = one_triangle();
    mesh.positions.insert(0, Vec3::splat(1e6));
    mesh.wedges = vec![0, 1, 2, 3, 1];
    mesh.triangles = vec![[1, 2, 3]];
    let chain = bake(&Plan::default(), &mesh);
    assert_eq!((chain.unreferenced, chain.levels[0].vertices()), (1, 3));
    assert_eq!(chain.levels[0].mesh.positions, one_triangle().positions);
    assert!(chain.table(Accuracy::default()).expect("a table").bounds().radius < 1.0);
}

#[test]
fn meshes_that_no_table_can_hold_are_refused() {
    let refused = |mesh: &Mesh| refused(&Plan::default(), mesh);
    assert_eq!(refused(&Mesh::default()), BakeError::NoTriangles);
    let mut point = one_triangle();
    point.positions = vec![Vec3::ONE; 3];
    assert_eq!(refused(&point), BakeError::NoExtent);
    let mut endless = one_triangle();
    endless.positions[1] = Vec3::X * f32::INFINITY;
    assert_eq!(refused(&endless), BakeError::NoExtent);
    endless.positions[1].x = f32::NAN;
    assert_eq!(refused(&endless), BakeError::NoExtent);
    let mut huge = one_triangle();
    huge.positions = vec![Vec3::splat(f32::MAX), Vec3::splat(-f32::MAX), Vec3::X];
    assert_eq!(refused(&huge), BakeError::NoExtent);
    let mut broken = one_triangle();
    broken.triangles = vec![[0, 1, 7]];
    assert_eq!(refused(&broken).to_string(), "corner 2 must be one of 3 wedges, not 7");
}

#[test]
fn plans_out_of_range_are_refused_before_anything_is_done() {
    let many = Stops::Triangles((1..=MAX_LEVELS).rev().collect());
    let refused = |plan: &Plan| refused(plan, &Mesh::default()).to_string();
    assert_eq!(refused(&plan(many)), "a chain must have at most 254 levels, not 255");
    let limits = Limits { levels: 255, ..Limits::NONE };
    assert_eq!(refused(&Plan { limits, ..quick() }), "a chain must have 1 to 254 levels, not 255");
    assert_eq!(refused(&plan(Stops::Ratio(0.0))), "the ratio must be between 0 and 1, not 0");
}

#[test]
fn as_many_levels_as_a_table_holds() {
    let ball = icosphere(6).into();
    let chain = bake(&plan(Stops::Triangles((1..MAX_LEVELS).map(|i| 720 - 2 * i).collect())), &ball);
    assert_eq!(chain.levels.len(), MAX_LEVELS);
    assert!(chain.table(Accuracy::default()).is_ok());
}

#[test]
fn a_bake_can_be_cancelled_at_every_report() {
    let ball = icosphere(4).into();
    let mut reports = Vec::new();
    let mut keep = |at| {
        reports.push(at);
        ControlFlow::Continue(())
    };
    let chain = Plan::default().bake(&ball, &mut keep).expect("a chain");
    let measured = reports.iter().filter(|at| matches!(at, Progress::Measuring { .. })).count();
    assert_eq!(measured + 1, chain.levels.len() + chain.left_out.len());
    for stop in 0..reports.len() {
        let mut left = stop;
        let mut cancel = |_| {
            left = left.wrapping_sub(1);
            if left == usize::MAX { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        assert_eq!(Plan::default().bake(&ball, &mut cancel).err(), Some(BakeError::Cancelled), "{stop}");
    }
}

#[test]
fn every_preset_bakes_its_levels() {
    let ball: Mesh = icosphere(8).into();
    for preset in Preset::ALL {
        let plan = Plan { measure: quick().measure, look: None, ..preset.plan() };
        let chain = bake(&plan, &ball);
        check(&ball, &chain);
        assert!((2..=plan.limits.levels).contains(&chain.levels.len()), "{preset:?}");
        let least = chain.levels.last().map_or(0, |level| level.triangles());
        assert!(least + 1 >= plan.limits.least_triangles, "{preset:?}: {least}");
        assert!(chain.table(Accuracy::default()).expect("a table").lint().is_empty(), "{preset:?}");
    }
}

#[test]
fn every_method_makes_chains_that_keep_the_contract() {
    let land: Mesh = terrain(12, 5).into();
    for method in Method::ALL {
        let chain = bake(&Plan { method, ..plan(Stops::Shares(vec![0.5, 0.2, 0.05])) }, &land);
        check(&land, &chain);
        assert!(chain.levels.len() > 1, "{method}");
    }
}

/// What a table says of a sphere follows from what a sphere is.
#[test]
fn accuracy_and_size_are_what_they_are_said_to_be() {
    let ball: Mesh = icosphere(10).into();
    let chain = bake(&Plan::default(), &ball);
    let tables = ACCURACIES.map(|accuracy| chain.table(accuracy).expect("a table"));
    let radius = f64::from(tables[0].bounds().radius);
    // No level is farther out than its error allows.
    let most = chain.levels.last().map_or(0.0, |level| f64::from(level.error));
    assert!((0.999..1.001 + most).contains(&radius), "{radius}");
    for (i, level) in chain.levels.iter().enumerate().skip(1) {
        let record = |k: usize| tables[k].levels()[i];
        let band = 2.0 * level.deviation.rms() / radius;
        assert!(f64::from(record(0).accuracy) <= 1.0 - band + 1e-6);
        assert!((f64::from(record(1).accuracy) - (1.0 - f64::from(level.error) / radius)).abs() < 1e-6);
        assert!((record(2).accuracy - accuracy_of(record(2).triangles)).abs() < 1e-6);
        // At the size from which on the finer level is wanted, this one is off by a pixel.
        let diameter_px = f64::from(tables[0].levels()[i - 1].min_size.unwrap_or(0.0)) * 1080.0;
        let error_px = f64::from(level.error) / (2.0 * radius) * diameter_px;
        assert!((error_px - 1.0).abs() < 1e-5, "{error_px} px");
    }
}

#[test]
fn bytes_and_draws_are_those_of_the_attributes_and_groups_there_are() {
    let mut mesh = one_triangle();
    let plain = bake(&Plan::default(), &mesh);
    assert_eq!((plain.levels[0].bytes(), plain.levels[0].draws()), (3 * 12 + 3 * 2, 1));
    mesh.normals = vec![Vec3::Z; 3];
    mesh.uvs = vec![vec![glam::Vec2::ZERO; 3]; 2];
    mesh.groups.push(Group { triangles: 1..1, ..Group::default() });
    let rich = bake(&Plan::default(), &mesh);
    assert_eq!((rich.levels[0].bytes(), rich.levels[0].draws()), (3 * (12 + 12 + 16) + 3 * 2, 1));
}

#[test]
fn levels_are_looked_at_and_level_0_is_not() {
    let mut land: Mesh = terrain(16, 3).into();
    land.normals = vec![Vec3::Y; land.wedges.len()];
    let chain = bake(&Plan { look: Some(Look::default()), ..quick() }, &land);
    assert!(chain.levels[0].appearance.is_none() && chain.levels.len() > 2);
    for level in &chain.levels[1..] {
        let seen = level.appearance.as_ref().expect("looked at");
        assert!(seen.attributes.normals_deg.as_ref().is_some_and(|normals| normals.max() < 0.1));
        assert!(seen.attributes.colours.is_none() && seen.attributes.uvs.is_empty());
        // No silhouette moves farther than the surface does.
        assert!(seen.silhouette.distance() <= level.deviation.hausdorff + seen.silhouette.error());
    }
}

#[test]
fn the_same_mesh_and_plan_have_the_same_chain() {
    let land: Mesh = terrain(20, 3).into();
    let tables = [(), ()].map(|()| {
        let chain = bake(&Plan::default(), &land);
        (chain.table(Accuracy::default()).expect("a table"), chain.levels.last().map(|l| l.mesh.clone()))
    });
    assert_eq!(tables[0], tables[1]);
}
