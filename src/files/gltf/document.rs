//! The parts of a glTF file that tell counts and bounds.
//!
//! The vocabulary is the `gltf` crate's. The root is our own, because that crate refuses files for parts that matter
//! to nobody who counts (a texture without an image, a scene without nodes, an extension it does not implement).

use ::gltf::json;
use serde::Deserialize;

use super::super::json::{Entry, Listed, parse};
use super::super::{FileError, disk};
use super::Refused;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    asset: Asset,
    scene: Option<usize>,
    #[serde(default)]
    scenes: Listed<SceneRoots>,
    #[serde(default)]
    nodes: Listed<json::Node>,
    #[serde(default)]
    meshes: Listed<json::Mesh>,
    #[serde(default)]
    accessors: Listed<json::Accessor>,
    #[serde(default)]
    buffer_views: Listed<json::buffer::View>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
struct Asset {
    version: String,
}

#[derive(Deserialize)]
struct SceneRoots {
    #[serde(default)]
    nodes: Vec<usize>,
}

impl Entry for SceneRoots {
    const KIND: &'static str = "scene";
}

impl Entry for json::Node {
    const KIND: &'static str = "node";
}

impl Entry for json::Mesh {
    const KIND: &'static str = "mesh";
}

impl Entry for json::Accessor {
    const KIND: &'static str = "accessor";
}

impl Entry for json::buffer::View {
    const KIND: &'static str = "buffer view";
}

/// Required extensions that change neither counts nor bounds: compression (the accessors tell what comes out),
/// images, lights, metadata. `KHR_materials_*` are fine as well.
const HARMLESS: [&str; 17] = [
    "EXT_lights_ies",
    "EXT_lights_image_based",
    "EXT_meshopt_compression",
    "EXT_texture_avif",
    "EXT_texture_procedurals",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
    "MSFT_lod",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_texture_dds",
];

impl Document {
    pub(super) fn open(bytes: &[u8], file: &str) -> Result<Self, FileError> {
        let json = match bytes.starts_with(b"glTF") {
            true => json_chunk(bytes).map_err(|rule| FileError::whole(file, rule))?,
            false => bytes,
        };
        let document: Self = parse(disk::text_of(json, file)?, file)?;
        match document.broken_rule() {
            Some(rule) => Err(FileError::whole(file, rule)),
            None => Ok(document),
        }
    }

    fn broken_rule(&self) -> Option<String> {
        if !self.asset.version.starts_with("2.") {
            return Some(format!("its asset.version must be 2.x, not {}", self.asset.version));
        }
        let harmless = |name: &str| HARMLESS.contains(&name) || name.starts_with("KHR_materials_");
        let strange = self.extensions_required.iter().find(|name| !harmless(name))?;
        Some(format!("it requires the extension {strange}, which is not supported"))
    }

    /// The nodes that the scene starts from; `None` where the file has no scene.
    pub(super) fn scene_roots(&self) -> Result<Option<&[usize]>, Refused> {
        let scene = match self.scene {
            Some(scene) => self.scenes.0.get(scene).map(Some),
            None => Some(self.scenes.0.first()),
        };
        let unknown = || Refused { place: None, rule: "its default scene must be one of its scenes".into() };
        Ok(scene.ok_or_else(unknown)?.map(|s| s.nodes.as_slice()))
    }

    pub(super) fn nodes(&self) -> &[json::Node] {
        &self.nodes.0
    }

    pub(super) fn node(&self, node: usize) -> &json::Node {
        &self.nodes.0[node]
    }

    pub(super) fn children(&self, node: usize) -> impl DoubleEndedIterator<Item = usize> {
        self.node(node).children.iter().flatten().map(json::Index::value)
    }

    pub(super) fn mesh_of(&self, node: usize) -> Option<usize> {
        self.node(node).mesh.map(|mesh| mesh.value())
    }

    pub(super) fn meshes(&self) -> &[json::Mesh] {
        &self.meshes.0
    }

    pub(super) fn accessor(&self, accessor: usize) -> Option<&json::Accessor> {
        self.accessors.0.get(accessor)
    }

    pub(super) fn buffer_view(&self, view: usize) -> Option<&json::buffer::View> {
        self.buffer_views.0.get(view)
    }

    /// What errors call a node.
    pub(super) fn node_place(&self, node: usize) -> String {
        called("node", node, self.nodes.0.get(node).and_then(|n| n.name.as_deref()))
    }

    /// What errors call a mesh.
    pub(super) fn mesh_place(&self, mesh: usize) -> String {
        called("mesh", mesh, self.meshes.0.get(mesh).and_then(|m| m.name.as_deref()))
    }
}

fn called(kind: &str, index: usize, name: Option<&str>) -> String {
    name.map_or_else(|| format!("{kind} {index}"), |name| format!("{kind} {index} '{name}'"))
}

/// The JSON within a GLB: a header of 12 bytes (magic, version, length), then chunks (length, kind, bytes), JSON the
/// first of them.
fn json_chunk(bytes: &[u8]) -> Result<&[u8], String> {
    let version = u32_at(bytes, 4).ok_or("it is cut off within its header")?;
    if version != 2 {
        return Err(format!("its GLB version must be 2, not {version}"));
    }
    let length = u32_at(bytes, 8).ok_or("it is cut off within its header")? as usize;
    let bytes = bytes
        .get(..length)
        .ok_or_else(|| format!("it is cut off: its header says {length} bytes, it has {}", bytes.len()))?;
    let (kind, json, mut rest) = split_chunk(bytes.get(12..).unwrap_or_default())?;
    if kind != b"JSON" {
        return Err("its first chunk must be JSON".to_owned());
    }
    while !rest.is_empty() {
        (_, _, rest) = split_chunk(rest)?;
    }
    Ok(json)
}

type Chunk<'a> = (&'a [u8], &'a [u8], &'a [u8]);

/// The first chunk's kind and bytes, and what follows.
fn split_chunk(bytes: &[u8]) -> Result<Chunk<'_>, String> {
    let cut = || "it is cut off within a chunk".to_owned();
    let length = u32_at(bytes, 0).ok_or_else(cut)? as usize;
    let kind = bytes.get(4..8).ok_or_else(cut)?;
    let (chunk, rest) = bytes[8..].split_at_checked(length).ok_or_else(cut)?;
    Ok((kind, chunk, rest))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..)?.first_chunk::<4>()?;
    Some(u32::from_le_bytes(*bytes))
}
