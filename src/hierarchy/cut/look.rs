//! How large an error is on the screen, and for how long that is known.
//!
//! A look holds for the eye anywhere within an *allowance* of where it is. What is worth about as much as the next split
//! or contraction is looked at *closely*. Of what is worth far less than the next split, or far more than the next
//! contraction, it is enough to know that it stays so, and that holds for longer (M. Duchaineau et al., "ROAMing
//! terrain", 1997, defer priorities likewise).

use glam::Vec3;

use crate::hierarchy::Operation;
use crate::hierarchy::cone::other_side;
use crate::view::Lens;

/// The share of the distance that an eye may travel before what it sees closely is looked at again. More makes for less
/// work and looser bounds: they are too large by this share.
const CLOSE: f32 = 0.125;

/// The same for what is out of view.
const ASIDE: f32 = 0.5;

/// The same, at most, for what is far from the brink.
const FAR: f32 = 0.75;

/// What errors count outside all frusta: enough to keep coarse what is behind the camera, in good order.
const UNSEEN: f32 = 1.0 / 1024.0;

/// How far from the brink something has to be, as a share of it, so as not to matter.
const APART: f32 = 0.8;

/// What an operation can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    Split,
    Merge,
}

/// What the next split and the next contraction were worth after the last update: no split that is worth less matters,
/// and no contraction that is worth more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Brink {
    pub(super) split: f32,
    pub(super) merge: f32,
}

impl Brink {
    /// Everything matters.
    pub(super) const UNKNOWN: Self = Self { split: 0.0, merge: f32::INFINITY };

    fn is_far(&self, way: Way, priority: f32) -> bool {
        match way {
            Way::Split => priority <= self.split * APART,
            Way::Merge => priority > self.merge / APART,
        }
    }
}

/// What an operation is worth, and until when: until what eyes have travelled, in object units, and what frusta have
/// turned, in chords of their normals, times `reach`, add up to `later`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    /// The error on the screen in px, divided by the scale of the first view.
    pub(super) priority: f32,
    pub(super) later: f32,
    pub(super) reach: f32,
}

impl Look {
    /// Of no view.
    const NOTHING: Self = Self { priority: 0.0, later: f32::INFINITY, reach: 0.0 };

    /// What the view makes of it that shows most, as long as all hold. Scales are those of the views, compared with
    /// the first.
    fn over(lenses: &[Lens], look: impl Fn(&Lens) -> Look) -> Self {
        lenses.iter().fold(Self::NOTHING, |all, lens| {
            let one = look(lens);
            Self {
                priority: all.priority.max(one.priority * lens.scale_px / lenses[0].scale_px),
                later: all.later.min(one.later),
                reach: all.reach.max(one.reach),
            }
        })
    }

    /// At least the error, whatever is done with it.
    pub(super) fn closely(lenses: &[Lens], operation: &Operation, way: Way) -> Self {
        Self::over(lenses, |lens| Glance::new(lens, operation).close(way))
    }

    /// That an operation is far from the brink, if that can be known for longer: for a split at least the error, for a
    /// contraction at most.
    pub(super) fn from_afar(lenses: &[Lens], operation: &Operation, way: Way, brink: &Brink) -> Option<Self> {
        let look = match way {
            Way::Split => {
                Self::over(lenses, |lens| Glance::new(lens, operation).most_below(brink.split * APART))
            }
            Way::Merge => {
                Self::over(lenses, |lens| Glance::new(lens, operation).least_above(brink.merge / APART))
            }
        };
        brink.is_far(way, look.priority).then_some(look)
    }
}

/// An operation as a view has it.
struct Glance<'a> {
    lens: &'a Lens,
    operation: &'a Operation,
    /// How far the middle of the sphere is from the eye, and how far the sphere itself.
    away: f32,
    gap: f32,
    /// The line of sight to the middle, and how far the others to the sphere pass it.
    sight: Vec3,
    wide: f32,
}

impl<'a> Glance<'a> {
    fn new(lens: &'a Lens, operation: &'a Operation) -> Self {
        let to = operation.sphere.center - lens.eye;
        let away = to.length_squared().sqrt();
        let radius = operation.sphere.radius;
        let (sight, wide) = if lens.perspective { (to / away, radius) } else { (lens.forward, 0.0) };
        Self { lens, operation, away, gap: away - radius, sight, wide }
    }

    /// At least the error until the eye has come nearer by a share of the distance, or what is in view and may be
    /// contracted is well outside, or what is not may come in.
    fn close(&self, way: Way) -> Look {
        let inside = self.depth();
        let is_seen = inside >= 0.0;
        if is_seen && way == Way::Split {
            return self.most(CLOSE);
        }
        let margin = if is_seen { inside + 0.25 * self.operation.sphere.radius } else { -inside };
        let (allowance, share) = if is_seen { (CLOSE, 1.0) } else { (ASIDE, UNSEEN) };
        let Look { priority, later, .. } = self.most(allowance);
        let later = later.min(margin);
        Look { priority: share * priority, later, reach: self.away + later }
    }

    /// At least the error, in view or not, for as long as that can stay below `limit`.
    fn most_below(&self, limit: f32) -> Look {
        self.most((1.0 - self.operation.error / (limit * self.gap)).clamp(CLOSE, FAR))
    }

    /// At least the error, in view or not. Where the line of sight goes with the eye, turns do not matter.
    fn most(&self, allowance: f32) -> Look {
        let travel = (allowance * self.gap).max(-self.gap).max(self.lens.near);
        let slant = self.operation.cone.largest_sine(self.sight, (self.wide + travel) / self.away);
        Look {
            priority: slant * self.operation.error / self.distance(-travel),
            later: travel,
            reach: if self.lens.perspective { 0.0 } else { self.away },
        }
    }

    /// At most the error, while it is in view, for as long as that can stay above `limit`; nothing where it is not.
    fn least_above(&self, limit: f32) -> Look {
        let slack = self.operation.error / (limit * self.gap) - 1.0;
        let travel = ((0.5 * slack).clamp(CLOSE, FAR) * self.gap).min(self.depth());
        if travel.is_nan() || travel <= 0.0 {
            return Look::NOTHING;
        }
        let (sine, turned) = (self.operation.cone.largest_sine(self.sight, 0.0), travel / self.away);
        let slant = (sine * other_side(turned) - other_side(sine) * turned).max(0.0);
        Look {
            priority: slant * self.operation.error / self.distance(travel),
            later: travel,
            reach: self.away + travel,
        }
    }

    /// What errors are divided by, so much farther away.
    fn distance(&self, farther: f32) -> f32 {
        if self.lens.perspective { (self.gap + farther).max(self.lens.near) } else { 1.0 }
    }

    /// How deep the sphere reaches into the frustum: negative where it is outside.
    fn depth(&self) -> f32 {
        let sphere = &self.operation.sphere;
        let planes = self.lens.frustum.planes.iter();
        planes.map(|plane| plane.distance(sphere.center)).fold(f32::INFINITY, f32::min) + sphere.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Sphere;
    use crate::hierarchy::Cone;
    use crate::hierarchy::cut::sight::{Motion, Sight};
    use crate::view::View;
    use glam::{DVec3, Quat, Vec2};
    use proptest::prelude::*;

    const WINDOW: Vec2 = Vec2::new(800.0, 600.0);

    fn camera(eye: Vec3, turn: f32) -> View {
        View::perspective(1.0, WINDOW).at(eye, Quat::from_rotation_y(turn))
    }

    fn flat_camera(eye: Vec3, turn: f32) -> View {
        View::orthographic(30.0, WINDOW).at(eye, Quat::from_rotation_y(turn))
    }

    fn place() -> impl Strategy<Value = Vec3> {
        let side = -50.0f32..50.0;
        (side.clone(), side.clone(), side).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    fn operation(center: Vec3, radius: f32, cone: Cone) -> Operation {
        Operation { ends: [0, 1], triangles: 2, error: 1.0, cone, sphere: Sphere::new(center, radius) }
    }

    /// The error as it is seen, which is upright.
    fn seen(view: &View, operation: &Operation) -> Option<f32> {
        let lens = view.lens(DVec3::ZERO);
        let unit = lens.unit_px(&operation.sphere) / lens.scale_px;
        let sight =
            if lens.perspective { (operation.sphere.center - view.eye).normalize() } else { lens.forward };
        lens.frustum.sees(&operation.sphere).then(|| Vec3::Z.cross(sight).length() * unit)
    }

    proptest! {
        #[test]
        fn a_look_holds_until_it_is_due(
            (eye, center, radius, turn) in (place(), place(), 0.01f32..20.0, -3.0f32..3.0),
            (brink, is_flat) in (0.001f32..1.0, any::<bool>()),
            steps in proptest::collection::vec((place(), -0.2f32..0.2), 1..20),
        ) {
            let operation = operation(center, radius, Cone::new(Vec3::Z, 0.0));
            let camera = if is_flat { flat_camera } else { camera };
            let (mut sight, mut eye, mut turn) = (Sight::default(), eye, turn);
            sight.renew([&camera(eye, turn)].into_iter());
            let brink = Brink { split: brink, merge: brink };
            let close = [Way::Split, Way::Merge].map(|way| Look::closely(sight.lenses(), &operation, way));
            let [split, merge] = [Way::Split, Way::Merge]
                .map(|way| Look::from_afar(sight.lenses(), &operation, way, &brink));
            let (mut travelled, mut turned) = (0.0, 0.0);
            for (step, angle) in steps {
                (eye, turn) = (eye + step * 0.02, turn + angle * 0.2);
                let view = camera(eye, turn);
                if let Motion::Moved { travel, turn } = sight.renew([&view].into_iter()) {
                    (travelled, turned) = (travelled + travel as f32, turned + turn as f32);
                }
                let holds = |look: &Look| travelled + turned * look.reach <= look.later;
                let seen = seen(&view, &operation);
                for look in close.iter().chain(&split).filter(|look| holds(look)) {
                    prop_assert!(look.priority >= seen.unwrap_or(0.0) * 0.999, "{look:?} {seen:?}");
                }
                for look in merge.iter().filter(|look| holds(look)) {
                    prop_assert!(seen.is_some_and(|seen| look.priority <= seen * 1.001 + 2e-3), "{look:?} {seen:?}");
                }
            }
        }
    }

    #[test]
    fn what_is_out_of_view_counts_next_to_nothing_and_what_is_near_counts_more() {
        let lens = camera(Vec3::ZERO, 0.0).lens(DVec3::ZERO);
        let at = |z: f32| {
            let operation = operation(Vec3::Z * z, 1.0, Cone::EVERY);
            Look::closely(&[lens], &operation, Way::Merge).priority
        };
        let [behind, near, far] = [10.0, -10.0, -100.0].map(at);
        assert!(behind < far / 50.0 && far < near / 9.0);
        assert!((1.0 / 9.0..1.2 / 9.0).contains(&near), "{near}");
    }

    /// What is far from the brink may be left alone longer, and what is near it is not far.
    #[test]
    fn what_does_not_matter_is_looked_at_less() {
        let lenses = [camera(Vec3::ZERO, 0.0).lens(DVec3::ZERO)];
        let operation = operation(Vec3::Z * -10.0, 1.0, Cone::EVERY);
        let close = Look::closely(&lenses, &operation, Way::Merge);
        for (way, brink) in [(Way::Split, 10.0 * close.priority), (Way::Merge, 0.1 * close.priority)] {
            let far =
                |brink| Look::from_afar(&lenses, &operation, way, &Brink { split: brink, merge: brink });
            assert!(far(brink).is_some_and(|look| look.later > 3.0 * close.later), "{way:?}");
            assert_eq!(far(close.priority), None, "{way:?}");
        }
    }
}
