//! Attributes, seams and materials through a simplification.
#![cfg(feature = "bake")]

mod textured;

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};
use lod_budget::bake::simplify::{
    Attributes, GarlandHeckbert, Placement, Simplified, Simplifier, Stopped, Target, Task, Topology, quietly,
};
use lod_budget::bake::{Group, Mesh};
use proptest::prelude::*;
use textured::{grid, hard_box, torus};

fn simplify(method: &GarlandHeckbert, mesh: &Mesh, triangles: usize) -> Simplified {
    let task = Task::new(mesh, Target::triangles(triangles));
    let simplified = method.simplify(&task, &mut quietly).expect("the task keeps the rules");
    assert_eq!(simplified.mesh.check(), Ok(()));
    simplified
}

/// Per directed edge of positions, the wedges at its ends.
fn sides(mesh: &Mesh) -> BTreeMap<[u32; 2], [u32; 2]> {
    let edges = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let position = |wedges: [u32; 2]| wedges.map(|w| mesh.wedges[w as usize]);
    mesh.triangles.iter().flat_map(edges).map(|wedges| (position(wedges), wedges)).collect()
}

#[test]
fn a_texture_stays_where_it_was_and_its_seams_stay_whole() {
    let torus = torus(96, 32);
    let shares = [2, 4, 8];
    let targets = shares.map(|share| Target::triangles(torus.triangles.len() / share));
    let task = Task::new(&torus, targets[0]);
    let chain = GarlandHeckbert::default().chain(&task, &targets, &mut quietly).expect("it keeps the rules");
    for (level, target) in chain.iter().zip(targets) {
        let mesh = &level.mesh;
        assert_eq!((level.stopped, mesh.check()), (Stopped::Triangles, Ok(())));
        assert!(mesh.triangles.len() <= target.triangles);
        for (wedge, &position) in mesh.wedges.iter().enumerate() {
            let [uv, at] = [mesh.uvs[0][wedge].extend(0.0), mesh.positions[position as usize]];
            let [sin, cos] = [(std::f32::consts::TAU * uv.x).sin(), (std::f32::consts::TAU * uv.x).cos()];
            let off = (at.truncate().normalize() - Vec2::new(cos, sin)).length();
            assert!(off < 0.03, "{off} at {at}");
            assert!((mesh.normals[wedge].length() - 1.0).abs() < 1e-5);
            let out = at - Vec3::new(cos, sin, 0.0);
            assert!(mesh.normals[wedge].dot(out.normalize()) > 0.9, "{at}");
        }
        let sides = sides(mesh);
        let mut seams = 0;
        for (&[a, b], &wedges) in &sides {
            let twin = sides.get(&[b, a]).expect("it is closed");
            for (one, other) in [(wedges[0], twin[1]), (wedges[1], twin[0])] {
                let jump = mesh.uvs[0][one as usize] - mesh.uvs[0][other as usize];
                seams += usize::from(jump != Vec2::ZERO);
                let near = jump.abs().min((jump.abs() - 1.0).abs());
                assert!(near.max_element() < 0.03, "{jump}");
                let hard = mesh.normals[one as usize] != mesh.normals[other as usize];
                assert!(!hard, "the normals have no seam");
            }
        }
        assert!(seams > 0 && seams < sides.len() / 2);
    }
}

/// What is contracted at once, and what goes on from where a level stopped, is the same.
#[test]
fn a_chain_is_its_levels_one_by_one() {
    let torus = torus(48, 16);
    let targets = [700, 300, 300, 100, 500].map(Target::triangles);
    let method = GarlandHeckbert::default();
    let chain = method.chain(&Task::new(&torus, targets[0]), &targets, &mut quietly).expect("a good task");
    for (level, target) in chain.iter().zip(targets) {
        assert_eq!(*level, simplify(&method, &torus, target.triangles));
    }
}

#[test]
fn a_box_of_six_charts_becomes_twelve_triangles() {
    let mesh = hard_box(8, 0.0);
    assert_eq!((mesh.triangles.len(), mesh.positions.len(), mesh.wedges.len()), (768, 386, 486));
    let level = simplify(&GarlandHeckbert::default(), &mesh, 12).mesh;
    assert_eq!((level.triangles.len(), level.positions.len(), level.wedges.len()), (12, 8, 24));
    for triangle in &level.triangles {
        let corners = triangle.map(|w| level.positions[level.wedges[w as usize] as usize]);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        for (wedge, corner) in triangle.iter().zip(corners) {
            assert!((corner.abs() - 1.0).abs().max_element() < 1e-5, "{corner}");
            assert!(level.normals[*wedge as usize].dot(normal) > 0.9999);
            let uv = level.uvs[0][*wedge as usize];
            assert!(uv.min(1.0 - uv).abs().max_element() < 1e-4, "{uv}");
        }
    }
}

/// A flat square of two materials that meet along a wave.
#[test]
fn materials_keep_their_border() {
    let cells = 40;
    let wave = |x: f32| 0.5 + 0.2 * (6.0 * x).sin();
    let mut mesh = grid(cells, cells, |column, row| {
        let [x, t] = [column as f32, row as f32].map(|i| i / cells as f32);
        let y = if t < 0.5 { 2.0 * t * wave(x) } else { wave(x) + (2.0 * t - 1.0) * (1.0 - wave(x)) };
        (Vec3::new(x, y, 0.0), Vec3::Z, Vec2::ZERO)
    });
    let half = mesh.triangles.len() / 2;
    let material =
        |name: &str, triangles| Group { material: Some(name.into()), triangles, ..Group::default() };
    mesh.groups = vec![material("below", 0..half), material("above", half..2 * half)];
    let level = simplify(&GarlandHeckbert::default(), &mesh, 200).mesh;
    assert_eq!(level.groups.len(), 2);
    for group in &level.groups {
        for t in group.triangles.clone() {
            let corners = level.triangles[t].map(|w| level.positions[level.wedges[w as usize] as usize]);
            let center = corners.iter().sum::<Vec3>() / 3.0;
            let above = center.y - wave(center.x);
            let is_above = group.material.as_deref() == Some("above");
            assert!(if is_above { above > -0.02 } else { above < 0.02 }, "{center} is {above} above");
        }
    }
}

#[test]
fn ignored_attributes_go_along_and_the_shape_is_as_if_there_were_none() {
    let torus = torus(48, 16);
    let bare = Mesh::from(torus.surface());
    let method = GarlandHeckbert { attributes: Attributes::IGNORED, ..Default::default() };
    let [textured, plain] = [&torus, &bare].map(|mesh| simplify(&method, mesh, 300));
    assert_eq!(textured.mesh.surface(), plain.mesh.surface());
    assert_eq!(textured.heirs, plain.heirs);
    assert_eq!(textured.mesh.normals.len(), textured.mesh.wedges.len());
}

#[test]
fn end_points_keep_their_attributes_bit_by_bit() {
    let torus = torus(24, 12);
    let method = GarlandHeckbert { placement: Placement::Endpoint, ..Default::default() };
    let level = simplify(&method, &torus, 200);
    for (wedge, &position) in level.mesh.wedges.iter().enumerate() {
        let origin = level.origins[position as usize];
        let same = |w: &usize| torus.wedges[*w] == origin && torus.normals[*w] == level.mesh.normals[wedge];
        assert!((0..torus.wedges.len()).any(|w| same(&w)), "a normal from nowhere");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// Soups of triangles whose corners have any attributes, in any groups.
    #[test]
    fn anything_goes_in_and_what_comes_out_is_a_mesh(
        corners in prop::collection::vec([0..24u32, 0..24, 0..24], 0..60),
        places in prop::collection::vec([0..4i8, 0..4, 0..3], 10),
        values in prop::collection::vec((0..10u32, 0..3i8, 0..3i8), 24),
        (target, free, cut) in (0..60usize, any::<bool>(), 0..60usize),
    ) {
        let count = corners.len();
        let cut = cut.min(count);
        let mesh = Mesh {
            positions: places.iter().map(|&[x, y, z]| Vec3::new(x.into(), y.into(), z.into())).collect(),
            wedges: values.iter().map(|v| v.0).collect(),
            normals: values.iter().map(|v| [Vec3::X, Vec3::Z, Vec3::ZERO][v.1 as usize]).collect(),
            uvs: vec![values.iter().map(|v| Vec2::new(v.1.into(), v.2.into())).collect(); 2],
            colours: values.iter().map(|v| glam::Vec4::splat(f32::from(v.2) / 2.0)).collect(),
            triangles: corners,
            groups: [0..cut, cut..count].map(|triangles| Group { triangles, ..Group::default() }).to_vec(),
            ..Mesh::default()
        };
        let topology = if free { Topology::Free } else { Topology::Preserved };
        let method = GarlandHeckbert { topology, ..Default::default() };
        let level = simplify(&method, &mesh, target).mesh;
        prop_assert!(level.triangles.len() <= count);
        prop_assert!(level.uvs[0].iter().all(|uv| uv.is_finite()) && level.normals.iter().all(|n| n.is_finite()));
        prop_assert!((0..level.wedges.len() as u32).all(|w| level.triangles.as_flattened().contains(&w)));
    }
}
