//! How far the heights of a field are off, exactly.
//!
//! The difference between two surfaces over the same ground is linear wherever both are. So the largest one is at a
//! vertex of either or where two edges cross: at the vertices of the mesh that are below the new triangles, which are
//! carried along (M. Garland, P. Heckbert, "Fast polygonal approximation of terrains and height fields", 1995), and on the
//! way of the new edges across the mesh.

use glam::{DVec2, DVec3, Vec3};

use super::overlay::Change;
use super::stars::Stars;

/// No triangle, no point.
const NONE: u32 = u32::MAX;

/// A height field as it was, and which of its vertices are below which triangle by now.
pub(super) struct Ground {
    axis: DVec3,
    /// Per vertex, as it was.
    places: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// Per triangle and side, the triangle across.
    across: Vec<[u32; 3]>,
    /// Per triangle as it is by now, the first vertex below it; per vertex, the next one.
    firsts: Vec<u32>,
    next: Vec<u32>,
    /// Per vertex by now, the old triangle that it is above, and whether it is where it was.
    homes: Vec<u32>,
    is_moved: Vec<bool>,
    pool: Vec<u32>,
}

impl Ground {
    pub(super) fn new(axis: DVec3, positions: &[Vec3], stars: &Stars, triangles: &[[u32; 3]]) -> Self {
        let count = positions.len();
        let mut ground = Self {
            axis,
            places: Vec::new(),
            triangles: triangles.to_vec(),
            across: (0..triangles.len() as u32).map(|t| neighbours(stars, t)).collect(),
            firsts: vec![NONE; triangles.len()],
            next: vec![NONE; count],
            homes: (0..count as u32).map(|v| stars.of(v).next().unwrap_or(NONE)).collect(),
            is_moved: vec![false; count],
            pool: Vec::new(),
        };
        ground.places = positions.iter().map(|p| ground.seen(p.as_dvec3())).collect();
        ground
    }

    /// Carries the vertices below a star over to the triangles that stay, and returns how far these are off at most;
    /// `None` where the way across the mesh is lost. `ends` are the two vertices that become the first.
    pub(super) fn contract(
        &mut self,
        ends: [u32; 2],
        change: &Change,
        star: &[u32],
        staying: &[u32],
    ) -> Option<f64> {
        let points: Vec<DVec3> = change.points.iter().map(|&p| self.seen(p)).collect();
        self.collect(ends, star);
        let below = self.hand_over(&points, &change.after, staying);
        let (home, _) = self.walk(self.homes[ends[0] as usize], points[0], points[2])?;
        self.homes[ends[0] as usize] = home;
        let mut most = below.max(self.off_at(home, points[2]));
        let mut ring: Vec<usize> = change.after.iter().flatten().copied().filter(|&p| p != 2).collect();
        ring.sort_unstable();
        ring.dedup();
        for end in ring {
            most = most.max(self.walk(home, points[2], points[end])?.1);
        }
        Some(most)
    }

    /// A place as it is seen from above, and its height.
    fn seen(&self, p: DVec3) -> DVec3 {
        let (right, up) = self.axis.any_orthonormal_pair();
        DVec3::new(p.dot(right), p.dot(up), p.dot(self.axis))
    }

    /// Takes the vertices below a star, and the ends themselves where they have not moved before.
    fn collect(&mut self, ends: [u32; 2], star: &[u32]) {
        self.pool.clear();
        for end in ends {
            if !std::mem::replace(&mut self.is_moved[end as usize], true) {
                self.pool.push(end);
            }
        }
        for &triangle in star {
            let mut point = std::mem::replace(&mut self.firsts[triangle as usize], NONE);
            while point != NONE {
                self.pool.push(point);
                point = self.next[point as usize];
            }
        }
    }

    /// Gives each vertex to the triangle that it is deepest in; returns how far one is off at most.
    fn hand_over(&mut self, points: &[DVec3], triangles: &[[usize; 3]], names: &[u32]) -> f64 {
        let mut most = 0.0f64;
        for point in std::mem::take(&mut self.pool) {
            let at = self.places[point as usize];
            let inside =
                triangles.iter().zip(names).map(|(t, &name)| (weights(t.map(|p| points[p]), at), t, name));
            let deepest = inside.max_by(|a, b| a.0.min_element().total_cmp(&b.0.min_element()));
            let Some((weights, t, name)) = deepest else { continue };
            most = most.max((height(t.map(|p| points[p]), weights) - at.z).abs());
            self.next[point as usize] = std::mem::replace(&mut self.firsts[name as usize], point);
        }
        most
    }

    fn off_at(&self, triangle: u32, at: DVec3) -> f64 {
        let corners = self.corners(triangle);
        (height(corners, weights(corners, at)) - at.z).abs()
    }

    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.places[v as usize])
    }

    /// Walks across the mesh from one place to another: the triangle where it ends, and how far the straight way is off at
    /// the sides that it crosses.
    fn walk(&self, start: u32, from: DVec3, to: DVec3) -> Option<(u32, f64)> {
        let (mut triangle, mut came, mut most) = (start, NONE, 0.0f64);
        let most_steps = 64 + 8 * self.triangles.len().isqrt();
        for _ in 0..most_steps {
            let corners = self.corners(triangle);
            let Some(side) = self.way_out(triangle, came, from, to) else {
                return Some((triangle, most));
            };
            let (p, q) = (corners[side], corners[(side + 1) % 3]);
            most = most.max(off_where_crossed([from, to], [p, q]));
            (came, triangle) = (triangle, self.across[triangle as usize][side]);
        }
        None
    }

    /// The side by which a straight way leaves a triangle; `None` where it ends there, or at the border.
    fn way_out(&self, triangle: u32, came: u32, from: DVec3, to: DVec3) -> Option<usize> {
        let corners = self.corners(triangle);
        let across = self.across[triangle as usize];
        let leads_out = |&side: &usize| {
            let (p, q) = (corners[side], corners[(side + 1) % 3]);
            let is_beyond = turn(q - p, to - p) < 0.0;
            is_beyond && across[side] != came && across[side] != NONE
        };
        let is_crossed = |&side: &usize| {
            let (p, q) = (corners[side] - from, corners[(side + 1) % 3] - from);
            turn(to - from, p) <= 0.0 && turn(to - from, q) >= 0.0
        };
        (0..3).filter(leads_out).find(is_crossed).or_else(|| (0..3).find(leads_out))
    }
}

/// The triangles across the sides of one, from each corner to the next.
fn neighbours(stars: &Stars, triangle: u32) -> [u32; 3] {
    let corners = stars.corners(triangle);
    std::array::from_fn(|i| {
        let other = corners[(i + 1) % 3];
        let mut beside = stars.of(corners[i]).filter(|&t| t != triangle && stars.corners(t).contains(&other));
        beside.next().unwrap_or(NONE)
    })
}

fn turn(a: DVec3, b: DVec3) -> f64 {
    a.truncate().perp_dot(b.truncate())
}

/// How far two edges are apart where they cross.
fn off_where_crossed([a, b]: [DVec3; 2], [p, q]: [DVec3; 2]) -> f64 {
    let (before, after) = (turn(b - a, p - a), turn(b - a, q - a));
    let share = (before / (before - after)).clamp(0.0, 1.0);
    let at = p.lerp(q, if share.is_nan() { 0.0 } else { share });
    let way: DVec2 = (b - a).truncate();
    let along = ((at - a).truncate().dot(way) / way.length_squared()).clamp(0.0, 1.0);
    (a.z + (b.z - a.z) * if along.is_nan() { 0.0 } else { along } - at.z).abs()
}

/// How much of each corner there is at a place.
fn weights(corners: [DVec3; 3], at: DVec3) -> DVec3 {
    let [a, b, c] = corners.map(|p| p - at);
    let weights = DVec3::new(turn(b, c), turn(c, a), turn(a, b));
    weights / weights.element_sum()
}

/// The height of a triangle at a place, or the nearest that it has.
fn height(corners: [DVec3; 3], weights: DVec3) -> f64 {
    let inside = weights.max(DVec3::ZERO);
    inside.dot(DVec3::from_array(corners.map(|p| p.z))) / inside.element_sum()
}
