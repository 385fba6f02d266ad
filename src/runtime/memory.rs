//! What is remembered of earlier frames, per view group and slot.

use crate::frame::{Cause, Change, GroupId};
use crate::scene::{ObjectId, Objects};
use crate::table::Level;
use crate::transition::Shown;

/// What is remembered of one object in one group.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlotState {
    /// The level that the policy wants.
    pub wanted: Level,
    /// What is shown.
    pub shown: Shown,
    /// The last of the group's frames in which the object was in view. Memory ends when it leaves.
    seen: u32,
    /// Since when the level is wanted, by the group's clock in whole milliseconds, which wraps after seven weeks.
    since_ms: u32,
}

impl SlotState {
    const UNSEEN: Self = Self { wanted: Level::NOT_DRAWN, shown: Shown::NOTHING, seen: 0, since_ms: 0 };
}

/// The memory of one view group.
#[derive(Clone, Debug)]
pub(super) struct GroupMemory {
    pub id: GroupId,
    /// The group's own count of frames. The first is 2, so that no slot seems to have been seen in the one before.
    frame: u32,
    clock_ms: f64,
    states: Vec<SlotState>,
    /// Slots in view in this frame and in the one before, ascending.
    visible: Vec<u32>,
    before: Vec<u32>,
    /// How many of the slots in view were in view in the frame before.
    stayed: usize,
}

/// The memory of a group, made when first asked for.
pub(super) fn of_group(groups: &mut Vec<GroupMemory>, id: GroupId) -> &mut GroupMemory {
    let at = groups.binary_search_by_key(&id, |g| g.id).unwrap_or_else(|at| {
        groups.insert(at, GroupMemory::new(id));
        at
    });
    &mut groups[at]
}

impl GroupMemory {
    fn new(id: GroupId) -> Self {
        Self {
            id,
            frame: 1,
            clock_ms: 0.0,
            states: Vec::new(),
            visible: Vec::new(),
            before: Vec::new(),
            stayed: 0,
        }
    }

    /// Starts a frame at `clock_ms` over so many slots; returns the time since the group's last one.
    pub fn begin_frame(&mut self, slots: usize, clock_ms: f64) -> f64 {
        self.states.resize(slots, SlotState::UNSEEN);
        self.frame += 1;
        self.stayed = 0;
        std::mem::swap(&mut self.visible, &mut self.before);
        self.visible.clear();
        clock_ms - std::mem::replace(&mut self.clock_ms, clock_ms)
    }

    /// Notes that a slot is in view; its state if it was in view in the last frame as well.
    pub fn recall(&mut self, slot: u32) -> Option<&mut SlotState> {
        self.visible.push(slot);
        let state = &mut self.states[slot as usize];
        let remembered = state.seen + 1 == self.frame;
        state.seen = self.frame;
        self.stayed += usize::from(remembered);
        remembered.then_some(state)
    }

    /// How long the level of a state has been wanted.
    pub fn age_ms(clock_ms: f64, state: &SlotState) -> u32 {
        whole_ms(clock_ms).wrapping_sub(state.since_ms)
    }

    /// The state of a slot that is in view.
    pub fn state(&mut self, slot: u32) -> &mut SlotState {
        &mut self.states[slot as usize]
    }

    /// What is shown in a slot that is in view.
    pub fn shown_at(&self, slot: u32) -> Shown {
        self.states[slot as usize].shown
    }

    /// What is shown in a slot; `None` when it was not in view in the group's last frame.
    pub fn visible(&self, slot: usize) -> Option<Shown> {
        self.states.get(slot).filter(|s| s.seen == self.frame).map(|s| s.shown)
    }

    /// Everything that was in view in the group's last frame, slots ascending.
    pub fn shown(&self) -> impl Iterator<Item = (usize, Shown)> + '_ {
        self.visible.iter().map(|&slot| (slot as usize, self.states[slot as usize].shown))
    }

    /// An object has come into view: it is shown as wanted at once.
    pub fn enter(&mut self, slot: u32, wanted: Level) {
        // Coming into view is no switch: the level counts as one that is long wanted.
        let since_ms = whole_ms(self.clock_ms).wrapping_sub(LONG_AGO_MS);
        let state = &mut self.states[slot as usize];
        *state = SlotState { wanted, shown: Shown::steady(wanted), since_ms, ..*state };
    }

    /// Notes that something else is wanted than before.
    pub fn want(&mut self, slot: u32, wanted: Level) {
        let since_ms = whole_ms(self.clock_ms);
        let state = &mut self.states[slot as usize];
        *state = SlotState { wanted, since_ms, ..*state };
    }

    /// Lists what has left the view since the group's last frame.
    pub fn end_frame(&self, objects: &Objects, changes: &mut Vec<Change>) {
        if self.stayed == self.before.len() {
            return;
        }
        for &slot in &self.before {
            let state = &self.states[slot as usize];
            if let Some(object) = objects.id_of(slot as usize).filter(|_| state.seen + 1 == self.frame) {
                self.leave(object, state.shown.level, changes);
            }
        }
    }

    fn leave(&self, object: ObjectId, old: Level, changes: &mut Vec<Change>) {
        if old.is_drawn() {
            let (group, new, cause) = (self.id, Level::NOT_DRAWN, Cause::OutOfView);
            changes.push(Change { group, object, old, new, cause });
        }
    }

    /// Carries states to the slots that their objects live in now. `tenants` are those of before.
    fn follow(&mut self, objects: &Objects, tenants: &[Option<ObjectId>], changes: &mut Vec<Change>) {
        let mut moved = Vec::new();
        self.visible.retain(|&slot| {
            let Some(id) = tenants[slot as usize] else { return true };
            let stays = objects.id_of(slot as usize) == Some(id);
            if !stays {
                moved.push((id, std::mem::replace(&mut self.states[slot as usize], SlotState::UNSEEN)));
            }
            stays
        });
        self.states.resize(objects.blocks().len() * crate::scene::BLOCK, SlotState::UNSEEN);
        let arrived = self.visible.len();
        for (id, state) in moved {
            match objects.slot_of(id) {
                Some(slot) => {
                    self.states[slot] = state;
                    self.visible.push(slot as u32);
                }
                None => self.leave(id, state.shown.level, changes),
            }
        }
        if self.visible.len() > arrived {
            self.visible.sort_unstable();
        }
    }
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
    /// How many slots there are.
    pub fn slots(&self) -> usize {
        self.tenants.len()
    }

    /// Carries every group's memory along when objects have come, gone or changed their slots. Lists those that have
    /// gone while in view.
    pub fn follow(&mut self, objects: &Objects, groups: &mut [GroupMemory], changes: &mut Vec<Change>) {
        if self.revision.replace(objects.layout_revision()) == Some(objects.layout_revision()) {
            return;
        }
        for group in groups {
            group.follow(objects, &self.tenants, changes);
        }
        self.tenants.clear();
        self.tenants
            .extend((0..objects.blocks().len() * crate::scene::BLOCK).map(|slot| objects.id_of(slot)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_remembered_in_the_first_frame() {
        let mut memory = GroupMemory::new(GroupId(0));
        memory.begin_frame(1, 0.0);
        assert!(memory.recall(0).is_none());
        memory.enter(0, Level(1));
        memory.begin_frame(1, 16.0);
        assert!(memory.recall(0).is_some());
    }
}
