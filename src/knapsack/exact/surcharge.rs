//! A tighter bound where benefits are costs plus surcharges of few sizes: strongly correlated instances, whose linear
//! bound is nearly a whole surcharge too high.
//!
//! Let d = benefit − cost of each item and D the sum of the chosen d. Benefit is at most budget + D, and D moves in
//! multiples of the greatest common divisor u of all differences of d. The linear bound lies between two such D. Either
//! D is at most the lower one, which bounds the benefit by budget + D; or it is at least the upper one, and the linear
//! relaxation *with that condition*, a second multiplier µ, bounds it. In the spirit of the cardinality bounds of S.
//! Martello, P. Toth, "Upper bounds and algorithms for hard 0-1 knapsack problems", 1997.

use super::super::dyadic::Number;
use super::prices::Prices;

/// Steps of each of the two nested bisections; any multipliers give a valid bound, more steps a tighter one.
const STEPS: u32 = 48;

/// A bound on the total benefit, if this one beats the linear bound.
pub(super) fn bound<T: Number>(prices: &Prices<T>) -> Option<T> {
    let surcharges = Surcharges::of(prices)?;
    let linear = prices.benefit_at(0.0) - prices.totals.benefit;
    let lower = (linear - prices.room).floor_to(surcharges.unit);
    let at_most_lower = prices.totals.benefit + prices.room + lower;
    let more = surcharges.gain_with_at_least(lower + surcharges.unit, prices);
    let at_least_upper = prices.benefit_at(prices.gap(prices.totals.benefit) - more);
    Some(at_most_lower.max(at_least_upper))
}

/// An alternative as (cost, benefit, surcharge), relative to its class's base.
type Triple = [f64; 3];

struct Surcharges<T> {
    unit: T,
    classes: Vec<Vec<Triple>>,
}

impl<T: Number> Surcharges<T> {
    /// `None` where costs and benefits are on different grids, or surcharges are as fine as benefits anyway.
    fn of(prices: &Prices<T>) -> Option<Self> {
        if !prices.one_grid() {
            return None;
        }
        let mut unit = T::ZERO;
        let mut classes = Vec::with_capacity(prices.classes.len());
        for class in &prices.classes {
            let mut triples = Vec::with_capacity(class.alternatives.len());
            for alternative in &class.alternatives {
                let surcharge = alternative.benefit - alternative.cost;
                unit = unit.common_divisor(surcharge);
                triples.push(
                    [alternative.cost, alternative.benefit, surcharge].map(|amount| prices.cost_f64(amount)),
                );
            }
            classes.push(triples);
        }
        (unit > prices.benefit_step).then_some(Self { unit, classes })
    }

    /// An upper bound on the gain in benefit when the surcharges gain at least `least`.
    fn gain_with_at_least(&self, least: T, prices: &Prices<T>) -> f64 {
        let (room, least) = (prices.cost_f64(prices.room), prices.cost_f64(least));
        let mut best = f64::INFINITY;
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut mu: f64 = 1e-6;
        for _ in 0..2 * STEPS {
            let (gain, surcharge) = self.relaxed(mu, room, least);
            best = best.min(gain);
            if surcharge < least {
                low = mu;
            } else {
                high = mu;
            }
            mu = if high.is_finite() { (low + high) / 2.0 } else { mu * 4.0 };
        }
        best
    }

    /// The least Lagrangian bound over λ for one µ, and the surcharges gained there.
    fn relaxed(&self, mu: f64, room: f64, least: f64) -> (f64, f64) {
        let steepest = |triple: &Triple| ((triple[1] + mu * triple[2]) / triple[0]).abs();
        let slopes = self.classes.iter().flatten().filter(|triple| triple[0] != 0.0).map(steepest);
        let (mut low, mut high) = (0.0, slopes.fold(0.0, f64::max));
        let mut best = (f64::INFINITY, 0.0);
        for _ in 0..STEPS {
            let lambda = (low + high) / 2.0;
            let (gain, cost, surcharge) = self.lagrangian(lambda, mu, room, least);
            if gain < best.0 {
                best = (gain, surcharge);
            }
            if cost > room {
                low = lambda;
            } else {
                high = lambda;
            }
        }
        best
    }

    /// The Lagrangian bound on the gain, rounded up, and the cost and surcharges of the choice that attains it.
    fn lagrangian(&self, lambda: f64, mu: f64, room: f64, least: f64) -> (f64, f64, f64) {
        let mut gain = lambda * room - mu * least;
        let mut size = lambda * room.abs() + mu * least.abs();
        let (mut cost, mut surcharge) = (0.0, 0.0);
        for class in &self.classes {
            let mut best = (0.0, [0.0; 3]);
            for triple in class {
                let (plain, extra, price) = (triple[1], mu * triple[2], lambda * triple[0]);
                let value = plain + extra - price;
                if value > best.0 {
                    best = (value, *triple);
                }
                size = size.max(plain.abs() + extra.abs() + price.abs());
            }
            gain += best.0;
            size += best.0;
            cost += best.1[0];
            surcharge += best.1[2];
        }
        // `size` is at least every term and every partial sum; each class adds a few roundings of at most ε of it.
        let roundings = 8.0 * (self.classes.len() + 2) as f64;
        (gain + roundings * f64::EPSILON * size, cost, surcharge)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::greedy::{Effort, quick};
    use super::super::super::ledger::{Grids, Ledger};
    use super::super::super::{Instance, Item};
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// Surcharges are multiples of 10, of either sign; the bound is held against all choices.
        #[test]
        fn no_choice_exceeds_the_bound(
            classes in prop::collection::vec(prop::collection::vec((30u32..90, 0u32..4), 1..5), 1..6),
            budget in 0u32..500,
        ) {
            let item = |&(cost, surcharge): &(u32, u32)| (f64::from(cost), f64::from(cost + 10 * surcharge) - 20.0);
            let rows: Vec<Vec<Item>> = classes.iter().map(|class| class.iter().map(|i| Item::from(item(i))).collect()).collect();
            let mut sums = vec![(0.0, 0.0)];
            for class in &rows {
                sums = sums.iter().flat_map(|&(c, b)| class.iter().map(move |i| (c + i.cost, b + i.benefit))).collect();
            }
            let best = sums.iter().filter(|sum| sum.0 <= f64::from(budget)).map(|sum| sum.1).fold(-1.0, f64::max);
            let instance = Instance::new(budget.into(), &rows).expect("a valid instance");
            let ledger = Ledger::<i64>::new(&instance, Grids::of(&instance));
            let Some(relaxation) = quick(&instance, Effort::TEXTBOOK).relaxation else { return Ok(()) };
            if let Some(bound) = bound(&Prices::new(&ledger, relaxation)) {
                prop_assert!(bound.to_f64(ledger.benefit_unit) >= best);
            }
        }
    }
}
