//! How far a geomorph moves things, in object units and on the screen.

use glam::Vec3;

use crate::bake::Mesh;
use crate::bounds::Sphere;
use crate::view::Lens;

/// How far vertices are from where they go, in object units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Movement {
    /// No point of the surface goes farther: proved, since points of a triangle go as its corners do, each by its
    /// share, and rounded up.
    pub max: f32,
    /// The mean over the finer surface, each triangle by its area with the mean of its corners: no less than the mean
    /// over all points. Over the triangles where none has an area.
    pub mean: f64,
}

/// What a switch does to the image if it is made at once: a geomorph spreads it over its frames.
///
/// What an eye notices is how far how much of the image jumps. Both are shares of the hard switch: a geomorph that
/// advances its weight by w in a frame moves nothing by more than w · `max_px` in it, and moves w · `energy_px3`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pop {
    /// No point of the object's surface jumps by more, in pixels, wherever it is on the object.
    pub max_px: f64,
    /// The mean jump over the surface, in pixels at the distance of the object's middle.
    pub mean_px: f64,
    /// Mean jump times projected area: pixels × square pixels.
    pub energy_px3: f64,
}

impl Movement {
    /// From a mesh to the same one with other positions.
    pub(super) fn between(from: &Mesh, to: &Mesh) -> Self {
        let ways = from.positions.iter().zip(&to.positions);
        let far: Vec<f64> = ways.map(|(a, b)| b.as_dvec3().distance(a.as_dvec3())).collect();
        let (mut sum, mut whole, mut plain) = (0.0, 0.0, 0.0);
        for corners in (0..from.triangles.len()).map(|t| from.corners(t)) {
            let mean = corners.iter().map(|&p| far[p as usize]).sum::<f64>() / 3.0;
            let area = area(corners.map(|p| from.positions[p as usize]));
            (sum, whole, plain) = (sum + area * mean, whole + area, plain + mean);
        }
        let mean = if whole > 0.0 { sum / whole } else { plain / from.triangles.len().max(1) as f64 };
        Self { max: rounded_up(far.into_iter().fold(0.0, f64::max)), mean }
    }

    /// What a hard switch looks like where the object's bound is `bounds` and its units are `scale` world units: the
    /// prediction of a pop. `max_px` is taken at the nearest point of the bound, the others at its middle
    /// ([`Lens::unit_px`], [`Lens::size_px`], [`Lens::area_px2`]).
    pub fn pop(&self, lens: &Lens, bounds: &Sphere, scale: f32) -> Pop {
        let unit_px = f64::from(lens.scale_px) / f64::from(lens.distance(bounds.center));
        let mean_px = self.mean * f64::from(scale) * unit_px;
        Pop {
            max_px: f64::from(self.max) * f64::from(scale) * f64::from(lens.unit_px(bounds)),
            mean_px,
            energy_px3: mean_px * f64::from(lens.area_px2(bounds)),
        }
    }
}

fn area([a, b, c]: [Vec3; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    0.5 * (b - a).cross(c - a).length()
}

/// To single precision, no less. A distance in double precision is off by less than its last place, which counts too.
fn rounded_up(distance: f64) -> f32 {
    let most = distance * (1.0 + 4.0 * f64::EPSILON);
    let nearest = most as f32;
    if f64::from(nearest) < most { nearest.next_up() } else { nearest }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec2};

    use super::*;
    use crate::bake::Surface;
    use crate::view::View;

    fn mesh(positions: [Vec3; 4]) -> Mesh {
        Surface { positions: positions.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]] }.into()
    }

    #[test]
    fn the_mean_counts_areas_and_the_maximum_corners() {
        let from = mesh([Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::new(-3.0, 1.0, 0.0)]);
        let mut to = from.clone();
        to.positions[3].z = 3.0;
        let movement = Movement::between(&from, &to);
        assert_eq!(movement.max, 3.0_f32.next_up(), "rounded up");
        // Areas of ½ and 2; in the second a mean of 1.
        assert!((movement.mean - 0.8).abs() < 1e-12, "{movement:?}");
        let flat = mesh([Vec3::ZERO; 4]);
        assert_eq!(Movement::between(&flat, &mesh([Vec3::X; 4])).mean, 1.0);
    }

    /// One unit is 100 pixels at distance 1.
    #[test]
    fn a_pop_is_as_large_as_the_view_says() {
        let view = View::perspective(2.0 * 0.5_f32.atan(), Vec2::new(100.0, 100.0));
        let lens = view.lens(DVec3::ZERO);
        let bounds = Sphere::new(Vec3::new(0.0, 0.0, -10.0), 2.0);
        let pop = Movement { max: 0.5, mean: 0.25 }.pop(&lens, &bounds, 2.0);
        assert!((pop.max_px - 0.5 * 2.0 * 100.0 / 8.0).abs() < 1e-4, "{pop:?}");
        assert!((pop.mean_px - 0.25 * 2.0 * 100.0 / 10.0).abs() < 1e-4, "{pop:?}");
        let area_px2 = std::f64::consts::PI * 20.0 * 20.0;
        assert!((pop.energy_px3 / (pop.mean_px * area_px2) - 1.0).abs() < 1e-4, "{pop:?}");
    }
}
