//! Which of many classes stay where they are: a loop without branches over two columns.
//!
//! A class of weight w holds position p of its hull while λ · (1 / slope into p) ≤ w < λ · (1 / slope out of p). The
//! reciprocals of all items of all profiles are kept in a table, so that whether a class is settled takes one look at its
//! weight.

use glam::{Mat4, Vec4};

/// When a class holds an item, and what that is worth to a class of weight 1. A row of four numbers, so that four classes
/// are turned into columns by a transposition:
/// - *keep*: the class keeps the step to the item while its weight is at least λ times this;
/// - *rest*: it takes no further step while its weight is below λ times this;
/// - *value* of the item, and of the cheapest item of its profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hold(Vec4);

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

    /// Of an item that is held from `keep` up to `rest` (exclusive), exactly.
    pub fn within(keep: f32, rest: f32, value: f32) -> Self {
        Self(Vec4::new(keep, rest, value, 0.0))
    }

    /// Whether a settled class of this weight may have a further step whose slope is `low` or more.
    pub fn may_go_on(self, weight: f32, low: f32) -> bool {
        weight >= low * self.0.y
    }
}

/// Benefit of classes, in units: where they are, and at their cheapest positions.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Units {
    pub value: i128,
    pub least: i128,
    /// One unit.
    pub unit: f64,
}

impl Units {
    /// So many units as `weight` times `value` counts.
    pub fn of(&self, weight: f32, value: f32) -> i128 {
        let rounding = rounding(self.unit);
        i128::from(((product(weight, value) + rounding - rounding) / self.unit) as i64)
    }

    /// The benefit of where the classes are.
    pub fn benefit(&self) -> f64 {
        self.value as f64 * self.unit
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

/// Finds the classes that are not settled for every λ of the bracket, tells `open` of each, and returns the benefit of
/// those that are, in a unit that follows from the heaviest class. The last of `holds` is open. What `holds` are about is
/// the `size` of a class: its weight, or another number.
pub(crate) fn sift(
    size: &[f32],
    weight: &[f32],
    place: &[u32],
    holds: &[Hold],
    bracket: [f32; 2],
    mut open: impl FnMut(usize),
) -> Units {
    let mut settled = Units { unit: unit_for(heaviest(weight)), ..Units::default() };
    let rounding = rounding(settled.unit);
    let mut sums = Lanes { value: [0.0; LANES], least: [0.0; LANES] };
    let mut told = |at: usize, mut opened: u16| {
        while opened != 0 {
            open(at * LANES + opened.trailing_zeros() as usize);
            opened &= opened - 1;
        }
    };
    let (sizes, last_sizes) = size.as_chunks::<LANES>();
    let (weights, last_weights) = weight.as_chunks::<LANES>();
    let (places, last_places) = place.as_chunks::<LANES>();
    for (at, ((size, weight), place)) in sizes.iter().zip(weights).zip(places).enumerate() {
        told(at, !sift_lanes(size, weight, place, holds, bracket, rounding, &mut sums));
        if at % CARRY_EVERY == CARRY_EVERY - 1 {
            carry(&mut sums, &mut settled);
        }
    }
    let (mut size, mut weight, mut place) = ([0.0; LANES], [0.0; LANES], [u32::MAX; LANES]);
    size[..last_sizes.len()].copy_from_slice(last_sizes);
    weight[..last_weights.len()].copy_from_slice(last_weights);
    place[..last_places.len()].copy_from_slice(last_places);
    let opened = !sift_lanes(&size, &weight, &place, holds, bracket, rounding, &mut sums);
    told(weights.len(), opened & ((1u32 << last_weights.len()) - 1) as u16);
    carry(&mut sums, &mut settled);
    settled
}

/// One chunk: which lanes are settled; their benefit goes into the sums.
fn sift_lanes(
    size: &[f32; LANES],
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
        let (s, w) = (size[lane], weight[lane]);
        let is_settled = (s >= high * keep[lane]) & (s < low * rest[lane]);
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
        let turned =
            Mat4::from_cols(row(places[0]), row(places[1]), row(places[2]), row(places[3])).transpose();
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

fn carry(sums: &mut Lanes, settled: &mut Units) {
    settled.value += sums.value.iter().map(|sum| i128::from((sum / settled.unit) as i64)).sum::<i128>();
    settled.least += sums.least.iter().map(|sum| i128::from((sum / settled.unit) as i64)).sum::<i128>();
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
