//! Before the first contraction: an order for the memory, quadrics, borders and seams.

use super::choice::Choice;
use super::sieve::Sieve;
use super::{Greedy, mark};
use crate::bake::simplify::Task;
use crate::bake::simplify::fans::Fans;
use crate::bake::simplify::link::{Complex, Rings, Stamps, others};
use crate::bake::simplify::order::{along_curve, by_key};
use crate::bake::simplify::quadric::form::Quadric;
use crate::bake::simplify::quadric::guard::{Facing, Guard};
use crate::bake::simplify::quadric::layers::Layers;
use crate::bake::simplify::quadric::pairs::Pairs;
use crate::bake::simplify::quadric::patch::Patch;
use crate::bake::simplify::quadric::rest::Rest;
use crate::bake::simplify::quadric::{GarlandHeckbert, Topology};
use crate::bake::simplify::queue::Queue;
use crate::bake::simplify::workpiece::scale_of;

impl<'a> Greedy<'a> {
    /// Sums up the quadrics and fills the queue.
    pub(in crate::bake::simplify::quadric) fn new(method: &'a GarlandHeckbert, task: &'a Task) -> Self {
        let Ordered { origins, triangles, old_triangles, weights } = Ordered::new(task);
        let count = origins.len();
        let positions = origins.iter().map(|&v| task.mesh.positions[v as usize]);
        let lock = |&v: &u32| if task.is_locked(v as usize) { mark::LOCKED } else { 0 };
        let scale = scale_of(positions.clone());
        let layers =
            task.mesh.has_seams().then(|| Layers::new(task.mesh, &old_triangles, &method.attributes, scale));
        let mut greedy = Self {
            method,
            task,
            guard: Guard::new(method.least_turn, method.least_shape),
            scale,
            places: positions.map(|p| p.as_dvec3() * scale).collect(),
            quadrics: vec![Quadric::default(); count],
            patches: vec![Patch::default(); count],
            fans: Fans::new(count, &triangles),
            from: triangles.len(),
            live: triangles.len(),
            facings: vec![Facing::default(); triangles.len()],
            triangles,
            old_triangles,
            pairs: None,
            layers,
            marks: origins.iter().map(lock).collect(),
            choices: vec![Choice::default(); count],
            queue: Queue::new(),
            stamps: Stamps::new(count),
            order: origins.clone(),
            origins,
            heirs: (0..count as u32).collect(),
            is_free: false,
            most: -1.0,
            error: 0.0,
            witness: None,
            fan: Sieve::default(),
            going: Sieve::default(),
            partners: Sieve::default(),
            rings: Rings::default(),
            rest: <[Rest; 2]>::default(),
        };
        greedy.sum_up(&weights);
        greedy.find_pairs();
        greedy
    }

    /// Finds what may be contracted besides edges.
    fn find_pairs(&mut self) {
        let distance = f64::from(self.method.pairs);
        if self.method.topology == Topology::Free && distance > 0.0 {
            let complex = Complex { triangles: &self.triangles, fans: &self.fans };
            self.pairs = Some(Pairs::find(&self.positions(), complex, distance));
        }
    }

    /// Gives every vertex the quadrics of its triangles and borders, and marks the borders.
    fn sum_up(&mut self, weights: &[f64]) {
        for (t, &weight) in weights.iter().enumerate() {
            let corners = self.triangles[t];
            let [a, b, c] = corners.map(|v| self.place(v));
            let across = (b - a).cross(c - a);
            let normal = across.normalize_or_zero();
            let area = 0.5 * weight * across.length();
            self.facings[t] = Facing::new(normal);
            for corner in corners {
                self.quadrics[corner as usize].add_plane(normal, area);
                self.patches[corner as usize].area += area as f32;
            }
        }
        let (mut uses, mut sides) = (vec![0; self.places.len()], Vec::new());
        for vertex in 0..self.places.len() as u32 {
            let fan = self.fans.of(vertex).iter();
            sides.clear();
            sides.extend(fan.map(|&t| (t as usize, others(self.triangles[t as usize], vertex))));
            self.find_borders(vertex, &sides, weights, &mut uses);
        }
        if let Some(mut layers) = self.layers.take() {
            layers.sum_up(&self.triangles, &self.places, weights);
            self.hold_seams(&layers, weights);
            self.layers = Some(layers);
        }
    }

    /// Marks the vertices of seams, and holds them to the planes that stand upright on the triangles at either side.
    fn hold_seams(&mut self, layers: &Layers, weights: &[f64]) {
        for triangle in (0..self.triangles.len()).filter(|_| layers.holds_seams()) {
            let [a, b, c] = self.triangles[triangle];
            for edge in [[a, b], [b, c], [c, a]] {
                if self.is_seam(layers, edge) {
                    for [vertex, neighbour] in [edge, [edge[1], edge[0]]] {
                        self.marks[vertex as usize] |= mark::SEAM;
                        let weight = weights[triangle] * f64::from(self.method.seam);
                        self.hold_to_edge(vertex, neighbour, triangle, weight);
                    }
                }
            }
        }
    }

    /// Marks a vertex that has borders, and holds it to those of one triangle. Where more than two meet nothing ends, and
    /// their own planes hold the edge if they meet at an angle. `sides` are the triangles of the vertex and their other
    /// corners. `uses` is 0 everywhere, and has room for counts: per neighbour of triangles that lead to it, and 2³²
    /// times those that come from it.
    fn find_borders(&mut self, vertex: u32, sides: &[(usize, [u32; 2])], weights: &[f64], uses: &mut [u64]) {
        const PLAIN: u64 = 1 << 32 | 1;
        let count = |uses: &mut [u64]| {
            for &(_, [p, q]) in sides {
                uses[p as usize] += 1;
                uses[q as usize] += 1 << 32;
            }
        };
        count(uses);
        // Where every neighbour has one triangle in either direction there are no others.
        let mut others = 0;
        for &(_, [p, _]) in sides {
            others |= std::mem::take(&mut uses[p as usize]) ^ PLAIN;
        }
        if others == 0 {
            return;
        }
        let neighbours = || sides.iter().flat_map(|&(triangle, ends)| ends.map(|end| (triangle, end)));
        neighbours().for_each(|(_, neighbour)| uses[neighbour as usize] = 0);
        count(uses);
        for (triangle, neighbour) in neighbours() {
            let (to, from) = (uses[neighbour as usize] as u32, (uses[neighbour as usize] >> 32) as u32);
            self.marks[vertex as usize] |= if to != from { mark::ODD } else { 0 };
            self.marks[vertex as usize] |= if to + from != 2 { mark::BORDER } else { 0 };
            if to + from == 1 {
                let weight = weights[triangle] * f64::from(self.method.border);
                self.hold_to_edge(vertex, neighbour, triangle, weight);
            }
        }
        neighbours().for_each(|(_, neighbour)| uses[neighbour as usize] = 0);
    }

    /// Holds one end of an edge of a triangle to the plane through it that stands upright on the triangle.
    fn hold_to_edge(&mut self, vertex: u32, neighbour: u32, triangle: usize, weight: f64) {
        let [a, b, c] = self.triangles[triangle].map(|v| self.place(v));
        let edge = self.place(neighbour) - self.place(vertex);
        let upright = (b - a).cross(c - a).cross(edge).normalize_or_zero();
        self.quadrics[vertex as usize].add_plane(upright, weight * edge.length_squared());
    }
}

/// The triangles of a task in an order that keeps neighbours together, those that use a vertex twice left out.
struct Ordered {
    /// Per vertex that is used, its old index.
    origins: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    /// Per triangle, its old index.
    old_triangles: Vec<u32>,
    /// Per triangle, 1 at most.
    weights: Vec<f64>,
}

impl Ordered {
    fn new(task: &Task) -> Self {
        let (kept, mut unsorted) = task.proper_triangles();
        let origins = along_curve(&task.mesh.positions, unsorted.iter().copied());
        let mut new = vec![0; task.mesh.positions.len()];
        for (index, &vertex) in (0..).zip(&origins) {
            new[vertex as usize] = index;
        }
        unsorted.as_flattened_mut().iter_mut().for_each(|vertex| *vertex = new[*vertex as usize]);
        let lowest = |&[a, b, c]: &[u32; 3]| a.min(b).min(c);
        let order = by_key(unsorted.iter().map(lowest), origins.len());
        let most = task.weights.iter().fold(0.0, |most: f32, &w| most.max(w));
        let scale = if most > 0.0 { 1.0 / f64::from(most) } else { 1.0 };
        let old_triangles: Vec<u32> = order.iter().map(|&i| kept[i as usize]).collect();
        Self {
            triangles: order.iter().map(|&i| unsorted[i as usize]).collect(),
            weights: old_triangles.iter().map(|&t| task.weight(t as usize) * scale).collect(),
            old_triangles,
            origins,
        }
    }
}
