//! A hecs [`World`] as the source of [`Objects`] and the sink of levels.
//!
//! The world is never the hot store: [`Bridge::sync`] carries what has changed into [`Objects`], the runtime works
//! there, and [`Bridge::write_back`] carries what has changed on the screen into components.
//!
//! ```
//! # use lod_budget::{bounds::Sphere, ecs::*, runtime::*, scene::*, select::Predictive, table::*, view::View};
//! # use glam::{Vec2, Vec3};
//! # let unit = Sphere::new(Vec3::ZERO, 1.0);
//! # let rock = LodTable::new("rock", unit, vec![LevelRecord::new(2000, 1000), LevelRecord::new(100, 60)])?;
//! # let mut runtime = Runtime::new(RuntimeOptions::default(), Box::new(Predictive::default()))?;
//! # let views = [ViewInput::new(View::perspective(1.0, Vec2::new(1280.0, 720.0)), 0)];
//! let mut objects = Objects::new();
//! let table = objects.add_table(rock)?;
//! let mut world = hecs::World::new();
//! let mut bridge = Bridge::new();
//! let ahead = LodBounds(Sphere::new(Vec3::new(0.0, 0.0, -9.0), 1.0));
//! let rock = world.spawn((LodObject { id: ObjectId(7), table }, ahead, LodShown::<0>::default()));
//!
//! // Every frame:
//! bridge.sync(&mut world, &mut objects)?;
//! runtime.frame(&mut objects, &FrameInput::new(&views, 4_000.0));
//! bridge.write_back::<0>(&mut world, &objects, &runtime);
//! assert_eq!(world.get::<&LodShown>(rock)?.0.level, Level::FINEST);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Do not take it when the world is not hecs, or when the engine already knows what spawns, moves and dies: calling
//! [`Objects`] from there costs nothing for what stands still.
//!
//! # Identity
//! An object is known by the [`ObjectId`] that the caller puts into its component, never by its entity. Objects enter
//! the store in the order of their ids, so that neither slots nor decisions depend on the order of entities. An id may
//! pass from one entity to another between two calls; the object then lives on.

use std::collections::HashMap;
use std::fmt;

use hecs::{Entity, QueryOneError, World};

use crate::bounds::Sphere;
use crate::frame::{FrameId, GroupId};
use crate::runtime::Runtime;
use crate::scene::{Object, ObjectError, ObjectId, Objects, Settings, TableId};
use crate::transition::Shown;

/// Component: the entity is an object of the store, under this id and with this table. It needs [`LodBounds`] as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LodObject {
    /// The caller's unique name for it.
    pub id: ObjectId,
    /// Its LOD table.
    pub table: TableId,
}

/// Component: the bound of the object where it is now, relative to [`Objects::origin`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LodBounds(pub Sphere);

/// Component, optional: what the object asks of the selection. Without it, [`Settings::default`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LodSettings(pub Settings);

/// Component: what is shown of the object to view group `GROUP`, written by [`Bridge::write_back`].
///
/// Each group has a component type of its own, so that a shadow pass queries `&LodShown<1>` and the camera's pass
/// `&LodShown`. Groups whose number is not known when compiling are read from [`Runtime::shown`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LodShown<const GROUP: u32 = 0>(pub Shown);

impl<const GROUP: u32> Default for LodShown<GROUP> {
    /// Nothing is shown.
    fn default() -> Self {
        Self(Shown::NOTHING)
    }
}

/// What [`Bridge::sync`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SyncReport {
    /// Entities looked at.
    pub looked_at: usize,
    /// Objects that came into the store.
    pub inserted: usize,
    /// Objects that left it.
    pub removed: usize,
    /// Objects that moved.
    pub moved: usize,
    /// Objects whose table or settings changed.
    pub changed: usize,
    /// Rules broken; see [`Bridge::refused`].
    pub refused: usize,
}

/// What an entity asked for in vain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The entity.
    pub entity: Entity,
    /// The object that it is or wants to be.
    pub object: ObjectId,
    /// The rule it breaks.
    pub rule: &'static str,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "entity {:?}, object {}: {}", self.entity, self.object.0, self.rule)
    }
}

/// Some entities broke a rule. Everything else has been carried over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EcsError {
    /// The refusal of the lowest object id; [`Bridge::refused`] has all of them.
    pub first: Refusal,
    /// What was done nevertheless.
    pub report: SyncReport,
}

impl fmt::Display for EcsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.first)?;
        match self.report.refused {
            1 => Ok(()),
            refused => write!(f, " (and {} more)", refused - 1),
        }
    }
}

impl std::error::Error for EcsError {}

/// What an entity says of itself.
type Source<'a> = (Entity, &'a LodObject, &'a LodBounds, Option<&'a LodSettings>);

/// Carries a [`World`] into [`Objects`] and levels back, and remembers what it has carried.
///
/// It keeps some 80 bytes per entity index and nothing in the world itself. Several bridges may read the same world,
/// each into a store of its own, and several worlds may share a store as long as their ids differ. What a bridge has
/// put into the store is to be changed through its components alone. After [`World::clear`], which numbers entities
/// anew, call [`Bridge::clear`].
#[derive(Default)]
pub struct Bridge {
    /// By the entity's index in the world.
    links: Vec<Option<Link>>,
    /// The settings that each link was given.
    settings: Vec<Settings>,
    /// Per index, the turn of the sync that found the object last; `None` without a link.
    marks: Vec<Option<bool>>,
    /// Alternates from one full sync to the next.
    turn: bool,
    entities: HashMap<ObjectId, Entity>,
    /// What this call has found to be new or different.
    wishes: Vec<Wish>,
    /// Indices whose object leaves with this call.
    leaving: Vec<u32>,
    refused: Vec<Refusal>,
    sinks: Vec<Sink>,
}

/// An entity whose object is in the store, and what the store was told.
#[derive(Clone, Copy, Debug)]
struct Link {
    entity: Entity,
    object: ObjectId,
    bounds: Sphere,
    table: TableId,
    has_settings: bool,
}

/// An entity that asks for a change of the store.
#[derive(Clone, Copy, Debug)]
struct Wish {
    entity: Entity,
    object: Object,
    has_settings: bool,
}

/// The memory of one view group: what has been written to the world.
#[derive(Clone, Debug)]
struct Sink {
    group: GroupId,
    /// The last frame that was written.
    frame: FrameId,
    /// Entities to look at with the next write.
    unsettled: Vec<Entity>,
}

impl Bridge {
    /// A bridge that has carried nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Makes the store agree with the world: entities that have come into being are inserted, those that are gone or
    /// lost a component removed, moved and changed ones updated. Looks at every entity, at some 6 ns for each that
    /// stands still; allocates nothing once it has seen as many entities and changes before.
    ///
    /// # Errors
    /// Entities that break a rule: an id that another entity has, an unknown table, a setting out of its range. They
    /// are left as they were (a new one outside the store, a known one with its old table or settings), tried again by
    /// the next call, and listed in [`Bridge::refused`]; everything else is carried over. Of several new entities with
    /// one id none gets it.
    pub fn sync(&mut self, world: &mut World, objects: &mut Objects) -> Result<SyncReport, EcsError> {
        let looked_at = self.compare_all(world);
        self.find_gone();
        self.apply(world, objects, looked_at)
    }

    /// As [`Bridge::sync`], but looks only at `touched`: for engines that know which entities were spawned, despawned,
    /// moved or changed since the last call. Some 50 to 100 ns for each of them, nothing for the others. Entities may
    /// be listed twice; one that is left out stays as it was until it is listed or a full sync comes by.
    ///
    /// # Errors
    /// As [`Bridge::sync`].
    pub fn sync_only(
        &mut self,
        world: &mut World,
        objects: &mut Objects,
        touched: &[Entity],
    ) -> Result<SyncReport, EcsError> {
        for &entity in touched {
            match world.query_one_mut::<Source<'_>>(entity) {
                Ok(source) => self.wishes.push(Wish::of(source)),
                Err(_) if self.link(entity).is_some() => self.leaving.push(entity.id()),
                Err(_) => {}
            }
        }
        self.find_renamed();
        self.apply(world, objects, touched.len())
    }

    /// What the last sync refused, by object id.
    pub fn refused(&self) -> &[Refusal] {
        &self.refused
    }

    /// The entity that is an object, as of the last sync.
    pub fn entity_of(&self, object: ObjectId) -> Option<Entity> {
        self.entities.get(&object).copied()
    }

    /// Takes everything that the bridge has put into the store out again, and forgets the world.
    pub fn clear(&mut self, objects: &mut Objects) {
        self.links.iter().flatten().for_each(|link| {
            objects.remove(link.object);
        });
        *self = Self::default();
    }

    fn link(&self, entity: Entity) -> Option<&Link> {
        self.links.get(entity.id() as usize)?.as_ref().filter(|link| link.entity == entity)
    }

    /// Compares every entity with its link. Nearly all stand still: they are passed over in a few loads.
    fn compare_all(&mut self, world: &mut World) -> usize {
        self.turn = !self.turn;
        let found = Some(self.turn);
        let Self { links, settings, marks, wishes, .. } = self;
        let (links, settings, marks) = (&links[..], &settings[..], &mut marks[..]);
        let mut looked_at = 0;
        world.query_mut::<Source<'_>>().into_iter().for_each(|(entity, lod, bounds, asked)| {
            looked_at += 1;
            let index = entity.id() as usize;
            match links.get(index) {
                Some(Some(link))
                    if link.is_current(entity, lod, bounds)
                        && link.has_settings == asked.is_some()
                        && asked.is_none_or(|asked| asked.0 == settings[index]) =>
                {
                    marks[index] = found;
                }
                _ => wishes.push(Wish::of((entity, lod, bounds, asked))),
            }
        });
        self.find_renamed();
        looked_at
    }

    /// Marks what was found again in another state, and lists the links whose entity has become another object.
    fn find_renamed(&mut self) {
        for wish in &self.wishes {
            let index = wish.entity.id();
            match self.links.get(index as usize).copied().flatten() {
                Some(link) if link.object == wish.object.id => {
                    self.marks[index as usize] = Some(self.turn);
                }
                Some(_) => self.leaving.push(index),
                None => {}
            }
        }
    }

    /// Lists the links that a full sync has not found again.
    fn find_gone(&mut self) {
        let gone = self.marks.iter().enumerate().filter(|&(_, &mark)| mark == Some(!self.turn));
        self.leaving.extend(gone.map(|(index, _)| index as u32));
    }

    /// Carries out what the comparison has found: departures free their ids before arrivals claim them.
    fn apply(
        &mut self,
        world: &World,
        objects: &mut Objects,
        looked_at: usize,
    ) -> Result<SyncReport, EcsError> {
        let mut report = SyncReport { looked_at, ..SyncReport::default() };
        self.refused.clear();
        let mut wishes = std::mem::take(&mut self.wishes);
        report.removed = self.remove_leaving(objects);
        wishes.retain(|wish| !self.update(wish, objects, &mut report));
        report.inserted = self.insert_new(&mut wishes, objects);
        wishes.clear();
        self.wishes = wishes;
        self.sinks.iter_mut().for_each(|sink| sink.compact(world));
        self.verdict(report)
    }

    fn remove_leaving(&mut self, objects: &mut Objects) -> usize {
        let mut removed = 0;
        while let Some(index) = self.leaving.pop() {
            let Some(link) = self.links[index as usize].take() else { continue };
            self.marks[index as usize] = None;
            self.entities.remove(&link.object);
            objects.remove(link.object);
            self.unsettle(link.entity);
            removed += 1;
        }
        removed
    }

    /// Brings a known object up to date; false when the entity's object is not known.
    fn update(&mut self, wish: &Wish, objects: &mut Objects, report: &mut SyncReport) -> bool {
        let index = wish.entity.id() as usize;
        let Some(mut link) = self.links.get(index).copied().flatten() else { return false };
        if link.entity != wish.entity {
            link.entity = wish.entity;
            self.entities.insert(link.object, wish.entity);
            self.unsettle(wish.entity);
        }
        if !same_bits(&link.bounds, &wish.object.bounds) {
            let moved = objects.set_bounds(link.object, wish.object.bounds);
            if self.accept(wish, moved) {
                link.bounds = wish.object.bounds;
                report.moved += 1;
            }
        }
        report.changed += usize::from(self.update_choice(wish, &mut link, objects));
        self.links[index] = Some(link);
        true
    }

    /// Brings table and settings up to date; whether one of them has changed.
    fn update_choice(&mut self, wish: &Wish, link: &mut Link, objects: &mut Objects) -> bool {
        let Object { table, settings, .. } = wish.object;
        let index = wish.entity.id() as usize;
        let mut changed = false;
        if link.table != table {
            let set = objects.set_table(link.object, table);
            if self.accept(wish, set) {
                link.table = table;
                changed = true;
            }
        }
        if self.settings[index] != settings {
            let set = objects.set_settings(link.object, settings);
            if !self.accept(wish, set) {
                return changed;
            }
            self.settings[index] = settings;
            changed = true;
        }
        link.has_settings = wish.has_settings;
        changed
    }

    /// Inserts new objects in the order of their ids.
    fn insert_new(&mut self, wishes: &mut Vec<Wish>, objects: &mut Objects) -> usize {
        wishes.sort_unstable_by_key(|wish| (wish.object.id, wish.entity));
        wishes.dedup_by_key(|wish| wish.entity);
        let mut inserted = 0;
        for claims in wishes.chunk_by(|a, b| a.object.id == b.object.id) {
            if let [wish] = claims {
                let entered = objects.insert(wish.object);
                if self.accept(wish, entered) {
                    self.add_link(wish);
                    inserted += 1;
                }
            } else {
                claims.iter().for_each(|wish| self.refuse(wish, "several new entities claim the id"));
            }
        }
        inserted
    }

    fn add_link(&mut self, wish: &Wish) {
        let index = wish.entity.id() as usize;
        if index >= self.links.len() {
            self.links.resize(index + 1, None);
            self.settings.resize(index + 1, Settings::default());
            self.marks.resize(index + 1, None);
        }
        let Wish { entity, object, has_settings } = *wish;
        let Object { id, bounds, table, settings } = object;
        self.links[index] = Some(Link { entity, object: id, bounds, table, has_settings });
        self.settings[index] = settings;
        self.marks[index] = Some(self.turn);
        self.entities.insert(id, entity);
        self.unsettle(entity);
    }

    /// Whether the store took it; a refusal is noted.
    fn accept(&mut self, wish: &Wish, answer: Result<(), ObjectError>) -> bool {
        answer.map_err(|error| self.refuse(wish, error.rule)).is_ok()
    }

    fn refuse(&mut self, wish: &Wish, rule: &'static str) {
        self.refused.push(Refusal { entity: wish.entity, object: wish.object.id, rule });
    }

    fn verdict(&mut self, mut report: SyncReport) -> Result<SyncReport, EcsError> {
        self.refused.sort_unstable_by_key(|r| (r.object, r.entity, r.rule));
        report.refused = self.refused.len();
        match self.refused.first() {
            Some(&first) => Err(EcsError { first, report }),
            None => Ok(report),
        }
    }

    /// Has every group look at an entity with its next write, even if nothing changes on the screen: what the component
    /// says may be of another object, or of none.
    fn unsettle(&mut self, entity: Entity) {
        self.sinks.iter_mut().for_each(|sink| sink.unsettled.push(entity));
    }

    /// Writes what is shown to view group `GROUP` into [`LodShown`]: once after each [`Runtime::frame`], and after the
    /// sync before it. Returns how many components it wrote.
    ///
    /// Touches only what has changed with the frame or is in transition. After frames that were not written (the
    /// group's first write, a gap, a reset or restored runtime) it looks at everything once.
    ///
    /// An entity without the component gets it when it is first shown, which moves it to another archetype, once; spawn
    /// entities with `LodShown::<GROUP>::default()` to avoid that. It keeps the component, which says
    /// [`Shown::NOTHING`] while it is out of view.
    pub fn write_back<const GROUP: u32>(
        &mut self,
        world: &mut World,
        objects: &Objects,
        runtime: &Runtime,
    ) -> usize {
        let group = GroupId(GROUP);
        let at = self.sink(group);
        self.gather(at, runtime);
        let mut unsettled = std::mem::take(&mut self.sinks[at].unsettled);
        unsettled.sort_unstable();
        unsettled.dedup();
        let mut written = 0;
        unsettled.retain(|&entity| {
            let link = self.link(entity);
            let shown = link.map_or(Shown::NOTHING, |link| runtime.shown(objects, group, link.object));
            written += usize::from(write::<GROUP>(world, entity, shown));
            shown.is_in_flight()
        });
        self.sinks[at].unsettled = unsettled;
        written
    }

    fn sink(&mut self, group: GroupId) -> usize {
        self.sinks.binary_search_by_key(&group, |sink| sink.group).unwrap_or_else(|at| {
            self.sinks.insert(at, Sink { group, frame: FrameId(0), unsettled: Vec::new() });
            at
        })
    }

    /// Lists the entities that the frame changed; all of them when frames were missed.
    fn gather(&mut self, at: usize, runtime: &Runtime) {
        let sink = &mut self.sinks[at];
        let frame = runtime.report().frame;
        let before = std::mem::replace(&mut sink.frame, frame);
        if frame.0 == before.0 + 1 {
            let changes = runtime.changes();
            let from = changes.partition_point(|change| change.group < sink.group);
            let changes = changes[from..].iter().take_while(|change| change.group == sink.group);
            sink.unsettled.extend(changes.filter_map(|change| self.entities.get(&change.object)));
        } else if frame != before {
            sink.unsettled.extend(self.links.iter().flatten().map(|link| link.entity));
        }
    }
}

impl Link {
    /// Whether the store has been told all that the entity says, its settings aside.
    #[inline]
    fn is_current(&self, entity: Entity, lod: &LodObject, bounds: &LodBounds) -> bool {
        (self.entity == entity)
            & (self.object == lod.id)
            & (self.table == lod.table)
            & same_bits(&self.bounds, &bounds.0)
    }
}

impl Wish {
    fn of((entity, lod, bounds, settings): Source<'_>) -> Self {
        let has_settings = settings.is_some();
        let settings = settings.map_or_else(Settings::default, |settings| settings.0);
        let object = Object { id: lod.id, bounds: bounds.0, table: lod.table, settings };
        Self { entity, object, has_settings }
    }
}

impl Sink {
    /// Keeps the list from growing while a group is not written.
    fn compact(&mut self, world: &World) {
        if self.unsettled.len() > 2 * world.len() as usize + 64 {
            self.unsettled.retain(|&entity| world.contains(entity));
            self.unsettled.sort_unstable();
            self.unsettled.dedup();
        }
    }
}

/// Whether two bounds are the same to the bit, so that one that is not a number stands still as well.
fn same_bits(a: &Sphere, b: &Sphere) -> bool {
    let same = |a: f32, b: f32| a.to_bits() == b.to_bits();
    let (here, there) = (a.center, b.center);
    same(here.x, there.x) & same(here.y, there.y) & same(here.z, there.z) & same(a.radius, b.radius)
}

/// Whether the component was written: an entity that never was shown needs none.
fn write<const GROUP: u32>(world: &mut World, entity: Entity, shown: Shown) -> bool {
    match world.query_one_mut::<&mut LodShown<GROUP>>(entity) {
        Ok(known) => std::mem::replace(&mut known.0, shown) != shown,
        Err(QueryOneError::Unsatisfied) if shown != Shown::NOTHING => {
            world.insert_one(entity, LodShown::<GROUP>(shown)).is_ok()
        }
        Err(_) => false,
    }
}
