//! Adds levels to a scene: bytes first, then meshes, then nodes.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::nodes::Show;
use super::survey::primitives;
use super::{MeshError, Part, Scene, Subject, at, embed, names, whole};
use crate::bake::mesh::{Group, Mesh};
use crate::bake::write::LevelOut;
use crate::bake::write::glb::blob::{Blob, packed};
use crate::bake::write::glb::{check, extras, primitive};

/// What [`Scene::write`] says.
pub(super) fn write(mut scene: Scene<'_>, levels: &[Vec<LevelOut<'_>>]) -> Result<Vec<u8>, MeshError> {
    check_all(&scene, levels)?;
    let bytes = embed::joined(&mut scene.document, &scene.source)?;
    let (views, accessors) = (scene.document.take("bufferViews"), scene.document.take("accessors"));
    let mut blob = Blob::after(bytes, views, accessors);
    for subject in std::mem::take(&mut scene.subjects) {
        let chains = &levels[subject.parts.clone()];
        let meshes = add_meshes(&mut scene, &mut blob, &subject, chains)?;
        add_nodes(&mut scene, &subject, chains, &meshes);
    }
    let (views, accessors, bytes) = blob.into_parts();
    scene.document.put("bufferViews", views);
    scene.document.put("accessors", accessors);
    scene.document.put(
        "buffers",
        if bytes.is_empty() { Vec::new() } else { vec![json!({ "byteLength": bytes.len() })] },
    );
    let Scene { source, document, .. } = scene;
    packed(&document.into_text(), bytes).map_err(|rule| whole(&source, rule))
}

/// Refuses levels that are not those of the scene's parts.
fn check_all(scene: &Scene<'_>, levels: &[Vec<LevelOut<'_>>]) -> Result<(), MeshError> {
    if levels.len() != scene.parts.len() {
        let rule =
            format!("there must be levels for each of {} parts, not {}", scene.parts.len(), levels.len());
        return Err(whole(&scene.source, rule));
    }
    for (part, chain) in scene.parts.iter().zip(levels) {
        for (i, level) in chain.iter().enumerate() {
            let refused = |rule| at(&scene.source, format!("level {i} of {}", part.name), rule);
            check_level(part, level.mesh).map_err(refused)?;
        }
    }
    Ok(())
}

fn check_level(part: &Part, level: &Mesh) -> Result<(), String> {
    check(level)?;
    let known = |group: &Group| part.chunk.mesh.groups.iter().any(|g| g.name == group.name);
    if let Some(strange) = level.groups.iter().find(|group| !known(group)) {
        return Err(format!("its group '{}' must be one of the part's", strange.name));
    }
    if level.triangles.is_empty() {
        return Err("it must have a triangle".to_owned());
    }
    part.chunk
        .check(level)
        .map_err(|[a, b]| format!("it must have the edge from {a} to {b} as its neighbours do"))
}

/// The mesh of each level of each part. Level 0 of a mesh that is not split is the file's own.
fn add_meshes(
    scene: &mut Scene<'_>,
    blob: &mut Blob,
    subject: &Subject,
    chains: &[Vec<LevelOut<'_>>],
) -> Result<Vec<Vec<usize>>, MeshError> {
    let mut meshes = Vec::new();
    for (part, chain) in subject.parts.clone().zip(chains) {
        let Part { name, chunk, is_chunk, .. } = &scene.parts[part];
        let own = [LevelOut::new(&chunk.mesh)];
        let chain = if chain.is_empty() { &own[..] } else { &chain[..] };
        let mut of_part = Vec::new();
        for (i, level) in chain.iter().enumerate() {
            if i == 0 && !is_chunk {
                of_part.push(subject.mesh);
                continue;
            }
            let name = if i == 0 { name.clone() } else { names::of_level(name, i) };
            let mesh = mesh(blob, primitives(&scene.document, subject.mesh), level, &name);
            blob.check().map_err(|rule| at(&scene.source, name, rule))?;
            of_part.push(scene.document.push("meshes", mesh));
        }
        meshes.push(of_part);
    }
    Ok(meshes)
}

/// A level as a mesh of the file: its groups are primitives like those that they come from, with new triangles.
fn mesh(blob: &mut Blob, templates: &[Value], level: &LevelOut<'_>, name: &str) -> Value {
    let mut bare: BTreeMap<Vec<String>, Mesh> = BTreeMap::new();
    let mut new = Vec::new();
    for group in level.mesh.groups.iter().filter(|group| !group.triangles.is_empty()) {
        let template = group.name.parse().ok().and_then(|i: usize| templates.get(i)).unwrap_or(&Value::Null);
        let attributes = attribute_names(template);
        let mesh = bare.entry(attributes.clone()).or_insert_with(|| without_others(level.mesh, &attributes));
        let unnamed = Group { name: String::new(), ..group.clone() };
        new.push(like(template, primitive::add(blob, mesh, &unnamed, None, None)));
    }
    let mut mesh = json!({ "name": name, "primitives": new });
    let extras = extras(level);
    if !extras.is_empty() {
        mesh["extras"] = Value::Object(extras);
    }
    mesh
}

fn attribute_names(primitive: &Value) -> Vec<String> {
    let attributes = primitive.get("attributes").and_then(Value::as_object);
    attributes.into_iter().flat_map(Map::keys).cloned().collect()
}

/// The mesh without what is there for the sake of other primitives.
fn without_others(mesh: &Mesh, attributes: &[String]) -> Mesh {
    let mut bare = mesh.clone();
    let has = |name: &str| attributes.iter().any(|attribute| attribute == name);
    let sets = (0..bare.uvs.len()).take_while(|set| has(&format!("TEXCOORD_{set}"))).count();
    bare.uvs.truncate(sets);
    if !has("NORMAL") {
        bare.normals.clear();
    }
    if !has("TANGENT") {
        bare.tangents.clear();
    }
    if !has("COLOR_0") {
        bare.colours.clear();
    }
    bare.skins.clear();
    bare
}

/// The template with other geometry.
fn like(template: &Value, geometry: Value) -> Value {
    let mut primitive = template.clone();
    let members = super::document::object(&mut primitive);
    members.remove("mode");
    for member in ["attributes", "indices"] {
        members.insert(member.to_owned(), geometry[member].clone());
    }
    primitive
}

/// Has every node show its levels.
fn add_nodes(scene: &mut Scene<'_>, subject: &Subject, chains: &[Vec<LevelOut<'_>>], meshes: &[Vec<usize>]) {
    let coverage =
        |chain: &Vec<LevelOut<'_>>| -> Vec<f32> { chain.iter().filter_map(|level| level.coverage).collect() };
    let shows: Vec<Show> =
        chains.iter().zip(meshes).map(|(chain, meshes)| Show { meshes, coverage: coverage(chain) }).collect();
    let is_split = scene.parts[subject.parts.start].is_chunk;
    for &node in &subject.nodes {
        match (is_split, &shows[..]) {
            (false, [show]) => scene.document.show(node, show),
            _ => scene.document.show_chunks(node, &shows),
        }
    }
}
