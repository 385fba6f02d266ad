//! The parts of a glTF file that tell counts and bounds.
//!
//! The vocabulary is the `gltf` crate's. The root is our own, because that crate refuses files for parts that matter
//! to nobody who counts (a texture without an image, a scene without nodes, an extension it does not implement).

use ::gltf::json;
use serde::Deserialize;

use super::super::json::{Entry, Listed, parse};
use super::super::{FileError, disk};
use super::Refused;
use crate::gltf::{broken_rule, parts};

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

/// Required extensions of compression: the accessors tell what comes out.
const COUNTED: [&str; 3] =
    ["EXT_meshopt_compression", "KHR_draco_mesh_compression", "KHR_meshopt_compression"];

impl Document {
    pub(super) fn open(bytes: &[u8], file: &str) -> Result<Self, FileError> {
        let (json, _) = parts(bytes).map_err(|rule| FileError::whole(file, rule))?;
        let document: Self = parse(disk::text_of(json, file)?, file)?;
        match broken_rule(&document.asset.version, &document.extensions_required, &COUNTED) {
            Some(rule) => Err(FileError::whole(file, rule)),
            None => Ok(document),
        }
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
