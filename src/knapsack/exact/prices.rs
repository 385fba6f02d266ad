//! The instance seen at one price λ: every class at its best item for that price, every other item with the loss that
//! choosing it costs against the Lagrangian bound.

use std::cmp::Ordering;

use super::super::Item;
use super::super::dyadic::{Number, PRODUCT_UNIT, WideProduct, add_product};
use super::super::hull::{difference, upper_hull_of};
use super::super::ledger::{Ledger, Totals, cheapest};
use super::super::relaxation::Relaxation;

/// An item other than its class's base, relative to the base.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alternative<T> {
    pub item: u32,
    pub cost: T,
    pub benefit: T,
    /// λ·cost − benefit: not negative, since the base is best at λ.
    pub loss: f64,
}

/// An edge of a class's hull, walked away from the base.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// Cost added (upwards) or saved (downwards).
    pub cost: f64,
    /// Loss added.
    pub loss: f64,
}

/// A class that has something to choose.
#[derive(Clone, Debug)]
pub(super) struct PricedClass<T> {
    pub class: u32,
    /// By loss, ascending.
    pub alternatives: Vec<Alternative<T>>,
    /// Hull edges from the base towards dearer items, by loss per cost.
    pub up: Vec<Edge>,
    /// Hull edges from the base towards cheaper items, by loss per cost.
    pub down: Vec<Edge>,
}

/// An instance at one price.
///
/// A choice that deviates from the base by cost x and losses ℓ has benefit g(λ) − Σℓ − λ·(room − x), where g(λ) is the
/// base's benefit + λ·room: what it lacks to g(λ), its *gap*, is a sum of terms that are not negative.
#[derive(Clone, Debug)]
pub(super) struct Prices<T> {
    pub lambda: f64,
    pub base: Vec<u32>,
    pub totals: Totals<T>,
    /// Budget minus the base's cost, rounded down to what deviations can fill; negative when the base does not fit.
    pub room: T,
    /// Benefits of choices differ by multiples of this.
    pub benefit_step: T,
    /// By the loss of the first alternative, ascending.
    pub classes: Vec<PricedClass<T>>,
    /// λ·room on the grid of products.
    price_of_room: WideProduct,
    cost_unit: i32,
    benefit_unit: i32,
}

impl<T: Number> Prices<T> {
    pub fn new(ledger: &Ledger<'_, T>, relaxation: Relaxation) -> Self {
        let lambda = relaxation.lambda.min(f64::MAX);
        let mut base = relaxation.choice;
        let least = ledger.totals(&cheapest(ledger.instance)).cost;
        let mut classes = Vec::new();
        for (class, items) in ledger.instance.classes().enumerate() {
            let cheapest = items.iter().map(|item| item.cost).fold(f64::INFINITY, f64::min);
            let others = least - T::floor(cheapest, ledger.cost_unit);
            let useful = useful_items(items, |&item| others + ledger.cost(item) <= ledger.budget);
            let best = best_at(lambda, items, &useful, base[class]);
            base[class] = best;
            classes.push(price_class(ledger, lambda, class as u32, best, &useful));
        }
        classes.retain(|class| !class.alternatives.is_empty());
        order(&mut classes);
        let totals = ledger.totals(&base);
        let divisor = |amount: fn(&Alternative<T>) -> T| {
            let all = classes.iter().flat_map(|class| &class.alternatives);
            all.fold(T::ZERO, |divisor, alternative| divisor.common_divisor(amount(alternative)))
        };
        let room = (ledger.budget - totals.cost).floor_to(divisor(|alternative| alternative.cost));
        Self {
            lambda,
            totals,
            room,
            price_of_room: priced(lambda, room, ledger.cost_unit),
            benefit_step: divisor(|alternative| alternative.benefit),
            base,
            classes,
            cost_unit: ledger.cost_unit,
            benefit_unit: ledger.benefit_unit,
        }
    }

    /// What a choice of this total benefit lacks to g(λ); negative where it would exceed it.
    pub fn gap(&self, benefit: T) -> f64 {
        (self.price_of_room - (benefit - self.totals.benefit).widen(self.benefit_unit)).to_f64(PRODUCT_UNIT)
    }

    /// The highest total benefit of a choice with at least this gap.
    pub fn benefit_at(&self, gap: f64) -> T {
        let gain = T::narrow(self.price_of_room - signed_wide(gap), self.benefit_unit);
        self.totals.benefit + gain.floor_to(self.benefit_step)
    }

    /// Whether costs and benefits are counted in the same unit.
    pub fn one_grid(&self) -> bool {
        self.cost_unit == self.benefit_unit
    }

    pub fn cost_f64(&self, cost: T) -> f64 {
        cost.to_f64(self.cost_unit)
    }
}

/// `lambda` times an amount, on the grid of products. An amount beyond the digits of an `f64` is taken in two pieces.
fn priced<T: Number>(lambda: f64, amount: T, unit: i32) -> WideProduct {
    let high = amount.to_f64(unit);
    let low = (amount.widen(unit) - signed_wide(high)).to_f64(PRODUCT_UNIT);
    add_product(add_product(WideProduct::ZERO, lambda, high), lambda, low)
}

/// Sorts by the least loss; of equal ones, classes that can go up and classes that can go down take turns.
fn order<T: Number>(classes: &mut Vec<PricedClass<T>>) {
    let key = |class: &PricedClass<T>| (class.alternatives[0].loss, class.alternatives[0].cost > T::ZERO);
    classes.sort_by(|a, b| key(a).0.total_cmp(&key(b).0));
    let mut turns = [0; 2];
    let mut last = f64::NAN;
    let mut keyed: Vec<_> = std::mem::take(classes)
        .into_iter()
        .map(|class| {
            let (loss, rises) = key(&class);
            if loss != last {
                (turns, last) = ([0; 2], loss);
            }
            let turn = &mut turns[usize::from(rises)];
            *turn += 1;
            (*turn, class)
        })
        .collect();
    keyed.sort_by(|a, b| key(&a.1).0.total_cmp(&key(&b.1).0).then(a.0.cmp(&b.0)));
    classes.extend(keyed.into_iter().map(|(_, class)| class));
}

fn signed_wide(value: f64) -> WideProduct {
    add_product(WideProduct::ZERO, value, 1.0)
}

/// Items that fit and that no other one dominates, in order of cost and benefit.
fn useful_items(items: &[Item], fits: impl Fn(&Item) -> bool) -> Vec<u32> {
    let mut order: Vec<u32> = (0..items.len() as u32).filter(|&i| fits(&items[i as usize])).collect();
    let key = |i: u32| items[i as usize];
    order.sort_by(|&a, &b| {
        key(a).cost.total_cmp(&key(b).cost).then(key(b).benefit.total_cmp(&key(a).benefit))
    });
    let mut best = f64::NEG_INFINITY;
    order.retain(|&i| {
        let better = key(i).benefit > best;
        best = best.max(key(i).benefit);
        better
    });
    order
}

/// The item with the highest benefit − λ·cost; `preferred` if it is one of them, else the cheapest.
fn best_at(lambda: f64, items: &[Item], useful: &[u32], preferred: u32) -> u32 {
    let start = if useful.contains(&preferred) { preferred } else { useful[0] };
    useful.iter().fold(
        start,
        |best, &i| {
            if gains(lambda, items[best as usize], items[i as usize]) { i } else { best }
        },
    )
}

/// What `item` lacks to `base` at price λ: λ·(cost − base cost) − (benefit − base benefit), to the last place but one.
fn loss(lambda: f64, base: Item, item: Item) -> f64 {
    quick_loss(lambda, base, item).unwrap_or_else(|| exact_loss(lambda, base, item).to_f64(PRODUCT_UNIT))
}

/// Whether `item` is better than `base` at price λ; exact.
fn gains(lambda: f64, base: Item, item: Item) -> bool {
    let sign = |loss: f64| loss.total_cmp(&0.0);
    let sign = quick_loss(lambda, base, item).map_or_else(|| exact_loss(lambda, base, item).sign(), sign);
    sign == Ordering::Less
}

/// The loss in twice the precision of `f64`; `None` where that may not do.
fn quick_loss(lambda: f64, base: Item, item: Item) -> Option<f64> {
    let (run, rise) = (difference(item.cost, base.cost), difference(item.benefit, base.benefit));
    let (price, price_low) = product(lambda, run.high)?;
    let high = difference(price, rise.high);
    let tail = [high.low, price_low, lambda * run.low, -rise.low];
    let loss = high.high + tail.iter().sum::<f64>();
    // The tail is off by some 2⁻⁵¹ of its terms; where the loss is no larger than they are, that might show.
    (loss.abs() > tail.iter().map(|term| term.abs()).sum()).then_some(loss)
}

/// A product, rounded, and the rounding error; `None` near the ends of the range (T. J. Dekker, "A floating-point
/// technique for extending the available precision", 1971).
fn product(a: f64, b: f64) -> Option<(f64, f64)> {
    let high = a * b;
    let safe = |value: f64| (1e-250..1e250).contains(&value.abs());
    if high == 0.0 || ![a, b, high].into_iter().all(safe) {
        return (a == 0.0 || b == 0.0).then_some((0.0, 0.0));
    }
    let halves = |value: f64| {
        let spread = value * ((1u64 << 27) + 1) as f64;
        let top = spread - (spread - value);
        (top, value - top)
    };
    let ((a, a_rest), (b, b_rest)) = (halves(a), halves(b));
    Some((high, a_rest * b_rest - (((high - a * b) - a_rest * b) - a * b_rest)))
}

fn exact_loss(lambda: f64, base: Item, item: Item) -> WideProduct {
    let (run, rise) = (difference(item.cost, base.cost), difference(item.benefit, base.benefit));
    [(lambda, run.high), (lambda, run.low), (-1.0, rise.high), (-1.0, rise.low)]
        .into_iter()
        .fold(WideProduct::ZERO, |sum, (x, y)| add_product(sum, x, y))
}

fn price_class<T: Number>(
    ledger: &Ledger<'_, T>,
    lambda: f64,
    class: u32,
    base: u32,
    useful: &[u32],
) -> PricedClass<T> {
    let items = ledger.instance.class(class as usize);
    let base_item = items[base as usize];
    let loss_of = |i: u32| loss(lambda, base_item, items[i as usize]);
    let mut alternatives: Vec<_> = useful
        .iter()
        .filter(|&&i| i != base)
        .map(|&i| Alternative {
            item: i,
            cost: ledger.cost(items[i as usize]) - ledger.cost(base_item),
            benefit: ledger.benefit(items[i as usize]) - ledger.benefit(base_item),
            loss: loss_of(i),
        })
        .collect();
    alternatives.sort_by(|a, b| a.loss.total_cmp(&b.loss));
    let mut hull = Vec::new();
    let kept = |item: &Item| useful.iter().any(|&i| items[i as usize] == *item);
    upper_hull_of(items, kept, &mut hull);
    let at = hull.partition_point(|&i| items[i as usize].cost < base_item.cost);
    let edge = |from: u32, to: u32| Edge {
        cost: (items[to as usize].cost - items[from as usize].cost).abs(),
        loss: (loss_of(to) - loss_of(from)).max(0.0),
    };
    let mut above = vec![base];
    above.extend(hull.iter().copied().filter(|&i| items[i as usize].cost > base_item.cost));
    let mut below = vec![base];
    below.extend(hull[..at].iter().rev());
    PricedClass {
        class,
        alternatives,
        up: above.windows(2).map(|ends| edge(ends[0], ends[1])).collect(),
        down: below.windows(2).map(|ends| edge(ends[0], ends[1])).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn amount() -> impl Strategy<Value = f64> {
        prop_oneof![0.0..1e6, (0u32..9).prop_map(f64::from), 1e-300..1e-280, 1e100..1e150]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5000))]

        /// λ is near the slope of the step as often as not, so that losses cancel.
        #[test]
        fn a_quick_loss_is_the_exact_one(cost in (amount(), amount()), benefit in (amount(), amount()), lambda in prop::option::of(amount())) {
            let (base, item) = (Item { cost: cost.0, benefit: benefit.0 }, Item { cost: cost.1, benefit: benefit.1 });
            let slope = ((benefit.1 - benefit.0) / (cost.1 - cost.0)).abs();
            let lambda = lambda.unwrap_or(slope);
            prop_assume!(lambda.is_finite());
            let exact = exact_loss(lambda, base, item);
            prop_assert_eq!(gains(lambda, base, item), exact.sign() == Ordering::Less);
            if let Some(quick) = quick_loss(lambda, base, item) {
                let exact = exact.to_f64(PRODUCT_UNIT);
                prop_assert!((quick - exact).abs() <= exact.abs() * 2.0 * f64::EPSILON, "{} {}", quick, exact);
            }
        }
    }
}
