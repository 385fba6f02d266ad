//! Random numbers that are the same everywhere and for ever.

use rand::Rng;
use rand_pcg::Pcg64;

/// A stream of random numbers: PCG XSL RR 128/64 (O'Neill, "PCG: A Family of Simple Fast Space-Efficient
/// Statistically Good Algorithms for Random Number Generation", 2014). What is made of its 64-bit words is ours, so
/// that no later version of a crate of distributions can change a scene.
pub(super) struct Dice(Pcg64);

impl Dice {
    /// Streams of one seed are independent, so that what one part of a scene draws leaves the other parts alone.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self(Pcg64::new(u128::from(seed), u128::from(stream)))
    }

    /// From 0 inclusive to 1 exclusive, in steps of 2⁻⁵³.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// An index below `n`; off by at most n / 2³² from uniform.
    pub fn below(&mut self, n: usize) -> usize {
        (((self.0.next_u64() >> 32) * n as u64) >> 32) as usize
    }

    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// # Panics
    /// Without anything to pick from.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_seeds_and_streams_differ_and_repeat() {
        let first = |seed, stream| Dice::new(seed, stream).0.next_u64();
        assert_eq!(first(7, 1), first(7, 1));
        assert!(first(6, 1) != first(7, 1) && first(7, 1) != first(7, 2));
    }

    #[test]
    fn draws_stay_in_their_range_and_reach_its_ends() {
        let mut dice = Dice::new(1, 1);
        let mut seen = [0; 5];
        (0..1000).for_each(|_| seen[dice.below(5)] += 1);
        assert!(seen.iter().all(|&n| n > 100));
        assert!((0..1000).all(|_| (2.0..3.0).contains(&dice.between(2.0, 3.0))));
    }
}
