//! What the edges of a vertex cost, several at once.
//!
//! Costs are most of what simplification computes. They are computed in columns here, one for each number that is known
//! of the far ends, by a loop without branches that is compiled to vectors of two edges or of four. The same operations
//! in the same order as for one edge give the same bits.

use glam::DVec3;

use super::cost::Cost;
use super::form::{Form, Quadric};
use super::placement::Spot;
use crate::kernel::{self, Kernel};

/// So many edges at once. Most vertices have fewer.
pub(super) const ROOM: usize = 16;

/// A multiple of the edges in one vector of the widths in use.
const LANES: usize = 4;

/// The far ends of some edges of a vertex, in columns.
pub(super) struct Edges {
    /// Their quadrics, as in [`Form::to_array`].
    forms: [[f64; ROOM]; 10],
    /// Where they are, seen from the vertex.
    places: [[f64; ROOM]; 3],
}

impl Edges {
    pub(super) fn new() -> Self {
        Self { forms: [[0.0; ROOM]; 10], places: [[0.0; ROOM]; 3] }
    }

    /// Per edge of a vertex, [`ROOM`] at most, what it costs to contract it to where the error is least; not a number
    /// where that place is out of reach. Ends are quadrics and where they are, seen from the vertex.
    #[inline]
    pub(super) fn costs<'a>(
        &mut self,
        from: &Quadric,
        ends: impl Iterator<Item = (&'a Quadric, DVec3)>,
        cost: Cost,
    ) -> [f32; ROOM] {
        let mut len = 0;
        for (quadric, edge) in ends.take(ROOM) {
            self.set(len, quadric, edge);
            len += 1;
        }
        kernel::run(Costs { edges: self, len, from: from.form(), cost })
    }

    #[inline]
    fn set(&mut self, at: usize, quadric: &Quadric, edge: DVec3) {
        for (column, number) in self.forms.iter_mut().zip(quadric.form().to_array()) {
            column[at] = number;
        }
        for (column, number) in self.places.iter_mut().zip(edge.to_array()) {
            column[at] = number;
        }
    }
}

/// What the first `len` edges cost.
struct Costs<'a> {
    edges: &'a Edges,
    len: usize,
    from: Form,
    cost: Cost,
}

impl Kernel for Costs<'_> {
    type Sum = [f32; ROOM];

    #[inline(always)]
    fn run(self) -> Self::Sum {
        let mut costs = [0.0; ROOM];
        let [xx, yy, zz, yz, zx, xy, bx, by, bz, c] = &self.edges.forms;
        let [x, y, z] = &self.edges.places;
        // No less than whole vectors: what is too much is nobody's.
        for i in 0..self.len.next_multiple_of(LANES).min(ROOM) {
            let far = [xx[i], yy[i], zz[i], yz[i], zx[i], xy[i], bx[i], by[i], bz[i], c[i]];
            let (far, edge) = (Form::from_array(far), DVec3::new(x[i], y[i], z[i]));
            let sum = self.from + far.seen_from(-edge);
            let (spot, is_in_reach) = Spot::least(edge, &sum);
            let least = self.cost.of_edge(spot.error, edge, &sum);
            costs[i] = if is_in_reach { least } else { f32::NAN };
        }
        costs
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::placement::Placement;
    use super::*;

    fn point() -> impl Strategy<Value = DVec3> {
        [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array)
    }

    /// Three planes nearby; two or three of them the same now and then.
    fn quadric() -> impl Strategy<Value = Quadric> {
        prop::collection::vec((point(), point(), 0.0..2.0f64), 1..4).prop_map(|planes| {
            let plane = |(normal, through, weight): &(DVec3, DVec3, f64)| {
                Quadric::plane(normal.normalize_or(DVec3::X), *weight).form().seen_from(-0.1 * *through)
            };
            planes.iter().map(plane).fold(Form::default(), |sum, plane| sum + plane).pack()
        })
    }

    proptest! {
        #[test]
        fn many_edges_cost_what_each_costs_alone(
            from in quadric(),
            ends in prop::collection::vec((quadric(), point()), 0..=ROOM),
            cost in prop_oneof![Just(Cost::Sum), Just(Cost::Balanced)],
        ) {
            let all = Edges::new().costs(&from, ends.iter().map(|(q, edge)| (q, *edge)), cost);
            for ((quadric, edge), found) in ends.iter().zip(all) {
                let sum = from.form() + quadric.form().seen_from(-*edge);
                let alone = cost.of_edge(Placement::Optimal.spot(*edge, || 0.5, &sum).error, *edge, &sum);
                let (_, is_in_reach) = Spot::least(*edge, &sum);
                prop_assert_eq!(found.is_nan(), !is_in_reach);
                prop_assert!(found.is_nan() || found.to_bits() == alone.to_bits());
            }
        }
    }

    #[test]
    fn where_no_place_is_best_there_is_no_cost() {
        let nothing = Quadric::default();
        let ends = [(&nothing, DVec3::X), (&nothing, DVec3::ZERO)];
        let costs = Edges::new().costs(&nothing, ends.into_iter(), Cost::Balanced);
        assert!(costs[0].is_nan() && costs[1].is_nan());
    }
}
