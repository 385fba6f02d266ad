//! Geomorphs: at weight 0 the finer level, at weight 1 the coarser one, whatever the mesh and the method.
#![cfg(feature = "bake")]

mod seams;
mod textured;

use std::collections::{BTreeMap, BTreeSet};

use glam::{Vec2, Vec3, Vec4};
use lod_budget::bake::chain::{Chain, ChainLevel, Length, Limits, Plan, Stops, quietly};
use lod_budget::bake::deviation;
use lod_budget::bake::geomorph::{Fit, Geomorph, GeomorphError};
use lod_budget::bake::read::gltf;
use lod_budget::bake::scene::{Options, Scene};
use lod_budget::bake::shapes::{icosphere, torus};
use lod_budget::bake::simplify::{GarlandHeckbert, Method, Simplified, Topology};
use lod_budget::bake::split::{self, split};
use lod_budget::bake::write::{LevelOut, Measured, glb};
use lod_budget::bake::{Group, Mesh, Surface};
#[cfg(feature = "files")]
use lod_budget::table::LevelRecord;
use proptest::prelude::*;
use seams::meshes;
use textured::{append, grid};

// -- meshes

/// With colours that follow from places, and tangents that follow from normals.
fn dressed(mut mesh: Mesh) -> Mesh {
    mesh.colours =
        mesh.wedges.iter().map(|&p| mesh.positions[p as usize].abs().extend(1.0).min(Vec4::ONE)).collect();
    mesh.tangents = mesh.normals.iter().map(|n| n.any_orthonormal_vector().extend(1.0)).collect();
    mesh
}

fn textured_torus(rings: u32, sides: u32) -> Mesh {
    dressed(textured::torus(rings, sides))
}

fn hard_box(cells: u32) -> Mesh {
    dressed(textured::hard_box(cells, 0.1))
}

// -- chains

/// Few samples, and no look: what is measured is another test's.
fn plan(method: Method, stops: Stops) -> Plan {
    let measure = deviation::Options { max_samples: 1 << 8, max_splits: 1, ..deviation::Options::default() };
    Plan { method, stops, limits: Limits::NONE, measure, look: None, ..Plan::default() }
}

fn bake(plan: &Plan, mesh: &Mesh) -> Chain {
    plan.bake(mesh, &mut quietly).expect("mesh and plan keep the rules")
}

fn halves() -> Stops {
    Stops::Shares(vec![0.5, 0.25, 0.1, 0.04])
}

fn morph(chain: &Chain, finer: usize, coarser: usize) -> Geomorph {
    chain.geomorph(finer, coarser).expect("both levels are there")
}

// -- what a mesh looks like, without its numbering

/// A corner as it is drawn: bits of its position, and of its attributes.
type Corner = ([u32; 3], Vec<u32>);

fn corner(mesh: &Mesh, wedge: u32) -> Corner {
    let w = wedge as usize;
    let bits = |x: &f32| (x + 0.0).to_bits();
    let mut look = Vec::new();
    look.extend(mesh.normals.get(w).into_iter().flat_map(|n| n.to_array()));
    look.extend(mesh.colours.get(w).into_iter().flat_map(|c| c.to_array()));
    look.extend(mesh.tangents.get(w).into_iter().flat_map(|t| t.truncate().to_array()));
    look.extend(mesh.uvs.iter().flat_map(|set| set[w].to_array()));
    let place = mesh.positions[mesh.wedges[w] as usize].to_array();
    (place.map(|x| bits(&x)), look.iter().map(bits).collect())
}

/// The triangles that have three places, each with its material, corners from the lowest place on.
fn drawn(mesh: &Mesh) -> BTreeSet<(Option<String>, [Corner; 3])> {
    let mut drawn = BTreeSet::new();
    for group in &mesh.groups {
        for triangle in &mesh.triangles[group.triangles.clone()] {
            let mut corners = triangle.map(|wedge| corner(mesh, wedge));
            let lowest = (0..3).min_by_key(|&i| corners[i].0).unwrap_or(0);
            corners.rotate_left(lowest);
            let places = corners.each_ref().map(|c| c.0);
            if places[0] != places[1] && places[1] != places[2] && places[2] != places[0] {
                drawn.insert((group.material.clone(), corners));
            }
        }
    }
    drawn
}

fn places(drawn: BTreeSet<(Option<String>, [Corner; 3])>) -> BTreeSet<[[u32; 3]; 3]> {
    drawn.into_iter().map(|(_, corners)| corners.map(|c| c.0)).collect()
}

/// At weight 0 the finer mesh, at weight 1 the triangles of the coarser one and none but those.
fn check_ends(morph: &Geomorph, finer: &Mesh, coarser: &Mesh) {
    assert_eq!(morph.target.check(), Ok(()));
    assert_eq!(morph.at(finer, 0.0), *finer);
    assert_eq!(morph.at(finer, -1.0), *finer);
    assert_eq!(morph.at(finer, 1.0), morph.target);
    assert_eq!(morph.target.triangles, finer.triangles);
    assert_eq!(morph.fit, Fit::Exact);
    assert_eq!(places(drawn(&morph.target)), places(drawn(coarser)));
}

/// No vertex goes farther than the movement says, and one goes as far.
fn check_movement(morph: &Geomorph, finer: &Mesh) {
    let far =
        finer.positions.iter().zip(&morph.target.positions).map(|(a, b)| a.as_dvec3().distance(b.as_dvec3()));
    let most = far.fold(0.0, f64::max);
    let max = f64::from(morph.movement.max);
    assert!(most <= max && max <= most * (1.0 + 1e-6), "{most} {max}");
    assert!(morph.movement.mean <= max && morph.movement.mean >= 0.0);
}

// -- exact ones

#[test]
fn every_method_but_those_that_fill_or_do_not_nest_ends_in_exactly_the_coarser_level() {
    for mesh in [textured_torus(32, 16), hard_box(6)] {
        for method in Method::ALL {
            let chain = bake(&plan(method, halves()), &mesh);
            assert!(chain.levels.len() > 2, "{method}");
            for (finer, coarser) in pairs(&chain) {
                let (fine, coarse) = (&chain.levels[finer].mesh, &chain.levels[coarser].mesh);
                let morph = morph(&chain, finer, coarser);
                check_movement(&morph, fine);
                let nests = method != Method::Decimate && (method != Method::Cluster || finer == 0);
                assert!(morph.fit == Fit::Exact || !nests && finer < coarser, "{method} {finer} {coarser}");
                if morph.fit == Fit::Exact {
                    check_ends(&morph, fine, coarse);
                    assert!(drawn(&morph.target) == drawn(coarse), "{method} {finer} {coarser}: attributes");
                }
            }
        }
    }
}

fn pairs(chain: &Chain) -> impl Iterator<Item = (usize, usize)> {
    let count = chain.levels.len();
    (0..count).flat_map(move |finer| (finer..count).map(move |coarser| (finer, coarser)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn quadrics_end_in_exactly_the_coarser_level(mesh in meshes(), is_free in any::<bool>()) {
        let topology = if is_free { Topology::Free } else { Topology::Preserved };
        let quadric = GarlandHeckbert { topology, ..GarlandHeckbert::default() };
        let chain = bake(&Plan { quadric, ..plan(Method::Quadric, halves()) }, &mesh);
        for (finer, coarser) in pairs(&chain) {
            let morph = morph(&chain, finer, coarser);
            let (fine, coarse) = (&chain.levels[finer].mesh, &chain.levels[coarser].mesh);
            check_ends(&morph, fine, coarse);
            check_movement(&morph, fine);
            prop_assert!(drawn(&morph.target).is_superset(&drawn(coarse)));
        }
    }

    #[test]
    fn all_methods_end_in_the_places_of_the_coarser_level(mesh in meshes(), which in 0..Method::ALL.len()) {
        let method = Method::ALL[which];
        let chain = bake(&plan(method, halves()), &mesh);
        for (finer, coarser) in pairs(&chain) {
            let morph = morph(&chain, finer, coarser);
            let fine = &chain.levels[finer].mesh;
            check_movement(&morph, fine);
            if morph.fit == Fit::Exact {
                check_ends(&morph, fine, &chain.levels[coarser].mesh);
            }
            prop_assert!(morph.target.positions.iter().all(|p| p.is_finite()));
            let is_strange = method == Method::Decimate || method == Method::Cluster && finer > 0;
            prop_assert!(morph.fit == Fit::Exact || is_strange, "{} {} {}", method, finer, coarser);
        }
    }

    /// What goes from level to level goes to where the geomorph over all of them leads.
    #[test]
    fn geomorphs_of_neighbours_add_up(mesh in meshes()) {
        let chain = bake(&plan(Method::Quadric, halves()), &mesh);
        let last = chain.levels.len() - 1;
        let all = morph(&chain, 0, last);
        let mut at: Vec<Vec3> = chain.levels[0].mesh.positions.clone();
        for step in 0..last {
            let finer = &chain.levels[step].mesh;
            let goes: BTreeMap<[u32; 3], Vec3> = finer.positions.iter().zip(morph(&chain, step, step + 1).target.positions)
                .map(|(from, to)| (from.to_array().map(f32::to_bits), to)).collect();
            at.iter_mut().for_each(|p| *p = goes[&p.to_array().map(f32::to_bits)]);
        }
        prop_assert_eq!(at, all.target.positions);
    }

    /// Between the ends everything is on the straight way there, and one step is a share of the movement.
    #[test]
    fn between_the_ends_everything_goes_straight(mesh in meshes(), weight in 0.01..0.99f32, step in 0.0..0.1f32) {
        let chain = bake(&plan(Method::Quadric, halves()), &mesh);
        let fine = &chain.levels[0].mesh;
        let morph = morph(&chain, 0, 1);
        let [now, next] = [weight, weight + step].map(|weight| morph.at(fine, weight));
        prop_assert_eq!(now.check(), Ok(()));
        for (i, (from, to)) in fine.positions.iter().zip(&morph.target.positions).enumerate() {
            let (from, to) = (from.as_dvec3(), to.as_dvec3());
            let way = from.lerp(to, f64::from(weight));
            prop_assert!(now.positions[i].as_dvec3().distance(way) < 1e-5 * (1.0 + from.length() + to.length()));
            let stepped = now.positions[i].distance(next.positions[i]);
            prop_assert!(stepped <= step * morph.movement.max + 1e-5 * (1.0 + from.length() as f32));
            if from == to {
                prop_assert_eq!(now.positions[i], fine.positions[i]);
            }
        }
    }

    /// Whatever mix of weights neighbouring chunks have, no vertex of their common border moves.
    #[test]
    fn borders_of_chunks_stay(mesh in meshes(), weight in 0.0..1.0f32) {
        let chunks = split(&mesh, &split::Options { triangles: mesh.triangles.len() / 3 + 1, ..split::Options::default() });
        for chunk in &chunks {
            let plan = plan(Method::Quadric, halves());
            let chain = plan.bake_locked(&chunk.mesh, &chunk.locked, &mut quietly);
            let Ok(chain) = chain else { continue };
            let locked = chunk.mesh.positions.iter().zip(&chunk.locked).filter(|(_, locked)| **locked);
            let fixed: BTreeSet<[u32; 3]> = locked.map(|(p, _)| p.to_array().map(f32::to_bits)).collect();
            for (finer, coarser) in pairs(&chain) {
                let fine = &chain.levels[finer].mesh;
                let at = morph(&chain, finer, coarser).at(fine, weight);
                let moved = fine.positions.iter().zip(&at.positions).filter(|(from, to)| from != to);
                for (from, _) in moved {
                    prop_assert!(!fixed.contains(&from.to_array().map(f32::to_bits)), "{from}");
                }
            }
        }
    }
}

/// A wedge at a seam goes to the side of the seam that it is on: the texture never slides across the chart.
#[test]
fn seams_stay_whole_all_the_way() {
    let mesh = textured_torus(48, 24);
    let chain = bake(&plan(Method::Quadric, halves()), &mesh);
    for (finer, coarser) in pairs(&chain) {
        let fine = &chain.levels[finer].mesh;
        let target = morph(&chain, finer, coarser).target;
        for (wedge, &position) in fine.wedges.iter().enumerate() {
            let far = fine.positions[position as usize].distance(target.positions[position as usize]);
            let slid = fine.uvs[0][wedge].distance(target.uvs[0][wedge]);
            // Once around the tube is 0.3 · τ: a unit of UV is 1.9 long at least. Across the seam it would slide by one.
            assert!(slid <= far / 1.8 + 0.1, "{slid} {far}");
        }
    }
}

#[test]
fn what_vanishes_shrinks_to_a_point() {
    let mut mesh: Mesh = icosphere(6).into();
    let ball = Mesh::from(icosphere(2));
    mesh.uvs = vec![vec![Vec2::ZERO; mesh.wedges.len()]];
    let small = Mesh {
        positions: ball.positions.iter().map(|p| Vec3::X * 3.0 + 0.01 * p).collect(),
        uvs: vec![vec![Vec2::ZERO; ball.wedges.len()]],
        ..ball
    };
    let count = mesh.positions.len();
    append(&mut mesh, small);
    let quadric = GarlandHeckbert { topology: Topology::Free, ..GarlandHeckbert::default() };
    let chain = bake(&Plan { quadric, ..plan(Method::Quadric, Stops::Shares(vec![0.1, 0.05])) }, &mesh);
    let coarse = &chain.levels.last().expect("there is one").mesh;
    assert!(coarse.positions.iter().all(|p| p.x < 2.0), "the small ball is gone");
    let morph = morph(&chain, 0, chain.levels.len() - 1);
    check_ends(&morph, &chain.levels[0].mesh, coarse);
    let ball = &morph.target.positions[count..];
    assert!(ball.iter().all(|p| *p == ball[0] && p.distance(Vec3::X * 3.0) < 0.01));
}

#[test]
fn one_level_and_the_same_level_stay_as_they_are() {
    let mesh = hard_box(3);
    let chain = bake(&plan(Method::Quadric, Stops::Shares(Vec::new())), &mesh);
    assert_eq!((chain.levels.len(), chain.geomorphs().expect("none")), (1, Vec::new()));
    let still = morph(&chain, 0, 0);
    assert_eq!((&still.target, still.fit), (&chain.levels[0].mesh, Fit::Exact));
    assert_eq!((still.movement.max, still.movement.mean), (0.0, 0.0));
    let twice =
        Chain::of_levels(vec![mesh.clone(), mesh.clone()], &deviation::Options::default()).expect("measured");
    assert_eq!(morph(&twice, 0, 1).target, mesh);
}

#[test]
fn levels_that_are_not_there_are_named() {
    let chain = bake(&plan(Method::Quadric, halves()), &torus(12, 8, 0.4).into());
    let count = chain.levels.len();
    let error = chain.geomorph(1, 0).expect_err("backwards");
    assert_eq!(error, GeomorphError::Levels { finer: 1, coarser: 0, levels: count });
    assert!(chain.geomorph(0, count).is_err());
    let mut broken = chain.levels[1].mesh.clone();
    broken.positions[3].y = f32::NAN;
    let error = Geomorph::between(&chain.levels[0].mesh, &broken, None).expect_err("not finite");
    assert_eq!(error.to_string(), "the coarser mesh '': position 3 must be finite");
    let error = Geomorph::between(&Mesh::default(), &broken, None).expect_err("empty");
    assert_eq!(error.to_string(), "the finer mesh '': it must have a triangle");
}

/// Somebody changes the levels of a chain: what became of what is no longer known, and nothing wrong is made up.
#[test]
fn wrong_heirs_are_found_out() {
    let mut chain = bake(&plan(Method::Quadric, halves()), &torus(24, 12, 0.4).into());
    chain.levels.remove(1);
    let found = morph(&chain, 0, 1);
    if found.fit == Fit::Exact {
        check_ends(&found, &chain.levels[0].mesh, &chain.levels[1].mesh);
    }
    let (fine, coarse) = (&chain.levels[0].mesh, &chain.levels[1].mesh);
    let zeros = vec![0; fine.positions.len()];
    let gone = vec![Simplified::GONE; fine.positions.len()];
    for heirs in [&zeros, &gone, &zeros[1..].to_vec(), &vec![u32::MAX - 1; zeros.len()]] {
        let morph = Geomorph::between(fine, coarse, Some(heirs)).expect("nearest points will do");
        assert_eq!(morph.fit, Fit::Nearest);
        assert!(morph.movement.max < 0.6, "{:?}", morph.movement);
    }
}

/// Levels for errors are searched for: they need not follow from each other, but always from level 0.
#[test]
fn levels_for_errors_follow_from_the_finest() {
    let stops =
        Stops::Errors(vec![Length::OfDiagonal(0.002), Length::OfDiagonal(0.01), Length::OfDiagonal(0.03)]);
    let chain = bake(&plan(Method::Quadric, stops), &textured_torus(48, 24));
    assert!(chain.levels.len() > 2);
    for coarser in 1..chain.levels.len() {
        check_ends(&morph(&chain, 0, coarser), &chain.levels[0].mesh, &chain.levels[coarser].mesh);
    }
}

// -- nearest ones

/// To the nearest of many points on a surface.
fn distance(mesh: &Mesh, point: Vec3) -> f32 {
    let corners = |t: &[u32; 3]| t.map(|w| mesh.positions[mesh.wedges[w as usize] as usize]);
    let spots = mesh.triangles.iter().map(corners).flat_map(|[a, b, c]| {
        (0..=12).flat_map(move |i| {
            (0..=12 - i).map(move |j| a + (b - a) * (i as f32 / 12.0) + (c - a) * (j as f32 / 12.0))
        })
    });
    spots.map(|spot| spot.distance(point)).fold(f32::INFINITY, f32::min)
}

#[test]
fn levels_of_unknown_origin_go_to_the_nearest_points() {
    let [fine, coarse] = [textured_torus(32, 16), textured_torus(12, 8)];
    let chain = Chain::of_levels(vec![fine.clone(), coarse.clone()], &deviation::Options::default())
        .expect("measured");
    let morph = morph(&chain, 0, 1);
    assert_eq!(morph.fit, Fit::Nearest);
    check_movement(&morph, &fine);
    for (from, to) in fine.positions.iter().zip(&morph.target.positions) {
        assert!(distance(&coarse, *to) < 0.03, "{to} is on the coarser surface");
        assert!(from.distance(*to) < 0.15 && from.distance(*to) <= 1.5 * distance(&coarse, *from) + 0.02);
    }
    for (wedge, &position) in fine.wedges.iter().enumerate() {
        let (own, new) = (fine.uvs[0][wedge], morph.target.uvs[0][wedge]);
        assert!(own.distance(new) < 0.1, "{own} {new} at {}", fine.positions[position as usize]);
        assert!((morph.target.normals[wedge].length() - 1.0).abs() < 1e-4);
        assert!(fine.normals[wedge].dot(morph.target.normals[wedge]) > 0.8);
    }
}

/// A plate with two sides so close together that the other side is nearer: each vertex stays on its own.
#[test]
fn thin_plates_are_not_turned_inside_out() {
    let plate = |cells: u32, bulge: f32| {
        let mut both = Mesh { uvs: vec![Vec::new()], ..Mesh::default() };
        for side in [1.0, -1.0f32] {
            append(
                &mut both,
                grid(cells, cells, |column, row| {
                    let uv = Vec2::new(column as f32, row as f32) / cells as f32;
                    let x = if side > 0.0 { uv.x } else { 1.0 - uv.x };
                    let height = side * (0.01 + bulge * (x * (1.0 - x) * uv.y * (1.0 - uv.y)));
                    (Vec3::new(x, uv.y, height), Vec3::Z * side, uv)
                }),
            );
        }
        both
    };
    let (fine, coarse) = (plate(16, -0.3), plate(3, 0.0));
    let morph = Geomorph::between(&fine, &coarse, None).expect("both are meshes");
    for (wedge, &position) in fine.wedges.iter().enumerate() {
        let goal = morph.target.positions[position as usize];
        assert!(fine.normals[wedge].z * goal.z > 0.0, "{goal}");
        assert_eq!(morph.target.normals[wedge], fine.normals[wedge]);
    }
}

/// An open plate that is smaller and turned a little: its border goes to the border.
#[test]
fn borders_go_to_borders() {
    let plate = |cells: u32, size: f32| {
        grid(cells, cells, |column, row| {
            let uv = Vec2::new(column as f32, row as f32) / cells as f32;
            ((size * (uv - 0.5)).extend(0.0), Vec3::Z, uv)
        })
    };
    let (fine, coarse) = (plate(16, 0.9), plate(4, 1.0));
    let morph = Geomorph::between(&fine, &coarse, None).expect("both are meshes");
    for (from, to) in fine.positions.iter().zip(&morph.target.positions) {
        let is_border = |p: &Vec3, half: f32| (p.truncate().abs().max_element() - half).abs() < 1e-5;
        assert_eq!(is_border(from, 0.45), is_border(to, 0.5), "{from} {to}");
        assert!(is_border(from, 0.45) || from.distance(*to) < 1e-5);
    }
}

/// Columns that one mesh has and the other has not stay as they are; one triangle and no area are meshes too.
#[test]
fn odd_meshes_morph() {
    let bare: Mesh =
        Surface { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]] }.into();
    let point = Mesh { positions: vec![Vec3::ONE; 3], ..bare.clone() };
    let full = hard_box(2);
    for (finer, coarser) in
        [(&full, &bare), (&bare, &full), (&full, &point), (&point, &bare), (&bare, &point)]
    {
        let morph = Geomorph::between(finer, coarser, None).expect("both are meshes");
        assert_eq!(morph.target.check(), Ok(()));
        assert_eq!(morph.at(finer, 0.5).check(), Ok(()));
        assert!(morph.target.positions.iter().all(|p| p.is_finite()));
        check_movement(&morph, finer);
    }
    let morph = Geomorph::between(&full, &bare, None).expect("both are meshes");
    assert_eq!((&morph.target.normals, &morph.target.uvs), (&full.normals, &full.uvs));
}

// -- as morph targets

/// The JSON and the bytes of a GLB.
fn parts(glb: &[u8]) -> (serde_json::Value, &[u8]) {
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    (serde_json::from_slice(&glb[20..20 + length]).expect("JSON"), &glb[28 + length..])
}

/// The rows of an accessor of floats.
fn rows((json, bytes): &(serde_json::Value, &[u8]), accessor: &serde_json::Value) -> Vec<Vec<f32>> {
    let accessor = &json["accessors"][accessor.as_u64().expect("an index") as usize];
    assert_eq!(accessor["componentType"], 5126);
    let view = &json["bufferViews"][accessor["bufferView"].as_u64().expect("an index") as usize];
    let width = usize::from(accessor["type"].as_str().expect("a type").as_bytes()[3] - b'0');
    let start = view["byteOffset"].as_u64().expect("an offset") as usize;
    let floats = bytes[start..].as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b));
    let all: Vec<f32> = floats.take(accessor["count"].as_u64().expect("a count") as usize * width).collect();
    let rows: Vec<Vec<f32>> = all.chunks(width).map(<[f32]>::to_vec).collect();
    for (bound, of) in [("min", f32::min as fn(f32, f32) -> f32), ("max", f32::max)] {
        let Some(stated) = accessor[bound].as_array() else { continue };
        for (i, stated) in stated.iter().enumerate() {
            let found = rows.iter().map(|row| row[i]).reduce(of).expect("rows");
            assert_eq!(stated.as_f64(), Some(f64::from(found)), "{bound}");
        }
    }
    rows
}

fn levels<'a>(chain: &'a Chain, morphs: &'a [Geomorph]) -> Vec<LevelOut<'a>> {
    let level = |(i, level): (usize, &'a ChainLevel)| LevelOut {
        measured: Some(Measured {
            error: level.error,
            hausdorff: level.deviation.hausdorff,
            rms: level.deviation.rms(),
        }),
        coverage: Some(0.5 / (1 << i) as f32),
        accuracy: Some(1.0 - i as f32 / 16.0),
        geomorph: morphs.get(i),
        ..LevelOut::new(&level.mesh)
    };
    chain.levels.iter().enumerate().map(level).collect()
}

#[test]
fn a_morph_target_leads_to_the_next_level() {
    let mut mesh = hard_box(6);
    mesh.name = "box".into();
    let half = mesh.triangles.len() / 2;
    let group = |name: &str, triangles| Group { material: Some(name.into()), triangles, ..Group::default() };
    mesh.groups = vec![group("a", 0..half), group("b", half..mesh.triangles.len())];
    let chain = bake(&plan(Method::Quadric, halves()), &mesh);
    let morphs = chain.geomorphs().expect("all levels are there");
    let file = glb(&levels(&chain, &morphs)).expect("written");
    let parts = parts(&file);
    let meshes = parts.0["meshes"].as_array().expect("a list");
    assert_eq!(meshes.len(), chain.levels.len());
    assert!(meshes.last().expect("one")["primitives"][0].get("targets").is_none());
    for (i, (written, morph)) in meshes.iter().zip(&morphs).enumerate() {
        assert_eq!(written["weights"], serde_json::json!([0.0]));
        assert_eq!(
            written["extras"]["targetNames"],
            serde_json::json!([format!("geomorph_to_LOD{}", i + 1)])
        );
        assert_eq!(written["extras"]["lod_geomorph_max"], f64::from(morph.movement.max));
        let coarser = &chain.levels[i + 1].mesh.positions;
        for primitive in written["primitives"].as_array().expect("a list") {
            let (own, target) = (&primitive["attributes"], &primitive["targets"][0]);
            assert_eq!(primitive["targets"].as_array().map(Vec::len), Some(1));
            let names = |of: &serde_json::Value| {
                of.as_object().expect("an object").keys().cloned().collect::<Vec<_>>()
            };
            assert_eq!(names(target), ["COLOR_0", "NORMAL", "POSITION", "TANGENT", "TEXCOORD_0"]);
            for name in names(target) {
                let (own, steps) = (rows(&parts, &own[&name]), rows(&parts, &target[&name]));
                assert_eq!(
                    (own.len(), steps[0].len()),
                    (steps.len(), if name == "TANGENT" { 3 } else { own[0].len() })
                );
                if name == "POSITION" {
                    for (own, step) in own.iter().zip(&steps) {
                        let end = Vec3::from_slice(own) + Vec3::from_slice(step);
                        let off = coarser.iter().map(|p| (*p - end).abs().max_element()).fold(1.0, f32::min);
                        // The last place of a number below 2.
                        assert!(off <= 2.0 * f32::EPSILON, "{off}");
                    }
                }
            }
        }
    }
}

/// Who does not know geomorphs reads the same levels as without.
#[test]
fn files_with_morph_targets_are_read_as_chains() {
    let mut mesh = textured_torus(32, 16);
    mesh.name = "torus".into();
    let chain = bake(&plan(Method::Quadric, halves()), &mesh);
    let morphs = chain.geomorphs().expect("all levels are there");
    let [with, without] = [&morphs[..], &[]].map(|morphs| glb(&levels(&chain, morphs)).expect("written"));
    let read = |file: &[u8]| -> Vec<Mesh> {
        let files = gltf::read_meshes(file, "torus.glb", None).unwrap_or_else(|e| panic!("{e}"));
        files.into_iter().map(|file| file.mesh).collect()
    };
    assert_eq!(read(&with), read(&without));
    for file in [&with, &without] {
        let scene =
            Scene::open(file, "torus.glb", None, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
        let [authored] = scene.authored() else { panic!("one chain, not {}", scene.authored().len()) };
        assert_eq!((authored.levels.len(), scene.parts().len()), (chain.levels.len(), 0));
        assert_eq!(scene.left(), []);
    }
}

#[cfg(feature = "files")]
#[test]
fn tables_of_files_with_morph_targets_differ_in_bytes_alone() {
    use lod_budget::files;
    let chain = bake(&plan(Method::Quadric, halves()), &textured_torus(32, 16));
    let morphs = chain.geomorphs().expect("all levels are there");
    let [with, without] = [&morphs[..], &[]].map(|morphs| {
        let file = glb(&levels(&chain, morphs)).expect("written");
        files::Scene::from_gltf(&file, "torus.glb").unwrap_or_else(|e| panic!("{e}")).tables.remove(0)
    });
    assert_eq!(with.bounds(), without.bounds());
    for (i, (a, b)) in with.levels().iter().zip(without.levels()).enumerate() {
        assert_eq!(a.bytes > b.bytes, i < morphs.len());
        let bytes = b.bytes;
        assert_eq!(LevelRecord { bytes, ..*a }, *b);
    }
}

#[test]
fn a_geomorph_of_another_mesh_is_refused() {
    let chain = bake(&plan(Method::Quadric, halves()), &torus(12, 8, 0.4).into());
    let morphs = chain.geomorphs().expect("all levels are there");
    let level = LevelOut { geomorph: Some(&morphs[1]), ..LevelOut::new(&chain.levels[0].mesh) };
    let refusal = glb(&[level]).expect_err("another mesh").to_string();
    assert_eq!(refusal, "_LOD0: its geomorph must be one of this mesh");
}
