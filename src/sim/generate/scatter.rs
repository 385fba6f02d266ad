//! A scatter of any size, for benchmarks.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::dice::Dice;
use super::draft::{Draft, Stock};
use super::film::{Film, key};
use crate::bounds::Sphere;
use crate::files::{CameraPath, Scene};
use crate::scene::Settings;
use crate::table::{LevelRecord, LodTable};

const TABLES: usize = 36;
/// Ground per object, in square metres: the density stays when the number of objects grows.
const GROUND: f64 = 100.0;
/// Blocks and the streets between them, as in a city.
const PITCH: f64 = 120.0;
const BLOCK: f64 = 90.0;

/// Objects in blocks like a city's, over a square that grows with their number (100 m² each): 36 tables of one to
/// six levels, from 12 triangles to 48 000; radii from 0.25 m to 64 m, small ones more often; one in eight of twice
/// the importance and one in eight of half. O(objects), about 0.1 µs each; ids from 0, positions in metres around the
/// origin.
pub fn scatter(objects: usize, seed: u64) -> Scene {
    let mut draft = Draft::of("scatter");
    let stocks: Vec<Stock> = (0..TABLES).map(|i| draft.stock_table(table(i), Settings::default())).collect();
    let mut dice = Dice::new(seed, 4);
    let side = (objects as f64 * GROUND).sqrt();
    for _ in 0..objects {
        let [x, z] = [0, 1].map(|_| in_a_block(dice.between(0.0, side)) - side / 2.0);
        let at = DVec3::new(x, dice.between(0.0, 3.0), z);
        let scale = size(&mut dice);
        draft.put_scaled(dice.pick(&stocks), at, scale).importance = dice.pick(&IMPORTANCES);
    }
    draft.finish()
}

/// A flight of half a minute through a scatter of so many objects, however large it is: at rest on its edge for five
/// seconds, rising over its middle, and looking back from before the other edge.
pub fn scatter_path(objects: usize, seed: u64) -> CameraPath {
    let reach = (objects as f64 * GROUND).sqrt() / 2.0;
    let street = (BLOCK + PITCH) / 2.0 - reach;
    let shot = [
        key(0.0, [street, 1.7, reach], 0.0, 0.0),
        key(5.0, [street, 1.7, reach], 0.0, 0.0),
        key(15.0, [0.0, 12.0, 0.0], 20.0, -10.0),
        key(25.0, [0.0, 25.0, -0.7 * reach], 0.0, 0.0),
        key(30.0, [0.0, 25.0, -0.7 * reach], 180.0, -10.0),
    ];
    Film { name: "scatter", hz: 20, sway_deg: 0.5, shots: &[&shot] }.shoot(seed)
}

const IMPORTANCES: [f32; 8] = [0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0];

/// Squeezes a coordinate out of the streets.
fn in_a_block(x: f64) -> f64 {
    let block = (x / PITCH).floor() * PITCH;
    block + (x - block) * (BLOCK / PITCH)
}

/// From 0.25 to 64: uniform within an octave, a low octave more likely than a high one.
fn size(dice: &mut Dice) -> f64 {
    let octave = dice.below(8).min(dice.below(8));
    0.25 * f64::from(1u32 << octave) * (1.0 + dice.unit())
}

/// A shape that fills a ball of radius 1, by the segments around it. Its tables follow from formulas.
#[derive(Clone, Copy)]
enum Shape {
    /// By longitude, and half as many latitudes.
    Sphere,
    /// A box with rounded edges, one more than the segments of a quarter.
    RoundedBlock,
    /// Half as many segments across as around.
    Torus,
}

/// Side of the cube in the ball.
const SIDE: f64 = 1.154_700_538_379_251_7;
const EDGE: f64 = 0.2;
const RING: f64 = 0.4;
const TUBE: f64 = 0.17;

impl Shape {
    fn triangles(self, n: u32) -> u32 {
        match self {
            Self::Sphere => 2 * n * (n / 2 - 1),
            Self::RoundedBlock => 12 + 16 * (n - 1) * n,
            Self::Torus => 2 * n * (n / 2),
        }
    }

    fn vertices(self, n: u32) -> u32 {
        match self {
            Self::Sphere => n * (n / 2 - 1) + 2,
            Self::RoundedBlock if n == 1 => 24,
            Self::RoundedBlock => 8 + 8 * (n - 1) * n,
            Self::Torus => n * (n / 2),
        }
    }

    /// How far at most the tessellation is from the smooth shape: a circle of radius r in n segments deviates by
    /// r·(1 − cos(π/n)) ≤ r·π²/(2n²), and a surface of revolution by that and its profile's deviation.
    fn deviation(self, n: u32) -> f64 {
        let sagitta = |radius: f64, segments: u32| radius * PI * PI / f64::from(2 * segments * segments);
        match self {
            Self::Sphere => 2.0 * sagitta(SIDE / 2.0, n / 2 * 2),
            // The sharp corner is √3 times the rounding from the rounding's centre.
            Self::RoundedBlock if n == 1 => 0.7321 * EDGE,
            Self::RoundedBlock => 2.0 * sagitta(EDGE, 4 * (n - 1)),
            Self::Torus => sagitta(RING + TUBE, n) + sagitta(TUBE, n / 2),
        }
    }
}

/// One to three equal shapes, of one to six levels and of four starting sizes.
fn table(index: usize) -> LodTable {
    let shape = [Shape::Sphere, Shape::RoundedBlock, Shape::Torus][index / 12];
    let finest = [128.0, 96.0, 64.0, 48.0][index % 4] / if index / 12 == 1 { 4.0 } else { 1.0 };
    let details = (0..1 + index % 6).map(|level| (finest * (2.0f64 / 3.0).powi(level as i32)) as u32);
    let times = 1 + index as u32 % 3;
    let records = details.clone().map(|n| {
        let (triangles, vertices) = (times * shape.triangles(n), times * shape.vertices(n));
        let deviation =
            if n == finest as u32 { 0.0 } else { shape.deviation(n) + shape.deviation(finest as u32) };
        LevelRecord {
            bytes: bytes_of(triangles, vertices),
            error: Some(((deviation * 1e4).ceil() / 1e4) as f32),
            ..LevelRecord::new(triangles, vertices)
        }
    });
    let bounds = Sphere::new(Vec3::new(0.0, (SIDE / 2.0) as f32, 0.0), 1.0);
    LodTable::new(format!("scatter {index}"), bounds, records.collect())
        .expect("finite, and of at least one level")
}

/// 32 bytes a vertex (position, normal, tangent and texture coordinates, packed) and three indices a triangle, of two
/// bytes where they suffice.
fn bytes_of(triangles: u32, vertices: u32) -> u64 {
    let index = if vertices > 1 << 16 { 4 } else { 2 };
    32 * u64::from(vertices) + 3 * index * u64::from(triangles)
}
