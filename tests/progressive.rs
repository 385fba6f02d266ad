//! Progressive meshes: every prefix is what simplification leaves, within its error, and the whole is the original.
#![cfg(feature = "bake")]

#[path = "progressive/files.rs"]
mod files;
#[path = "progressive/meshes.rs"]
mod meshes;
#[path = "progressive/prefixes.rs"]
mod prefixes;
