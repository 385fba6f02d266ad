//! Tangents of the limit surface: left eigenvectors of what a subdivision does to the faces around a vertex.
//!
//! Of a smooth vertex they are known (C. Loop, 1987; M. Halstead, M. Kass, T. DeRose, "Efficient, fair interpolation using
//! Catmull-Clark surfaces", 1993). For one side of a crease, k faces wide, let dᵢ be from the vertex to its neighbours, 0
//! and k on the crease, and gᵢ to the corners across the quads. d₀ − dₖ is halved by a subdivision, s = d₀ + dₖ becomes a
//! quarter, and the vertex moves by s / 8. Across goes, with θ = π / k, Σ sin(iθ) dᵢ + Σ zᵢ gᵢ + α s, of eigenvalue
//!
//! - μ = 3/8 + cos(θ) / 4 for triangles, where α = (sin θ − Σ sin iθ) / (8μ − 2) and there is no g;
//! - 16 μ² − (10 + 2 cos θ) μ + 1 = 0, the larger, for quads, where zᵢ = (sin iθ + sin (i + 1)θ) / (16μ − 4) and
//!   α = (sin(θ) / 16 + z₀ / 4 − (Σ sin iθ + Σ zᵢ) / 8) / (μ − 1/4).
//!
//! One face alone lies in the plane in which the crease bends: across it goes s.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::Scheme;

/// What lies around a vertex on one of its sides, counter-clockwise, as seen from it.
pub(super) struct Spread {
    /// To the neighbours: one more than there are faces where the side is open.
    pub neighbours: Vec<DVec3>,
    /// Per quad, to the corner across; empty for triangles.
    pub across: Vec<DVec3>,
    /// How many faces there are.
    pub faces: usize,
}

/// Less than this share of the square of the largest distance is no area.
const FLAT: f64 = 1e-12;

impl Spread {
    /// Of a smooth vertex, all around it.
    pub fn smooth(&self, scheme: Scheme) -> DVec3 {
        let turn = TAU / self.faces as f64;
        let tangent = |wave: fn(f64) -> f64| {
            let wave = |i: usize| wave(turn * i as f64);
            let own = match scheme {
                Scheme::Loop => 1.0,
                Scheme::CatmullClark => {
                    1.0 + turn.cos() + (turn / 2.0).cos() * (18.0 + 2.0 * turn.cos()).sqrt()
                }
            };
            weighted(&self.neighbours, |i| own * wave(i)) + weighted(&self.across, |i| wave(i) + wave(i + 1))
        };
        self.or_area(tangent(f64::cos).cross(tangent(f64::sin)))
    }

    /// Of a side of a crease.
    pub fn beside_crease(&self, scheme: Scheme) -> DVec3 {
        let [first, last] = self.ends();
        let (bend, along) = (first + last, first - last);
        if self.faces == 1 {
            return self.or_area(along.cross(bend));
        }
        let turn = PI / self.faces as f64;
        let wave = |i: usize| if i < self.faces { (turn * i as f64).sin() } else { 0.0 };
        let inner: f64 = (1..self.faces).map(wave).sum();
        let (far, share) = match scheme {
            Scheme::Loop => (0.0, (wave(1) - inner) / (1.0 + 2.0 * turn.cos())),
            Scheme::CatmullClark => {
                let trace = 5.0 + turn.cos();
                let shrink = (trace + (trace * trace - 16.0).sqrt()) / 16.0;
                let far = 1.0 / (16.0 * shrink - 4.0);
                let gain = wave(1) / 16.0 + far * wave(1) / 4.0 - inner * (1.0 + 2.0 * far) / 8.0;
                (far, gain / (shrink - 0.25))
            }
        };
        let across = weighted(&self.neighbours, wave)
            + weighted(&self.across, |i| far * (wave(i) + wave(i + 1)))
            + bend * share;
        self.or_area(along.cross(across))
    }

    /// Of a side of a corner: the plane of its two creases while faces are few enough to end there. Wider ones and tips
    /// have no plane, for which the mean of the faces stands.
    pub fn at_corner(&self, scheme: Scheme) -> DVec3 {
        let most = match scheme {
            Scheme::Loop => 3,
            Scheme::CatmullClark => 2,
        };
        let area = self.area();
        if self.neighbours.len() == self.faces || self.faces > most {
            return area;
        }
        let [first, last] = self.ends();
        let plane = first.cross(last);
        self.or_area(if plane.dot(area) < 0.0 { -plane } else { plane })
    }

    /// The sum of the faces' areas.
    pub fn area(&self) -> DVec3 {
        let next = |i: usize| self.neighbours[(i + 1) % self.neighbours.len()];
        let face = |i: usize| match self.across.get(i) {
            Some(&across) => (next(i) - self.neighbours[i]).cross(-across),
            None => self.neighbours[i].cross(next(i)),
        };
        (0..self.faces).map(face).sum()
    }

    fn ends(&self) -> [DVec3; 2] {
        [self.neighbours[0], self.neighbours[self.neighbours.len() - 1]]
    }

    /// The normal, unless tangents are parallel but for rounding.
    fn or_area(&self, normal: DVec3) -> DVec3 {
        let size = self.neighbours.iter().map(|d| d.length_squared()).fold(0.0, f64::max);
        if normal.length() > FLAT * size { normal } else { self.area() }
    }
}

fn weighted(values: &[DVec3], weight: impl Fn(usize) -> f64) -> DVec3 {
    values.iter().enumerate().map(|(i, &value)| value * weight(i)).sum()
}
