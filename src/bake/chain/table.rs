//! From measured levels to what the runtime reads.

use glam::Vec3;

use super::{Chain, ChainLevel};
use crate::bounds::Sphere;
use crate::table::{LevelRecord, LodTable, TableError, accuracy_of};

/// How the accuracy of a level is told: what share of an object's benefit it has.
///
/// The runtime weighs accuracies of different objects against each other, so take one for all tables of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Accuracy {
    /// 1 − 2 · rms / radius, at least 0: from the largest root mean square distance of this and all finer levels, and the
    /// radius of the table's bound.
    ///
    /// Benefit is projected area times accuracy. An object of radius r whose surface is off by e shows it along its
    /// outline: a band 2πr long and e wide, of a disc of πr². So 2e/r is the share of its pixels that are wrong, at any
    /// distance, and what an object loses is an area in pixels as its benefit is. The mean counts and not the maximum,
    /// since one bent antenna is no band; with the maximum, all levels without the antenna would be worth the same.
    /// Take it unless there is a reason not to.
    #[default]
    Rms,
    /// 1 − error / radius, at least 0: from the contract itself. For those who fear the worst point more than the sum of
    /// all others; as no point is farther than the error, half of the outline is thought to be off by that much.
    Hausdorff,
    /// 1 − ½ / triangles ([`accuracy_of`]), and 1 for level 0: knows nothing of shape, but goes with tables that nobody
    /// measured.
    Triangles,
}

impl Accuracy {
    /// Of each level, finest first: 1 for level 0, never rising, from 0 to 1.
    fn of(self, levels: &[ChainLevel], radius: f64) -> Vec<f32> {
        let loss = |level: &ChainLevel| match self {
            Self::Rms => 2.0 * level.deviation.rms() / radius,
            Self::Hausdorff => f64::from(level.error) / radius,
            Self::Triangles => 1.0 - f64::from(accuracy_of(level.triangles() as u32)),
        };
        let so_far = |most: &mut f64, (i, level): (usize, &ChainLevel)| {
            *most = if i == 0 { 0.0 } else { most.max(loss(level)) };
            Some((1.0 - *most).max(0.0) as f32)
        };
        levels.iter().enumerate().scan(0.0, so_far).collect()
    }
}

/// Lines of the image that [`LevelRecord::min_size`] is worked out for.
const LINES: f64 = 1080.0;

/// A level that is exact is never too coarse; a diameter of a thousand images is as good as any.
const LARGEST_SIZE: f64 = 1000.0;

impl Chain {
    /// The table: what each level costs, its error and accuracy, and from which size on it is wanted.
    ///
    /// The bound is a sphere around the box of level 0 that holds all levels. `min_size` is the projected diameter at
    /// which the error of the next coarser level is one pixel of an image of 1080 lines; the coarsest level has 0. It
    /// goes by the name of level 0's mesh.
    ///
    /// # Errors
    /// Where a level is farther out, or an error larger, than single precision can tell.
    pub fn table(&self, accuracy: Accuracy) -> Result<LodTable, TableError> {
        let bounds = self.bounds();
        let accuracies = accuracy.of(&self.levels, f64::from(bounds.radius));
        let coarser = self.levels.iter().skip(1).map(Some).chain([None]);
        let records =
            self.levels.iter().zip(accuracies).zip(coarser).map(|((level, accuracy), coarser)| LevelRecord {
                triangles: level.triangles() as u32,
                vertices: level.vertices() as u32,
                draws: level.draws() as u32,
                bytes: level.bytes(),
                error: Some(level.error),
                accuracy,
                min_size: Some(coarser.map_or(0.0, |coarser| min_size(bounds.radius, coarser.error))),
            });
        LodTable::new(self.levels[0].mesh.name.clone(), bounds, records.collect())
    }

    /// Around the middle of level 0's box, with all levels inside.
    fn bounds(&self) -> Sphere {
        let center = self.levels[0].mesh.bounds().sphere().center;
        let distance = |p: &Vec3| p.as_dvec3().distance(center.as_dvec3());
        let positions = self.levels.iter().flat_map(|level| &level.mesh.positions);
        let radius = positions.map(distance).fold(0.0, f64::max);
        Sphere::new(center, rounded_up(radius))
    }
}

/// The projected diameter of an object, in heights of the image, at which an error of its is one pixel.
pub(in crate::bake) fn min_size(radius: f32, error: f32) -> f32 {
    (2.0 * f64::from(radius) / (f64::from(error) * LINES)).min(LARGEST_SIZE) as f32
}

pub(in crate::bake) fn rounded_up(value: f64) -> f32 {
    let nearest = value as f32;
    if f64::from(nearest) < value { nearest.next_up() } else { nearest }
}
