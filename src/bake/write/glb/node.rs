//! Places in a scene.

use glam::{Mat4, Quat, Vec3};
use serde_json::{Map, Value, json};

use super::ChainId;

/// A node of one [`Glb`](super::Glb).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeId(pub(super) usize);

/// A place in the scene.
#[derive(Clone, Debug, Default)]
pub struct Node {
    /// `_LOD0` and so on is added where the node shows a chain.
    pub name: String,
    /// `None` for a root of the scene.
    pub parent: Option<NodeId>,
    /// What it shows.
    pub chain: Option<ChainId>,
    /// From its own space to its parent's; all its numbers finite.
    pub transform: Transform,
    /// What else to say of it; the coverages of its chain, where it has any, stand above `MSFT_screencoverage` in here.
    pub extras: Map<String, Value>,
}

/// How a node is placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transform {
    /// Affine, and by the specification a product of translation, rotation and scale.
    Matrix(Mat4),
    /// Scale first, translation last.
    Parts {
        /// In the parent's units.
        translation: Vec3,
        /// Of unit length.
        rotation: Quat,
        /// 1 leaves an axis as it is.
        scale: Vec3,
    },
}

impl Default for Transform {
    fn default() -> Self {
        Self::Matrix(Mat4::IDENTITY)
    }
}

/// A node as the file has it, but for its children.
#[derive(Debug)]
pub(super) struct Placed {
    pub(super) node: Map<String, Value>,
    pub(super) children: Vec<usize>,
}

impl Placed {
    /// What the node is, but for what it shows.
    pub(super) fn of(node: &Node, name: &str) -> Self {
        let mut placed = node.transform.parts();
        placed.insert("name".to_owned(), json!(name));
        Self { node: placed, children: Vec::new() }
    }

    pub(super) fn finished(mut self) -> Value {
        if !self.children.is_empty() {
            self.node.insert("children".to_owned(), json!(self.children));
        }
        Value::Object(self.node)
    }
}

impl Transform {
    pub(super) fn is_finite(&self) -> bool {
        match self {
            Self::Matrix(matrix) => matrix.is_finite(),
            Self::Parts { translation, rotation, scale } => {
                translation.is_finite() && rotation.is_finite() && scale.is_finite()
            }
        }
    }

    /// The parts that are not as they are anyway.
    fn parts(self) -> Map<String, Value> {
        let all = match self {
            Self::Matrix(m) => vec![("matrix", m != Mat4::IDENTITY, json!(m.to_cols_array()))],
            Self::Parts { translation, rotation, scale } => vec![
                ("translation", translation != Vec3::ZERO, json!(translation.to_array())),
                ("rotation", rotation != Quat::IDENTITY, json!(rotation.to_array())),
                ("scale", scale != Vec3::ONE, json!(scale.to_array())),
            ],
        };
        let telling = all.into_iter().filter(|&(_, tells, _)| tells);
        telling.map(|(name, _, value)| (name.to_owned(), value)).collect()
    }
}
