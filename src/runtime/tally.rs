//! What is shown, counted per level, and what that is expected to take.

use crate::frame::{Candidates, NO_PLACE, PixelSum};
use crate::knapsack::FixedSum;
use crate::rate::{CostModel, DRIVERS, Drivers, Stages, cost_us, drivers_of};
use crate::select::Frame;
use crate::table::{Level, LodTable};
use crate::transition::{Shown, TransitionKind};

/// Counts of one frame. Sums are of integers, or of numbers that add up exactly, so that the order of slots does not
/// matter.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    kind: TransitionKind,
    stages: Stages,
    /// Per level of every table, how often it is drawn, cost multipliers included, in units of 2⁻²⁰.
    usage: Vec<i64>,
    /// Projected area.
    area: PixelSum,
    /// Time by the model, where it is not linear in the counts.
    time_us: FixedSum,
}

const USAGE_UNIT: f64 = (1 << 20) as f64;

impl Tally {
    /// Starts with the census: every candidate with a place, at that place, and the area of all candidates, drawn once.
    /// Where stages do not add up no candidate has a place.
    pub fn begin(&mut self, frame: &Frame<'_>, kind: TransitionKind) {
        (self.kind, self.stages) = (kind, frame.model.stages);
        self.time_us = FixedSum::default();
        self.area = frame.candidates.pixels;
        self.usage.clear();
        self.usage.extend(frame.candidates.census.iter().map(|&count| i64::from(count) << 20));
    }

    /// Counts what is shown of candidate `i` instead of what was counted at its place.
    pub fn recount(&mut self, frame: &Frame<'_>, i: usize, shown: Shown) {
        self.usage[frame.candidates.place[i] as usize] -= 1 << 20;
        self.add(frame, i, shown);
    }

    /// Counts who was deferred and is none of the `news`, which are ascending, at the level it holds instead of the one
    /// that was chosen for it.
    pub fn recount_deferred(&mut self, frame: &Frame<'_>, news: &[usize], levels: &[Level]) {
        let Candidates { place, deferred, .. } = frame.candidates;
        let mut news = news.iter().peekable();
        for i in deferred.iter().map(|d| d.candidate as usize).filter(|&i| place[i] != NO_PLACE) {
            while news.next_if(|&&n| n < i).is_some() {}
            if news.peek() != Some(&&i) {
                let chosen = frame.rates.level_at(place[i]);
                let held = place[i] as usize + levels[i].index() - chosen.index();
                self.usage[place[i] as usize] -= 1 << 20;
                self.usage[held] += 1 << 20;
            }
        }
    }

    /// Counts what is shown of candidate `i`. Its area has been counted once.
    pub fn add(&mut self, frame: &Frame<'_>, i: usize, shown: Shown) {
        let (first, second) = match (shown.is_in_flight(), self.kind) {
            (false, _) => (shown.level, None),
            (true, TransitionKind::Geomorph) => (shown.morph().level, None),
            (true, _) => (shown.level, Some(shown.from)),
        };
        let candidate = frame.candidate(i);
        let mut drawn = 0.0;
        for level in [Some(first), second].into_iter().flatten().filter(|level| level.is_drawn()) {
            let count = &mut self.usage[frame.rates.index(candidate.table, level)];
            *count = count.saturating_add((f64::from(candidate.cost_scale) * USAGE_UNIT) as i64);
            drawn += 1.0;
            if self.stages == Stages::Max {
                self.time_us.add(cost_us(frame.model, frame.rates, &candidate, level));
            }
        }
        self.area.add((drawn - 1.0) * PixelSum::rounded(candidate.area_px2));
    }

    /// Counts of draw calls, vertices, triangles and pixels, and the time that the model expects of them.
    pub fn sum(&self, model: &CostModel, tables: &[LodTable]) -> (Drivers, f64) {
        let mut drivers = [0.0; DRIVERS];
        for (level, &count) in tables.iter().flat_map(LodTable::levels).zip(&self.usage) {
            let times = count as f64 / USAGE_UNIT;
            drivers.iter_mut().zip(drivers_of(level)).for_each(|(sum, d)| *sum += d * times);
        }
        drivers[DRIVERS - 1] = self.area.px2();
        let linear_us = drivers.iter().zip(model.coefficients()).map(|(d, c)| d * c).sum();
        (drivers, if model.stages == Stages::Max { self.time_us.value() } else { linear_us })
    }
}
