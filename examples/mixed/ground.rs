//! Hills, with +Y up, around the origin.

use glam::{Vec2, Vec3};
use lod_budget::bake::{Mesh, Surface, shapes};

/// Length of a side, and how high the noise of one unit is, in metres: hills are some 40 m high.
pub const SIDE_M: f32 = 600.0;
const HEIGHT_M: f32 = 200.0;

/// A height field that things can be put on.
pub struct Ground {
    surface: Surface,
    /// Cells on a side.
    cells: u32,
}

impl Ground {
    pub fn new(cells: u32, seed: u32) -> Self {
        let mut surface = shapes::terrain(cells, seed);
        for p in &mut surface.positions {
            *p = Vec3::new((p.x - 0.5) * SIDE_M, p.z * HEIGHT_M, (0.5 - p.y) * SIDE_M);
        }
        Self { surface, cells }
    }

    pub fn mesh(&self) -> Mesh {
        Mesh { name: "terrain".to_owned(), ..self.surface.clone().into() }
    }

    /// The place on the ground at (x, z), between four vertices in proportion.
    pub fn place(&self, at: Vec2) -> Vec3 {
        let cell = (Vec2::new(at.x, -at.y) / SIDE_M + 0.5) * self.cells as f32;
        let first = cell.floor().clamp(Vec2::ZERO, Vec2::splat(self.cells as f32 - 1.0));
        let part = (cell - first).clamp(Vec2::ZERO, Vec2::ONE);
        let height = |right: u32, up: u32| {
            let (column, row) = (first.x as u32 + right, first.y as u32 + up);
            self.surface.positions[(row * (self.cells + 1) + column) as usize].y
        };
        let [low, high] = [0, 1].map(|up| height(0, up) * (1.0 - part.x) + height(1, up) * part.x);
        Vec3::new(at.x, low * (1.0 - part.y) + high * part.y, at.y)
    }
}
