//! A group of triangles as a primitive.

use serde_json::{Map, Value, json};

use super::attributes;
use super::blob::Blob;
use super::morph;
use crate::bake::mesh::{Group, Mesh};
use crate::bake::weld::classes;

/// How many sets of texture coordinates are written.
const UV_SETS: usize = 8;

/// The wedges of a group as vertices, in order of first use.
pub(super) struct Vertices<'a> {
    pub(super) mesh: &'a Mesh,
    /// Per vertex.
    pub(super) wedges: Vec<usize>,
    /// Per corner, its vertex.
    pub(super) indices: Vec<u32>,
}

impl<'a> Vertices<'a> {
    fn of(mesh: &'a Mesh, group: &Group) -> Self {
        let corners = mesh.triangles[group.triangles.clone()].as_flattened();
        let used = classes(corners.iter().map(|&wedge| [wedge, 0, 0]));
        let wedges = used.firsts.iter().map(|&first| corners[first as usize] as usize).collect();
        Self { mesh, wedges, indices: used.of }
    }

    /// A column of the mesh, a row per vertex.
    pub(super) fn rows<'b, T: Copy>(&'b self, column: &'b [T]) -> impl Iterator<Item = T> + 'b {
        self.wedges.iter().map(|&wedge| column[wedge])
    }
}

/// Writes a group that has triangles, with a morph target if there is one: the mesh with other rows.
pub(in crate::bake) fn add(
    blob: &mut Blob,
    mesh: &Mesh,
    group: &Group,
    material: Option<usize>,
    target: Option<&Mesh>,
) -> Value {
    let vertices = Vertices::of(mesh, group);
    let indices = blob.indices(&vertices.indices, vertices.wedges.len());
    let attributes = attributes(blob, &vertices);
    let targets: Vec<_> =
        target.into_iter().map(|target| morph::target(blob, &vertices, target, &attributes)).collect();
    let mut primitive = json!({ "attributes": attributes, "indices": indices });
    if !targets.is_empty() {
        primitive["targets"] = json!(targets);
    }
    if let Some(material) = material {
        primitive["material"] = json!(material);
    }
    if !group.name.is_empty() {
        primitive["extras"] = json!({ "name": group.name });
    }
    primitive
}

/// The accessor of each attribute that the mesh has.
fn attributes(blob: &mut Blob, vertices: &Vertices<'_>) -> Map<String, Value> {
    let mut accessors = Map::new();
    let mut add = |name: &str, accessor: usize| accessors.insert(name.to_owned(), json!(accessor));
    let mesh = vertices.mesh;
    let positions: Vec<_> =
        vertices.rows(&mesh.wedges).map(|p| mesh.positions[p as usize].to_array()).collect();
    add("POSITION", blob.positions(&positions));
    if let Some(normals) = attributes::normals(vertices) {
        add("NORMAL", blob.floats(&normals));
        if let Some(tangents) = attributes::tangents(vertices, &normals) {
            add("TANGENT", blob.floats(&tangents));
        }
    }
    for (set, column) in mesh.uvs.iter().take(UV_SETS).enumerate() {
        add(&format!("TEXCOORD_{set}"), blob.floats(&attributes::uvs(vertices, column)));
    }
    if let Some(colours) = attributes::colours(vertices) {
        add("COLOR_0", blob.floats(&colours));
    }
    if let Some(skins) = attributes::skins(vertices) {
        let (joints, weights): (Vec<_>, Vec<_>) = skins.into_iter().map(|s| (s.joints, s.weights)).unzip();
        add("JOINTS_0", blob.joints(&joints));
        add("WEIGHTS_0", blob.floats(&weights));
    }
    accessors
}
