//! One pass over the columns for the policies that decide about each object by itself.
//!
//! A plain object stays at its level while its size lies in the interval of that level. Who stays is told without
//! branches and counted by level; only the others are decided one by one. The sums are those of [`Frame::report`], of
//! counts.

use std::ops::Range;

use super::Frame;
use crate::frame::{Candidate, Candidates, PixelSum, SelectReport};
use crate::knapsack::{Columns, FixedSum, Hold, Units, opened, sift};
use crate::rate::{LevelRate, TableRates, cost_us};
use crate::table::Level;

/// Sizes from the first up to the second (exclusive) at which an object stays at a level.
pub(super) type Interval = [f32; 2];

/// Nobody stays: they are decided one by one.
pub(super) const NEVER: Interval = [f32::INFINITY, 0.0];

/// The pass, and what the levels chosen in it come to.
#[derive(Clone, Debug, Default)]
pub(super) struct Sweep {
    intervals: Vec<Interval>,
    /// Per level of all tables, and an open one.
    holds: Vec<Hold>,
    /// A bit per candidate: it is decided one by one.
    open: Vec<u16>,
    /// How many candidates with a place are at each level of all tables.
    census: Vec<u32>,
    odd: Odd,
    benefit: f64,
}

/// Sums over the candidates without a place.
#[derive(Clone, Copy, Debug, Default)]
struct Odd {
    cost_us: FixedSum,
    least_us: FixedSum,
    area: PixelSum,
}

impl Sweep {
    /// Starts a frame: everybody is where they were.
    pub fn begin(&mut self, frame: &Frame<'_>) {
        self.census.clone_from(&frame.candidates.census);
        self.census.resize(frame.rates.len(), 0);
        self.odd = Odd::default();
        self.benefit = 0.0;
    }

    /// Sets who stays. `intervals` appends those of the levels of a table, finest first.
    pub fn set_holds(&mut self, rates: &TableRates, mut intervals: impl FnMut(u16, &mut Vec<Interval>)) {
        self.intervals.clear();
        all_tables(rates).for_each(|table| intervals(table, &mut self.intervals));
        let levels = all_tables(rates).flat_map(|table| rates.levels(table));
        let hold = |(level, &[keep, rest]): (&LevelRate, &Interval)| Hold::within(keep, rest, level.accuracy);
        self.holds.clear();
        self.holds.extend(levels.zip(&self.intervals).map(hold));
        self.holds.push(Hold::OPEN);
    }

    /// Chooses the levels of the candidates of `range`, by `rule` for those that may not stay. `levels` is of all
    /// candidates and has what they hold.
    pub fn choose(
        &mut self,
        frame: &Frame<'_>,
        range: Range<usize>,
        levels: &mut [Level],
        mut rule: impl FnMut(usize, &Candidate) -> Level,
    ) {
        let mut worth = self.find_open(frame, range.clone());
        let open = std::mem::take(&mut self.open);
        for i in opened(&open).map(|at| range.start + at) {
            let candidate = frame.candidate(i);
            levels[i] = rule(i, &candidate);
            worth.value += worth.of(candidate.weight, frame.rates.accuracy(candidate.table, levels[i]));
            self.count(frame, i, &candidate, levels[i]);
        }
        self.open = open;
        self.benefit += worth.benefit();
    }

    /// Finds who may not stay, counted from the start of `range`, and returns the benefit of the others.
    fn find_open(&mut self, frame: &Frame<'_>, range: Range<usize>) -> Units {
        let &Candidates { ref size_px, ref weight, heaviest, ref place, .. } = frame.candidates;
        let [size, weight] = [size_px, weight].map(|column| &column[range.clone()]);
        let columns = Columns { size, weight, heaviest, place: &place[range], holds: &self.holds };
        sift(columns, [1.0; 2], frame.threads, &mut self.open)
    }

    /// Counts a candidate at the level that has been chosen for it one by one.
    fn count(&mut self, frame: &Frame<'_>, i: usize, candidate: &Candidate, level: Level) {
        let Some(held) = self.census.get_mut(frame.candidates.place[i] as usize) else {
            return self.odd.add(frame, candidate, level);
        };
        *held -= 1;
        self.census[frame.rates.index(candidate.table, level)] += 1;
    }

    /// Whether each level, given with its table, at which there is a candidate with a place is such a one.
    pub fn every(&self, rates: &TableRates, mut such: impl FnMut(u16, Level) -> bool) -> bool {
        let mut counts = self.census.iter();
        all_levels(rates).all(|(table, level)| counts.next() == Some(&0) || such(table, level))
    }

    /// [`Frame::report`] of the levels that have been chosen.
    pub fn report(&self, frame: &Frame<'_>) -> SelectReport {
        let Odd { cost_us: mut cost, least_us: mut least, area: odd } = self.odd;
        for ((table, level), &count) in all_levels(frame.rates).zip(&self.census).filter(|(_, c)| **c > 0) {
            let cheapest = frame.rates.minimum(table, frame.rates.whole(table));
            cost.add(f64::from(count) * frame.rates.geometry_us(table, level));
            least.add(f64::from(count) * frame.rates.geometry_us(table, cheapest));
        }
        let pixels_us = frame.model.pixel_us * (frame.candidates.pixels.px2() - odd.px2());
        SelectReport {
            cost_us: cost.value() + pixels_us,
            benefit: self.benefit,
            infeasible_us: (least.value() + pixels_us - frame.budget.select_us).max(0.0),
            ..SelectReport::default()
        }
    }
}

impl Odd {
    fn add(&mut self, frame: &Frame<'_>, candidate: &Candidate, level: Level) {
        let price_us = |level| cost_us(frame.model, frame.rates, candidate, level);
        self.cost_us.add(price_us(level));
        self.least_us.add(price_us(frame.minimum_of(candidate)));
        self.area.add(PixelSum::rounded(candidate.area_px2));
    }
}

fn all_tables(rates: &TableRates) -> impl Iterator<Item = u16> + use<> {
    (0..rates.tables()).map(|table| table as u16)
}

/// The levels of all tables in the order of places.
fn all_levels(rates: &TableRates) -> impl Iterator<Item = (u16, Level)> + '_ {
    all_tables(rates).flat_map(|t| (0..=rates.coarsest(t).0).map(move |level| (t, Level(level))))
}
