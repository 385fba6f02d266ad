//! Vertex decimation: a vertex goes with the triangles around it, and the hole is triangulated anew.
//!
//! W. Schroeder, J. Zarge, W. Lorensen, "Decimation of triangle meshes", SIGGRAPH 1992. A vertex is simple, on a
//! border, on one feature edge that goes through it, a corner of such, or none of these (complex). Simple ones go in
//! the order of their distance from the average plane of their triangles, those on borders and edges in that of their
//! distance from the line between their neighbours on it; the others stay. Where we depart from the paper:
//! - vertices go in the order of a queue, not pass by pass with a growing threshold (as in W. Schroeder, "A topology
//!   modifying progressive decimation algorithm", 1997, whose changes of topology are not made);
//! - what was taken away around a vertex before counts in its distance, so that errors do not add up unseen;
//! - seams of attributes and borders of materials are feature edges;
//! - new triangles may not turn away from the old ones.

mod fill;
mod loops;

use std::ops::ControlFlow;

use glam::DVec3;

use super::queue::Queue;
use super::rebuild::Corner;
use super::steps::{Steps, step_by_step};
use super::workpiece::Workpiece;
use super::{Progress, Simplified, Simplifier, SimplifyError, Task};
use fill::fill;
use loops::{Kind, Sector};

/// Vertex decimation: vertices are some of the old ones, topology and feature edges stay. For scans and isosurfaces,
/// which are smooth and fine everywhere; where features are everywhere it ends early.
///
/// Weights make what they lie on go later; they have no part in the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decimate {
    /// Angle between the normals of two triangles from which their edge is a feature, in degrees.
    pub feature_angle: f32,
    /// Least distance of a corner of a loop from a cut through it, in lengths of the cut. Higher keeps triangles fat
    /// and ends earlier.
    pub least_aspect: f32,
    /// Least cosine of the angle between a new triangle and the average of those it came for, in [0, 1].
    pub least_turn: f32,
}

impl Default for Decimate {
    fn default() -> Self {
        Self { feature_angle: 60.0, least_aspect: 0.02, least_turn: 0.2 }
    }
}

/// A vertex in more triangles stays until they are fewer: what its loop costs takes the cube of their number.
const LARGEST_LOOP: usize = 64;

/// All vertices are looked at again while at least one in so many went since they were.
const WORTH_A_SWEEP: usize = 64;

impl Simplifier for Decimate {
    fn simplify(
        &self,
        task: &Task,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Simplified, SimplifyError> {
        step_by_step(task, progress, |piece| Removals::new(self, piece))
    }
}

/// The vertices that may go.
struct Removals<'a> {
    method: &'a Decimate,
    /// Cosine of the feature angle.
    least_cosine: f64,
    queue: Queue,
    /// Per vertex, what its removal costs as of now.
    costs: Vec<f32>,
    /// Per vertex, how far what went around it was off, in places.
    drifts: Vec<f64>,
    error: f64,
    /// How many vertices were in the queue, and went since.
    swept: usize,
    since_sweep: usize,
    ring: Vec<u32>,
}

impl Steps for Removals<'_> {
    /// Removes the vertex that is least off, if its loops can be filled.
    fn step(&mut self, piece: &mut Workpiece) -> ControlFlow<()> {
        let Some((cost, vertex)) = self.queue.pop() else {
            if self.since_sweep * WORTH_A_SWEEP <= self.swept {
                return ControlFlow::Break(());
            }
            self.sweep(piece);
            return ControlFlow::Continue(());
        };
        if self.costs[vertex as usize].to_bits() == cost.to_bits() && cost.is_finite() {
            self.try_remove(piece, vertex);
        }
        ControlFlow::Continue(())
    }

    fn error(&self) -> f64 {
        self.error
    }
}

impl<'a> Removals<'a> {
    fn new(method: &'a Decimate, piece: &Workpiece) -> Self {
        let count = piece.positions.len();
        let mut removals = Self {
            method,
            least_cosine: f64::from(method.feature_angle).to_radians().cos(),
            queue: Queue::new(),
            costs: vec![f32::INFINITY; count],
            drifts: vec![0.0; count],
            error: 0.0,
            swept: 0,
            since_sweep: 0,
            ring: Vec::new(),
        };
        removals.sweep(piece);
        removals
    }

    /// Puts all vertices into the queue.
    fn sweep(&mut self, piece: &Workpiece) {
        (self.swept, self.since_sweep) = (0, 0);
        for vertex in piece.vertices() {
            self.swept += 1;
            self.push(piece, vertex);
        }
    }

    /// Puts a vertex into the queue, if it is of a kind that may go.
    fn push(&mut self, piece: &Workpiece, vertex: u32) {
        self.costs[vertex as usize] = f32::INFINITY;
        let fan = piece.fans.of(vertex);
        if fan.is_empty() || fan.len() > LARGEST_LOOP || piece.is_locked(vertex) {
            return;
        }
        let kind = Kind::of(piece, vertex, self.least_cosine);
        let Some(off) = distance(piece, vertex, &kind) else { return };
        let weight = fan.iter().map(|&t| piece.weight(t)).fold(0.0, f64::max);
        let cost = weight * (off + self.drifts[vertex as usize]);
        self.costs[vertex as usize] = cost.min(f64::from(f32::MAX)) as f32;
        self.queue.push(self.costs[vertex as usize], vertex);
    }

    fn try_remove(&mut self, piece: &mut Workpiece, vertex: u32) {
        let kind = Kind::of(piece, vertex, self.least_cosine);
        let Some(off) = distance(piece, vertex, &kind) else { return };
        let drift = self.drifts[vertex as usize] + off;
        if piece.in_units(drift) > piece.task.target.error || !may_close(piece, vertex, &kind) {
            return;
        }
        let sectors = match kind {
            Kind::Simple(sector) => vec![sector],
            Kind::Line(_, sectors) => sectors,
            Kind::Fixed => return,
        };
        let filled: Option<Vec<_>> = sectors.iter().map(|s| self.fill(piece, s)).collect();
        if let Some(filled) = filled {
            self.remove(piece, vertex, &sectors, &filled, drift);
        }
    }

    /// Triangles of a sector without its vertex, unless they would be slivers, turn away, or repeat an edge.
    fn fill(&self, piece: &Workpiece, sector: &Sector) -> Option<Vec<[Corner; 3]>> {
        let places: Vec<DVec3> = sector.corners.iter().map(|c| piece.place(c.vertex)).collect();
        let average = average_normal(piece, &sector.triangles);
        let filled = fill(&places, average, f64::from(self.method.least_aspect))?;
        let least = f64::from(self.method.least_turn.clamp(0.0, 1.0));
        let is_turned = |&[a, b, c]: &[usize; 3]| {
            let across = (places[b] - places[a]).cross(places[c] - places[a]);
            let turn = across.normalize_or_zero().dot(average);
            turn <= 0.0 || turn < least
        };
        let count = places.len();
        let is_old = |a: usize, b: usize| {
            let are_next = (a + 1) % count == b || (b + 1) % count == a;
            !are_next && piece.at_edge(sector.corners[a].vertex, sector.corners[b].vertex).next().is_some()
        };
        let repeats = |&[a, b, c]: &[usize; 3]| is_old(a, b) || is_old(b, c) || is_old(c, a);
        let is_bad = filled.iter().any(|t| is_turned(t) || repeats(t));
        (!is_bad).then(|| filled.iter().map(|t| t.map(|i| sector.corners[i])).collect())
    }

    fn remove(
        &mut self,
        piece: &mut Workpiece,
        vertex: u32,
        sectors: &[Sector],
        filled: &[Vec<[Corner; 3]>],
        drift: f64,
    ) {
        let mut ring = std::mem::take(&mut self.ring);
        piece.neighbours(vertex, &mut ring);
        for (sector, new) in sectors.iter().zip(filled) {
            sector.triangles.iter().for_each(|&t| piece.remove(t));
            sector.triangles.iter().zip(new).for_each(|(&t, &corners)| piece.insert(t, corners));
        }
        let away = |&&n: &&u32| piece.place(n).distance_squared(piece.place(vertex));
        if let Some(&heir) = ring.iter().min_by(|a, b| away(a).total_cmp(&away(b))) {
            piece.set_heir(vertex, heir);
        }
        self.error = self.error.max(drift);
        self.since_sweep += 1;
        for &neighbour in &ring {
            self.drifts[neighbour as usize] = self.drifts[neighbour as usize].max(drift);
        }
        for &neighbour in &ring {
            self.push(piece, neighbour);
        }
        self.ring = ring;
    }
}

/// How far a vertex is from what will be in its stead; `None` if it stays.
fn distance(piece: &Workpiece, vertex: u32, kind: &Kind) -> Option<f64> {
    let place = piece.place(vertex);
    match kind {
        Kind::Simple(sector) => {
            let normal = average_normal(piece, &sector.triangles);
            let centers = sector.triangles.iter().map(|&t| center(piece, t));
            let (sum, area) = centers.fold((DVec3::ZERO, 0.0), |(s, w), (c, a)| (s + a * c, w + a));
            Some(if area > 0.0 { normal.dot(place - sum / area).abs() } else { 0.0 })
        }
        Kind::Line([a, b], _) => {
            let (from, to) = (piece.place(*a), piece.place(*b));
            let along = (to - from).normalize_or(DVec3::ZERO);
            Some((place - from - along * along.dot(place - from)).length())
        }
        Kind::Fixed => None,
    }
}

/// Whether the edges that close a vertex's loops may be: a border is closed by an edge that is not there yet, unless
/// the vertex has but one triangle, whose side becomes the border; what a feature leads through likewise; and the
/// loop of three is no triangle already.
fn may_close(piece: &Workpiece, vertex: u32, kind: &Kind) -> bool {
    match kind {
        Kind::Simple(sector) => match sector.corners[..] {
            [] | [_] | [_, _] => false,
            [a, b, c] => !piece.at_edge(a.vertex, b.vertex).any(|t| has(piece, t, c.vertex)),
            _ => true,
        },
        Kind::Line([a, b], sectors) => {
            let is_single = sectors.len() == 1 && piece.fans.of(vertex).len() == 1;
            let at_edge = piece.at_edge(*a, *b).count();
            if is_single { at_edge == 2 } else { at_edge == 0 }
        }
        Kind::Fixed => false,
    }
}

fn has(piece: &Workpiece, triangle: u32, vertex: u32) -> bool {
    piece.triangles[triangle as usize].contains(&vertex)
}

/// The unit normal of triangles together, by area; zero if they have none.
fn average_normal(piece: &Workpiece, triangles: &[u32]) -> DVec3 {
    let across = |&t: &u32| {
        let [a, b, c] = piece.places(t);
        (b - a).cross(c - a)
    };
    triangles.iter().map(across).sum::<DVec3>().normalize_or_zero()
}

/// The center of a triangle, and its area twice.
fn center(piece: &Workpiece, triangle: u32) -> (DVec3, f64) {
    let [a, b, c] = piece.places(triangle);
    ((a + b + c) / 3.0, (b - a).cross(c - a).length())
}
