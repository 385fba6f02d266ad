//! The finest level of a kind as a mesh.

use std::ops::Range;

use glam::{DVec3, Vec3};

use super::place::Place;
use super::solid::Solid;

/// The mesh of a kind of object: what its table is measured from.
///
/// In metres, +Y up, standing around the origin on y = 0. Positions are whole multiples of 2⁻¹⁴ m (0.06 mm) and so the
/// same numbers on every platform. It is of many parts, closed or with borders, which pass through each other where
/// they meet, as an artist's would.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Name of the kind, and of its table.
    pub name: String,
    /// How its levels are made.
    pub class: Class,
    /// In metres.
    pub positions: Vec<Vec3>,
    /// Indices of positions, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Each material and its run of triangles; the runs cover all of them in order.
    pub materials: Vec<(&'static str, Range<usize>)>,
}

/// How levels of a kind are made: presets of `lod bake`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Furniture; and what has leaves or hair, which as foliage or as a character would keep every strand and end at half
    /// its triangles.
    SmallProp,
    /// What one walks around.
    LargeProp,
    /// What rooms are made of.
    LevelArchitecture,
    /// Houses and streets, seen from afar.
    Vista,
    /// The crowd.
    Character,
}

impl Class {
    /// Name of the preset.
    pub fn name(self) -> &'static str {
        match self {
            Self::SmallProp => "small-prop",
            Self::LargeProp => "large-prop",
            Self::LevelArchitecture => "level-architecture",
            Self::Vista => "vista",
            Self::Character => "character",
        }
    }
}

/// A kind being put together.
#[derive(Default)]
pub(super) struct Assembly(Vec<Part>);

/// Equal solids of one material.
struct Part {
    material: &'static str,
    solid: Solid,
    places: Vec<Place>,
}

impl Assembly {
    /// Puts one at each of these places.
    pub fn put(&mut self, material: &'static str, solid: Solid, places: impl IntoIterator<Item = Place>) {
        self.0.push(Part { material, solid, places: places.into_iter().collect() });
    }

    /// All of it as one mesh: materials in order of their names, parts in the order in which they were put.
    pub fn model(mut self, name: &str, class: Class) -> Model {
        self.0.sort_by_key(|part| part.material);
        let mut model = Model {
            name: name.to_owned(),
            class,
            positions: Vec::new(),
            triangles: Vec::new(),
            materials: Vec::new(),
        };
        self.0.iter().for_each(|part| model.add(part));
        model
    }
}

/// Steps of a position per metre.
const STEPS: f64 = 16384.0;

impl Model {
    fn add(&mut self, part: &Part) {
        let start = self.triangles.len();
        for place in &part.places {
            let first = self.positions.len() as u32;
            self.positions.extend(part.solid.positions.iter().map(|&p| rounded(place.apply(p))));
            self.triangles.extend(part.solid.triangles.iter().map(|t| t.map(|corner| first + corner)));
        }
        let end = self.triangles.len();
        match self.materials.last_mut() {
            Some((material, run)) if *material == part.material => run.end = end,
            _ => self.materials.push((part.material, start..end)),
        }
    }
}

impl Model {
    /// The corners of the box around it.
    pub fn extent(&self) -> [Vec3; 2] {
        let corners = |[low, high]: [Vec3; 2], &p: &Vec3| [low.min(p), high.max(p)];
        self.positions.iter().fold([Vec3::MAX, Vec3::MIN], corners)
    }
}

fn rounded(position: DVec3) -> Vec3 {
    (position * STEPS).round().as_vec3() / STEPS as f32
}
