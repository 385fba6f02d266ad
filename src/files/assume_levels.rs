//! Levels for meshes whose author made none: what a simplifier that halves could have made of them.

use super::{FileError, Scene};
use crate::table::{LevelRecord, LodTable, MAX_LEVELS, accuracy_of};

/// A mesh of so many triangles is not halved any more.
const FEWEST_TRIANGLES: u32 = 8;

impl Scene {
    /// Gives every table of exactly one level a chain of up to `levels` levels, level 0 included. From level to level
    /// triangles, vertices (rounded up) and bytes halve, down to 8 triangles at the least; draws stay. Accuracy is
    /// [`accuracy_of`] the triangles, the error unknown, the author's `min_size` stays with level 0. Chains that an
    /// author made stay as they are.
    ///
    /// Returns how many tables changed: whoever shows a result has to say so.
    ///
    /// # Errors
    /// No level at all, or more than a table may have.
    pub fn assume_levels(&mut self, levels: usize) -> Result<usize, FileError> {
        if !(1..=MAX_LEVELS).contains(&levels) {
            let rule = format!("levels to assume must be between 1 and {MAX_LEVELS}, not {levels}");
            return Err(FileError::whole(&self.name, rule));
        }
        let mut changed = 0;
        for table in self.tables.iter_mut().filter(|t| t.levels().len() == 1) {
            let chain = halved(table.levels()[0], levels);
            if chain.len() > 1 {
                *table = LodTable::new(table.name(), table.bounds(), chain)
                    .map_err(|e| super::of_table(e, &self.name))?;
                changed += 1;
            }
        }
        Ok(changed)
    }
}

/// `finest` and its halves: at most `levels` of them, none below [`FEWEST_TRIANGLES`].
fn halved(finest: LevelRecord, levels: usize) -> Vec<LevelRecord> {
    let next = |l: &LevelRecord| (l.triangles / 2 >= FEWEST_TRIANGLES).then(|| half(l));
    std::iter::successors(Some(finest), next).take(levels).collect()
}

fn half(level: &LevelRecord) -> LevelRecord {
    let triangles = level.triangles / 2;
    LevelRecord {
        triangles,
        vertices: level.vertices.div_ceil(2),
        draws: level.draws,
        bytes: level.bytes / 2,
        error: None,
        accuracy: accuracy_of(triangles),
        min_size: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Sphere;
    use glam::Vec3;

    fn scene(chains: &[&[u32]]) -> Scene {
        let table = |(i, chain): (usize, &&[u32])| {
            let levels = chain.iter().map(|&t| LevelRecord::new(t, t / 2 + 1)).collect();
            LodTable::new(format!("t{i}"), Sphere::new(Vec3::ZERO, 1.0), levels).expect("a good table")
        };
        Scene { tables: chains.iter().enumerate().map(table).collect(), ..Scene::default() }
    }

    fn triangles(scene: &Scene) -> Vec<Vec<u32>> {
        scene.tables.iter().map(|t| t.levels().iter().map(|l| l.triangles).collect()).collect()
    }

    #[test]
    fn only_single_levels_get_a_chain_and_it_stops_at_8_triangles() {
        let mut s = scene(&[&[100], &[100, 3], &[15], &[16], &[0], &[7]]);
        assert_eq!(s.assume_levels(10), Ok(2));
        let expected = vec![vec![100, 50, 25, 12], vec![100, 3], vec![15], vec![16, 8], vec![0], vec![7]];
        assert_eq!(triangles(&s), expected);
        assert_eq!(s.tables[0].levels()[1].vertices, 26);
        assert_eq!(s.tables[0].levels()[3].accuracy, accuracy_of(12));
        assert_eq!(s.assume_levels(10), Ok(0));
    }

    #[test]
    fn the_number_of_levels_counts_level_0() {
        let mut s = scene(&[&[100]]);
        assert_eq!(s.assume_levels(1), Ok(0));
        assert_eq!(s.assume_levels(3), Ok(1));
        assert_eq!(triangles(&s), vec![vec![100, 50, 25]]);
        assert!(s.assume_levels(0).is_err() && s.assume_levels(256).is_err());
    }
}
