//! Cell collapse: the cells of an octree become points, one after another, in the order of their error.
//!
//! D. Luebke and others, "Level of Detail for 3D Graphics", 2003, chapter 2, names the operation; D. Luebke, C.
//! Erikson, "View-dependent simplification of arbitrary polygonal environments", 1997, collapses the octree's cells
//! bottom-up. All vertices of a cell become one, connected or not; a cell's turn can come once those within it have
//! collapsed. What is ours:
//! - the order is that of the quadric error of the cell's vertex, no less than that of the cells within;
//! - triangles may turn over: cells that would make them do so were held back at first, and the rest got worse by more.

use std::ops::ControlFlow;

use glam::DVec3;

use super::cluster::octree::{DEPTH, code, corner_of, shared_depth};
use super::planes::Planes;
use super::queue::Queue;
use super::star::Star;
use super::steps::{Steps, step_by_step};
use super::workpiece::Workpiece;
use super::{Progress, Simplified, Simplifier, SimplifyError, Task, Topology};

/// Octree cells that become points in the order of their quadric error: takes anything, joins parts that are close, and
/// comes within a few triangles of the target where clusters of a grid do not. For rubble, foliage and other crowds of
/// small parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellCollapse {
    /// Whether parts may be joined, holes may close, and the like. [`Topology::Preserved`] refuses most cells that are
    /// larger than the details in them.
    pub topology: Topology,
}

impl Default for CellCollapse {
    fn default() -> Self {
        Self { topology: Topology::Free }
    }
}

impl Simplifier for CellCollapse {
    fn simplify(
        &self,
        task: &Task,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Simplified, SimplifyError> {
        step_by_step(task, progress, |piece| Cells::new(self, piece))
    }
}

/// A cell of several vertices.
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// Its vertices, a range of all in the order of the octree.
    first: u32,
    end: u32,
    /// The smallest larger cell of more vertices; [`NO_CELL`] for the largest.
    parent: u32,
    /// How many cells within are still to collapse.
    waits_for: u32,
    /// How many times the octree's box was halved.
    depth: u32,
    /// What its collapse costs as of now, no less than those within.
    cost: f32,
    /// Largest error of a cell within.
    error: f64,
    /// Where its vertices become one.
    place: DVec3,
}

/// The parent of the largest cell.
const NO_CELL: u32 = u32::MAX;

/// The cells on their way up.
struct Cells<'a> {
    method: &'a CellCollapse,
    cells: Vec<Cell>,
    queue: Queue,
    /// The vertices that may move, in the order of the octree, and their places in it.
    order: Vec<u32>,
    codes: Vec<u64>,
    /// The octree's box, a cube.
    corner: DVec3,
    side: f64,
    /// Per vertex.
    planes: Vec<Planes>,
    error: f64,
}

impl Steps for Cells<'_> {
    /// Collapses the cell that costs least.
    fn step(&mut self, piece: &mut Workpiece) -> ControlFlow<()> {
        let Some((_, cell)) = self.queue.pop() else { return ControlFlow::Break(()) };
        let error = self.cells[cell as usize].error;
        let left = self.left(piece, cell);
        let is_kept = || self.method.topology == Topology::Free || Star::new(piece, &left).is_disc(piece);
        if piece.in_units(error) <= piece.task.target.error && (left.len() < 2 || is_kept()) {
            self.collapse(piece, cell, &left);
        }
        ControlFlow::Continue(())
    }

    fn error(&self) -> f64 {
        self.error
    }
}

impl<'a> Cells<'a> {
    fn new(method: &'a CellCollapse, piece: &Workpiece) -> Self {
        let free: Vec<u32> = piece.vertices().filter(|&v| !piece.is_locked(v)).collect();
        let (low, high) = free.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &v| {
            (low.min(piece.place(v)), high.max(piece.place(v)))
        });
        let side = (high - low).max_element().max(f64::MIN_POSITIVE);
        let mut keys: Vec<(u64, u32)> =
            free.into_iter().map(|v| (code((piece.place(v) - low) / side), v)).collect();
        keys.sort_unstable();
        let mut cells = Self {
            method,
            cells: Vec::new(),
            queue: Queue::new(),
            order: keys.iter().map(|key| key.1).collect(),
            codes: keys.iter().map(|key| key.0).collect(),
            corner: low,
            side,
            planes: Planes::of_vertices(piece),
            error: 0.0,
        };
        if cells.order.len() > 1 {
            cells.divide(0, cells.order.len() as u32, NO_CELL);
        }
        for cell in 0..cells.cells.len() as u32 {
            cells.offer(piece, cell);
        }
        cells
    }

    /// Makes a cell of vertices that are two at least, and cells within it.
    fn divide(&mut self, first: u32, end: u32, parent: u32) {
        let cell = self.cells.len() as u32;
        let codes = |at: u32| self.codes[at as usize];
        let depth = shared_depth(codes(first), codes(end - 1)) as u32;
        let place = DVec3::ZERO;
        let new = Cell { first, end, parent, waits_for: 0, depth, cost: 0.0, error: 0.0, place };
        self.cells.push(new);
        let mut at = first;
        while at < end && depth < DEPTH {
            let eighth = octant(self.codes[at as usize], depth);
            let inside = &self.codes[at as usize..end as usize];
            let next = at + inside.partition_point(|&c| octant(c, depth) == eighth) as u32;
            if next - at > 1 {
                self.cells[cell as usize].waits_for += 1;
                self.divide(at, next, cell);
            }
            at = next;
        }
    }

    /// Puts a cell into the queue if those within it have collapsed.
    fn offer(&mut self, piece: &Workpiece, cell: u32) {
        let Cell { first, waits_for, depth, .. } = self.cells[cell as usize];
        if waits_for > 0 {
            return;
        }
        let left = self.left(piece, cell);
        let sum = left.iter().fold(Planes::NONE, |sum, &v| sum + self.planes[v as usize]);
        let mean = left.iter().map(|&v| piece.place(v)).sum::<DVec3>() / left.len().max(1) as f64;
        let size = (-f64::from(depth)).exp2() * self.side;
        let corner = corner_of(self.codes[first as usize], depth as usize) * self.side + self.corner;
        let place = sum.least(mean).clamp(corner, corner + size);
        let cell_of = &mut self.cells[cell as usize];
        cell_of.place = place;
        cell_of.error = cell_of.error.max(sum.distance_at(place));
        let cost = sum.weight().sqrt() * cell_of.error.hypot(SIZE * size);
        cell_of.cost = cell_of.cost.max(cost.min(f64::from(f32::MAX)) as f32);
        self.queue.push(cell_of.cost, cell);
    }

    /// The vertices of a cell that triangles are left of.
    fn left(&self, piece: &Workpiece, cell: u32) -> Vec<u32> {
        let Cell { first, end, .. } = self.cells[cell as usize];
        let members = self.order[first as usize..end as usize].iter().copied();
        members.filter(|&v| !piece.fans.of(v).is_empty()).collect()
    }

    /// Merges vertices into the first, two by two, so that many cost no square of their number.
    fn merge(&mut self, piece: &mut Workpiece, vertices: &[u32]) {
        let mut step = 1;
        while step < vertices.len() {
            for pair in vertices.chunks(2 * step).filter(|pair| pair.len() > step) {
                let (kept, gone) = (pair[0], pair[step]);
                piece.merge(gone, kept);
                let planes = self.planes[gone as usize];
                self.planes[kept as usize] += planes;
            }
            step *= 2;
        }
    }

    /// Merges what is left of a cell's vertices into the first, and offers the cell around it.
    fn collapse(&mut self, piece: &mut Workpiece, cell: u32, left: &[u32]) {
        let Cell { parent, place, error, cost, .. } = self.cells[cell as usize];
        if let Some(&kept) = left.first() {
            self.merge(piece, left);
            piece.move_to(kept, piece.position_at(place), kept);
            self.error = self.error.max(error);
        }
        if parent != NO_CELL {
            let around = &mut self.cells[parent as usize];
            around.waits_for -= 1;
            around.error = around.error.max(error);
            around.cost = around.cost.max(cost);
            self.offer(piece, parent);
        }
    }
}

/// How much of a cell's side counts as error: enough that what is flat collapses in small cells before large ones.
const SIZE: f64 = 0.01;

/// Which eighth of a cell at some depth a place is in.
fn octant(code: u64, depth: u32) -> u64 {
    code >> (3 * (DEPTH - 1 - depth)) & 7
}
