//! Half-edge collapses in the order of length times bend.
//!
//! S. Melax, "A simple, fast, and effective polygon reduction algorithm", Game Developer, 1998. A vertex u moves onto a
//! neighbour v at the cost |u − v| · max over f of min over n of (1 − f·n) / 2, where f are the normals of the
//! triangles of u and n those of its triangles that have v as well: how far u goes, times how sharply the surface
//! bends away from where it goes. Where we depart from the article:
//! - borders and seams are lines with a bend of their own, and leaving them counts as the sharpest bend;
//! - triangles without area have no normal, and are left out of the formula;
//! - a collapse that would change the topology, or turn a triangle over, is refused, and the next best taken.

use std::ops::ControlFlow;

use glam::DVec3;

use super::link::others;
use super::queue::Queue;
use super::steps::{Steps, step_by_step};
use super::workpiece::Workpiece;
use super::{Progress, Simplified, Simplifier, SimplifyError, Task, Topology};

/// Half-edge collapses by S. Melax's rule: quick to judge, and vertices are some of the old ones, attributes and all.
/// Weights make what they lie on move later; they have no part in the error.
///
/// The rule sees the surface as it is now, not as it was, so errors add up: take the quadric error for few triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Melax {
    /// Whether holes may close, and the like.
    pub topology: Topology,
    /// Least cosine of the angle by which one collapse may turn a triangle, in [0, 1].
    pub least_turn: f32,
}

impl Default for Melax {
    fn default() -> Self {
        Self { topology: Topology::Preserved, least_turn: 0.2 }
    }
}

/// A vertex in more triangles stays until they are fewer: what a collapse costs takes the square of their number.
const LARGEST_FAN: usize = 256;

impl Simplifier for Melax {
    fn simplify(
        &self,
        task: &Task,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Simplified, SimplifyError> {
        step_by_step(task, progress, |piece| Collapses::new(self, piece))
    }
}

/// Where a vertex goes, and what that costs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Choice {
    cost: f32,
    to: u32,
}

impl Choice {
    const NONE: Self = Self { cost: f32::INFINITY, to: u32::MAX };

    /// Cheaper first, ties by the lower target.
    fn key(self) -> (u32, u32) {
        (self.cost.to_bits(), self.to)
    }
}

/// The choices of all vertices.
struct Collapses<'a> {
    method: &'a Melax,
    queue: Queue,
    choices: Vec<Choice>,
    /// Whether something cheaper than the choice, or all there was, has been refused.
    settled: Vec<bool>,
    /// Unit normals, per triangle; zero for those without area.
    normals: Vec<DVec3>,
    /// Per vertex, how far what was collapsed into it is off, in places.
    drifts: Vec<f64>,
    /// Largest of all drifts.
    error: f64,
    /// What a vertex may go to, and the neighbours of a collapse.
    targets: Vec<u32>,
    ring: Vec<u32>,
}

impl Steps for Collapses<'_> {
    /// Collapses the vertex that costs least, if it may; if not, has it choose again.
    fn step(&mut self, piece: &mut Workpiece) -> ControlFlow<()> {
        let Some((cost, vertex)) = self.queue.pop() else { return ControlFlow::Break(()) };
        let choice = self.choices[vertex as usize];
        if choice.cost.to_bits() != cost.to_bits() || choice == Choice::NONE {
            return ControlFlow::Continue(());
        }
        let drift = self.drift(piece, vertex, choice.to);
        let is_in_reach = piece.in_units(drift) <= piece.task.target.error;
        if is_in_reach && self.may_collapse(piece, vertex, choice.to) {
            self.collapse(piece, vertex, choice.to, drift);
        } else {
            self.choose(piece, vertex, Some(choice));
        }
        ControlFlow::Continue(())
    }

    fn error(&self) -> f64 {
        self.error
    }
}

impl<'a> Collapses<'a> {
    fn new(method: &'a Melax, piece: &Workpiece) -> Self {
        let count = piece.positions.len();
        let mut collapses = Self {
            method,
            queue: Queue::new(),
            choices: vec![Choice::NONE; count],
            settled: vec![false; count],
            normals: (0..piece.triangles.len() as u32).map(|t| normal(piece.places(t))).collect(),
            drifts: vec![0.0; count],
            error: 0.0,
            targets: Vec::new(),
            ring: Vec::new(),
        };
        for vertex in piece.vertices() {
            collapses.choose(piece, vertex, None);
        }
        collapses
    }

    /// Chooses the cheapest collapse of a vertex that is dearer than `above`, and puts it into the queue.
    fn choose(&mut self, piece: &Workpiece, vertex: u32, above: Option<Choice>) {
        self.settled[vertex as usize] = above.is_some();
        self.choices[vertex as usize] = self.cheapest(piece, vertex, above);
        let Choice { cost, to } = self.choices[vertex as usize];
        if to != u32::MAX {
            self.queue.push(cost, vertex);
        }
    }

    fn cheapest(&mut self, piece: &Workpiece, vertex: u32, above: Option<Choice>) -> Choice {
        let fan = piece.fans.of(vertex);
        if piece.is_locked(vertex) || fan.len() > LARGEST_FAN {
            return Choice::NONE;
        }
        let mut targets = std::mem::take(&mut self.targets);
        piece.neighbours(vertex, &mut targets);
        let weight = fan.iter().map(|&t| piece.weight(t)).fold(0.0, f64::max);
        let line = Line::through(piece, vertex, &targets);
        let choice = |&to: &u32| {
            let away = piece.place(vertex).distance(piece.place(to));
            let bend = self.bend(piece, vertex, to).max(line.bend(piece, vertex, to));
            Choice { cost: (weight * away * bend).min(f64::from(f32::MAX)) as f32, to }
        };
        let is_dearer = |c: &Choice| above.is_none_or(|above| c.key() > above.key());
        let choices = targets.iter().map(choice).filter(is_dearer);
        let cheapest = choices.min_by_key(|c| c.key()).unwrap_or(Choice::NONE);
        self.targets = targets;
        cheapest
    }

    /// How sharply the surface around a vertex bends away from the triangles between it and a neighbour, in [0, 1]. Of
    /// more than two triangles there the first two count.
    fn bend(&self, piece: &Workpiece, vertex: u32, to: u32) -> f64 {
        let with_area = |&n: &DVec3| n != DVec3::ZERO;
        let mut between = piece.at_edge(vertex, to).map(|t| self.normals[t as usize]).filter(with_area);
        let Some(first) = between.next() else { return 1.0 };
        let second = between.next().unwrap_or(first);
        let around = piece.fans.of(vertex).iter().map(|&t| self.normals[t as usize]).filter(with_area);
        around.map(|f| (1.0 - f.dot(first).max(f.dot(second))) / 2.0).fold(0.0, f64::max)
    }

    /// How far the surface is off, in places, once a vertex is collapsed: how far it was off so far, and the distance
    /// of the vertex from the triangles that it bends away from most.
    fn drift(&self, piece: &Workpiece, vertex: u32, to: u32) -> f64 {
        let bend = self.bend(piece, vertex, to);
        let sine = if bend < 0.5 { 2.0 * (bend * (1.0 - bend)).sqrt() } else { 1.0 };
        let off = sine * piece.place(vertex).distance(piece.place(to));
        self.drifts[to as usize].max(self.drifts[vertex as usize] + off)
    }

    fn may_collapse(&self, piece: &mut Workpiece, vertex: u32, to: u32) -> bool {
        let keeps_topology = |piece: &mut Workpiece| {
            let at_border = piece.is_at_border(vertex) && piece.is_at_border(to);
            piece.keeps_topology(vertex, to, at_border)
        };
        self.turns_nothing(piece, vertex, to)
            && (self.method.topology == Topology::Free || keeps_topology(piece))
    }

    /// Whether the triangles of a vertex that stay keep their direction.
    fn turns_nothing(&self, piece: &Workpiece, vertex: u32, to: u32) -> bool {
        let least = f64::from(self.method.least_turn.clamp(0.0, 1.0));
        let place = piece.place(to);
        let staying = piece.fans.of(vertex).iter().filter(|&&t| !piece.triangles[t as usize].contains(&to));
        let turn = |&t: &u32| {
            let [p, q] = others(piece.triangles[t as usize], vertex).map(|v| piece.place(v));
            self.normals[t as usize].dot(normal([place, p, q]))
        };
        let had_area = |t: &&u32| self.normals[**t as usize] != DVec3::ZERO;
        let mut turns = staying.filter(had_area).map(turn);
        turns.all(|turn| turn > 0.0 && turn >= least)
    }

    fn collapse(&mut self, piece: &mut Workpiece, vertex: u32, to: u32, drift: f64) {
        let mut ring = std::mem::take(&mut self.ring);
        piece.neighbours(vertex, &mut ring);
        piece.merge(vertex, to);
        self.choices[vertex as usize] = Choice::NONE;
        self.drifts[to as usize] = drift;
        self.error = self.error.max(drift);
        for &triangle in piece.fans.of(to) {
            self.normals[triangle as usize] = normal(piece.places(triangle));
        }
        for &neighbour in &ring {
            self.choose(piece, neighbour, None);
        }
        for &neighbour in &ring {
            self.choose_settled(piece, neighbour);
        }
        self.ring = ring;
    }

    /// Has those neighbours of a vertex choose again that were refused something, which may now be allowed.
    fn choose_settled(&mut self, piece: &Workpiece, vertex: u32) {
        if piece.fans.of(vertex).len() > LARGEST_FAN {
            return;
        }
        for i in 0..piece.fans.of(vertex).len() {
            let triangle = piece.fans.of(vertex)[i];
            for neighbour in others(piece.triangles[triangle as usize], vertex) {
                if self.settled[neighbour as usize] {
                    self.choose(piece, neighbour, None);
                }
            }
        }
    }
}

/// How a vertex lies on borders and seams.
enum Line {
    /// On none.
    Off,
    /// On one that comes from one neighbour and goes on to the other.
    Between([u32; 2]),
    /// Where one ends, or several meet.
    Corner,
}

impl Line {
    fn through(piece: &Workpiece, vertex: u32, neighbours: &[u32]) -> Self {
        let mut creases = neighbours.iter().copied().filter(|&n| piece.is_crease(vertex, n));
        match (creases.next(), creases.next(), creases.next()) {
            (None, ..) => Self::Off,
            (Some(a), Some(b), None) => Self::Between([a, b]),
            _ => Self::Corner,
        }
    }

    /// How sharply the line bends away from where its vertex goes, as (1 − cos) / 2; more than any bend for a vertex
    /// that leaves it.
    fn bend(&self, piece: &Workpiece, vertex: u32, to: u32) -> f64 {
        match *self {
            Self::Off => 0.0,
            Self::Between([a, b]) if to == a || to == b => {
                let [a, b] = [a, b].map(|n| (piece.place(n) - piece.place(vertex)).normalize_or_zero());
                (1.0 + a.dot(b)) / 2.0
            }
            _ => 2.0,
        }
    }
}

/// The unit normal of a triangle; zero if it has no area.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}
