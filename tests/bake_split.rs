//! Chunks of a mesh: every triangle in one of them, and no crack at any mix of their levels.
#![cfg(feature = "bake")]

mod seams;

use std::collections::BTreeMap;

use glam::Vec3;
use lod_budget::bake::Mesh;
use lod_budget::bake::shapes::{terrain, torus_knot};
use lod_budget::bake::simplify::{GarlandHeckbert, Simplified, Simplifier, Target, Task, Topology, quietly};
use lod_budget::bake::split::{Chunk, Options, open_edges, split};
use proptest::prelude::*;
use seams::{meshes, with_seams};

/// The coordinates of every corner, triangle by triangle.
fn corners(mesh: &Mesh) -> Vec<[Vec3; 3]> {
    let place = |wedge: u32| mesh.positions[mesh.wedges[wedge as usize] as usize];
    mesh.triangles.iter().map(|t| t.map(place)).collect()
}

/// A level of a chunk with this share of its triangles.
fn level(chunk: &Chunk, share: f64, topology: Topology) -> Simplified {
    let method = GarlandHeckbert { topology, ..GarlandHeckbert::default() };
    let target = Target::triangles((chunk.mesh.triangles.len() as f64 * share) as usize);
    let task = Task { locked: &chunk.locked, ..Task::new(&chunk.mesh, target) };
    method.simplify(&task, &mut quietly).expect("a chunk keeps the rules")
}

type Edge = ([u32; 3], [u32; 3]);

fn edge([a, b]: [Vec3; 2]) -> Edge {
    (a.to_array().map(f32::to_bits), b.to_array().map(f32::to_bits))
}

/// Edges that are there more often than their opposites, by the difference.
fn tally(edges: impl Iterator<Item = [Vec3; 2]>) -> BTreeMap<Edge, i32> {
    let mut tally = BTreeMap::new();
    for [a, b] in edges.filter(|[a, b]| a != b) {
        *tally.entry(edge([a, b])).or_insert(0) += 1;
        *tally.entry(edge([b, a])).or_insert(0) -= 1;
    }
    tally.retain(|_, &mut n| n > 0);
    tally
}

/// Where the edges of the whole mesh's border should be by now: at the heirs of their ends.
fn expected_border(mesh: &Mesh, chunks: &[Chunk], levels: &[Simplified]) -> BTreeMap<Edge, i32> {
    let whole = open_edges(&[mesh]);
    let moved = chunks.iter().zip(levels).flat_map(|(chunk, level)| {
        let place = |p: u32| level.mesh.positions[level.heirs[p as usize] as usize];
        let sides = (0..chunk.mesh.triangles.len()).flat_map(|t| {
            let [a, b, c] = chunk.mesh.triangles[t].map(|w| chunk.mesh.wedges[w as usize]);
            [[a, b], [b, c], [c, a]]
        });
        let is_border = |side: &[u32; 2]| {
            let ends = side.map(|p| chunk.mesh.positions[p as usize]);
            whole.iter().any(|border| edge(*border) == edge(ends))
        };
        let border: Vec<[u32; 2]> = sides.filter(is_border).collect();
        border.into_iter().map(move |side| side.map(place)).collect::<Vec<_>>()
    });
    tally(moved)
}

fn border_of(levels: &[Simplified]) -> BTreeMap<Edge, i32> {
    let meshes: Vec<&Mesh> = levels.iter().map(|level| &level.mesh).collect();
    tally(open_edges(&meshes).into_iter())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn chunks_hold_every_triangle_once_with_all_it_had(mesh in meshes(), most in 1..200usize) {
        let chunks = split(&mesh, &Options { triangles: most, share: 0.0 });
        let mut seen = vec![0; mesh.triangles.len()];
        for chunk in &chunks {
            prop_assert_eq!(chunk.mesh.check(), Ok(()));
            prop_assert!((1..=most).contains(&chunk.mesh.triangles.len()));
            prop_assert_eq!(chunk.check(&chunk.mesh), Ok(()));
            let (all, own) = (corners(&mesh), corners(&chunk.mesh));
            for (i, &t) in chunk.triangles.iter().enumerate() {
                let t = t as usize;
                seen[t] += 1;
                prop_assert_eq!(own[i], all[t]);
                let uvs = |mesh: &Mesh, t: usize| mesh.triangles[t].map(|w| mesh.uvs[0][w as usize]);
                prop_assert_eq!(uvs(&chunk.mesh, i), uvs(&mesh, t));
                let group = |mesh: &Mesh, t| mesh.groups.iter().find(|g| g.triangles.contains(&t)).map(|g| g.name.clone());
                prop_assert_eq!(group(&chunk.mesh, i), group(&mesh, t));
            }
        }
        prop_assert!(seen.iter().all(|&n| n == 1));
    }

    /// By looking at all chunks: a position is locked where another one has it, an edge shared where another one has
    /// it.
    #[test]
    fn what_chunks_share_is_known(mesh in meshes(), most in 20..200usize) {
        let chunks = split(&mesh, &Options { triangles: most, share: 0.0 });
        let uses = |chunk: &Chunk, p: Vec3| chunk.mesh.positions.contains(&p);
        for (i, chunk) in chunks.iter().enumerate() {
            let others = || chunks.iter().enumerate().filter(|&(j, _)| j != i).map(|(_, other)| other);
            for (&p, &locked) in chunk.mesh.positions.iter().zip(&chunk.locked) {
                prop_assert_eq!(locked, others().any(|other| uses(other, p)));
            }
            let sides = |chunk: &Chunk| -> Vec<[Vec3; 2]> {
                corners(&chunk.mesh).into_iter().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]).collect()
            };
            let theirs: Vec<[Vec3; 2]> = others().flat_map(sides).collect();
            let is_shared = |&[a, b]: &[Vec3; 2]| theirs.contains(&[a, b]) || theirs.contains(&[b, a]);
            let shared = sides(chunk).into_iter().filter(is_shared);
            let border = chunk.border.iter().map(|side| side.map(|p| chunk.mesh.positions[p as usize]));
            prop_assert_eq!(tally(shared), tally(border));
        }
    }

    /// The border of a mix is what the mesh's border has become; where there was none there is none, even if topology
    /// is free. (With a border it may be, too: but where a triangle goes with all its corners, nobody tells where to.)
    #[test]
    fn no_mix_of_levels_has_a_crack(
        mesh in meshes(),
        most in 20..200usize,
        shares in prop::collection::vec(0.0..1.0f64, 1..8),
        may_be_free in any::<bool>(),
    ) {
        let is_free = may_be_free && open_edges(&[&mesh]).is_empty();
        let topology = if is_free { Topology::Free } else { Topology::Preserved };
        let chunks = split(&mesh, &Options { triangles: most, share: 0.0 });
        let levels: Vec<Simplified> =
            chunks.iter().zip(shares.iter().cycle()).map(|(chunk, &share)| level(chunk, share, topology)).collect();
        for (chunk, level) in chunks.iter().zip(&levels) {
            let mut locked = chunk.locked.iter().zip(&chunk.mesh.positions).filter(|&(&locked, _)| locked);
            prop_assert!(is_free || locked.all(|(_, p)| level.mesh.positions.contains(p)));
            prop_assert!(is_free || chunk.check(&level.mesh).is_ok());
        }
        let expected = if is_free { BTreeMap::new() } else { expected_border(&mesh, &chunks, &levels) };
        prop_assert_eq!(border_of(&levels), expected);
        let lost = || levels.iter().map(|l| l.mesh.triangles.len()).sum::<usize>() < mesh.triangles.len();
        prop_assert!(lost() || shares.iter().any(|&share| share > 0.5) || most < 60, "nothing was simplified");
    }
}

/// What the checks are there for: levels that were made without locks do not fit, and both say so.
#[test]
fn levels_without_locks_are_found_out() {
    let mesh: Mesh = torus_knot(60, 10).into();
    let chunks = split(&mesh, &Options { triangles: 300, share: 0.0 });
    let careless = |chunk: &Chunk| {
        let task = Task::new(&chunk.mesh, Target::triangles(100));
        GarlandHeckbert::default().simplify(&task, &mut quietly).expect("a good task").mesh
    };
    let levels: Vec<Mesh> = chunks.iter().map(careless).collect();
    assert!(chunks.iter().zip(&levels).all(|(chunk, level)| chunk.check(level).is_err()));
    assert!(!open_edges(&levels.iter().collect::<Vec<_>>()).is_empty());
}

#[test]
fn every_pair_of_levels_of_neighbours_fits() {
    let mesh = with_seams(torus_knot(48, 8), 4);
    let chunks = split(&mesh, &Options { triangles: mesh.triangles.len() / 3 + 1, share: 0.0 });
    assert_eq!(chunks.len(), 3);
    let shares = [1.0, 0.5, 0.25, 0.0];
    let chains: Vec<Vec<Mesh>> = chunks
        .iter()
        .map(|chunk| shares.iter().map(|&share| level(chunk, share, Topology::Preserved).mesh).collect())
        .collect();
    for mix in 0..64 {
        let levels: Vec<&Mesh> = (0..3).map(|i| &chains[i][mix >> (2 * i) & 3]).collect();
        assert!(open_edges(&levels).is_empty(), "mix {mix}");
    }
}

#[test]
fn a_mesh_of_nothing_has_no_chunks() {
    assert_eq!(split(&Mesh::default(), &Options::default()), []);
    assert!(open_edges(&[]).is_empty());
}

#[test]
fn the_same_mesh_has_the_same_chunks() {
    let mesh = with_seams(terrain(30, 7), 4);
    let options = Options { triangles: 100, share: 0.0 };
    assert_eq!(split(&mesh, &options), split(&mesh.clone(), &options));
    let whole = split(&mesh, &Options::default());
    assert_eq!((whole.len(), whole[0].border.len()), (1, 0));
    assert!(whole[0].locked.iter().all(|&locked| !locked));
}
