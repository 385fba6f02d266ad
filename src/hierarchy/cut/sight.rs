//! How large errors are on the screen, and for how long that is known.
//!
//! What an error is worth changes slowly with the camera, so it is not looked at in every frame (M. Duchaineau et al.,
//! "ROAMing terrain", 1997, defer priorities likewise). An operation's priority is worked out for the eye anywhere
//! within an *allowance* of where it is: an upper bound until the eye has travelled that far, or the frustum has turned
//! by so much that the operation may have come into view or left it.

use glam::{DVec3, Vec3};

use crate::bounds::Sphere;
use crate::hierarchy::Operation;
use crate::view::{Lens, View};

/// The share of the distance that an eye may travel before what it sees is looked at again. More makes for less work
/// and looser bounds: they are too large by this share.
const ALLOWANCE: f32 = 0.125;

/// What errors count outside all frusta: enough to keep coarse what is behind the camera, in good order.
const UNSEEN: f32 = 1.0 / 1024.0;

/// What an operation is worth until when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    /// At least the error on the screen in px, divided by the scale of the first view.
    pub(super) priority: f32,
    /// The travel, as in [`Sight::travel`], up to which that holds.
    pub(super) until_travel: f64,
    /// And the turn.
    pub(super) until_turn: f64,
}

/// How views differ from those before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    /// Not at all.
    Still,
    /// They have moved or turned.
    Moved,
    /// Nothing that is known of priorities holds any more.
    Cut,
}

/// The views of a frame, and how far they have come.
#[derive(Clone, Debug, Default)]
pub(super) struct Sight {
    lenses: Vec<Lens>,
    /// How far eyes have travelled so far, in object units.
    pub(super) travel: f64,
    /// How far frusta have turned so far, in chords of their normals.
    pub(super) turn: f64,
}

impl Sight {
    /// Takes new views, all of which can be used.
    pub(super) fn renew<'a>(&mut self, views: impl Iterator<Item = &'a View>) -> Motion {
        let lenses: Vec<Lens> = views.map(|view| view.lens(DVec3::ZERO)).collect();
        let before = std::mem::replace(&mut self.lenses, lenses);
        if before == self.lenses {
            return Motion::Still;
        }
        let is_cut = before.len() != self.lenses.len()
            || before.iter().zip(&self.lenses).any(|(a, b)| {
                a.perspective != b.perspective
                    || a.near != b.near
                    || ratio(a, &before) != ratio(b, &self.lenses)
            });
        let steps = || before.iter().zip(&self.lenses);
        let travel = steps().map(|(a, b)| travelled(a, b)).fold(0.0, f64::max);
        let turn = steps().map(|(a, b)| turned(a, b)).fold(0.0, f64::max);
        self.travel += travel;
        self.turn += turn;
        if is_cut || !self.travel.is_finite() || !self.turn.is_finite() {
            (self.travel, self.turn) = (0.0, 0.0);
            return Motion::Cut;
        }
        Motion::Moved
    }

    /// Whether there is no view.
    pub(super) fn is_empty(&self) -> bool {
        self.lenses.is_empty()
    }

    /// The first view.
    pub(super) fn first(&self) -> Option<&Lens> {
        self.lenses.first()
    }

    /// What an operation is worth in the view that shows most of it.
    pub(super) fn look(&self, operation: &Operation) -> Look {
        let mut all = Look { priority: 0.0, until_travel: f64::INFINITY, until_turn: f64::INFINITY };
        for lens in &self.lenses {
            let glance = Glance::new(lens, operation);
            all.priority = all.priority.max(glance.priority * ratio(lens, &self.lenses));
            all.until_travel = all.until_travel.min(self.travel + f64::from(glance.travel));
            all.until_turn = all.until_turn.min(self.turn + f64::from(glance.turn));
        }
        all
    }
}

/// What one view makes of an operation.
struct Glance {
    priority: f32,
    travel: f32,
    turn: f32,
}

impl Glance {
    fn new(lens: &Lens, operation: &Operation) -> Self {
        let Operation { sphere, cone, error, .. } = operation;
        let to = sphere.center - lens.eye;
        let away = to.length_squared().sqrt();
        let gap = away - sphere.radius;
        let inside = depth(lens, sphere);
        let is_seen = inside >= 0.0;
        // What is in view is sharp until it is well outside, what is not until it may come in.
        let margin = 0.5 * if is_seen { inside + 0.25 * sphere.radius } else { -inside };
        let travel = (ALLOWANCE * gap).max(-gap).max(lens.near).min(margin);
        let reach = sphere.radius + travel;
        let distance = if lens.perspective { (away - reach).max(lens.near) } else { 1.0 };
        let slant = match lens.perspective {
            true => cone.largest_sine(to / away, reach / away),
            false => cone.largest_sine(lens.forward, 0.0),
        };
        let seen = if is_seen { 1.0 } else { UNSEEN };
        Self { priority: seen * slant * error / distance, travel, turn: margin / (away + travel) }
    }
}

/// How deep a sphere reaches into the frustum: negative where it is outside.
fn depth(lens: &Lens, sphere: &Sphere) -> f32 {
    let least = lens.frustum.planes.iter().map(|p| p.distance(sphere.center)).fold(f32::INFINITY, f32::min);
    least + sphere.radius
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
    use crate::hierarchy::Cone;
    use glam::{Quat, Vec2};
    use proptest::prelude::*;

    fn camera(eye: Vec3, turn: f32) -> View {
        View::perspective(1.0, Vec2::new(800.0, 600.0)).at(eye, Quat::from_rotation_y(turn))
    }

    fn place() -> impl Strategy<Value = Vec3> {
        let side = -50.0f32..50.0;
        (side.clone(), side.clone(), side).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    /// The priority for a view that has never been anywhere else.
    fn fresh(view: &View, operation: &Operation) -> Look {
        let mut sight = Sight::default();
        sight.renew([view].into_iter());
        sight.look(operation)
    }

    proptest! {
        /// A fresh look allows for travel too, which is why it may be above one that is older.
        #[test]
        fn a_priority_bounds_what_is_seen_until_it_is_due(
            (eye, center, radius, turn) in (place(), place(), 0.01f32..20.0, -3.0f32..3.0),
            steps in proptest::collection::vec((place(), -0.2f32..0.2), 1..20),
        ) {
            let sphere = Sphere::new(center, radius);
            let operation = Operation { ends: [0, 1], triangles: 2, error: 1.0, cone: Cone::new(Vec3::Z, 0.0), sphere };
            let (mut sight, mut eye, mut turn) = (Sight::default(), eye, turn);
            sight.renew([&camera(eye, turn)].into_iter());
            let look = sight.look(&operation);
            for (step, angle) in steps {
                (eye, turn) = (eye + step * 0.02, turn + angle * 0.2);
                let view = camera(eye, turn);
                sight.renew([&view].into_iter());
                if sight.travel > look.until_travel || sight.turn > look.until_turn {
                    break;
                }
                let lens = view.lens(DVec3::ZERO);
                let unit = lens.unit_px(&sphere) / lens.scale_px;
                if lens.frustum.sees(&sphere) {
                    let sight = (center - eye).normalize();
                    let slant = Vec3::Z.cross(sight).length();
                    prop_assert!(look.priority >= slant * unit * 0.999, "{look:?} {unit}");
                }
            }
        }
    }

    #[test]
    fn what_is_out_of_view_counts_next_to_nothing_and_what_is_near_counts_more() {
        let at = |z: f32| Operation {
            ends: [0, 1],
            triangles: 2,
            error: 1.0,
            cone: Cone::EVERY,
            sphere: Sphere::new(Vec3::Z * z, 1.0),
        };
        let view = camera(Vec3::ZERO, 0.0);
        let [behind, near, far] = [10.0, -10.0, -100.0].map(|z| fresh(&view, &at(z)).priority);
        assert!(behind < far / 50.0 && far < near / 9.0);
        assert!((1.0 / 9.0..1.2 / 9.0).contains(&near), "{near}");
    }

    #[test]
    fn a_zoom_is_a_turn_and_another_kind_of_camera_a_cut() {
        let mut sight = Sight::default();
        let wide = camera(Vec3::ZERO, 0.0);
        assert_eq!(sight.renew([&wide].into_iter()), Motion::Cut);
        assert_eq!(sight.renew([&wide].into_iter()), Motion::Still);
        let narrow = View::perspective(0.5, Vec2::new(800.0, 600.0));
        assert_eq!(sight.renew([&narrow].into_iter()), Motion::Moved);
        assert!(sight.turn > 0.1 && sight.travel < 1e-3);
        let flat = View::orthographic(10.0, Vec2::new(800.0, 600.0));
        assert_eq!(sight.renew([&flat].into_iter()), Motion::Cut);
        assert_eq!(sight.renew([].into_iter()), Motion::Cut);
    }
}
