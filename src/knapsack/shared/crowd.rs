//! Classes by the hundred thousand, nearly all of which stay where they are.
//!
//! From one call to the next nearly every class holds its item whatever λ in the bracket turns out to be. Such a class is
//! *settled*. Whether it is takes one look at its weight: a class of weight w holds position p of its hull while
//! λ · (1 / slope into p) ≤ w < λ · (1 / slope out of p). The reciprocals of all items of all profiles are kept in a table,
//! so that sifting the crowd is a loop without branches over two columns. All that the sums need of settled classes is
//! how many hold each item, and what they weigh.

use glam::{Mat4, Vec4};

use super::profiles::Profiles;

/// The classes of a call, column by column, and how to look at one more closely.
pub struct Crowd<'a, F> {
    /// Factor on the profile's values, finite and ≥ 0.
    pub weight: &'a [f32],
    /// The number of the item that a class of scale 1 holds, among the items of all profiles in the order in which they
    /// were pushed. Any other number for a class that holds none, or has another scale.
    pub place: &'a [u32],
    /// How many classes hold each item.
    pub census: &'a [u32],
    /// The class in full: `Fn(&Profiles, usize) -> SharedClass`.
    pub class: F,
}

/// When a class holds an item, and what that is worth to a class of weight 1. A row of four numbers, so that four classes
/// are turned into columns by a transposition:
/// - *keep*: the class keeps the step to the item while its weight is at least λ times this;
/// - *rest*: it takes no further step while its weight is below λ times this;
/// - *value* of the item, and of the cheapest item of its profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hold(Vec4);

/// Reciprocals are moved outwards by more than the three roundings of single precision that slopes and comparisons take.
const OUTWARDS: f32 = 1.0e-6;

impl Hold {
    /// Never settled.
    pub const OPEN: Self = Self(Vec4::new(f32::INFINITY, 0.0, 0.0, 0.0));

    /// Of a position by the slopes of the steps to it and from it, where there are such.
    pub fn new(into: Option<f32>, out: Option<f32>, value: f32, least: f32) -> Self {
        let keep = into.map_or(0.0, |slope| 1.0 / slope * (1.0 + OUTWARDS));
        let rest = out.map_or(f32::INFINITY, |slope| 1.0 / slope * (1.0 - OUTWARDS));
        Self(Vec4::new(keep, rest, value, least))
    }

    fn settles(self, weight: f32, [low, high]: [f32; 2]) -> bool {
        (weight >= high * self.0.x) & (weight < low * self.0.y)
    }
}

/// What settled classes add up to. Costs are in ticks.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Settled {
    /// How many there are.
    pub classes: u64,
    /// All of them at their cheapest position, where they are, and at their best.
    pub cheapest: u64,
    pub held: u64,
    pub best: u64,
    /// The most that one class can cost beyond its cheapest position.
    pub widest: u64,
    /// Benefit where they are, and at the cheapest positions, in units.
    pub value: i128,
    pub least: i128,
    /// One unit of benefit.
    pub unit: f64,
}

impl Settled {
    /// Everyone who holds an item, as if settled.
    pub fn all(profiles: &Profiles, census: &[u32]) -> Self {
        let mut sums = Self::default();
        for (item, &count) in census.iter().enumerate().filter(|&(_, &count)| count > 0) {
            let [cheapest, held, best] = profiles.item_ticks(item);
            let times = u64::from(count);
            sums.classes += times;
            sums.cheapest = sums.cheapest.saturating_add(cheapest.saturating_mul(times));
            sums.held = sums.held.saturating_add(held.saturating_mul(times));
            sums.best = sums.best.saturating_add(best.saturating_mul(times));
            sums.widest = sums.widest.max(best - cheapest);
        }
        sums
    }

    /// Takes a class that holds `item` out of counts and costs.
    pub fn dismiss(&mut self, profiles: &Profiles, item: usize) {
        let [cheapest, held, best] = profiles.item_ticks(item);
        self.classes -= 1;
        self.cheapest -= cheapest;
        self.held -= held;
        self.best -= best;
    }

    /// Takes out of the benefit what a class of this weight at this item was counted with.
    pub fn devalue(&mut self, weight: f32, hold: &Hold) {
        let rounding = rounding(self.unit);
        let units = |value: f32| ((product(weight, value) + rounding - rounding) / self.unit) as i128;
        self.value -= units(hold.0.z);
        self.least -= units(hold.0.w);
    }

    /// Benefit where they are, and at the cheapest positions.
    pub fn benefit(&self) -> [f64; 2] {
        [self.value as f64 * self.unit, self.least as f64 * self.unit]
    }

    /// How much rounding may hide of either.
    pub fn hidden(&self) -> f64 {
        self.classes as f64 * self.unit
    }
}

/// Classes that are looked at together.
const LANES: usize = 16;

/// Chunks whose benefit is summed in double precision before it is carried over: so many numbers of 40 bits add up exactly
/// in 52.
const CARRY_EVERY: usize = 1 << 12;
const TERM_BITS: i32 = 40;

/// Sums of benefit, lane by lane.
#[derive(Clone, Copy)]
struct Lanes {
    value: [f64; LANES],
    least: [f64; LANES],
}

/// Finds the classes that are not settled for every λ of the bracket, and tells `open` of each. Adds the benefit of those
/// that are to `settled`, whose unit follows from the heaviest class. The last of `holds` is open.
pub(super) fn sift(
    weight: &[f32],
    place: &[u32],
    holds: &[Hold],
    bracket: [f32; 2],
    settled: &mut Settled,
    mut open: impl FnMut(usize),
) {
    settled.unit = unit_for(heaviest(weight));
    let rounding = rounding(settled.unit);
    let mut sums = Lanes { value: [0.0; LANES], least: [0.0; LANES] };
    let mut told = |at: usize, mut opened: u16| {
        while opened != 0 {
            open(at * LANES + opened.trailing_zeros() as usize);
            opened &= opened - 1;
        }
    };
    let (weights, last_weights) = weight.as_chunks::<LANES>();
    let (places, last_places) = place.as_chunks::<LANES>();
    for (at, (weight, place)) in weights.iter().zip(places).enumerate() {
        told(at, !sift_lanes(weight, place, holds, bracket, rounding, &mut sums));
        if at % CARRY_EVERY == CARRY_EVERY - 1 {
            carry(&mut sums, settled);
        }
    }
    let (mut weight, mut place) = ([0.0; LANES], [u32::MAX; LANES]);
    weight[..last_weights.len()].copy_from_slice(last_weights);
    place[..last_places.len()].copy_from_slice(last_places);
    let opened = !sift_lanes(&weight, &place, holds, bracket, rounding, &mut sums);
    told(weights.len(), opened & ((1u32 << last_weights.len()) - 1) as u16);
    carry(&mut sums, settled);
}

/// Finds the settled classes that hold an item with a further step whose slope is at least `low`, and tells `open` of each.
/// Slopes are those of the profile; steps of lower priced slopes may be among them.
pub(super) fn openings<F>(
    crowd: &Crowd<'_, F>,
    holds: &[Hold],
    bracket: [f32; 2],
    low: f32,
    mut open: impl FnMut(usize),
) {
    for (i, (&weight, &place)) in crowd.weight.iter().zip(crowd.place).enumerate() {
        let Some(hold) = holds.get(place as usize) else { continue };
        if hold.settles(weight, bracket) & (weight >= low * hold.0.y) {
            open(i);
        }
    }
}

/// One chunk: which lanes are settled; their benefit goes into the sums.
fn sift_lanes(
    weight: &[f32; LANES],
    place: &[u32; LANES],
    holds: &[Hold],
    [low, high]: [f32; 2],
    rounding: f64,
    sums: &mut Lanes,
) -> u16 {
    let [keep, rest, value, least] = columns(place, holds);
    let mut stays = [0; LANES];
    for lane in 0..LANES {
        let w = weight[lane];
        let is_settled = (w >= high * keep[lane]) & (w < low * rest[lane]);
        stays[lane] = u32::from(is_settled);
        let counted = if is_settled { w } else { 0.0 };
        sums.value[lane] += product(counted, value[lane]) + rounding - rounding;
        sums.least[lane] += product(counted, least[lane]) + rounding - rounding;
    }
    stays.iter().enumerate().fold(0, |mask, (lane, &bit)| mask | bit << lane) as u16
}

/// The rows of a chunk's items, as columns.
fn columns(place: &[u32; LANES], holds: &[Hold]) -> [[f32; LANES]; 4] {
    let last = holds.len() - 1;
    let row = |place: u32| holds[(place as usize).min(last)].0;
    let mut columns = [[0.0; LANES]; 4];
    for (quad, places) in place.as_chunks::<4>().0.iter().enumerate() {
        let [a, b, c, d] = places.map(row);
        let turned = Mat4::from_cols(a, b, c, d).transpose();
        for (column, part) in
            columns.iter_mut().zip([turned.x_axis, turned.y_axis, turned.z_axis, turned.w_axis])
        {
            column[quad * 4..][..4].copy_from_slice(&part.to_array());
        }
    }
    columns
}

fn product(weight: f32, value: f32) -> f64 {
    f64::from(weight) * f64::from(value)
}

fn carry(sums: &mut Lanes, settled: &mut Settled) {
    settled.value += sums.value.iter().map(|sum| (sum / settled.unit) as i128).sum::<i128>();
    settled.least += sums.least.iter().map(|sum| (sum / settled.unit) as i128).sum::<i128>();
    *sums = Lanes { value: [0.0; LANES], least: [0.0; LANES] };
}

/// A power of two of which the heaviest class has fewer than 2⁴⁰.
fn unit_for(heaviest: f32) -> f64 {
    let exponent = if heaviest > 0.0 { (heaviest.to_bits() >> 23) as i32 - 126 } else { 0 };
    f64::from_bits(((1023 + exponent - TERM_BITS) as u64) << 52)
}

/// Adding and subtracting this rounds to whole units.
fn rounding(unit: f64) -> f64 {
    unit * 1.5 * (1u64 << 52) as f64
}

fn heaviest(weight: &[f32]) -> f32 {
    let mut most = [0.0f32; LANES];
    for chunk in weight.chunks(LANES) {
        for (most, &w) in most.iter_mut().zip(chunk) {
            *most = if w > *most { w } else { *most };
        }
    }
    most.into_iter().fold(0.0, f32::max)
}
