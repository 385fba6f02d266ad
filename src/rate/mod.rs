//! Rate: from rows in view to candidates with a weight (what showing the object is worth) and the drivers of its
//! cost.
//!
//! Benefit = projected area · accuracy · importance · focus · motion, in px². All of it but the accuracy is the
//! candidate's weight; the accuracy is the level's. [`weigh`] makes the weights alone, from one view, [`rate`] the
//! details as well; [`details`] works them out for one candidate.

mod benefit;
mod cost;
mod levels;
mod weigh;

pub use benefit::BenefitModel;
pub use cost::{CostModel, CostModelError, DRIVER_NAMES, DRIVERS, Drivers, Stages, drivers_of};
pub use levels::{LevelRate, TableRates, estimated_error};
pub use weigh::weigh;

use glam::Vec3;

use crate::cull::VisibleBlock;
use crate::frame::{Candidate, Candidates, PixelSum};
use crate::scene::{BLOCK, Block, Objects, Settings, lanes};
use crate::table::Level;
use crate::view::Lens;

/// One view of a group.
#[derive(Clone, Debug)]
pub struct Seen {
    /// The view, made ready for this frame.
    pub lens: Lens,
    /// What culling found in it: blocks ascending.
    pub visible: Vec<VisibleBlock>,
}

/// Predicted time of a candidate at `level`; 0 when not drawn.
pub fn cost_us(model: &CostModel, rates: &TableRates, candidate: &Candidate, level: Level) -> f64 {
    if !level.is_drawn() {
        return 0.0;
    }
    let geometry_us = rates.geometry_us(candidate.table, level);
    model.object_us(geometry_us, f64::from(candidate.cost_scale), f64::from(candidate.area_px2))
}

/// A candidate of a group of one view, its details worked out from the object.
pub fn details(objects: &Objects, rates: &TableRates, lens: &Lens, slot: u32, weight: f32) -> Candidate {
    let (block, lane) = (&objects.blocks()[slot as usize / BLOCK], slot as usize % BLOCK);
    let (area_px2, size_px, near_px) = lens.project(&block.sphere(lane));
    let table = block.table[lane];
    let allowed = rates.whole(table);
    let mut candidate =
        Candidate { slot, table, allowed, weight, cost_scale: 1.0, size_px, near_px, area_px2 };
    if block.special & (1 << lane) != 0 {
        heed(&mut candidate, objects.settings(slot as usize), rates.levels(table).len());
    }
    candidate
}

/// Weighs the areas of the lanes of `mask` by focus and motion.
fn attend(
    objects: &Objects,
    index: u32,
    block: &Block,
    lens: &Lens,
    mask: u16,
    model: &BenefitModel,
    area: &mut [f32; BLOCK],
) {
    for lane in lanes(mask) {
        let velocity = match block.special & (1 << lane) {
            0 => Vec3::ZERO,
            _ => objects.settings(index as usize * BLOCK + lane).velocity,
        };
        area[lane] *= model.attention(lens, &block.sphere(lane), velocity);
    }
}

/// What the views of a group see of one block: a column per quantity, sums and maxima over the views.
struct Rows {
    mask: u16,
    area_px2: [f32; BLOCK],
    weight: [f32; BLOCK],
    size_px: [f32; BLOCK],
    near_px: [f32; BLOCK],
    views: [f32; BLOCK],
}

/// Appends the candidates of one group: the union of what its views see, slots ascending. The caller closes the run
/// with [`Candidates::end_group`]. `cursors` is scratch.
pub fn rate(
    objects: &Objects,
    rates: &TableRates,
    views: &[Seen],
    model: &BenefitModel,
    cursors: &mut Vec<usize>,
    candidates: &mut Candidates,
) {
    cursors.clear();
    cursors.resize(views.len(), 0);
    while let Some(index) = next_block(views, cursors) {
        let block = &objects.blocks()[index as usize];
        let mut rows = Rows::EMPTY;
        for (seen, cursor) in views.iter().zip(cursors.iter_mut()) {
            if let Some(found) = seen.visible.get(*cursor).filter(|v| v.block == index) {
                *cursor += 1;
                rows.add(objects, index, block, &seen.lens, found.mask, model);
            }
        }
        push_rows(objects, rates, index, block, &rows, model, candidates);
    }
}

/// The lowest block that some view has yet to deliver.
fn next_block(views: &[Seen], cursors: &[usize]) -> Option<u32> {
    views.iter().zip(cursors).filter_map(|(seen, &cursor)| seen.visible.get(cursor)).map(|v| v.block).min()
}

impl Rows {
    const EMPTY: Self = Self {
        mask: 0,
        area_px2: [0.0; BLOCK],
        weight: [0.0; BLOCK],
        size_px: [0.0; BLOCK],
        near_px: [0.0; BLOCK],
        views: [0.0; BLOCK],
    };

    /// Adds what one view sees. Lanes outside `mask` contribute nothing.
    fn add(
        &mut self,
        objects: &Objects,
        index: u32,
        block: &Block,
        lens: &Lens,
        mask: u16,
        model: &BenefitModel,
    ) {
        let mut area = project(self, block, lens, mask);
        if !model.is_plain() {
            attend(objects, index, block, lens, mask, model, &mut area);
        }
        for (weight, (area, gain)) in self.weight.iter_mut().zip(area.iter().zip(&block.gain)) {
            *weight += area * gain;
        }
        self.mask |= mask;
    }
}

/// The projected area of every lane of `mask`, and into `rows` what does not depend on attention. The lens's maths
/// (see [`Lens::area_px2`], [`Lens::size_px`], [`Lens::unit_px`]), a column at a time.
fn project(rows: &mut Rows, block: &Block, lens: &Lens, mask: u16) -> [f32; BLOCK] {
    let mut area = [0.0; BLOCK];
    for (lane, area) in area.iter_mut().enumerate() {
        let sphere = block.sphere(lane);
        let seen = f32::from(mask >> lane & 1);
        let (area_px2, size_px, near_px) = lens.project(&sphere);
        *area = area_px2 * seen;
        rows.area_px2[lane] += area_px2 * seen;
        rows.size_px[lane] = rows.size_px[lane].max(size_px * seen);
        rows.near_px[lane] = rows.near_px[lane].max(near_px * seen);
        rows.views[lane] += seen;
    }
    area
}

fn push_rows(
    objects: &Objects,
    rates: &TableRates,
    index: u32,
    block: &Block,
    rows: &Rows,
    model: &BenefitModel,
    candidates: &mut Candidates,
) {
    candidates.push_row(index, rows.mask, &rows.weight);
    let slot = index * BLOCK as u32;
    for lane in lanes(rows.mask) {
        let table = block.table[lane];
        let mut candidate = Candidate {
            slot: slot + lane as u32,
            table,
            allowed: rates.whole(table),
            weight: rows.weight[lane],
            cost_scale: rows.views[lane],
            size_px: rows.size_px[lane],
            near_px: rows.near_px[lane],
            area_px2: rows.area_px2[lane],
        };
        let levels = rates.levels(table);
        if block.special & (1 << lane) != 0 {
            heed(&mut candidate, objects.settings(slot as usize + lane), levels.len());
        }
        if model.enough_px > 0.0 {
            spare(&mut candidate, levels, model.enough_px);
        }
        candidates.pixels.add(PixelSum::rounded(candidate.area_px2));
        candidates.push_details(candidate);
    }
}

/// What the settings of a special object change. Its bias is in the weight already.
fn heed(candidate: &mut Candidate, settings: &Settings, levels: usize) {
    candidate.allowed = settings.allowed(levels);
    let unclamped = candidate.allowed.coarsest.index() + 1 == levels;
    if settings.may_skip && settings.forced.is_none() && unclamped {
        candidate.allowed.coarsest = Level::NOT_DRAWN;
    }
    candidate.cost_scale *= settings.cost_multiplier;
    candidate.area_px2 *= settings.cost_multiplier;
    candidate.size_px *= settings.bias;
    candidate.near_px *= settings.bias;
}

/// Takes away the levels that are finer than the coarsest one whose projected error is small enough.
fn spare(candidate: &mut Candidate, levels: &[LevelRate], enough_px: f32) {
    let last = candidate.allowed.coarsest.index().min(levels.len() - 1);
    let finest = candidate.allowed.finest.index();
    let enough = (finest..=last).rev().find(|&l| levels[l].error * candidate.near_px <= enough_px);
    candidate.allowed.finest = Level(enough.unwrap_or(finest) as u8);
}
