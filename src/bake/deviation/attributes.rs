//! How far the attributes of two meshes differ where their surfaces correspond.
//!
//! Points are taken evenly over either surface, attributes interpolated there and at the nearest point of the other
//! surface. What comes of it is an estimate: the mean square has a standard error, and the largest difference is the
//! largest of the samples, no bound. Nearest points as correspondence are what P. Cignoni, C. Rocchini, R. Scopigno,
//! "Metro: measuring error on simplified surfaces", 1998, take for distances; the further the surfaces are apart, the
//! less is said by what differs between such points.
//!
//! At a seam a point has several triangles that are nearest to it. There every attribute is compared in the one in which
//! it agrees best, so that a mesh does not differ from itself. Where a seam has moved, points between its old and its new
//! place belong to different charts, and differ in UVs by as much as charts do: judge UVs of meshes with seams by their
//! [`rms`](Difference::rms) rather than by their [`max`](Difference::max).

use glam::{DVec3, DVec4, Vec2, Vec3, Vec4};

use super::facet::nearest_weights;
use super::sampling::{Place, Spread, Strata, Sums};
use super::shape::{self, Shape};
use super::{DeviationError, nothing_in};
use crate::bake::mesh::Mesh;

/// Triangles are equally near to a point where their distances differ by less than this share of the largest coordinate.
const SAME: f64 = 1e-12;

/// How closely to compare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Samples on each surface, at least 1; each takes some 2 µs.
    pub samples: usize,
    /// Where samples lie; equal seeds give equal results.
    pub seed: u64,
}

impl Default for Options {
    /// 65 536 samples on each surface.
    fn default() -> Self {
        Self { samples: 1 << 16, seed: 0 }
    }
}

/// How far attributes differ; `None` where one of the meshes does not have them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AttributeDeviation {
    /// Angles between normals, in degrees from 0 to 180.
    pub normals_deg: Option<Difference>,
    /// Distances between texture coordinates in UV units, for each set that both meshes have.
    pub uvs: Vec<Option<Difference>>,
    /// Distances between colours as points (R, G, B, A), linear as in the mesh.
    pub colours: Option<Difference>,
}

/// How far an attribute differs, seen from either surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// At points of the first surface.
    pub there: Spread,
    /// At points of the second surface.
    pub back: Spread,
}

impl Difference {
    /// The root mean square of the direction in which it is larger.
    pub fn rms(&self) -> f64 {
        self.there.rms.max(self.back.rms)
    }

    /// The largest difference of all samples: no bound.
    pub fn max(&self) -> f64 {
        self.there.max.max(self.back.max)
    }
}

/// How far the attributes of two meshes differ. Tangents and skins are not compared. O(n log n) to prepare, then some
/// 2 µs for a sample.
///
/// Corners without a normal (the zero vector), and values that are no numbers, are left out of the comparison.
///
/// # Errors
/// [`DeviationError`], for surfaces that are none, where one has triangles and the other none, and without samples.
///
/// # Panics
/// Where a mesh does not pass [`Mesh::check`].
pub fn deviation(
    first: &Mesh,
    second: &Mesh,
    options: &Options,
) -> Result<AttributeDeviation, DeviationError> {
    if options.samples == 0 {
        return Err(DeviationError::Options("`samples` is at least 1"));
    }
    let surfaces = [first, second].map(Mesh::surface);
    let origin = shape::origin(&surfaces[0]);
    let shapes = [Shape::new(&surfaces[0], origin)?, Shape::new(&surfaces[1], origin)?];
    if nothing_in(shapes.each_ref().map(Shape::is_empty))? {
        return Ok(AttributeDeviation::default());
    }
    let [first, second] = [Side::new(first, &shapes[0]), Side::new(second, &shapes[1])];
    let there = compare(&first, &second, options);
    let back = compare(&second, &first, options);
    let mut both =
        there.into_iter().zip(back).map(|(there, back)| Some(Difference { there: there?, back: back? }));
    let [normals_deg, colours] = [both.next().flatten(), both.next().flatten()];
    Ok(AttributeDeviation { normals_deg, colours, uvs: both.collect() })
}

/// A mesh made ready for comparison.
struct Side<'a> {
    mesh: &'a Mesh,
    shape: &'a Shape,
    columns: Vec<Column<'a>>,
}

impl<'a> Side<'a> {
    fn new(mesh: &'a Mesh, shape: &'a Shape) -> Self {
        let uvs = mesh.uvs.iter().map(|set| Column::Uvs(set));
        let columns = [Column::Normals(&mesh.normals), Column::Colours(&mesh.colours)].into_iter().chain(uvs);
        Self { mesh, shape, columns: columns.collect() }
    }

    /// A column's value at a place of the shape; `None` where it has none.
    fn value(&self, column: usize, place: &Place) -> Option<DVec4> {
        let wedges = self.mesh.triangles[self.shape.order[place.triangle] as usize];
        self.columns[column].interpolated(wedges, place.weights)
    }
}

/// An attribute of every wedge; without rows where a mesh has none.
#[derive(Clone, Copy)]
enum Column<'a> {
    Normals(&'a [Vec3]),
    Colours(&'a [Vec4]),
    Uvs(&'a [Vec2]),
}

impl Column<'_> {
    fn row(self, wedge: u32) -> Option<DVec4> {
        let wedge = wedge as usize;
        match self {
            Self::Normals(rows) => rows.get(wedge).map(|n| n.as_dvec3().normalize_or_zero().extend(0.0)),
            Self::Colours(rows) => rows.get(wedge).map(|colour| colour.as_dvec4()),
            Self::Uvs(rows) => rows.get(wedge).map(|uv| uv.as_dvec2().extend(0.0).extend(0.0)),
        }
    }

    fn interpolated(self, wedges: [u32; 3], weights: [f64; 3]) -> Option<DVec4> {
        let mut sum = DVec4::ZERO;
        for (wedge, weight) in wedges.into_iter().zip(weights) {
            sum += self.row(wedge)? * weight;
        }
        let is_lost = matches!(self, Self::Normals(_)) && sum.length_squared() < 1e-12;
        (sum.is_finite() && !is_lost).then_some(sum)
    }

    /// How far two values of this kind of column differ: degrees of normals, else the distance.
    fn difference(self, a: DVec4, b: DVec4) -> f64 {
        match self {
            Self::Normals(_) => angle_rad(a.truncate(), b.truncate()).to_degrees(),
            Self::Colours(_) | Self::Uvs(_) => a.distance(b),
        }
    }
}

/// The angle between two directions of any length, as precise near 0 and π as elsewhere.
fn angle_rad(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// How far columns that both have differ at samples of `from`, in the order of columns; `None` where there was nothing
/// to compare.
fn compare(from: &Side, to: &Side, options: &Options) -> Vec<Option<Spread>> {
    let mut sums = vec![Sums::default(); from.columns.len().min(to.columns.len())];
    let (mut near, mut nearest) = (0, Vec::new());
    let strata = Strata::new(from.shape);
    strata.visit(options.samples, options.seed, 0, |place| {
        let point = from.shape.point(&place);
        near = places_nearest_to(point, to.shape, near, &mut nearest);
        for (column, sums) in sums.iter_mut().enumerate() {
            if let Some(difference) = least_difference(column, from, &place, to, &nearest) {
                sums.add(difference * difference);
            }
        }
    });
    sums.iter().map(|sums| Some(sums.spread()).filter(|spread| spread.samples > 0)).collect()
}

/// The places of `to` that are nearest to `point`, in every triangle that has one; returns one of those triangles.
fn places_nearest_to(point: DVec3, to: &Shape, hint: u32, places: &mut Vec<Place>) -> u32 {
    let nearest = to.bvh.nearest(point, hint);
    let most = nearest.distance2.sqrt() + SAME * to.reach.max(point.abs().max_element());
    places.clear();
    to.bvh.each_within(point, most * most, |triangle| {
        let weights = nearest_weights(&to.corners[triangle as usize], point);
        places.push(Place { triangle: triangle as usize, weights });
    });
    nearest.triangle
}

/// How far a column's value at a place differs from that at the place of `there` where it agrees best.
fn least_difference(column: usize, from: &Side, place: &Place, to: &Side, there: &[Place]) -> Option<f64> {
    let value = from.value(column, place)?;
    let values = there.iter().filter_map(|place| to.value(column, place));
    values.map(|other| from.columns[column].difference(value, other)).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A square of `n` by `n` cells over [0, 1]², its attributes given by a position.
    fn plate(n: u32, height: f32, attributes: impl Fn(Vec3) -> (Vec3, Vec2, Vec4)) -> Mesh {
        let at = |i: u32| i as f32 / n as f32;
        let places = (0..=n).flat_map(|y| (0..=n).map(move |x| Vec3::new(at(x), at(y), height)));
        let mut mesh = Mesh { positions: places.collect(), uvs: vec![Vec::new()], ..Mesh::default() };
        for (normal, uv, colour) in mesh.positions.iter().map(|&place| attributes(place)) {
            mesh.normals.push(normal);
            mesh.uvs[0].push(uv);
            mesh.colours.push(colour);
        }
        mesh.wedges = (0..mesh.positions.len() as u32).collect();
        let cells = (0..n).flat_map(|y| (0..n).map(move |x| y * (n + 1) + x));
        mesh.triangles = cells.flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]).collect();
        mesh
    }

    /// A cube whose faces are charts of their own: every edge is a seam in UVs, and a crease in normals.
    fn cube() -> Mesh {
        let mut mesh = Mesh { uvs: vec![Vec::new()], ..Mesh::default() };
        for (face, normal) in (0..).zip([Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z]) {
            let right = Vec3::new(normal.y, normal.z, normal.x).abs();
            for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                mesh.positions.push(normal + x * right + y * normal.cross(right));
                mesh.normals.push(normal);
                mesh.uvs[0].push(Vec2::new(x + 3.0 * face as f32, y));
            }
            mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|corner: u32| corner + 4 * face)));
        }
        mesh.wedges = (0..24).collect();
        crate::bake::weld::weld(&mut mesh);
        mesh
    }

    fn compared(first: &Mesh, second: &Mesh) -> AttributeDeviation {
        deviation(first, second, &Options { samples: 1 << 12, seed: 1 }).expect("two meshes")
    }

    fn is_near(found: f64, expected: f64, share: f64) -> bool {
        (found - expected).abs() <= share * expected
    }

    #[test]
    fn what_is_known_of_a_plate_is_found() {
        let tilt = 10_f32.to_radians();
        let first = plate(3, 0.0, |p| (Vec3::Z, p.truncate(), Vec4::ONE));
        let second = plate(7, 0.1, |p| {
            (Vec3::new(0.0, tilt.sin(), tilt.cos()) * 3.0, 1.5 * p.truncate(), Vec4::new(0.0, 1.0, 1.0, p.x))
        });
        let found = compared(&first, &second);
        let normals = found.normals_deg.expect("both have normals");
        assert!(is_near(normals.rms(), 10.0, 1e-6) && is_near(normals.max(), 10.0, 1e-6), "{normals:?}");
        // Half the distance from the corner at the origin: ∫ (x² + y²) / 4 = 1/6, and at most √2 / 2.
        let uvs = found.uvs[0].expect("both have texture coordinates");
        assert!(is_near(uvs.rms(), (1.0_f64 / 6.0).sqrt(), 0.01), "{uvs:?}");
        assert!(is_near(uvs.max(), 0.5_f64.sqrt(), 0.05) && uvs.max() < 0.5_f64.sqrt() + 1e-6, "{uvs:?}");
        // 1 + (1 - x)²: 4/3 on average.
        let colours = found.colours.expect("both have colours");
        assert!(is_near(colours.there.rms, (4.0_f64 / 3.0).sqrt(), 0.01), "{colours:?}");
        assert!(is_near(colours.back.rms, (4.0_f64 / 3.0).sqrt(), 0.01), "{colours:?}");
    }

    #[test]
    fn a_cube_does_not_differ_from_itself_whatever_the_order_of_triangles() {
        let cube = cube();
        let mut other = cube.clone();
        other.triangles.reverse();
        other.triangles.iter_mut().for_each(|corners| corners.rotate_left(1));
        let found = compared(&cube, &other);
        let all = [found.normals_deg, found.uvs[0]].map(|difference| difference.expect("both have it"));
        assert!(all.iter().all(|d| d.max() < 1e-9 && d.there.samples == 1 << 12), "{found:?}");
    }

    /// Every point of a larger cube outside of the smaller one's slabs is nearest to a seam of that.
    #[test]
    fn beyond_a_seam_the_chart_that_agrees_best_counts() {
        let small = cube();
        let mut large = small.clone();
        large.positions.iter_mut().for_each(|p| *p *= 1.5);
        let found = compared(&small, &large);
        let (normals, uvs) = (found.normals_deg.expect("normals"), found.uvs[0].expect("uvs"));
        assert!(normals.max() < 1e-9, "{normals:?}");
        // A chart of 2 by 2 on faces of 2 and 3: at most half a unit at each of two borders apart, and never a chart.
        assert!(uvs.max() <= 0.5_f64.sqrt(), "{uvs:?}");
    }

    #[test]
    fn what_one_mesh_lacks_is_not_compared() {
        let whole = plate(2, 0.0, |p| (Vec3::Z, p.truncate(), Vec4::ONE));
        let bare = Mesh { normals: Vec::new(), colours: Vec::new(), uvs: Vec::new(), ..whole.clone() };
        for found in [compared(&whole, &bare), compared(&bare, &whole)] {
            assert_eq!(found, AttributeDeviation::default());
        }
        let more = Mesh { uvs: vec![whole.uvs[0].clone(), whole.uvs[0].clone()], ..whole.clone() };
        assert_eq!(compared(&whole, &more).uvs.len(), 1);
        assert_eq!(compared(&more, &more).uvs.len(), 2);
    }

    #[test]
    fn corners_without_a_normal_and_numbers_that_are_none_are_left_out() {
        let whole = plate(4, 0.0, |p| (Vec3::Z, p.truncate(), Vec4::ONE));
        let mut holed = whole.clone();
        holed.normals[0] = Vec3::ZERO;
        holed.colours[7].x = f32::NAN;
        holed.uvs[0].fill(Vec2::splat(f32::INFINITY));
        let found = compared(&whole, &holed);
        assert!(found.normals_deg.is_some_and(|normals| normals.max() < 1e-9));
        assert!(found.colours.is_some_and(|colours| colours.max() < 1e-9 && colours.there.samples < 4000));
        assert_eq!(found.uvs, [None]);
    }

    #[test]
    fn what_cannot_be_compared_is_refused() {
        let whole = plate(1, 0.0, |p| (Vec3::Z, p.truncate(), Vec4::ONE));
        let none = Mesh::default();
        let options = Options::default();
        assert_eq!(deviation(&whole, &none, &options), Err(DeviationError::OneIsEmpty));
        assert_eq!(deviation(&none, &none, &options), Ok(AttributeDeviation::default()));
        let refused = deviation(&whole, &whole, &Options { samples: 0, seed: 0 });
        assert_eq!(refused, Err(DeviationError::Options("`samples` is at least 1")));
        // All corners in one place, and a segment: surfaces all the same.
        let mut needle = whole.clone();
        needle.positions.iter_mut().for_each(|p| *p = Vec3::X * p.x);
        let mut point = whole.clone();
        point.positions.fill(Vec3::ONE);
        for flat in [needle, point] {
            let found = compared(&flat, &flat).normals_deg;
            assert!(found.is_some_and(|normals| normals.max() < 1e-9));
        }
    }

    proptest! {
        /// Attributes that follow the position in both meshes, over the same plane in other triangles: the difference
        /// is linear, so it is largest in a corner, and its mean square is that of its values at nine points.
        #[test]
        fn linear_attributes_differ_by_what_they_differ(
            n in 1_u32..6, m in 1_u32..6, steps in prop::array::uniform4(-1.0_f32..1.0)
        ) {
            let [a, b, c, d] = steps;
            let first = plate(n, 0.0, |p| (Vec3::Z, Vec2::new(a * p.x + b * p.y, c), Vec4::splat(p.x)));
            let second = plate(m, 0.25, |p| (Vec3::Z, Vec2::new(c * p.x, d * p.y), Vec4::splat(p.x)));
            let uvs = compared(&first, &second).uvs[0].expect("both have texture coordinates");
            let difference2 = |x: f32, y: f32| {
                Vec2::new(a * x + b * y - c * x, c - d * y).as_dvec2().length_squared()
            };
            let thirds = [(0.0, 1.0), (0.5, 4.0), (1.0, 1.0)];
            let at = |(x, p): (f32, f64)| thirds.map(|(y, q)| p * q * difference2(x, y)).iter().sum::<f64>();
            let mean2 = thirds.map(at).iter().sum::<f64>() / 36.0;
            let corners = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)];
            let most2 = corners.map(|(x, y)| difference2(x, y)).into_iter().fold(0.0, f64::max);
            prop_assert!(uvs.max() <= most2.sqrt() + 1e-6, "{uvs:?} {most2}");
            for spread in [uvs.there, uvs.back] {
                prop_assert!((spread.rms - mean2.sqrt()).abs() <= 0.02 * most2.sqrt() + 1e-6, "{spread:?} {mean2}");
            }
        }
    }
}
