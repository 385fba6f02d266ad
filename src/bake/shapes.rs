//! Surfaces made from a formula: smooth, closed or open, of any number of triangles.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::Surface;

/// How many radii the tube of a knot is away from its axis.
const KNOT_RADIUS: f32 = 1.0;

/// Radius of the tube of a knot.
const TUBE_RADIUS: f32 = 0.25;

/// The torus knot that winds twice around the axis and thrice through the hole: closed, of genus 1, some 3 units
/// wide. It has `2·rings·sides` triangles; fewer than 3 rings or sides are made 3.
pub fn torus_knot(rings: u32, sides: u32) -> Surface {
    let (rings, sides) = (rings.max(3), sides.max(3));
    let place = |ring: u32, side: u32| {
        let along = TAU * ring as f32 / rings as f32;
        let (sin, cos) = (TAU * side as f32 / sides as f32).sin_cos();
        let tangent = (knot(along + 1e-3) - knot(along - 1e-3)).normalize();
        let out = tangent.cross(Vec3::Z).normalize();
        knot(along) + TUBE_RADIUS * (cos * out + sin * tangent.cross(out))
    };
    Surface {
        positions: grid(rings, sides).map(|(ring, side)| place(ring, side)).collect(),
        triangles: quads(grid(rings, sides), |ring, side| (ring % rings) * sides + side % sides),
    }
}

/// The centre line of the knot, from an angle.
fn knot(along: f32) -> Vec3 {
    let (around, through) = ((2.0 * along).sin_cos(), (3.0 * along).sin_cos());
    let reach = KNOT_RADIUS + 0.5 * through.1;
    Vec3::new(reach * around.1, reach * around.0, 0.5 * through.0)
}

/// The torus around the z axis with tubes of `tube` units at 1 unit: closed, of genus 1, of `2·rings·sides` triangles.
/// Fewer than 3 rings or sides are made 3.
pub fn torus(rings: u32, sides: u32, tube: f32) -> Surface {
    let (rings, sides) = (rings.max(3), sides.max(3));
    let place = |ring: u32, side: u32| {
        let around = Vec2::from_angle(TAU * ring as f32 / rings as f32);
        let across = Vec2::from_angle(TAU * side as f32 / sides as f32) * tube;
        (around * (1.0 + across.x)).extend(-across.y)
    };
    Surface {
        positions: grid(rings, sides).map(|(ring, side)| place(ring, side)).collect(),
        triangles: quads(grid(rings, sides), |ring, side| (ring % rings) * sides + side % sides),
    }
}

/// The unit sphere as an icosahedron each of whose edges is cut into `cuts`: closed, of genus 0, of `20·cuts²`
/// triangles. No cut is made one.
pub fn icosphere(cuts: u32) -> Surface {
    let cuts = cuts.max(1);
    let mut sphere = Sphere { surface: Surface::default(), cuts, edges: vec![Vec::new(); 12 * 12] };
    sphere.surface.positions = icosahedron_corners().to_vec();
    for face in ICOSAHEDRON {
        sphere.add_face(face);
    }
    sphere.surface
}

/// The faces of an icosahedron, counter-clockwise from outside.
const ICOSAHEDRON: [[u32; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

fn icosahedron_corners() -> [Vec3; 12] {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let corners = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ];
    corners.map(|c| Vec3::from_array(c).normalize())
}

/// An icosphere in the making.
struct Sphere {
    surface: Surface,
    cuts: u32,
    /// Per pair of corners, lower one first, the vertices between them.
    edges: Vec<Vec<u32>>,
}

impl Sphere {
    /// Adds the face between three corners, row by row from the first of them.
    fn add_face(&mut self, [a, b, c]: [u32; 3]) {
        let (left, right, last) = (self.edge(a, b), self.edge(a, c), self.edge(b, c));
        let mut above = vec![a];
        for row in 1..=self.cuts {
            let ends = (left[row as usize], right[row as usize]);
            let below = if row == self.cuts { last.clone() } else { self.row(ends.0, ends.1, row) };
            for i in 0..row as usize {
                self.surface.triangles.push([above[i], below[i], below[i + 1]]);
                if i + 1 < row as usize {
                    self.surface.triangles.push([above[i], below[i + 1], above[i + 1]]);
                }
            }
            above = below;
        }
    }

    /// The vertices from corner `a` to corner `b`, both included, made where this is the first face that asks.
    fn edge(&mut self, a: u32, b: u32) -> Vec<u32> {
        let key = (a.min(b) * 12 + a.max(b)) as usize;
        if self.edges[key].is_empty() {
            self.edges[key] = self.row(a.min(b), a.max(b), self.cuts);
        }
        let mut edge = self.edges[key].clone();
        if a > b {
            edge.reverse();
        }
        edge
    }

    /// Vertices from `a` to `b`, both included, `steps` apart.
    fn row(&mut self, a: u32, b: u32, steps: u32) -> Vec<u32> {
        let [start, end] = [a, b].map(|v| self.surface.positions[v as usize]);
        let first = self.surface.positions.len() as u32;
        let between = (1..steps).map(|i| start.lerp(end, i as f32 / steps as f32).normalize());
        self.surface.positions.extend(between);
        [a].into_iter().chain(first..first + steps - 1).chain([b]).collect()
    }
}

/// A square of 1 by 1 units of `2·side²` triangles, open at its border, whose height (z) is four octaves of value
/// noise, up to 0.15 units, and a fine grain of 0.1 % of a unit. The same seed makes the same terrain.
pub fn terrain(side: u32, seed: u32) -> Surface {
    let side = side.max(1);
    let place = |row: u32, column: u32| {
        let at = Vec2::new(column as f32, row as f32) / side as f32;
        let grain = 1e-3 * (lattice(row, column, seed ^ 0x5eed) - 0.5);
        at.extend(hills(at, seed) + grain)
    };
    Surface {
        positions: grid(side + 1, side + 1).map(|(row, column)| place(row, column)).collect(),
        triangles: quads(grid(side, side), |row, column| row * (side + 1) + column),
    }
}

/// The height of the hills at a place in the unit square.
fn hills(at: Vec2, seed: u32) -> f32 {
    let octave = |o: u32| noise(at * (4 << (2 * o)) as f32, seed.wrapping_add(o)) / (3 * o + 1).pow(2) as f32;
    0.15 * (0..4).map(octave).sum::<f32>()
}

/// Value noise in [0, 1): random values at whole numbers, smoothly blended between.
fn noise(at: Vec2, seed: u32) -> f32 {
    let (cell, part) = (at.floor(), at.fract());
    let blend = part * part * (Vec2::splat(3.0) - 2.0 * part);
    let value = |x: u32, y: u32| lattice(cell.x as u32 + x, cell.y as u32 + y, seed);
    let [low, high] = [0, 1].map(|y| value(0, y) * (1.0 - blend.x) + value(1, y) * blend.x);
    low * (1.0 - blend.y) + high * blend.y
}

/// A random number in [0, 1) for a pair of whole numbers.
fn lattice(x: u32, y: u32, seed: u32) -> f32 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ seed.wrapping_mul(0xc2b2_ae3d);
    for _ in 0..2 {
        h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    }
    ((h ^ (h >> 16)) >> 8) as f32 / (1 << 24) as f32
}

/// All (row, column), row by row.
fn grid(rows: u32, columns: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..rows).flat_map(move |row| (0..columns).map(move |column| (row, column)))
}

/// Two triangles for each cell between (row, column) and the next of both.
fn quads(cells: impl Iterator<Item = (u32, u32)>, vertex: impl Fn(u32, u32) -> u32) -> Vec<[u32; 3]> {
    let corners = |(r, c)| [vertex(r, c), vertex(r, c + 1), vertex(r + 1, c + 1), vertex(r + 1, c)];
    cells.map(corners).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// How many triangles go along each directed edge.
    fn edges(surface: &Surface) -> BTreeMap<(u32, u32), u32> {
        let mut edges = BTreeMap::new();
        for &[a, b, c] in &surface.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                *edges.entry(edge).or_default() += 1;
            }
        }
        edges
    }

    fn is_closed(surface: &Surface) -> bool {
        let edges = edges(surface);
        edges.iter().all(|(&(a, b), &n)| n == 1 && edges.get(&(b, a)) == Some(&1))
    }

    fn volume(surface: &Surface) -> f32 {
        let corner = |v: u32| surface.positions[v as usize];
        surface.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0).sum()
    }

    #[test]
    fn closed_shapes_are_closed_face_outwards_and_have_the_triangles_they_say() {
        for (shape, triangles) in
            [(torus_knot(60, 8), 960), (torus(3, 3, 0.3), 18), (icosphere(1), 20), (icosphere(7), 980)]
        {
            assert!(is_closed(&shape) && volume(&shape) > 0.0, "{triangles}: {}", volume(&shape));
            assert_eq!(shape.triangles.len(), triangles);
        }
    }

    #[test]
    fn a_fine_icosphere_has_the_volume_of_the_ball() {
        assert!((volume(&icosphere(30)) - TAU * 2.0 / 3.0).abs() < 0.02);
    }

    #[test]
    fn a_terrain_is_one_sheet_that_faces_up() {
        let terrain = terrain(9, 1);
        let edges = edges(&terrain);
        let open = edges.keys().filter(|&&(a, b)| !edges.contains_key(&(b, a))).count();
        assert_eq!((terrain.triangles.len(), open), (162, 36));
        let corner = |v: u32| terrain.positions[v as usize];
        assert!(
            terrain
                .triangles
                .iter()
                .all(|&[a, b, c]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).z > 0.0)
        );
        assert!(terrain.positions.iter().all(|p| (-0.01..0.25).contains(&p.z)));
    }
}
