//! The procedural scenes and their paths: the same from the same seed, honest tables, and a load that swings.
#![cfg(feature = "sim")]

use std::collections::HashSet;
use std::fs;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};
use lod_budget::files::{CameraPath, Pose, Scene};
use lod_budget::scene::Object;
use lod_budget::sim::generate::{Recipe, scatter, scatter_path};
use lod_budget::table::{LevelRecord, LodTable};
use lod_budget::view::{Lens, View};

fn bundled() -> impl Iterator<Item = (Recipe, Scene, CameraPath)> {
    Recipe::ALL.into_iter().map(|r| (r, r.scene(r.bundled_seed()), r.path(r.bundled_seed())))
}

#[test]
fn the_same_seed_gives_the_same_scene_and_path() {
    for recipe in Recipe::ALL {
        assert_eq!(recipe.scene(5), recipe.scene(5));
        assert_eq!(recipe.path(5), recipe.path(5));
        assert_ne!(recipe.scene(5), recipe.scene(6));
        assert_ne!(recipe.path(5), recipe.path(6));
    }
    assert_eq!(scatter(1000, 5), scatter(1000, 5));
    assert_ne!(scatter(1000, 5), scatter(1000, 6));
}

/// The files under `scenes/` are what the generators make, byte for byte, wherever this runs. Where a generator is
/// meant to change, `lod generate NAME --out scenes` renews them.
#[test]
fn the_bundled_files_are_what_the_generators_make() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    for (recipe, scene, path) in bundled() {
        let file = |extension| folder.join(format!("{recipe}.{extension}"));
        let same =
            |extension, text: String| text.into_bytes() == fs::read(file(extension)).expect("a bundled file");
        assert!(
            same("json", scene.to_json().expect("a good scene")),
            "{recipe}.json is not what is generated"
        );
        assert!(same("csv", path.to_csv()), "{recipe}.csv is not what is generated");
        assert_eq!(Scene::read(&file("json")).expect("a scene"), scene);
        assert_eq!(CameraPath::read(&file("csv")).expect("a path"), path);
    }
}

/// Kinds as meshes: nothing missing, nothing without an area, on the grid of a platform that has no grid of its own.
#[test]
fn models_are_sound() {
    for model in Recipe::ALL.into_iter().flat_map(Recipe::models) {
        let name = &model.name;
        let ends: Vec<_> = model.materials.iter().map(|(_, run)| (run.start, run.end)).collect();
        assert!(
            ends.windows(2).all(|w| w[0].1 == w[1].0) && ends.iter().all(|(a, b)| a < b),
            "{name}: {ends:?}"
        );
        assert_eq!((ends[0].0, ends[ends.len() - 1].1), (0, model.triangles.len()), "{name}");
        let materials: HashSet<_> = model.materials.iter().map(|(material, _)| material).collect();
        assert_eq!(materials.len(), ends.len(), "{name}: a material has two runs");
        let steps = |x: f32| x * 16384.0 == (x * 16384.0).round();
        assert!(model.positions.iter().all(|p| p.to_array().into_iter().all(steps)), "{name}");
        let used: HashSet<u32> = model.triangles.iter().flatten().copied().collect();
        assert_eq!(used.len(), model.positions.len(), "{name}: a position is of no use");
        let flat =
            model.triangles.iter().filter(|t| area(t.map(|corner| model.positions[corner as usize])) == 0.0);
        assert_eq!(flat.count(), 0, "{name}: triangles without an area");
    }
}

fn area([a, b, c]: [Vec3; 3]) -> f32 {
    (b - a).cross(c - a).length() / 2.0
}

#[test]
fn ids_are_unique_and_objects_valid() {
    for (recipe, scene, _) in bundled() {
        let ids: HashSet<_> = scene.objects.iter().map(|o| o.id).collect();
        assert_eq!(ids.len(), scene.objects.len(), "{recipe}");
        assert!(scene.objects.iter().all(|o| o.bounds.is_valid() && o.bounds.radius > 0.0), "{recipe}");
        let store = scene.to_objects().expect("every object is accepted");
        assert_eq!((store.len(), store.broken_bounds()), (ids.len(), 0), "{recipe}");
    }
}

#[test]
fn scenes_have_the_sizes_they_are_said_to_have() {
    let sizes = bundled().map(|(_, scene, _)| scene.objects.len());
    for (size, expected) in sizes.zip([2500usize, 4000, 4500]) {
        assert!(size.abs_diff(expected) < expected / 8, "{size} objects, not about {expected}");
    }
}

/// Being the only level is no fault: a box has no coarser box.
const HARMLESS: &str = "it is the only level: nothing to select";

#[test]
fn tables_are_monotone_and_free_of_lints() {
    let scenes = bundled().map(|(_, scene, _)| scene).chain([scatter(10, 1)]);
    for table in scenes.flat_map(|scene| scene.tables) {
        let serious: Vec<_> = table.lint().into_iter().filter(|l| l.rule != HARMLESS).collect();
        assert_eq!(serious, [], "{}", table.name());
        assert!(table.levels().windows(2).all(|w| steps_down(&w[0], &w[1])), "{table:?}");
        assert_eq!(table.levels()[0].error, Some(0.0), "{}", table.name());
    }
}

fn steps_down(finer: &LevelRecord, coarser: &LevelRecord) -> bool {
    coarser.triangles < finer.triangles
        && coarser.vertices <= finer.vertices
        && coarser.draws <= finer.draws
        && coarser.bytes <= finer.bytes
        && coarser.error >= finer.error
        && coarser.error > Some(0.0)
}

#[test]
fn tables_are_those_of_a_game() {
    for (recipe, scene, _) in bundled() {
        let levels = || scene.tables.iter().flat_map(|t| t.levels());
        let counts: HashSet<_> = scene.tables.iter().map(|t| t.levels().len()).collect();
        assert!(counts.len() >= 3, "{recipe}: {counts:?} levels");
        assert!(levels().all(|l| (1..=5).contains(&l.draws)), "{recipe}");
        assert!(levels().all(|l| (4..=60_000).contains(&l.triangles)), "{recipe}");
        assert!(levels().any(|l| l.triangles >= 20_000), "{recipe}: nobody is a hero");
        // An error beyond the object's own diameter would be no measure of anything.
        let within = |t: &LodTable| t.levels().iter().all(|l| l.error <= Some(2.0 * t.bounds().radius));
        assert_eq!(scene.tables.iter().find(|t| !within(t)), None, "{recipe}");
        let gains: HashSet<_> = scene.objects.iter().map(|o| o.settings.importance.to_bits()).collect();
        assert!(gains.len() >= 3, "{recipe}: objects are all of the same importance");
    }
}

/// What is in view of one pose, were it drawn at its finest and at its coarsest.
#[derive(Clone, Copy)]
struct Load {
    objects: usize,
    finest: u64,
    coarsest: u64,
}

fn load(scene: &Scene, lens: &Lens) -> Load {
    let seen = |o: &&Object| {
        lens.frustum.sees(&o.bounds) && lens.distance(o.bounds.center) <= o.settings.draw_distance
    };
    let none = Load { objects: 0, finest: 0, coarsest: 0 };
    scene.objects.iter().filter(seen).fold(none, |sum, object| {
        let levels = scene.tables[usize::from(object.table.0)].levels();
        let triangles = |level: &LevelRecord| u64::from(level.triangles);
        Load {
            objects: sum.objects + 1,
            finest: sum.finest + triangles(&levels[0]),
            coarsest: sum.coarsest + triangles(&levels[levels.len() - 1]),
        }
    })
}

fn lens(pose: &Pose) -> Lens {
    let view = View::perspective(60f32.to_radians(), Vec2::new(1920.0, 1080.0));
    view.at(pose.position.as_vec3(), pose.rotation).lens(DVec3::ZERO)
}

fn loads(scene: &Scene, path: &CameraPath) -> Vec<Load> {
    path.poses().iter().step_by(4).map(|pose| load(scene, &lens(pose))).collect()
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

/// One line per path: what a reader of `cargo test -- --nocapture` wants to know.
fn report(recipe: Recipe, scene: &Scene, loads: &[Load]) {
    let line = |name: &str, of: fn(&Load) -> u64| {
        let (min, max) = (loads.iter().map(of).min(), loads.iter().map(of).max());
        let mean = mean(loads.iter().map(|l| of(l) as f64)).round();
        println!("  {name}: min {} mean {mean} max {}", min.unwrap_or(0), max.unwrap_or(0));
    };
    let all: Vec<u64> = (0..2).map(|end| scene.objects.iter().map(|o| end_of(scene, o, end)).sum()).collect();
    println!("{recipe}: {} objects, {} tables", scene.objects.len(), scene.tables.len());
    println!("  triangles: {} at the finest, {} at the coarsest", all[0], all[1]);
    let by_second: Vec<u64> = loads.iter().step_by(10).map(|l| l.finest / 1000).collect();
    println!("  thousands of finest triangles in view, every two seconds: {by_second:?}");
    line("objects in view", |l| l.objects as u64);
    line("finest triangles in view", |l| l.finest);
    line("coarsest triangles in view", |l| l.coarsest);
}

fn end_of(scene: &Scene, object: &Object, end: usize) -> u64 {
    let levels = scene.tables[usize::from(object.table.0)].levels();
    u64::from(levels[if end == 0 { 0 } else { levels.len() - 1 }].triangles)
}

#[test]
fn the_load_swings_along_every_path() {
    for (recipe, scene, path) in bundled() {
        let loads = loads(&scene, &path);
        report(recipe, &scene, &loads);
        let least = loads.iter().map(|l| l.finest).min().expect("a pose");
        let most = loads.iter().map(|l| l.finest).max().expect("a pose");
        assert!(least > 0 && most >= 3 * least, "{recipe}: from {least} to {most} triangles");
        let ratio = mean(loads.iter().map(|l| l.coarsest as f64 / l.finest as f64));
        assert!(ratio <= 0.2, "{recipe}: the coarsest levels take {ratio} of the finest");
        assert!(loads.iter().all(|l| l.objects > 0), "{recipe}: nothing in view");
    }
}

#[test]
fn paths_are_walks_of_a_minute_with_a_rest() {
    for (recipe, _, path) in bundled() {
        let poses = path.poses();
        let (first, last) = (poses[0].time_s, poses[poses.len() - 1].time_s);
        assert!((60.0..=90.0).contains(&(last - first)), "{recipe}: {} s", last - first);
        let step = |w: &[Pose]| w[1].time_s - w[0].time_s;
        assert!(poses.windows(2).all(|w| (0.03..=0.11).contains(&step(w))), "{recipe}");
        let rest = poses.windows(2).filter(|w| same_place(&w[0], &w[1])).count();
        assert!(rest >= 40, "{recipe}: rests for {rest} poses");
    }
}

fn same_place(a: &Pose, b: &Pose) -> bool {
    a.position == b.position && a.rotation == b.rotation
}

#[test]
fn nobody_runs_faster_than_his_legs_but_where_the_path_jumps() {
    let top_speed = |recipe| match recipe {
        Recipe::City => 100.0,
        _ => 12.0,
    };
    for (recipe, _, path) in bundled() {
        let speed = |w: &[Pose]| (w[1].position - w[0].position).length() / (w[1].time_s - w[0].time_s);
        let jumps = path.poses().windows(2).filter(|w| speed(w) > top_speed(recipe)).count();
        assert_eq!(jumps, usize::from(recipe != Recipe::City), "{recipe}");
    }
}

#[test]
fn a_scatter_has_every_size_and_level_count() {
    let scene = scatter(20_000, 1);
    assert_eq!(scene.objects.len(), 20_000);
    let radii = || scene.objects.iter().map(|o| o.bounds.radius);
    let (small, large) = (radii().fold(f32::MAX, f32::min), radii().fold(0.0, f32::max));
    assert!(large / small >= 100.0, "{small} to {large}");
    let counts: HashSet<_> = scene.tables.iter().map(|t| t.levels().len()).collect();
    assert_eq!(counts, (1..=6).collect());
    assert!(scatter(0, 1).objects.is_empty());
    scene.to_objects().expect("every object is accepted");
}

#[test]
fn a_scatter_of_any_size_has_a_path_through_it() {
    for objects in [0, 10, 20_000, 1_000_000] {
        let path = scatter_path(objects, 1);
        assert_eq!((path.breaks(), path.poses().len()), (&[][..], 600), "{objects} objects");
    }
    let loads = loads(&scatter(20_000, 1), &scatter_path(20_000, 1));
    let objects: Vec<usize> = loads.iter().map(|l| l.objects).collect();
    assert!(objects.iter().all(|&n| n > 0) && objects.iter().any(|&n| n > 1000), "{objects:?}");
    assert_ne!(scatter_path(10, 1), scatter_path(10, 2));
}
