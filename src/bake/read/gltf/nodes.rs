//! Which meshes are shown, and where.

use ::gltf::json;
use glam::DMat4;

use super::Refused;
use super::document::Document;
use crate::gltf::local;

/// A mesh where a node puts it.
pub(super) struct Placed {
    pub(super) mesh: usize,
    pub(super) node: Option<usize>,
    /// From the mesh's own units to the scene's.
    pub(super) world: DMat4,
}

impl Placed {
    pub(super) fn alone(mesh: usize) -> Self {
        Self { mesh, node: None, world: DMat4::IDENTITY }
    }
}

/// Everything that the scene shows, depth first; every mesh as it is where there are no nodes.
pub(super) fn placed(document: &Document<'_>) -> Result<Vec<Placed>, Refused> {
    if document.nodes.is_empty() {
        return Ok((0..document.meshes.len()).map(Placed::alone).collect());
    }
    let coarser = coarser_levels(document);
    let mut met = vec![false; document.nodes.len()];
    let mut placed = Vec::new();
    let mut waiting: Vec<(usize, DMat4)> =
        roots(document).into_iter().rev().map(|root| (root, DMat4::IDENTITY)).collect();
    while let Some((index, above)) = waiting.pop() {
        let refused = |rule: &str| Refused::at(format!("node {index}"), rule);
        let node = document.nodes.get(index).ok_or_else(|| refused("it is unknown"))?;
        if std::mem::replace(&mut met[index], true) {
            return Err(refused("it must have one parent, and not be its own ancestor"));
        }
        if coarser[index] {
            continue;
        }
        let world = above * local(node).map_err(refused)?;
        if !world.is_finite() {
            return Err(refused("its place in the scene must be finite"));
        }
        // What moves a skinned mesh is its joints alone.
        let place = if node.skin.is_some() { DMat4::IDENTITY } else { world };
        let mesh = node.mesh.map(|mesh| Placed { mesh: mesh.value(), node: Some(index), world: place });
        placed.extend(mesh);
        waiting.extend(children(node).rev().map(|child| (child, world)));
    }
    Ok(placed)
}

fn children(node: &json::Node) -> impl DoubleEndedIterator<Item = usize> {
    node.children.iter().flatten().map(json::Index::value)
}

/// The scene's, or all nodes without a parent.
fn roots(document: &Document<'_>) -> Vec<usize> {
    if let Some(roots) = document.roots() {
        return roots.to_vec();
    }
    let mut is_child = vec![false; document.nodes.len()];
    for child in document.nodes.iter().flat_map(children) {
        if let Some(is_child) = is_child.get_mut(child) {
            *is_child = true;
        }
    }
    (0..is_child.len()).filter(|&node| !is_child[node]).collect()
}

/// Which nodes stand in for others from afar.
fn coarser_levels(document: &Document<'_>) -> Vec<bool> {
    let mut coarser = vec![false; document.nodes.len()];
    let extensions = document.nodes.iter().filter_map(|node| node.extensions.as_ref());
    let ids = extensions.filter_map(|e| e.others.get("MSFT_lod")?.get("ids")?.as_array()).flatten();
    for id in ids.filter_map(|id| usize::try_from(id.as_u64()?).ok()) {
        if let Some(coarser) = coarser.get_mut(id) {
            *coarser = true;
        }
    }
    coarser
}
