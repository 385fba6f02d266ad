//! The mesh about its middle.

use glam::DVec3;

use super::ImpostorError;
use super::frame::Basis;
use crate::bake::mesh::Mesh;
use crate::bounds::Aabb;

/// What is drawn, in double precision and about the middle, so that a mesh far from the origin is as good as any.
pub(super) struct Body {
    pub center: DVec3,
    pub radius: f64,
    pub girth: f64,
    pub basis: Basis,
    /// The positions that triangles use, each once.
    pub points: Vec<DVec3>,
    /// Of points.
    pub triangles: Vec<[u32; 3]>,
}

impl Body {
    pub(super) fn of(mesh: &Mesh, up: DVec3) -> Result<Self, ImpostorError> {
        mesh.check().map_err(ImpostorError::Mesh)?;
        let (used, triangles) = used_positions(mesh);
        if let Some(at) = used.iter().find(|&&p| !mesh.positions[p as usize].is_finite()) {
            return Err(ImpostorError::Mesh(format!("position {at} must be finite")));
        }
        if triangles.is_empty() {
            return Err(ImpostorError::NoTriangles);
        }
        let bounds = Aabb::around(used.iter().map(|&p| mesh.positions[p as usize]));
        let center = 0.5 * (bounds.min.as_dvec3() + bounds.max.as_dvec3());
        let points: Vec<DVec3> =
            used.iter().map(|&p| mesh.positions[p as usize].as_dvec3() - center).collect();
        let basis = Basis::around(up);
        let most =
            |length: fn(&Basis, DVec3) -> f64| points.iter().map(|&p| length(&basis, p)).fold(0.0, f64::max);
        let (radius, girth) = (most(|_, p| p.length()), most(|basis, p| basis.across(p).length()));
        if radius == 0.0 || 2.0 * radius > f64::from(f32::MAX) {
            return Err(ImpostorError::NoExtent);
        }
        Ok(Self { center, radius, girth, basis, points, triangles })
    }

    pub(super) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|point| self.points[point as usize])
    }
}

/// The positions that triangles use, in order, and the triangles of those.
fn used_positions(mesh: &Mesh) -> (Vec<u32>, Vec<[u32; 3]>) {
    let mut numbers = vec![u32::MAX; mesh.positions.len()];
    (0..mesh.triangles.len()).flat_map(|t| mesh.corners(t)).for_each(|p| numbers[p as usize] = 0);
    let used: Vec<u32> =
        (0..).zip(&numbers).filter(|&(_, &number)| number == 0).map(|(position, _)| position).collect();
    (0..).zip(&used).for_each(|(number, &position)| numbers[position as usize] = number);
    let triangles = (0..mesh.triangles.len()).map(|t| mesh.corners(t).map(|p| numbers[p as usize]));
    (used, triangles.collect())
}
