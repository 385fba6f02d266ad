//! Where positions of the finer mesh end, as a number: a position of the coarser mesh, or a point that something
//! shrinks to.

use glam::{DVec3, Vec3};

use super::sets::Sets;
use crate::bake::Mesh;
use crate::bake::simplify::Simplified;

/// The end of every position of the finer mesh.
pub(super) struct Goals {
    /// Per position. Below [`Goals::kept`] a position of the coarser mesh, from there on a point of its own.
    pub(super) of: Vec<u32>,
    /// How many positions the coarser mesh has.
    pub(super) kept: u32,
    /// What is gone and hangs together goes to its middle, so that nothing of it keeps an area.
    points: Vec<Vec3>,
}

impl Goals {
    /// `None` where heirs are not those of these two meshes.
    pub(super) fn new(finer: &Mesh, coarser: &Mesh, heirs: &[u32]) -> Option<Self> {
        let kept = coarser.positions.len() as u32;
        let is_right = |&heir: &u32| heir < kept || heir == Simplified::GONE;
        let fits = heirs.len() == finer.positions.len() && heirs.iter().all(is_right);
        fits.then(|| {
            let mut goals = Self { of: heirs.to_vec(), kept, points: Vec::new() };
            goals.shrink(finer);
            goals
        })
    }

    /// Where a position of the finer mesh ends.
    pub(super) fn place(&self, position: usize, coarser: &Mesh) -> Vec3 {
        let goal = self.of[position];
        match goal.checked_sub(self.kept) {
            None => coarser.positions[goal as usize],
            Some(point) => self.points[point as usize],
        }
    }

    /// Whether a goal is a position of the coarser mesh.
    pub(super) fn is_kept(&self, goal: u32) -> bool {
        goal < self.kept
    }

    /// Gives a point to each set of positions that are gone and hang together by edges.
    fn shrink(&mut self, finer: &Mesh) {
        let gone: Vec<bool> = self.of.iter().map(|&goal| goal == Simplified::GONE).collect();
        let mut sets = Sets::new(gone.len());
        for triangle in 0..finer.triangles.len() {
            let [a, b, c] = finer.corners(triangle);
            let both = |&(a, b): &(u32, u32)| gone[a as usize] && gone[b as usize];
            [(a, b), (b, c), (c, a)].into_iter().filter(both).for_each(|(a, b)| sets.join(a, b));
        }
        let mut sums: Vec<(DVec3, f64)> = Vec::new();
        for vertex in (0..gone.len()).filter(|&v| gone[v]) {
            // The lowest member of a set comes first.
            let root = sets.root(vertex as u32) as usize;
            if root == vertex {
                self.of[vertex] = self.kept + sums.len() as u32;
                sums.push((DVec3::ZERO, 0.0));
            }
            self.of[vertex] = self.of[root];
            let (sum, count) = &mut sums[(self.of[root] - self.kept) as usize];
            *sum += finer.positions[vertex].as_dvec3();
            *count += 1.0;
        }
        self.points = sums.into_iter().map(|(sum, count)| (sum / count).as_vec3()).collect();
    }
}
