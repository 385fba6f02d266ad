//! The hierarchy of nodes: who is above whom, and where everything is in the world.

use glam::DMat4;

use super::Refused;
use super::document::Document;
use crate::gltf::local;

/// Parents and world transforms, per node, and the roots of the scene.
pub(super) struct Graph {
    parents: Vec<Option<usize>>,
    locals: Vec<DMat4>,
    worlds: Vec<DMat4>,
    roots: Vec<usize>,
}

impl Graph {
    pub(super) fn of(document: &Document) -> Result<Self, Refused> {
        let parents = find_parents(document)?;
        let locals = document.nodes().iter().enumerate();
        let locals = locals
            .map(|(i, n)| local(n).map_err(|rule| Refused::at(document.node_place(i), rule)))
            .collect::<Result<Vec<_>, _>>()?;
        let worlds = place_all(document, &parents, &locals)?;
        let roots = find_roots(document, &parents)?;
        Ok(Self { parents, locals, worlds, roots })
    }

    pub(super) fn roots(&self) -> &[usize] {
        &self.roots
    }

    /// From the node's own space to its parent's.
    pub(super) fn local(&self, node: usize) -> DMat4 {
        self.locals[node]
    }

    /// From the node's own space to the world.
    pub(super) fn world(&self, node: usize) -> DMat4 {
        self.worlds[node]
    }

    /// From the node's own space to the world, were it a sibling of `other` if it has no parent.
    pub(super) fn world_beside(&self, node: usize, other: usize) -> DMat4 {
        match (self.parents[node], self.parents[other]) {
            (None, Some(parent)) => self.worlds[parent] * self.locals[node],
            _ => self.worlds[node],
        }
    }
}

fn find_parents(document: &Document) -> Result<Vec<Option<usize>>, Refused> {
    let mut parents = vec![None; document.nodes().len()];
    for node in 0..document.nodes().len() {
        for child in document.children(node) {
            let refused = |rule: String| Refused::at(document.node_place(node), rule);
            let parent =
                parents.get_mut(child).ok_or_else(|| refused(format!("its child {child} is unknown")))?;
            if let Some(other) = parent.replace(node) {
                return Err(refused(format!("its child {child} is also a child of node {other}")));
            }
        }
    }
    Ok(parents)
}

/// The world transform of every node, parents before children.
fn place_all(
    document: &Document,
    parents: &[Option<usize>],
    locals: &[DMat4],
) -> Result<Vec<DMat4>, Refused> {
    let mut worlds: Vec<Option<DMat4>> = vec![None; parents.len()];
    let mut waiting: Vec<usize> = (0..parents.len()).filter(|&n| parents[n].is_none()).collect();
    while let Some(node) = waiting.pop() {
        let above = parents[node].and_then(|parent| worlds[parent]).unwrap_or(DMat4::IDENTITY);
        let world = above * locals[node];
        if !world.is_finite() {
            return Err(Refused::at(document.node_place(node), "its place in the world must be finite"));
        }
        worlds[node] = Some(world);
        waiting.extend(document.children(node));
    }
    let placed = worlds.iter().enumerate();
    placed
        .map(|(i, w)| w.ok_or_else(|| Refused::at(document.node_place(i), "it is its own ancestor")))
        .collect()
}

fn find_roots(document: &Document, parents: &[Option<usize>]) -> Result<Vec<usize>, Refused> {
    let Some(roots) = document.scene_roots()? else {
        return Ok((0..parents.len()).filter(|&n| parents[n].is_none()).collect());
    };
    let mut seen = vec![false; parents.len()];
    for &root in roots {
        let rule = match parents.get(root) {
            None => "it is a root of the scene but unknown",
            Some(Some(_)) => "it is a root of the scene and also a child",
            Some(None) if std::mem::replace(&mut seen[root], true) => "it is a root of the scene twice",
            Some(None) => continue,
        };
        return Err(Refused::at(document.node_place(root), rule));
    }
    Ok(roots.to_vec())
}
