//! Which meshes are much larger than their neighbours.

use glam::{DMat4, DVec3};

use super::Place;
use crate::bounds::Aabb;

/// How many times as far as half of the others it reaches.
const TIMES_OTHERS: f64 = 4.0;

/// The least share of the scene's size.
const OF_SCENE: f64 = 0.25;

/// How many chunks' worth of triangles it has at least.
const CHUNKS: usize = 2;

/// What is shown, as far as sizes go.
pub(super) struct Sizes {
    /// Mesh and radius, in the scene's units, of everything that is shown.
    shown: Vec<(usize, f64)>,
    /// Half the diagonal of the box around it all.
    scene: f64,
}

impl Sizes {
    /// `boxes` has that of each place's mesh, in the mesh's own units.
    pub(super) fn of(places: &[Place], boxes: &[Aabb]) -> Self {
        let spheres: Vec<(DVec3, f64)> =
            places.iter().zip(boxes).map(|(place, b)| sphere(b, &place.world)).collect();
        let low = spheres.iter().fold(DVec3::INFINITY, |low, &(center, radius)| low.min(center - radius));
        let high =
            spheres.iter().fold(DVec3::NEG_INFINITY, |high, &(center, radius)| high.max(center + radius));
        let shown = places.iter().zip(&spheres).map(|(place, &(_, radius))| (place.mesh, radius)).collect();
        Self { shown, scene: 0.5 * (high - low).length() }
    }

    /// Whether a mesh of so many triangles is large where a chunk may have `most`.
    pub(super) fn is_large(&self, mesh: usize, triangles: usize, most: usize) -> bool {
        let (own, mut others): (Vec<f64>, Vec<f64>) = {
            let (own, others): (Vec<_>, Vec<_>) = self.shown.iter().partition(|&&(m, _)| m == mesh);
            let radii = |of: Vec<(usize, f64)>| of.into_iter().map(|(_, radius)| radius).collect();
            (radii(own), radii(others))
        };
        others.sort_unstable_by(f64::total_cmp);
        let Some(&half) = others.get(others.len() / 2) else { return false };
        let radius = own.into_iter().fold(0.0, f64::max);
        triangles > CHUNKS.saturating_mul(most)
            && radius >= TIMES_OTHERS * half
            && radius >= OF_SCENE * self.scene
    }
}

/// Around a box that is moved.
fn sphere(b: &Aabb, world: &DMat4) -> (DVec3, f64) {
    if b.is_empty() {
        return (world.w_axis.truncate(), 0.0);
    }
    let (low, high) = (b.min.as_dvec3(), b.max.as_dvec3());
    let stretch = [world.x_axis, world.y_axis, world.z_axis].map(|axis| axis.truncate().length());
    let radius = 0.5 * (high - low).length() * stretch.into_iter().fold(0.0, f64::max);
    (world.transform_point3(0.5 * (low + high)), radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A mesh of radius `radius`, and `rocks` of radius 1 in a row.
    fn sizes(radius: f32, rocks: usize, apart: f64) -> Sizes {
        let place = |i: usize| Place {
            node: i,
            mesh: usize::from(i > 0),
            world: DMat4::from_translation(DVec3::X * (i as f64 * apart)),
        };
        let cube = |r: f32| {
            let corner = Vec3::splat(r / 3_f32.sqrt());
            Aabb { min: -corner, max: corner }
        };
        let places: Vec<Place> = (0..=rocks).map(place).collect();
        let boxes: Vec<Aabb> = (0..=rocks).map(|i| cube(if i == 0 { radius } else { 1.0 })).collect();
        Sizes::of(&places, &boxes)
    }

    #[test]
    fn a_track_among_rocks_is_large_and_a_rock_is_not() {
        let sizes = sizes(50.0, 9, 5.0);
        assert!(sizes.is_large(0, 10_000, 4096));
        assert!(!sizes.is_large(0, 8192, 4096), "two chunks would do");
        assert!(!sizes.is_large(1, 100_000, 4096), "a statue has many triangles, but is small");
    }

    #[test]
    fn without_neighbours_or_in_a_scene_much_larger_nothing_is_large() {
        assert!(!sizes(50.0, 0, 0.0).is_large(0, 1_000_000, 4096));
        assert!(!sizes(3.9, 9, 0.1).is_large(0, 1_000_000, 4096));
        assert!(!sizes(50.0, 9, 1000.0).is_large(0, 1_000_000, 4096));
    }
}
