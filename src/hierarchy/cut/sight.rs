//! The views of a frame, and how far they have come since the first.

use glam::{DVec3, Vec3};

use crate::view::{Lens, View};

/// How views differ from those before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Motion {
    /// Not at all.
    Still,
    /// Eyes have travelled so far, in object units, and frusta have turned so far, in chords of their normals.
    Moved { travel: f64, turn: f64 },
    /// Nothing that is known of priorities holds any more.
    Cut,
}

/// The views of a frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Sight {
    lenses: Vec<Lens>,
}

impl Sight {
    /// Takes new views, all of which can be used.
    pub(super) fn renew<'a>(&mut self, views: impl Iterator<Item = &'a View>) -> Motion {
        let lenses: Vec<Lens> = views.map(|view| view.lens(DVec3::ZERO)).collect();
        let before = std::mem::replace(&mut self.lenses, lenses);
        if before == self.lenses {
            return Motion::Still;
        }
        let steps = || before.iter().zip(&self.lenses);
        let is_cut = before.len() != self.lenses.len()
            || steps().any(|(a, b)| {
                a.perspective != b.perspective
                    || a.near != b.near
                    || ratio(a, &before) != ratio(b, &self.lenses)
            });
        let travel = steps().map(|(a, b)| travelled(a, b)).fold(0.0, f64::max);
        let turn = steps().map(|(a, b)| turned(a, b)).fold(0.0, f64::max);
        let is_far = !travel.is_finite() || !turn.is_finite();
        if is_cut || is_far { Motion::Cut } else { Motion::Moved { travel, turn } }
    }

    pub(super) fn lenses(&self) -> &[Lens] {
        &self.lenses
    }

    /// The first view.
    pub(super) fn first(&self) -> Option<&Lens> {
        self.lenses.first()
    }
}

/// The scale of a view, compared with the first.
fn ratio(lens: &Lens, lenses: &[Lens]) -> f32 {
    lens.scale_px / lenses.first().map_or(1.0, |first| first.scale_px)
}

/// How far the eye and the planes that do not go through it have moved.
fn travelled(from: &Lens, to: &Lens) -> f64 {
    let offset = |lens: &Lens, plane: usize| f64::from(lens.frustum.planes[plane].distance(lens.eye));
    let moved = |plane| {
        let (a, b) = (offset(from, plane), offset(to, plane));
        if a == b { 0.0 } else { (a - b).abs() }
    };
    let planes = (0..from.frustum.planes.len()).map(moved).fold(0.0, f64::max);
    f64::from(from.eye.distance(to.eye)) + planes
}

/// How far the normals of the frustum have turned at most.
fn turned(from: &Lens, to: &Lens) -> f64 {
    let planes = from.frustum.planes.iter().zip(&to.frustum.planes);
    let chord = |a: Vec3, b: Vec3| f64::from(a.distance(b));
    planes.map(|(a, b)| chord(a.normal, b.normal)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn a_zoom_is_a_turn_and_another_kind_of_camera_a_cut() {
        let mut sight = Sight::default();
        let wide = View::perspective(1.0, Vec2::new(800.0, 600.0));
        assert_eq!(sight.renew([&wide].into_iter()), Motion::Cut);
        assert_eq!(sight.renew([&wide].into_iter()), Motion::Still);
        let narrow = View::perspective(0.5, Vec2::new(800.0, 600.0));
        let zoom = sight.renew([&narrow].into_iter());
        assert!(matches!(zoom, Motion::Moved { travel, turn } if turn > 0.1 && travel < 1e-3), "{zoom:?}");
        let flat = View::orthographic(10.0, Vec2::new(800.0, 600.0));
        assert_eq!(sight.renew([&flat].into_iter()), Motion::Cut);
        assert_eq!(sight.renew([].into_iter()), Motion::Cut);
    }
}
