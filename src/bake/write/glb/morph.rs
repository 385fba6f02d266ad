//! A geomorph as a morph target: what is to be added to each attribute at weight 1.

use glam::{Vec3, Vec4};
use serde_json::{Map, Value, json};

use super::attributes::{self, unit};
use super::blob::Blob;
use super::primitive::Vertices;
use crate::bake::geomorph::Geomorph;
use crate::bake::mesh::Mesh;

/// What is said of a mesh that has a geomorph to this level, in its `extras`: names of targets, and how far they move
/// vertices, in object units.
pub(super) fn extras(geomorph: &Geomorph, level: usize) -> Map<String, Value> {
    let names = json!([format!("geomorph_to_LOD{level}")]);
    let (max, mean) = (json!(f64::from(geomorph.movement.max)), json!(geomorph.movement.mean));
    [("targetNames", names), ("lod_geomorph_max", max), ("lod_geomorph_mean", mean)]
        .map(|(name, value)| (name.to_owned(), value))
        .into_iter()
        .collect()
}

/// Whether a geomorph is one of this mesh, and can be written.
pub(super) fn check(geomorph: &Geomorph, mesh: &Mesh) -> Result<(), String> {
    let target = &geomorph.target;
    let is_its = target.positions.len() == mesh.positions.len()
        && target.wedges == mesh.wedges
        && target.uvs.len() == mesh.uvs.len();
    if !is_its {
        return Err("its geomorph must be one of this mesh".to_owned());
    }
    super::check(target).map_err(|rule| format!("its geomorph: {rule}"))
}

/// The accessor of each attribute that moves, of those that the primitive has.
pub(super) fn target(
    blob: &mut Blob,
    base: &Vertices<'_>,
    target: &Mesh,
    has: &Map<String, Value>,
) -> Map<String, Value> {
    let end = Vertices { mesh: target, wedges: base.wedges.clone(), indices: base.indices.clone() };
    let ends = [base, &end];
    let mut accessors = Map::new();
    let mut add = |name: &str, accessor: usize| accessors.insert(name.to_owned(), json!(accessor));
    add("POSITION", blob.positions(&steps(places(base), places(&end))));
    if has.contains_key("NORMAL") {
        add("NORMAL", blob.floats(&turns(ends.map(|v| v.rows(&v.mesh.normals).collect()))));
    }
    if has.contains_key("TANGENT") {
        let along = |v: &Vertices<'_>| v.rows(&v.mesh.tangents).map(Vec4::truncate).collect();
        add("TANGENT", blob.floats(&turns(ends.map(along))));
    }
    for (set, (from, to)) in base.mesh.uvs.iter().zip(&target.uvs).enumerate() {
        let name = format!("TEXCOORD_{set}");
        if has.contains_key(&name) {
            let [from, to] = [attributes::uvs(base, from), attributes::uvs(&end, to)];
            add(&name, blob.floats(&steps(from.into_iter(), to.into_iter())));
        }
    }
    if let [Some(from), Some(to)] = ends.map(attributes::colours) {
        add("COLOR_0", blob.floats(&steps(from.into_iter(), to.into_iter())));
    }
    accessors
}

fn places<'a>(vertices: &'a Vertices<'_>) -> impl Iterator<Item = [f32; 3]> + 'a {
    let mesh = vertices.mesh;
    vertices.rows(&mesh.wedges).map(|position| mesh.positions[position as usize].to_array())
}

fn steps<const N: usize>(
    from: impl Iterator<Item = [f32; N]>,
    to: impl Iterator<Item = [f32; N]>,
) -> Vec<[f32; N]> {
    from.zip(to).map(|(from, to)| std::array::from_fn(|i| step(from[i], to[i]))).collect()
}

/// What leads from a number to another when it is added, exactly if one of the nearest differences does: so that what
/// has become one point is one point after the addition too.
fn step(from: f32, to: f32) -> f32 {
    let difference = to - from;
    let near = [difference, difference.next_up(), difference.next_down()];
    near.into_iter().find(|step| from + step == to).unwrap_or(difference)
}

/// Differences of unit vectors; what has no direction at one of the ends does not turn.
fn turns([from, to]: [Vec<Vec3>; 2]) -> Vec<[f32; 3]> {
    let turn = |(from, to): (Vec3, Vec3)| match (unit(from), unit(to)) {
        (Some(from), Some(to)) => (to - from).to_array(),
        _ => [0.0; 3],
    };
    from.into_iter().zip(to).map(turn).collect()
}
