//! Light on grey clay, and the edges of triangles.

use glam::{DVec3, Vec3};

use super::camera::Camera;
use super::normals::Normals;
use super::raster::{Facet, Frame, NOTHING};
use crate::bake::mesh::Mesh;

/// What the page is made of.
const PAPER: Vec3 = Vec3::ONE;

/// Linear light that fronts, backs and edges give back.
const FRONT: Vec3 = Vec3::new(0.62, 0.60, 0.57);
const BACK: Vec3 = Vec3::new(0.36, 0.44, 0.62);
const INK: Vec3 = Vec3::new(0.03, 0.06, 0.12);

/// Lights as the viewer sees them: direction (to be normalised) and strength. The first comes over the left shoulder.
const LIGHTS: [(Vec3, f32); 2] = [(Vec3::new(-0.5, 0.75, 0.7), 0.85), (Vec3::new(0.9, 0.1, 0.45), 0.18)];

/// Light from all around: from below, and what comes on top of it from above.
const GROUND: f32 = 0.16;
const SKY: f32 = 0.24;

/// Edges are drawn so wide, in pixels, and so strongly.
const EDGE_PX: f64 = 0.9;
const EDGE_STRENGTH: f32 = 0.5;

/// Triangles of less than the first height, in pixels, have no edges drawn, those of more than the second full ones:
/// below, lines would cover everything.
const EDGES_FROM_PX: [f64; 2] = [3.0, 10.0];

/// The linear colour of each sample; a pixel has `samples` of them each way.
pub(super) fn colours(mesh: &Mesh, camera: &Camera, frame: &Frame, samples: f32) -> Vec<Vec3> {
    let normals = Normals::of(mesh);
    let colour = |sample: usize| match frame.triangle[sample] {
        NOTHING => PAPER,
        triangle => {
            let seen = Seen::of(mesh, camera, frame, &normals, (triangle as usize, sample));
            seen.colour(open_sky(frame, sample), f64::from(samples))
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
    fn of(
        mesh: &Mesh,
        camera: &Camera,
        frame: &Frame,
        normals: &Normals<'_>,
        (triangle, sample): (usize, usize),
    ) -> Self {
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

    fn colour(&self, open: f32, samples: f64) -> Vec3 {
        let direct: f32 =
            LIGHTS.iter().map(|(from, power)| power * self.normal.dot(from.normalize()).max(0.0)).sum();
        let around = GROUND + SKY * (0.5 + 0.5 * self.normal.y);
        let clay = if self.is_front { FRONT } else { BACK };
        let lit = clay * (around * open + direct * (0.5 + 0.5 * open));
        lit.lerp(INK, self.edge(samples))
    }

    /// How much of an edge there is.
    fn edge(&self, samples: f64) -> f32 {
        let [from, to] = EDGES_FROM_PX;
        let large = ((self.height / samples - from) / (to - from)).clamp(0.0, 1.0);
        let near = (EDGE_PX / 2.0 + 0.5 - self.to_edge / samples).clamp(0.0, 1.0);
        (large * near) as f32 * EDGE_STRENGTH
    }
}

/// How far neighbours are looked for, as shares of the frame.
const REACHES: [f32; 3] = [0.012, 0.03, 0.07];

/// The share of the sky that nothing nearby hides, from 0 to 1: what rises around a sample, in the depth buffer alone
/// (Mittring, *Finding next gen: CryEngine 2*, 2007). What rises by more than three times its distance is something in
/// front and hides nothing. Neighbouring samples look in different directions, which their pixel evens out.
fn open_sky(frame: &Frame, sample: usize) -> f32 {
    let (x, y) = ((sample % frame.side) as f32, (sample / frame.side) as f32);
    let turn = (sample % 2 * 2 + sample / frame.side % 2) as f32 / 4.0;
    let mut hidden = 0.0;
    for reach in REACHES.map(|share| share * frame.side as f32) {
        for direction in 0..DIRECTIONS {
            let angle = (direction as f32 + turn) * (std::f32::consts::TAU / DIRECTIONS as f32);
            let at = [x + reach * angle.cos(), y + reach * angle.sin()];
            if at.iter().all(|&at| at >= 0.0 && at < frame.side as f32) {
                let depth = frame.depth[at[1] as usize * frame.side + at[0] as usize];
                let rise = (depth - frame.depth[sample]) / reach;
                hidden += if rise < 3.0 { (rise - 0.15).clamp(0.0, 1.0) } else { 0.0 };
            }
        }
    }
    let share = hidden / (REACHES.len() * DIRECTIONS) as f32;
    (1.0 - 1.6 * share).max(0.0)
}

/// In which neighbours are looked for.
const DIRECTIONS: usize = 6;
