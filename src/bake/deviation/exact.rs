//! Distances in twice the precision, slowly: what rounding is held against.

use std::ops::{Add, Div, Mul, Sub};

use glam::{DVec3, Vec3};
use proptest::prelude::*;

use super::facet::Facet;
use super::{Deviation, Options, deviation};
use crate::bake::surface::Surface;

/// A sum of two `f64`, the second half a unit of the first at most: some 106 bits
/// (T. J. Dekker, "A floating-point technique for extending the available precision", 1971).
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct Double(f64, f64);

const ZERO: Double = Double(0.0, 0.0);

fn exact_sum(a: f64, b: f64) -> Double {
    let sum = a + b;
    let other = sum - a;
    Double(sum, (a - (sum - other)) + (b - other))
}

impl From<f64> for Double {
    fn from(x: f64) -> Self {
        Self(x, 0.0)
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (exact_sum(self.0, other.0), exact_sum(self.1, other.1));
        let sum = exact_sum(high.0, high.1 + low.0);
        exact_sum(sum.0, sum.1 + low.1)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + Self(-other.0, -other.1)
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = self.0 * other.0;
        let rest = self.0.mul_add(other.0, -product);
        exact_sum(product, rest + (self.0 * other.1 + self.1 * other.0))
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.0 / other.0;
        let rest = self - other * first.into();
        let second = rest.0 / other.0;
        let rest = rest - other * second.into();
        exact_sum(first, second) + (rest.0 / other.0).into()
    }
}

type Point = [Double; 3];

fn point(p: DVec3) -> Point {
    p.to_array().map(Double::from)
}

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] - b[k])
}

fn along(a: Point, direction: Point, t: Double) -> Point {
    std::array::from_fn(|k| a[k] + direction[k] * t)
}

fn dot(a: Point, b: Point) -> Double {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [[1, 2], [2, 0], [0, 1]].map(|[i, j]| a[i] * b[j] - a[j] * b[i])
}

fn to_segment2(p: Point, a: Point, b: Point) -> Double {
    let (side, offset) = (minus(b, a), minus(p, a));
    let (place, length2) = (dot(offset, side), dot(side, side));
    let t = if place <= ZERO {
        ZERO
    } else if place >= length2 {
        1.0.into()
    } else {
        place / length2
    };
    let away = minus(p, along(a, side, t));
    dot(away, away)
}

/// The squared distance from a point to a triangle.
fn to_triangle2(p: Point, [a, b, c]: [Point; 3]) -> Double {
    let sides = [(a, b), (b, c), (c, a)];
    let normal = cross(minus(b, a), minus(c, a));
    let is_inside = |(from, to): (Point, Point)| dot(cross(minus(to, from), minus(p, from)), normal) >= ZERO;
    if dot(normal, normal) > ZERO && sides.into_iter().all(is_inside) {
        let height = dot(minus(p, a), normal);
        return height * height / dot(normal, normal);
    }
    let distances2 = sides.map(|(from, to)| to_segment2(p, from, to));
    distances2.into_iter().fold(distances2[0], |least, other| if other < least { other } else { least })
}

fn triangles(surface: &Surface) -> Vec<[Point; 3]> {
    let place = |&i: &u32| point(surface.positions[i as usize].as_dvec3());
    surface.triangles.iter().map(|corners| corners.each_ref().map(place)).collect()
}

/// The largest squared distance of a lattice of points of `from`, `STEPS` to a side, which is a power of two, so that
/// they are exact.
fn farthest2(from: &Surface, to: &Surface) -> Double {
    const STEPS: u32 = 8;
    let to = triangles(to);
    let mut farthest2 = ZERO;
    for [a, b, c] in triangles(from) {
        for (i, j) in (0..=STEPS).flat_map(|i| (0..=STEPS - i).map(move |j| (i, j))) {
            let [u, v] = [i, j].map(|step| Double::from(f64::from(step) / f64::from(STEPS)));
            let p = along(along(a, minus(b, a), u), minus(c, a), v);
            let distances2 = to.iter().map(|&corners| to_triangle2(p, corners));
            let nearest2 = distances2.reduce(|least, other| if other < least { other } else { least });
            farthest2 = nearest2.filter(|&nearest2| nearest2 > farthest2).unwrap_or(farthest2);
        }
    }
    farthest2
}

fn square(x: f64) -> Double {
    Double::from(x) * x.into()
}

/// As closely as can be asked for.
fn measured(a: &Surface, b: &Surface) -> Deviation {
    let options = Options { relative: 0.001, of_diagonal: 1e-9, max_samples: 500, ..Options::default() };
    deviation(a, b, &options).expect("two surfaces")
}

/// Where whole numbers are put: scales and offsets at which single precision holds all of them.
#[derive(Clone, Copy, Debug)]
struct Placing {
    scale: f32,
    offset: Vec3,
}

fn placing() -> impl Strategy<Value = Placing> {
    let scale = prop_oneof![Just(-70), Just(-20), Just(0), Just(67)].prop_map(|k: i32| 2.0_f32.powi(k));
    let offset =
        prop_oneof![Just(Vec3::ZERO), Just(Vec3::new(1e6, -1e6, 5e5)), Just(Vec3::new(0.0, 16e6, 0.0))];
    (scale, offset).prop_map(|(scale, offset)| Placing { scale, offset })
}

impl Placing {
    fn place(self, p: [i32; 3]) -> Vec3 {
        (Vec3::from(p.map(|x| x as f32)) + self.offset) * self.scale
    }
}

fn whole(most: i32) -> impl Strategy<Value = [i32; 3]> {
    prop::array::uniform3(-most..=most)
}

fn soup() -> impl Strategy<Value = (Vec<[i32; 3]>, Vec<[u32; 3]>)> {
    prop::collection::vec(whole(1000), 3..9).prop_flat_map(|positions| {
        let corner = 0..positions.len() as u32;
        let triangle = prop::array::uniform3(corner);
        prop::collection::vec(triangle, 1..6).prop_map(move |triangles| (positions.clone(), triangles))
    })
}

proptest! {
    /// What the slack of the Hausdorff bound counts with.
    #[test]
    fn a_distance_is_off_by_less_than_fifty_units_in_the_last_place(
        corners in prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64)),
        p in prop::array::uniform3(-1.0..1.0_f64), foot in 0.0..1.0_f64, thin in 0.0..11.0_f64
    ) {
        let ([a, b, c], p) = (corners.map(DVec3::from), DVec3::from(p));
        let apex = a.lerp(b, foot).lerp(c, 10.0_f64.powf(-thin));
        for corners in [[a, b, c], [a, b, apex], [apex, a, b], [a, b, b]] {
            let weights = [0.25, 0.5, 0.25];
            let within = corners.iter().zip(weights).map(|(&corner, weight)| corner * weight).sum::<DVec3>();
            for p in [p, within, within.lerp(p, 1e-9)] {
                let found = Facet::new(corners).distance2(p).sqrt();
                let exact = to_triangle2(point(p), corners.map(point)).0.sqrt();
                prop_assert!((found - exact).abs() < 50.0 * 2.0_f64.powi(-53), "{found} {exact}");
            }
        }
    }

    /// A triangle cut in sixteen and moved along its normal: every point is as far as it was moved, to the last bit.
    #[test]
    fn parallel_triangles_are_as_far_apart_as_they_are(
        corners in prop::array::uniform3(whole(15)), steps in 1..9_i32, placing in placing()
    ) {
        let [a, b, c] = corners.map(|p| p.map(|x| 4 * x));
        let side = |to: [i32; 3]| [0, 1, 2].map(|k| f64::from((to[k] - a[k]) / 4));
        let normal = DVec3::from(side(b)).cross(side(c).into()) * f64::from(steps);
        let normal = normal.to_array().map(|x| x as i32);
        let lattice = |i: i32, j: i32| [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) / 4 * i + (c[k] - a[k]) / 4 * j);
        let first = Surface { positions: [a, b, c].map(|p| placing.place(p)).to_vec(), triangles: vec![[0, 1, 2]] };
        let mut second = Surface::default();
        let moved = |(i, j)| placing.place([0, 1, 2].map(|k| lattice(i, j)[k] + normal[k]));
        for (i, j) in (0..4).flat_map(|j| (0..4 - j).map(move |i| (i, j))) {
            let start = second.positions.len() as u32;
            second.positions.extend([(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(moved));
            second.triangles.push([start, start + 1, start + 2]);
            if i + j < 3 {
                second.triangles.push([start + 1, start + 3, start + 2]);
            }
        }
        let found = measured(&first, &second);
        let moved = point(DVec3::from(normal.map(f64::from)) * f64::from(placing.scale));
        let exact2 = dot(moved, moved);
        prop_assert!(square(found.hausdorff) >= exact2 && square(found.attained) <= exact2, "{found:?} {exact2:?}");
        prop_assert!(found.hausdorff <= exact2.0.sqrt() * 1.001 + 1e-6 * f64::from(placing.scale), "{found:?} {exact2:?}");
    }

    #[test]
    fn no_point_is_farther_than_the_bound_at_any_scale_and_place(a in soup(), b in soup(), placing in placing()) {
        let [a, b] = [a, b].map(|(positions, triangles)| Surface {
            positions: positions.into_iter().map(|p| placing.place(p)).collect(),
            triangles,
        });
        let found = measured(&a, &b);
        for farthest2 in [farthest2(&a, &b), farthest2(&b, &a)] {
            prop_assert!(square(found.hausdorff) >= farthest2, "{found:?} {farthest2:?}");
        }
    }
}
