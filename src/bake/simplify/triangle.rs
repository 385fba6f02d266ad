//! Triangle contraction in the order of the quadric error.
//!
//! A triangle becomes a point, and with it the three at its sides go: B. Hamann, "A data reduction scheme for
//! triangulated surfaces", 1994; T. Gieng, B. Hamann, K. Joy, G. Schussman, I. Trotts, "Smooth hierarchical surface
//! triangulations", 1997. Where we depart from the papers:
//! - triangles go in the order of their quadric error (M. Garland, P. Heckbert, 1997), not of the curvature of a
//!   surface fitted to their corners; the point is where that error is least;
//! - borders are held by planes that stand upright on them;
//! - a contraction that would change the topology or turn a triangle over is refused.

use std::ops::ControlFlow;

use glam::DVec3;

use super::planes::Planes;
use super::queue::Queue;
use super::star::Star;
use super::steps::{Steps, step_by_step};
use super::workpiece::{GONE, Workpiece};
use super::{Progress, Simplified, Simplifier, SimplifyError, Task, Topology};

/// Triangle contraction by quadric error: four triangles a step, so some steps are bound to be worse than those of
/// edges. Take it for even meshes and to compare.
///
/// The target of triangles is met, or missed by up to three too few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleCollapse {
    /// Whether holes may close, and the like.
    pub topology: Topology,
    /// Least cosine of the angle by which one contraction may turn a triangle, in [0, 1].
    pub least_turn: f32,
}

impl Default for TriangleCollapse {
    fn default() -> Self {
        Self { topology: Topology::Preserved, least_turn: 0.2 }
    }
}

/// Triangles whose corners are in more than so many triangles wait until they are fewer.
const LARGEST_STAR: usize = 256;

/// How much of a triangle's size counts as error: enough that on what is flat the smaller go first.
const SIZE: f64 = 1e-5;

/// All triangles are looked at again while at least one in so many went since they were.
const WORTH_A_SWEEP: usize = 64;

impl Simplifier for TriangleCollapse {
    fn simplify(
        &self,
        task: &Task,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Simplified, SimplifyError> {
        step_by_step(task, progress, |piece| Contractions::new(self, piece))
    }
}

/// The contractions of all triangles.
struct Contractions<'a> {
    method: &'a TriangleCollapse,
    queue: Queue,
    /// Per triangle, what its contraction costs as of now.
    costs: Vec<f32>,
    /// Per vertex.
    planes: Vec<Planes>,
    /// Largest error so far, in places.
    error: f64,
    /// How many triangles were in the queue, and went since.
    swept: usize,
    since_sweep: usize,
}

impl Steps for Contractions<'_> {
    /// Contracts the triangle that costs least, if that may be.
    fn step(&mut self, piece: &mut Workpiece) -> ControlFlow<()> {
        let Some((cost, triangle)) = self.queue.pop() else {
            if self.since_sweep * WORTH_A_SWEEP <= self.swept {
                return ControlFlow::Break(());
            }
            self.sweep(piece);
            return ControlFlow::Continue(());
        };
        let corners = piece.triangles[triangle as usize];
        if corners != GONE && self.costs[triangle as usize].to_bits() == cost.to_bits() {
            self.try_contract(piece, corners);
        }
        ControlFlow::Continue(())
    }

    fn error(&self) -> f64 {
        self.error
    }
}

impl<'a> Contractions<'a> {
    fn new(method: &'a TriangleCollapse, piece: &Workpiece) -> Self {
        let mut contractions = Self {
            method,
            queue: Queue::new(),
            costs: vec![0.0; piece.triangles.len()],
            planes: Planes::of_vertices(piece),
            error: 0.0,
            swept: 0,
            since_sweep: 0,
        };
        contractions.sweep(piece);
        contractions
    }

    /// Puts all triangles into the queue.
    fn sweep(&mut self, piece: &Workpiece) {
        let left = (0..piece.triangles.len() as u32).filter(|&t| piece.triangles[t as usize] != GONE);
        let left: Vec<u32> = left.collect();
        left.iter().for_each(|&t| self.push(piece, t));
        (self.swept, self.since_sweep) = (left.len(), 0);
    }

    fn push(&mut self, piece: &Workpiece, triangle: u32) {
        let corners = piece.triangles[triangle as usize];
        let (sum, place) = self.sum(piece, corners);
        let spread: f64 = corners.iter().map(|&v| piece.place(v).distance_squared(place)).sum();
        let cost = sum.weight().sqrt() * sum.distance_at(place).hypot(SIZE * spread.sqrt());
        self.costs[triangle as usize] = cost.min(f64::from(f32::MAX)) as f32;
        self.queue.push(self.costs[triangle as usize], triangle);
    }

    /// The planes of three vertices together, and where they become one.
    fn sum(&self, piece: &Workpiece, corners: [u32; 3]) -> (Planes, DVec3) {
        let [a, b, c] = corners.map(|v| self.planes[v as usize]);
        let sum = a + b + c;
        let [p, q, r] = corners.map(|v| piece.place(v));
        let middle = (p + q + r) / 3.0;
        let reach = [p, q, r].iter().map(|at| at.distance(middle)).fold(0.0, f64::max);
        let least = sum.least(middle);
        let free = if least.distance(middle) <= 2.0 * reach { least } else { middle };
        let locked = corners.into_iter().find(|&v| piece.is_locked(v));
        (sum, locked.map_or(free, |v| piece.place(v)))
    }

    fn try_contract(&mut self, piece: &mut Workpiece, corners: [u32; 3]) {
        let (sum, place) = self.sum(piece, corners);
        let error = sum.distance_at(place);
        if piece.in_units(error) > piece.task.target.error || !self.may_contract(piece, corners, place) {
            return;
        }
        self.error = self.error.max(error);
        self.contract(piece, corners, place, sum);
    }

    fn may_contract(&self, piece: &Workpiece, corners: [u32; 3], place: DVec3) -> bool {
        let size: usize = corners.iter().map(|&v| piece.fans.of(v).len()).sum();
        if size > LARGEST_STAR || corners.iter().filter(|&&v| piece.is_locked(v)).count() > 1 {
            return false;
        }
        let star = Star::new(piece, &corners);
        star.turns_nothing(piece, place, self.method.least_turn)
            && (self.method.topology == Topology::Free || star.is_disc(piece))
    }

    /// Merges the corners into the locked one, or else the lowest.
    fn contract(&mut self, piece: &mut Workpiece, mut corners: [u32; 3], place: DVec3, sum: Planes) {
        corners.sort_unstable_by_key(|&v| (!piece.is_locked(v), v));
        let [kept, second, third] = corners;
        let before = piece.live();
        piece.merge(second, kept);
        piece.merge(third, kept);
        self.since_sweep += before - piece.live();
        if !piece.is_locked(kept) {
            piece.move_to(kept, piece.position_at(place), kept);
        }
        self.planes[kept as usize] = sum;
        for i in 0..piece.fans.of(kept).len() {
            self.push(piece, piece.fans.of(kept)[i]);
        }
    }
}
