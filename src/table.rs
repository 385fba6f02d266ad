//! LOD tables: what each level of an object costs and how true it is. The bake side writes them, the runtime
//! reads them.

use std::fmt;

use crate::bounds::Sphere;

/// The index of a level of detail. Level 0 is the finest; "not drawn" is a value of its own.
///
/// The derived order therefore reads "finer before coarser before not drawn".
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Level(pub u8);

impl Level {
    /// The most detailed level.
    pub const FINEST: Self = Self(0);
    /// The object is not drawn at all.
    pub const NOT_DRAWN: Self = Self(u8::MAX);

    /// Whether something is drawn.
    pub fn is_drawn(self) -> bool {
        self != Self::NOT_DRAWN
    }

    /// As an index into the levels of a table. Meaningless for [`Level::NOT_DRAWN`].
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NOT_DRAWN => f.write_str("not drawn"),
            Self(level) => write!(f, "level {level}"),
        }
    }
}

/// The most levels that a table may have; two values of [`Level`] are kept for "not drawn" and for "not known".
pub const MAX_LEVELS: usize = 254;

/// What one level of an object costs to draw, and how true it is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct LevelRecord {
    /// Triangles drawn.
    pub triangles: u32,
    /// Vertices processed.
    pub vertices: u32,
    /// Draw calls, one per primitive or material.
    #[cfg_attr(feature = "serde", serde(default = "one_draw"))]
    pub draws: u32,
    /// Memory that the level occupies.
    #[cfg_attr(feature = "serde", serde(default))]
    pub bytes: u64,
    /// Geometric error: two-sided deviation from level 0 in object units; `None` where nobody measured it.
    #[cfg_attr(feature = "serde", serde(default))]
    pub error: Option<f32>,
    /// How well the level stands in for the object, from 0 to 1.
    pub accuracy: f32,
    /// The smallest projected diameter, as a fraction of the viewport's height, at which an author wants this
    /// level; `None` where nobody said.
    #[cfg_attr(feature = "serde", serde(default))]
    pub min_size: Option<f32>,
}

#[cfg(feature = "serde")]
fn one_draw() -> u32 {
    1
}

impl LevelRecord {
    /// A level of so many triangles and vertices in one draw call, its accuracy by [`accuracy_of`].
    pub fn new(triangles: u32, vertices: u32) -> Self {
        let accuracy = accuracy_of(triangles);
        Self { triangles, vertices, draws: 1, bytes: 0, error: None, accuracy, min_size: None }
    }
}

/// Accuracy of a level by its number of triangles: 1 − ½ / triangles, and 0 for none.
///
/// The flat-shading case (exponent 1) of Funkhouser and Séquin, "Adaptive Display Algorithm for Interactive Frame
/// Rates During Visualization of Complex Virtual Environments", 1993, with triangles as samples.
pub fn accuracy_of(triangles: u32) -> f32 {
    if triangles == 0 { 0.0 } else { 1.0 - 0.5 / triangles as f32 }
}

/// The levels of one kind of object, finest first, and its bound.
///
/// There is one bound for all levels: a bound per level would let neighbouring levels disagree about which of
/// them is in view, and draw both or neither.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LodTable {
    name: String,
    bounds: Sphere,
    levels: Vec<LevelRecord>,
}

impl LodTable {
    /// Checks and keeps `levels`, finest first. `bounds` is in object units.
    ///
    /// # Errors
    /// What is broken is refused and named: no level or more than [`MAX_LEVELS`], a bound that is not finite or
    /// has no extent, an error that is negative or not finite, an accuracy outside 0…1. What is merely odd is
    /// the linter's: see [`LodTable::lint`].
    pub fn new(
        name: impl Into<String>,
        bounds: Sphere,
        levels: Vec<LevelRecord>,
    ) -> Result<Self, TableError> {
        let name = name.into();
        match broken_rule(&bounds, &levels) {
            Some((level, rule)) => Err(TableError { table: name, level, rule }),
            None => Ok(Self { name, bounds, levels }),
        }
    }

    /// The name that errors and reports use.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The bound of all levels, in object units.
    pub fn bounds(&self) -> Sphere {
        self.bounds
    }

    /// The levels, finest first; never empty.
    pub fn levels(&self) -> &[LevelRecord] {
        &self.levels
    }

    /// The coarsest level.
    pub fn coarsest(&self) -> Level {
        Level((self.levels.len() - 1) as u8)
    }

    /// What is odd about the table, though it can be used; one entry per finding, finest level first.
    pub fn lint(&self) -> Vec<Lint> {
        let pairs = self.levels.windows(2).enumerate();
        let mut lints: Vec<Lint> = pairs
            .flat_map(|(i, pair)| {
                let level = Level((i + 1) as u8);
                odd_steps(&pair[0], &pair[1]).map(move |rule| Lint { level, rule })
            })
            .collect();
        if self.levels.len() == 1 {
            lints.push(Lint { level: Level::FINEST, rule: "it is the only level: nothing to select" });
        }
        if self.levels.iter().any(|l| l.triangles == 0) {
            let level = self.levels.iter().position(|l| l.triangles == 0).unwrap_or_default();
            lints.push(Lint { level: Level(level as u8), rule: "it has no triangles" });
        }
        lints
    }
}

fn broken_rule(bounds: &Sphere, levels: &[LevelRecord]) -> Option<(Option<Level>, &'static str)> {
    if !bounds.is_valid() || bounds.radius == 0.0 {
        return Some((None, "its bound must be finite and have a positive radius"));
    }
    if levels.is_empty() {
        return Some((None, "it must have at least one level"));
    }
    if levels.len() > MAX_LEVELS {
        return Some((None, "it must have at most 254 levels"));
    }
    levels.iter().enumerate().find_map(|(i, l)| broken_level(l).map(|rule| (Some(Level(i as u8)), rule)))
}

fn broken_level(level: &LevelRecord) -> Option<&'static str> {
    let is_size = |x: f32| x.is_finite() && x >= 0.0;
    if !(0.0..=1.0).contains(&level.accuracy) {
        Some("accuracy must be between 0 and 1")
    } else if level.error.is_some_and(|e| !is_size(e)) {
        Some("error must be finite and not negative")
    } else if level.min_size.is_some_and(|s| !is_size(s)) {
        Some("min_size must be finite and not negative")
    } else {
        None
    }
}

/// What is odd about following `finer` by `coarser`.
fn odd_steps(finer: &LevelRecord, coarser: &LevelRecord) -> impl Iterator<Item = &'static str> + use<> {
    let less_true = coarser.accuracy <= finer.accuracy;
    let no_cheaper = coarser.triangles >= finer.triangles
        && coarser.vertices >= finer.vertices
        && coarser.draws >= finer.draws;
    let errors = finer.error.zip(coarser.error);
    [
        (no_cheaper && less_true, "it is dominated: no cheaper than the finer level and no more accurate"),
        (coarser.triangles > finer.triangles, "it has more triangles than the finer level"),
        (coarser.vertices > finer.vertices, "it has more vertices than the finer level"),
        (!less_true, "it is more accurate than the finer level"),
        (errors.is_some_and(|(f, c)| c < f), "its error is below that of the finer level"),
        (
            finer.min_size.zip(coarser.min_size).is_some_and(|(f, c)| c > f),
            "its min_size is above that of the finer level",
        ),
    ]
    .into_iter()
    .filter_map(|(odd, rule)| odd.then_some(rule))
}

/// Why a table was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableError {
    /// The name of the table.
    pub table: String,
    /// The level that breaks the rule, if it is one level's fault.
    pub level: Option<Level>,
    /// The rule it breaks.
    pub rule: &'static str,
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "LOD table '{}'", self.table)?;
        if let Some(level) = self.level {
            write!(f, ", {level}")?;
        }
        write!(f, ": {}", self.rule)
    }
}

impl std::error::Error for TableError {}

/// Something odd about a table that still can be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lint {
    /// The level it was found at.
    pub level: Level,
    /// What is odd.
    pub rule: &'static str,
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn unit() -> Sphere {
        Sphere::new(Vec3::ZERO, 1.0)
    }

    fn rule_of(levels: Vec<LevelRecord>) -> String {
        LodTable::new("chair", unit(), levels).expect_err("must be refused").to_string()
    }

    #[test]
    fn broken_tables_are_refused_by_name_level_and_rule() {
        let good = LevelRecord::new(100, 60);
        let bad = LevelRecord { error: Some(f32::NAN), ..good };
        assert_eq!(rule_of(vec![]), "LOD table 'chair': it must have at least one level");
        assert_eq!(
            rule_of(vec![good, bad]),
            "LOD table 'chair', level 1: error must be finite and not negative"
        );
        assert_eq!(rule_of(vec![good; 256]), "LOD table 'chair': it must have at most 254 levels");
        let bad = LevelRecord { accuracy: 1.5, ..good };
        assert_eq!(rule_of(vec![bad]), "LOD table 'chair', level 0: accuracy must be between 0 and 1");
        let flat = LodTable::new("dot", Sphere::default(), vec![good]);
        assert!(flat.is_err());
    }

    #[test]
    fn odd_tables_are_linted_not_refused() {
        let t = LodTable::new(
            "fern",
            unit(),
            vec![LevelRecord::new(216, 216), LevelRecord::new(68, 300), LevelRecord::new(68, 300)],
        )
        .expect("usable");
        let rules: Vec<_> = t.lint().into_iter().map(|l| (l.level, l.rule)).collect();
        assert_eq!(rules[0], (Level(1), "it has more vertices than the finer level"));
        assert_eq!(
            rules[1],
            (Level(2), "it is dominated: no cheaper than the finer level and no more accurate")
        );
    }

    #[test]
    fn accuracy_follows_the_1993_formula() {
        assert_eq!(accuracy_of(1), 0.5);
        assert_eq!(accuracy_of(50), 0.99);
        assert_eq!(accuracy_of(0), 0.0);
    }
}
