//! Levels upwards: from the control mesh that an artist made to the smooth surface that is meant.
//!
//! | scheme | for | |
//! |---|---|---|
//! | [`Scheme::Loop`] | triangles | C. Loop, "Smooth subdivision surfaces based on triangles", 1987 |
//! | [`Scheme::CatmullClark`] | quads and any polygons | E. Catmull, J. Clark, "Recursively generated B-spline surfaces on arbitrary topological meshes", 1978 |
//!
//! Every subdivision cuts faces into four or so and smooths; the surface that comes of it in the end is smooth but for
//! what is sharp:
//!
//! - **Creases** are edges that stay sharp; along them runs the cubic B-spline of their vertices, whatever is beside it
//!   (H. Hoppe et al., "Piecewise smooth surface reconstruction", 1994). A vertex of one sharp edge is smooth (a *dart*), of
//!   two a crease, of more a corner, which stays where it is. We take Hoppe's rules without his masks for irregular
//!   crease vertices, as most renderers do: a side of more than six triangles there has a tangent plane that is not
//!   unique.
//! - **Semi-sharp** edges and vertices are sharp for as many subdivisions as their sharpness says, and smooth from then
//!   on (T. DeRose, M. Kass, T. Truong, "Subdivision surfaces in character animation", 1998). A fraction is that share of
//!   one more. From [`FOREVER_SHARP`] on they are sharp for ever.
//! - **Borders** are creases; where two of a border's edges alone meet in one face, they make no corner: name it as a
//!   [`SharpVertex`] to have one.
//! - **Non-manifold** edges, of more than two faces, are creases as well, and vertices at which several surfaces touch are
//!   corners: they are held together, since there is no smooth surface through them. A vertex at which an edge of more
//!   than two faces ends within a surface is a corner.
//! - **Texture coordinates and colours** are smoothed as positions are, so that a texture does not swim; along the
//!   borders of charts they are linear, so that charts keep their outlines and no texel of another chart shows. Where
//!   a crease runs through a chart, they follow it.
//! - **Normals** are those of the limit surface, at every level. What is sharp for ever is a hard edge, and has a normal on
//!   each side.
//!
//! Levels show the surface itself: their vertices lie where they end in the limit ([`Placement::Limit`]). With those of
//! the subdivision every level would be a larger or smaller object than the next, and off by a multiple. Vertices keep
//! their places and indices in all finer levels: a change of level adds vertices and moves none.
//!
//! [`Upward::bake`] measures how far levels are from the limit surface, as a bound that is proved, and makes a
//! [`Chain`](super::chain::Chain) of them, from which tables, files and pictures are made as from any other.
//!
//! ```
//! use glam::Vec3;
//! use lod_budget::bake::chain::{Accuracy, quietly};
//! use lod_budget::bake::subdivide::{ControlMesh, Upward};
//!
//! let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
//! let sides: [&[u32]; 6] = [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
//! let cube = ControlMesh::of_faces((0..8).map(corner).collect(), &sides);
//! let chain = Upward { levels: 3, ..Upward::default() }.bake(&cube, &mut quietly)?;
//! assert_eq!(chain.levels.iter().map(|level| level.triangles()).collect::<Vec<_>>(), [768, 192, 48, 12]);
//! assert!(chain.table(Accuracy::default())?.lint().is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod catmull_clark;
mod control;
mod draw;
mod error;
mod fan;
mod level;
mod limits;
mod load;
mod loops;
mod net;
mod normals;
mod remainder;
mod scheme;
mod sharpen;
mod tangents;
#[cfg(test)]
mod tests;
mod upward;

use std::fmt;
use std::str::FromStr;

pub use control::{ControlMesh, FaceGroup, SharpEdge, SharpVertex};
pub use error::SubdivideError;
pub use load::{ControlFile, load};
pub use upward::Upward;

use super::mesh::Mesh;

/// What is as sharp as this, or sharper, is never smooth: ten subdivisions make a million faces of one.
pub const FOREVER_SHARP: f32 = 10.0;

/// A subdivision with more corners of faces than this is refused: it would take several gigabytes.
pub const MOST_CORNERS: u64 = 1 << 26;

/// How to subdivide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Triangles into four.
    Loop,
    /// Polygons of n corners into n quads, quads into four.
    CatmullClark,
}

impl Scheme {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Loop, Self::CatmullClark];

    /// Loop's where all faces are triangles, else Catmull and Clark's.
    pub fn of(mesh: &ControlMesh) -> Self {
        if mesh.is_triangles() { Self::Loop } else { Self::CatmullClark }
    }

    /// As the command has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Loop => "loop",
            Self::CatmullClark => "catmull-clark",
        }
    }
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Scheme {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let named = Self::ALL.into_iter().find(|scheme| scheme.name() == name);
        named.ok_or_else(|| format!("a scheme must be loop or catmull-clark, not {name}"))
    }
}

/// Where the vertices of levels lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Placement {
    /// On the limit surface. Take it unless levels are to be subdivided further by somebody else.
    #[default]
    Limit,
    /// Where the subdivision has them; the coarsest level is the control mesh as it is.
    Subdivision,
}

impl ControlMesh {
    /// As [`ControlMesh::subdivided`], by Loop's scheme, on the limit surface.
    ///
    /// # Errors
    /// As [`ControlMesh::subdivided`].
    pub fn loop_subdivided(&self, levels: usize) -> Result<Vec<Mesh>, SubdivideError> {
        self.subdivided(Scheme::Loop, levels, Placement::Limit)
    }

    /// As [`ControlMesh::subdivided`], by Catmull and Clark's scheme, on the limit surface.
    ///
    /// # Errors
    /// As [`ControlMesh::subdivided`].
    pub fn catmull_clark(&self, levels: usize) -> Result<Vec<Mesh>, SubdivideError> {
        self.subdivided(Scheme::CatmullClark, levels, Placement::Limit)
    }

    /// The mesh after `levels` subdivisions, after one less, and so on to the control mesh: finest first, `levels` + 1 of
    /// them. Triangles of level l are in the order of the faces they come from; quads are cut along their shorter
    /// diagonal, the control mesh's polygons as the readers cut them.
    ///
    /// Some 0.5 µs and 300 bytes per triangle of the finest level.
    ///
    /// # Errors
    /// What [`ControlMesh::check`] refuses, polygons for Loop's scheme, too many faces, and a concave face too large.
    pub fn subdivided(
        &self,
        scheme: Scheme,
        levels: usize,
        placement: Placement,
    ) -> Result<Vec<Mesh>, SubdivideError> {
        let stack = level::Stack::new(self, scheme, levels)?;
        draw::meshes(self, &stack, placement)
    }
}
