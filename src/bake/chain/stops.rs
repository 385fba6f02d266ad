//! Where levels are made, and where a chain ends.

use super::BakeError;
use crate::table::MAX_LEVELS;

/// Where levels are made. Level 0 is the mesh itself and not among them.
#[derive(Clone, Debug, PartialEq)]
pub enum Stops {
    /// Each level has so many times the triangles of the one before, in (0, 1): ½ makes n/2, n/4, n/8 … until a limit
    /// ends the chain.
    Ratio(f64),
    /// Shares of level 0's triangles, in (0, 1) and falling.
    Shares(Vec<f64>),
    /// Numbers of triangles, at least 1 and falling.
    Triangles(Vec<usize>),
    /// Distances from level 0, rising: each level is the coarsest that was found to be *measured* within its distance.
    /// Takes as long as several chains, as it has to try.
    Errors(Vec<Length>),
}

/// A length in object units, or relative to the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// In object units, finite and > 0.
    Units(f64),
    /// As a share of the diagonal of the mesh's bounding box, finite and > 0.
    OfDiagonal(f64),
}

impl Length {
    /// In object units.
    pub fn units(self, diagonal: f64) -> f64 {
        match self {
            Self::Units(units) => units,
            Self::OfDiagonal(share) => share * diagonal,
        }
    }

    fn number(self) -> f64 {
        match self {
            Self::Units(number) | Self::OfDiagonal(number) => number,
        }
    }
}

/// Where a chain ends, whatever its stops say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The most levels, level 0 included: from 1 to [`MAX_LEVELS`].
    pub levels: usize,
    /// No level is asked to have fewer triangles. At least 1.
    pub least_triangles: usize,
    /// The chain ends before a level whose measured Hausdorff distance is above this.
    pub most_error: Option<Length>,
    /// A level that saves less than this share of the triangles of the one before is left out: it would take memory and
    /// switches for nothing. In [0, 1); 0 keeps whatever is coarser at all.
    pub least_gain: f64,
}

impl Limits {
    /// All that is asked for: no end but that of what a method can do.
    pub const NONE: Self = Self { levels: MAX_LEVELS, least_triangles: 1, most_error: None, least_gain: 0.0 };
}

impl Default for Limits {
    /// At least 16 triangles, of which a fifth is saved each time, and at most a tenth of the diagonal away: of an
    /// object that is coarser than that little more can be told than its size.
    fn default() -> Self {
        Self { least_triangles: 16, most_error: Some(Length::OfDiagonal(0.1)), least_gain: 0.2, ..Self::NONE }
    }
}

impl Limits {
    pub(super) fn check(&self) -> Result<(), BakeError> {
        rule((1..=MAX_LEVELS).contains(&self.levels), || {
            format!("a chain must have 1 to {MAX_LEVELS} levels, not {}", self.levels)
        })?;
        rule(self.least_triangles > 0, || "the least triangles of a level must be at least 1".to_owned())?;
        rule((0.0..1.0).contains(&self.least_gain), || {
            format!("the least gain must be from 0 to below 1, not {}", self.least_gain)
        })?;
        rule(self.most_error.is_none_or(|length| is_positive(length.number())), || {
            "the most error must be finite and above 0".to_owned()
        })
    }
}

impl Stops {
    /// Refuses what is out of range, out of order, or more than a table can hold.
    pub(super) fn check(&self) -> Result<(), BakeError> {
        rule(self.count() < MAX_LEVELS, || {
            format!("a chain must have at most {MAX_LEVELS} levels, not {}", self.count() + 1)
        })?;
        let is_share = |share: &f64| *share > 0.0 && *share < 1.0;
        match self {
            Self::Ratio(ratio) => {
                rule(is_share(ratio), || format!("the ratio must be between 0 and 1, not {ratio}"))
            }
            Self::Shares(shares) => {
                let falls = shares.is_sorted_by(|a, b| a > b);
                rule(falls && shares.iter().all(is_share), || {
                    "shares of triangles must be between 0 and 1 and fall".to_owned()
                })
            }
            Self::Triangles(counts) => {
                let falls = counts.is_sorted_by(|a, b| a > b);
                rule(falls && !counts.contains(&0), || {
                    "numbers of triangles must be at least 1 and fall".to_owned()
                })
            }
            Self::Errors(lengths) => rule(lengths.iter().all(|length| is_positive(length.number())), || {
                "target errors must be finite and above 0".to_owned()
            }),
        }
    }

    /// How many levels are named one by one.
    fn count(&self) -> usize {
        match self {
            Self::Ratio(_) => 0,
            Self::Shares(shares) => shares.len(),
            Self::Triangles(counts) => counts.len(),
            Self::Errors(lengths) => lengths.len(),
        }
    }

    /// The numbers of triangles to make levels of, falling, for a mesh of `triangles`; `None` where stops are errors.
    pub(super) fn counts(&self, triangles: usize, limits: &Limits) -> Option<Vec<usize>> {
        let share = |share: f64| ((share * triangles as f64).round() as usize).max(1);
        let wanted: Vec<usize> = match self {
            Self::Ratio(ratio) => (1..limits.levels as i32).map(|level| share(ratio.powi(level))).collect(),
            Self::Shares(shares) => shares.iter().copied().map(share).collect(),
            Self::Triangles(counts) => counts.clone(),
            Self::Errors(_) => return None,
        };
        let mut counts: Vec<usize> = wanted
            .into_iter()
            .filter(|&count| count < triangles && count >= limits.least_triangles)
            .collect();
        counts.dedup();
        counts.truncate(limits.levels - 1);
        Some(counts)
    }
}

fn is_positive(number: f64) -> bool {
    number.is_finite() && number > 0.0
}

fn rule(holds: bool, rule: impl FnOnce() -> String) -> Result<(), BakeError> {
    if holds { Ok(()) } else { Err(BakeError::Plan(rule())) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_ends_at_the_least_triangles() {
        let counts = |triangles| Stops::Ratio(0.5).counts(triangles, &Limits::default());
        assert_eq!(counts(1000), Some(vec![500, 250, 125, 63, 31, 16]));
        assert_eq!(counts(16), Some(vec![]));
        let three = Limits { levels: 3, ..Limits::NONE };
        assert_eq!(Stops::Ratio(0.5).counts(1000, &three), Some(vec![500, 250]));
    }

    #[test]
    fn shares_are_of_level_0_and_those_that_round_to_the_same_are_one() {
        let shares = Stops::Shares(vec![0.9, 0.5, 0.3, 0.2]);
        assert_eq!(shares.counts(500_000, &Limits::NONE), Some(vec![450_000, 250_000, 150_000, 100_000]));
        assert_eq!(shares.counts(2, &Limits::NONE), Some(vec![1]));
        assert_eq!(shares.counts(1, &Limits::NONE), Some(vec![]));
    }

    #[test]
    fn stops_out_of_range_or_order_are_refused() {
        let broken = [
            Stops::Ratio(1.0),
            Stops::Ratio(f64::NAN),
            Stops::Shares(vec![0.25, 0.5]),
            Stops::Shares(vec![0.5, 0.0]),
            Stops::Triangles(vec![10, 10]),
            Stops::Triangles(vec![0]),
            Stops::Errors(vec![Length::Units(f64::INFINITY)]),
            Stops::Errors(vec![Length::OfDiagonal(-0.1)]),
            Stops::Triangles((1..=MAX_LEVELS).rev().collect()),
        ];
        assert!(broken.iter().all(|stops| stops.check().is_err()));
        assert_eq!(Stops::Triangles((1..MAX_LEVELS).rev().collect()).check(), Ok(()));
        let limits = [
            Limits { levels: 0, ..Limits::NONE },
            Limits { levels: MAX_LEVELS + 1, ..Limits::NONE },
            Limits { least_triangles: 0, ..Limits::NONE },
            Limits { least_gain: 1.0, ..Limits::NONE },
            Limits { most_error: Some(Length::Units(0.0)), ..Limits::NONE },
        ];
        assert!(limits.iter().all(|limits| limits.check().is_err()));
    }
}
