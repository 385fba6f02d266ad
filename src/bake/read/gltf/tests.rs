use glam::{Vec2, Vec3, Vec4};

use super::*;
use crate::bake::Mesh;

/// A GLB of one buffer.
fn glb(json: &str, blob: &[u8]) -> Vec<u8> {
    let pad = |bytes: &[u8], with: u8| [bytes, &vec![with; (4 - bytes.len() % 4) % 4]].concat();
    let chunk = |kind: &[u8], bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes(), kind, bytes].concat();
    let chunks = [chunk(b"JSON", &pad(json.as_bytes(), b' ')), chunk(b"BIN\0", &pad(blob, 0))].concat();
    let length = 12 + chunks.len() as u32;
    [b"glTF".as_slice(), &2u32.to_le_bytes(), &length.to_le_bytes(), &chunks].concat()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Bytes 0..48: four positions; 48..56: indices of two triangles as bytes, padded; 56..88: four texture coordinates;
/// 88..136: normals.
fn square() -> Vec<u8> {
    let positions = floats(&[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.]);
    let uvs = floats(&[0., 0., 1., 0., 1., 1., 0., 1.]);
    [positions, vec![0, 1, 2, 0, 2, 3, 0, 0], uvs, floats(&[0., 0., 1.].repeat(4))].concat()
}

/// The parts of a file: nodes, then the primitives of its one mesh.
fn json(nodes: &str, primitives: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{nodes}],"meshes":[{{"name":"square","primitives":[{primitives}]}}],
        "materials":[{{"name":"brick"}},{{}}],
        "buffers":[{{"byteLength":136}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":8}},
            {{"buffer":0,"byteOffset":56,"byteLength":32}},{{"buffer":0,"byteOffset":88,"byteLength":48}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},
            {{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}},
            {{"bufferView":2,"componentType":5126,"count":4,"type":"VEC2"}},
            {{"bufferView":3,"componentType":5126,"count":4,"type":"VEC3"}},
            {{"bufferView":1,"componentType":5121,"count":2,"type":"VEC4","normalized":true}},
            {{"componentType":5126,"count":4,"type":"VEC3","sparse":{{"count":1,
                "indices":{{"bufferView":1,"byteOffset":1,"componentType":5121}},"values":{{"bufferView":3}}}}}},
            {{"bufferView":1,"componentType":5121,"count":2,"type":"SCALAR"}}]}}"#
    )
}

const PLAIN: &str = r#"{"attributes":{"POSITION":0},"indices":1}"#;
const FULL: &str =
    r#"{"attributes":{"POSITION":0,"NORMAL":3,"TEXCOORD_0":2,"TEXCOORD_1":2},"indices":1,"material":0}"#;

fn read_parts(nodes: &str, primitives: &str) -> Mesh {
    let file =
        read(&glb(&json(nodes, primitives), &square()), "a.glb", None).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(file.mesh.check(), Ok(()));
    assert_eq!(file.origins.numbers.len(), file.mesh.triangles.len());
    file.mesh
}

fn refusal(nodes: &str, primitives: &str) -> String {
    read(&glb(&json(nodes, primitives), &square()), "a.glb", None).expect_err("refused").to_string()
}

#[test]
fn a_primitive_brings_its_attributes() {
    let mesh = read_parts(r#"{"mesh":0}"#, FULL);
    assert_eq!(mesh.surface().triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!((mesh.normals.as_slice(), mesh.uvs.len()), ([Vec3::Z; 4].as_slice(), 2));
    assert_eq!(mesh.uvs[1][2], Vec2::ONE);
    assert_eq!((mesh.groups[0].name.as_str(), mesh.groups[0].material.as_deref()), ("square", Some("brick")));
}

#[test]
fn nodes_move_meshes_and_mirrors_turn_them_over() {
    let nodes =
        r#"{"children":[1,2],"translation":[10,0,0]},{"mesh":0,"scale":[2,2,2]},{"mesh":0,"scale":[1,1,-1]}"#;
    let mesh = read_parts(nodes, FULL);
    assert_eq!(mesh.positions[2], Vec3::new(12.0, 2.0, 0.0));
    let normal = |t: usize| {
        let [a, b, c] = mesh.surface().corners(t);
        (b - a).cross(c - a).normalize()
    };
    assert_eq!((normal(0), normal(2)), (Vec3::Z, Vec3::NEG_Z));
    let said = |t: usize| mesh.normals[mesh.triangles[t][0] as usize];
    assert_eq!((said(0), said(2)), (Vec3::Z, Vec3::NEG_Z));
}

#[test]
fn meshes_share_what_is_welded() {
    let mesh = read_parts(r#"{"mesh":0},{"mesh":0,"translation":[1,0,0]}"#, PLAIN);
    assert_eq!((mesh.positions.len(), mesh.triangles.len(), mesh.groups.len()), (6, 4, 2));
}

#[test]
fn primitives_without_an_attribute_get_a_neutral_one() {
    let colours = r#"{"attributes":{"POSITION":0,"COLOR_0":0,"TEXCOORD_0":2},"indices":1}"#;
    let mesh = read_parts(r#"{"mesh":0}"#, &format!("{PLAIN},{colours},{FULL}"));
    let at = |group: usize| mesh.triangles[mesh.groups[group].triangles.start][1] as usize;
    assert_eq!((mesh.colours[at(0)], mesh.colours[at(1)]), (Vec4::ONE, Vec4::new(1., 0., 0., 1.)));
    assert_eq!((mesh.normals[at(0)], mesh.normals[at(2)]), (Vec3::ZERO, Vec3::Z));
    assert_eq!(mesh.uvs[0][at(0)], Vec2::ZERO);
}

#[test]
fn primitives_without_a_triangle_bring_no_column() {
    let none = r#"{"attributes":{"POSITION":0,"NORMAL":3,"TEXCOORD_0":2},"indices":6}"#;
    let mesh = read_parts(r#"{"mesh":0}"#, &format!("{none},{PLAIN}"));
    assert_eq!((mesh.triangles.len(), mesh.normals.len(), mesh.uvs.len()), (2, 0, 0));
}

#[test]
fn strips_and_fans_run_the_same_way_all_along() {
    let faces = |mode: u32| {
        let primitive = format!(r#"{{"attributes":{{"POSITION":0}},"mode":{mode}}}"#);
        let surface = read_parts(r#"{"mesh":0}"#, &primitive).surface();
        surface.triangles.iter().map(|t| t.map(|p| surface.positions[p as usize])).collect::<Vec<_>>()
    };
    let [a, b, c, d] = [Vec3::ZERO, Vec3::X, Vec3::new(1., 1., 0.), Vec3::Y];
    assert_eq!(faces(5), [[a, b, c], [b, d, c]]);
    assert_eq!(faces(6), [[b, c, a], [c, d, a]]);
    assert!(faces(1).is_empty());
}

#[test]
fn sparse_rows_stand_above_others() {
    let mesh = read_parts(r#"{"mesh":0}"#, r#"{"attributes":{"POSITION":5},"mode":5}"#);
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::Z]);
}

#[test]
fn coarser_levels_are_left_out() {
    let nodes = r#"{"mesh":0,"extensions":{"MSFT_lod":{"ids":[1]}}},{"mesh":0,"translation":[0,0,9]}"#;
    assert_eq!(read_parts(nodes, PLAIN).triangles.len(), 2);
}

#[test]
fn a_skinned_mesh_stays_where_its_joints_expect_it() {
    assert_eq!(read_parts(r#"{"mesh":0,"skin":0,"translation":[5,5,5]}"#, PLAIN).positions[0], Vec3::ZERO);
}

#[test]
fn meshes_are_read_one_by_one() {
    let bytes = glb(&json(r#"{"mesh":0,"translation":[5,5,5]}"#, PLAIN), &square());
    let meshes = read_meshes(&bytes, "a.glb", None).expect("valid");
    assert_eq!((meshes.len(), meshes[0].mesh.name.as_str()), (1, "square"));
    assert_eq!((meshes[0].mesh.positions[0], meshes[0].origins.place(0).as_str()), (Vec3::ZERO, "mesh 0"));
    assert_eq!(read_parts("", PLAIN).triangles.len(), 2);
}

#[test]
fn buffers_may_be_in_the_text_or_beside_it() {
    let text = json(r#"{"mesh":0}"#, r#"{"attributes":{"POSITION":0}}"#);
    let inline = text.replace(
        r#"{"byteLength":136}"#,
        &format!(r#"{{"byteLength":48,"uri":"data:;base64,{}"}}"#, "A".repeat(64)),
    );
    assert_eq!(read(inline.as_bytes(), "a.gltf", None).expect("valid").mesh.triangles.len(), 1);
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("a b.bin"), square()).expect("written");
    let beside = text.replace(r#"{"byteLength":136}"#, r#"{"byteLength":136,"uri":"a%20b.bin"}"#);
    assert_eq!(
        read(beside.as_bytes(), "a.gltf", Some(folder.path())).expect("valid").mesh.positions.len(),
        3
    );
    let alone = read(beside.as_bytes(), "a.gltf", None).expect_err("no folder").to_string();
    assert!(alone.ends_with("accessor 0: buffer 0 must be in the file itself here"), "{alone}");
}

#[test]
fn what_is_out_of_range_is_named() {
    let refused = |primitive: &str| refusal(r#"{"mesh":0,"name":"hut"}"#, primitive);
    let place = "a.glb: node 0 \"hut\", mesh 0 \"square\", primitive 0: ";
    let cases = [
        (r#"{"attributes":{}}"#, "it must have a POSITION"),
        (r#"{"attributes":{"POSITION":9}}"#, "accessor 9 is unknown"),
        (r#"{"attributes":{"POSITION":2}}"#, "accessor 2: it must have [3] components, not 2"),
        (r#"{"attributes":{"POSITION":0},"mode":9}"#, "its mode must be one of 0 to 6"),
        (r#"{"attributes":{"POSITION":0,"COLOR_0":4}}"#, "its attributes must have 4 rows, not 2"),
    ];
    for (primitive, rule) in cases {
        assert_eq!(refused(primitive), format!("{place}{rule}"));
    }
    let long = json(r#"{"mesh":0}"#, PLAIN).replace(r#""count":6"#, r#""count":9"#);
    let error = read(&glb(&long, &square()), "a.glb", None).expect_err("refused").to_string();
    assert!(error.ends_with("accessor 1: its 9 rows of 1 bytes must fit buffer view 1"), "{error}");
    let mut wild = square();
    wild[50] = 77;
    let error =
        read(&glb(&json(r#"{"mesh":0}"#, PLAIN), &wild), "a.glb", None).expect_err("refused").to_string();
    assert!(error.ends_with("its index 2 must be one of 4 vertices, not 77"), "{error}");
}

#[test]
fn nodes_form_a_forest() {
    let circle = refusal(r#"{"children":[1]},{"children":[0],"mesh":0}],"scenes":[{"nodes":[0]}"#, PLAIN);
    assert_eq!(circle, "a.glb: node 0: it must have one parent, and not be its own ancestor");
    assert!(refusal(r#"{"children":[7]}"#, PLAIN).contains("node 7: it is unknown"));
    assert!(refusal(r#"{"mesh":3}"#, PLAIN).contains("its mesh is unknown"));
    assert!(refusal(r#"{"mesh":0,"rotation":[0,0,0,0]}"#, PLAIN).contains("rotation must have a length"));
}

#[test]
fn repeated_meshes_do_not_fill_the_memory() {
    let long = |nodes: usize| {
        let text = json(&vec![r#"{"mesh":0}"#; nodes].join(","), PLAIN)
            .replace(r#""byteOffset":48,"byteLength":8"#, r#""byteOffset":136,"byteLength":30000"#)
            .replace(r#""count":6"#, r#""count":30000"#)
            .replace(r#""byteLength":136"#, r#""byteLength":30136"#);
        read(&glb(&text, &[square(), vec![0; 30000]].concat()), "a.glb", None)
    };
    assert_eq!(long(50).expect("half a million").mesh.triangles.len(), 500_000);
    let error = long(200).expect_err("two millions").to_string();
    let place = "a.glb: node 104, mesh 0 \"square\", primitive 0: ";
    assert_eq!(error, format!("{place}with it there are more triangles or names than the file has bytes"));
    let empty = vec![r#"{"attributes":{"POSITION":0},"mode":0}"#; 2000].join(",");
    let error = read(&glb(&json(&vec![r#"{"mesh":0}"#; 600].join(","), &empty), &square()), "a.glb", None);
    assert!(
        error.expect_err("more than a million points").to_string().contains("more triangles or names than")
    );
    let zeros = json(r#"{"mesh":0}"#, r#"{"attributes":{"POSITION":5}}"#)
        .replace(r#""count":4,"type":"VEC3","sparse""#, r#""count":4000000000,"type":"VEC3","sparse""#);
    let error = read(&glb(&zeros, &square()), "a.glb", None).expect_err("refused").to_string();
    assert!(error.contains("accessor 5: it must not have more rows than the file has bytes"), "{error}");
}

#[test]
fn repeated_names_do_not_fill_the_memory() {
    let many = vec![PLAIN; 1000].join(",");
    let text =
        json(&vec![r#"{"mesh":0}"#; 1000].join(","), &many).replace("square", &"\u{1F600}".repeat(256));
    let error = read(&glb(&text, &square()), "a.glb", None).expect_err("a gigabyte").to_string();
    assert!(error.ends_with("with it there are more triangles or names than the file has bytes"), "{error}");
}

#[test]
fn files_that_are_none_are_refused() {
    let refused = |bytes: &[u8]| read(bytes, "a.glb", None).expect_err("refused").to_string();
    assert!(refused(b"").contains("its JSON is wrong"));
    assert!(refused(b"{}").contains("missing field `asset`"));
    assert!(refused(b"glTF").contains("cut off within its header"));
    let whole = glb(&json(r#"{"mesh":0}"#, PLAIN), &square());
    for end in [11, 19, 100, whole.len() - 1] {
        assert!(refused(&whole[..end]).contains("cut off"), "{end}");
    }
    let draco = json("", PLAIN)
        .replace(r#""nodes""#, r#""extensionsRequired":["KHR_draco_mesh_compression"],"nodes""#);
    assert!(refused(draco.as_bytes()).contains("requires the extension KHR_draco_mesh_compression"));
    assert!(refused(br#"{"asset":{"version":"1.0"}}"#).contains("must be 2.x"));
}
