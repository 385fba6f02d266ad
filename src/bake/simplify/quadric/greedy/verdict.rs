//! Which contractions are allowed.

use super::step::Step;
use super::{Greedy, LARGEST_FAN, mark};
use crate::bake::simplify::link::{Complex, others};
use crate::bake::simplify::quadric::layer::Move;
use crate::bake::simplify::quadric::layers::Layers;
use crate::bake::simplify::quadric::rest::{Neighbour, Rest};
use crate::bake::simplify::quadric::{Cost, Topology};

/// A contraction costs no less than if this share of all that went into both ends were as far off as the ends will be:
/// a tip that goes takes a cone with it.
const TIP: f64 = 0.5;

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
        let &Step { way: Move { kept, gone, .. }, to, error, .. } = step;
        let both = self.marks[kept as usize] & self.marks[gone as usize];
        let may = both & mark::LOCKED == 0
            && self.in_units(error) <= self.most
            && !self.fans.of(gone).is_empty()
            && self.fans.of(kept).len() + self.fans.of(gone).len() <= LARGEST_FAN;
        if !may {
            return Verdict::No;
        }
        self.find_rest(kept, gone);
        let Some(distances2) = Rest::follow(&self.rest, to, self.guard) else { return Verdict::No };
        if self.keeps_topology(kept, gone) {
            self.price_of_tips(step, distances2)
        } else {
            match self.method.topology {
                Topology::Preserved => Verdict::No,
                Topology::Free => self.price_of_topology(step),
            }
        }
    }

    /// Finds what is around both ends of an edge, and what of that would be left.
    fn find_rest(&mut self, kept: u32, gone: u32) {
        let (places, facings) = (&self.places[..], &self.facings[..]);
        let ends = [[kept, gone], [gone, kept]];
        for ((ring, rest), [vertex, other]) in self.rings.iter_mut().zip(&mut self.rest).zip(ends) {
            let fan = self.fans.of(vertex);
            ring.resize(fan.len(), [0; 2]);
            let neighbours = fan.iter().zip(ring).map(|(&triangle, side)| {
                let [p, q] = others(self.triangles[triangle as usize], vertex);
                *side = [p, q];
                Neighbour {
                    stays: (p != other) & (q != other),
                    side: [places[p as usize], places[q as usize]],
                    facing: facings[triangle as usize],
                }
            });
            rest.fill(places[vertex as usize], neighbours);
        }
    }

    /// Quadrics know of planes, and not where they end: a needle may slide back along itself at hardly any cost. So how
    /// far both ends are from what would be left is looked at, too, when it is a contraction's turn. `own` is how far,
    /// squared, each is from what its own triangles become: where an end was there is mostly one of those.
    fn price_of_tips(&self, step: &Step, own: [f64; 2]) -> Verdict {
        let paid = self.choices[step.way.kept as usize].cost();
        if self.method.cost == Cost::Sum || self.price_of_distance(step, own[0].max(own[1])) <= paid {
            return Verdict::Yes;
        }
        let &Step { way: Move { kept, gone, .. }, to, .. } = step;
        let distance2 = |end: usize, vertex| self.rest[end].distance2(to, self.place(vertex));
        let other = [distance2(1, kept), distance2(0, gone)];
        let price = self.price_of_distance(step, own[0].min(other[0]).max(own[1].min(other[1])));
        if price > paid { Verdict::For(price) } else { Verdict::Yes }
    }

    /// What a step costs at which both ends come to be that far, squared, from what is left.
    fn price_of_distance(&self, step: &Step, distance2: f64) -> f32 {
        let area = TIP * f64::from(step.patch.area);
        self.method.cost.of(area * distance2, area)
    }

    fn keeps_topology(&mut self, kept: u32, gone: u32) -> bool {
        let at_border = self.marks[kept as usize] & self.marks[gone as usize] & mark::BORDER != 0;
        let complex = Complex { triangles: &self.triangles, fans: &self.fans };
        complex.may_contract([kept, gone], &self.rings, at_border, &mut self.stamps)
            && self.keeps_charts(kept, gone)
    }

    /// Quadrics know of planes, and not that a part ends or a hole closes. So a step that changes the topology always
    /// costs what a tip does: by how far from what is left the vertices are that go. That pairs without an edge join is
    /// what they are for.
    fn price_of_topology(&self, step: &Step) -> Verdict {
        let &Step { way: Move { kept, gone, .. }, to, .. } = step;
        if self.around().edge(kept, gone).next().is_none() {
            return Verdict::Yes;
        }
        let going = self.stranded(kept, gone).chain([kept, gone]);
        let distances2 = |v| self.rest.each_ref().map(|rest| rest.distance2(to, self.place(v)));
        let farthest2 = going.map(distances2).map(|[a, b]| a.min(b)).fold(0.0, f64::max);
        let price = self.price_of_distance(step, farthest2);
        if self.in_units(farthest2) > self.most {
            Verdict::No
        } else if self.is_free || self.choices[kept as usize].cost() >= price {
            Verdict::Yes
        } else {
            Verdict::For(price)
        }
    }

    /// The vertices that have triangles at an edge and nowhere else: they go with it.
    fn stranded(&self, a: u32, b: u32) -> impl Iterator<Item = u32> {
        let far = self.around().edge(a, b).flat_map(|t| self.triangles[t]).filter(move |&v| v != a && v != b);
        let is_at_edge = move |&t: &u32| {
            let corners = self.triangles[t as usize];
            corners.contains(&a) && corners.contains(&b)
        };
        far.filter(move |&vertex| self.fans.of(vertex).iter().all(is_at_edge))
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

    /// Whether an edge is a seam that is held. One that has not two triangles is a border.
    pub(super) fn is_seam(&self, layers: &Layers, edge: [u32; 2]) -> bool {
        let mut sides = self.around().edge(edge[0], edge[1]);
        match (sides.next(), sides.next(), sides.next()) {
            (Some(s), Some(t), None) => layers.is_seam(self.around(), edge, [s, t]),
            _ => false,
        }
    }
}
