//! Which contraction of a vertex comes first.

use super::sieve::Sieve;
use super::{Greedy, LARGEST_FAN, mark};
use crate::bake::simplify::link::others;
use crate::bake::simplify::quadric::edges::{self, LANES};

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
        let is_plain = self.layers.is_none() && self.method.placement.is_least() && !self.is_locked(vertex);
        let mut cheapest = Choice::NONE;
        for &some in partners.list().as_chunks().0 {
            let costs = if is_plain { self.plain_costs(vertex, some) } else { [f32::NAN; LANES] };
            for (partner, cost) in some.into_iter().zip(costs) {
                let is_known = (!cost.is_nan() & !self.is_locked(partner)) | (partner == vertex);
                let cost = if is_known { cost } else { self.cost(vertex, partner) };
                let choice = Choice::new(cost, partner);
                let is_one = (choice >= from) & (partner != vertex);
                cheapest = if is_one { cheapest.min(choice) } else { cheapest };
            }
        }
        self.partners = partners;
        cheapest
    }

    /// Lists what a vertex may be contracted with.
    ///
    /// Where every edge has as many triangles in either direction it is enough to look at one corner of each. Filled up to
    /// whole vectors with the vertex itself.
    fn find_partners(&self, vertex: u32, partners: &mut Sieve<u32>) {
        let fan = self.fans.of(vertex);
        let fan = if fan.len() > LARGEST_FAN { &[] } else { fan };
        let is_odd = self.marks[vertex as usize] & mark::ODD != 0;
        let pairs = self.pairs.as_ref().filter(|_| !fan.is_empty()).map_or(&[][..], |pairs| pairs.of(vertex));
        partners.clear(2 * fan.len() + pairs.len() + LANES);
        for &triangle in fan {
            let [p, q] = others(self.triangles[triangle as usize], vertex);
            partners.add_if(p > vertex, p);
            if is_odd {
                partners.add_if(q > vertex, q);
            }
        }
        for &partner in pairs {
            partners.add_if(partner > vertex && !self.fans.of(partner).is_empty(), partner);
        }
        partners.fill_up(LANES, vertex);
    }

    /// What contracting a vertex with each of some partners costs where neither end is locked: not a number where there is
    /// no best place in reach.
    #[inline]
    fn plain_costs(&self, vertex: u32, partners: [u32; LANES]) -> [f32; LANES] {
        let end = |v: u32| (&self.quadrics[v as usize], &self.places[v as usize]);
        edges::costs(end(vertex), partners.map(end), self.method.cost)
    }
}
