//! Which way a surface looks at the corners of its triangles.

use glam::{DVec3, Vec3};

use crate::bake::mesh::Mesh;

/// Normals of a mesh, its own or made from its triangles.
pub(super) struct Normals<'a> {
    pub(super) mesh: &'a Mesh,
    /// Per position, the sum over its triangles, by area.
    smooth: Vec<DVec3>,
}

/// Cosine of the most by which a smooth normal may be off its triangle's: half the angle of a sharp edge.
const CREASE: f64 = 0.766;

impl<'a> Normals<'a> {
    pub(super) fn of(mesh: &'a Mesh) -> Self {
        let mut smooth = vec![DVec3::ZERO; mesh.positions.len()];
        for triangle in 0..mesh.triangles.len() {
            let face = across(mesh, triangle);
            mesh.corners(triangle).iter().for_each(|&p| smooth[p as usize] += face);
        }
        Self { mesh, smooth }
    }

    /// Unit vectors, or 0 where there is no telling.
    pub(super) fn of_corners(&self, triangle: usize) -> [DVec3; 3] {
        let face = across(self.mesh, triangle).normalize_or_zero();
        self.mesh.triangles[triangle].map(|wedge| self.own(wedge).unwrap_or_else(|| self.made(wedge, face)))
    }

    fn own(&self, wedge: u32) -> Option<DVec3> {
        let normal = self.mesh.normals.get(wedge as usize).copied().map(Vec3::as_dvec3);
        normal.and_then(DVec3::try_normalize)
    }

    fn made(&self, wedge: u32, face: DVec3) -> DVec3 {
        let position = self.mesh.wedges[wedge as usize];
        let smooth = self.smooth[position as usize].normalize_or_zero();
        if smooth.dot(face) < CREASE { face } else { smooth }
    }
}

/// Across the triangle, as long as twice its area.
fn across(mesh: &Mesh, triangle: usize) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle).map(|p| mesh.positions[p as usize].as_dvec3());
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::Group;

    /// Two triangles that share an edge and rise from it by `slope`.
    fn roof(slope: f32) -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::Y, Vec3::new(1.0, 0.0, -slope), Vec3::new(-1.0, 0.0, -slope)],
            wedges: vec![0, 1, 2, 3],
            triangles: vec![[0, 2, 1], [0, 1, 3]],
            groups: vec![Group { triangles: 0..2, ..Group::default() }],
            ..Mesh::default()
        }
    }

    #[test]
    fn flat_edges_are_smooth_and_steep_ones_sharp() {
        let of_ridge = |slope: f32| {
            let mesh = roof(slope);
            let normals = Normals::of(&mesh);
            [0, 1].map(|t| normals.of_corners(t)[0].x)
        };
        let [left, right] = of_ridge(0.5);
        assert!(left.abs() < 1e-9 && right.abs() < 1e-9);
        let [left, right] = of_ridge(2.0);
        assert!(left > 0.8 && right < -0.8, "{left} {right}");
    }

    #[test]
    fn its_own_normals_come_first() {
        let mut mesh = roof(0.5);
        mesh.normals = vec![Vec3::X * 3.0, Vec3::ZERO, Vec3::Y, Vec3::NAN];
        let [own, _, made] = Normals::of(&mesh).of_corners(0);
        assert_eq!(own, DVec3::X);
        assert!(made.z > 0.8, "{made}");
    }
}
