//! From meshes to LOD tables: what is done once, before anything is drawn.
//!
//! | | |
//! |---|---|
//! | [`mesh`] | the one mesh type: welded positions, attributes per wedge |
//! | [`surface`] | its geometry alone, for simplification and measuring |
//! | [`mod@read`] | OBJ, PLY, OFF, STL and glTF |
//! | [`weld`] | positions that are the same become one |
//! | [`repair`] | what is wrong with a mesh, and what can be put right safely |
//! | [`finding`] | what readers and repair have to report |
//! | [`simplify`] | fewer triangles: the methods behind one interface |
//! | [`progressive`] | a coarse mesh and the splits that lead to the original: any level, as a file that streams |
//! | [`mod@split`] | a mesh that is in view near and far at once, in chunks without cracks |
//! | [`subdivide`] | more triangles: from a control mesh to the smooth surface that is meant |
//! | [`shapes`] | meshes to try it on |
//! | [`deviation`] | how far two surfaces are apart, as a bound that is proved |
//! | [`chain`] | plans, chains of measured levels, and their LOD tables |
//! | [`geomorph`] | a finer level that turns into a coarser one without a jump |
//! | [`impostor`] | pictures on quads as the last level: layout, cameras, error, table |
//! | [`hierarchy`] | one huge mesh for a cut that follows the camera, and its file |
//! | [`scene`] | whole glTF scenes: which meshes get levels, and the same scene with them |
//! | [`mod@write`] | levels as OBJ, as GLB and as pictures |

pub mod chain;
pub mod deviation;
pub mod finding;
pub mod geomorph;
pub mod hierarchy;
pub mod impostor;
pub mod mesh;
pub mod progressive;
pub mod read;
pub mod repair;
pub mod scene;
pub mod shapes;
pub mod simplify;
pub mod split;
pub mod subdivide;
pub mod surface;
pub mod weld;
pub mod write;

pub use finding::{Defect, Finding};
pub use mesh::{Group, Mesh, Skin};
pub use read::{Format, MeshError, MeshFile};
pub use surface::Surface;
