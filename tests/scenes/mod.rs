//! Random scenes, cameras and policies for the tests of the runtime.

use glam::{Quat, Vec2, Vec3};
use lod_budget::bounds::Sphere;
use lod_budget::check::Promise;
use lod_budget::cull::CullOptions;
use lod_budget::frame::{Change, FrameId, FrameReport, FrameTime, GroupId};
use lod_budget::rate::{BenefitModel, CostModel, Stages};
use lod_budget::runtime::{Runtime, RuntimeOptions, ViewInput};
use lod_budget::scene::{LevelRange, Object, ObjectId, Objects, Settings, TableId};
use lod_budget::select::{
    Coarsest, Finest, FunkhouserSequin, Measure, Predictive, PredictiveOptions, Reactive, ScreenSize,
    ScreenSizeOptions, Selector,
};
use lod_budget::table::{Level, LevelRecord, LodTable};
use lod_budget::transition::{Shown, TransitionKind, TransitionOptions};
use lod_budget::view::{Projection, View, Window};
use proptest::prelude::*;

/// Every policy of the crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Policy {
    Finest,
    Coarsest,
    ErrorPx,
    Authored,
    Reactive,
    FunkhouserSequin,
    Predictive,
    Steady,
}

pub const POLICIES: [Policy; 8] = [
    Policy::Finest,
    Policy::Coarsest,
    Policy::ErrorPx,
    Policy::Authored,
    Policy::Reactive,
    Policy::FunkhouserSequin,
    Policy::Predictive,
    Policy::Steady,
];

impl Policy {
    pub fn selector(self) -> Box<dyn Selector> {
        match self {
            Self::Finest => Box::new(Finest),
            Self::Coarsest => Box::new(Coarsest),
            Self::ErrorPx => Box::new(screen_size(Measure::ErrorPx(1.0))),
            Self::Authored => Box::new(screen_size(Measure::Authored { error_px: 2.0 })),
            Self::Reactive => Box::new(Reactive::new(Default::default()).expect("defaults are good")),
            Self::FunkhouserSequin => Box::new(FunkhouserSequin::default()),
            Self::Predictive => Box::new(priced()),
            Self::Steady => Box::new(Predictive::default()),
        }
    }

    pub fn promise(self) -> Promise {
        match self {
            Self::Predictive | Self::Steady => Promise::Budget,
            _ => Promise::Levels,
        }
    }
}

/// Hysteresis as a price inside the objective.
fn priced() -> Predictive {
    Predictive::new(PredictiveOptions { steadiness: None, ..Default::default() }).expect("good options")
}

fn screen_size(measure: Measure) -> ScreenSize {
    ScreenSize::new(ScreenSizeOptions { measure, ..Default::default() }).expect("good options")
}

/// What a store of objects is made from.
#[derive(Clone, Debug)]
pub struct Scene {
    pub tables: Vec<Vec<LevelRecord>>,
    pub objects: Vec<Object>,
}

impl Scene {
    /// The store, its objects inserted in the order of the scene.
    pub fn store(&self) -> Objects {
        self.store_in(0..self.objects.len())
    }

    /// The store, its objects inserted in this order.
    pub fn store_in(&self, order: impl IntoIterator<Item = usize>) -> Objects {
        let mut store = Objects::new();
        for (i, levels) in self.tables.iter().enumerate() {
            let bounds = Sphere::new(Vec3::ZERO, 1.0);
            let table = LodTable::new(format!("table {i}"), bounds, levels.clone()).expect("a good table");
            store.add_table(table).expect("room for tables");
        }
        order.into_iter().for_each(|i| store.insert(self.objects[i]).expect("a good object"));
        store
    }
}

/// A permutation of so many things.
pub fn shuffled(count: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&i| {
        (i as u64 ^ seed).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(21).wrapping_mul(seed | 1)
    });
    order
}

/// Re-arranges the slots of a store at random.
pub fn reorder(objects: &mut Objects, seed: u64) {
    let slots = 0..objects.blocks().len() * lod_budget::scene::BLOCK;
    let occupied: Vec<u32> = slots.filter(|&s| objects.id_of(s).is_some()).map(|s| s as u32).collect();
    let order: Vec<u32> = shuffled(occupied.len(), seed).into_iter().map(|i| occupied[i]).collect();
    objects.reorder(&order);
}

/// A chain of levels that halves from `triangles`.
pub fn halving(triangles: u32, levels: usize) -> Vec<LevelRecord> {
    (0..levels).map(|l| LevelRecord::new((triangles >> l).max(2), (triangles >> l).max(2) / 2 + 2)).collect()
}

fn level() -> impl Strategy<Value = LevelRecord> {
    let triangles = prop_oneof![1 => Just(0u32), 3 => 1u32..50, 6 => 50u32..200_000];
    let size = prop::option::weighted(0.3, 0.0f32..1.5);
    (triangles, 0u32..100_000, 0u32..4, 0.0f32..=1.0, prop::option::weighted(0.5, 0.0f32..0.5), size)
        .prop_map(|(triangles, vertices, draws, accuracy, error, min_size)| LevelRecord {
            draws,
            accuracy,
            error,
            min_size,
            ..LevelRecord::new(triangles, vertices)
        })
}

/// Halving chains, ragged ones without any order, and ones whose levels all cost the same.
fn levels() -> impl Strategy<Value = Vec<LevelRecord>> {
    let halving = (1u32..100_000, 1usize..=12).prop_map(|(t, n)| halving(t, n));
    let equal = (level(), prop::collection::vec(0.0f32..=1.0, 1..=12)).prop_map(|(level, accuracies)| {
        accuracies.into_iter().map(|accuracy| LevelRecord { accuracy, ..level }).collect()
    });
    prop_oneof![4 => halving, 3 => prop::collection::vec(level(), 1..=12), 1 => equal]
}

fn range() -> impl Strategy<Value = LevelRange> {
    (0u8..8, 0u8..8).prop_map(|(finest, more)| LevelRange::new(finest, finest + more))
}

fn special_settings() -> impl Strategy<Value = Settings> {
    let factors = (
        prop_oneof![Just(1.0f32), Just(0.0), 0.1f32..50.0],
        prop_oneof![Just(1.0f32), 0.1f32..8.0],
        prop_oneof![Just(1.0f32), 0.1f32..20.0],
    );
    let ranges = (
        prop_oneof![2 => Just(LevelRange::ALL), 1 => range()],
        prop_oneof![2 => Just(LevelRange::ALL), 1 => range()],
        prop::option::weighted(0.2, (0u8..10).prop_map(Level)),
    );
    let rest = (any::<bool>(), prop_oneof![Just(f32::INFINITY), 0.0f32..200.0], prop::bool::weighted(0.1));
    (factors, ranges, rest, -5.0f32..5.0).prop_map(
        |((importance, bias, cost_multiplier), (clamp, resident, forced), (may_skip, far, hidden), speed)| {
            Settings {
                importance,
                bias,
                cost_multiplier,
                clamp,
                resident,
                forced,
                may_skip,
                draw_distance: far,
                hidden,
                velocity: Vec3::new(speed, 0.0, speed * 0.5),
            }
        },
    )
}

/// Where an object is: nearly always somewhere, at times nowhere.
fn bounds() -> impl Strategy<Value = Sphere> {
    let ball = |center: f32| {
        let side = -center..center;
        let radius = prop_oneof![1 => Just(0.0f32), 9 => 0.01f32..1.0, 5 => 1.0f32..6.0];
        (side.clone(), side.clone(), side, radius)
            .prop_map(|(x, y, z, radius)| Sphere::new(Vec3::new(x, y, z), radius))
    };
    let broken = prop_oneof![
        Just(Sphere::new(Vec3::NAN, 1.0)),
        Just(Sphere::new(Vec3::ZERO, f32::INFINITY)),
        Just(Sphere::new(Vec3::ZERO, -1.0)),
    ];
    prop_oneof![20 => ball(20.0), 20 => ball(60.0), 1 => broken]
}

/// How many objects: none, one, a few, hundreds.
fn counts() -> impl Strategy<Value = usize> {
    prop_oneof![1 => Just(0usize), 2 => Just(1), 8 => 2usize..14, 3 => 60usize..300]
}

/// Random scenes; ids are neither dense nor in order of insertion.
pub fn scene() -> impl Strategy<Value = Scene> {
    let settings = prop_oneof![3 => Just(Settings::default()), 2 => special_settings()];
    let objects = counts().prop_flat_map(move |n| {
        prop::collection::vec((bounds(), any::<prop::sample::Index>(), settings.clone()), n)
    });
    (prop::collection::vec(levels(), 1..5), objects).prop_map(|(tables, objects)| {
        let object =
            |(i, (bounds, table, settings)): (usize, (Sphere, prop::sample::Index, Settings))| Object {
                id: ObjectId((i as u64).wrapping_mul(0x5851_f42d_4c95_7f2d)),
                bounds,
                table: TableId(table.index(tables.len()) as u16),
                settings,
            };
        Scene { objects: objects.into_iter().enumerate().map(object).collect(), tables }
    })
}

/// The cameras of one frame and the group of each.
pub type Cameras = Vec<(View, GroupId)>;

/// One rig: a view, its group, where it starts and how it moves per frame.
#[derive(Clone, Copy, Debug)]
struct Rig {
    projection: Projection,
    viewport_px: Vec2,
    group: u32,
    eye: Vec3,
    yaw: f32,
    step: Vec3,
    turn: f32,
}

impl Rig {
    fn at(&self, frame: f32, jump: Vec3) -> (View, GroupId) {
        let rotation = Quat::from_rotation_y(self.yaw + self.turn * frame);
        let view = View::through(self.projection, self.viewport_px)
            .at(self.eye + self.step * frame + jump, rotation);
        (View { velocity: self.step * 60.0, ..view }, GroupId(self.group))
    }
}

fn projection() -> impl Strategy<Value = Projection> {
    let window = |size: f32| {
        (0.2f32..1.0, 0.2f32..1.0, 0.2f32..1.0, 0.2f32..1.0).prop_map(move |(l, r, b, t)| Window {
            left: -l * size,
            right: r * size,
            bottom: -b * size,
            top: t * size,
        })
    };
    prop_oneof![
        4 => (0.2f32..1.5).prop_map(|half| Projection::Perspective(Window::symmetric(half * 1.5, half))),
        2 => window(1.0).prop_map(Projection::Perspective),
        1 => window(60.0).prop_map(Projection::Orthographic),
    ]
}

fn rig() -> impl Strategy<Value = Rig> {
    let place = (-30.0f32..30.0, -5.0f32..5.0, -30.0f32..30.0).prop_map(|(x, y, z)| Vec3::new(x, y, z));
    let step = (-1.0f32..1.0, -1.0f32..1.0).prop_map(|(x, z)| Vec3::new(x, 0.0, z));
    let viewport = prop_oneof![Just(Vec2::new(1920.0, 1080.0)), Just(Vec2::new(640.0, 480.0))];
    let turning = (-3.0f32..3.0, prop_oneof![Just(0.0f32), -0.3f32..0.3]);
    (projection(), viewport, 0u32..3, place, step, turning).prop_map(
        |(projection, viewport_px, group, eye, step, (yaw, turn))| Rig {
            projection,
            viewport_px,
            group,
            eye,
            yaw,
            step,
            turn,
        },
    )
}

/// The cameras of a number of frames: standing, moving, turning, and at times somewhere else at once. A group may be
/// missing from a frame.
pub fn film(frames: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Cameras>> {
    let jumps = prop::collection::vec(prop::option::weighted(0.15, -40.0f32..40.0), frames);
    let shots = (prop::collection::vec(rig(), 1..5), jumps, prop::option::weighted(0.2, 0usize..4));
    shots.prop_map(|(rigs, jumps, absent)| {
        let mut jump = Vec3::ZERO;
        let cameras = |(n, jumped): (usize, Option<f32>)| {
            jump += jumped.map_or(Vec3::ZERO, |by| Vec3::new(by, 0.0, -by));
            let there = rigs.iter().filter(|r| absent != Some(n) || r.group != 0);
            there.map(|rig| rig.at(n as f32, jump)).collect()
        };
        jumps.into_iter().enumerate().map(cameras).collect()
    })
}

pub fn inputs(cameras: &Cameras) -> Vec<ViewInput<'static>> {
    cameras.iter().map(|&(view, group)| ViewInput::new(view, group.0)).collect()
}

/// Options of the runtime that matter to the contract.
pub fn options() -> impl Strategy<Value = RuntimeOptions> {
    let kind = prop_oneof![
        Just(TransitionKind::Hard),
        Just(TransitionKind::CrossFade),
        Just(TransitionKind::Geomorph)
    ];
    let cost = (
        prop_oneof![Just(Stages::Sum), Just(Stages::Max)],
        prop_oneof![
            Just(CostModel::default()),
            Just(CostModel::default().with_coefficients([0.0, 0.0, 0.001, 0.0])),
            Just(CostModel::default().with_coefficients([3.0, 0.01, 0.02, 0.01])),
        ],
    );
    let benefit = (prop_oneof![Just(0.0f32), Just(4.0)], prop_oneof![Just(0.0f32), Just(1.0)]);
    let enough = prop_oneof![4 => Just(0.0f32), 1 => 0.1f32..5.0];
    let transition = (kind, prop_oneof![Just(0.05f32), Just(0.0), Just(1.0)], 20.0f32..300.0);
    (transition, cost, benefit, enough, prop_oneof![Just(0.0f32), Just(3.0)]).prop_map(
        |((kind, reserve, duration_ms), (stages, cost), (focus, motion), enough_px, min_size_px)| {
            RuntimeOptions {
                transition: TransitionOptions { kind, duration_ms, reserve },
                cost: CostModel { stages, ..cost },
                benefit: BenefitModel { focus, motion, enough_px },
                cull: CullOptions { min_size_px },
                ..RuntimeOptions::default()
            }
        },
    )
}

/// A budget, by what the minimum choice of the first frame costs.
#[derive(Clone, Copy, Debug)]
pub enum BudgetOf {
    Fixed(f64),
    Minimum(f64),
}

impl BudgetOf {
    pub fn us(self, minimum_us: f64) -> f64 {
        match self {
            Self::Fixed(us) => us,
            Self::Minimum(factor) => minimum_us * factor,
        }
    }
}

/// None, tiny, around the minimum choice, some, huge, and no number at all.
pub fn budget() -> impl Strategy<Value = BudgetOf> {
    prop_oneof![
        1 => prop_oneof![Just(0.0), Just(-1.0), Just(f64::NAN), Just(1e-9), Just(1e12), Just(f64::INFINITY)]
            .prop_map(BudgetOf::Fixed),
        2 => (0.5f64..2.5).prop_map(BudgetOf::Minimum),
        4 => (2.0f64..60.0).prop_map(BudgetOf::Minimum),
    ]
}

/// The measurements that arrive before frame `n`: the frames of `late` frames ago took `ratio` times what was
/// predicted. Every seventh is no time at all, and strangers come along.
pub fn measured(n: u64, predicted_us: &[f64], late: u64, ratio: f64) -> Vec<FrameTime> {
    let Some(frame) = n.checked_sub(late + 1).filter(|&f| f > 0) else { return Vec::new() };
    let time_us = match n % 7 {
        3 => f32::NAN,
        _ => (predicted_us[frame as usize - 1] * ratio) as f32,
    };
    vec![FrameTime::busy(FrameId(frame + 1000), 5.0), FrameTime::busy(FrameId(frame), time_us)]
}

/// What is remembered of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    pub changes: Vec<Change>,
    pub report: FrameReport,
    pub shown: Vec<(GroupId, ObjectId, Shown)>,
}

impl Record {
    /// How much culling looks at is left out: that depends on slots, and on what it was told of tables before.
    pub fn of(runtime: &Runtime, objects: &Objects) -> Self {
        let report =
            FrameReport { visited_nodes: 0, tested_objects: 0, worth_too_little: 0, ..*runtime.report() };
        let of_group = |group| runtime.shown_slots(group).map(move |(slot, shown)| (group, slot, shown));
        let named = |(group, slot, shown)| (group, objects.id_of(slot).unwrap_or_default(), shown);
        let mut shown: Vec<_> = (0..4).map(GroupId).flat_map(of_group).map(named).collect();
        shown.sort_by_key(|&(group, id, _)| (group, id));
        Self { changes: runtime.changes().to_vec(), report, shown }
    }
}
