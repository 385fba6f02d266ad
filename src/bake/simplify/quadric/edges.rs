//! What the edges of a vertex cost, several at once.
//!
//! Costs are most of what simplification computes. They are computed here by a loop without branches that is compiled to
//! vectors of two edges or of four. The same operations in the same order as for one edge give the same bits.

use glam::DVec3;

use super::cost::Cost;
use super::form::Quadric;
use super::placement::Spot;
use crate::kernel::{self, Kernel};

/// So many edges at once: those of one vector of 256 bits.
pub(super) const LANES: usize = 4;

/// An end of an edge: its quadric, and where it is.
pub(super) type End<'a> = (&'a Quadric, &'a DVec3);

/// Per edge of a vertex what it costs to contract it to where the error is least; not a number where that place is out of
/// reach.
#[inline]
pub(super) fn costs(from: End, ends: [End; LANES], cost: Cost) -> [f32; LANES] {
    kernel::run(Costs { from, ends, cost })
}

struct Costs<'a> {
    from: End<'a>,
    ends: [End<'a>; LANES],
    cost: Cost,
}

impl Kernel for Costs<'_> {
    type Sum = [f32; LANES];

    #[inline(always)]
    fn run(self) -> Self::Sum {
        let mut costs = [0.0; LANES];
        let (from, at) = (self.from.0.form(), *self.from.1);
        for (&(quadric, place), known) in self.ends.iter().zip(&mut costs) {
            let edge = *place - at;
            let sum = from + quadric.form().seen_from(-edge);
            let (spot, is_in_reach) = Spot::least(edge, &sum);
            let least = self.cost.of_edge(spot.error, edge, &sum);
            *known = if is_in_reach { least } else { f32::NAN };
        }
        costs
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::form::Form;
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
            (from, at) in (quadric(), point()),
            ends in prop::array::uniform4((quadric(), point())),
            cost in prop_oneof![Just(Cost::Sum), Just(Cost::Balanced)],
        ) {
            let all = costs((&from, &at), ends.each_ref().map(|(quadric, place)| (quadric, place)), cost);
            for ((quadric, place), found) in ends.iter().zip(all) {
                let edge = *place - at;
                let sum = from.form() + quadric.form().seen_from(-edge);
                let alone = cost.of_edge(Placement::Optimal.spot(edge, || 0.5, &sum).error, edge, &sum);
                let (_, is_in_reach) = Spot::least(edge, &sum);
                prop_assert_eq!(found.is_nan(), !is_in_reach);
                prop_assert!(found.is_nan() || found.to_bits() == alone.to_bits());
            }
        }
    }

    #[test]
    fn where_no_place_is_best_there_is_no_cost() {
        let nothing = Quadric::default();
        let ends = [DVec3::X, DVec3::ZERO, DVec3::Y, DVec3::Z];
        let ends = ends.each_ref().map(|end| (&nothing, end));
        assert!(costs((&nothing, &DVec3::ZERO), ends, Cost::Balanced).iter().all(|cost| cost.is_nan()));
    }
}
