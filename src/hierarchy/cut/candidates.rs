//! What could be split or contracted next, and what each of it is worth.

use super::agenda::Agenda;
use super::front::Front;
use super::heap::Heap;
use super::look::{Brink, Look, Way};
use super::sight::{Motion, Sight};
use crate::hierarchy::Hierarchy;
use crate::view::{Lens, View};

/// Two queues of operations, and what is known of their priorities. What comes first is looked at closely before it is
/// said to be first.
#[derive(Clone, Debug)]
pub(super) struct Candidates {
    sight: Sight,
    /// Operations whose node is active, largest error first.
    splits: Heap,
    /// Operations that could be done, least error first. Some may have become impossible since.
    merges: Heap,
    /// All of both, by when to look at them again.
    agenda: Agenda,
    /// What came first after the last update.
    brink: Brink,
    /// How often views have changed; per operation, how often they had when it was looked at closely.
    moves: u32,
    close_looks: Vec<u32>,
    overdue: Vec<u32>,
    /// How many looks were taken since the last motion.
    pub(super) evaluated: usize,
}

impl Candidates {
    pub(super) fn new(hierarchy: &Hierarchy) -> Self {
        let operations = hierarchy.parts().operations.len();
        Self {
            sight: Sight::default(),
            splits: Heap::new(operations),
            merges: Heap::new(operations),
            agenda: Agenda::new(operations, hierarchy.bounds().radius),
            brink: Brink::UNKNOWN,
            moves: 0,
            close_looks: vec![0; operations],
            overdue: Vec::new(),
            evaluated: 0,
        }
    }

    /// The first view.
    pub(super) fn lens(&self) -> Option<&Lens> {
        self.sight.first()
    }

    /// Takes new views, all of which can be used, and looks at all that their motion may have changed. Returns whether
    /// there was any.
    pub(super) fn follow<'a>(
        &mut self,
        hierarchy: &Hierarchy,
        views: impl Iterator<Item = &'a View>,
    ) -> bool {
        self.evaluated = 0;
        let mut overdue = std::mem::take(&mut self.overdue);
        let motion = self.sight.renew(views);
        match motion {
            Motion::Still => {}
            Motion::Moved { travel, turn } => self.agenda.advance(travel, turn, &mut overdue),
            Motion::Cut => {
                self.agenda.clear();
                overdue.extend(self.splits.operations().chain(self.merges.operations()));
            }
        }
        self.moves = self.moves.wrapping_add(u32::from(motion != Motion::Still));
        overdue.sort_unstable();
        overdue.drain(..).for_each(|operation| self.look_again(hierarchy, operation));
        self.overdue = overdue;
        motion != Motion::Still
    }

    /// Remembers what comes first: what is far from it is not looked at closely.
    pub(super) fn remember_brink(&mut self, hierarchy: &Hierarchy, front: &Front) -> Brink {
        let split = self.worst(hierarchy).map_or(0.0, |(error, _)| error);
        let merge = self.mildest(hierarchy, front).map_or(f32::INFINITY, |(error, _)| error);
        self.brink = Brink { split, merge };
        self.brink
    }

    /// The operation that is most in need of a split.
    pub(super) fn worst(&mut self, hierarchy: &Hierarchy) -> Option<(f32, u32)> {
        loop {
            let (key, operation) = self.splits.first()?;
            if self.is_close(operation) {
                return Some((f32::from_bits(!key), operation));
            }
            self.look_closely(hierarchy, operation, Way::Split);
        }
    }

    /// The operation that is done at the least error.
    pub(super) fn mildest(&mut self, hierarchy: &Hierarchy, front: &Front) -> Option<(f32, u32)> {
        loop {
            let (key, operation) = self.merges.first()?;
            if !front.may_merge(hierarchy, operation) {
                self.drop(operation);
            } else if self.is_close(operation) {
                return Some((f32::from_bits(key), operation));
            } else {
                self.look_closely(hierarchy, operation, Way::Merge);
            }
        }
    }

    /// The key of an operation that could be split.
    pub(super) fn take_split(&mut self, operation: u32) -> Option<u32> {
        self.splits.remove(operation)
    }

    pub(super) fn put_back_split(&mut self, operation: u32, key: u32) {
        if self.splits.key(operation).is_none() {
            self.splits.set(operation, key);
        }
    }

    pub(super) fn may_be_merged(&self, operation: u32) -> bool {
        self.merges.key(operation).is_some()
    }

    /// An operation that could be contracted was, and can be split.
    pub(super) fn turn_to_split(&mut self, hierarchy: &Hierarchy, operation: u32) {
        match self.merges.remove(operation) {
            Some(key) if self.is_close(operation) => self.splits.set(operation, !key),
            _ => self.add(hierarchy, operation, Way::Split),
        }
    }

    /// An operation can neither be split nor done.
    pub(super) fn drop(&mut self, operation: u32) {
        self.splits.remove(operation);
        self.merges.remove(operation);
        self.agenda.remove(operation);
    }

    /// Whether what is known of an operation was seen closely from where the eye is now.
    fn is_close(&self, operation: u32) -> bool {
        self.close_looks[operation as usize] == self.moves
    }

    fn look_again(&mut self, hierarchy: &Hierarchy, operation: u32) {
        let way = if self.splits.key(operation).is_some() { Way::Split } else { Way::Merge };
        self.add(hierarchy, operation, way);
    }

    /// An operation can be split or contracted: looks at it as closely as it matters.
    pub(super) fn add(&mut self, hierarchy: &Hierarchy, operation: u32, way: Way) {
        let of = hierarchy.operation(operation);
        match Look::from_afar(self.sight.lenses(), of, way, &self.brink) {
            Some(look) => {
                self.close_looks[operation as usize] = self.moves.wrapping_sub(1);
                self.enter(operation, way, look);
            }
            None => self.look_closely(hierarchy, operation, way),
        }
    }

    fn look_closely(&mut self, hierarchy: &Hierarchy, operation: u32, way: Way) {
        self.close_looks[operation as usize] = self.moves;
        self.enter(operation, way, Look::closely(self.sight.lenses(), hierarchy.operation(operation), way));
    }

    /// Puts an operation into its queue, and on the agenda.
    fn enter(&mut self, operation: u32, way: Way, look: Look) {
        self.evaluated += 1;
        let bits = look.priority.to_bits();
        match way {
            Way::Split => self.splits.set(operation, !bits),
            Way::Merge => self.merges.set(operation, bits),
        }
        self.agenda.set(operation, look.later, look.reach);
    }
}
