//! Steadiness: from the optimum of a frame to levels that stay.
//!
//! A budget that is all spent makes the optimum restless: a fraction of a per cent more or less of what a frame costs
//! at least moves λ, and with it the levels of everything near it; a step that is large against the budget takes or
//! leaves room for a hundred small ones. So the optimum is *owed*, not shown. What is held stays, and every object
//! keeps account of what it is owed:
//!
//! - An object held finer than the optimum is kept while the budget lasts. When it does not, such objects are
//!   coarsened, those of the least benefit per cost first. Nothing else coarsens, and this always suffices: with all of
//!   them coarsened no more is spent than by the optimum.
//! - An object held coarser is owed the difference. It is refined when what it is owed, times how long, comes to the
//!   price of a switch: at once where much is owed, later where little is, never where the optimum changes its mind
//!   before. That is the break-even rule of renting or buying skis, which knows no future and pays at most twice what
//!   it would have paid had it known (Karlin, Manasse, Rudolph and Sleator, "Competitive snoopy caching", 1988).
//! - What lies just above λ is the first that the optimum changes its mind about. So a debt counts only by what it is
//!   worth beyond a few times λ; one that is worth more than that is paid soon however little it is, one that is worth
//!   less must wait.
//! - An object that was coarsened a moment ago would turn back. Refining it costs more than a switch.
//! - While all that is owed together is next to nothing, nothing is due: a camera at rest stays at rest under noise.
//! - Budget that would stay unspent, beyond a dead band, goes to debts that are not due, those of the most benefit
//!   first: that takes the fewest switches. Without it one dear level that is worth next to nothing leaves half the
//!   budget unspent for seconds.
//! - A leaky bucket per object bounds the worst rate of refinements, and with it that of switches.
//!
//! The same debts are paid in whatever order they are found. The optimum's upper bound certifies what is shown.

use std::cmp::Ordering;

use crate::frame::{Account, Deferral, OptionsError, Remembered};
use crate::knapsack::{FixedSum, Offer};
use crate::table::Level;

/// Options of a policy's steadiness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steadiness {
    /// Price of a switch: an object is refined when its surplus, times the time it has been owed, comes to so many
    /// seconds of the mean object's gain. Its surplus is the benefit it is owed less what its cost is worth elsewhere,
    /// by `margin`. From 0 to 3600. Higher switches less and shows later what is owed.
    pub patience_s: f32,
    /// The price is so many times higher for an object that was coarsened less than a second ago. From 1 to 1000.
    pub turn: f32,
    /// So many times the going rate of benefit per cost counts as what a cost is worth elsewhere: the going rate moves,
    /// and what lies just above it comes and goes. From 1 to 1000.
    pub margin: f32,
    /// What has a surplus and has been owed for so long is paid however little it is, but for what was coarsened less
    /// than a second ago.
    pub soon_ms: u16,
    /// What has been owed for so long is paid in any case. Decides when the last detail arrives.
    pub longest_ms: u16,
    /// While no more than this share of the gain is owed in all, nothing is due. In 0…1, exclusive.
    pub content: f64,
    /// Dead band of the budget, as a fraction of it: what is left beyond it goes to debts that are not due. In 0…1; at
    /// 1 none does. Higher switches less and leaves more unspent.
    pub spare: f64,
    /// So many refinements an object may have at once, from 1 to 15; after that one in 256 ms, however much it is owed.
    pub burst: u8,
}

/// A debt counts as owed for one frame of 60 Hz when it is first seen.
const FIRST_MS: f64 = 16.0;

impl Default for Steadiness {
    fn default() -> Self {
        Self {
            patience_s: 0.022,
            turn: 2.0,
            margin: 3.0,
            soon_ms: 250,
            longest_ms: 1000,
            content: 0.002,
            spare: 0.05,
            burst: 4,
        }
    }
}

impl Steadiness {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the option that is out of its range.
    pub fn check(&self) -> Result<(), OptionsError> {
        let patience = (0.0..=3600.0).contains(&self.patience_s);
        OptionsError::unless(patience, "patience_s", "must be from 0 to 3600")?;
        let factor = |x: f32| (1.0..=1000.0).contains(&x);
        OptionsError::unless(factor(self.turn), "turn", "must be from 1 to 1000")?;
        OptionsError::unless(factor(self.margin), "margin", "must be from 1 to 1000")?;
        let content = (0.0..1.0).contains(&self.content);
        OptionsError::unless(content, "content", "must be at least 0 and below 1")?;
        OptionsError::unless((0.0..=1.0).contains(&self.spare), "spare", "must be from 0 to 1")?;
        OptionsError::unless((1..=15).contains(&self.burst), "burst", "must be from 1 to 15")
    }

    /// Whether a bucket has no room for one more refinement.
    pub(super) fn is_full(&self, account: Account) -> bool {
        account.drops > (self.burst - 1) * Account::REFINEMENT_DROPS
    }

    /// Whether a debt is due. O(1).
    fn is_due(&self, debt: &Debt, optimum: &Optimum) -> bool {
        let seconds = (f64::from(debt.account.owed_ms) + FIRST_MS) / 1e3;
        let surplus = debt.benefit - f64::from(self.margin) * optimum.lambda * debt.cost as f64;
        let turn = if debt.turns { f64::from(self.turn) } else { 1.0 };
        let price = f64::from(self.patience_s) * turn * optimum.gain;
        surplus * seconds * optimum.objects as f64 >= price
            || debt.account.owed_ms >= self.wait_ms(debt, surplus)
    }

    /// After how long a debt is due however little it is.
    fn wait_ms(&self, debt: &Debt, surplus: f64) -> u16 {
        if debt.turns || surplus <= 0.0 { self.longest_ms } else { self.soon_ms.min(self.longest_ms) }
    }

    /// Whether so little is owed that nothing is due.
    fn is_content(&self, debts: &[Debt], optimum: &Optimum) -> bool {
        let mut owed = FixedSum::default();
        debts.iter().for_each(|debt| owed.add(debt.benefit / optimum.gain));
        owed.value() <= self.content
    }
}

/// A change back within this time is a reversal.
const TURN_MS: u32 = 1000;

/// An object whose optimum is another level than it holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    /// Which candidate, and its slot.
    pub candidate: u32,
    pub slot: u32,
    /// The level that it holds.
    pub level: Level,
}

/// Whether an object that holds `level` was coarsened so short a time ago that to refine it is to turn back.
fn was_finer(level: Level, remembered: &Remembered) -> bool {
    remembered.age_ms <= TURN_MS && remembered.account.from < level
}

/// What the optimum of a frame comes to. Costs in ticks, benefits in px².
#[derive(Clone, Copy, Debug)]
pub(super) struct Optimum {
    /// Benefit over the cheapest choice.
    pub gain: f64,
    /// How many objects there are.
    pub objects: usize,
    /// Worth of a tick.
    pub lambda: f64,
    /// Ticks it spends.
    pub cost: u64,
    /// Ticks there are.
    pub budget: u64,
    /// Ticks of them that are to be spent while anything is owed.
    pub enough: u64,
}

/// What an object that is held coarser than the optimum is owed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Debt {
    /// Which candidate, and its slot.
    pub candidate: u32,
    pub slot: u32,
    /// The level that the optimum has for it.
    pub best: Level,
    /// Benefit by which that is better than what is held, > 0.
    pub benefit: f64,
    /// Ticks by which it is dearer, > 0.
    pub cost: u64,
    /// What is remembered of it.
    pub account: Account,
    /// Whether it was coarsened a moment ago.
    pub turns: bool,
    /// Whether it is paid before it is due.
    is_paid: bool,
}

/// What an object that is held finer than the optimum has beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Credit {
    /// Which candidate, and its slot.
    pub candidate: u32,
    pub slot: u32,
    /// The level that the optimum has for it.
    pub best: Level,
    /// Benefit by which what is held is better, > 0.
    pub benefit: f64,
    /// Ticks by which it is dearer, > 0.
    pub cost: u64,
}

/// The accounts of a frame. [`Accounts::open`] them, then [`Accounts::settle`].
#[derive(Clone, Debug, Default)]
pub(super) struct Accounts {
    /// Before: what is owed. After: what still is.
    pub debts: Vec<Debt>,
    /// Before: what may be called in. After: what has not been.
    pub credits: Vec<Credit>,
    /// After: candidates that take the optimum's level, and that level. All others keep theirs.
    pub settled: Vec<(u32, Level)>,
}

impl Accounts {
    /// Forgets all accounts and keeps the memory.
    pub fn clear(&mut self) {
        self.debts.clear();
        self.credits.clear();
        self.settled.clear();
    }

    /// Makes room for an account for each of so many candidates, so that a frame with more of them than any before
    /// allocates nothing.
    pub fn make_room(&mut self, candidates: usize) {
        self.debts.reserve(candidates.saturating_sub(self.debts.len()));
        self.credits.reserve(candidates.saturating_sub(self.credits.len()));
        self.settled.reserve(candidates.saturating_sub(self.settled.len()));
    }

    /// Opens the account of a candidate whose optimum is another level than it holds. Where the optimum's is better at
    /// no more cost, or cheaper at no less benefit, it is settled without more ado.
    pub fn open(
        &mut self,
        held: Held,
        best: Level,
        [old, new]: [Offer; 2],
        remembered: impl FnOnce() -> Remembered,
    ) {
        let (benefit, Held { candidate, slot, level }) = (new.benefit - old.benefit, held);
        if new.ticks > old.ticks && benefit > 0.0 {
            let (cost, remembered) = (new.ticks - old.ticks, remembered());
            let (turns, account) = (was_finer(level, &remembered), remembered.account);
            self.debts.push(Debt { candidate, slot, best, benefit, cost, account, turns, is_paid: false });
        } else if new.ticks < old.ticks && benefit < 0.0 {
            let cost = old.ticks - new.ticks;
            self.credits.push(Credit { candidate, slot, best, benefit: -benefit, cost });
        } else {
            self.settled.push((candidate, best));
        }
    }

    /// Pays the debts that are due, then calls in credits, the least benefit per cost first, until the budget is kept,
    /// and spends what is left beyond the dead band on other debts, the most benefit first; the lower `key` of a
    /// candidate goes first. Returns the cost.
    ///
    /// O(accounts), and a sort of about so many credits as are called in, or of debts as are paid early.
    pub fn settle(&mut self, steadiness: &Steadiness, optimum: &Optimum, key: impl Fn(u32) -> u128) -> u64 {
        let mut cost = self.held_cost(optimum);
        if !steadiness.is_content(&self.debts, optimum) {
            self.pay(|debt| {
                let pays = steadiness.is_due(debt, optimum) && !steadiness.is_full(debt.account);
                cost = cost.saturating_add(if pays { debt.cost } else { 0 });
                pays
            });
        }
        if cost > optimum.budget {
            cost = cost.saturating_sub(self.call_in(cost - optimum.budget, &key));
        }
        if cost < optimum.enough {
            cost = self.pay_early(steadiness, optimum, cost, &key);
        }
        cost
    }

    /// Pays debts, the most benefit first, until enough is spent. Returns the cost.
    fn pay_early(
        &mut self,
        steadiness: &Steadiness,
        optimum: &Optimum,
        mut cost: u64,
        key: &impl Fn(u32) -> u128,
    ) -> u64 {
        let order = |a: &Debt, b: &Debt| {
            b.benefit.total_cmp(&a.benefit).then_with(|| key(a.candidate).cmp(&key(b.candidate)))
        };
        let looked_at = in_order(&mut self.debts, order, |debt| {
            let fits = cost < optimum.enough && debt.cost <= optimum.budget - cost;
            debt.is_paid = fits && !steadiness.is_full(debt.account);
            cost += if debt.is_paid { debt.cost } else { 0 };
            cost < optimum.enough
        });
        let paid = self.debts[..looked_at].iter().filter(|debt| debt.is_paid);
        self.settled.extend(paid.map(|debt| (debt.candidate, debt.best)));
        self.debts.retain(|debt| !debt.is_paid);
        cost
    }

    /// Who does not hold the optimum's level after all, in no order.
    pub fn deferrals(&self) -> impl Iterator<Item = Deferral> + '_ {
        let debts = self.debts.iter().map(|d| (d.candidate, d.slot, d.best, true));
        let credits = self.credits.iter().map(|c| (c.candidate, c.slot, c.best, false));
        debts.chain(credits).map(|(candidate, slot, chosen, owed)| Deferral { candidate, slot, chosen, owed })
    }

    /// What the open accounts make of the optimum's benefit.
    pub fn benefit(&self, optimum: f64) -> f64 {
        let mut held = FixedSum::default();
        self.debts.iter().for_each(|debt| held.add(-debt.benefit));
        self.credits.iter().for_each(|credit| held.add(credit.benefit));
        optimum + held.value()
    }

    /// What is spent when nobody switches.
    fn held_cost(&self, optimum: &Optimum) -> u64 {
        let kept = self.credits.iter().fold(optimum.cost, |sum, c| sum.saturating_add(c.cost));
        self.debts.iter().fold(kept, |sum, d| sum.saturating_sub(d.cost))
    }

    /// Pays the debts that `pays` says to.
    fn pay(&mut self, mut pays: impl FnMut(&Debt) -> bool) {
        let settled = &mut self.settled;
        self.debts.retain(|debt| {
            let is_paid = pays(debt);
            if is_paid {
                settled.push((debt.candidate, debt.best));
            }
            !is_paid
        });
    }

    /// Calls in credits of `over` ticks or more, or all. Returns how many ticks they come to.
    fn call_in(&mut self, over: u64, key: &impl Fn(u32) -> u128) -> u64 {
        let slope = |credit: &Credit| credit.benefit / credit.cost as f64;
        let order = |a: &Credit, b: &Credit| {
            slope(a).total_cmp(&slope(b)).then_with(|| key(a.candidate).cmp(&key(b.candidate)))
        };
        let mut freed = 0u64;
        let called = in_order(&mut self.credits, order, |credit| {
            freed = freed.saturating_add(credit.cost);
            freed < over
        });
        self.settled.extend(self.credits.drain(..called).map(|credit| (credit.candidate, credit.best)));
        freed
    }
}

/// Puts a list into order from its start until `goes_on` says no. Returns how many entries it was asked about.
///
/// O(n) where it says no soon, else a sort.
fn in_order<T>(
    list: &mut [T],
    order: impl Fn(&T, &T) -> Ordering,
    mut goes_on: impl FnMut(&mut T) -> bool,
) -> usize {
    let (mut start, mut size) = (0, 64);
    while start < list.len() {
        let rest = &mut list[start..];
        let end = size.min(rest.len());
        if end < rest.len() {
            rest.select_nth_unstable_by(end - 1, &order);
        }
        rest[..end].sort_unstable_by(&order);
        if let Some(at) = rest[..end].iter_mut().position(|entry| !goes_on(entry)) {
            return start + at + 1;
        }
        (start, size) = (start + end, size * 4);
    }
    list.len()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Benefit, ticks, and what is remembered of an object that holds level 2.
    type Entry = (f64, u64, Remembered);

    /// It has held that level for so long, after level `from`.
    fn held(age_ms: u32, from: u8, owed_ms: u16, drops: u8) -> Remembered {
        Remembered { age_ms, account: Account { owed_ms, drops, from: Level(from) } }
    }

    /// It holds what it holds for long.
    fn owed(owed_ms: u16) -> Remembered {
        held(u32::MAX, 0, owed_ms, 0)
    }

    fn holder(i: usize) -> Held {
        Held { candidate: i as u32, slot: i as u32, level: Level(2) }
    }

    fn entry() -> impl Strategy<Value = Entry> {
        let held = (0..2000u32, 0..4u8, 0..2000u16, any::<u8>())
            .prop_map(|(age_ms, from, owed_ms, drops)| held(age_ms, from, owed_ms, drops));
        (prop_oneof![0.0..10.0, Just(1.0)], 1..1000u64, held)
    }

    fn entries() -> impl Strategy<Value = Vec<Entry>> {
        prop::collection::vec(entry(), 0..20)
    }

    fn steadiness() -> impl Strategy<Value = Steadiness> {
        let prices = (0.0..1f32, 1.0..10f32, 1.0..100f32);
        (prices, 0..2000u16, 0..2000u16, 0.0..0.5, 1..=15u8).prop_map(
            |((patience_s, turn, margin), soon_ms, longest_ms, content, burst)| {
                let times = Steadiness { soon_ms, longest_ms, ..Steadiness::default() };
                Steadiness { patience_s, turn, margin, content, burst, ..times }
            },
        )
    }

    /// Debts first, then credits, each candidate numbered by its place.
    fn accounts(debts: &[Entry], credits: &[Entry]) -> Accounts {
        let mut accounts = Accounts::default();
        let offer = |ticks: u64, benefit: f64| Offer { ticks: 50 + ticks, benefit };
        let all = debts.iter().map(|e| (e, true)).chain(credits.iter().map(|e| (e, false)));
        for (i, (&(benefit, cost, held), is_debt)) in all.enumerate() {
            let [little, much] = [offer(0, 0.0), offer(cost, benefit + 0.01)];
            let offers = if is_debt { [little, much] } else { [much, little] };
            accounts.open(holder(i), Level(0), offers, || held);
        }
        accounts
    }

    /// Candidates that settle, and what is spent.
    fn settled(mut accounts: Accounts, steadiness: &Steadiness, optimum: &Optimum) -> (Vec<u32>, u64) {
        let cost = accounts.settle(steadiness, optimum, u128::from);
        let mut settled: Vec<u32> = accounts.settled.iter().map(|&(i, _)| i).collect();
        settled.sort_unstable();
        (settled, cost)
    }

    /// An optimum of 10 000 ticks beside those of the debts, of which `spare` are to stay.
    fn optimum(debts: &[Entry], left: u64, spare: u64) -> Optimum {
        let cost = 10_000 + debts.iter().map(|d| d.1).sum::<u64>();
        let budget = cost + left;
        Optimum { gain: 500.0, objects: 100, lambda: 1e-3, cost, budget, enough: budget - spare }
    }

    proptest! {
        #[test]
        fn the_budget_is_kept_and_spent_and_the_order_does_not_matter(
            debts in entries(),
            credits in entries(),
            (left, spare) in (0..3000u64, 0..3000u64),
            steadiness in steadiness(),
        ) {
            let optimum = optimum(&debts, left, spare);
            let mut forwards = accounts(&debts, &credits);
            let mut backwards = forwards.clone();
            backwards.debts.reverse();
            backwards.credits.reverse();
            let (paid, cost) = settled(forwards.clone(), &steadiness, &optimum);
            prop_assert_eq!((&paid, cost), (&settled(backwards, &steadiness, &optimum).0, cost));
            forwards.settle(&steadiness, &optimum, u128::from);
            let still_owed: u64 = forwards.debts.iter().map(|d| d.cost).sum();
            let kept: u64 = forwards.credits.iter().map(|c| c.cost).sum();
            prop_assert_eq!(cost, optimum.cost + kept - still_owed);
            prop_assert!(cost <= optimum.budget);
            let affordable = |d: &Debt| cost + d.cost <= optimum.budget && !steadiness.is_full(d.account);
            prop_assert!(cost >= optimum.enough || !forwards.debts.iter().any(affordable));
            let full = |d: &Entry| steadiness.is_full(d.2.account);
            prop_assert!(paid.iter().all(|&i| debts.get(i as usize).is_none_or(|d| !full(d))));
        }
    }

    #[test]
    fn no_more_credits_are_called_in_than_the_budget_asks_for() {
        let credit = |benefit: f64| (benefit, 10, owed(0));
        let found = accounts(&[], &[credit(5.0), credit(1.0), credit(3.0)]);
        assert_eq!(settled(found, &Steadiness::default(), &optimum(&[], 15, 15)), (vec![1, 2], 10_010));
    }

    /// Whether a debt of 100 ticks is paid beside one that cannot be.
    fn is_paid(steadiness: &Steadiness, benefit: f64, held: Remembered) -> bool {
        let full = Remembered { account: Account { drops: 255, ..Account::NEW }, ..owed(0) };
        let debts = [(benefit, 100, held), (20.0, 100, full)];
        let optimum = optimum(&debts, 0, 1000);
        settled(accounts(&debts, &[]), steadiness, &optimum).0 == [0]
    }

    #[test]
    fn much_is_paid_at_once_and_little_later() {
        let default = Steadiness::default();
        let is_paid = |benefit: f64, owed_ms: u16| is_paid(&default, benefit, owed(owed_ms));
        assert!(is_paid(100.0, 0));
        assert!(!is_paid(1.0, 0) && is_paid(1.0, 150));
        assert!(!is_paid(0.35, 249) && is_paid(0.35, 250));
        // Worth no more than 3 · λ · cost = 0.3.
        assert!(!is_paid(0.25, 999) && is_paid(0.25, 1000));
    }

    #[test]
    fn who_would_turn_back_waits_longer() {
        let default = Steadiness::default();
        let coarsened = |age_ms: u32, owed_ms: u16| held(age_ms, 1, owed_ms, 0);
        assert!(
            is_paid(&default, 1.0, coarsened(1001, 150)) && !is_paid(&default, 1.0, coarsened(1000, 150))
        );
        assert!(is_paid(&default, 1.0, coarsened(1000, 300)));
        assert!(
            !is_paid(&default, 0.35, coarsened(999, 999)) && is_paid(&default, 0.35, coarsened(999, 1000))
        );
        // What was refined a moment ago goes on in the same direction.
        assert!(is_paid(&default, 1.0, held(100, 3, 150, 0)));
    }

    proptest! {
        #[test]
        fn a_debt_that_waits_longer_or_is_worth_more_is_paid_no_later(
            (benefit, more) in (0.0..10.0, 0.0..10.0),
            (owed_ms, longer_ms) in (0..2000u16, 0..2000u16),
            (age_ms, from) in (0..2000u32, 0..4u8),
            steadiness in steadiness(),
        ) {
            let paid = |benefit: f64, owed_ms: u16| is_paid(&steadiness, benefit, held(age_ms, from, owed_ms, 0));
            prop_assert!(!paid(benefit, owed_ms) || paid(benefit + more, owed_ms + longer_ms));
            let calm = is_paid(&steadiness, benefit, held(age_ms, 3, owed_ms, 0));
            prop_assert!(calm || !paid(benefit, owed_ms));
        }
    }

    #[test]
    fn what_would_stay_unspent_pays_the_most_first() {
        let debts = [1.0, 3.0, 2.0].map(|benefit| (benefit, 100, owed(0)));
        let paid = |spare: u64| {
            let patient = Steadiness { patience_s: 3600.0, ..Steadiness::default() };
            settled(accounts(&debts, &[]), &patient, &optimum(&debts, 0, spare)).0
        };
        assert_eq!([paid(300), paid(200), paid(150), paid(0)], [vec![], vec![1], vec![1, 2], vec![0, 1, 2]]);
    }

    #[test]
    fn what_is_better_for_no_more_is_taken_at_once() {
        let mut accounts = Accounts::default();
        let offer = |ticks: u64, benefit: f64| Offer { ticks, benefit };
        let offers =
            [[offer(5, 1.0), offer(5, 2.0)], [offer(5, 1.0), offer(4, 1.0)], [offer(4, 2.0), offer(5, 2.0)]];
        for (i, offers) in offers.into_iter().enumerate() {
            accounts.open(holder(i), Level(i as u8), offers, || owed(0));
        }
        assert_eq!(accounts.settled, [(0, Level(0)), (1, Level(1)), (2, Level(2))]);
        assert!(accounts.debts.is_empty() && accounts.credits.is_empty());
    }
}
