//! Where the pieces of a kind stand, and the patterns in which many of them do.

use glam::{DMat3, DVec3};

use super::angle::sin_cos_deg;
use super::solid::direction;

/// A position, and how what is put there is turned and stretched.
///
/// Read it as a walk: `at(x, y, z).yaw(a).pitch(b)` goes somewhere, turns, and then tilts what has turned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    axes: DMat3,
    origin: DVec3,
}

/// Upright at a point.
pub(super) fn at(x: f64, y: f64, z: f64) -> Place {
    Place { axes: DMat3::IDENTITY, origin: DVec3::new(x, y, z) }
}

impl Place {
    /// Turns about y: +z towards +x.
    pub fn yaw(self, degrees: f64) -> Self {
        let (sin, cos) = sin_cos_deg(degrees);
        self.turned([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])
    }

    /// Turns about x: +y towards +z.
    pub fn pitch(self, degrees: f64) -> Self {
        let (sin, cos) = sin_cos_deg(degrees);
        self.turned([[1.0, 0.0, 0.0], [0.0, cos, sin], [0.0, -sin, cos]])
    }

    /// Turns about z: +x towards +y.
    pub fn roll(self, degrees: f64) -> Self {
        let (sin, cos) = sin_cos_deg(degrees);
        self.turned([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    }

    fn turned(self, columns: [[f64; 3]; 3]) -> Self {
        Self { axes: self.axes * DMat3::from_cols_array_2d(&columns), ..self }
    }

    /// Stretches along its own axes; all factors must be positive.
    pub fn stretched(self, [x, y, z]: [f64; 3]) -> Self {
        Self { axes: self.axes * DMat3::from_diagonal(DVec3::new(x, y, z)), ..self }
    }

    /// As large in all directions.
    pub fn scaled(self, factor: f64) -> Self {
        self.stretched([factor; 3])
    }

    /// Goes on from here, along its own axes.
    pub fn by(self, x: f64, y: f64, z: f64) -> Self {
        self.to(at(x, y, z))
    }

    /// A place that is told as seen from this one.
    pub fn to(self, inner: Self) -> Self {
        Self { axes: self.axes * inner.axes, origin: self.apply(inner.origin) }
    }

    /// Where a point of what is put here comes to lie.
    pub fn apply(&self, point: DVec3) -> DVec3 {
        self.origin + self.axes * point
    }
}

/// From one point to another: what is one metre high reaches from the first to the second.
pub(super) fn between(from: [f64; 3], to: [f64; 3]) -> Place {
    let (from, to) = (DVec3::from(from), DVec3::from(to));
    let up = to - from;
    let height = up.length();
    // Any axis across will do, as long as it is not along.
    let side = if up.x.abs() < 0.5 * height { DVec3::X } else { DVec3::Z };
    let front = side.cross(up) / side.cross(up).length();
    Place { axes: DMat3::from_cols(up.cross(front) / height, up, front), origin: from }
}

/// So many from one point to another, both included; one stands in the middle.
pub(super) fn row(count: u32, from: [f64; 3], to: [f64; 3]) -> Vec<Place> {
    let (from, to) = (DVec3::from(from), DVec3::from(to));
    let step = |i: u32| if count == 1 { 0.5 } else { f64::from(i) / f64::from(count - 1) };
    (0..count).map(|i| Place { origin: from + (to - from) * step(i), ..at(0.0, 0.0, 0.0) }).collect()
}

/// Rows of so many in x, y and z that fill a box from its low corner to its high one.
pub(super) fn lattice([nx, ny, nz]: [u32; 3], low: [f64; 3], high: [f64; 3]) -> Vec<Place> {
    let origins = row(nx, [low[0], 0.0, 0.0], [high[0], 0.0, 0.0]);
    let up = row(ny, [0.0, low[1], 0.0], [0.0, high[1], 0.0]);
    let south = row(nz, [0.0, 0.0, low[2]], [0.0, 0.0, high[2]]);
    let layers = up.iter().flat_map(|y| south.iter().map(move |z| y.to(*z)));
    layers.flat_map(|yz| origins.iter().map(move |x| yz.to(*x))).collect()
}

/// So many around the y axis, each with its +z outwards; the first is at +z.
pub(super) fn ring(count: u32, radius: f64, height: f64) -> Vec<Place> {
    let turn = |i: u32| 360.0 * f64::from(i) / f64::from(count);
    (0..count).map(|i| at(0.0, height, 0.0).yaw(turn(i)).by(0.0, 0.0, radius)).collect()
}

/// Left and right of the plane x = 0.
pub(super) fn pair(x: f64, y: f64, z: f64) -> [Place; 2] {
    [at(-x, y, z), at(x, y, z)]
}

/// The four corners of a rectangle around the y axis.
pub(super) fn corners(x: f64, y: f64, z: f64) -> [Place; 4] {
    [at(-x, y, -z), at(x, y, -z), at(x, y, z), at(-x, y, z)]
}

/// So many strewn evenly over a sphere, each with its +z outwards, stretched to an ellipsoid around a point.
///
/// The spiral of golden angles (Swinbank and Purser, "Fibonacci grids: A novel approach to global modelling", 2006).
pub(super) fn strewn(count: u32, [x, y, z]: [f64; 3], radii: [f64; 3]) -> Vec<Place> {
    let on_sphere = |i: u32| {
        let height = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let around = (1.0 - height * height).sqrt();
        let turn = (f64::from(i) * GOLDEN_DEG) % 360.0;
        let out = direction(turn, 0.0) * around + DVec3::Y * height;
        let origin = out * DVec3::from(radii) + DVec3::new(x, y, z);
        Place { axes: facing(out), origin }
    };
    (0..count).map(on_sphere).collect()
}

/// So many evenly over a cone that stands at a height, each with its +z outwards and its +y up the slope.
pub(super) fn on_cone(count: u32, radius: f64, height: f64, y: f64) -> Vec<Place> {
    let slope_deg = 90.0 * radius / (radius + height);
    let on_slope = |i: u32| {
        let up = 1.0 - (1.0 - (f64::from(i) + 0.5) / f64::from(count)).sqrt();
        let turned = at(0.0, y, 0.0).yaw((f64::from(i) * GOLDEN_DEG) % 360.0);
        turned.by(0.0, up * height, radius * (1.0 - up)).pitch(-slope_deg)
    };
    (0..count).map(on_slope).collect()
}

/// 360° · (1 − 1/φ).
const GOLDEN_DEG: f64 = 137.507_764_050_037_85;

/// Axes whose +z is a unit vector, and whose +y is as high as that allows.
fn facing(z: DVec3) -> DMat3 {
    let aside = DVec3::Y.cross(z);
    let x = if aside.length() < 1e-9 { DVec3::X } else { aside / aside.length() };
    DMat3::from_cols(x, z.cross(x), z)
}

/// The i-th of a sequence of numbers from 0 to 1 that leaves no gaps: multiples of the plastic ratio without their whole
/// part. The golden ratio would go in step with the spirals above.
pub(super) fn even_unit(i: usize) -> f64 {
    (i as f64 * 0.754_877_666_246_692_7) % 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_near(a: DVec3, b: [f64; 3]) -> bool {
        a.abs_diff_eq(DVec3::from(b), 1e-9)
    }

    #[test]
    fn a_walk_goes_turns_and_tilts() {
        let there = at(1.0, 2.0, 3.0).yaw(90.0);
        assert!(is_near(there.apply(DVec3::Z), [2.0, 2.0, 3.0]));
        assert!(is_near(there.by(0.0, 0.0, 5.0).apply(DVec3::ZERO), [6.0, 2.0, 3.0]));
        assert!(is_near(there.pitch(90.0).apply(DVec3::Y), [2.0, 2.0, 3.0]));
        assert!(is_near(at(0.0, 0.0, 0.0).roll(90.0).apply(DVec3::X), [0.0, 1.0, 0.0]));
        assert!(is_near(there.scaled(2.0).apply(DVec3::Z), [3.0, 2.0, 3.0]));
    }

    #[test]
    fn a_beam_reaches_from_end_to_end() {
        let ends = [[1.0, 2.0, 3.0], [1.0, 5.0, 3.0], [-4.0, 2.0, 3.0], [1.0, 2.0, 9.5], [7.0, -2.0, 1.0]];
        for (a, b) in ends.into_iter().flat_map(|a| ends.map(|b| (a, b))).filter(|(a, b)| a != b) {
            let beam = between(a, b);
            assert!(is_near(beam.apply(DVec3::ZERO), a) && is_near(beam.apply(DVec3::Y), b));
            let axes = beam.axes;
            assert!((axes.determinant() - axes.y_axis.length()).abs() < 1e-9, "not turned inside out");
        }
    }

    #[test]
    fn patterns_fill_what_they_are_given() {
        assert!(is_near(row(1, [0.0; 3], [2.0, 4.0, 6.0])[0].apply(DVec3::ZERO), [1.0, 2.0, 3.0]));
        let filled = lattice([2, 3, 4], [0.0; 3], [1.0, 2.0, 3.0]);
        let mut points: Vec<_> =
            filled.iter().map(|p| p.apply(DVec3::ZERO).to_array().map(|x| x as i32)).collect();
        points.sort_unstable();
        points.dedup();
        assert_eq!((points.len(), points[0], points[23]), (24, [0, 0, 0], [1, 2, 3]));
        let around = ring(4, 2.0, 1.0);
        assert!(is_near(around[1].apply(DVec3::Z), [3.0, 1.0, 0.0]));
    }

    /// Every point of the sphere has one within reach, and all of them look outwards.
    #[test]
    fn what_is_strewn_leaves_no_gaps() {
        let places = strewn(500, [1.0, 2.0, 3.0], [2.0, 2.0, 2.0]);
        let points: Vec<DVec3> =
            places.iter().map(|p| p.apply(DVec3::ZERO) - DVec3::new(1.0, 2.0, 3.0)).collect();
        for (turn, tilt) in (0..36)
            .flat_map(|turn| (-9..10).map(move |tilt| (10.0 * f64::from(turn), 10.0 * f64::from(tilt))))
        {
            let out = 2.0 * direction(turn, tilt);
            let nearest = points.iter().map(|p| p.distance(out)).fold(f64::MAX, f64::min);
            assert!(nearest < 0.25, "{turn} {tilt}: {nearest}");
        }
        let outwards = |(place, out): (&Place, &DVec3)| place.axes.z_axis.dot(*out) > 1.999;
        assert!(places.iter().zip(&points).all(outwards));
    }
}
