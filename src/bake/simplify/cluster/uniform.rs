//! Clusters of a uniform grid.
//!
//! J. Rossignac, P. Borrel, "Multi-resolution 3D approximations for rendering complex scenes", 1993. The vertices of a
//! cell become one; triangles with two corners in a cell go. Where we depart from the paper:
//! - the vertex of a cell is where the error to the planes of its triangles is least (P. Lindstrom, "Out-of-core
//!   simplification of large polygonal models", 2000), or the heaviest by the rule of K.-L. Low and T.-S. Tan, "Model
//!   simplification using vertex-clustering", 1997;
//! - triangles that become edges or points are not kept to be drawn as such;
//! - how fine the grid is follows from the target.

use std::ops::ControlFlow;

use glam::{DVec3, U64Vec3};

use super::cloud::{Cloud, Clusters, is_apart};
use crate::bake::simplify::fans::Fans;
use crate::bake::simplify::link::others;
use crate::bake::simplify::planes::Planes;
use crate::bake::simplify::{Progress, Simplified, Simplifier, SimplifyError, Task};
use crate::bake::weld::{Classes, classes};

/// Most cells along the longest side of a grid, so that a cell fits 64 bits.
const FINEST: u64 = 1 << 20;

/// How many edges of a vertex are compared with each other to see how sharp it is.
const MOST_EDGES: usize = 64;

/// The vertices of a grid's cell become one: the fastest method and the one that takes anything, at several times the
/// error of others. Joins what is close, so parts, holes and thin walls may go.
///
/// A target of triangles is met by the finest grid that has no more than those: within a few percent where there are
/// thousands, and up to a half below where there are tens. An error is the largest diagonal of a cell, and bounds how far
/// a vertex moves. Weights count in where the vertex of a cell is, not in how large cells are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cluster {
    /// Where the vertex of a cell is.
    pub representative: Representative,
}

/// Where the vertex of a cell is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Representative {
    /// Where the squared distance to the planes of its triangles is least, within the cell.
    #[default]
    Quadric,
    /// At the heaviest of its vertices: the one with long edges that is sharp.
    Heaviest,
}

impl Simplifier for Cluster {
    fn simplify(
        &self,
        task: &Task,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Simplified, SimplifyError> {
        task.check()?;
        let grid = Grid { cloud: Cloud::new(task) };
        let found = grid.search(progress);
        let clusters = match found {
            ControlFlow::Continue(Some(cells)) => grid.clusters(cells, self.representative),
            _ => grid.cloud.singles(),
        };
        // Rounding of positions may exceed a diagonal of hardly any length.
        let error = grid.cloud.farthest(&clusters).min(task.target.error.max(0.0));
        Ok(grid.cloud.finish(&clusters, error, found.is_break()))
    }
}

/// Grids over a box, each of so many cells along the longest side.
struct Grid<'a> {
    cloud: Cloud<'a>,
}

impl Grid<'_> {
    /// The finest grid that meets the target of triangles, or else the coarsest that the error allows; `None` where that
    /// is finer than any grid. Doubles, then halves the interval: some 2 log n looks at all triangles.
    fn search(&self, progress: &mut dyn FnMut(Progress) -> ControlFlow<()>) -> ControlFlow<(), Option<u64>> {
        let target = self.cloud.task.target.triangles;
        let Some(coarsest) = self.coarsest().filter(|_| self.cloud.triangles.len() > target) else {
            return ControlFlow::Continue(None);
        };
        let mut meets = |cells: u64| {
            let triangles = self.count(cells);
            progress(self.cloud.progress(triangles))?;
            ControlFlow::Continue(triangles <= target)
        };
        if !meets(coarsest)? {
            return ControlFlow::Continue(Some(coarsest));
        }
        let (mut good, mut bad) = (coarsest, 2 * coarsest);
        while bad < FINEST && meets(bad)? {
            (good, bad) = (bad, 2 * bad);
        }
        bad = bad.min(FINEST);
        while good + 1 < bad {
            let middle = good.midpoint(bad);
            if meets(middle)? { good = middle } else { bad = middle }
        }
        ControlFlow::Continue(Some(good))
    }

    /// The fewest cells whose diagonal is no more than the error.
    fn coarsest(&self) -> Option<u64> {
        let diagonal = 3f64.sqrt() * self.cloud.in_units(1.0);
        let cells = (diagonal / f64::from(self.cloud.task.target.error)).ceil();
        (0.0..=FINEST as f64).contains(&cells).then_some((cells as u64).max(1))
    }

    /// How many triangles have their corners in three cells.
    fn count(&self, cells: u64) -> usize {
        let keys = self.keys(cells);
        self.cloud.triangles.iter().filter(|t| is_apart(t.map(|v| keys[v as usize]))).count()
    }

    /// Per vertex, its cell, by number; one of its own where it is not free.
    fn keys(&self, cells: u64) -> Vec<u64> {
        let count = self.cloud.task.mesh.positions.len() as u32;
        let key = |vertex: u32| {
            let U64Vec3 { x, y, z } = self.cell(vertex, cells);
            let alone = 1 << 63 | u64::from(vertex);
            if self.cloud.is_free(vertex) { x | y << 20 | z << 40 } else { alone }
        };
        (0..count).map(key).collect()
    }

    fn cell(&self, vertex: u32, cells: u64) -> U64Vec3 {
        let place = (self.cloud.place(vertex) * cells as f64).max(DVec3::ZERO);
        place.as_u64vec3().min(U64Vec3::splat(cells - 1))
    }

    fn clusters(&self, cells: u64, representative: Representative) -> Clusters {
        let keys = self.keys(cells);
        let classes = classes(keys.iter().map(|&key| [(key >> 32) as u32, key as u32, 0]));
        match representative {
            Representative::Quadric => self.at_least_error(classes, cells),
            Representative::Heaviest => self.at_heaviest(classes),
        }
    }

    /// Puts every cluster where its error is least within its cell; one of a single vertex stays there.
    fn at_least_error(&self, Classes { of, firsts }: Classes, cells: u64) -> Clusters {
        let mut planes = vec![Planes::NONE; firsts.len()];
        let mut sums = vec![(DVec3::ZERO, 0u32); firsts.len()];
        for (t, corners) in self.cloud.triangles.iter().enumerate() {
            let plane = self.cloud.plane_of(t);
            corners.iter().for_each(|&v| planes[of[v as usize] as usize] += plane);
        }
        for vertex in 0..of.len() as u32 {
            let (sum, count) = &mut sums[of[vertex as usize] as usize];
            *sum += self.cloud.place(vertex);
            *count += 1;
        }
        let position = |cluster: usize| {
            let (first, (sum, count)) = (firsts[cluster], sums[cluster]);
            if count <= 1 {
                return self.cloud.task.mesh.positions[first as usize];
            }
            let low = self.cell(first, cells).as_dvec3() / cells as f64;
            let place = planes[cluster].least(sum / f64::from(count));
            self.cloud.position_at(place.clamp(low, low + 1.0 / cells as f64))
        };
        Clusters { positions: (0..firsts.len()).map(position).collect(), of }
    }

    /// Puts every cluster at the heaviest of its vertices, ties by the lower index.
    fn at_heaviest(&self, Classes { of, firsts }: Classes) -> Clusters {
        let fans = Fans::new(of.len(), &self.cloud.triangles);
        let mut heaviest: Vec<(f64, u32)> = firsts.into_iter().map(|first| (-1.0, first)).collect();
        for vertex in 0..of.len() as u32 {
            let weight = self.weight(vertex, &fans);
            let best = &mut heaviest[of[vertex as usize] as usize];
            *best = if weight > best.0 { (weight, vertex) } else { *best };
        }
        let position = |(_, vertex): (f64, u32)| self.cloud.task.mesh.positions[vertex as usize];
        Clusters { of, positions: heaviest.into_iter().map(position).collect() }
    }

    /// How much a vertex matters: the longest of its edges, times the cosine of half the widest angle between two of
    /// them, times the largest weight of its triangles. −1 for one that has none.
    fn weight(&self, vertex: u32, fans: &Fans) -> f64 {
        let mut ring: Vec<DVec3> = Vec::new();
        let mut weight: f64 = -1.0;
        for &triangle in fans.of(vertex) {
            let ends = others(self.cloud.triangles[triangle as usize], vertex);
            ring.extend(ends.map(|end| self.cloud.place(end) - self.cloud.place(vertex)));
            weight = weight.max(self.cloud.weight_of(triangle as usize));
        }
        let longest = ring.iter().map(|edge| edge.length()).fold(0.0, f64::max);
        let directions = ring.iter().take(MOST_EDGES).map(|edge| edge.normalize_or_zero());
        let directions: Vec<DVec3> = directions.collect();
        let widest = directions.iter().map(|a| directions.iter().map(|b| a.dot(*b)).fold(1.0, f64::min));
        let half = ((1.0 + widest.fold(1.0, f64::min)) / 2.0).max(0.0).sqrt();
        weight * longest * half
    }
}
