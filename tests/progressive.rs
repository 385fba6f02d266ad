//! Progressive meshes: every prefix is what simplification leaves, within its error, and the whole is the original.

#[path = "progressive/files.rs"]
mod files;
#[path = "progressive/meshes.rs"]
mod meshes;
#[path = "progressive/prefixes.rs"]
mod prefixes;
