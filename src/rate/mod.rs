//! Rate: from rows in view to candidates with a weight (what showing the object is worth) and the drivers of its
//! cost.
//!
//! Benefit = projected area · accuracy · importance · focus · motion, in px². All of it but the accuracy is the
//! candidate's weight; the accuracy is the level's. [`weigh`] makes the weights alone, from one view, [`rate`] the details
//! as well; [`details`] works them out for one candidate.

mod benefit;
mod cost;
mod levels;

pub use benefit::BenefitModel;
pub use cost::{CostModel, CostModelError, DRIVER_NAMES, DRIVERS, Drivers, Stages, drivers_of};
pub use levels::{LevelRate, TableRates, estimated_error};

use glam::Vec3;

use crate::cull::VisibleBlock;
use crate::frame::{Candidate, Candidates, PixelSum, Row};
use crate::kernel::{Divisible, Kernel, run_on};
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

/// Appends the candidates of a group of one view without their details: weights and the sum of areas; the sizes too
/// where they are asked for. On so many threads where there are many objects (feature `rayon`). The caller closes the run with [`Candidates::end_group`]. Candidates must not be detailed.
pub fn weigh(
    objects: &Objects,
    seen: &Seen,
    model: &BenefitModel,
    with_sizes: bool,
    threads: usize,
    candidates: &mut Candidates,
) {
    let (first, first_row) = (candidates.len(), candidates.rows.len());
    candidates.push_blocks(seen.visible.iter().map(|v| (v.block, v.mask)));
    let Candidates { rows, weight, .. } = &mut *candidates;
    let (rows, weight) = (&rows[first_row..], &mut weight[first..]);
    let weighed = run_on(threads, Weighing { objects, lens: &seen.lens, model, rows, weight });
    candidates.pixels.add(weighed.pixels);
    candidates.heaviest = candidates.heaviest.max(weighed.heaviest);
    if with_sizes {
        for &VisibleBlock { block, mask } in &seen.visible {
            candidates.push_sizes(mask, &sizes_px(objects, block, &seen.lens, mask));
        }
    }
}

/// Rows whose candidates are to be weighed, and where their weights go.
struct Weighing<'a> {
    objects: &'a Objects,
    lens: &'a Lens,
    model: &'a BenefitModel,
    rows: &'a [Row],
    weight: &'a mut [f32],
}

/// What weighing adds up.
struct Weighed {
    /// Areas as they count for the pixel stage, rounded.
    pixels: f64,
    heaviest: f32,
}

impl Kernel for Weighing<'_> {
    type Sum = Weighed;

    #[inline(always)]
    fn run(self) -> Weighed {
        let start = self.rows.first().map_or(0, |row| row.first) as usize;
        let (mut pixels, mut heaviest) = ([0.0; BLOCK], [0.0f32; BLOCK]);
        for row in self.rows {
            let block = &self.objects.blocks()[row.block as usize];
            let mut weight = [0.0; BLOCK];
            for (lane, area) in weight.iter_mut().enumerate() {
                *area = self.lens.area_px2(&block.sphere(lane));
            }
            let costly = costly_areas(self.objects, row.block, block, &weight, row.mask);
            if !self.model.is_plain() {
                attend(self.objects, row.block, block, self.lens, row.mask, self.model, &mut weight);
            }
            let at = row.first as usize - start;
            for lane in 0..BLOCK {
                weight[lane] *= block.gain[lane];
                pixels[lane] += costly[lane];
            }
            if row.mask == u16::MAX {
                self.weight[at..at + BLOCK].copy_from_slice(&weight);
            } else {
                let weights = &mut self.weight[at..at + row.mask.count_ones() as usize];
                lanes(row.mask).zip(weights).for_each(|(lane, to)| *to = weight[lane]);
                lanes(!row.mask).for_each(|lane| weight[lane] = 0.0);
            }
            for lane in 0..BLOCK {
                heaviest[lane] = if weight[lane] > heaviest[lane] { weight[lane] } else { heaviest[lane] };
            }
        }
        Weighed { pixels: pixels.iter().sum(), heaviest: heaviest.into_iter().fold(0.0, f32::max) }
    }
}

impl Divisible for Weighing<'_> {
    fn len(&self) -> usize {
        self.weight.len()
    }

    fn halves(self) -> [Self; 2] {
        let start = self.rows.first().map_or(0, |row| row.first);
        let (rows, other_rows) = self.rows.split_at(self.rows.len() / 2);
        let at = other_rows.first().map_or(0, |row| row.first - start) as usize;
        let (weight, other_weight) = self.weight.split_at_mut(at);
        [Self { rows, weight, ..self }, Self { rows: other_rows, weight: other_weight, ..self }]
    }

    fn join([a, b]: [Weighed; 2]) -> Weighed {
        Weighed { pixels: a.pixels + b.pixels, heaviest: a.heaviest.max(b.heaviest) }
    }
}

/// The projected diameters of the lanes of `mask`, bias included, and of the others as they are.
fn sizes_px(objects: &Objects, index: u32, lens: &Lens, mask: u16) -> [f32; BLOCK] {
    let block = &objects.blocks()[index as usize];
    let mut sizes_px = [0.0; BLOCK];
    for (lane, size_px) in sizes_px.iter_mut().enumerate() {
        *size_px = lens.size_px(&block.sphere(lane));
    }
    for lane in lanes(block.special & mask) {
        sizes_px[lane] *= objects.settings(index as usize * BLOCK + lane).bias;
    }
    sizes_px
}

/// The areas of the lanes of `mask` as they count for the pixel stage, rounded so that their sum is exact.
#[inline(always)]
fn costly_areas(
    objects: &Objects,
    index: u32,
    block: &Block,
    area: &[f32; BLOCK],
    mask: u16,
) -> [f64; BLOCK] {
    let mut costly = [0.0; BLOCK];
    for (lane, costly) in costly.iter_mut().enumerate() {
        *costly = PixelSum::rounded(area[lane]);
    }
    for lane in lanes(block.special & mask) {
        let multiplier = objects.settings(index as usize * BLOCK + lane).cost_multiplier;
        costly[lane] = PixelSum::rounded(area[lane] * multiplier);
    }
    for lane in lanes(!mask) {
        costly[lane] = 0.0;
    }
    costly
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
