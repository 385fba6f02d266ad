//! A queue whose entries can change their place.

use crate::hierarchy::NONE;

/// A binary heap of operations, least key first, ties by lower operation, in which every operation is at most once.
#[derive(Clone, Debug, Default)]
pub(super) struct Heap {
    /// The key of an operation in the upper half, itself in the lower: whole numbers in the order of the heap.
    items: Vec<u64>,
    /// Per operation, where it is in `items`.
    places: Vec<u32>,
}

impl Heap {
    pub(super) fn new(operations: usize) -> Self {
        Self { items: Vec::new(), places: vec![NONE; operations] }
    }

    pub(super) fn first(&self) -> Option<(u32, u32)> {
        self.items.first().copied().map(parts)
    }

    pub(super) fn key(&self, operation: u32) -> Option<u32> {
        let place = self.places[operation as usize];
        (place != NONE).then(|| parts(self.items[place as usize]).0)
    }

    /// All operations that are in it, in no order.
    pub(super) fn operations(&self) -> impl Iterator<Item = u32> {
        self.items.iter().map(|&item| parts(item).1)
    }

    /// Puts an operation in, or gives it another key.
    pub(super) fn set(&mut self, operation: u32, key: u32) {
        let item = u64::from(key) << 32 | u64::from(operation);
        let place = match self.places[operation as usize] {
            NONE => {
                self.items.push(item);
                self.items.len() - 1
            }
            place => place as usize,
        };
        self.settle(place, item);
    }

    /// Takes an operation out, and returns its key if it was in.
    pub(super) fn remove(&mut self, operation: u32) -> Option<u32> {
        let place = self.places[operation as usize];
        if place == NONE {
            return None;
        }
        let item = self.items.swap_remove(place as usize);
        self.places[operation as usize] = NONE;
        if let Some(&moved) = self.items.get(place as usize) {
            self.settle(place as usize, moved);
        }
        Some(parts(item).0)
    }

    /// Puts an item where it belongs, from a place that is free for it.
    fn settle(&mut self, place: usize, item: u64) {
        let place = self.rise(place, item);
        let place = self.sink(place, item);
        self.put(place, item);
    }

    /// Moves down what is above a place and more than an item; returns where that leaves room.
    fn rise(&mut self, mut place: usize, item: u64) -> usize {
        while place > 0 && item < self.items[(place - 1) / 2] {
            self.put(place, self.items[(place - 1) / 2]);
            place = (place - 1) / 2;
        }
        place
    }

    /// Moves up what is below a place and less than an item; returns where that leaves room.
    fn sink(&mut self, mut place: usize, item: u64) -> usize {
        while let Some(&left) = self.items.get(2 * place + 1) {
            let right = self.items.get(2 * place + 2).copied().unwrap_or(u64::MAX);
            if item <= left.min(right) {
                break;
            }
            self.put(place, left.min(right));
            place = 2 * place + 1 + usize::from(right < left);
        }
        place
    }

    fn put(&mut self, place: usize, item: u64) {
        self.items[place] = item;
        self.places[parts(item).1 as usize] = place as u32;
    }
}

/// The key and the operation of an item.
fn parts(item: u64) -> (u32, u32) {
    ((item >> 32) as u32, item as u32)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_first_is_the_least_whatever_is_done(steps in proptest::collection::vec((0u32..20, 0u32..9, any::<bool>()), 0..200)) {
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
