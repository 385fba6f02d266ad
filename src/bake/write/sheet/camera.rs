//! Where from to look at a mesh.

use glam::{DVec3, Vec3};

use crate::bake::mesh::Mesh;

/// A parallel projection onto a square of samples.
#[derive(Clone, Debug)]
pub(super) struct Camera {
    right: DVec3,
    up: DVec3,
    /// Towards the viewer.
    back: DVec3,
    /// What is in the middle.
    centre: DVec3,
    /// Samples per unit.
    scale: f64,
    /// Samples each way.
    pub(super) side: usize,
}

/// How far round from the front (+Z), and how far up, in degrees. Two ways round, because a long thing looks short from
/// one of them.
const AROUND: [f64; 2] = [30.0, 60.0];
const ABOVE: f64 = 22.0;

/// The share of the square that the mesh takes in the wider direction.
const FILLED: f64 = 0.92;

impl Camera {
    /// The three-quarter view that shows the larger part of the box around the mesh, and all of it.
    pub(super) fn around(mesh: &Mesh, side: usize) -> Self {
        let bounds = mesh.bounds();
        let size =
            if bounds.is_empty() { DVec3::ZERO } else { bounds.max.as_dvec3() - bounds.min.as_dvec3() };
        let sides = DVec3::new(size.y * size.z, size.z * size.x, size.x * size.y);
        let [first, second] = AROUND.map(|around| Self::from(around, ABOVE, side));
        let shown = |camera: &Self| camera.back.dot(sides);
        let mut camera = if shown(&second) > shown(&first) { second } else { first };
        camera.fit(mesh);
        camera
    }

    fn from(around: f64, above: f64, side: usize) -> Self {
        let ((sin, cos), (rise, reach)) = (around.to_radians().sin_cos(), above.to_radians().sin_cos());
        let (right, back) = (DVec3::new(cos, 0.0, -sin), DVec3::new(sin * reach, rise, cos * reach));
        Self { right, up: back.cross(right), back, centre: DVec3::ZERO, scale: 1.0, side }
    }

    /// The unit vector towards the viewer.
    pub(super) fn back(&self) -> DVec3 {
        self.back
    }

    /// Moves what the triangles cover to the middle. Corners that are infinite or no numbers do not count.
    fn fit(&mut self, mesh: &Mesh) {
        let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let corners =
            mesh.triangles.as_flattened().iter().map(|&w| mesh.positions[mesh.wedges[w as usize] as usize]);
        for p in corners.filter(|p| p.is_finite()).map(Vec3::as_dvec3) {
            let seen = DVec3::new(p.dot(self.right), p.dot(self.up), p.dot(self.back));
            (least, most) = (least.min(seen), most.max(seen));
        }
        if least.x > most.x {
            return;
        }
        let middle = (least + most) * 0.5;
        self.centre = self.right * middle.x + self.up * middle.y + self.back * middle.z;
        let size = (most - least).truncate().max_element();
        if size > 0.0 {
            self.scale = FILLED * self.side as f64 / size;
        }
    }

    /// The camera that has before it, so many times larger, the square from this sample on to the right and downwards.
    pub(super) fn nearer(&self, corner: [usize; 2], zoom: usize) -> Self {
        let half = self.side as f64 / 2.0;
        let [x, y] = corner.map(|at| (at as f64 + half / zoom as f64 - half) / self.scale);
        let centre = self.centre + self.right * x - self.up * y;
        Self { centre, scale: self.scale * zoom as f64, ..self.clone() }
    }

    /// To samples: x to the right, y downwards, z towards the viewer.
    pub(super) fn place(&self, p: Vec3) -> DVec3 {
        let from = (p.as_dvec3() - self.centre) * self.scale;
        let half = self.side as f64 / 2.0;
        DVec3::new(half + from.dot(self.right), half - from.dot(self.up), from.dot(self.back))
    }

    /// A direction as the viewer sees it: x to the right, y upwards, z towards them.
    pub(super) fn turn(&self, d: DVec3) -> Vec3 {
        DVec3::new(d.dot(self.right), d.dot(self.up), d.dot(self.back)).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::Group;

    fn points(positions: Vec<Vec3>) -> Mesh {
        let wedges: Vec<u32> = (0..positions.len() as u32).collect();
        let triangles = wedges.as_chunks().0.to_vec();
        let groups = vec![Group { triangles: 0..triangles.len(), ..Group::default() }];
        Mesh { positions, wedges, triangles, groups, ..Mesh::default() }
    }

    #[test]
    fn the_mesh_fills_the_square() {
        let mesh = points(vec![Vec3::ZERO, Vec3::new(9.0, 1.0, 0.0), Vec3::new(-3.0, 2.0, 5.0)]);
        let camera = Camera::around(&mesh, 100);
        let seen: Vec<DVec3> = mesh.positions.iter().map(|&p| camera.place(p)).collect();
        let range = |of: fn(&DVec3) -> f64| {
            let sorted = seen.iter().map(of).fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
            (sorted.0.round(), sorted.1.round())
        };
        assert_eq!(range(|p| p.x), (4.0, 96.0));
        assert!(range(|p| p.y).0 >= 4.0 && range(|p| p.y).1 <= 96.0);
    }

    #[test]
    fn a_nearer_look_keeps_the_corner() {
        let mesh = points(vec![Vec3::ZERO, Vec3::new(9.0, 1.0, 0.0), Vec3::new(-3.0, 2.0, 5.0)]);
        let camera = Camera::around(&mesh, 100);
        let near = camera.nearer([25, 50], 4);
        for p in mesh.positions {
            let (far, near) = (camera.place(p), near.place(p));
            assert!(
                (near.x - (far.x - 25.0) * 4.0).abs() < 1e-9 && (near.y - (far.y - 50.0) * 4.0).abs() < 1e-9
            );
        }
    }

    #[test]
    fn long_things_are_seen_from_their_side() {
        let along = |axis: Vec3| {
            let mesh = points(vec![Vec3::ZERO, axis * 10.0, axis * 10.0 + Vec3::Y]);
            let camera = Camera::around(&mesh, 100);
            camera.turn(axis.as_dvec3()).x.abs()
        };
        assert!(along(Vec3::X) > 0.8 && along(Vec3::Z) > 0.8);
    }

    #[test]
    fn what_has_no_size_is_in_the_middle() {
        for positions in [Vec::new(), vec![Vec3::ONE; 3], vec![Vec3::ONE, Vec3::NAN, Vec3::INFINITY]] {
            let camera = Camera::around(&points(positions.clone()), 100);
            let middle = positions.first().map_or(Vec3::ZERO, |&p| p);
            assert_eq!(camera.place(middle).truncate().round(), glam::DVec2::splat(50.0));
        }
    }
}
