//! Which triangles go together: halves of halves, by the longest side.

use glam::Vec3;

use super::Options;
use crate::bake::Mesh;
use crate::bounds::Aabb;

/// The triangles of each part, ascending; every triangle is in one. Parts are in the order of the cuts.
pub(super) fn parts(mesh: &Mesh, options: &Options) -> Vec<Vec<u32>> {
    let centers: Vec<Vec3> = (0..mesh.triangles.len()).map(|t| center(mesh, t)).collect();
    let side = |triangles: &[u32]| longest(&extent(&centers, triangles)).1;
    let mut all: Vec<u32> = (0..centers.len() as u32).collect();
    let least = side(&all) * options.share;
    let most = options.triangles.max(1);
    let mut parts = Vec::new();
    let mut waiting = vec![all.as_mut_slice()];
    while let Some(part) = waiting.pop() {
        if part.len() <= most || side(part) <= least {
            part.sort_unstable();
            parts.extend((!part.is_empty()).then(|| part.to_vec()));
            continue;
        }
        let (low, high) = halve(&centers, part, most);
        waiting.push(high);
        waiting.push(low);
    }
    parts
}

/// The centre of a triangle, times three.
fn center(mesh: &Mesh, triangle: usize) -> Vec3 {
    mesh.corners(triangle).into_iter().map(|p| mesh.positions[p as usize]).sum()
}

fn extent(centers: &[Vec3], triangles: &[u32]) -> Vec3 {
    let bounds = Aabb::around(triangles.iter().map(|&t| centers[t as usize]));
    if bounds.is_empty() { Vec3::ZERO } else { bounds.max - bounds.min }
}

/// The axis along which an extent is longest, the first of equals, and how long it is.
fn longest(extent: &Vec3) -> (usize, f32) {
    let longer =
        |best: (usize, f32), (axis, side): (usize, f32)| if side > best.1 { (axis, side) } else { best };
    extent.to_array().into_iter().enumerate().fold((0, 0.0), longer)
}

/// Cuts across the longest side. As many parts as are needed are shared out evenly, so that all of them are about as
/// full; equal places are told apart by the triangle.
fn halve<'a>(centers: &[Vec3], part: &'a mut [u32], most: usize) -> (&'a mut [u32], &'a mut [u32]) {
    let (axis, _) = longest(&extent(centers, part));
    let needed = part.len().div_ceil(most);
    let middle = part.len() * (needed / 2) / needed;
    let place = |t: u32| centers[t as usize][axis];
    part.select_nth_unstable_by(middle, |&a, &b| place(a).total_cmp(&place(b)).then(a.cmp(&b)));
    part.split_at_mut(middle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::shapes::terrain;

    #[test]
    fn parts_are_full_and_hold_every_triangle_once() {
        let mesh: Mesh = terrain(40, 1).into();
        for most in [1, 7, 100, 3199, 3200] {
            let parts = parts(&mesh, &Options { triangles: most, share: 0.0 });
            assert!(parts.iter().all(|part| part.len() <= most && part.is_sorted()), "{most}");
            assert_eq!(parts.len(), 3200_usize.div_ceil(most), "{most}");
            let mut all: Vec<u32> = parts.concat();
            all.sort_unstable();
            assert_eq!(all, (0..3200).collect::<Vec<_>>(), "{most}");
        }
    }

    #[test]
    fn what_is_small_stays_whole() {
        let mut mesh: Mesh = terrain(20, 1).into();
        let (here, count) = (mesh.clone(), mesh.positions.len() as u32);
        mesh.positions.extend(here.positions.iter().map(|p| p + Vec3::X * 100.0));
        mesh.wedges.extend(count..2 * count);
        mesh.triangles.extend(here.triangles.iter().map(|t| t.map(|w| w + count)));
        mesh.groups[0].triangles.end *= 2;
        let parts = |share| parts(&mesh, &Options { triangles: 10, share });
        assert_eq!((parts(0.02).len(), parts(0.0).len()), (2, 160));
    }

    #[test]
    fn places_that_are_no_numbers_are_cut_somewhere() {
        let mut mesh: Mesh = terrain(4, 1).into();
        mesh.positions[3] = Vec3::NAN;
        mesh.positions[9] = Vec3::INFINITY;
        let parts = parts(&mesh, &Options { triangles: 5, share: 0.0 });
        assert_eq!(parts.iter().map(Vec::len).sum::<usize>(), 32);
    }
}
