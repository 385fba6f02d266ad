//! Procedural scenes, each with a camera path, made from a seed alone.
//!
//! # Bundled scenes
//!
//! | scene | seed | objects | tables | triangles, finest | coarsest | in view along its path (finest): least, mean, most |
//! |---|---|---|---|---|---|---|
//! | building | 1993 | 2 322 | 26 | 18.4 M | 0.13 M | 0.1 M, 2.0 M, 4.1 M |
//! | city | 1968 | 4 223 | 17 | 59.2 M | 0.29 M | 2.1 M, 11.7 M, 16.0 M |
//! | forest | 1969 | 4 267 | 18 | 33.6 M | 0.16 M | 0.7 M, 5.7 M, 12.7 M |
//!
//! "In view" is by the frustum of a 60° view at 1920×1080 reaching 1000 m, and by the draw distances of the objects;
//! walls hide nothing. `cargo test --features sim --test generate -- --nocapture` prints these numbers.
//!
//! **building**: five storeys around an atrium, after the model of Soda Hall that the field began with. Rooms differ
//! by an order of magnitude in what they cost: store rooms and offices, and on the other side of the wall laboratories,
//! libraries and offices of six desks. Furniture has a draw distance, smaller things a shorter one. The path (80 s)
//! starts at rest at a window, hurries along the galleries, looks up into the atrium, rests before a piano, turns on
//! the heel into the lecture hall, climbs the stairs, opens the door on the laboratories of the first storey and rests
//! there, climbs again, jumps to the top gallery and looks down into the atrium.
//!
//! **city**: ten by ten blocks over one and a half kilometres: houses, shops, apartments, towers, parks and a market
//! around a fountain; streets with parked cars, buses, lamps and traffic lights. The path (86 s) starts at rest in a
//! suburb, drives in, turns into the street of the towers, turns again, waits five seconds at a light by the market,
//! looks down, rises over the roofs and reveals the whole city.
//!
//! **forest**: 1 850 trees, and shrubs, ferns and rocks, over four hundred metres square; in the clearing a festival with a
//! crowd of 800, denser before the stage. People are skinned (twice the cost) and worth more than trees; the singer is
//! worth most. The path (81 s) starts at rest at the edge of the forest, walks up the lane, past an old oak, out into
//! the clearing where the crowd comes into view at once, through it, jumps to the singer's face and rests there, and
//! turns to the crowd.
//!
//! # What the tables say
//!
//! Every kind of object is made of parametric shapes (blocks, rounded blocks, cylinders, cones, spheres, tori, tubes,
//! height fields, crowns of leaf cards), and every level says how finely it tessellates each of them, or that it leaves
//! it out. Triangles and vertices are those of the tessellations. The error of a level is an upper bound on its two-sided
//! deviation from level 0, by the triangle inequality through the smooth shape:
//!
//! - a circle of radius r in n segments deviates by r·(1 − cos(π/n)) ≤ r·π²/(2n²), a surface of revolution by that and
//!   its profile's deviation; a height field of cells h wide, whose second derivative is at most κ, by κh²/4; a crown
//!   by half the way across the cell of a leaf;
//! - a part that is left out counts with how far it sticks out of the parts that stay, or with the reach of the cards
//!   or box that stand in for it, both stated with the kind.
//!
//! The accuracy of a level follows its number of triangles ([`accuracy_of`](crate::table::accuracy_of)). Kinds have
//! one to six levels, one to five draw calls (a coarse level shares one atlas), 4 to 55 000 triangles.
//!
//! # What a seed fixes
//!
//! Random numbers come from PCG and are made into positions by the arithmetic of this module; sines and cosines are
//! its own, and lengths are rounded to millimetres: no platform and no later version of a dependency changes a scene.
//! The plans (which room is where) are the same for all seeds, so that a storyboard fits them all; what stands in the
//! rooms, how large, and how the camera sways is the seed's.

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

pub use scatter::{scatter, scatter_path};

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
