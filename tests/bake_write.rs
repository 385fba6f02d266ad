//! What the bake writes is what its readers read: level by level, corner by corner, bit by bit.
#![cfg(feature = "bake")]

use std::fmt::Debug;

use glam::{Mat4, Quat, Vec2, Vec3, Vec4};
use lod_budget::bake::read::{from_bytes, gltf};
use lod_budget::bake::weld::weld;
use lod_budget::bake::write::glb::{Node, Transform};
use lod_budget::bake::write::sheet::{self, Chain};
use lod_budget::bake::write::{Glb, LevelOut, Measured, glb, obj};
use lod_budget::bake::{Format, Group, Mesh, Skin};
use proptest::prelude::*;

/// Triangles of few positions and few attributes, so that many corners meet, with and without seams.
fn meshes(uv_sets: usize) -> impl Strategy<Value = Mesh> {
    let corner = (0..30_u32, 0..3_u32);
    let triangles = prop::collection::vec([corner.clone(), corner.clone(), corner], 0..60);
    let cuts = prop::collection::vec((0..60_usize, "[a-c]?", prop::option::of("[m-o] ?[0-9]")), 0..5);
    let columns = prop::array::uniform4(any::<bool>());
    (triangles, cuts, columns, any::<u32>(), 0..=uv_sets).prop_map(
        |(triangles, cuts, columns, seed, sets)| {
            let mut mesh = Mesh { name: "thing".into(), ..Mesh::default() };
            mesh.uvs = vec![Vec::new(); sets];
            for (position, kind) in triangles.iter().flatten() {
                add_corner(
                    &mut mesh,
                    Numbers(seed ^ position),
                    Numbers(seed ^ (position << 8 | kind << 5)),
                    columns,
                );
            }
            let wedges: Vec<u32> = (0..mesh.positions.len() as u32).collect();
            mesh.triangles = wedges.as_chunks::<3>().0.to_vec();
            mesh.wedges = wedges;
            mesh.groups = groups(cuts, mesh.triangles.len());
            weld(&mut mesh);
            mesh
        },
    )
}

fn add_corner(
    mesh: &mut Mesh,
    mut place: Numbers,
    mut look: Numbers,
    [normal, colour, tangent, skin]: [bool; 4],
) {
    mesh.positions.push(place.vec3());
    if normal {
        mesh.normals.push(look.vec3().normalize_or(Vec3::X));
    }
    mesh.uvs.iter_mut().for_each(|set| set.push(look.vec3().truncate()));
    if colour {
        let c =
            [look.share(), look.share(), look.share(), if look.share() < 0.5 { 1.0 } else { look.share() }];
        mesh.colours.push(Vec4::from(c));
    }
    if normal && tangent {
        let side = if look.share() < 0.5 { -1.0 } else { 1.0 };
        mesh.tangents.push(look.vec3().normalize_or(Vec3::Y).extend(side));
    }
    if skin {
        let joint = look.next() as u16;
        mesh.skins.push(Skin { joints: [joint, joint ^ 1, 0, 0], weights: [0.75, 0.25, 0.0, 0.0] });
    }
}

/// Numbers that follow from a seed, some of them very large or small.
struct Numbers(u32);

impl Numbers {
    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(0x915f_77f5).wrapping_add(0x6a09_e667);
        self.0 ^ self.0 >> 15
    }

    fn share(&mut self) -> f32 {
        (self.next() >> 8) as f32 / (1 << 24) as f32
    }

    fn number(&mut self) -> f32 {
        let scale = [1.0, 1.0, 1e3, 1e-7, 1e12, 0.0][self.next() as usize % 6];
        (self.share() - 0.5) * scale
    }

    fn vec3(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }
}

/// Runs that cover all triangles, some of them empty.
fn groups(mut cuts: Vec<(usize, String, Option<String>)>, triangles: usize) -> Vec<Group> {
    cuts.iter_mut().for_each(|cut| cut.0 = cut.0.min(triangles));
    cuts.sort();
    let mut groups = vec![Group::default()];
    for (start, name, material) in cuts {
        groups.last_mut().expect("one at least").triangles.end = start;
        groups.push(Group { name, material, triangles: start..start });
    }
    groups.last_mut().expect("one at least").triangles.end = triangles;
    groups
}

/// The mesh with its wedges in order of first use, by looking at all of them; those that look alike become one. With
/// `used_only`, positions too.
fn in_order_of_use(mesh: &Mesh, used_only: bool) -> Mesh {
    let mut ordered = Mesh { name: mesh.name.clone(), groups: mesh.groups.clone(), ..Mesh::default() };
    ordered.uvs = vec![Vec::new(); mesh.uvs.len()];
    if !used_only {
        ordered.positions = mesh.positions.clone();
    }
    let mut rows: Vec<Row> = Vec::new();
    for triangle in &mesh.triangles {
        let wedges = triangle.map(|wedge| {
            let row = Row::of(mesh, wedge as usize);
            rows.iter().position(|other| *other == row).unwrap_or_else(|| {
                row.add_to(&mut ordered);
                rows.push(row);
                rows.len() - 1
            })
        });
        ordered.triangles.push(wedges.map(|w| w as u32));
    }
    ordered
}

/// All that a wedge has.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    position: Vec3,
    normal: Option<Vec3>,
    uvs: Vec<Vec2>,
    colour: Option<Vec4>,
    tangent: Option<Vec4>,
    skin: Option<Skin>,
}

impl Row {
    fn of(mesh: &Mesh, wedge: usize) -> Self {
        Self {
            position: mesh.positions[mesh.wedges[wedge] as usize],
            normal: mesh.normals.get(wedge).copied(),
            uvs: mesh.uvs.iter().map(|set| set[wedge]).collect(),
            colour: mesh.colours.get(wedge).copied(),
            tangent: mesh.tangents.get(wedge).copied(),
            skin: mesh.skins.get(wedge).copied(),
        }
    }

    fn add_to(&self, mesh: &mut Mesh) {
        let known = mesh.positions.iter().position(|p| *p == self.position);
        mesh.wedges.push(known.unwrap_or(mesh.positions.len()) as u32);
        mesh.positions.extend(known.is_none().then_some(self.position));
        mesh.normals.extend(self.normal);
        mesh.uvs.iter_mut().zip(&self.uvs).for_each(|(set, &uv)| set.push(uv));
        mesh.colours.extend(self.colour);
        mesh.tangents.extend(self.tangent);
        mesh.skins.extend(self.skin);
    }
}

/// Without empty ones, and neighbours that are called alike as one.
fn joined(groups: &[Group]) -> Vec<Group> {
    let mut joined: Vec<Group> = Vec::new();
    for group in groups.iter().filter(|group| !group.triangles.is_empty()) {
        match joined.last_mut().filter(|last| last.name == group.name && last.material == group.material) {
            Some(last) => last.triangles.end = group.triangles.end,
            None => joined.push(group.clone()),
        }
    }
    joined
}

fn read_obj(text: &str) -> Mesh {
    let file =
        from_bytes(text.as_bytes(), "thing.obj", Format::Obj).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(file.findings.is_empty(), "{:?}", file.findings);
    file.mesh
}

fn read_glb(bytes: &[u8]) -> Vec<Mesh> {
    let files = gltf::read_meshes(bytes, "thing.glb", None).unwrap_or_else(|e| panic!("{e}"));
    files.into_iter().map(|file| file.mesh).collect()
}

/// What reading a level of a GLB should give.
fn as_glb_has_it(mesh: &Mesh, name: &str) -> Mesh {
    let mut mesh = in_order_of_use(mesh, true);
    mesh.name = name.to_owned();
    mesh.groups.retain(|group| !group.triangles.is_empty());
    mesh.groups.iter_mut().for_each(|group| group.name = name.to_owned());
    mesh
}

/// Bits, which `==` does not tell: −0 is not 0, and Debug writes the shortest number that is the same.
fn bits<T: Debug>(of: &T) -> String {
    format!("{of:?}")
}

fn json_of(glb: &[u8]) -> serde_json::Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&glb[20..20 + length]).expect("JSON")
}

fn square(z: f32) -> Mesh {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1) as f32, z);
    Mesh {
        name: "square".into(),
        positions: (0..4).map(corner).collect(),
        wedges: vec![0, 1, 2, 3],
        triangles: vec![[0, 1, 2], [2, 1, 3]],
        groups: vec![Group { triangles: 0..2, ..Group::default() }],
        ..Mesh::default()
    }
}

proptest! {
    #[test]
    fn obj_is_read_as_it_was(mesh in meshes(1)) {
        let mut expected = Mesh { tangents: Vec::new(), skins: Vec::new(), ..mesh.clone() };
        expected = in_order_of_use(&expected, false);
        expected.groups = joined(&mesh.groups);
        let read = read_obj(&obj(&mesh));
        prop_assert_eq!(&read.surface().triangles, &mesh.surface().triangles);
        if mesh.triangles.is_empty() {
            expected.uvs.clear();
        }
        prop_assert_eq!(&read, &expected);
        prop_assert_eq!(bits(&read), bits(&expected));
    }

    #[test]
    fn every_level_of_a_glb_is_read_as_it_was(chain in prop::collection::vec(meshes(9), 1..4)) {
        let levels: Vec<LevelOut> = chain.iter().map(LevelOut::new).collect();
        let bytes = glb(&levels).expect("written");
        let full = chain.iter().enumerate().filter(|(_, mesh)| !mesh.triangles.is_empty());
        let expected: Vec<Mesh> = full.map(|(i, mesh)| {
            let mesh = Mesh { uvs: mesh.uvs.iter().take(8).cloned().collect(), ..mesh.clone() };
            as_glb_has_it(&mesh, &format!("thing_LOD{i}"))
        }).collect();
        prop_assert_eq!(bits(&read_glb(&bytes)), bits(&expected));
        prop_assert_eq!(glb(&levels).expect("written"), bytes);
    }

    /// Whatever a mesh has, glTF's rules hold of what is written.
    #[test]
    fn attributes_keep_the_rules(
        rows in prop::collection::vec(
            prop::array::uniform8(prop_oneof![Just(0.0), Just(f32::NAN), Just(f32::MAX), -2.0..2.0f32]),
            3..12,
        ),
        joints in prop::array::uniform4(0..2_u16),
    ) {
        let wedges: Vec<u32> = (0..rows.len() as u32).collect();
        let triangles = wedges.as_chunks::<3>().0.to_vec();
        let mesh = Mesh {
            positions: (0..rows.len()).map(|i| Vec3::splat(i as f32)).collect(),
            normals: rows.iter().map(|r| Vec3::new(r[0], r[1], r[2])).collect(),
            tangents: rows.iter().map(|r| Vec4::new(r[3], r[4], r[5], r[6])).collect(),
            colours: rows.iter().map(|r| Vec4::new(r[3], r[4], r[5], r[6])).collect(),
            skins: rows.iter().map(|r| Skin { joints, weights: [r[4], r[5], r[6], r[7]] }).collect(),
            groups: vec![Group { triangles: 0..triangles.len(), ..Group::default() }],
            wedges,
            triangles,
            ..Mesh::default()
        };
        let read = read_glb(&glb(&[LevelOut::new(&mesh)]).expect("written")).remove(0);
        prop_assert!(read.normals.iter().all(|n| (n.length() - 1.0).abs() < 0.006));
        prop_assert!(read.tangents.iter().all(|t| (t.truncate().length() - 1.0).abs() < 0.006 && t.w.abs() == 1.0));
        prop_assert!(read.colours.iter().all(|c| c.cmpge(Vec4::ZERO).all() && c.cmple(Vec4::ONE).all()));
        for Skin { joints, weights } in read.skins {
            let sum: f64 = weights.into_iter().map(f64::from).sum();
            prop_assert!((sum - 1.0).abs() <= 8e-7 && weights.iter().all(|&w| w >= 0.0), "{weights:?}");
            for i in 0..4 {
                let again = (0..i).any(|j| joints[j] == joints[i] && weights[j] > 0.0);
                let holds = if weights[i] > 0.0 { !again } else { joints[i] == 0 };
                prop_assert!(holds, "{joints:?} {weights:?}");
            }
        }
    }
}

#[test]
fn a_seam_of_an_obj_is_no_border() {
    let mut mesh = square(0.0);
    mesh.wedges.extend([1, 2]);
    mesh.triangles[1] = [5, 4, 3];
    mesh.uvs = vec![(0..6).map(|i| Vec2::splat(i as f32 / 8.0)).collect()];
    let text = obj(&mesh);
    assert_eq!(text.matches("v ").count(), 4, "{text}");
    assert!(text.ends_with("f 1/1 2/2 3/3\nf 3/6 2/5 4/4\n"), "{text}");
}

#[test]
fn names_of_an_obj_stay_on_their_line() {
    let mut mesh = square(0.0);
    mesh.groups = vec![
        Group { name: "a\nf 1 1 1 \\".into(), material: Some("x\r\ny".into()), triangles: 0..1 },
        Group { name: String::new(), material: None, triangles: 1..2 },
    ];
    let read = read_obj(&obj(&mesh));
    let names: Vec<_> = read.groups.iter().map(|g| (g.name.as_str(), g.material.as_deref())).collect();
    assert_eq!(names, [("a f 1 1 1", Some("x  y")), ("", None)]);
    assert_eq!(read.triangles.len(), 2);
}

#[test]
fn an_obj_of_nothing_is_empty() {
    assert_eq!(obj(&Mesh::default()), "");
}

#[test]
fn indices_are_wide_from_65536_vertices_on() {
    for (vertices, kind) in [(65_535, 5123), (65_536, 5125)] {
        let wedges: Vec<u32> = (0..vertices).collect();
        let triangles: Vec<[u32; 3]> = (0..vertices - 2).map(|i| [i, i + 1, i + 2]).collect();
        let mesh = Mesh {
            positions: wedges.iter().map(|&i| Vec3::new(i as f32, (i % 2) as f32, 0.0)).collect(),
            groups: vec![Group { triangles: 0..triangles.len(), ..Group::default() }],
            wedges,
            triangles,
            ..Mesh::default()
        };
        let bytes = glb(&[LevelOut::new(&mesh)]).expect("written");
        assert_eq!(json_of(&bytes)["accessors"][0]["componentType"], kind);
        assert_eq!(read_glb(&bytes)[0].triangles, mesh.triangles);
    }
}

#[test]
fn what_cannot_be_written_is_named() {
    let nowhere = Node { name: "n".into(), transform: Transform::Matrix(Mat4::NAN), ..Node::default() };
    let refused = Glb::default().add_node(nowhere).expect_err("refused");
    assert_eq!(refused.to_string(), "n: its transform must be finite");
    let refusal = |levels: &[LevelOut]| glb(levels).expect_err("refused").to_string();
    assert_eq!(refusal(&[]), ": it must have a level");
    let mut broken = square(0.0);
    broken.triangles[1][1] = 9;
    assert_eq!(
        refusal(&[LevelOut::new(&square(0.0)), LevelOut::new(&broken)]),
        "square_LOD1: corner 4 must be one of 4 wedges, not 9"
    );
    broken = square(f32::NAN);
    assert_eq!(refusal(&[LevelOut::new(&broken)]), "square_LOD0: position 0 must be finite");
    let mesh = square(0.0);
    let shown = |coverage| LevelOut { coverage, ..LevelOut::new(&mesh) };
    assert_eq!(
        refusal(&[shown(Some(0.5)), shown(None)]),
        "square: all of its levels must have a coverage, or none"
    );
    for (a, b) in [(0.1, 0.2), (f32::NAN, 0.0), (0.1, -0.1)] {
        assert!(refusal(&[shown(Some(a)), shown(Some(b))]).contains("its coverages must"));
    }
}

#[test]
fn a_file_of_nothing_is_a_file() {
    let bytes = Glb::default().finish().expect("written");
    assert_eq!(read_glb(&bytes), []);
    let nothing = Mesh::default();
    let bytes = glb(&[LevelOut::new(&nothing)]).expect("written");
    assert_eq!(json_of(&bytes)["nodes"][0], serde_json::json!({ "name": "_LOD0" }));
}

#[test]
fn what_was_measured_is_with_the_meshes() {
    let (fine, coarse) = (square(0.0), square(0.5));
    let measured = Some(Measured { error: 0.5, hausdorff: 0.5, rms: 0.25 });
    let levels = [LevelOut::new(&fine), LevelOut { measured, ..LevelOut::new(&coarse) }];
    let root = json_of(&glb(&levels).expect("written"));
    assert_eq!(
        root["meshes"][1]["extras"],
        serde_json::json!({ "lod_error": 0.5, "lod_hausdorff": 0.5, "lod_rms": 0.25 })
    );
    assert_eq!(root["asset"]["generator"], "lod-budget");
}

/// A scene of three objects and two chains, one of them below a node that turns it.
fn scene() -> Vec<u8> {
    let meshes = [square(0.0), square(0.25), square(1.0)];
    let mut glb = Glb::default();
    let levels = [(0, 0.5), (1, 0.125)];
    let levels = levels.map(|(i, c)| LevelOut { coverage: Some(c), ..LevelOut::new(&meshes[i]) });
    let pair = glb.add_chain("pair", &levels).expect("added");
    let alone = glb.add_chain("alone", &[LevelOut::new(&meshes[2])]).expect("added");
    let parts = Transform::Parts {
        translation: Vec3::X,
        rotation: Quat::from_rotation_y(1.0),
        scale: Vec3::splat(2.0),
    };
    let mut add = |node: Node| glb.add_node(node).expect("added");
    let group = add(Node { name: "group".into(), transform: parts, ..Node::default() });
    let moved = Transform::Matrix(Mat4::from_translation(Vec3::Y));
    let extras = serde_json::Map::from_iter([("tag".to_owned(), serde_json::json!(7))]);
    add(Node { name: "a".into(), parent: Some(group), chain: Some(pair), transform: moved, extras });
    add(Node { name: "a".into(), chain: Some(pair), ..Node::default() });
    add(Node { name: "b".into(), chain: Some(alone), transform: moved, ..Node::default() });
    glb.finish().expect("written")
}

#[test]
fn nodes_share_the_meshes_of_their_chain() {
    let root = json_of(&scene());
    assert_eq!(root["meshes"].as_array().map(Vec::len), Some(3));
    let head = &root["nodes"][1];
    assert_eq!(
        (&head["name"], &head["extras"]["tag"]),
        (&serde_json::json!("a_LOD0"), &serde_json::json!(7))
    );
    assert_eq!(head["extensions"]["MSFT_lod"]["ids"], serde_json::json!([2]));
    assert_eq!(root["nodes"][2]["matrix"], head["matrix"]);
    assert_eq!(root["scenes"][0]["nodes"], serde_json::json!([0, 3, 5]));
    // The reader of meshes shows the finest levels alone.
    let shown = from_bytes(&scene(), "scene.glb", Format::Gltf).expect("read").mesh;
    assert_eq!(shown.triangles.len(), 6);
}

#[cfg(feature = "files")]
#[test]
fn the_runtime_reads_the_scene() {
    use lod_budget::files::Scene;
    use lod_budget::files::gltf::size_of_coverage;

    let scene = Scene::from_gltf(&scene(), "scene.glb").unwrap_or_else(|e| panic!("{e}"));
    let ids: Vec<u64> = scene.objects.iter().map(|o| o.id.0).collect();
    assert_eq!(ids, [1, 3, 5]);
    let [pair, alone] = &scene.tables[..] else { panic!("two tables, not {}", scene.tables.len()) };
    assert_eq!((pair.name(), alone.name()), ("pair_LOD0", "alone_LOD0"));
    let sizes: Vec<_> = pair.levels().iter().map(|l| l.min_size).collect();
    assert_eq!(sizes, [0.5, 0.125].map(|c| Some(size_of_coverage(c))));
    assert_eq!(
        pair.levels().iter().map(|l| (l.triangles, l.vertices, l.draws)).collect::<Vec<_>>(),
        [(2, 4, 1); 2]
    );
    assert_eq!(alone.levels().len(), 1);
    let [turned, plain, other] = &scene.objects[..] else { unreachable!("three objects") };
    assert_eq!((turned.table, plain.table), (plain.table, turned.table));
    assert_ne!(other.table, plain.table);
    assert!((turned.bounds.radius / plain.bounds.radius - 2.0).abs() < 1e-6);
}

/// Whether every element of the text is closed by its own end, every attribute is in quotes, and nothing is outside.
fn is_well_formed(text: &str) -> bool {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = text.trim();
    while let Some(start) = rest.find('<') {
        let (plain, tag) = (&rest[..start], &rest[start + 1..]);
        let Some(end) = tag.find('>') else { return false };
        let stray = plain.contains('>') || plain.split('&').skip(1).any(|entity| !entity.contains(';'));
        if stray || open.is_empty() && !plain.trim().is_empty() {
            return false;
        }
        let inside = &tag[..end];
        let name = inside.trim_start_matches('/').split([' ', '/']).next().unwrap_or_default();
        match inside {
            _ if inside.starts_with('/') && open.pop() != Some(name) => return false,
            _ if inside.starts_with('/') || inside.ends_with('/') => {}
            _ => open.push(name),
        }
        if inside.matches('"').count() % 2 == 1 || inside.contains(['<', '&']) {
            return false;
        }
        rest = &tag[end + 1..];
    }
    open.is_empty() && rest.is_empty()
}

#[test]
fn the_checker_of_pages_tells_good_from_bad() {
    assert!(is_well_formed("<a b=\"c\"><d/>e&amp;<f>g</f></a>"));
    for bad in ["<a>", "<a></b>", "<a/>b", "<a>&b</a>", "<a b=\"></a>", "<a><b></a></b>", "<a>></a>"] {
        assert!(!is_well_formed(bad), "{bad}");
    }
}

#[test]
fn a_sheet_is_a_page_whatever_is_on_it() {
    let (nothing, mut one, two, far) = (Mesh::default(), square(0.0), square(f32::NAN), square(f32::MAX));
    one.triangles.truncate(1);
    one.groups[0].triangles = 0..1;
    let levels = [&one, &nothing, &two, &far, &one, &one, &one].map(LevelOut::new);
    let chains = [
        Chain { name: "<all> & \"none\"\u{0}", levels: &levels },
        Chain { name: "empty", levels: &levels[1..2] },
        Chain { name: "", levels: &[] },
    ];
    let page = sheet::svg(&chains).expect("drawn");
    assert!(is_well_formed(&page), "{}", &page[..1000]);
    assert_eq!(page.matches("<image").count(), 2 * 7 + 1);
    assert_eq!(page.matches("class=\"mark\"").count(), 7);
    assert!(page.contains("&lt;all&gt; &amp; \"none\""));
    assert_eq!(sheet::svg(&chains).expect("drawn"), page);
    assert!(is_well_formed(&sheet::svg(&[]).expect("drawn")));
}

#[test]
fn a_picture_shows_the_mesh_on_white() {
    let decoded = |mesh: &Mesh| {
        let png = sheet::png(mesh, 64).expect("drawn");
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        assert_eq!(png[16..24], [0, 0, 0, 64, 0, 0, 0, 64]);
        png
    };
    assert_ne!(decoded(&square(0.0)), decoded(&Mesh::default()));
    let mut turned = square(0.0);
    turned.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    assert_ne!(decoded(&square(0.0)), decoded(&turned), "back sides look different");
    assert_eq!(decoded(&square(0.0)), decoded(&square(7.0)), "wherever it is");
}
