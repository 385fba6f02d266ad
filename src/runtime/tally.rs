//! What is shown, counted per level, and what that is expected to take.

use crate::frame::Candidates;
use crate::knapsack::FixedSum;
use crate::rate::{CostModel, DRIVERS, Drivers, Stages, TableRates, cost_us, drivers_of};
use crate::table::{Level, LodTable};
use crate::transition::{Shown, TransitionKind};

/// Counts of one frame. Sums are of integers, so that the order of slots does not matter.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    /// Per level of every table, how often it is drawn, cost multipliers included, in units of 2⁻²⁰.
    usage: Vec<i64>,
    /// Projected area, in units of 2⁻¹² px².
    area: i64,
    /// Time by the model, where it is not linear in the counts.
    time_us: FixedSum,
}

const USAGE_UNIT: f64 = (1 << 20) as f64;
const AREA_UNIT: f64 = (1 << 12) as f64;

impl Tally {
    /// Forgets all counts; `levels` is how many levels all tables have.
    pub fn clear(&mut self, levels: usize) {
        self.usage.clear();
        self.usage.resize(levels, 0);
        self.area = 0;
        self.time_us = FixedSum::default();
    }

    /// Counts what is shown of candidate `i`.
    pub fn add(
        &mut self,
        model: &CostModel,
        rates: &TableRates,
        candidates: &Candidates,
        i: usize,
        shown: Shown,
        kind: TransitionKind,
    ) {
        if !shown.is_in_flight() {
            return self.add_level(model, rates, candidates, i, shown.level);
        }
        match kind {
            TransitionKind::Geomorph => {
                self.add_level(model, rates, candidates, i, shown.level.min(shown.from));
            }
            _ => {
                self.add_level(model, rates, candidates, i, shown.level);
                self.add_level(model, rates, candidates, i, shown.from);
            }
        }
    }

    /// Counts one level of candidate `i`.
    pub fn add_level(
        &mut self,
        model: &CostModel,
        rates: &TableRates,
        c: &Candidates,
        i: usize,
        level: Level,
    ) {
        if level.is_drawn() {
            let count = &mut self.usage[rates.index(c.table[i], level)];
            *count = count.saturating_add((f64::from(c.cost_scale[i]) * USAGE_UNIT) as i64);
            self.area = self.area.saturating_add((f64::from(c.area_px2[i]) * AREA_UNIT) as i64);
            if model.stages == Stages::Max {
                self.time_us.add(cost_us(model, rates, c, i, level));
            }
        }
    }

    /// Counts of draw calls, vertices, triangles and pixels, and the time that the model expects of them.
    pub fn sum(&self, model: &CostModel, tables: &[LodTable]) -> (Drivers, f64) {
        let mut drivers = [0.0; DRIVERS];
        for (level, &count) in tables.iter().flat_map(LodTable::levels).zip(&self.usage) {
            let times = count as f64 / USAGE_UNIT;
            drivers.iter_mut().zip(drivers_of(level)).for_each(|(sum, d)| *sum += d * times);
        }
        drivers[DRIVERS - 1] = self.area as f64 / AREA_UNIT;
        let linear_us = drivers.iter().zip(model.coefficients()).map(|(d, c)| d * c).sum();
        (drivers, if model.stages == Stages::Max { self.time_us.value() } else { linear_us })
    }
}
