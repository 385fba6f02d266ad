//! Where to put the vertex that an edge is contracted to.

use glam::DVec3;

use super::form::Form;

/// Where to put the vertex that an edge is contracted to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Placement {
    /// Where the error is least, as in the paper. Falls back to the best of the end points and the middle where that is
    /// far away.
    Optimal,
    /// The same, and on what bulges a little further to the outside, so that the surface is as far outside as inside: on a
    /// sphere that takes more than a tenth of the root mean square distance away.
    #[default]
    Balanced,
    /// At the end point of less error: the result's vertices are some of the old ones, attributes and all.
    Endpoint,
    /// Half way between the end points.
    Midpoint,
    /// At the mean of the end points, weighted by the area that was contracted into each.
    Average,
}

/// How stiffly the best place is held at the middle of the edge, as a share of all curvature. Higher gives away
/// precision on gently curved surfaces; lower lets vertices slide about on flat ones.
const STIFFNESS: f64 = 1e-6;

/// How far from the middle of the edge the best place may be, in lengths of the edge.
const REACH: f64 = 1.0;

/// A place, and its error, which is never negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    pub(super) place: DVec3,
    pub(super) error: f64,
}

impl Spot {
    #[inline]
    pub(super) fn new(place: DVec3, form: &Form) -> Self {
        Self { place, error: form.at(place).max(0.0) }
    }

    /// Where the error of an edge is least, and whether that is near enough to its middle.
    #[inline(always)]
    pub(super) fn least(edge: DVec3, sum: &Form) -> (Self, bool) {
        let middle = 0.5 * edge;
        let place = sum.least(middle, STIFFNESS);
        let is_in_reach = place.distance_squared(middle) <= REACH * REACH * edge.length_squared();
        (Self::new(place, sum), is_in_reach)
    }

    /// The one of less error, the first where they are equal.
    fn better(self, other: Self) -> Self {
        if other.error < self.error { other } else { self }
    }
}

impl Placement {
    /// Whether it starts from where the error is least.
    #[inline]
    pub(super) fn is_least(self) -> bool {
        matches!(self, Self::Optimal | Self::Balanced)
    }

    /// Where an edge goes whose ends have the error `sum` together. All is seen from the first end; `edge` leads to the
    /// second, which stands for that `share` of the area.
    #[inline]
    pub(super) fn spot(self, edge: DVec3, share: impl FnOnce() -> f64, sum: &Form) -> Spot {
        match self {
            Self::Optimal | Self::Balanced => optimal(edge, sum),
            Self::Endpoint => Spot::new(DVec3::ZERO, sum).better(Spot::new(edge, sum)),
            Self::Midpoint => Spot::new(0.5 * edge, sum),
            Self::Average => Spot::new(share() * edge, sum),
        }
    }
}

#[inline]
fn optimal(edge: DVec3, sum: &Form) -> Spot {
    let (spot, is_in_reach) = Spot::least(edge, sum);
    if is_in_reach { spot } else { on_edge(edge, sum) }
}

/// The best of the end points and of the lowest point between them.
fn on_edge(edge: DVec3, sum: &Form) -> Spot {
    let share = -sum.slope(DVec3::ZERO).dot(edge) / sum.curvature(edge);
    let inside = if (0.0..=1.0).contains(&share) { share * edge } else { 0.5 * edge };
    Spot::new(inside, sum).better(Spot::new(DVec3::ZERO, sum)).better(Spot::new(edge, sum))
}

#[cfg(test)]
mod tests {
    use super::super::form::Quadric;
    use super::*;

    /// A crease along x through `at`, one unit of weight on either side.
    fn crease(at: DVec3) -> Form {
        let sides = [DVec3::Y, DVec3::Z].map(|n| Quadric::plane(n, 1.0).form());
        (sides[0] + sides[1]).seen_from(-at)
    }

    #[test]
    fn each_placement_goes_where_it_says() {
        let sum = crease(DVec3::new(0.0, 0.25, 0.1));
        let spot = |p: Placement| p.spot(DVec3::Y, || 0.125, &sum).place;
        assert!(spot(Placement::Optimal).distance(DVec3::new(0.0, 0.25, 0.1)) < 1e-5);
        assert_eq!(spot(Placement::Endpoint), DVec3::ZERO);
        assert_eq!(spot(Placement::Midpoint), DVec3::Y * 0.5);
        assert_eq!(spot(Placement::Average), DVec3::Y * 0.125);
    }

    #[test]
    fn what_is_best_far_away_is_looked_for_on_the_edge() {
        let spot = |at| Placement::Optimal.spot(DVec3::Y, || 0.5, &crease(at)).place;
        assert_eq!(spot(DVec3::new(0.0, 9.0, 0.0)), DVec3::Y);
        assert_eq!(spot(DVec3::new(0.0, -9.0, 0.0)), DVec3::ZERO);
        assert_eq!(spot(DVec3::new(0.0, 0.25, 9.0)), DVec3::Y * 0.25);
    }

    #[test]
    fn where_nothing_counts_the_middle_will_do() {
        let spot = Placement::Optimal.spot(DVec3::Y, || 0.5, &Form::default());
        assert_eq!(spot, Spot { place: DVec3::Y * 0.5, error: 0.0 });
    }
}
