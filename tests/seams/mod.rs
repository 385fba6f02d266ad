//! Meshes with seams, made at random.

use glam::Vec2;
use lod_budget::bake::shapes::{icosphere, terrain, torus, torus_knot};
use lod_budget::bake::weld::weld;
use lod_budget::bake::{Group, Mesh, Surface};
use proptest::prelude::*;

/// With texture coordinates that jump at every corner that is not left alone, and two materials.
pub fn with_seams(surface: Surface, seams: u32) -> Mesh {
    let mut mesh = Mesh::from(surface);
    let old = mesh.clone();
    mesh.wedges = old.triangles.as_flattened().iter().map(|&w| old.wedges[w as usize]).collect();
    mesh.triangles = (0..old.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let uv = |(corner, &p): (usize, &u32)| {
        let jumps = p.wrapping_mul(0x9e37_79b1) >> 28 < seams;
        Vec2::new(p as f32, if jumps { (corner / 3 % 2) as f32 } else { 0.0 })
    };
    mesh.uvs = vec![mesh.wedges.iter().enumerate().map(uv).collect()];
    let half = mesh.triangles.len() / 2;
    let group = |name: &str, triangles| Group { name: name.into(), material: Some(name.into()), triangles };
    mesh.groups = vec![group("a", 0..half), group("b", half..mesh.triangles.len())];
    weld(&mut mesh);
    mesh
}

/// Closed ones and open ones, with seams and without.
pub fn meshes() -> impl Strategy<Value = Mesh> {
    let surface = prop_oneof![
        (4..20u32, any::<u32>()).prop_map(|(side, seed)| terrain(side, seed)),
        (12..40u32, 4..10u32).prop_map(|(along, around)| torus_knot(along, around)),
        (3..8u32).prop_map(icosphere),
        (4..20u32, 4..12u32).prop_map(|(along, around)| torus(along, around, 0.4)),
    ];
    (surface, 0..8u32).prop_map(|(surface, seams)| with_seams(surface, seams))
}
