//! Weighted quickselect: the step that the budget cuts is looked for as a median is, without sorting; every other
//! step is then compared with it. O(steps) on average.

use super::Selection;
use super::classes::Classes;

/// A step's key and its cost.
#[derive(Clone, Copy, Default)]
struct Priced {
    key: u64,
    units: u32,
}

#[derive(Default)]
pub struct Quickselect {
    keys: Vec<u64>,
    steps: Vec<Priced>,
    spare: Vec<Priced>,
}

/// Fewer steps than this are sorted.
const FEW: usize = 256;
/// Steps that the pivot is the median of, spread over all.
const SAMPLE: usize = 63;

impl Selection for Quickselect {
    fn choose(&mut self, classes: &Classes<'_>, budget: u64, position: &mut [u8]) {
        let keys = classes.keys(&mut self.keys);
        let price = |&key: &u64| Priced { key, units: classes.step_units(key) as u32 };
        self.steps.clear();
        self.steps.extend(keys.iter().map(price));
        self.spare.resize(self.steps.len().max(self.spare.len()), Priced::default());
        let room = budget.saturating_sub(classes.least_units());
        let cut = critical(&mut self.steps, &mut self.spare, room);
        classes.take_below(cut, position);
    }
}

/// The key of the first step, in ascending order, that does not fit into `room`; the greatest key when all fit.
fn critical<'a>(mut steps: &'a mut [Priced], mut spare: &'a mut [Priced], mut room: u64) -> u64 {
    while steps.len() > FEW {
        let (len, pivot) = (steps.len(), pivot(steps));
        let (below, units) = partition(steps, &mut spare[..len], pivot);
        std::mem::swap(&mut steps, &mut spare);
        if units > room {
            steps = &mut steps[..below];
        } else {
            room -= units;
            steps = &mut steps[below..len];
        }
    }
    steps.sort_unstable_by_key(|s| s.key);
    for step in steps {
        if u64::from(step.units) > room {
            return step.key;
        }
        room -= u64::from(step.units);
    }
    u64::MAX
}

fn pivot(steps: &[Priced]) -> u64 {
    let mut sample = [0; SAMPLE];
    let stride = steps.len() / SAMPLE;
    sample.iter_mut().enumerate().for_each(|(i, key)| *key = steps[i * stride + stride / 2].key);
    *sample.select_nth_unstable(SAMPLE / 2).1
}

/// Moves steps up to the pivot to the front of `to` and the others to its back, without branches. Returns how
/// many are in front and what they cost.
fn partition(from: &[Priced], to: &mut [Priced], pivot: u64) -> (usize, u64) {
    let (mut front, mut back, mut units) = (0, to.len() - 1, 0);
    for &step in from {
        let is_below = step.key <= pivot;
        // To both ends; what is wrong at one of them is overwritten later.
        to[front] = step;
        to[back] = step;
        front += usize::from(is_below);
        back = back.wrapping_sub(usize::from(!is_below));
        units += u64::from(step.units) * u64::from(is_below);
    }
    (front, units)
}
