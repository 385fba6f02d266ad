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
        let worth = range(block.live, &worths(objects, index, slopes), [f64::INFINITY, 0.0]);
        let none = [f32::INFINITY, 0.0];
        let limits = Limits {
            size: range(block.live, &size, none),
            reach: range(block.live, &reach, none),
            worth,
            live: block.live.count_ones(),
            area,
        };
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
    let outside = [f32::INFINITY, f32::NEG_INFINITY];
    let [x, y, z] = [&block.x, &block.y, &block.z].map(|column| {
        let lower = std::array::from_fn(|lane| column[lane] - block.radius[lane] - SKIN);
        let upper = std::array::from_fn(|lane| column[lane] + block.radius[lane] + SKIN);
        [range(block.live, &lower, outside)[0], range(block.live, &upper, outside)[1]]
    });
    Aabb { min: Vec3::new(x[0], y[0], z[0]), max: Vec3::new(x[1], y[1], z[1]) }
}

/// Radius · bias and draw distance per lane.
fn sizes_and_reaches(objects: &Objects, index: usize) -> ([f32; BLOCK], [f32; BLOCK]) {
    let block = &objects.blocks()[index];
    let (mut sizes, mut reaches) = (block.radius, [f32::INFINITY; BLOCK]);
    for lane in lanes_of(block.live & block.adjusted) {
        let settings = objects.settings(index * BLOCK + lane);
        sizes[lane] *= settings.bias;
        reaches[lane] = settings.draw_distance;
    }
    (sizes, reaches)
}

/// Worth per lane; infinite for what may not be left out.
fn worths(objects: &Objects, index: usize, slopes: &KeptSlopes) -> [f64; BLOCK] {
    let block = &objects.blocks()[index];
    let mut worths = [f64::INFINITY; BLOCK];
    for lane in lanes_of(block.live & block.skippable) {
        worths[lane] = worth(objects, index, lane, Some(slopes.of(block.table[lane])));
    }
    worths
}

/// Least and greatest number in the lanes of `mask`, starting from those of no lane.
fn range<T: Copy + PartialOrd>(mask: u16, lanes: &[T; BLOCK], none: [T; 2]) -> [T; 2] {
    lanes.iter().enumerate().fold(none, |[least, most], (lane, &number)| {
        let counts = mask >> lane & 1 != 0;
        [
            if counts & (number < least) { number } else { least },
            if counts & (number > most) { number } else { most },
        ]
    })
}

/// Whether planes can be told from rounding at the sphere's place.
pub(super) fn is_tame(sphere: &Sphere) -> bool {
    sphere.center.abs().max_element() + sphere.radius <= TAME
}
