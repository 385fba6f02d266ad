//! Scenes from glTF 2.0, as `.gltf` or `.glb`: what is drawn how often, at which levels, and how large it is.
//!
//! Only counts and bounds are read, so buffers and images need not be there. A scene is the default one, else the
//! first, else all nodes without a parent.
//!
//! **Objects.** Every node with a mesh becomes an object; its id is the index of the node. Its bound is the sphere
//! around the eight transformed corners of the mesh's box: never too small, and for even scales exactly as many times
//! the table's as the node is scaled. A node whose scale leaves nothing of the mesh is kept as a hidden object.
//! Skinned meshes are taken as they rest, at their node.
//!
//! **Tables.** Objects of the same meshes, placed alike within the object, and of the same switching data share a
//! table, called after the finest mesh. Per level: triangles by the mode of each primitive (strips and fans count
//! n − 2, points and lines 0); vertices as the sum of POSITION counts, an accessor counted once per mesh; a draw per
//! primitive; bytes as the accessors take once unpacked, morph targets with them. The bound holds all levels, and every
//! morph target at full weight, but for geomorphs between levels (`extras.lod_geomorph_max` of a mesh).
//!
//! **Measured levels**: the error of a level, in object units, and its accuracy are what `extras.lod_error` and
//! `extras.lod_accuracy` of its meshes say, of several the worst. Level 0 is exact (0 and 1) where nothing is said of
//! it and all coarser levels are known. Otherwise the error is unknown, and accuracy is by
//! [`accuracy_of`](crate::table::accuracy_of).
//!
//! **Levels**, in this order of precedence:
//! 1. `MSFT_lod` on a node: the node is level 0, `ids` are the coarser levels. A level is its node and everything
//!    below; a level without a mesh draws nothing. Level nodes are no objects of their own, in the scene or not. A
//!    level node without a parent is placed as a sibling of level 0. `MSFT_lod` on materials is passed over.
//! 2. Names that end in `_LOD` and a number, in upper or lower case: siblings of one stem are one object, levels in
//!    order of the number, whether or not it starts at 0 or leaves some out. Where a number occurs more than once
//!    among siblings, the first ones go together, then the second ones, and so on. A node without such a name goes
//!    by that of its mesh. The object has the id of its finest node.
//! 3. A node left alone whose mesh is called so gets, as coarser levels, the meshes of that stem and a greater number
//!    that no node uses.
//!
//! **Switching data** become `min_size`, the fraction of the viewport's height that the projected diameter must have:
//! - `extras.MSFT_screencoverage`, one value per level: the coverage above which the level is shown. The
//!   specification leaves open what is covered; we take the share of the *area* of a 16:9 image that the bounding
//!   sphere's disc covers, as Babylon.js does: see [`size_of_coverage`].
//! - `extras.lod_max_distance`, one distance per level in world units: the finest level whose distance exceeds that
//!   of the camera is shown, nothing beyond the last. A level's `min_size` is the object's own size at that distance
//!   under a vertical field of view of 60°, so that objects of different scale do not share a table; the greatest
//!   distance becomes [`Settings::draw_distance`], which is all there is to it where there is one level.
//!
//! With both, sizes come from the coverage and the draw distance from the distances.
//!
//! **Refused**: a node with two parents or its own ancestor, a level of two nodes, levels within levels (hierarchical
//! levels), a POSITION without `min` and `max`, indices out of range, accessors beyond their buffer view, counts
//! beyond 32 bits, transforms that are not affine or not finite, and required extensions that could change what is
//! counted. Extensions of compression, materials, textures and lights are accepted: the accessors tell the counts.

mod baked;
mod document;
mod groups;
mod meshes;
mod nodes;
mod tables;

use document::Document;
use groups::Group;
use meshes::Measured;
use nodes::Graph;
use tables::{Switching, Tables};

use super::{FileError, Scene, disk};
use crate::bounds::Sphere;
use crate::scene::{Object, ObjectId, Settings, TableId};

pub use tables::{coverage_of_size, size_of_coverage};

impl Scene {
    /// Reads glTF, text or binary, as described in [`crate::files::gltf`]. `file` names it in errors.
    ///
    /// # Errors
    /// What that description refuses, naming the node or mesh.
    pub fn from_gltf(bytes: &[u8], file: &str) -> Result<Self, FileError> {
        read(bytes, file).map_err(|Refused { place, rule }| FileError { file: file.to_owned(), place, rule })
    }
}

/// A [`FileError`] before anybody says which file.
struct Refused {
    place: Option<String>,
    rule: String,
}

impl Refused {
    fn at(place: String, rule: impl Into<String>) -> Self {
        Self { place: Some(place), rule: rule.into() }
    }
}

impl From<FileError> for Refused {
    fn from(FileError { place, rule, .. }: FileError) -> Self {
        Self { place, rule }
    }
}

fn read(bytes: &[u8], file: &str) -> Result<Scene, Refused> {
    let document = Document::open(bytes, file)?;
    let graph = Graph::of(&document)?;
    let mut meshes = Measured::new(&document);
    let mut tables = Tables::new(file);
    let mut objects = Vec::new();
    for group in groups::gather(&document, &graph)? {
        let Some(shape) = tables.shape(&group, &mut meshes)? else { continue };
        objects.push(place(&group, shape, &document, &graph, &mut tables)?);
    }
    objects.sort_unstable_by_key(|o: &Object| o.id);
    Ok(Scene { name: disk::stem(file), tables: tables.into_tables(), objects })
}

/// The object that a group is, in the world.
fn place(
    group: &Group,
    shape: usize,
    document: &Document,
    graph: &Graph,
    tables: &mut Tables,
) -> Result<Object, Refused> {
    let name = || document.node_place(group.node);
    let bounds = tables.shape_box(shape).placed(graph.world(group.node));
    if !bounds.is_valid() {
        return Err(Refused::at(name(), "its place and size in the world must fit 32-bit floats"));
    }
    let switching = Switching::of(document.node(group.node), group.levels.len());
    let switching = switching.map_err(|rule| Refused::at(name(), rule))?;
    let table = tables.table(shape, &switching.min_sizes(bounds.radius))?;
    Ok(object(group.node, bounds, table, &switching))
}

fn object(node: usize, bounds: Sphere, table: TableId, switching: &Switching) -> Object {
    let draw_distance = switching.draw_distance();
    let settings = Settings { draw_distance, hidden: bounds.radius == 0.0, ..Settings::default() };
    Object { id: ObjectId(node as u64), bounds, table, settings }
}
