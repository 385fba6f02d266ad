//! Spatial order along the Z-order curve (G. Morton, "A computer oriented geodetic data base", 1966).

use glam::DVec3;

use super::order::SpatialOrder;
use crate::bounds::{Aabb, Sphere};

/// Bits per axis: three times as many fit a word.
const BITS: u32 = 21;

/// Sorts spheres by the Morton code of their centres, ties by index. Keeps its buffers.
#[derive(Clone, Default)]
pub(super) struct Curve {
    codes: Vec<(u64, u32)>,
    order: Vec<u32>,
}

impl SpatialOrder for Curve {
    fn order(&mut self, spheres: &[Sphere]) -> &[u32] {
        let bounds = Aabb::around(spheres.iter().map(|s| s.center));
        let corner = bounds.min.as_dvec3();
        let extent = (bounds.max.as_dvec3() - corner).max_element().max(f64::MIN_POSITIVE);
        let cells = f64::from((1u32 << BITS) - 1) / extent;
        let codes = spheres.iter().map(|s| morton((s.center.as_dvec3() - corner) * cells));
        self.codes.clear();
        self.codes.extend(codes.zip(0..));
        self.codes.sort_unstable();
        self.order.clear();
        self.order.extend(self.codes.iter().map(|&(_, index)| index));
        &self.order
    }
}

/// Interleaves the bits of a cell's coordinates, each below 2²¹.
fn morton(cell: DVec3) -> u64 {
    spread(cell.x as u64) | spread(cell.y as u64) << 1 | spread(cell.z as u64) << 2
}

/// Two zero bits before every bit of a number below 2²¹.
fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn spread_leaves_two_zeros_before_every_bit() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
    }

    #[test]
    fn corners_of_a_cube_follow_the_curve() {
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let spheres: Vec<Sphere> = (0..8).rev().map(|i| Sphere::new(corner(i), 0.5)).collect();
        assert_eq!(Curve::default().order(&spheres), [7, 6, 5, 4, 3, 2, 1, 0]);
    }

    #[test]
    fn spheres_in_one_place_keep_their_order() {
        let spheres = [Sphere::new(Vec3::splat(3.0), 1.0); 5];
        assert_eq!(Curve::default().order(&spheres), [0, 1, 2, 3, 4]);
        assert!(Curve::default().order(&[]).is_empty());
    }
}
