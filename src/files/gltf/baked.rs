//! What a bake has measured of a level, as the extras of its mesh tell.

use ::gltf::json;
use glam::{DMat3, DMat4};
use serde_json::Value;

use crate::table::LevelRecord;

/// How far from level 0 a mesh is, in its own units, and how accurate.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Baked {
    error: Option<f64>,
    accuracy: Option<f64>,
    /// What `extras.lod_geomorph_max` says.
    geomorph: Option<f64>,
}

impl Baked {
    /// What `extras.lod_error`, `extras.lod_accuracy` and `extras.lod_geomorph_max` say.
    pub(super) fn of(mesh: &json::Mesh) -> Result<Self, String> {
        let extras = mesh.extras.as_ref().map(|e| serde_json::from_str::<Value>(e.get()));
        let extras = extras.transpose().map_err(|e| format!("its extras cannot be read: {e}"))?;
        let number = |key, most: f64, rule| match extras.as_ref().and_then(|e| e.get(key)) {
            Some(value) => match value.as_f64().filter(|x| (0.0..=most).contains(x)) {
                Some(number) => Ok(Some(number)),
                None => Err(format!("its extras.{key} must be {rule}")),
            },
            None => Ok(None),
        };
        let error = number("lod_error", f64::from(f32::MAX), "a number that is finite and not negative")?;
        let geomorph =
            number("lod_geomorph_max", f64::from(f32::MAX), "a number that is finite and not negative")?;
        Ok(Self { error, accuracy: number("lod_accuracy", 1.0, "between 0 and 1")?, geomorph })
    }

    /// Whether its morph target is the way to the next coarser level, which does not lead out of what holds both.
    pub(super) fn is_geomorph(&self) -> bool {
        self.geomorph.is_some()
    }

    /// Of all parts of a level, each with its transform: the worst of each, unless something is not known of one.
    pub(super) fn joined(parts: impl Iterator<Item = (Self, DMat4)>) -> Self {
        let both = |a: Option<f64>, b: Option<f64>, worse: fn(f64, f64) -> f64| Some(worse(a?, b?));
        let scaled =
            |(part, place): (Self, DMat4)| Self { error: part.error.map(|e| e * stretch(&place)), ..part };
        let worst = parts.map(scaled).reduce(|a, b| Self {
            error: both(a.error, b.error, f64::max),
            accuracy: both(a.accuracy, b.accuracy, f64::min),
            geomorph: None,
        });
        worst.unwrap_or_default()
    }

    /// Tells a level of it.
    pub(super) fn tell(self, level: &mut LevelRecord) {
        level.error = self.error.map(rounded_up);
        level.accuracy = self.accuracy.map_or(level.accuracy, |accuracy| accuracy as f32);
    }

    /// Level 0 is what others are measured against: where they were and nobody says so of it, it is exact.
    pub(super) fn tell_finest(self, level: &mut LevelRecord, coarser: &[Self]) {
        let known =
            |all: fn(&Self) -> Option<f64>| !coarser.is_empty() && coarser.iter().all(|c| all(c).is_some());
        let error = self.error.or(known(|c| c.error).then_some(0.0));
        let accuracy = self.accuracy.or(known(|c| c.accuracy).then_some(1.0));
        Self { error, accuracy, geomorph: None }.tell(level);
    }
}

/// The most by which a transform makes lengths longer, or a bit more where its axes are oblique: the root of a bound on
/// the largest eigenvalue of MᵀM, its largest sum of a row.
fn stretch(transform: &DMat4) -> f64 {
    let m = DMat3::from_mat4(*transform);
    let squared = m.transpose() * m;
    let rows = [0, 1, 2].map(|row| squared.row(row).abs().element_sum());
    rows.into_iter().fold(0.0, f64::max).sqrt()
}

fn rounded_up(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) < x { nearest.next_up() } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};

    #[test]
    fn a_stretch_is_that_of_the_longest_axis() {
        let turned = DMat4::from_scale_rotation_translation(
            DVec3::new(1.0, -3.0, 2.0),
            DQuat::from_rotation_y(0.7),
            DVec3::ONE,
        );
        assert!((stretch(&turned) - 3.0).abs() < 1e-12);
        assert_eq!(stretch(&DMat4::IDENTITY), 1.0);
        let shear = DMat4::from_cols_array_2d(&[
            [1., 0., 0., 0.],
            [1., 1., 0., 0.],
            [0., 0., 1., 0.],
            [0., 0., 0., 1.],
        ]);
        assert!((1.618..1.8).contains(&stretch(&shear)), "no less than the golden ratio");
    }
}
