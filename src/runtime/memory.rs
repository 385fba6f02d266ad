//! What is remembered of earlier frames, per view group and slot: sixteen slots to a block, as the objects are.

use crate::frame::{Account, Cause, Change, GroupId, Memory, NEWCOMER, NO_PLACE, Remembered, Row};
use crate::kernel::{Divisible, Kernel, run_on};
use crate::rate::TableRates;
use crate::scene::{BLOCK, ObjectId, Objects, lanes};
use crate::table::Level;
use crate::transition::Shown;

/// What is remembered of the objects of a block and read in every frame.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct BlockMemory {
    /// See [`Candidates::place`](crate::frame::Candidates::place).
    place: [u32; BLOCK],
    /// The level that the policy wants.
    wanted: [Level; BLOCK],
    /// The last of the group's frames in which some of the block was in view.
    frame: u32,
    /// Bit per lane: it was in view in that frame. Memory ends when an object leaves.
    seen: u16,
    /// Bit per lane: something else is shown than the level that is wanted. See [`GroupMemory::unsteady`].
    unsteady: u16,
    /// Bit per lane: the place is not that of the level that is wanted. Not set while a frame is under way.
    deferred: u16,
}

impl BlockMemory {
    const EMPTY: Self = Self {
        place: [NO_PLACE; BLOCK],
        wanted: [Level::NOT_DRAWN; BLOCK],
        frame: 0,
        seen: 0,
        unsteady: 0,
        deferred: 0,
    };
}

/// The accounts of the objects of a block.
#[derive(Clone, Copy, Debug)]
struct BlockAccounts {
    /// Drops are those of the time when the level that is wanted came to be wanted.
    account: [Account; BLOCK],
    /// Bit per lane: it was owed something in this one of the group's frames, and in the one before.
    owing: u16,
    owing_before: u16,
    frame: u32,
}

impl BlockAccounts {
    const EMPTY: Self = Self { account: [Account::NEW; BLOCK], owing: 0, owing_before: 0, frame: 0 };

    /// What was owed at the end of a frame, the last one or the one before, and the drops.
    fn get(&self, lane: usize, frame: u32) -> Account {
        let owing = match self.frame.wrapping_sub(frame) {
            0 => self.owing,
            1 => self.owing_before,
            _ => 0,
        };
        let is_owed = owing & (1 << lane) != 0;
        Account { owed_ms: if is_owed { self.account[lane].owed_ms } else { 0 }, ..self.account[lane] }
    }

    fn set(&mut self, lane: usize, frame: u32, account: Account) {
        if self.frame != frame {
            self.owing_before = if self.frame + 1 == frame { self.owing } else { 0 };
            (self.frame, self.owing) = (frame, 0);
        }
        self.account[lane] = account;
        self.owing &= !(1 << lane);
        self.owing |= u16::from(account.owed_ms > 0) << lane;
    }
}

/// What is shown in a slot where it is not simply the level that is wanted.
#[derive(Clone, Copy, Debug)]
struct Unsteady {
    slot: u32,
    shown: Shown,
}

/// The memory of one view group.
#[derive(Clone, Debug)]
pub(super) struct GroupMemory {
    pub id: GroupId,
    /// The group's own count of frames. The first is 2, so that no slot seems to have been seen in the one before.
    frame: u32,
    clock_ms: f64,
    /// Whole milliseconds since the frame before.
    elapsed_ms: u16,
    blocks: Vec<BlockMemory>,
    /// Per slot, since when the level is wanted, by the group's clock in whole milliseconds, which wraps after seven
    /// weeks.
    since_ms: Vec<[u32; BLOCK]>,
    /// How many of what was in view are at each place.
    census: Vec<u32>,
    /// The objects' revision that the places hold for, and whether objects counted once then.
    placed: (u64, bool),
    /// Of every block, where the policy has use for them; else none.
    accounts: Vec<BlockAccounts>,
    /// Slots with an unsteady bit, ascending; those of this frame's end are in `fresh`.
    unsteady: Vec<Unsteady>,
    fresh: Vec<Unsteady>,
    /// What is in view in this frame, and what was in the one before.
    rows: Vec<Row>,
    before: Vec<Row>,
    /// How many objects in view were in view in the frame before.
    stayed: u32,
    /// Where states wait while they are carried to other slots; empty between frames.
    moving: Vec<(ObjectId, Moved)>,
}

/// The memory of all groups, in the order of their ids.
#[derive(Clone, Debug, Default)]
pub(super) struct Groups(Vec<GroupMemory>);

impl Groups {
    /// The memory of a group, made when first asked for.
    pub fn of(&mut self, id: GroupId) -> &mut GroupMemory {
        let at = self.0.binary_search_by_key(&id, |g| g.id).unwrap_or_else(|at| {
            self.0.insert(at, GroupMemory::new(id));
            at
        });
        &mut self.0[at]
    }

    /// The memory of a group that has had a frame.
    pub fn get(&self, id: GroupId) -> Option<&GroupMemory> {
        self.0.binary_search_by_key(&id, |g| g.id).ok().map(|at| &self.0[at])
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

impl Memory for Groups {
    fn recall(&self, group: GroupId, slot: u32) -> Remembered {
        let of =
            |memory: &GroupMemory| Remembered { age_ms: memory.age_ms(slot), account: memory.account(slot) };
        self.get(group).map_or(Remembered::default(), of)
    }
}

/// What places are looked up in.
#[derive(Clone, Copy)]
pub(super) struct Places<'a> {
    pub objects: &'a Objects,
    pub rates: &'a TableRates,
    /// Whether the group has one view, so that every object counts once.
    pub once: bool,
}

impl Places<'_> {
    /// The place of a level of the object in `slot`.
    pub fn of(&self, slot: usize, level: Level) -> u32 {
        let (block, lane) = (&self.objects.blocks()[slot / BLOCK], slot % BLOCK);
        let plain = self.once && block.special & (1 << lane) == 0;
        if plain && level.is_drawn() { self.rates.index(block.table[lane], level) as u32 } else { NO_PLACE }
    }
}

impl GroupMemory {
    fn new(id: GroupId) -> Self {
        Self {
            id,
            frame: 1,
            clock_ms: 0.0,
            elapsed_ms: 0,
            blocks: Vec::new(),
            since_ms: Vec::new(),
            census: Vec::new(),
            placed: (0, true),
            accounts: Vec::new(),
            unsteady: Vec::new(),
            fresh: Vec::new(),
            rows: Vec::new(),
            before: Vec::new(),
            stayed: 0,
            moving: Vec::new(),
        }
    }

    /// Starts a frame at `clock_ms`; returns the time since the group's last one.
    pub fn begin_frame(&mut self, places: Places<'_>, clock_ms: f64) -> f64 {
        let blocks = places.objects.blocks().len();
        self.blocks.resize(blocks, BlockMemory::EMPTY);
        self.since_ms.resize(blocks, [0; BLOCK]);
        self.census.resize(places.rates.len(), 0);
        self.frame += 1;
        self.stayed = 0;
        std::mem::swap(&mut self.rows, &mut self.before);
        self.rows.clear();
        let elapsed_ms = whole_ms(clock_ms).wrapping_sub(whole_ms(self.clock_ms));
        self.elapsed_ms = elapsed_ms.min(u32::from(u16::MAX)) as u16;
        clock_ms - std::mem::replace(&mut self.clock_ms, clock_ms)
    }

    /// Keeps accounts of every block from now on.
    pub fn keep_accounts(&mut self) {
        self.accounts.resize(self.blocks.len(), BlockAccounts::EMPTY);
    }

    /// Notes that the candidates of `rows` are in view, and recalls what was wanted of them. The rows learn which of
    /// their objects were in view in the last frame as well. Lists what has left the view.
    pub fn recall(
        &mut self,
        rows: &mut [Row],
        places: Places<'_>,
        recalled: Recalled<'_>,
        threads: usize,
        changes: &mut Vec<Change>,
    ) {
        self.renew(rows, places);
        let (frame, blocks) = (self.frame, &mut self.blocks[..]);
        self.stayed =
            run_on(threads, Recalling { rows: &mut *rows, frame, blocks, first_block: 0, recalled });
        self.rows.extend_from_slice(rows);
        if self.stayed != self.before.iter().map(|row| row.mask.count_ones()).sum::<u32>() {
            self.dismiss_leavers(places.objects, changes);
        }
    }

    /// How many objects in view, now and in the frame before, are at each place.
    pub fn census(&self) -> &[u32] {
        &self.census
    }

    /// Looks up places anew where objects have changed, and cuts what is wanted to tables that may be others by now.
    fn renew(&mut self, rows: &[Row], places: Places<'_>) {
        let now = (places.objects.revision(), places.once);
        let (since, once) = std::mem::replace(&mut self.placed, now);
        if (since, once) == now {
            return;
        }
        for row in rows {
            let is_new = places.objects.block_revisions()[row.block as usize] > since || once != places.once;
            let memory = &self.blocks[row.block as usize];
            let is_known = memory.frame + 1 == self.frame;
            if is_new && is_known {
                slots_of(row.block, memory.seen & row.mask).for_each(|slot| self.renew_slot(slot, places));
            }
        }
    }

    fn renew_slot(&mut self, slot: u32, places: Places<'_>) {
        let (block, lane) = (slot as usize / BLOCK, slot as usize % BLOCK);
        let wanted = self.blocks[block].wanted[lane];
        let coarsest = places.rates.coarsest(places.objects.blocks()[block].table[lane]);
        let cut = if wanted.is_drawn() { wanted.min(coarsest) } else { wanted };
        if cut != wanted {
            self.keep_showing(slot, Shown::steady(wanted));
        }
        self.set(slot, cut, places.of(slot as usize, cut));
    }

    /// Notes what is wanted in a slot that is in view.
    fn set(&mut self, slot: u32, wanted: Level, place: u32) {
        let (memory, lane) = (&mut self.blocks[slot as usize / BLOCK], slot as usize % BLOCK);
        count(&mut self.census, memory.place[lane], -1);
        count(&mut self.census, place, 1);
        memory.wanted[lane] = wanted;
        memory.place[lane] = place;
        memory.deferred &= !(1 << lane);
    }

    /// Notes that another level has been chosen for a slot than is wanted, the one at `place`.
    pub fn defer(&mut self, slot: u32, place: u32) {
        let (memory, lane) = (&mut self.blocks[slot as usize / BLOCK], slot as usize % BLOCK);
        memory.deferred |= 1 << lane;
        if memory.place[lane] != place {
            count(&mut self.census, memory.place[lane], -1);
            count(&mut self.census, place, 1);
            memory.place[lane] = place;
        }
    }

    /// Whether another level has been chosen for a slot than is wanted.
    pub fn is_deferred(&self, slot: u32) -> bool {
        self.blocks[slot as usize / BLOCK].deferred & (1 << (slot as usize % BLOCK)) != 0
    }

    /// Notes that what is wanted in a slot is what has been chosen, and is at `place`.
    pub fn conclude(&mut self, slot: u32, place: u32) {
        self.defer(slot, place);
        self.blocks[slot as usize / BLOCK].deferred &= !(1 << (slot as usize % BLOCK));
    }

    /// Goes on showing what is shown where something else is wanted of a sudden.
    fn keep_showing(&mut self, slot: u32, shown: Shown) {
        let (memory, bit) = (&mut self.blocks[slot as usize / BLOCK], 1 << (slot as usize % BLOCK));
        if memory.unsteady & bit == 0 {
            let at = self.unsteady.partition_point(|u| u.slot < slot);
            self.unsteady.insert(at, Unsteady { slot, shown });
            memory.unsteady |= bit;
        }
    }

    /// How long what is wanted in a slot in view has been wanted.
    pub fn age_ms(&self, slot: u32) -> u32 {
        let since_ms = self.since_ms[slot as usize / BLOCK][slot as usize % BLOCK];
        whole_ms(self.clock_ms).wrapping_sub(since_ms)
    }

    /// What the policy owes to a slot that was in view in the last frame too.
    pub fn account(&self, slot: u32) -> Account {
        let Some(accounts) = self.accounts.get(slot as usize / BLOCK) else { return Account::default() };
        accounts.get(slot as usize % BLOCK, self.frame - 1).after(self.elapsed_ms, self.age_ms(slot))
    }

    /// What is shown in a slot that is in view.
    pub fn shown_at(&self, slot: u32) -> Shown {
        let (memory, lane) = (&self.blocks[slot as usize / BLOCK], slot as usize % BLOCK);
        let unsteady = match memory.unsteady & (1 << lane) {
            0 => None,
            _ => self.unsteady.binary_search_by_key(&slot, |u| u.slot).ok(),
        };
        unsteady.map_or(Shown::steady(memory.wanted[lane]), |at| self.unsteady[at].shown)
    }

    /// What is shown in a slot; `None` when it was not in view in the group's last frame.
    pub fn visible(&self, slot: usize) -> Option<Shown> {
        let memory = self.blocks.get(slot / BLOCK).filter(|m| m.frame == self.frame)?;
        (memory.seen & (1 << (slot % BLOCK)) != 0).then(|| self.shown_at(slot as u32))
    }

    /// Everything that was in view in the group's last frame, slots ascending.
    pub fn shown(&self) -> impl Iterator<Item = (usize, Shown)> + '_ {
        let slots = self.rows.iter().flat_map(|row| slots_of(row.block, row.mask));
        slots.map(|slot| (slot as usize, self.shown_at(slot)))
    }

    /// The slots that are in view, were in view before, and do not simply show what was wanted; what they show.
    pub fn unsteady(&mut self) -> impl Iterator<Item = (u32, &mut Shown)> {
        let (blocks, frame) = (&self.blocks, self.frame);
        let stays = move |u: &&mut Unsteady| {
            let memory = &blocks[u.slot as usize / BLOCK];
            memory.frame == frame && memory.seen & memory.unsteady & (1 << (u.slot as usize % BLOCK)) != 0
        };
        self.unsteady.iter_mut().filter(stays).map(|u| (u.slot, &mut u.shown))
    }

    /// An object has come into view: it is shown as wanted at once.
    pub fn enter(&mut self, slot: u32, wanted: Level, place: u32) {
        // Coming into view is no switch: the level counts as one that is long wanted.
        let (block, lane) = (slot as usize / BLOCK, slot as usize % BLOCK);
        self.since_ms[block][lane] = whole_ms(self.clock_ms).wrapping_sub(LONG_AGO_MS);
        self.blocks[block].place[lane] = NO_PLACE;
        self.blocks[block].unsteady &= !(1 << lane);
        self.set(slot, wanted, place);
        if let Some(accounts) = self.accounts.get_mut(block) {
            accounts.set(lane, self.frame, Account::default());
        }
    }

    /// Notes that something else is wanted than before.
    pub fn want(&mut self, slot: u32, wanted: Level, place: u32) {
        let (block, lane) = (slot as usize / BLOCK, slot as usize % BLOCK);
        let age_ms = self.age_ms(slot);
        if let Some(accounts) = self.accounts.get_mut(block) {
            let from = self.blocks[block].wanted[lane];
            let put_in = if wanted < from { Account::REFINEMENT_DROPS } else { 0 };
            let drops = accounts.account[lane].after(0, age_ms).drops.saturating_add(put_in);
            accounts.set(lane, self.frame, Account { owed_ms: 0, drops, from });
        }
        self.since_ms[block][lane] = whole_ms(self.clock_ms);
        self.set(slot, wanted, place);
    }

    /// Notes that a finer level of a slot is held back.
    pub fn owe(&mut self, slot: u32) {
        let owed_ms = self.account(slot).owed_ms.max(1);
        if let Some(accounts) = self.accounts.get_mut(slot as usize / BLOCK) {
            let lane = slot as usize % BLOCK;
            accounts.set(lane, self.frame, Account { owed_ms, ..accounts.account[lane] });
        }
    }

    /// Notes what is shown in a slot in view; once per slot and frame. Reading it may yield what was shown before until
    /// the end of the frame.
    pub fn show(&mut self, slot: u32, shown: Shown) {
        let (memory, lane) = (&mut self.blocks[slot as usize / BLOCK], slot as usize % BLOCK);
        let was_unsteady = memory.unsteady & (1 << lane) != 0;
        if shown == Shown::steady(memory.wanted[lane]) {
            memory.unsteady &= !(1 << lane);
        } else if was_unsteady {
            let at = self.unsteady.binary_search_by_key(&slot, |u| u.slot);
            at.into_iter().for_each(|at| self.unsteady[at].shown = shown);
        } else {
            self.fresh.push(Unsteady { slot, shown });
        }
    }

    /// Forgets what is no longer unsteady.
    pub fn end_frame(&mut self) {
        let (blocks, frame) = (&mut self.blocks, self.frame);
        self.unsteady.retain(|u| {
            let (memory, bit) = (&mut blocks[u.slot as usize / BLOCK], 1 << (u.slot as usize % BLOCK));
            let in_view = memory.frame == frame && memory.seen & bit != 0;
            memory.unsteady &= if in_view { u16::MAX } else { !bit };
            memory.unsteady & bit != 0
        });
        for fresh in &self.fresh {
            blocks[fresh.slot as usize / BLOCK].unsteady |= 1 << (fresh.slot as usize % BLOCK);
        }
        if !self.fresh.is_empty() {
            self.unsteady.append(&mut self.fresh);
            self.unsteady.sort_unstable_by_key(|u| u.slot);
        }
    }

    /// Forgets what has left the view since the group's last frame, and lists it.
    fn dismiss_leavers(&mut self, objects: &Objects, changes: &mut Vec<Change>) {
        for at in 0..self.before.len() {
            let row = self.before[at];
            let memory = &self.blocks[row.block as usize];
            let stayed = if memory.frame == self.frame { memory.seen } else { 0 };
            for slot in slots_of(row.block, row.mask & !stayed) {
                let place = self.blocks[row.block as usize].place[slot as usize % BLOCK];
                count(&mut self.census, place, -1);
                if let Some(object) = objects.id_of(slot as usize) {
                    self.leave(object, self.shown_at(slot).level, changes);
                }
            }
        }
    }

    fn leave(&self, object: ObjectId, old: Level, changes: &mut Vec<Change>) {
        if old.is_drawn() {
            let (group, new, cause) = (self.id, Level::NOT_DRAWN, Cause::OutOfView);
            changes.push(Change { group, object, old, new, cause });
        }
    }

    /// Carries what is remembered to the slots that objects live in now. `tenants` are those of before; blocks that
    /// have not changed since `revision` are passed over.
    fn follow(
        &mut self,
        objects: &Objects,
        tenants: &[Option<ObjectId>],
        revision: u64,
        changes: &mut Vec<Change>,
    ) {
        self.take_moved(objects, tenants, revision);
        self.blocks.resize(objects.blocks().len(), BlockMemory::EMPTY);
        self.since_ms.resize(objects.blocks().len(), [0; BLOCK]);
        if !self.accounts.is_empty() {
            self.keep_accounts();
        }
        while let Some((id, state)) = self.moving.pop() {
            match objects.slot_of(id) {
                Some(slot) => self.put(slot, state),
                None => self.leave(id, state.shown.level, changes),
            }
        }
        self.rows.sort_unstable_by_key(|row| row.block);
        self.rows.dedup_by_key(|row| row.block);
        let (blocks, frame) = (&self.blocks, self.frame);
        self.rows.retain_mut(|row| {
            // A row stays though nothing of it is left: its block goes on counting as one that has a row.
            let memory = blocks.get(row.block as usize).filter(|m| m.frame == frame);
            row.mask = memory.map_or(0, |m| m.seen);
            memory.is_some()
        });
        self.unsteady.append(&mut self.fresh);
        self.unsteady.sort_unstable_by_key(|u| u.slot);
    }

    /// Forgets the objects in view whose slots have new tenants, and puts aside what was remembered of them.
    fn take_moved(&mut self, objects: &Objects, tenants: &[Option<ObjectId>], revision: u64) {
        let changed =
            |block: u32| objects.block_layout_revisions().get(block as usize).is_none_or(|&r| r > revision);
        for at in (0..self.rows.len()).filter(|&at| changed(self.rows[at].block)) {
            let row = self.rows[at];
            for slot in slots_of(row.block, row.mask) {
                let Some(id) = tenants[slot as usize].filter(|&id| objects.id_of(slot as usize) != Some(id))
                else {
                    continue;
                };
                let shown = self.shown_at(slot);
                let (memory, lane) = (&mut self.blocks[row.block as usize], slot as usize % BLOCK);
                let accounts = self.accounts.get(row.block as usize);
                let account = accounts.map(|accounts| accounts.get(lane, self.frame)).unwrap_or_default();
                let (wanted, since_ms) = (memory.wanted[lane], self.since_ms[row.block as usize][lane]);
                count(&mut self.census, memory.place[lane], -1);
                self.moving.push((id, Moved { wanted, since_ms, shown, account }));
                memory.seen &= !(1 << lane);
                memory.unsteady &= !(1 << lane);
            }
        }
        let blocks = &self.blocks;
        self.unsteady
            .retain(|u| blocks[u.slot as usize / BLOCK].unsteady & (1 << (u.slot as usize % BLOCK)) != 0);
    }

    /// Remembers an object in its new slot.
    fn put(&mut self, slot: usize, state: Moved) {
        let (memory, lane) = (&mut self.blocks[slot / BLOCK], slot % BLOCK);
        if memory.frame != self.frame {
            (memory.frame, memory.seen) = (self.frame, 0);
            self.rows.push(Row { block: (slot / BLOCK) as u32, mask: 0, known: 0, deferred: 0, first: 0 });
        }
        memory.seen |= 1 << lane;
        memory.wanted[lane] = state.wanted;
        memory.place[lane] = NO_PLACE;
        memory.deferred &= !(1 << lane);
        self.since_ms[slot / BLOCK][lane] = state.since_ms;
        if let Some(accounts) = self.accounts.get_mut(slot / BLOCK) {
            accounts.set(lane, self.frame, state.account);
        }
        if state.shown != Shown::steady(state.wanted) {
            memory.unsteady |= 1 << lane;
            self.fresh.push(Unsteady { slot: slot as u32, shown: state.shown });
        }
    }
}

/// What is remembered of an object on its way to another slot.
#[derive(Clone, Copy, Debug)]
struct Moved {
    wanted: Level,
    since_ms: u32,
    shown: Shown,
    account: Account,
}

/// Where what is recalled of candidates goes: columns of theirs.
pub(super) struct Recalled<'a> {
    pub held: &'a mut [Level],
    pub place: &'a mut [u32],
    pub levels: &'a mut [Level],
}

/// Rows whose candidates are to be recalled.
struct Recalling<'a> {
    rows: &'a mut [Row],
    frame: u32,
    /// Those of the rows, and maybe others, from `first_block` on.
    blocks: &'a mut [BlockMemory],
    first_block: usize,
    recalled: Recalled<'a>,
}

impl Kernel for Recalling<'_> {
    /// How many are in view that were in view before.
    type Sum = u32;

    #[inline(always)]
    fn run(self) -> u32 {
        let Recalled { held, place, levels } = self.recalled;
        let start = self.rows.first().map_or(0, |row| row.first) as usize;
        let mut stayed = 0;
        for row in self.rows {
            let memory = &mut self.blocks[row.block as usize - self.first_block];
            row.known = if memory.frame + 1 == self.frame { memory.seen & row.mask } else { 0 };
            row.deferred = memory.deferred & row.known;
            memory.deferred = 0;
            (memory.frame, memory.seen) = (self.frame, row.mask);
            stayed += row.known.count_ones();
            let at = row.first as usize - start;
            if row.known == u16::MAX {
                place[at..at + BLOCK].copy_from_slice(&memory.place);
                levels[at..at + BLOCK].copy_from_slice(&memory.wanted);
                held[at..at + BLOCK].copy_from_slice(&memory.wanted);
            } else {
                for (at, lane) in (at..).zip(lanes(row.mask)) {
                    let known = row.known & (1 << lane) != 0;
                    place[at] = if known { memory.place[lane] } else { NO_PLACE };
                    levels[at] = if known { memory.wanted[lane] } else { Level::NOT_DRAWN };
                    held[at] = if known { memory.wanted[lane] } else { NEWCOMER };
                }
            }
        }
        stayed
    }
}

impl Divisible for Recalling<'_> {
    fn len(&self) -> usize {
        self.recalled.place.len()
    }

    fn halves(self) -> [Self; 2] {
        let Self { rows, frame, blocks, first_block, recalled: Recalled { held, place, levels } } = self;
        let start = rows.first().map_or(0, |row| row.first);
        let (rows, other_rows) = rows.split_at_mut(rows.len() / 2);
        let (at, block) = other_rows
            .first()
            .map_or((0, first_block), |row| ((row.first - start) as usize, row.block as usize));
        let (blocks, other_blocks) = blocks.split_at_mut(block - first_block);
        let (held, place, levels) = (held.split_at_mut(at), place.split_at_mut(at), levels.split_at_mut(at));
        let recalled = Recalled { held: held.0, place: place.0, levels: levels.0 };
        let other = Recalled { held: held.1, place: place.1, levels: levels.1 };
        [
            Self { rows, frame, blocks, first_block, recalled },
            Self { rows: other_rows, frame, blocks: other_blocks, first_block: block, recalled: other },
        ]
    }

    fn join([a, b]: [u32; 2]) -> u32 {
        a + b
    }
}

/// Counts one more, or one less, at a place.
fn count(census: &mut [u32], place: u32, by: i32) {
    if let Some(count) = census.get_mut(place as usize) {
        *count = count.wrapping_add_signed(by);
    }
}

fn slots_of(block: u32, mask: u16) -> impl Iterator<Item = u32> {
    lanes(mask).map(move |lane| block * BLOCK as u32 + lane as u32)
}

/// Longer than any dwell: 12 days.
const LONG_AGO_MS: u32 = 1 << 30;

fn whole_ms(clock_ms: f64) -> u32 {
    clock_ms as u64 as u32
}

/// Which object lived in which slot when the groups' memory was last brought up to date.
#[derive(Clone, Debug, Default)]
pub(super) struct Layout {
    revision: Option<u64>,
    tenants: Vec<Option<ObjectId>>,
}

impl Layout {
    /// Carries every group's memory along when objects have come, gone or changed their slots. Lists those that have
    /// gone while in view.
    pub fn follow(&mut self, objects: &Objects, groups: &mut Groups, changes: &mut Vec<Change>) {
        let now = objects.layout_revision();
        let before = self.revision.replace(now);
        if before == Some(now) {
            return;
        }
        let since = before.unwrap_or(0);
        for group in &mut groups.0 {
            group.follow(objects, &self.tenants, since, changes);
        }
        self.tenants.resize(objects.blocks().len() * BLOCK, None);
        for (block, tenants) in self.tenants.chunks_exact_mut(BLOCK).enumerate() {
            if before.is_none() || objects.block_layout_revisions()[block] > since {
                let slots = block * BLOCK..;
                tenants.iter_mut().zip(slots).for_each(|(tenant, slot)| *tenant = objects.id_of(slot));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Sphere;
    use crate::rate::CostModel;
    use crate::scene::Object;
    use crate::table::{LevelRecord, LodTable};
    use glam::Vec3;

    #[test]
    fn nothing_is_remembered_in_the_first_frame() {
        let mut objects = Objects::new();
        let table = LodTable::new("box", Sphere::new(Vec3::ZERO, 1.0), vec![LevelRecord::new(12, 8)]);
        let table = objects.add_table(table.expect("a good table")).expect("room");
        objects.insert(Object::new(0, Sphere::new(Vec3::ZERO, 1.0), table)).expect("new");
        let mut rates = TableRates::default();
        rates.renew(objects.tables(), &CostModel::default());
        let places = Places { objects: &objects, rates: &rates, once: false };
        let mut memory = GroupMemory::new(GroupId(0));
        let recall = |memory: &mut GroupMemory, clock_ms: f64| {
            let mut rows = [Row { block: 0, mask: 1, known: 0, deferred: 0, first: 0 }];
            let (mut held, mut place, mut levels) = ([NEWCOMER], [NO_PLACE], [Level::NOT_DRAWN]);
            let recalled = Recalled { held: &mut held, place: &mut place, levels: &mut levels };
            memory.begin_frame(places, clock_ms);
            memory.recall(&mut rows, places, recalled, 1, &mut Vec::new());
            (rows[0].known, held[0])
        };
        assert_eq!(recall(&mut memory, 0.0), (0, NEWCOMER));
        memory.enter(0, Level::FINEST, NO_PLACE);
        assert_eq!(recall(&mut memory, 16.0), (1, Level::FINEST));
    }
}
