//! Deviation between surfaces: against brute force, against what is known, and against itself.
#![cfg(feature = "bake")]

use glam::{DVec3, Quat, Vec3};
use lod_budget::bake::deviation::silhouette::{self, SilhouetteDeviation};
use lod_budget::bake::deviation::{Deviation, DeviationError, Flaw, Options, Ruler, deviation, running_max};
use lod_budget::bake::surface::Surface;
use proptest::prelude::*;

// -- surfaces

fn surface(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Surface {
    Surface { positions, triangles }
}

/// A height field over `[0, 1]²`, `n` squares to a side.
fn field(n: u32, height: impl Fn(f32, f32) -> f32) -> Surface {
    let at = |i: u32| i as f32 / n as f32;
    let positions = (0..=n).flat_map(|y| (0..=n).map(move |x| (at(x), at(y))));
    let positions = positions.map(|(x, y)| Vec3::new(x, y, height(x, y))).collect();
    let corner = |x: u32, y: u32| y * (n + 1) + x;
    let square = |(x, y)| {
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..n).flat_map(|y| (0..n).map(move |x| (x, y))).flat_map(square).collect();
    surface(positions, triangles)
}

/// An octahedron whose faces are cut into n² triangles, its vertices moved to the unit sphere.
fn sphere(n: u32) -> Surface {
    let mut ball = Surface::default();
    let axes = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y];
    for (k, pole) in (0..4).flat_map(|k| [(k, Vec3::Z), (k, Vec3::NEG_Z)]) {
        let [a, b] = if pole.z > 0.0 { [axes[k], axes[(k + 1) % 4]] } else { [axes[(k + 1) % 4], axes[k]] };
        add_patch(&mut ball, [a, b, pole], n);
    }
    ball
}

fn add_patch(ball: &mut Surface, [a, b, c]: [Vec3; 3], n: u32) {
    let start = ball.positions.len() as u32;
    let place = |i: u32, j: u32| start + j * (2 * n + 3 - j) / 2 + i;
    for (i, j) in (0..=n).flat_map(|j| (0..=n - j).map(move |i| (i, j))) {
        let weights = Vec3::new((n - i - j) as f32, i as f32, j as f32);
        ball.positions.push((a * weights.x + b * weights.y + c * weights.z).normalize());
        if i + j < n {
            ball.triangles.push([place(i, j), place(i + 1, j), place(i, j + 1)]);
        }
        if i + j + 1 < n {
            ball.triangles.push([place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)]);
        }
    }
}

// -- the oracle: dense samples against all triangles, by a formula of its own

/// The distance from a point to a segment.
fn to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let t = if along == DVec3::ZERO { 0.0 } else { (p - a).dot(along) / along.length_squared() };
    p.distance(a + along * t.clamp(0.0, 1.0))
}

/// The distance from a point to a triangle: that of its plane over its inside, that of its sides elsewhere.
fn to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let sides = to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a));
    let normal = (b - a).cross(c - a);
    let inside = |from: DVec3, to: DVec3| (to - from).cross(p - from).dot(normal) >= 0.0;
    if normal.length() > 1e-12 && inside(a, b) && inside(b, c) && inside(c, a) {
        return sides.min((p - a).dot(normal.normalize()).abs());
    }
    sides
}

fn corners(surface: &Surface) -> Vec<[DVec3; 3]> {
    let place = |i: u32| surface.positions[i as usize].as_dvec3();
    surface.triangles.iter().map(|triangle| triangle.map(place)).collect()
}

fn to_surface(p: DVec3, triangles: &[[DVec3; 3]]) -> f64 {
    triangles.iter().map(|&triangle| to_triangle(p, triangle)).fold(f64::INFINITY, f64::min)
}

/// Points of a triangle, `n` steps to a side.
fn lattice([a, b, c]: [DVec3; 3], n: u32) -> impl Iterator<Item = DVec3> {
    let steps = (0..=n).flat_map(move |i| (0..=n - i).map(move |j| (i, j)));
    steps.map(move |(i, j)| a + ((b - a) * f64::from(i) + (c - a) * f64::from(j)) / f64::from(n))
}

/// The largest distance of dense samples, and how far the largest of all points can be above it.
fn brute_one_way(from: &Surface, to: &Surface, n: u32) -> (f64, f64) {
    let to = corners(to);
    let (mut most, mut step) = (0.0_f64, 0.0_f64);
    for triangle in corners(from) {
        let [a, b, c] = triangle;
        step = step.max(a.distance(b).max(b.distance(c)).max(c.distance(a)) / f64::from(n));
        most = lattice(triangle, n).map(|p| to_surface(p, &to)).fold(most, f64::max);
    }
    (most, step)
}

/// Between which two numbers the Hausdorff distance is.
fn brute(a: &Surface, b: &Surface, n: u32) -> (f64, f64) {
    let (there, back) = (brute_one_way(a, b, n), brute_one_way(b, a, n));
    (there.0.max(back.0), (there.0 + there.1).max(back.0 + back.1))
}

fn diagonal(surface: &Surface) -> f64 {
    let points: Vec<DVec3> = corners(surface).into_iter().flatten().collect();
    let (min, max) =
        points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), &p| (a.min(p), b.max(p)));
    (max - min).length()
}

/// What must hold of any deviation whatever the surfaces.
fn check(a: &Surface, b: &Surface, found: &Deviation, options: &Options) {
    let Deviation { hausdorff, attained, there, back, .. } = *found;
    let allowed = (attained * options.relative).max(options.of_diagonal * diagonal(a).min(diagonal(b)));
    let reach = corners(a).iter().chain(&corners(b)).flatten().map(|p| p.length()).fold(0.0, f64::max);
    assert!(hausdorff >= attained, "{found:?}");
    assert!(hausdorff <= attained + allowed * (1.0 + 1e-9) + 1e-10 * reach, "{found:?}");
    for spread in [there, back] {
        assert!(
            spread.mean <= spread.rms * (1.0 + 1e-9) && spread.rms <= spread.max * (1.0 + 1e-9),
            "{found:?}"
        );
        assert!(spread.max <= hausdorff, "{found:?}");
    }
}

fn few_samples() -> Options {
    Options { max_samples: 2000, ..Options::default() }
}

fn measured(a: &Surface, b: &Surface) -> Deviation {
    let options = few_samples();
    let found = deviation(a, b, &options).expect("two surfaces");
    check(a, b, &found, &options);
    found
}

fn is_near(found: f64, expected: f64, relative: f64) -> bool {
    (found - expected).abs() <= relative * expected
}

// -- what is known

#[test]
fn planes_are_as_far_apart_as_they_are() {
    let apart = measured(&field(7, |_, _| 0.0), &field(3, |_, _| 0.25));
    assert!(is_near(apart.hausdorff, 0.25, 0.01) && is_near(apart.rms(), 0.25, 1e-9), "{apart:?}");
    assert!(is_near(apart.attained, 0.25, 1e-9) && apart.there.rms_error < 1e-9, "{apart:?}");
}

#[test]
fn one_plane_in_other_triangles_is_the_same_surface() {
    let apart = measured(&field(40, |_, _| 0.0), &field(7, |_, _| 0.0));
    assert!(apart.hausdorff <= 1e-10 && apart.attained == 0.0, "{apart:?}");
    let tilted = |x: f32, y: f32| 0.5 * x + 0.25 * y;
    let apart = measured(&field(64, tilted), &field(2, tilted));
    assert!(apart.hausdorff <= 2e-6, "{apart:?}");
}

#[test]
fn a_moved_vertex_is_as_far_away_as_it_moved() {
    let flat = field(20, |_, _| 0.0);
    let mut peak = flat.clone();
    peak.positions[10 * 21 + 10].z = 0.01;
    let apart = measured(&flat, &peak);
    // The peak itself is 0.01 above the plane; no point of the plane is as far from the peak's flanks.
    assert!(apart.hausdorff >= f64::from(0.01_f32) && apart.hausdorff <= 0.0102, "{apart:?}");
    assert!(apart.there.max < apart.hausdorff);
}

/// A pyramid of base side 2/n and height h over a plane: ∫ d² = base · h² / 6, seen from the pyramid.
#[test]
fn the_mean_square_of_a_pyramid_is_its_integral() {
    let n = 8;
    let flat = field(n, |_, _| 0.0);
    let roof = field(n, |x, _| 0.01 * (1.0 - (x - 0.5).abs() / 0.5));
    let options = Options { rms_error: 0.001, ..Options::default() };
    let apart = deviation(&flat, &roof, &options).expect("two surfaces");
    // Height falls from 0.01 to 0 linearly on both sides: mean square h²/3 over the roof.
    assert!(is_near(apart.back.rms, 0.01 / 3.0_f64.sqrt(), 0.004), "{apart:?}");
    assert!(is_near(apart.back.mean, 0.005, 0.004), "{apart:?}");
    // From the plane the nearest point of the roof is across its slope of 1 in 50.
    assert!(is_near(apart.there.rms, apart.back.rms / (1.0 + 0.02_f64.powi(2)).sqrt(), 0.004), "{apart:?}");
}

#[test]
fn a_missing_piece_is_seen_from_the_whole() {
    let whole = field(10, |_, _| 0.0);
    let mut half = whole.clone();
    half.triangles.retain(|corners| corners.iter().all(|&i| whole.positions[i as usize].x <= 0.5));
    for apart in [measured(&whole, &half), measured(&half, &whole)] {
        assert!(is_near(apart.hausdorff, 0.5, 0.01), "{apart:?}");
    }
    let apart = measured(&whole, &half);
    assert!(apart.back.max < 1e-9 && apart.there.max > 0.45, "{apart:?}");
    // Half is at no distance, the other half at distances from 0 to ½, evenly: mean square ½ · ½² / 3.
    assert!(is_near(apart.there.rms, (0.125_f64 / 3.0).sqrt(), 0.03), "{apart:?}");
}

/// The sagitta: the unit sphere is farthest from an inscribed polyhedron over the middle of its largest face.
#[test]
fn an_inscribed_octahedron_lies_within_a_sphere() {
    let apart = measured(&sphere(96), &sphere(1));
    let expected = 1.0 - 1.0 / 3.0_f64.sqrt();
    assert!(is_near(apart.hausdorff, expected, 0.012), "{apart:?} {expected}");
}

/// Where triangles are laid over a surface: a gap in it and a hidden fold must not go unseen.
#[test]
fn a_hole_under_a_large_triangle_is_found() {
    let whole = field(1, |_, _| 0.0);
    for hole in [0, 77, 450, 799] {
        let mut fine = field(20, |_, _| 0.0);
        let gone = corners(&fine)[hole];
        fine.triangles.remove(hole);
        let apart = measured(&whole, &fine);
        let (least, _) = brute_one_way(&surface_of(gone), &fine, 64);
        assert!(apart.hausdorff >= least && apart.hausdorff <= least * 1.05, "{apart:?} {least}");
    }
}

fn surface_of(triangle: [DVec3; 3]) -> Surface {
    surface(triangle.iter().map(|p| p.as_vec3()).collect(), vec![[0, 1, 2]])
}

#[test]
fn a_fold_under_a_large_triangle_is_bounded() {
    let whole = field(1, |_, _| 0.0);
    let mut folded = field(12, |x, y| 0.02 * (9.0 * x).sin() * (7.0 * y).cos());
    // The middle column is drawn over its neighbours: an S in the section.
    for p in folded.positions.iter_mut().filter(|p| p.x == 0.5) {
        *p = Vec3::new(0.8, p.y, 0.05);
    }
    holds_against_brute_force(&whole, &folded);
}

#[test]
fn what_is_equal_is_at_no_distance() {
    let ball = sphere(30);
    assert_eq!(deviation(&ball, &ball, &Options::default()), Ok(Deviation::default()));
    let mut shuffled = ball.clone();
    shuffled.triangles.reverse();
    shuffled.triangles.iter_mut().for_each(|corners| corners.rotate_left(1));
    let apart = measured(&ball, &shuffled);
    assert!(apart.hausdorff < 1e-10 && apart.splits == 0, "{apart:?}");
}

#[test]
fn vertices_without_triangles_do_not_count() {
    let flat = field(4, |_, _| 0.0);
    let mut stray = flat.clone();
    stray.positions.extend([Vec3::splat(100.0), Vec3::splat(f32::NAN)]);
    assert_eq!(deviation(&flat, &stray, &Options::default()), Ok(Deviation::default()));
}

#[test]
fn segments_points_and_needles_are_surfaces_too() {
    let point = surface(vec![Vec3::new(3.0, 4.0, 0.0)], vec![[0, 0, 0]]);
    let origin = surface(vec![Vec3::ZERO], vec![[0, 0, 0]]);
    assert!(is_near(measured(&point, &origin).hausdorff, 5.0, 1e-9));
    let segment = surface(vec![Vec3::ZERO, Vec3::X, Vec3::X * 0.25], vec![[0, 1, 2]]);
    let apart = measured(&segment, &origin);
    assert!(is_near(apart.hausdorff, 1.0, 1e-9), "{apart:?}");
    let needle = surface(vec![Vec3::ZERO, Vec3::X, Vec3::new(0.3, 1e-30, 1e-20)], vec![[0, 1, 2]]);
    assert!(measured(&segment, &needle).hausdorff < 1e-9);
    let high = surface(vec![Vec3::Z, Vec3::X + Vec3::Z, Vec3::new(0.3, 1e-7, 1.0)], vec![[0, 1, 2]]);
    assert!(is_near(measured(&high, &needle).hausdorff, 1.0, 1e-9));
}

#[test]
fn a_mesh_far_from_its_origin_is_measured_as_well() {
    let bump = |x: f32, y: f32| if (x, y) == (0.5, 0.5) { 0.25 } else { 0.0 };
    let moved = |mesh: Surface| {
        let far = Vec3::new(8192.0, -4096.0, 1024.0);
        surface(mesh.positions.iter().map(|&p| p + far).collect(), mesh.triangles)
    };
    let [near, far] = [|mesh: Surface| mesh, moved]
        .map(|place: fn(Surface) -> Surface| measured(&place(field(8, |_, _| 0.0)), &place(field(8, bump))));
    assert_eq!(near, far);
}

#[test]
fn the_largest_and_smallest_numbers_are_measured() {
    let huge =
        surface(vec![Vec3::splat(-3e38), Vec3::splat(3e38), Vec3::new(3e38, -3e38, 0.0)], vec![[0, 1, 2]]);
    let apart = measured(&huge, &surface(vec![Vec3::splat(3e38)], vec![[0, 0, 0]]));
    assert!(is_near(apart.hausdorff, 6e38 * 3.0_f64.sqrt(), 1e-6), "{apart:?}");
    let tiny = surface(vec![Vec3::ZERO, Vec3::X * 1e-44, Vec3::Y * 1e-44], vec![[0, 1, 2]]);
    let apart = measured(&tiny, &surface(vec![Vec3::Z * 1e-44], vec![[0, 0, 0]]));
    assert!(apart.hausdorff > 0.9e-44 && apart.hausdorff < 2.1e-44, "{apart:?}");
}

#[test]
fn what_is_no_surface_is_refused() {
    let good = field(1, |_, _| 0.0);
    let refused = |bad: &Surface| {
        let [there, back] = [deviation(&good, bad, &few_samples()), deviation(bad, &good, &few_samples())];
        assert_eq!(there, back);
        there.expect_err("refused")
    };
    let mut bad = good.clone();
    bad.positions[3].y = f32::NAN;
    assert_eq!(refused(&bad), DeviationError::Triangle { triangle: 0, flaw: Flaw::NotFinite { vertex: 3 } });
    bad.triangles[0][1] = 4;
    let flaw = Flaw::NoSuchVertex { vertex: 4, vertices: 4 };
    assert_eq!(refused(&bad), DeviationError::Triangle { triangle: 0, flaw });
    assert_eq!(refused(&bad).to_string(), "triangle 0: there is no vertex 4 among 4");
    assert_eq!(refused(&Surface::default()), DeviationError::OneIsEmpty);
    let empty = deviation(&Surface::default(), &Surface::default(), &few_samples());
    assert_eq!(empty, Ok(Deviation::default()));
    for relative in [0.0, -1.0, f64::NAN, 2.0] {
        let options = Options { relative, ..Options::default() };
        assert!(matches!(deviation(&good, &good, &options), Err(DeviationError::Options(_))));
    }
}

// -- the chain

#[test]
fn the_contract_of_a_chain_never_falls_and_is_rounded_up() {
    let ball = sphere(24);
    let ruler = Ruler::new(&ball).expect("a surface");
    let level = |n| ruler.deviation(&sphere(n), &few_samples()).expect("a surface");
    let chain = [24, 12, 3, 6, 1].map(level);
    let errors = running_max(&chain);
    assert_eq!(errors[0], 0.0);
    assert_eq!(errors[3], errors[2]);
    for (error, apart) in errors.iter().zip(&chain) {
        assert!(f64::from(*error) >= apart.hausdorff);
    }
    assert!(errors.is_sorted() && chain[3].hausdorff < chain[2].hausdorff);
}

#[test]
fn a_search_that_is_cut_short_still_bounds() {
    let (a, b) = (field(30, |x, y| (9.0 * x).sin() * (8.0 * y).cos()), field(17, |x, y| (7.0 * x * y).sin()));
    let whole = measured(&a, &b);
    let short =
        deviation(&a, &b, &Options { max_splits: 0, relative: 0.001, ..few_samples() }).expect("surfaces");
    assert!(short.hausdorff >= whole.attained && short.attained <= whole.hausdorff, "{short:?} {whole:?}");
}

// -- silhouettes

fn silhouettes(a: &Surface, b: &Surface, resolution: usize) -> SilhouetteDeviation {
    let found = silhouette::deviation(a, b, &silhouette::Options { resolution }).expect("two surfaces");
    let back = silhouette::deviation(b, a, &silhouette::Options { resolution }).expect("two surfaces");
    assert_eq!(found.views.len(), silhouette::DIRECTIONS.len());
    for (view, other) in found.views.iter().zip(&back.views) {
        assert_eq!((view.distance, view.areas), (other.distance, [other.areas[1], other.areas[0]]));
    }
    found
}

fn moved(mesh: &Surface, place: impl Fn(Vec3) -> Vec3) -> Surface {
    surface(mesh.positions.iter().map(|&p| place(p)).collect(), mesh.triangles.clone())
}

#[test]
fn the_silhouette_of_a_larger_sphere_is_larger_all_round() {
    let ball = sphere(40);
    for (scale, resolution) in [(1.05_f32, 512), (0.8, 512), (1.3, 100)] {
        let found = silhouettes(&ball, &moved(&ball, |p| p * scale), resolution);
        let expected = f64::from(scale - 1.0).abs();
        for view in &found.views {
            assert!((view.distance - expected).abs() <= view.error, "{view:?}");
            assert!(view.error < 5.0 * f64::from(scale.max(1.0)) / resolution as f64, "{view:?}");
            assert!(is_near(view.areas[0], std::f64::consts::PI, 0.02), "{view:?}");
        }
        let change = found.area_change().expect("it covers something");
        assert!((change - (f64::from(scale).powi(2) - 1.0)).abs() < 0.01, "{change}");
    }
}

#[test]
fn a_plate_that_is_shifted_is_seen_to_be_shifted_where_that_shows() {
    let plate = field(4, |_, _| 0.0);
    let found = silhouettes(&plate, &moved(&plate, |p| p + Vec3::new(0.25, 0.0, 0.0)), 512);
    for (view, direction) in found.views.iter().zip(silhouette::DIRECTIONS) {
        // What is left of the shift across the direction, if it is across an edge, or less.
        let across = 0.25 * direction.normalize().cross(DVec3::X).length();
        assert!(view.distance <= across + view.error, "{view:?} {direction}");
        if direction.y == 0.0 {
            assert!((view.distance - across).abs() <= view.error, "{view:?} {direction}");
        }
    }
    assert!((found.distance() - 0.25).abs() <= found.error() && found.error() < 0.25 * 0.02);
    assert!(found.area_change().expect("it covers something").abs() < 0.01);
}

#[test]
fn what_covers_less_is_said_to_cover_less() {
    let leaves = field(16, |_, _| 0.0);
    let mut fewer = leaves.clone();
    let mut kept = (0..).map(|i| i % 4 != 0);
    fewer.triangles.retain(|_| kept.next() == Some(true));
    let change = silhouettes(&leaves, &fewer, 512).area_change().expect("it covers something");
    assert!((change + 0.25).abs() < 0.02, "{change}");
    // Seen from the side a plate covers nothing, but is there.
    let line = field(1, |_, _| 0.0);
    let lifted = silhouettes(&line, &moved(&line, |p| p + Vec3::Z), 256);
    assert!((lifted.views[0].distance - 1.0).abs() <= lifted.views[0].error, "{:?}", lifted.views[0]);
}

/// A hole's radius is what closing it changes, and no more.
#[test]
fn a_hole_that_closes_counts_by_its_size() {
    let whole = field(20, |_, _| 0.0);
    let mut holed = whole.clone();
    holed.triangles.retain(|t| {
        t.iter()
            .any(|&i| (whole.positions[i as usize] - Vec3::new(0.5, 0.5, 0.0)).abs().max_element() > 0.101)
    });
    let view = silhouettes(&whole, &holed, 512).views[2];
    assert!((view.distance - 0.1).abs() <= view.error, "{view:?}");
}

#[test]
fn points_segments_and_nothing_have_silhouettes_too() {
    let at = |p: Vec3| surface(vec![p], vec![[0, 0, 0]]);
    let found = silhouettes(&at(Vec3::ZERO), &at(Vec3::new(3.0, 4.0, 0.0)), 64);
    assert!((found.views[2].distance - 5.0).abs() <= found.views[2].error, "{:?}", found.views[2]);
    assert_eq!(silhouettes(&at(Vec3::ONE), &at(Vec3::ONE), 64).distance(), 0.0);
    assert_eq!(silhouettes(&at(Vec3::ONE), &at(Vec3::ONE), 64).area_change(), None);
    let huge = silhouettes(&at(Vec3::splat(-3e38)), &at(Vec3::splat(3e38)), 64);
    assert!(huge.distance().is_finite() && (huge.distance() - 6e38 * 3.0_f64.sqrt()).abs() <= huge.error());
    let options = silhouette::Options::default();
    let (none, one) = (Surface::default(), at(Vec3::ONE));
    assert_eq!(silhouette::deviation(&none, &none, &options), Ok(SilhouetteDeviation::default()));
    assert_eq!(silhouette::deviation(&none, &one, &options), Err(DeviationError::OneIsEmpty));
    let refused = silhouette::deviation(&one, &one, &silhouette::Options { resolution: 8 });
    assert!(matches!(refused, Err(DeviationError::Options(_))));
    let stray = surface(vec![Vec3::NAN, Vec3::ONE], vec![[1, 1, 1]]);
    assert_eq!(silhouettes(&stray, &one, 64).distance(), 0.0);
}

// -- against brute force

fn soup(most: usize) -> impl Strategy<Value = Surface> {
    let coordinate = prop_oneof![4 => -1.0_f32..1.0, 1 => Just(0.0), 1 => Just(0.5)];
    let position = (coordinate.clone(), coordinate.clone(), coordinate).prop_map(Vec3::from);
    prop::collection::vec(position, 1..12).prop_flat_map(move |positions| {
        let corner = 0..positions.len() as u32;
        let triangle = (corner.clone(), corner.clone(), corner).prop_map(<[u32; 3]>::from);
        prop::collection::vec(triangle, 1..most)
            .prop_map(move |triangles| surface(positions.clone(), triangles))
    })
}

/// A height field and another with the same ground plan, shaken by little: what simplification makes.
fn resembling() -> impl Strategy<Value = (Surface, Surface)> {
    let heights = |n: u32| prop::collection::vec(-0.05_f32..0.05, ((n + 1) * (n + 1)) as usize);
    (1_u32..6, 1_u32..6).prop_flat_map(move |(n, m)| {
        (heights(n), heights(m)).prop_map(move |(a, b)| {
            let [mut first, mut second] = [field(n, |_, _| 0.0), field(m, |_, _| 0.0)];
            first.positions.iter_mut().zip(a).for_each(|(p, z)| p.z = z);
            second.positions.iter_mut().zip(b).for_each(|(p, z)| p.z = z);
            (first, second)
        })
    })
}

fn holds_against_brute_force(a: &Surface, b: &Surface) {
    let found = measured(a, b);
    let (least, most) = brute(a, b, 24);
    assert!(found.hausdorff >= least * (1.0 - 1e-12) - 1e-12, "{found:?} is no bound of {least}");
    assert!(found.attained <= most * (1.0 + 1e-12), "{found:?} was never attained: {most}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn soups_are_bounded(a in soup(8), b in soup(8)) {
        holds_against_brute_force(&a, &b);
    }

    #[test]
    fn surfaces_that_resemble_each_other_are_bounded((a, b) in resembling()) {
        holds_against_brute_force(&a, &b);
    }

    /// A shadow moves no farther than what casts it; and points of either surface, seen from a direction, are no
    /// farther from the other silhouette than is said.
    #[test]
    fn silhouettes_are_bounded_by_the_surfaces_and_hold_against_brute_force(a in soup(8), b in soup(8)) {
        let found = silhouettes(&a, &b, 128);
        prop_assert!(found.distance() <= measured(&a, &b).hausdorff + found.error());
        for (view, direction) in found.views.iter().zip(silhouette::DIRECTIONS) {
            let along = direction.normalize();
            let flat = |mesh: &Surface| corners(mesh).into_iter().map(|t| t.map(|p| p - along * p.dot(along)));
            let [first, second]: [Vec<[DVec3; 3]>; 2] = [flat(&a).collect(), flat(&b).collect()];
            let far = |from: &[[DVec3; 3]], to: &[[DVec3; 3]]| {
                let points = from.iter().flat_map(|&t| lattice(t, 6));
                points.map(|p| to_surface(p, to)).fold(0.0, f64::max)
            };
            let least = far(&first, &second).max(far(&second, &first));
            prop_assert!(view.distance >= least - view.error, "{view:?} {least}");
        }
    }

    #[test]
    fn neither_order_nor_place_matters(a in soup(8), b in soup(8), turn in prop::array::uniform3(-3.0_f32..3.0)) {
        let apart = measured(&a, &b);
        let back = measured(&b, &a);
        let turned = |mesh: &Surface| {
            let quat = Quat::from_euler(glam::EulerRot::XYZ, turn[0], turn[1], turn[2]);
            surface(mesh.positions.iter().map(|&p| quat * p + Vec3::splat(turn[0])).collect(), mesh.triangles.clone())
        };
        let moved = measured(&turned(&a), &turned(&b));
        for other in [back, moved] {
            prop_assert!(apart.attained <= other.hausdorff + 1e-5 && other.attained <= apart.hausdorff + 1e-5);
        }
    }

    #[test]
    fn a_detour_is_no_shortcut(a in soup(6), b in soup(6), c in soup(6)) {
        let [ab, bc, ac] = [(&a, &b), (&b, &c), (&a, &c)].map(|(x, y)| measured(x, y));
        prop_assert!(ac.attained <= ab.hausdorff + bc.hausdorff);
    }

    #[test]
    fn a_surface_in_other_triangles_is_at_no_distance(a in soup(6), picks in prop::collection::vec(0.1_f32..0.9, 8)) {
        // Every triangle is cut through a corner, at places that single precision holds exactly or nearly so.
        let mut cut = Surface { positions: a.positions.clone(), triangles: Vec::new() };
        for (&[i, j, k], t) in a.triangles.iter().zip(picks) {
            let middle = cut.positions.len() as u32;
            cut.positions.push(a.positions[i as usize].lerp(a.positions[j as usize], t));
            cut.triangles.extend([[i, middle, k], [middle, j, k]]);
        }
        prop_assert!(measured(&a, &cut).hausdorff <= 5e-6);
    }
}
