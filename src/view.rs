//! Cameras: what is in view, and how large it is on the screen.
//!
//! All screen-space maths of the crate is here. Per-frame maths uses only + − × ÷ √, so that every build decides
//! alike; the one exception is [`View::perspective`], which takes the tangent of an angle when a view is made.

use std::fmt;

use glam::{DVec3, Quat, Vec2, Vec3};

use crate::bounds::{Aabb, Sphere};

/// A window that the camera looks through: tangents at unit distance for a perspective view, world units for an
/// orthographic one. Asymmetric windows (VR eyes, tiles of a wall) are windows like any other.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Window {
    /// Left edge, usually negative.
    pub left: f32,
    /// Right edge.
    pub right: f32,
    /// Lower edge, usually negative.
    pub bottom: f32,
    /// Upper edge.
    pub top: f32,
}

impl Window {
    /// The window that reaches `half_width` and `half_height` to either side of the axis.
    pub fn symmetric(half_width: f32, half_height: f32) -> Self {
        Self { left: -half_width, right: half_width, bottom: -half_height, top: half_height }
    }
}

/// How space is mapped to the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Projection {
    /// Sizes fall with distance; the window is in tangents (as OpenXR's field of view, after `tan`).
    Perspective(Window),
    /// Sizes do not depend on distance; the window is in world units.
    Orthographic(Window),
}

/// A camera. It looks along its −Z axis, with +Y up and +X to the right.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct View {
    /// World position that `eye` is relative to.
    pub origin: DVec3,
    /// Position of the eye relative to `origin`.
    pub eye: Vec3,
    /// Rotation from camera to world.
    pub rotation: Quat,
    /// What the camera sees of the space before it.
    pub projection: Projection,
    /// Distance of the near plane, > 0 for a perspective view.
    pub near: f32,
    /// Distance of the far plane; may be infinite.
    pub far: f32,
    /// Width and height of the image in pixels.
    pub viewport_px: Vec2,
    /// Where the viewer looks, from (−1, −1) at the lower left to (1, 1) at the upper right; the centre if nobody
    /// knows.
    pub gaze: Option<Vec2>,
    /// Velocity of the eye in world units per second.
    pub velocity: Vec3,
}

impl View {
    /// A symmetric perspective view at the origin, looking along −Z: vertical field of view in radians, viewport in
    /// pixels, near 0.1 and far 1000. Pixels are square.
    ///
    /// This takes a tangent, whose last bit may differ between platforms; where recorded decisions must repeat on
    /// all of them, give [`Projection::Perspective`] the tangents themselves.
    pub fn perspective(fov_y: f32, viewport_px: Vec2) -> Self {
        let half_height = (fov_y * 0.5).tan();
        let half_width = half_height * viewport_px.x / viewport_px.y;
        Self::through(Projection::Perspective(Window::symmetric(half_width, half_height)), viewport_px)
    }

    /// A symmetric orthographic view at the origin, looking along −Z, `height` world units high.
    pub fn orthographic(height: f32, viewport_px: Vec2) -> Self {
        let half_height = height * 0.5;
        let half_width = half_height * viewport_px.x / viewport_px.y;
        Self::through(Projection::Orthographic(Window::symmetric(half_width, half_height)), viewport_px)
    }

    /// A view at the origin, looking along −Z, near 0.1 and far 1000.
    pub fn through(projection: Projection, viewport_px: Vec2) -> Self {
        Self {
            origin: DVec3::ZERO,
            eye: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            projection,
            near: 0.1,
            far: 1000.0,
            viewport_px,
            gaze: None,
            velocity: Vec3::ZERO,
        }
    }

    /// The same camera at `eye` with this rotation.
    pub fn at(self, eye: Vec3, rotation: Quat) -> Self {
        Self { eye, rotation, ..self }
    }

    /// Whether the view can be used.
    ///
    /// # Errors
    /// Names the first rule that is broken: finite numbers, a window and a viewport with an extent, 0 ≤ near < far,
    /// near > 0 for a perspective view.
    pub fn check(&self) -> Result<(), ViewError> {
        match self.broken_rule() {
            Some(rule) => Err(ViewError { rule }),
            None => Ok(()),
        }
    }

    fn broken_rule(&self) -> Option<&'static str> {
        let (window, perspective) = self.window();
        let edges = [window.left, window.right, window.bottom, window.top];
        let [x, y, z, w] = self.rotation.to_array();
        let rotation_length = x * x + y * y + z * z + w * w;
        if !self.origin.is_finite() || !self.eye.is_finite() || !self.velocity.is_finite() {
            Some("origin, eye and velocity must be finite")
        } else if !(rotation_length > 0.0 && rotation_length.is_finite()) {
            Some("rotation must be a finite quaternion that is not zero")
        } else if edges.iter().any(|e| !e.is_finite())
            || window.left >= window.right
            || window.bottom >= window.top
        {
            Some("the window must be finite and have an extent")
        } else if !self.viewport_px.is_finite() || self.viewport_px.min_element() <= 0.0 {
            Some("the viewport must have a width and a height")
        } else if !(self.near >= 0.0 && self.near.is_finite() && self.near < self.far) {
            Some("near must be finite, not negative and below far")
        } else if perspective && self.near == 0.0 {
            Some("near must be positive in a perspective view")
        } else if self.gaze.is_some_and(|g| !g.is_finite()) {
            Some("gaze must be finite")
        } else {
            None
        }
    }

    fn window(&self) -> (Window, bool) {
        match self.projection {
            Projection::Perspective(window) => (window, true),
            Projection::Orthographic(window) => (window, false),
        }
    }

    /// The view made ready for a frame, relative to `origin`, the world position that the objects' coordinates are
    /// relative to. The difference of origins is taken in double precision, so that shifting both changes nothing.
    pub fn lens(&self, origin: DVec3) -> Lens {
        Lens::new(self, origin)
    }
}

/// Why a view cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ViewError {
    /// The rule it breaks.
    pub rule: &'static str,
}

impl fmt::Display for ViewError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "view: {}", self.rule)
    }
}

impl std::error::Error for ViewError {}

/// A plane: points with `normal · p + offset ≥ 0` are inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit normal, pointing inwards.
    pub normal: Vec3,
    /// Signed distance of the origin.
    pub offset: f32,
}

impl Plane {
    fn through(point: Vec3, normal: Vec3) -> Self {
        let normal = normal * (1.0 / normal.length_squared().sqrt());
        Self { normal, offset: -dot(normal, point) }
    }

    /// Signed distance of `point`, positive inside.
    pub fn distance(&self, point: Vec3) -> f32 {
        dot(self.normal, point) + self.offset
    }
}

/// The dot product in one fixed order: x, y, z.
fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// How many planes bound a view.
pub const PLANES: usize = 6;

/// The planes around what a camera can see: left, right, bottom, top, near, far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// The planes, normals inwards. An infinite far plane is at an infinite offset and passes everything.
    pub planes: [Plane; PLANES],
}

impl Frustum {
    /// Whether some of the sphere may be in view: conservative at the edges, where a sphere outside two planes'
    /// corner passes.
    pub fn sees(&self, sphere: &Sphere) -> bool {
        self.planes.iter().all(|plane| plane.distance(sphere.center) >= -sphere.radius)
    }

    /// Which planes the box crosses, as bits of the mask, or `None` when it is wholly outside one of them. Only
    /// planes in `mask` are tried; a plane left out of the answer has the whole box inside.
    ///
    /// Rounding is taken into account: a box is said to be outside or inside only where the same holds for
    /// [`Frustum::sees`] of every sphere in it.
    pub fn crossed(&self, aabb: &Aabb, mask: u8) -> Option<u8> {
        let center = aabb.min * 0.5 + aabb.max * 0.5;
        let half = aabb.max * 0.5 - aabb.min * 0.5;
        let mut crossed = 0;
        for (i, plane) in self.planes.iter().enumerate().filter(|&(i, _)| mask & (1 << i) != 0) {
            let reach = dot(plane.normal.abs(), half);
            let distance = plane.distance(center);
            let slack =
                (center.abs().max_element() + half.max_element() + plane.offset.abs().min(f32::MAX)) * SLACK;
            if distance + reach < -slack {
                return None;
            }
            if distance - reach < slack {
                crossed |= 1 << i;
            }
        }
        Some(crossed)
    }
}

/// Relative room for the rounding of a plane's distance: a few dozen units in the last place. Larger only sends
/// more boxes down to the exact test; smaller than about 8 · 2⁻²⁴ would let the box test and the exact one disagree.
pub(crate) const SLACK: f32 = 3e-6;

/// A view made ready for one frame: frustum and projection in the coordinates of the objects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// What is in view.
    pub frustum: Frustum,
    /// Position of the eye in the coordinates of the objects.
    pub eye: Vec3,
    /// Viewing direction, of unit length.
    pub forward: Vec3,
    /// Pixels per tangent (perspective) or per world unit (orthographic), the geometric mean of both axes.
    pub scale_px: f32,
    /// Projected area of a sphere of radius 1 at distance 1 (perspective) or anywhere (orthographic): π · scale².
    pub unit_px2: f32,
    /// Area of the viewport, the most that any object can cover.
    pub viewport_px2: f32,
    /// Height of the viewport.
    pub height_px: f32,
    /// Sizes are taken no nearer than this distance.
    pub near: f32,
    /// Whether sizes fall with distance.
    pub perspective: bool,
    /// The direction that the viewer looks at, of unit length; the window's centre if nobody knows.
    pub gaze: Vec3,
    /// Velocity of the eye.
    pub velocity: Vec3,
}

impl Lens {
    fn new(view: &View, origin: DVec3) -> Self {
        let (window, perspective) = view.window();
        let [right, up, back] = axes(view.rotation);
        let forward = -back;
        let eye = ((view.origin - origin) + view.eye.as_dvec3()).as_vec3();
        let at = view.gaze.unwrap_or_default() * 0.5 + 0.5;
        let x = window.left + (window.right - window.left) * at.x;
        let y = window.bottom + (window.top - window.bottom) * at.y;
        let gaze = if perspective { forward + right * x + up * y } else { forward };
        let per_x = view.viewport_px.x / (window.right - window.left);
        let per_y = view.viewport_px.y / (window.top - window.bottom);
        let scale_px = (per_x * per_y).sqrt();
        Self {
            frustum: Frustum { planes: planes(view, window, perspective, eye, [right, up, forward]) },
            eye,
            forward,
            scale_px,
            unit_px2: std::f32::consts::PI * scale_px * scale_px,
            viewport_px2: view.viewport_px.x * view.viewport_px.y,
            height_px: view.viewport_px.y,
            near: view.near,
            perspective,
            gaze: gaze * (1.0 / gaze.length_squared().sqrt()),
            velocity: view.velocity,
        }
    }

    /// Distance from the eye to `center`, at least near; 1 in an orthographic view, where sizes do not depend on it.
    pub fn distance(&self, center: Vec3) -> f32 {
        let d = center - self.eye;
        let distance = (d.x * d.x + d.y * d.y + d.z * d.z).sqrt().max(self.near);
        if self.perspective { distance } else { 1.0 }
    }

    /// Projected diameter of a sphere in pixels: by distance, not by depth, so that turning the camera changes
    /// nothing. Not clamped to the viewport.
    pub fn size_px(&self, sphere: &Sphere) -> f32 {
        2.0 * sphere.radius * self.scale_px / self.distance(sphere.center)
    }

    /// Projected area of a sphere in square pixels, at most the viewport's; the whole viewport when the eye is inside.
    /// Free of branches and square roots, so that a loop over spheres can be vectorised.
    #[inline(always)]
    pub fn area_px2(&self, sphere: &Sphere) -> f32 {
        let d = sphere.center - self.eye;
        let distance2 = larger(d.x * d.x + d.y * d.y + d.z * d.z, self.near * self.near);
        let distance2 = if self.perspective { distance2 } else { 1.0 };
        // Finite, so that what is infinitely far is infinitely small however large it is.
        let radius2 = smaller(sphere.radius * sphere.radius, f32::MAX);
        let area_px2 = smaller(radius2 / distance2 * self.unit_px2, self.viewport_px2);
        let inside = self.perspective & (distance2 <= radius2);
        if inside { self.viewport_px2 } else { area_px2 }
    }

    /// Projected length in pixels of one world unit at the point of the sphere that is nearest to the eye, taken no
    /// nearer than near: what a geometric error there looks like at most.
    pub fn unit_px(&self, sphere: &Sphere) -> f32 {
        self.nearest_px(self.distance(sphere.center), sphere.radius)
    }

    /// Projected area in px², projected diameter in px, and the projected length in px of the bounding radius at the
    /// sphere's nearest point. Free of branches, so that a loop over spheres can be vectorised.
    pub fn project(&self, sphere: &Sphere) -> (f32, f32, f32) {
        let distance = self.distance(sphere.center);
        let size_px = 2.0 * sphere.radius * self.scale_px / distance;
        (self.area_px2(sphere), size_px, sphere.radius * self.nearest_px(distance, sphere.radius))
    }

    fn nearest_px(&self, distance: f32, radius: f32) -> f32 {
        let nearest = if self.perspective { (distance - radius).max(self.near) } else { 1.0 };
        self.scale_px / nearest
    }
}

/// The maximum; `b` where one is not a number. One instruction, which [`f32::max`] is not.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The minimum; `b` where one is not a number.
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The camera's axes in the world: the columns of the rotation matrix of the normalised quaternion, in scalar
/// arithmetic of a fixed order.
fn axes(rotation: Quat) -> [Vec3; 3] {
    let [x, y, z, w] = rotation.to_array();
    let s = 2.0 / (x * x + y * y + z * z + w * w);
    let (xs, ys, zs) = (x * s, y * s, z * s);
    let right = Vec3::new(1.0 - (y * ys + z * zs), x * ys + w * zs, x * zs - w * ys);
    let up = Vec3::new(x * ys - w * zs, 1.0 - (x * xs + z * zs), y * zs + w * xs);
    let back = Vec3::new(x * zs + w * ys, y * zs - w * xs, 1.0 - (x * xs + y * ys));
    [right, up, back]
}

fn planes(view: &View, window: Window, perspective: bool, eye: Vec3, axes: [Vec3; 3]) -> [Plane; PLANES] {
    let [right, up, forward] = axes;
    let sides = [(right, window.left), (-right, -window.right), (up, window.bottom), (-up, -window.top)].map(
        |(inwards, edge)| match perspective {
            true => Plane::through(eye, inwards - forward * edge),
            false => Plane::through(eye + inwards * edge, inwards),
        },
    );
    let near = Plane::through(eye + forward * view.near, forward);
    let far = match view.far.is_finite() {
        true => Plane::through(eye + forward * view.far, -forward),
        false => Plane { normal: -forward, offset: f32::INFINITY },
    };
    [sides[0], sides[1], sides[2], sides[3], near, far]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn full_hd() -> View {
        View::perspective(60f32.to_radians(), Vec2::new(1920.0, 1080.0))
    }

    fn ball(x: f32, y: f32, z: f32, radius: f32) -> Sphere {
        Sphere::new(Vec3::new(x, y, z), radius)
    }

    #[test]
    fn a_sphere_ahead_is_seen_and_one_behind_is_not() {
        let frustum = full_hd().lens(DVec3::ZERO).frustum;
        assert!(frustum.sees(&ball(0.0, 0.0, -10.0, 1.0)));
        assert!(!frustum.sees(&ball(0.0, 0.0, 10.0, 1.0)));
        assert!(!frustum.sees(&ball(0.0, 0.0, -1002.0, 1.0)));
        assert!(!frustum.sees(&ball(-20.0, 0.0, -10.0, 1.0)));
        assert!(frustum.sees(&ball(-10.5, 0.0, -10.0, 1.0)));
    }

    #[test]
    fn axes_are_those_of_the_rotation() {
        let rotation = Quat::from_euler(glam::EulerRot::YXZ, 0.7, -0.4, 1.1);
        for (axis, unit) in axes(rotation * 3.0).into_iter().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
            assert!((axis - rotation * unit).length() < 1e-6);
        }
    }

    #[test]
    fn turning_the_camera_changes_no_size() {
        let sphere = ball(3.0, 1.0, -10.0, 1.0);
        let straight = full_hd().lens(DVec3::ZERO);
        let turned = full_hd().at(Vec3::ZERO, Quat::from_rotation_y(0.4)).lens(DVec3::ZERO);
        assert_eq!(straight.size_px(&sphere), turned.size_px(&sphere));
    }

    #[test]
    fn an_orthographic_size_does_not_depend_on_distance() {
        let lens = View::orthographic(10.0, Vec2::new(1000.0, 1000.0)).lens(DVec3::ZERO);
        assert_eq!(lens.size_px(&ball(0.0, 0.0, -5.0, 1.0)), 200.0);
        assert_eq!(lens.size_px(&ball(0.0, 0.0, -500.0, 1.0)), 200.0);
    }

    #[test]
    fn twice_the_resolution_is_twice_the_size() {
        let sphere = ball(0.0, 0.0, -10.0, 1.0);
        let uhd = View::perspective(60f32.to_radians(), Vec2::new(3840.0, 2160.0)).lens(DVec3::ZERO);
        let hd = full_hd().lens(DVec3::ZERO);
        assert_eq!(uhd.size_px(&sphere), 2.0 * hd.size_px(&sphere));
        assert_eq!(uhd.unit_px(&sphere), 2.0 * hd.unit_px(&sphere));
    }

    #[test]
    fn the_eye_inside_an_object_sees_it_fill_the_viewport() {
        let lens = full_hd().lens(DVec3::ZERO);
        assert_eq!(lens.area_px2(&ball(0.0, 0.0, 0.5, 2.0)), 1920.0 * 1080.0);
        assert!(lens.unit_px(&ball(0.0, 0.0, 0.5, 2.0)).is_finite());
    }

    #[test]
    fn what_is_infinitely_far_is_infinitely_small() {
        let lens = full_hd().at(Vec3::splat(1e30), Quat::IDENTITY).lens(DVec3::ZERO);
        assert_eq!(lens.area_px2(&ball(0.0, 0.0, 0.0, f32::MAX)), 0.0);
    }

    #[test]
    fn an_infinite_far_plane_passes_everything_ahead() {
        let lens = View { far: f32::INFINITY, ..full_hd() }.lens(DVec3::ZERO);
        assert!(lens.frustum.sees(&ball(0.0, 0.0, -1e30, 1.0)));
        let aabb = ball(0.0, 0.0, -100.0, 1.0).aabb();
        assert_eq!(lens.frustum.crossed(&aabb, 0b11_1111), Some(0));
    }

    #[test]
    fn broken_views_are_refused() {
        let rules = [
            View { near: 0.0, ..full_hd() },
            View { far: 0.05, ..full_hd() },
            View { viewport_px: Vec2::new(0.0, 1080.0), ..full_hd() },
            View { eye: Vec3::NAN, ..full_hd() },
            View { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..full_hd() },
        ];
        assert!(rules.iter().all(|v| v.check().is_err()));
        assert_eq!(full_hd().check(), Ok(()));
    }
}
