//! Meshes from files: [`obj`], [`ply`], [`off`], [`stl`] and [`gltf`].
//!
//! All of a file becomes one mesh, its parts as groups. Positions are welded exactly; wedges keep what differs.
//! Nothing is trusted: an error names the file, the line or element and the rule it breaks, and memory grows with the
//! file's size, whatever its header says. What is odd but harmless is passed over and reported
//! ([`MeshFile::findings`]). Text may be UTF-8 or UTF-16 with a mark, its lines end in LF, CR LF or CR.
//!
//! [`load`] is what most want: read, then repaired.

pub mod gltf;
pub mod obj;
pub mod off;
pub mod ply;
pub mod stl;

mod crease;
mod polygons;
mod text;
pub(super) mod triangulate;

use std::fmt;
use std::path::Path;

use super::finding::Finding;
use super::mesh::Mesh;
use super::repair::repair;

/// A mesh as a file has it, welded.
#[derive(Clone, Debug)]
pub struct MeshFile {
    /// The mesh.
    pub mesh: Mesh,
    /// Where its triangles come from.
    pub origins: Origins,
    /// What was odd.
    pub findings: Vec<Finding>,
}

/// Where in the file each triangle comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origins {
    /// What is counted: "line", "face", "triangle", "node".
    pub element: &'static str,
    /// Its number, per triangle.
    pub numbers: Vec<u32>,
}

impl Origins {
    /// Of a mesh that comes from no file: its triangles' own numbers.
    pub fn of_made(mesh: &Mesh) -> Self {
        Self { element: "triangle", numbers: (0..mesh.triangles.len() as u32).collect() }
    }

    /// What to call the place of a triangle.
    pub fn place(&self, triangle: usize) -> String {
        format!("{} {}", self.element, self.numbers[triangle])
    }
}

/// Why a file was refused. Displayed as `FILE: PLACE: RULE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshError {
    /// The file, as the caller named it.
    pub file: String,
    /// The line or element at fault; `None` where it is the whole file.
    pub place: Option<String>,
    /// The rule it breaks.
    pub rule: String,
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.file)?;
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        f.write_str(&self.rule)
    }
}

impl std::error::Error for MeshError {}

/// A [`MeshError`] before anybody says which file.
#[derive(Debug)]
struct Refused {
    place: Option<String>,
    rule: String,
}

impl Refused {
    fn whole(rule: impl Into<String>) -> Self {
        Self { place: None, rule: rule.into() }
    }

    fn at(place: impl Into<String>, rule: impl Into<String>) -> Self {
        Self { place: Some(place.into()), rule: rule.into() }
    }

    fn line(number: u32, rule: impl Into<String>) -> Self {
        Self::at(format!("line {number}"), rule)
    }

    fn within(self, file: &str) -> MeshError {
        MeshError { file: file.to_owned(), place: self.place, rule: self.rule }
    }
}

/// The formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY, text or binary.
    Ply,
    /// Geomview OFF, text.
    Off,
    /// STL, text or binary.
    Stl,
    /// glTF 2.0, `.gltf` or `.glb`.
    Gltf,
}

impl Format {
    /// By the first bytes where they tell, else by the extension of the name.
    pub fn guess(bytes: &[u8], file: &str) -> Option<Self> {
        if bytes.starts_with(b"glTF") {
            return Some(Self::Gltf);
        }
        if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            return Some(Self::Ply);
        }
        let extension = Path::new(file).extension().and_then(|e| e.to_str()).unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "off" | "coff" | "noff" => Some(Self::Off),
            "stl" => Some(Self::Stl),
            "gltf" | "glb" => Some(Self::Gltf),
            _ => None,
        }
    }
}

/// The file at `path`, repaired as far as that is safe; the findings of both are in one list.
///
/// # Errors
/// What the format's reader refuses, and a file that has no triangle once it is repaired.
pub fn load(path: &Path) -> Result<MeshFile, MeshError> {
    let mut read = read(path)?;
    let found = repair(&mut read.mesh, &mut read.origins);
    read.findings.extend(found);
    if read.mesh.triangles.is_empty() {
        let rule = match read.findings.first() {
            Some(finding) => format!("it must have a triangle that can be used ({finding})"),
            None => "it must have a triangle".to_owned(),
        };
        return Err(Refused::whole(rule).within(&path.display().to_string()));
    }
    Ok(read)
}

/// The file at `path` as it is, which may be a mesh without triangles.
///
/// # Errors
/// What cannot be read from disk, an unknown format, and what the format's reader refuses.
pub fn read(path: &Path) -> Result<MeshFile, MeshError> {
    let file = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|e| Refused::whole(format!("it cannot be read: {e}")));
    let bytes = bytes.map_err(|refused| refused.within(&file))?;
    if bytes.starts_with(&[0x1f, 0x8b]) {
        return Err(Refused::whole("it is compressed by gzip and must be unpacked first").within(&file));
    }
    let format = Format::guess(&bytes, &file).ok_or_else(|| {
        Refused::whole("it must end in .obj, .ply, .off, .stl, .gltf or .glb").within(&file)
    })?;
    match format {
        Format::Gltf => gltf::read(&bytes, &file, path.parent()),
        format => from_bytes(&bytes, &file, format),
    }
}

/// The bytes of a file that needs no other. `file` names it in errors.
///
/// # Errors
/// What the format's reader refuses; glTF whose buffers are other files.
pub fn from_bytes(bytes: &[u8], file: &str, format: Format) -> Result<MeshFile, MeshError> {
    match format {
        Format::Obj => obj::read(bytes, file),
        Format::Ply => ply::read(bytes, file),
        Format::Off => off::read(bytes, file),
        Format::Stl => stl::read(bytes, file),
        Format::Gltf => gltf::read(bytes, file, None),
    }
}

/// The name without folder and extension.
fn stem(file: &str) -> String {
    Path::new(file).file_stem().and_then(|s| s.to_str()).unwrap_or(file).to_owned()
}

/// A name as far as it is kept: names are repeated where groups alternate, and a file may have one of a megabyte.
fn short_name(name: &str) -> String {
    name.chars().take(LONGEST_NAME).collect()
}

/// In characters.
const LONGEST_NAME: usize = 256;
