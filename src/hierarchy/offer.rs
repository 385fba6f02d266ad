//! A hierarchy as a table of levels.

use super::{Cut, Hierarchy};
use crate::table::{LevelRecord, LodTable, MAX_LEVELS, TableError};

/// So many vertices of a graphics card's buffer and so many indices, in bytes.
const BYTES: [u64; 2] = [12, 12];

impl Hierarchy {
    /// The hierarchy as a table: `levels` levels (2 at least, 254 at most) from the whole mesh to the base, their
    /// triangles in equal ratios as far as they are whole numbers.
    ///
    /// A level's error is that of the record's first operations down to so many triangles, whatever the view; its accuracy
    /// is 1 − error / radius, at least 0, as `bake::chain::table::Accuracy::Hausdorff` has it. Take that for all tables
    /// of a scene that a hierarchy is in. `bytes` is the index buffer and the positions of all nodes.
    ///
    /// # Errors
    /// Where there is no extent.
    pub fn table(&self, name: impl Into<String>, levels: usize) -> Result<LodTable, TableError> {
        let radius = self.bounds().radius;
        let record = |level: Stage| {
            let loss = if radius > 0.0 { level.error / radius } else { 0.0 };
            LevelRecord {
                vertices: level.vertices as u32,
                bytes: BYTES[0] * self.positions().len() as u64 + BYTES[1] * level.triangles as u64,
                error: Some(level.error),
                accuracy: (1.0 - loss).max(0.0),
                ..LevelRecord::new(level.triangles as u32, 0)
            }
        };
        LodTable::new(name, self.bounds(), self.stages(levels).into_iter().map(record).collect())
    }

    /// The record at equal ratios of triangles, the whole mesh first.
    fn stages(&self, levels: usize) -> Vec<Stage> {
        let (all, base) = (self.triangles(), self.base_triangles());
        let steps = levels.clamp(2, MAX_LEVELS) - 1;
        let ratio = (base.max(1) as f64 / all.max(1) as f64).powf(1.0 / steps as f64);
        let mut stage = Stage { triangles: all, vertices: self.leaves(), error: 0.0 };
        let mut stages = vec![stage];
        let mut wanted = all as f64 * ratio;
        for operation in &self.parts().operations {
            stage.triangles -= operation.triangles as usize;
            stage.vertices -= 1;
            stage.error = stage.error.max(operation.error);
            if stage.triangles as f64 <= wanted && stages.len() < steps {
                stages.push(stage);
                wanted = stage.triangles as f64 * ratio;
            }
        }
        if stages.last() != Some(&stage) {
            stages.push(stage);
        }
        stages
    }
}

/// What the first operations of a record leave.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stage {
    triangles: usize,
    vertices: usize,
    error: f32,
}

impl Cut {
    /// The table of its hierarchy as it is worth to the first view of the last update: the error of each level is what it
    /// would have to be everywhere on the mesh, seen from the middle of its bound, to look as bad as the worst point of
    /// the cut of so many triangles. Accuracies go with it, so that the selection's λ is the price of a triangle of the
    /// cut.
    ///
    /// What the present cut is off by is known. From it to other numbers of triangles, errors are taken to change as they
    /// do along the record. Without a view it is the table as it was.
    ///
    /// So do not steer a cut by what it offers itself: once it is coarse, no size looks worth its triangles. Take offers of
    /// a cut of steady size, or the table of the hierarchy, which serves as well.
    ///
    /// `table` is what [`Hierarchy::table`] gave. O(levels).
    ///
    /// # Errors
    /// None but those of [`LodTable::new`], which do not come up for a table of [`Hierarchy::table`].
    pub fn offer(&self, table: &LodTable) -> Result<LodTable, TableError> {
        let Some(lens) = self.lens() else { return Ok(table.clone()) };
        let bounds = table.bounds();
        let radius_px = (lens.area_px2(&bounds) / std::f32::consts::PI).sqrt();
        let record = error_at(table.levels(), self.triangles().len());
        let scale = if record > 0.0 { self.report().max_error_px / record } else { 0.0 };
        let offered = |level: &LevelRecord| {
            let loss = (level.error.unwrap_or(0.0) * scale / radius_px).clamp(0.0, 1.0);
            LevelRecord { accuracy: 1.0 - loss, error: Some(loss * bounds.radius), ..*level }
        };
        LodTable::new(table.name(), bounds, table.levels().iter().map(offered).collect())
    }
}

/// The error of a record at a number of triangles, between levels in proportion.
fn error_at(levels: &[LevelRecord], triangles: usize) -> f32 {
    let error = |level: &LevelRecord| level.error.unwrap_or(0.0);
    let coarser = levels.partition_point(|level| level.triangles as usize > triangles);
    match (coarser.checked_sub(1).map(|finer| &levels[finer]), levels.get(coarser)) {
        (Some(finer), Some(coarser)) => {
            let span = (finer.triangles - coarser.triangles) as f32;
            let share = (finer.triangles as usize - triangles) as f32 / span;
            error(finer) + (error(coarser) - error(finer)) * share
        }
        (finer, coarser) => finer.or(coarser).map_or(0.0, error),
    }
}
