//! What orders contractions: from squared distances to a cost.

use glam::DVec3;

use super::form::Form;

/// How much the squared length of an edge adds to its cost, compared with its squared error: enough to order what is
/// flat but for rounding, too little to matter elsewhere.
const SHORTER_FIRST: f64 = 1e-9;

/// What the cost of a contraction is, given what the planes that were contracted weigh and how far they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cost {
    /// The sum of weight · squared distance, as in the paper: the best for the mean over the surface, were quadrics all
    /// there is to it. The worst point of a small patch may be far off.
    Sum,
    /// Weight · (mean squared distance)^1¼, which is between the sum and the mean, and no less than that of
    /// a surface whose tip moves as far as the ends of the edge do. The mean alone would be best for the worst point,
    /// but spends triangles where nobody sees them.
    #[default]
    Balanced,
}

impl Cost {
    /// What a sum of weighted squared distances costs.
    #[inline]
    pub(super) fn of(self, sum: f64, weight: f64) -> f32 {
        match self {
            Self::Sum => sum as f32,
            Self::Balanced if sum > 0.0 => (sum * (sum / weight).sqrt().sqrt()) as f32,
            Self::Balanced => 0.0,
        }
    }

    /// What an edge costs with the least error that its ends may have together.
    #[inline]
    pub(super) fn of_edge(self, error: f64, edge: DVec3, sum: &Form) -> f32 {
        self.of(error + SHORTER_FIRST * sum.weight() * edge.length_squared(), sum.weight())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn costs_rise_with_the_sum(sum in 1e-9..1.0f64, more in 1.01..100.0f64, weight in 1e-6..1.0f64) {
            for cost in [Cost::Sum, Cost::Balanced] {
                prop_assert!(cost.of(sum, weight) < cost.of(more * sum, weight));
                prop_assert_eq!(cost.of(0.0, 0.0), 0.0);
            }
        }
    }
}
