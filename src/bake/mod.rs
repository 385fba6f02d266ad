//! From meshes to LOD tables: how true simplified meshes are, measured.
//!
//! | | |
//! |---|---|
//! | [`surface`] | the geometry of a mesh alone |
//! | [`deviation`] | how far two surfaces are apart, as a bound that is proved |

pub mod surface;

pub mod deviation;
