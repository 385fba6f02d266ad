//! Classes that stay where they are, counted instead of listed.
//!
//! From one frame to the next nearly every class holds its position whatever λ in the bracket turns out to be. Such a
//! class is *settled*: all that the sums need of it is how many there are like it and what they weigh.

use super::SharedClass;
use super::class::Class;
use super::profiles::{Position, Profiles};

/// Counts per position of every profile.
#[derive(Clone, Debug, Default)]
pub(super) struct Census {
    counts: Vec<Count>,
    /// Units of benefit per one: a power of two that gives the heaviest class 56 bits.
    unit: f64,
}

/// The settled classes at one position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Count {
    pub classes: u64,
    /// Sum of weights, in units.
    pub weight: u128,
    /// Sum of weights times the price of switching, in units.
    pub kept: u128,
}

/// The settled classes of one profile at one of its positions.
#[derive(Clone, Copy)]
pub(super) struct Settled<'a> {
    pub positions: &'a [Position],
    pub position: usize,
    pub count: Count,
}

impl Settled<'_> {
    /// What they would cost at `position` together. Their scale is 1.
    pub fn cost(&self, position: usize) -> u64 {
        self.positions[position].ticks.saturating_mul(self.count.classes)
    }
}

/// Fewer classes than this per position are not worth counting: adding up the counts would take longer than listing.
const WORTH_COUNTING: usize = 4;

const WEIGHT_BITS: i32 = 56;

impl Census {
    /// Starts anew for these classes.
    pub fn begin(&mut self, profiles: &Profiles, classes: &[SharedClass]) {
        let heaviest = classes.iter().map(|c| c.weight).fold(0.0, f32::max);
        self.unit = power_of_two(WEIGHT_BITS - exponent_of(heaviest));
        let counted = classes.len() / WORTH_COUNTING >= profiles.positions_len();
        self.counts.clear();
        self.counts.resize(if counted { profiles.positions_len() } else { 0 }, Count::default());
    }

    /// Units of benefit per one.
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// Counts a class if it holds its position for every λ from `low` to `high`, priced or not. Whether it does.
    pub fn settles(&mut self, class: &Class<'_>, [low, high]: [f32; 2]) -> bool {
        let held = class.held();
        let stays = class.scale == 1.0
            && class.plain_slope(held) < low
            && (held == 0 || class.plain_slope(held - 1) >= high);
        match self.counts.get_mut(class.place(held)).filter(|_| stays) {
            Some(count) => {
                let [weight, kept] = weights(class, self.unit);
                count.classes += 1;
                count.weight += u128::from(weight);
                count.kept += u128::from(kept);
                true
            }
            None => false,
        }
    }

    /// Takes a class that has settled out of the count.
    pub fn remove(&mut self, class: &Class<'_>) {
        let [weight, kept] = weights(class, self.unit);
        let count = &mut self.counts[class.place(class.held())];
        count.classes -= 1;
        count.weight -= u128::from(weight);
        count.kept -= u128::from(kept);
    }

    /// The settled classes, by profile and position.
    pub fn settled<'a>(&'a self, profiles: &'a Profiles) -> impl Iterator<Item = Settled<'a>> {
        let hulls = profiles.hulls().flat_map(|positions| (0..positions.len()).map(move |p| (positions, p)));
        let all = self.counts.iter().zip(hulls);
        all.filter(|(count, _)| count.classes > 0).map(|(&count, (positions, position))| Settled {
            positions,
            position,
            count,
        })
    }
}

fn weights(class: &Class<'_>, unit: f64) -> [u64; 2] {
    let weight = f64::from(class.weight) * unit;
    [fixed(weight), fixed(weight * f64::from(class.stay))]
}

/// The whole units of `x`, which is not negative and below 2⁶³.
pub(super) fn fixed(x: f64) -> u64 {
    x as i64 as u64
}

/// The exponent of a power of two above `x`; 0 for 0.
fn exponent_of(x: f32) -> i32 {
    if x > 0.0 { (x.to_bits() >> 23) as i32 - 126 } else { 0 }
}

/// 2^`exponent`, for exponents of normal numbers.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}
