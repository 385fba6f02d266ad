//! A procedural terrain.

use glam::Vec2;
use lod_budget::bake::{Surface, shapes};

/// How many cells of the mesh the finest bump is wide, and of how many bumps the coarsest octave is on a side.
const FINEST: u32 = 4;
const COARSEST: u32 = 4;

/// Height of the coarsest octave, in units.
const RELIEF: f32 = 0.08;

/// How high an octave is, as a share of the one before.
const FALL: f32 = 0.55;

/// A square of 1 by 1 units of `2·side²` triangles: octaves of noise down to a few cells, each half as wide as the one
/// before and 0.55 times as high (K. Perlin, "An image synthesizer", 1985). `shapes::terrain` has a grain from vertex to
/// vertex instead, of which no mesh but the whole one knows.
pub fn land(side: u32) -> Surface {
    let octaves = (side / FINEST / COARSEST).max(1).ilog2() + 1;
    let height = |at: Vec2| -> f32 {
        (0..octaves).map(|o| RELIEF * FALL.powi(o as i32) * noise(at * (COARSEST << o) as f32, o)).sum()
    };
    let mut land = shapes::terrain(side, 0);
    land.positions.iter_mut().for_each(|p| p.z = height(p.truncate()));
    land
}

/// Values in [-1, 1] at whole numbers, smoothly blended between.
fn noise(at: Vec2, octave: u32) -> f32 {
    let (cell, part) = (at.floor(), at.fract());
    let blend = part * part * part * (part * (part * 6.0 - 15.0) + 10.0);
    let value = |x: u32, y: u32| random(cell.x as u32 + x, cell.y as u32 + y, octave);
    let [low, high] = [0, 1].map(|y| value(0, y) * (1.0 - blend.x) + value(1, y) * blend.x);
    low * (1.0 - blend.y) + high * blend.y
}

/// A random number in [-1, 1] for three whole numbers.
fn random(x: u32, y: u32, octave: u32) -> f32 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ octave.wrapping_mul(0xc2b2_ae3d);
    for _ in 0..2 {
        h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    }
    ((h ^ (h >> 16)) >> 8) as f32 / (1 << 23) as f32 - 1.0
}
