//! Why there is no hierarchy.

use std::fmt;

use crate::bake::simplify::SimplifyError;
use crate::hierarchy::Flaw;

/// Why a hierarchy cannot be built.
#[derive(Clone, Debug, PartialEq)]
pub enum BuildError {
    /// The mesh breaks a rule of [`Mesh::check`](crate::bake::Mesh::check).
    Mesh(String),
    /// The mesh cannot be simplified.
    Simplify(SimplifyError),
    /// A contraction is of something else.
    Record {
        /// Which one.
        index: usize,
        /// The rule it breaks.
        rule: &'static str,
    },
    /// The result has numbers or counts that are too large.
    Flaw(Flaw),
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(rule) => f.write_str(rule),
            Self::Simplify(error) => error.fmt(f),
            Self::Record { index, rule } => write!(f, "contraction {index}: {rule}"),
            Self::Flaw(flaw) => flaw.fmt(f),
        }
    }
}

impl std::error::Error for BuildError {}

impl From<SimplifyError> for BuildError {
    fn from(error: SimplifyError) -> Self {
        Self::Simplify(error)
    }
}

impl From<Flaw> for BuildError {
    fn from(flaw: Flaw) -> Self {
        Self::Flaw(flaw)
    }
}

/// Why a file was refused. Displayed as `FILE: byte N: RULE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// The file, as the caller named it.
    pub file: String,
    /// Where what is wrong begins.
    pub byte: usize,
    /// The rule it breaks.
    pub rule: String,
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: byte {}: {}", self.file, self.byte, self.rule)
    }
}

impl std::error::Error for ReadError {}
