//! Parametric shapes and their tessellations: exact counts, and a proved bound on how far a tessellation is from the
//! smooth shape.
//!
//! Everything round rests on one bound, the *sagitta*: a regular n-gon inscribed in a circle of radius r stays within
//! r·(1 − cos(π/n)) ≤ r·π²/(2n²) of it, both ways. A surface of revolution with an inscribed profile and n segments
//! around the axis stays within the sum of the profile's deviation and the sagitta of its widest circle, because
//! turning the profile into an n-gon scales its distance from the axis by a factor between cos(π/n) and 1. That
//! covers cylinders, cones, spheres (a profile of n/2 chords over half a circle: the sagitta of n segments again)
//! and tori.

use std::f64::consts::PI;

/// A shape in metres. Its *detail* is how finely it is tessellated: segments around for what is round, cells along a
/// side for a field; 0 leaves it out.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    /// A box with sharp edges. Any detail draws all of it.
    Block([f64; 3]),
    /// A box whose edges are rounded to a radius; detail n takes n − 1 segments for a quarter of a circle, so that
    /// detail 1 is the sharp box.
    RoundedBlock([f64; 3], f64),
    /// An extruded outline of so many corners, capped. Any detail draws all of it.
    Profile { corners: u32, size: [f64; 3] },
    /// A pocket in a wall, such as a window's reveal: four sides and a back, open in front. Any detail draws it.
    Recess { depth: f64 },
    /// A capped cylinder, or the frustum of a cone whose wider radius is this.
    Cylinder { radius: f64, height: f64 },
    /// An open tube such as a branch; radius at its wider end.
    Tube { radius: f64, length: f64 },
    /// A cone with its base.
    Cone { radius: f64, height: f64 },
    /// A sphere by longitude (detail) and latitude (half of it).
    Sphere { radius: f64 },
    /// A ring of radius `ring` around the axis, `tube` thick; detail segments around, half of it across.
    Torus { ring: f64, tube: f64 },
    /// A square height field, `relief` from its lowest to its highest point; `bend` bounds its second derivative in
    /// every direction (1/m).
    Field { side: f64, relief: f64, bend: f64 },
    /// A crown of leaf cards, one in each cell of detail × detail/2 on a sphere, lying flat in its cell.
    Crown { radius: f64 },
    /// What stands in for the parts that a level leaves out. No point of it is farther than `reach` from the finest
    /// level, and none of theirs is farther from it.
    StandIn { triangles: u32, vertices: u32, reach: f64 },
}

impl Shape {
    /// Triangles at a detail.
    pub fn triangles(self, detail: u32) -> u32 {
        let n = detail;
        match self {
            _ if n == 0 => 0,
            Self::Block(_) => 12,
            Self::RoundedBlock(..) => 12 + 16 * (n - 1) * n,
            Self::Profile { corners, .. } => 4 * corners - 4,
            Self::Recess { .. } => 10,
            Self::Cylinder { .. } => 4 * n - 4,
            Self::Tube { .. } => 2 * n,
            Self::Cone { .. } => 2 * n - 2,
            Self::Sphere { .. } => 2 * n * (n / 2 - 1),
            Self::Torus { .. } => 2 * n * (n / 2),
            Self::Field { .. } => 2 * n * n,
            Self::Crown { .. } => 2 * n * (n / 2),
            Self::StandIn { triangles, .. } => triangles,
        }
    }

    /// Vertices at a detail: split where the normal breaks, shared where the surface is smooth; seams of textures are
    /// not counted.
    pub fn vertices(self, detail: u32) -> u32 {
        let n = detail;
        match self {
            _ if n == 0 => 0,
            Self::Block(_) => 24,
            Self::RoundedBlock(..) if n == 1 => 24,
            Self::RoundedBlock(..) => 8 + 8 * (n - 1) * n,
            Self::Profile { corners, .. } => 6 * corners,
            Self::Recess { .. } => 20,
            Self::Cylinder { .. } => 4 * n,
            Self::Tube { .. } => 2 * n,
            Self::Cone { .. } => 2 * n + 1,
            Self::Sphere { .. } => n * (n / 2 - 1) + 2,
            Self::Torus { .. } => n * (n / 2),
            Self::Field { .. } => (n + 1) * (n + 1),
            Self::Crown { .. } => 4 * n * (n / 2),
            Self::StandIn { vertices, .. } => vertices,
        }
    }

    /// How far, at most, the tessellation and the smooth shape are apart, both ways, in metres. Of a shape that is
    /// left out, see [`Shape::extent`].
    pub fn deviation(self, detail: u32) -> f64 {
        let n = f64::from(detail);
        match self {
            Self::Block(_) | Self::Profile { .. } | Self::Recess { .. } | Self::StandIn { .. } => 0.0,
            // The sharp corner is √3 times the rounding from the rounding's centre; rounded corners are octants of a
            // sphere of 4(n − 1) segments.
            Self::RoundedBlock(_, edge) if detail == 1 => 0.7321 * edge,
            Self::RoundedBlock(_, edge) => 2.0 * sagitta(edge, 4.0 * (n - 1.0)),
            Self::Cylinder { radius, .. } | Self::Tube { radius, .. } | Self::Cone { radius, .. } => {
                sagitta(radius, n)
            }
            Self::Sphere { radius } => 2.0 * sagitta(radius, even(n)),
            Self::Torus { ring, tube } => sagitta(ring + tube, n) + sagitta(tube, even(n) / 2.0),
            // Linear interpolation over a right triangle of legs h: bend · (h/√2)² / 2 (Waldron, "The error in linear
            // interpolation at the vertices of a simplex", 1998).
            Self::Field { side, relief, bend } => (bend * side * side / (4.0 * n * n)).min(relief),
            // Half of the way across a cell by longitude and by latitude.
            Self::Crown { radius } => PI * radius / n + PI * radius / even(n),
        }
    }

    /// What leaving the shape out costs: no point of it is farther than this from the part that it touches. Its
    /// diameter, but for a pocket, which leaves a flat wall.
    pub fn extent(self) -> f64 {
        match self {
            Self::Block(size) | Self::RoundedBlock(size, _) | Self::Profile { size, .. } => length(&size),
            Self::Recess { depth } => depth,
            Self::Cylinder { radius, height } | Self::Cone { radius, height } => {
                length(&[2.0 * radius, height])
            }
            Self::Tube { radius, length: along } => length(&[2.0 * radius, along]),
            Self::Sphere { radius } | Self::Crown { radius } => 2.0 * radius,
            Self::Torus { ring, tube } => 2.0 * (ring + tube),
            Self::Field { side, relief, .. } => length(&[side, side, relief]),
            Self::StandIn { reach, .. } => reach,
        }
    }
}

/// An upper bound on r·(1 − cos(π/n)), by 1 − cos x ≤ x²/2.
fn sagitta(radius: f64, segments: f64) -> f64 {
    radius * PI * PI / (2.0 * segments * segments)
}

/// The even number not above `n`: twice the segments by latitude.
fn even(n: f64) -> f64 {
    2.0 * (n / 2.0).floor()
}

fn length(sides: &[f64]) -> f64 {
    sides.iter().map(|s| s * s).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::angle::sin_cos_deg;
    use super::*;

    type Point = [f64; 3];

    /// The obvious tessellation of a surface of revolution: a profile of (distance from the axis, height), turned;
    /// triangles without an area are left out.
    fn turned(profile: &[[f64; 2]], segments: u32) -> Vec<[Point; 3]> {
        let at = |[rho, y]: [f64; 2], i: u32| {
            let (sin, cos) = sin_cos_deg(360.0 * f64::from(i % segments) / f64::from(segments));
            [rho * cos, y, rho * sin]
        };
        let mut triangles = Vec::new();
        for (pair, i) in profile.windows(2).flat_map(|pair| (0..segments).map(move |i| (pair, i))) {
            let [a, b, c, d] = [at(pair[0], i), at(pair[0], i + 1), at(pair[1], i), at(pair[1], i + 1)];
            let has_area = |t: &[Point; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
            triangles.extend([[a, b, c], [c, b, d]].into_iter().filter(has_area));
        }
        triangles
    }

    /// Part of a circle in the plane of a profile: centre on the ground, angles in degrees, both ends included.
    fn arc(center: f64, radius: f64, [from, to]: [f64; 2], chords: u32) -> Vec<[f64; 2]> {
        let at = |i| {
            let (sin, cos) = sin_cos_deg(from + (to - from) * f64::from(i) / f64::from(chords));
            // The axis is the axis: a radius of −1e-17 would be a hole.
            [(center + radius * cos * f64::from(u8::from(cos.abs() > 1e-9))), radius * sin]
        };
        (0..=chords).map(at).collect()
    }

    fn vertices(mesh: &[[Point; 3]]) -> usize {
        let mut keys: Vec<_> = mesh.iter().flatten().map(|p| p.map(|c| (c * 1e9).round() as i64)).collect();
        keys.sort_unstable();
        keys.dedup();
        keys.len()
    }

    /// Points all over a mesh.
    fn samples(mesh: &[[Point; 3]]) -> impl Iterator<Item = Point> + use<'_> {
        const STEPS: u32 = 12;
        let weights = (0..=STEPS).flat_map(|i| (0..=STEPS - i).map(move |j| [i, j].map(f64::from)));
        weights.flat_map(move |[i, j]| {
            let (u, v) = (i / f64::from(STEPS), j / f64::from(STEPS));
            mesh.iter()
                .map(move |[a, b, c]| std::array::from_fn(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k])))
        })
    }

    fn rho([x, _, z]: Point) -> f64 {
        (x * x + z * z).sqrt()
    }

    /// Checks counts and bound of a shape against a real tessellation; `distance` is that to the smooth surface.
    fn check(shape: Shape, detail: u32, mesh: &[[Point; 3]], distance: impl Fn(Point) -> f64) {
        assert_eq!(shape.triangles(detail) as usize, mesh.len(), "{shape:?} at {detail}");
        assert_eq!(shape.vertices(detail) as usize, vertices(mesh), "{shape:?} at {detail}");
        let worst = samples(mesh).map(distance).fold(0.0, f64::max);
        let bound = shape.deviation(detail);
        assert!(worst <= bound, "{shape:?} at {detail}: {worst} beyond the bound {bound}");
        assert!(worst >= bound / 4.0, "{shape:?} at {detail}: {worst}, and the bound is {bound}");
    }

    #[test]
    fn spheres_are_as_counted_and_within_their_bound() {
        for detail in [4, 6, 8, 12, 20, 48] {
            let mesh = turned(&arc(0.0, 1.5, [-90.0, 90.0], detail / 2), detail);
            check(Shape::Sphere { radius: 1.5 }, detail, &mesh, |p| {
                (1.5 - (rho(p) * rho(p) + p[1] * p[1]).sqrt()).abs()
            });
        }
    }

    #[test]
    fn tori_are_as_counted_and_within_their_bound() {
        for detail in [6, 8, 13, 24, 48] {
            let mut profile = arc(2.0, 0.5, [0.0, 360.0], detail / 2);
            let last = profile.len() - 1;
            profile[last] = profile[0];
            let mesh = turned(&profile, detail);
            check(Shape::Torus { ring: 2.0, tube: 0.5 }, detail, &mesh, |p| {
                let across = rho(p) - 2.0;
                (0.5 - (across * across + p[1] * p[1]).sqrt()).abs()
            });
        }
    }

    #[test]
    fn tubes_are_as_counted_and_within_their_bound() {
        for detail in [3, 4, 8, 48] {
            let mesh = turned(&[[0.25, 0.0], [0.1, 4.0]], detail);
            check(Shape::Tube { radius: 0.25, length: 4.0 }, detail, &mesh, |p| {
                (rho(p) - 0.25 + 0.15 * p[1] / 4.0).abs()
            });
        }
    }

    /// A cap is a polygon: two triangles less than corners, and corners of its own.
    #[test]
    fn caps_are_counted() {
        for n in [3, 8, 48] {
            let side = turned(&[[1.0, 0.0], [1.0, 1.0]], n);
            let cylinder = Shape::Cylinder { radius: 1.0, height: 1.0 };
            assert_eq!(cylinder.triangles(n) as usize, side.len() + 2 * (n as usize - 2));
            assert_eq!(cylinder.vertices(n) as usize, vertices(&side) + 2 * n as usize);
            let side = turned(&[[1.0, 0.0], [0.0, 1.0]], n);
            let cone = Shape::Cone { radius: 1.0, height: 1.0 };
            assert_eq!(cone.triangles(n) as usize, side.len() + n as usize - 2);
            assert_eq!(cone.vertices(n) as usize, vertices(&side) + n as usize);
        }
        let (block, profile) = (Shape::Block([1.0; 3]), Shape::Profile { corners: 4, size: [1.0; 3] });
        assert_eq!((block.triangles(1), block.vertices(1)), (profile.triangles(1), profile.vertices(1)));
    }

    /// A closed smooth mesh has two vertices more than half its triangles (Euler); its corners are the octants of
    /// a sphere.
    #[test]
    fn a_rounded_block_closes_and_its_corners_are_a_sphere() {
        let block = Shape::RoundedBlock([3.0, 2.0, 1.0], 0.25);
        for detail in 2..20 {
            assert_eq!(block.vertices(detail), 2 + block.triangles(detail) / 2);
            let sphere = Shape::Sphere { radius: 0.25 };
            assert_eq!(block.deviation(detail), sphere.deviation(4 * (detail - 1)));
        }
        let corner = 0.25 * (3f64.sqrt() - 1.0);
        assert!((corner..corner * 1.001).contains(&block.deviation(1)));
    }

    /// The paraboloid of the given bend is the worst case: its chord's error is the bound itself.
    #[test]
    fn the_bound_of_a_field_is_met_by_a_paraboloid() {
        let (side, bend, cells) = (8.0, 0.5, 4.0);
        let height = |x: f64, z: f64| bend * (x * x + z * z) / 2.0;
        let cell = side / cells;
        let chord = (height(cell, 0.0) + height(0.0, cell)) / 2.0;
        let worst = chord - height(cell / 2.0, cell / 2.0);
        let field = Shape::Field { side, relief: 100.0, bend };
        assert!((worst - field.deviation(4)).abs() < 1e-12);
        assert_eq!((field.triangles(4), field.vertices(4)), (32, 25));
    }

    #[test]
    fn detail_zero_draws_nothing() {
        for shape in [Shape::Block([1.0; 3]), Shape::Sphere { radius: 1.0 }, Shape::Recess { depth: 1.0 }] {
            assert_eq!((shape.triangles(0), shape.vertices(0)), (0, 0));
        }
    }
}
