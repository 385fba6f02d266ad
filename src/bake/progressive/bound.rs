//! How far a contraction takes the surface: a bound on the distance between the triangles around an edge before and
//! after, in both directions.
//!
//! The old triangles are mapped onto the new ones where a corner goes. As linear maps take no point farther than a
//! corner, that distance is at most that of the vertex that moves most. It is a bound whatever the triangles are, but in
//! the plane it is half an edge where the surfaces are the same.
//!
//! So the triangles are looked at from above, too (J. Cohen, D. Manocha, M. Olano, "Simplifying polygonal models using
//! successive mappings", 1997). Where all face the viewer and both sets have the same outline, each point of the outline's
//! inside is covered once by either: the winding number of the outline counts both. Then straight up and down is a
//! map, the difference of heights is linear between where edges cross, and is largest at a vertex or a crossing. Where
//! an edge of the border is contracted, the outline changes. There the old triangles' border is first moved onto
//! the new one, by what it takes, and then they have one.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

/// What rounding can add, as a share.
const SLACK: f64 = 1e-6;

/// Ends of a border edge that are closer than this to where both go, as a share of its length, go there, too.
const CLOSE: f64 = 1e-4;

/// A corner of a triangle: which vertex, and where.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) vertex: u32,
    pub(super) at: DVec3,
}

/// The point within the border edge that goes where both ends do.
const MIDDLE: u32 = u32::MAX;

/// The triangles around two vertices before and after they become one.
#[derive(Clone, Debug, Default)]
pub(super) struct Star {
    pub(super) kept: u32,
    pub(super) gone: u32,
    /// Where both go.
    pub(super) to: DVec3,
    pub(super) old: Vec<[Corner; 3]>,
    pub(super) new: Vec<[Corner; 3]>,
    /// Somewhere on a triangle that is left; needed where no new one is.
    pub(super) elsewhere: Option<DVec3>,
}

impl Star {
    /// No point of the old triangles is farther than this from the new ones or, where there are none, from what is
    /// elsewhere; nor one of the new from the old.
    pub(super) fn bound(&self) -> f64 {
        let corners = self.old.as_flattened();
        if self.new.is_empty() {
            let from = self.elsewhere;
            let far = |corner: &Corner| from.map_or(f64::INFINITY, |at| at.distance(corner.at));
            return corners.iter().map(far).fold(0.0, f64::max) * (1.0 + SLACK);
        }
        let is_own = |corner: &&Corner| self.is_own(corner.vertex);
        let moved =
            corners.iter().filter(is_own).map(|corner| corner.at.distance(self.to)).fold(0.0, f64::max);
        let lost = self.lost();
        let bound =
            if lost > 0.0 { moved.max(lost) } else { self.seen_from_above().map_or(moved, |b| b.min(moved)) };
        bound * (1.0 + SLACK)
    }

    fn is_own(&self, vertex: u32) -> bool {
        vertex == self.kept || vertex == self.gone || vertex == MIDDLE
    }

    /// A triangle that goes becomes an edge. How far its third corner is where no new triangle has that edge.
    fn lost(&self) -> f64 {
        let has = |vertex: u32| self.new.as_flattened().iter().any(|corner| corner.vertex == vertex);
        let goes = |t: &&[Corner; 3]| t.iter().filter(|corner| self.is_own(corner.vertex)).count() > 1;
        let thirds = self.old.iter().filter(goes).flatten().filter(|corner| !self.is_own(corner.vertex));
        let lost = thirds.filter(|corner| !has(corner.vertex));
        lost.map(|corner| corner.at.distance(self.to)).fold(0.0, f64::max)
    }

    /// The bound by heights, where there is one.
    fn seen_from_above(&self) -> Option<f64> {
        let (old, moved) = self.on_new_border()?;
        let up = self.old.iter().chain(&self.new).map(across).sum::<DVec3>().try_normalize()?;
        let view = View { up, x: up.any_orthonormal_vector(), origin: self.to };
        let [old, new] = [old.as_slice(), &self.new].map(|triangles| view.all(triangles));
        let [old, new] = [old?, new?];
        if !self.is_one_fan(&new) {
            return None;
        }
        Some(moved + self.largest_difference(&old, &new))
    }

    /// The old triangles with their border, if the vertices are at one, on that of the new; and how far they had to
    /// be moved. `None` where borders are not that simple.
    fn on_new_border(&self) -> Option<(Vec<[Corner; 3]>, f64)> {
        let of = |triangles, vertex| Loose::of(triangles, vertex);
        let [kept, gone] = [of(&self.old, self.kept)?, of(&self.old, self.gone)?];
        let new = of(&self.new, self.kept)?;
        match (kept, gone) {
            (Loose(None), Loose(None)) => new.0.is_none().then(|| (self.old.clone(), 0.0)),
            (Loose(Some(ends)), Loose(None)) => self.at_border(self.kept, ends, new),
            (Loose(None), Loose(Some(ends))) => self.at_border(self.gone, ends, new),
            (Loose(Some(a)), Loose(Some(b))) => {
                if a.to.vertex == self.gone && b.from.vertex == self.kept {
                    self.along_border([self.kept, self.gone], a.from, b.to, new)
                } else if b.to.vertex == self.kept && a.from.vertex == self.gone {
                    self.along_border([self.gone, self.kept], b.from, a.to, new)
                } else {
                    None
                }
            }
        }
    }

    /// One of the vertices is at the border, which runs over it from one end to the other, and then over where both go:
    /// that is a point of the edge before it or of the one after it.
    fn at_border(&self, vertex: u32, Ends { from, to }: Ends, new: Loose) -> Option<(Vec<[Corner; 3]>, f64)> {
        if !new.is_between(from.vertex, to.vertex) {
            return None;
        }
        let own = Corner { vertex, at: self.old_place(vertex)? };
        let after = self.bordered([own, to], [nearest([from.at, self.to], own.at), to.at]);
        let before = self.bordered([from, own], [from.at, nearest([self.to, to.at], own.at)]);
        Some(if after.1 <= before.1 { after } else { before })
    }

    /// The border runs from `from` over the two vertices, `first` and `second`, to `to`. Both are taken to the nearest
    /// place of the new border.
    fn along_border(
        &self,
        [first, second]: [u32; 2],
        from: Corner,
        to: Corner,
        new: Loose,
    ) -> Option<(Vec<[Corner; 3]>, f64)> {
        if !new.is_between(from.vertex, to.vertex) {
            return None;
        }
        let corner = |vertex: u32| self.old_place(vertex).map(|at| Corner { vertex, at });
        let (first, second) = (corner(first)?, corner(second)?);
        let places = [nearest([from.at, self.to], first.at), nearest([self.to, to.at], second.at)];
        Some(self.bordered([first, second], places))
    }

    fn old_place(&self, vertex: u32) -> Option<DVec3> {
        self.old.as_flattened().iter().find(|corner| corner.vertex == vertex).map(|corner| corner.at)
    }

    /// The old triangles with the ends of a border edge taken to some places, and the point of it that is nearest to
    /// where both vertices go taken there; and how far they had to go.
    fn bordered(&self, edge: [Corner; 2], places: [DVec3; 2]) -> (Vec<[Corner; 3]>, f64) {
        // What is as good as there is there, so that no triangle is as good as flat.
        let close = CLOSE * edge[0].at.distance(edge[1].at);
        let places = places.map(|place| if place.distance(self.to) < close { self.to } else { place });
        let middle = nearest(edge.map(|corner| corner.at), self.to);
        let ends = edge.iter().zip(places).map(|(corner, place)| corner.at.distance(place));
        let moved = ends.fold(middle.distance(self.to), f64::max);
        let middle = Corner { vertex: MIDDLE, at: self.to };
        let place = |corner: Corner| {
            let end = edge.iter().zip(places).find(|(end, _)| end.vertex == corner.vertex);
            end.map_or(corner, |(_, at)| Corner { at, ..corner })
        };
        let mut old = Vec::with_capacity(self.old.len() + 1);
        for triangle in self.old.iter().map(|t| t.map(place)) {
            let next = |i: usize| triangle[(i + 1) % 3];
            let is_edge =
                |&i: &usize| triangle[i].vertex == edge[0].vertex && next(i).vertex == edge[1].vertex;
            match (0..3).find(is_edge) {
                Some(i) => {
                    let (a, b, c) = (triangle[i], next(i), next(i + 1));
                    old.extend([[a, middle, c], [middle, b, c]]);
                }
                None => old.push(triangle),
            }
        }
        old.retain(|[a, b, c]| a.at != b.at && b.at != c.at && c.at != a.at);
        (old, moved)
    }

    /// Whether new triangles go around their vertex once at most, so that none covers another.
    fn is_one_fan(&self, new: &[[Seen; 3]]) -> bool {
        let angle = |triangle: &[Seen; 3]| {
            let sides = triangle.iter().filter(|c| c.vertex != self.kept);
            let [a, b] = [0, 1].map(|i| sides.clone().nth(i).map_or(DVec2::ZERO, |c| c.at));
            a.angle_to(b).abs()
        };
        new.iter().map(angle).sum::<f64>() < TAU + 1e-6
    }

    /// How far the heights of old and new triangles are apart at most.
    fn largest_difference(&self, old: &[[Seen; 3]], new: &[[Seen; 3]]) -> f64 {
        let own = |triangle: &[Seen; 3], i: usize| {
            let [corner, next] = [triangle[i], triangle[(i + 1) % 3]];
            self.is_own(corner.vertex).then_some([corner, next])
        };
        let spokes = |triangles: &[[Seen; 3]]| -> Vec<[Seen; 2]> {
            triangles.iter().flat_map(|t| [0, 1, 2].map(|i| own(t, i))).flatten().collect()
        };
        let (old_spokes, new_spokes) = (spokes(old), spokes(new));
        let heights = |corners: &[[Seen; 2]], over: &[[Seen; 3]]| {
            let apart = corners.iter().map(|[c, _]| (c.height - height_at(over, c.at)).abs());
            apart.fold(0.0, f64::max)
        };
        let at_vertices = heights(&old_spokes, new).max(heights(&new_spokes[..1], old));
        let pairs = new_spokes.iter().flat_map(|a| old_spokes.iter().map(move |b| (a, b)));
        pairs.filter_map(|(a, b)| apart_at_crossing(a, b)).fold(at_vertices, f64::max)
    }
}

/// The border at a vertex: from where it comes and where it goes on.
#[derive(Clone, Copy)]
struct Ends {
    from: Corner,
    to: Corner,
}

/// The edges of a vertex that one triangle has to itself, if there are any.
#[derive(Clone, Copy)]
struct Loose(Option<Ends>);

impl Loose {
    /// `None` where there are more than a border has.
    fn of(triangles: &[[Corner; 3]], vertex: u32) -> Option<Self> {
        let mut ways: Vec<[Option<Corner>; 2]> = Vec::with_capacity(8);
        for triangle in triangles {
            let Some(i) = triangle.iter().position(|corner| corner.vertex == vertex) else { continue };
            for (way, corner) in [(0, triangle[(i + 1) % 3]), (1, triangle[(i + 2) % 3])] {
                let same = |pair: &&mut [Option<Corner>; 2]| {
                    pair[way].is_none() && pair[1 - way].is_some_and(|other| other.vertex == corner.vertex)
                };
                match ways.iter_mut().find(same) {
                    Some(pair) => pair[way] = Some(corner),
                    None => {
                        let mut pair = [None; 2];
                        pair[way] = Some(corner);
                        ways.push(pair);
                    }
                }
            }
        }
        // What leads out alone is where the border goes on: a triangle is to the left of its edges.
        let [mut out, mut back] =
            [0, 1].map(|way| ways.iter().filter(move |p| p[1 - way].is_none()).filter_map(move |p| p[way]));
        match (out.next(), back.next(), out.next().is_none() && back.next().is_none()) {
            (None, None, true) => Some(Self(None)),
            (Some(to), Some(from), true) => Some(Self(Some(Ends { from, to }))),
            _ => None,
        }
    }

    fn is_between(self, from: u32, to: u32) -> bool {
        self.0.is_some_and(|ends| ends.from.vertex == from && ends.to.vertex == to)
    }
}

/// A corner from above.
#[derive(Clone, Copy)]
struct Seen {
    vertex: u32,
    at: DVec2,
    height: f64,
}

/// A view from above; `x` is to its right.
struct View {
    up: DVec3,
    x: DVec3,
    origin: DVec3,
}

impl View {
    /// Triangles as they are seen; `None` where one does not face the viewer.
    fn all(&self, triangles: &[[Corner; 3]]) -> Option<Vec<[Seen; 3]>> {
        let y = self.up.cross(self.x);
        let seen = |Corner { vertex, at }: Corner| {
            let at = at - self.origin;
            Seen { vertex, at: DVec2::new(at.dot(self.x), at.dot(y)), height: at.dot(self.up) }
        };
        let faces = |triangle: [Seen; 3]| is_seen(&triangle).then_some(triangle);
        triangles.iter().map(|t| faces(t.map(seen))).collect()
    }
}

/// Whether a triangle is counter-clockwise by more than rounding.
fn is_seen([a, b, c]: &[Seen; 3]) -> bool {
    let (p, q) = (b.at - a.at, c.at - a.at);
    p.perp_dot(q) > 1e-9 * (p.length_squared() + q.length_squared())
}

fn across([a, b, c]: &[Corner; 3]) -> DVec3 {
    (b.at - a.at).cross(c.at - a.at)
}

/// The point of a segment that is nearest to a place.
fn nearest([a, b]: [DVec3; 2], place: DVec3) -> DVec3 {
    let along = b - a;
    let t = (place - a).dot(along) / along.length_squared();
    if t.is_finite() { a + along * t.clamp(0.0, 1.0) } else { a }
}

/// The height of the triangle that has a place, or that lacks least.
fn height_at(triangles: &[[Seen; 3]], at: DVec2) -> f64 {
    let mut best = (f64::NEG_INFINITY, 0.0);
    for [a, b, c] in triangles {
        let whole = (b.at - a.at).perp_dot(c.at - a.at);
        let of = |p: &Seen, q: &Seen| (p.at - at).perp_dot(q.at - at) / whole;
        let weights = [of(b, c), of(c, a), of(a, b)];
        let least = weights[0].min(weights[1]).min(weights[2]);
        if least > best.0 {
            best = (least, weights[0] * a.height + weights[1] * b.height + weights[2] * c.height);
        }
    }
    best.1
}

/// How far two segments are apart where they cross, if they do so within both.
fn apart_at_crossing([a, b]: &[Seen; 2], [c, d]: &[Seen; 2]) -> Option<f64> {
    if b.vertex == d.vertex {
        return None;
    }
    let (p, q, between) = (b.at - a.at, d.at - c.at, c.at - a.at);
    let turn = p.perp_dot(q);
    if turn == 0.0 {
        return None;
    }
    let (s, t) = (between.perp_dot(q) / turn, between.perp_dot(p) / turn);
    let is_within = |x: f64| (-1e-9..=1.0 + 1e-9).contains(&x);
    let height = |from: &Seen, to: &Seen, x: f64| from.height + x.clamp(0.0, 1.0) * (to.height - from.height);
    (is_within(s) && is_within(t)).then(|| (height(a, b, s) - height(c, d, t)).abs())
}
