//! A priority queue for keys that mostly grow.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Bits of a cost that its bucket leaves out: three bits of the mantissa are left, so that costs within one bucket are
/// less than 13 % apart. With fewer buckets the heap leaves the cache, with more most are empty.
const FINE_BITS: u32 = 20;

/// Items in the order of their cost, ties by the lower item: a bucket for each range of costs, of which only the
/// lowest is a heap.
///
/// Costs that a simplification puts back are mostly above the one it took last, so nearly all go to the end of some
/// bucket, and the heap that is worked on stays in the cache. The order is that of one big heap.
pub(super) struct Queue {
    /// Costs within buckets up to `current`, and their items.
    near: BinaryHeap<Reverse<u64>>,
    current: usize,
    /// Costs above, by bucket, unsorted.
    far: Vec<Vec<Reverse<u64>>>,
}

impl Queue {
    pub(super) fn new() -> Self {
        let buckets = (f32::INFINITY.to_bits() >> FINE_BITS) as usize + 1;
        Self { near: BinaryHeap::new(), current: 0, far: vec![Vec::new(); buckets] }
    }

    /// Adds an item. Costs are ≥ 0 and may be infinite; one that is negative or not a number counts as infinite.
    pub(super) fn push(&mut self, cost: f32, item: u32) {
        let cost = if cost >= 0.0 { cost.abs() } else { f32::INFINITY };
        let bucket = (cost.to_bits() >> FINE_BITS) as usize;
        let key = Reverse(u64::from(cost.to_bits()) << 32 | u64::from(item));
        if bucket <= self.current { self.near.push(key) } else { self.far[bucket].push(key) }
    }

    /// Takes the item of the lowest cost.
    pub(super) fn pop(&mut self) -> Option<(f32, u32)> {
        while self.near.is_empty() {
            self.current = (self.current + 1..self.far.len()).find(|&b| !self.far[b].is_empty())?;
            self.near = BinaryHeap::from(std::mem::take(&mut self.far[self.current]));
        }
        self.near.pop().map(|Reverse(key)| (f32::from_bits((key >> 32) as u32), key as u32))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A push of a cost, or a pop.
    fn steps() -> impl Strategy<Value = Vec<Option<f32>>> {
        let cost = prop_oneof![0.0..1.0f32, 0.0..1e-30f32, Just(0.0), Just(f32::INFINITY), 1.0..1e30f32];
        prop::collection::vec(prop::option::weighted(0.6, cost), 0..200)
    }

    proptest! {
        #[test]
        fn pops_what_a_sorted_list_pops(steps in steps()) {
            let (mut queue, mut sorted) = (Queue::new(), Vec::<(f32, u32)>::new());
            for (item, step) in (0..).zip(steps) {
                if let Some(cost) = step {
                    queue.push(cost, item);
                    sorted.push((cost, item));
                    sorted.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
                } else {
                    prop_assert_eq!(queue.pop(), sorted.pop());
                }
            }
        }
    }

    #[test]
    fn what_is_no_cost_comes_last() {
        let mut queue = Queue::new();
        for (item, cost) in (0..).zip([f32::NAN, 2.0, -1.0, -0.0]) {
            queue.push(cost, item);
        }
        let items: Vec<u32> = std::iter::from_fn(|| queue.pop()).map(|(_, item)| item).collect();
        assert_eq!(items, [3, 1, 0, 2]);
    }
}
