//! Exact sums of `f64`: every finite `f64` is an integer times a power of two, so a set of them shares a unit in which
//! sums are integer sums. `i64` and `i128` carry the usual ranges; [`Wide`] carries every range an `f64` can span.

use std::fmt::Debug;
use std::ops::{Add, Sub};

/// The exponent of the smallest positive `f64`; no finite `f64` has a lower bit.
pub(crate) const LOWEST_UNIT: i32 = -1074;

/// Splits a non-negative finite `f64` into `(mantissa, exponent)` with `value = mantissa · 2^exponent`.
pub(crate) fn decompose(value: f64) -> (u64, i32) {
    let bits = value.to_bits();
    let fraction = bits & ((1 << 52) - 1);
    match (bits >> 52) & 0x7ff {
        0 => (fraction, LOWEST_UNIT),
        biased => (fraction | (1 << 52), biased as i32 - 1075),
    }
}

/// `2^exponent`, exact, for exponents from -1074 to 1023.
fn power_of_two(exponent: i32) -> f64 {
    if exponent < -1022 {
        f64::from_bits(1 << (exponent - LOWEST_UNIT))
    } else {
        f64::from_bits(((exponent + 1023) as u64) << 52)
    }
}

/// The unit shared by a set of values, and the bits a sum of them takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grid {
    /// Values are integers times `2^unit`.
    pub unit: i32,
    /// A sum of the announced number of values, with its sign, fits in this many bits.
    pub bits: u32,
}

impl Grid {
    /// The coarsest grid that holds `values`, with room for sums of `terms` of them.
    pub fn of(values: impl Iterator<Item = f64>, terms: usize) -> Self {
        let mut unit = i32::MAX;
        let mut top = i32::MIN;
        for (mantissa, exponent) in values.filter(|&value| value > 0.0).map(decompose) {
            unit = unit.min(exponent + mantissa.trailing_zeros() as i32);
            top = top.max(exponent + 64 - mantissa.leading_zeros() as i32);
        }
        if unit > top {
            return Self { unit: 0, bits: 2 };
        }
        let carry = usize::BITS - terms.leading_zeros();
        Self { unit, bits: (top - unit) as u32 + carry + 1 }
    }
}

/// An integer wide enough for the sums of one instance. Values are counted in units of `2^unit`.
pub(crate) trait Number: Copy + Ord + Debug + Add<Output = Self> + Sub<Output = Self> {
    /// The sum of nothing.
    const ZERO: Self;

    /// How many units fit into `value`, rounded down; `value` is finite, not negative and small enough.
    fn floor(value: f64, unit: i32) -> Self;

    /// The nearest `f64`, ties to even.
    fn to_f64(self, unit: i32) -> f64;

    /// The same amount on the grid of products.
    fn widen(self, unit: i32) -> WideProduct;

    /// The amount rounded down from the grid of products; it must fit.
    fn narrow(wide: WideProduct, unit: i32) -> Self;

    /// The greatest common divisor of two amounts, for types that can tell; else one unit.
    fn common_divisor(self, other: Self) -> Self;

    /// The largest multiple of `divisor` that is not above, for types that can tell; else the amount itself.
    fn floor_to(self, divisor: Self) -> Self;

    /// The lowest `f64` that is not below.
    fn to_f64_up(self, unit: i32) -> f64 {
        let nearest = self.to_f64(unit);
        if nearest >= 0.0 && nearest.is_finite() && Self::floor(nearest, unit) < self {
            nearest.next_up()
        } else {
            nearest
        }
    }

    /// The highest `f64` that is not above.
    fn to_f64_down(self, unit: i32) -> f64 {
        let nearest = self.to_f64(unit);
        if nearest > 0.0 && nearest.is_finite() && Self::floor(nearest, unit) > self {
            nearest.next_down()
        } else {
            nearest
        }
    }
}

macro_rules! primitive_number {
    ($type:ty, $unsigned:ty) => {
        impl Number for $type {
            const ZERO: Self = 0;

            fn floor(value: f64, unit: i32) -> Self {
                let (mantissa, exponent) = decompose(value);
                let shift = exponent - unit;
                match shift {
                    0.. if mantissa == 0 => 0,
                    0.. => <$type>::from(mantissa as i64) << shift,
                    -63..=-1 => (mantissa >> -shift) as $type,
                    _ => 0,
                }
            }

            fn to_f64(self, unit: i32) -> f64 {
                let magnitude = self.unsigned_abs() as f64 * power_of_two(unit);
                if self < 0 { -magnitude } else { magnitude }
            }

            fn widen(self, unit: i32) -> WideProduct {
                let magnitude =
                    WideProduct::shifted(self.unsigned_abs().into(), (unit - PRODUCT_UNIT) as u32);
                if self < 0 { magnitude.negated() } else { magnitude }
            }

            fn narrow(wide: WideProduct, unit: i32) -> Self {
                let words = wide.shifted_down((unit - PRODUCT_UNIT) as u32).words;
                (u128::from(words[1]) << 64 | u128::from(words[0])) as $type
            }

            fn common_divisor(self, other: Self) -> Self {
                let (mut a, mut b) = (self.unsigned_abs(), other.unsigned_abs());
                while b != 0 {
                    (a, b) = (b, a % b);
                }
                a as $type
            }

            fn floor_to(self, divisor: Self) -> Self {
                if divisor > 1 { self.div_euclid(divisor) * divisor } else { self }
            }
        }
    };
}

primitive_number!(i64, u64);
primitive_number!(i128, u128);

/// A two's complement integer of `64 · N` bits, lowest word first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Wide<const N: usize> {
    words: [u64; N],
}

/// Holds sums of up to 2^64 values of any finite `f64`, counted in the smallest positive one.
pub(crate) type WideSum = Wide<36>;

/// Holds sums of products of two `f64`, which span 2^-2148 … 2^2048, counted in the smallest.
pub(crate) type WideProduct = Wide<68>;

/// The exponent of the unit of [`WideProduct`].
pub(crate) const PRODUCT_UNIT: i32 = 2 * LOWEST_UNIT;

/// `sum + x·y`, exactly.
pub(crate) fn add_product(sum: WideProduct, x: f64, y: f64) -> WideProduct {
    let ((m, e), (n, f)) = (decompose(x.abs()), decompose(y.abs()));
    let product = WideProduct::shifted(u128::from(m) * u128::from(n), (e + f - PRODUCT_UNIT) as u32);
    if (x < 0.0) == (y < 0.0) { sum + product } else { sum - product }
}

impl<const N: usize> Wide<N> {
    fn is_negative(&self) -> bool {
        self.words[N - 1] >> 63 == 1
    }

    pub fn negated(self) -> Self {
        Self::ZERO_WORDS - self
    }

    const ZERO_WORDS: Self = Self { words: [0; N] };

    /// `mantissa · 2^shift`; what lies beyond the last word is lost.
    pub fn shifted(mantissa: u128, shift: u32) -> Self {
        let (word, bit) = ((shift / 64) as usize, shift % 64);
        let pieces = [mantissa as u64, (mantissa >> 64) as u64];
        let mut words = [0; N];
        for (i, piece) in pieces.into_iter().enumerate() {
            let spread = u128::from(piece) << bit;
            for (j, half) in [spread as u64, (spread >> 64) as u64].into_iter().enumerate() {
                if let Some(target) = words.get_mut(word + i + j) {
                    *target |= half;
                }
            }
        }
        Self { words }
    }

    /// Divided by `2^shift`, rounded down.
    fn shifted_down(&self, shift: u32) -> Self {
        let (word, bit) = ((shift / 64) as usize, shift % 64);
        let fill = if self.is_negative() { u64::MAX } else { 0 };
        let at = |i: usize| u128::from(self.words.get(i).copied().unwrap_or(fill));
        Self { words: std::array::from_fn(|i| ((at(i + word + 1) << 64 | at(i + word)) >> bit) as u64) }
    }

    /// Extended or cut to another width, keeping the sign.
    fn resized<const M: usize>(&self) -> Wide<M> {
        let fill = if self.is_negative() { u64::MAX } else { 0 };
        Wide { words: std::array::from_fn(|i| self.words.get(i).copied().unwrap_or(fill)) }
    }

    /// Multiplied by `2^shift`.
    fn shifted_up(&self, shift: u32) -> Self {
        let (word, bit) = ((shift / 64) as usize, shift % 64);
        let at = |i: usize| i.checked_sub(word).map_or(0, |i| u128::from(self.words[i]));
        let joined = |i: usize| at(i) << 64 | if i > 0 { at(i - 1) } else { 0 };
        Self { words: std::array::from_fn(|i| (joined(i) << bit >> 64) as u64) }
    }

    /// The sign against zero.
    pub fn sign(&self) -> std::cmp::Ordering {
        self.cmp(&Self::ZERO_WORDS)
    }
}

impl<const N: usize> Ord for Wide<N> {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let signs = other.is_negative().cmp(&self.is_negative());
        signs.then_with(|| self.words.iter().rev().cmp(other.words.iter().rev()))
    }
}

impl<const N: usize> PartialOrd for Wide<N> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<const N: usize> Add for Wide<N> {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        let mut carry = false;
        for (word, &term) in self.words.iter_mut().zip(&other.words) {
            let (sum, over) = word.overflowing_add(term);
            let (sum, over_carry) = sum.overflowing_add(u64::from(carry));
            (*word, carry) = (sum, over || over_carry);
        }
        self
    }
}

impl<const N: usize> Sub for Wide<N> {
    type Output = Self;

    fn sub(mut self, other: Self) -> Self {
        let mut borrow = false;
        for (word, &term) in self.words.iter_mut().zip(&other.words) {
            let (difference, under) = word.overflowing_sub(term);
            let (difference, under_borrow) = difference.overflowing_sub(u64::from(borrow));
            (*word, borrow) = (difference, under || under_borrow);
        }
        self
    }
}

impl<const N: usize> Number for Wide<N> {
    const ZERO: Self = Self::ZERO_WORDS;

    fn floor(value: f64, unit: i32) -> Self {
        let (mantissa, exponent) = decompose(value);
        let shift = exponent - unit;
        match shift {
            0.. => Self::shifted(mantissa.into(), shift as u32),
            -63..=-1 => Self::shifted((mantissa >> -shift).into(), 0),
            _ => Self::ZERO,
        }
    }

    fn to_f64(self, unit: i32) -> f64 {
        if self.is_negative() {
            return -self.negated().to_f64(unit);
        }
        let top = self.words.iter().rposition(|&word| word != 0).unwrap_or(0).max(1);
        let leading = u128::from(self.words[top]) << 64 | u128::from(self.words[top - 1]);
        // A word of the 128 leading bits may be nearly empty, but 65 of them are not: one more bit stands for all
        // below.
        let rest = self.words[..top - 1].iter().any(|&word| word != 0);
        let exponent = unit + 64 * (top as i32 - 1);
        if exponent > 1023 {
            return f64::INFINITY;
        }
        let leading = (leading | u128::from(rest)) as f64;
        // Below the smallest `f64` (products only) in two steps; what is lost there is subnormal.
        leading
            * power_of_two(exponent.max(LOWEST_UNIT))
            * power_of_two((exponent - LOWEST_UNIT).clamp(LOWEST_UNIT, 0))
    }

    fn widen(self, unit: i32) -> WideProduct {
        self.resized().shifted_up((unit - PRODUCT_UNIT) as u32)
    }

    fn narrow(wide: WideProduct, unit: i32) -> Self {
        wide.shifted_down((unit - PRODUCT_UNIT) as u32).resized()
    }

    fn common_divisor(self, _: Self) -> Self {
        Self::shifted(1, 0)
    }

    fn floor_to(self, _: Self) -> Self {
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn value() -> impl Strategy<Value = f64> {
        prop_oneof![
            (0u64..0x7ff0_0000_0000_0000).prop_map(f64::from_bits),
            0.0..1e15,
            (0u32..1000).prop_map(f64::from),
            Just(0.0),
            Just(f64::MIN_POSITIVE),
            Just(5e-324),
            Just(f64::MAX),
        ]
    }

    proptest! {
        #[test]
        fn wide_holds_every_f64(value in value()) {
            let wide = WideSum::floor(value, LOWEST_UNIT);
            prop_assert_eq!(wide.to_f64(LOWEST_UNIT), value);
            prop_assert_eq!((WideSum::ZERO - wide).to_f64(LOWEST_UNIT), -value);
        }

        #[test]
        fn a_sum_of_two_rounds_like_the_processor(a in value(), b in value()) {
            let sum = WideSum::floor(a, LOWEST_UNIT) + WideSum::floor(b, LOWEST_UNIT);
            prop_assert_eq!(sum.to_f64(LOWEST_UNIT), a + b);
            let difference = WideSum::floor(a, LOWEST_UNIT) - WideSum::floor(b, LOWEST_UNIT);
            prop_assert_eq!(difference.to_f64(LOWEST_UNIT), a - b);
            prop_assert_eq!(difference.sign(), a.total_cmp(&b));
        }

        #[test]
        fn narrow_and_wide_agree(values in prop::collection::vec(0.0f64..1e9, 1..20)) {
            let grid = Grid::of(values.iter().copied(), values.len());
            prop_assume!(grid.bits <= 127);
            let narrow = values.iter().fold(0i128, |sum, &v| sum + i128::floor(v, grid.unit));
            let wide = values.iter().fold(WideSum::ZERO, |sum, &v| sum + WideSum::floor(v, grid.unit));
            prop_assert_eq!(narrow.to_f64(grid.unit), wide.to_f64(grid.unit));
            prop_assert_eq!(narrow.to_f64_up(grid.unit), wide.to_f64_up(grid.unit));
            prop_assert_eq!(narrow.to_f64_down(grid.unit), wide.to_f64_down(grid.unit));
            prop_assert!(narrow.to_f64_down(grid.unit) <= narrow.to_f64_up(grid.unit));
        }
    }
}
