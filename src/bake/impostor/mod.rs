//! Impostors: pictures of a mesh on a few quads, as the last level of a chain.
//!
//! An object that is small in the image can be drawn as a picture of itself (P. Maciel, P. Shirley, "Visual navigation
//! of large environments using textured clusters", 1995; J. Shade et al., "Hierarchical image caching for accelerated
//! walkthroughs of complex environments", 1996). Here everything about such pictures is worked out but the pixels: which
//! there are, from where each is taken, where it lies in the atlas, what is drawn with it, where that holds, and how far
//! what is seen then can be from where the mesh would be.
//!
//! | kind | pictures | drawn |
//! |---|---|---|
//! | [`Kind::Billboard`] | one or several around the axis | one quad that turns to the viewer |
//! | [`Kind::CrossQuads`] | one per quad | all quads, as they stand (X. Décoret et al., "Billboard clouds", 2003, place such quads freely) |
//! | [`Kind::Octahedral`] | a grid all over the sphere or its upper half | the three pictures nearest to the direction, blended (R. Brucks, "Octahedral impostors", 2018) |
//!
//! # The pivot
//! Everything turns about the middle of the box around the mesh ([`Impostor::center`]), wherever the mesh's own origin
//! is, and around the axis through it ([`Options::up`]). An engine that turns about something else adds that distance
//! to the error.
//!
//! # To draw it
//! Clear the atlas to nothing. For each [`Frame`] draw the mesh with [`Impostor::camera`] into
//! [`Frame::rectangle_px`], colour and coverage, and fill the gutter from the rectangle's border. At run time
//! [`Impostor::sights`] says which frames a direction needs, [`Impostor::placed`] where each puts a point, and
//! [`Impostor::uv`] where that point is in the atlas. [`Kind`] says what it comes to for each kind.
//!
//! # The error
//! [`Impostor::error`] times the length in pixels of one unit at the nearest point of the bound (as
//! [`View`](crate::view::View) projects errors) is no less than the distance on the screen between where the impostor
//! shows a point of the mesh and where it is, from everywhere that [`Validity`] allows. It follows from depth and
//! angles alone; `bound.rs` has the proof. That is the contract of a table's levels, though of another kind: levels of
//! triangles are near the surface in space, those of pictures on the screen. What is *hidden* by what does not count,
//! nor does light that moves.
//!
//! ```
//! use glam::DVec3;
//! use lod_budget::bake::chain::{Accuracy, Plan, quietly};
//! use lod_budget::bake::impostor::{Kind, Options};
//! use lod_budget::bake::shapes;
//!
//! let knot = shapes::torus_knot(200, 20).into();
//! let impostor = Options::new(Kind::Octahedral { frames: 9, hemisphere: true }).bake(&knot)?;
//! let [nearest, ..] = impostor.sights(DVec3::new(0.3, 0.4, 1.0))[..] else { unreachable!() };
//! let (view, projection) = impostor.camera(nearest.frame);
//!
//! let chain = Plan::default().bake(&knot, &mut quietly)?;
//! let joined = impostor.join(&chain, Accuracy::default())?;
//! assert_eq!(joined.table.levels().len(), joined.kept + 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod atlas;
mod body;
mod bound;
mod document;
mod error;
mod frame;
mod geometry;
mod kind;
mod level;
mod octahedral;
mod options;
mod outline;
mod sampled;
mod sights;

pub use atlas::{Atlas, AtlasOptions, Rectangle, Sides};
pub use document::{DocumentError, FORMAT, VERSION};
pub use error::ImpostorError;
pub use frame::{Frame, Window};
pub use kind::{Facing, Kind};
pub use level::{Joined, NotJoined};
pub use octahedral::Octahedron;
pub use options::{Options, Validity};
pub use outline::Outline;
pub use sights::Sight;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use self::body::Body;
use super::mesh::Mesh;

/// A mesh as pictures: all but the pixels. Lengths are in object units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Impostor {
    /// That of the mesh.
    pub name: String,
    /// What is drawn, and how.
    pub kind: Kind,
    /// The middle of the box around the mesh: what turns does so about it.
    pub center: DVec3,
    /// How far a point of the mesh can be from `center`, > 0.
    pub radius: f64,
    /// How far a point of the mesh can be from the axis through `center` along `up`.
    pub girth: f64,
    /// Unit vector from which elevations count.
    pub up: DVec3,
    /// Unit vector across `up`, from which angles around it count, towards `up` × `front`.
    pub front: DVec3,
    /// From where on the error holds.
    pub validity: Validity,
    /// The image with all frames.
    pub atlas: Atlas,
    /// In the order that [`Kind`] says.
    pub frames: Vec<Frame>,
    /// Half the width and height of a rectangle around `center`, facing the viewer, that covers all that is shown from
    /// where the impostor is valid.
    pub cover: [f64; 2],
    /// The proved bound, as the module says.
    pub error: f64,
    /// The root mean square of what `error` bounds, over directions and the surface, seen from the nearest distance. An
    /// estimate, in units at the distance of `center`.
    pub rms: f64,
    /// Pixels that are drawn, in those of the disc around the bound: the mean over directions. A mesh has at most 1; what
    /// is above is what transparency and overlap cost.
    pub fill: f64,
}

impl Options {
    /// Lays out the impostor of a mesh. The same options and mesh have the same result.
    ///
    /// Each frame costs a look at every position, some 10 ns; 81 frames of half a million positions half a second.
    ///
    /// # Errors
    /// Options out of range; a mesh that has no triangle, is all in one place, does not [check](Mesh::check), or has a
    /// position that is no number; an atlas that does not hold the frames at four texels across the bound.
    pub fn bake(&self, mesh: &Mesh) -> Result<Impostor, ImpostorError> {
        self.check()?;
        let body = Body::of(mesh, self.up)?;
        let views = self.kind.views(&body.basis, self.yaw_deg);
        let extents: Vec<_> = views.iter().map(|view| view.extent(&body.points)).collect();
        let (atlas, frames) = atlas::fitted(self, body.radius, &views, &extents)?;
        let mut impostor = Impostor {
            name: mesh.name.clone(),
            kind: self.kind,
            center: body.center,
            radius: body.radius,
            girth: body.girth,
            up: body.basis.up,
            front: body.basis.front,
            validity: self.validity(body.radius, &atlas),
            atlas,
            frames,
            cover: [0.0; 2],
            error: 0.0,
            rms: 0.0,
            fill: 0.0,
        };
        impostor.error = impostor.error_everywhere();
        impostor.cover = impostor.covering();
        (impostor.rms, impostor.fill) = sampled::looked_at(&impostor, &body);
        Ok(impostor)
    }
}
