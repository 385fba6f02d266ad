//! What the text formats, PLY and STL have in common: vertices, and polygons of corners. From here to a mesh.

use glam::{Vec2, Vec3, Vec4};

use super::text::quoted;
use super::triangulate::{TooConcave, Triangulator};
use super::{MeshFile, Origins, Refused, short_name};
use crate::bake::finding::{Defect, Findings};
use crate::bake::mesh::{Group, Mesh};
use crate::bake::weld::{classes, weld};

mod control;

/// A file's columns as it has them, and its faces.
pub(super) struct Polygons {
    /// What a face's number counts: "line" or "face".
    pub(super) element: &'static str,
    pub(super) positions: Vec<Vec3>,
    /// Per position; may end early or be empty, the rest is white.
    pub(super) colours: Vec<Vec4>,
    pub(super) normals: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    /// The corners of all faces, one face after the other.
    corners: Vec<Corner>,
    faces: Vec<Face>,
    runs: Vec<Run>,
    pub(super) findings: Findings,
}

/// What a corner points at; [`NONE`] where it has no normal or texture coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}

/// The index that is never one.
pub(super) const NONE: u32 = u32::MAX;

impl Corner {
    /// Without a normal or texture coordinate.
    pub(super) fn bare(position: u32) -> Self {
        Self { position, uv: NONE, normal: NONE }
    }
}

struct Face {
    /// Where its corners end in the list of all.
    end: u32,
    number: u32,
}

/// Faces from here on are of this group.
struct Run {
    first_face: usize,
    name: String,
    material: Option<String>,
}

impl Polygons {
    pub(super) fn new(element: &'static str) -> Self {
        Self {
            element,
            positions: Vec::new(),
            colours: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            corners: Vec::new(),
            faces: Vec::new(),
            runs: Vec::new(),
            findings: Findings::default(),
        }
    }

    /// Adds a corner to the face that [`Polygons::end_face`] ends.
    pub(super) fn add_corner(&mut self, corner: Corner) {
        self.corners.push(corner);
    }

    /// Ends a face; one of fewer than three corners is left out and reported.
    pub(super) fn end_face(&mut self, number: u32) -> Result<(), Refused> {
        let start = self.faces.last().map_or(0, |face| face.end as usize);
        if self.corners.len() - start < 3 {
            self.corners.truncate(start);
            let element = self.element;
            self.findings.add(Defect::ShortFace, || format!("{element} {number}"));
            return Ok(());
        }
        let end = u32::try_from(self.corners.len()).map_err(|_| Refused::whole(TOO_LARGE))?;
        self.faces.push(Face { end, number });
        Ok(())
    }

    /// Faces that follow belong to this group.
    pub(super) fn begin_group(&mut self, name: &str, material: Option<&str>) {
        let material = material.map(str::to_owned);
        if self.runs.last().is_some_and(|run| run.name == name && run.material == material) {
            return;
        }
        let first_face = self.faces.len();
        self.runs.pop_if(|run| run.first_face == first_face);
        self.runs.push(Run { first_face, name: name.to_owned(), material });
    }

    pub(super) fn into_file(mut self, name: String) -> Result<MeshFile, Refused> {
        self.check_size()?;
        self.check_corners()?;
        let alike = classes(self.corners.iter().map(|c| [c.position, c.uv, c.normal]));
        let wedges: Vec<Corner> = alike.firsts.iter().map(|&c| self.corners[c as usize]).collect();
        let mut mesh = Mesh { name, ..Mesh::default() };
        let mut origins = Origins { element: self.element, numbers: Vec::new() };
        self.cut_faces(&alike.of, &mut mesh, &mut origins)?;
        self.fill_columns(&wedges, &mut mesh);
        weld(&mut mesh);
        Ok(MeshFile { mesh, origins, findings: self.findings.0 })
    }

    fn check_size(&self) -> Result<(), Refused> {
        let columns = [self.positions.len(), self.normals.len(), self.uvs.len()];
        match columns.iter().any(|&n| n >= NONE as usize) {
            true => Err(Refused::whole(TOO_LARGE)),
            false => Ok(()),
        }
    }

    fn place(&self, face: &Face) -> String {
        format!("{} {}", self.element, face.number)
    }

    /// Refuses positions that are not there, and takes away normals and texture coordinates that are not.
    fn check_corners(&mut self) -> Result<(), Refused> {
        let (uvs, normals) = (self.uvs.len(), self.normals.len());
        let mut start = 0;
        for face in &self.faces {
            for corner in &mut self.corners[start..face.end as usize] {
                if corner.position as usize >= self.positions.len() {
                    let (at, of) = (u64::from(corner.position) + 1, self.positions.len());
                    let rule = format!("a corner must be one of {of} vertices, not number {at}");
                    return Err(Refused::at(self.place(face), rule));
                }
                let unknown = |index: u32, count: usize| index != NONE && index as usize >= count;
                if unknown(corner.uv, uvs) || unknown(corner.normal, normals) {
                    let element = self.element;
                    self.findings.add(Defect::UnknownAttribute, || format!("{element} {}", face.number));
                }
                corner.uv = if unknown(corner.uv, uvs) { NONE } else { corner.uv };
                corner.normal = if unknown(corner.normal, normals) { NONE } else { corner.normal };
            }
            start = face.end as usize;
        }
        Ok(())
    }

    /// Triangles of wedges, the groups over them, and where they come from.
    fn cut_faces(&self, wedge_of: &[u32], mesh: &mut Mesh, origins: &mut Origins) -> Result<(), Refused> {
        let mut triangulator = Triangulator::default();
        let mut runs = self.runs.iter().peekable();
        let (mut start, mut polygon) = (0, Vec::new());
        for (i, face) in self.faces.iter().enumerate() {
            if let Some(run) = runs.next_if(|run| run.first_face <= i) {
                mesh.groups.push(opened(run, mesh.triangles.len()));
            }
            let corners = start..face.end as usize;
            polygon.clear();
            polygon.extend(self.corners[corners.clone()].iter().map(|c| self.positions[c.position as usize]));
            let emit = |t: [u32; 3]| mesh.triangles.push(t.map(|corner| wedge_of[start + corner as usize]));
            let cut = triangulator.cut(&polygon, emit);
            cut.map_err(|TooConcave| Refused::at(self.place(face), TOO_CONCAVE))?;
            origins.numbers.resize(mesh.triangles.len(), face.number);
            start = corners.end;
        }
        close_groups(mesh);
        Ok(())
    }

    fn fill_columns(&mut self, wedges: &[Corner], mesh: &mut Mesh) {
        mesh.wedges = wedges.iter().map(|w| w.position).collect();
        if wedges.iter().any(|w| w.normal != NONE) {
            let normal = |w: &Corner| self.normals.get(w.normal as usize).copied().unwrap_or_default();
            mesh.normals = wedges.iter().map(normal).collect();
        }
        if wedges.iter().any(|w| w.uv != NONE) {
            let uv = |w: &Corner| self.uvs.get(w.uv as usize).copied().unwrap_or_default();
            mesh.uvs = vec![wedges.iter().map(uv).collect()];
        }
        if !self.colours.is_empty() {
            let colour = |w: &Corner| self.colours.get(w.position as usize).copied().unwrap_or(Vec4::ONE);
            mesh.colours = wedges.iter().map(colour).collect();
        }
        mesh.positions = std::mem::take(&mut self.positions);
    }
}

const TOO_LARGE: &str = "it must have fewer than 4294967295 vertices and corners";
const TOO_CONCAVE: &str = "its concave polygons have too many corners to be cut into triangles";

/// A group that ends where the next one starts.
fn opened(run: &Run, start: usize) -> Group {
    Group { name: run.name.clone(), material: run.material.clone(), triangles: start..start }
}

/// Ends every group where the next one starts; triangles before the first get a group without a name.
fn close_groups(mesh: &mut Mesh) {
    if mesh.groups.first().map_or(!mesh.triangles.is_empty(), |g| g.triangles.start > 0) {
        mesh.groups.insert(0, Group::default());
    }
    let mut end = mesh.triangles.len();
    for group in mesh.groups.iter_mut().rev() {
        group.triangles.end = end;
        end = group.triangles.start;
    }
}

/// RGB or RGBA, each from 0 to 1.
pub(super) fn colour(parts: &[f32]) -> Option<Vec4> {
    match *parts {
        [r, g, b] => Some(Vec4::new(r, g, b, 1.0)),
        [r, g, b, a] => Some(Vec4::new(r, g, b, a)),
        _ => None,
    }
}

/// A name as the file spells it, as far as it is UTF-8 and not too long.
pub(super) fn name_of(bytes: &[u8]) -> String {
    short_name(&String::from_utf8_lossy(bytes.trim_ascii()))
}

/// "'x' must be …", for a word that starts nothing known.
pub(super) fn must_be(word: &[u8], what: &str) -> String {
    format!("{} must be {what}", quoted(word))
}
