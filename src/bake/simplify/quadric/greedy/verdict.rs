//! Which contractions are allowed.

use glam::DVec3;

use super::step::Step;
use super::{Greedy, LARGEST_FAN, mark};
use crate::bake::simplify::link::{Complex, others};
use crate::bake::simplify::quadric::Topology;
use crate::bake::simplify::quadric::layer::Move;
use crate::bake::simplify::quadric::layers::Layers;

/// A contraction that changes the topology costs as if all that went into both ends moved by this share of their longest
/// edge. Higher keeps small parts at the expense of everything else; lower lets parts go that could be seen.
const TOPOLOGY_MOVES: f32 = 0.1;

/// Whether a step may be taken.
pub(super) enum Verdict {
    Yes,
    No,
    /// When it is the turn of what costs so much.
    For(f32),
}

impl Greedy<'_> {
    /// Whether a step is allowed.
    pub(super) fn may_contract(&mut self, step: &Step) -> Verdict {
        let &Step { way: Move { kept, gone, .. }, position, error, .. } = step;
        let to = position.as_dvec3() * self.scale;
        let both = self.marks[kept as usize] & self.marks[gone as usize];
        let may = both & mark::LOCKED == 0
            && self.in_units(error) <= self.most
            && !self.fans.of(gone).is_empty()
            && self.fans.of(kept).len() + self.fans.of(gone).len() <= LARGEST_FAN
            && self.guard_allows(kept, gone, to)
            && self.guard_allows(gone, kept, to);
        if !may {
            Verdict::No
        } else if self.keeps_topology(kept, gone) {
            Verdict::Yes
        } else {
            match self.method.topology {
                Topology::Preserved => Verdict::No,
                Topology::Free => self.price(step),
            }
        }
    }

    fn keeps_topology(&mut self, kept: u32, gone: u32) -> bool {
        let at_border = self.marks[kept as usize] & self.marks[gone as usize] & mark::BORDER != 0;
        let complex = Complex { triangles: &self.triangles, fans: &self.fans };
        complex.may_contract(kept, gone, at_border, &mut self.stamps) && self.keeps_charts(kept, gone)
    }

    /// A step that changes the topology has a price of its own: quadrics know of planes, and not that a part ends or a
    /// hole closes. That pairs without an edge join is what they are for.
    fn price(&self, step: &Step) -> Verdict {
        let Move { kept, gone, .. } = step.way;
        if self.around().edge(kept, gone).next().is_none() {
            return Verdict::Yes;
        }
        let moved = TOPOLOGY_MOVES * TOPOLOGY_MOVES * self.reach(kept).max(self.reach(gone));
        let price = (self.areas[kept as usize] + self.areas[gone as usize]) * moved;
        if self.in_units(f64::from(moved)) > self.most {
            Verdict::No
        } else if self.is_free || self.choices[kept as usize].cost() >= price {
            Verdict::Yes
        } else {
            Verdict::For(price)
        }
    }

    /// The squared length of the longest edge at a vertex.
    fn reach(&self, vertex: u32) -> f32 {
        let at = self.place(vertex);
        let ring = self.fans.of(vertex).iter().flat_map(|&t| self.triangles[t as usize]);
        ring.map(|v| self.place(v).distance_squared(at)).fold(0.0, f64::max) as f32
    }

    /// Whether what is between seams stays whole: two vertices on seams may become one only along a seam.
    fn keeps_charts(&self, kept: u32, gone: u32) -> bool {
        let both = self.marks[kept as usize] & self.marks[gone as usize];
        let is_seam = |layers| both & mark::BORDER != 0 || self.is_seam(layers, [kept, gone]);
        both & mark::SEAM == 0 || self.layers.as_ref().is_none_or(is_seam)
    }

    /// The distance, in object units, of a squared one between places.
    pub(super) fn in_units(&self, squared: f64) -> f32 {
        (squared.sqrt() / self.scale) as f32
    }

    /// Whether the triangles of a vertex, but for those that go with the edge to `other`, may follow it.
    fn guard_allows(&self, vertex: u32, other: u32, to: DVec3) -> bool {
        let from = self.place(vertex);
        self.fans.of(vertex).iter().all(|&t| {
            let [p, q] = others(self.triangles[t as usize], vertex);
            let side = || [self.place(p), self.place(q)];
            p == other || q == other || self.guard.allows(from, to, side(), self.facings[t as usize])
        })
    }

    /// Whether an edge is a seam that is held. One that has not two triangles is a border.
    pub(super) fn is_seam(&self, layers: &Layers, edge: [u32; 2]) -> bool {
        let mut sides = self.around().edge(edge[0], edge[1]);
        match (sides.next(), sides.next(), sides.next()) {
            (Some(s), Some(t), None) => layers.is_seam(self.around(), edge, [s, t]),
            _ => false,
        }
    }
}
