//! A piece of a triangle, how far it can be from a surface, and where to cut it.

use glam::DVec3;

use super::bvh::Bvh;

/// Every so many cuts a piece is halved across its longest side, so that pieces become small wherever the other cuts
/// fall.
const HALVE_EVERY: u16 = 4;

/// Cuts keep this share of an edge's length from its ends.
const MARGIN: f64 = 1.0 / 64.0;

/// Steps of the search for a place to cut.
const SEARCH: usize = 6;

/// A piece of a triangle of one surface, and triangles of the other one that may be near to all of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub corners: [DVec3; 3],
    /// For each corner the triangle nearest to it.
    pub near: [u32; 3],
    /// One more that is worth trying.
    pub also: u32,
    /// How many cuts lie behind it.
    pub depth: u16,
}

/// The triangle of the other surface by which a piece is bounded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cover {
    pub triangle: u32,
    /// The squared distance of each corner to it.
    pub distances2: [f64; 3],
}

impl Cover {
    /// No point of the piece is farther from the other surface than the root of this.
    ///
    /// Distance to a convex set is a convex function: over a piece it is largest in a corner.
    pub(super) fn most2(&self) -> f64 {
        let [a, b, c] = self.distances2;
        a.max(b).max(c)
    }
}

/// A place on an edge of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    /// The edge, as two corners.
    pub ends: [usize; 2],
    pub point: DVec3,
    /// The triangle that covers the part at each end, as far as one does.
    pub covers: [u32; 2],
}

impl Piece {
    pub(super) fn center(&self) -> DVec3 {
        (self.corners[0] + self.corners[1] + self.corners[2]) / 3.0
    }

    /// The best cover among the triangles that are near to a corner and the one more.
    pub(super) fn cover(&self, to: &Bvh) -> Cover {
        let [a, b, c] = self.near;
        let mut best = self.covered_by(a, to);
        for (k, other) in [b, c, self.also].into_iter().enumerate() {
            let seen = other == a || (k > 0 && other == b) || (k > 1 && other == c);
            if !seen {
                let cover = self.covered_by(other, to);
                best = if cover.most2() < best.most2() { cover } else { best };
            }
        }
        best
    }

    fn covered_by(&self, triangle: u32, to: &Bvh) -> Cover {
        Cover { triangle, distances2: self.corners.map(|corner| to.distance2(triangle, corner)) }
    }

    /// Where to cut a piece that its best cover leaves farther than the root of `close2`: where the cover and the
    /// triangle that is nearest to the worst corner are equally far.
    ///
    /// That is where the surface bends between them, so that two cuts part a piece that lies across an edge of the
    /// other surface, where halving would need as many as the edge has room for.
    pub(super) fn cut(&self, cover: &Cover, to: &Bvh, close2: f64) -> Cut {
        if self.depth % HALVE_EVERY == HALVE_EVERY - 1 {
            return self.halved(cover);
        }
        let worst = largest(cover.distances2);
        let rival = self.covered_by(self.near[worst], to);
        let mut others = rival.distances2;
        others[worst] = f64::NEG_INFINITY;
        let start = largest(others);
        let gain = |distances2: [f64; 2]| distances2[0].sqrt() - distances2[1].sqrt();
        let gains = [start, worst].map(|k| gain([cover.distances2[k], rival.distances2[k]]));
        if !(gains[0] <= 0.0 && gains[1] > 0.0) {
            return self.halved(cover);
        }
        let [a, b] = [self.corners[start], self.corners[worst]];
        let at = crossing(gains, |t| {
            let point = a + (b - a) * t;
            let distances2 = [cover.triangle, rival.triangle].map(|triangle| to.distance2(triangle, point));
            if distances2[0].max(distances2[1]) <= close2 { 0.0 } else { gain(distances2) }
        });
        let point = a + (b - a) * at.clamp(MARGIN, 1.0 - MARGIN);
        Cut { ends: [start, worst], point, covers: [cover.triangle, rival.triangle] }
    }

    fn halved(&self, cover: &Cover) -> Cut {
        let side = |k: usize| self.corners[k].distance_squared(self.corners[(k + 1) % 3]);
        let start = largest([side(0), side(1), side(2)]);
        let ends = [start, (start + 1) % 3];
        let point = (self.corners[ends[0]] + self.corners[ends[1]]) * 0.5;
        Cut { ends, point, covers: [cover.triangle; 2] }
    }

    /// The two parts, `near` being the triangle nearest to the place of the cut.
    pub(super) fn parts(&self, cut: &Cut, near: u32) -> [Self; 2] {
        [0, 1].map(|side| {
            let mut part = Self { also: cut.covers[side], depth: self.depth + 1, ..*self };
            part.corners[cut.ends[1 - side]] = cut.point;
            part.near[cut.ends[1 - side]] = near;
            part
        })
    }
}

fn largest(values: [f64; 3]) -> usize {
    (1..3).fold(0, |best, k| if values[k] > values[best] { k } else { best })
}

/// A place in [0, 1] where `f` is about zero, `ends` being its values at 0 (not above zero) and 1 (above).
///
/// False position with the Illinois rule (M. Dowell, P. Jarratt, "A modified regula falsi method", 1971).
fn crossing(ends: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    let ([mut low, mut high], [mut at_low, mut at_high]) = ([0.0, 1.0], ends);
    let (mut place, mut side) = (0.5, 0);
    for _ in 0..SEARCH {
        place = (low * at_high - high * at_low) / (at_high - at_low);
        let value = f(place);
        if value == 0.0 {
            break;
        }
        if value > 0.0 {
            (high, at_high) = (place, value);
            at_low *= if side == 1 { 0.5 } else { 1.0 };
            side = 1;
        } else {
            (low, at_low) = (place, value);
            at_high *= if side == -1 { 0.5 } else { 1.0 };
            side = -1;
        }
    }
    if place.is_finite() { place } else { 0.5 }
}
