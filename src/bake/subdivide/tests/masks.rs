//! Masks against the twin, and counts.

use glam::{DAffine3, DMat3, DVec3};
use proptest::prelude::*;

use super::shapes::{self, of_polygons, of_triangles, semi_sharp};
use super::twin::Twin;
use crate::bake::subdivide::level::{Level, Stack};
use crate::bake::subdivide::limits::limits;
use crate::bake::subdivide::net::{Edge, Net};
use crate::bake::subdivide::{ControlMesh, Scheme};

fn all() -> impl Iterator<Item = (Scheme, String, ControlMesh)> {
    let loops = of_triangles().into_iter().map(|(name, mesh)| (Scheme::Loop, name, mesh));
    loops.chain(of_polygons().into_iter().map(|(name, mesh)| (Scheme::CatmullClark, name, mesh)))
}

/// Every point of either is one of the other's, within 1e-12.
fn assert_same(ours: &[DVec3], twins: &[DVec3], what: &str) {
    assert_eq!(ours.len(), twins.len(), "{what}");
    let is_in = |p: &DVec3, set: &[DVec3]| set.iter().any(|q| p.distance(*q) < 1e-12);
    for p in ours {
        assert!(is_in(p, twins), "{what}: {p} is not the twin's");
    }
    for p in twins {
        assert!(is_in(p, ours), "{what}: {p} is the twin's alone");
    }
}

fn assert_as_twin(scheme: Scheme, mesh: &ControlMesh, levels: usize, what: &str) {
    let (mut level, mut twin) = (Level::base(mesh), Twin::of(mesh));
    for _ in 0..levels {
        (level, twin) = (level.refined(scheme), twin.refined(scheme));
        assert_same(&level.positions, &twin.points, what);
        assert_eq!(level.net.face_count(), twin.faces.len(), "{what}");
    }
}

/// After a subdivision its sides have edges of their own between the same vertices, which the twin does not tell apart.
fn is_pillow(scheme: Scheme, name: &str) -> bool {
    scheme == Scheme::Loop && name == "two triangles back to back"
}

#[test]
fn subdivisions_are_as_the_papers_say() {
    for (scheme, name, mesh) in all() {
        let levels = if is_pillow(scheme, &name) { 1 } else { 2 };
        assert_as_twin(scheme, &mesh, levels, &format!("{scheme}, {name}"));
    }
}

#[test]
fn semi_sharp_creases_fade_as_the_paper_says() {
    for sharpness in [0.25, 0.5, 1.0, 1.5, 2.0] {
        for (name, mesh) in semi_sharp(sharpness) {
            assert_as_twin(Scheme::CatmullClark, &mesh, 3, &format!("{name} {sharpness}"));
        }
    }
}

#[test]
fn half_sharp_is_half_way_between_smooth_and_sharp() {
    let ring: [&[u32]; 1] = [&[0, 1, 2, 3, 0]];
    let once = |sharpness: f32| {
        let mesh = shapes::sharp(shapes::scatter(shapes::prism(4), 3), &ring, sharpness);
        Level::base(&mesh).refined(Scheme::CatmullClark).positions
    };
    let (smooth, half, sharp, sharper) = (once(0.0), once(0.5), once(1.0), once(7.0));
    assert_eq!(sharp, sharper);
    assert!(smooth.iter().zip(&sharp).any(|(a, b)| a.distance(*b) > 0.05));
    for ((a, b), middle) in smooth.iter().zip(&sharp).zip(&half) {
        assert!(((*a + *b) / 2.0).distance(*middle) < 1e-14);
    }
}

#[test]
fn limits_are_where_subdividing_ends() {
    for (scheme, name, mesh) in all() {
        let stack = Stack::new(&mesh, scheme, 0).expect("a mesh");
        let (limits, twin) = (stack.limits(), Twin::of(&mesh));
        for vertex in 0..mesh.positions.len() {
            let apart = limits.positions[vertex].distance(twin.limit(scheme, vertex));
            assert!(apart < 1e-9, "{scheme}, {name}: vertex {vertex} is {apart} off");
        }
    }
}

#[test]
fn limits_of_semi_sharp_vertices_are_where_subdividing_ends() {
    for sharpness in [0.5, 1.0, 2.25] {
        for (name, mesh) in semi_sharp(sharpness) {
            let limits = Stack::new(&mesh, Scheme::CatmullClark, 1).expect("a mesh").limits();
            let twin = Twin::of(&mesh);
            for vertex in 0..mesh.positions.len() {
                let end = twin.limit(Scheme::CatmullClark, vertex);
                let apart = limits.positions[vertex].distance(end);
                assert!(apart < 1e-9, "{name} {sharpness}: vertex {vertex} is {apart} off");
            }
        }
    }
}

#[test]
fn vertices_stay_where_they_end() {
    for (scheme, name, mesh) in all() {
        let stack = Stack::new(&mesh, scheme, 2).expect("a mesh");
        let coarse = Stack::new(&mesh, scheme, 1).expect("a mesh").limits().positions;
        for (p, q) in coarse.iter().zip(stack.limits().positions) {
            assert!(p.distance(q) < 1e-12, "{scheme}, {name}");
        }
    }
}

/// V − E + F stays, and faces, edges and vertices are as many as is written.
#[test]
fn what_is_counted_is_as_euler_has_it() {
    for (scheme, name, mesh) in all() {
        let base = Level::base(&mesh);
        let next = base.refined(scheme);
        let counts = |level: &Level| [level.positions.len(), level.net.edges.len(), level.net.face_count()];
        let [vertices, edges, faces] = counts(&base);
        let corners = base.net.corners.len();
        let expected = match scheme {
            Scheme::Loop => [vertices + edges, 2 * edges + 3 * faces, 4 * faces],
            Scheme::CatmullClark => [vertices + edges + faces, 2 * edges + corners, corners],
        };
        assert_eq!(counts(&next), expected, "{scheme}, {name}");
        let euler = |[vertices, edges, faces]: [usize; 3]| vertices as i64 - edges as i64 + faces as i64;
        assert_eq!(euler(counts(&next)), euler(counts(&base)), "{scheme}, {name}");
        assert_eq!(next.net.valence.iter().sum::<u32>() as usize, 2 * next.net.edges.len());
    }
}

/// The edges that a refined net makes for itself are those that would be found among its faces.
#[test]
fn refined_nets_are_those_of_their_faces() {
    for (scheme, name, mesh) in all().filter(|(scheme, name, _)| !is_pillow(*scheme, name)) {
        let net = Level::base(&mesh).refined(scheme).refined(scheme).net;
        let found = Net::of_faces(net.sharpness.len(), net.ends.clone(), net.corners.clone());
        let sides = |edge: &Edge| {
            let mut faces = edge.faces;
            faces.sort_unstable();
            ([edge.ends[0].min(edge.ends[1]), edge.ends[0].max(edge.ends[1])], edge.sides, faces)
        };
        for (&edge, &same) in net.edge_of.iter().zip(&found.edge_of) {
            let (edge, same) = (sides(&net.edges[edge as usize]), sides(&found.edges[same as usize]));
            assert_eq!((edge.0, edge.1), (same.0, same.1), "{scheme}, {name}");
            assert!(edge.1 != 2 || edge.2 == same.2, "{scheme}, {name}");
        }
        assert_eq!((net.edges.len(), &net.valence), (found.edges.len(), &found.valence), "{scheme}, {name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// What is moved, turned, scaled and sheared before is so afterwards.
    #[test]
    fn subdivision_is_affine(numbers in prop::array::uniform12(-2.0f64..2.0), shape in 0usize..1000, seed in 0u64..99) {
        let shapes: Vec<_> = all().collect();
        let (scheme, _, mesh) = &shapes[shape % shapes.len()];
        let mesh = shapes::scatter(mesh.clone(), seed);
        let map = DAffine3 {
            matrix3: DMat3::from_cols_slice(&numbers[..9]),
            translation: DVec3::from_slice(&numbers[9..]),
        };
        let base = Level::base(&mesh);
        let mut mapped = base.clone();
        mapped.positions.iter_mut().for_each(|p| *p = map.transform_point3(*p));
        let ends = |base: Level| {
            let level = base.refined(*scheme).refined(*scheme);
            limits(*scheme, &level.net, &level.positions)
        };
        for (before, after) in ends(base).iter().zip(ends(mapped)) {
            prop_assert!(map.transform_point3(*before).distance(after) < 1e-11);
        }
    }
}
