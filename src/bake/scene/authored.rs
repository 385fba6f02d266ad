//! Chains that an author made, as far as they can be measured.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::document::{Document, member};
use super::{MeshError, Scene};
use crate::bake::mesh::Mesh;
use crate::bake::repair::repair;
use crate::bake::write::LevelOut;
use crate::bake::write::glb::extras;

/// A chain of the file: a node whose `MSFT_lod` names others, each with a mesh and placed as it is.
#[derive(Clone, Debug)]
pub struct Authored {
    /// What the finest mesh is called.
    pub name: String,
    /// Finest first, at least two, in their own units.
    pub levels: Vec<Mesh>,
    /// How many nodes show it.
    pub instances: usize,
    /// Of the levels, in the file.
    meshes: Vec<usize>,
}

impl Scene<'_> {
    /// Finds the chains that the scene shows, each once. Left out are those whose levels are more than a mesh each, and
    /// those with a coarser level that is shown elsewhere as well, where what was measured would not be true.
    pub(super) fn find_authored(&mut self) -> Result<(), MeshError> {
        let shown = self.source.shown()?;
        let mut chains: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
        for chain in shown.iter().filter_map(|shown| chain_of(&self.document, shown.node)) {
            *chains.entry(chain).or_default() += 1;
        }
        let mut users: BTreeMap<usize, usize> = BTreeMap::new();
        let coarser = chains.keys().flat_map(|chain| &chain[1..]).copied();
        for mesh in coarser.chain(shown.iter().map(|shown| shown.mesh)) {
            *users.entry(mesh).or_default() += 1;
        }
        chains.retain(|chain, _| chain[1..].iter().all(|mesh| users[mesh] == 1));
        for (meshes, instances) in chains {
            let levels = meshes.iter().map(|&mesh| self.level(mesh)).collect::<Result<Vec<_>, _>>()?;
            if levels.iter().all(|level| !level.triangles.is_empty()) {
                let name = levels[0].name.clone();
                self.authored.push(Authored { name, levels, instances, meshes });
            }
        }
        Ok(())
    }

    fn level(&self, mesh: usize) -> Result<Mesh, MeshError> {
        let mut file = self.source.mesh(mesh)?;
        repair(&mut file.mesh, &mut file.origins);
        Ok(file.mesh)
    }

    /// Says in the extras of each coarser level's mesh what was measured of it.
    pub(super) fn tell_authored(&mut self, measured: &[Vec<LevelOut<'_>>]) {
        for (chain, levels) in self.authored.iter().zip(measured) {
            for (&mesh, level) in chain.meshes.iter().zip(levels).skip(1) {
                let mesh = self.document.edit("meshes", mesh);
                if let Some(old) = mesh.get("extras").filter(|extras| !extras.is_object()).cloned() {
                    mesh.insert("extras".to_owned(), json!({ "extras": old }));
                }
                member(mesh, "extras").extend(extras(level));
            }
        }
    }
}

/// The meshes of a node's levels, if it has several and each is a mesh at its very place.
fn chain_of(document: &Document, head: usize) -> Option<Vec<usize>> {
    let nodes: Vec<usize> = std::iter::once(head).chain(document.coarser(head)).collect();
    let place = |node: usize| {
        let member = |name: &str| document.get("nodes", node).get(name).cloned();
        ["matrix", "translation", "rotation", "scale"].map(member)
    };
    let is_plain = |&node: &usize| {
        let has = |name: &str| document.get("nodes", node).get(name).is_some();
        !has("children") && !has("skin") && place(node) == place(head)
    };
    let meshes: Option<Vec<usize>> = nodes.iter().map(|&node| document.mesh_of(node)).collect();
    meshes.filter(|meshes| {
        meshes.len() > 1 && nodes.iter().all(is_plain) && !meshes.iter().any(|&m| morphs(document, m))
    })
}

/// Whether morph targets move a mesh, other than geomorphs between its levels: those are the chain's own.
fn morphs(document: &Document, mesh: usize) -> bool {
    let mesh = document.get("meshes", mesh);
    let names = mesh.pointer("/extras/targetNames").and_then(Value::as_array);
    let is_geomorph = |name: &Value| name.as_str().is_some_and(|name| name.starts_with("geomorph_to_LOD"));
    let are_geomorphs = names.is_some_and(|names| !names.is_empty() && names.iter().all(is_geomorph));
    let primitives = mesh.get("primitives").and_then(Value::as_array);
    !are_geomorphs && primitives.into_iter().flatten().any(|primitive| primitive.get("targets").is_some())
}
