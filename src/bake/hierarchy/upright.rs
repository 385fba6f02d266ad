//! Height fields: what is upright about them, and how they are simplified.

use glam::{DVec3, Vec3};

use crate::bake::Mesh;
use crate::bake::simplify::Contraction;

/// The axis of a height field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Upright(pub(super) DVec3);

/// The slope that a flattened height field has on average: so flat that a triangle turns over where it does so as seen
/// from above, and that what is measured across its planes is measured upwards; not so flat that its hills are rounding.
const FLAT: f64 = 1.0 / 32.0;

impl Upright {
    /// The axis that all triangles face, if there is one.
    pub(super) fn of(positions: &[Vec3], triangles: &[[u32; 3]]) -> Option<Self> {
        let axes = [DVec3::Z, DVec3::Y, DVec3::X, DVec3::NEG_Z, DVec3::NEG_Y, DVec3::NEG_X];
        let faces = |axis: DVec3| triangles.iter().all(|&t| normal(positions, t).dot(axis) > 0.0);
        axes.into_iter().find(|&axis| !triangles.is_empty() && faces(axis)).map(Self)
    }

    /// Of a mesh, those triangles left out that use a position twice.
    pub(super) fn of_mesh(mesh: &Mesh) -> Option<Self> {
        Self::of(&mesh.positions, &triangles_of(mesh))
    }

    /// The mesh with its heights scaled by a power of two, which is returned as well.
    pub(super) fn flattened(self, mesh: &Mesh) -> (Mesh, f32) {
        let scale = self.scale(mesh);
        let mut flat = mesh.clone();
        flat.positions.iter_mut().for_each(|p| *p = self.scaled(*p, scale));
        (flat, scale)
    }

    /// A contraction of a flattened mesh as one of the mesh that it was.
    pub(super) fn raised(self, contraction: Contraction, scale: f32) -> Contraction {
        Contraction { position: self.scaled(contraction.position, 1.0 / scale), ..contraction }
    }

    fn scaled(self, p: Vec3, scale: f32) -> Vec3 {
        let upwards = self.0.abs().as_vec3();
        p * (Vec3::ONE + upwards * (scale - 1.0))
    }

    fn scale(self, mesh: &Mesh) -> f32 {
        let (mut run, mut rise) = (0.0, 0.0);
        for triangle in triangles_of(mesh) {
            let normal = normal(&mesh.positions, triangle);
            let up = normal.dot(self.0);
            run += up;
            rise += (normal - self.0 * up).length();
        }
        let scale = (FLAT * run / rise).log2().floor().clamp(-20.0, 0.0);
        if scale.is_nan() { 1.0 } else { scale.exp2() as f32 }
    }
}

fn triangles_of(mesh: &Mesh) -> Vec<[u32; 3]> {
    let corners = (0..mesh.triangles.len()).map(|t| mesh.corners(t));
    corners.filter(|&[a, b, c]| a != b && b != c && c != a).collect()
}

/// Twice the area of a triangle, as a vector.
fn normal(positions: &[Vec3], triangle: [u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|v| positions[v as usize].as_dvec3());
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::shapes::{icosphere, terrain};

    #[test]
    fn a_terrain_is_upright_and_a_sphere_is_not() {
        let mesh = Mesh::from(terrain(9, 1));
        let upright = Upright::of_mesh(&mesh).expect("a height field");
        assert_eq!(upright, Upright(DVec3::Z));
        assert_eq!(Upright::of_mesh(&icosphere(3).into()), None);
        let (flat, scale) = upright.flattened(&mesh);
        assert!(scale < 0.5 && scale.log2().fract() == 0.0, "{scale}");
        let contraction = |position| Contraction { kept: 0, gone: 1, position, error: 0.0 };
        for (low, high) in flat.positions.iter().zip(&mesh.positions) {
            assert_eq!(
                (low.truncate(), upright.raised(contraction(*low), scale).position),
                (high.truncate(), *high)
            );
        }
    }
}
