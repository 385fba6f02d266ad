//! Golden decisions: the levels of every frame along the bundled paths, hashed. What is hashed are decisions, never
//! floats, so that the hashes hold wherever the per-frame maths (+ − × ÷ √) rounds as IEEE 754 says.
//!
//! A changed hash means that some object was shown at another level in some frame. If that is intended, run the test,
//! read the new hashes off its message, and say in the commit why decisions changed.
#![cfg(feature = "sim")]

use glam::{Quat, Vec2, Vec3};
use lod_budget::frame::{FrameTime, GroupId};
use lod_budget::kernel::{Width, limit_width, width};
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
use lod_budget::scene::{BLOCK, Objects};
use lod_budget::select::{
    FunkhouserSequin, Predictive, PredictiveOptions, Reactive, ReactiveOptions, ScreenSize, Selector,
};
use lod_budget::sim::generate::{Recipe, scatter};
use lod_budget::view::{Projection, View, Window};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg32;

const FRAMES: usize = 150;

/// FNV-1a over 64-bit words.
fn mix(hash: u64, word: u64) -> u64 {
    (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3)
}

/// A 60° camera given by its tangents, which no library function rounds.
fn camera() -> View {
    let window = Window::symmetric(1.026_400_5, 0.577_350_26);
    View::through(Projection::Perspective(window), Vec2::new(1920.0, 1080.0))
}

/// The levels of every object in view in every frame, on a machine a tenth slower than expected, measured two frames
/// late.
fn decisions(recipe: Recipe, selector: Box<dyn Selector>, budget_us: f64) -> u64 {
    let (scene, path) = (recipe.scene(recipe.bundled_seed()), recipe.path(recipe.bundled_seed()));
    let mut objects = scene.to_objects().expect("a good scene");
    let mut runtime = Runtime::new(RuntimeOptions::default(), selector).expect("good options");
    let mut times: Vec<FrameTime> = Vec::new();
    let mut hash = 0xcbf2_9ce4_8422_2325;
    for k in 0..FRAMES {
        let pose = path.sample(path.start_s() + path.duration_s() * k as f64 / FRAMES as f64);
        let views = [ViewInput::new(View { origin: pose.position, rotation: pose.rotation, ..camera() }, 0)];
        let known = if k >= 2 { &times[k - 2..k - 1] } else { &[] };
        let report = *runtime
            .frame(&mut objects, &FrameInput { measured: known, ..FrameInput::new(&views, budget_us) });
        let model_us = report.select.cost_us;
        times.push(FrameTime::busy(report.frame, (model_us * 1.1) as f32));
        hash = mix_shown(mix(hash, k as u64), &runtime, &objects);
    }
    hash
}

/// Mixes in the level of every object in view.
fn mix_shown(hash: u64, runtime: &Runtime, objects: &Objects) -> u64 {
    let shown = runtime.shown_slots(GroupId(0));
    let mut levels: Vec<(u64, u8)> =
        shown.filter_map(|(slot, shown)| Some((objects.id_of(slot)?.0, shown.level.0))).collect();
    levels.sort_unstable();
    levels.iter().fold(hash, |hash, &(id, level)| mix(mix(hash, id), u64::from(level)))
}

fn policies() -> [(&'static str, Box<dyn Selector>); 5] {
    let priced = Predictive::new(PredictiveOptions { steadiness: None, ..Default::default() });
    let reactive = Reactive::new(ReactiveOptions::default()).expect("good defaults");
    [
        ("static", Box::new(ScreenSize::default())),
        ("reactive", Box::new(reactive)),
        ("funkhouser-sequin", Box::new(FunkhouserSequin::default())),
        ("predictive, priced", Box::new(priced.expect("good options"))),
        ("predictive", Box::new(Predictive::default())),
    ]
}

#[test]
fn decisions_along_the_bundled_paths_are_the_golden_ones() {
    let mut found = Vec::new();
    for (recipe, budget_us) in
        [(Recipe::Building, 2_000.0), (Recipe::City, 8_000.0), (Recipe::Forest, 5_000.0)]
    {
        for (policy, selector) in policies() {
            found.push((recipe.name(), policy, decisions(recipe, selector, budget_us)));
        }
    }
    assert_eq!(found, GOLDEN, "found {found:#x?}");
}

/// So many objects that the loops over them are cut in eight.
const CROWD: usize = 150_000;

/// The same objects, inserted in an order of their own.
fn shuffled(objects: &Objects, seed: u64) -> Objects {
    let slots = 0..objects.blocks().len() * BLOCK;
    let mut ids: Vec<_> = slots.filter_map(|slot| objects.id_of(slot)).collect();
    ids.shuffle(&mut Pcg32::seed_from_u64(seed));
    let mut again = Objects::new();
    objects.tables().iter().for_each(|table| {
        again.add_table(table.clone()).expect("a good table");
    });
    let all = ids.into_iter().filter_map(|id| objects.get(id));
    all.for_each(|object| again.insert(object).expect("a new id"));
    again
}

/// The levels of a crowd in a few frames of a moving camera that turns around once.
fn crowd_decisions(mut objects: Objects, selector: Box<dyn Selector>, threads: usize) -> u64 {
    let options = RuntimeOptions { threads, ..RuntimeOptions::default() };
    let mut runtime = Runtime::new(options, selector).expect("good options");
    let spheres = objects.blocks().iter().flat_map(|b| (0..BLOCK).map(|lane| b.sphere(lane).center.length()));
    let radius = spheres.fold(0.0, f32::max);
    let mut hash = 0xcbf2_9ce4_8422_2325;
    for k in 0..8 {
        let (eye, far) = (Vec3::new(k as f32, 100.0, radius * 1.9), f32::INFINITY);
        let rotation = if k == 5 { Quat::from_xyzw(0.0, 1.0, 0.0, 0.0) } else { Quat::IDENTITY };
        let views = [ViewInput::new(View { far, ..camera() }.at(eye, rotation), 0)];
        runtime.frame(&mut objects, &FrameInput::new(&views, 10.0 * CROWD as f64));
        hash = mix_shown(hash, &runtime, &objects);
    }
    hash
}

#[test]
fn neither_width_nor_threads_nor_the_order_of_insertion_change_a_decision() {
    let objects = scatter(CROWD, 7).to_objects().expect("a good scene");
    for (policy, selector) in policies().into_iter().filter(|(name, _)| *name != "funkhouser-sequin") {
        let of = |objects: Objects| crowd_decisions(objects, selector.clone(), 1);
        limit_width(Width::Compiled);
        let expected = of(shuffled(&objects, 0));
        for widest in Width::ALL.into_iter().filter(|w| w.is_here()) {
            assert_eq!(limit_width(widest), widest);
            assert_eq!(of(shuffled(&objects, 1)), expected, "{policy}, {widest:?}");
        }
        for threads in [2, 8] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let (objects, selector) = (shuffled(&objects, 2), selector.clone());
            let found = pool.install(move || crowd_decisions(objects, selector, threads));
            assert_eq!(found, expected, "{policy}, {threads} threads");
        }
        assert_eq!(limit_width(Width::Avx512), width());
    }
}

const GOLDEN: [(&str, &str, u64); 15] = [
    ("building", "static", 0xc20ca74ad4e57c80),
    ("building", "reactive", 0xba06ab8a92c4e1ba),
    ("building", "funkhouser-sequin", 0xf9e04f451568f4b0),
    ("building", "predictive, priced", 0xbade081699ee2c00),
    ("building", "predictive", 0x93b84081e9c6ab8e),
    ("city", "static", 0xe6d080dbaab54201),
    ("city", "reactive", 0x026bf9762d68ea4e),
    ("city", "funkhouser-sequin", 0x1db1df5d1850881c),
    ("city", "predictive, priced", 0x5312e4b382faa579),
    ("city", "predictive", 0x9c5ecf90b815b55d),
    ("forest", "static", 0x4e8e1848c062c564),
    ("forest", "reactive", 0x0b7534d67f3b499d),
    ("forest", "funkhouser-sequin", 0x9129583178510702),
    ("forest", "predictive, priced", 0x28a6258d2442fb9c),
    ("forest", "predictive", 0x92f34a5ea775b8ab),
];
