//! What candidates may choose from that share no hull: those that may be left out, and all where the slower of two stages
//! counts.
//!
//! Costs are worked out for eight levels side by side, from columns per table that are kept until the rates change.

use crate::frame::Candidate;
use crate::knapsack::{Menus, Octet, OwnClass};
use crate::rate::{CostModel, TableRates};
use crate::table::Level;

/// Levels that are looked at together.
const LANES: usize = 8;

/// Levels of a table, side by side, and after them "not drawn".
#[derive(Clone, Copy, Debug)]
struct Columns {
    value: [f64; LANES],
    geometry_us: [f64; LANES],
    /// 1 where there is something to draw, else 0.
    drawn: [f64; LANES],
}

impl Columns {
    const NOTHING: Self = Self { value: [0.0; LANES], geometry_us: [0.0; LANES], drawn: [0.0; LANES] };
}

/// Where the levels of a table are.
#[derive(Clone, Copy, Debug)]
struct Span {
    start: u32,
    levels: u8,
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
            let levels = rates.levels(table);
            self.spans.push(Span { start: self.columns.len() as u32, levels: levels.len() as u8 });
            self.most_octets = self.most_octets.max(levels.len() / LANES + 1);
            for octet in 0..=levels.len() / LANES {
                let mut columns = Columns::NOTHING;
                for (lane, rate) in levels.iter().skip(octet * LANES).take(LANES).enumerate() {
                    columns.value[lane] = f64::from(rate.accuracy);
                    columns.geometry_us[lane] = rate.geometry_us;
                    columns.drawn[lane] = 1.0;
                }
                self.columns.push(columns);
            }
        }
    }
}

/// A candidate that shares no hull.
#[derive(Clone, Copy, Debug)]
pub(super) struct OwnCandidate {
    class: OwnClass,
    table: u16,
    /// Its items, from the finest to the coarsest; "not drawn" is the one after the table's last level.
    items: [u8; 2],
    cost_scale: f32,
    area_px2: f32,
}

impl OwnCandidate {
    /// The candidate at `at`, holding the level that was wanted of it.
    pub fn new(
        at: usize,
        candidate: &Candidate,
        held: Option<Level>,
        stay: f32,
        columns: &MenuColumns,
    ) -> Self {
        let Candidate { table, allowed, weight, cost_scale, area_px2, .. } = *candidate;
        let levels = columns.spans[usize::from(table)].levels;
        let drawn = |level: Level| level.0.min(levels - 1);
        let item = |level: Level| if level.is_drawn() { drawn(level) } else { levels };
        let held = held.filter(|held| !held.is_drawn() || held.0 < levels).map(item);
        Self {
            class: OwnClass { at: at as u32, weight, stay, held },
            table,
            items: [item(allowed.finest), item(allowed.coarsest)],
            cost_scale,
            area_px2,
        }
    }
}

/// The candidates of a frame that share no hull, with what is needed to price them.
#[derive(Clone, Copy)]
pub(super) struct FrameMenus<'a> {
    pub columns: &'a MenuColumns,
    pub candidates: &'a [OwnCandidate],
    pub model: &'a CostModel,
    pub ticks_per_us: f64,
}

impl FrameMenus<'_> {
    fn span(&self, n: usize) -> Span {
        self.columns.spans[usize::from(self.candidates[n].table)]
    }
}

impl Menus for FrameMenus<'_> {
    fn len(&self) -> usize {
        self.candidates.len()
    }

    fn class(&self, n: usize) -> OwnClass {
        self.candidates[n].class
    }

    fn octets(&self, n: usize) -> usize {
        usize::from(self.candidates[n].items[1]) / LANES + 1
    }

    fn most_octets(&self) -> usize {
        self.columns.most_octets
    }

    fn octet(&self, n: usize, octet: usize) -> Octet {
        let OwnCandidate { items: [first, last], cost_scale, area_px2, .. } = self.candidates[n];
        let [scale, area, first, last] =
            [f64::from(cost_scale), f64::from(area_px2), f64::from(first), f64::from(last)];
        let Columns { value, geometry_us, drawn } = self.columns.columns[self.span(n).start as usize + octet];
        let [no_value, no_ticks] = Octet::NOTHING;
        let mut items = Octet { value: [no_value; LANES], ticks: [no_ticks; LANES] };
        for lane in 0..LANES {
            let item = (octet * LANES + lane) as f64;
            let is_allowed = (item >= first) & (item <= last);
            let cost_us = self.model.object_us(geometry_us[lane], scale, area * drawn[lane]);
            let ticks = whole_ticks(cost_us * self.ticks_per_us);
            items.value[lane] = if is_allowed { value[lane] } else { no_value };
            items.ticks[lane] = if is_allowed { ticks } else { no_ticks };
        }
        items
    }

    fn code(&self, n: usize, item: u8) -> u8 {
        if item == self.span(n).levels { Level::NOT_DRAWN.0 } else { item }
    }
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
        fn ticks_are_rounded_up_as_by_the_library(mantissa in any::<u64>(), exponent in -60i32..63) {
            let ticks = (mantissa >> 11) as f64 * 2f64.powi(exponent - 53);
            prop_assert_eq!(whole_ticks(ticks), ticks.ceil().min(2f64.powi(62)));
        }
    }
}
