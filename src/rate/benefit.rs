//! What drawing is worth: projected area, weighted by importance, focus and motion.

use crate::bounds::Sphere;
use crate::frame::OptionsError;
use crate::view::Lens;
use glam::Vec3;

/// What the benefit heeds beside size, accuracy and importance. The default heeds nothing else, so that turning the
/// camera moves no detail about.
///
/// Focus and motion are the heuristics of Funkhouser and Séquin 1993; they gave no formula, these are ours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenefitModel {
    /// How much benefit falls away from the point looked at: an object that misses it by the angle φ counts
    /// 1 / (1 + focus · sin²φ). 0 is off; 8 is strong. Never negative.
    pub focus: f32,
    /// How much benefit falls with apparent speed: an object that crosses `s` viewport heights per second counts
    /// 1 / (1 + motion · s). 0 is off; 1 is strong. Never negative.
    pub motion: f32,
    /// Detail whose projected error is below this many pixels is not bought, to save power. 0 is off. Needs tables
    /// with errors; an object never falls below what its error asks for.
    pub enough_px: f32,
}

impl Default for BenefitModel {
    fn default() -> Self {
        Self { focus: 0.0, motion: 0.0, enough_px: 0.0 }
    }
}

impl BenefitModel {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the option that is negative or not finite.
    pub fn check(&self) -> Result<(), OptionsError> {
        let valid = |x: f32| x.is_finite() && x >= 0.0;
        OptionsError::unless(valid(self.focus), "focus", "must be finite and not negative")?;
        OptionsError::unless(valid(self.motion), "motion", "must be finite and not negative")?;
        OptionsError::unless(valid(self.enough_px), "enough_px", "must be finite and not negative")
    }

    /// Whether the factor of [`BenefitModel::attention`] can differ from 1.
    pub fn is_plain(&self) -> bool {
        self.focus == 0.0 && self.motion == 0.0
    }

    /// The factor for focus and motion, in (0, 1].
    pub fn attention(&self, lens: &Lens, sphere: &Sphere, velocity: Vec3) -> f32 {
        let to = sphere.center - lens.eye;
        let distance = to.length_squared().sqrt().max(lens.near).max(f32::MIN_POSITIVE);
        let focus = 1.0 + self.focus * squared(miss(lens, sphere, to) / distance);
        let speed =
            across(velocity - lens.velocity, to / distance) * lens.scale_px / lens.distance(sphere.center);
        1.0 / (focus * (1.0 + self.motion * speed / lens.height_px))
    }
}

/// By how much the gaze misses the sphere: 0 when it hits.
fn miss(lens: &Lens, sphere: &Sphere, to: Vec3) -> f32 {
    let along = to.dot(lens.gaze);
    let lateral = (to.length_squared() - along * along).max(0.0).sqrt();
    let nearest = if along > 0.0 || !lens.perspective { lateral } else { to.length_squared().sqrt() };
    (nearest - sphere.radius).max(0.0)
}

/// The part of `velocity` across the line of sight.
fn across(velocity: Vec3, sight: Vec3) -> f32 {
    (velocity - sight * velocity.dot(sight)).length_squared().sqrt()
}

fn squared(x: f32) -> f32 {
    x * x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::View;
    use glam::{DVec3, Vec2};

    fn lens() -> Lens {
        View::perspective(1.0, Vec2::new(1000.0, 1000.0)).lens(DVec3::ZERO)
    }

    fn ball(x: f32, z: f32) -> Sphere {
        Sphere::new(Vec3::new(x, 0.0, z), 1.0)
    }

    #[test]
    fn focus_falls_away_from_the_gaze_and_is_full_on_it() {
        let model = BenefitModel { focus: 4.0, ..BenefitModel::default() };
        let at = |x| model.attention(&lens(), &ball(x, -10.0), Vec3::ZERO);
        assert_eq!(at(0.5), 1.0);
        assert!(at(3.0) < 1.0 && at(5.0) < at(3.0) && at(5.0) > 0.2);
    }

    #[test]
    fn motion_counts_only_across_the_line_of_sight() {
        let model = BenefitModel { motion: 1.0, ..BenefitModel::default() };
        let at = |velocity| model.attention(&lens(), &ball(0.0, -10.0), velocity);
        assert_eq!(at(Vec3::ZERO), 1.0);
        assert_eq!(at(Vec3::new(0.0, 0.0, 50.0)), 1.0);
        assert!(at(Vec3::new(5.0, 0.0, 0.0)) < 1.0);
    }
}
