//! A choice under construction, and what the greedy does to it.

use super::Item;
use super::dyadic::Number;
use super::greedy::Effort;
use super::ledger::{Ledger, Totals};
use super::meter::Meter;
use super::relaxation::{Edge, HullStep, Relaxation};
use super::repair::{Exchange, Goal, Repair};

/// One item of every class, with its totals.
#[derive(Clone, Debug)]
pub(super) struct Attempt<'a, T> {
    ledger: &'a Ledger<'a, T>,
    pub choice: Vec<u32>,
    pub totals: Totals<T>,
}

impl<'a, T: Number> Attempt<'a, T> {
    pub fn new(ledger: &'a Ledger<'a, T>, choice: Vec<u32>) -> Self {
        let totals = ledger.totals(&choice);
        Self { ledger, choice, totals }
    }

    /// Totals once `class` has chosen `item`.
    fn with(&self, class: u32, item: u32) -> Totals<T> {
        let old = self.ledger.item(class as usize, self.choice[class as usize]);
        let new = self.ledger.item(class as usize, item);
        Totals {
            cost: self.totals.cost - self.ledger.cost(old) + self.ledger.cost(new),
            benefit: self.totals.benefit - self.ledger.benefit(old) + self.ledger.benefit(new),
        }
    }

    fn switch(&mut self, class: u32, item: u32) {
        self.totals = self.with(class, item);
        self.choice[class as usize] = item;
    }

    /// Takes every step that starts where its class stands and fits, while the meter lasts; returns the first that did
    /// not fit or was not looked at.
    ///
    /// A class whose step was skipped never again stands where one of its steps starts: it is blocked.
    pub fn walk(&mut self, steps: &[HullStep], meter: &mut Meter<'_>) -> Option<Edge<T>> {
        let mut edge = None;
        for (at, &step) in steps.iter().enumerate() {
            let go_on = meter.spend(1);
            if go_on && self.choice[step.class as usize] != step.from {
                continue;
            }
            if go_on && self.with(step.class, step.to).cost <= self.ledger.budget {
                self.switch(step.class, step.to);
            } else if edge.is_none() {
                edge = Some(Edge { at, step, before: self.totals });
            }
            if !go_on {
                break;
            }
        }
        edge
    }

    /// The attempt that takes the item of `first` first.
    pub fn rival(mut self, first: HullStep, steps: &[HullStep], meter: &mut Meter<'_>) -> Self {
        self.switch(first.class, first.to);
        self.walk(steps, meter);
        self
    }

    /// This attempt if it is the better one, else the other.
    pub fn better_than(self, other: Self) -> Self {
        if self.totals.benefit > other.totals.benefit { self } else { other }
    }

    /// Exchanges items with slopes near λ where that gains: once for those of the relaxation, where every exchange
    /// loses a little but what is left over, and once for those of the best attempt so far, where less is left and
    /// smaller exchanges help.
    pub fn repair(
        &mut self,
        relaxation: &Relaxation,
        steps: &[HullStep],
        effort: Effort,
        meter: &mut Meter<'_>,
    ) {
        let mut base = Self::new(self.ledger, relaxation.choice.clone());
        for _ in 0..2 {
            if let Some(better) = base.exchanged(self.totals.benefit, relaxation.lambda, effort, meter) {
                *self = better;
                self.walk(steps, meter);
            }
            base = self.clone();
        }
    }

    /// This attempt after the best exchanges, if they come to more than `benefit`.
    fn exchanged(&self, benefit: T, lambda: f64, effort: Effort, meter: &mut Meter<'_>) -> Option<Self> {
        let (room, to_beat) = (self.ledger.budget - self.totals.cost, benefit - self.totals.benefit);
        let priced_room = (lambda * room.to_f64(self.ledger.cost_unit)).min(f64::MAX);
        let limit = priced_room - to_beat.to_f64(self.ledger.benefit_unit);
        let mut exchanges = self.nearest_exchanges(lambda, effort.exchanges);
        let mut repair = Repair::new(effort.states);
        repair.run(&mut exchanges, Goal { room, to_beat, limit }, meter)?;
        let mut exchanged = self.clone();
        for &at in repair.found() {
            exchanged.switch(exchanges[at as usize].class, exchanges[at as usize].item);
        }
        Some(exchanged)
    }

    /// The `count` items beside the chosen ones with the slopes, seen from there, that are nearest to λ.
    fn nearest_exchanges(&self, lambda: f64, count: usize) -> Vec<Exchange<T>> {
        let mut nearest: Vec<Nearness> = Vec::with_capacity(self.ledger.instance.items().len());
        for (class, (items, &chosen)) in self.ledger.instance.classes().zip(&self.choice).enumerate() {
            let others = (0..items.len() as u32).filter(|&item| item != chosen);
            let here = items[chosen as usize];
            nearest.extend(others.map(|item| Nearness::new(lambda, class, item, here, items[item as usize])));
        }
        nearest.retain(|nearness| nearness.apart.is_finite());
        if count < nearest.len() {
            let order = |a: &Nearness, b: &Nearness| {
                a.apart.total_cmp(&b.apart).then((a.class, a.item).cmp(&(b.class, b.item)))
            };
            nearest.select_nth_unstable_by(count, order);
            nearest.truncate(count);
        }
        nearest.iter().map(|nearness| self.exchange(nearness)).collect()
    }

    fn exchange(&self, &Nearness { class, item, loss, apart }: &Nearness) -> Exchange<T> {
        let Totals { cost, benefit } = self.with(class, item);
        let (cost, gain) = (cost - self.totals.cost, benefit - self.totals.benefit);
        Exchange { key: class.into(), class, item, cost, gain, loss, apart }
    }
}

/// An item and how near to λ its slope is, seen from another of its class.
#[derive(Clone, Copy, Debug)]
struct Nearness {
    class: u32,
    item: u32,
    loss: f64,
    apart: f64,
}

impl Nearness {
    fn new(lambda: f64, class: usize, item: u32, from: Item, to: Item) -> Self {
        let cost = to.cost - from.cost;
        let loss = lambda * cost - (to.benefit - from.benefit);
        Self { class: class as u32, item, loss, apart: loss / cost.abs() }
    }
}
