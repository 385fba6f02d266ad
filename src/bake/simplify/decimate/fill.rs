//! Triangulating a loop by splitting it again and again.

use glam::DVec3;

/// Triangles of a loop, by the places of its corners, counter-clockwise around `normal`: indices into the loop.
///
/// Of all straight cuts from corner to corner that leave the two parts on their own sides, the best is made, and then
/// those of the parts: that whose nearest corner is farthest away, compared with its length. `None` where a cut would
/// be worse than `least_aspect`, or there is none. O(n³) at worst, for a loop of n corners.
pub(super) fn fill(places: &[DVec3], normal: DVec3, least_aspect: f64) -> Option<Vec<[usize; 3]>> {
    let mut triangles = Vec::with_capacity(places.len().saturating_sub(2));
    let mut parts: Vec<Vec<usize>> = vec![(0..places.len()).collect()];
    while let Some(part) = parts.pop() {
        match part[..] {
            [] | [_] | [_, _] => {}
            [a, b, c] => triangles.push([a, b, c]),
            _ => parts.extend(split(&part, places, normal, least_aspect)?),
        }
    }
    Some(triangles)
}

/// The two parts of a loop on either side of the best cut.
fn split(part: &[usize], places: &[DVec3], normal: DVec3, least_aspect: f64) -> Option<[Vec<usize>; 2]> {
    let count = part.len();
    let cuts = (0..count).flat_map(|i| (i + 2..count).map(move |j| (i, j)));
    let inner = cuts.filter(|&(i, j)| !(i == 0 && j == count - 1));
    let judged = inner.map(|(i, j)| (aspect(part, places, normal, i, j), i, j));
    let (best, i, j) = judged.max_by(|a, b| a.0.total_cmp(&b.0).then((b.1, b.2).cmp(&(a.1, a.2))))?;
    let near = part[i..=j].to_vec();
    let far = part[j..].iter().chain(&part[..=i]).copied().collect();
    (best > least_aspect.max(0.0)).then_some([near, far])
}

/// How good a cut is: the least distance of a corner from it, compared with its length; negative if one is on the wrong
/// side.
fn aspect(part: &[usize], places: &[DVec3], normal: DVec3, i: usize, j: usize) -> f64 {
    let from = places[part[i]];
    let cut = places[part[j]] - from;
    let outwards = cut.cross(normal).normalize_or_zero();
    let off = |k: usize| outwards.dot(places[part[k]] - from);
    let near = (i + 1..j).map(off);
    let far = (j + 1..part.len()).chain(0..i).map(|k| -off(k));
    near.chain(far).fold(f64::INFINITY, f64::min) / cut.length()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(points: &[[f64; 2]]) -> Vec<DVec3> {
        points.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
    }

    fn area(places: &[DVec3], triangles: &[[usize; 3]]) -> f64 {
        let part = |&[a, b, c]: &[usize; 3]| (places[b] - places[a]).cross(places[c] - places[a]).z / 2.0;
        assert!(triangles.iter().all(|t| part(t) > 0.0));
        triangles.iter().map(part).sum()
    }

    #[test]
    fn loops_are_covered_whole_convex_or_not() {
        let arrow = flat(&[[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.8, 1.0]]);
        let filled = fill(&arrow, DVec3::Z, 0.0).expect("an arrow has a cut");
        assert_eq!((filled.len(), (area(&arrow, &filled) - 1.2).abs() < 1e-12), (2, true));
        let disc: Vec<DVec3> =
            (0..9).map(|i| DVec3::new(f64::from(i).cos(), f64::from(i).sin(), 0.0)).collect();
        let disc = &disc[..6];
        let filled = fill(disc, DVec3::Z, 0.0).expect("convex");
        let whole: f64 = (0..6).map(|i| disc[i].cross(disc[(i + 1) % 6]).z / 2.0).sum();
        assert!(filled.len() == 4 && (area(disc, &filled) - whole).abs() < 1e-12);
    }

    #[test]
    fn loops_without_a_good_cut_are_left() {
        let sliver = flat(&[[0.0, 0.0], [1.0, 0.01], [2.0, 0.0], [1.0, 0.02]]);
        assert!(fill(&sliver, DVec3::Z, 0.001).is_some());
        assert_eq!(fill(&sliver, DVec3::Z, 0.1), None);
        let star = flat(&[[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.8, 1.0]]);
        assert_eq!(fill(&star, DVec3::NEG_Z, 0.0), None, "seen from behind");
    }

    #[test]
    fn a_triangle_is_itself_and_less_is_nothing() {
        let places = flat(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        assert_eq!(fill(&places, DVec3::Z, 0.5), Some(vec![[0, 1, 2]]));
        assert_eq!(fill(&places[..2], DVec3::Z, 0.5), Some(vec![]));
    }
}
