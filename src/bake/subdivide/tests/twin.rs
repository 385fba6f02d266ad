//! Both schemes as the papers write them, vertex by vertex, on lists of faces that are searched anew for everything.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use glam::DVec3;

use super::shapes;
use crate::bake::subdivide::{ControlMesh, Scheme};

#[derive(Clone)]
pub(super) struct Twin {
    pub points: Vec<DVec3>,
    pub faces: Vec<Vec<usize>>,
    /// All edges, the lower end first.
    sharp: BTreeMap<(usize, usize), f64>,
    corners: BTreeMap<usize, f64>,
}

fn key(a: usize, b: usize) -> (usize, usize) {
    (a.min(b), a.max(b))
}

impl Twin {
    pub(super) fn of(mesh: &ControlMesh) -> Self {
        let face = |span: std::ops::Range<usize>| {
            mesh.corners[span].iter().map(|&w| mesh.wedges[w as usize] as usize).collect()
        };
        let mut twin = Self {
            points: shapes::in_double(mesh),
            faces: mesh.faces().map(face).collect(),
            sharp: BTreeMap::new(),
            corners: mesh
                .sharp_vertices
                .iter()
                .map(|s| (s.position as usize, f64::from(s.sharpness)))
                .collect(),
        };
        for (a, b) in twin.edges() {
            let sharpness = if twin.beside(a, b).len() == 2 { 0.0 } else { f64::INFINITY };
            twin.sharp.insert((a, b), sharpness);
        }
        for edge in &mesh.sharp_edges {
            let sharpness =
                twin.sharp.get_mut(&key(edge.ends[0] as usize, edge.ends[1] as usize)).expect("an edge");
            *sharpness = sharpness.max(f64::from(edge.sharpness));
        }
        for vertex in 0..twin.points.len() {
            if twin.parts_around(vertex) > 1 {
                twin.corners.insert(vertex, f64::INFINITY);
            }
        }
        twin
    }

    fn pairs(face: &[usize]) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..face.len()).map(|i| (face[i], face[(i + 1) % face.len()]))
    }

    fn edges(&self) -> BTreeSet<(usize, usize)> {
        self.faces.iter().flat_map(|face| Self::pairs(face)).map(|(a, b)| key(a, b)).collect()
    }

    /// The faces at an edge.
    fn beside(&self, a: usize, b: usize) -> Vec<usize> {
        let has = |face: &[usize]| Self::pairs(face).any(|(p, q)| key(p, q) == key(a, b));
        (0..self.faces.len()).filter(|&face| has(&self.faces[face])).collect()
    }

    fn faces_at(&self, vertex: usize) -> Vec<usize> {
        (0..self.faces.len()).filter(|&face| self.faces[face].contains(&vertex)).collect()
    }

    fn neighbours(&self, vertex: usize) -> Vec<usize> {
        let edges = self.sharp.keys().filter(|&&(a, b)| a == vertex || b == vertex);
        edges.map(|&(a, b)| if a == vertex { b } else { a }).collect()
    }

    /// How many sets of faces at a vertex hang together by its edges.
    fn parts_around(&self, vertex: usize) -> usize {
        let mut left = self.faces_at(vertex);
        let mut parts = 0;
        while let Some(first) = left.pop() {
            parts += 1;
            let mut open = vec![first];
            while let Some(face) = open.pop() {
                let touches = |other: usize| {
                    Self::pairs(&self.faces[face]).any(|(a, b)| {
                        (a == vertex || b == vertex)
                            && Self::pairs(&self.faces[other]).any(|(p, q)| key(p, q) == key(a, b))
                    })
                };
                let (near, far) = left.into_iter().partition(|&other| touches(other));
                open.extend::<Vec<usize>>(near);
                left = far;
            }
        }
        parts
    }

    fn mean(&self, vertices: &[usize]) -> DVec3 {
        vertices.iter().map(|&v| self.points[v]).sum::<DVec3>() / vertices.len() as f64
    }

    fn vertex_by(&self, scheme: Scheme, vertex: usize, worn: f64) -> DVec3 {
        let p = self.points[vertex];
        let ring = self.neighbours(vertex);
        let sharp: Vec<usize> =
            ring.iter().copied().filter(|&other| self.sharp[&key(vertex, other)] > worn).collect();
        let is_corner = self.corners.get(&vertex).is_some_and(|&sharpness| sharpness > worn);
        if is_corner || sharp.len() > 2 || ring.is_empty() {
            return p;
        }
        if sharp.len() == 2 {
            return (6.0 * p + self.points[sharp[0]] + self.points[sharp[1]]) / 8.0;
        }
        let n = ring.len() as f64;
        match scheme {
            Scheme::Loop => {
                let beta = (5.0 / 8.0 - (3.0 / 8.0 + (TAU / n).cos() / 4.0).powi(2)) / n;
                (1.0 - n * beta) * p + beta * ring.iter().map(|&v| self.points[v]).sum::<DVec3>()
            }
            Scheme::CatmullClark => {
                let faces = self.faces_at(vertex);
                let q = faces.iter().map(|&f| self.mean(&self.faces[f])).sum::<DVec3>() / faces.len() as f64;
                let r = ring.iter().map(|&v| (self.points[v] + p) / 2.0).sum::<DVec3>() / n;
                q / n + 2.0 * r / n + (n - 3.0) / n * p
            }
        }
    }

    fn vertex(&self, scheme: Scheme, vertex: usize) -> DVec3 {
        let edges = self.neighbours(vertex).into_iter().map(|other| self.sharp[&key(vertex, other)]);
        let fading: Vec<f64> =
            edges.chain(self.corners.get(&vertex).copied()).filter(|&s| s > 0.0 && s <= 1.0).collect();
        let (now, next) = (self.vertex_by(scheme, vertex, 0.0), self.vertex_by(scheme, vertex, 1.0));
        if fading.is_empty() {
            return now;
        }
        next.lerp(now, fading.iter().sum::<f64>() / fading.len() as f64)
    }

    fn edge(&self, scheme: Scheme, (a, b): (usize, usize)) -> DVec3 {
        let middle = (self.points[a] + self.points[b]) / 2.0;
        let sharpness = self.sharp[&(a, b)];
        if sharpness >= 1.0 {
            return middle;
        }
        let faces = self.beside(a, b);
        let smooth = match scheme {
            Scheme::Loop => {
                let all: DVec3 = faces.iter().map(|&f| 3.0 * self.mean(&self.faces[f])).sum();
                let across = all - 4.0 * middle;
                0.75 * middle + across / 8.0
            }
            Scheme::CatmullClark => {
                (2.0 * middle + self.mean(&self.faces[faces[0]]) + self.mean(&self.faces[faces[1]])) / 4.0
            }
        };
        smooth.lerp(middle, sharpness)
    }

    pub(super) fn refined(&self, scheme: Scheme) -> Self {
        let edges: Vec<(usize, usize)> = self.sharp.keys().copied().collect();
        let number: BTreeMap<(usize, usize), usize> =
            edges.iter().enumerate().map(|(i, &edge)| (edge, self.points.len() + i)).collect();
        let mut points: Vec<DVec3> = (0..self.points.len()).map(|v| self.vertex(scheme, v)).collect();
        points.extend(edges.iter().map(|&edge| self.edge(scheme, edge)));
        let mut faces = Vec::new();
        for face in &self.faces {
            let middles: Vec<usize> = Self::pairs(face).map(|(a, b)| number[&key(a, b)]).collect();
            let before = |i: usize| middles[(i + middles.len() - 1) % middles.len()];
            match scheme {
                Scheme::Loop => {
                    faces.extend((0..3).map(|i| vec![face[i], middles[i], before(i)]));
                    faces.push(middles);
                }
                Scheme::CatmullClark => {
                    let centre = points.len();
                    points.push(self.mean(face));
                    faces.extend((0..face.len()).map(|i| vec![face[i], middles[i], centre, before(i)]));
                }
            }
        }
        let worn = |sharpness: f64| (sharpness - 1.0).max(0.0);
        let corners = self.corners.iter().map(|(&v, &sharpness)| (v, worn(sharpness))).collect();
        let mut refined = Self { points, faces, sharp: BTreeMap::new(), corners };
        refined.sharp = refined.edges().into_iter().map(|edge| (edge, 0.0)).collect();
        for (&(a, b), &sharpness) in &self.sharp {
            for end in [a, b] {
                refined.sharp.insert(key(end, number[&(a, b)]), worn(sharpness));
            }
        }
        refined
    }

    /// The faces at a vertex, which becomes vertex 0. What goes on there depends on nothing else; edges keep their
    /// sharpness, but those that have lost a face.
    pub(super) fn around(&self, vertex: usize) -> Self {
        let faces: Vec<&Vec<usize>> = self.faces_at(vertex).into_iter().map(|f| &self.faces[f]).collect();
        let others: BTreeSet<usize> =
            faces.iter().flat_map(|face| face.iter().copied()).filter(|&v| v != vertex).collect();
        let old: Vec<usize> = [vertex].into_iter().chain(others).collect();
        let new = |v: &usize| old.iter().position(|o| o == v).expect("one of them");
        let mut near = Self {
            points: old.iter().map(|&v| self.points[v]).collect(),
            faces: faces.iter().map(|face| face.iter().map(new).collect()).collect(),
            sharp: BTreeMap::new(),
            corners: self.corners.get(&vertex).map(|&sharpness| (0, sharpness)).into_iter().collect(),
        };
        for (a, b) in near.edges() {
            let sharpness = self.sharp[&key(old[a], old[b])];
            let is_border = near.beside(a, b).len() != 2;
            near.sharp.insert((a, b), if is_border { f64::INFINITY } else { sharpness });
        }
        near
    }

    /// Where a vertex ends: subdivided forty times, its own faces alone.
    pub(super) fn limit(&self, scheme: Scheme, vertex: usize) -> DVec3 {
        let mut near = self.around(vertex);
        for _ in 0..40 {
            near = near.refined(scheme).around(0);
        }
        near.points[0]
    }
}
