//! Surfaces and curves that are known otherwise.

use glam::{DVec2, DVec3};

use super::shapes;
use crate::bake::subdivide::level::Stack;
use crate::bake::subdivide::{ControlMesh, Scheme};

const GRID: u32 = 8;

/// The uniform cubic B-spline's weights of four points, at t from 0 to 1 between the two in the middle.
fn cubic(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * t * t * t - 6.0 * t * t + 4.0, 3.0 * s * s * s - 6.0 * s * s + 4.0, t * t * t]
        .map(|w| w / 6.0)
}

fn nearest(points: &[DVec3], to: DVec3) -> f64 {
    points.iter().map(|p| p.distance(to)).fold(f64::INFINITY, f64::min)
}

fn at(mesh: &ControlMesh, i: i64, j: i64) -> DVec3 {
    mesh.positions[(i + i64::from(GRID) * j) as usize].as_dvec3()
}

/// Parameters of the vertices after two subdivisions, away from the border.
fn parameters() -> impl Iterator<Item = DVec2> {
    let range = || (8..4 * (GRID - 3) as i64 + 1).map(|i| i as f64 / 4.0);
    range().flat_map(move |x| range().map(move |y| DVec2::new(x, y)))
}

fn ends(mesh: &ControlMesh, scheme: Scheme) -> Vec<DVec3> {
    Stack::new(mesh, scheme, 2).expect("a mesh").limits().positions
}

#[test]
fn catmull_clark_on_a_regular_grid_is_the_bicubic_b_spline() {
    let mesh = shapes::scatter(shapes::quad_grid(GRID), 1);
    let points = ends(&mesh, Scheme::CatmullClark);
    for at_param in parameters() {
        let cell = at_param.floor();
        let (across, along) = (cubic(at_param.x - cell.x), cubic(at_param.y - cell.y));
        let mut p = DVec3::ZERO;
        for (j, v) in along.iter().enumerate() {
            for (i, u) in across.iter().enumerate() {
                p += at(&mesh, cell.x as i64 + i as i64 - 1, cell.y as i64 + j as i64 - 1) * (u * v);
            }
        }
        assert!(nearest(&points, p) < 1e-12, "{at_param}");
    }
}

/// The box spline of these directions, by its recurrence (C. de Boor, K. Höllig, "B-splines from parallelepipeds",
/// 1982): x is a sum of t times the directions, of which the last two are taken.
fn box_spline(directions: &[DVec2], x: DVec2) -> f64 {
    let solve = |a: DVec2, b: DVec2| (x.perp_dot(b) / a.perp_dot(b), a.perp_dot(x) / a.perp_dot(b));
    if let [a, b] = *directions {
        if a.perp_dot(b) == 0.0 {
            return 0.0;
        }
        let (s, t) = solve(a, b);
        let is_in = |t: f64| (0.0..1.0).contains(&t);
        return if is_in(s) && is_in(t) { 1.0 / a.perp_dot(b).abs() } else { 0.0 };
    }
    let spans = directions.iter().any(|d| d.perp_dot(directions[0]) != 0.0);
    if !spans {
        return 0.0;
    }
    let second = directions.iter().position(|d| d.perp_dot(directions[0]) != 0.0).expect("one that spans");
    let (s, t) = solve(directions[0], directions[second]);
    let mut share = vec![0.0; directions.len()];
    (share[0], share[second]) = (s, t);
    let without = |i: usize| [&directions[..i], &directions[i + 1..]].concat();
    let term = |(i, t): (usize, &f64)| {
        let rest = without(i);
        t * box_spline(&rest, x) + (1.0 - t) * box_spline(&rest, x - directions[i])
    };
    share.iter().enumerate().map(term).sum::<f64>() / (directions.len() as f64 - 2.0)
}

#[test]
fn loop_on_a_regular_grid_is_the_quartic_box_spline() {
    let mesh = shapes::scatter(shapes::triangle_grid(GRID), 2);
    let points = ends(&mesh, Scheme::Loop);
    let (e, f) = (DVec2::X, DVec2::Y);
    let directions = [e, f, e + f, e, f, e + f];
    // The recurrence is ambiguous on the lines between its pieces.
    let is_inside = |p: &DVec2| p.x.fract() != 0.0 && p.y.fract() != 0.0 && (p.x - p.y).fract() != 0.0;
    let mut seen = 0;
    for x in parameters().filter(is_inside).filter(|p| p.max_element() < 5.0) {
        let mut p = DVec3::ZERO;
        for j in 0..i64::from(GRID) {
            for i in 0..i64::from(GRID) {
                let weight = box_spline(&directions, x - DVec2::new(i as f64, j as f64) + DVec2::splat(2.0));
                p += at(&mesh, i, j) * weight;
            }
        }
        assert!(nearest(&points, p) < 1e-11, "{x}");
        seen += 1;
    }
    assert!(seen > 30);
}

/// Whatever is beside it.
#[test]
fn creases_and_borders_are_cubic_b_splines() {
    let ring: [u32; 8] = [2, 3, 4, 5, 6, 7, 8, 2];
    let crease = shapes::sharp(shapes::scatter(shapes::bipyramid(7), 4), &[&ring], f32::INFINITY);
    let border = shapes::scatter(shapes::prism(7), 4);
    let open: Vec<Vec<u32>> = border.corners.chunks(4).take(7).map(<[u32]>::to_vec).collect();
    let border = ControlMesh { positions: border.positions, ..shapes::of_faces(14, &open) };
    for (mesh, first, scheme) in
        [(&crease, 2, Scheme::Loop), (&crease, 2, Scheme::CatmullClark), (&border, 0, Scheme::CatmullClark)]
    {
        let points = ends(mesh, scheme);
        let vertex = |i: usize| mesh.positions[first + i % 7].as_dvec3();
        for (i, quarter) in (0..7).flat_map(|i| (0..4).map(move |quarter| (i, quarter))) {
            let weights = cubic(f64::from(quarter) / 4.0);
            let p: DVec3 = weights.iter().enumerate().map(|(k, w)| vertex(i + k) * *w).sum();
            assert!(nearest(&points, p) < 1e-12, "{scheme}: {i} {quarter}");
        }
    }
}
