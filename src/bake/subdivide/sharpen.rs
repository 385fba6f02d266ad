//! Creases where faces meet at an angle.

use std::collections::BTreeMap;

use glam::DVec3;

use super::{ControlMesh, SharpEdge};

impl ControlMesh {
    /// Makes edges sharp whose two faces are turned against each other by `degrees` or more, from 0 to 180: what most
    /// files cannot say, but most artists' meshes show. Edges that are sharper stay as they are. Returns how many there
    /// are. O(n log n).
    ///
    /// Faces are as flat as Newell's normal has them (I. Sutherland, R. Sproull, R. Schumacker 1974); one without area
    /// makes no edge sharp.
    ///
    /// # Panics
    /// Where the mesh does not pass [`ControlMesh::check`].
    pub fn sharpen(&mut self, degrees: f64, sharpness: f32) -> usize {
        let mut normals: BTreeMap<[u32; 2], Vec<DVec3>> = BTreeMap::new();
        for face in self.faces() {
            let normal = self.normal(face.clone());
            self.edges_of(face).for_each(|edge| normals.entry(edge).or_default().push(normal));
        }
        let most = degrees.to_radians().cos();
        let is_sharp = |faces: &[DVec3]| matches!(faces, [a, b] if *a != DVec3::ZERO && *b != DVec3::ZERO && a.dot(*b) <= most);
        let sharp = normals.into_iter().filter(|(_, faces)| is_sharp(faces));
        let before = self.sharp_edges.len();
        self.sharp_edges.extend(sharp.map(|(ends, _)| SharpEdge { ends, sharpness }));
        self.sharp_edges.len() - before
    }

    /// Of unit length, or zero.
    fn normal(&self, face: std::ops::Range<usize>) -> DVec3 {
        let at =
            |corner: usize| self.positions[self.wedges[self.corners[corner] as usize] as usize].as_dvec3();
        let origin = at(face.start);
        let pairs = face.clone().skip(1).zip(face.skip(2));
        let normal: DVec3 = pairs.map(|(a, b)| (at(a) - origin).cross(at(b) - origin)).sum();
        normal.normalize_or_zero()
    }
}
