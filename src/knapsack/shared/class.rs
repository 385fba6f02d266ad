//! One class with its hull at hand: slopes, costs and how far a multiplier λ carries it.

use super::SharedClass;
use super::profiles::{Position, Profiles};

/// One class of a call.
pub(super) struct Class<'a> {
    /// Its hull, cheapest first.
    pub positions: &'a [Position],
    pub weight: f32,
    pub scale: f32,
    /// Weight per scale: what turns the profile's slopes into the class's.
    rate: f32,
    pub current: u8,
    pub stay: f32,
}

impl<'a> Class<'a> {
    pub fn new(profiles: &'a Profiles, class: &SharedClass) -> Self {
        let SharedClass { profile, weight, scale, current, stay } = *class;
        Self {
            positions: profiles.positions(profile),
            weight,
            scale,
            rate: if scale == 1.0 { weight } else { weight / scale },
            current,
            stay,
        }
    }

    pub fn last(&self) -> u8 {
        (self.positions.len() - 1) as u8
    }

    /// The position held now.
    pub fn held(&self) -> u8 {
        self.current.min(self.last())
    }

    pub fn cost(&self, position: u8) -> u64 {
        scaled(self.positions[usize::from(position)].ticks, self.scale)
    }

    /// Benefit per tick of the step from `position` to the next; 0 at the last.
    pub fn plain_slope(&self, position: u8) -> f32 {
        self.rate * self.positions[usize::from(position)].next_slope
    }

    /// The same with switching priced in.
    pub fn slope(&self, position: u8) -> f32 {
        let price = if position < self.current { 1.0 + self.stay } else { 1.0 - self.stay };
        self.plain_slope(position) * price
    }

    /// The position where steps of priced slope λ or more end, λ > 0. Looked for from `near`, which from frame to frame
    /// is nearly always the answer.
    pub fn reach(&self, near: u8, lambda: f32) -> u8 {
        reach(near, lambda, |p| self.slope(p))
    }

    /// What pricing adds to the benefit of a position: the value up to the current position counts `stay` more, the
    /// value beyond it `stay` less.
    pub fn premium(&self, position: u8) -> f64 {
        let value = |p: u8| f64::from(self.positions[usize::from(p)].value);
        let kept = value(position.min(self.held()));
        f64::from(self.weight) * f64::from(self.stay) * ((kept - value(0)) - (value(position) - kept))
    }

    pub fn plain(&self, position: u8) -> f64 {
        f64::from(self.weight) * f64::from(self.positions[usize::from(position)].value)
    }
}

/// [`Class::reach`] for any slope.
pub(super) fn reach(near: u8, lambda: f32, slope: impl Fn(u8) -> f32) -> u8 {
    let mut position = near;
    while slope(position) >= lambda {
        position += 1;
    }
    while position > 0 && slope(position - 1) < lambda {
        position -= 1;
    }
    position
}

/// Ticks times scale, rounded up, and held to what 64 bits hold: so do all sums of costs, which then are beyond any
/// budget.
pub(super) fn scaled(ticks: u64, scale: f32) -> u64 {
    if scale == 1.0 {
        return ticks;
    }
    let product = ticks as f64 * f64::from(scale);
    let floor = product as u64;
    floor.saturating_add(u64::from((floor as f64) < product))
}
