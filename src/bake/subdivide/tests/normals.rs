//! Normals against splines, and against the faces of a deep subdivision.

use glam::{DVec3, Vec3};

use super::shapes::{self, of_polygons, of_triangles, semi_sharp};
use crate::bake::subdivide::fan::fans;
use crate::bake::subdivide::level::{Level, Stack};
use crate::bake::subdivide::limits::{closer, star};
use crate::bake::subdivide::net::Rule;
use crate::bake::subdivide::{ControlMesh, Placement, Scheme};

fn all() -> impl Iterator<Item = (Scheme, String, ControlMesh)> {
    let loops = of_triangles().into_iter().map(|(name, mesh)| (Scheme::Loop, name, mesh));
    let quads = of_polygons().into_iter().map(|(name, mesh)| (Scheme::CatmullClark, name, mesh));
    let fading = [0.5, 2.25].into_iter().flat_map(semi_sharp);
    loops.chain(quads).chain(fading.map(|(name, mesh)| (Scheme::CatmullClark, name, mesh)))
}

/// The faces around a vertex after many subdivisions, as large as they were: per face its corner's normal, by the areas
/// of those it hangs together with. `None` where they come to no plane, or only slowly: many faces, tips, sides of
/// corners and creases that are too wide, and single quads.
fn deep_normals(level: &Level, scheme: Scheme, vertex: u32) -> Vec<Option<DVec3>> {
    let sides = if scheme == Scheme::Loop { 3 } else { 4 };
    let at = |corner: &usize| level.net.corners[*corner] == vertex;
    let faces: Vec<u32> =
        (0..level.net.corners.len()).filter(at).map(|corner| (corner / sides) as u32).collect();
    let (mut net, old) = star(&level.net, vertex, &faces);
    let mut points: Vec<DVec3> = old.iter().map(|&v| level.positions[v as usize]).collect();
    // A single triangle gets thinner by half with every subdivision, and is what it will be at once.
    let steps = if faces.len() == 1 { 12 } else { 60 };
    for _ in 0..steps {
        (net, points) = closer(scheme, &net, &points);
        let (middle, farthest) =
            (points[0], points.iter().map(|p| p.distance(points[0])).fold(0.0, f64::max));
        points.iter_mut().for_each(|p| *p = (*p - middle) / farthest);
    }
    let rule = net.rules(f32::MAX)[0];
    let own: Vec<u32> = (0..net.corners.len() as u32).filter(|&c| net.corners[c as usize] == 0).collect();
    let is_cut = |edge: u32| rule != Rule::Smooth && net.edges[edge as usize].sharpness > 0.0;
    let mut normals = vec![None; own.len()];
    for fan in fans(&net, &own, is_cut) {
        let is_plane = match (rule, scheme, fan.corners.len()) {
            (Rule::Smooth, _, faces) => (3..=12).contains(&faces),
            (Rule::Crease(_), Scheme::Loop, faces) => (2..=5).contains(&faces) || own.len() == 1,
            (Rule::Crease(_), Scheme::CatmullClark, faces) => (2..=4).contains(&faces),
            (Rule::Corner, _, faces) => faces == 1,
        };
        let area = |&(i, is_turned): &(usize, bool)| {
            let corners: Vec<DVec3> =
                net.face(own[i] as usize / sides).iter().map(|&v| points[v as usize]).collect();
            let twice: DVec3 = (0..sides).map(|k| corners[k].cross(corners[(k + 1) % sides])).sum();
            if is_turned { -twice } else { twice }
        };
        let normal: DVec3 = fan.corners.iter().map(area).sum();
        for (i, is_turned) in fan.corners.into_iter().filter(|_| is_plane && normal.length() > 1e-9) {
            normals[i] = Some(if is_turned { -normal } else { normal }.normalize());
        }
    }
    normals
}

#[test]
fn normals_are_those_of_a_deep_subdivision() {
    let (mut tried, mut farthest) = (0, (0.0, String::new()));
    for (scheme, name, mesh) in all() {
        let stack = Stack::new(&mesh, scheme, 1).expect("a mesh");
        let (level, sides) = (stack.finest(), stack.sides());
        let (old, new) = (mesh.positions.len() as u32, level.positions.len() as u32);
        for vertex in (0..old).chain((old..new).step_by(9)) {
            let own = (0..level.net.corners.len()).filter(|&corner| level.net.corners[corner] == vertex);
            for (corner, deep) in own.zip(deep_normals(level, scheme, vertex)) {
                let Some(deep) = deep else { continue };
                let apart = deep.distance(sides.normals[sides.of_corner[corner] as usize].as_dvec3());
                tried += 1;
                if apart > farthest.0 {
                    farthest = (apart, format!("{scheme}, {name}: vertex {vertex}, {deep}"));
                }
            }
        }
    }
    assert!(tried > 1000 && farthest.0 < 2e-3, "{farthest:?}");
}

/// The uniform cubic B-spline's weights at a knot, and those of its derivative.
const KNOT: [[f64; 3]; 2] = [[1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0], [-0.5, 0.0, 0.5]];

#[test]
fn catmull_clark_on_a_regular_grid_has_the_b_splines_normals() {
    let mesh = shapes::scatter(shapes::quad_grid(6), 1);
    let stack = Stack::new(&mesh, Scheme::CatmullClark, 0).expect("a mesh");
    let sides = stack.sides();
    for (x, y) in (1..5).flat_map(|x| (1..5).map(move |y| (x, y))) {
        let tangent = |across: usize, along: usize| -> DVec3 {
            let weight = |i: usize, j: usize| KNOT[across][i] * KNOT[along][j];
            let at = |i: usize, j: usize| mesh.positions[x + i - 1 + 6 * (y + j - 1)].as_dvec3();
            (0..9).map(|k| at(k % 3, k / 3) * weight(k % 3, k / 3)).sum()
        };
        let normal = tangent(1, 0).cross(tangent(0, 1)).normalize();
        assert_normal(&stack, &sides.of_corner, &sides.normals, x + 6 * y, normal);
    }
}

/// By its derivatives along the grid at a vertex: 1/6 of the neighbours' differences along each of two triangles'
/// sides, twice that across it (C. Loop, 1987).
#[test]
fn loop_on_a_regular_grid_has_the_box_splines_normals() {
    let mesh = shapes::scatter(shapes::triangle_grid(6), 2);
    let stack = Stack::new(&mesh, Scheme::Loop, 0).expect("a mesh");
    let sides = stack.sides();
    for (x, y) in (1..5).flat_map(|x| (1..5).map(move |y| (x, y))) {
        let at = |i: usize, j: usize| mesh.positions[x + i - 1 + 6 * (y + j - 1)].as_dvec3();
        let along_x = (at(2, 1) - at(0, 1)) * 2.0 + (at(2, 2) - at(1, 2)) + (at(1, 0) - at(0, 0));
        let along_y = (at(1, 2) - at(1, 0)) * 2.0 + (at(2, 2) - at(2, 1)) + (at(0, 1) - at(0, 0));
        assert_normal(
            &stack,
            &sides.of_corner,
            &sides.normals,
            x + 6 * y,
            along_x.cross(along_y).normalize(),
        );
    }
}

fn assert_normal(stack: &Stack, of_corner: &[u32], normals: &[Vec3], vertex: usize, normal: DVec3) {
    let corners = &stack.finest().net.corners;
    let own = (0..corners.len()).filter(|&corner| corners[corner] as usize == vertex);
    for corner in own {
        let ours = normals[of_corner[corner] as usize].as_dvec3();
        assert!(ours.distance(normal) < 1e-6, "{vertex}: {ours}, not {normal}");
    }
}

/// All that coarser levels show is shown by finer ones, normals included.
#[test]
fn vertices_keep_their_normals() {
    for (scheme, name, mesh) in all() {
        let levels = mesh.subdivided(scheme, 2, Placement::Limit).expect("a mesh");
        let rows = |level: &crate::bake::Mesh| -> std::collections::BTreeSet<[u32; 6]> {
            let row = |(&position, normal): (&u32, &Vec3)| {
                let [a, b, c] = level.positions[position as usize].to_array().map(f32::to_bits);
                let [x, y, z] = normal.to_array().map(f32::to_bits);
                [a, b, c, x, y, z]
            };
            level.wedges.iter().zip(&level.normals).map(row).collect()
        };
        assert!(rows(&levels[1]).is_subset(&rows(&levels[0])), "{scheme}, {name}");
        assert!(rows(&levels[2]).is_subset(&rows(&levels[1])), "{scheme}, {name}");
        let lengths = levels.iter().flat_map(|level| &level.normals).map(|normal| normal.length());
        lengths.for_each(|length| assert!(length == 0.0 || (length - 1.0).abs() < 1e-6));
    }
}

#[test]
fn a_crease_is_a_hard_edge_and_what_fades_is_none() {
    let ring: [&[u32]; 1] = [&[0, 1, 2, 3, 0]];
    let wedges = |sharpness: f32| {
        let mesh = shapes::sharp(shapes::scatter(shapes::prism(4), 3), &ring, sharpness);
        let levels = mesh.catmull_clark(3).expect("a mesh");
        levels.iter().map(|level| level.wedges.len() - level.positions.len()).collect::<Vec<_>>()
    };
    assert_eq!(wedges(f32::INFINITY), [32, 16, 8, 4]);
    assert_eq!(wedges(2.5), [0; 4]);
}

/// A face that is turned over faces the other way, and nothing else does.
#[test]
fn faces_that_are_turned_over_face_the_other_way() {
    let flat = |faces: &[&[u32]]| {
        let positions = [(0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (2, 1)];
        let positions = positions.map(|(x, y)| Vec3::new(x as f32, y as f32, 0.0)).to_vec();
        ControlMesh::of_faces(positions, faces).catmull_clark(1).expect("a mesh").swap_remove(0)
    };
    let facing = |mesh: &crate::bake::Mesh, sign: f32| {
        let ups = mesh.triangles.iter().map(|t| t.map(|wedge| mesh.normals[wedge as usize].z * sign));
        ups.filter(|z| z.iter().all(|&z| (z - 1.0).abs() < 1e-6)).count()
    };
    let agreed = flat(&[&[0, 1, 2, 3], &[1, 4, 5, 2]]);
    assert_eq!((facing(&agreed, 1.0), facing(&agreed, -1.0)), (16, 0));
    let turned = flat(&[&[0, 1, 2, 3], &[2, 5, 4, 1]]);
    assert_eq!((facing(&turned, 1.0), facing(&turned, -1.0)), (8, 8));
}
