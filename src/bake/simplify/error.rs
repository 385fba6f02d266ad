//! Why a task is refused.

use std::fmt;

use super::MAX_TRIANGLES;

/// Why a task is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SimplifyError {
    /// The mesh breaks a rule of [`Mesh::check`](crate::bake::Mesh::check).
    Mesh(String),
    /// A triangle uses a vertex whose position is infinite or not a number.
    NotFinite {
        /// The first such triangle.
        triangle: usize,
        /// The vertex it uses.
        vertex: u32,
    },
    /// More triangles than 2²⁸, or more vertices than 2³² − 1.
    TooLarge {
        /// How many triangles there are.
        triangles: usize,
    },
    /// The list of locked vertices is neither empty nor as long as the positions.
    Locked {
        /// Its length.
        given: usize,
        /// How many positions there are.
        vertices: usize,
    },
    /// The list of weights is neither empty nor as long as the triangles.
    Weights {
        /// Its length.
        given: usize,
        /// How many triangles there are.
        triangles: usize,
    },
    /// A weight is negative, infinite or not a number.
    Weight {
        /// The first such triangle.
        triangle: usize,
    },
}

impl fmt::Display for SimplifyError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(rule) => out.write_str(rule),
            Self::NotFinite { triangle, vertex } => {
                write!(
                    out,
                    "triangle {triangle}: its positions must be finite, but that of vertex {vertex} is not"
                )
            }
            Self::TooLarge { triangles } => {
                write!(
                    out,
                    "a mesh may have up to {MAX_TRIANGLES} triangles and 2^32 - 1 vertices, but has {triangles} triangles"
                )
            }
            Self::Locked { given, vertices } => {
                write!(
                    out,
                    "there must be a lock for each of the {vertices} vertices or for none, but there are {given}"
                )
            }
            Self::Weights { given, triangles } => {
                write!(
                    out,
                    "there must be a weight for each of the {triangles} triangles or for none, but there are {given}"
                )
            }
            Self::Weight { triangle } => {
                write!(out, "triangle {triangle}: its weight must be finite and not negative")
            }
        }
    }
}

impl std::error::Error for SimplifyError {}
