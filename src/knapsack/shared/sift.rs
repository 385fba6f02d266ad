//! Which of many classes stay where they are: a loop without branches over two columns.
//!
//! A class of weight w holds position p of its hull while λ · (1 / slope into p) ≤ w < λ · (1 / slope out of p). The
//! reciprocals of all items of all profiles are kept in a table, so that whether a class is settled takes one look at
//! its weight.

use glam::{Mat4, Vec4};

use crate::kernel::{Divisible, Kernel, run_on};

/// When a class holds an item, and what that is worth to a class of weight 1. A row of four numbers, so that four
/// classes are turned into columns by a transposition:
/// - *keep*: the class keeps the step to the item while its weight is at least λ times this;
/// - *rest*: it takes no further step while its weight is below λ times this;
/// - *value* of the item, and of the cheapest item of its profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hold(Vec4);

/// Reciprocals are moved outwards by more than the three roundings of single precision that slopes and comparisons
/// take.
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

/// Chunks whose benefit is summed in double precision before it is carried over: so many numbers of 40 bits add up
/// exactly in 52.
const CARRY_EVERY: usize = 1 << 12;
const TERM_BITS: i32 = 40;

/// Sums of benefit, lane by lane.
#[derive(Clone, Copy)]
struct Lanes {
    value: [f64; LANES],
    least: [f64; LANES],
}

/// The columns of the classes that are to be looked at. What `holds` are about is the `size` of a class: its weight, or
/// another number. The last of `holds` is open.
#[derive(Clone, Copy)]
pub(crate) struct Columns<'a> {
    pub size: &'a [f32],
    pub weight: &'a [f32],
    /// No weight is greater.
    pub heaviest: f32,
    pub place: &'a [u32],
    pub holds: &'a [Hold],
}

/// Finds the classes that are not settled for every λ of the bracket, a bit in `open` for each, and returns the benefit
/// of those that are, in a unit that follows from the heaviest class.
pub(crate) fn sift(columns: Columns<'_>, bracket: [f32; 2], threads: usize, open: &mut Vec<u16>) -> Units {
    open.resize(columns.weight.len().div_ceil(LANES), 0);
    let unit = unit_for(columns.heaviest);
    run_on(threads, Sift { columns, bracket, unit, open })
}

/// The classes that a bit of `open` stands for, ascending.
pub(crate) fn opened(open: &[u16]) -> impl Iterator<Item = usize> + '_ {
    open.iter().enumerate().filter(|&(_, &bits)| bits != 0).flat_map(|(at, &bits)| {
        (0..LANES).filter(move |lane| bits & (1 << lane) != 0).map(move |lane| at * LANES + lane)
    })
}

struct Sift<'a> {
    columns: Columns<'a>,
    bracket: [f32; 2],
    unit: f64,
    open: &'a mut [u16],
}

impl Kernel for Sift<'_> {
    type Sum = Units;

    #[inline(always)]
    fn run(self) -> Units {
        let Columns { size, weight, place, holds, .. } = self.columns;
        let mut settled = Units { unit: self.unit, ..Units::default() };
        let rounding = rounding(settled.unit);
        let mut sums = Lanes { value: [0.0; LANES], least: [0.0; LANES] };
        let (sizes, last_sizes) = size.as_chunks::<LANES>();
        let (weights, last_weights) = weight.as_chunks::<LANES>();
        let (places, last_places) = place.as_chunks::<LANES>();
        let chunks = sizes.iter().zip(weights).zip(places).zip(&mut *self.open).enumerate();
        for (at, (((size, weight), place), open)) in chunks {
            *open = !sift_lanes(size, weight, place, holds, self.bracket, rounding, &mut sums);
            if at % CARRY_EVERY == CARRY_EVERY - 1 {
                carry(&mut sums, &mut settled);
            }
        }
        if let Some(open) = self.open.get_mut(weights.len()) {
            let (mut size, mut weight, mut place) = ([0.0; LANES], [0.0; LANES], [u32::MAX; LANES]);
            size[..last_sizes.len()].copy_from_slice(last_sizes);
            weight[..last_weights.len()].copy_from_slice(last_weights);
            place[..last_places.len()].copy_from_slice(last_places);
            let opened = !sift_lanes(&size, &weight, &place, holds, self.bracket, rounding, &mut sums);
            *open = opened & ((1u32 << last_weights.len()) - 1) as u16;
        }
        carry(&mut sums, &mut settled);
        settled
    }
}

impl Divisible for Sift<'_> {
    fn len(&self) -> usize {
        self.columns.weight.len()
    }

    fn halves(self) -> [Self; 2] {
        let Self { columns, bracket, unit, open } = self;
        let chunks = open.len() / 2;
        let (open, other_open) = open.split_at_mut(chunks);
        let [size, weight] = [columns.size, columns.weight].map(|column| column.split_at(chunks * LANES));
        let place = columns.place.split_at(chunks * LANES);
        let first = Columns { size: size.0, weight: weight.0, place: place.0, ..columns };
        let second = Columns { size: size.1, weight: weight.1, place: place.1, ..columns };
        [
            Self { columns: first, bracket, unit, open },
            Self { columns: second, bracket, unit, open: other_open },
        ]
    }

    fn join([a, b]: [Units; 2]) -> Units {
        Units { value: a.value + b.value, least: a.least + b.least, unit: a.unit }
    }
}

/// One chunk: which lanes are settled; their benefit goes into the sums.
#[inline(always)]
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
#[inline(always)]
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

#[inline(always)]
fn product(weight: f32, value: f32) -> f64 {
    f64::from(weight) * f64::from(value)
}

#[cold]
#[inline(never)]
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
#[inline(always)]
fn rounding(unit: f64) -> f64 {
    unit * 1.5 * (1u64 << 52) as f64
}
