//! Golden decisions: the levels of every frame along the bundled paths, hashed. What is hashed are decisions, never
//! floats, so that the hashes hold wherever the per-frame maths (+ − × ÷ √) rounds as IEEE 754 says.
//!
//! A changed hash means that some object was shown at another level in some frame. If that is intended, run the test,
//! read the new hashes off its message, and say in the commit why decisions changed.
#![cfg(feature = "sim")]

use glam::Vec2;
use lod_budget::frame::{FrameTime, GroupId};
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
use lod_budget::select::{
    FunkhouserSequin, Predictive, PredictiveOptions, Reactive, ReactiveOptions, ScreenSize, Selector,
};
use lod_budget::sim::generate::Recipe;
use lod_budget::view::{Projection, View, Window};

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
        let mut shown: Vec<(u64, u8)> = runtime
            .shown_slots(GroupId(0))
            .filter_map(|(slot, shown)| Some((objects.id_of(slot)?.0, shown.level.0)))
            .collect();
        shown.sort_unstable();
        hash =
            shown.iter().fold(mix(hash, k as u64), |hash, &(id, level)| mix(mix(hash, id), u64::from(level)));
    }
    hash
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

const GOLDEN: [(&str, &str, u64); 15] = [
    ("building", "static", 0x2f590871b89f91c5),
    ("building", "reactive", 0x051719a321cf9007),
    ("building", "funkhouser-sequin", 0x47cb243574b2ac77),
    ("building", "predictive, priced", 0x7ef98b24939046d4),
    ("building", "predictive", 0x9cfc7d4b620e995d),
    ("city", "static", 0x907a2b16fb0bc664),
    ("city", "reactive", 0x560cd49e8b7dc391),
    ("city", "funkhouser-sequin", 0xdce214cfc99ae577),
    ("city", "predictive, priced", 0x34355eead36659ef),
    ("city", "predictive", 0xd67c7d2f2309818d),
    ("forest", "static", 0x78e69e7156fa279f),
    ("forest", "reactive", 0xcea1ec3019e316c3),
    ("forest", "funkhouser-sequin", 0xd61b4bc65fcc1ffb),
    ("forest", "predictive, priced", 0xbc8895dc4ab060d8),
    ("forest", "predictive", 0x4bc05e4b2aa03414),
];
