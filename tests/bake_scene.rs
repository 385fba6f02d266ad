//! Scenes with levels: what was in the file stays, what is new is found by readers, chunks fit.
#![cfg(feature = "bake")]

use lod_budget::bake::chain::{Chain, ChainLevel, Limits, Plan, quietly};
use lod_budget::bake::deviation;
use lod_budget::bake::read::gltf::read_meshes;
use lod_budget::bake::scene::{Chunks, Options, Part, Scene};
use lod_budget::bake::shapes::{icosphere, terrain, torus_knot};
use lod_budget::bake::split::{self, open_edges};
use lod_budget::bake::write::{LevelOut, Measured};
use lod_budget::bake::{Mesh, Surface};
use serde_json::{Value, json};

/// A file in the making: meshes of one primitive each with a buffer view and an accessor for positions and indices.
struct File {
    root: Value,
    bytes: Vec<u8>,
}

impl File {
    fn new(nodes: Value) -> Self {
        let lists = json!({"asset": {"version": "2.0"}, "scene": 0, "materials": [{"name": "stone"}], "nodes": nodes,
            "meshes": [], "accessors": [], "bufferViews": [], "extras": {"kept": [1, 2.5, "x"]}});
        let mut file = Self { root: lists, bytes: Vec::new() };
        let children: Vec<&Value> =
            file.nodes().iter().filter_map(|n| n["children"].as_array()).flatten().collect();
        let is_root = |i: &usize| !children.contains(&&json!(i)) && file.nodes()[*i]["name"] != "level";
        let roots: Vec<usize> = (0..file.nodes().len()).filter(is_root).collect();
        file.root["scenes"] = json!([{ "nodes": roots }]);
        file
    }

    fn nodes(&self) -> &[Value] {
        self.root["nodes"].as_array().expect("a list")
    }

    fn with(mut self, name: &str, surface: &Surface) -> Self {
        let positions =
            surface.positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
        let indices = surface.triangles.as_flattened().iter().flat_map(|i| i.to_le_bytes()).collect();
        let bounds = Mesh::from(surface.clone()).bounds();
        let position = self.column(
            positions,
            json!({"componentType": 5126, "type": "VEC3", "count": surface.positions.len(),
            "min": bounds.min.to_array(), "max": bounds.max.to_array()}),
        );
        let index = self.column(
            indices,
            json!({"componentType": 5125, "type": "SCALAR", "count": 3 * surface.triangles.len()}),
        );
        let flat = surface.positions.iter().flat_map(|p| [p.x, p.y]).flat_map(f32::to_le_bytes).collect();
        let uv = self
            .column(flat, json!({"componentType": 5126, "type": "VEC2", "count": surface.positions.len()}));
        let primitive = json!({"attributes": {"POSITION": position, "TEXCOORD_0": uv}, "indices": index, "material": 0,
            "extras": {"side": "both"}});
        let primitive =
            if name.starts_with("uv") { primitive } else { without(primitive, "/attributes", "TEXCOORD_0") };
        self.push("meshes", json!({"name": name, "primitives": [primitive]}));
        self
    }

    fn column(&mut self, bytes: Vec<u8>, mut accessor: Value) -> usize {
        let view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        self.bytes.extend(bytes);
        accessor["bufferView"] = json!(self.push("bufferViews", view));
        self.push("accessors", accessor)
    }

    fn push(&mut self, list: &str, entry: Value) -> usize {
        let list = self.root[list].as_array_mut().expect("a list");
        list.push(entry);
        list.len() - 1
    }

    /// As GLB.
    fn glb(mut self) -> Vec<u8> {
        self.root["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        let mut text = self.root.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let chunk = |kind: &[u8], bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes(), kind, bytes].concat();
        let chunks = [chunk(b"JSON", &text), chunk(b"BIN\0", &self.bytes)].concat();
        [&b"glTF\x02\0\0\0"[..], &(chunks.len() as u32 + 12).to_le_bytes(), &chunks].concat()
    }
}

fn without(mut value: Value, of: &str, member: &str) -> Value {
    if let Some(members) = value.pointer_mut(of).and_then(Value::as_object_mut) {
        members.remove(member);
    }
    value
}

/// The JSON and the bytes of a GLB.
fn parts(glb: &[u8]) -> (Value, &[u8]) {
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    (serde_json::from_slice(&glb[20..20 + length]).expect("JSON"), &glb[28 + length..])
}

fn open<'a>(glb: &'a [u8], options: &Options) -> Scene<'a> {
    Scene::open(glb, "town.glb", None, options).unwrap_or_else(|e| panic!("{e}"))
}

/// Measures no closer than it has to, and goes on however far a level is off.
fn plan() -> Plan {
    let measure =
        deviation::Options { relative: 0.5, rms_error: 0.1, max_samples: 1 << 10, ..Plan::default().measure };
    let limits = Limits { most_error: None, ..Limits::default() };
    Plan { measure, limits, look: None, ..Plan::default() }
}

fn chains(scene: &Scene<'_>) -> Vec<Chain> {
    let plan = plan();
    let bake = |part: &Part| part.bake(&plan, &mut quietly);
    scene.parts().iter().map(|part| bake(part).unwrap_or_else(|e| panic!("{}: {e}", part.name))).collect()
}

/// What is written of them: with coverages and accuracies by number.
fn levels(chains: &[Chain]) -> Vec<Vec<LevelOut<'_>>> {
    chains
        .iter()
        .map(|chain| chain.levels.iter().enumerate().map(|(i, level)| level_out(i, level)).collect())
        .collect()
}

fn level_out(i: usize, level: &ChainLevel) -> LevelOut<'_> {
    let (hausdorff, rms) = (level.deviation.hausdorff, level.deviation.rms());
    LevelOut {
        measured: Some(Measured { error: level.error, hausdorff, rms }),
        coverage: Some(0.5 / (1 << i) as f32),
        accuracy: Some(1.0 - i as f32 / 64.0),
        ..LevelOut::new(&level.mesh)
    }
}

/// The scene with default levels.
fn baked(glb: &[u8], options: &Options) -> Vec<u8> {
    let scene = open(glb, options);
    let chains = chains(&scene);
    scene.write(&levels(&chains), &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// A village: two balls and a knot, the knot below a node that turns.
fn village() -> Vec<u8> {
    File::new(json!([
        {"name": "ball", "mesh": 0, "translation": [3, 0, 0], "extras": {"tag": 7}},
        {"name": "ball", "mesh": 0, "matrix": [2,0,0,0, 0,2,0,0, 0,0,2,0, 0,5,0,1]},
        {"name": "turn", "children": [3], "rotation": [0, 1, 0, 0]},
        {"name": "knot", "mesh": 1, "extras": {"lod_max_distance": [80.0]}},
    ]))
    .with("uvball", &icosphere(6))
    .with("knot", &torus_knot(60, 10))
    .glb()
}

fn list<'a>(root: &'a Value, name: &str) -> &'a [Value] {
    root[name].as_array().map_or(&[], Vec::as_slice)
}

#[test]
fn what_is_in_the_file_stays_there() {
    let before = village();
    let after = baked(&before, &Options::default());
    let ((old, old_bytes), (new, new_bytes)) = (parts(&before), parts(&after));
    assert!(new_bytes.starts_with(old_bytes));
    for name in ["accessors", "bufferViews", "meshes", "materials", "scenes"] {
        assert_eq!(list(&new, name)[..list(&old, name).len()], *list(&old, name), "{name}");
    }
    assert_eq!(
        (&new["extras"], &new["asset"], &new["scene"]),
        (&old["extras"], &old["asset"], &old["scene"])
    );
    for (i, old) in list(&old, "nodes").iter().enumerate() {
        let bare = without(new["nodes"][i].clone(), "/extras", "MSFT_screencoverage");
        let bare = without(bare, "/extensions", "MSFT_lod");
        for member in old.as_object().expect("a node").keys().filter(|&member| member != "extras") {
            assert_eq!(bare[member], old[member], "node {i}, {member}");
        }
    }
    assert_eq!(new["nodes"][0]["extras"]["tag"], 7);
    assert_eq!(new["extensionsUsed"], json!(["MSFT_lod"]));
}

#[test]
fn instances_share_levels_and_levels_are_placed_alike() {
    let after = baked(&village(), &Options::default());
    let (root, _) = parts(&after);
    let node = |i: usize| &root["nodes"][i];
    let levels_of = |i: usize| -> Vec<usize> {
        let ids = node(i)["extensions"]["MSFT_lod"]["ids"].as_array().expect("levels");
        ids.iter().map(|id| id.as_u64().expect("an index") as usize).collect()
    };
    let meshes = |i: usize| -> Vec<&Value> { levels_of(i).into_iter().map(|n| &node(n)["mesh"]).collect() };
    assert_eq!(meshes(0), meshes(1));
    for (i, level) in levels_of(1).into_iter().enumerate() {
        assert_eq!(node(level)["matrix"], node(1)["matrix"]);
        assert_eq!(node(level)["name"], format!("ball_LOD{}", i + 1));
    }
    let coarse = &root["meshes"][node(levels_of(0)[0])["mesh"].as_u64().expect("a mesh") as usize];
    assert_eq!(coarse["name"], "uvball_LOD1");
    assert_eq!(coarse["primitives"][0]["material"], 0);
    assert_eq!(coarse["primitives"][0]["extras"], json!({"side": "both"}));
    assert!(coarse["extras"]["lod_error"].as_f64().is_some_and(|error| error > 0.0));
    let count = levels_of(3).len() + 1;
    assert_eq!(node(3)["extras"]["lod_max_distance"], json!(vec![80.0; count]));
    let read = read_meshes(&after, "a.glb", None).expect("good meshes");
    let uv_sets: Vec<usize> = read.iter().map(|file| file.mesh.uvs.len()).collect();
    assert!(
        read.iter().zip(uv_sets).all(|(file, sets)| sets == usize::from(file.mesh.name.starts_with("uv")))
    );
}

#[cfg(feature = "files")]
#[test]
fn the_runtime_sees_the_same_objects_with_measured_levels() {
    let before = village();
    let read =
        |glb: &[u8]| lod_budget::files::Scene::from_gltf(glb, "a.glb").unwrap_or_else(|e| panic!("{e}"));
    let (old, new) = (read(&before), read(&baked(&before, &Options::default())));
    let ids = |scene: &lod_budget::files::Scene| scene.objects.iter().map(|o| o.id.0).collect::<Vec<_>>();
    assert_eq!((ids(&old), ids(&new)), (vec![0, 1, 3], vec![0, 1, 3]));
    assert_eq!(new.tables.len(), 2);
    for table in &new.tables {
        assert!(table.levels().len() > 3);
        for (i, level) in table.levels().iter().enumerate() {
            assert_eq!(level.accuracy, 1.0 - i as f32 / 64.0);
            assert_eq!(level.error.map(|error| error > 0.0), Some(i > 0), "{} {i}", table.name());
        }
    }
    for (old, new) in old.objects.iter().zip(&new.objects) {
        assert!((old.bounds.center - new.bounds.center).length() < 0.05 * old.bounds.radius);
        assert!(old.settings.draw_distance == new.settings.draw_distance);
    }
}

#[test]
fn what_has_levels_or_moves_or_is_no_surface_is_left_alone() {
    let mut file = File::new(json!([
        {"name": "skinned", "mesh": 0, "skin": 0},
        {"name": "morphed", "mesh": 1},
        {"name": "dots", "mesh": 2},
        {"name": "tiny", "mesh": 3},
        {"name": "head", "mesh": 0, "extensions": {"MSFT_lod": {"ids": [5]}}},
        {"name": "level", "mesh": 4},
        {"name": "tree_LOD0", "mesh": 0},
        {"name": "tree_LOD1", "mesh": 4},
        {"name": "many", "mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {}}},
    ]))
    .with("ball", &icosphere(4))
    .with("face", &icosphere(4))
    .with("cloud", &icosphere(4))
    .with("leaf", &terrain(1, 1))
    .with("rough", &icosphere(2));
    file.root["meshes"][1]["primitives"][0]["targets"] = json!([{"POSITION": 2}]);
    file.root["meshes"][2]["primitives"][0]["mode"] = json!(0);
    let glb = file.glb();
    let scene = open(&glb, &Options::default());
    assert_eq!(scene.parts().len(), 0);
    let left: Vec<String> =
        scene.left().iter().map(|left| format!("{}: {}", left.place, left.reason)).collect();
    assert_eq!(
        left,
        [
            "node 0 'skinned', mesh 0 'ball': it is moved by a skin",
            "node 8 'many', mesh 0 'ball': it is drawn by EXT_mesh_gpu_instancing",
            "node 1 'morphed', mesh 1 'face': it has morph targets",
            "node 2 'dots', mesh 2 'cloud': it has points or lines",
            "node 3 'tiny', mesh 3 'leaf': it has hardly any triangles",
        ]
    );
    let (old, new) = (parts(&glb).0, scene.write(&[], &[]).expect("written"));
    let new = parts(&new).0;
    assert!(["nodes", "meshes", "accessors"].iter().all(|list| new[list] == old[list]));
}

/// Level 0 of a node is all that is below it, and moves with it: what else it has must not go with a coarser level.
#[test]
fn a_node_with_more_than_a_mesh_hands_it_down() {
    let mut file = File::new(json!([
        {"name": "arm", "mesh": 0, "children": [1], "extras": {"lod_max_distance": [9], "tag": 1}},
        {"name": "hand", "mesh": 0, "translation": [4, 0, 0]},
        {"name": "flag", "mesh": 0},
    ]))
    .with("ball", &icosphere(5));
    file.root["animations"] =
        json!([{"channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}}], "samplers": []}]);
    let after = baked(&file.glb(), &Options::default());
    let (root, _) = parts(&after);
    let node = |i: usize| &root["nodes"][i];
    for i in [0, 2] {
        assert!(node(i).get("mesh").is_none() && node(i)["extensions"].get("MSFT_lod").is_none());
        let child =
            node(i)["children"].as_array().and_then(|all| all.last()?.as_u64()).expect("a child") as usize;
        assert_eq!((&node(child)["mesh"], &node(child)["name"]), (&json!(0), &node(i)["name"]));
        assert!(node(child)["extensions"]["MSFT_lod"]["ids"].is_array());
    }
    assert_eq!(node(0)["children"][0], 1);
    assert_eq!(node(0)["extras"], json!({"tag": 1}));
    assert_eq!(node(1)["mesh"], 0);
    assert!(node(1)["extensions"]["MSFT_lod"]["ids"].is_array());
}

/// A closed track among many small things.
fn race() -> Vec<u8> {
    let rocks = (0..12)
        .map(|i| json!({"name": "rock", "mesh": 1, "translation": [i, 0, 0], "scale": [0.05, 0.05, 0.05]}));
    let track = json!({"name": "track", "mesh": 0, "translation": [0, -3, 0], "extras": {"lod_max_distance": [70], "a": 1}});
    File::new(std::iter::once(track).chain(rocks).collect())
        .with("track", &torus_knot(250, 8))
        .with("rock", &icosphere(3))
        .glb()
}

fn small_chunks() -> split::Options {
    split::Options { triangles: 500, share: 0.0 }
}

#[test]
fn what_is_much_larger_than_its_neighbours_becomes_chunks_that_fit_at_every_mix() {
    let options = Options { chunks: Chunks::Large(small_chunks()), ..Options::default() };
    let after = baked(&race(), &options);
    let (root, _) = parts(&after);
    let track = &root["nodes"][0];
    assert!(track.get("mesh").is_none());
    assert_eq!((&track["extras"], &track["translation"]), (&json!({"a": 1}), &json!([0, -3, 0])));
    let chunks: Vec<&Value> = list(track, "children")
        .iter()
        .map(|i| &root["nodes"][i.as_u64().expect("an index") as usize])
        .collect();
    assert_eq!(chunks.len(), 8);
    let meshes = read_meshes(&after, "race.glb", None).expect("good meshes");
    let mesh_of = |node: &Value| &meshes[node["mesh"].as_u64().expect("a mesh") as usize].mesh;
    let chain_of = |chunk: &Value| -> Vec<&Mesh> {
        let ids = chunk["extensions"]["MSFT_lod"]["ids"].as_array().expect("levels");
        let coarser = ids.iter().map(|i| mesh_of(&root["nodes"][i.as_u64().expect("an index") as usize]));
        std::iter::once(mesh_of(chunk)).chain(coarser).collect()
    };
    let chains: Vec<Vec<&Mesh>> = chunks.iter().map(|chunk| chain_of(chunk)).collect();
    let lengths: Vec<usize> = chains.iter().map(Vec::len).collect();
    assert!(lengths.iter().all(|&levels| levels > 2), "{lengths:?}");
    for mix in 0..200_usize {
        let pick = |i: usize, levels: usize| (mix >> i ^ mix.wrapping_mul(i * i + 7)) % levels;
        let levels: Vec<&Mesh> =
            chains.iter().enumerate().map(|(i, chain)| chain[pick(i, chain.len())]).collect();
        assert!(open_edges(&levels).is_empty(), "mix {mix}");
    }
    for chunk in chunks {
        assert_eq!(list(&chunk["extras"], "lod_max_distance").len(), chain_of(chunk).len());
    }
}

#[test]
fn chunks_are_as_asked_for() {
    let glb = race();
    let chunks = |chunks| {
        open(&glb, &Options { chunks, ..Options::default() }).parts().iter().filter(|p| p.is_chunk).count()
    };
    assert_eq!(chunks(Chunks::Never), 0);
    assert_eq!(chunks(Options::default().chunks), 0, "4000 triangles are less than one chunk");
    assert_eq!(
        chunks(Chunks::All(split::Options { triangles: 90, share: 0.0 })),
        4000_usize.div_ceil(90) + 2
    );
}

#[test]
fn levels_that_are_none_of_the_scene_are_refused() {
    let glb = race();
    let options = Options { chunks: Chunks::Large(small_chunks()), ..Options::default() };
    let refusal = |spoil: &dyn Fn(&mut Vec<Chain>)| {
        let scene = open(&glb, &options);
        let mut chains = chains(&scene);
        spoil(&mut chains);
        scene.write(&levels(&chains), &[]).expect_err("refused").to_string()
    };
    assert_eq!(
        refusal(&|chains| chains.truncate(2)),
        "town.glb: there must be levels for each of 9 parts, not 2"
    );
    let strange = refusal(&|chains| chains[8].levels[1].mesh.groups[0].name = "7".into());
    assert_eq!(strange, "town.glb: level 1 of rock: its group '7' must be one of the part's");
    let torn = refusal(&|chains| {
        let mesh = &chains[0].levels[0].mesh;
        let coarse = plan().bake(mesh, &mut quietly).expect("a chain").levels.remove(2);
        chains[0].levels[2] = coarse;
    });
    assert!(torn.starts_with("town.glb: level 2 of track_chunk0: it must have the edge from ["), "{torn}");
}

#[test]
fn chains_of_the_author_are_measured_and_stay() {
    let file = File::new(json!([
        {"name": "a", "mesh": 0, "extensions": {"MSFT_lod": {"ids": [2]}}},
        {"name": "b", "mesh": 0, "translation": [9, 0, 0], "extensions": {"MSFT_lod": {"ids": [3]}}},
        {"name": "level", "mesh": 1},
        {"name": "level", "mesh": 1, "translation": [9, 0, 0]},
    ]));
    let glb = file.with("ball", &icosphere(6)).with("rough", &icosphere(2)).glb();
    let scene = open(&glb, &Options::default());
    let [authored] = scene.authored() else { panic!("one chain, not {}", scene.authored().len()) };
    assert_eq!((authored.instances, authored.levels.len(), authored.name.as_str()), (2, 2, "ball"));
    let chain = [Chain::of_levels(authored.levels.clone(), &plan().measure).expect("measured")];
    let error = chain[0].levels[1].error;
    assert!((0.05..0.2).contains(&error), "an icosphere of 80 triangles is {error} off");
    let written = scene.write(&[], &levels(&chain)).expect("written");
    let (old, new) = (parts(&glb).0, parts(&written).0);
    assert_eq!(new["meshes"][1]["extras"]["lod_error"], f64::from(error));
    assert_eq!((&new["nodes"], &new["meshes"][0]), (&old["nodes"], &old["meshes"][0]));
}

#[test]
fn buffers_and_images_beside_the_file_are_taken_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = File::new(json!([{"mesh": 0}, {"mesh": 0}])).with("ball", &icosphere(5));
    let (mut root, bytes) = (file.root, file.bytes);
    root["buffers"] =
        json!([{"uri": "empty.bin", "byteLength": 5}, {"uri": "ball.bin", "byteLength": bytes.len()}]);
    root["bufferViews"].as_array_mut().expect("views").iter_mut().for_each(|view| view["buffer"] = json!(1));
    let png = b"\x89PNG\r\n\x1a\nand so on";
    root["images"] = json!([{"uri": "bark.png"}, {"uri": "lost.png"}]);
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("written");
    put("empty.bin", b"12345");
    put("ball.bin", &bytes);
    put("bark.png", png);
    let text = root.to_string();
    let scene =
        Scene::open(text.as_bytes(), "a.gltf", Some(folder.path()), &Options::default()).expect("read");
    let chains = chains(&scene);
    let written = scene.write(&levels(&chains), &[]).expect("written");
    let (new, blob) = parts(&written);
    let meshes = read_meshes(&written, "a.glb", None).expect("good meshes");
    assert_eq!(meshes[0].mesh.triangles.len(), 500);
    assert_eq!(new["images"][1], json!({"uri": "lost.png"}));
    let view = &new["bufferViews"][new["images"][0]["bufferView"].as_u64().expect("a view") as usize];
    let start = view["byteOffset"].as_u64().expect("an offset") as usize;
    assert_eq!(&blob[start..start + png.len()], png);
}

#[test]
fn the_same_scene_is_baked_alike() {
    let options = Options { chunks: Chunks::Large(small_chunks()), ..Options::default() };
    assert_eq!(baked(&race(), &options), baked(&race(), &options));
}

#[test]
fn what_is_broken_is_named() {
    let refusal = |spoil: &dyn Fn(&mut File)| {
        let mut file = File::new(json!([{"name": "a", "mesh": 0}])).with("ball", &icosphere(2));
        spoil(&mut file);
        let glb = file.glb();
        Scene::open(&glb, "town.glb", None, &Options::default()).err().expect("refused").to_string()
    };
    assert_eq!(
        refusal(&|f| f.root["nodes"][0]["mesh"] = json!(4)),
        "town.glb: node 0 'a': its mesh 4 is unknown"
    );
    let cut = refusal(&|f| f.root["accessors"][1]["count"] = json!(900));
    assert!(cut.starts_with("town.glb: mesh 0 \"ball\", primitive 0: accessor 1: its 900 rows"), "{cut}");
    assert!(Scene::open(b"{", "town.gltf", None, &Options::default()).is_err());
}

#[cfg(feature = "cli")]
#[test]
fn lod_bake_makes_a_scene_that_lod_compare_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("written");
    put("race.glb", &race());
    let turn = |t: f32| format!("{t},{},{},2,0,0,0,1\n", t.sin(), t.cos());
    let path: String = (0..5).map(|i| turn(0.1 * i as f32)).collect();
    put("race.csv", format!("time_s,x,y,z,qx,qy,qz,qw\n{path}").as_bytes());
    let run = |line: &str| -> Value {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_lod"));
        let output = command.current_dir(folder.path()).args(line.split(' ')).output().expect("it runs");
        assert!(output.status.success(), "lod {line}: {}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("JSON")
    };
    let baked = run("bake race.glb --split 500 --out lods --json");
    let scene = &baked["scenes"][0];
    assert_eq!((&scene["chains"], &scene["chunks"], &scene["nodes"]), (&json!(9), &json!(8), &json!(12)));
    assert_eq!(list(&baked, "meshes").len(), 9);
    assert!(list(&baked, "meshes").iter().all(|mesh| mesh["scene_file"] == scene["scene_file"]));
    let file = scene["scene_file"].as_str().expect("a file");
    let compared = run(&format!("compare {file} --policies coarsest,predictive --json"));
    assert!(compared.is_object());
    let whole = run("bake race.glb --no-split --out whole --json");
    assert_eq!((&whole["scenes"][0]["chunks"], list(&whole, "meshes").len()), (&json!(0), 2));
    let joined = run("bake race.glb --one-mesh --out joined --json");
    assert_eq!((list(&joined, "scenes").len(), list(&joined, "meshes").len()), (0, 1));
}
