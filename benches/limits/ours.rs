//! The only file that calls the crate under test.

use glam::{DVec3, Quat, Vec2, Vec3};
use lod_budget::cull::{BlockTree, CullOptions, VisibleBlock};
use lod_budget::feedback::FeedbackOptions;
use lod_budget::frame::FrameReport;
use lod_budget::knapsack::{ProfileItem, SharedClass, SharedKnapsack};
use lod_budget::rate::Stages;
use lod_budget::scene::TableId;
use lod_budget::select::{Frame, Needs, PredictiveOptions, ScreenSizeOptions};
use lod_budget::table::LevelRecord;
use lod_budget::view::{Projection, Window};
use lod_budget::{
    CostModel, FrameInput, GroupId, Level, LodTable, Object, ObjectId, Objects, Predictive, Runtime,
    RuntimeOptions, ScreenSize, Selector, Settings, Sphere, View, ViewInput,
};

use crate::camera::{Camera, Lens, NEAR, VIEWPORT_PX};
use crate::exactness::{Answer, Problem};
use crate::scene::{Detail, Scene, UNITS_PER_US};

/// The level of an object that is not shown.
pub const NOT_SHOWN: u8 = Level::NOT_DRAWN.0;

/// The objects of a scene in the crate's store; object `i` has the id `i`.
pub struct Store {
    objects: Objects,
}

impl Store {
    pub fn new(scene: &Scene) -> Self {
        Self::with_settings(scene, Settings::default())
    }

    /// Every object may be left out.
    pub fn may_skip(scene: &Scene) -> Self {
        Self::with_settings(scene, Settings { may_skip: true, ..Settings::default() })
    }

    fn with_settings(scene: &Scene, settings: Settings) -> Self {
        let mut objects = Objects::new();
        let tables: Vec<TableId> =
            scene.tables.iter().map(|t| objects.add_table(lod_table(t)).expect("few tables")).collect();
        for i in 0..scene.len() {
            let settings = Settings { importance: scene.importance[i], ..settings };
            let table = tables[usize::from(scene.table[i])];
            let object = Object { settings, ..Object::new(i as u64, sphere(scene.sphere(i)), table) };
            objects.insert(object).expect("a new id");
        }
        Self { objects }
    }

    /// Moves an object.
    pub fn place(&mut self, object: usize, at: [f32; 4]) {
        self.objects.set_bounds(ObjectId(object as u64), sphere(at)).expect("a known id");
    }
}

fn sphere([x, y, z, radius]: [f32; 4]) -> Sphere {
    Sphere::new(Vec3::new(x, y, z), radius)
}

fn lod_table(levels: &[Detail]) -> LodTable {
    let record =
        |d: &Detail| LevelRecord { accuracy: d.accuracy, ..LevelRecord::new(d.triangles, d.vertices) };
    let unit = Sphere::new(Vec3::ZERO, 1.0);
    LodTable::new("table", unit, levels.iter().map(record).collect()).expect("a good table")
}

fn view(camera: &Camera) -> View {
    let window = Projection::Perspective(Window::symmetric(1.0, 1.0));
    let rotation = Quat::from_rotation_y(-135f32.to_radians());
    let view = View { near: NEAR, far: camera.far, ..View::through(window, Vec2::from_array(VIEWPORT_PX)) };
    view.at(Vec3::from_array(camera.eye), rotation)
}

/// A camera made ready for a frame, in plain numbers.
pub fn lens(camera: &Camera) -> Lens {
    let lens = view(camera).lens(DVec3::ZERO);
    let plane = |p: lod_budget::view::Plane| [p.normal.x, p.normal.y, p.normal.z, p.offset];
    Lens {
        planes: lens.frustum.planes.map(plane),
        eye: lens.eye.to_array(),
        unit_px2: std::f32::consts::PI * lens.scale_px * lens.scale_px,
        viewport_px2: lens.viewport_px2,
    }
}

/// Which policy a loop runs by.
#[derive(Clone, Copy)]
pub enum Policy {
    /// Budgeted, switches free of charge: the textbook's objective.
    Predictive,
    /// The same, with what it remembers of earlier frames (its λ) forgotten before each.
    Forgetful,
    /// Budgeted, with the default options of switching.
    Priced,
    /// By size on the screen alone.
    Static,
    /// Budgeted, every object costing the slower of its geometry and its pixels, of so many µs each.
    SlowerStage { pixel_us: f64 },
}

impl Policy {
    pub fn name(self) -> &'static str {
        match self {
            Self::Predictive => "predictive",
            Self::Forgetful => "predictive without memory",
            Self::Priced => "predictive, default options",
            Self::Static => "static",
            Self::SlowerStage { .. } => "predictive, max(geometry, pixels)",
        }
    }

    fn selector(self) -> Box<dyn Selector> {
        match self {
            Self::Predictive | Self::SlowerStage { .. } => Box::new(free_of_charge()),
            Self::Forgetful => Box::new(Forgetful(free_of_charge())),
            Self::Priced => Box::new(Predictive::default()),
            Self::Static => {
                let options = ScreenSizeOptions { band: 0.0, dwell_ms: 0, ..Default::default() };
                Box::new(ScreenSize::new(options).expect("good options"))
            }
        }
    }

    /// Every draw, vertex and triangle costs an integer of 1024ths of a microsecond.
    fn cost(self) -> CostModel {
        let unit_us = 1.0 / UNITS_PER_US;
        let plain = CostModel {
            draw_us: 0.25,
            vertex_us: unit_us,
            triangle_us: unit_us,
            pixel_us: 0.0,
            stages: Stages::Sum,
        };
        match self {
            Self::SlowerStage { pixel_us } => CostModel { pixel_us, stages: Stages::Max, ..plain },
            _ => plain,
        }
    }
}

fn free_of_charge() -> Predictive {
    let options = PredictiveOptions { steadiness: None, hysteresis: 0.0, dwell_ms: 0, dwell: 0.0, ease: 0.0 };
    Predictive::new(options).expect("good options")
}

/// A policy without memory.
#[derive(Clone)]
struct Forgetful(Predictive);

impl Selector for Forgetful {
    fn needs(&self) -> Needs {
        self.0.needs()
    }

    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> lod_budget::frame::SelectReport {
        self.0.reset();
        self.0.select(frame, levels)
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(self.clone())
    }
}

/// A frame loop: hard transitions, the whole budget spent from the first frame on, nothing measured.
pub struct Loop {
    runtime: Runtime,
}

/// What a frame did.
#[derive(Clone, Copy, Default)]
pub struct Done {
    pub visible: usize,
    /// Objects tested one by one, and objects rated.
    pub visits: usize,
}

impl Done {
    fn of(report: &FrameReport) -> Self {
        Self { visible: report.candidates, visits: report.tested_objects + report.candidates }
    }
}

impl Loop {
    pub fn new(policy: Policy) -> Self {
        let feedback =
            FeedbackOptions { start: 1.0, headroom: 0.0, prior_deviation: 0.0, ..Default::default() };
        let options = RuntimeOptions { cost: policy.cost(), feedback, ..RuntimeOptions::default() };
        Self { runtime: Runtime::new(options, policy.selector()).expect("good options") }
    }

    pub fn frame(&mut self, store: &mut Store, camera: &Camera, budget_us: f64) -> Done {
        let views = [ViewInput::new(view(camera), 0)];
        Done::of(self.runtime.frame(&mut store.objects, &FrameInput::new(&views, budget_us)))
    }

    /// The level shown of objects `0..count`, [`NOT_SHOWN`] of what is not.
    pub fn levels(&self, store: &Store, count: usize) -> Vec<u8> {
        let shown = |id| self.runtime.shown(&store.objects, GroupId(0), ObjectId(id)).level.0;
        (0..count as u64).map(shown).collect()
    }
}

/// The selection stage alone, over the candidates that a loop found last.
pub struct SelectStage {
    selector: Box<dyn Selector>,
    levels: Vec<Level>,
}

impl SelectStage {
    pub fn new(policy: Policy) -> Self {
        Self { selector: policy.selector(), levels: Vec::new() }
    }

    /// Selects for the loop's last frame; `around` is called with the work to be timed.
    pub fn select<T>(&mut self, of: &Loop, store: &Store, around: impl FnOnce(&mut dyn FnMut()) -> T) -> T {
        let frame = of.runtime.last_frame(&store.objects);
        self.levels.resize(frame.candidates.len(), Level::NOT_DRAWN);
        around(&mut || {
            self.selector.select(&frame, &mut self.levels);
        })
    }
}

/// Culling alone, to a list of blocks with a mask each.
#[derive(Default)]
pub struct Cull {
    tree: BlockTree,
    visible: Vec<VisibleBlock>,
}

impl Cull {
    /// Brings the tree up to date with the objects.
    pub fn update(&mut self, store: &mut Store) {
        self.tree.update(&mut store.objects);
    }

    /// Returns how many objects are in view.
    pub fn run(&mut self, store: &Store, camera: &Camera) -> usize {
        let lens = view(camera).lens(DVec3::ZERO);
        let report = self.tree.cull(&store.objects, &lens, &CullOptions::default(), &mut self.visible);
        report.visible as usize
    }
}

/// The frame loop's solver on its own, without memory of earlier calls.
#[derive(Default)]
pub struct FrameSolver(SharedKnapsack);

impl FrameSolver {
    pub fn solve(&mut self, problem: &Problem) -> Answer {
        let Self(knapsack) = self;
        knapsack.forget();
        knapsack.profiles.truncate(0);
        for levels in &problem.tables {
            let items = levels.iter().zip(0..);
            let items = items.map(|(l, item)| ProfileItem { value: l.value, ticks: l.units, item });
            knapsack.profiles.push(&items.collect::<Vec<_>>());
        }
        let class = |&(profile, weight): &(u32, f32)| SharedClass {
            profile,
            weight,
            scale: 1.0,
            stay: 0.0,
            current: 0,
        };
        knapsack.classes.clear();
        knapsack.classes.extend(problem.classes.iter().map(class));
        let outcome = knapsack.solve(problem.budget, problem.budget, |i| i as u128);
        Answer { bound: outcome.upper_bound, choice: knapsack.chosen.clone() }
    }
}
