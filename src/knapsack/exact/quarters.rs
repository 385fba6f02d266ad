//! The complete search where two lists do not fit: four, of which two at a time are combined on the fly.
//!
//! Of two halves of the classes with a joint loss up to a limit, one has at most half of it. So it is enough to hold each half's combinations
//! up to *half* the limit and to stream the other half's up to the *whole* limit past them: the time of the longer list,
//! the memory of the square root of all. The split in four follows R. Schroeppel, A. Shamir, "A T = O(2^(n/2)), S = O(2^(n/4))
//! algorithm for certain NP-complete problems", 1981; the loss limit takes the place of their priority queues.

use super::super::dyadic::Number;
use super::super::ledger::Totals;
use super::group::{Group, Halt};
use super::prices::Prices;

/// One half of the classes: two groups, each in order of loss.
pub(super) struct Half<'a, T> {
    pub first: &'a Group<T>,
    pub second: &'a Group<T>,
    by_loss: [Vec<u32>; 2],
}

/// A combination of a state of each group of a half.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair<T> {
    pub totals: Totals<T>,
    pub at: [u32; 2],
}

impl<'a, T: Number> Half<'a, T> {
    pub fn new(first: &'a Group<T>, second: &'a Group<T>) -> Self {
        Self { first, second, by_loss: [first.by_loss(), second.by_loss()] }
    }

    /// How many combinations have a loss up to `limit`.
    pub fn count(&self, limit: f64) -> u64 {
        let mut end = self.by_loss[1].len();
        let mut count = 0;
        for &a in &self.by_loss[0] {
            let left = limit - self.first.states[a as usize].loss;
            while end > 0 && self.second.states[self.by_loss[1][end - 1] as usize].loss > left {
                end -= 1;
            }
            count += end as u64;
        }
        count
    }

    /// Calls `visit` with every combination of loss above `floor` and up to the limit, which `visit` returns anew after each row.
    fn stream(
        &self,
        floor: f64,
        limit: f64,
        mut visit: impl FnMut(Pair<T>),
        mut row: impl FnMut() -> Result<f64, Halt>,
    ) -> Result<(), Halt> {
        let mut limit = limit;
        let second: Vec<_> = self.by_loss[1].iter().map(|&b| (b, self.second.states[b as usize])).collect();
        for &a in &self.by_loss[0] {
            let state = self.first.states[a as usize];
            let start = second.partition_point(|(_, other)| other.loss + state.loss <= floor);
            for (b, other) in &second[start..] {
                if other.loss + state.loss > limit {
                    break;
                }
                let totals = Totals { cost: state.cost + other.cost, benefit: state.benefit + other.benefit };
                visit(Pair { totals, at: [a, *b] });
            }
            limit = limit.min(row()?);
        }
        Ok(())
    }

    /// All undominated combinations of loss up to `limit`, by cost.
    fn list(&self, limit: f64, stop: &mut dyn FnMut() -> bool) -> Result<Vec<Pair<T>>, Halt> {
        let mut pairs = Vec::new();
        let poll = || if stop() { Err(Halt::Stopped) } else { Ok(limit) };
        self.stream(-1.0, limit, |pair| pairs.push(pair), poll)?;
        pairs.sort_unstable_by(|a, b| {
            a.totals.cost.cmp(&b.totals.cost).then(b.totals.benefit.cmp(&a.totals.benefit))
        });
        let mut best: Option<T> = None;
        pairs.retain(|pair| {
            let better = best.is_none_or(|best| pair.totals.benefit > best);
            best = best.max(Some(pair.totals.benefit));
            better
        });
        Ok(pairs)
    }
}

/// Predecessor search by cost: marks that say where nothing is, then buckets of equal width, then bisection.
struct Index<'a, T> {
    pairs: &'a [Pair<T>],
    starts: Vec<u32>,
    least: f64,
    scale: f64,
    /// One bit per [`MARKS`]th of a bucket: small enough for the cache, which most queries need not leave.
    marks: Vec<u64>,
}

/// Marks per bucket: more of them answer more queries, but leave the cache earlier.
const MARKS: f64 = 16.0;

impl<'a, T: Number> Index<'a, T> {
    fn new(prices: &Prices<T>, pairs: &'a [Pair<T>]) -> Self {
        let cost = |i: usize| prices.cost_f64(pairs[i].totals.cost);
        let least = cost(0);
        let width = (cost(pairs.len() - 1) - least).max(f64::MIN_POSITIVE);
        let scale = (2.0 * pairs.len() as f64 / width).min(f64::MAX);
        let mut index = Self { pairs, starts: Vec::new(), least, scale, marks: Vec::new() };
        index.marks.resize(index.mark(cost(pairs.len() - 1)) / 64 + 1, 0);
        for i in 0..pairs.len() {
            let (bucket, mark) = (index.bucket(cost(i)), index.mark(cost(i)));
            index.marks[mark / 64] |= 1 << (mark % 64);
            index.starts.resize((bucket + 1).max(index.starts.len()), i as u32);
        }
        index.starts.push(pairs.len() as u32);
        index
    }

    /// Rises with the cost, rounding included.
    fn bucket(&self, cost: f64) -> usize {
        ((cost - self.least) * self.scale) as usize
    }

    fn mark(&self, cost: f64) -> usize {
        ((cost - self.least) * self.scale * MARKS) as usize
    }

    /// Whether a pair may cost between `cost` − `width` and `cost`, give or take a rounding.
    fn may_hold(&self, cost: f64, width: f64) -> bool {
        let low = self.mark(cost - width - cost.abs() * 1e-15);
        let high = self.mark(cost).min(64 * self.marks.len() - 1);
        high > low + 2 || (low..=high).any(|mark| self.marks[mark / 64] >> (mark % 64) & 1 == 1)
    }

    /// The dearest pair that costs at most `cost`: by dominance the best of those.
    fn at_most(&self, prices: &Prices<T>, cost: T) -> Option<&'a Pair<T>> {
        let bucket = self.bucket(prices.cost_f64(cost)).min(self.starts.len() - 2);
        let (start, end) = (self.starts[bucket] as usize, self.starts[bucket + 1] as usize);
        let below = start + self.pairs[start..end].partition_point(|pair| pair.totals.cost <= cost);
        below.checked_sub(1).map(|i| &self.pairs[i])
    }
}

/// Reports every pair of combinations, one of `held` with a loss up to half the limit and one of `streamed`, that gains more than the
/// best so far. `found` returns the gain to beat and the limit from then on.
pub(super) fn meet<T: Number>(
    prices: &Prices<T>,
    [held, streamed]: [&Half<'_, T>; 2],
    floor: f64,
    limit: f64,
    to_beat: T,
    stop: &mut dyn FnMut() -> bool,
    found: &mut dyn FnMut(&Pair<T>, &Pair<T>) -> (T, f64),
) -> Result<(), Halt> {
    let pairs = held.list(limit / 2.0, stop)?;
    if pairs.is_empty() {
        return Ok(());
    }
    let index = Index::new(prices, &pairs);
    // More room left over than this is too large a gap by itself.
    let width = limit / prices.lambda * (1.0 + 1e-9);
    let best = std::cell::Cell::new((to_beat, limit));
    let visit = |pair: Pair<T>| {
        let left = prices.room - pair.totals.cost;
        if !index.may_hold(prices.cost_f64(left), width) {
            return;
        }
        if let Some(other) = index.at_most(prices, left) {
            if pair.totals.benefit + other.totals.benefit > best.get().0 {
                best.set(found(other, &pair));
            }
        }
    };
    let row = || if stop() { Err(Halt::Stopped) } else { Ok(best.get().1) };
    streamed.stream(floor, limit, visit, row)
}
