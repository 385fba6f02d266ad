//! What has to be looked at again when the camera has come so far.

use crate::hierarchy::NONE;

/// Operations by when they are due: when what the eye has travelled, and what the frustum has turned times a *reach*,
/// add up to so much.
///
/// There is a clock for every octave of reaches, at which turns count at least as much as they should, and an operation
/// is on one of them: in a radix heap, where to add one is to write to the end of a list, and every one is moved some
/// few times at most until it is due (R. K. Ahuja, K. Mehlhorn, J. B. Orlin, R. E. Tarjan, "Faster algorithms for the
/// shortest path problem", 1990). There is no order among those that are due at once.
#[derive(Clone, Debug)]
pub(super) struct Agenda {
    clocks: Vec<Clock>,
    /// Per operation.
    entries: Vec<Entry>,
}

#[derive(Clone, Debug)]
struct Clock {
    /// What turns count.
    reach: f64,
    /// The bits of the time, which as whole numbers are in its order.
    now: u64,
    /// List `i` has what is due at a time whose highest bit that is not that of `now` is bit `i - 1`.
    lists: Vec<Vec<u32>>,
}

/// What an operation is due at: the clock, the bits of the time, and the place in its list.
#[derive(Clone, Copy, Debug)]
struct Entry {
    due: u64,
    clock: u32,
    place: u32,
}

/// How many octaves of reaches there are, the middle one at the size of the object. What is nearer counts as if it were
/// at the first.
const OCTAVES: usize = 32;

/// A list per bit, and one for what is due now.
const LISTS: usize = u64::BITS as usize + 1;

impl Agenda {
    /// For so many operations of an object of some size.
    pub(super) fn new(operations: usize, size: f32) -> Self {
        let first = f64::from(size.max(f32::MIN_POSITIVE)) * 0.5f64.powi(OCTAVES as i32 / 2);
        let octaves = (0..OCTAVES).map(|octave| first * 2f64.powi(octave as i32));
        let reaches = [0.0].into_iter().chain(octaves);
        let lists = vec![Vec::new(); LISTS];
        Self {
            clocks: reaches.map(|reach| Clock { reach, now: 0, lists: lists.clone() }).collect(),
            entries: vec![Entry { due: 0, clock: 0, place: NONE }; operations],
        }
    }

    /// Says that an operation is due so much later. One that never is, is not in it.
    pub(super) fn set(&mut self, operation: u32, later: f32, reach: f32) {
        self.remove(operation);
        if later < f32::INFINITY {
            let reach = f64::from(reach);
            let clock = self.clocks.partition_point(|clock| clock.reach < reach).min(OCTAVES);
            // Beyond the last octave, all counts as if it were nearer.
            let nearer = (self.clocks[clock].reach / reach).min(1.0);
            let due = self.clocks[clock].after(f64::from(later) * nearer);
            self.entries[operation as usize] = Entry { due, clock: clock as u32, place: NONE };
            self.clocks[clock].put(operation, &mut self.entries);
        }
    }

    pub(super) fn remove(&mut self, operation: u32) {
        let Entry { due, clock, place } = self.entries[operation as usize];
        if place != NONE {
            self.entries[operation as usize].place = NONE;
            let clock = &mut self.clocks[clock as usize];
            let list = &mut clock.lists[list_of(clock.now, due)];
            list.swap_remove(place as usize);
            if let Some(&moved) = list.get(place as usize) {
                self.entries[moved as usize].place = place;
            }
        }
    }

    /// Lets the eye travel and the frustum turn; takes out what was due before and adds it to `overdue`.
    pub(super) fn advance(&mut self, travel: f64, turn: f64, overdue: &mut Vec<u32>) {
        for clock in &mut self.clocks {
            let now = f64::from_bits(clock.now) + travel + turn * clock.reach;
            clock.advance(now.next_up().to_bits(), &mut self.entries, overdue);
        }
    }

    /// Starts anew, with nothing in it.
    pub(super) fn clear(&mut self) {
        for clock in &mut self.clocks {
            clock.now = 0;
            for operation in clock.lists.iter_mut().flat_map(|list| list.drain(..)) {
                self.entries[operation as usize].place = NONE;
            }
        }
    }
}

impl Clock {
    /// The bits of a time that is so much later, and no more for rounding.
    fn after(&self, later: f64) -> u64 {
        let now = f64::from_bits(self.now);
        (now + later).next_down().max(now).to_bits()
    }

    fn put(&mut self, operation: u32, entries: &mut [Entry]) {
        let entry = &mut entries[operation as usize];
        let list = &mut self.lists[list_of(self.now, entry.due)];
        entry.place = list.len() as u32;
        list.push(operation);
    }

    fn advance(&mut self, now: u64, entries: &mut [Entry], overdue: &mut Vec<u32>) {
        let before = std::mem::replace(&mut self.now, now);
        for list in 0..=list_of(before, now) {
            let mut passing = std::mem::take(&mut self.lists[list]);
            for operation in passing.drain(..) {
                if entries[operation as usize].due < now {
                    entries[operation as usize].place = NONE;
                    overdue.push(operation);
                } else {
                    self.put(operation, entries);
                }
            }
            // Those that stay are in lists before this one.
            self.lists[list] = passing;
        }
    }
}

/// The list for a time, at another.
fn list_of(now: u64, due: u64) -> usize {
    (u64::BITS - (now ^ due).leading_zeros()) as usize
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use proptest::prelude::*;

    /// What has to happen until an operation is due, and what has happened since.
    #[derive(Clone, Copy)]
    struct Due {
        later: f64,
        reach: f64,
        since: f64,
    }

    proptest! {
        /// Nothing is late, and what is early has turned more than half of what it may.
        #[test]
        fn what_is_due_is_told_and_little_else(
            steps in proptest::collection::vec((0u32..20, 0u32..300, 0u32..9, 0u32..4), 0..300),
            size in 0.001f32..10.0,
        ) {
            let mut agenda = Agenda::new(20, size);
            let mut twin: BTreeMap<u32, Due> = BTreeMap::new();
            for (operation, ahead, reach, what) in steps {
                let (ahead, reach) = (f64::from(ahead) / 64.0, f64::from(reach) / 4.0);
                match what {
                    0 => {
                        agenda.remove(operation);
                        twin.remove(&operation);
                    }
                    1 => {
                        let mut overdue = Vec::new();
                        agenda.advance(ahead / 8.0, ahead / 16.0, &mut overdue);
                        twin.values_mut().for_each(|due| due.since += ahead / 8.0 + due.reach * ahead / 16.0);
                        for (operation, due) in &twin {
                            let is_told = overdue.contains(operation);
                            prop_assert!(is_told || due.since <= due.later);
                            prop_assert!(!is_told || 2.0 * due.since >= 0.999 * due.later);
                        }
                        for operation in &overdue {
                            prop_assert!(twin.remove(operation).is_some());
                        }
                    }
                    _ => {
                        let later = if ahead > 4.0 { f64::INFINITY } else { ahead };
                        agenda.set(operation, later as f32, reach as f32);
                        twin.insert(operation, Due { later, reach, since: 0.0 });
                    }
                }
            }
            agenda.clear();
            let mut overdue = Vec::new();
            agenda.advance(1e9, 0.0, &mut overdue);
            prop_assert!(overdue.is_empty());
        }
    }
}
