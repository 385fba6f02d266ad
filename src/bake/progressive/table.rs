//! From a progressive mesh to what the runtime reads.

use super::{Cursor, Progressive};
use crate::bake::chain::{Accuracy, BakeError, Chain};
use crate::bake::deviation;
use crate::bake::simplify::Target;
use crate::bake::{Mesh, MeshError};
use crate::table::{LodTable, MAX_LEVELS};

impl Progressive {
    /// The LOD table of so many levels, at least 1 and at most [`MAX_LEVELS`]: the runtime chooses among them, and
    /// [`Progressive::extract`] or a [`Cursor`] makes the one that it chose, by its number of triangles. The
    /// finest has all splits, the coarsest none, and the triangles of those between shrink by the same factor. There are fewer levels where
    /// fewer numbers of triangles are to be had.
    ///
    /// Every level is measured, as those of a [`Chain`] are.
    ///
    /// # Errors
    /// A record that is none; levels that cannot be measured or told in single precision.
    pub fn table(
        &self,
        levels: usize,
        accuracy: Accuracy,
        measure: &deviation::Options,
    ) -> Result<LodTable, BakeError> {
        let chain = Chain::of_levels(self.levels(levels)?, measure)?;
        Ok(chain.table(accuracy)?)
    }

    /// The levels of a table, finest first.
    fn levels(&self, count: usize) -> Result<Vec<Mesh>, MeshError> {
        let steps = count.clamp(1, MAX_LEVELS) - 1;
        let (full, base) = (self.full().triangles as f64, self.base().triangles as f64);
        let mut cursor = Cursor::new(self);
        let mut levels: Vec<Mesh> = Vec::with_capacity(steps + 1);
        for step in (0..=steps).rev() {
            let share = if steps > 0 { step as f64 / steps as f64 } else { 0.0 };
            let triangles = (full * (base / full).powf(share)).round() as usize;
            cursor.go_to(self, Target::triangles(triangles))?;
            if levels.last().is_none_or(|last| last.triangles.len() < cursor.triangles().len()) {
                levels.push(cursor.mesh(self));
            }
        }
        levels.reverse();
        Ok(levels)
    }
}
