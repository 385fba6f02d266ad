//! What broke elsewhere, one test each, named after the failure and the system it was reported for.
//!
//! Not tested here, because the crate does not have the part that broke, or shows it in another place: roots evicted
//! and load loops at a byte cap (nothing here decides what is loaded; that an evicted level is not shown is tested),
//! the RMS error that under-reports deviation (the bake side measures), frame generation (no presented frame is counted
//! twice: times are matched by id, see `measurements_of_unknown_frames_are_passed_over`), allocation
//! (`tests/no_alloc.rs`).

use std::collections::VecDeque;

use glam::{DVec3, Quat, Vec2, Vec3};
use lod_budget::bounds::Sphere;
use lod_budget::frame::{
    Budget, Candidate, Candidates, Change, Clock, FrameId, FrameTime, GroupId, NoMemory, SelectReport, Timing,
};
use lod_budget::rate::{CostModel, Stages, TableRates, cost_us};
use lod_budget::runtime::{Activity, FrameInput, Runtime, RuntimeOptions, ViewInput};
use lod_budget::scene::{BLOCK, LevelRange, Object, ObjectId, Objects, Settings, TableId};
use lod_budget::select::{
    Coarsest, Finest, Frame, FunkhouserSequin, Measure, Predictive, PredictiveOptions, Reactive,
    ReactiveOptions, ScreenSize, ScreenSizeOptions, Selector, Steadiness,
};
use lod_budget::table::{Level, LevelRecord, LodTable};
use lod_budget::transition::{TransitionKind, TransitionOptions};
use lod_budget::view::{Projection, View, Window};

// ---- the stage ----

fn camera() -> View {
    let window = Window::symmetric(1.0, 0.5625);
    View::through(Projection::Perspective(window), Vec2::new(1920.0, 1080.0))
}

/// Levels whose triangles halve, with measured errors that double, of a bound of this radius.
fn chain(name: &str, triangles: u32, levels: u32, radius: f32) -> LodTable {
    let level = |l: u32| LevelRecord {
        error: Some(0.002 * radius * (1 << l) as f32),
        min_size: Some(0.4 / (1 << l) as f32),
        accuracy: 1.0 - 0.02 * (1 << l) as f32,
        ..LevelRecord::new(triangles >> l, (triangles >> l) / 2)
    };
    LodTable::new(name, Sphere::new(Vec3::ZERO, radius), (0..levels).map(level).collect())
        .expect("a good table")
}

/// A field of `side`² objects in front of the camera, in a world of this scale.
fn field_of(side: u64, scale: f32) -> Objects {
    let mut objects = Objects::new();
    for (name, triangles) in [("rock", 6000), ("tree", 20_000), ("house", 40_000)] {
        objects.add_table(chain(name, triangles, 5, scale)).expect("room");
    }
    for id in 0..side * side {
        let (x, z) = ((id % side) as f32 - side as f32 / 2.0, (id / side) as f32);
        let jitter = (id * 37 % 11) as f32 * 0.07;
        let center = Vec3::new(x * 3.0 + jitter, jitter - 0.3, -4.0 - z * 3.0 - jitter) * scale;
        let bounds = Sphere::new(center, (0.6 + jitter) * scale);
        objects.insert(Object::new(id, bounds, TableId((id % 3) as u16))).expect("a new id");
    }
    objects
}

fn field() -> Objects {
    field_of(18, 1.0)
}

/// One object of a chain of 5 levels at this distance.
fn alone(distance: f32) -> Objects {
    let mut objects = Objects::new();
    let table = objects.add_table(chain("statue", 20_000, 5, 1.0)).expect("room");
    let bounds = Sphere::new(Vec3::new(0.0, 0.0, -distance), 1.0);
    objects.insert(Object::new(1, bounds, table)).expect("a new id");
    objects
}

fn runtime(selector: impl Selector + 'static) -> Runtime {
    Runtime::new(RuntimeOptions::default(), Box::new(selector)).expect("defaults are good")
}

fn fading(kind: TransitionKind, reserve: f32, selector: impl Selector + 'static) -> Runtime {
    let transition = TransitionOptions { kind, reserve, ..TransitionOptions::default() };
    let options = RuntimeOptions { transition, ..RuntimeOptions::default() };
    Runtime::new(options, Box::new(selector)).expect("good options")
}

fn sized(scale: f32) -> ScreenSize {
    let measure = Measure::ErrorPx(1.0);
    let options = ScreenSizeOptions { measure, scale, band: 0.0, dwell_ms: 0 };
    ScreenSize::new(options).expect("good options")
}

fn steady(steadiness: Steadiness) -> Predictive {
    let options = PredictiveOptions { steadiness: Some(steadiness), ..PredictiveOptions::default() };
    Predictive::new(options).expect("good options")
}

fn selectors() -> [Box<dyn Selector>; 7] {
    [
        Box::new(Finest),
        Box::new(Coarsest),
        Box::new(ScreenSize::default()),
        Box::new(Reactive::new(Default::default()).expect("defaults are good")),
        Box::new(FunkhouserSequin::default()),
        Box::new(Predictive::default()),
        Box::new(steady(Steadiness::default())),
    ]
}

/// One frame of one view without measurements.
fn step(runtime: &mut Runtime, objects: &mut Objects, view: View, budget_us: f64) {
    runtime.frame(objects, &FrameInput::new(&[ViewInput::new(view, 0)], budget_us));
}

fn level_of(runtime: &Runtime, objects: &Objects, id: u64) -> Level {
    runtime.shown(objects, GroupId(0), ObjectId(id)).level
}

/// What the finest and the cheapest choice of the field cost.
fn finest_and_cheapest_us() -> (f64, f64) {
    let cost_us = |selector: Box<dyn Selector>| {
        let mut runtime = Runtime::new(RuntimeOptions::default(), selector).expect("defaults are good");
        step(&mut runtime, &mut field(), camera(), 1e9);
        runtime.report().select.cost_us
    };
    (cost_us(Box::new(Finest)), cost_us(Box::new(Coarsest)))
}

/// A budget that allows about half of the detail of the field.
fn half_us() -> f64 {
    let (finest, cheapest) = finest_and_cheapest_us();
    cheapest + 0.5 * (finest - cheapest)
}

/// A machine that draws what is shown and measures it, late and with noise.
struct Machine {
    truth: CostModel,
    noise: f64,
    late: usize,
    interval_us: Option<f64>,
    pending: VecDeque<FrameTime>,
    dice: u64,
}

impl Machine {
    /// Draws as the prior says, noise 3 %, two frames late.
    fn usual() -> Self {
        let truth = CostModel::default();
        Self { truth, noise: 0.03, late: 2, interval_us: None, pending: VecDeque::new(), dice: 1 }
    }

    fn exact(late: usize) -> Self {
        Self { noise: 0.0, late, ..Self::usual() }
    }

    fn uniform(&mut self) -> f64 {
        self.dice = self.dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.dice >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Near enough to a normal distribution: the sum of twelve dice.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    fn busy_us(&self, runtime: &Runtime, objects: &Objects) -> f64 {
        let mut rates = TableRates::default();
        rates.renew(objects.tables(), &self.truth);
        let frame = runtime.last_frame(objects);
        let price = |i: usize| {
            let id = objects.id_of(frame.candidates.slot_of(i) as usize).expect("an object");
            let shown = runtime.shown(objects, frame.candidates.group_of(i), id);
            let cost_us = |level| cost_us(&self.truth, &rates, &frame.candidate(i), level);
            cost_us(shown.level) + if shown.is_in_flight() { cost_us(shown.from) } else { 0.0 }
        };
        (0..frame.candidates.len()).map(price).sum()
    }

    fn draw(&mut self, runtime: &Runtime, objects: &Objects) {
        let busy_us = self.busy_us(runtime, objects) * (1.0 + self.noise * self.normal());
        let frame = runtime.report().frame;
        self.pending.push_back(match self.interval_us {
            None => FrameTime::busy(frame, busy_us as f32),
            Some(interval_us) => FrameTime {
                frame,
                time_us: ((busy_us / interval_us).ceil() * interval_us) as f32,
                clock: Clock::Vsync { interval_us: interval_us as f32 },
            },
        });
    }

    fn known(&mut self) -> Vec<FrameTime> {
        let count = self.pending.len().saturating_sub(self.late);
        self.pending.drain(..count).collect()
    }

    /// So many frames of one view; `each` hears of every one.
    fn play(
        &mut self,
        runtime: &mut Runtime,
        objects: &mut Objects,
        (budget_us, frames): (f64, usize),
        view: impl Fn(usize) -> View,
        mut each: impl FnMut(&Runtime, &Objects),
    ) {
        for n in 0..frames {
            let measured = self.known();
            let views = [ViewInput::new(view(n), 0)];
            runtime.frame(objects, &FrameInput { measured: &measured, ..FrameInput::new(&views, budget_us) });
            self.draw(runtime, objects);
            each(runtime, objects);
        }
    }

    /// How often the wanted levels switch within so many frames of a still camera.
    fn switches(
        &mut self,
        runtime: &mut Runtime,
        objects: &mut Objects,
        budget_us: f64,
        frames: usize,
    ) -> usize {
        let mut switches = 0;
        self.play(
            runtime,
            objects,
            (budget_us, frames),
            |_| camera(),
            |r, _| switches += r.report().switches,
        );
        switches
    }
}

// ---- still cameras ----

#[test]
fn reactive_control_hunts_luanti() {
    let (finest, cheapest) = finest_and_cheapest_us();
    for share in [0.2, 0.3, 0.5, 0.7, 0.8] {
        let budget_us = cheapest + share * (finest - cheapest);
        let (mut runtime, mut objects) = (runtime(Reactive::new(Default::default()).expect("good")), field());
        let mut machine = Machine::usual();
        let before = machine.switches(&mut runtime, &mut objects, budget_us, 120);
        assert!(before > 0, "the scene calls for control");
        assert_eq!(machine.switches(&mut runtime, &mut objects, budget_us, 600), 0, "share {share}");
    }
}

#[test]
fn a_still_camera_comes_to_rest_under_noise_whatever_the_policy() {
    for selector in selectors() {
        let mut runtime = Runtime::new(RuntimeOptions::default(), selector).expect("defaults are good");
        let (mut objects, mut machine) = (field(), Machine::usual());
        machine.switches(&mut runtime, &mut objects, half_us(), 120);
        assert_eq!(machine.switches(&mut runtime, &mut objects, half_us(), 300), 0);
    }
}

#[test]
fn a_steady_still_camera_is_at_rest_after_two_seconds_on_a_machine_that_is_not_as_expected() {
    let prior = CostModel::default().coefficients();
    for factors in [[1.0; 4], [1.2, 0.85, 1.15, 0.9], [0.8, 1.2, 0.9, 1.1], [1.3; 4]] {
        let truth = CostModel::default().with_coefficients(std::array::from_fn(|k| prior[k] * factors[k]));
        let (mut runtime, mut objects) = (runtime(steady(Steadiness::default())), field());
        let mut machine = Machine { truth, ..Machine::usual() };
        machine.switches(&mut runtime, &mut objects, half_us(), 120);
        assert_eq!(machine.switches(&mut runtime, &mut objects, half_us(), 600), 0, "{factors:?}");
    }
}

/// The optimum of every frame, whatever was shown before.
fn optimum() -> Predictive {
    let options = PredictiveOptions { steadiness: None, hysteresis: 0.0, dwell_ms: 0, dwell: 0.0, ease: 0.0 };
    Predictive::new(options).expect("good options")
}

fn at(z: f64) -> View {
    View { origin: DVec3::new(0.0, 0.0, z), ..camera() }
}

/// Where the optimum changes between two places, to a hundredth of a millimetre.
fn threshold(mut from: f64, mut to: f64) -> f64 {
    let wanted = |z: f64| {
        let (mut runtime, mut objects) = (runtime(optimum()), field());
        step(&mut runtime, &mut objects, at(z), half_us());
        runtime.wanted().to_vec()
    };
    let before = wanted(from);
    assert_ne!(before, wanted(to));
    while (to - from).abs() > 1e-5 {
        let middle = 0.5 * (from + to);
        if wanted(middle) == before { from = middle } else { to = middle }
    }
    to
}

/// How often levels switch in five seconds of a camera that shakes by ±1 mm and ±0.01° around `z`, after a second of
/// it.
fn switches_in_the_hand(selector: Predictive, z: f64) -> usize {
    let (mut runtime, mut objects, mut dice) = (runtime(selector), field(), Machine::usual());
    let mut shaken = || {
        let [x, y, dz, pitch, yaw, roll] = std::array::from_fn(|_| 2.0 * dice.uniform() - 1.0);
        let turn = Vec3::new(pitch as f32, yaw as f32, roll as f32) * 0.01_f32.to_radians();
        let origin = DVec3::new(0.0, 0.0, z) + DVec3::new(x, y, dz) * 1e-3;
        View { origin, rotation: Quat::from_scaled_axis(turn), ..camera() }
    };
    let mut switches = 0;
    for n in 0..360 {
        step(&mut runtime, &mut objects, shaken(), half_us());
        switches += if n < 60 { 0 } else { runtime.report().switches };
    }
    switches
}

#[test]
fn jitter_at_a_threshold_switches_nothing_after_a_second() {
    for (from, to) in [(0.0, 1.0), (1.0, 2.0), (2.0, 3.5), (-0.5, -1.5)] {
        let z = threshold(from, to);
        let restless = switches_in_the_hand(optimum(), z);
        assert!(restless > 50, "the optimum itself switches {restless} times at {z}");
        assert_eq!(switches_in_the_hand(steady(Steadiness::default()), z), 0, "{z}");
    }
}

/// The most refinements of one object in so many frames of a budget that swings between next to nothing and plenty.
fn most_refinements(steadiness: Steadiness, frames: usize) -> usize {
    let (mut runtime, mut objects) = (runtime(steady(steadiness)), field());
    let mut counts = std::collections::BTreeMap::new();
    for n in 0..frames {
        step(&mut runtime, &mut objects, camera(), if n % 2 == 0 { 1.0 } else { 1e9 });
        for change in runtime.changes().iter().filter(|c| c.new < c.old && c.old.is_drawn()) {
            *counts.entry(change.object).or_insert(0) += 1;
        }
    }
    counts.into_values().max().unwrap_or(0)
}

#[test]
fn a_bucket_bounds_the_worst_rate_of_refinements() {
    let impatient = Steadiness { patience_s: 0.0, content: 0.0, ..Steadiness::default() };
    for burst in [1, 2, 4, 15] {
        let most = most_refinements(Steadiness { burst, ..impatient }, 600);
        // Ten seconds: what the bucket holds, and one for each 256 ms.
        let allowed = usize::from(burst) + 10_000 / 256;
        assert!(most <= allowed && most > allowed / 2, "{most} with {burst}");
    }
}

/// The changes of every frame of a camera that goes to and fro, while objects change their slots as told.
fn changes_of_a_walk(reorder: impl Fn(usize, &mut Objects)) -> Vec<Vec<Change>> {
    let patient = Steadiness { spare: 1.0, content: 0.0, burst: 1, ..Steadiness::default() };
    let (mut runtime, mut objects) = (runtime(steady(patient)), field());
    let frame = |n: usize| {
        reorder(n, &mut objects);
        let z = (n as f64 * 0.05).sin() * 3.0;
        step(&mut runtime, &mut objects, at(z), half_us());
        runtime.changes().to_vec()
    };
    (0..240).map(frame).collect()
}

#[test]
fn what_is_owed_follows_an_object_to_another_slot() {
    let turned = changes_of_a_walk(|n, objects| {
        let slots = (0..objects.blocks().len() * BLOCK).filter(|&s| objects.id_of(s).is_some());
        let backwards: Vec<u32> = slots.map(|slot| slot as u32).rev().collect();
        if n % 7 == 3 {
            objects.reorder(&backwards);
        }
    });
    assert_eq!(turned, changes_of_a_walk(|_, _| ()));
}

#[test]
fn a_still_camera_never_reaches_the_final_level_babylon() {
    let kinds = [TransitionKind::CrossFade, TransitionKind::Geomorph];
    for (kind, reserve) in kinds.into_iter().flat_map(|kind| [(kind, 0.05), (kind, 0.01)]) {
        let (mut runtime, mut objects) = (fading(kind, reserve, Predictive::default()), field());
        let mut machine = Machine::exact(2);
        let far = |_| camera().at(Vec3::new(0.0, 0.0, 60.0), Quat::IDENTITY);
        machine.play(&mut runtime, &mut objects, (half_us(), 60), far, |_, _| {});
        machine.play(&mut runtime, &mut objects, (half_us(), 600), |_| camera(), |_, _| {});
        assert_eq!(runtime.report().fades, 0);
        for (i, &wanted) in runtime.wanted().iter().enumerate() {
            let id = objects.id_of(runtime.candidates().slot_of(i) as usize).expect("an object");
            let shown = runtime.shown(&objects, GroupId(0), id);
            assert_eq!((shown.level, shown.weight), (wanted, 1.0));
        }
    }
}

#[test]
fn lod_drifts_down_in_the_background_vircadia() {
    for selector in selectors() {
        let mut runtime = Runtime::new(RuntimeOptions::default(), selector).expect("defaults are good");
        let (mut objects, mut machine) = (field(), Machine::usual());
        machine.switches(&mut runtime, &mut objects, half_us(), 120);
        let (before, budget) = (runtime.wanted().to_vec(), runtime.report().budget);
        for _ in 0..200 {
            let slow = FrameTime::busy(runtime.report().frame, 500_000.0);
            let views = [ViewInput::new(camera(), 0)];
            let input = FrameInput::new(&views, half_us());
            runtime
                .frame(&mut objects, &FrameInput { measured: &[slow], activity: Activity::Paused, ..input });
        }
        // One slow time belongs to the last frame before the pause; a single one is a hitch.
        assert_eq!(runtime.wanted(), before);
        assert_eq!(runtime.report().budget, budget);
    }
}

// ---- the reactive controller ----

/// A frame of the field as a selector sees it, to be given other times.
fn with_frame<T>(act: impl FnOnce(Frame<'_>) -> T) -> T {
    let (mut runtime, mut objects) = (runtime(Finest), field());
    step(&mut runtime, &mut objects, camera(), half_us());
    act(runtime.last_frame(&objects))
}

fn timed(frame: Frame<'_>, filtered_us: f64) -> Frame<'_> {
    Frame { timing: Timing { filtered_us, fresh: 1, censored: false }, ..frame }
}

#[test]
fn vsync_hides_headroom_so_the_controller_probes_for_ever_unity() {
    let interval_us = finest_and_cheapest_us().0 * 0.6;
    let mut machine = Machine { interval_us: Some(interval_us), ..Machine::usual() };
    let (mut reactive, mut objects) = (runtime(Reactive::new(Default::default()).expect("good")), field());
    // How often in so many frames the time rises above the interval.
    let mut failures = |frames: usize| {
        let (mut failures, mut missing) = (0, false);
        machine.play(
            &mut reactive,
            &mut objects,
            (interval_us, frames),
            |_| camera(),
            |runtime, _| {
                let misses = runtime.report().filtered_us > 1.02 * interval_us;
                failures += usize::from(misses && !missing);
                missing = misses;
            },
        );
        failures
    };
    // Each failure doubles the wait between probes: a few in four minutes, and fewer from then on.
    let failures = failures(15_000);
    assert!((1..=6).contains(&failures), "{failures} failures");
    let mut machine = Machine { interval_us: Some(interval_us), ..Machine::usual() };
    let mut predictive = runtime(Predictive::default());
    machine.switches(&mut predictive, &mut objects, interval_us, 600);
    assert_eq!(machine.switches(&mut predictive, &mut objects, interval_us, 1200), 0);
}

#[test]
fn reactive_integral_windup_vircadia() {
    let recovery = |too_slow: usize, settings: Settings| {
        let (mut first, mut objects) = (runtime(Finest), field());
        (0..objects.len() as u64).for_each(|id| objects.set_settings(ObjectId(id), settings).expect("good"));
        step(&mut first, &mut objects, camera(), half_us());
        let frame = first.last_frame(&objects);
        let mut reactive = Reactive::new(Default::default()).expect("defaults are good");
        let mut levels = vec![Level::FINEST; frame.candidates.len()];
        for _ in 0..too_slow {
            reactive.select(&timed(frame, 10.0 * frame.budget.target_us), &mut levels);
        }
        let stuck = levels.clone();
        let mut moves = |reactive: &mut Reactive| {
            reactive.select(&timed(frame, 0.1 * frame.budget.target_us), &mut levels);
            levels != stuck
        };
        (1..10_000).find(|_| moves(&mut reactive)).expect("it recovers")
    };
    for settings in [Settings::default(), Settings { may_skip: true, ..Settings::default() }] {
        assert_eq!(recovery(3000, settings), recovery(300, settings));
    }
}

#[test]
fn large_corrections_stutter_msfs_autofps() {
    with_frame(|frame| {
        let mut reactive = Reactive::new(Default::default()).expect("defaults are good");
        let mut levels = vec![Level::FINEST; frame.candidates.len()];
        let target_us = frame.budget.target_us;
        for filtered_us in [100.0, 0.01, 3.0, 1.3, 0.5].map(|x| x * target_us) {
            let before = reactive.factor();
            reactive.select(&timed(frame, filtered_us), &mut levels);
            let step = reactive.factor() / before;
            let ReactiveOptions { rise, fall, .. } = ReactiveOptions::default();
            assert!((1.0 - fall - 1e-4..=1.0 + rise + 1e-4).contains(&step), "{step}");
        }
    });
}

// ---- spending ----

fn reversals(history: &[Vec<(u64, Level)>]) -> usize {
    let at = |n: usize, id: u64| history[n].iter().find(|h| h.0 == id).map(|h| h.1);
    let turns = |n: usize, id: u64, now: Level| {
        let before = at(n - 1, id);
        before != Some(now) && (2..=60.min(n)).any(|back| at(n - back, id) == Some(now))
    };
    (1..history.len()).map(|n| history[n].iter().filter(|&&(id, now)| turns(n, id, now)).count()).sum()
}

#[test]
fn skipping_what_does_not_fit_flips_levels_at_small_camera_moves_playcanvas() {
    let (mut runtime, mut objects) = (runtime(Predictive::default()), field());
    let mut machine = Machine::exact(2);
    machine.switches(&mut runtime, &mut objects, half_us(), 120);
    let shake =
        |n: usize| camera().at(Vec3::new(0.01 * (n % 3) as f32, 0.0, 0.01 * (n % 5) as f32), Quat::IDENTITY);
    let mut history = Vec::new();
    machine.play(&mut runtime, &mut objects, (half_us(), 240), shake, |runtime, objects| {
        let ids = runtime.candidates().slots().map(|s| objects.id_of(s as usize).expect("an object").0);
        history.push(ids.zip(runtime.wanted().iter().copied()).collect::<Vec<_>>());
    });
    let objects_seconds = history[0].len() * 4;
    assert!(reversals(&history) * 100 <= objects_seconds, "{}", reversals(&history));
}

#[test]
fn stopping_early_wastes_budget_playcanvas() {
    let (mut runtime, mut objects) = (runtime(Predictive::default()), field());
    for share in [0.1, 0.3, 0.6, 0.9] {
        let (finest, cheapest) = finest_and_cheapest_us();
        step(&mut runtime, &mut objects, camera(), (cheapest + share * (finest - cheapest)) / 0.75);
        let (report, budget) = (runtime.report().select, runtime.report().budget.select_us);
        // The dead band of the budget leaves five percent, and what they would buy is known.
        assert!(report.cost_us <= budget && report.cost_us > 0.94 * budget, "{report:?} of {budget}");
        assert!(report.certificate.is_some_and(|c| c.gap < 0.02), "{report:?}");
    }
}

#[test]
fn equal_priorities_are_decided_by_node_order_playcanvas() {
    let twins = |order: &mut dyn Iterator<Item = u64>| {
        let mut objects = Objects::new();
        let table = objects.add_table(chain("post", 20_000, 4, 1.0)).expect("room");
        for id in order {
            objects
                .insert(Object::new(id, Sphere::new(Vec3::new(0.0, 0.0, -20.0), 1.0), table))
                .expect("new");
        }
        objects
    };
    for share in 1..20 {
        for selector in
            [Box::new(Predictive::default()) as Box<dyn Selector>, Box::new(FunkhouserSequin::default())]
        {
            let levels = |order: &mut dyn Iterator<Item = u64>| {
                let mut objects = twins(order);
                let mut runtime = Runtime::new(RuntimeOptions::default(), selector.clone()).expect("good");
                step(&mut runtime, &mut objects, camera(), f64::from(share) * 25.0);
                (0..10).map(|id| level_of(&runtime, &objects, id)).collect::<Vec<_>>()
            };
            let (forwards, backwards) = (levels(&mut (0..10)), levels(&mut (0..10).rev()));
            assert_eq!(forwards, backwards);
        }
    }
}

#[test]
fn cheap_far_upgrades_starve_near_detail_babylon_lite() {
    let mut objects = Objects::new();
    let statue = objects.add_table(chain("statue", 40_000, 4, 1.0)).expect("room");
    let pebble = objects.add_table(chain("pebble", 800, 4, 1.0)).expect("room");
    objects.insert(Object::new(1000, Sphere::new(Vec3::new(0.0, 0.0, -4.0), 1.0), statue)).expect("new");
    for id in 0..400 {
        let center = Vec3::new((id % 20) as f32 - 10.0, (id / 20) as f32 - 10.0, -300.0);
        objects.insert(Object::new(id, Sphere::new(center, 0.5), pebble)).expect("new");
    }
    let mut runtime = runtime(Predictive::default());
    step(&mut runtime, &mut objects, camera(), 0.0);
    let cheapest_us = runtime.report().select.cost_us;
    step(&mut runtime, &mut objects, camera(), (cheapest_us + 60.0) / 0.75);
    assert_eq!(level_of(&runtime, &objects, 1000), Level(0));
}

#[test]
fn triangle_count_is_not_time_threepp() {
    let truth = CostModel { pixel_us: 0.01, stages: Stages::Max, ..CostModel::default() };
    let options = RuntimeOptions { cost: truth, ..RuntimeOptions::default() };
    let mut runtime = Runtime::new(options, Box::new(Predictive::default())).expect("good options");
    let mut objects = alone(3.0);
    step(&mut runtime, &mut objects, camera(), 0.0);
    let infeasible = *runtime.report();
    assert!(infeasible.select.infeasible_us > 0.0);
    // Pixels bind: every level takes as long, so not even an exceeded budget calls for a coarser one.
    assert_eq!(level_of(&runtime, &objects, 1), Level(0));
    let mut machine = Machine { truth, ..Machine::exact(0) };
    machine.draw(&runtime, &objects);
    let fine = machine.busy_us(&runtime, &objects);
    objects
        .set_settings(ObjectId(1), Settings { forced: Some(Level(4)), ..Settings::default() })
        .expect("good");
    step(&mut runtime, &mut objects, camera(), 0.0);
    assert_eq!((level_of(&runtime, &objects, 1), machine.busy_us(&runtime, &objects)), (Level(4), fine));
}

#[test]
fn the_printed_guarantee_is_false_for_more_than_one_object_perf_goblin() {
    for n in 1..60 {
        let (finest, cheapest) = finest_and_cheapest_us();
        let mut runtime = runtime(Predictive::default());
        let budget_us = (cheapest + f64::from(n) / 60.0 * (finest - cheapest)) / 0.75;
        step(&mut runtime, &mut field(), camera(), budget_us);
        let certificate = runtime.report().select.certificate.expect("it fits");
        assert!(certificate.gap <= 0.5 && certificate.upper_bound >= runtime.report().select.benefit);
        assert!(
            certificate.gap < if n < 10 { 0.1 } else { 0.01 },
            "hundreds of objects: {}",
            certificate.gap
        );
    }
}

/// Two objects whose levels have exactly these costs (units of 1e-4) and benefits, finest first.
fn counterexample(select: &mut dyn Selector) -> SelectReport {
    const BENEFIT: f32 = 1000.0;
    let pairs: [[(u32, f32); 4]; 2] = [
        [(3_467_490, 618.5195), (188_952, 34.5056), (17_599, 5.0387), (1136, 0.4652)],
        [(214_700, 6.1775), (52_287, 2.1120), (3057, 0.6621), (1086, 0.3795)],
    ];
    let model = CostModel::default().with_coefficients([0.0, 0.0, 1e-4, 0.0]);
    let (mut objects, mut candidates, mut rates) =
        (Objects::new(), Candidates::default(), TableRates::default());
    for (id, levels) in pairs.iter().enumerate() {
        let record = |&(triangles, benefit): &(u32, f32)| LevelRecord {
            accuracy: benefit / BENEFIT,
            ..LevelRecord::new(triangles, 0)
        };
        let bounds = Sphere::new(Vec3::ZERO, 1.0);
        let table = LodTable::new("pair", bounds, levels.iter().map(record).collect()).expect("a good table");
        let table = objects.add_table(table).expect("room");
        objects.insert(Object::new(id as u64, bounds, table)).expect("new");
        candidates.push(Candidate {
            slot: id as u32,
            table: table.0,
            allowed: LevelRange::new(0, 3),
            weight: BENEFIT,
            cost_scale: 1.0,
            size_px: 100.0,
            near_px: 100.0,
            area_px2: 0.0,
        });
    }
    candidates.end_group(GroupId(0), camera().lens(DVec3::ZERO), 1);
    rates.renew(objects.tables(), &model);
    let budget = Budget { frame_us: 346.8607, target_us: 346.8607, select_us: 346.8607 };
    let (id, timing) = (FrameId(1), Timing::default());
    let frame = Frame {
        id,
        objects: &objects,
        candidates: &candidates,
        rates: &rates,
        model: &model,
        budget,
        timing,
        floor: 0.0,
        memory: &NoMemory,
        threads: 1,
    };
    let mut levels = [Level::NOT_DRAWN; 2];
    select.select(&frame, &mut levels)
}

#[test]
fn at_least_half_of_the_optimum_is_false_of_the_1993_rule_mason() {
    let rule = counterexample(&mut FunkhouserSequin::new(0.0).expect("good"));
    assert!((rule.benefit - 35.1677).abs() < 1e-3, "{}", rule.benefit);
    let ours = counterexample(&mut Predictive::new(PredictiveOptions::default()).expect("good"));
    assert!((ours.benefit - 618.899).abs() < 1e-3, "{}", ours.benefit);
    assert!(ours.cost_us <= 346.8607 && ours.certificate.is_some_and(|c| c.upper_bound >= ours.benefit));
}

#[test]
fn a_level_that_was_never_drawn_is_tried_at_once_vtk() {
    // What was never drawn is priced by its table, so neither the first frame nor a teleport overshoots.
    let (mut runtime, mut objects) = (runtime(Predictive::default()), field());
    let mut machine = Machine::exact(2);
    let mut worst_us: f64 = 0.0;
    let jumps =
        |n: usize| camera().at(Vec3::new(0.0, 0.0, if n % 40 < 20 { 50.0 } else { 0.0 }), Quat::IDENTITY);
    machine.play(&mut runtime, &mut objects, (half_us(), 200), jumps, |runtime, objects| {
        worst_us = worst_us.max(Machine::usual().busy_us(runtime, objects));
    });
    assert!(worst_us <= half_us(), "{worst_us} of {}", half_us());
}

// ---- views ----

#[test]
fn one_hysteresis_state_is_shared_by_several_views_flax_spark_3dtiles_potree() {
    let swinging = |n: usize, phase: f32| {
        let z = 6.0 * (((n as f32 * 0.07 + phase) % 2.0) - 1.0).abs();
        camera().at(Vec3::new(0.0, 0.0, z), Quat::IDENTITY)
    };
    let phases = [0.0, 0.9];
    let (mut both, mut singles) =
        (runtime(ScreenSize::default()), phases.map(|_| runtime(ScreenSize::default())));
    let mut stores = [field(), field()];
    let mut shared = field();
    for n in 0..120 {
        let views: Vec<_> = (0..2).map(|g| ViewInput::new(swinging(n, phases[g]), g as u32)).collect();
        both.frame(&mut shared, &FrameInput::new(&views, 1e9));
        for g in 0..2 {
            let view = [ViewInput::new(swinging(n, phases[g]), 0)];
            singles[g].frame(&mut stores[g], &FrameInput::new(&view, 1e9));
            for id in (0..324).map(ObjectId) {
                let apart = singles[g].shown(&stores[g], GroupId(0), id);
                assert_eq!(both.shown(&shared, GroupId(g as u32), id), apart);
            }
        }
    }
}

#[test]
fn views_beyond_32_are_silently_ignored_bevy() {
    let mut objects = field();
    let mut runtime = runtime(Predictive::default());
    let views: Vec<_> = (0..100).map(|g| ViewInput::new(camera(), g)).collect();
    runtime.frame(&mut objects, &FrameInput::new(&views, 100.0 * half_us()));
    let first: Vec<_> = runtime.shown_slots(GroupId(0)).collect();
    assert!(!first.is_empty());
    assert!((0..100).all(|g| runtime.shown_slots(GroupId(g)).count() == first.len()));
    assert_eq!(runtime.report().candidates, 100 * first.len());
}

#[test]
fn neither_or_both_levels_are_visible_godot() {
    for selector in selectors() {
        let mut runtime = Runtime::new(RuntimeOptions::default(), selector).expect("defaults are good");
        let (mut objects, mut machine) = (field(), Machine::usual());
        let fly = |n: usize| camera().at(Vec3::new(0.0, 0.0, 20.0 - 0.4 * n as f32), Quat::IDENTITY);
        machine.play(&mut runtime, &mut objects, (half_us(), 150), fly, |runtime, _| {
            let shown: Vec<_> = runtime.shown_slots(GroupId(0)).collect();
            assert_eq!(shown.len(), runtime.report().candidates);
            assert!(shown.iter().all(|(_, s)| s.level.is_drawn() && s.level == s.from && s.weight == 1.0));
        });
    }
}

#[test]
fn left_and_right_eye_differ_godot_o3de_vrtrial() {
    let eye = |x: f32, skew: f32| {
        let window = Window { left: -1.0 + skew, right: 1.0 + skew, bottom: -0.6, top: 0.6 };
        let view = View::through(Projection::Perspective(window), Vec2::new(1080.0, 1200.0));
        ViewInput::new(view.at(Vec3::new(x, 0.0, 0.0), Quat::IDENTITY), 0)
    };
    let mut objects = field();
    let mut stereo = runtime(Predictive::default());
    let (left, right) = (eye(-0.03, 0.1), eye(0.03, -0.1));
    stereo.frame(&mut objects, &FrameInput::new(&[left, right], half_us()));
    let mut slots: Vec<u32> = stereo.candidates().slots().collect();
    slots.dedup();
    assert_eq!(slots.len(), stereo.candidates().len(), "one level for both eyes");
    // Both eyes draw it: what both see costs twice.
    assert!(stereo.candidates().cost_scale.iter().all(|&views| views == 1.0 || views == 2.0));
    assert!(stereo.candidates().cost_scale.contains(&2.0));
    let mut swapped = runtime(Predictive::default());
    swapped.frame(&mut objects, &FrameInput::new(&[right, left], half_us()));
    assert_eq!(stereo.wanted(), swapped.wanted());
}

/// The distance at which level 0 gives way.
fn switching_distance(scale: f32) -> f32 {
    let (mut near, mut far) = (1.1f32, 900.0f32);
    for _ in 0..40 {
        let middle = 0.5 * (near + far);
        let (mut runtime, mut objects) = (runtime(sized(scale)), alone(middle));
        step(&mut runtime, &mut objects, camera(), 1e9);
        let fine = level_of(&runtime, &objects, 1) == Level(0);
        *(if fine { &mut near } else { &mut far }) = middle;
    }
    near
}

#[test]
fn the_scale_is_applied_to_the_squared_distance_panda3d() {
    let [one, two] = [1.0, 2.0].map(switching_distance);
    assert!((two / one - 2.0).abs() < 1e-3, "{two} for {one}");
}

#[test]
fn the_perspective_formula_is_used_for_orthographic_views_playcanvas() {
    let view = View::orthographic(60.0, Vec2::new(1920.0, 1080.0));
    for selector in selectors() {
        let levels = [5.0, 50.0, 500.0].map(|distance| {
            let mut runtime = Runtime::new(RuntimeOptions::default(), selector.clone()).expect("good");
            let mut objects = alone(distance);
            step(&mut runtime, &mut objects, view, 18.0);
            level_of(&runtime, &objects, 1)
        });
        assert_eq!(levels, [levels[0]; 3]);
    }
    // 18 px per unit: an error of 0.002 · 2ˡ is below a pixel up to level 4; of a window ten times as narrow up to 2.
    for (height, level) in [(60.0, 4), (6.0, 1)] {
        let (mut runtime, mut objects) = (runtime(sized(1.0)), alone(100.0));
        let view = View::orthographic(height, Vec2::new(1920.0, 1080.0));
        step(&mut runtime, &mut objects, view, 1e9);
        let expected = (0..5).rev().find(|&l| 0.002 * f64::from(1 << l) * 1080.0 / f64::from(height) <= 1.0);
        assert_eq!(level_of(&runtime, &objects, 1), Level(expected.unwrap_or(0)), "about {level}");
    }
}

#[test]
fn thresholds_tuned_at_1080p_pop_at_4k_oloengine() {
    let uhd = View { viewport_px: Vec2::new(3840.0, 2160.0), ..camera() };
    // Errors are projected at the distance of the centre.
    let error_px = |view: View, id: u64| {
        let (mut runtime, mut objects) = (runtime(sized(1.0)), field());
        step(&mut runtime, &mut objects, view, 1e9);
        let explained = runtime.explain(&objects, GroupId(0), ObjectId(id))?;
        let error = 0.002 * f32::from(1u8 << explained.shown.level.0);
        Some((explained.shown.level, error * 0.5 * explained.size_px))
    };
    for id in 0..324 {
        let (Some(hd), Some(uhd)) = (error_px(camera(), id), error_px(uhd, id)) else { continue };
        assert!(hd.0 == Level(0) || hd.1 <= 1.0 && uhd.0 <= hd.0);
        assert!(uhd.0 == Level(0) || uhd.1 <= 1.0);
    }
}

#[test]
fn thresholds_are_wrong_at_a_hundred_times_the_scale_godot() {
    for selector in selectors() {
        let wanted = |scale: f32| {
            let (mut objects, mut all) = (field_of(18, scale), Vec::new());
            let mut runtime = Runtime::new(RuntimeOptions::default(), selector.clone()).expect("good");
            let view = View { near: 0.1 * scale, far: 1000.0 * scale, ..camera() };
            for n in 0..20 {
                let eye = Vec3::new(0.05, 0.0, 0.3) * (n as f32 * scale);
                step(&mut runtime, &mut objects, view.at(eye, Quat::IDENTITY), half_us());
                all.push((0..324).map(|id| level_of(&runtime, &objects, id)).collect::<Vec<_>>());
            }
            all
        };
        assert_eq!(wanted(1.0), wanted(128.0));
        assert_eq!(wanted(1.0), wanted(100.0));
    }
}

// ---- transitions ----

#[test]
fn a_fade_stops_half_way_when_the_camera_stops_godot() {
    let (mut runtime, mut objects) = (fading(TransitionKind::CrossFade, 1.0, sized(1.0)), alone(40.0));
    step(&mut runtime, &mut objects, camera(), 1e9);
    let closer = camera().at(Vec3::new(0.0, 0.0, -30.0), Quat::IDENTITY);
    step(&mut runtime, &mut objects, closer, 1e9);
    let shown = |runtime: &Runtime, objects: &Objects| runtime.shown(objects, GroupId(0), ObjectId(1));
    assert!(shown(&runtime, &objects).is_in_flight());
    let frames = (1..60).find(|_| {
        step(&mut runtime, &mut objects, closer, 1e9);
        !shown(&runtime, &objects).is_in_flight()
    });
    assert_eq!(frames, Some(12), "200 ms at 60 Hz");
}

#[test]
fn chained_fades_add_latency_and_double_the_cost_cesium() {
    let (mut runtime, mut objects) = (fading(TransitionKind::CrossFade, 1.0, sized(1.0)), alone(40.0));
    let mut distance = |runtime: &mut Runtime, z: f32| {
        step(runtime, &mut objects, camera().at(Vec3::new(0.0, 0.0, z), Quat::IDENTITY), 1e9);
        runtime.shown(&objects, GroupId(0), ObjectId(1))
    };
    // Every 50 ms another level is wanted, each before the fade to the one before it has ended.
    for n in 0..40 {
        let z = [0.0, -20.0, -30.0, -36.0][n / 3 % 4];
        distance(&mut runtime, z);
        assert!(runtime.report().fades <= 1);
    }
    let frames = (1..60).find(|_| !distance(&mut runtime, -36.0).is_in_flight());
    assert!(frames.is_some_and(|f| f <= 13), "the last wish is reached within one fade: {frames:?}");
    assert_eq!(distance(&mut runtime, -36.0).level, runtime.wanted()[0]);
}

#[test]
fn an_evicted_level_is_shown_on_its_way_out() {
    let (mut runtime, mut objects) = (fading(TransitionKind::CrossFade, 1.0, Finest), alone(10.0));
    step(&mut runtime, &mut objects, camera(), 1e9);
    let evicted = Settings { resident: LevelRange::new(2, 4), ..Settings::default() };
    objects.set_settings(ObjectId(1), evicted).expect("good");
    step(&mut runtime, &mut objects, camera(), 1e9);
    let shown = runtime.shown(&objects, GroupId(0), ObjectId(1));
    assert_eq!((shown.level, shown.from), (Level(2), Level(2)));
}

#[test]
fn a_table_with_fewer_levels_in_mid_fade_is_indexed_past_its_end() {
    let (mut runtime, mut objects) = (fading(TransitionKind::CrossFade, 1.0, sized(1.0)), alone(200.0));
    let short = objects.add_table(chain("stub", 100, 1, 1.0)).expect("room");
    step(&mut runtime, &mut objects, camera(), 1e9);
    step(&mut runtime, &mut objects, camera().at(Vec3::new(0.0, 0.0, -190.0), Quat::IDENTITY), 1e9);
    assert_eq!(runtime.report().switches, 1);
    objects.set_table(ObjectId(1), short).expect("known");
    step(&mut runtime, &mut objects, camera(), 1e9);
    assert_eq!(runtime.shown(&objects, GroupId(0), ObjectId(1)).level, Level(0));
}

#[test]
fn each_view_group_spends_the_whole_fade_reserve() {
    let (mut runtime, mut objects) =
        (fading(TransitionKind::CrossFade, 0.05, Predictive::default()), field());
    let at = |z: f32| camera().at(Vec3::new(0.0, 0.0, z), Quat::IDENTITY);
    for n in 0..60 {
        let views: Vec<_> = (0..4).map(|g| ViewInput::new(at(n as f32 * 0.3), g)).collect();
        runtime.frame(&mut objects, &FrameInput::new(&views, 4.0 * half_us()));
        let reserve_us = 0.05 * runtime.report().budget.target_us;
        assert!(
            runtime.report().fades_us <= 1.3 * reserve_us,
            "{} of {reserve_us}",
            runtime.report().fades_us
        );
    }
}

// ---- feedback ----

/// Predicted ÷ true time at the end of a flight on this machine.
fn prediction_after(mut machine: Machine, frames: usize) -> f64 {
    let (mut runtime, mut objects) = (runtime(Predictive::default()), field());
    let mut ratio = 0.0;
    let fly = |n: usize| camera().at(Vec3::new(0.0, 0.0, 10.0 - 0.05 * (n % 200) as f32), Quat::IDENTITY);
    let truth = Machine { truth: machine.truth, ..Machine::exact(0) };
    machine.play(&mut runtime, &mut objects, (half_us(), frames), fly, |runtime, objects| {
        ratio = runtime.report().predicted_us / truth.busy_us(runtime, objects);
    });
    ratio
}

#[test]
fn a_machine_that_is_thirty_percent_off_is_learnt() {
    for late in 0..=3 {
        for factors in [[1.3, 0.7, 1.3, 0.7], [0.7, 1.3, 0.7, 1.3], [1.3; 4], [0.7; 4], [1.0, 1.3, 0.7, 1.0]]
        {
            let prior = CostModel::default().coefficients();
            let truth =
                CostModel::default().with_coefficients(std::array::from_fn(|k| prior[k] * factors[k]));
            let ratio = prediction_after(Machine { truth, late, ..Machine::usual() }, 150);
            assert!((ratio - 1.0).abs() < 0.05, "{ratio} at {factors:?}, {late} late");
        }
    }
}

/// The budget of a settled runtime after these measurements of its last frames were given to it, and before.
fn budgets(spoil: impl Fn(FrameId, f64) -> Vec<FrameTime>) -> (Budget, Budget) {
    let (mut runtime, mut objects, mut machine) =
        (runtime(Predictive::default()), field(), Machine::exact(0));
    machine.switches(&mut runtime, &mut objects, half_us(), 60);
    let (before, last) = (runtime.report().budget, *runtime.report());
    let measured = spoil(last.frame, last.predicted_us);
    let views = [ViewInput::new(camera(), 0)];
    runtime.frame(&mut objects, &FrameInput { measured: &measured, ..FrameInput::new(&views, half_us()) });
    (before, runtime.report().budget)
}

#[test]
fn a_hitch_is_no_news() {
    let (before, after) = budgets(|frame, us| vec![FrameTime::busy(frame, (us * 8.0) as f32)]);
    assert_eq!(before, after);
}

#[test]
fn measurements_of_unknown_frames_are_passed_over() {
    let (before, after) = budgets(|frame, us| {
        let strangers = [frame.0 + 1, frame.0 + 64, frame.0.wrapping_sub(64), 0, u64::MAX];
        strangers.map(|id| FrameTime::busy(FrameId(id), (us * 2.0) as f32)).to_vec()
    });
    assert_eq!(before, after);
}

#[test]
fn a_frame_is_learnt_from_once() {
    let (before, after) = budgets(|frame, us| {
        let first = FrameTime::busy(frame, us as f32);
        [first].into_iter().chain((0..20).map(|_| FrameTime::busy(frame, (us * 2.0) as f32))).collect()
    });
    assert_eq!(before, after);
}

#[test]
fn what_is_no_time_is_passed_over() {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -5.0, 0.0];
    let (before, after) = budgets(|frame, _| bad.map(|time_us| FrameTime::busy(frame, time_us)).to_vec());
    assert_eq!(before, after);
}

#[test]
fn times_may_arrive_in_any_order() {
    let (mut runtime, mut objects, mut machine) = (runtime(Predictive::default()), field(), Machine::usual());
    machine.truth = machine.truth.with_coefficients(machine.truth.coefficients().map(|c| c * 1.25));
    for n in 0..160 {
        let mut measured = if n % 4 == 3 { machine.known() } else { Vec::new() };
        measured.reverse();
        let views = [ViewInput::new(camera(), 0)];
        runtime
            .frame(&mut objects, &FrameInput { measured: &measured, ..FrameInput::new(&views, half_us()) });
        machine.draw(&runtime, &objects);
    }
    let ratio = runtime.report().predicted_us / machine.busy_us(&runtime, &objects);
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
}

#[test]
fn a_time_clamped_by_vsync_is_taken_for_the_frames_own() {
    // The work is half an interval: that the frame took a whole one says nothing against the prediction.
    let interval_us = 2.0 * half_us();
    let mut machine = Machine { interval_us: Some(interval_us), ..Machine::exact(1) };
    let (mut runtime, mut objects) = (runtime(Predictive::default()), field());
    machine.switches(&mut runtime, &mut objects, half_us(), 300);
    let ratio = runtime.report().predicted_us / machine.busy_us(&runtime, &objects);
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}
