//! Which triangles go together: halves of halves, by the longest side.

use glam::Vec3;

use super::Options;
use super::pieces::{Spot, side, spots};
use crate::bake::Mesh;
use crate::bounds::Aabb;

/// The triangles of each part, ascending; every triangle is in one. Parts are in the order of the cuts.
pub(super) fn parts(mesh: &Mesh, options: &Options) -> Vec<Vec<u32>> {
    let most = options.triangles.max(1);
    let spots = spots(mesh, most);
    let mut all: Vec<u32> = (0..spots.len() as u32).collect();
    let least = side(&extent(&spots, &all)) * options.share;
    let mut parts = Vec::new();
    let mut waiting = vec![all.as_mut_slice()];
    while let Some(part) = waiting.pop() {
        if part.len() <= most || side(&extent(&spots, part)) <= least {
            part.sort_unstable();
            parts.extend((!part.is_empty()).then(|| part.to_vec()));
            continue;
        }
        let (low, high) = halve(&spots, part, most);
        waiting.push(high);
        waiting.push(low);
    }
    parts
}

fn extent(spots: &[Spot], triangles: &[u32]) -> Aabb {
    Aabb::around(triangles.iter().map(|&t| spots[t as usize].place))
}

/// The axis along which a box is longest, the first of equals.
fn longest(bounds: &Aabb) -> usize {
    let sides: Vec3 = bounds.max - bounds.min;
    (1..3).fold(0, |best, axis| if sides[axis] > sides[best] { axis } else { best })
}

/// Cuts across the longest side. As many parts as are needed are shared out evenly, so that all of them are about as
/// full; pieces that stay whole are on one side.
fn halve<'a>(spots: &[Spot], part: &'a mut [u32], most: usize) -> (&'a mut [u32], &'a mut [u32]) {
    let axis = longest(&extent(spots, part));
    let place = |t: u32| spots[t as usize].place[axis];
    let piece = |t: u32| spots[t as usize].piece;
    part.sort_unstable_by(|&a, &b| {
        place(a).total_cmp(&place(b)).then(piece(a).cmp(&piece(b))).then(a.cmp(&b))
    });
    let needed = part.len().div_ceil(most);
    let middle = part.len() * (needed / 2) / needed;
    let cut = beside_piece(part, middle, |a, b| piece(a) == piece(b));
    part.split_at_mut(cut)
}

/// The place nearest to `middle` that is not within a piece. There is one, since no piece that stays whole is a part by
/// itself that is too large.
fn beside_piece(part: &[u32], middle: usize, same: impl Fn(u32, u32) -> bool) -> usize {
    let before = part[..middle].iter().rev().take_while(|&&t| same(t, part[middle])).count();
    let after = part[middle..].iter().take_while(|&&t| same(t, part[middle])).count();
    let (low, high) = (middle - before, middle + after);
    if low > 0 && (before <= after || high == part.len()) { low } else { high.min(part.len() - 1) }
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
    fn a_cut_is_beside_a_piece() {
        let cut = |pieces: &[u32], middle| {
            let part: Vec<u32> = (0..pieces.len() as u32).collect();
            beside_piece(&part, middle, |a, b| pieces[a as usize] == pieces[b as usize])
        };
        assert_eq!((cut(&[0, 1, 2, 3], 2), cut(&[0, 1, 1, 3], 2), cut(&[0, 1, 1, 1, 4], 3)), (2, 1, 4));
        assert_eq!((cut(&[0, 0, 0, 3], 2), cut(&[0, 1, 1, 1], 2)), (3, 1));
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
