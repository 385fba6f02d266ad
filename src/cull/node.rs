//! What the tree knows about the objects below a node.

use glam::Vec3;

use super::lanes::lanes_of;
use super::value::{KeptSlopes, worth};
use crate::bounds::{Aabb, Sphere};
use crate::scene::{BLOCK, Block, Objects};

/// Objects that reach farther from the origin than this, in world units, are put into a box that is all of space
/// and always tested one by one: beyond about 1e19 the distance to a plane can overflow, and a box could no longer
/// foretell the exact test. Any value from the size of the largest world to 1e18 is right.
pub(super) const TAME: f32 = 1e15;

/// Added to every side of a box, so that its extent is a normal number and relative room for rounding is room. Any
/// value from 1e-32 to the size of a speck of dust is right.
const SKIN: f32 = 1e-30;

/// Summary of the live objects below a node of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    /// Holds all their spheres; empty when there is none, all of space when one is beyond [`TAME`].
    pub aabb: Aabb,
    pub limits: Limits,
}

/// What is known of the live objects below a node beside where they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    /// Least and greatest radius · bias.
    pub size: [f32; 2],
    /// Least and greatest draw distance.
    pub reach: [f32; 2],
    /// Least and greatest worth at the slopes that the tree keeps; infinite for what may not be left out.
    pub worth: [f64; 2],
    /// How many there are.
    pub live: u32,
    /// Summed half-area of the tame boxes of the blocks below.
    pub area: f32,
}

impl Limits {
    const EMPTY: Self = Self {
        size: [f32::INFINITY, 0.0],
        reach: [f32::INFINITY, 0.0],
        worth: [f64::INFINITY, 0.0],
        live: 0,
        area: 0.0,
    };

    fn union(&self, other: &Self) -> Self {
        Self {
            size: [self.size[0].min(other.size[0]), self.size[1].max(other.size[1])],
            reach: [self.reach[0].min(other.reach[0]), self.reach[1].max(other.reach[1])],
            worth: [self.worth[0].min(other.worth[0]), self.worth[1].max(other.worth[1])],
            live: self.live + other.live,
            area: self.area + other.area,
        }
    }
}

impl Node {
    /// No object at all; the neutral element of [`Node::union`].
    pub const EMPTY: Self = Self { aabb: Aabb::EMPTY, limits: Limits::EMPTY };

    /// The node over one block. Straight loops over the lanes, which compilers turn into vector code.
    pub fn of_block(objects: &Objects, index: usize, slopes: &KeptSlopes) -> Self {
        let block = &objects.blocks()[index];
        if block.live == 0 {
            return Self::EMPTY;
        }
        let aabb = spacious(block);
        let area = if aabb.max.x < f32::INFINITY { aabb.half_area() } else { 0.0 };
        let (size, reach) = sizes_and_reaches(objects, index);
        let worth = worths(objects, index, slopes);
        let limits = Limits { size, reach, worth, live: block.live.count_ones(), area };
        Self { aabb, limits }
    }

    /// The node over both.
    pub fn union(&self, other: &Self) -> Self {
        Self { aabb: self.aabb.union(other.aabb), limits: self.limits.union(&other.limits) }
    }
}

/// Distances from a finite `eye` that no centre in the box is nearer or farther than, per axis.
///
/// Every step of the way from a centre to its distance, and on to its size, is a rounded operation, which is
/// monotone; the corners of the box take the same steps, so that the bounds hold to the last bit, without room
/// for rounding.
pub(super) fn reach(aabb: &Aabb, eye: Vec3) -> [Vec3; 2] {
    let (below, above) = (aabb.min - eye, eye - aabb.max);
    [below.max(above).max(Vec3::ZERO), below.abs().max(above.abs())]
}

/// A box around the live spheres of a block with a little room, or all of space.
fn spacious(block: &Block) -> Aabb {
    let tame = (0..BLOCK).fold(0, |tame, lane| tame | u16::from(is_tame(&block.sphere(lane))) << lane);
    if block.live & !tame != 0 {
        return Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
    }
    let [x, y, z] = [&block.x, &block.y, &block.z].map(|column| span(block.live, column, &block.radius));
    Aabb { min: Vec3::new(x[0], y[0], z[0]), max: Vec3::new(x[1], y[1], z[1]) }
}

/// From where to where the live spheres reach along an axis, and a little farther.
fn span(live: u16, column: &[f32; BLOCK], radius: &[f32; BLOCK]) -> [f32; 2] {
    let (mut lower, mut upper) = ([0.0; BLOCK], [0.0; BLOCK]);
    for lane in 0..BLOCK {
        lower[lane] = column[lane] - radius[lane] - SKIN;
        upper[lane] = column[lane] + radius[lane] + SKIN;
    }
    [least(live, lower), -least(live, upper.map(|x| -x))]
}

/// The least number in the lanes of `mask`; infinite without one. By halves, so that it is vector code.
fn least(mask: u16, mut lanes: [f32; BLOCK]) -> f32 {
    for (lane, number) in lanes.iter_mut().enumerate() {
        *number = if mask >> lane & 1 != 0 { *number } else { f32::INFINITY };
    }
    for half in [8, 4, 2, 1] {
        for lane in 0..half {
            let (a, b) = (lanes[lane], lanes[lane + half]);
            lanes[lane] = if b < a { b } else { a };
        }
    }
    lanes[0]
}

/// Least and greatest radius · bias, and draw distance.
fn sizes_and_reaches(objects: &Objects, index: usize) -> ([f32; 2], [f32; 2]) {
    let block = &objects.blocks()[index];
    let (mut sizes, mut reach) = (block.radius, [f32::INFINITY; 2]);
    let adjusted = block.live & block.adjusted;
    for lane in lanes_of(adjusted) {
        let settings = objects.settings(index * BLOCK + lane);
        sizes[lane] *= settings.bias;
        reach[0] = reach[0].min(settings.draw_distance);
    }
    if adjusted == block.live {
        let farthest = |lane| objects.settings(index * BLOCK + lane).draw_distance;
        reach[1] = lanes_of(adjusted).map(farthest).fold(0.0, f32::max);
    }
    ([least(block.live, sizes), -least(block.live, sizes.map(|x| -x))], reach)
}

/// Least and greatest worth; infinite where an object may not be left out.
fn worths(objects: &Objects, index: usize, slopes: &KeptSlopes) -> [f64; 2] {
    let block = &objects.blocks()[index];
    let skippable = block.live & block.skippable;
    let of_lane = |lane| worth(objects, index, lane, Some(slopes.of(block.table[lane])));
    let start = if skippable == block.live { 0.0 } else { f64::INFINITY };
    lanes_of(skippable)
        .map(of_lane)
        .fold([f64::INFINITY, start], |[least, most], worth| [least.min(worth), most.max(worth)])
}

/// Whether planes can be told from rounding at the sphere's place.
pub(super) fn is_tame(sphere: &Sphere) -> bool {
    sphere.center.abs().max_element() + sphere.radius <= TAME
}
