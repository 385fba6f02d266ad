//! The scene that all rows are measured in, made from a seed.
//!
//! Objects are scattered over a square of ground, a hundred square metres to each, so that the density stays when
//! their number grows. Radii are from 0.25 m to 64 m, small ones more often; one in eight counts twice and one in
//! eight half. There are 256 tables of two to six levels. The order of objects is that of the dice, which is not
//! that of space: what an engine's list of entities looks like after a while.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Metres of a square's side that each object has to itself.
const SPACING: f32 = 10.0;
/// Objects stand no higher than this.
const HEIGHT: f32 = 30.0;
const TABLES: usize = 256;
/// Steps that an object can take at most.
pub const MOST_STEPS: usize = 5;
const IMPORTANCES: [f32; 8] = [0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0];

/// Costs are counted in 1024ths of a microsecond, in which all of them are integers: a quarter of a microsecond per
/// draw, and one unit per triangle and per vertex.
pub const UNITS_PER_US: f64 = 1024.0;
const DRAW_UNITS: u32 = 256;

/// One level of a table.
#[derive(Clone, Copy)]
pub struct Detail {
    pub triangles: u32,
    pub vertices: u32,
    pub accuracy: f32,
}

impl Detail {
    /// What it costs, in 1024ths of a microsecond.
    pub fn units(&self) -> u32 {
        DRAW_UNITS + self.triangles + self.vertices
    }
}

/// Objects column by column, and the levels of their tables, finest first.
pub struct Scene {
    pub side: f32,
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
    pub radius: Vec<f32>,
    pub importance: Vec<f32>,
    pub table: Vec<u16>,
    pub tables: Vec<Vec<Detail>>,
}

impl Scene {
    pub fn scatter(objects: usize, seed: u64) -> Self {
        let mut dice = Pcg64::seed_from_u64(seed);
        let side = SPACING * (objects as f32).sqrt();
        let tables = (0..TABLES).map(|_| table(&mut dice)).collect();
        let mut scene = Self::with_room(objects, side, tables);
        for _ in 0..objects {
            scene.x.push(side * dice.random::<f32>());
            scene.y.push(HEIGHT * dice.random::<f32>());
            scene.z.push(side * dice.random::<f32>());
            scene.radius.push(radius(&mut dice));
            scene.importance.push(IMPORTANCES[dice.random_range(0..IMPORTANCES.len())]);
            scene.table.push(dice.random_range(0..TABLES) as u16);
        }
        scene
    }

    fn with_room(objects: usize, side: f32, tables: Vec<Vec<Detail>>) -> Self {
        let [x, y, z, radius, importance] = [(); 5].map(|()| Vec::with_capacity(objects));
        Self { side, x, y, z, radius, importance, table: Vec::with_capacity(objects), tables }
    }

    pub fn len(&self) -> usize {
        self.x.len()
    }

    pub fn sphere(&self, i: usize) -> [f32; 4] {
        [self.x[i], self.y[i], self.z[i], self.radius[i]]
    }

    /// The same objects along a Morton curve over the ground: neighbours in space are neighbours in memory.
    pub fn in_spatial_order(&self) -> Self {
        let mut order: Vec<usize> = (0..self.len()).collect();
        order.sort_by_cached_key(|&i| {
            interleave(self.cell(self.x[i])) | interleave(self.cell(self.z[i])) << 1
        });
        let mut sorted = Self::with_room(self.len(), self.side, self.tables.clone());
        let columns = [&self.x, &self.y, &self.z, &self.radius, &self.importance];
        let [x, y, z, radius, importance] = columns.map(|c| order.iter().map(|&i| c[i]).collect());
        sorted.table.extend(order.iter().map(|&i| self.table[i]));
        Self { x, y, z, radius, importance, ..sorted }
    }

    fn cell(&self, coordinate: f32) -> u32 {
        (coordinate / self.side * 65_535.0) as u32
    }
}

/// The 16 low bits, a zero after each.
fn interleave(bits: u32) -> u32 {
    (0..16).fold(0, |spread, bit| spread | (bits >> bit & 1) << (2 * bit))
}

/// Two to six levels. Triangles fall to a fifth or to a half from one level to the next, and what is missing of full
/// accuracy doubles or so.
fn table(dice: &mut Pcg64) -> Vec<Detail> {
    let levels = dice.random_range(2..=MOST_STEPS + 1);
    let mut triangles = dice.random_range(2_000.0f32..30_000.0);
    let mut missing = dice.random_range(0.002f32..0.02);
    let mut level = || {
        let counts = (triangles as u32, (triangles * 0.6) as u32);
        let detail = Detail { triangles: counts.0, vertices: counts.1, accuracy: 1.0 - missing.min(0.95) };
        triangles = (triangles * dice.random_range(0.2f32..0.5)).max(12.0);
        missing *= dice.random_range(1.5f32..3.0);
        detail
    };
    (0..levels).map(|_| level()).collect()
}

/// Uniform within an octave, a low octave more likely than a high one.
fn radius(dice: &mut Pcg64) -> f32 {
    let octave = dice.random_range(0..8u32).min(dice.random_range(0..8));
    0.25 * (1u32 << octave) as f32 * (1.0 + dice.random::<f32>())
}
