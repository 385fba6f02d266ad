//! Subdivision against what the papers and the theory of splines say.

mod bounds;
mod masks;
mod normals;
mod shapes;
mod splines;
mod twin;
