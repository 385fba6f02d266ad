//! A kind of object: a name, what it is made of, and how objects of it are treated.

use glam::Vec3;

use super::model::{Assembly, Class, Model};
use crate::bounds::Sphere;
use crate::scene::Settings;
use crate::table::{LevelRecord, LodTable};

/// What an artist would hand in: a named object in metres, standing on the point it is placed at.
pub(super) struct Kind {
    pub name: String,
    pub class: Class,
    /// Width, height and depth of the box around it.
    pub size: [f64; 3],
    pub settings: Settings,
    build: Box<dyn Fn(&mut Assembly)>,
}

impl Kind {
    /// `build` is called when somebody asks for the model.
    pub fn new(
        name: impl Into<String>,
        class: Class,
        size: [f64; 3],
        build: impl Fn(&mut Assembly) + 'static,
    ) -> Self {
        Self { name: name.into(), class, size, settings: Settings::default(), build: Box::new(build) }
    }

    /// Not drawn beyond this distance, in metres.
    pub fn seen_to(mut self, distance: f64) -> Self {
        self.settings.draw_distance = distance as f32;
        self
    }

    /// Factor on its benefit.
    pub fn importance(mut self, factor: f32) -> Self {
        self.settings.importance = factor;
        self
    }

    /// Factor on its cost, for skinning or an expensive material.
    pub fn cost(mut self, factor: f32) -> Self {
        self.settings.cost_multiplier = factor;
        self
    }

    /// Its finest level.
    pub fn model(&self) -> Model {
        let mut assembly = Assembly::default();
        (self.build)(&mut assembly);
        let model = assembly.model(&self.name, self.class);
        debug_assert!(fits(model.extent(), self.size), "{} is {:?}", self.name, model.extent());
        model
    }

    /// The table of what has not been measured: its finest level alone.
    ///
    /// # Panics
    /// A kind without an extent is a mistake in this crate.
    pub fn unmeasured(&self) -> LodTable {
        let model = self.model();
        let [low, high] = model.extent();
        let bounds = Sphere::new((low + high) / 2.0, (high - low).length() / 2.0);
        let finest = LevelRecord::new(model.triangles.len() as u32, model.positions.len() as u32);
        LodTable::new(&self.name, bounds, vec![finest]).expect("every kind has an extent")
    }
}

/// Whether what reaches from a corner to another is in a box of this size but for a twentieth, fills three quarters of
/// each side, and stands on the ground.
fn fits([low, high]: [Vec3; 2], size: [f64; 3]) -> bool {
    let size = Vec3::from(size.map(|side| side as f32));
    let half = 0.55 * size.with_y(0.0);
    let is_inside = (low + half).cmpge(Vec3::ZERO).all() && high.cmple(half.with_y(1.05 * size.y)).all();
    is_inside && (high - low).cmpge(0.75 * size).all() && low.y < 0.1 * size.y
}
