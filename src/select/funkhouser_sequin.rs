//! The incremental rule of 1993, as a baseline.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::{Frame, Selector};
use crate::frame::OptionsError;
use crate::frame::SelectReport;
use crate::knapsack::FixedSum;
use crate::scene::LevelRange;
use crate::table::Level;

/// The rule of T. Funkhouser and C. Séquin, "Adaptive Display Algorithm for Interactive Frame Rates During
/// Visualization of Complex Virtual Environments", 1993.
///
/// It starts from the levels of the last frame (the cheapest for what has come into view). Each iteration raises the
/// object with the highest value of its next finer level, then, while over the budget, lowers the object with the
/// lowest value of its current level; it ends with the iteration that raises and lowers the same object. Value is
/// benefit ÷ cost of the level itself, not of the step.
///
/// It is kept for comparison: it can end far from the optimum (one object in 346.86 units of budget at 35.17 of
/// 618.90), it promises no share of it, and it has no certificate.
#[derive(Clone, Debug)]
pub struct FunkhouserSequin {
    hysteresis: f32,
    raise: BinaryHeap<Entry>,
    lower: BinaryHeap<Entry>,
}

impl Default for FunkhouserSequin {
    fn default() -> Self {
        Self { hysteresis: 0.1, raise: BinaryHeap::new(), lower: BinaryHeap::new() }
    }
}

impl FunkhouserSequin {
    /// The rule with the paper's hysteresis factor on benefit: a level counts 1 / (1 + hysteresis · d), d its distance
    /// in levels from that of the last frame. 0 is off.
    ///
    /// # Errors
    /// A hysteresis that is negative or not finite.
    pub fn new(hysteresis: f32) -> Result<Self, OptionsError> {
        let valid = hysteresis.is_finite() && hysteresis >= 0.0;
        OptionsError::unless(valid, "hysteresis", "must be finite and not negative")?;
        Ok(Self { hysteresis, ..Self::default() })
    }

    /// Last frame's levels, and what they cost in a sum that does not depend on the order of slots.
    fn start(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> FixedSum {
        self.raise.clear();
        self.lower.clear();
        let mut cost = FixedSum::default();
        for (i, level) in levels.iter_mut().enumerate() {
            let kept = frame.candidates.previous(i).filter(|&l| holds(frame.candidates.allowed[i], l));
            *level = kept.unwrap_or_else(|| frame.minimum(i));
            cost.add(frame.cost_us(i, *level));
            self.offer(frame, i, *level);
        }
        cost
    }

    /// Offers an object, which is at `level`, for raising and for lowering.
    fn offer(&mut self, frame: &Frame<'_>, i: usize, level: Level) {
        let key = frame.key(i);
        if let Some(finer) = finer(frame, i, level) {
            let value = self.value(frame, i, finer);
            self.raise.push(Entry { priority: value, key, class: i, level });
        }
        if coarser(frame, i, level).is_some() {
            let value = self.value(frame, i, level);
            self.lower.push(Entry { priority: -value, key, class: i, level });
        }
    }

    /// Benefit per cost of a level; infinite for a free one.
    fn value(&self, frame: &Frame<'_>, i: usize, level: Level) -> f64 {
        let distance = frame
            .candidates
            .previous(i)
            .map_or(0, |previous| position(frame, i, previous).abs_diff(position(frame, i, level)));
        let factor = 1.0 / (1.0 + f64::from(self.hysteresis) * distance as f64);
        let (benefit, cost) = (factor * frame.benefit(i, level), frame.cost_us(i, level));
        if cost > 0.0 { benefit / cost } else { f64::INFINITY }
    }

    fn change(&mut self, frame: &Frame<'_>, i: usize, levels: &mut [Level], to: Level, cost: &mut FixedSum) {
        cost.add(-frame.cost_us(i, levels[i]));
        cost.add(frame.cost_us(i, to));
        levels[i] = to;
        self.offer(frame, i, to);
    }
}

/// An offer, valid while the object still is at `level`.
#[derive(Clone, Copy, Debug)]
struct Entry {
    priority: f64,
    key: u128,
    class: usize,
    level: Level,
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        self.priority
            .total_cmp(&other.priority)
            .then(other.key.cmp(&self.key))
            .then(other.level.cmp(&self.level))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}

/// The best offer that is still valid.
fn next(heap: &mut BinaryHeap<Entry>, levels: &[Level]) -> Option<usize> {
    std::iter::from_fn(|| heap.pop()).find(|e| levels[e.class] == e.level).map(|e| e.class)
}

/// Position of a level on the way from finest to not drawn.
fn position(frame: &Frame<'_>, i: usize, level: Level) -> usize {
    level.index().min(frame.rates.levels(frame.candidates.table[i]).len())
}

fn holds(allowed: LevelRange, level: Level) -> bool {
    allowed.finest <= level && level <= allowed.coarsest
}

fn finer(frame: &Frame<'_>, i: usize, level: Level) -> Option<Level> {
    let finest = frame.candidates.allowed[i].finest;
    let before = position(frame, i, level).checked_sub(1)?;
    Some(Level(before as u8)).filter(|&l| l >= finest)
}

fn coarser(frame: &Frame<'_>, i: usize, level: Level) -> Option<Level> {
    let allowed = frame.candidates.allowed[i];
    let after = position(frame, i, level) + 1;
    if level >= allowed.coarsest {
        None
    } else if after == frame.rates.levels(frame.candidates.table[i]).len() {
        Some(Level::NOT_DRAWN).filter(|_| !allowed.coarsest.is_drawn())
    } else {
        Some(Level(after as u8))
    }
}

/// Iterations per level of all objects after which the rule is stopped: values that do not fall with detail can make it
/// raise and lower in a circle.
const ROUNDS_PER_LEVEL: usize = 4;

impl Selector for FunkhouserSequin {
    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport {
        let budget = frame.budget.select_us;
        let mut cost = self.start(frame, levels);
        let tables = frame.candidates.table.iter();
        let rounds = tables.map(|&t| frame.rates.levels(t).len()).sum::<usize>() * ROUNDS_PER_LEVEL;
        let mut steps = 0;
        for _ in 0..rounds {
            let raised = next(&mut self.raise, levels);
            if let Some(i) = raised {
                let to = finer(frame, i, levels[i]).unwrap_or(levels[i]);
                self.change(frame, i, levels, to, &mut cost);
                steps += 1;
            }
            let mut undone = false;
            while cost.value() > budget {
                let Some(i) = next(&mut self.lower, levels) else { break };
                let to = coarser(frame, i, levels[i]).unwrap_or(levels[i]);
                self.change(frame, i, levels, to, &mut cost);
                undone |= raised == Some(i);
                steps += 1;
            }
            if undone || raised.is_none() {
                break;
            }
        }
        SelectReport { steps, ..frame.report(levels) }
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(self.clone())
    }
}
