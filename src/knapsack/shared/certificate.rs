//! Sums over a choice, and the bound on every other: for any λ ≥ 0, Σ max(benefit − λ·cost) + λ·budget is no less than
//! the optimum within the budget.
//!
//! Sums are of integers, so the order of classes does not matter, and bounds are rounded outwards.

use super::SharedClass;
use super::class::{Class, reach};
use super::crowd::Aside;
use super::profiles::FRACTION_BITS;

/// How good a choice is. Costs are in ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Cost of the choice.
    pub cost: u64,
    /// By how much the cheapest choice exceeds the budget; 0 when it fits.
    pub shortfall: u64,
    /// Benefit of the choice.
    pub benefit: f64,
    /// Benefit of the cheapest choice.
    pub minimum_benefit: f64,
    /// No choice within the budget has more benefit.
    pub upper_bound: f64,
    /// Benefit of the choice with switching priced in.
    pub priced_benefit: f64,
    /// No choice within the budget has more priced benefit.
    pub priced_bound: f64,
    /// Benefit per tick where the budget ends; 0 when everything fits.
    pub lambda: f64,
    /// Steps that were compared one by one.
    pub steps: usize,
}

impl Outcome {
    /// (bound − benefit) ÷ (bound − benefit of the cheapest choice), of the plain benefit.
    pub fn gap(&self) -> f64 {
        let attainable = self.upper_bound - self.minimum_benefit;
        if attainable > 0.0 { ((self.upper_bound - self.benefit) / attainable).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// (priced bound − priced benefit) ÷ what [`Outcome::gap`] divides by.
    pub fn priced_gap(&self) -> f64 {
        let attainable = self.upper_bound - self.minimum_benefit;
        if attainable > 0.0 {
            ((self.priced_bound - self.priced_benefit) / attainable).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }
}

/// The sums behind an [`Outcome`], in any order of classes.
pub(super) struct Sums {
    lambda: f32,
    classes: usize,
    /// Units of benefit per one.
    unit: f64,
    /// Sum of all weights, in units.
    weight: u128,
    cost: u64,
    benefit: Worth,
    minimum: Worth,
    premium: i128,
    bound: Bound,
    priced_bound: Bound,
    bound_premium: i128,
}

/// What the best positions at λ come to.
#[derive(Default)]
struct Bound {
    worth: Worth,
    cost: u64,
}

impl Bound {
    fn add(&mut self, class: &Class<'_>, weight: u64, position: u8) {
        self.worth.add(class, weight, position);
        self.cost = self.cost.saturating_add(class.cost(position));
    }
}

/// An exact sum of weight (in units) · value (with [`FRACTION_BITS`] binary digits after the point).
#[derive(Clone, Copy, Default)]
struct Worth(u128);

impl Worth {
    fn add(&mut self, class: &Class<'_>, weight: u64, position: u8) {
        let worth = class.positions[usize::from(position)].worth;
        self.0 = self.0.wrapping_add(u128::from(weight) * u128::from(worth));
    }

    fn value(self, unit: f64) -> f64 {
        self.0 as f64 / ((1u64 << FRACTION_BITS) as f64 * unit)
    }
}

/// Slopes this close to λ, relatively, may be on its other side without the rounding of single precision: three
/// roundings of 2⁻²⁴ each, doubled. There the best position is looked for in double precision.
pub(super) const NEAR: f32 = 4e-7;

impl Sums {
    /// None of these classes yet.
    pub fn new(lambda: f32, classes: &[SharedClass]) -> Self {
        let heaviest = classes.iter().map(|c| c.weight).fold(0.0, f32::max);
        Self {
            lambda,
            classes: classes.len(),
            unit: power_of_two(WEIGHT_BITS - exponent_of(heaviest)),
            weight: 0,
            cost: 0,
            benefit: Worth::default(),
            minimum: Worth::default(),
            premium: 0,
            bound: Bound::default(),
            priced_bound: Bound::default(),
            bound_premium: 0,
        }
    }

    /// Adds a class and its chosen position.
    pub fn add(&mut self, class: &Class<'_>, choice: u8) {
        let weight = fixed(f64::from(class.weight) * self.unit);
        self.weight += u128::from(weight);
        self.cost = self.cost.saturating_add(class.cost(choice));
        self.benefit.add(class, weight, choice);
        self.minimum.add(class, weight, 0);
        let best = best(class, choice, self.lambda, |p| class.plain_slope(p), |p| class.plain(p));
        self.bound.add(class, weight, best);
        if class.stay == 0.0 {
            self.priced_bound.add(class, weight, best);
            return;
        }
        let priced = |p| class.plain(p) + class.premium(p);
        let best = self::best(class, choice, self.lambda, |p| class.slope(p), priced);
        let premium = |p: u8| i128::from((class.premium(p) * self.unit) as i64);
        let chosen = premium(choice);
        self.premium += chosen;
        self.bound_premium += if best == choice { chosen } else { premium(best) };
        self.priced_bound.add(class, weight, best);
    }

    /// What the sums and those of the classes set aside come to. The price of switching of the latter is left out on
    /// both sides: they are at the best position for λ with it.
    ///
    /// Bounds are widened by what rounding can hide: two units per class for weights and premiums, two ticks per class
    /// for scaled costs, the last binary digit of every value, doubled where switching is priced, and the last places
    /// of the products.
    pub fn outcome(&self, budget: u64, aside: &Aside) -> Outcome {
        let lambda = f64::from(self.lambda);
        let digits = 2.0 * self.weight as f64 / ((1u64 << FRACTION_BITS) as f64 * self.unit);
        let [value, least, hover_value] = [aside.benefit.value, aside.benefit.least, aside.hover_value]
            .map(|units| units as f64 * aside.benefit.unit);
        let hidden = self.classes as f64 * 2.0 * (lambda + 1.0 / self.unit)
            + digits
            + 2.0 * (aside.hidden() + aside.classes as f64 * lambda);
        let bound = |benefit: f64, cost: f64| {
            let (benefit, cost) = (benefit + value, cost + aside.cost as f64);
            let unspent = lambda * (budget as f64 - cost);
            let widest = benefit.abs() + lambda * (budget as f64 + cost.abs());
            benefit + unspent + hidden + widest * 1e-14
        };
        let plain_best = self.bound.worth.value(self.unit) + hover_value;
        let plain_cost = self.bound.cost as f64 + aside.hover_cost as f64;
        let benefit = self.benefit.value(self.unit) + value;
        let priced_benefit = benefit + self.premium as f64 / self.unit;
        let priced_best = self.priced_bound.worth.value(self.unit) + self.bound_premium as f64 / self.unit;
        Outcome {
            cost: self.cost.saturating_add(aside.cost),
            shortfall: 0,
            benefit,
            minimum_benefit: self.minimum.value(self.unit) + least,
            upper_bound: bound(plain_best, plain_cost).max(benefit),
            priced_benefit,
            priced_bound: bound(priced_best, self.priced_bound.cost as f64).max(priced_benefit),
            lambda,
            steps: 0,
        }
    }
}

/// The heaviest class has so many bits of units.
const WEIGHT_BITS: i32 = 56;

/// The whole units of `x`, which is not negative and below 2⁶³.
fn fixed(x: f64) -> u64 {
    x as i64 as u64
}

/// The exponent of a power of two above `x`; 0 for 0.
fn exponent_of(x: f32) -> i32 {
    if x > 0.0 { (x.to_bits() >> 23) as i32 - 126 } else { 0 }
}

/// 2^`exponent`, for exponents of normal numbers.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// The position that maximises benefit − λ·cost, looked for from `near`.
pub(super) fn best(
    class: &Class<'_>,
    near: u8,
    lambda: f32,
    slope: impl Fn(u8) -> f32,
    benefit: impl Fn(u8) -> f64,
) -> u8 {
    if lambda == 0.0 {
        return class.last();
    }
    let position = reach(near, lambda, &slope);
    let close = |p: u8| (slope(p) - lambda).abs() <= lambda * NEAR;
    let doubtful = close(position) || position > 0 && close(position - 1);
    if !doubtful {
        return position;
    }
    let surplus = |p: u8| benefit(p) - f64::from(lambda) * class.cost(p) as f64;
    (0..=class.last()).reduce(|best, p| if surplus(p) > surplus(best) { p } else { best }).unwrap_or(position)
}
