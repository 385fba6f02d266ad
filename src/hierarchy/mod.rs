//! One huge mesh that is near and far at once: a vertex hierarchy, and the cut through it that a camera asks for.
//!
//! H. Hoppe, "View-dependent refinement of progressive meshes", 1997; D. Luebke, C. Erikson, "View-dependent
//! simplification of arbitrary polygonal environments", 1997. A record of contractions is a forest: two vertices
//! become one, which is contracted in its turn. A [`Cut`] is a set of contractions that holds with each all that it
//! rests on. It always is a mesh without cracks, and every triangle of it is one that the record came by, so that
//! none is turned over that the simplifier did not turn over (L. De Floriani, P. Magillo, E. Puppo, "Efficient
//! implementation of multi-triangulations", 1998).
//!
//! Little says in memory what rests on what: nodes are numbered in the order in which they were made, and a vertex
//! may be split when it is younger than all its neighbours, two may be contracted when no neighbour has to be
//! contracted first (J. El-Sana, A. Varshney, "Generalized view-dependent simplification", 1999). That is not enough
//! where vertices are no longer neighbours once the triangles between them have gone, as the last ones of a part have:
//! therefore each vertex also knows the operations that took a triangle of it.
//!
//! | | |
//! |---|---|
//! | [`Hierarchy`] | what is baked, and never changes: some 120 bytes a vertex |
//! | [`Cut`] | what is shown, changed a little from frame to frame |
//! | [`Budget`], [`Report`] | what an update is given and what it says |
//! | [`Cone`] | which way errors point |
//!
//! The sizes of a cut are levels of a [`LodTable`](crate::table::LodTable): [`Hierarchy::table`] has them once and for
//! all (take that), [`Cut::offer`] as a model of what they are worth to the camera of the last update. So the
//! selection shares one budget among cuts and all other objects: the triangles of the level that it chooses are the
//! [`Budget`] of the cut.
//!
//! Do not take it for what fits into chunks of levels without much loss: a chunk is one number to choose and one
//! buffer to draw, a cut has to be uploaded piece by piece.

mod cone;
mod cut;
mod error;
mod forest;
mod offer;
mod takers;

pub use cone::Cone;
pub use cut::{Budget, Cut, Report};
pub use error::{Flaw, Part};
pub use forest::{Hierarchy, Operation, Parts};

/// No node, operation or corner.
const NONE: u32 = u32::MAX;
