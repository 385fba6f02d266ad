//! The value floor: what the selection would leave out anyway need not be rated.

use super::lanes::{bits, distances, lanes_of};
use crate::scene::{BLOCK, Objects};
use crate::view::Lens;

/// A value below which an object that the selection may leave out
/// ([`Settings::may_be_left_out`](crate::scene::Settings::may_be_left_out)) is passed over.
///
/// An object's value in a view is the most benefit per microsecond that drawing it can have: projected area · gain ·
/// the best slope of its table ÷ its cost multiplier. Pixels only add to the cost, and attention only takes from the
/// benefit, so that a selection whose multiplier λ is at or above the floor would not have drawn what is passed over,
/// in a view group of this view alone. Where objects that are drawn are worth more than others (hysteresis), the floor
/// is λ less the greatest such premium. An object that the eye is in is never passed over.
#[derive(Clone, Copy, Debug)]
pub struct ValueFloor<'a> {
    /// λ in px² per µs. A floor that is not above 0 passes nothing over.
    pub lambda: f64,
    /// By [`TableId`](crate::scene::TableId): the greatest accuracy per µs of geometry of any level. Objects of a table
    /// that has none are never passed over, nor are those of an infinite one.
    pub best_slope: &'a [f32],
}

impl ValueFloor<'_> {
    /// Nothing is passed over.
    pub const NONE: Self = Self { lambda: 0.0, best_slope: &[] };
}

/// Relative room below λ for the rounding of the selection's own numbers: an area, a gain and a slope in `f32`. Larger
/// passes less over; below about 8 · 2⁻²⁴ an object worth exactly λ might be missed.
const ROOM: f64 = 4e-6;

/// The floor of one cull, with what all its tests have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Floor<'a> {
    /// Least value that is kept.
    least: f64,
    /// Area of a sphere of radius 1 at distance 1, in px².
    unit_px2: f64,
    best_slope: &'a [f32],
}

impl<'a> Floor<'a> {
    pub fn new(floor: &ValueFloor<'a>, lens: &Lens) -> Self {
        let scale = f64::from(lens.scale_px);
        let unit_px2 = std::f64::consts::PI * scale * scale;
        Self { least: floor.lambda * (1.0 - ROOM), unit_px2, best_slope: floor.best_slope }
    }

    /// Whether anything can be passed over.
    pub fn is_open(&self) -> bool {
        self.least > 0.0
    }

    /// Whether something of this worth is passed over at a distance as [`Lens::distance`] gives it. Falls with the
    /// worth and rises with the distance, to the last bit.
    pub fn is_above(&self, worth: f64, distance: f32) -> bool {
        worth * self.unit_px2 < self.least_at(distance)
    }

    /// Whether everything of at least this worth is kept at that distance.
    pub fn is_below(&self, worth: f64, distance: f32) -> bool {
        worth == f64::INFINITY || worth * self.unit_px2 >= self.least_at(distance)
    }

    /// What has to be reached at a distance by what an object is worth at distance 1.
    fn least_at(&self, distance: f32) -> f64 {
        let distance = f64::from(distance);
        self.least * (distance * distance)
    }

    /// Least and greatest ratio of a slope to the one that the tree keeps of its table, `tables` of them, and a
    /// little outwards: from worth as it is kept to bounds of worth as it is.
    pub fn ratios(&self, kept: &KeptSlopes, tables: usize) -> [f64; 2] {
        let known = if self.best_slope.len() < tables { f64::INFINITY } else { 0.0 };
        let pairs = self.best_slope.iter().take(tables).enumerate();
        let [least, most] = pairs.fold([f64::INFINITY, known], |[least, most], (table, &now)| {
            let ratio = f64::from(now) / f64::from(kept.of(table as u16));
            let ratio = if ratio.is_nan() { f64::INFINITY } else { ratio };
            [least.min(ratio), most.max(ratio)]
        });
        [least * (1.0 - 1e-12), most * (1.0 + 1e-12)]
    }

    /// The lanes of `mask` that are passed over. Straight loops over the lanes, which compilers turn into vector code.
    pub fn passes_over(&self, objects: &Objects, index: usize, lens: &Lens, mask: u16) -> u16 {
        let block = &objects.blocks()[index];
        let mask = mask & block.skippable;
        if mask == 0 {
            return 0;
        }
        let distances = distances(block, lens);
        let worth = self.worths(objects, index, mask);
        let over = std::array::from_fn(|lane| {
            let outside = !lens.perspective | (distances[lane] > block.radius[lane]);
            u32::from(outside & self.is_above(worth[lane], distances[lane]))
        });
        mask & bits(&over)
    }

    /// [`worth`] of every lane, of those in `mask` with their cost multiplier; not a number for [`worth`]'s infinity.
    fn worths(&self, objects: &Objects, index: usize, mask: u16) -> [f64; BLOCK] {
        let block = &objects.blocks()[index];
        let slope = |table: u16| self.best_slope.get(usize::from(table)).copied().unwrap_or(f32::NAN);
        let slopes = block.table.map(slope);
        let mut worths = std::array::from_fn(|lane| {
            let radius = f64::from(block.radius[lane]);
            radius * radius * f64::from(block.gain[lane]) * f64::from(slopes[lane])
        });
        for lane in lanes_of(mask & block.adjusted) {
            worths[lane] /= f64::from(objects.settings(index * BLOCK + lane).cost_multiplier);
        }
        worths
    }
}

/// The slopes that a tree's summaries of worth are made with: finite and above 0.
#[derive(Clone, Debug, Default)]
pub(super) struct KeptSlopes(Vec<f32>);

impl KeptSlopes {
    /// What is kept of a table; 1 before it is known.
    pub fn of(&self, table: u16) -> f32 {
        self.0.get(usize::from(table)).copied().unwrap_or(1.0)
    }

    /// Keeps these, where they are usable.
    pub fn keep(&mut self, slopes: &[f32]) {
        let usable = |&slope: &f32| if slope.is_finite() && slope > 0.0 { slope } else { 1.0 };
        self.0.clear();
        self.0.extend(slopes.iter().map(usable));
    }

    /// Whether these compare with each other as those that are kept do, within a factor.
    pub fn are_alike(&self, slopes: &[f32], factor: f64) -> bool {
        let usable = slopes.iter().enumerate().filter(|&(_, slope)| slope.is_finite() && *slope > 0.0);
        let ratios = usable.map(|(table, &now)| f64::from(now) / f64::from(self.of(table as u16)));
        let [least, most] =
            ratios.fold([f64::INFINITY, 0.0f64], |[least, most], ratio| [least.min(ratio), most.max(ratio)]);
        most <= least * factor
    }
}

/// The worth of an object that may be left out: radius² · gain · slope ÷ cost multiplier, which is its value where a
/// sphere of radius 1 covers a unit of area. Infinite where it has none.
pub(super) fn worth(objects: &Objects, index: usize, lane: usize, slope: Option<f32>) -> f64 {
    let block = &objects.blocks()[index];
    let multiplier = match block.adjusted & (1 << lane) {
        0 => 1.0,
        _ => objects.settings(index * BLOCK + lane).cost_multiplier,
    };
    let radius = f64::from(block.radius[lane]);
    let slope = f64::from(slope.unwrap_or(f32::NAN));
    let worth = radius * radius * f64::from(block.gain[lane]) * slope / f64::from(multiplier);
    if worth.is_nan() { f64::INFINITY } else { worth }
}
