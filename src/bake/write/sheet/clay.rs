//! Light on grey clay, and the edges of triangles.

use glam::{DVec3, Vec3};

use super::camera::Camera;
use super::normals::Normals;
use super::raster::{Facet, Frame, NOTHING};
use super::sky::Sky;

/// What the page is made of.
const PAPER: Vec3 = Vec3::ONE;

/// Linear light that fronts, backs and edges give back.
const FRONT: Vec3 = Vec3::new(0.66, 0.64, 0.61);
const BACK: Vec3 = Vec3::new(0.36, 0.44, 0.62);
const INK: Vec3 = Vec3::new(0.03, 0.06, 0.12);

/// Lights as the viewer sees them: direction (to be normalised) and strength. The first comes over the left shoulder.
const LIGHTS: [(Vec3, f32); 2] = [(Vec3::new(-0.5, 0.75, 0.7), 0.78), (Vec3::new(0.9, 0.1, 0.45), 0.26)];

/// Light from all around: from below, and what comes on top of it from above.
const GROUND: f32 = 0.22;
const SKY: f32 = 0.3;

/// Edges are drawn so wide, in pixels, and so strongly.
const EDGE_PX: f64 = 0.9;
const EDGE_STRENGTH: f32 = 0.5;

/// Triangles of less than the first height, in pixels, have no edges drawn, those of more than the second full ones:
/// below, lines would cover everything.
const EDGES_FROM_PX: [f64; 2] = [3.0, 10.0];

/// The linear colour of each sample; a pixel has `samples` of them each way.
pub(super) fn colours(normals: &Normals<'_>, camera: &Camera, frame: &Frame, samples: usize) -> Vec<Vec3> {
    let sky = Sky::of(frame.side);
    let lights = LIGHTS.map(|(from, power)| from.normalize() * power);
    let colour = |sample: usize| match frame.triangle[sample] {
        NOTHING => PAPER,
        triangle => {
            let seen = Seen::of(normals, camera, frame, (triangle as usize, sample));
            seen.lit(&lights, sky.open(frame, sample)).lerp(INK, seen.edge(samples as f64))
        }
    };
    (0..frame.triangle.len()).map(colour).collect()
}

/// What is at a sample.
struct Seen {
    is_front: bool,
    /// As the viewer sees it, towards them.
    normal: Vec3,
    /// To the nearest edge, in samples.
    to_edge: f64,
    /// The least height of the triangle, in samples.
    height: f64,
}

impl Seen {
    fn of(normals: &Normals<'_>, camera: &Camera, frame: &Frame, (triangle, sample): (usize, usize)) -> Self {
        let mesh = normals.mesh;
        let places = mesh.corners(triangle).map(|p| camera.place(mesh.positions[p as usize]));
        let facet = Facet::of(places);
        let (x, y) = (sample % frame.side, sample / frame.side);
        let weights = facet.as_ref().and_then(|f| f.weights(x, y)).unwrap_or([1.0, 0.0, 0.0]);
        let heights = facet.as_ref().map_or([0.0; 3], Facet::heights);
        let is_front = facet.is_none_or(|f| f.is_front());
        let normal: DVec3 = normals.of_corners(triangle).into_iter().zip(weights).map(|(n, w)| n * w).sum();
        let normal = camera.turn(if is_front { normal } else { -normal });
        Self {
            is_front,
            normal: normal.try_normalize().unwrap_or(Vec3::Z),
            to_edge: (0..3).map(|i| weights[i] * heights[i]).fold(f64::INFINITY, f64::min),
            height: heights.into_iter().fold(f64::INFINITY, f64::min),
        }
    }

    /// Without edges. `lights` are directions as long as they are strong.
    fn lit(&self, lights: &[Vec3], open: f32) -> Vec3 {
        let direct: f32 = lights.iter().map(|&light| self.normal.dot(light).max(0.0)).sum();
        let around = GROUND + SKY * (0.5 + 0.5 * self.normal.y);
        let clay = if self.is_front { FRONT } else { BACK };
        clay * (around * open + direct * (0.5 + 0.5 * open))
    }

    /// How much of an edge there is.
    fn edge(&self, samples: f64) -> f32 {
        let [from, to] = EDGES_FROM_PX;
        let large = ((self.height / samples - from) / (to - from)).clamp(0.0, 1.0);
        let near = (EDGE_PX / 2.0 + 0.5 - self.to_edge / samples).clamp(0.0, 1.0);
        (large * near) as f32 * EDGE_STRENGTH
    }
}
