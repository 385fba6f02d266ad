//! Procedural scenes, each with a camera path, made from a seed alone.

mod angle;
mod building;
mod city;
mod dice;
mod draft;
mod film;
mod forest;
mod indoors;
mod kind;
mod outdoors;
mod scatter;
mod shape;
mod urban;

use std::fmt;

use crate::files::{CameraPath, Scene};

pub use scatter::scatter;

/// A scene that can be made from a seed. The same seed gives the same scene and the same path on every platform: to
/// the last bit, but for rotations, whose normalisation may differ in it.
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
        match self {
            Self::Building => building::scene(seed),
            Self::City => city::scene(seed),
            Self::Forest => forest::scene(seed),
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
