//! Neighbours in space next to each other in memory.

use glam::Vec3;

use crate::bounds::Aabb;

/// Bits per axis of a place on the curve, and of a digit that places are sorted by.
const BITS: u32 = 10;

/// The vertices that triangles use, along a Z-order curve, ties by index. O(n).
///
/// Meshes come in all orders, some of them random, and what simplification waits for is memory.
pub(super) fn along_curve(positions: &[Vec3], triangles: impl Iterator<Item = [u32; 3]>) -> Vec<u32> {
    let mut is_used = vec![false; positions.len()];
    for corner in triangles.flatten() {
        is_used[corner as usize] = true;
    }
    let used: Vec<u32> = (0..positions.len() as u32).filter(|&v| is_used[v as usize]).collect();
    let bounds = Aabb::around(used.iter().map(|&v| positions[v as usize]));
    let corner = bounds.min.as_dvec3();
    let extent = (bounds.max.as_dvec3() - corner).max_element().max(f64::MIN_POSITIVE);
    let cells = f64::from((1u32 << BITS) - 1) / extent;
    let place = |&v: &u32| {
        let cell = ((positions[v as usize].as_dvec3() - corner) * cells).as_uvec3();
        let [x, y, z] = cell.to_array().map(|x| spread(u64::from(x)) as u32);
        (v, x | y << 1 | z << 2)
    };
    let mut places: Vec<(u32, u32)> = used.iter().map(place).collect();
    for digit in 0..3 {
        let digits = places.iter().map(|&(_, place)| place >> (digit * BITS) & ((1 << BITS) - 1));
        places = by_key(digits, 1 << BITS).into_iter().map(|i| places[i as usize]).collect();
    }
    places.into_iter().map(|(vertex, _)| vertex).collect()
}

/// Two zero bits before every bit of a number below 2²¹.
pub(super) fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// The indices of some keys in ascending order of the keys, all of which are below `end`; ties by index. O(n + end).
pub(super) fn by_key(keys: impl ExactSizeIterator<Item = u32> + Clone, end: usize) -> Vec<u32> {
    let mut next = vec![0; end + 1];
    for key in keys.clone() {
        next[key as usize + 1] += 1;
    }
    for key in 0..end {
        next[key + 1] += next[key];
    }
    let mut order = vec![0; keys.len()];
    for (index, key) in (0..).zip(keys) {
        let at: &mut u32 = &mut next[key as usize];
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
    fn keys_are_sorted_ties_by_index() {
        assert_eq!(by_key([2, 0, 2, 0, 5].into_iter(), 6), [1, 3, 0, 2, 4]);
        assert!(by_key([].into_iter(), 0).is_empty());
    }
}
