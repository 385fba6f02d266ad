//! Sums that do not depend on the order of their terms.

/// A sum in fixed point with 32 binary digits after the point. Integer addition is associative, so the same terms
/// give the same sum in any order and on any number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct FixedSum(i128);

/// Units per one.
const SCALE: f64 = (1u64 << 32) as f64;
/// Units up to which the conversion is one instruction.
const WORD: f64 = (1u64 << 63) as f64;
/// The most units of a term: 2²⁷ of them are within range.
const MOST: f64 = (1u128 << 100) as f64;

impl FixedSum {
    /// Adds a term rounded towards zero: by less than 2⁻³². Terms beyond ±2⁶⁸ are held to that; not a number is 0.
    pub fn add(&mut self, term: f64) {
        let units = term * SCALE;
        self.0 += match units.abs() < WORD {
            true => i128::from(units as i64),
            false => units.clamp(-MOST, MOST) as i128,
        };
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

    #[test]
    fn large_terms_are_not_lost() {
        let mut sum = FixedSum::default();
        [1e15, f64::NAN, 0.5, f64::INFINITY, f64::NEG_INFINITY].into_iter().for_each(|t| sum.add(t));
        assert_eq!(sum.value(), 1e15 + 0.5);
    }
}
