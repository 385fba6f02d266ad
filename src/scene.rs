//! The hot store of what may be drawn: caller-given stable ids outside, movable slots in blocks of 16 inside.

use std::collections::HashMap;
use std::fmt;
use std::hash::{BuildHasherDefault, Hasher};

use glam::{DVec3, Vec3};

use crate::bounds::Sphere;
use crate::table::{Level, LodTable};

/// The caller's name for an object: unique, stable, and the breaker of every tie (the lower id goes first).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ObjectId(pub u64);

/// Which table of [`Objects`] an object uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TableId(pub u16);

/// Levels from `finest` to `coarsest`, both included. Reaching beyond a table's last level is allowed: the range is
/// cut to the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LevelRange {
    /// The finest level allowed.
    pub finest: Level,
    /// The coarsest level allowed.
    pub coarsest: Level,
}

impl LevelRange {
    /// Every level of any table.
    pub const ALL: Self = Self { finest: Level(0), coarsest: Level(254) };

    /// From `finest` to `coarsest`, both included.
    pub const fn new(finest: u8, coarsest: u8) -> Self {
        Self { finest: Level(finest), coarsest: Level(coarsest) }
    }

    /// Whether `level` is in the range.
    pub fn contains(&self, level: Level) -> bool {
        self.finest <= level && level <= self.coarsest
    }

    fn is_valid(&self) -> bool {
        self.finest <= self.coarsest && self.coarsest.is_drawn()
    }

    fn nearest(&self, level: Level) -> Level {
        level.clamp(self.finest, self.coarsest)
    }

    /// The levels of `wish` that are in the range, or the one nearest to it.
    fn narrowed(&self, wish: LevelRange) -> LevelRange {
        LevelRange { finest: self.nearest(wish.finest), coarsest: self.nearest(wish.coarsest) }
    }
}

/// What an object asks of the selection, beyond its table. The default asks for nothing special.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Factor on the benefit, ≥ 0.
    pub importance: f32,
    /// The object is treated as if it were so many times its size on the screen; > 0.
    pub bias: f32,
    /// Factor on the cost, for skinning or an expensive material; > 0.
    pub cost_multiplier: f32,
    /// Levels that the author allows.
    pub clamp: LevelRange,
    /// The level to show whatever it costs.
    pub forced: Option<Level>,
    /// Levels that are in memory.
    pub resident: LevelRange,
    /// Whether the selection may leave the object out where its benefit is not worth its cost. It stays in where the
    /// coarsest level of its table is ruled out: what must not be coarser must not be missing.
    pub may_skip: bool,
    /// The object is not drawn beyond this distance from the eye.
    pub draw_distance: f32,
    /// Whether the caller hides the object from every view.
    pub hidden: bool,
    /// Velocity in world units per second; matters only where the benefit model weighs motion.
    pub velocity: Vec3,
}

/// The most that importance · bias² may be: benefits of whole screens of such objects are still summed exactly.
const MOST_GAIN: f32 = 1e12;
/// The most that a cost multiplier may be: the ticks that costs are counted in still hold the cost of many.
const MOST_COST: f32 = 1e6;

impl Default for Settings {
    fn default() -> Self {
        Self {
            importance: 1.0,
            bias: 1.0,
            cost_multiplier: 1.0,
            clamp: LevelRange::ALL,
            forced: None,
            resident: LevelRange::ALL,
            may_skip: false,
            draw_distance: f32::INFINITY,
            hidden: false,
            velocity: Vec3::ZERO,
        }
    }
}

impl Settings {
    /// The levels of a table of `levels` levels that may be shown: resident goes before forced, forced before clamp.
    pub fn allowed(&self, levels: usize) -> LevelRange {
        let resident = self.showable(levels);
        match self.forced {
            Some(level) => resident.narrowed(LevelRange { finest: level, coarsest: level }),
            None => resident.narrowed(self.clamp),
        }
    }

    /// The levels of a table of `levels` levels that are in memory, or the one nearest to them.
    pub fn showable(&self, levels: usize) -> LevelRange {
        let table = LevelRange { finest: Level::FINEST, coarsest: Level((levels - 1) as u8) };
        table.narrowed(self.resident)
    }

    /// Whether the selection may leave out an object with a table of `levels` levels: where skipping is allowed and
    /// neither force, clamp nor residency rules out the coarsest level.
    pub fn may_be_left_out(&self, levels: usize) -> bool {
        let coarsest = || self.allowed(levels).coarsest.index() + 1 == levels;
        self.may_skip && self.forced.is_none() && coarsest()
    }

    fn broken_rule(&self) -> Option<&'static str> {
        let is_factor = |x: f32| x.is_finite() && x > 0.0;
        if !(self.importance.is_finite() && self.importance >= 0.0) {
            Some("importance must be finite and not negative")
        } else if !is_factor(self.bias) {
            Some("bias must be finite and positive")
        } else if self.importance * (self.bias * self.bias) > MOST_GAIN
            || !(self.bias * self.bias).is_finite()
        {
            Some("importance times bias squared must be at most 1e12")
        } else if !is_factor(self.cost_multiplier) {
            Some("cost_multiplier must be finite and positive")
        } else if self.cost_multiplier > MOST_COST {
            Some("cost_multiplier must be at most 1e6")
        } else if !self.clamp.is_valid() || !self.resident.is_valid() {
            Some("a range of levels must go from a finer level to a coarser one that is drawn")
        } else if self.forced.is_some_and(|l| !l.is_drawn()) {
            Some("a forced level must be drawn; hide the object instead")
        } else if self.draw_distance.is_nan() || self.draw_distance < 0.0 {
            Some("draw_distance must not be negative")
        } else if !self.velocity.is_finite() {
            Some("velocity must be finite")
        } else {
            None
        }
    }

    /// Whether culling has to look beyond the hot columns for this object.
    fn is_adjusted(&self) -> bool {
        self.bias != 1.0 || self.cost_multiplier != 1.0 || self.draw_distance < f32::INFINITY
    }

    /// Whether a stage has to look beyond the hot columns for this object.
    fn is_special(&self) -> bool {
        let plain = Self { importance: self.importance, hidden: self.hidden, ..Self::default() };
        *self != plain
    }
}

/// One object, as it enters and leaves the store.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Object {
    /// The caller's unique name for it.
    pub id: ObjectId,
    /// Where it is, in coordinates relative to [`Objects::origin`].
    pub bounds: Sphere,
    /// Its LOD table.
    pub table: TableId,
    /// What it asks of the selection.
    pub settings: Settings,
}

impl Object {
    /// An object with default settings.
    pub fn new(id: u64, bounds: Sphere, table: TableId) -> Self {
        Self { id: ObjectId(id), bounds, table, settings: Settings::default() }
    }
}

/// Objects per block.
pub const BLOCK: usize = 16;

/// Sixteen neighbouring slots, column by column: what every stage streams over. Empty slots have a live bit of 0
/// and arbitrary numbers.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Block {
    /// Centres.
    pub x: [f32; BLOCK],
    /// Centres.
    pub y: [f32; BLOCK],
    /// Centres.
    pub z: [f32; BLOCK],
    /// Radii.
    pub radius: [f32; BLOCK],
    /// Importance · bias².
    pub gain: [f32; BLOCK],
    /// [`TableId`]s.
    pub table: [u16; BLOCK],
    /// Bit per slot: occupied, not hidden, and its bound is finite.
    pub live: u16,
    /// Bit per slot: its settings say more than importance.
    pub special: u16,
    /// Bit per slot: its bias, cost multiplier or draw distance is not the default.
    pub adjusted: u16,
    /// Bit per slot: the selection may leave it out ([`Settings::may_be_left_out`]).
    pub skippable: u16,
}

impl Block {
    const EMPTY: Self = Self {
        x: [0.0; BLOCK],
        y: [0.0; BLOCK],
        z: [0.0; BLOCK],
        radius: [0.0; BLOCK],
        gain: [0.0; BLOCK],
        table: [0; BLOCK],
        live: 0,
        special: 0,
        adjusted: 0,
        skippable: 0,
    };

    /// The bound in one lane.
    #[inline(always)]
    pub fn sphere(&self, lane: usize) -> Sphere {
        Sphere::new(Vec3::new(self.x[lane], self.y[lane], self.z[lane]), self.radius[lane])
    }
}

/// All objects and their tables.
///
/// Objects live in *slots*: slot `s` is lane `s % 16` of block `s / 16`. Slots are an arrangement for speed; they
/// change when [`Objects::reorder`] or [`Objects::relocate`] is called. Ids do not. Removal leaves a hole, insertion
/// appends, or fills a hole where a quarter of the slots are holes, and a reorder closes the holes.
///
/// Every change raises [`Objects::revision`], so that whoever keeps something per slot can see what to renew.
#[derive(Clone, Debug, Default)]
pub struct Objects {
    origin: DVec3,
    tables: Vec<LodTable>,
    blocks: Vec<Block>,
    cold: Vec<Cold>,
    /// Per block, a bit per slot: it has a tenant.
    occupied: Vec<u16>,
    slots: HashMap<ObjectId, u32, BuildHasherDefault<IdHasher>>,
    appended: usize,
    /// The block where a hole was last looked for.
    cursor: usize,
    broken_bounds: usize,
    revision: u64,
    layout_revision: u64,
    tables_revision: u64,
    block_revisions: Vec<u64>,
    block_layout_revisions: Vec<u64>,
    /// Where objects wait while their slots are written anew; empty between calls.
    moving: Vec<Object>,
}

/// What is looked at only for special objects, and who lives in the slot; `None` in a hole.
#[derive(Clone, Copy, Debug)]
struct Cold {
    id: Option<ObjectId>,
    settings: Settings,
}

impl Objects {
    /// A store without tables or objects.
    pub fn new() -> Self {
        Self::default()
    }

    /// World position that all bounds are relative to.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Declares what world position all bounds are relative to, without touching them.
    pub fn set_origin(&mut self, origin: DVec3) {
        self.origin = origin;
    }

    /// Moves the origin and re-expresses every bound relative to it, so that everything stays where it is in the
    /// world. Decisions stay the same as far as the bounds do: exactly, where the shift is a multiple of a bound's
    /// last place. A bound that a shift makes too large for its numbers is broken from then on.
    pub fn shift_origin(&mut self, origin: DVec3) {
        let shift = self.origin - origin;
        self.origin = origin;
        self.revision += 1;
        self.broken_bounds = 0;
        for (block, cold) in self.blocks.iter_mut().zip(self.cold.chunks(BLOCK)) {
            let columns = [(&mut block.x, shift.x), (&mut block.y, shift.y), (&mut block.z, shift.z)];
            for (column, by) in columns {
                column.iter_mut().for_each(|c| *c = (f64::from(*c) + by) as f32);
            }
            self.broken_bounds += renew_live(block, cold);
        }
        self.block_revisions.fill(self.revision);
    }

    /// Adds a table.
    ///
    /// # Errors
    /// A 65 537th table is refused.
    pub fn add_table(&mut self, table: LodTable) -> Result<TableId, ObjectError> {
        let id = u16::try_from(self.tables.len());
        let id = id.map_err(|_| ObjectError { id: None, rule: "there can be at most 65536 tables" })?;
        self.tables.push(table);
        self.touch_tables();
        Ok(TableId(id))
    }

    /// Puts another table in the place of one, for all objects that have it: what its levels cost, how true they are, or
    /// both have changed, as those of a cut may with the camera ([`Cut::offer`](crate::hierarchy::Cut::offer)). Levels
    /// keep their numbers, so what is shown and remembered stays. Bounds of objects are not touched. The next frame
    /// prices all tables anew, in O(levels).
    ///
    /// # Errors
    /// An unknown table, and one of another number of levels: that is a new table, for [`Objects::set_table`].
    pub fn replace_table(&mut self, id: TableId, table: LodTable) -> Result<(), ObjectError> {
        let refused = |rule| ObjectError { id: None, rule };
        let old = self.tables.get_mut(usize::from(id.0)).ok_or(refused("the table to replace is unknown"))?;
        if old.levels().len() != table.levels().len() {
            return Err(refused("a table must have as many levels as the one that it replaces"));
        }
        *old = table;
        self.touch_tables();
        Ok(())
    }

    /// All tables, by [`TableId`].
    pub fn tables(&self) -> &[LodTable] {
        &self.tables
    }

    /// Adds an object. A bound that is not finite is accepted and the object not drawn until it gets a finite one.
    ///
    /// # Errors
    /// An id that is in use, an unknown table, or a setting out of its range.
    pub fn insert(&mut self, object: Object) -> Result<(), ObjectError> {
        self.check(&object)?;
        if self.slots.contains_key(&object.id) {
            return Err(ObjectError::of(object.id, "the id is in use"));
        }
        let slot = self.free_slot();
        self.appended += 1;
        self.write(slot, &object);
        self.touch_layout(slot);
        Ok(())
    }

    /// Takes an object out and returns it; `None` when there is none of that id.
    pub fn remove(&mut self, id: ObjectId) -> Option<Object> {
        let slot = self.slots.remove(&id)? as usize;
        let object = self.vacate(slot);
        self.touch_layout(slot);
        object
    }

    /// The object of that id.
    pub fn get(&self, id: ObjectId) -> Option<Object> {
        self.read(self.slot_of(id)?)
    }

    /// Moves an object. A bound that is not finite is accepted: the object is left out and counted until it gets a
    /// finite one.
    ///
    /// # Errors
    /// An unknown id.
    pub fn set_bounds(&mut self, id: ObjectId, bounds: Sphere) -> Result<(), ObjectError> {
        let slot = self.known_slot(id)?;
        let (block, lane) = (&mut self.blocks[slot / BLOCK], slot % BLOCK);
        self.broken_bounds -= usize::from(!block.sphere(lane).is_valid());
        self.broken_bounds += usize::from(!bounds.is_valid());
        write_bounds(block, lane, bounds);
        let live = bounds.is_valid() && !self.cold[slot].settings.hidden;
        set_bit(&mut block.live, lane, live);
        self.touch(slot);
        Ok(())
    }

    /// Gives an object another table.
    ///
    /// # Errors
    /// An unknown id or table.
    pub fn set_table(&mut self, id: ObjectId, table: TableId) -> Result<(), ObjectError> {
        let slot = self.known_slot(id)?;
        if usize::from(table.0) >= self.tables.len() {
            return Err(ObjectError::of(id, "its table is unknown"));
        }
        self.blocks[slot / BLOCK].table[slot % BLOCK] = table.0;
        self.write_settings(slot, self.cold[slot].settings);
        self.touch(slot);
        Ok(())
    }

    /// Changes what an object asks of the selection.
    ///
    /// # Errors
    /// An unknown id or a setting out of its range.
    pub fn set_settings(&mut self, id: ObjectId, settings: Settings) -> Result<(), ObjectError> {
        let slot = self.known_slot(id)?;
        if let Some(rule) = settings.broken_rule() {
            return Err(ObjectError::of(id, rule));
        }
        self.write_settings(slot, settings);
        self.touch(slot);
        Ok(())
    }

    /// How many objects there are.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there is no object.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// How many objects are left out because their bound is not finite.
    pub fn broken_bounds(&self) -> usize {
        self.broken_bounds
    }

    /// The slots, 16 to a block, holes included.
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Where an object lives at present.
    pub fn slot_of(&self, id: ObjectId) -> Option<usize> {
        self.slots.get(&id).map(|&slot| slot as usize)
    }

    /// Who lives in a slot at present.
    pub fn id_of(&self, slot: usize) -> Option<ObjectId> {
        self.cold.get(slot)?.id
    }

    /// The settings of the object in a slot; those of the last tenant in a hole.
    pub fn settings(&self, slot: usize) -> &Settings {
        &self.cold[slot].settings
    }

    /// Raised by every change.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The revision at which an object last came, went or changed its slot.
    pub fn layout_revision(&self) -> u64 {
        self.layout_revision
    }

    /// The revision at which a table last came or was replaced.
    pub fn tables_revision(&self) -> u64 {
        self.tables_revision
    }

    /// Per block, the revision at which it last changed.
    pub fn block_revisions(&self) -> &[u64] {
        &self.block_revisions
    }

    /// Per block, the revision at which an object last came into, went from or changed its slot in it.
    pub fn block_layout_revisions(&self) -> &[u64] {
        &self.block_layout_revisions
    }

    /// Per block, a bit per slot: an object lives in it.
    pub fn occupied(&self) -> &[u16] {
        &self.occupied
    }

    /// How many slots are out of order: holes, and objects that came after the last [`Objects::reorder`].
    pub fn disorder(&self) -> usize {
        self.holes() + self.appended
    }

    /// Re-arranges the slots: the object in slot `order[i]` moves to slot `i`. Holes are closed. Decisions do not
    /// depend on the order, only speed does. Takes 100 bytes per object while it works.
    ///
    /// # Panics
    /// `order` must name every occupied slot exactly once.
    pub fn reorder(&mut self, order: &[u32]) {
        assert_eq!(order.len(), self.len(), "an order names every occupied slot once");
        let mut objects = Vec::with_capacity(order.len());
        objects.extend(order.iter().filter_map(|&slot| self.vacate(slot as usize)));
        assert_eq!(objects.len(), order.len(), "an order names occupied slots, and none twice");
        self.truncate(0);
        self.revision += 1;
        self.layout_revision = self.revision;
        for (slot, object) in objects.into_iter().enumerate() {
            self.push_slot();
            self.write(slot, &object);
        }
        self.block_revisions.fill(self.revision);
        self.block_layout_revisions.fill(self.revision);
        self.appended = 0;
    }

    /// Moves the object in slot `from[i]` to slot `to[i]`, for all `i` at once; slots beyond the end are made, and
    /// holes at the end given up. Decisions do not depend on it. Allocates nothing for as many objects and slots as
    /// there were before.
    ///
    /// # Panics
    /// `from` must name occupied slots, `to` holes or slots in `from`, as many, and neither one twice.
    pub fn relocate(&mut self, from: &[u32], to: &[u32]) {
        assert_eq!(from.len(), to.len(), "every object goes to one slot");
        let mut objects = std::mem::take(&mut self.moving);
        for &slot in from {
            objects.extend(self.vacate(slot as usize));
            self.touch_layout(slot as usize);
        }
        assert_eq!(objects.len(), from.len(), "only occupied slots can be left, and only once");
        for (object, &slot) in objects.drain(..).zip(to) {
            while self.cold.len() <= slot as usize {
                self.push_slot();
            }
            assert!(self.id_of(slot as usize).is_none(), "slot {slot} is taken");
            self.write(slot as usize, &object);
            self.touch_layout(slot as usize);
        }
        self.moving = objects;
        let last = self.occupied.iter().rposition(|&lanes| lanes != 0);
        self.truncate(last.map_or(0, |block| (block + 1) * BLOCK));
    }

    fn check(&self, object: &Object) -> Result<(), ObjectError> {
        if usize::from(object.table.0) >= self.tables.len() {
            return Err(ObjectError::of(object.id, "its table is unknown"));
        }
        match object.settings.broken_rule() {
            Some(rule) => Err(ObjectError::of(object.id, rule)),
            None => Ok(()),
        }
    }

    fn known_slot(&self, id: ObjectId) -> Result<usize, ObjectError> {
        self.slot_of(id).ok_or(ObjectError::of(id, "the id is unknown"))
    }

    fn touch_tables(&mut self) {
        self.revision += 1;
        self.tables_revision = self.revision;
    }

    fn touch(&mut self, slot: usize) {
        self.revision += 1;
        self.block_revisions[slot / BLOCK] = self.revision;
    }

    fn touch_layout(&mut self, slot: usize) {
        self.touch(slot);
        self.layout_revision = self.revision;
        self.block_layout_revisions[slot / BLOCK] = self.revision;
    }

    fn holes(&self) -> usize {
        self.cold.len() - self.slots.len()
    }

    /// A hole where a quarter of the slots are holes, else one in the last block or a new slot at the end.
    fn free_slot(&mut self) -> usize {
        if self.holes() * 4 > self.cold.len() {
            self.cursor = self.next_loose_block();
        } else {
            self.cursor = self.blocks.len().saturating_sub(1);
        }
        let first = self.cursor * BLOCK;
        let lanes = BLOCK.min(self.cold.len() - first.min(self.cold.len()));
        let hole = (first..first + lanes).find(|&slot| self.cold[slot].id.is_none());
        hole.unwrap_or_else(|| self.push_slot())
    }

    /// The next block with a hole, from the cursor on and around. As many blocks are passed over in a round as there
    /// are, and a quarter of the slots filled.
    fn next_loose_block(&self) -> usize {
        let blocks = self.occupied.len();
        let from = self.cursor.min(blocks);
        let loose = |&block: &usize| self.occupied[block] != u16::MAX;
        (from..blocks).chain(0..from).find(loose).unwrap_or(blocks.saturating_sub(1))
    }

    fn push_slot(&mut self) -> usize {
        if self.cold.len().is_multiple_of(BLOCK) {
            self.blocks.push(Block::EMPTY);
            self.occupied.push(0);
            self.block_revisions.push(self.revision);
            self.block_layout_revisions.push(self.revision);
        }
        self.cold.push(Cold { id: None, settings: Settings::default() });
        self.cold.len() - 1
    }

    /// Gives up the slots from `slots` on.
    fn truncate(&mut self, slots: usize) {
        let blocks = slots.div_ceil(BLOCK);
        self.cold.truncate(slots);
        self.blocks.truncate(blocks);
        self.occupied.truncate(blocks);
        self.block_revisions.truncate(blocks);
        self.block_layout_revisions.truncate(blocks);
    }

    /// Makes a hole of a slot; its tenant, if there was one.
    fn vacate(&mut self, slot: usize) -> Option<Object> {
        let object = self.read(slot)?;
        self.broken_bounds -= usize::from(!object.bounds.is_valid());
        self.cold[slot].id = None;
        set_bit(&mut self.occupied[slot / BLOCK], slot % BLOCK, false);
        set_bit(&mut self.blocks[slot / BLOCK].live, slot % BLOCK, false);
        Some(object)
    }

    fn read(&self, slot: usize) -> Option<Object> {
        let &Cold { id, settings } = self.cold.get(slot)?;
        let (block, lane) = (&self.blocks[slot / BLOCK], slot % BLOCK);
        Some(Object { id: id?, bounds: block.sphere(lane), table: TableId(block.table[lane]), settings })
    }

    fn write(&mut self, slot: usize, object: &Object) {
        self.broken_bounds += usize::from(!object.bounds.is_valid());
        let (block, lane) = (&mut self.blocks[slot / BLOCK], slot % BLOCK);
        write_bounds(block, lane, object.bounds);
        block.table[lane] = object.table.0;
        self.cold[slot].id = Some(object.id);
        self.slots.insert(object.id, slot as u32);
        set_bit(&mut self.occupied[slot / BLOCK], lane, true);
        self.write_settings(slot, object.settings);
    }

    fn write_settings(&mut self, slot: usize, settings: Settings) {
        self.cold[slot].settings = settings;
        let (block, lane) = (&mut self.blocks[slot / BLOCK], slot % BLOCK);
        block.gain[lane] = settings.importance * (settings.bias * settings.bias);
        let levels = self.tables[usize::from(block.table[lane])].levels().len();
        set_bit(&mut block.special, lane, settings.is_special());
        set_bit(&mut block.adjusted, lane, settings.is_adjusted());
        set_bit(&mut block.skippable, lane, settings.may_be_left_out(levels));
        let live = !settings.hidden && block.sphere(lane).is_valid();
        set_bit(&mut block.live, lane, live);
    }
}

/// Finds out anew which lanes are live, and returns how many of the tenants' bounds are broken.
fn renew_live(block: &mut Block, cold: &[Cold]) -> usize {
    let mut broken = 0;
    for (lane, Cold { id, settings }) in cold.iter().enumerate() {
        let valid = block.sphere(lane).is_valid();
        broken += usize::from(id.is_some() && !valid);
        set_bit(&mut block.live, lane, id.is_some() && valid && !settings.hidden);
    }
    broken
}

fn write_bounds(block: &mut Block, lane: usize, bounds: Sphere) {
    block.x[lane] = bounds.center.x;
    block.y[lane] = bounds.center.y;
    block.z[lane] = bounds.center.z;
    block.radius[lane] = bounds.radius;
}

fn set_bit(mask: &mut u16, lane: usize, on: bool) {
    *mask = *mask & !(1 << lane) | u16::from(on) << lane;
}

/// The positions of the bits of `mask`, ascending.
pub(crate) fn lanes(mask: u16) -> impl Iterator<Item = usize> {
    let mut rest = mask;
    std::iter::from_fn(move || {
        let lane = rest.trailing_zeros() as usize;
        (rest != 0).then(|| {
            rest &= rest - 1;
            lane
        })
    })
}

/// Why an object was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObjectError {
    /// The object, if it is one object's fault.
    pub id: Option<ObjectId>,
    /// The rule it breaks.
    pub rule: &'static str,
}

impl ObjectError {
    fn of(id: ObjectId, rule: &'static str) -> Self {
        Self { id: Some(id), rule }
    }
}

impl fmt::Display for ObjectError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.id {
            Some(ObjectId(id)) => write!(f, "object {id}: {}", self.rule),
            None => write!(f, "objects: {}", self.rule),
        }
    }
}

impl std::error::Error for ObjectError {}

/// Spreads ids by one multiplication; ids are often consecutive. Not proof against an adversary who picks ids.
#[derive(Clone, Copy, Debug, Default)]
struct IdHasher(u64);

impl Hasher for IdHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&b| self.write_u64(self.0.rotate_left(8) ^ u64::from(b)));
    }

    fn write_u64(&mut self, id: u64) {
        let wide = u128::from(id ^ 0x9e37_79b9_7f4a_7c15) * 0xd134_2543_de82_ef95;
        self.0 = (wide >> 64) as u64 ^ wide as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::LevelRecord;

    fn store(objects: u64) -> Objects {
        let mut store = Objects::new();
        let levels = vec![LevelRecord::new(100, 60), LevelRecord::new(10, 8)];
        let table = LodTable::new("box", Sphere::new(Vec3::ZERO, 1.0), levels).expect("a good table");
        let table = store.add_table(table).expect("room");
        for id in 0..objects {
            store.insert(Object::new(id, ball(id as f32), table)).expect("a new id");
        }
        store
    }

    fn ball(x: f32) -> Sphere {
        Sphere::new(Vec3::new(x, 0.0, 0.0), 1.0)
    }

    #[test]
    fn ids_survive_removal_and_reorder() {
        let mut store = store(40);
        assert_eq!(store.remove(ObjectId(7)).map(|o| o.id), Some(ObjectId(7)));
        assert_eq!(store.remove(ObjectId(7)), None);
        let order: Vec<u32> = (0..40).rev().filter(|&s| s != 7).collect();
        store.reorder(&order);
        assert_eq!((store.len(), store.disorder()), (39, 0));
        assert_eq!(store.id_of(0), Some(ObjectId(39)));
        assert!(store.slots.iter().all(|(&id, &slot)| store.id_of(slot as usize) == Some(id)));
        assert_eq!(store.get(ObjectId(12)).map(|o| o.bounds), Some(ball(12.0)));
    }

    #[test]
    fn a_bound_that_is_not_finite_is_left_out_and_counted() {
        let mut store = store(3);
        store.set_bounds(ObjectId(1), ball(f32::NAN)).expect("a known id");
        assert_eq!((store.broken_bounds(), store.blocks()[0].live), (1, 0b101));
        store.set_bounds(ObjectId(1), ball(1.0)).expect("a known id");
        assert_eq!((store.broken_bounds(), store.blocks()[0].live), (0, 0b111));
    }

    #[test]
    fn errors_name_the_object_and_the_rule() {
        let mut store = store(1);
        let table = TableId(0);
        let twice = store.insert(Object::new(0, ball(0.0), table)).expect_err("taken");
        assert_eq!(twice.to_string(), "object 0: the id is in use");
        let lost = store.insert(Object::new(5, ball(0.0), TableId(9))).expect_err("no table");
        assert_eq!(lost.to_string(), "object 5: its table is unknown");
        let settings = Settings { bias: 0.0, ..Settings::default() };
        let flat = store.set_settings(ObjectId(0), settings).expect_err("no size");
        assert_eq!(flat.to_string(), "object 0: bias must be finite and positive");
        let settings = Settings { importance: 0.0, bias: 1e30, ..Settings::default() };
        let vast = store.set_settings(ObjectId(0), settings).expect_err("no benefit");
        assert_eq!(vast.to_string(), "object 0: importance times bias squared must be at most 1e12");
    }

    #[test]
    fn resident_goes_before_forced_and_forced_before_clamp() {
        let clamped = Settings { clamp: LevelRange::new(1, 2), ..Settings::default() };
        assert_eq!(clamped.allowed(5), LevelRange::new(1, 2));
        assert_eq!(clamped.allowed(1), LevelRange::new(0, 0));
        let forced = Settings { forced: Some(Level(4)), ..clamped };
        assert_eq!(forced.allowed(5), LevelRange::new(4, 4));
        let streamed = Settings { resident: LevelRange::new(3, 3), ..forced };
        assert_eq!(streamed.allowed(5), LevelRange::new(3, 3));
    }

    #[test]
    fn a_shift_that_overflows_a_bound_breaks_it() {
        let mut store = store(3);
        let hidden = Settings { hidden: true, ..Settings::default() };
        store.set_settings(ObjectId(1), hidden).expect("a known id");
        store.shift_origin(DVec3::X * 1e300);
        assert_eq!((store.blocks()[0].live, store.broken_bounds()), (0, 3));
        for id in 0..3 {
            store.set_bounds(ObjectId(id), ball(0.0)).expect("a known id");
        }
        assert_eq!((store.blocks()[0].live, store.broken_bounds()), (0b101, 0));
    }

    #[test]
    fn shifting_the_origin_keeps_everything_in_place() {
        let mut store = store(20);
        store.shift_origin(DVec3::new(-4096.0, 8.0, 0.0));
        assert_eq!(store.get(ObjectId(3)).map(|o| o.bounds.center), Some(Vec3::new(4099.0, -8.0, 0.0)));
    }
}
