//! Looks over a scene: what is to have levels, and what is to be left alone.

use std::collections::BTreeMap;

use serde_json::Value;

use super::document::Document;
use super::large::Sizes;
use super::names::has_levels;
use super::{Chunks, Left, Odd, Options, Part, Place, Scene, Subject, at};
use crate::bake::mesh::Mesh;
use crate::bake::read::{MeshError, MeshFile};
use crate::bake::repair::repair;
use crate::bake::split::{self, Chunk, split};

impl Scene<'_> {
    /// Finds the parts, and those who are left alone.
    pub(super) fn survey(&mut self, options: &Options) -> Result<(), MeshError> {
        let places = self.places()?;
        let meshes = self.meshes(&places)?;
        let boxes: Vec<_> = places.iter().map(|place| meshes[&place.mesh].bounds()).collect();
        let sizes = Sizes::of(&places, &boxes);
        let nodes = self.nodes_by_mesh(&places);
        for (mesh, shape) in meshes {
            let Some(nodes) = nodes.get(&mesh) else { continue };
            match self.objection(mesh, &shape, options) {
                Some(reason) => self.leave(mesh, nodes[0], reason),
                None => self.add(mesh, shape, nodes.clone(), &sizes, options),
            }
        }
        Ok(())
    }

    /// Everything that the scene shows.
    fn places(&self) -> Result<Vec<Place>, MeshError> {
        let shown = self.source.shown()?;
        let unknown = shown.iter().find(|shown| shown.mesh >= self.document.list("meshes").len());
        match unknown {
            Some(shown) => {
                let rule = format!("its mesh {} is unknown", shown.mesh);
                Err(at(&self.source, self.document.place("node", "nodes", shown.node), rule))
            }
            None => {
                Ok(shown.into_iter().map(|s| Place { node: s.node, mesh: s.mesh, world: s.world }).collect())
            }
        }
    }

    /// All meshes that are shown, repaired, groups called after their primitives; empty ones for those that have points
    /// or lines.
    fn meshes(&mut self, places: &[Place]) -> Result<BTreeMap<usize, Mesh>, MeshError> {
        let mut meshes = BTreeMap::new();
        for &Place { mesh, .. } in places {
            if meshes.contains_key(&mesh) {
                continue;
            }
            let MeshFile { mesh: mut shape, mut origins, .. } = self.source.mesh(mesh)?;
            for (i, group) in shape.groups.iter_mut().enumerate() {
                group.name = i.to_string();
            }
            let place = self.document.place("mesh", "meshes", mesh);
            let found = repair(&mut shape, &mut origins).into_iter().filter(|f| f.defect.is_repaired());
            self.odd.extend(found.map(|finding| Odd { place: place.clone(), finding }));
            meshes.insert(mesh, shape);
        }
        Ok(meshes)
    }

    /// Per mesh, the nodes that may get levels of it. Those that have reasons of their own not to are told of.
    fn nodes_by_mesh(&mut self, places: &[Place]) -> BTreeMap<usize, Vec<usize>> {
        let has_levels = has_levels(&self.document);
        let mut nodes: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for place in places.iter().filter(|place| !has_levels[place.node]) {
            match node_objection(self.document.get("nodes", place.node)) {
                Some(reason) => self.leave(place.mesh, place.node, reason),
                None => nodes.entry(place.mesh).or_default().push(place.node),
            }
        }
        nodes
    }

    fn leave(&mut self, mesh: usize, node: usize, reason: &'static str) {
        let [node, mesh] = [("node", "nodes", node), ("mesh", "meshes", mesh)]
            .map(|(kind, list, index)| self.document.place(kind, list, index));
        self.left.push(Left { place: format!("{node}, {mesh}"), reason });
    }

    /// What speaks against levels of a mesh.
    fn objection(&self, mesh: usize, shape: &Mesh, options: &Options) -> Option<&'static str> {
        let primitives = primitives(&self.document, mesh);
        if primitives.iter().any(|p| p.get("mode").and_then(Value::as_u64).unwrap_or(4) < 4) {
            return Some("it has points or lines");
        }
        if primitives.iter().any(|p| p.get("targets").is_some()) {
            return Some("it has morph targets");
        }
        (shape.triangles.len() < options.least_triangles.max(1)).then_some("it has hardly any triangles")
    }

    /// Adds a mesh as one part, or as many.
    fn add(&mut self, mesh: usize, shape: Mesh, nodes: Vec<usize>, sizes: &Sizes, options: &Options) {
        let split_as = match options.chunks {
            Chunks::Large(split) if sizes.is_large(mesh, shape.triangles.len(), split.triangles) => {
                Some(split)
            }
            Chunks::All(split) if shape.triangles.len() > split.triangles => Some(split),
            _ => None,
        };
        let chunks = split_as
            .map_or_else(|| vec![whole(shape.clone())], |options: split::Options| split(&shape, &options));
        let (start, is_chunk) = (self.parts.len(), chunks.len() > 1);
        for (i, chunk) in chunks.into_iter().enumerate() {
            let name = if is_chunk { of_chunk(&shape.name, i) } else { shape.name.clone() };
            self.parts.push(Part { name, chunk, instances: nodes.len(), is_chunk });
        }
        self.subjects.push(Subject { mesh, nodes, parts: start..self.parts.len() });
    }
}

pub(super) fn primitives(document: &Document, mesh: usize) -> &[Value] {
    document.get("meshes", mesh).get("primitives").and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

/// What a chunk is called, as node and as mesh.
pub(super) fn of_chunk(name: &str, chunk: usize) -> String {
    format!("{name}_chunk{chunk}")
}

/// A mesh as its only chunk.
fn whole(mesh: Mesh) -> Chunk {
    Chunk {
        locked: vec![false; mesh.positions.len()],
        triangles: (0..mesh.triangles.len() as u32).collect(),
        border: Vec::new(),
        mesh,
    }
}

/// What speaks against levels of what a node shows.
fn node_objection(node: &Value) -> Option<&'static str> {
    if node.get("skin").is_some() {
        return Some("it is moved by a skin");
    }
    node.pointer("/extensions/EXT_mesh_gpu_instancing")
        .is_some()
        .then_some("it is drawn by EXT_mesh_gpu_instancing")
}
