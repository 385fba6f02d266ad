//! What a frame of selection costs: rating alone, each policy alone, and the whole frame.
//!
//! ```text
//! cargo bench --features sim --bench frame
//! cargo bench --features sim --bench frame -- select/predictive/100000
//! ```
//!
//! | id | what | objects |
//! |---|---|---|
//! | `rate/N` | from visible blocks to candidates | N, all in view |
//! | `select/POLICY/N` | one selection, much the same as the last | N, all in view |
//! | `select/predictive-cold/N` | the same after a teleport: no object was in view before, and λ is unknown | N, all in view |
//! | `frame/POLICY/N` | a frame with its measurement, the camera moving by a step each time | N, a quarter in view |
//!
//! N is a power of ten of `scatter`, or `building` for the bundled scene in the middle of its path. Budgets are two
//! fifths of the way from what the frame costs at least to what it costs at most, so that nearly every object has to
//! be weighed. Divide by N for the time per object.

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DVec3, Quat, Vec2, Vec3};
use lod_budget::cull::{BlockTree, CullOptions};
use lod_budget::feedback::FeedbackOptions;
use lod_budget::frame::Candidates;
use lod_budget::rate::{BenefitModel, Seen, TableRates, rate};
use lod_budget::sim::Camera;
use lod_budget::sim::generate::{Recipe, scatter};
use lod_budget::view::{Projection, Window};
use lod_budget::{Coarsest, Finest, FunkhouserSequin, Predictive, Reactive, ScreenSize, Selector};
use lod_budget::{
    CostModel, FrameInput, FrameTime, Level, Objects, Runtime, RuntimeOptions, View, ViewInput,
};

const SIZES: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];
const SEED: u64 = 1;

/// Frames of a camera that goes round and round.
const ROUND: usize = 64;

/// Where things are measured.
struct Place {
    name: String,
    objects: Objects,
    /// Sees everything, for what is measured per object in view.
    wide: View,
    /// Sees about a quarter; moves along `ahead` by a step per frame.
    usual: View,
    ahead: Vec3,
}

impl Place {
    /// A scatter from outside one of its corners, along the diagonal and a quarter turn wide.
    fn scatter(objects: usize) -> Self {
        let side = 10.0 * (objects as f32).sqrt();
        let window = Projection::Perspective(Window::symmetric(1.0, 1.0));
        let corner = Vec3::new(-side, 0.0, -side) * 0.5;
        let ahead = Vec3::new(1.0, 0.0, 1.0).normalize();
        let rotation = Quat::from_rotation_y(-135f32.to_radians());
        let view = |eye| View::through(window, Vec2::new(1920.0, 1080.0)).at(eye, rotation);
        Self {
            name: objects.to_string(),
            objects: scatter(objects, SEED).to_objects().expect("a good scene"),
            wide: View { far: f32::INFINITY, ..view(corner - ahead * 100.0 + Vec3::Y * 20.0) },
            usual: View { far: side * 0.5, ..view(corner + Vec3::Y * 10.0) },
            ahead,
        }
    }

    fn building() -> Self {
        let recipe = Recipe::Building;
        let path = recipe.path(recipe.bundled_seed());
        let middle = path.sample((path.start_s() + path.end_s()) * 0.5);
        let usual = Camera::default().view(&middle);
        let objects = recipe.scene(recipe.bundled_seed()).to_objects().expect("a good scene");
        let outside =
            View::orthographic(200.0, usual.viewport_px).at(Vec3::new(0.0, 0.0, 500.0), Quat::IDENTITY);
        let ahead = usual.rotation * Vec3::NEG_Z;
        Self { name: recipe.to_string(), objects, wide: outside, usual, ahead }
    }

    fn all() -> impl Iterator<Item = Self> {
        SIZES.into_iter().map(Self::scatter).chain(std::iter::once_with(Self::building))
    }

    /// Two fifths of the way from the least to the most that a view can cost.
    fn budget_us(&mut self, view: View) -> f64 {
        let mut cost_us = |selector: Box<dyn Selector>| {
            let mut runtime = Runtime::new(options(), selector).expect("good options");
            let views = [ViewInput::new(view, 0)];
            runtime.frame(&mut self.objects, &FrameInput::new(&views, f64::MAX)).select.cost_us
        };
        let (least, most) = (cost_us(Box::new(Coarsest)), cost_us(Box::new(Finest)));
        least + 0.4 * (most - least)
    }
}

/// The whole budget is spent from the first frame on, and the machine is as expected.
fn options() -> RuntimeOptions {
    let feedback = FeedbackOptions { start: 1.0, headroom: 0.0, prior_deviation: 0.0, ..Default::default() };
    RuntimeOptions { feedback, ..RuntimeOptions::default() }
}

fn policies() -> [(&'static str, Box<dyn Selector>); 6] {
    [
        ("finest", Box::new(Finest)),
        ("coarsest", Box::new(Coarsest)),
        ("screen-size", Box::new(ScreenSize::default())),
        ("reactive", Box::new(Reactive::new(Default::default()).expect("good options"))),
        ("predictive", Box::new(Predictive::default())),
        ("funkhouser-sequin", Box::new(FunkhouserSequin::default())),
    ]
}

fn group<'a>(c: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = c.benchmark_group(name);
    group.sample_size(10).nresamples(2000);
    group.warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(500));
    group
}

fn rating(c: &mut Criterion) {
    for mut place in Place::all() {
        let mut tree = BlockTree::new();
        tree.update(&mut place.objects);
        let mut seen = [Seen { lens: place.wide.lens(DVec3::ZERO), visible: Vec::new() }];
        tree.cull(&place.objects, &seen[0].lens, &CullOptions::default(), &mut seen[0].visible);
        let mut rates = TableRates::default();
        rates.renew(place.objects.tables(), &CostModel::default());
        let (model, mut cursors) = (BenefitModel::default(), Vec::new());
        let mut candidates = Candidates::default();
        group(c, "rate").bench_function(&place.name, |b| {
            b.iter(|| {
                candidates.clear(rates.len());
                rate(&place.objects, &rates, black_box(&seen), &model, &mut cursors, &mut candidates);
            });
        });
    }
}

fn selecting(c: &mut Criterion) {
    for mut place in Place::all() {
        let budget_us = place.budget_us(place.wide);
        for (name, mut selector) in policies() {
            let runtime = after(3, &mut place, budget_us, &*selector);
            let frame = runtime.last_frame(&place.objects);
            let mut levels = vec![Level::NOT_DRAWN; frame.candidates.len()];
            group(c, "select").bench_function(BenchmarkId::new(name, &place.name), |b| {
                b.iter(|| selector.select(black_box(&frame), &mut levels));
            });
        }
        let mut selector =
            policies().into_iter().find(|(name, _)| *name == "predictive").expect("it is there").1;
        let runtime = after(1, &mut place, budget_us, &*selector);
        let frame = runtime.last_frame(&place.objects);
        let mut levels = vec![Level::NOT_DRAWN; frame.candidates.len()];
        group(c, "select").bench_function(BenchmarkId::new("predictive-cold", &place.name), |b| {
            b.iter(|| {
                selector.reset();
                selector.select(black_box(&frame), &mut levels)
            });
        });
    }
}

/// A runtime of this policy that has looked at everything in a place for so many frames.
fn after(frames: usize, place: &mut Place, budget_us: f64, selector: &dyn Selector) -> Runtime {
    let mut runtime = Runtime::new(options(), selector.boxed_clone()).expect("good options");
    for _ in 0..frames {
        runtime.frame(&mut place.objects, &FrameInput::new(&[ViewInput::new(place.wide, 0)], budget_us));
    }
    runtime
}

fn frames(c: &mut Criterion) {
    for mut place in Place::all() {
        let budget_us = place.budget_us(place.usual);
        for (name, selector) in policies() {
            let mut runtime = Runtime::new(options(), selector).expect("good options");
            let mut step = 0;
            group(c, "frame").bench_function(BenchmarkId::new(name, &place.name), |b| {
                b.iter(|| {
                    step = (step + 1) % ROUND;
                    let way = step.min(ROUND - step) as f32 * 0.05;
                    let view = View { eye: place.usual.eye + place.ahead * way, ..place.usual };
                    let last = runtime.report();
                    let measured = [FrameTime::busy(last.frame, last.predicted_us as f32)];
                    let views = [ViewInput::new(view, 0)];
                    let input = FrameInput { measured: &measured, ..FrameInput::new(&views, budget_us) };
                    black_box(runtime.frame(&mut place.objects, &input).candidates)
                });
            });
        }
    }
}

criterion_group!(benches, rating, selecting, frames);
criterion_main!(benches);
