//! How far off a surface is on the screen, measured at the vertices of a terrain.

use glam::{DVec3, Vec2, Vec3};
use lod_budget::View;
use lod_budget::bake::Surface;

/// The vertices of a terrain, by cells of a grid that they are above.
pub struct Heights {
    points: Vec<Vec3>,
    low: Vec2,
    /// Cells per unit.
    per_unit: f32,
    side: usize,
    /// Per cell, where its points start among `sorted`; and where the last ones end.
    firsts: Vec<u32>,
    sorted: Vec<u32>,
}

impl Heights {
    pub fn new(surface: &Surface) -> Self {
        let points = surface.positions.clone();
        let (low, high) = points.iter().fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), p| {
            (low.min(p.truncate()), high.max(p.truncate()))
        });
        let side = ((points.len() as f32 / 2.0).sqrt() as usize).max(1);
        let per_unit = side as f32 / (high - low).max_element().max(f32::MIN_POSITIVE);
        let mut heights = Self { points, low, per_unit, side, firsts: Vec::new(), sorted: Vec::new() };
        let cells: Vec<usize> = heights.points.iter().map(|p| heights.cell(p.truncate())).collect();
        heights.sorted = (0..cells.len() as u32).collect();
        heights.sorted.sort_by_key(|&p| cells[p as usize]);
        let mut counts = vec![0u32; side * side + 1];
        cells.iter().for_each(|&cell| counts[cell + 1] += 1);
        (1..counts.len()).for_each(|i| counts[i] += counts[i - 1]);
        heights.firsts = counts;
        heights
    }

    fn column(&self, at: Vec2) -> [usize; 2] {
        let at = ((at - self.low) * self.per_unit).max(Vec2::ZERO);
        [at.x, at.y].map(|x| (x as usize).min(self.side - 1))
    }

    fn cell(&self, at: Vec2) -> usize {
        let [x, y] = self.column(at);
        y * self.side + x
    }

    /// Per vertex, the height of a surface there; that of the vertex itself where the surface is not.
    pub fn under(&self, surface: &Surface) -> Vec<f32> {
        let mut heights: Vec<f32> = self.points.iter().map(|p| p.z).collect();
        for triangle in 0..surface.triangles.len() {
            let corners = surface.corners(triangle);
            let flat = corners.map(Vec3::truncate);
            let [low, high] = [flat[0].min(flat[1]).min(flat[2]), flat[0].max(flat[1]).max(flat[2])];
            let ([x0, y0], [x1, y1]) = (self.column(low), self.column(high));
            for y in y0..=y1 {
                let row =
                    self.firsts[y * self.side + x0] as usize..self.firsts[y * self.side + x1 + 1] as usize;
                for &point in &self.sorted[row] {
                    if let Some(z) = height(corners, self.points[point as usize].truncate()) {
                        heights[point as usize] = z;
                    }
                }
            }
        }
        heights
    }

    /// How far any vertex that is in view is from where the surface shows it, in px.
    pub fn error_px(&self, heights: &[f32], view: &View) -> f32 {
        let lens = view.lens(DVec3::ZERO);
        let (right, up) = (view.rotation * Vec3::X, view.rotation * Vec3::Y);
        let on_screen = |p: Vec3| {
            let to = p - lens.eye;
            Vec2::new(to.dot(right), to.dot(up)) * lens.scale_px / to.dot(lens.forward)
        };
        let is_seen = |p: Vec3| lens.frustum.planes.iter().all(|plane| plane.distance(p) >= 0.0);
        let seen = self.points.iter().zip(heights).filter(|&(&p, &z)| p.z != z && is_seen(p));
        seen.map(|(&p, &z)| on_screen(p).distance(on_screen(p.with_z(z)))).fold(0.0, f32::max)
    }
}

/// The height of a triangle over a place.
fn height(corners: [Vec3; 3], at: Vec2) -> Option<f32> {
    let [a, b, c] = corners.map(|p| p.truncate() - at);
    let weights = Vec3::new(b.perp_dot(c), c.perp_dot(a), a.perp_dot(b));
    let is_inside = weights.min_element() >= 0.0 && weights.element_sum() > 0.0;
    is_inside.then(|| weights.dot(Vec3::from_array(corners.map(|p| p.z))) / weights.element_sum())
}
