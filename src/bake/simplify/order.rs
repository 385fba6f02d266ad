//! Neighbours in space next to each other in memory.

use glam::Vec3;

use crate::bounds::Aabb;

/// Bits per axis of a place on the curve.
const BITS: u32 = 10;

/// The vertices that triangles use, along a Z-order curve, ties by index. O(n log n).
///
/// Meshes come in all orders, some of them random, and what simplification waits for is memory.
pub(super) fn along_curve(positions: &[Vec3], triangles: impl Iterator<Item = [u32; 3]>) -> Vec<u32> {
    let mut is_used = vec![false; positions.len()];
    for corner in triangles.flatten() {
        is_used[corner as usize] = true;
    }
    let used = || (0..positions.len() as u32).filter(|&v| is_used[v as usize]);
    let bounds = Aabb::around(used().map(|v| positions[v as usize]));
    let corner = bounds.min.as_dvec3();
    let extent = (bounds.max.as_dvec3() - corner).max_element().max(f64::MIN_POSITIVE);
    let cells = f64::from((1u32 << BITS) - 1) / extent;
    let code = |v: u32| {
        let cell = ((positions[v as usize].as_dvec3() - corner) * cells).as_u64vec3();
        spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
    };
    let mut keys: Vec<u64> = used().map(|v| code(v) << 32 | u64::from(v)).collect();
    keys.sort_unstable();
    keys.into_iter().map(|key| key as u32).collect()
}

/// Two zero bits before every bit of a number below 2²¹.
pub(super) fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// Triangles in the order of their lowest corners, ties by index: the indices of all, from the corners. O(n).
pub(super) fn by_lowest_corner(triangles: &[[u32; 3]], vertices: usize) -> Vec<u32> {
    let lowest = |t: &[u32; 3]| t[0].min(t[1]).min(t[2]) as usize;
    let mut next = vec![0; vertices + 1];
    for triangle in triangles {
        next[lowest(triangle) + 1] += 1;
    }
    for vertex in 0..vertices {
        next[vertex + 1] += next[vertex];
    }
    let mut order = vec![0; triangles.len()];
    for (index, triangle) in (0..).zip(triangles) {
        let at: &mut u32 = &mut next[lowest(triangle)];
        order[*at as usize] = index;
        *at += 1;
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_leaves_two_zeros_before_every_bit() {
        for bit in 0..21 {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
    }

    #[test]
    fn the_curve_goes_octant_by_octant_and_leaves_out_what_is_not_used() {
        let positions = [Vec3::ONE, Vec3::ZERO, Vec3::NAN, Vec3::Z, Vec3::X, Vec3::X, Vec3::Y];
        assert_eq!(along_curve(&positions, [[0, 1, 3], [4, 5, 6]].into_iter()), [1, 4, 5, 6, 3, 0]);
        assert!(along_curve(&positions, [].into_iter()).is_empty());
    }

    #[test]
    fn triangles_are_sorted_by_their_lowest_corner() {
        assert_eq!(by_lowest_corner(&[[3, 2, 4], [0, 1, 2], [4, 3, 2], [1, 2, 0]], 5), [1, 3, 0, 2]);
    }
}
