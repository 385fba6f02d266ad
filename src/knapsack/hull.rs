//! The upper convex hull of a class in the (cost, benefit) plane: the items the linear relaxation can use.

use std::cmp::Ordering;

use super::Item;
use super::dyadic::{Number, WideProduct, add_product, decompose};

/// Writes into `hull` the indices of the upper convex hull of `items`, in order of cost, from the cheapest item (of
/// equally cheap ones the highest benefit, then the lowest index) to the one with the highest benefit.
///
/// Slopes along the hull never rise; items *on* an edge are kept, so that equal slopes give several small steps instead
/// of a large one. Items of equal cost and benefit appear once. `hull` is cleared first and is the only scratch. Values
/// must be finite and not negative. O(n log n), exact ([`compare_slopes`]). Andrew's monotone chain (A. M. Andrew,
/// "Another efficient algorithm for convex hulls in two dimensions", 1979).
pub fn upper_hull(items: &[Item], hull: &mut Vec<u32>) {
    upper_hull_of(items, |_| true, hull);
}

/// [`upper_hull`] of the items that `keep` accepts; indices are those of `items`. Empty when none is kept.
pub fn upper_hull_of(items: &[Item], keep: impl Fn(&Item) -> bool, hull: &mut Vec<u32>) {
    hull.clear();
    hull.extend((0..items.len() as u32).filter(|&i| keep(&items[i as usize])));
    hull.sort_unstable_by(|&a, &b| cheaper_then_better(items, a, b));
    let mut kept = 0;
    for read in 0..hull.len() {
        let item = items[hull[read] as usize];
        if kept > 0 && item.benefit <= items[hull[kept - 1] as usize].benefit {
            continue;
        }
        while kept > 1 && lies_below(items, hull[kept - 2], hull[kept - 1], item) {
            kept -= 1;
        }
        hull[kept] = hull[read];
        kept += 1;
    }
    hull.truncate(kept);
}

fn cheaper_then_better(items: &[Item], a: u32, b: u32) -> Ordering {
    let (left, right) = (items[a as usize], items[b as usize]);
    left.cost.total_cmp(&right.cost).then(right.benefit.total_cmp(&left.benefit)).then(a.cmp(&b))
}

/// Whether `middle` lies strictly below the edge from `left` to `right`.
fn lies_below(items: &[Item], left: u32, middle: u32, right: Item) -> bool {
    let (left, middle) = (items[left as usize], items[middle as usize]);
    compare_slopes(Step { from: left, to: middle }, Step { from: middle, to: right }) == Ordering::Less
}

/// A step from an item of a class to a costlier and better one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Where the step starts.
    pub from: Item,
    /// Where it ends; costs more than `from` and has a higher benefit.
    pub to: Item,
}

impl Step {
    /// Benefit gained per unit of cost, rounded; infinite where the quotient overflows.
    pub fn slope(&self) -> f64 {
        (self.to.benefit - self.from.benefit) / (self.to.cost - self.from.cost)
    }
}

/// Compares the slopes of two steps exactly, as if by cross-multiplication without rounding.
///
/// A rounded comparison decides all but near ties; those take integer products (differences that `f64` holds) or an
/// accumulator as wide as any product of differences can be.
pub fn compare_slopes(a: Step, b: Step) -> Ordering {
    let [rise_a, run_a] = differences(a);
    let [rise_b, run_b] = differences(b);
    let (left, right) = (rise_a.high * run_b.high, rise_b.high * run_a.high);
    // Each product carries three roundings, 1.5 ε relative; 4 ε of the sum is safely more, unless digits fell off the
    // range.
    let doubt = 4.0 * f64::EPSILON * (left + right);
    let in_range = |product: f64| product.is_finite() && product > 1e-290;
    if in_range(left) && in_range(right) && (left - right).abs() > doubt {
        return left.total_cmp(&right);
    }
    if [rise_a, run_a, rise_b, run_b].iter().all(|difference| difference.low == 0.0) {
        return compare_products(rise_a.high, run_b.high, rise_b.high, run_a.high);
    }
    compare_in_full(rise_a, run_b, rise_b, run_a)
}

/// An exact difference of two `f64`, as the unevaluated sum of its rounded value and the rounding error.
#[derive(Clone, Copy)]
pub(crate) struct Difference {
    pub high: f64,
    pub low: f64,
}

fn differences(step: Step) -> [Difference; 2] {
    [difference(step.to.benefit, step.from.benefit), difference(step.to.cost, step.from.cost)]
}

/// Knuth's two-sum, with a minus (D. E. Knuth, The Art of Computer Programming 2, 4.2.2). Exact unless it overflows.
pub(crate) fn difference(a: f64, b: f64) -> Difference {
    let high = a - b;
    let b_virtual = a - high;
    let a_virtual = high + b_virtual;
    Difference { high, low: (a - a_virtual) + (b_virtual - b) }
}

/// Compares `a·b` with `c·d`; all are finite and not negative.
fn compare_products(a: f64, b: f64, c: f64, d: f64) -> Ordering {
    let product = |x: f64, y: f64| {
        let ((m, e), (n, f)) = (decompose(x), decompose(y));
        (u128::from(m) * u128::from(n), e + f)
    };
    let ((m, e), (n, f)) = (product(a, b), product(c, d));
    if m == 0 || n == 0 {
        return m.cmp(&n);
    }
    let top = |mantissa: u128, exponent: i32| exponent + 128 - mantissa.leading_zeros() as i32;
    // With the highest bits level, aligning them to the top of the word loses nothing.
    top(m, e).cmp(&top(n, f)).then((m << m.leading_zeros()).cmp(&(n << n.leading_zeros())))
}

/// Compares `a·b` with `c·d` through the eight partial products.
fn compare_in_full(a: Difference, b: Difference, c: Difference, d: Difference) -> Ordering {
    let mut sum = WideProduct::ZERO;
    for (x, y) in [(a.high, b.high), (a.high, b.low), (a.low, b.high), (a.low, b.low)] {
        sum = add_product(sum, x, y);
    }
    for (x, y) in [(c.high, d.high), (c.high, d.low), (c.low, d.high), (c.low, d.low)] {
        sum = add_product(sum, -x, y);
    }
    sum.sign()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn items(points: &[(f64, f64)]) -> Vec<Item> {
        points.iter().map(|&(cost, benefit)| Item { cost, benefit }).collect()
    }

    fn hull_of(points: &[(f64, f64)]) -> Vec<u32> {
        let mut hull = vec![7];
        upper_hull(&items(points), &mut hull);
        hull
    }

    #[test]
    fn an_empty_class_has_an_empty_hull() {
        assert!(hull_of(&[]).is_empty());
    }

    #[test]
    fn equally_cheap_items_yield_the_best_then_the_first() {
        assert_eq!(hull_of(&[(1.0, 1.0), (1.0, 3.0), (1.0, 3.0)]), [1]);
        assert_eq!(hull_of(&[(2.0, 3.0), (1.0, 3.0)]), [1]);
    }

    #[test]
    fn items_on_an_edge_stay_and_items_below_go() {
        assert_eq!(hull_of(&[(2.0, 2.0), (0.0, 0.0), (1.0, 1.0), (3.0, 2.5)]), [1, 2, 0, 3]);
        assert_eq!(hull_of(&[(0.0, 0.0), (1.0, 0.5), (2.0, 2.0)]), [0, 2]);
    }

    #[test]
    fn slopes_that_round_alike_are_told_apart() {
        let step = |rise: f64, run: f64| Step {
            from: Item { cost: 0.0, benefit: 0.0 },
            to: Item { cost: run, benefit: rise },
        };
        let big = (1u64 << 53) as f64;
        let (a, b) = (step(big - 1.0, big - 2.0), step(big - 2.0, big - 3.0));
        assert_eq!(compare_slopes(a, b), Ordering::Less);
        assert_eq!(compare_slopes(b, a), Ordering::Greater);
        assert_eq!(compare_slopes(step(3.0, 5.0), step(6.0, 10.0)), Ordering::Equal);
        assert_eq!(compare_slopes(step(5e-324, 5e-324), step(f64::MAX, f64::MAX)), Ordering::Equal);
        let tiny = Step { from: Item { cost: 5e-324, benefit: 0.0 }, to: Item { cost: 1.0, benefit: 1.0 } };
        assert_eq!(compare_slopes(tiny, step(1.0, 1.0)), Ordering::Greater);
    }

    proptest! {
        #[test]
        fn small_integers_compare_like_fractions(a in prop::array::uniform4(0u32..9), b in prop::array::uniform4(0u32..9)) {
            let step = |[cost, benefit, run, rise]: [u32; 4]| Step {
                from: Item { cost: cost.into(), benefit: benefit.into() },
                to: Item { cost: (cost + run + 1).into(), benefit: (benefit + rise).into() },
            };
            let expected = (a[3] * (b[2] + 1)).cmp(&(b[3] * (a[2] + 1)));
            prop_assert_eq!(compare_slopes(step(a), step(b)), expected);
        }

        #[test]
        fn all_three_paths_agree(values in prop::array::uniform4(1u64..1 << 40), scale in -900i32..900) {
            let scale = 2f64.powi(scale / 2);
            let [a, b, c, d] = values.map(|value| value as f64 * scale);
            let exact = (u128::from(values[0]) * u128::from(values[1])).cmp(&(u128::from(values[2]) * u128::from(values[3])));
            let whole = |high: f64| Difference { high, low: 0.0 };
            prop_assert_eq!(compare_products(a, b, c, d), exact);
            prop_assert_eq!(compare_in_full(whole(a), whole(b), whole(c), whole(d)), exact);
        }

        #[test]
        fn no_item_lies_above_the_hull(points in prop::collection::vec((0u32..12, 0u32..12), 1..9)) {
            let points: Vec<_> = points.iter().map(|&(cost, benefit)| (f64::from(cost), f64::from(benefit))).collect();
            let hull = hull_of(&points);
            let at = |i: u32| points[i as usize];
            for pair in hull.windows(2) {
                prop_assert!(at(pair[0]).0 < at(pair[1]).0 && at(pair[0]).1 < at(pair[1]).1);
            }
            for &(cost, benefit) in &points {
                let reach = hull.windows(2).map(|pair| (at(pair[0]), at(pair[1]))).find(|(_, to)| cost <= to.0);
                let Some((from, to)) = reach else {
                    let last = at(hull[hull.len() - 1]);
                    prop_assert!(benefit <= last.1 && cost >= at(hull[0]).0);
                    continue;
                };
                prop_assert!((benefit - from.1) * (to.0 - from.0) <= (to.1 - from.1) * (cost - from.0));
            }
        }
    }
}
