//! Control meshes of every kind of vertex.

use std::f32::consts::TAU;

use glam::{DVec3, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use crate::bake::subdivide::{ControlMesh, SharpEdge, SharpVertex};

pub(super) fn of_faces(count: usize, faces: &[Vec<u32>]) -> ControlMesh {
    let positions = (0..count).map(|i| Vec3::new(i as f32, 0.0, 0.0)).collect();
    let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    ControlMesh::of_faces(positions, &faces)
}

/// Positions from −1 to 1, the same for the same seed.
pub(super) fn scatter(mut mesh: ControlMesh, seed: u64) -> ControlMesh {
    let mut dice = Pcg32::seed_from_u64(seed);
    mesh.positions
        .iter_mut()
        .for_each(|p| *p = Vec3::from_array(std::array::from_fn(|_| dice.random_range(-1.0..1.0))));
    mesh
}

/// Two poles, and `n` vertices between them: triangles, poles of valence n and others of 4.
pub(super) fn bipyramid(n: u32) -> ControlMesh {
    let sides = (0..n).flat_map(|i| [vec![0, 2 + i, 2 + (i + 1) % n], vec![1, 2 + (i + 1) % n, 2 + i]]);
    let mut mesh = of_faces(n as usize + 2, &sides.collect::<Vec<_>>());
    let around =
        |i: u32| Vec3::new((TAU * i as f32 / n as f32).cos(), (TAU * i as f32 / n as f32).sin(), 0.0);
    mesh.positions = [Vec3::Z, -Vec3::Z].into_iter().chain((0..n).map(around)).collect();
    mesh
}

/// A bottom and a top of `n` corners, and quads between them.
pub(super) fn prism(n: u32) -> ControlMesh {
    let sides = (0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]);
    let ends = [(0..n).rev().collect(), (n..2 * n).collect::<Vec<_>>()];
    of_faces(2 * n as usize, &sides.chain(ends).collect::<Vec<_>>())
}

/// A pole of `n` quads around it, closed below by a polygon of 2n corners.
pub(super) fn quad_fan(n: u32) -> ControlMesh {
    let around = |i: u32| 1 + i % (2 * n);
    let quads = (0..n).map(|i| vec![0, around(2 * i), around(2 * i + 1), around(2 * i + 2)]);
    of_faces(2 * n as usize + 1, &quads.chain([(0..2 * n).rev().map(around).collect()]).collect::<Vec<_>>())
}

/// `n` × `n` vertices in a plane, quads in between.
pub(super) fn quad_grid(n: u32) -> ControlMesh {
    let quads = (0..(n - 1) * (n - 1)).map(|i| (i % (n - 1)) + n * (i / (n - 1)));
    let mut mesh =
        of_faces((n * n) as usize, &quads.map(|at| vec![at, at + 1, at + n + 1, at + n]).collect::<Vec<_>>());
    mesh.positions = (0..n * n).map(|i| Vec3::new((i % n) as f32, (i / n) as f32, 0.0)).collect();
    mesh
}

/// As [`quad_grid`], every quad cut from its first to its third corner.
pub(super) fn triangle_grid(n: u32) -> ControlMesh {
    let quads = quad_grid(n);
    let halves = quads.corners.chunks(4).flat_map(|q| [vec![q[0], q[1], q[2]], vec![q[0], q[2], q[3]]]);
    let mesh = of_faces((n * n) as usize, &halves.collect::<Vec<_>>());
    ControlMesh { positions: quads.positions, ..mesh }
}

/// Makes edges, or vertices where there is one position, as sharp as that.
pub(super) fn sharp(mut mesh: ControlMesh, features: &[&[u32]], sharpness: f32) -> ControlMesh {
    for feature in features {
        match **feature {
            [position] => mesh.sharp_vertices.push(SharpVertex { position, sharpness }),
            _ => mesh
                .sharp_edges
                .extend(feature.windows(2).map(|e| SharpEdge { ends: [e[0], e[1]], sharpness })),
        }
    }
    mesh
}

/// Triangles: closed ones of all valences, borders, creases of all kinds, and what is no manifold.
pub(super) fn of_triangles() -> Vec<(String, ControlMesh)> {
    let named = |name: &str, mesh: ControlMesh| (name.to_owned(), scatter(mesh, 7));
    let mut shapes: Vec<_> = (3..=12).map(|n| named(&format!("bipyramid {n}"), bipyramid(n))).collect();
    let tetrahedron = || of_faces(4, &[vec![0, 1, 2], vec![0, 2, 3], vec![0, 3, 1], vec![1, 3, 2]]);
    let f = f32::INFINITY;
    shapes.extend([
        named("tetrahedron", tetrahedron()),
        named("two triangles back to back", of_faces(3, &[vec![0, 1, 2], vec![0, 2, 1]])),
        named("one triangle", of_faces(3, &[vec![0, 1, 2]])),
        named("border", triangle_grid(4)),
        named("sharp corners", sharp(triangle_grid(4), &[&[0], &[3], &[12], &[15]], f)),
        named("bow tie", of_faces(5, &[vec![0, 1, 2], vec![0, 3, 4]])),
        named("three faces at an edge", of_faces(5, &[vec![0, 1, 2], vec![1, 0, 3], vec![0, 1, 4]])),
        named("crease", sharp(bipyramid(7), &[&[2, 3, 4, 5, 6, 7, 8, 2]], f)),
        named("dart", sharp(bipyramid(7), &[&[0, 3]], f)),
        named("two darts", sharp(tetrahedron(), &[&[0, 3]], f)),
        named("corner of creases", sharp(bipyramid(9), &[&[0, 3], &[0, 5], &[0, 9, 1]], f)),
        named("crease beside many", sharp(bipyramid(12), &[&[3, 0, 4]], f)),
        named("inside out", of_faces(4, &[vec![0, 1, 2], vec![0, 1, 3], vec![0, 3, 2], vec![1, 3, 2]])),
    ]);
    shapes
}

/// Quads and other polygons, likewise.
pub(super) fn of_polygons() -> Vec<(String, ControlMesh)> {
    let named = |name: &str, mesh: ControlMesh| (name.to_owned(), scatter(mesh, 11));
    let mut shapes: Vec<_> = (3..=8).map(|n| named(&format!("prism {n}"), prism(n))).collect();
    shapes.extend((3..=12).map(|n| named(&format!("fan {n}"), quad_fan(n))));
    let f = f32::INFINITY;
    shapes.extend(of_triangles());
    shapes.extend([
        named("one quad", of_faces(4, &[vec![0, 1, 2, 3]])),
        named("two quads back to back", of_faces(4, &[vec![0, 1, 2, 3], vec![3, 2, 1, 0]])),
        named("one pentagon", of_faces(5, &[vec![0, 1, 2, 3, 4]])),
        named("valence 2", of_faces(5, &[vec![0, 1, 2, 4], vec![0, 4, 2, 3]])),
        named("border", quad_grid(4)),
        named("sharp corners", sharp(quad_grid(4), &[&[0], &[3], &[12], &[15]], f)),
        named("bow tie", of_faces(7, &[vec![0, 1, 2, 3], vec![0, 4, 5, 6]])),
        named("three quads at an edge", of_faces(8, &[vec![0, 1, 2, 3], vec![1, 0, 4, 5], vec![0, 1, 6, 7]])),
        named("crease", sharp(prism(4), &[&[0, 1, 2, 3, 0]], f)),
        named("dart", sharp(quad_fan(3), &[&[0, 1]], f)),
        named("corner of creases", sharp(quad_fan(6), &[&[1, 0, 3], &[0, 7]], f)),
        named("crease beside many", sharp(quad_fan(9), &[&[1, 0, 3]], f)),
    ]);
    shapes
}

/// The same shapes with creases that fade, at `sharpness`.
pub(super) fn semi_sharp(sharpness: f32) -> Vec<(String, ControlMesh)> {
    let cube = || scatter(prism(4), 5);
    vec![
        ("ring".into(), sharp(cube(), &[&[0, 1, 2, 3, 0]], sharpness)),
        ("dart".into(), sharp(cube(), &[&[0, 1]], sharpness)),
        ("corner".into(), sharp(cube(), &[&[0, 1], &[0, 3], &[0, 4]], sharpness)),
        ("vertex".into(), sharp(cube(), &[&[0]], sharpness)),
        (
            "across a crease".into(),
            sharp(sharp(cube(), &[&[0, 1, 2, 3, 0]], f32::INFINITY), &[&[0, 4]], sharpness),
        ),
        ("unlike".into(), sharp(sharp(cube(), &[&[0, 1, 2]], sharpness), &[&[2, 3, 0]], 1.7 * sharpness)),
        ("border".into(), sharp(scatter(quad_grid(4), 5), &[&[5, 1], &[5, 6, 10]], sharpness)),
    ]
}

pub(super) fn in_double(mesh: &ControlMesh) -> Vec<DVec3> {
    mesh.positions.iter().map(|p| p.as_dvec3()).collect()
}
