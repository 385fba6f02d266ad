//! Why a mesh is not baked.

use std::fmt;

use crate::bake::deviation::DeviationError;
use crate::bake::read::MeshError;
use crate::bake::simplify::SimplifyError;
use crate::table::TableError;

/// Why a mesh is not baked.
#[derive(Clone, Debug, PartialEq)]
pub enum BakeError {
    /// The plan breaks this rule.
    Plan(String),
    /// The mesh has no triangle.
    NoTriangles,
    /// All of the mesh is in one place, or it is larger than single precision can tell: no bound can hold it.
    NoExtent,
    /// The simplifier refuses the mesh.
    Simplify(SimplifyError),
    /// A level cannot be measured.
    Deviation(DeviationError),
    /// A progressive mesh is not as it should be.
    File(MeshError),
    /// The levels make no table.
    Table(TableError),
    /// The progress callback said so.
    Cancelled,
}

impl fmt::Display for BakeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plan(rule) => f.write_str(rule),
            Self::NoTriangles => f.write_str("it must have a triangle"),
            Self::NoExtent => f.write_str("its box must be larger than a point, and its diagonal finite"),
            Self::Simplify(error) => error.fmt(f),
            Self::Deviation(error) => error.fmt(f),
            Self::File(error) => error.fmt(f),
            Self::Table(error) => error.fmt(f),
            Self::Cancelled => f.write_str("cancelled"),
        }
    }
}

impl std::error::Error for BakeError {}

impl From<SimplifyError> for BakeError {
    fn from(error: SimplifyError) -> Self {
        Self::Simplify(error)
    }
}

impl From<DeviationError> for BakeError {
    fn from(error: DeviationError) -> Self {
        Self::Deviation(error)
    }
}

impl From<MeshError> for BakeError {
    fn from(error: MeshError) -> Self {
        Self::File(error)
    }
}

impl From<TableError> for BakeError {
    fn from(error: TableError) -> Self {
        Self::Table(error)
    }
}
