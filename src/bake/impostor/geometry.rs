//! The quads of an impostor as a mesh, and what is seen of it.

use glam::{DVec2, DVec3};

use super::{Frame, Impostor, Kind};
use crate::bake::mesh::{Group, Mesh};

impl Impostor {
    /// What is drawn, with texture coordinates into the atlas: all quads of cross-quads, to be drawn from both sides; of
    /// the other kinds the frame that is nearest to the front, as it stands before an engine turns it. All is one group,
    /// whose material is called `NAME_impostor`.
    pub fn mesh(&self) -> Mesh {
        let mut mesh = Mesh { name: self.name.clone(), uvs: vec![Vec::new()], ..Mesh::default() };
        self.drawn().for_each(|frame| self.add_polygon(&mut mesh, frame));
        let material = Some(format!("{}_impostor", self.name));
        mesh.groups = vec![Group { triangles: 0..mesh.triangles.len(), material, ..Group::default() }];
        mesh
    }

    /// The frames of [`Impostor::mesh`].
    fn drawn(&self) -> impl Iterator<Item = &Frame> {
        let all = matches!(self.kind, Kind::CrossQuads { .. });
        let front = self.sights(self.front).first().map_or(0, |sight| sight.frame);
        let (from, count) = if all { (0, self.frames.len()) } else { (front, 1) };
        self.frames.iter().skip(from).take(count)
    }

    /// As a fan.
    fn add_polygon(&self, mesh: &mut Mesh, frame: &Frame) {
        let first = mesh.positions.len() as u32;
        for &at in &frame.outline {
            let place = self.center + frame.right * at.x + frame.up * at.y;
            mesh.wedges.push(mesh.positions.len() as u32);
            mesh.positions.push(place.as_vec3());
            mesh.normals.push(frame.direction.as_vec3());
            mesh.uvs[0].push(self.uv_of(frame, at).as_vec2());
        }
        let corners = frame.outline.len() as u32;
        mesh.triangles.extend((1..corners - 1).map(|k| [first, first + k, first + k + 1]));
    }

    /// Triangles and vertices of what is drawn, of the frame that has most of them.
    pub(super) fn counts(&self) -> (u32, u32) {
        let corners = |frame: &Frame| frame.outline.len() as u32;
        match self.kind {
            Kind::CrossQuads { .. } => {
                let vertices: u32 = self.frames.iter().map(corners).sum();
                (vertices - 2 * self.frames.len() as u32, vertices)
            }
            _ => {
                let vertices = self.frames.iter().map(corners).max().unwrap_or(0);
                (vertices - 2, vertices)
            }
        }
    }

    /// What a viewer in this direction (of any length) sees of the impostor of a mesh, as geometry: the mesh flattened
    /// onto the quads that are drawn. Of what is blended, the frame that counts most. For pictures and tests: its
    /// triangles are as many as those of the mesh, or that for each quad.
    ///
    /// # Panics
    /// Where the mesh does not [check](Mesh::check).
    pub fn seen(&self, mesh: &Mesh, direction: DVec3) -> Mesh {
        let direction = direction.normalize_or(self.front);
        let sights = self.sights(direction);
        let shown = if self.kind.blends() { &sights[..sights.len().min(1)] } else { &sights[..] };
        let mut seen = Mesh { name: self.name.clone(), ..Mesh::default() };
        for sight in shown {
            self.add_flattened(&mut seen, mesh, sight.frame, direction);
        }
        seen.groups = vec![Group { triangles: 0..seen.triangles.len(), ..Group::default() }];
        seen
    }

    fn add_flattened(&self, seen: &mut Mesh, mesh: &Mesh, frame: usize, direction: DVec3) {
        let first = seen.positions.len() as u32;
        let (view, quad) = (self.frames[frame].view(), self.quad(&self.frames[frame], direction));
        let flat = |p: u32| view.flat(mesh.positions[p as usize].as_dvec3() - self.center);
        let all = 0..mesh.positions.len() as u32;
        seen.positions.extend(all.clone().map(|p| (self.center + quad.lift(flat(p))).as_vec3()));
        seen.wedges.extend(all.map(|p| first + p));
        let away = self.kind.stands() && self.frames[frame].direction.dot(direction) < 0.0;
        for triangle in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(triangle);
            let corners = if is_clockwise([a, b, c].map(flat)) != away { [a, c, b] } else { [a, b, c] };
            seen.triangles.push(corners.map(|p| first + p));
        }
    }
}

impl Kind {
    /// Whether several frames are drawn in one place.
    fn blends(self) -> bool {
        matches!(self, Self::Octahedral { .. })
    }
}

fn is_clockwise([a, b, c]: [DVec2; 3]) -> bool {
    (b - a).perp_dot(c - a) < 0.0
}
