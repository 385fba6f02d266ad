//! Why parts are no hierarchy.

use std::fmt;

/// A column of [`Parts`](super::Parts).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Where a node is.
    Position,
    /// Two nodes that become one.
    Operation,
    /// Three leaves.
    Triangle,
    /// The third node of a triangle that goes.
    Apex,
}

/// Why parts are no hierarchy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// What is at fault.
    pub part: Part,
    /// Which of them; how many there are where it is their number.
    pub index: usize,
    /// The rule it breaks.
    pub rule: &'static str,
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let part = match self.part {
            Part::Position => "position",
            Part::Operation => "operation",
            Part::Triangle => "triangle",
            Part::Apex => "apex",
        };
        write!(f, "{part} {}: {}", self.index, self.rule)
    }
}

impl std::error::Error for Flaw {}
