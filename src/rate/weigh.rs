//! Weights of the candidates of one view: a kernel over blocks.

use super::{BenefitModel, Seen, attend};
use crate::cull::VisibleBlock;
use crate::frame::{Candidates, PixelSum, Row};
use crate::kernel::{Divisible, Kernel, run_on};
use crate::scene::{BLOCK, Block, Objects, lanes};
use crate::view::Lens;

/// Appends the candidates of a group of one view without their details: weights and the sum of areas; the sizes too
/// where they are asked for. On so many threads where there are many objects (feature `rayon`). The caller closes the
/// run with [`Candidates::end_group`]. Candidates must not be detailed.
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
    fn run(mut self) -> Weighed {
        let start = self.rows.first().map_or(0, |row| row.first) as usize;
        let (mut pixels, mut heaviest) = ([0.0; BLOCK], [0.0f32; BLOCK]);
        for row in self.rows {
            let block = &self.objects.blocks()[row.block as usize];
            let mut area = [0.0; BLOCK];
            for (lane, area) in area.iter_mut().enumerate() {
                *area = self.lens.area_px2(&block.sphere(lane));
            }
            let costly = costly_areas(self.objects, block, row, &area);
            if !self.model.is_plain() {
                attend(self.objects, row.block, block, self.lens, row.mask, self.model, &mut area);
            }
            let mut weight = area;
            for lane in 0..BLOCK {
                weight[lane] *= block.gain[lane];
                pixels[lane] += costly[lane];
            }
            self.write(row.first as usize - start, row.mask, &mut weight);
            for lane in 0..BLOCK {
                heaviest[lane] = if weight[lane] > heaviest[lane] { weight[lane] } else { heaviest[lane] };
            }
        }
        Weighed { pixels: pixels.iter().sum(), heaviest: heaviest.into_iter().fold(0.0, f32::max) }
    }
}

impl Weighing<'_> {
    /// Writes the weights of the lanes of `mask`, and sets the others to 0.
    #[inline(always)]
    fn write(&mut self, at: usize, mask: u16, weight: &mut [f32; BLOCK]) {
        if mask == u16::MAX {
            self.weight[at..at + BLOCK].copy_from_slice(weight);
            return;
        }
        let weights = &mut self.weight[at..at + mask.count_ones() as usize];
        lanes(mask).zip(weights).for_each(|(lane, to)| *to = weight[lane]);
        lanes(!mask).for_each(|lane| weight[lane] = 0.0);
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

/// The areas of the candidates of a row as they count for the pixel stage, rounded so that their sum is exact; 0 in the
/// other lanes.
#[inline(always)]
fn costly_areas(objects: &Objects, block: &Block, row: &Row, area: &[f32; BLOCK]) -> [f64; BLOCK] {
    let mut costly = [0.0; BLOCK];
    for (lane, costly) in costly.iter_mut().enumerate() {
        *costly = PixelSum::rounded(area[lane]);
    }
    for lane in lanes(block.special & row.mask) {
        let multiplier = objects.settings(row.block as usize * BLOCK + lane).cost_multiplier;
        costly[lane] = PixelSum::rounded(area[lane] * multiplier);
    }
    lanes(!row.mask).for_each(|lane| costly[lane] = 0.0);
    costly
}
