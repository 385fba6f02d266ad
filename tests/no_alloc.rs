//! Once warm, a frame allocates nothing, whatever the policy and the transition.
//!
//! One test in a binary of its own: the allocator counts for the whole process.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{Quat, Vec2, Vec3};
use lod_budget::bounds::Sphere;
use lod_budget::frame::{FrameTime, GroupId};
use lod_budget::rate::{CostModel, Stages};
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
use lod_budget::scene::{LevelRange, Object, ObjectId, Objects, Settings};
use lod_budget::select::{
    Coarsest, Finest, FunkhouserSequin, Predictive, PredictiveOptions, Reactive, ScreenSize, Selector,
};
use lod_budget::table::{LevelRecord, LodTable};
use lod_budget::transition::{TransitionKind, TransitionOptions};
use lod_budget::view::View;

/// The system's allocator, counting.
struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is handed on to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.realloc(memory, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

const OBJECTS: u64 = 700;
const FRAMES: usize = 300;

/// Objects all around, a third of them special in some way.
fn crowd() -> Objects {
    let mut objects = Objects::new();
    let levels =
        |triangles: u32| (0..6).map(|l| LevelRecord::new(triangles >> l, triangles >> (l + 1))).collect();
    let tables = [("near", 30_000), ("far", 3000)].map(|(name, triangles)| {
        let table =
            LodTable::new(name, Sphere::new(Vec3::ZERO, 1.0), levels(triangles)).expect("a good table");
        objects.add_table(table).expect("room")
    });
    for id in 0..OBJECTS {
        let place = |k: u64| (id * k % 97) as f32 - 48.0;
        let bounds =
            Sphere::new(Vec3::new(place(31), place(57) * 0.1, place(83)), 0.5 + (id % 5) as f32 * 0.3);
        let mut object = Object::new(id, bounds, tables[(id % 2) as usize]);
        object.settings = Settings {
            may_skip: id % 6 == 0,
            clamp: if id % 9 == 0 { LevelRange::new(1, 3) } else { LevelRange::ALL },
            draw_distance: if id % 7 == 0 { 40.0 } else { f32::INFINITY },
            ..Settings::default()
        };
        objects.insert(object).expect("a new id");
    }
    objects
}

/// Two groups: a camera that flies in a circle and turns, and one seen from above.
fn views(n: usize) -> [ViewInput<'static>; 2] {
    let turn = n as f32 / FRAMES as f32 * std::f32::consts::TAU;
    let eye = Vec3::new(10.0 * turn.cos(), 1.0, 10.0 * turn.sin());
    let size = Vec2::new(1280.0, 720.0);
    let camera = View::perspective(1.0, size).at(eye, Quat::from_rotation_y(3.0 * turn));
    let above = View::orthographic(60.0, size)
        .at(eye + Vec3::Y * 100.0, Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    [ViewInput::new(camera, 0), ViewInput::new(above, 3)]
}

/// One round of the path; returns how many changes there were, so that nothing can be left out.
fn fly(runtime: &mut Runtime, objects: &mut Objects, budget_us: f64) -> usize {
    let mut changes = 0;
    for n in 0..FRAMES {
        let report = runtime.report();
        let time_us = report.predicted_us as f32 * (1.0 + 0.03 * (n % 5) as f32);
        let measured = [FrameTime::busy(report.frame, time_us)];
        let views = views(n);
        let input = FrameInput { measured: &measured, ..FrameInput::new(&views, budget_us) };
        runtime.frame(objects, &input);
        changes += runtime.changes().len() + runtime.shown_slots(GroupId(3)).count();
    }
    changes
}

/// A world in motion: every frame some objects move, one goes and comes back elsewhere, and now and then the camera
/// jumps.
fn stir(objects: &mut Objects, n: usize) {
    for k in 0..20 {
        let id = ObjectId((n * 7 + k * 31) as u64 % OBJECTS);
        let object = objects.get(id).expect("it is there");
        let step = Vec3::new((k % 3) as f32 - 1.0, 0.0, (n % 3) as f32 - 1.0);
        let center = (object.bounds.center + step).clamp(Vec3::splat(-48.0), Vec3::splat(48.0));
        objects.set_bounds(id, Sphere { center, ..object.bounds }).expect("it is there");
    }
    let gone = objects.remove(ObjectId(n as u64 * 13 % OBJECTS)).expect("it is there");
    let center = Vec3::new(-gone.bounds.center.z, gone.bounds.center.y, gone.bounds.center.x);
    objects.insert(Object { bounds: Sphere { center, ..gone.bounds }, ..gone }).expect("the id is free");
}

/// A thousand frames of that.
fn stir_and_fly(runtime: &mut Runtime, objects: &mut Objects) -> usize {
    let mut changes = 0;
    for n in 0..1000 {
        stir(objects, n);
        let report = runtime.report();
        let measured = [FrameTime::busy(report.frame, report.predicted_us as f32)];
        let views = views(if n % 100 < 50 { n } else { n + 150 });
        runtime.frame(objects, &FrameInput { measured: &measured, ..FrameInput::new(&views, 2000.0) });
        changes += runtime.changes().len();
    }
    changes
}

fn selectors() -> [Box<dyn Selector>; 7] {
    let priced = PredictiveOptions { steadiness: None, ..Default::default() };
    [
        Box::new(Finest),
        Box::new(Coarsest),
        Box::new(ScreenSize::default()),
        Box::new(Reactive::new(Default::default()).expect("defaults are good")),
        Box::new(FunkhouserSequin::default()),
        Box::new(Predictive::default()),
        Box::new(Predictive::new(priced).expect("good options")),
    ]
}

#[test]
fn a_warm_frame_allocates_nothing() {
    for (policy, selector) in selectors().into_iter().enumerate() {
        let mut runtime = Runtime::new(RuntimeOptions::default(), selector).expect("good options");
        let mut objects = crowd();
        stir_and_fly(&mut runtime, &mut objects);
        stir_and_fly(&mut runtime, &mut objects);
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        let changes = stir_and_fly(&mut runtime, &mut objects);
        let allocations = ALLOCATIONS.load(Ordering::Relaxed) - before;
        assert_eq!(allocations, 0, "policy {policy}, in a world in motion");
        assert!(changes > 0, "there is something to do");
    }
    let kinds = [TransitionKind::Hard, TransitionKind::CrossFade, TransitionKind::Geomorph];
    for (kind, stages) in kinds.into_iter().zip([Stages::Sum, Stages::Sum, Stages::Max]) {
        for (policy, selector) in selectors().into_iter().enumerate() {
            let options = RuntimeOptions {
                transition: TransitionOptions { kind, ..TransitionOptions::default() },
                cost: CostModel { stages, ..CostModel::default() },
                ..RuntimeOptions::default()
            };
            let mut runtime = Runtime::new(options, selector).expect("good options");
            let mut objects = crowd();
            for _warming_up in 0..3 {
                fly(&mut runtime, &mut objects, 2000.0);
            }
            let before = ALLOCATIONS.load(Ordering::Relaxed);
            let changes = fly(&mut runtime, &mut objects, 2000.0);
            let allocations = ALLOCATIONS.load(Ordering::Relaxed) - before;
            assert_eq!(allocations, 0, "policy {policy}, {kind:?}");
            assert!(before > 0 && changes > 0, "the allocator counts, and there is something to do");
        }
    }
}
