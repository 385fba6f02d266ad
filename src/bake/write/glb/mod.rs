//! All levels of an object in one GLB (glTF 2.0, binary), and scenes of such objects.
//!
//! An object's levels are a *chain*: a mesh each, called `NAME_LOD0`, `NAME_LOD1` and so on. A node that shows a chain
//! shows its finest level; its `MSFT_lod` names further nodes, placed alike, that show the coarser ones. Those are no
//! part of the scene, so that a program that does not know the extension draws the finest level alone. The coverage
//! from which on each level is shown is in `extras.MSFT_screencoverage` of the first node; what was measured is in the
//! `extras` of a level's mesh: `lod_error`, `lod_hausdorff` and `lod_rms`, in object units, and `lod_accuracy`. That of
//! an impostor's quads has `lod_impostor`, which is what [`Impostor::to_json`](crate::bake::impostor::Impostor::to_json)
//! writes.
//!
//! A level's [geomorph](super::LevelOut::geomorph) is a morph target of weight 0, called `geomorph_to_LOD1` and so on in
//! the mesh's `extras.targetNames`: what to add to positions, normals, tangents, texture coordinates and colours to
//! make it look like that level. How far it moves a vertex at most, and on average, is in `extras.lod_geomorph_max` and
//! `extras.lod_geomorph_mean`, in object units. Positions meet those of the coarser level to the bit wherever single
//! precision has a difference that leads there, else to the last place.
//!
//! Groups of triangles become primitives, each with vertices of its own, a wedge a vertex, and indices of 16 bits where
//! they will do. A primitive's `extras.name` is its group's name. Materials are names: matt, white, without textures.
//! Joints and weights are written without a skin, as the specification allows: the mesh rests in its pose until an
//! engine gives it its skeleton.
//!
//! What glTF forbids is put right: normals and tangents become unit vectors, colours lie between 0 and 1, weights are
//! positive and add up to 1. A wedge without a normal gets that of its first triangle. Where all normals, tangents or
//! joints of a primitive are missing it goes without. What keeps the rules is written bit by bit. Positions that no
//! triangle uses are left out; a level without triangles is a node without a mesh. At most eight sets of texture
//! coordinates are written.
//!
//! ```
//! use lod_budget::bake::write::{Glb, LevelOut, glb::{Node, Transform}};
//! use lod_budget::bake::{Group, Mesh};
//!
//! let rock = Mesh {
//!     positions: vec![glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y],
//!     wedges: vec![0, 1, 2],
//!     triangles: vec![[0, 1, 2]],
//!     groups: vec![Group { triangles: 0..1, ..Group::default() }],
//!     ..Mesh::default()
//! };
//! let mut scene = Glb::default();
//! let chain = scene.add_chain("rock", &[LevelOut::new(&rock)])?;
//! for x in [0.0, 5.0] {
//!     let transform = Transform::Matrix(glam::Mat4::from_translation(glam::Vec3::X * x));
//!     scene.add_node(Node { name: "rock".into(), chain: Some(chain), transform, ..Node::default() })?;
//! }
//! let bytes = scene.finish()?;
//! # Ok::<(), lod_budget::bake::write::GlbError>(())
//! ```

mod attributes;
pub(in crate::bake) mod blob;
mod morph;
mod node;
pub(in crate::bake) mod primitive;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use serde_json::{Map, Value, json};

use self::blob::Blob;
use self::node::Placed;
use super::{LevelOut, Measured};
use crate::bake::mesh::Mesh;

pub use self::node::{Node, NodeId, Transform};

/// All levels of one object, finest first, called after the finest one's mesh.
///
/// # Errors
/// As [`Glb::add_chain`] and [`Glb::finish`].
pub fn glb(levels: &[LevelOut<'_>]) -> Result<Vec<u8>, GlbError> {
    let name = levels.first().map_or("", |level| &level.mesh.name);
    let mut glb = Glb::default();
    let chain = glb.add_chain(name, levels)?;
    glb.add_node(Node { name: name.to_owned(), chain: Some(chain), ..Node::default() })?;
    glb.finish()
}

/// Why something cannot be written. Displayed as `OBJECT: RULE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GlbError {
    /// What the file would call it.
    pub object: String,
    /// The rule it breaks.
    pub rule: String,
}

impl GlbError {
    fn new(object: impl Into<String>, rule: impl Into<String>) -> Self {
        Self { object: object.into(), rule: rule.into() }
    }
}

impl fmt::Display for GlbError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.object, self.rule)
    }
}

impl std::error::Error for GlbError {}

/// A chain of one [`Glb`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChainId(usize);

/// A file in the making: first chains, then the nodes that show them.
#[derive(Debug, Default)]
pub struct Glb {
    blob: Blob,
    materials: Materials,
    meshes: Vec<Value>,
    chains: Vec<Chain>,
    nodes: Vec<Placed>,
    roots: Vec<usize>,
}

/// Names, each once, in order of first use.
#[derive(Debug, Default)]
struct Materials {
    names: Vec<String>,
    known: BTreeMap<String, usize>,
    /// Those that are seen from both sides and through.
    cards: BTreeSet<usize>,
}

#[derive(Debug)]
struct Chain {
    /// Per level its mesh, if it draws anything.
    meshes: Vec<Option<usize>>,
    /// Per level, or empty.
    coverage: Vec<f32>,
}

impl Glb {
    /// Adds the levels of an object, finest first. A chain should have a node: readers may take meshes that no node
    /// shows for levels of others, by their names.
    ///
    /// # Errors
    /// No level; a mesh that does not [check](Mesh::check) or has positions that are infinite or no numbers; coverages
    /// that only some levels have, rise, are negative or no numbers; a geomorph of another mesh; more than 4 GiB in
    /// all.
    pub fn add_chain(&mut self, name: &str, levels: &[LevelOut<'_>]) -> Result<ChainId, GlbError> {
        if levels.is_empty() {
            return Err(GlbError::new(name, "it must have a level"));
        }
        let coverage = coverages(levels).map_err(|rule| GlbError::new(name, rule))?;
        let mesh = |(i, level)| self.add_mesh(&format!("{name}_LOD{i}"), level, i + 1);
        let meshes = levels.iter().enumerate().map(mesh).collect::<Result<_, _>>()?;
        self.chains.push(Chain { meshes, coverage });
        Ok(ChainId(self.chains.len() - 1))
    }

    /// The index of the level's mesh; `None` where it draws nothing. `next` is the number of the next coarser level.
    fn add_mesh(&mut self, name: &str, level: &LevelOut<'_>, next: usize) -> Result<Option<usize>, GlbError> {
        let refused = |rule| GlbError::new(name, rule);
        check(level.mesh).map_err(refused)?;
        level.geomorph.map_or(Ok(()), |geomorph| morph::check(geomorph, level.mesh)).map_err(refused)?;
        let target = level.geomorph.map(|geomorph| &geomorph.target);
        let mut primitives = Vec::new();
        for group in level.mesh.groups.iter().filter(|group| !group.triangles.is_empty()) {
            let material = group.material.as_ref().map(|name| self.materials.index(name));
            self.materials.cards.extend(material.filter(|_| level.impostor.is_some()));
            primitives.push(primitive::add(&mut self.blob, level.mesh, group, material, target));
            self.blob.check().map_err(|rule| refused(rule.to_owned()))?;
        }
        if primitives.is_empty() {
            return Ok(None);
        }
        let mut mesh = object(json!({ "name": name, "primitives": primitives }));
        let mut extras = extras(level);
        if let Some(geomorph) = level.geomorph {
            mesh.insert("weights".to_owned(), json!([0.0]));
            extras.extend(morph::extras(geomorph, next));
        }
        mesh.extend((!extras.is_empty()).then(|| ("extras".to_owned(), Value::Object(extras))));
        self.meshes.push(Value::Object(mesh));
        Ok(Some(self.meshes.len() - 1))
    }

    /// Adds a node, and those of the coarser levels of what it shows.
    ///
    /// # Errors
    /// A transform that is not finite.
    ///
    /// # Panics
    /// Where its parent or chain is of another file.
    pub fn add_node(&mut self, node: Node) -> Result<NodeId, GlbError> {
        if !node.transform.is_finite() {
            return Err(GlbError::new(node.name, "its transform must be finite"));
        }
        let id = self.nodes.len();
        match node.parent {
            Some(parent) => self.nodes[parent.0].children.push(id),
            None => self.roots.push(id),
        }
        match node.chain {
            Some(chain) => self.add_levels(&node, chain.0),
            None => self.nodes.push(Placed::of(&node, &node.name)),
        }
        let mut extras = node.extras;
        extras.extend(self.nodes[id].node.remove("extras").map(object).unwrap_or_default());
        if !extras.is_empty() {
            self.nodes[id].node.insert("extras".to_owned(), Value::Object(extras));
        }
        Ok(NodeId(id))
    }

    fn add_levels(&mut self, node: &Node, chain: usize) {
        let head = self.nodes.len();
        for level in 0..self.chains[chain].meshes.len() {
            let mesh = self.chains[chain].meshes[level];
            self.nodes.push(Placed::of(node, &format!("{}_LOD{level}", node.name)));
            let mesh = mesh.map(|mesh| ("mesh".to_owned(), json!(mesh)));
            self.nodes[head + level].node.extend(mesh);
        }
        let coarser: Vec<usize> = (head + 1..self.nodes.len()).collect();
        let coverage = &self.chains[chain].coverage;
        let head = &mut self.nodes[head].node;
        if !coarser.is_empty() {
            head.insert("extensions".to_owned(), json!({ "MSFT_lod": { "ids": coarser } }));
        }
        if !coverage.is_empty() {
            head.insert("extras".to_owned(), json!({ "MSFT_screencoverage": coverage }));
        }
    }

    /// The file.
    ///
    /// # Errors
    /// More than 4 GiB in all, which is as much as a GLB can have.
    pub fn finish(self) -> Result<Vec<u8>, GlbError> {
        let has_levels = self.chains.iter().any(|chain| chain.meshes.len() > 1);
        let materials = self.materials.finished();
        let nodes = self.nodes.into_iter().map(Placed::finished).collect();
        let (views, accessors, bytes) = self.blob.into_parts();
        let mut root = object(json!({
            "asset": { "version": "2.0", "generator": "lod-budget" },
            "scene": 0,
            "scenes": [if self.roots.is_empty() { json!({}) } else { json!({ "nodes": self.roots }) }],
        }));
        let lists = [
            ("accessors", accessors),
            ("bufferViews", views),
            ("buffers", blob::buffers(&bytes)),
            ("extensionsUsed", if has_levels { vec![json!("MSFT_lod")] } else { Vec::new() }),
            ("materials", materials),
            ("meshes", self.meshes),
            ("nodes", nodes),
        ];
        let full = lists.into_iter().filter(|(_, list)| !list.is_empty());
        root.extend(full.map(|(name, list)| (name.to_owned(), Value::Array(list))));
        blob::packed(&Value::Object(root).to_string(), bytes).map_err(|rule| GlbError::new("the file", rule))
    }
}

impl Materials {
    fn finished(&self) -> Vec<Value> {
        let material = |(i, name): (usize, &String)| material(name, self.cards.contains(&i));
        self.names.iter().enumerate().map(material).collect()
    }

    fn index(&mut self, name: &str) -> usize {
        if let Some(&known) = self.known.get(name) {
            return known;
        }
        self.names.push(name.to_owned());
        self.known.insert(name.to_owned(), self.names.len() - 1);
        self.names.len() - 1
    }
}

/// Per level, or empty where no level has one.
fn coverages(levels: &[LevelOut<'_>]) -> Result<Vec<f32>, &'static str> {
    let coverage: Vec<f32> = levels.iter().filter_map(|level| level.coverage).collect();
    if !coverage.is_empty() && coverage.len() < levels.len() {
        return Err("all of its levels must have a coverage, or none");
    }
    if coverage.iter().any(|&c| !c.is_finite() || c < 0.0) || !coverage.is_sorted_by(|a, b| a >= b) {
        return Err("its coverages must be finite, not be below 0, and not rise from level to level");
    }
    Ok(coverage)
}

/// Whether a mesh can be written.
pub(in crate::bake) fn check(mesh: &Mesh) -> Result<(), String> {
    mesh.check()?;
    let corners = mesh.triangles.as_flattened().iter().map(|&w| mesh.wedges[w as usize]);
    match corners.into_iter().find(|&p| !mesh.positions[p as usize].is_finite()) {
        Some(position) => Err(format!("position {position} must be finite")),
        None => Ok(()),
    }
}

/// What is known of a level.
pub(in crate::bake) fn extras(level: &LevelOut<'_>) -> Map<String, Value> {
    let measured = level.measured.map_or_else(Map::new, |Measured { error, hausdorff, rms }| {
        object(json!({ "lod_error": f64::from(error), "lod_hausdorff": hausdorff, "lod_rms": rms }))
    });
    let accuracy = level.accuracy.map(|accuracy| ("lod_accuracy".to_owned(), json!(accuracy)));
    let impostor = level.impostor.map(|impostor| ("lod_impostor".to_owned(), impostor.to_value()));
    measured.into_iter().chain(accuracy).chain(impostor).collect()
}

/// Matt and white: without a word glTF means bare metal.
fn material(name: &str, is_card: bool) -> Value {
    let mut material = json!({ "name": name, "pbrMetallicRoughness": { "metallicFactor": 0 } });
    if is_card {
        material["doubleSided"] = json!(true);
        material["alphaMode"] = json!("MASK");
    }
    material
}

/// The members of what is known to be an object.
fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}
