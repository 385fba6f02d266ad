//! An impostor as the last level of a chain.

use std::fmt;

use super::Impostor;
use crate::bake::chain::table::{min_size, rounded_up};
use crate::bake::chain::{Accuracy, Chain};
use crate::table::{LevelRecord, LodTable, MAX_LEVELS, TableError, accuracy_of};

/// A chain with an impostor at its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Joined {
    /// The levels that stay, and the impostor's.
    pub table: LodTable,
    /// So many levels of the chain stay. Those after them are no more accurate than the impostor, and would be of no use.
    pub kept: usize,
    /// Why the impostor is left out, and the table that of the chain.
    pub left_out: Option<NotJoined>,
}

/// Why an impostor is no level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotJoined {
    /// It has more triangles, vertices or draw calls than the coarsest level that is more accurate, or as many of all.
    NotCheaper,
    /// It is worth nothing: its accuracy is 0.
    TooFar,
    /// The chain has as many levels as a table holds.
    Full,
}

impl fmt::Display for NotJoined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotCheaper => "no cheaper than a level that is more accurate",
            Self::TooFar => "too far from level 0 to be worth anything",
            Self::Full => "the table has no room for it",
        })
    }
}

impl Impostor {
    /// The table of a chain with the impostor as its last level: one draw call; vertices of 32 bytes and indices of two,
    /// and the atlas; the larger of all errors before and its own, to which level 0's is added where that has one;
    /// accuracy as the chain's levels have it, from [`Impostor::rms`] or that error, and never above theirs. `min_size` of the level before is where the
    /// impostor's error is a pixel.
    ///
    /// # Errors
    /// As [`Chain::table`].
    pub fn join(&self, chain: &Chain, accuracy: Accuracy) -> Result<Joined, TableError> {
        let table = chain.table(accuracy)?;
        let levels = table.levels();
        let record = self.record(&table, self.error_in(chain), accuracy);
        let more_accurate = levels.iter().take_while(|level| level.accuracy > record.accuracy).count();
        let kept = more_accurate.max(1);
        let left_out = not_joined(&levels[..kept], &record);
        if left_out.is_some() {
            return Ok(Joined { kept: levels.len(), table, left_out });
        }
        let table = appended(&table, kept, record)?;
        Ok(Joined { table, kept, left_out })
    }

    /// How far off it is where level 0 of its chain is itself so far from what is meant, as levels by subdivision are
    /// from the limit surface: [`Impostor::error`] is from level 0.
    pub fn error_in(&self, chain: &Chain) -> f64 {
        self.error + chain.levels[0].deviation.hausdorff
    }

    /// Its level by itself.
    fn record(&self, table: &LodTable, error: f64, accuracy: Accuracy) -> LevelRecord {
        let (triangles, vertices) = self.counts();
        let radius = f64::from(table.bounds().radius);
        let loss = match accuracy {
            Accuracy::Rms => 2.0 * self.rms / radius,
            Accuracy::Hausdorff => error / radius,
            Accuracy::Triangles => 1.0 - f64::from(accuracy_of(triangles)),
        };
        LevelRecord {
            triangles,
            vertices,
            draws: 1,
            bytes: self.atlas.bytes + 32 * u64::from(vertices) + 6 * u64::from(triangles),
            error: Some(rounded_up(error)),
            accuracy: (1.0 - loss).clamp(0.0, 1.0) as f32,
            min_size: Some(0.0),
        }
    }
}

fn not_joined(finer: &[LevelRecord], record: &LevelRecord) -> Option<NotJoined> {
    let counts = |level: &LevelRecord| [level.triangles, level.vertices, level.draws];
    let no_cheaper = |finer: &LevelRecord| {
        let pairs = counts(record).into_iter().zip(counts(finer));
        pairs.clone().any(|(own, other)| own > other) || pairs.clone().all(|(own, other)| own == other)
    };
    if finer.last().is_some_and(no_cheaper) {
        Some(NotJoined::NotCheaper)
    } else if record.accuracy <= 0.0 {
        Some(NotJoined::TooFar)
    } else {
        (finer.len() >= MAX_LEVELS).then_some(NotJoined::Full)
    }
}

/// The first levels of a table and one more.
fn appended(table: &LodTable, kept: usize, record: LevelRecord) -> Result<LodTable, TableError> {
    let mut levels = table.levels()[..kept].to_vec();
    let mut record = record;
    if let Some(last) = levels.last_mut() {
        record.error = Some(record.error.unwrap_or(0.0).max(last.error.unwrap_or(0.0)));
        record.accuracy = record.accuracy.min(last.accuracy);
        last.min_size = record.error.map(|error| min_size(table.bounds().radius, error));
    }
    // What was wanted later than the impostor is wanted before it.
    for at in (1..levels.len()).rev() {
        let wanted = levels[at].min_size.unwrap_or(0.0);
        levels[at - 1].min_size = levels[at - 1].min_size.map(|size| size.max(wanted));
    }
    levels.push(record);
    LodTable::new(table.name(), table.bounds(), levels)
}
