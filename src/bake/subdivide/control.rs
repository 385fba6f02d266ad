//! The control mesh: polygons as an artist made them.

use std::collections::BTreeSet;
use std::ops::Range;

use glam::{Vec2, Vec3, Vec4};

use super::SubdivideError;
use crate::bake::mesh::Mesh;

/// Polygons of welded positions, attributes per wedge as a [`Mesh`] has them, and what is to stay sharp.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ControlMesh {
    /// What the levels are called.
    pub name: String,
    /// In object units. What no face uses is left out of all levels.
    pub positions: Vec<Vec3>,
    /// Per wedge, its position.
    pub wedges: Vec<u32>,
    /// One column per set, each per wedge.
    pub uvs: Vec<Vec<Vec2>>,
    /// Per wedge, linear RGBA; empty where there are none.
    pub colours: Vec<Vec4>,
    /// Wedges, face after face, each face counter-clockwise and of at least 3.
    pub corners: Vec<u32>,
    /// Per face, where its corners end.
    pub ends: Vec<u32>,
    /// Runs of faces, covering all of them in order.
    pub groups: Vec<FaceGroup>,
    /// Edges that are not smooth. Of one that is named twice the greater sharpness counts.
    pub sharp_edges: Vec<SharpEdge>,
    /// Positions that are not smooth. Of one that is named twice the greater sharpness counts.
    pub sharp_vertices: Vec<SharpVertex>,
}

/// A run of faces of one material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaceGroup {
    /// As the file has it; may be empty.
    pub name: String,
    /// The material's name.
    pub material: Option<String>,
    /// Indices of faces.
    pub faces: Range<usize>,
}

/// An edge that stays sharp for so many subdivisions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharpEdge {
    /// Its positions.
    pub ends: [u32; 2],
    /// ≥ 0: so many subdivisions it is a crease, the fraction's share of one more, and smooth from then on. From
    /// [`FOREVER_SHARP`](super::FOREVER_SHARP) on it is never smooth.
    pub sharpness: f32,
}

/// A vertex that stays where it is for so many subdivisions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharpVertex {
    /// Its position's index.
    pub position: u32,
    /// As [`SharpEdge::sharpness`].
    pub sharpness: f32,
}

impl From<&Mesh> for ControlMesh {
    /// The triangles as faces. Normals and tangents are left behind, since they are those of another surface, and skins.
    ///
    /// A cage of quads that was cut into triangles is not put together again: which two triangles were one quad cannot
    /// be told, and a wrong guess changes the surface more than Loop's scheme does.
    fn from(mesh: &Mesh) -> Self {
        let group = |group: &crate::bake::Group| FaceGroup {
            name: group.name.clone(),
            material: group.material.clone(),
            faces: group.triangles.clone(),
        };
        Self {
            name: mesh.name.clone(),
            positions: mesh.positions.clone(),
            wedges: mesh.wedges.clone(),
            uvs: mesh.uvs.clone(),
            colours: mesh.colours.clone(),
            corners: mesh.triangles.as_flattened().to_vec(),
            ends: (1..=mesh.triangles.len() as u32).map(|face| 3 * face).collect(),
            groups: mesh.groups.iter().map(group).collect(),
            ..Self::default()
        }
    }
}

impl ControlMesh {
    /// A control mesh without attributes: a wedge per position, all faces one group.
    pub fn of_faces(positions: Vec<Vec3>, faces: &[&[u32]]) -> Self {
        let wedges = (0..positions.len() as u32).collect();
        let ends = faces.iter().scan(0, |end, face| {
            *end += face.len() as u32;
            Some(*end)
        });
        Self {
            positions,
            wedges,
            ends: ends.collect(),
            corners: faces.concat(),
            groups: vec![FaceGroup { faces: 0..faces.len(), ..FaceGroup::default() }],
            ..Self::default()
        }
    }

    /// Where each face's corners are in [`ControlMesh::corners`].
    pub fn faces(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| start as usize..end as usize)
    }

    /// Whether all faces are triangles.
    pub fn is_triangles(&self) -> bool {
        self.faces().all(|face| face.len() == 3)
    }

    /// Per corner, its position's index.
    pub(super) fn corner_positions(&self) -> Vec<u32> {
        self.corners.iter().map(|&wedge| self.wedges[wedge as usize]).collect()
    }

    /// Whether indices point at something, columns have a row per wedge, faces have three corners or more in different
    /// positions, all numbers that are used are finite, and what is sharp is there.
    ///
    /// # Errors
    /// [`SubdivideError::Mesh`] with the first rule that is broken and the element that breaks it.
    pub fn check(&self) -> Result<(), SubdivideError> {
        self.check_columns()
            .and_then(|()| self.check_faces())
            .and_then(|()| self.check_groups())
            .and_then(|()| self.check_sharp())
            .map_err(SubdivideError::Mesh)
    }

    fn check_columns(&self) -> Result<(), String> {
        let wedges = self.wedges.len();
        let rows = self.uvs.iter().map(Vec::len).chain(Some(self.colours.len()).filter(|&rows| rows > 0));
        if let Some(rows) = rows.into_iter().find(|&rows| rows != wedges) {
            return Err(format!("an attribute must have a row for each of {wedges} wedges, not {rows}"));
        }
        check_indices("wedge", "position", &self.wedges, self.positions.len())?;
        check_indices("corner", "wedge", &self.corners, wedges)?;
        self.uvs
            .iter()
            .try_for_each(|set| check_all("texture coordinate", set.iter().map(|uv| uv.is_finite())))?;
        check_all("colour", self.colours.iter().map(|colour| colour.is_finite()))
    }

    fn check_faces(&self) -> Result<(), String> {
        let mut start = 0;
        for (face, &end) in self.ends.iter().enumerate() {
            if end < start || end - start < 3 || end as usize > self.corners.len() {
                return Err(format!("face {face} must have at least 3 of {} corners", self.corners.len()));
            }
            let corners = &self.corners[start as usize..end as usize];
            let mut positions: Vec<u32> = corners.iter().map(|&wedge| self.wedges[wedge as usize]).collect();
            if let Some(bad) = positions.iter().find(|&&p| !self.positions[p as usize].is_finite()) {
                return Err(format!("position {bad} of face {face} must be finite"));
            }
            positions.sort_unstable();
            if let Some(twice) = positions.windows(2).find(|pair| pair[0] == pair[1]) {
                return Err(format!("face {face} must not use position {} twice", twice[0]));
            }
            start = end;
        }
        match self.corners.len() - start as usize {
            0 => Ok(()),
            left => Err(format!("the faces must use all corners; {left} are left")),
        }
    }

    fn check_groups(&self) -> Result<(), String> {
        let mut end = 0;
        for (i, group) in self.groups.iter().enumerate() {
            if group.faces.start != end || group.faces.end < end {
                return Err(format!("group {i} must start at face {end}, where the last one ends"));
            }
            end = group.faces.end;
        }
        match end == self.ends.len() {
            true => Ok(()),
            false => Err(format!("the groups must cover {} faces, not {end}", self.ends.len())),
        }
    }

    fn check_sharp(&self) -> Result<(), String> {
        let is_sharpness = |sharpness: f32| sharpness >= 0.0;
        let edges = if self.sharp_edges.is_empty() { BTreeSet::new() } else { self.edges() };
        for SharpEdge { ends: [a, b], sharpness } in &self.sharp_edges {
            if !edges.contains(&[*a.min(b), *a.max(b)]) {
                return Err(format!("the sharp edge from position {a} to {b} must be an edge of a face"));
            }
            if !is_sharpness(*sharpness) {
                return Err(format!(
                    "the sharpness of the edge from {a} to {b} must not be below 0: {sharpness}"
                ));
            }
        }
        for SharpVertex { position, sharpness } in &self.sharp_vertices {
            if *position as usize >= self.positions.len() {
                return Err(format!(
                    "a sharp vertex must be one of {}, not {position}",
                    self.positions.len()
                ));
            }
            if !is_sharpness(*sharpness) {
                return Err(format!("the sharpness of position {position} must not be below 0: {sharpness}"));
            }
        }
        Ok(())
    }

    /// All edges, each with the lower position first.
    pub(in crate::bake) fn edges(&self) -> BTreeSet<[u32; 2]> {
        self.faces().flat_map(|face| self.edges_of(face)).collect()
    }

    /// The edges of a face, each with the lower position first.
    pub(super) fn edges_of(&self, face: Range<usize>) -> impl Iterator<Item = [u32; 2]> + '_ {
        let position = |corner: usize| self.wedges[self.corners[corner] as usize];
        let (start, end) = (face.start, face.end);
        face.map(move |corner| {
            let next = if corner + 1 == end { start } else { corner + 1 };
            let (a, b) = (position(corner), position(next));
            [a.min(b), a.max(b)]
        })
    }
}

fn check_indices(what: &str, of: &str, indices: &[u32], count: usize) -> Result<(), String> {
    match indices.iter().position(|&i| i as usize >= count) {
        Some(at) => Err(format!("{what} {at} must be one of {count} {of}s, not {}", indices[at])),
        None => Ok(()),
    }
}

fn check_all(what: &str, mut is_finite: impl Iterator<Item = bool>) -> Result<(), String> {
    match is_finite.position(|is_finite| !is_finite) {
        Some(at) => Err(format!("{what} {at} must be finite")),
        None => Ok(()),
    }
}
