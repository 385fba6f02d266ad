//! Sums that do not depend on the order of their terms.

/// A sum in fixed point with 32 binary digits after the point. Integer addition is associative, so the same terms
/// give the same sum in any order and on any number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct FixedSum(i128);

/// Units per one.
const SCALE: f64 = (1u64 << 32) as f64;

impl FixedSum {
    /// Adds a term rounded towards zero: by less than 2⁻³². Terms beyond ±2³¹ are held to that; not a number is 0.
    pub fn add(&mut self, term: f64) {
        self.0 += i128::from((term * SCALE) as i64);
    }

    /// The sum, rounded once.
    pub fn value(self) -> f64 {
        self.0 as f64 / SCALE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_terms_does_not_matter() {
        let terms: Vec<f64> = (0..1000).map(|i| 1e6 / f64::from(i + 1)).collect();
        let sum = |terms: &mut dyn Iterator<Item = &f64>| {
            let mut sum = FixedSum::default();
            terms.for_each(|&t| sum.add(t));
            sum
        };
        assert_eq!(sum(&mut terms.iter()), sum(&mut terms.iter().rev()));
        assert!((sum(&mut terms.iter()).value() - terms.iter().sum::<f64>()).abs() < 1e-6);
    }
}
