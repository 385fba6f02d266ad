//! What candidates may choose from that share no hull: those that may be left out, and all where the slower of two
//! stages counts.
//!
//! Costs are worked out for eight levels side by side, from columns per table that are kept until the rates change.

use crate::frame::Candidate;
use crate::knapsack::{Ends, Menus, Octet, OwnClass};
use crate::rate::{CostModel, LevelRate, Stages, TableRates};
use crate::table::Level;

/// Levels that are looked at together.
const LANES: usize = 8;

/// Levels of a table side by side, and "not drawn" after the last one. Lanes without either are worth nothing at an
/// infinite cost.
#[derive(Clone, Copy, Debug)]
struct Columns {
    value: [f64; LANES],
    geometry_us: [f64; LANES],
    /// 1 where there is something to draw, else 0.
    drawn: [f64; LANES],
}

impl Columns {
    /// Of the levels from the first one of an octet on.
    fn of(levels: &[LevelRate]) -> Self {
        let [value, drawn] = [[Octet::NOTHING[0]; LANES], [0.0; LANES]];
        let mut columns = Self { value, geometry_us: [f64::INFINITY; LANES], drawn };
        for (lane, rate) in levels.iter().take(LANES).enumerate() {
            columns.value[lane] = f64::from(rate.accuracy);
            columns.geometry_us[lane] = rate.geometry_us;
            columns.drawn[lane] = 1.0;
        }
        if levels.len() < LANES {
            (columns.value[levels.len()], columns.geometry_us[levels.len()]) = (0.0, 0.0);
        }
        columns
    }
}

/// Where the levels of a table are.
#[derive(Clone, Copy, Debug)]
struct Span {
    start: u32,
    levels: u8,
    /// The level that costs least, and the cheapest of the best ones.
    cheapest: u8,
    best: u8,
}

/// The columns of all tables.
#[derive(Clone, Debug, Default)]
pub(super) struct MenuColumns {
    columns: Vec<Columns>,
    spans: Vec<Span>,
    /// How many octets the levels of any table and "not drawn" fill at most.
    most_octets: usize,
}

impl MenuColumns {
    /// Makes them anew and keeps the memory. Time: O(levels).
    pub fn renew(&mut self, rates: &TableRates) {
        self.columns.clear();
        self.spans.clear();
        self.most_octets = 0;
        for table in (0..rates.tables()).map(|table| table as u16) {
            let (levels, start) = (rates.levels(table), self.columns.len());
            self.columns
                .extend((0..=levels.len() / LANES).map(|octet| Columns::of(&levels[octet * LANES..])));
            self.spans.push(Span {
                start: start as u32,
                levels: levels.len() as u8,
                cheapest: rates.minimum(table, rates.whole(table)).0,
                best: best(levels),
            });
            self.most_octets = self.most_octets.max(self.columns.len() - start);
        }
    }
}

/// The cheapest of the best levels.
fn best(levels: &[LevelRate]) -> u8 {
    let better = |(best, b): (u8, LevelRate), (level, l): (u8, LevelRate)| {
        let wins = l.accuracy > b.accuracy || l.accuracy == b.accuracy && l.geometry_us < b.geometry_us;
        if wins { (level, l) } else { (best, b) }
    };
    (0..).zip(levels.iter().copied()).reduce(better).map_or(0, |(level, _)| level)
}

/// A candidate that shares no hull.
#[derive(Clone, Copy, Debug)]
struct OwnCandidate {
    class: OwnClass,
    table: u16,
    /// Its items, from the finest to the coarsest; "not drawn" is the one after the table's last level.
    items: [u8; 2],
    cost_scale: f32,
    area_px2: f32,
}

/// What prices levels in a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pricing<'a> {
    pub columns: &'a MenuColumns,
    pub model: &'a CostModel,
    pub ticks_per_us: f64,
}

impl Pricing<'_> {
    fn span(&self, candidate: &OwnCandidate) -> Span {
        self.columns.spans[usize::from(candidate.table)]
    }

    /// The factor on geometry, and the time of pixels, which is a number.
    fn factors(&self, candidate: &OwnCandidate) -> [f64; 2] {
        let area_px2 = f64::from(candidate.area_px2.min(f32::MAX));
        [f64::from(candidate.cost_scale), self.model.pixel_us * area_px2]
    }

    fn octet(&self, candidate: &OwnCandidate, octet: usize) -> Octet {
        let columns = &self.columns.columns[self.span(candidate).start as usize + octet];
        let cost_us = match self.model.stages {
            Stages::Sum => sums_us(columns, self.factors(candidate)),
            Stages::Max => maxima_us(columns, self.factors(candidate)),
        };
        let ticks = cost_us.map(|cost_us| whole_ticks(cost_us * self.ticks_per_us));
        narrowed(columns.value, ticks, candidate.items.map(|item| f64::from(item) - (octet * LANES) as f64))
    }

    /// Ticks of an item.
    fn ticks(&self, candidate: &OwnCandidate, item: u8) -> u64 {
        let (span, [scale, pixels_us]) = (self.span(candidate), self.factors(candidate));
        if item == span.levels {
            return 0;
        }
        let (octet, lane) = (usize::from(item) / LANES, usize::from(item) % LANES);
        let geometry_us = self.columns.columns[span.start as usize + octet].geometry_us[lane] * scale;
        let cost_us = match self.model.stages {
            Stages::Sum => geometry_us + pixels_us,
            Stages::Max => geometry_us.max(pixels_us),
        };
        whole_ticks(cost_us * self.ticks_per_us) as u64
    }

    /// Ticks of the cheapest item, and of the cheapest of the best ones: those of the table where its levels are not
    /// narrowed, for time rises with geometry.
    fn ends(&self, candidate: &OwnCandidate) -> [u64; 2] {
        let (span, [first, last]) = (self.span(candidate), candidate.items);
        let ticks = |item: u8| self.ticks(candidate, item);
        let (cheapest, best) = if first == 0 && last + 1 >= span.levels {
            (span.cheapest, span.best)
        } else {
            return self.ends_of_octets(candidate);
        };
        [if last == span.levels { 0 } else { ticks(cheapest) }, ticks(best)]
    }

    /// The same by a look at all items.
    fn ends_of_octets(&self, candidate: &OwnCandidate) -> [u64; 2] {
        let octets = (0..=usize::from(candidate.items[1]) / LANES).map(|octet| self.octet(candidate, octet));
        let items = octets.flat_map(|octet| octet.value.into_iter().zip(octet.ticks));
        let (mut cheapest, mut best) = (f64::INFINITY, [Octet::NOTHING[0], f64::INFINITY]);
        for (value, ticks) in items.filter(|(value, _)| *value >= 0.0) {
            cheapest = cheapest.min(ticks);
            let is_better = value > best[0] || value == best[0] && ticks < best[1];
            best = if is_better { [value, ticks] } else { best };
        }
        [cheapest as u64, best[1] as u64]
    }
}

/// The candidates of a frame that share no hull, ascending.
#[derive(Clone, Debug, Default)]
pub(super) struct OwnCandidates {
    candidates: Vec<OwnCandidate>,
    ends: Ends,
}

impl OwnCandidates {
    /// Forgets all and keeps the memory.
    pub fn clear(&mut self) {
        self.candidates.clear();
        self.ends = Ends::default();
    }

    /// Adds the candidate at `at`, which holds the level that was wanted of it.
    pub fn push(
        &mut self,
        at: usize,
        candidate: &Candidate,
        held: Option<Level>,
        stay: f32,
        pricing: &Pricing<'_>,
    ) {
        let Candidate { table, allowed, weight, cost_scale, area_px2, .. } = *candidate;
        let levels = pricing.columns.spans[usize::from(table)].levels;
        let item = |level: Level| if level.is_drawn() { level.0.min(levels - 1) } else { levels };
        let held = held.filter(|held| !held.is_drawn() || held.0 < levels).map(item);
        let class = OwnClass { at: at as u32, weight, stay, held };
        let items = [item(allowed.finest), item(allowed.coarsest)];
        let own = OwnCandidate { class, table, items, cost_scale, area_px2 };
        let [cheapest, best] = pricing.ends(&own);
        self.ends.add(cheapest, best);
        self.candidates.push(own);
    }
}

/// [`OwnCandidates`] with what prices them.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameMenus<'a> {
    pub own: &'a OwnCandidates,
    pub pricing: Pricing<'a>,
}

impl Menus for FrameMenus<'_> {
    fn len(&self) -> usize {
        self.own.candidates.len()
    }

    fn ends(&self) -> Ends {
        self.own.ends
    }

    fn class(&self, n: usize) -> OwnClass {
        self.own.candidates[n].class
    }

    fn octets(&self, n: usize) -> usize {
        usize::from(self.own.candidates[n].items[1]) / LANES + 1
    }

    fn most_octets(&self) -> usize {
        self.pricing.columns.most_octets
    }

    #[inline]
    fn octet(&self, n: usize, octet: usize) -> Octet {
        self.pricing.octet(&self.own.candidates[n], octet)
    }

    fn code(&self, n: usize, item: u8) -> u8 {
        let is_drawn = item < self.pricing.span(&self.own.candidates[n]).levels;
        if is_drawn { item } else { Level::NOT_DRAWN.0 }
    }
}

/// [`CostModel::object_us`] of every lane, where the stages add up.
fn sums_us(columns: &Columns, [scale, pixels_us]: [f64; 2]) -> [f64; LANES] {
    let mut cost_us = [0.0; LANES];
    for (lane, cost_us) in cost_us.iter_mut().enumerate() {
        *cost_us = columns.geometry_us[lane] * scale + columns.drawn[lane] * pixels_us;
    }
    cost_us
}

/// [`CostModel::object_us`] of every lane, where the slower stage counts.
fn maxima_us(columns: &Columns, [scale, pixels_us]: [f64; 2]) -> [f64; LANES] {
    let mut cost_us = [0.0; LANES];
    for (lane, cost_us) in cost_us.iter_mut().enumerate() {
        let (geometry, pixels) = (columns.geometry_us[lane] * scale, columns.drawn[lane] * pixels_us);
        *cost_us = if geometry > pixels { geometry } else { pixels };
    }
    cost_us
}

/// The numbers of lanes.
const LANE: [f64; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// The items in the lanes from the first to the last.
fn narrowed(value: [f64; LANES], ticks: [f64; LANES], [first, last]: [f64; 2]) -> Octet {
    let [no_value, no_ticks] = Octet::NOTHING;
    let mut items = Octet { value, ticks };
    for lane in 0..LANES {
        let is_allowed = (LANE[lane] >= first) & (LANE[lane] <= last);
        items.value[lane] = if is_allowed { value[lane] } else { no_value };
        items.ticks[lane] = if is_allowed { ticks[lane] } else { no_ticks };
    }
    items
}

/// Rounds ticks, which are not negative, up to whole ones; beyond 2⁶² it holds. Free of branches.
pub(super) fn whole_ticks(ticks: f64) -> f64 {
    const WHOLE: f64 = (1u64 << 52) as f64;
    const MOST: f64 = (1u64 << 62) as f64;
    let near = ticks + WHOLE - WHOLE;
    let up = near + if near < ticks { 1.0 } else { 0.0 };
    let whole = if ticks < WHOLE { up } else { ticks };
    if whole < MOST { whole } else { MOST }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Sphere;
    use crate::rate::cost_us;
    use crate::scene::LevelRange;
    use crate::table::{LevelRecord, LodTable};
    use glam::Vec3;
    use proptest::prelude::*;

    #[test]
    fn ticks_are_rounded_up() {
        let whole = [0.0, 1e-300, 0.5, 1.0, 1.0000000000000002, 2.5].map(whole_ticks);
        assert_eq!(whole, [0.0, 1.0, 1.0, 1.0, 2.0, 3.0]);
        assert_eq!(whole_ticks(f64::INFINITY), 2f64.powi(62));
        assert_eq!(whole_ticks(f64::MAX), 2f64.powi(62));
    }

    proptest! {
        #[test]
        fn octets_hold_what_the_model_says(
            counts in prop::collection::vec((1u32..5000, 0.0f32..1.0), 1..20),
            allowed in (0u8..20, 0u8..20, any::<bool>()),
            (cost_scale, area_px2, pixel_us) in (0.1f32..10.0, 0.0f32..1e6, 0.0f64..1e-3),
            is_max in any::<bool>(),
        ) {
            let stages = if is_max { Stages::Max } else { Stages::Sum };
            let model = CostModel { pixel_us, stages, ..CostModel::default() };
            let level = |(triangles, accuracy): (u32, f32)| {
                LevelRecord { accuracy, ..LevelRecord::new(triangles, triangles) }
            };
            let levels = counts.into_iter().map(level).collect();
            let table = LodTable::new("table", Sphere::new(Vec3::ZERO, 1.0), levels).expect("a good table");
            let last = table.coarsest().0;
            let (mut rates, mut columns) = (TableRates::default(), MenuColumns::default());
            rates.renew(&[table], &model);
            columns.renew(&rates);
            let finest = Level(allowed.0.min(last));
            let coarsest = if allowed.2 { Level::NOT_DRAWN } else { Level(allowed.1.clamp(finest.0, last)) };
            let allowed = LevelRange { finest, coarsest };
            let candidate = Candidate {
                slot: 0, table: 0, allowed, weight: 1.0, cost_scale, size_px: 1.0, near_px: 1.0, area_px2,
            };
            let pricing = Pricing { columns: &columns, model: &model, ticks_per_us: 1024.0 };
            let mut own = OwnCandidates::default();
            own.push(0, &candidate, None, 0.0, &pricing);
            let menus = FrameMenus { own: &own, pricing };
            let skip = (!coarsest.is_drawn()).then_some((Level::NOT_DRAWN, 0.0));
            let drawn = rates.drawn(0, allowed).map(|(level, rate)| (level, rate.accuracy));
            let expected: Vec<_> = drawn.chain(skip).map(|(level, value)| {
                let ticks = (cost_us(&model, &rates, &candidate, level) * 1024.0).ceil();
                (level.0, f64::from(value), ticks)
            }).collect();
            let octets = (0..menus.octets(0)).map(|octet| menus.octet(0, octet));
            let lanes = octets.flat_map(|octet| octet.value.into_iter().zip(octet.ticks));
            let found: Vec<_> = (0..).zip(lanes).filter(|(_, (value, _))| *value >= 0.0)
                .map(|(item, (value, ticks))| (menus.code(0, item), value, ticks)).collect();
            prop_assert_eq!(found, expected);
            let own = own.candidates[0];
            prop_assert_eq!(pricing.ends(&own), pricing.ends_of_octets(&own));
        }

        #[test]
        fn ticks_are_rounded_up_as_by_the_library(mantissa in any::<u64>(), exponent in -60i32..63) {
            let ticks = (mantissa >> 11) as f64 * 2f64.powi(exponent - 53);
            prop_assert_eq!(whole_ticks(ticks), ticks.ceil().min(2f64.powi(62)));
        }
    }
}
