//! The classes of a knapsack as the baselines see them: objects with a weight, and the shared hulls of their tables.

use crate::scene::{Detail, MOST_STEPS};

/// The upper hull of a table over (cost, accuracy), cheapest position first.
#[derive(Clone, Copy, Default)]
pub struct Hull {
    /// Accuracy per unit of cost of the step from each position; 0 at the last and beyond.
    pub slope: [f32; MOST_STEPS + 1],
    /// Costs in 1024ths of a microsecond.
    pub units: [u32; MOST_STEPS + 1],
    pub accuracy: [f32; MOST_STEPS + 1],
    pub level: [u8; MOST_STEPS + 1],
    /// The last position.
    pub last: u8,
}

impl Hull {
    /// Monotone chain over levels, which are given finest first and are cheaper and less accurate from one to the
    /// next.
    pub fn of(levels: &[Detail]) -> Self {
        let mut chain: Vec<usize> = Vec::new();
        for next in (0..levels.len()).rev() {
            while let [.., before, last] = chain[..]
                && slope(&levels[before], &levels[last]) <= slope(&levels[last], &levels[next])
            {
                chain.pop();
            }
            chain.push(next);
        }
        let mut hull = Self { last: (chain.len() - 1) as u8, ..Self::default() };
        for (position, &level) in chain.iter().enumerate() {
            hull.units[position] = levels[level].units();
            hull.accuracy[position] = levels[level].accuracy;
            hull.level[position] = level as u8;
        }
        for (position, ends) in chain.windows(2).enumerate() {
            hull.slope[position] = slope(&levels[ends[0]], &levels[ends[1]]) as f32;
        }
        hull
    }

    /// Cost of the step from a position.
    #[inline]
    pub fn step_units(&self, from: usize) -> u32 {
        self.units[from + 1] - self.units[from]
    }
}

fn slope(from: &Detail, to: &Detail) -> f64 {
    (f64::from(to.accuracy) - f64::from(from.accuracy)) / f64::from(to.units() - from.units())
}

/// One class per object.
#[derive(Clone, Copy)]
pub struct Classes<'a> {
    pub hulls: &'a [Hull],
    pub table: &'a [u16],
    pub weight: &'a [f32],
}

/// Cost and benefit of a choice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    pub units: u64,
    pub benefit: f64,
}

/// A step from one position of an object to the next, in 32 bits: they rise with the object, then the position.
#[derive(Clone, Copy)]
pub struct StepIndex(u32);

const POSITION_BITS: u32 = 3;

impl StepIndex {
    #[inline]
    pub fn new(object: usize, from: usize) -> Self {
        Self((object as u32) << POSITION_BITS | from as u32)
    }

    #[inline]
    pub fn object(self) -> usize {
        (self.0 >> POSITION_BITS) as usize
    }

    #[inline]
    pub fn from(self) -> usize {
        (self.0 & ((1 << POSITION_BITS) - 1)) as usize
    }
}

/// A step with its slope in 64 bits; keys ascend in the order in which the greedy takes steps.
#[inline]
pub fn key(slope: f32, step: StepIndex) -> u64 {
    u64::from(!slope.to_bits()) << 32 | u64::from(step.0)
}

/// The step of a key.
#[inline]
pub fn step_of(key: u64) -> StepIndex {
    StepIndex(key as u32)
}

impl Classes<'_> {
    pub fn len(&self) -> usize {
        self.table.len()
    }

    #[inline]
    pub fn hull(&self, object: usize) -> &Hull {
        &self.hulls[usize::from(self.table[object])]
    }

    /// Every object at its cheapest.
    pub fn least_units(&self) -> u64 {
        (0..self.len()).map(|i| u64::from(self.hull(i).units[0])).sum()
    }

    /// The keys of all steps, objects ascending. Without branches: all slots are written, and as many kept as
    /// there are steps.
    pub fn keys<'k>(&self, keys: &'k mut Vec<u64>) -> &'k mut [u64] {
        keys.resize((self.len() + 1) * (MOST_STEPS + 1), 0);
        let mut end = 0;
        for object in 0..self.len() {
            let (hull, weight) = (self.hull(object), self.weight[object]);
            let slots = &mut keys[end..end + MOST_STEPS];
            for (from, slot) in slots.iter_mut().enumerate() {
                *slot = key(weight * hull.slope[from], StepIndex::new(object, from));
            }
            end += usize::from(hull.last);
        }
        &mut keys[..end]
    }

    /// Cost of a key's step.
    #[inline]
    pub fn step_units(&self, key: u64) -> u64 {
        let step = step_of(key);
        u64::from(self.hull(step.object()).step_units(step.from()))
    }

    /// Takes steps in the order of ascending keys up to the first that does not fit.
    pub fn take(&self, sorted: &[u64], budget: u64, position: &mut [u8]) {
        let mut room = budget.saturating_sub(self.least_units());
        let cut = sorted.iter().find(|&&key| {
            let units = self.step_units(key);
            let fits = units <= room;
            room -= if fits { units } else { 0 };
            !fits
        });
        self.take_below(cut.copied().unwrap_or(u64::MAX), position);
    }

    /// Every object takes its steps below the cut, objects ascending, without branches.
    pub fn take_below(&self, cut: u64, position: &mut [u8]) {
        for (object, at) in position.iter_mut().enumerate() {
            let (hull, weight) = (self.hull(object), self.weight[object]);
            let is_taken = |from: usize| {
                let below = key(weight * hull.slope[from], StepIndex::new(object, from)) < cut;
                (from < usize::from(hull.last)) & below
            };
            *at = (0..MOST_STEPS).map(|from| u8::from(is_taken(from))).sum();
        }
    }

    pub fn totals(&self, position: &[u8]) -> Totals {
        let mut totals = Totals::default();
        for (object, &at) in position.iter().enumerate() {
            let hull = self.hull(object);
            totals.units += u64::from(hull.units[usize::from(at)]);
            totals.benefit += f64::from(self.weight[object]) * f64::from(hull.accuracy[usize::from(at)]);
        }
        totals
    }
}
