//! What a contraction means: where it goes, and what it costs.

use glam::DVec3;

use super::{Greedy, mark};
use crate::bake::simplify::quadric::form::{Form, Quadric};
use crate::bake::simplify::quadric::layer::Move;
use crate::bake::simplify::quadric::layers::Layers;
use crate::bake::simplify::quadric::patch::Patch;
use crate::bake::simplify::quadric::placement::{Placement, Spot};

/// What contracting two vertices means.
pub(super) struct Step {
    pub(super) way: Move,
    /// Where they go: the place of a position in single precision.
    pub(super) to: DVec3,
    /// The error of the shape, seen from there.
    pub(super) quadric: Quadric,
    /// What went into both ends.
    pub(super) patch: Patch,
    /// Mean squared distance to the planes contracted so far, scaled.
    pub(super) error: f64,
}

impl Greedy<'_> {
    /// What contracting two vertices means.
    pub(super) fn step(&self, kept: u32, gone: u32) -> Step {
        let edge = self.place(gone) - self.place(kept);
        let shape = self.shape(kept, gone, edge);
        let spot = self.spot(kept, gone, edge, &(shape + self.looks(kept, gone, edge)));
        let patch = self.patches[kept as usize].join(self.patches[gone as usize], edge);
        let place = spot.place + self.lift([kept, gone], patch.moved(spot.place), &shape, spot.place);
        let to = if place == DVec3::ZERO {
            self.place(kept)
        } else if place == edge {
            self.place(gone)
        } else {
            ((self.place(kept) + place) / self.scale).as_vec3().as_dvec3() * self.scale
        };
        let moved = to - self.place(kept);
        let area = f64::from(patch.area);
        let error = if area > 0.0 { shape.at(place).max(0.0) / area } else { 0.0 };
        let way = Move { kept, gone, edge, to: if to == self.place(gone) { edge } else { moved } };
        Step { way, to, quadric: shape.seen_from(moved).pack(), patch: patch.moved(moved), error }
    }

    /// The error of both ends of an edge, seen from the first.
    #[inline]
    fn sum(&self, a: u32, b: u32, edge: DVec3) -> Form {
        match self.layers {
            None => self.shape(a, b, edge),
            Some(_) => self.shape(a, b, edge) + self.looks(a, b, edge),
        }
    }

    /// The part of the error that is distance.
    #[inline]
    fn shape(&self, a: u32, b: u32, edge: DVec3) -> Form {
        self.quadrics[a as usize].form() + self.quadrics[b as usize].form().seen_from(-edge)
    }

    /// The part of the error that is attributes.
    fn looks(&self, a: u32, b: u32, edge: DVec3) -> Form {
        let error = |layers: &Layers| layers.error(self.around(), a, b, edge);
        self.layers.as_ref().map_or(Form::default(), error)
    }

    /// Whether a vertex must stay where it is.
    #[inline]
    pub(super) fn is_locked(&self, vertex: u32) -> bool {
        self.marks[vertex as usize] & mark::LOCKED != 0
    }

    /// Where the contraction of two vertices goes, seen from the first.
    #[inline]
    fn spot(&self, a: u32, b: u32, edge: DVec3, sum: &Form) -> Spot {
        let share = || self.patches[a as usize].share_of(self.patches[b as usize]);
        match (self.is_locked(a), self.is_locked(b)) {
            (false, false) => self.method.placement.spot(edge, share, sum),
            (true, _) => Spot::new(DVec3::ZERO, sum),
            (_, true) => Spot::new(edge, sum),
        }
    }

    /// How much further two vertices go than to where their error is least; not at all where they are held to more than the
    /// planes of a patch that is all around them.
    #[inline]
    fn lift(&self, ends: [u32; 2], patch: Patch, shape: &Form, place: DVec3) -> DVec3 {
        const HELD: u8 = mark::LOCKED | mark::BORDER | mark::SEAM;
        let are_held = ends.iter().any(|&v| self.marks[v as usize] & HELD != 0);
        if are_held || self.method.placement != Placement::Balanced {
            return DVec3::ZERO;
        }
        patch.lift(shape, place)
    }

    /// What contracting two vertices costs.
    #[inline]
    pub(super) fn cost(&self, a: u32, b: u32) -> f32 {
        let edge = self.place(b) - self.place(a);
        let sum = self.sum(a, b, edge);
        self.method.cost.of_edge(self.spot(a, b, edge, &sum).error, edge, &sum)
    }
}
