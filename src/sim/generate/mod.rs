//! Procedural scenes, each with a camera path, made from a seed alone.
//!
//! What is in the scenes that come with the project, and along their paths, is told in `scenes/README.md`.
//!
//! # What the tables say
//!
//! Every kind of object is a mesh ([`Model`]), put together from tessellated shapes: an office chair from rounded blocks
//! and rings, a spruce from cones and cards. Its table is what `lod bake` has measured of the mesh, by the preset of its
//! [`Class`]: the triangles and vertices of levels that were really made, and how far they really are from the finest
//! one. The tables are stored beside the scenes, so that nobody has to bake to generate. A scatter has no meshes: its
//! tables follow from formulas for spheres, rounded blocks and tori.
//!
//! # What a seed fixes
//!
//! Random numbers come from PCG and are made into positions by the arithmetic of this module; sines and cosines are
//! its own, and lengths are rounded to millimetres, in meshes to 2⁻¹⁴ m: no platform and no later version of a
//! dependency changes a scene.
//! The plans (which room is where) are the same for all seeds, so that a storyboard fits them all; what stands in the
//! rooms, how large, and how the camera sways is the seed's.

mod angle;
mod building;
mod city;
mod dice;
mod draft;
mod festival;
mod film;
mod foliage;
mod forest;
mod indoors;
mod kind;
mod model;
mod outdoors;
mod place;
mod scatter;
mod solid;
mod street;
mod structure;
mod urban;

use std::fmt;

use crate::files::{CameraPath, Scene};

use draft::Draft;
use kind::Kind;

pub use model::{Class, Model};
pub use scatter::{scatter, scatter_path};

/// A scene that can be made from a seed. The same seed gives the same scene and the same path on every platform, to
/// the last bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recipe {
    /// A furnished building of five storeys.
    Building,
    /// A city of ten by ten blocks.
    City,
    /// A forest with a festival in a clearing.
    Forest,
}

impl Recipe {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Building, Self::City, Self::Forest];

    /// Name of the scene, of its path and of the files they are bundled in.
    pub fn name(self) -> &'static str {
        match self {
            Self::Building => "building",
            Self::City => "city",
            Self::Forest => "forest",
        }
    }

    /// The recipe of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|recipe| recipe.name() == name)
    }

    /// The seed of the scene that comes with the project.
    pub fn bundled_seed(self) -> u64 {
        match self {
            Self::Building => 1993,
            Self::City => 1968,
            Self::Forest => 1969,
        }
    }

    /// Makes the scene.
    pub fn scene(self, seed: u64) -> Scene {
        self.draft(seed).finish()
    }

    /// The finest levels of the kinds of object that are in it, in the order of their tables. No seed changes them.
    pub fn models(self) -> Vec<Model> {
        self.draft(0).kinds().iter().map(Kind::model).collect()
    }

    fn draft(self, seed: u64) -> Draft {
        match self {
            Self::Building => building::draft(seed),
            Self::City => city::draft(seed),
            Self::Forest => forest::draft(seed),
        }
    }

    /// Makes the camera path. The storyboard is that of the plan, which no seed changes; the seed is in the hand that
    /// holds the camera.
    pub fn path(self, seed: u64) -> CameraPath {
        match self {
            Self::Building => building::path(seed),
            Self::City => city::path(seed),
            Self::Forest => forest::path(seed),
        }
    }
}

impl fmt::Display for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The scene of [`Recipe::Building`].
pub fn building(seed: u64) -> Scene {
    Recipe::Building.scene(seed)
}

/// The scene of [`Recipe::City`].
pub fn city(seed: u64) -> Scene {
    Recipe::City.scene(seed)
}

/// The scene of [`Recipe::Forest`].
pub fn forest(seed: u64) -> Scene {
    Recipe::Forest.scene(seed)
}
