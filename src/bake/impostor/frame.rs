//! Frames: from where pictures are taken, and what is on them.

use std::f64::consts::PI;

use glam::dcamera::rh::{proj::directx::orthographic, view::look_to_mat4};
use glam::{DMat4, DVec2, DVec3};
use serde::{Deserialize, Serialize};

use super::outline::{self, Supports};
use super::{Impostor, Kind, Octahedron, Outline, Rectangle};

/// Upright axes: unit vectors across each other, right × up = front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Basis {
    pub right: DVec3,
    pub up: DVec3,
    pub front: DVec3,
}

impl Basis {
    /// Around an axis that has a direction. The front is +Z as in glTF; where the axis is, −Y.
    pub(super) fn around(up: DVec3) -> Self {
        let up = up.normalize();
        let forward = if up.z.abs() > 0.9 { -DVec3::Y } else { DVec3::Z };
        let front = up.cross(forward.cross(up)).normalize();
        Self { right: up.cross(front), up, front }
    }

    /// The part of a vector across the axis.
    pub(super) fn across(&self, v: DVec3) -> DVec3 {
        v - v.dot(self.up) * self.up
    }

    /// The unit vector at these angles: around from the front towards the right, and above the horizon.
    pub(super) fn direction(&self, yaw: f64, elevation: f64) -> DVec3 {
        let ((sin, cos), (rise, reach)) = (yaw.sin_cos(), elevation.sin_cos());
        (self.front * cos + self.right * sin) * reach + self.up * rise
    }

    /// The angles of a unit vector; a yaw of 0 along the axis.
    pub(super) fn angles(&self, direction: DVec3) -> (f64, f64) {
        let flat = DVec2::new(direction.dot(self.right), direction.dot(self.front));
        let yaw = if flat.length() < NO_YAW { 0.0 } else { flat.x.atan2(flat.y) };
        (yaw, direction.dot(self.up).atan2(flat.length()))
    }

    /// The upright view from a direction.
    pub(super) fn view(&self, direction: DVec3) -> View {
        let flat = self.across(direction);
        let right = if flat.length() < NO_YAW { self.right } else { self.up.cross(flat).normalize() };
        View { right, up: direction.cross(right), direction }
    }

    /// From coordinates along right, up and front.
    pub(super) fn world(&self, local: DVec3) -> DVec3 {
        self.right * local.x + self.up * local.y + self.front * local.z
    }

    /// To coordinates along right, up and front.
    pub(super) fn local(&self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.right), v.dot(self.up), v.dot(self.front))
    }
}

/// A unit vector with less than this across the axis points along it.
const NO_YAW: f64 = 1e-9;

/// A parallel projection: unit vectors across each other, `direction` towards the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    pub right: DVec3,
    pub up: DVec3,
    pub direction: DVec3,
}

/// How far something reaches in a view.
pub(super) struct Extent {
    pub supports: Supports,
    pub depth: [f64; 2],
}

impl View {
    pub(super) fn flat(&self, p: DVec3) -> DVec2 {
        DVec2::new(p.dot(self.right), p.dot(self.up))
    }

    /// Back from [`View::flat`], into the plane through the middle.
    pub(super) fn lift(&self, at: DVec2) -> DVec3 {
        self.right * at.x + self.up * at.y
    }

    pub(super) fn extent(&self, points: &[DVec3]) -> Extent {
        let mut extent = Extent { supports: Supports::NONE, depth: [f64::INFINITY, f64::NEG_INFINITY] };
        for &p in points {
            let depth = p.dot(self.direction);
            extent.supports.add(self.flat(p));
            extent.depth = [extent.depth[0].min(depth), extent.depth[1].max(depth)];
        }
        extent
    }
}

impl Kind {
    /// From where its frames are taken.
    pub(super) fn views(self, basis: &Basis, yaw_deg: f64) -> Vec<View> {
        let level = |yaw: f64| basis.view(basis.direction(yaw, 0.0));
        match self {
            Self::Billboard { frames, .. } => {
                let yaw = |k: u32| yaw_deg.to_radians() * (f64::from(2 * k + 1) / f64::from(frames) - 1.0);
                (0..frames).map(|k| level(yaw(k))).collect()
            }
            Self::CrossQuads { planes, horizontal } => {
                let upright = (0..planes).map(|k| level(PI * f64::from(k) / f64::from(planes)));
                upright.chain(horizontal.then(|| basis.view(basis.up))).collect()
            }
            Self::Octahedral { frames, hemisphere } => {
                let map = Octahedron::new(frames, hemisphere);
                let view = |frame| basis.view(basis.world(map.direction(frame)).normalize());
                (0..self.frame_count()).map(view).collect()
            }
        }
    }
}

/// A picture of the mesh without perspective.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// Unit vector from the mesh to the viewer.
    pub direction: DVec3,
    /// Unit vector to the right in the picture.
    pub right: DVec3,
    /// Unit vector upwards in the picture.
    pub up: DVec3,
    /// What the picture shows, along `right` and `up` from the middle.
    pub window: Window,
    /// How far the mesh reaches along `direction` from the middle: least and most.
    pub depth: [f64; 2],
    /// Where it is in the atlas; a texel is as wide as it is high.
    pub rectangle_px: Rectangle,
    /// The corners of a convex polygon in the window, counter-clockwise, 4 to 8 of them, with everything of the mesh at
    /// least half a texel inside.
    pub outline: Vec<DVec2>,
}

/// A rectangle of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Window {
    /// Lower left corner.
    pub min: DVec2,
    /// Upper right corner.
    pub max: DVec2,
}

impl Frame {
    /// The frame of a view, not yet placed in the atlas: a window of whole texels, with half a texel or more around what
    /// is seen.
    pub(super) fn of(view: &View, extent: &Extent, texels_per_unit: f64, outline: Outline) -> Self {
        let texel = 1.0 / texels_per_unit;
        let (min, max) = extent.supports.bounds();
        let texels = ((max - min) * texels_per_unit + 1.0 + SLACK).ceil();
        let (middle, half) = (0.5 * (min + max), 0.5 * texel * texels);
        let window = Window { min: middle - half, max: middle + half };
        Self {
            direction: view.direction,
            right: view.right,
            up: view.up,
            window,
            depth: extent.depth,
            rectangle_px: Rectangle { x: 0, y: 0, width: texels.x as u32, height: texels.y as u32 },
            outline: outline::cut(outline, &extent.supports, 0.5 * texel, &window),
        }
    }

    /// How far the mesh is from the plane through the middle at most.
    pub(super) fn reach(&self) -> f64 {
        self.depth[1].max(-self.depth[0])
    }

    pub(super) fn view(&self) -> View {
        View { right: self.right, up: self.up, direction: self.direction }
    }
}

/// In texels: so that rounding never makes a window too small.
const SLACK: f64 = 1e-6;

/// Before and behind the mesh, in radii.
const DEPTH_MARGIN: f64 = 0.01;

impl Impostor {
    /// The camera that takes the picture of a frame: from object space to its own, and from there to clip space with
    /// depths from 0 to 1, for a viewport that is the frame's rectangle. Narrow them with `as_mat4` where the mesh is
    /// not far from the origin.
    ///
    /// # Panics
    /// Where there is no such frame.
    pub fn camera(&self, frame: usize) -> (DMat4, DMat4) {
        let Frame { direction, up, window: Window { min, max }, depth: [least, most], .. } =
            self.frames[frame];
        let margin = DEPTH_MARGIN * self.radius;
        let eye = self.center + direction * (most + margin);
        let view = look_to_mat4(eye, -direction, up);
        let far = most - least + 2.0 * margin;
        (view, orthographic(min.x, max.x, min.y, max.y, 0.0, far))
    }

    /// Where in the atlas a point of a frame's plane is: (0, 0) is the upper left corner, (1, 1) the lower right one, as
    /// glTF has it. The point is given in object space; what is beyond the window is beyond the rectangle.
    ///
    /// # Panics
    /// Where there is no such frame.
    pub fn uv(&self, frame: usize, point: DVec3) -> DVec2 {
        let frame = &self.frames[frame];
        self.uv_of(frame, frame.view().flat(point - self.center))
    }

    /// As [`Impostor::uv`], of a point along `right` and `up`.
    pub(super) fn uv_of(&self, frame: &Frame, at: DVec2) -> DVec2 {
        let corner = DVec2::new(f64::from(frame.rectangle_px.x), f64::from(frame.rectangle_px.y));
        let from_corner = DVec2::new(at.x - frame.window.min.x, frame.window.max.y - at.y);
        let texel = corner + from_corner * self.atlas.texels_per_unit;
        texel / DVec2::new(f64::from(self.atlas.width_px), f64::from(self.atlas.height_px))
    }

    pub(super) fn basis(&self) -> Basis {
        Basis { right: self.up.cross(self.front), up: self.up, front: self.front }
    }
}
