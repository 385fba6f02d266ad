//! A scatter of any size, for benchmarks.

use glam::DVec3;

use super::dice::Dice;
use super::draft::{Draft, Stock};
use super::film::{Film, key};
use super::kind::Kind;
use super::shape::Shape;
use crate::files::{CameraPath, Scene};

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
    let mut draft = Draft::new("scatter");
    let stocks: Vec<Stock> = (0..TABLES).map(|i| draft.stock(kind(i))).collect();
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

/// Shapes that fill a ball of radius 1, of one to six levels and of four starting sizes.
fn kind(index: usize) -> Kind {
    let side = 2.0 / 3f64.sqrt();
    let shapes = [
        Shape::Sphere { radius: side / 2.0 },
        Shape::RoundedBlock([side; 3], 0.2),
        Shape::Torus { ring: 0.4, tube: 0.17 },
    ];
    let levels = 1 + index % 6;
    let finest = [128.0, 96.0, 64.0, 48.0][index % 4];
    let parts = 1 + index as u32 % 3;
    let shape = shapes[index / 12];
    let step = if matches!(shape, Shape::RoundedBlock(..)) { 4.0 } else { 1.0 };
    let segments = std::iter::successors(Some(finest), |segments| Some(segments * (2.0 / 3.0)));
    let details: Vec<u32> = segments.take(levels).map(|s| (s / step) as u32).collect();
    Kind::new(format!("scatter {index}"), [side, side, side]).part("grey", shape, parts, &details)
}
