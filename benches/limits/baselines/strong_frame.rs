//! The frame of someone who knows the machine but not the problem: every object tested in straight loops over
//! blocks of sixteen, columns in spatial order, and the packed steps sorted.

use super::Selection;
use super::classes::{Classes, Hull};
use super::u64_sort::U64Sort;
use crate::camera::Lens;
use crate::scene::Scene;

const LANES: usize = 16;

/// Objects column by column.
#[derive(Clone)]
#[repr(align(64))]
struct Block {
    x: [f32; LANES],
    y: [f32; LANES],
    z: [f32; LANES],
    radius: [f32; LANES],
    importance: [f32; LANES],
    table: [u16; LANES],
}

pub struct StrongFrame<'a> {
    hulls: &'a [Hull],
    blocks: Vec<Block>,
    /// The position that each object in view has been given.
    pub position: Vec<u8>,
    pub table: Vec<u16>,
    pub weight: Vec<f32>,
    selection: U64Sort,
}

impl<'a> StrongFrame<'a> {
    pub fn over(scene: &Scene, hulls: &'a [Hull]) -> Self {
        let sorted = scene.in_spatial_order();
        Self {
            hulls,
            blocks: (0..sorted.len()).step_by(LANES).map(|first| block(&sorted, first)).collect(),
            position: Vec::new(),
            table: Vec::new(),
            weight: Vec::new(),
            selection: U64Sort::default(),
        }
    }

    /// Chooses for everything in view.
    pub fn run(&mut self, lens: &Lens, budget: u64) {
        self.list_visible(lens);
        self.position.resize(self.table.len(), 0);
        let classes = Classes { hulls: self.hulls, table: &self.table, weight: &self.weight };
        self.selection.choose(&classes, budget, &mut self.position);
    }

    fn list_visible(&mut self, lens: &Lens) {
        let Self { blocks, table, weight, .. } = self;
        table.clear();
        weight.clear();
        for block in blocks.iter() {
            match block.mask(lens) {
                0 => {}
                u16::MAX => {
                    weight.extend_from_slice(&block.weight(lens));
                    table.extend_from_slice(&block.table);
                }
                mask => {
                    let all = block.weight(lens);
                    weight.extend(lanes(mask).map(|lane| all[lane]));
                    table.extend(lanes(mask).map(|lane| block.table[lane]));
                }
            }
        }
    }
}

/// The positions of the bits of a mask, ascending.
fn lanes(mut mask: u16) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        (mask != 0).then(|| {
            mask &= mask - 1;
            lane
        })
    })
}

/// The objects from `first` on. Lanes beyond the last are of no size, infinitely far away.
fn block(scene: &Scene, first: usize) -> Block {
    let column = |from: &[f32], empty: f32| {
        std::array::from_fn(|lane| from.get(first + lane).copied().unwrap_or(empty))
    };
    Block {
        x: column(&scene.x, f32::NEG_INFINITY),
        y: column(&scene.y, 0.0),
        z: column(&scene.z, 0.0),
        radius: column(&scene.radius, 0.0),
        importance: column(&scene.importance, 0.0),
        table: std::array::from_fn(|lane| scene.table.get(first + lane).copied().unwrap_or(0)),
    }
}

impl Block {
    /// A bit for each lane that is in view.
    fn mask(&self, lens: &Lens) -> u16 {
        let mut nearest = [f32::INFINITY; LANES];
        for [a, b, c, d] in lens.planes {
            for (lane, nearest) in nearest.iter_mut().enumerate() {
                let distance = a * self.x[lane] + b * self.y[lane] + c * self.z[lane] + d;
                *nearest = nearest.min(distance + self.radius[lane]);
            }
        }
        let bits = nearest.iter().enumerate();
        bits.fold(0, |mask, (lane, &nearest)| mask | u16::from(nearest >= 0.0) << lane)
    }

    fn weight(&self, lens: &Lens) -> [f32; LANES] {
        std::array::from_fn(|lane| {
            let sphere = [self.x[lane], self.y[lane], self.z[lane], self.radius[lane]];
            lens.weight(sphere, self.importance[lane])
        })
    }
}
