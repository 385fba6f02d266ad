//! Meshes with normals and texture coordinates, and seams where these jump.

use glam::{Vec2, Vec3};
use lod_budget::bake::weld::weld;
use lod_budget::bake::{Group, Mesh};

/// A grid of `columns` by `rows` cells, its corners placed and given attributes by what is asked for, welded.
pub fn grid(columns: u32, rows: u32, corner: impl Fn(u32, u32) -> (Vec3, Vec3, Vec2)) -> Mesh {
    let mut mesh = Mesh { uvs: vec![Vec::new()], ..Mesh::default() };
    for (row, column) in (0..=rows).flat_map(|row| (0..=columns).map(move |column| (row, column))) {
        let (position, normal, uv) = corner(column, row);
        mesh.wedges.push(mesh.positions.len() as u32);
        mesh.positions.push(position);
        mesh.normals.push(normal);
        mesh.uvs[0].push(uv);
    }
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let [a, b] = [row * (columns + 1) + column, (row + 1) * (columns + 1) + column];
        mesh.triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
    }
    mesh.groups.push(Group { triangles: 0..mesh.triangles.len(), ..Group::default() });
    weld(&mut mesh);
    mesh
}

/// A torus with smooth normals, whose texture coordinates go once around either way: two seams.
pub fn torus(rings: u32, sides: u32) -> Mesh {
    let turn = |step: u32, steps: u32| (std::f32::consts::TAU * step as f32 / steps as f32).sin_cos();
    grid(rings, sides, |column, row| {
        let uv = Vec2::new(column as f32 / rings as f32, row as f32 / sides as f32);
        // So that both ends of the grid are the same to the last bit.
        let ((sa, ca), (sc, cc)) = (turn(column % rings, rings), turn(row % sides, sides));
        let normal = Vec3::new(ca * cc, sa * cc, sc);
        (Vec3::new(ca, sa, 0.0) + 0.3 * normal, normal, uv)
    })
}

/// A box of six faces, each of them a grid with its own normal, texture and group, and a bump in its middle.
pub fn hard_box(cells: u32, bump: f32) -> Mesh {
    let mut all = Mesh { uvs: vec![Vec::new()], ..Mesh::default() };
    for (normal, across) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)] {
        for side in [1.0, -1.0] {
            let up = side * normal.cross(across);
            let face = grid(cells, cells, |column, row| {
                let uv = Vec2::new(column as f32, row as f32) / cells as f32;
                let out = 1.0 + bump * (uv.x * (1.0 - uv.x) * uv.y * (1.0 - uv.y));
                let at = side * out * normal + (2.0 * uv.x - 1.0) * across + (2.0 * uv.y - 1.0) * up;
                (at, side * normal, uv)
            });
            append(&mut all, face);
        }
    }
    weld(&mut all);
    all
}

/// Adds a mesh of the same attributes, with its groups.
pub fn append(all: &mut Mesh, part: Mesh) {
    let [positions, wedges] = [all.positions.len() as u32, all.wedges.len() as u32];
    let triangles = all.triangles.len();
    all.positions.extend(part.positions);
    all.wedges.extend(part.wedges.iter().map(|p| p + positions));
    all.normals.extend(part.normals);
    all.colours.extend(part.colours);
    all.tangents.extend(part.tangents);
    all.uvs[0].extend(&part.uvs[0]);
    all.triangles.extend(part.triangles.iter().map(|t| t.map(|w| w + wedges)));
    let moved =
        |g: Group| Group { triangles: g.triangles.start + triangles..g.triangles.end + triangles, ..g };
    all.groups.extend(part.groups.into_iter().map(moved));
}
