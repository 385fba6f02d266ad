//! Why a control mesh is not subdivided.

use std::fmt;

use crate::bake::chain::BakeError;
use crate::bake::deviation::DeviationError;

/// Why a control mesh is not subdivided.
#[derive(Clone, Debug, PartialEq)]
pub enum SubdivideError {
    /// The control mesh breaks this rule.
    Mesh(String),
    /// Loop's scheme is for triangles.
    NotTriangle {
        /// The first face that is none.
        face: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// The mesh would have more than [`MOST_CORNERS`](super::MOST_CORNERS) corners of faces.
    TooLarge {
        /// The level that would, counted from the control mesh.
        level: usize,
    },
    /// The first subdivision would have more triangles than [`Upward`](super::Upward) may make.
    TooMany {
        /// As many as it would have.
        triangles: usize,
        /// As many as it may.
        most: usize,
    },
    /// A concave face of the control mesh has too many corners to be cut into triangles.
    TooConcave {
        /// Which.
        face: usize,
    },
    /// An option out of its range; the rule it breaks.
    Options(String),
    /// The levels cannot be baked.
    Bake(BakeError),
}

impl fmt::Display for SubdivideError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(rule) | Self::Options(rule) => f.write_str(rule),
            Self::NotTriangle { face, corners } => {
                write!(f, "face {face}: it must be a triangle for Loop's scheme, and has {corners} corners")
            }
            Self::TooLarge { level } => {
                write!(f, "subdivision {level} must have at most {} corners of faces", super::MOST_CORNERS)
            }
            Self::TooMany { triangles, most } => {
                write!(f, "subdivided once it must have at most {most} triangles, and has {triangles}")
            }
            Self::TooConcave { face } => {
                write!(f, "face {face}: it is concave and has too many corners to be cut into triangles")
            }
            Self::Bake(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for SubdivideError {}

impl From<BakeError> for SubdivideError {
    fn from(error: BakeError) -> Self {
        Self::Bake(error)
    }
}

impl From<DeviationError> for SubdivideError {
    fn from(error: DeviationError) -> Self {
        Self::Bake(error.into())
    }
}
