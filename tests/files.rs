//! Files, well-formed and not: every reader names file, place and rule, and none panics.
#![cfg(feature = "files")]

#[path = "files/gltf.rs"]
mod gltf;
#[path = "files/inspect.rs"]
mod inspect;
#[path = "files/mangle.rs"]
mod mangle;
#[path = "files/paths.rs"]
mod paths;
#[path = "files/scenes.rs"]
mod scenes;
