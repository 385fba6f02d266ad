//! A queue whose entries can change their place.

use crate::hierarchy::NONE;

/// A binary heap of operations, least key first, ties by lower operation, in which every operation is at most once.
#[derive(Clone, Debug, Default)]
pub(super) struct Heap {
    items: Vec<(u64, u32)>,
    /// Per operation, where it is in `items`.
    places: Vec<u32>,
}

impl Heap {
    pub(super) fn new(operations: usize) -> Self {
        Self { items: Vec::new(), places: vec![NONE; operations] }
    }

    pub(super) fn first(&self) -> Option<(u64, u32)> {
        self.items.first().copied()
    }

    pub(super) fn key(&self, operation: u32) -> Option<u64> {
        let place = self.places[operation as usize];
        (place != NONE).then(|| self.items[place as usize].0)
    }

    /// All operations that are in it, in no order.
    pub(super) fn operations(&self) -> impl Iterator<Item = u32> {
        self.items.iter().map(|&(_, operation)| operation)
    }

    /// Puts an operation in, or gives it another key.
    pub(super) fn set(&mut self, operation: u32, key: u64) {
        let mut place = self.places[operation as usize] as usize;
        if place == NONE as usize {
            place = self.items.len();
            self.items.push((key, operation));
        }
        self.items[place] = (key, operation);
        let place = self.rise(place);
        self.sink(place);
    }

    /// Takes an operation out, and returns its key if it was in.
    pub(super) fn remove(&mut self, operation: u32) -> Option<u64> {
        let place = self.places[operation as usize];
        if place == NONE {
            return None;
        }
        let (key, _) = self.items.swap_remove(place as usize);
        self.places[operation as usize] = NONE;
        if (place as usize) < self.items.len() {
            let place = self.rise(place as usize);
            self.sink(place);
        }
        Some(key)
    }

    /// Moves an item up to where it belongs, and returns its place.
    fn rise(&mut self, mut place: usize) -> usize {
        let item = self.items[place];
        while place > 0 && item < self.items[(place - 1) / 2] {
            self.put(place, self.items[(place - 1) / 2]);
            place = (place - 1) / 2;
        }
        self.put(place, item);
        place
    }

    fn sink(&mut self, mut place: usize) {
        let item = self.items[place];
        loop {
            let first = 2 * place + 1;
            let below = first..(first + 2).min(self.items.len());
            let Some(least) = below.min_by_key(|&child| self.items[child]) else { break };
            if item <= self.items[least] {
                break;
            }
            self.put(place, self.items[least]);
            place = least;
        }
        self.put(place, item);
    }

    fn put(&mut self, place: usize, item: (u64, u32)) {
        self.items[place] = item;
        self.places[item.1 as usize] = place as u32;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_first_is_the_least_whatever_is_done(steps in proptest::collection::vec((0u32..20, 0u64..9, any::<bool>()), 0..200)) {
            let mut heap = Heap::new(20);
            let mut twin = BTreeMap::new();
            for (operation, key, stays) in steps {
                if stays {
                    heap.set(operation, key);
                    twin.insert(operation, key);
                } else {
                    prop_assert_eq!(heap.remove(operation), twin.remove(&operation));
                }
                let least = twin.iter().map(|(&operation, &key)| (key, operation)).min();
                prop_assert_eq!(heap.first(), least);
                prop_assert_eq!(heap.key(operation), twin.get(&operation).copied());
                prop_assert_eq!(heap.operations().count(), twin.len());
            }
        }
    }
}
