//! Meshes to try it on, and what makes two of them the same.

use glam::{Vec2, Vec3, Vec4};
use lod_budget::bake::progressive::{Options, Progressive};
use lod_budget::bake::shapes::{icosphere, torus};
use lod_budget::bake::simplify::{GarlandHeckbert, Topology, quietly};
use lod_budget::bake::{Group, Mesh, Skin, Surface};
use proptest::prelude::*;

/// A number from 0 to 1 that looks random.
pub fn random(seed: u32, number: u32) -> f32 {
    let mut state = u64::from(seed) << 32 | u64::from(number);
    for _ in 0..3 {
        state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        state ^= state >> 29;
    }
    (state >> 40) as f32 / (1 << 24) as f32
}

/// The vertices of a surface, pushed about by up to `bump`.
pub fn bumped(mut surface: Surface, bump: f32, seed: u32) -> Surface {
    for (i, p) in (0u32..).zip(&mut surface.positions) {
        let push = |axis| 2.0 * random(seed, 3 * i + axis) - 1.0;
        *p += bump * Vec3::new(push(0), push(1), push(2));
    }
    surface
}

/// A sheet of cells in the plane, with a hole where cells are left out.
pub fn sheet(columns: u32, rows: u32, hole: bool) -> Surface {
    let at = |x: u32, y: u32| y * (columns + 1) + x;
    let places = (0..=rows).flat_map(|y| (0..=columns).map(move |x| Vec3::new(x as f32, y as f32, 0.0)));
    let is_hole = |x: u32, y: u32| hole && x == columns / 2 && y == rows / 2;
    let cells = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))).filter(|&(x, y)| !is_hole(x, y));
    let triangles = cells.flat_map(|(x, y)| {
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
        [[a, b, d], [a, d, c]]
    });
    Surface { positions: places.collect(), triangles: triangles.collect() }
}

/// Gives a surface all attributes there are: charts by the side of a plane, hard edges, two materials in turns.
pub fn dressed(surface: Surface, seed: u32) -> Mesh {
    let mut mesh = Mesh { name: "dressed".into(), positions: surface.positions, ..Mesh::default() };
    mesh.uvs = vec![Vec::new(), Vec::new()];
    let mut known = std::collections::BTreeMap::new();
    for triangle in &surface.triangles {
        let center: Vec3 = triangle.iter().map(|&v| mesh.positions[v as usize]).sum::<Vec3>() / 3.0;
        let (chart, smooth) = (u32::from(center.x > 0.2), u32::from(center.y > 0.1));
        mesh.triangles.push(triangle.map(|vertex| {
            *known.entry((vertex, chart, smooth)).or_insert_with(|| {
                let p = mesh.positions[vertex as usize];
                let side = if chart == 1 { 1.0 } else { -1.0 };
                let tilt = Vec3::new(0.0, smooth as f32, 0.3);
                mesh.wedges.push(vertex);
                mesh.normals.push((p + tilt).normalize_or_zero());
                mesh.uvs[0].push(Vec2::new(p.x + 3.0 * chart as f32, p.y));
                mesh.uvs[1].push(Vec2::new(p.z, random(seed, vertex)));
                mesh.colours.push(Vec4::new(random(seed, vertex), 0.5, smooth as f32, 1.0));
                mesh.tangents.push(Vec4::new(1.0, p.x, 0.0, side));
                let weight = random(seed, vertex + 77);
                mesh.skins.push(Skin {
                    joints: [vertex as u16, chart as u16, 0, 0],
                    weights: [weight, 1.0 - weight, 0.0, 0.0],
                });
                mesh.wedges.len() as u32 - 1
            })
        }));
    }
    let count = mesh.triangles.len();
    let ends = [0, count / 3, count / 3, count / 2, count];
    let names = ["a", "empty", "b", "a"];
    mesh.groups = (0..4)
        .map(|i| Group {
            name: names[i].into(),
            material: (i != 2).then(|| names[i].to_owned()),
            triangles: ends[i]..ends[i + 1],
        })
        .collect();
    mesh
}

/// What no simplification keeps: triangles that use a position twice, positions and wedges without use, wedges that
/// look the same, triangles twice; and numbers that are none, or 0 with a sign.
pub fn ragged(mut mesh: Mesh) -> Mesh {
    mesh.positions.insert(3, Vec3::new(f32::NAN, -0.0, f32::INFINITY));
    mesh.positions.push(Vec3::splat(-0.0));
    mesh.wedges.iter_mut().filter(|position| **position >= 3).for_each(|position| *position += 1);
    let twin = |wedges: &mut Vec<u32>, of: u32| {
        wedges.push(wedges[of as usize]);
        wedges.len() as u32 - 1
    };
    let copies: Vec<u32> = (0..6).map(|i| 2 * i).collect();
    let rows = |column: usize| copies.iter().copied().filter(move |_| column > 0);
    for of in copies.clone() {
        twin(&mut mesh.wedges, of);
    }
    mesh.wedges.push(3);
    let last = |n: usize| n.saturating_sub(1) as u32;
    macro_rules! repeat {
        ($column:expr) => {{
            let more: Vec<_> =
                rows($column.len()).chain((!$column.is_empty()).then(|| last($column.len()))).collect();
            for row in more {
                let value = $column[row as usize];
                $column.push(value);
            }
        }};
    }
    repeat!(mesh.normals);
    mesh.uvs.iter_mut().for_each(|set| repeat!(set));
    repeat!(mesh.colours);
    repeat!(mesh.tangents);
    repeat!(mesh.skins);
    if let Some(normal) = mesh.normals.first_mut() {
        *normal *= 3.0;
    }
    let first_copy = (mesh.wedges.len() - 7) as u32;
    for corner in mesh.triangles.as_flattened_mut().iter_mut().step_by(5).filter(|w| **w < 12 && **w % 2 == 0)
    {
        *corner = first_copy + *corner / 2;
    }
    let [a, b, _] = mesh.triangles[0];
    mesh.triangles.insert(0, [a, a, b]);
    let twice = mesh.triangles[2];
    mesh.triangles.push(twice);
    mesh.triangles.push([b, a, b]);
    for (i, group) in mesh.groups.iter_mut().enumerate() {
        group.triangles.start += usize::from(i > 0);
        group.triangles.end += 1;
    }
    if let Some(group) = mesh.groups.last_mut() {
        group.triangles.end += 2;
    }
    mesh
}

/// Small meshes of all kinds: closed, with borders and holes, in parts, with and without attributes, ragged.
pub fn any_mesh() -> impl Strategy<Value = Mesh> {
    let sphere = (2..6u32).prop_map(icosphere);
    let torus = (5..12u32, 5..8u32, 0.2..0.5f32).prop_map(|(r, s, tube)| torus(r, s, tube));
    let sheet = (2..9u32, 2..9u32, any::<bool>()).prop_map(|(c, r, hole)| sheet(c, r, hole));
    let parts = (2..4u32).prop_map(|cuts| both(icosphere(cuts), icosphere(2)));
    let surface = prop_oneof![sphere, torus, sheet, parts];
    (surface, 0.0..0.15f32, any::<u32>(), 0..3u8).prop_map(|(surface, bump, seed, kind)| {
        let surface = bumped(surface, bump, seed);
        match kind {
            0 => surface.into(),
            1 => dressed(surface, seed),
            _ => ragged(dressed(surface, seed)),
        }
    })
}

/// Two surfaces beside each other.
pub fn both(mut a: Surface, b: Surface) -> Surface {
    let first = a.positions.len() as u32;
    a.positions.extend(b.positions.iter().map(|&p| p + Vec3::X * 2.5));
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + first)));
    a
}

/// Both kinds of topology.
pub fn any_method() -> impl Strategy<Value = GarlandHeckbert> {
    any::<bool>().prop_map(|is_free| GarlandHeckbert {
        topology: if is_free { Topology::Free } else { Topology::Preserved },
        pairs: if is_free { 0.3 } else { 0.0 },
        ..GarlandHeckbert::default()
    })
}

pub fn progressive(mesh: &Mesh, method: GarlandHeckbert, marks_per_halving: u32) -> Progressive {
    let options = Options { method, marks_per_halving, ..Options::default() };
    Progressive::build(mesh, &options, &mut quietly).expect("a good mesh")
}

/// Every number of a mesh by its bits, so that what is no number equals itself.
pub fn bits(mesh: &Mesh) -> String {
    let vec3 = |v: &Vec3| v.to_array().map(f32::to_bits);
    let vec4 = |v: &Vec4| v.to_array().map(f32::to_bits);
    let columns = (
        mesh.positions.iter().map(vec3).collect::<Vec<_>>(),
        mesh.normals.iter().map(vec3).collect::<Vec<_>>(),
        mesh.uvs.iter().flatten().map(|uv| uv.to_array().map(f32::to_bits)).collect::<Vec<_>>(),
        mesh.colours.iter().map(vec4).collect::<Vec<_>>(),
        mesh.tangents.iter().map(vec4).collect::<Vec<_>>(),
        mesh.skins.iter().map(|s| (s.joints, s.weights.map(f32::to_bits))).collect::<Vec<_>>(),
    );
    format!("{:?}", (&mesh.name, columns, &mesh.wedges, &mesh.triangles, &mesh.groups))
}

/// A mesh up to the numbers of its positions, wedges and triangles: what each triangle is, sorted.
pub fn unnumbered(mesh: &Mesh) -> (usize, usize, Vec<String>) {
    let group_of =
        |t: usize| mesh.groups.iter().find(|g| g.triangles.contains(&t)).map(|g| (&g.name, &g.material));
    let corner = |&wedge: &u32| {
        let w = wedge as usize;
        format!(
            "{:?}",
            (
                mesh.positions[mesh.wedges[w] as usize].to_array().map(f32::to_bits),
                mesh.normals.get(w).map(|n| n.to_array().map(f32::to_bits)),
                mesh.uvs.iter().map(|set| set[w].to_array().map(f32::to_bits)).collect::<Vec<_>>(),
                mesh.colours.get(w).map(|c| c.to_array().map(f32::to_bits)),
                mesh.tangents.get(w).map(|t| t.to_array().map(f32::to_bits)),
                mesh.skins.get(w).map(|s| (s.joints, s.weights.map(f32::to_bits))),
            )
        )
    };
    let triangle =
        |(t, corners): (usize, &[u32; 3])| format!("{:?} {:?}", group_of(t), corners.each_ref().map(corner));
    let mut triangles: Vec<String> = mesh.triangles.iter().enumerate().map(triangle).collect();
    triangles.sort();
    (mesh.positions.len(), mesh.wedges.len(), triangles)
}
