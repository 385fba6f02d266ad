//! The crate: `Runtime::frame` under three policies.
//!
//! A frame is everything that the call does: the look for what has changed, culling, rating, selection (with its
//! certificate, where there is one), transitions, the list of changes, feedback, and the prediction of the frame's
//! time. The machine is one that draws exactly as fast as the cost model says: the time predicted for a frame is
//! handed in as measured with the next.

use std::time::Duration;

use cpu_time::ThreadTime;
use glam::{Quat, Vec2, Vec3};
use lod_budget::select::{Measure, ReactiveOptions, ScreenSizeOptions};
use lod_budget::{
    CostModel, FrameInput, FrameTime, GroupId, LevelRecord, LodTable, Object, Objects, Predictive, Reactive,
    Runtime, RuntimeOptions, ScreenSize, Selector, Sphere, View, ViewInput,
};

use crate::camera::{Bound, Camera, FOV_Y, NEAR, VIEWPORT_PX};
use crate::peer::{Census, Peer, Spent};
use crate::scene::{Kind, LEVELS, Scene, TOLERANCE_PX};

/// Which policy a loop runs by.
#[derive(Clone, Copy, PartialEq)]
pub enum Policy {
    /// By the error in pixels alone, thresholds and nothing else: what the peers do.
    Static,
    /// The same thresholds, scaled until the measured time fits the budget.
    Reactive,
    /// The best choice within the budget, with its certificate.
    Predictive,
}

impl Policy {
    pub const ALL: [Self; 3] = [Self::Static, Self::Reactive, Self::Predictive];

    fn name(self) -> &'static str {
        match self {
            Self::Static => "lod-budget, static",
            Self::Reactive => "lod-budget, reactive",
            Self::Predictive => "lod-budget, predictive",
        }
    }

    fn selector(self) -> Box<dyn Selector> {
        let size = ScreenSizeOptions {
            measure: Measure::ErrorPx(TOLERANCE_PX),
            band: 0.0,
            dwell_ms: 0,
            ..ScreenSizeOptions::default()
        };
        match self {
            Self::Static => Box::new(ScreenSize::new(size).expect("good options")),
            Self::Reactive => {
                Box::new(Reactive::new(ReactiveOptions { size, ..Default::default() }).expect("good options"))
            }
            Self::Predictive => Box::new(Predictive::default()),
        }
    }
}

/// A frame loop with its own store of the scene.
pub struct Loop {
    policy: Policy,
    runtime: Runtime,
    objects: Objects,
    budget_us: f64,
    measured: Option<FrameTime>,
}

impl Loop {
    /// The budget is two fifths of the way from the least to the most that what `start` sees can cost.
    pub fn new(policy: Policy, scene: &Scene, start: &Camera) -> Self {
        let runtime = Runtime::new(RuntimeOptions::default(), policy.selector()).expect("good options");
        let (objects, budget_us) = (store(scene), budget_us(scene, start));
        Self { policy, runtime, objects, budget_us, measured: None }
    }
}

impl Peer for Loop {
    fn name(&self) -> &'static str {
        self.policy.name()
    }

    fn bound(&self) -> Bound {
        Bound::Sphere
    }

    fn frame(&mut self, camera: &Camera) -> Duration {
        let views = [ViewInput::new(view(camera), 0)];
        let measured = self.measured.as_slice();
        let input = FrameInput { measured, ..FrameInput::new(&views, self.budget_us) };
        let start = ThreadTime::now();
        let report = self.runtime.frame(&mut self.objects, &input);
        let time = start.elapsed();
        self.measured = Some(FrameTime::busy(report.frame, report.predicted_us as f32));
        time
    }

    fn census(&mut self) -> Census {
        let mut census = Census::default();
        for (_, shown) in self.runtime.shown_slots(GroupId(0)) {
            census.0[shown.level.index()] += 1;
        }
        census
    }

    fn spent(&self) -> Option<Spent> {
        let report = self.runtime.report();
        let gap = report.select.certificate.map(|certificate| certificate.gap);
        let share = report.predicted_us / self.budget_us;
        (self.policy != Policy::Static).then_some(Spent { share, gap })
    }
}

/// The prices that the loops and the knapsacks share.
pub fn prices_us(kind: &Kind) -> [f64; LEVELS] {
    let cost = CostModel { pixel_us: 0.0, ..CostModel::default() };
    records(kind).map(|level| cost.geometry_us(&level))
}

fn budget_us(scene: &Scene, camera: &Camera) -> f64 {
    let prices: Vec<[f64; LEVELS]> = scene.kinds.iter().map(prices_us).collect();
    let in_view = camera.in_view(scene, Bound::Sphere).map(|instance| prices[instance.kind]);
    let [least, most] = in_view.fold([0.0; 2], |[least, most], p| [least + p[LEVELS - 1], most + p[0]]);
    least + 0.4 * (most - least)
}

fn records(kind: &Kind) -> [LevelRecord; LEVELS] {
    std::array::from_fn(|level| {
        let triangles = kind.triangles[level];
        LevelRecord {
            error: Some(kind.errors[level]),
            accuracy: kind.accuracies[level],
            ..LevelRecord::new(triangles, triangles / 2)
        }
    })
}

fn store(scene: &Scene) -> Objects {
    let mut objects = Objects::new();
    let unit = Sphere::new(Vec3::ZERO, 1.0);
    let table = |kind| LodTable::new("kind", unit, records(kind).to_vec()).expect("a good table");
    let tables: Vec<_> =
        scene.kinds.iter().map(|kind| objects.add_table(table(kind)).expect("few tables")).collect();
    for (id, instance) in (0..).zip(&scene.instances) {
        let bounds = Sphere::new(Vec3::from_array(instance.center), scene.kind(instance).radius);
        objects.insert(Object::new(id, bounds, tables[instance.kind])).expect("a new id");
    }
    objects
}

/// What the crate sees through a camera.
pub fn view(camera: &Camera) -> View {
    let view =
        View { near: NEAR, far: camera.far, ..View::perspective(FOV_Y, Vec2::from_array(VIEWPORT_PX)) };
    view.at(Vec3::from_array(camera.eye), Quat::from_rotation_y(camera.yaw))
}
