//! Which way the limit surface faces at its vertices.
//!
//! A vertex has a normal on each of its *sides*: what is sharp for ever parts them, so that a crease is a hard edge of
//! the shading as it is one of the surface. Semi-sharp creases are smooth in the end, and part nothing.

use glam::{DVec3, Vec3};

use super::Scheme;
use super::fan::{Fan, fans};
use super::level::Level;
use super::limits::{closer, star, unmasked};
use super::net::{Net, Rule};
use super::tangents::Spread;

/// A star without masks is as flat as it gets after so many subdivisions.
const MOST_STEPS: usize = 48;

/// The sides of all vertices, and the corners of a level's faces that are on them.
pub(super) struct Sides {
    /// Per corner.
    pub of_corner: Vec<u32>,
    /// Per side, of length 1; zero where nothing around the vertex has an area.
    pub normals: Vec<Vec3>,
}

impl Sides {
    /// Catmull and Clark's scheme needs a level of quads. O(n log n), n being the corners at a vertex; where there are no
    /// masks, as many small subdivisions as [`limits`](super::limits::limits) makes.
    pub fn of(level: &Level, scheme: Scheme) -> Self {
        let net = &level.net;
        let mut sides = Self { of_corner: vec![0; net.corners.len()], normals: Vec::new() };
        let (rules, open) = (net.rules(f32::MAX), unmasked(net));
        let (starts, order) = corners_by_vertex(net);
        for (vertex, span) in starts.windows(2).enumerate().filter(|(_, span)| span[0] < span[1]) {
            let corners = &order[span[0]..span[1]];
            if open[vertex] {
                sides.add_followed(level, scheme, vertex as u32, corners);
            } else {
                let here = Here { net, values: &level.positions, vertex, corners, rule: rules[vertex] };
                here.sides(scheme).for_each(|(fan, normal)| sides.add(&fan, corners, normal));
            }
        }
        sides
    }

    /// Those of the corners one subdivision earlier: vertices keep their sides.
    pub fn coarsen(&mut self, scheme: Scheme) {
        // Triangles come in fours, the first three of which begin with a corner each; quads begin with one each.
        let (corners, own): (usize, &[usize]) = match scheme {
            Scheme::Loop => (12, &[0, 3, 6]),
            Scheme::CatmullClark => (4, &[0]),
        };
        let faces = self.of_corner.chunks(corners);
        self.of_corner = faces.flat_map(|face| own.iter().map(|&corner| face[corner])).collect();
    }

    /// As the faces around the vertex are in the end.
    fn add_followed(&mut self, level: &Level, scheme: Scheme, vertex: u32, corners: &[u32]) {
        let sides = level.net.corners.len() / level.net.face_count();
        let faces: Vec<u32> = corners.iter().map(|&corner| corner / sides as u32).collect();
        let (mut net, old) = star(&level.net, vertex, &faces);
        let mut values: Vec<DVec3> = old.iter().map(|&v| level.positions[v as usize]).collect();
        for _ in 0..MOST_STEPS {
            if !unmasked(&net)[0] {
                break;
            }
            (net, values) = closer(scheme, &net, &values);
            magnify(&mut values);
        }
        let own: Vec<u32> = (0..net.corners.len() as u32).filter(|&c| net.corners[c as usize] == 0).collect();
        let rule = net.rules(f32::MAX)[0];
        let here = Here { net: &net, values: &values, vertex: 0, corners: &own, rule };
        here.sides(scheme).for_each(|(fan, normal)| self.add(&fan, corners, normal));
    }

    /// Faces that are turned against the order face the other way.
    fn add(&mut self, fan: &Fan, corners: &[u32], normal: DVec3) {
        let normal = normal.normalize_or_zero().as_vec3();
        for (is_turned, normal) in [(false, normal), (true, -normal)] {
            let mut own = fan.corners.iter().filter(|(_, turned)| *turned == is_turned).peekable();
            if own.peek().is_some() {
                own.for_each(|&(i, _)| self.of_corner[corners[i] as usize] = self.normals.len() as u32);
                self.normals.push(normal);
            }
        }
    }
}

/// A vertex, and what is around it.
struct Here<'a> {
    net: &'a Net,
    values: &'a [DVec3],
    vertex: usize,
    corners: &'a [u32],
    rule: Rule,
}

impl Here<'_> {
    /// Its sides, and their normals of any length.
    fn sides(&self, scheme: Scheme) -> impl Iterator<Item = (Fan, DVec3)> + '_ {
        let edge = |edge: u32| &self.net.edges[edge as usize];
        // A crease that ends in a smooth vertex parts nothing there.
        let is_cut = |e: u32| self.rule != Rule::Smooth && edge(e).sharpness == f32::INFINITY;
        fans(self.net, self.corners, is_cut).into_iter().map(move |fan| {
            let spread = self.spread(&fan);
            let normal = match self.rule {
                Rule::Smooth if self.has_dart(&fan) => spread.area(),
                Rule::Smooth => spread.smooth(scheme),
                Rule::Crease(_) => spread.beside_crease(scheme),
                Rule::Corner => spread.at_corner(scheme),
            };
            (fan, normal)
        })
    }

    fn has_dart(&self, fan: &Fan) -> bool {
        fan.spokes.iter().any(|&edge| self.net.edges[edge as usize].sharpness > 0.0)
    }

    fn spread(&self, fan: &Fan) -> Spread {
        let to = |vertex: u32| self.values[vertex as usize] - self.values[self.vertex];
        let end = |&edge: &u32| to(self.net.edges[edge as usize].other(self.vertex as u32));
        let across = |&(i, _): &(usize, bool)| {
            let corner = self.corners[i] as usize;
            to(self.net.corners[corner - corner % 4 + (corner + 2) % 4])
        };
        let is_quads = self.net.corners.len() == 4 * self.net.face_count();
        Spread {
            neighbours: fan.spokes.iter().map(end).collect(),
            across: fan.corners.iter().filter(|_| is_quads).map(across).collect(),
            faces: fan.corners.len(),
        }
    }
}

/// Vertex 0 in the origin, and the farthest of the others 1 away: what is compared keeps its digits.
fn magnify(values: &mut [DVec3]) {
    let middle = values[0];
    let size = values.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
    let scale = if size > 0.0 { 1.0 / size } else { 1.0 };
    values.iter_mut().for_each(|p| *p = (*p - middle) * scale);
}

/// The corners in the order of their vertices, and where each vertex's begin and the last one's end.
fn corners_by_vertex(net: &Net) -> (Vec<usize>, Vec<u32>) {
    let mut starts = vec![0; net.sharpness.len() + 1];
    net.corners.iter().for_each(|&vertex| starts[vertex as usize + 1] += 1);
    for vertex in 1..starts.len() {
        starts[vertex] += starts[vertex - 1];
    }
    let (mut next, mut order) = (starts.clone(), vec![0; net.corners.len()]);
    for (corner, &vertex) in net.corners.iter().enumerate() {
        order[next[vertex as usize]] = corner as u32;
        next[vertex as usize] += 1;
    }
    (starts, order)
}
