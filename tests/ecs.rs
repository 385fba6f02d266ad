//! A hecs world as source and sink: the same decisions as through `Objects` directly, and nothing done for what stands
//! still.
#![cfg(feature = "hecs")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::collections::BTreeMap;

use glam::{Vec2, Vec3};
use hecs::{Entity, World};
use proptest::prelude::*;

use lod_budget::bounds::Sphere;
use lod_budget::ecs::{Bridge, EcsError, LodBounds, LodObject, LodSettings, LodShown, SyncReport};
use lod_budget::frame::{Cause, Change, FrameReport, FrameTime, GroupId};
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
use lod_budget::scene::{Object, ObjectId, Objects, Settings, TableId};
use lod_budget::select::Predictive;
use lod_budget::table::{Level, LevelRecord, LodTable};
use lod_budget::transition::{Shown, TransitionKind, TransitionOptions};
use lod_budget::view::View;

fn store() -> Objects {
    let unit = Sphere::new(Vec3::ZERO, 1.0);
    let chain =
        |finest: u32| (0..4).map(|l| LevelRecord::new(finest >> (2 * l), finest >> (2 * l + 1))).collect();
    let mut objects = Objects::new();
    for (name, finest) in [("rock", 40_000), ("tree", 100_000), ("post", 900)] {
        let table = LodTable::new(name, unit, chain(finest)).expect("a good table");
        objects.add_table(table).expect("few tables");
    }
    objects
}

fn runtime(kind: TransitionKind) -> Runtime {
    let transition = TransitionOptions { kind, reserve: 0.5, ..TransitionOptions::default() };
    let options = RuntimeOptions { transition, ..RuntimeOptions::default() };
    Runtime::new(options, Box::new(Predictive::default())).expect("good options")
}

fn views() -> [ViewInput<'static>; 2] {
    let camera = View::perspective(1.0, Vec2::new(1280.0, 720.0));
    let sun = View::orthographic(40.0, Vec2::new(512.0, 512.0));
    [ViewInput::new(camera, 0), ViewInput::new(sun, 1)]
}

fn at(x: f32, z: f32) -> Sphere {
    Sphere::new(Vec3::new(x, 0.0, z), 1.0)
}

/// Runs a frame whose measurement of two frames ago says that the machine is slower than the model.
fn run_frame(runtime: &mut Runtime, objects: &mut Objects, predicted_us: &mut Vec<FrameTime>) {
    let views = views();
    let measured: Vec<FrameTime> = predicted_us.iter().rev().skip(1).take(1).copied().collect();
    let input = FrameInput { measured: &measured, ..FrameInput::new(&views, 600.0) };
    let report = runtime.frame(objects, &input);
    let busy_us = (report.select.cost_us * 1.2) as f32;
    predicted_us.push(FrameTime::busy(report.frame, busy_us));
}

/// A report without what the arrangement of slots may change: how much culling looked at.
fn without_culling(report: &FrameReport) -> FrameReport {
    FrameReport { visited_nodes: 0, tested_objects: 0, ..*report }
}

#[derive(Clone, Debug)]
enum Op {
    Spawn(u64, Sphere, u16),
    /// Another entity takes over the id.
    Handover(u64),
    Despawn(u64),
    Move(u64, Sphere),
    Table(u64, u16),
    Settings(u64, Option<Settings>),
    /// The entity loses or regains its bounds.
    Toggle(u64),
}

fn ops() -> impl Strategy<Value = Vec<Op>> {
    let id = 0..48u64;
    let place = (-12f32..12.0, -40f32..4.0).prop_map(|(x, z)| at(x, z));
    let setting = prop_oneof![
        Just(None),
        (0.1f32..4.0).prop_map(|importance| Some(Settings { importance, ..Settings::default() })),
        Just(Some(Settings { may_skip: true, ..Settings::default() })),
        Just(Some(Settings { forced: Some(Level(1)), ..Settings::default() })),
        Just(Some(Settings { hidden: true, ..Settings::default() })),
    ];
    let op = prop_oneof![
        6 => (id.clone(), place.clone(), 0..3u16).prop_map(|(id, place, table)| Op::Spawn(id, place, table)),
        1 => id.clone().prop_map(Op::Handover),
        2 => id.clone().prop_map(Op::Despawn),
        6 => (id.clone(), place).prop_map(|(id, place)| Op::Move(id, place)),
        1 => (id.clone(), 0..3u16).prop_map(|(id, table)| Op::Table(id, table)),
        1 => (id.clone(), setting).prop_map(|(id, settings)| Op::Settings(id, settings)),
        1 => id.prop_map(Op::Toggle),
    ];
    prop::collection::vec(op, 0..5)
}

/// The same scene twice: in a world, and in a store that is told of every change by hand.
struct Twins {
    world: World,
    bridge: Bridge,
    entities: BTreeMap<u64, Entity>,
    touched: Vec<Entity>,
    synced: Objects,
    direct: Objects,
}

impl Twins {
    fn new() -> Self {
        Self {
            world: World::new(),
            bridge: Bridge::new(),
            entities: BTreeMap::new(),
            touched: Vec::new(),
            synced: store(),
            direct: store(),
        }
    }

    fn spawn(&mut self, object: Object) {
        let Object { id, bounds, table, settings } = object;
        let parts = (LodObject { id, table }, LodBounds(bounds));
        // Different archetypes, some of which have the result component already.
        let entity = match id.0 % 3 {
            0 => self.world.spawn(parts),
            1 => self.world.spawn((parts.0, parts.1, LodShown::<0>::default())),
            _ => self.world.spawn((parts.0, parts.1, LodShown::<0>::default(), LodShown::<1>::default())),
        };
        if settings != Settings::default() {
            self.world.insert_one(entity, LodSettings(settings)).expect("alive");
        }
        self.touched.push(entity);
        self.entities.insert(id.0, entity);
    }

    fn despawn(&mut self, id: u64) {
        if let Some(entity) = self.entities.remove(&id) {
            self.world.despawn(entity).expect("alive");
            self.touched.push(entity);
        }
    }

    /// The entity of an id that is in the store, noted as touched.
    fn touch(&mut self, id: u64) -> Option<Entity> {
        let entity = *self.entities.get(&id)?;
        self.touched.push(entity);
        Some(entity)
    }

    fn apply(&mut self, op: &Op) {
        match *op {
            Op::Spawn(id, bounds, table) if !self.entities.contains_key(&id) => {
                let object = Object::new(id, bounds, TableId(table));
                self.direct.insert(object).expect("a new id");
                self.spawn(object);
            }
            Op::Handover(id) => {
                if let Some(object) = self.direct.get(ObjectId(id)) {
                    self.despawn(id);
                    self.spawn(object);
                }
            }
            Op::Despawn(id) => {
                self.direct.remove(ObjectId(id));
                self.despawn(id);
            }
            Op::Move(id, bounds) if self.direct.get(ObjectId(id)).is_some() => {
                self.direct.set_bounds(ObjectId(id), bounds).expect("known");
                let entity = self.touch(id).expect("known");
                self.world.query_one_mut::<&mut LodBounds>(entity).expect("has bounds").0 = bounds;
            }
            Op::Table(id, table) if self.direct.get(ObjectId(id)).is_some() => {
                self.direct.set_table(ObjectId(id), TableId(table)).expect("known");
                let entity = self.touch(id).expect("known");
                self.world.query_one_mut::<&mut LodObject>(entity).expect("has a table").table =
                    TableId(table);
            }
            Op::Settings(id, settings) if self.direct.get(ObjectId(id)).is_some() => {
                self.direct.set_settings(ObjectId(id), settings.unwrap_or_default()).expect("good");
                let entity = self.touch(id).expect("known");
                match settings {
                    Some(settings) => self.world.insert_one(entity, LodSettings(settings)).expect("alive"),
                    None => drop(self.world.remove_one::<LodSettings>(entity)),
                }
            }
            Op::Toggle(id) => self.toggle(id),
            _ => {}
        }
    }

    fn toggle(&mut self, id: u64) {
        let Some(entity) = self.touch(id) else { return };
        if self.world.remove_one::<LodBounds>(entity).is_ok() {
            self.direct.remove(ObjectId(id));
        } else {
            self.world.insert_one(entity, LodBounds(at(0.0, -6.0))).expect("alive");
            let lod = *self.world.get::<&LodObject>(entity).expect("kept");
            let settings =
                self.world.get::<&LodSettings>(entity).map_or_else(|_| Settings::default(), |s| s.0);
            let object = Object { settings, ..Object::new(id, at(0.0, -6.0), lod.table) };
            self.direct.insert(object).expect("was removed");
        }
    }

    fn sync(&mut self, only: bool) -> Result<SyncReport, EcsError> {
        let touched = std::mem::take(&mut self.touched);
        match only {
            true => self.bridge.sync_only(&mut self.world, &mut self.synced, &touched),
            false => self.bridge.sync(&mut self.world, &mut self.synced),
        }
    }

    fn assert_shown<const GROUP: u32>(&mut self, runtime: &Runtime) {
        for &entity in self.entities.values() {
            let id = self.world.get::<&LodObject>(entity).expect("kept").id;
            let shown = self.world.get::<&LodShown<GROUP>>(entity).map_or(Shown::NOTHING, |s| s.0);
            assert_eq!(shown, runtime.shown(&self.synced, GroupId(GROUP), id), "object {}", id.0);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, max_shrink_iters: 400, ..ProptestConfig::default() })]

    #[test]
    fn a_world_decides_as_its_objects_do(
        script in prop::collection::vec(ops(), 200),
        only in any::<bool>(),
        fade in any::<bool>(),
    ) {
        let kind = if fade { TransitionKind::CrossFade } else { TransitionKind::Hard };
        let (mut through_world, mut by_hand) = (runtime(kind), runtime(kind));
        let (mut times, mut times_by_hand) = (Vec::new(), Vec::new());
        let mut twins = Twins::new();
        let mut changes = 0;
        for (frame, ops) in script.iter().enumerate() {
            ops.iter().for_each(|op| twins.apply(op));
            prop_assert!(twins.sync(only).is_ok());
            run_frame(&mut through_world, &mut twins.synced, &mut times);
            run_frame(&mut by_hand, &mut twins.direct, &mut times_by_hand);
            prop_assert_eq!(through_world.changes(), by_hand.changes());
            changes += by_hand.changes().len();
            prop_assert_eq!(without_culling(through_world.report()), without_culling(by_hand.report()));
            twins.bridge.write_back::<0>(&mut twins.world, &twins.synced, &through_world);
            twins.assert_shown::<0>(&through_world);
            if frame % 3 == 0 {
                twins.bridge.write_back::<1>(&mut twins.world, &twins.synced, &through_world);
                twins.assert_shown::<1>(&through_world);
            }
        }
        prop_assert!(changes > 0);
    }
}

/// A world of `count` rocks in a row ahead, and what it takes to run it.
struct Row {
    world: World,
    bridge: Bridge,
    objects: Objects,
    runtime: Runtime,
    times: Vec<FrameTime>,
    entities: Vec<Entity>,
}

impl Row {
    fn new(count: u64) -> Self {
        let mut world = World::new();
        let entities = (0..count).map(|i| world.spawn(rock(i))).collect();
        let (bridge, objects) = (Bridge::new(), store());
        Self { world, bridge, objects, runtime: runtime(TransitionKind::Hard), times: Vec::new(), entities }
    }

    fn sync(&mut self) -> Result<SyncReport, EcsError> {
        self.bridge.sync(&mut self.world, &mut self.objects)
    }

    /// One whole frame; how many components were written.
    fn frame(&mut self) -> usize {
        self.sync().expect("good entities");
        run_frame(&mut self.runtime, &mut self.objects, &mut self.times);
        self.bridge.write_back::<0>(&mut self.world, &self.objects, &self.runtime)
    }

    fn shown(&self, i: usize) -> Level {
        self.world.get::<&LodShown>(self.entities[i]).expect("was shown").0.level
    }
}

fn rock(i: u64) -> (LodObject, LodBounds) {
    (LodObject { id: ObjectId(i), table: TableId(0) }, LodBounds(at(i as f32 * 0.5 - 2.0, -12.0)))
}

#[test]
fn what_stands_still_costs_no_work() {
    let mut row = Row::new(8);
    assert_eq!(row.sync(), Ok(SyncReport { looked_at: 8, inserted: 8, ..SyncReport::default() }));
    for _ in 0..60 {
        row.frame();
    }
    let revision = row.objects.revision();
    assert_eq!(row.sync(), Ok(SyncReport { looked_at: 8, ..SyncReport::default() }));
    assert_eq!(row.objects.revision(), revision);
    assert_eq!(row.frame(), 0);
    let nothing = row.bridge.sync_only(&mut row.world, &mut row.objects, &[]);
    assert_eq!(nothing, Ok(SyncReport::default()));
}

#[test]
fn a_bound_that_is_no_number_stands_still_too() {
    let mut row = Row::new(1);
    row.world.insert_one(row.entities[0], LodBounds(Sphere::new(Vec3::NAN, 1.0))).expect("alive");
    assert_eq!(row.sync().map(|r| r.inserted), Ok(1));
    assert_eq!(row.sync(), Ok(SyncReport { looked_at: 1, ..SyncReport::default() }));
    assert_eq!(row.objects.broken_bounds(), 1);
}

#[test]
fn a_despawn_in_view_is_a_change_to_not_drawn() {
    let mut row = Row::new(3);
    row.frame();
    let old = row.shown(1);
    assert!(old.is_drawn());
    row.world.despawn(row.entities[1]).expect("alive");
    row.frame();
    let gone = Change {
        group: GroupId(0),
        object: ObjectId(1),
        old,
        new: Level::NOT_DRAWN,
        cause: Cause::OutOfView,
    };
    assert!(row.runtime.changes().contains(&gone));
    assert_eq!(row.bridge.entity_of(ObjectId(1)), None);
}

#[test]
fn an_entity_that_stops_being_an_object_shows_nothing() {
    let mut row = Row::new(2);
    row.frame();
    assert!(row.shown(0).is_drawn());
    row.world.remove_one::<LodObject>(row.entities[0]).expect("has it");
    row.frame();
    assert_eq!(row.shown(0), Level::NOT_DRAWN);
    assert!(row.shown(1).is_drawn());
}

#[test]
fn an_id_that_two_new_entities_claim_goes_to_neither() {
    let mut row = Row::new(2);
    let twin = row.world.spawn(rock(1));
    let error = row.sync().expect_err("two claims");
    assert_eq!((error.report.inserted, error.report.refused), (1, 2));
    assert_eq!(row.bridge.refused().len(), 2);
    let said = error.to_string();
    assert!(said.ends_with("object 1: several new entities claim the id (and 1 more)"), "{said}");
    row.world.despawn(twin).expect("alive");
    assert_eq!(row.sync().map(|r| r.inserted), Ok(1));
    assert!(row.bridge.refused().is_empty());
}

#[test]
fn an_id_in_use_stays_with_who_has_it_until_that_one_goes() {
    let mut row = Row::new(2);
    row.sync().expect("good entities");
    let late = row.world.spawn(rock(0));
    let error = row.sync().expect_err("in use");
    assert_eq!(
        (error.first.entity, error.first.object, error.first.rule),
        (late, ObjectId(0), "the id is in use")
    );
    assert_eq!(row.bridge.entity_of(ObjectId(0)), Some(row.entities[0]));
    row.world.despawn(row.entities[0]).expect("alive");
    let report = row.sync().expect("free now");
    assert_eq!((report.removed, report.inserted), (1, 1));
    assert_eq!(row.bridge.entity_of(ObjectId(0)), Some(late));
}

#[test]
fn offenders_keep_what_they_had_and_everything_else_is_applied() {
    let mut row = Row::new(4);
    row.sync().expect("good entities");
    let [first, second, third, fourth] = row.entities[..] else { panic!("four rocks") };
    row.world.query_one_mut::<&mut LodObject>(first).expect("has it").table = TableId(9);
    let broken = Settings { bias: 0.0, ..Settings::default() };
    row.world.insert_one(second, LodSettings(broken)).expect("alive");
    row.world.query_one_mut::<&mut LodBounds>(second).expect("has it").0 = at(0.0, -3.0);
    row.world.query_one_mut::<&mut LodBounds>(third).expect("has it").0 = at(0.0, -5.0);
    row.world.despawn(fourth).expect("alive");
    let stranger =
        row.world.spawn((LodObject { id: ObjectId(99), table: TableId(9) }, LodBounds(at(0.0, -5.0))));
    for _ in 0..2 {
        let error = row.sync().expect_err("three offenders");
        assert_eq!(error.first.rule, "its table is unknown");
        let rules: Vec<_> = row.bridge.refused().iter().map(|r| (r.entity, r.object.0, r.rule)).collect();
        let expected = [
            (first, 0, "its table is unknown"),
            (second, 1, "bias must be finite and positive"),
            (stranger, 99, "its table is unknown"),
        ];
        assert_eq!(rules, expected);
    }
    let held = |id| row.objects.get(ObjectId(id));
    assert_eq!(held(0).map(|o| o.table), Some(TableId(0)));
    assert_eq!(held(1).map(|o| (o.bounds, o.settings)), Some((at(0.0, -3.0), Settings::default())));
    assert_eq!(held(2).map(|o| o.bounds), Some(at(0.0, -5.0)));
    assert_eq!((held(3), held(99)), (None, None));
}

#[test]
fn entities_may_swap_their_ids() {
    let mut row = Row::new(2);
    row.frame();
    for (entity, id) in [(row.entities[0], 1), (row.entities[1], 0)] {
        row.world.query_one_mut::<&mut LodObject>(entity).expect("has it").id = ObjectId(id);
    }
    let report = row.sync().expect("still unique");
    assert_eq!((report.removed, report.inserted), (2, 2));
    assert_eq!(row.objects.get(ObjectId(1)).map(|o| o.bounds), Some(rock(0).1.0));
    assert_eq!(row.bridge.entity_of(ObjectId(1)), Some(row.entities[0]));
}

#[test]
fn slots_do_not_depend_on_the_order_of_entities() {
    let slots = |order: &mut dyn Iterator<Item = u64>| -> Vec<_> {
        let (mut world, mut objects) = (World::new(), store());
        order.for_each(|i| match i % 2 {
            0 => drop(world.spawn(rock(i))),
            _ => drop(world.spawn((rock(i).0, rock(i).1, "another archetype"))),
        });
        Bridge::new().sync(&mut world, &mut objects).expect("good entities");
        (0..40).map(|i| objects.slot_of(ObjectId(i))).collect()
    };
    assert_eq!(slots(&mut (0..40)), slots(&mut (0..40).rev()));
}

#[test]
fn clearing_takes_out_what_the_bridge_put_in() {
    let mut row = Row::new(5);
    row.objects.insert(Object::new(77, at(0.0, -9.0), TableId(0))).expect("not the bridge's");
    row.sync().expect("good entities");
    row.bridge.clear(&mut row.objects);
    assert_eq!(row.objects.len(), 1);
    assert_eq!(row.sync().map(|r| r.inserted), Ok(5));
}

#[test]
fn a_partial_sync_before_any_full_one_is_remembered_by_it() {
    let mut row = Row::new(3);
    let touched = [row.entities[0], row.entities[2], row.entities[0]];
    let partial = row.bridge.sync_only(&mut row.world, &mut row.objects, &touched);
    assert_eq!(partial.map(|r| (r.looked_at, r.inserted)), Ok((3, 2)));
    row.world.despawn(row.entities[2]).expect("alive");
    assert_eq!(row.sync().map(|r| (r.inserted, r.removed)), Ok((1, 1)));
}

/// Counts the allocations of the thread that asks.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Moves every rock and replaces one in eight, ids included.
fn stir(row: &mut Row, round: u64) {
    for LodBounds(bounds) in row.world.query_mut::<&mut LodBounds>() {
        bounds.center.x = -bounds.center.x;
    }
    for (i, entity) in row.entities.iter_mut().enumerate().skip(round as usize % 8).step_by(8) {
        row.world.despawn(*entity).expect("alive");
        *entity = row.world.spawn(rock(i as u64 + 1000 * (round % 2)));
    }
}

#[test]
fn nothing_is_allocated_once_warm() {
    let mut row = Row::new(200);
    let mut counted = 0;
    for round in 0..64 {
        stir(&mut row, round);
        let before = ALLOCATIONS.get();
        row.sync().expect("good entities");
        counted += if round < 32 { 0 } else { ALLOCATIONS.get() - before };
        run_frame(&mut row.runtime, &mut row.objects, &mut row.times);
        let before = ALLOCATIONS.get();
        row.bridge.write_back::<0>(&mut row.world, &row.objects, &row.runtime);
        counted += if round < 32 { 0 } else { ALLOCATIONS.get() - before };
    }
    assert_eq!(counted, 0);
    assert!(ALLOCATIONS.get() > 0, "the counter counts");
}

#[test]
fn a_bridge_can_move_to_another_thread() {
    fn is_send<T: Send>(_: &T) {}
    is_send(&Bridge::new());
}
