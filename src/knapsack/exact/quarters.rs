//! The complete search where two lists do not fit: four, of which two at a time are combined on the fly.
//!
//! Of two halves of the classes with a joint loss up to a limit, one has at most half of it. So it is enough to hold
//! each half's combinations up to *half* the limit and to stream the other half's up to the *whole* limit past them:
//! the time of the longer list, the memory of the square root of all. The split in four follows R. Schroeppel, A.
//! Shamir, "A T = O(2^(n/2)), S = O(2^(n/4)) algorithm for certain NP-complete problems", 1981; the loss limit takes
//! the place of their priority queues.

use super::super::dyadic::Number;
use super::super::ledger::Totals;
use super::super::meter::Meter;
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

    /// Calls `visit` with every combination of loss above `floor` and up to the limit, which `row` returns anew after
    /// each row of so many combinations.
    fn stream(
        &self,
        floor: f64,
        limit: f64,
        mut visit: impl FnMut(Pair<T>),
        mut row: impl FnMut(u64) -> Result<f64, Halt>,
    ) -> Result<(), Halt> {
        let mut limit = limit;
        let second: Vec<_> = self.by_loss[1].iter().map(|&b| (b, self.second.states[b as usize])).collect();
        for &a in &self.by_loss[0] {
            let state = self.first.states[a as usize];
            let start = second.partition_point(|(_, other)| other.loss + state.loss <= floor);
            let within = second[start..].iter().take_while(|(_, other)| other.loss + state.loss <= limit);
            let mut combinations = 0;
            for (b, other) in within {
                combinations += 1;
                let totals = Totals { cost: state.cost + other.cost, benefit: state.benefit + other.benefit };
                visit(Pair { totals, at: [a, *b] });
            }
            limit = limit.min(row(combinations)?);
        }
        Ok(())
    }

    /// All undominated combinations of loss up to `limit`, by cost.
    fn list(&self, limit: f64, meter: &mut Meter<'_>) -> Result<Vec<Pair<T>>, Halt> {
        let mut pairs = Vec::new();
        let row = |made| if meter.spend(made) { Ok(limit) } else { Err(Halt::Stopped) };
        self.stream(-1.0, limit, |pair| pairs.push(pair), row)?;
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

/// Predecessor search by cost: a filter that says where nothing is, then buckets of equal width, then bisection.
struct Index<'a, T> {
    pairs: &'a [Pair<T>],
    starts: Vec<u32>,
    least: f64,
    scale: f64,
    /// Costs are told apart by cells as wide as the room that may be left over.
    cell: f64,
    /// One bit per hashed cell, set where a pair's cost lies: small enough for the cache, which most queries need not
    /// leave.
    filter: Vec<u64>,
}

/// Filter bits per pair, at least: more of them answer more queries, but leave the cache earlier.
const FILTER_BITS: usize = 16;

impl<'a, T: Number> Index<'a, T> {
    /// An index for queries that accept costs within `width` below the one asked for.
    fn new(prices: &Prices<T>, pairs: &'a [Pair<T>], width: f64) -> Self {
        let cost = |i: usize| prices.cost_f64(pairs[i].totals.cost);
        let least = cost(0);
        let spread = (cost(pairs.len() - 1) - least).max(f64::MIN_POSITIVE);
        let scale = (2.0 * pairs.len() as f64 / spread).min(f64::MAX);
        let filter = vec![0; (FILTER_BITS * pairs.len()).next_power_of_two().max(64) / 64];
        let cell = width.max(f64::MIN_POSITIVE);
        let mut index = Self { pairs, starts: Vec::new(), least, scale, cell, filter };
        for i in 0..pairs.len() {
            let bucket = index.bucket(cost(i));
            index.starts.resize((bucket + 1).max(index.starts.len()), i as u32);
            let (word, bit) = index.slot((cost(i) / cell).floor());
            index.filter[word] |= bit;
        }
        index.starts.push(pairs.len() as u32);
        index
    }

    /// The filter's word and bit of a cell (D. E. Knuth's multiplicative hashing).
    fn slot(&self, cell: f64) -> (usize, u64) {
        let hash = (cell as i64 as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        (hash as usize >> 6 & (self.filter.len() - 1), 1 << (hash & 63))
    }

    /// Whether a pair may cost between `cost` less the width and `cost`, give or take a rounding.
    fn may_hold(&self, cost: f64) -> bool {
        let low = ((cost - self.cell - cost.abs() * 1e-15) / self.cell).floor();
        let high = (cost / self.cell).floor();
        let holds = |cell: f64| {
            let (word, bit) = self.slot(cell);
            self.filter[word] & bit != 0
        };
        // Where a cell is narrower than a rounding, or cells leave the integers, the filter does not know.
        high - low > 2.0
            || high.abs() > 4e15
            || low.abs() > 4e15
            || holds(low)
            || holds(high)
            || (high - low > 1.0 && holds(low + 1.0))
    }

    /// Rises with the cost, rounding included.
    fn bucket(&self, cost: f64) -> usize {
        ((cost - self.least) * self.scale) as usize
    }

    /// The dearest pair that costs at most `cost`: by dominance the best of those.
    fn at_most(&self, prices: &Prices<T>, cost: T) -> Option<&'a Pair<T>> {
        let bucket = self.bucket(prices.cost_f64(cost)).min(self.starts.len() - 2);
        let (start, end) = (self.starts[bucket] as usize, self.starts[bucket + 1] as usize);
        let below = start + self.pairs[start..end].partition_point(|pair| pair.totals.cost <= cost);
        below.checked_sub(1).map(|i| &self.pairs[i])
    }
}

/// Takes a pair of combinations better than any before; returns the gain to beat and the limit from then on.
pub(super) type Found<'a, T> = dyn FnMut(&Pair<T>, &Pair<T>) -> (T, f64) + 'a;

/// Reports every pair of combinations, one of `held` with a loss up to half the limit and one of `streamed`, that gains
/// more than the best so far.
pub(super) fn meet<T: Number>(
    prices: &Prices<T>,
    [held, streamed]: [&Half<'_, T>; 2],
    floor: f64,
    limit: f64,
    to_beat: T,
    meter: &mut Meter<'_>,
    found: &mut Found<'_, T>,
) -> Result<(), Halt> {
    let pairs = held.list(limit / 2.0, meter)?;
    if pairs.is_empty() {
        return Ok(());
    }
    // More room left over than this is too large a gap by itself.
    let width = limit / prices.lambda * (1.0 + 1e-9);
    let index = Index::new(prices, &pairs, width);
    let best = std::cell::Cell::new((to_beat, limit));
    let visit = |pair: Pair<T>| {
        let left = prices.room - pair.totals.cost;
        if !index.may_hold(prices.cost_f64(left)) {
            return;
        }
        let gain = |other: &Pair<T>| pair.totals.benefit + other.totals.benefit;
        if let Some(other) = index.at_most(prices, left).filter(|other| gain(other) > best.get().0) {
            best.set(found(other, &pair));
        }
    };
    let row = |made| if meter.spend(made) { Ok(best.get().1) } else { Err(Halt::Stopped) };
    streamed.stream(floor, limit, visit, row)
}
