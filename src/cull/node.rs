//! What the tree knows about the objects below a node.

use glam::Vec3;

use super::value::{KeptSlopes, worth};
use crate::bounds::{Aabb, Sphere};
use crate::scene::{BLOCK, Objects};

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

    /// The node over one block.
    pub fn of_block(objects: &Objects, index: usize, slopes: &KeptSlopes) -> Self {
        let block = &objects.blocks()[index];
        let lanes = (0..BLOCK).filter(|lane| block.live & (1 << lane) != 0);
        let mut node =
            lanes.fold(Self::EMPTY, |node, lane| node.union(&Self::of_object(objects, index, lane, slopes)));
        node.limits.area = if node.is_tame() { node.aabb.half_area() } else { 0.0 };
        node
    }

    fn of_object(objects: &Objects, index: usize, lane: usize, slopes: &KeptSlopes) -> Self {
        let block = &objects.blocks()[index];
        let sphere = block.sphere(lane);
        let (bias, draw_distance) = match block.adjusted & (1 << lane) {
            0 => (1.0, f32::INFINITY),
            _ => {
                let settings = objects.settings(index * BLOCK + lane);
                (settings.bias, settings.draw_distance)
            }
        };
        let worth = match block.skippable & (1 << lane) {
            0 => f64::INFINITY,
            _ => worth(objects, index, lane, Some(slopes.of(block.table[lane]))),
        };
        let limits = Limits {
            size: [sphere.radius * bias; 2],
            reach: [draw_distance; 2],
            worth: [worth; 2],
            live: 1,
            area: 0.0,
        };
        Self { aabb: spacious(&sphere), limits }
    }

    /// The node over both.
    pub fn union(&self, other: &Self) -> Self {
        Self { aabb: self.aabb.union(other.aabb), limits: self.limits.union(&other.limits) }
    }

    /// Whether the box may be tried against planes.
    pub fn is_tame(&self) -> bool {
        self.aabb.max.x < f32::INFINITY
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

/// A box around the sphere with a little room, or all of space.
fn spacious(sphere: &Sphere) -> Aabb {
    if !is_tame(sphere) {
        return Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
    }
    let aabb = sphere.aabb();
    Aabb { min: aabb.min - SKIN, max: aabb.max + SKIN }
}

/// Whether planes can be told from rounding at the sphere's place.
pub(super) fn is_tame(sphere: &Sphere) -> bool {
    sphere.center.abs().max_element() + sphere.radius <= TAME
}
