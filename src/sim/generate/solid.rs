//! What kinds are put together from: tessellated shapes in metres, standing on the ground around the y axis.
//!
//! A shape is made of triangles in space; corners at the same place, to the bit, become one position, and triangles
//! without an area are dropped. So what closes in exact arithmetic has to close in ours: places that meet are worked
//! out by the same operations from the same numbers.

use std::collections::BTreeMap;

use glam::DVec3;

use super::angle::sin_cos_deg;
use super::place::{Place, at as place_at};

/// Triangles, counter-clockwise from outside.
#[derive(Clone, Debug, Default)]
pub(super) struct Solid {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
}

type Triangle = [DVec3; 3];

impl FromIterator<Triangle> for Solid {
    fn from_iter<I: IntoIterator<Item = Triangle>>(triangles: I) -> Self {
        let (mut solid, mut seen) = (Self::default(), BTreeMap::new());
        for corners in triangles {
            let [a, b, c] = corners.map(|corner| solid.index_of(corner, &mut seen));
            if a != b && b != c && c != a {
                solid.triangles.push([a, b, c]);
            }
        }
        solid
    }
}

impl Solid {
    fn index_of(&mut self, position: DVec3, seen: &mut BTreeMap<[u64; 3], u32>) -> u32 {
        // Minus zero becomes zero.
        let key = position.to_array().map(|x| (x + 0.0).to_bits());
        *seen.entry(key).or_insert_with(|| {
            self.positions.push(position);
            self.positions.len() as u32 - 1
        })
    }

    /// With every position moved; `bend` must not turn the solid inside out.
    pub fn bent(mut self, bend: impl Fn(DVec3) -> DVec3) -> Self {
        self.positions.iter_mut().for_each(|p| *p = bend(*p));
        self
    }

    /// One at each of these places, joined where they meet.
    pub fn at(&self, places: impl IntoIterator<Item = Place>) -> Self {
        let moved = |place: Place| self.corners().map(move |corners| corners.map(|p| place.apply(p)));
        places.into_iter().flat_map(moved).collect()
    }

    /// Both in one, joined where they meet.
    pub fn with(&self, other: &Self) -> Self {
        self.corners().chain(other.corners()).collect()
    }

    fn corners(&self) -> impl Iterator<Item = Triangle> {
        self.triangles.iter().map(|t| t.map(|corner| self.positions[corner as usize]))
    }
}

/// A box with sharp edges: 12 triangles.
pub(super) fn block([width, height, depth]: [f64; 3]) -> Solid {
    let [x, z] = [width / 2.0, depth / 2.0];
    prism(&[[-x, -z], [-x, z], [x, z], [x, -z]], height)
}

/// What stands over an outline of (x, z), counter-clockwise from above and in sight of its first corner: 4n − 4
/// triangles.
pub(super) fn prism(outline: &[[f64; 2]], height: f64) -> Solid {
    let ring = |y: f64| outline.iter().map(|&[x, z]| DVec3::new(x, y, z)).collect::<Vec<_>>();
    let (bottom, top) = (ring(0.0), ring(height));
    let around = (0..outline.len()).map(|i| (i, (i + 1) % outline.len()));
    let sides = around.flat_map(|(i, next)| quad([bottom[i], bottom[next], top[next], top[i]]));
    sides.chain(fan(&top)).chain(fan(&bottom).map(flipped)).collect()
}

/// A box whose edges are rounded to a radius, a quarter of a circle in n segments: 12 + 16n(n + 1) triangles.
pub(super) fn rounded([width, height, depth]: [f64; 3], radius: f64, quarter: u32) -> Solid {
    let at = |row: u32, column: u32| {
        let (upper, east, south) =
            (row > quarter, is_east(column / (quarter + 1)), column / (quarter + 1) < 2);
        let up = if upper { row - quarter - 1 } else { row };
        let turn = f64::from(column / (quarter + 1)) + f64::from(column % (quarter + 1)) / f64::from(quarter);
        let tilt = f64::from(up) / f64::from(quarter) - if upper { 0.0 } else { 1.0 };
        let corner = DVec3::new(
            if east { width / 2.0 - radius } else { radius - width / 2.0 },
            if upper { height - radius } else { radius },
            if south { depth / 2.0 - radius } else { radius - depth / 2.0 },
        );
        corner + radius * direction(90.0 * turn, 90.0 * tilt)
    };
    let (rows, columns) = (2 * quarter + 2, 4 * quarter + 4);
    let flat = |row: u32| fan(&[0, 1, 2, 3].map(|quadrant| at(row, quadrant * (quarter + 1)))).map(flipped);
    let caps = flat(0).map(flipped).chain(flat(rows - 1)).collect::<Vec<_>>();
    sheet([rows, columns + 1], |row, column| at(row, column % columns)).chain(caps).collect()
}

/// Whether x is positive in a quadrant, counted from +x to +z.
fn is_east(quadrant: u32) -> bool {
    quadrant == 0 || quadrant == 3
}

/// A unit vector: so many degrees from +x to +z, and so many up.
pub(super) fn direction(turn_deg: f64, tilt_deg: f64) -> DVec3 {
    let ((sin, cos), (up, along)) = (sin_cos_deg(turn_deg), sin_cos_deg(tilt_deg));
    DVec3::new(along * cos, up, along * sin)
}

/// A profile of [distance from the axis, height], from the bottom outwards and up, turned around the axis in so many
/// segments: two triangles for each segment and chord, one where the chord ends on the axis. It closes where the
/// profile's ends are on the axis or are the same.
pub(super) fn lathe(profile: &[[f64; 2]], segments: u32) -> Solid {
    turned(profile, 360.0, segments)
}

/// A profile turned by so many degrees from +x to +z; open at its ends unless it comes full circle.
pub(super) fn turned(profile: &[[f64; 2]], degrees: f64, segments: u32) -> Solid {
    let at = |row: u32, column: u32| {
        let [rho, y] = profile[row as usize];
        let (sin, cos) = sin_cos_deg(degrees * f64::from(column) / f64::from(segments));
        DVec3::new(rho * cos, y, rho * sin)
    };
    sheet([profile.len() as u32, segments + 1], at).collect()
}

/// A closed cylinder: 4n triangles.
pub(super) fn cylinder(radius: f64, height: f64, segments: u32) -> Solid {
    frustum([radius, radius], height, segments)
}

/// A closed cylinder of two radii, the lower one first: 4n triangles, or 2n where one is 0.
pub(super) fn frustum([lower, upper]: [f64; 2], height: f64, segments: u32) -> Solid {
    lathe(&[[0.0, 0.0], [lower, 0.0], [upper, height], [0.0, height]], segments)
}

/// A cylinder without ends, such as a branch, of two radii, the lower one first: 2n triangles.
pub(super) fn tube([lower, upper]: [f64; 2], height: f64, segments: u32) -> Solid {
    lathe(&[[lower, 0.0], [upper, height]], segments)
}

/// A sphere around the origin by longitude and half as many latitudes: n(n − 2) triangles.
pub(super) fn sphere(radius: f64, segments: u32) -> Solid {
    lathe(&arc([0.0, 0.0], radius, [-90.0, 90.0], segments / 2), segments)
}

/// A ring around the origin, `tube` thick to either side: n segments around, m across, 2nm triangles.
pub(super) fn torus(ring: f64, tube: f64, [around, across]: [u32; 2]) -> Solid {
    lathe(&arc([ring, 0.0], tube, [-90.0, 270.0], across), around)
}

/// A part of a ring that starts at +x, of so many degrees.
pub(super) fn hoop(ring: f64, tube: f64, degrees: f64, [around, across]: [u32; 2]) -> Solid {
    turned(&arc([ring, 0.0], tube, [-90.0, 270.0], across), degrees, around)
}

/// A cylinder with half spheres for ends, from the ground to its height: n segments around, n/2 from end to end,
/// n² triangles.
pub(super) fn capsule(radius: f64, height: f64, segments: u32) -> Solid {
    let chords = segments / 4;
    let mut profile = arc([0.0, radius], radius, [-90.0, 0.0], chords);
    profile.extend(arc([0.0, height - radius], radius, [0.0, 90.0], chords));
    lathe(&profile, segments)
}

/// Points of a circle as a profile, from an angle to another in degrees; 0 is outwards, 90 up.
pub(super) fn arc(center: [f64; 2], radius: f64, [from, to]: [f64; 2], chords: u32) -> Vec<[f64; 2]> {
    let at = |i| {
        let (sin, cos) = sin_cos_deg(from + (to - from) * f64::from(i) / f64::from(chords));
        [center[0] + radius * cos, center[1] + radius * sin]
    };
    (0..=chords).map(at).collect()
}

/// A height field over a rectangle, open at its borders: two triangles a cell.
pub(super) fn field(
    [width, depth]: [f64; 2],
    [columns, rows]: [u32; 2],
    height: impl Fn(f64, f64) -> f64,
) -> Solid {
    let along = |side: f64, i: u32, n: u32| side * (f64::from(i) / f64::from(n) - 0.5);
    let at = |row: u32, column: u32| {
        let (x, z) = (along(width, column, columns), -along(depth, row, rows));
        DVec3::new(x, height(x, z), z)
    };
    sheet([rows + 1, columns + 1], at).map(flipped).collect()
}

/// A leaf, a sign, a pane: an upright rectangle facing +z, two triangles seen from one side.
pub(super) fn card([width, height]: [f64; 2]) -> Solid {
    quad(rectangle([-width / 2.0, 0.0], [width / 2.0, height], 0.0)).into_iter().collect()
}

/// A wall facing +z with a window in each of its cells, set back by a depth: 18 triangles a window, open at the wall's
/// borders.
pub(super) fn facade(
    [width, height]: [f64; 2],
    [columns, rows]: [u32; 2],
    [window_width, window_height]: [f64; 2],
    depth: f64,
) -> Solid {
    let along = |side: f64, i: u32, n: u32| side * (f64::from(i) / f64::from(n));
    let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let window = |(row, column): (u32, u32)| {
        let low = [along(width, column, columns) - width / 2.0, along(height, row, rows)];
        let high = [along(width, column + 1, columns) - width / 2.0, along(height, row + 1, rows)];
        let middle = [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0];
        let half = [window_width / 2.0, window_height / 2.0];
        let (near, far) = ([0, 1].map(|k| middle[k] - half[k]), [0, 1].map(|k| middle[k] + half[k]));
        let edge = rectangle(near, far, 0.0);
        let pane = rectangle(near, far, -depth);
        let frame = between(rectangle(low, high, 0.0), edge);
        frame.chain(between(edge, pane)).chain(quad(pane)).collect::<Vec<_>>()
    };
    cells.flat_map(window).collect()
}

/// Four façades around a floor, windows in so many columns on the wide sides, the deep sides, and so many rows; neither
/// floor nor roof.
pub(super) fn walls(
    [width, height, depth]: [f64; 3],
    [wide, deep, rows]: [u32; 3],
    window: [f64; 2],
    reveal: f64,
) -> Solid {
    let [x, z] = [width / 2.0, depth / 2.0];
    let front = facade([width, height], [wide, rows], window, reveal);
    let side = facade([depth, height], [deep, rows], window, reveal);
    let fronts = front.at([0.0, 180.0].map(|turn| place_at(0.0, 0.0, 0.0).yaw(turn).by(0.0, 0.0, z)));
    fronts.with(&side.at([90.0, 270.0].map(|turn| place_at(0.0, 0.0, 0.0).yaw(turn).by(0.0, 0.0, x))))
}

/// Corners of an upright rectangle, counter-clockwise from +z.
fn rectangle([left, low]: [f64; 2], [right, high]: [f64; 2], z: f64) -> [DVec3; 4] {
    [[left, low], [right, low], [right, high], [left, high]].map(|[x, y]| DVec3::new(x, y, z))
}

/// The strip between a rectangle and a smaller or deeper one in it.
fn between(outer: [DVec3; 4], inner: [DVec3; 4]) -> impl Iterator<Item = Triangle> {
    (0..4).flat_map(move |i| {
        let next = (i + 1) % 4;
        quad([outer[i], outer[next], inner[next], inner[i]])
    })
}

fn quad([a, b, c, d]: [DVec3; 4]) -> [Triangle; 2] {
    [[a, b, c], [a, c, d]]
}

/// A polygon in sight of its first corner.
fn fan(ring: &[DVec3]) -> impl Iterator<Item = Triangle> + use<> {
    let first = ring[0];
    let pairs: Vec<Triangle> = ring[1..].windows(2).map(|pair| [first, pair[0], pair[1]]).collect();
    pairs.into_iter()
}

fn flipped([a, b, c]: Triangle) -> Triangle {
    [a, c, b]
}

/// The cells of a grid of points, seen from the side where rows go up and columns to the left.
fn sheet([rows, columns]: [u32; 2], at: impl Fn(u32, u32) -> DVec3) -> impl Iterator<Item = Triangle> {
    let cells = (1..rows).flat_map(move |row| (1..columns).map(move |column| (row, column)));
    cells.flat_map(move |(row, column)| {
        quad([at(row - 1, column - 1), at(row, column - 1), at(row, column), at(row - 1, column)])
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::f64::consts::PI;

    use super::*;

    /// Edges along which there is a triangle on one side alone.
    fn borders(solid: &Solid) -> usize {
        let mut uses = BTreeSet::new();
        for [a, b, c] in &solid.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                assert!(uses.insert(edge), "an edge is gone along twice");
            }
        }
        uses.iter().filter(|&&(a, b)| !uses.contains(&(b, a))).count()
    }

    fn volume(solid: &Solid) -> f64 {
        solid.corners().map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    fn area(solid: &Solid) -> f64 {
        solid.corners().map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum()
    }

    /// Triangles as counted, no border, and a volume that is positive and that of the smooth shape within so many
    /// percent: closed, and right side out.
    fn check_closed(solid: &Solid, triangles: u32, expected: f64, percent: f64) {
        assert_eq!((solid.triangles.len(), borders(solid)), (triangles as usize, 0));
        let off = 100.0 * (volume(solid) / expected - 1.0);
        assert!(off.abs() <= percent, "{} is {off} % from {expected}", volume(solid));
    }

    #[test]
    fn flat_solids_are_closed_and_exact() {
        check_closed(&block([3.0, 2.0, 1.0]), 12, 6.0, 1e-9);
        check_closed(&prism(&[[0.0, 0.0], [0.0, 2.0], [3.0, 0.0]], 5.0), 8, 15.0, 1e-9);
    }

    #[test]
    fn round_solids_are_closed_and_nearly_exact() {
        for n in [16, 20, 64] {
            check_closed(&sphere(1.5, n), n * (n - 2), 4.5 * PI, 8.0);
            check_closed(&torus(2.0, 0.5, [n, 16]), 32 * n, PI * PI, 6.0);
            check_closed(&cylinder(0.5, 3.0, n), 4 * n, 0.75 * PI, 3.0);
            check_closed(&frustum([1.0, 0.0], 3.0, n), 2 * n, PI, 3.0);
            check_closed(&capsule(0.5, 2.0, n), n * n, PI / 4.0 + PI / 6.0, 6.0);
        }
    }

    /// A box, beams along its edges and a sphere of the rounding.
    #[test]
    fn rounded_blocks_are_closed_and_nearly_exact() {
        let (size, r) = ([3.0, 2.0, 1.0], 0.25);
        let [a, b, c] = size.map(|side| side - 2.0 * r);
        let faces = 2.0 * r * (a * b + b * c + c * a);
        let expected = a * b * c + faces + PI * r * r * (a + b + c) + 4.0 / 3.0 * PI * r * r * r;
        for n in [1, 2, 5, 12] {
            check_closed(&rounded(size, r, n), 12 + 16 * n * (n + 1), expected, 8.0 / f64::from(n * n));
        }
        check_closed(&rounded([0.5; 3], r, 8), 32 * 30, PI / 48.0, 4.0);
    }

    #[test]
    fn open_solids_are_open_where_they_say() {
        let branch = tube([0.3, 0.1], 2.0, 12);
        assert_eq!((branch.triangles.len(), borders(&branch)), (24, 24));
        let half = hoop(1.0, 0.1, 180.0, [8, 6]);
        assert_eq!((half.triangles.len(), borders(&half)), (96, 12));
        let leaf = card([2.0, 3.0]);
        assert_eq!((leaf.triangles.len(), area(&leaf)), (2, 6.0));
        let ground = field([4.0, 2.0], [8, 4], |_, _| 1.0);
        assert_eq!((ground.triangles.len(), area(&ground), borders(&ground)), (64, 8.0, 24));
        let up = |[a, b, c]: Triangle| (b - a).cross(c - a).y > 0.0;
        assert!(ground.corners().all(up));
    }

    /// A wall's area and those of the four sides of its windows; its border is its outline.
    #[test]
    fn a_facade_has_windows_and_four_of_them_meet() {
        let side = facade([6.0, 4.0], [3, 2], [1.0, 0.5], 0.2);
        assert_eq!((side.triangles.len(), borders(&side)), (18 * 6, 10));
        assert!((area(&side) - (24.0 + 6.0 * 3.0 * 0.2)).abs() < 1e-9);
        let house = walls([6.0, 4.0, 5.0], [3, 2, 2], [1.0, 0.5], 0.2);
        assert_eq!((house.triangles.len(), borders(&house)), (18 * 20, 20));
    }
}
