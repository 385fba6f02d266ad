//! Polygons as they are, for a control mesh.

use std::collections::BTreeSet;

use super::{Corner, NONE, Polygons};
use crate::bake::finding::Defect;
use crate::bake::read::crease::Crease;
use crate::bake::read::{Origins, Refused};
use crate::bake::subdivide::{ControlFile, ControlMesh, FaceGroup, SharpEdge, SharpVertex};
use crate::bake::weld::{bits, classes};

impl Polygons {
    /// The control mesh of all faces, positions welded exactly. Faces with two corners in one place, with positions
    /// that are not finite, and those that repeat another are left out and reported, as are attributes that are not
    /// finite and creases along no edge.
    pub(in crate::bake::read) fn into_control(
        mut self,
        name: String,
        creases: &[Crease],
    ) -> Result<ControlFile, Refused> {
        self.check_size()?;
        self.check_corners()?;
        let same = classes(self.positions.iter().map(|&p| bits(p)));
        self.corners.iter_mut().for_each(|corner| corner.position = same.of[corner.position as usize]);
        self.positions = same.firsts.iter().map(|&first| self.positions[first as usize] + 0.0).collect();
        let mut mesh = ControlMesh { name, ..ControlMesh::default() };
        let mut origins = Origins { element: self.element, numbers: Vec::new() };
        let kept = self.keep_faces(&mut mesh, &mut origins);
        self.fill_control(&kept, &mut mesh);
        let edges = if creases.is_empty() { BTreeSet::new() } else { mesh.edges() };
        for crease in creases {
            self.sharpen(crease, &same.of, &edges, &mut mesh);
        }
        Ok(ControlFile { mesh, origins, findings: self.findings.0 })
    }

    /// The corners of the faces that can be used. The mesh gets the ends of these faces and their groups.
    fn keep_faces(&mut self, mesh: &mut ControlMesh, origins: &mut Origins) -> Vec<Corner> {
        let (mut kept, mut seen, mut start) = (Vec::new(), BTreeSet::new(), 0);
        let mut runs = self.runs.iter().peekable();
        for (i, face) in self.faces.iter().enumerate() {
            let named = runs.next_if(|run| run.first_face <= i);
            if let Some(run) = named.map(|run| (run.name.clone(), run.material.clone())).or_else(|| {
                // Faces before the first group are one without a name.
                mesh.groups.is_empty().then(Default::default)
            }) {
                let faces = mesh.ends.len()..mesh.ends.len();
                mesh.groups.push(FaceGroup { name: run.0, material: run.1, faces });
            }
            let corners = &self.corners[start..face.end as usize];
            start = face.end as usize;
            if let Some(defect) = self.defect(corners, &mut seen) {
                self.findings.add(defect, || format!("{} {}", self.element, face.number));
                continue;
            }
            kept.extend_from_slice(corners);
            mesh.ends.push(kept.len() as u32);
            origins.numbers.push(face.number);
            if let Some(group) = mesh.groups.last_mut() {
                group.faces.end = mesh.ends.len();
            }
        }
        mesh.groups.retain(|group| !group.faces.is_empty());
        kept
    }

    /// What is wrong with a face, if anything. `seen` has the positions of all faces before, each from its lowest on.
    fn defect(&self, corners: &[Corner], seen: &mut BTreeSet<Vec<u32>>) -> Option<Defect> {
        if corners.iter().any(|corner| !self.positions[corner.position as usize].is_finite()) {
            return Some(Defect::NotFinitePosition);
        }
        let mut face: Vec<u32> = corners.iter().map(|corner| corner.position).collect();
        let lowest = face.iter().enumerate().min_by_key(|&(_, position)| position).map_or(0, |(at, _)| at);
        face.rotate_left(lowest);
        let mut sorted = face.clone();
        sorted.sort_unstable();
        if sorted.windows(2).any(|pair| pair[0] == pair[1]) {
            return Some(Defect::DegenerateFace);
        }
        (!seen.insert(face)).then_some(Defect::DuplicateFace)
    }

    fn fill_control(&mut self, kept: &[Corner], mesh: &mut ControlMesh) {
        let alike = classes(kept.iter().map(|c| [c.position, c.uv, 0]));
        let wedges: Vec<Corner> = alike.firsts.iter().map(|&c| kept[c as usize]).collect();
        mesh.corners = alike.of;
        mesh.wedges = wedges.iter().map(|wedge| wedge.position).collect();
        if wedges.iter().any(|wedge| wedge.uv != NONE) {
            let uv = |w: &Corner| self.uvs.get(w.uv as usize).copied().unwrap_or_default();
            mesh.uvs = vec![wedges.iter().map(uv).collect()];
        }
        if !self.colours.is_empty() {
            let colour =
                |w: &Corner| self.colours.get(w.position as usize).copied().unwrap_or(glam::Vec4::ONE);
            mesh.colours = wedges.iter().map(colour).collect();
        }
        for uv in mesh.uvs.iter_mut().flatten().filter(|uv| !uv.is_finite()) {
            *uv = glam::Vec2::ZERO;
            self.findings.add(Defect::NotFiniteAttribute, || "texture coordinate".to_owned());
        }
        for colour in mesh.colours.iter_mut().filter(|colour| !colour.is_finite()) {
            *colour = glam::Vec4::ONE;
            self.findings.add(Defect::NotFiniteAttribute, || "colour".to_owned());
        }
        mesh.positions = std::mem::take(&mut self.positions);
    }

    fn sharpen(
        &mut self,
        crease: &Crease,
        welded: &[u32],
        edges: &BTreeSet<[u32; 2]>,
        mesh: &mut ControlMesh,
    ) {
        let position = |vertex: &u32| welded.get(*vertex as usize).copied();
        let Some(along) = crease.vertices.iter().map(position).collect::<Option<Vec<u32>>>() else {
            self.findings
                .add(Defect::Unread("creases of unknown vertices"), || format!("line {}", crease.line));
            return;
        };
        let sharpness = crease.sharpness;
        if let [position] = along[..] {
            mesh.sharp_vertices.push(SharpVertex { position, sharpness });
        }
        for ends in along.windows(2) {
            let ends = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            match edges.contains(&ends) {
                true => mesh.sharp_edges.push(SharpEdge { ends, sharpness }),
                false => self
                    .findings
                    .add(Defect::Unread("creases along no edge"), || format!("line {}", crease.line)),
            }
        }
    }
}
