//! Which contraction of a vertex comes first.

use super::{Greedy, LARGEST_FAN, mark};
use crate::bake::simplify::link::others;
use crate::bake::simplify::quadric::edges::ROOM;

/// A contraction of a vertex, with one of higher index: the bits of its cost, then the partner, so that whole numbers
/// order them by cost and then by partner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Choice(u64);

impl Choice {
    /// The choice after all others.
    const NONE: Self = Self(u64::MAX);

    /// A cost that is not a number comes last.
    #[inline]
    pub(super) fn new(cost: f32, partner: u32) -> Self {
        Self(u64::from(cost.abs().to_bits()) << 32 | u64::from(partner))
    }

    pub(super) fn cost(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    pub(super) fn partner(self) -> u32 {
        self.0 as u32
    }
}

impl Greedy<'_> {
    /// Chooses the cheapest contraction of a vertex above that one, and puts it into the queue.
    pub(super) fn choose(&mut self, vertex: u32, above: Option<Choice>) {
        let choice = self.cheapest(vertex, above.map_or(Choice(0), |Choice(c)| Choice(c + 1)));
        let marks = &mut self.marks[vertex as usize];
        *marks &= !(mark::IDLE | mark::SETTLED);
        *marks |= if above.is_some() { mark::SETTLED } else { 0 };
        if choice == Choice::NONE {
            *marks |= mark::IDLE;
            return;
        }
        self.choices[vertex as usize] = choice;
        self.queue.push(choice.cost(), vertex);
    }

    /// Has a vertex come again with the next of its choices, or with this one at a price if that is less.
    pub(super) fn put_off(&mut self, vertex: u32, choice: Choice, price: f32) {
        let next = self.cheapest(vertex, Choice(choice.0 + 1));
        self.marks[vertex as usize] |= mark::SETTLED;
        self.choices[vertex as usize] = next.min(Choice::new(price, choice.partner()));
        self.queue.push(self.choices[vertex as usize].cost(), vertex);
    }

    /// The cheapest contraction of a vertex from that one on.
    fn cheapest(&mut self, vertex: u32, from: Choice) -> Choice {
        let mut partners = std::mem::take(&mut self.partners);
        self.find_partners(vertex, &mut partners);
        let mut cheapest = Choice::NONE;
        for some in partners.chunks(ROOM) {
            let costs = self.costs(vertex, some);
            for (&partner, cost) in some.iter().zip(costs) {
                let choice = Choice::new(cost, partner);
                cheapest = if choice >= from { cheapest.min(choice) } else { cheapest };
            }
        }
        self.partners = partners;
        cheapest
    }

    /// Lists what a vertex may be contracted with.
    ///
    /// Where every edge has as many triangles in either direction it is enough to look at one corner of each.
    fn find_partners(&self, vertex: u32, partners: &mut Vec<u32>) {
        partners.clear();
        let fan = self.fans.of(vertex);
        if fan.is_empty() || fan.len() > LARGEST_FAN {
            return;
        }
        let sides = fan.iter().map(|&t| others(self.triangles[t as usize], vertex));
        if self.marks[vertex as usize] & mark::ODD != 0 {
            partners.extend(sides.flatten().filter(|&p| p > vertex));
        } else {
            retain_above(vertex, sides.map(|[p, _]| p), partners);
        }
        if let Some(pairs) = &self.pairs {
            let is_left = |p: &&u32| **p > vertex && !self.fans.of(**p).is_empty();
            partners.extend(pairs.of(vertex).iter().filter(is_left));
        }
    }

    /// What contracting a vertex with each of some partners costs, [`ROOM`] at most.
    #[inline]
    fn costs(&mut self, vertex: u32, partners: &[u32]) -> [f32; ROOM] {
        let is_plain = self.layers.is_none() && self.method.placement.is_least() && !self.is_locked(vertex);
        let mut costs = if is_plain { self.plain_costs(vertex, partners) } else { [f32::NAN; ROOM] };
        for (cost, &partner) in costs.iter_mut().zip(partners) {
            if cost.is_nan() || self.is_locked(partner) {
                *cost = self.cost(vertex, partner);
            }
        }
        costs
    }

    /// The same where neither end is locked, as far as there is a best place in reach.
    #[inline]
    fn plain_costs(&mut self, vertex: u32, partners: &[u32]) -> [f32; ROOM] {
        let Self { edges, places, quadrics, .. } = self;
        let place = |v: u32| places[v as usize];
        let at = place(vertex);
        let ends = partners.iter().map(|&p| (&quadrics[p as usize], place(p) - at));
        edges.costs(&quadrics[vertex as usize], ends, self.method.cost)
    }
}

/// Replaces a list by those of some vertices that are above one. Without branches: nobody can predict which are.
#[inline]
fn retain_above(vertex: u32, some: impl ExactSizeIterator<Item = u32>, list: &mut Vec<u32>) {
    list.resize(some.len(), 0);
    let mut len = 0;
    for other in some {
        list[len] = other;
        len += usize::from(other > vertex);
    }
    list.truncate(len);
}
