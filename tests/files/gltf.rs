//! glTF, made here piece by piece.

use glam::{Mat4, Quat, Vec3};
use lod_budget::bounds::Sphere;
use lod_budget::files::Scene;
use lod_budget::files::gltf::size_of_coverage;
use lod_budget::scene::{Object, ObjectId};
use lod_budget::table::{LodTable, accuracy_of};
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::mangle;

/// A file with one accessor per entry of `positions` (that many vertices in the box from −1 to 1), then one of
/// indices per entry of `indices`, all without buffers.
fn file(positions: &[u64], indices: &[u64], meshes: Value, nodes: Value) -> Value {
    let position = |n: &u64| json!({"componentType": 5126, "type": "VEC3", "count": n, "min": [-1, -1, -1], "max": [1, 1, 1]});
    let index = |n: &u64| json!({"componentType": 5123, "type": "SCALAR", "count": n});
    let accessors: Vec<Value> = positions.iter().map(position).chain(indices.iter().map(index)).collect();
    json!({"asset": {"version": "2.0"}, "accessors": accessors, "meshes": meshes, "nodes": nodes})
}

/// One primitive of triangles.
fn indexed(position: usize, indices: usize) -> Value {
    json!({"primitives": [{"attributes": {"POSITION": position}, "indices": indices}]})
}

/// Meshes of 100, 50, 20 and 4 triangles, by accessor 0 to 3 (vertices) and 4 to 7 (indices), and these nodes.
fn chain_file(nodes: Value) -> Value {
    let meshes = (0..4).map(|i| indexed(i, i + 4)).collect();
    file(&[60, 30, 12, 4], &[300, 150, 60, 12], meshes, nodes)
}

fn read(file: &Value) -> Result<Scene, String> {
    Scene::from_gltf(file.to_string().as_bytes(), "a.gltf").map_err(|e| e.to_string())
}

#[track_caller]
fn good(file: &Value) -> Scene {
    let scene = read(file).expect("a good file");
    scene.to_objects().expect("a good scene");
    scene
}

#[track_caller]
fn refused(file: &Value, message: &str) {
    let error = read(file).expect_err("must be refused");
    assert!(error.starts_with("a.gltf: "), "{error}");
    assert!(error.contains(message), "{error}");
}

fn table_of<'a>(scene: &'a Scene, object: &Object) -> &'a LodTable {
    &scene.tables[usize::from(object.table.0)]
}

/// Per object its id and the triangles of its levels.
fn chains(scene: &Scene) -> Vec<(u64, Vec<u32>)> {
    let triangles = |o| table_of(scene, o).levels().iter().map(|l| l.triangles).collect();
    scene.objects.iter().map(|o| (o.id.0, triangles(o))).collect()
}

fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let chunk = |kind: &[u8], bytes: &[u8], pad: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), pad);
        [&(bytes.len() as u32).to_le_bytes()[..], kind, &bytes].concat()
    };
    let chunks = [chunk(b"JSON", json.as_bytes(), b' '), chunk(b"BIN\0", binary, 0)].concat();
    let length = (chunks.len() + 12) as u32;
    [b"glTF", &2u32.to_le_bytes()[..], &length.to_le_bytes(), &chunks].concat()
}

#[test]
fn counts_follow_the_mode_of_each_primitive() {
    for (mode, triangles) in [(0, 0), (1, 0), (2, 0), (3, 0), (4, 3), (5, 9), (6, 9)] {
        let primitive = json!({"attributes": {"POSITION": 0}, "indices": 1, "mode": mode});
        let scene = good(&file(&[7], &[11], json!([{"primitives": [primitive]}]), json!([{"mesh": 0}])));
        let level = scene.tables[0].levels()[0];
        assert_eq!((level.triangles, level.vertices, level.draws), (triangles, 7, 1), "mode {mode}");
        assert_eq!(level.bytes, 7 * 12 + 11 * 2);
        assert_eq!((level.accuracy, level.error, level.min_size), (accuracy_of(triangles), None, None));
    }
    let loose = json!([{"primitives": [{"attributes": {"POSITION": 0}, "mode": 5}]}]);
    assert_eq!(chains(&good(&file(&[7], &[], loose, json!([{"mesh": 0}])))), [(0, vec![5])]);
    let strange = json!([{"primitives": [{"attributes": {"POSITION": 0}, "mode": 7}]}]);
    refused(&file(&[7], &[], strange, json!([{"mesh": 0}])), "mesh 0: primitive 0: its mode must be");
}

#[test]
fn an_accessor_that_primitives_share_is_counted_once_per_mesh() {
    let primitive = |indices: usize| json!({"attributes": {"POSITION": 0}, "indices": indices});
    let meshes = json!([{"primitives": [primitive(1), primitive(2), primitive(1)]}]);
    let scene = good(&file(&[40], &[30, 60], meshes, json!([{"mesh": 0}, {"mesh": 0}])));
    let level = scene.tables[0].levels()[0];
    assert_eq!((level.triangles, level.vertices, level.draws), (10 + 20 + 10, 40, 3));
    assert_eq!(level.bytes, 40 * 12 + 30 * 2 + 60 * 2);
    assert_eq!((scene.tables.len(), scene.objects.len()), (1, 2));
}

#[test]
fn morph_targets_widen_the_bound_and_fill_memory() {
    let mut f = file(&[10, 10], &[], json!([]), json!([{"mesh": 0}]));
    let primitive = json!({"attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}, {"POSITION": 1}]});
    f["meshes"] = json!([{"primitives": [primitive]}]);
    f["accessors"][1]["min"] = json!([0, 2, 0]);
    f["accessors"][1]["max"] = json!([0, 3, 0.5]);
    let scene = good(&f);
    let expected = Sphere::new(Vec3::new(0.0, 3.0, 0.5), Vec3::new(1.0, 4.0, 1.5).length());
    let bounds = scene.tables[0].bounds();
    assert_eq!(bounds.center, expected.center);
    assert!((bounds.radius - expected.radius).abs() < 1e-6);
    assert_eq!((scene.tables[0].levels()[0].vertices, scene.tables[0].levels()[0].bytes), (10, 240));
}

#[test]
fn skins_sparse_and_compressed_accessors_are_counted_like_any_other() {
    let mut f = chain_file(json!([{"mesh": 0, "skin": 0}]));
    f["accessors"][0]["sparse"] = json!({"count": 1, "indices": {"bufferView": 0, "componentType": 5123},
                                         "values": {"bufferView": 0}});
    f["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression": {"bufferView": 7}});
    f["extensionsRequired"] = json!(["KHR_draco_mesh_compression", "KHR_materials_unlit", "MSFT_lod"]);
    assert_eq!(chains(&good(&f)), [(0, vec![100])]);
}

#[test]
fn normalised_positions_are_what_they_stand_for() {
    let mut f = chain_file(json!([{"mesh": 0}]));
    f["accessors"][0] = json!({"componentType": 5122, "normalized": true, "type": "VEC3", "count": 60,
                               "min": [-32767, 0, 0], "max": [32767, 0, 0]});
    assert!((good(&f).tables[0].bounds().radius - 1.0).abs() < 1e-6);
}

#[test]
fn what_does_not_matter_may_be_missing_or_odd() {
    let mut f = chain_file(json!([{"mesh": 0, "camera": 5, "extras": [1, "two"]}, {"name": "empty"}]));
    f["textures"] = json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
    f["materials"] = json!([{"extensions": {"MSFT_lod": {"ids": [99]}}}]);
    f["scenes"] = json!([{"name": "nothing in it"}, {"nodes": [0, 1]}]);
    f["scene"] = json!(1);
    f["buffers"] = json!([{"byteLength": 9, "uri": "not/there.bin"}]);
    assert_eq!(chains(&good(&f)), [(0, vec![100])]);
    f["scene"] = json!(0);
    assert_eq!(chains(&good(&f)), []);
    f["scene"] = json!(2);
    refused(&f, "its default scene must be one of its scenes");
}

#[test]
fn the_first_scene_stands_in_for_the_default_and_all_roots_for_none() {
    let mut f = chain_file(json!([{"mesh": 0}, {"children": [2]}, {"mesh": 1}]));
    assert_eq!(chains(&good(&f)), [(0, vec![100]), (2, vec![50])]);
    f["scenes"] = json!([{"nodes": [1]}, {"nodes": [0]}]);
    assert_eq!(chains(&good(&f)), [(2, vec![50])]);
}

#[test]
fn a_required_extension_that_is_unknown_is_named() {
    let mut f = chain_file(json!([{"mesh": 0}]));
    f["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    assert!(read(&f).is_ok());
    f["extensionsRequired"] = json!(["KHR_mesh_quantization", "EXT_mesh_gpu_instancing"]);
    refused(&f, "a.gltf: it requires the extension EXT_mesh_gpu_instancing, which is not supported");
}

#[test]
fn broken_hierarchies_are_refused() {
    refused(&chain_file(json!([{"children": [1]}, {"children": [0]}])), "node 0: it is its own ancestor");
    refused(&chain_file(json!([{"mesh": 0}, {"children": [1]}])), "node 1: it is its own ancestor");
    let two = json!([{"children": [2], "name": "a"}, {"children": [2], "name": "b"}, {"mesh": 0}]);
    refused(&chain_file(two), "node 1 'b': its child 2 is also a child of node 0");
    refused(&chain_file(json!([{"children": [7]}])), "node 0: its child 7 is unknown");
    refused(&chain_file(json!([{"children": [-1]}])), "node at position 0");
    refused(&chain_file(json!([{"mesh": 4}])), "node 0: its mesh 4 is unknown");
    let mut f = chain_file(json!([{"mesh": 0, "children": [1]}, {"mesh": 1}]));
    for (roots, message) in [
        (json!([0, 0]), "node 0: it is a root of the scene twice"),
        (json!([0, 1]), "node 1: it is a root of the scene and also a child"),
        (json!([9]), "node 9: it is a root of the scene but unknown"),
    ] {
        f["scenes"] = json!([{"nodes": roots}]);
        refused(&f, message);
    }
}

#[test]
fn a_hierarchy_may_be_a_hundred_thousand_deep() {
    let mut nodes: Vec<Value> = (1..100_000).map(|i| json!({"children": [i]})).collect();
    nodes.push(json!({"mesh": 0}));
    assert_eq!(chains(&good(&chain_file(Value::Array(nodes)))), [(99_999, vec![100])]);
}

#[test]
fn broken_accessors_are_refused() {
    let base = chain_file(json!([{"mesh": 0}]));
    let with = |pointer: &str, value: Value| {
        let mut f = base.clone();
        match f.pointer_mut(pointer) {
            Some(place) => *place = value,
            None => panic!("{pointer} must be there"),
        }
        f
    };
    let box_rule = "mesh 0: primitive 0: positions (accessor 0) must have a min and a max";
    for (pointer, value) in [
        ("/accessors/0/min", json!(null)),
        ("/accessors/0/max", json!([1, 1])),
        ("/accessors/0/max", json!([1, 1, "1"])),
        ("/accessors/0/max", json!([1, -2, 1])),
        ("/accessors/0/max", json!("high")),
    ] {
        refused(&with(pointer, value), box_rule);
    }
    refused(&with("/accessors/0/type", json!("VEC2")), "positions (accessor 0) must be of type VEC3");
    refused(&with("/accessors/0/type", json!("VEC9")), "positions (accessor 0) must be of type VEC3");
    refused(&with("/accessors/4/componentType", json!(1)), "the type of accessor 4 is unknown");
    refused(
        &with("/accessors/0/count", json!(0)),
        "the count of accessor 0 must be between 1 and 4294967295",
    );
    refused(&with("/accessors/4/count", json!(1u64 << 40)), "the count of accessor 4 must be between 1");
    refused(&with("/accessors/4/count", json!(-3)), "accessor at position 4");
    refused(&with("/accessors/0/count", json!(1.5)), "accessor at position 0");
    refused(&with("/meshes/0/primitives", json!([])), "mesh 0: it must have a primitive");
    refused(
        &with("/meshes/0/primitives/0/attributes", json!({"NORMAL": 0})),
        "primitive 0: it must have a POSITION",
    );
    refused(
        &with("/meshes/0/primitives/0/indices", json!(99)),
        "mesh 0: primitive 0: accessor 99 is unknown",
    );
    refused(
        &with("/meshes/0/primitives/0/attributes", json!({"POSITION": 0, "_X": 99})),
        "accessor 99 is unknown",
    );
    refused(&with("/asset/version", json!("1.0")), "its asset.version must be 2.x, not 1.0");
    refused(&with("/accessors/0/max", json!([1e39, 1, 1])), "its place and size in the world must fit");
}

#[test]
fn huge_counts_are_taken_at_their_word_as_far_as_they_fit() {
    let most = u64::from(u32::MAX);
    let mut f = file(&[4], &[most], json!([indexed(0, 1)]), json!([{"mesh": 0}]));
    assert_eq!(chains(&good(&f)), [(0, vec![u32::MAX / 3])]);
    f["accessors"][1]["bufferView"] = json!(0);
    refused(&f, "the buffer view 0 of accessor 1 is unknown");
    f["bufferViews"] = json!([{"buffer": 0, "byteLength": 1000}]);
    refused(&f, "accessor 1 must fit its buffer view of 1000 bytes");
    f["accessors"][1]["byteOffset"] = json!(u64::MAX);
    refused(&f, "accessor 1 must fit its buffer view of 1000 bytes");
    f["accessors"][1] = json!({"componentType": 5123, "type": "SCALAR", "count": 500, "bufferView": 0});
    assert!(read(&f).is_ok());
    let strip = json!({"attributes": {"POSITION": 0}, "mode": 5});
    let f = file(&[most], &[], json!([{"primitives": [strip, strip]}]), json!([{"mesh": 0}]));
    refused(&f, "triangles, vertices and draws must each be at most 4294967295");
}

#[test]
fn transforms_are_checked() {
    let moved = |node: Value| chain_file(json!([node]));
    let columns = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2];
    refused(&moved(json!({"mesh": 0, "matrix": columns})), "node 0: its matrix must be affine");
    refused(&moved(json!({"mesh": 0, "matrix": [1, 0]})), "node at position 0");
    refused(&moved(json!({"mesh": 0, "rotation": [0, 0, 0, 0]})), "node 0: its rotation must have a length");
    refused(&moved(json!({"mesh": 0, "translation": [1e39, 0, 0]})), "node at position 0");
    refused(
        &moved(json!({"mesh": 0, "scale": [3e38, 3e38, 1]})),
        "node 0: its place and size in the world must fit",
    );
    let text = r#"{"asset":{"version":"2.0"},"nodes":[{"translation":[NaN,0,0]}]}"#;
    assert!(Scene::from_gltf(text.as_bytes(), "a.gltf").is_err());
    let deep: Vec<Value> = (1..20).map(|i| json!({"scale": [3e38, 3e38, 3e38], "children": [i]})).collect();
    let deep = [deep, vec![json!({"mesh": 0})]].concat();
    refused(&chain_file(Value::Array(deep)), "its place in the world must be finite");
}

#[test]
fn a_scale_of_zero_hides_and_a_flat_one_does_not() {
    let f = chain_file(json!([{"mesh": 0, "scale": [0, 0, 0], "translation": [5, 0, 0]},
                              {"mesh": 0, "scale": [1, 0, 1]}]));
    let scene = good(&f);
    let [gone, flat] = scene.objects[..] else { panic!("two objects") };
    assert_eq!((gone.bounds, gone.settings.hidden), (Sphere::new(Vec3::X * 5.0, 0.0), true));
    assert!(!flat.settings.hidden && (flat.bounds.radius - 2.0f32.sqrt()).abs() < 1e-6);
}

#[test]
fn msft_lod_makes_one_object_of_its_nodes() {
    let f = chain_file(json!([
        {"mesh": 0, "translation": [1, 2, 3], "extensions": {"MSFT_lod": {"ids": [1, 2]}}},
        {"mesh": 1, "translation": [1, 2, 3]},
        {"mesh": 2, "translation": [1, 2, 3]},
        {"mesh": 0, "translation": [9, 9, 9], "extensions": {"MSFT_lod": {"ids": [4, 5]}}},
        {"mesh": 1, "translation": [9, 9, 9]},
        {"mesh": 2, "translation": [9, 9, 9]},
        {"mesh": 3},
    ]));
    let scene = good(&f);
    assert_eq!(chains(&scene), [(0, vec![100, 50, 20]), (3, vec![100, 50, 20]), (6, vec![4])]);
    assert_eq!((scene.tables.len(), scene.objects[0].table), (2, scene.objects[1].table));
    assert_eq!(scene.objects[0].bounds.center, Vec3::new(1.0, 2.0, 3.0));
    let vertices: Vec<u32> = scene.tables[0].levels().iter().map(|l| l.vertices).collect();
    assert_eq!(vertices, [60, 30, 12]);
}

#[test]
fn one_bound_holds_all_levels() {
    let f = chain_file(json!([
        {"mesh": 0, "scale": [2, 2, 2], "extensions": {"MSFT_lod": {"ids": [1]}}},
        {"mesh": 1, "scale": [2, 2, 2], "translation": [4, 0, 0]},
    ]));
    let scene = good(&f);
    let table = scene.tables[0].bounds();
    assert_eq!((table.center, table.radius), (Vec3::X, (4.0f32 + 1.0 + 1.0).sqrt()));
    let world = scene.objects[0].bounds;
    assert_eq!((world.center, world.radius), (Vec3::X * 2.0, table.radius * 2.0));
}

#[test]
fn a_level_is_a_node_and_all_below_and_may_draw_nothing() {
    let f = chain_file(json!([
        {"children": [1, 2, 3], "extensions": {"MSFT_lod": {"ids": [3, 4]}}},
        {"mesh": 0},
        {"mesh": 1},
        {"mesh": 2},
        {"name": "nothing"},
    ]));
    let scene = good(&f);
    assert_eq!(chains(&scene), [(0, vec![150, 20, 0])]);
    let draws: Vec<u32> = scene.tables[0].levels().iter().map(|l| l.draws).collect();
    assert_eq!(draws, [2, 1, 0]);
    let empty = chain_file(json!([{"extensions": {"MSFT_lod": {"ids": [1]}}}, {}]));
    assert_eq!(chains(&good(&empty)), []);
}

#[test]
fn a_level_without_a_parent_is_placed_beside_its_finest() {
    let f = chain_file(json!([
        {"children": [1], "translation": [100, 0, 0]},
        {"mesh": 0, "translation": [0, 1, 0], "extensions": {"MSFT_lod": {"ids": [2]}}},
        {"mesh": 1, "translation": [0, 1, 0]},
    ]));
    let scene = good(&f);
    assert_eq!(chains(&scene), [(1, vec![100, 50])]);
    let bounds = scene.tables[0].bounds();
    assert!(bounds.center == Vec3::ZERO && (bounds.radius - 3.0f32.sqrt()).abs() < 1e-6, "{bounds:?}");
    assert_eq!(scene.objects[0].bounds.center, Vec3::new(100.0, 1.0, 0.0));
}

#[test]
fn broken_msft_lods_are_refused() {
    let lod = |ids: Value| json!({"mesh": 0, "extensions": {"MSFT_lod": {"ids": ids}}});
    let plain = || json!({"mesh": 1});
    refused(&chain_file(json!([lod(json!([5]))])), "node 0: its MSFT_lod level 5 is unknown");
    refused(&chain_file(json!([lod(json!([0]))])), "node 0: it has MSFT_lod levels and is one itself");
    refused(
        &chain_file(json!([lod(json!([1])), lod(json!([0]))])),
        "node 0: it has MSFT_lod levels and is one",
    );
    refused(
        &chain_file(json!([lod(json!([1])), lod(json!([2])), plain()])),
        "node 1: it has MSFT_lod levels and",
    );
    let shared = json!([lod(json!([2])), lod(json!([2])), plain()]);
    refused(&chain_file(shared), "node 1: its MSFT_lod level 2 is also a level of node 0");
    refused(&chain_file(json!([lod(json!([1, 1])), plain()])), "node 0: its MSFT_lod names node 1 twice");
    for ids in [json!([-1]), json!(["1"]), json!(1), json!([1.5]), json!(null)] {
        refused(
            &chain_file(json!([lod(ids), plain()])),
            "node 0: its MSFT_lod must have a list of node indices",
        );
    }
    let above = json!([{"children": [1]}, lod(json!([0]))]);
    refused(&chain_file(above), "node 1: it has MSFT_lod levels within a level");
    let mut parent = lod(json!([3]));
    parent["children"] = json!([1]);
    let nested = json!([parent, lod(json!([2])), plain(), plain()]);
    refused(&chain_file(nested), "node 1: it has MSFT_lod levels within a level");
    let many: Vec<Value> = (0..256).map(|_| plain()).collect();
    let many = [vec![lod((1..=256).collect())], many].concat();
    refused(&chain_file(Value::Array(many)), "it must have at most 254 levels");
    let no_levels = chain_file(json!([lod(json!([]))]));
    assert_eq!(chains(&good(&no_levels)), [(0, vec![100])]);
}

#[test]
fn coverage_becomes_a_least_size() {
    let lod = |extras: Value| {
        chain_file(json!([
            {"mesh": 0, "extensions": {"MSFT_lod": {"ids": [1]}}, "extras": extras},
            {"mesh": 1},
        ]))
    };
    let scene = good(&lod(json!({"MSFT_screencoverage": [0.5, 0.01]})));
    let sizes: Vec<_> = scene.tables[0].levels().iter().map(|l| l.min_size).collect();
    assert_eq!(sizes, [Some(size_of_coverage(0.5)), Some(size_of_coverage(0.01))]);
    assert_eq!(scene.objects[0].settings.draw_distance, f32::INFINITY);
    let scene = good(&lod(json!({"MSFT_screencoverage": [0.5]})));
    assert_eq!(scene.tables[0].levels()[1].min_size, None);
    refused(
        &lod(json!({"MSFT_screencoverage": [3, 2, 1]})),
        "node 0: its extras.MSFT_screencoverage must have",
    );
    for broken in [json!([-0.5]), json!("0.5"), json!([null])] {
        refused(
            &lod(json!({"MSFT_screencoverage": broken})),
            "node 0: its extras.MSFT_screencoverage must be a list",
        );
    }
}

#[test]
fn distances_become_sizes_by_the_size_of_each_object() {
    let distances = json!({"lod_max_distance": [50, 200]});
    let node = |x: f32, scale: f32, level: usize| {
        json!({"mesh": 0, "translation": [x, 0.0, 0.0], "scale": [scale, scale, scale], "extras": distances,
               "extensions": {"MSFT_lod": {"ids": [level]}}})
    };
    let coarse = |x: f32, s: f32| json!({"mesh": 1, "translation": [x, 0.0, 0.0], "scale": [s, s, s]});
    let f = chain_file(json!([
        node(0.0, 1.0, 3), node(5.0, 2.0, 4), node(9.0, 1.0, 5),
        coarse(0.0, 1.0), coarse(5.0, 2.0), coarse(9.0, 1.0),
        {"mesh": 2, "extras": {"lod_max_distance": [80]}}, {"mesh": 2, "scale": [3, 3, 3]},
    ]));
    let scene = good(&f);
    let [small, large, same, culled, plain] = scene.objects[..] else { panic!("five objects") };
    assert_eq!((small.table, culled.table), (same.table, plain.table));
    assert_ne!(small.table, large.table);
    assert_eq!((small.settings.draw_distance, culled.settings.draw_distance), (200.0, 80.0));
    assert_eq!(plain.settings.draw_distance, f32::INFINITY);
    assert_eq!(table_of(&scene, &culled).levels()[0].min_size, None);
    for object in [small, large] {
        let sizes = table_of(&scene, &object).levels().iter().map(|l| l.min_size);
        let height = |d: f32| 2.0 * d * 30f32.to_radians().tan();
        let expected = [50.0, 200.0].map(|d| 2.0 * object.bounds.radius / height(d));
        for (size, expected) in sizes.zip(expected) {
            assert!((size.expect("a size") / expected - 1.0).abs() < 1e-6);
        }
    }
    let wrong = |d: Value| chain_file(json!([{"mesh": 0, "extras": {"lod_max_distance": d}}]));
    refused(
        &wrong(json!([50, 200])),
        "node 0: its extras.lod_max_distance must have a value per level, of which it has 1",
    );
    refused(&wrong(json!([0])), "node 0: its extras.lod_max_distance must be a list of numbers");
}

/// Per level of the first table, its error and accuracy.
fn measured(scene: &Scene) -> Vec<(Option<f32>, f32)> {
    scene.tables[0].levels().iter().map(|l| (l.error, l.accuracy)).collect()
}

#[test]
fn what_was_measured_is_in_the_table() {
    let nodes = json!([{"mesh": 0, "extensions": {"MSFT_lod": {"ids": [1, 2]}}}, {"mesh": 1}, {"mesh": 2}]);
    let mut f = chain_file(nodes);
    let unknown = [100, 50, 20].map(|n| (None, accuracy_of(n)));
    assert_eq!(measured(&good(&f)), unknown);
    f["meshes"][2]["extras"] = json!({"lod_error": 0.1, "lod_accuracy": 0.75, "lod_rms": 0.01});
    assert_eq!(measured(&good(&f)), [unknown[0], unknown[1], (Some(0.1), 0.75)]);
    f["meshes"][1]["extras"] = json!({"lod_error": 0.0625, "lod_accuracy": 0.875});
    assert_eq!(measured(&good(&f))[..2], [(Some(0.0), 1.0), (Some(0.0625), 0.875)]);
    f["meshes"][0]["extras"] = json!({"lod_error": 0.03125, "lod_accuracy": 0.9375, "other": []});
    assert_eq!(measured(&good(&f))[0], (Some(0.03125), 0.9375));
}

#[test]
fn a_level_of_several_parts_is_as_good_as_its_worst() {
    let mut f = chain_file(json!([
        {"mesh": 0, "extensions": {"MSFT_lod": {"ids": [1]}}},
        {"mesh": 1, "children": [2]}, {"mesh": 2, "scale": [2, 4, -3]},
    ]));
    f["meshes"][1]["extras"] = json!({"lod_error": 0.5, "lod_accuracy": 0.25});
    assert_eq!(measured(&good(&f)), [(None, accuracy_of(100)), (None, accuracy_of(70))]);
    f["meshes"][2]["extras"] = json!({"lod_error": 0.25, "lod_accuracy": 0.75});
    assert_eq!(measured(&good(&f)), [(Some(0.0), 1.0), (Some(1.0), 0.25)]);
}

#[test]
fn measures_that_cannot_be_are_refused() {
    for (key, values) in
        [("lod_error", json!([-1, "1", 1e300, []])), ("lod_accuracy", json!([-0.5, 1.5, true]))]
    {
        for value in values.as_array().expect("a list") {
            let mut f = chain_file(json!([{"mesh": 0}]));
            f["meshes"][0]["extras"] = json!({key: value});
            refused(&f, &format!("mesh 0: its extras.{key} must be"));
        }
    }
}

#[test]
fn siblings_named_by_level_are_one_object() {
    let f = chain_file(json!([
        {"name": "tree_LOD2", "mesh": 2},
        {"name": "tree_lod0", "mesh": 0},
        {"name": "bush_LOD1", "mesh": 1},
        {"name": "bush_LOD3", "mesh": 3},
        {"name": "tree", "mesh": 3, "children": [5]},
        {"name": "tree_LOD1", "mesh": 1},
        {"name": "alone_LOD4", "mesh": 3},
    ]));
    let expected = [(1, vec![100, 20]), (2, vec![50, 4]), (4, vec![4]), (5, vec![50]), (6, vec![4])];
    assert_eq!(chains(&good(&f)), expected);
}

#[test]
fn repeated_level_names_pair_up_in_order() {
    let node =
        |name: &str, mesh: usize, x: i32| json!({"name": name, "mesh": mesh, "translation": [x, 0, 0]});
    let f = chain_file(json!([
        node("t_LOD0", 0, 0),
        node("t_LOD1", 1, 0),
        node("t_LOD0", 0, 9),
        node("t_LOD1", 1, 9),
        node("t_LOD0", 0, 20),
    ]));
    let scene = good(&f);
    assert_eq!(chains(&scene), [(0, vec![100, 50]), (2, vec![100, 50]), (4, vec![100])]);
    assert_eq!(scene.objects[0].table, scene.objects[1].table);
}

#[test]
fn named_levels_may_be_groups_of_nodes() {
    let f = chain_file(json!([
        {"name": "house", "children": [1, 2]},
        {"name": "house_LOD0", "children": [3, 4]},
        {"name": "house_LOD1", "mesh": 2},
        {"name": "wall_LOD0", "mesh": 0},
        {"name": "roof_LOD0", "mesh": 1},
    ]));
    assert_eq!(chains(&good(&f)), [(1, vec![150, 20])]);
}

#[test]
fn meshes_named_by_level_lend_their_coarser_ones() {
    let mut f = chain_file(json!([{"name": "here", "mesh": 0}, {"name": "there", "mesh": 0}]));
    for (mesh, name) in ["x_LOD0", "x_LOD2", "x_lod3", "y_LOD1"].iter().enumerate() {
        f["meshes"][mesh]["name"] = json!(name);
    }
    let scene = good(&f);
    assert_eq!(chains(&scene), [(0, vec![100]), (1, vec![100])].map(|(id, _)| (id, vec![100, 50, 20])));
    assert_eq!((scene.tables.len(), scene.tables[0].name()), (1, "x_LOD0"));
    f["nodes"] = json!([{"mesh": 0}, {"mesh": 1}]);
    assert_eq!(chains(&good(&f)), [(0, vec![100, 50])], "nodes go by the names of their meshes");
}

#[test]
fn tables_of_equal_names_are_told_apart() {
    let mut f = chain_file(json!([{"mesh": 0}, {"mesh": 1}, {"mesh": 2}]));
    for mesh in 0..3 {
        f["meshes"][mesh]["name"] = json!("thing");
    }
    let scene = good(&f);
    let names: Vec<_> = scene.tables.iter().map(LodTable::name).collect();
    assert_eq!(names, ["thing", "thing #2", "thing #3"]);
    assert!(scene.to_json().is_ok());
}

#[test]
fn binary_files_are_read_without_looking_into_their_buffers() {
    let text = chain_file(json!([{"mesh": 0}])).to_string();
    let bytes = glb(&text, b"whatever");
    assert_eq!(
        Scene::from_gltf(&bytes, "a.gltf").map_err(|e| e.to_string()),
        read(&chain_file(json!([{"mesh": 0}])))
    );
    mangle::is_refused_when_cut(&bytes, Scene::from_gltf);
    mangle::is_refused_when_cut(text.as_bytes(), Scene::from_gltf);
    let with = |at: usize, value: u32| {
        let mut bytes = bytes.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        Scene::from_gltf(&bytes, "a.glb").expect_err("must be refused").to_string()
    };
    assert_eq!(with(4, 1), "a.glb: its GLB version must be 2, not 1");
    assert!(with(8, u32::MAX).contains("it is cut off: its header says 4294967295 bytes"));
    assert_eq!(with(8, 3), "a.glb: it is cut off within a chunk");
    assert_eq!(with(12, u32::MAX), "a.glb: it is cut off within a chunk");
    assert_eq!(with(16, 7), "a.glb: its first chunk must be JSON");
}

#[test]
fn text_may_come_from_windows_but_not_as_utf16() {
    let f = chain_file(json!([{"mesh": 0}]));
    let text = serde_json::to_string_pretty(&f).expect("text");
    let marked = Scene::from_gltf(&mangle::marked_crlf(&text), "a.gltf").map_err(|e| e.to_string());
    assert_eq!(marked, read(&f));
    assert!(Scene::from_gltf(&mangle::utf16(&text), "a.gltf").expect_err("UTF-16").rule.contains("UTF-16"));
    assert!(Scene::from_gltf(&[], "a.gltf").is_err());
}

/// Translation, rotation, scale.
type Transform = ([f32; 3], [f32; 4], [f32; 3]);

fn transforms() -> impl Strategy<Value = Transform> {
    let rotation =
        prop::array::uniform4(-1.0f32..1.0).prop_filter("a length", |q| Quat::from_array(*q).length() > 0.1);
    (prop::array::uniform3(-50.0f32..50.0), rotation, prop::array::uniform3(-3.0f32..3.0))
}

proptest! {
    /// The twin places every corner of the mesh's box by hand, one node of the chain after the other.
    #[test]
    fn bounds_hold_the_mesh_however_nodes_are_nested(chain in prop::collection::vec(transforms(), 1..6)) {
        let last = chain.len() - 1;
        let node = |(i, (t, q, s)): (usize, &Transform)| match i == last {
            true => json!({"translation": t, "rotation": q, "scale": s, "mesh": 0}),
            false => json!({"translation": t, "rotation": q, "scale": s, "children": [i + 1]}),
        };
        let scene = good(&chain_file(chain.iter().enumerate().map(node).collect()));
        let bounds = scene.objects[0].bounds;
        for corner in 0..8 {
            let sign = |axis: u32| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
            let placed = chain.iter().rev().fold(Vec3::new(sign(0), sign(1), sign(2)), |p, (t, q, s)| {
                Quat::from_array(*q).normalize() * (p * Vec3::from(*s)) + Vec3::from(*t)
            });
            let away = placed.distance(bounds.center);
            prop_assert!(away <= bounds.radius * 1.0001 + 1e-3, "{away} {bounds:?}");
        }
    }

    /// Sharing a table must not depend on where objects are, and ids are those of nodes.
    #[test]
    fn instances_share_a_table_wherever_they_are(places in prop::collection::vec(transforms(), 1..20)) {
        let node = |(t, q, s): &Transform| {
            let m = Mat4::from_scale_rotation_translation((*s).into(), Quat::from_array(*q).normalize(), (*t).into());
            json!({"matrix": m.to_cols_array(), "mesh": 0, "extensions": {"MSFT_lod": {"ids": []}}})
        };
        let scene = good(&chain_file(places.iter().map(node).collect()));
        prop_assert_eq!(scene.tables.len(), 1);
        let ids: Vec<_> = scene.objects.iter().map(|o| o.id).collect();
        prop_assert_eq!(ids, (0..places.len() as u64).map(ObjectId).collect::<Vec<_>>());
    }

    #[test]
    fn a_spoiled_file_is_refused_or_still_a_scene(edits in mangle::edits(), binary in any::<bool>()) {
        let text = chain_file(json!([
            {"mesh": 0, "name": "a", "translation": [1, 2, 3], "extensions": {"MSFT_lod": {"ids": [1]}},
             "extras": {"lod_max_distance": [50, 100]}},
            {"mesh": 1}, {"mesh": 2, "children": [3, 4]}, {"name": "b_LOD0", "mesh": 2}, {"name": "b_LOD1", "mesh": 3},
        ])).to_string();
        let bytes = if binary { glb(&text, b"") } else { text.into_bytes() };
        if let Ok(scene) = Scene::from_gltf(&mangle::spoiled(&bytes, &edits), "spoiled.glb") {
            prop_assert!(scene.to_objects().is_ok());
            prop_assert!(scene.to_json().is_ok());
        }
    }

    #[test]
    fn random_bytes_are_refused(mut bytes in prop::collection::vec(any::<u8>(), 0..400), magic in any::<bool>()) {
        if magic {
            bytes.splice(0..0, *b"glTF\x02\0\0\0");
        }
        prop_assert!(Scene::from_gltf(&bytes, "noise.glb").is_err());
    }
}
