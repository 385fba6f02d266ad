//! From subdivisions to meshes of triangles.

use glam::{Vec2, Vec3, Vec4};

use super::level::{Level, Limits, Stack};
use super::normals::Sides;
use super::{ControlMesh, Placement, SubdivideError};
use crate::bake::mesh::{Group, Mesh};
use crate::bake::read::triangulate::{TooConcave, Triangulator};
use crate::bake::repair::drop_isolated;
use crate::bake::weld::classes;

/// All levels, finest first.
pub(super) fn meshes(
    control: &ControlMesh,
    stack: &Stack,
    placement: Placement,
) -> Result<Vec<Mesh>, SubdivideError> {
    let limits = match placement {
        Placement::Limit => Some(stack.limits()),
        Placement::Subdivision => None,
    };
    let mut sides = stack.sides();
    let mut meshes = Vec::with_capacity(stack.levels.len());
    for level in stack.levels.iter().rev() {
        if !meshes.is_empty() {
            sides.coarsen(stack.scheme);
        }
        meshes.push(mesh(control, level, limits.as_ref(), &sides)?);
    }
    Ok(meshes)
}

/// A level as it is drawn: its vertices at the limits where those are given.
pub(super) fn mesh(
    control: &ControlMesh,
    level: &Level,
    limits: Option<&Limits>,
    sides: &Sides,
) -> Result<Mesh, SubdivideError> {
    let (wedge_of, firsts) = wedges(level, sides);
    let mut mesh = Mesh { name: control.name.clone(), ..Mesh::default() };
    mesh.positions = places(level, limits);
    mesh.wedges = firsts.iter().map(|&corner| level.net.corners[corner as usize]).collect();
    mesh.normals =
        firsts.iter().map(|&corner| sides.normals[sides.of_corner[corner as usize] as usize]).collect();
    fill_columns(control, level, limits, &firsts, &mut mesh);
    cut_faces(control, level, &wedge_of, &mut mesh)?;
    drop_isolated(&mut mesh);
    Ok(mesh)
}

/// Where the vertices of a level are drawn.
pub(super) fn places(level: &Level, limits: Option<&Limits>) -> Vec<Vec3> {
    let values = limits.map_or(&level.positions, |limits| &limits.positions);
    values[..level.positions.len()].iter().map(|p| p.as_vec3()).collect()
}

/// Per corner its wedge, and per wedge its first corner: corners on one side of a vertex with the same attributes are
/// one.
fn wedges(level: &Level, sides: &Sides) -> (Vec<u32>, Vec<u32>) {
    let mut alike = classes(sides.of_corner.iter().map(|&side| [side, 0, 0]));
    for channel in &level.channels {
        alike =
            classes(alike.of.iter().zip(&channel.net.corners).map(|(&class, &vertex)| [class, vertex, 0]));
    }
    (alike.of, alike.firsts)
}

fn fill_columns(
    control: &ControlMesh,
    level: &Level,
    limits: Option<&Limits>,
    firsts: &[u32],
    mesh: &mut Mesh,
) {
    let column = |i: usize| -> Vec<Vec4> {
        let channel = &level.channels[i];
        let values = limits.map_or(&channel.values, |limits| &limits.channels[i]);
        firsts.iter().map(|&corner| values[channel.net.corners[corner as usize] as usize].as_vec4()).collect()
    };
    let uvs = |i: usize| column(i).into_iter().map(|uv| Vec2::new(uv.x, uv.y)).collect();
    mesh.uvs = (0..control.uvs.len()).map(uvs).collect();
    mesh.colours = (control.uvs.len()..level.channels.len()).flat_map(column).collect();
}

fn cut_faces(
    control: &ControlMesh,
    level: &Level,
    wedge_of: &[u32],
    mesh: &mut Mesh,
) -> Result<(), SubdivideError> {
    let mut triangulator = Triangulator::default();
    let mut triangles = Vec::with_capacity(level.triangles());
    let mut polygon = Vec::new();
    for (faces, group) in level.groups.iter().zip(&control.groups) {
        let start = triangles.len();
        for face in faces.clone() {
            let span = level.net.span(face);
            polygon.clear();
            polygon.extend(
                level.net.corners[span.clone()].iter().map(|&vertex| mesh.positions[vertex as usize]),
            );
            let emit = |t: [u32; 3]| triangles.push(t.map(|corner| wedge_of[span.start + corner as usize]));
            cut(&polygon, &mut triangulator, emit)
                .map_err(|TooConcave| SubdivideError::TooConcave { face })?;
        }
        let (name, material) = (group.name.clone(), group.material.clone());
        mesh.groups.push(Group { name, material, triangles: start..triangles.len() });
    }
    mesh.triangles = triangles;
    Ok(())
}

/// Cuts a quad that is shorter from its second corner to its fourth there, all others as the readers do. A concave
/// quad is one of the others.
fn cut(
    polygon: &[Vec3],
    triangulator: &mut Triangulator,
    mut emit: impl FnMut([u32; 3]),
) -> Result<(), TooConcave> {
    if let [a, b, c, d] = *polygon {
        let turns = |p: Vec3, q: Vec3, r: Vec3| (q - p).cross(r - q);
        let is_second = b.distance_squared(d) < a.distance_squared(c);
        let halves =
            if is_second { [turns(a, b, d), turns(b, c, d)] } else { [turns(a, b, c), turns(a, c, d)] };
        if halves[0].dot(halves[1]) > 0.0 {
            let cuts = if is_second { [[0, 1, 3], [1, 2, 3]] } else { [[0, 1, 2], [0, 2, 3]] };
            cuts.into_iter().for_each(emit);
            return Ok(());
        }
    }
    triangulator.cut(polygon, &mut emit)
}
