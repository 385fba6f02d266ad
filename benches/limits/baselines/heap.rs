//! A binary heap with the next step of every object: no step is looked at that its object does not reach.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::collections::binary_heap::PeekMut;

use super::Selection;
use super::classes::{Classes, StepIndex, key, step_of};

#[derive(Default)]
pub struct Heap {
    next: Vec<Reverse<u64>>,
}

impl Selection for Heap {
    fn choose(&mut self, classes: &Classes<'_>, budget: u64, position: &mut [u8]) {
        let key_at = |object: usize, from: usize| {
            let slope = classes.weight[object] * classes.hull(object).slope[from];
            Reverse(key(slope, StepIndex::new(object, from)))
        };
        let mut next = std::mem::take(&mut self.next);
        next.clear();
        next.extend((0..classes.len()).filter(|&i| classes.hull(i).last > 0).map(|i| key_at(i, 0)));
        let mut next = BinaryHeap::from(next);
        let mut room = budget.saturating_sub(classes.least_units());
        position.fill(0);
        while let Some(mut top) = next.peek_mut() {
            let (units, object) = (classes.step_units(top.0), step_of(top.0).object());
            if units > room {
                break;
            }
            room -= units;
            position[object] += 1;
            if position[object] < classes.hull(object).last {
                *top = key_at(object, usize::from(position[object]));
            } else {
                PeekMut::pop(top);
            }
        }
        self.next = next.into_vec();
    }
}
