//! What results of simplification are held to, and shapes to simplify.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec3, Vec3};
use lod_budget::bake::shapes::{icosphere, torus};
use lod_budget::bake::simplify::{Simplified, Stopped, Task};
use lod_budget::bake::{Mesh, Surface};
use proptest::prelude::*;

/// How many triangles go along each directed edge.
pub fn edges(surface: &Surface) -> BTreeMap<(u32, u32), usize> {
    let mut edges = BTreeMap::new();
    for &[a, b, c] in &surface.triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    edges
}

/// The edges that one triangle has to itself.
pub fn borders(surface: &Surface) -> BTreeSet<(u32, u32)> {
    let edges = edges(surface);
    edges.keys().copied().filter(|&(a, b)| !edges.contains_key(&(b, a))).collect()
}

pub fn is_manifold(surface: &Surface) -> bool {
    edges(surface).values().all(|&n| n == 1)
        && (0..surface.positions.len() as u32).all(|v| is_disc(surface, v))
}

/// Whether the triangles around a vertex are one fan: a walk across their edges meets them all.
fn is_disc(surface: &Surface, vertex: u32) -> bool {
    let sides: Vec<(u32, u32)> = surface.triangles.iter().filter_map(|t| across(t, vertex)).collect();
    let next: BTreeMap<u32, u32> = sides.iter().copied().collect();
    let ends: BTreeSet<u32> = next.values().copied().collect();
    let first = next.keys().find(|c| !ends.contains(c)).or(next.keys().next());
    let mut walk = std::iter::successors(first, |at| next.get(at).filter(|to| Some(*to) != first));
    let met = walk.by_ref().take_while(|at| next.contains_key(at)).count();
    met == sides.len()
}

/// The side of a triangle that is across from a corner of it.
fn across(triangle: &[u32; 3], vertex: u32) -> Option<(u32, u32)> {
    let at = triangle.iter().position(|&c| c == vertex)?;
    Some((triangle[(at + 1) % 3], triangle[(at + 2) % 3]))
}

/// Vertices − edges + triangles.
pub fn euler(surface: &Surface) -> i64 {
    let undirected: BTreeSet<(u32, u32)> =
        edges(surface).keys().map(|&(a, b)| (a.min(b), a.max(b))).collect();
    surface.positions.len() as i64 - undirected.len() as i64 + surface.triangles.len() as i64
}

pub fn normal(surface: &Surface, triangle: [u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|v| surface.positions[v as usize].as_dvec3());
    (b - a).cross(c - a)
}

pub fn center(surface: &Surface, triangle: [u32; 3]) -> Vec3 {
    triangle.iter().map(|&v| surface.positions[v as usize]).sum::<Vec3>() / 3.0
}

/// A closed shape, its vertices pushed about by up to `bump`, and its Euler characteristic.
pub fn closed() -> impl Strategy<Value = (Mesh, i64)> {
    let sphere = (2..8u32).prop_map(|cuts| (icosphere(cuts), 2));
    let torus = (5..20u32, 5..12u32, 0.2..0.5f32).prop_map(|(r, s, tube)| (torus(r, s, tube), 0));
    (prop_oneof![sphere, torus], 0.0..0.1f32, any::<u32>()).prop_map(|((mut surface, euler), bump, seed)| {
        perturb(&mut surface, bump, seed);
        (surface.into(), euler)
    })
}

pub fn perturb(surface: &mut Surface, bump: f32, seed: u32) {
    let mut state = u64::from(seed) << 1 | 1;
    let mut random = || {
        state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    for p in &mut surface.positions {
        *p += bump * Vec3::new(random(), random(), random());
    }
}

/// What holds of every result, whatever the task.
pub fn check(task: &Task, result: &Simplified) {
    let Simplified { mesh, origins, wedge_origins, heirs, error, stopped } = result;
    assert_eq!(mesh.check(), Ok(()));
    let surface = mesh.surface();
    let count = surface.positions.len() as u32;
    assert!(surface.triangles.len() <= task.mesh.triangles.len());
    assert!(surface.triangles.iter().all(|&[a, b, c]| a != b && b != c && c != a && a.max(b).max(c) < count));
    assert!((0..count).all(|v| surface.triangles.as_flattened().contains(&v)), "a vertex without triangle");
    assert!(surface.positions.iter().all(|p| p.is_finite()) && error.is_finite() && *error >= 0.0);
    assert_eq!((origins.len(), heirs.len()), (surface.positions.len(), task.mesh.positions.len()));
    assert!(heirs.iter().all(|&h| h < count || h == Simplified::GONE));
    for (new, &old) in origins.iter().enumerate() {
        assert_eq!(heirs[old as usize] as usize, new, "what stems from a vertex is its heir");
    }
    assert_eq!(wedge_origins.len(), mesh.wedges.len());
    assert!(wedge_origins.iter().all(|&w| (w as usize) < task.mesh.wedges.len()));
    match stopped {
        Stopped::Triangles => assert!(surface.triangles.len() <= task.target.triangles),
        _ => assert!(surface.triangles.len() > task.target.triangles),
    }
    assert!(*error <= task.target.error);
}
