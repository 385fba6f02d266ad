//! How far a contraction moves the surface, along one direction.
//!
//! Both sets of triangles, those before and those after, are seen along an axis. Where either covers the same region
//! once, they lie one above the other; how far they are apart there is linear in each cell of their overlay, so that
//! the largest distance is at a corner of a cell: at a vertex, or where an edge of one crosses an edge of the other
//! (J. Cohen, D. Manocha, M. Olano, "Simplifying polygonal models using successive mappings", 1997).

use glam::{DVec2, DVec3};

/// The two vertices of a [`Change`], and what they become.
const ENDS: [usize; 2] = [0, 1];
const MADE: usize = 2;

/// Triangles before and after a contraction. Point 0 and 1 become point 2, the others stay.
#[derive(Default)]
pub(super) struct Change {
    pub(super) points: Vec<DVec3>,
    pub(super) before: Vec<[usize; 3]>,
    pub(super) after: Vec<[usize; 3]>,
}

/// What a change means for the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drift {
    /// All points move along the axis, so far at most.
    Along(f64),
    /// Some triangle is upright or upside down, or the same place is covered twice.
    Folded,
    /// The border moves across the axis.
    Slid,
}

/// How far a border may move across the axis, as a share of the size of all that changes, and count as staying: what
/// rounding does to straight ones.
const STAYS: f64 = 1e-5;

impl Change {
    /// Twice the sum of the areas, as a vector.
    pub(super) fn facing(&self) -> DVec3 {
        let area = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|p| self.points[p]);
            (b - a).cross(c - a)
        };
        self.before.iter().chain(&self.after).map(area).sum()
    }

    /// No point of the surface has to move farther than that.
    pub(super) fn reach(&self) -> f64 {
        ENDS.map(|end| self.points[end].distance(self.points[MADE])).into_iter().fold(0.0, f64::max)
    }

    /// How far the surface moves along an axis of unit length.
    pub(super) fn drift(&self, axis: DVec3) -> Drift {
        let seen = Seen::new(self, axis);
        if !seen.is_simple(&self.before, &ENDS) || !seen.is_simple(&self.after, &[MADE]) {
            return Drift::Folded;
        }
        let slid = self.slid(&seen);
        if slid > STAYS * seen.size() {
            return Drift::Slid;
        }
        let slope = seen.slope(&self.before).max(seen.slope(&self.after));
        Drift::Along(self.at_vertices(&seen).max(self.at_crossings(&seen)) + slid * (1.0 + 2.0 * slope))
    }

    fn at_vertices(&self, seen: &Seen) -> f64 {
        let old = ENDS.iter().map(|&end| seen.apart(end, &self.after));
        old.chain([seen.apart(MADE, &self.before)]).fold(0.0, f64::max)
    }

    fn at_crossings(&self, seen: &Seen) -> f64 {
        let old = spokes(&self.before, &ENDS);
        let new = spokes(&self.after, &[MADE]);
        let crossings = old.iter().flat_map(|&a| new.iter().filter_map(move |&b| seen.crossing(a, b)));
        crossings.fold(0.0, f64::max)
    }

    /// How far the border moves across the axis.
    fn slid(&self, seen: &Seen) -> f64 {
        let [old, new] =
            [(&self.before, &ENDS[..]), (&self.after, &[MADE][..])].map(|(t, of)| borders(t, of));
        if old.is_empty() && new.is_empty() {
            return 0.0;
        }
        let off = |vertex: usize, border: &[[usize; 2]]| {
            let distances =
                border.iter().map(|&[a, b]| distance(seen.flat[vertex], seen.flat[a], seen.flat[b]));
            distances.fold(f64::INFINITY, f64::min)
        };
        let moved = |from: &[[usize; 2]], of: &[usize], to: &[[usize; 2]]| {
            let on_border = of.iter().filter(|&v| from.iter().any(|edge| edge.contains(v)));
            on_border.map(|&v| off(v, to)).fold(0.0, f64::max)
        };
        moved(&old, &ENDS, &new).max(moved(&new, &[MADE], &old))
    }
}

/// The edges at some vertices, each once.
fn spokes(triangles: &[[usize; 3]], of: &[usize]) -> Vec<[usize; 2]> {
    let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut spokes: Vec<[usize; 2]> =
        sides.filter(|side| side.iter().any(|v| of.contains(v))).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    spokes.sort_unstable();
    spokes.dedup();
    spokes
}

/// The edges at some vertices that have one triangle only.
fn borders(triangles: &[[usize; 3]], of: &[usize]) -> Vec<[usize; 2]> {
    let has =
        |p: usize, q: usize| triangles.iter().any(|&[a, b, c]| [[a, b], [b, c], [c, a]].contains(&[p, q]));
    spokes(triangles, of).into_iter().filter(|&[a, b]| has(a, b) != has(b, a)).collect()
}

/// The distance of a point from a segment.
fn distance(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let side = b - a;
    let share = ((p - a).dot(side) / side.length_squared()).clamp(0.0, 1.0);
    let share = if share.is_nan() { 0.0 } else { share };
    p.distance(a + side * share)
}

/// A change as it is seen along an axis.
struct Seen {
    flat: Vec<DVec2>,
    heights: Vec<f64>,
}

impl Seen {
    fn new(change: &Change, axis: DVec3) -> Self {
        let (right, up) = axis.any_orthonormal_pair();
        // From the new point, for the sake of digits.
        let seen = |p: &DVec3| *p - change.points[MADE];
        Self {
            flat: change.points.iter().map(seen).map(|p| DVec2::new(p.dot(right), p.dot(up))).collect(),
            heights: change.points.iter().map(seen).map(|p| p.dot(axis)).collect(),
        }
    }

    fn size(&self) -> f64 {
        self.flat.iter().map(|p| p.length()).fold(0.0, f64::max)
    }

    /// Twice the area of a triangle, negative where it is seen from behind.
    fn area(&self, [a, b, c]: [usize; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(|p| self.flat[p]);
        (b - a).perp_dot(c - a)
    }

    /// Whether all triangles are seen from the front and go around each of the vertices once at most.
    fn is_simple(&self, triangles: &[[usize; 3]], of: &[usize]) -> bool {
        let least = 1e-12 * self.size().powi(2);
        let faces = triangles.iter().all(|&t| self.area(t) > least);
        faces && of.iter().all(|&v| self.turns(triangles, v) <= 1)
    }

    /// How often triangles around a vertex pass a direction.
    fn turns(&self, triangles: &[[usize; 3]], vertex: usize) -> usize {
        let is_above = |p: usize| self.flat[p].y > self.flat[vertex].y;
        let passes = |t: &&[usize; 3]| match t.iter().position(|&p| p == vertex) {
            // Less than half a turn each, so that the way up passes to the right.
            Some(at) => !is_above(t[(at + 1) % 3]) && is_above(t[(at + 2) % 3]),
            None => false,
        };
        triangles.iter().filter(passes).count()
    }

    /// How steep triangles are at most.
    fn slope(&self, triangles: &[[usize; 3]]) -> f64 {
        let steep = |t: &[usize; 3]| {
            let [a, b, c] = *t;
            let [p, q] = [b, c].map(|v| (self.flat[v] - self.flat[a], self.heights[v] - self.heights[a]));
            (p.1 * q.0.perp() - q.1 * p.0.perp()).length() / self.area(*t)
        };
        triangles.iter().map(steep).fold(0.0, f64::max)
    }

    /// How far a point is from triangles, along the axis: from the one that it is deepest in.
    fn apart(&self, point: usize, triangles: &[[usize; 3]]) -> f64 {
        let at = self.flat[point];
        let weights = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|p| self.flat[p] - at);
            DVec3::new(b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)) / self.area(*t)
        };
        let depth = |t: &&[usize; 3]| weights(t).min_element();
        let deepest = triangles.iter().max_by(|s, t| depth(s).total_cmp(&depth(t)));
        let height = |t: &[usize; 3]| {
            let inside = weights(t).max(DVec3::ZERO);
            inside.dot(DVec3::from_array(t.map(|p| self.heights[p]))) / inside.element_sum()
        };
        deepest.map_or(0.0, |t| (height(t) - self.heights[point]).abs())
    }

    /// How far two edges are apart where they cross; `None` where they do not.
    fn crossing(&self, [a, b]: [usize; 2], [c, d]: [usize; 2]) -> Option<f64> {
        let [p, q] = [self.flat[b] - self.flat[a], self.flat[d] - self.flat[c]];
        let start = self.flat[c] - self.flat[a];
        let turn = p.perp_dot(q);
        let (s, t) = (start.perp_dot(q) / turn, start.perp_dot(p) / turn);
        let on_both = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
        let height = |a: usize, b: usize, s: f64| self.heights[a] + (self.heights[b] - self.heights[a]) * s;
        on_both.then(|| (height(a, b, s) - height(c, d, t)).abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A fan around points 0 and 1, which become point 2; the ring is a hexagon of these heights.
    fn hexagon(heights: [f64; 6], ends: [f64; 3], made: DVec2) -> Change {
        let ring = (0..6).map(|i| {
            let at = DVec2::from_angle(f64::from(i) * std::f64::consts::FRAC_PI_3);
            (at * 2.0).extend(heights[i as usize])
        });
        let ends = [DVec3::new(-0.5, 0.0, ends[0]), DVec3::new(0.5, 0.0, ends[1]), made.extend(ends[2])];
        let r = |i: usize| 3 + i % 6;
        let sides = |of: usize, from: usize, to: usize| (from..to).map(move |i| [of, r(i), r(i + 1)]);
        Change {
            points: ends.into_iter().chain(ring).collect(),
            before: sides(1, 0, 1)
                .chain(sides(1, 5, 6))
                .chain(sides(1, 1, 2).take(0))
                .chain(sides(0, 2, 4))
                .chain([[1, r(1), 0], [0, r(1), r(2)], [0, r(4), r(5)], [0, r(5), 1]])
                .collect(),
            after: sides(2, 0, 6).collect(),
        }
    }

    fn height_at(change: &Change, triangles: &[[usize; 3]], at: DVec2) -> Option<f64> {
        triangles.iter().find_map(|t| {
            let [a, b, c] = t.map(|p| change.points[p]);
            let flat = [a, b, c].map(|p| p.truncate() - at);
            let w =
                DVec3::new(flat[1].perp_dot(flat[2]), flat[2].perp_dot(flat[0]), flat[0].perp_dot(flat[1]));
            (w.min_element() >= 0.0).then(|| w.dot(DVec3::new(a.z, b.z, c.z)) / w.element_sum())
        })
    }

    proptest! {
        /// Points on a grid are never farther apart than the bound, and some come near it.
        #[test]
        fn the_bound_is_what_a_grid_of_points_comes_to(
            heights in prop::array::uniform6(-1.0..1.0f64),
            ends in prop::array::uniform3(-1.0..1.0f64),
            (x, y) in (-0.4..0.4f64, -0.4..0.4f64),
        ) {
            let change = hexagon(heights, ends, DVec2::new(x, y));
            let Drift::Along(bound) = change.drift(DVec3::Z) else { panic!("it is seen from above") };
            let mut most = 0.0f64;
            for i in 0..=100 {
                for j in 0..=100 {
                    let at = DVec2::new(f64::from(i), f64::from(j)) * 0.04 - 2.0;
                    if let Some((a, b)) = height_at(&change, &change.before, at).zip(height_at(&change, &change.after, at)) {
                        most = most.max((a - b).abs());
                    }
                }
            }
            prop_assert!(most <= bound + 1e-9 && most >= bound - 0.2, "{most} {bound}");
        }
    }

    #[test]
    fn a_plane_does_not_move_and_what_folds_is_told() {
        let flat = hexagon([0.0; 6], [0.0; 3], DVec2::ZERO);
        assert_eq!(flat.drift(DVec3::Z), Drift::Along(0.0));
        assert_eq!(flat.drift(DVec3::NEG_Z), Drift::Folded);
        assert_eq!(flat.drift(DVec3::X), Drift::Folded);
        let folded = hexagon([0.0; 6], [0.0; 3], DVec2::new(5.0, 0.0));
        assert_eq!(folded.drift(DVec3::Z), Drift::Folded);
        assert_eq!(folded.reach(), 5.5);
    }

    #[test]
    fn a_border_that_moves_is_told() {
        let corner = |made: DVec3| Change {
            points: vec![
                DVec3::ZERO,
                DVec3::X,
                made,
                DVec3::new(2.0, 0.0, 0.0),
                DVec3::Y,
                DVec3::new(-1.0, 0.0, 0.0),
            ],
            before: vec![[0, 1, 4], [1, 3, 4], [5, 0, 4]],
            after: vec![[2, 3, 4], [5, 2, 4]],
        };
        assert_eq!(corner(DVec3::new(0.5, 0.0, 0.0)).drift(DVec3::Z), Drift::Along(0.0));
        assert_eq!(corner(DVec3::new(0.5, 0.1, 0.0)).drift(DVec3::Z), Drift::Slid);
        let Drift::Along(up) = corner(DVec3::new(0.5, 0.0, 0.25)).drift(DVec3::Z) else { panic!("it stays") };
        assert!((up - 0.25).abs() < 1e-12);
    }
}
