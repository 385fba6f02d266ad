//! What is proved on paper about the distance to the limit surface, tried.

use glam::{DVec3, Vec3};

use super::shapes::{of_polygons, of_triangles, scatter, semi_sharp};
use crate::bake::subdivide::level::{Level, Stack};
use crate::bake::subdivide::remainder::{differences, limit_distance, shrink, tail};
use crate::bake::subdivide::{ControlMesh, Scheme, draw};

fn all() -> impl Iterator<Item = (Scheme, String, ControlMesh)> {
    let loops = of_triangles().into_iter().map(|(name, mesh)| (Scheme::Loop, name, mesh));
    loops.chain(of_polygons().into_iter().map(|(name, mesh)| (Scheme::CatmullClark, name, mesh)))
}

/// The factor r: on scattered vertices, which come close to the worst case more often than smooth ones.
#[test]
fn second_differences_shrink_as_they_should() {
    for (scheme, name, mesh) in all() {
        for seed in 0..8 {
            let mut level = Level::base(&scatter(mesh.clone(), seed)).refined(scheme);
            for step in 0..3 {
                let before = differences(&level.net, scheme, &level.positions);
                let factor = shrink(&level.net, scheme);
                assert!((0.5..1.0).contains(&factor), "{scheme}, {name}: {factor}");
                if level.net.face_count() > 400 {
                    break;
                }
                level = level.refined(scheme);
                let after = differences(&level.net, scheme, &level.positions);
                assert!(
                    after <= before * factor + 1e-12,
                    "{scheme}, {name}, {step}: {after} > {factor} · {before}"
                );
            }
        }
    }
}

/// The greatest distance between a level's faces and those of one some subdivisions later, by their parameters.
fn travelled(level: &Level, scheme: Scheme, steps: usize) -> f64 {
    let (mut level, mut flat) = (level.clone(), level.positions.clone());
    for _ in 0..steps {
        flat = scheme.flat_points(&level.net, &flat);
        level = level.refined(scheme);
    }
    level.positions.iter().zip(flat).map(|(p, q)| p.distance(q)).fold(0.0, f64::max)
}

#[test]
fn no_subdivision_goes_farther_than_the_tail() {
    let fading = [0.5, 1.5, 3.0].into_iter().flat_map(semi_sharp);
    let shapes = all().chain(fading.map(|(name, mesh)| (Scheme::CatmullClark, name, mesh)));
    for (scheme, name, mesh) in shapes {
        let level = Level::base(&mesh).refined(scheme);
        let bound = tail(&level.net, scheme, &level.positions);
        let moved = travelled(&level, scheme, 4);
        assert!(moved <= bound, "{scheme}, {name}: {moved} > {bound}");
    }
}

/// Drawn as it is drawn, against its own vertices much later: none of these may be farther from it than the bound.
#[test]
fn limit_points_are_within_the_bound_of_a_level() {
    for (scheme, name, mesh) in all().step_by(3) {
        let stack = Stack::new(&mesh, scheme, 1).expect("a mesh");
        let limits = stack.limits();
        let bound = limit_distance(stack.finest(), scheme, &draw::places(stack.finest(), Some(&limits)));
        let drawn =
            draw::mesh(&mesh, stack.finest(), Some(&limits), &stack.sides()).expect("a mesh").surface();
        let triangles: Vec<[DVec3; 3]> =
            (0..drawn.triangles.len()).map(|t| drawn.corners(t).map(|p| p.as_dvec3())).collect();
        let ends = Stack::new(&mesh, scheme, 2).expect("a mesh").limits().positions;
        let farthest = ends.iter().map(|p| distance(&triangles, *p)).fold(0.0, f64::max);
        assert!(farthest <= bound, "{scheme}, {name}: {farthest} > {bound}");
        assert!(bound < 4.0, "{scheme}, {name}: {bound} says nothing");
    }
}

/// From a point to the nearest triangle, by some of its points: an upper estimate would not do, so their distance
/// from each other comes off.
fn distance(triangles: &[[DVec3; 3]], p: DVec3) -> f64 {
    const CUTS: i32 = 8;
    let of = |[a, b, c]: &[DVec3; 3]| {
        let shares = (0..=CUTS).flat_map(|i| (0..=CUTS - i).map(move |j| (i, j)));
        let at = shares.map(|(i, j)| {
            *a + (*b - *a) * f64::from(i) / f64::from(CUTS) + (*c - *a) * f64::from(j) / f64::from(CUTS)
        });
        let nearest = at.map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
        let step = (*b - *a).length().max((*c - *a).length()).max((*c - *b).length()) / f64::from(CUTS);
        nearest - step
    };
    triangles.iter().map(of).fold(f64::INFINITY, f64::min)
}

/// On a smooth surface the bound falls to a quarter with every subdivision, as the distance does.
#[test]
fn the_bound_falls_with_the_square_of_the_size_of_faces() {
    let cube = scatter(super::shapes::prism(4), 9);
    let bound = |levels: usize| {
        let stack = Stack::new(&cube, Scheme::CatmullClark, levels).expect("a mesh");
        let limits = stack.limits();
        limit_distance(stack.finest(), stack.scheme, &draw::places(stack.finest(), Some(&limits)))
    };
    let bounds = [1, 2, 3, 4].map(bound);
    assert!(bounds.windows(2).all(|pair| pair[1] < 0.5 * pair[0]), "{bounds:?}");
}

/// What is flat is exact: but for rounding to single precision there is nothing to bound.
#[test]
fn a_plane_is_no_distance_away() {
    let mesh = super::shapes::quad_grid(4);
    let stack = Stack::new(&mesh, Scheme::CatmullClark, 2).expect("a mesh");
    let places: Vec<Vec3> = draw::places(stack.finest(), None);
    let inner = super::shapes::sharp(mesh, &[&[0], &[3], &[12], &[15]], f32::INFINITY);
    let held = Stack::new(&inner, Scheme::CatmullClark, 2).expect("a mesh");
    assert!(limit_distance(held.finest(), held.scheme, &draw::places(held.finest(), None)) < 1e-6);
    assert!(limit_distance(stack.finest(), stack.scheme, &places) > 1e-3, "corners of a border are rounded");
}
