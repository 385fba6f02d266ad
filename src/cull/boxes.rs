//! Eight boxes side by side, tried against the planes of a view at once.

use glam::Vec3;

use super::lanes::OpenTests;
use super::tree::FAN_OUT;
use crate::bounds::Aabb;
use crate::kernel::{Kernel, run};
use crate::view::{Frustum, Plane, SLACK};

/// The boxes of eight siblings, column by column, so that they fill three cache lines and compilers turn loops over
/// them into vector code. Lanes that stand for no node hold the empty box.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Boxes {
    min: [[f32; FAN_OUT]; 3],
    max: [[f32; FAN_OUT]; 3],
}

/// What planes say of eight boxes.
pub(super) struct Crossed {
    /// Bit per lane: the box is not empty and not wholly outside a plane.
    pub inside: u8,
    /// Per lane, the planes that the box is not wholly inside of.
    pub planes: [u32; FAN_OUT],
}

impl Boxes {
    pub const EMPTY: Self =
        Self { min: [[f32::INFINITY; FAN_OUT]; 3], max: [[f32::NEG_INFINITY; FAN_OUT]; 3] };

    pub fn get(&self, lane: usize) -> Aabb {
        let corner = |columns: &[[f32; FAN_OUT]; 3]| Vec3::from(columns.map(|column| column[lane]));
        Aabb { min: corner(&self.min), max: corner(&self.max) }
    }

    pub fn set(&mut self, lane: usize, aabb: &Aabb) {
        for axis in 0..3 {
            self.min[axis][lane] = aabb.min[axis];
            self.max[axis][lane] = aabb.max[axis];
        }
    }

    /// Tries the boxes against the planes in `open`: the arithmetic of [`Frustum::crossed`], eight boxes at a time. A
    /// box that is all of space crosses every plane.
    pub fn crossed(&self, frustum: &Frustum, open: OpenTests) -> Crossed {
        run(Crossing { boxes: self, frustum, open })
    }

    #[inline(always)]
    fn centers(&self) -> ([[f32; FAN_OUT]; 3], [[f32; FAN_OUT]; 3]) {
        let (mut center, mut half) = ([[0.0; FAN_OUT]; 3], [[0.0; FAN_OUT]; 3]);
        for axis in 0..3 {
            for lane in 0..FAN_OUT {
                let (min, max) = (self.min[axis][lane] * 0.5, self.max[axis][lane] * 0.5);
                center[axis][lane] = min + max;
                half[axis][lane] = max - min;
            }
        }
        (center, half)
    }
}

/// [`Boxes::crossed`].
struct Crossing<'a> {
    boxes: &'a Boxes,
    frustum: &'a Frustum,
    open: OpenTests,
}

impl Kernel for Crossing<'_> {
    type Sum = Crossed;

    #[inline(always)]
    fn run(self) -> Crossed {
        let [min, max] = [&self.boxes.min[0], &self.boxes.max[0]];
        let (center, half) = self.boxes.centers();
        let mut outside = [0; FAN_OUT];
        for lane in 0..FAN_OUT {
            outside[lane] = u32::from(min[lane] > max[lane]);
        }
        let mut planes = [0; FAN_OUT];
        for (i, plane) in self.frustum.planes.iter().enumerate().filter(|&(i, _)| self.open & (1 << i) != 0) {
            split(plane, 1 << i, &center, &half, &mut outside, &mut planes);
        }
        let inside = outside.iter().enumerate().fold(0, |mask, (lane, &out)| mask | (1 - out) << lane);
        Crossed { inside: inside as u8, planes }
    }
}

/// Notes which boxes are outside a plane, and which are not wholly inside. Comparisons with what is not a number say
/// "neither".
#[inline(always)]
fn split(
    plane: &Plane,
    bit: u32,
    center: &[[f32; FAN_OUT]; 3],
    half: &[[f32; FAN_OUT]; 3],
    outside: &mut [u32; FAN_OUT],
    crossed: &mut [u32; FAN_OUT],
) {
    let (n, a) = (plane.normal, plane.normal.abs());
    let offset = plane.offset.abs().min(f32::MAX);
    for lane in 0..FAN_OUT {
        let [x, y, z] = [center[0][lane], center[1][lane], center[2][lane]];
        let [hx, hy, hz] = [half[0][lane], half[1][lane], half[2][lane]];
        let distance = n.x * x + n.y * y + n.z * z + plane.offset;
        let reach = a.x * hx + a.y * hy + a.z * hz;
        let slack = (larger(larger(x.abs(), y.abs()), z.abs()) + larger(larger(hx, hy), hz) + offset) * SLACK;
        outside[lane] |= u32::from(distance + reach < -slack);
        crossed[lane] |= if distance - reach >= slack { 0 } else { bit };
    }
}

/// The larger of two numbers, as one instruction.
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
