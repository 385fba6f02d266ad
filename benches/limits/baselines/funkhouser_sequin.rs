//! T. Funkhouser and C. Séquin, "Adaptive Display Algorithm for Interactive Frame Rates During Visualization of
//! Complex Virtual Environments", 1993: incremental from the last frame's levels, with two heaps.
//!
//! Each iteration raises the object whose next finer position has the highest value (benefit ÷ cost of the
//! position itself, not of the step), then, while over the budget, lowers the one whose own position has the
//! lowest; it ends with the iteration that lowers what it has raised. It does not claim the textbook's answer,
//! and does not reach it.

use std::collections::BinaryHeap;

use super::Selection;
use super::classes::Classes;

#[derive(Default)]
pub struct FunkhouserSequin {
    raise: Vec<Offer>,
    lower: Vec<Offer>,
}

/// Ordered bits of a value, the object, and the position it is offered at: valid while it is still there.
type Offer = (u32, u32, u8);

/// Iterations per object after which the rule is stopped: values that do not fall with detail can make it go
/// round in a circle.
const MOST_ITERATIONS: usize = 20;

impl Selection for FunkhouserSequin {
    fn choose(&mut self, classes: &Classes<'_>, budget: u64, position: &mut [u8]) {
        let mut rule = Rule::start(classes, position, &mut self.raise, &mut self.lower);
        for _ in 0..MOST_ITERATIONS * classes.len() {
            let raised = rule.raise_best(position);
            let mut undone = raised.is_none();
            while rule.units > budget {
                let Some(lowered) = rule.lower_worst(position) else { break };
                undone |= raised == Some(lowered);
            }
            if undone {
                break;
            }
        }
        (self.raise, self.lower) = (rule.raise.into_vec(), rule.lower.into_vec());
    }
}

struct Rule<'a> {
    classes: &'a Classes<'a>,
    raise: BinaryHeap<Offer>,
    lower: BinaryHeap<Offer>,
    units: u64,
}

impl<'a> Rule<'a> {
    fn start(
        classes: &'a Classes<'a>,
        position: &[u8],
        raise: &mut Vec<Offer>,
        lower: &mut Vec<Offer>,
    ) -> Self {
        let (mut raise, mut lower) = (std::mem::take(raise), std::mem::take(lower));
        raise.clear();
        lower.clear();
        let mut units = 0;
        for (object, &at) in position.iter().enumerate() {
            let hull = classes.hull(object);
            units += u64::from(hull.units[usize::from(at)]);
            raise.extend((at < hull.last).then(|| raise_offer(classes, object, at)));
            lower.extend((at > 0).then(|| lower_offer(classes, object, at)));
        }
        Self { classes, raise: raise.into(), lower: lower.into(), units }
    }

    fn raise_best(&mut self, position: &mut [u8]) -> Option<u32> {
        let object = next(&mut self.raise, position)?;
        self.change(object, position, position[object as usize] + 1);
        Some(object)
    }

    fn lower_worst(&mut self, position: &mut [u8]) -> Option<u32> {
        let object = next(&mut self.lower, position)?;
        self.change(object, position, position[object as usize] - 1);
        Some(object)
    }

    fn change(&mut self, object: u32, position: &mut [u8], to: u8) {
        let (classes, object) = (self.classes, object as usize);
        let hull = classes.hull(object);
        self.units -= u64::from(hull.units[usize::from(position[object])]);
        self.units += u64::from(hull.units[usize::from(to)]);
        position[object] = to;
        self.raise.extend((to < hull.last).then(|| raise_offer(classes, object, to)));
        self.lower.extend((to > 0).then(|| lower_offer(classes, object, to)));
    }
}

/// The best offer that is still valid.
fn next(heap: &mut BinaryHeap<Offer>, position: &[u8]) -> Option<u32> {
    std::iter::from_fn(|| heap.pop()).find(|o| position[o.1 as usize] == o.2).map(|o| o.1)
}

fn raise_offer(classes: &Classes<'_>, object: usize, at: u8) -> Offer {
    (value(classes, object, at + 1), object as u32, at)
}

fn lower_offer(classes: &Classes<'_>, object: usize, at: u8) -> Offer {
    (!value(classes, object, at), object as u32, at)
}

/// Benefit ÷ cost of a position. Positive floats sort as their bits.
fn value(classes: &Classes<'_>, object: usize, at: u8) -> u32 {
    let (hull, at) = (classes.hull(object), usize::from(at));
    (classes.weight[object] * hull.accuracy[at] / hull.units[at] as f32).to_bits()
}
