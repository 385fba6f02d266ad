//! How a level looks beside level 0, as far as distances between surfaces do not tell.

use super::BakeError;
use crate::bake::deviation::attributes::{self, AttributeDeviation};
use crate::bake::deviation::silhouette::{self, SilhouetteDeviation};
use crate::bake::mesh::Mesh;

/// How closely to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// At normals, texture coordinates and colours.
    pub attributes: attributes::Options,
    /// At silhouettes.
    pub silhouette: silhouette::Options,
}

impl Default for Look {
    /// At 8192 points of either surface, and at 256 pixels, since this is for people to compare levels by, and no contract:
    /// some 50 ms a level of small meshes, and a second or so where level 0 has half a million triangles.
    fn default() -> Self {
        Self {
            attributes: attributes::Options { samples: 1 << 13, ..attributes::Options::default() },
            silhouette: silhouette::Options { resolution: 256 },
        }
    }
}

/// How a level looks beside level 0: estimates, all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Appearance {
    /// Normals, texture coordinates and colours, those that both have.
    pub attributes: AttributeDeviation,
    /// From 13 directions.
    pub silhouette: SilhouetteDeviation,
}

impl Appearance {
    pub(in crate::bake) fn of(level: &Mesh, finest: &Mesh, look: &Look) -> Result<Self, BakeError> {
        Ok(Self {
            attributes: attributes::deviation(finest, level, &look.attributes)?,
            silhouette: silhouette::deviation(&finest.surface(), &level.surface(), &look.silhouette)?,
        })
    }
}
