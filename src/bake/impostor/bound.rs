//! How far what is seen can be from where the mesh is: the bound and its proof.
//!
//! All about the middle, in units of the object. The eye is at distance D in the unit direction v. It sees a point p, of
//! a ball of radius R < D, on the plane through the middle across v, at π(p) = p⊥ · D / (D − p·v), where p⊥ is the part of
//! p across v. With sin α = R / D no point of the ball is seen farther than α from the middle, |p⊥| ≤ (D − p·v) tan α, and
//! D / (D − p·v) is at most κ = D / (D − R).
//!
//! **Along.** Let q = p − z f for a unit vector f at the angle θ to v. Then
//! π(q) − π(p) = −D / (D − q·v) · z · (f⊥ + cos θ · p⊥ / (D − p·v)), and so
//! |π(q) − π(p)| ≤ κ |z| (sin θ + |cos θ| tan α) = κ |z| sin(θ + α) / cos α, for θ ≤ 90°; and never more than κ |z| / cos α.
//!
//! **Across.** For any q, π(q) − π(p) = D / (D − q·v) · ((q − p)⊥ + (q − p)·v · p⊥ / (D − p·v)), and so by Cauchy and Schwarz
//! |π(q) − π(p)| ≤ κ |q − p| √(1 + tan² α) = κ |q − p| / cos α.
//!
//! A frame taken from f shows p on the plane across f: z = p·f. What stands (cross-quads; an octahedral impostor, whose
//! rays meet the planes of its frames) is off by *along* with θ = ∠(f, v). What turns (billboards) first turns p, about
//! the middle, by no more than 2 sin(half the angle) times its distance from the axis, and is off by *across* for that
//! and by *along* for what comes after, θ being the angle between v and the quad. What is read from the atlas at a point
//! is what was taken within a texel each way: *across* for √2 texels, by which R is enlarged.
//!
//! The runtime projects an error at the nearest point of the bound, κ-fold: so κ is left out here. In angle and
//! distance all of it only falls as D grows.

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2, TAU};

use glam::DVec3;

use super::{Facing, Frame, Impostor, Kind, Octahedron};

/// A viewer at some distance.
struct Lens {
    /// Half the angle under which everything is seen.
    alpha: f64,
    /// What is left of κ beside that of the bound.
    factor: f64,
}

impl Lens {
    /// Nobody is nearer than the ball.
    fn along(&self, z: f64, theta: f64) -> f64 {
        self.factor * z * (theta + self.alpha).min(FRAC_PI_2).sin() / self.alpha.cos()
    }

    fn across(&self, length: f64) -> f64 {
        self.factor * length / self.alpha.cos()
    }
}

impl Impostor {
    /// The bound for a viewer in this direction (of any length), at this distance from the middle, valid or not, as
    /// [`Impostor::error`] has it. Infinite for a viewer within the bound.
    pub fn error_at(&self, direction: DVec3, distance: f64) -> f64 {
        let Some(lens) = self.lens(distance) else { return f64::INFINITY };
        let direction = direction.normalize_or(self.front);
        let error = |frame: &Frame| match self.kind {
            Kind::Billboard { facing, .. } => {
                let (yaw, elevation) = self.basis().angles(direction);
                let turned = angle_between_yaws(self.basis().angles(frame.direction).0, yaw);
                self.turned(&lens, facing, frame.reach(), turned, elevation.abs())
            }
            _ => {
                let theta = frame.direction.angle_between(direction);
                lens.along(frame.reach(), if self.is_two_sided() { theta.min(PI - theta) } else { theta })
            }
        };
        let most = if self.is_two_sided() {
            self.frames.iter().map(error).fold(0.0, f64::max)
        } else {
            let shown = self.sights(direction).into_iter().map(|sight| &self.frames[sight.frame]);
            shown.map(error).fold(0.0, f64::max)
        };
        most + self.texel_error(&lens)
    }

    /// The bound for all that is valid.
    pub(super) fn error_everywhere(&self) -> f64 {
        let Some(lens) = self.lens(self.validity.nearest) else { return f64::INFINITY };
        let [low, high] = self.validity.elevation_deg.map(f64::to_radians);
        let shown = match self.kind {
            Kind::Billboard { facing, frames } => {
                let turned = self.validity.yaw_deg.to_radians() / f64::from(frames);
                let elevation = high.max(-low);
                let error = |frame: &Frame| self.turned(&lens, facing, frame.reach(), turned, elevation);
                self.frames.iter().map(error).fold(0.0, f64::max)
            }
            Kind::CrossQuads { .. } => {
                self.frames.iter().map(|frame| lens.along(frame.reach(), FRAC_PI_2)).fold(0.0, f64::max)
            }
            Kind::Octahedral { .. } => {
                let errors = self.widest_angles().into_iter().zip(&self.frames);
                errors.map(|(theta, frame)| lens.along(frame.reach(), theta)).fold(0.0, f64::max)
            }
        };
        shown + self.texel_error(&lens)
    }

    /// Of a billboard that is turned by these angles, the second above the horizon.
    fn turned(&self, lens: &Lens, facing: Facing, reach: f64, yaw: f64, elevation: f64) -> f64 {
        let chord = |radius: f64, angle: f64| 2.0 * radius * (0.5 * angle).sin();
        match facing {
            Facing::Axis => lens.across(chord(self.girth, yaw)) + lens.along(reach, elevation),
            Facing::Viewer => {
                // Half the angle of two turns about axes across each other.
                let half = ((0.5 * yaw).cos() * (0.5 * elevation).cos()).acos();
                let at_once = chord(self.radius, 2.0 * half);
                let in_turn = chord(self.girth, yaw) + chord(self.radius, elevation);
                lens.across(at_once.min(in_turn)) + lens.along(reach, 0.0)
            }
        }
    }

    /// Per frame of an octahedral impostor, how far from it a direction can be to which it is shown. What is within half
    /// a turn of a corner of a spherical triangle is convex, so that no point is farther from a corner than the others are.
    fn widest_angles(&self) -> Vec<f64> {
        let mut widest = vec![0.0_f64; self.frames.len()];
        let Kind::Octahedral { frames, hemisphere } = self.kind else { return widest };
        let map = Octahedron::new(frames, hemisphere);
        for corners in map.triangles() {
            for [a, b] in [[0, 1], [1, 2], [2, 0]].map(|side| side.map(|k| corners[k])) {
                let angle = self.frames[a].direction.angle_between(self.frames[b].direction);
                widest[a] = widest[a].max(angle);
                widest[b] = widest[b].max(angle);
            }
        }
        let below = if hemisphere { (-self.validity.elevation_deg[0]).max(0.0).to_radians() } else { 0.0 };
        (0..)
            .zip(&mut widest)
            .filter(|(frame, _)| map.is_border(*frame))
            .for_each(|(_, angle)| *angle += below);
        widest
    }

    /// Half the width and height of what covers all that is shown, seen from the nearest distance.
    pub(super) fn covering(&self) -> [f64; 2] {
        let Some(lens) = self.lens(self.validity.nearest) else { return [f64::INFINITY; 2] };
        let kappa = self.validity.nearest / (self.validity.nearest - self.reach_with_texels());
        let seen = self.reach_with_texels() / lens.alpha.cos();
        let theta = self.widest_angles().into_iter().fold(0.0, f64::max).min(FRAC_PI_2);
        let flat = match self.kind {
            Kind::Octahedral { .. } => self.girth + self.radius * theta.sin(),
            _ => self.girth,
        };
        [(kappa * (flat + self.texel_reach())).min(seen), seen]
    }

    fn lens(&self, distance: f64) -> Option<Lens> {
        let reach = self.reach_with_texels();
        let factor = (distance - self.radius) / (distance - reach);
        (distance > reach).then(|| Lens { alpha: (reach / distance).asin(), factor })
    }

    fn is_two_sided(&self) -> bool {
        matches!(self.kind, Kind::CrossQuads { .. })
    }

    fn reach_with_texels(&self) -> f64 {
        self.radius + self.texel_reach()
    }

    fn texel_reach(&self) -> f64 {
        SQRT_2 / self.atlas.texels_per_unit
    }

    fn texel_error(&self, lens: &Lens) -> f64 {
        lens.across(self.texel_reach())
    }
}

/// The shorter way around.
fn angle_between_yaws(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(TAU);
    turn.min(TAU - turn)
}
