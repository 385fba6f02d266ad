//! The levels of all tables, priced by a cost model: made when tables or coefficients change, read every frame.

use crate::rate::cost::CostModel;
use crate::scene::LevelRange;
use crate::table::{Level, LevelRecord, LodTable};

/// What the selection needs to know of a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelRate {
    /// Time of its geometry, drawn once.
    pub geometry_us: f64,
    /// How well it stands in for the object, 0 to 1.
    pub accuracy: f32,
    /// Its geometric error as a fraction of the bounding radius; measured where the table has it, else estimated by
    /// [`estimated_error`].
    pub error: f32,
    /// The smallest projected diameter, as a fraction of the viewport's height, that its author wants it at; not a
    /// number where nobody said.
    pub min_size: f32,
}

/// The rates of all levels of all tables.
#[derive(Clone, Debug, Default)]
pub struct TableRates {
    spans: Vec<Span>,
    levels: Vec<LevelRate>,
    level_at: Vec<Level>,
    best_slopes: Vec<f32>,
    revision: u64,
}

/// Where the levels of a table lie, and its cheapest.
#[derive(Clone, Copy, Debug)]
struct Span {
    start: u32,
    coarsest: Level,
    cheapest: Level,
}

impl TableRates {
    /// Prices `tables` anew and keeps the memory. Time: O(levels).
    pub fn renew(&mut self, tables: &[LodTable], model: &CostModel) {
        self.spans.clear();
        self.levels.clear();
        self.level_at.clear();
        self.best_slopes.clear();
        for table in tables {
            let (start, radius) = (self.levels.len(), table.bounds().radius);
            self.levels.extend(table.levels().iter().map(|level| rate_of(level, radius, model)));
            self.level_at.extend((0..=table.coarsest().0).map(Level));
            let levels = self.levels[start..].iter().enumerate().map(|(i, &rate)| (Level(i as u8), rate));
            let cheapest = cheapest(levels).unwrap_or(Level::FINEST);
            self.spans.push(Span { start: start as u32, coarsest: table.coarsest(), cheapest });
            self.best_slopes.push(best_slope(&self.levels[start..]));
        }
        self.revision += 1;
    }

    /// The levels of a table, finest first.
    pub fn levels(&self, table: u16) -> &[LevelRate] {
        let Span { start, coarsest, .. } = self.spans[usize::from(table)];
        &self.levels[start as usize..][..=coarsest.index()]
    }

    /// The coarsest level of a table.
    pub fn coarsest(&self, table: u16) -> Level {
        self.spans[usize::from(table)].coarsest
    }

    /// All levels of a table.
    pub fn whole(&self, table: u16) -> LevelRange {
        LevelRange { finest: Level::FINEST, coarsest: self.coarsest(table) }
    }

    /// The place of a drawn level among the levels of all tables, table by table.
    pub fn index(&self, table: u16, level: Level) -> usize {
        self.spans[usize::from(table)].start as usize + level.index()
    }

    /// Which level of its table is at a place.
    pub fn level_at(&self, place: u32) -> Level {
        self.level_at[place as usize]
    }

    /// Per table, the greatest accuracy per µs of geometry of any level, rounded up.
    pub fn best_slopes(&self) -> &[f32] {
        &self.best_slopes
    }

    /// How many levels all tables have.
    pub fn len(&self) -> usize {
        self.levels.len()
    }

    /// Whether there is no table.
    pub fn is_empty(&self) -> bool {
        self.levels.is_empty()
    }

    /// How many tables there are.
    pub fn tables(&self) -> usize {
        self.spans.len()
    }

    /// Raised whenever the rates are renewed.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The levels of `range` that draw something, finest first.
    pub fn drawn(
        &self,
        table: u16,
        range: LevelRange,
    ) -> impl DoubleEndedIterator<Item = (Level, LevelRate)> + '_ {
        let levels = self.levels(table);
        let last = range.coarsest.index().min(levels.len() - 1);
        (range.finest.index()..=last).map(|i| (Level(i as u8), levels[i]))
    }

    /// The cheapest choice in `range`: what is shown when nothing can be afforded. "Not drawn" where that is allowed,
    /// otherwise the level of least geometry, the more accurate of equals.
    pub fn minimum(&self, table: u16, range: LevelRange) -> Level {
        if !range.coarsest.is_drawn() {
            Level::NOT_DRAWN
        } else if range == self.whole(table) {
            self.spans[usize::from(table)].cheapest
        } else {
            self::cheapest(self.drawn(table, range)).unwrap_or(range.coarsest)
        }
    }

    /// Geometry time of a level; 0 where nothing is drawn.
    pub fn geometry_us(&self, table: u16, level: Level) -> f64 {
        self.levels(table).get(level.index()).map_or(0.0, |l| l.geometry_us)
    }

    /// Accuracy of a level; 0 where nothing is drawn.
    pub fn accuracy(&self, table: u16, level: Level) -> f32 {
        self.levels(table).get(level.index()).map_or(0.0, |l| l.accuracy)
    }
}

/// The level of least geometry, the more accurate of equals, then the finer.
fn cheapest(levels: impl Iterator<Item = (Level, LevelRate)>) -> Option<Level> {
    let cheaper = |(best, b): (Level, LevelRate), (level, l): (Level, LevelRate)| {
        let wins = l.geometry_us < b.geometry_us || l.geometry_us == b.geometry_us && l.accuracy > b.accuracy;
        if wins { (level, l) } else { (best, b) }
    };
    levels.reduce(cheaper).map(|(level, _)| level)
}

fn best_slope(levels: &[LevelRate]) -> f32 {
    let slope = |level: &LevelRate| f64::from(level.accuracy) / level.geometry_us;
    let slopes = levels.iter().filter(|level| level.accuracy > 0.0).map(slope);
    (slopes.fold(0.0, f64::max) as f32).next_up()
}

fn rate_of(level: &LevelRecord, radius: f32, model: &CostModel) -> LevelRate {
    LevelRate {
        geometry_us: model.geometry_us(level),
        accuracy: level.accuracy,
        error: level.error.map_or_else(|| estimated_error(level.triangles), |e| e / radius),
        min_size: level.min_size.unwrap_or(f32::NAN),
    }
}

/// Error of an unmeasured level as a fraction of its radius: 4 / triangles, at most 1.
///
/// A sphere of radius 1 in T equal triangles has edges of length h with h² = 16π / (√3 T); the sagitta of a triangle's
/// circumcircle, h² / 6, is 4.8 / T, and 4 / T what remains when the surface is centred on the sphere.
pub fn estimated_error(triangles: u32) -> f32 {
    (4.0 / triangles.max(1) as f32).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Sphere;
    use glam::Vec3;

    fn rates() -> TableRates {
        let levels = vec![LevelRecord::new(216, 104), LevelRecord::new(68, 40), LevelRecord::new(68, 40)];
        let bounds = Sphere::new(Vec3::ZERO, 2.0);
        let one = LodTable::new("one", bounds, vec![LevelRecord { error: Some(0.5), ..levels[0] }]);
        let fern = LodTable::new("fern", bounds, levels);
        let mut rates = TableRates::default();
        rates.renew(&[one.expect("good"), fern.expect("good")], &CostModel::default());
        rates
    }

    #[test]
    fn errors_are_relative_to_the_radius() {
        assert_eq!(rates().levels(0)[0].error, 0.25);
        assert_eq!(rates().levels(1)[1].error, 4.0 / 68.0);
    }

    #[test]
    fn the_minimum_is_the_cheapest_and_the_first_of_equals() {
        let all = LevelRange { finest: Level(0), coarsest: Level(2) };
        assert_eq!(rates().minimum(1, all), Level(1));
        assert_eq!(rates().minimum(1, LevelRange { coarsest: Level::NOT_DRAWN, ..all }), Level::NOT_DRAWN);
        assert_eq!(rates().drawn(1, LevelRange { coarsest: Level::NOT_DRAWN, ..all }).count(), 3);
    }
}
