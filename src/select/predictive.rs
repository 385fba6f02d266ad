//! The predictive policy: the multiple-choice knapsack under the budget of this frame.

use super::menu::{FrameMenus, MenuColumns, OwnCandidates, Pricing, whole_ticks};
use super::steadiness::{Accounts, Held, Optimum, Steadiness};
use super::{Frame, Needs, Selector};
use crate::frame::{Candidate, Candidates, Cause, Certificate, Deferral, Deferred};
use crate::frame::{NO_PLACE, OptionsError, PixelSum, SelectReport};
use crate::knapsack::{Crowd, Menus, OddClass, Outcome, ProfileItem, SharedClass, SharedKnapsack};
use crate::rate::{Stages, TableRates};
use crate::scene::{BLOCK, LevelRange};
use crate::table::Level;

/// Options of [`Predictive`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictiveOptions {
    /// Shows the optimum only where and when that is worth switching. Then the optimum is one without prices and dead
    /// band, and the options below have no effect.
    pub steadiness: Option<Steadiness>,
    /// Price of a switch: a better level is taken when it is worth 1/(1 − hysteresis) of the going rate, and given up
    /// when it is worth less than 1/(1 + hysteresis) of it. In 0…1, exclusive. Higher switches less and spends less
    /// well.
    pub hysteresis: f32,
    /// For so long after a switch the price is `dwell` instead.
    pub dwell_ms: u32,
    /// Price of a switch soon after another; not below `hysteresis`. The budget still goes first.
    pub dwell: f32,
    /// Dead band of the budget, as a fraction of it: detail is added only while this much is left over, and kept until
    /// nothing is. In 0…1, exclusive. Without it a budget that is all spent moves detail at every breath of the camera.
    pub ease: f64,
}

impl Default for PredictiveOptions {
    fn default() -> Self {
        Self {
            steadiness: Some(Steadiness::default()),
            hysteresis: 0.2,
            dwell_ms: 500,
            dwell: 0.7,
            ease: 0.01,
        }
    }
}

impl PredictiveOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the option that is out of its range.
    pub fn check(&self) -> Result<(), OptionsError> {
        self.steadiness.map_or(Ok(()), |steadiness| steadiness.check())?;
        let price = |x: f32| (0.0..1.0).contains(&x);
        OptionsError::unless(price(self.hysteresis), "hysteresis", "must be at least 0 and below 1")?;
        let dwell = price(self.dwell) && self.dwell >= self.hysteresis;
        OptionsError::unless(dwell, "dwell", "must be at least the hysteresis and below 1")?;
        OptionsError::unless((0.0..1.0).contains(&self.ease), "ease", "must be at least 0 and below 1")
    }

    fn dead_band(&self) -> f64 {
        self.steadiness.map_or(self.ease, |steadiness| steadiness.spare)
    }

    fn price(&self, previous: Option<Level>, age_ms: impl Fn() -> u32) -> f32 {
        match previous {
            _ if self.steadiness.is_some() => 0.0,
            None => 0.0,
            Some(_) if self.dwell > self.hysteresis && age_ms() < self.dwell_ms => self.dwell,
            Some(_) => self.hysteresis,
        }
    }
}

/// Maximises benefit under the budget, with a certificate: after Funkhouser and Séquin 1993 in what it maximises, not
/// in how. What keeps levels from flickering, accounts of what objects are owed ([`Steadiness`]) or prices of switching
/// inside the objective, never breaks the budget.
#[derive(Clone, Debug, Default)]
pub struct Predictive {
    options: PredictiveOptions,
    knapsack: SharedKnapsack,
    hulls: Hulls,
    /// Candidates whose class is not simply that of a level of their table, and those that share no hull.
    odd: Vec<OddClass>,
    own: OwnCandidates,
    accounts: Accounts,
    /// Candidates that are not held at the optimum, and a bit for each that is owed it.
    deferred: Vec<Deferral>,
    owed: Vec<u64>,
    /// λ of the last frame in px² per µs.
    lambda: f64,
    /// See [`FALL`].
    fall: f64,
}

/// The class of a candidate that has just come into view and asks for nothing special, where that can be told without
/// its details.
fn plain_newcomer(frame: &Frame<'_>, i: usize) -> Option<SharedClass> {
    let candidates = frame.candidates;
    let slot = candidates.slot_of(i) as usize;
    let (block, lane) = (slot / BLOCK, slot % BLOCK);
    let block = &frame.objects.blocks()[block];
    let plain =
        !candidates.is_detailed() && candidates.previous(i).is_none() && block.special & (1 << lane) == 0;
    let (profile, weight) = (u32::from(block.table[lane]), candidates.weight[i]);
    plain.then_some(SharedClass { profile, weight, scale: 1.0, stay: 0.0, current: 0 })
}

/// Whether what a level costs depends on the candidate in more than a factor: where the cost of pixels depends on the
/// level, the table's hull does not hold.
fn has_own_hull(frame: &Frame<'_>, candidate: &Candidate) -> bool {
    frame.model.stages == Stages::Max || !candidate.allowed.coarsest.is_drawn()
}

impl Predictive {
    /// The policy with these options.
    ///
    /// # Errors
    /// An option that is out of its range.
    pub fn new(options: PredictiveOptions) -> Result<Self, OptionsError> {
        options.check()?;
        Ok(Self { options, ..Self::default() })
    }

    /// Makes the classes of the candidates without a place: those that have just come into view, and those whose levels
    /// are narrowed, may be skipped, or cost more than their table says. Returns the ticks that are spent whatever is
    /// chosen.
    fn fill_odd(&mut self, frame: &Frame<'_>) -> u64 {
        let mut pixels = frame.candidates.pixels;
        self.odd.clear();
        self.own.clear();
        for i in frame.candidates.unplaced() {
            if let Some(class) = plain_newcomer(frame, i) {
                self.odd.push(OddClass { at: i as u32, class });
                continue;
            }
            let candidate = frame.candidate(i);
            if has_own_hull(frame, &candidate) {
                pixels.add(-PixelSum::rounded(candidate.area_px2));
                self.push_own(frame, i, &candidate);
            } else {
                self.push_odd(frame, i, &candidate);
            }
        }
        ceil_ticks(frame.model.pixel_us * self.hulls.ticks_per_us * pixels.px2())
    }

    fn push_own(&mut self, frame: &Frame<'_>, i: usize, candidate: &Candidate) {
        let previous = frame.candidates.previous(i);
        let stay = self.options.price(previous, || frame.age_ms(i));
        self.own.push(i, candidate, previous, stay, &self.hulls.pricing(frame));
    }

    fn push_odd(&mut self, frame: &Frame<'_>, i: usize, candidate: &Candidate) {
        let previous = frame.candidates.previous(i);
        let profile = self.hulls.shared(candidate, frame.rates, &mut self.knapsack);
        let current = previous.map_or(0, |level| self.knapsack.profiles.position_of(profile, level.0));
        let stay = self.options.price(previous, || frame.age_ms(i));
        let (weight, scale) = (candidate.weight, candidate.cost_scale);
        let class = SharedClass { profile, weight, scale, stay, current };
        self.odd.push(OddClass { at: i as u32, class });
    }

    /// The optimum up to `budget` in `levels`, the dead band being above `ease`. Under steadiness `levels` are led
    /// there instead, and the outcome has their cost and benefit.
    fn solve(&mut self, frame: &Frame<'_>, budget: u64, ease: u64, levels: &mut [Level]) -> Outcome {
        let &Candidates { ref weight, heaviest, ref place, ref census, .. } = frame.candidates;
        let stay = |i: usize| self.options.price(frame.candidates.previous(i), || frame.age_ms(i));
        let own = FrameMenus { own: &self.own, pricing: self.hulls.pricing(frame) };
        let (odd, threads) = (&self.odd, frame.threads);
        let crowd = Crowd { weight, heaviest, place, census, odd, own, stay, threads };
        let Some(steadiness) = &self.options.steadiness else {
            let outcome = self.knapsack.solve_crowd(&crowd, budget, ease, |i| frame.key(i));
            self.knapsack.changed().for_each(|(i, item)| levels[i] = Level(item));
            return outcome;
        };
        let outcome = self.knapsack.solve_crowd(&crowd, budget, budget, |i| frame.key(i));
        self.accounts.make_room(levels.len());
        open_accounts(&mut self.accounts, &self.knapsack, &crowd, frame, levels);
        let Outcome { lambda, cost, benefit, minimum_benefit, .. } = outcome;
        let (gain, objects) = (benefit - minimum_benefit, levels.len());
        let optimum = Optimum { gain, objects, lambda, cost, budget, enough: ease };
        let cost = self.accounts.settle(steadiness, &optimum, |candidate| frame.key(candidate as usize));
        self.accounts.settled.iter().for_each(|&(i, level)| levels[i as usize] = level);
        self.deferred.clear();
        self.deferred.extend(self.accounts.deferrals());
        self.owed.clear();
        self.owed.resize(levels.len().div_ceil(64), 0);
        for debt in &self.accounts.debts {
            self.owed[debt.candidate as usize / 64] |= 1 << (debt.candidate % 64);
        }
        Outcome { cost, benefit: self.accounts.benefit(benefit), ..outcome }
    }

    fn report(&self, frame: &Frame<'_>, outcome: &Outcome, fixed: u64, over: u64) -> SelectReport {
        let us_per_tick = 1.0 / self.hulls.ticks_per_us;
        let certificate = Certificate {
            upper_bound: outcome.upper_bound.max(outcome.benefit),
            gap: outcome.gap(),
            penalised_gap: outcome.priced_gap(),
            lambda: self.lambda,
        };
        let shortfall = outcome.shortfall.saturating_add(over);
        SelectReport {
            cost_us: outcome.cost.saturating_add(fixed) as f64 * us_per_tick,
            benefit: outcome.benefit,
            // Below the floor what was not looked at might have been worth drawing.
            certificate: (shortfall == 0 && self.lambda >= frame.floor).then_some(certificate),
            infeasible_us: shortfall as f64 * us_per_tick,
            steps: outcome.steps,
        }
    }
}

/// How far λ is expected to fall from one frame to the next at most, as a factor: so little where it has not fallen
/// farther for a while, and so much after it has. What is worth less than that is not looked at; where λ falls farther
/// after all there is no certificate, and what would be drawn is missing for a frame.
const FALL: std::ops::RangeInclusive<f64> = 0.6..=0.95;

/// How fast trust comes back, per frame.
const TRUST: f64 = 1.1;

impl Selector for Predictive {
    fn needs(&self) -> Needs {
        Needs::Weights
    }

    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport {
        self.hulls.renew(frame, &mut self.knapsack);
        let fixed = self.fill_odd(frame);
        let budget = (frame.budget.select_us.max(0.0) * self.hulls.ticks_per_us) as u64;
        let over = fixed.saturating_sub(budget);
        let ease = (budget as f64 * (1.0 - self.options.dead_band())) as u64;
        let free = |ticks: u64| ticks.saturating_sub(fixed);
        let outcome = self.solve(frame, free(budget), free(ease), levels);
        self.lambda = outcome.lambda * self.hulls.ticks_per_us;
        let fell = self.lambda < frame.floor;
        self.fall = if fell { *FALL.start() } else { (self.fall * TRUST).clamp(*FALL.start(), *FALL.end()) };
        self.report(frame, &outcome, fixed, over)
    }

    /// λ of the last frame, less the premium of what is held, and less room for λ to fall.
    fn floor(&self) -> f64 {
        self.fall * self.lambda / (1.0 + f64::from(self.options.hysteresis))
    }

    /// Held back by steadiness where the optimum is finer, or by the price of switching where the next finer level is
    /// worth the going rate without it.
    fn cause(&self, frame: &Frame<'_>, i: usize, level: Level) -> Cause {
        if let Some(steadiness) = self.options.steadiness {
            let is_full = steadiness.is_full(frame.account(i));
            return match self.owed.get(i / 64).is_some_and(|bits| bits & (1 << (i % 64)) != 0) {
                true if is_full => Cause::Dwell,
                true => Cause::Hysteresis,
                false => Cause::Budget,
            };
        }
        let (candidates, candidate) = (frame.candidates, frame.candidate(i));
        let finer = frame.rates.drawn(candidate.table, candidate.allowed).filter(|&(l, _)| l < level);
        let lambda = self.lambda;
        let pays = |to: Level| {
            let gain = frame.benefit(i, to) - frame.benefit(i, level);
            gain > lambda * (frame.cost_us(i, to) - frame.cost_us(i, level))
        };
        match candidates.previous(i) {
            Some(held) if held == level && finer.map(|(l, _)| l).any(pays) => {
                if frame.age_ms(i) < self.options.dwell_ms { Cause::Dwell } else { Cause::Hysteresis }
            }
            _ => Cause::Budget,
        }
    }

    fn deferred(&self) -> Option<&[Deferral]> {
        self.options.steadiness.map(|_| self.deferred.as_slice())
    }

    fn reset(&mut self) {
        self.knapsack.forget();
        (self.lambda, self.fall) = (0.0, 0.0);
        self.deferred.clear();
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(self.clone())
    }
}

/// Opens the account of every candidate that does not hold the level the knapsack has for it: of those that were looked
/// at closely, and of those that were deferred and are where they were. Who has just come into view, and whose level is
/// allowed no longer, takes it at once.
fn open_accounts<F: Fn(usize) -> f32, M: Menus>(
    accounts: &mut Accounts,
    knapsack: &SharedKnapsack,
    crowd: &Crowd<'_, F, M>,
    frame: &Frame<'_>,
    levels: &mut [Level],
) {
    accounts.clear();
    let candidates = frame.candidates;
    let recall = |i: usize, slot: u32| frame.memory.recall(candidates.group_of(i), slot);
    for (i, item) in knapsack.changed() {
        let best = Level(item);
        let offer = |level: Level| crowd.offer(&knapsack.profiles, i, level.0);
        let held = candidates.previous(i).filter(|&level| level != best);
        match held.and_then(|level| Some((level, [offer(level)?, offer(best)?]))) {
            Some((level, offers)) => {
                let held = Held { candidate: i as u32, slot: candidates.slot_of(i), level };
                accounts.open(held, best, offers, || recall(i, held.slot));
            }
            None => levels[i] = best,
        }
    }
    for &Deferred { candidate, slot } in &candidates.deferred {
        let (i, place) = (candidate as usize, candidates.place[candidate as usize]);
        if place != NO_PLACE && !knapsack.has_looked_at(i) {
            let (level, best) = (levels[i], frame.rates.level_at(place));
            let weight = candidates.weight[i];
            let offer = |place: u32| knapsack.profiles.offer_at(place, weight);
            let offers = [offer(place + u32::from(level.0) - u32::from(best.0)), offer(place)];
            accounts.open(Held { candidate, slot, level }, best, offers, || recall(i, slot));
        }
    }
}

/// Which profile of the knapsack holds the hull of which table and range of levels. Made as they are met, kept until
/// the rates change, as are the columns that make hulls for one candidate alone.
#[derive(Clone, Debug, Default)]
struct Hulls {
    rates_revision: u64,
    ticks_per_us: f64,
    columns: MenuColumns,
    by_table: Vec<Vec<(LevelRange, u32)>>,
    items: Vec<ProfileItem>,
}

/// Costs are counted in ticks of a power of two, so fine that the dearest level of any table has 36 bits and a tick is
/// no less than 2⁻²⁴ µs: sums over 2²⁷ objects stay within 63 bits.
const TICK_BITS: i32 = 36;
const FINEST_TICK: i32 = 24;

impl Hulls {
    /// Forgets all hulls when the rates have changed.
    fn renew(&mut self, frame: &Frame<'_>, knapsack: &mut SharedKnapsack) {
        if self.rates_revision == frame.rates.revision() && self.by_table.len() == frame.rates.tables() {
            return;
        }
        self.rates_revision = frame.rates.revision();
        self.ticks_per_us = ticks_per_us(frame.rates);
        self.columns.renew(frame.rates);
        knapsack.profiles.truncate(0);
        self.by_table.iter_mut().for_each(Vec::clear);
        self.by_table.resize(frame.rates.tables(), Vec::new());
        for table in (0..frame.rates.tables()).map(|table| table as u16) {
            self.make(table, frame.rates.whole(table), frame.rates, knapsack);
        }
    }

    /// The profile of a table cut to a range of drawn levels. Those of whole tables have the tables' numbers.
    fn shared(&mut self, candidate: &Candidate, rates: &TableRates, knapsack: &mut SharedKnapsack) -> u32 {
        let Candidate { table, allowed, .. } = *candidate;
        if allowed == rates.whole(table) {
            return u32::from(table);
        }
        let known = self.by_table[usize::from(table)].iter().find(|(range, _)| *range == allowed);
        if let Some(&(_, profile)) = known {
            return profile;
        }
        let profile = self.make(table, allowed, rates, knapsack);
        self.by_table[usize::from(table)].push((allowed, profile));
        profile
    }

    fn make(
        &mut self,
        table: u16,
        allowed: LevelRange,
        rates: &TableRates,
        knapsack: &mut SharedKnapsack,
    ) -> u32 {
        let tick = self.ticks_per_us;
        self.items.clear();
        self.items.extend(rates.drawn(table, allowed).map(|(level, rate)| ProfileItem {
            value: rate.accuracy,
            ticks: ceil_ticks(rate.geometry_us * tick),
            item: level.0,
        }));
        knapsack.profiles.push(&self.items)
    }

    /// What prices the candidates that share no hull.
    fn pricing<'a>(&'a self, frame: &Frame<'a>) -> Pricing<'a> {
        Pricing { columns: &self.columns, model: frame.model, ticks_per_us: self.ticks_per_us }
    }
}

fn ticks_per_us(rates: &TableRates) -> f64 {
    let tables = (0..rates.tables()).map(|t| t as u16);
    let dearest = tables.flat_map(|t| rates.levels(t)).fold(0.0, |most: f64, l| most.max(l.geometry_us));
    let mut bits = FINEST_TICK;
    while bits > -TICK_BITS && dearest * power_of_two(bits) > power_of_two(TICK_BITS) {
        bits -= 1;
    }
    power_of_two(bits)
}

fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// Rounds up; beyond 2⁶² ticks it holds.
fn ceil_ticks(ticks: f64) -> u64 {
    whole_ticks(ticks) as u64
}
