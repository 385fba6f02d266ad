//! The optimum, proved.

mod group;
mod prices;
mod relief;

use self::group::{Group, Halt, best_pair};
use self::prices::Prices;
use self::relief::Relief;
use super::dyadic::{Number, WideSum};
use super::greedy::relax;
use super::ledger::{Grids, Ledger, Totals};
use super::{Instance, Solution, greedy};

/// Solves to proved optimality, or as far as `stop` allows.
///
/// `stop` is polled regularly and ends the search when it returns true; the best known choice then comes back with an honest upper bound
/// and `optimal: false`.
pub fn exact(instance: &Instance, stop: &mut dyn FnMut() -> bool) -> Solution {
    let quick = greedy(instance);
    if quick.optimal || !quick.feasible {
        return quick;
    }
    let grids = Grids::of(instance);
    match grids.bits() {
        0..=64 => search(&Ledger::<i64>::new(instance, grids), quick, stop),
        65..=128 => search(&Ledger::<i128>::new(instance, grids), quick, stop),
        _ => search(&Ledger::<WideSum>::new(instance, grids), quick, stop),
    }
}

/// The best choice so far and what is known about better ones.
struct Search<'a, T> {
    ledger: &'a Ledger<'a, T>,
    prices: Prices<T>,
    choice: Vec<u32>,
    totals: Totals<T>,
    /// No choice has a benefit above this.
    bound: T,
}

impl<T: Number> Search<'_, T> {
    /// Whether no choice reports a higher benefit.
    fn proved(&self) -> bool {
        let unit = self.ledger.benefit_unit;
        self.bound <= self.totals.benefit || self.bound.to_f64(unit) <= self.totals.benefit.to_f64(unit)
    }

    /// The largest gap of a choice better than the best.
    fn limit(&self) -> f64 {
        self.prices.gap(self.totals.benefit + self.prices.benefit_step)
    }

    fn offer(&mut self, choice: Vec<u32>) {
        let totals = self.ledger.totals(&choice);
        if totals.cost <= self.ledger.budget && totals.benefit > self.totals.benefit {
            (self.choice, self.totals) = (choice, totals);
        }
    }

    /// Looks at every choice with a gap up to `level`.
    fn explore(&mut self, level: f64, capacity: usize, stop: &mut dyn FnMut() -> bool) -> Result<(), Halt> {
        let mut groups = [Group::new(), Group::new()];
        let classes = std::mem::take(&mut self.prices.classes);
        let mut inside = [Vec::new(), Vec::new()];
        let mut result = Ok(());
        for (i, class) in classes.iter().enumerate() {
            let limit = level.min(self.limit());
            if limit < 0.0 || class.alternatives[0].loss > limit {
                break;
            }
            let side = usize::from(groups[1].states.len() < groups[0].states.len());
            inside[side].push(i);
            let outside = classes
                .iter()
                .enumerate()
                .filter(|(j, _)| inside[side].binary_search(j).is_err())
                .map(|(_, class)| class);
            let relief = Relief::of(self.prices.lambda, outside);
            result = groups[side].extend(&self.prices, class, &relief, limit, capacity, stop);
            if result.is_err() {
                break;
            }
            if let Some((a, b)) = best_pair(&groups[0].states, &groups[1].states, self.prices.room) {
                let gain = groups[0].states[a].benefit + groups[1].states[b].benefit;
                if self.prices.totals.benefit + gain > self.totals.benefit {
                    let mut choice = self.prices.base.clone();
                    groups[0].write(a, &mut choice);
                    groups[1].write(b, &mut choice);
                    self.offer(choice);
                }
            }
        }
        self.prices.classes = classes;
        result
    }
}

fn search<T: Number>(ledger: &Ledger<'_, T>, quick: Solution, stop: &mut dyn FnMut() -> bool) -> Solution {
    let Some(relaxation) = relax(ledger) else { return quick };
    let prices = Prices::new(ledger, relaxation);
    let totals = ledger.totals(&quick.choice);
    let bound = prices.benefit_at(0.0);
    let mut search = Search { ledger, prices, choice: quick.choice.clone(), totals, bound };
    let mut level = first_level(&search);
    while !search.proved() {
        match search.explore(level, 1 << 21, stop) {
            Ok(()) => {
                search.bound = if level >= search.limit() {
                    search.totals.benefit
                } else {
                    search.prices.benefit_at(level)
                };
                level *= 2.0;
            }
            Err(_) => break,
        }
    }
    let bound = search.bound.to_f64_up(ledger.benefit_unit);
    ledger.solution(search.choice, search.totals, Some(bound), quick.lambda)
}

fn first_level<T: Number>(search: &Search<'_, T>) -> f64 {
    let mut losses: Vec<f64> =
        search.prices.classes.iter().flat_map(|class| class.alternatives.iter().map(|a| a.loss)).collect();
    losses.sort_by(f64::total_cmp);
    let few = losses.get(20).copied().unwrap_or(f64::MAX);
    let benefit = search.totals.benefit.to_f64(search.ledger.benefit_unit);
    few.max(benefit * f64::EPSILON / 2.0).max(f64::MIN_POSITIVE)
}
