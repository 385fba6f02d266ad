//! The scene that every peer is given, made from a seed.
//!
//! Objects are scattered over a square of ground, a hundred square metres to each. There are sixteen kinds, each with
//! one radius and one table of four levels: three.ez switches a kind by distance alone, so that sizes within a kind
//! would make its levels incomparable. The order of objects is that of the dice.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::camera::SCALE_PX;

/// Levels of every kind, 0 the finest.
pub const LEVELS: usize = 4;
/// A level is good enough while its geometric error looks no larger than this.
pub const TOLERANCE_PX: f32 = 1.0;

const KINDS: usize = 16;
const SEED: u64 = 1993;
/// Metres of a square's side that each object has to itself.
const SPACING: f32 = 10.0;
/// Objects stand no higher than this.
const HEIGHT: f32 = 30.0;

/// What objects of a kind have in common.
pub struct Kind {
    /// Of the bounding sphere, metres.
    pub radius: f32,
    /// Triangles per level.
    pub triangles: [u32; LEVELS],
    /// Geometric error per level, as a fraction of the radius: what thresholds on distance go by.
    pub errors: [f32; LEVELS],
    /// Accuracy per level: what a budget goes by.
    pub accuracies: [f32; LEVELS],
}

impl Kind {
    fn roll(dice: &mut Pcg64) -> Self {
        let triangles = dice.random_range(2_000..30_000u32);
        let (error, missing) = (dice.random_range(0.01..0.04f32), dice.random_range(0.002..0.02f32));
        Self {
            radius: dice.random_range(0.5..6.0),
            triangles: [triangles, triangles / 4, triangles / 16, triangles / 64],
            errors: [0.0, 1.0, 3.0, 9.0].map(|times| error * times),
            accuracies: [1.0, 2.5, 6.0, 15.0].map(|times| 1.0 - missing * times),
        }
    }

    /// The distance in metres from which on each level is good enough.
    pub fn distances(&self) -> [f32; LEVELS] {
        self.errors.map(|error| error * self.radius * SCALE_PX / TOLERANCE_PX)
    }
}

/// One object.
#[derive(Clone, Copy)]
pub struct Instance {
    pub center: [f32; 3],
    /// Index into [`Scene::kinds`].
    pub kind: usize,
}

/// Objects and their kinds.
pub struct Scene {
    /// Metres of a side of the ground.
    pub side: f32,
    pub kinds: Vec<Kind>,
    pub instances: Vec<Instance>,
}

impl Scene {
    pub fn scatter(objects: usize) -> Self {
        let mut dice = Pcg64::seed_from_u64(SEED);
        let side = SPACING * (objects as f32).sqrt();
        let kinds = (0..KINDS).map(|_| Kind::roll(&mut dice)).collect();
        let mut instance = || Instance {
            center: [side, HEIGHT, side].map(|length| length * dice.random::<f32>()),
            kind: dice.random_range(0..KINDS),
        };
        Self { side, kinds, instances: (0..objects).map(|_| instance()).collect() }
    }

    pub fn len(&self) -> usize {
        self.instances.len()
    }

    pub fn kind(&self, instance: &Instance) -> &Kind {
        &self.kinds[instance.kind]
    }
}
