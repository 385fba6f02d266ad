//! A priority queue for keys that mostly grow.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Bits of a cost that its bucket leaves out: three bits of the mantissa are left, so that costs within one bucket are
/// less than 13 % apart. With fewer buckets sorting leaves the cache, with more there is little to look ahead to.
const FINE_BITS: u32 = 20;

/// Items in the order of their cost, ties by the lower item: a bucket for each range of costs, of which only the
/// lowest is sorted.
///
/// Costs that a simplification puts back are mostly above the one it took last, so nearly all go to the end of some
/// bucket, and what comes next is known in advance. The order is that of one big heap.
pub(super) struct Queue {
    /// The bucket that items are taken from: the costs and items that it had when its turn came, from the last to the
    /// first.
    current: Vec<Key>,
    /// Which bucket that is.
    turn: usize,
    /// Costs and items that came too late for their buckets.
    late: BinaryHeap<Key>,
    /// Costs and items of the buckets to come, unsorted.
    far: Vec<Vec<Key>>,
}

/// The bits of a cost, then the item; the lowest is the largest key.
type Key = Reverse<u64>;

impl Queue {
    pub(super) fn new() -> Self {
        let buckets = (f32::INFINITY.to_bits() >> FINE_BITS) as usize + 1;
        Self { current: Vec::new(), turn: 0, late: BinaryHeap::new(), far: vec![Vec::new(); buckets] }
    }

    /// Adds an item. Costs are ≥ 0 and may be infinite; one that is negative or not a number counts as infinite.
    pub(super) fn push(&mut self, cost: f32, item: u32) {
        let cost = if cost >= 0.0 { cost.abs() } else { f32::INFINITY };
        let bucket = (cost.to_bits() >> FINE_BITS) as usize;
        let key = Reverse(u64::from(cost.to_bits()) << 32 | u64::from(item));
        if bucket <= self.turn { self.late.push(key) } else { self.far[bucket].push(key) }
    }

    /// Takes the item of the lowest cost.
    pub(super) fn pop(&mut self) -> Option<(f32, u32)> {
        if self.current.is_empty() && self.late.is_empty() {
            self.turn = (self.turn + 1..self.far.len()).find(|&b| !self.far[b].is_empty())?;
            self.current = std::mem::take(&mut self.far[self.turn]);
            self.current.sort_unstable();
        }
        let is_late = self.late.peek() > self.current.last();
        let key = if is_late { self.late.pop() } else { self.current.pop() };
        key.map(|Reverse(key)| (f32::from_bits((key >> 32) as u32), key as u32))
    }

    /// The items so many places ahead as far as is known: some may come in before them, and where there are not so
    /// many in a bucket it is the last of it.
    #[inline]
    pub(super) fn ahead<const N: usize>(&self, places: [usize; N]) -> Option<[u32; N]> {
        let last = self.current.len().checked_sub(1)?;
        Some(places.map(|place| self.current[last.saturating_sub(place)].0 as u32))
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
    fn what_is_ahead_is_what_comes() {
        let mut queue = Queue::new();
        (0..5).for_each(|item| queue.push(1.0, item));
        assert_eq!(queue.ahead([0]), None);
        for item in 0..4 {
            assert_eq!(queue.pop(), Some((1.0, item)));
            assert_eq!(queue.ahead([0, 1]), Some([item + 1, (item + 2).min(4)]));
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
