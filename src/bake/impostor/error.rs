//! Why a mesh gets no impostor.

use std::fmt;

/// Why a mesh gets no impostor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImpostorError {
    /// The options break this rule.
    Options(String),
    /// The mesh breaks this rule of [`Mesh::check`](crate::bake::Mesh::check), or this position is not finite.
    Mesh(String),
    /// The mesh has no triangle.
    NoTriangles,
    /// All of it is in one place, or it is larger than single precision can tell.
    NoExtent,
    /// So many frames do not fit an atlas of so many pixels each way.
    Atlas {
        /// All of them.
        frames: usize,
        /// The most that was allowed.
        side_px: u32,
    },
}

impl fmt::Display for ImpostorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Options(rule) | Self::Mesh(rule) => f.write_str(rule),
            Self::NoTriangles => f.write_str("it must have a triangle"),
            Self::NoExtent => f.write_str("its box must be larger than a point, and its diagonal finite"),
            Self::Atlas { frames, side_px } => {
                write!(
                    f,
                    "an atlas of {side_px} pixels each way must hold its {frames} frames; they need more"
                )
            }
        }
    }
}

impl std::error::Error for ImpostorError {}
