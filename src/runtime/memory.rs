//! What is remembered of earlier frames, per view group and slot: sixteen slots to a block, as the objects are.

use crate::frame::{Account, Candidates, Cause, Change, GroupId, NO_PLACE, Row};
use crate::rate::TableRates;
use crate::scene::{BLOCK, ObjectId, Objects, lanes};
use crate::table::Level;
use crate::transition::Shown;

/// What is remembered of the objects of a block.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct BlockMemory {
    /// See [`Candidates::place`].
    place: [u32; BLOCK],
    /// Since when the level is wanted, by the group's clock in whole milliseconds, which wraps after seven weeks.
    since_ms: [u32; BLOCK],
    /// The level that the policy wants.
    wanted: [Level; BLOCK],
    /// The revision of the objects' block that the places hold for, and whether objects counted once then.
    revision: u64,
    once: bool,
    /// The last of the group's frames in which some of the block was in view.
    frame: u32,
    /// Bit per lane: it was in view in that frame. Memory ends when an object leaves.
    seen: u16,
    /// Bit per lane: something else is shown than the level that is wanted. See [`GroupMemory::unsteady`].
    unsteady: u16,
}

impl BlockMemory {
    const EMPTY: Self = Self {
        place: [NO_PLACE; BLOCK],
        since_ms: [0; BLOCK],
        wanted: [Level::NOT_DRAWN; BLOCK],
        revision: 0,
        once: true,
        frame: 0,
        seen: 0,
        unsteady: 0,
    };
}

/// The accounts of the objects of a block.
#[derive(Clone, Copy, Debug)]
struct BlockAccounts {
    /// Drops are those of the time when the level that is wanted came to be wanted.
    account: [Account; BLOCK],
    /// Bit per lane: it was owed something in this one of the group's frames.
    owing: u16,
    frame: u32,
}

impl BlockAccounts {
    const EMPTY: Self = Self { account: [Account::NEW; BLOCK], owing: 0, frame: 0 };

    /// What was owed at the end of a frame, and the drops.
    fn get(&self, lane: usize, frame: u32) -> Account {
        let is_owed = self.frame == frame && self.owing & (1 << lane) != 0;
        Account { owed_ms: if is_owed { self.account[lane].owed_ms } else { 0 }, ..self.account[lane] }
    }

    fn set(&mut self, lane: usize, frame: u32, account: Account) {
        if self.frame != frame {
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

/// The memory of a group, made when first asked for.
pub(super) fn of_group(groups: &mut Vec<GroupMemory>, id: GroupId) -> &mut GroupMemory {
    let at = groups.binary_search_by_key(&id, |g| g.id).unwrap_or_else(|at| {
        groups.insert(at, GroupMemory::new(id));
        at
    });
    &mut groups[at]
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
            accounts: Vec::new(),
            unsteady: Vec::new(),
            fresh: Vec::new(),
            rows: Vec::new(),
            before: Vec::new(),
            stayed: 0,
            moving: Vec::new(),
        }
    }

    /// Starts a frame at `clock_ms` over so many blocks; returns the time since the group's last one.
    pub fn begin_frame(&mut self, blocks: usize, clock_ms: f64) -> f64 {
        self.blocks.resize(blocks, BlockMemory::EMPTY);
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

    /// Notes that the candidates of a row are in view, and adds what is remembered of them to the candidates and to
    /// `levels`. The row learns which of its objects were in view in the last frame as well.
    pub fn recall(
        &mut self,
        row: &mut Row,
        places: Places<'_>,
        candidates: &mut Candidates,
        levels: &mut Vec<Level>,
    ) {
        let now_ms = whole_ms(self.clock_ms);
        let memory = &mut self.blocks[row.block as usize];
        row.known = if memory.frame + 1 == self.frame { memory.seen & row.mask } else { 0 };
        (memory.frame, memory.seen) = (self.frame, row.mask);
        self.stayed += row.known.count_ones();
        self.rows.push(*row);
        let revision = places.objects.block_revisions()[row.block as usize];
        if memory.revision != revision || memory.once != places.once {
            memory.renew(row, places, &mut self.unsteady);
            (memory.revision, memory.once) = (revision, places.once);
        }
        if row.known == u16::MAX {
            candidates.previous.extend(memory.wanted.iter().map(|&level| Some(level)));
            candidates.age_ms.extend(memory.since_ms.iter().map(|&since| now_ms.wrapping_sub(since)));
            candidates.place.extend_from_slice(&memory.place);
            levels.extend_from_slice(&memory.wanted);
        } else {
            memory.recall_lanes(row, now_ms, candidates, levels);
        }
        if let Some(accounts) = self.accounts.get(row.block as usize) {
            candidates.account.extend(lanes(row.mask).map(|lane| {
                let known = row.known & (1 << lane) != 0;
                let age_ms = now_ms.wrapping_sub(memory.since_ms[lane]);
                let account = accounts.get(lane, self.frame - 1).after(self.elapsed_ms, age_ms);
                if known { account } else { Account::default() }
            }));
        }
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
        let since_ms = whole_ms(self.clock_ms).wrapping_sub(LONG_AGO_MS);
        self.blocks[slot as usize / BLOCK].set(slot, wanted, place, since_ms);
        self.blocks[slot as usize / BLOCK].unsteady &= !(1 << (slot as usize % BLOCK));
        if let Some(accounts) = self.accounts.get_mut(slot as usize / BLOCK) {
            accounts.set(slot as usize % BLOCK, self.frame, Account::default());
        }
    }

    /// Notes that something else is wanted than before.
    pub fn want(&mut self, slot: u32, wanted: Level, place: u32) {
        let since_ms = whole_ms(self.clock_ms);
        let (memory, lane) = (&mut self.blocks[slot as usize / BLOCK], slot as usize % BLOCK);
        if let Some(accounts) = self.accounts.get_mut(slot as usize / BLOCK) {
            let put_in = if wanted < memory.wanted[lane] { Account::REFINEMENT_DROPS } else { 0 };
            let age_ms = since_ms.wrapping_sub(memory.since_ms[lane]);
            let account = accounts.account[lane].after(0, age_ms);
            let drops = account.drops.saturating_add(put_in);
            accounts.set(lane, self.frame, Account { owed_ms: 0, drops, from: memory.wanted[lane] });
        }
        memory.set(slot, wanted, place, since_ms);
    }

    /// Notes that a finer level of a slot has been held back for so long.
    pub fn owe(&mut self, slot: u32, owed_ms: u16) {
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

    /// Lists what has left the view since the group's last frame.
    pub fn end_frame(&mut self, objects: &Objects, changes: &mut Vec<Change>) {
        if self.stayed != self.before.iter().map(|row| row.mask.count_ones()).sum::<u32>() {
            self.list_leavers(objects, changes);
        }
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

    fn list_leavers(&self, objects: &Objects, changes: &mut Vec<Change>) {
        for row in &self.before {
            let memory = &self.blocks[row.block as usize];
            let stayed = if memory.frame == self.frame { memory.seen } else { 0 };
            for slot in slots_of(row.block, row.mask & !stayed) {
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
                let (wanted, since_ms) = (memory.wanted[lane], memory.since_ms[lane]);
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
            self.rows.push(Row { block: (slot / BLOCK) as u32, mask: 0, known: 0, first: 0 });
        }
        memory.seen |= 1 << lane;
        memory.set(slot as u32, state.wanted, NO_PLACE, state.since_ms);
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

impl BlockMemory {
    fn set(&mut self, slot: u32, wanted: Level, place: u32, since_ms: u32) {
        let lane = slot as usize % BLOCK;
        self.wanted[lane] = wanted;
        self.place[lane] = place;
        self.since_ms[lane] = since_ms;
    }

    /// Looks up the places anew, and cuts what is wanted to tables that may be others by now.
    fn renew(&mut self, row: &Row, places: Places<'_>, unsteady: &mut Vec<Unsteady>) {
        for slot in slots_of(row.block, row.known) {
            let lane = slot as usize % BLOCK;
            let (wanted, table) =
                (self.wanted[lane], places.objects.blocks()[row.block as usize].table[lane]);
            if wanted.is_drawn() && wanted > places.rates.coarsest(table) {
                self.wanted[lane] = places.rates.coarsest(table);
                self.keep_showing(slot, Shown::steady(wanted), unsteady);
            }
            self.place[lane] = places.of(slot as usize, self.wanted[lane]);
        }
    }

    /// Goes on showing what is shown where something else is wanted of a sudden.
    fn keep_showing(&mut self, slot: u32, shown: Shown, unsteady: &mut Vec<Unsteady>) {
        let bit = 1 << (slot as usize % BLOCK);
        if self.unsteady & bit == 0 {
            let at = unsteady.partition_point(|u| u.slot < slot);
            unsteady.insert(at, Unsteady { slot, shown });
            self.unsteady |= bit;
        }
    }

    /// [`GroupMemory::recall`] where the row is not full, or not all of it is known.
    fn recall_lanes(&self, row: &Row, now_ms: u32, candidates: &mut Candidates, levels: &mut Vec<Level>) {
        for lane in lanes(row.mask) {
            let known = row.known & (1 << lane) != 0;
            candidates.previous.push(known.then_some(self.wanted[lane]));
            candidates.age_ms.push(if known { now_ms.wrapping_sub(self.since_ms[lane]) } else { 0 });
            candidates.place.push(if known { self.place[lane] } else { NO_PLACE });
            levels.push(if known { self.wanted[lane] } else { Level::NOT_DRAWN });
        }
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
    pub fn follow(&mut self, objects: &Objects, groups: &mut [GroupMemory], changes: &mut Vec<Change>) {
        let now = objects.layout_revision();
        let before = self.revision.replace(now);
        if before == Some(now) {
            return;
        }
        let since = before.unwrap_or(0);
        for group in groups {
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
        let (mut candidates, mut levels) = (Candidates::default(), Vec::new());
        let mut row = Row { block: 0, mask: 1, known: 0, first: 0 };
        memory.begin_frame(1, 0.0);
        memory.recall(&mut row, places, &mut candidates, &mut levels);
        assert_eq!(row.known, 0);
        memory.enter(0, Level::FINEST, NO_PLACE);
        memory.begin_frame(1, 16.0);
        memory.recall(&mut row, places, &mut candidates, &mut levels);
        assert_eq!(row.known, 1);
        assert_eq!(candidates.previous, [None, Some(Level::FINEST)]);
    }
}
