//! The error of a prefix: a bound on how far it is from the original.
//!
//! The Hausdorff distance obeys the triangle inequality: a prefix is no farther from the original than another prefix
//! is, and the two from each other. So some prefixes, the *marks*, are measured ([`deviation`]), and each one between two
//! marks has two bounds: from the finer mark on, and from the coarser mark back. How far two prefixes are apart is kept
//! track of triangle by triangle: a contraction takes no point of the triangles around its edge farther than
//! `bound.rs` says, in either direction, so what those triangles become is no farther off than the farthest of
//! them was, and that. The largest of these, over all triangles, bounds how far apart the prefixes are, since from any
//! point of one a chain of such steps leads to a point of the other.
//!
//! The error that is kept is the lesser bound of the two, and at least that of every finer prefix.

use super::build::Options;
use super::split::is_proper;
use super::trail::Walked;
use crate::bake::chain::BakeError;
use crate::bake::deviation::{self, Deviation, DeviationError, Ruler};
use crate::bake::simplify::Seen;
use crate::bake::{Mesh, Surface};

/// Measured prefixes.
pub(super) struct Marks<'a> {
    options: &'a deviation::Options,
    ruler: Option<Ruler>,
    /// By what the triangles shrink from one to the next.
    shrinks: f64,
    /// How many triangles the next one has at most.
    next: f64,
    /// After how many contractions, and how far it is from the original at most.
    measured: Vec<(usize, f64)>,
    failed: Option<DeviationError>,
}

impl<'a> Marks<'a> {
    /// The first one is what simplification begins with.
    pub(super) fn new(mesh: &Mesh, options: &'a Options) -> Result<Self, BakeError> {
        let surface = mesh.surface();
        let whole: Vec<[u32; 3]> = surface.triangles.iter().copied().filter(|&t| is_proper(t)).collect();
        if whole.is_empty() {
            return Err(BakeError::NoTriangles);
        }
        let leaves_out = whole.len() < surface.triangles.len();
        let measures = options.marks_per_halving > 0;
        let shrinks = (-1.0 / f64::from(options.marks_per_halving)).exp2();
        let mut marks = Self {
            options: &options.measure,
            ruler: if leaves_out || measures { Some(Ruler::new(&surface)?) } else { None },
            shrinks,
            next: if measures { whole.len() as f64 * shrinks } else { -1.0 },
            measured: Vec::new(),
            failed: None,
        };
        let start = Surface { triangles: whole, ..surface };
        marks.measured.push((0, if leaves_out { marks.measure(&start)? } else { 0.0 }));
        Ok(marks)
    }

    fn measure(&self, surface: &Surface) -> Result<f64, DeviationError> {
        let deviation = self.ruler.as_ref().map(|ruler| ruler.deviation(surface, self.options));
        deviation
            .transpose()
            .map(|deviation: Option<Deviation>| deviation.map_or(f64::INFINITY, |d| d.hausdorff))
    }

    /// Measures the mesh after so many contractions if it is time to.
    pub(super) fn follow(&mut self, seen: &Seen, contractions: usize) {
        if seen.live() as f64 > self.next || self.failed.is_some() {
            return;
        }
        self.next = seen.live() as f64 * self.shrinks;
        let vertices = 0..seen.vertices().len() as u32;
        let triangles = 0..seen.old_triangles().len() as u32;
        self.add(
            contractions,
            &Surface {
                positions: vertices.map(|vertex| seen.position(vertex)).collect(),
                triangles: triangles.filter_map(|triangle| seen.triangle(triangle)).collect(),
            },
        );
    }

    fn add(&mut self, contractions: usize, surface: &Surface) {
        match self.measure(surface) {
            Ok(bound) => self.measured.push((contractions, bound)),
            Err(error) => self.failed = Some(error),
        }
    }

    /// The error after each number of contractions, from none to all.
    pub(super) fn errors(mut self, walked: &Walked) -> Result<Vec<f64>, BakeError> {
        let all = walked.events.len();
        if self.next >= 0.0 && self.measured.last().is_some_and(|&(last, _)| last < all) {
            self.add(all, &walked.surface());
        }
        if let Some(error) = self.failed {
            return Err(error.into());
        }
        let (there, back) = (from_finer(walked, &self.measured), from_coarser(walked, &self.measured));
        let so_far = |most: &mut f64, (there, back): (f64, f64)| {
            *most = most.max(there.min(back));
            Some(*most)
        };
        Ok(there.into_iter().zip(back).scan(0.0, so_far).collect())
    }
}

/// How far the triangles of a prefix are from a mark.
struct Spread {
    /// What the mark is off.
    start: f64,
    of_triangle: Vec<f64>,
    most: f64,
}

impl Spread {
    fn new(triangles: usize) -> Self {
        Self { start: f64::INFINITY, of_triangle: vec![0.0; triangles], most: 0.0 }
    }

    /// Begins anew at a mark.
    fn begin(&mut self, start: f64) {
        self.of_triangle.fill(0.0);
        (self.start, self.most) = (start, 0.0);
    }

    /// Follows a contraction, which is no farther forth than back.
    fn follow(&mut self, walked: &Walked, event: usize) {
        let triangles = || walked.star(event).map(|t| t as usize);
        let far = triangles().map(|t| self.of_triangle[t]).fold(0.0, f64::max) + walked.events[event].moved;
        triangles().for_each(|t| self.of_triangle[t] = far);
        self.most = self.most.max(far);
    }

    fn bound(&self) -> f64 {
        self.start + self.most
    }
}

/// The bounds of all prefixes from the marks that are finer.
fn from_finer(walked: &Walked, marks: &[(usize, f64)]) -> Vec<f64> {
    let mut spread = Spread::new(walked.triangles.len());
    let mut marks = marks.iter().peekable();
    let mut bounds = Vec::with_capacity(walked.events.len() + 1);
    for event in 0..=walked.events.len() {
        if let Some(&(_, bound)) = marks.next_if(|mark| mark.0 == event) {
            spread.begin(bound);
        }
        bounds.push(spread.bound());
        if event < walked.events.len() {
            spread.follow(walked, event);
        }
    }
    bounds
}

/// The bounds of all prefixes from the marks that are coarser; infinite where there is none.
fn from_coarser(walked: &Walked, marks: &[(usize, f64)]) -> Vec<f64> {
    let mut spread = Spread::new(walked.triangles.len());
    let mut marks = marks.iter().rev().peekable();
    let mut bounds = vec![f64::INFINITY; walked.events.len() + 1];
    for event in (0..=walked.events.len()).rev() {
        if let Some(&(_, bound)) = marks.next_if(|mark| mark.0 == event) {
            spread.begin(bound);
        }
        bounds[event] = spread.bound();
        if event > 0 {
            spread.follow(walked, event - 1);
        }
    }
    bounds
}
