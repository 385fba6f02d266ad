//! Scene JSON.

use glam::Vec3;
use lod_budget::bounds::Sphere;
use lod_budget::files::Scene;
use lod_budget::scene::{LevelRange, Object, ObjectId, Settings, TableId};
use lod_budget::table::{Level, LevelRecord, LodTable};
use proptest::prelude::*;

use crate::mangle;

const YARD: &str = r#"{
  "format": "lod-budget scene",
  "version": 1,
  "name": "yard",
  "tables": [
    {"name":"tree","center":[0.0,2.0,0.0],"radius":2.5,"levels":[
      {"triangles":1200,"vertices":700,"bytes":99,"error":0.0,"accuracy":0.9996},
      {"triangles":90,"vertices":60,"draws":2,"accuracy":0.994,"min_size":0.1}
    ]},
    {"name":"stone","radius":1.0,"levels":[
      {"triangles":12,"vertices":8,"accuracy":0.5}
    ]}
  ],
  "objects": [
    {"id":1,"table":"tree","center":[4.0,2.0,-9.0],"radius":2.5},
    {"id":18446744073709551615,"table":"stone","center":[0.1,0.0,1e-20],"radius":0.0,"importance":2.0,"clamp":[0,1],"forced":1,"resident":[1,1],"may_skip":true,"draw_distance":80.0,"hidden":true,"velocity":[0.0,1.0,0.0]}
  ]
}
"#;

fn read(text: &str) -> Result<Scene, String> {
    Scene::from_json(text.as_bytes(), "yard.json").map_err(|e| e.to_string())
}

#[test]
fn a_scene_is_read_as_described() {
    let scene = read(YARD).expect("a good scene");
    let tree = &scene.tables[0];
    assert_eq!((scene.name.as_str(), tree.name()), ("yard", "tree"));
    assert_eq!(tree.bounds(), Sphere::new(Vec3::new(0.0, 2.0, 0.0), 2.5));
    assert_eq!(scene.tables[1].bounds().center, Vec3::ZERO);
    assert_eq!((tree.levels()[0].bytes, tree.levels()[0].draws, tree.levels()[1].draws), (99, 1, 2));
    assert_eq!((tree.levels()[0].error, tree.levels()[1].error), (Some(0.0), None));
    assert_eq!(tree.levels()[1].min_size, Some(0.1));
    let [plain, odd] = scene.objects[..] else { panic!("two objects") };
    assert_eq!((plain.id, plain.table, plain.settings), (ObjectId(1), TableId(0), Settings::default()));
    assert_eq!((odd.id, odd.table), (ObjectId(u64::MAX), TableId(1)));
    let expected = Settings {
        importance: 2.0,
        clamp: LevelRange::new(0, 1),
        forced: Some(Level(1)),
        resident: LevelRange::new(1, 1),
        may_skip: true,
        draw_distance: 80.0,
        hidden: true,
        velocity: Vec3::Y,
        ..Settings::default()
    };
    assert_eq!(odd.settings, expected);
}

#[test]
fn what_is_written_is_what_the_format_describes() {
    assert_eq!(read(YARD).expect("a good scene").to_json().expect("it can be written"), YARD);
}

#[test]
fn a_scene_may_be_empty_and_without_a_name() {
    let text = r#"{"tables":[],"version":1,"objects":[],"format":"lod-budget scene"}"#;
    let scene = read(text).expect("nothing is a scene");
    assert_eq!((scene.name.as_str(), scene.objects.len()), ("yard", 0));
    let again = scene.to_json().expect("nothing can be written");
    assert_eq!(read(&again), Ok(scene));
}

/// The yard with `old` replaced, and what the error must say; " … " stands for anything.
#[track_caller]
fn refused(old: &str, new: &str, message: &str) {
    assert_eq!(YARD.matches(old).count(), 1, "'{old}' must be there once");
    let error = read(&YARD.replace(old, new)).expect_err("must be refused");
    assert!(error.starts_with("yard.json: "), "{error}");
    assert!(message.split(" … ").all(|part| error.contains(part)), "{error}");
}

#[test]
fn errors_name_the_object_and_the_rule() {
    refused("\"id\":1,", "\"id\":18446744073709551615,", "object 18446744073709551615: the id is in use");
    refused(
        "\"id\":1,",
        "\"id\":-1,",
        "object at position 0 (line 15, column … ): invalid value: integer `-1`",
    );
    refused(
        "\"id\":1,",
        "\"id\":1,\"id\":1,",
        "object at position 0 (line 15, column … ): duplicate field `id`",
    );
    refused("\"id\":1,", "\"id\":1,\"colour\":3,", "unknown field `colour`");
    refused("\"id\":1,", "", "object at position 0 (line 15, column … ): missing field `id`");
    refused(
        "\"id\":1,\"table\":\"tree\"",
        "\"id\":1,\"table\":\"oak\"",
        "object 1: its table 'oak' is unknown",
    );
    refused(
        "\"importance\":2.0",
        "\"importance\":-2.0",
        "object 18446744073709551615: importance must be finite",
    );
    refused("\"draw_distance\":80.0", "\"draw_distance\":1e39", "object at position 1 (line 16");
    refused("\"forced\":1,", "\"forced\":255,", "object 18446744073709551615: a forced level must be drawn");
    refused("\"forced\":1,", "\"forced\":256,", "object at position 1");
    refused("\"clamp\":[0,1]", "\"clamp\":[2,1]", "a range of levels must go from a finer level");
    refused("\"clamp\":[0,1]", "\"clamp\":[0,1,2]", "object at position 1");
    refused("\"may_skip\":true", "\"may_skip\":1", "object at position 1");
    refused(
        "[4.0,2.0,-9.0],\"radius\":2.5",
        "[4.0,2.0,-9.0],\"radius\":-2.5",
        "object 1: center and radius must be",
    );
    refused("[4.0,2.0,-9.0]", "[4.0,2.0,NaN]", "yard.json: line 15, column 46: expected value");
    refused("[4.0,2.0,-9.0]", "[4.0,2.0,1e999]", "number out of range");
    refused("[4.0,2.0,-9.0]", "[4.0,2.0,-1e39]", "object at position 0");
    refused("[4.0,2.0,-9.0]", "[4.0,2.0]", "object at position 0 (line 15, column … ): invalid length 2");
}

#[test]
fn errors_name_the_table_and_the_level() {
    refused(
        "\"stone\",\"radius\"",
        "\"tree\",\"radius\"",
        "table 'tree': there must be no other table of that name",
    );
    refused(
        "\"radius\":1.0",
        "\"radius\":0",
        "table 'stone': its bound must be finite and have a positive radius",
    );
    refused(
        "\"radius\":1.0",
        "\"radius\":\"1\"",
        "table at position 1 (line 10, column … ): invalid type: string",
    );
    refused("0.994", "1.01", "table 'tree', level 1: accuracy must be between 0 and 1");
    refused(
        "\"error\":0.0",
        "\"error\":-0.5",
        "table 'tree', level 0: error must be finite and not negative",
    );
    refused("\"triangles\":90", "\"triangles\":-90", "table at position 0, level at position 1 (line 8");
    refused("\"triangles\":90", "\"triangles\":4294967296", "table at position 0, level at position 1");
    refused("\"triangles\":90", "\"triangles\":90.5", "table at position 0, level at position 1");
    refused("\"min_size\":0.1", "\"min_size\":-1", "table 'tree', level 1: min_size must be finite");
    refused("\"draws\":2", "\"draw_calls\":2", "unknown field `draw_calls`");
    let levels = r#"{"triangles":12,"vertices":8,"accuracy":0.5}"#;
    refused(levels, "", "table 'stone': it must have at least one level");
    refused(levels, &vec![levels; 256].join(","), "table 'stone': it must have at most 254 levels");
}

#[test]
fn files_of_another_kind_are_told_so() {
    refused("lod-budget scene", "glTF", "its \"format\" must be \"lod-budget scene\", not \"glTF\"");
    refused("\"version\": 1", "\"version\": 2", "its \"version\" must be 1, not 2");
    refused("\"version\": 1", "\"version\": \"1\"", "invalid type: string \"1\", expected u64");
    refused("  \"version\": 1,\n", "", "missing field `version`");
    refused("\"name\": \"yard\"", "\"title\": \"yard\"", "unknown field `title`");
    for other in ["", "[]", "null", "7", "{}", "\0", "{\"format\":", "ceci n'est pas un JSON"] {
        assert!(read(other).is_err(), "{other}");
    }
    assert!(read(&format!("{YARD}{YARD}")).expect_err("two scenes").contains("trailing characters"));
}

#[test]
fn nesting_has_no_depth_that_crashes() {
    let deep = "[".repeat(200_000);
    assert!(read(&deep).is_err());
    refused("\"id\":1,", &format!("\"id\":{deep},"), "yard.json");
    let closed = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    refused(
        "\"name\": \"yard\"",
        &format!("\"name\": {closed}"),
        "invalid type: sequence, expected a string",
    );
}

#[test]
fn a_list_of_another_kind_is_refused_at_its_first_entry() {
    let numbers = vec!["0"; 1_000_000].join(",");
    refused("\"objects\": [", &format!("\"objects\": [{numbers},"), "object at position 0");
}

#[test]
fn text_may_come_from_windows_but_not_as_utf16() {
    let plain = read(YARD);
    let marked = Scene::from_json(&mangle::marked_crlf(YARD), "yard.json").map_err(|e| e.to_string());
    assert_eq!(marked, plain);
    let error = Scene::from_json(&mangle::utf16(YARD), "yard.json").expect_err("UTF-16");
    assert_eq!(error.to_string(), "yard.json: it must be UTF-8, and starts with the mark of UTF-16");
}

#[test]
fn a_scene_that_is_cut_off_is_refused_wherever_it_ends() {
    mangle::is_refused_when_cut(YARD.trim_end().as_bytes(), Scene::from_json);
}

#[test]
fn what_the_format_cannot_hold_is_not_written() {
    let good = read(YARD).expect("a good scene");
    let mut twice = good.clone();
    twice.tables[1] = twice.tables[0].clone();
    assert_eq!(
        twice.to_json().expect_err("a name twice").to_string(),
        "yard: table 'tree': there must be no other table of that name"
    );
    let mut nowhere = good.clone();
    nowhere.objects[0].bounds.center.x = f32::NAN;
    assert!(
        nowhere.to_json().expect_err("no place").to_string().starts_with("yard: object 1: center and radius")
    );
    let mut lost = good;
    lost.objects[0].table = TableId(2);
    assert_eq!(lost.to_json().expect_err("no table").to_string(), "yard: object 1: its table is unknown");
}

#[test]
fn a_scene_survives_the_disk_and_a_refused_one_leaves_the_old_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("Yard.JSON");
    let mut scene = read(YARD).expect("a good scene");
    scene.write(&path).expect("it can be written");
    assert_eq!(Scene::read(&path).as_ref(), Ok(&scene));
    scene.objects[0].bounds.radius = f32::INFINITY;
    assert_eq!(scene.write(&path).expect_err("no size").file, path.display().to_string());
    assert_eq!(std::fs::read_to_string(&path).expect("the old file"), YARD);
    assert!(
        Scene::read(&folder.path().join("none.json")).expect_err("no file").rule.contains("cannot be read")
    );
    let error = Scene::read(&folder.path().join("yard.obj")).expect_err("no scene");
    assert!(error.rule.contains(".json, .glb or .gltf"));
}

fn numbers() -> impl Strategy<Value = f32> {
    any::<f32>().prop_filter("finite", |x| x.is_finite())
}

fn sizes() -> impl Strategy<Value = f32> {
    numbers().prop_map(f32::abs)
}

fn factors() -> impl Strategy<Value = f32> {
    prop_oneof![Just(1.0), sizes().prop_filter("positive", |x| *x > 0.0)]
}

fn points() -> impl Strategy<Value = Vec3> {
    prop_oneof![Just(Vec3::ZERO), prop::array::uniform3(numbers()).prop_map(Vec3::from)]
}

fn levels() -> impl Strategy<Value = LevelRecord> {
    let counts = (any::<u32>(), any::<u32>(), prop_oneof![Just(1), any::<u32>()], any::<u64>());
    (counts, prop::option::of(sizes()), 0.0f32..=1.0, prop::option::of(sizes())).prop_map(
        |((triangles, vertices, draws, bytes), error, accuracy, min_size)| LevelRecord {
            triangles,
            vertices,
            draws,
            bytes,
            error,
            accuracy,
            min_size,
        },
    )
}

fn tables() -> impl Strategy<Value = Vec<LodTable>> {
    let table = (any::<String>(), points(), factors(), prop::collection::vec(levels(), 1..5));
    let named = |(i, (name, center, radius, levels)): (usize, (String, Vec3, f32, Vec<LevelRecord>))| {
        LodTable::new(format!("{name}{i}"), Sphere::new(center, radius), levels).expect("a good table")
    };
    prop::collection::vec(table, 1..4).prop_map(move |all| all.into_iter().enumerate().map(named).collect())
}

fn ranges() -> impl Strategy<Value = LevelRange> {
    let some = (0u8..255, 0u8..255).prop_map(|(a, b)| LevelRange::new(a.min(b), a.max(b)));
    prop_oneof![Just(LevelRange::ALL), some]
}

fn settings() -> impl Strategy<Value = Settings> {
    // Importance times bias squared has a limit, and so has the cost multiplier.
    let gains = (prop_oneof![Just(1.0), 0.0f32..1e6], prop_oneof![Just(1.0), 1e-6f32..1e3]);
    let factors = gains.prop_flat_map(|(importance, bias)| (Just(importance), Just(bias), 1e-6f32..1e6));
    let levels = (ranges(), prop::option::of((0u8..255).prop_map(Level)), ranges());
    let rest = (any::<bool>(), prop_oneof![Just(f32::INFINITY), sizes()], any::<bool>(), points());
    (factors, levels, rest).prop_map(
        |(
            (importance, bias, cost_multiplier),
            (clamp, forced, resident),
            (may_skip, draw_distance, hidden, velocity),
        )| Settings {
            importance,
            bias,
            cost_multiplier,
            clamp,
            forced,
            resident,
            may_skip,
            draw_distance,
            hidden,
            velocity,
        },
    )
}

fn scenes() -> impl Strategy<Value = Scene> {
    let object = (any::<u64>(), points(), sizes(), any::<prop::sample::Index>(), settings());
    let objects = prop::collection::btree_map(any::<u64>(), object, 0..6);
    (any::<String>(), tables(), objects).prop_map(|(name, tables, objects)| {
        let objects = objects.into_iter().map(|(id, (_, center, radius, table, settings))| {
            let table = TableId(table.index(tables.len()) as u16);
            Object { settings, ..Object::new(id, Sphere::new(center, radius), table) }
        });
        Scene { objects: objects.collect(), name, tables }
    })
}

proptest! {
    #[test]
    fn a_scene_reads_back_as_it_was_written(scene in scenes()) {
        let text = scene.to_json().expect("it can be written");
        let again = Scene::from_json(text.as_bytes(), "again.json").expect("it can be read");
        prop_assert_eq!(&again, &scene);
        prop_assert_eq!(again.to_json().expect("again"), text);
    }

    #[test]
    fn a_spoiled_scene_is_refused_or_still_a_scene(edits in mangle::edits()) {
        if let Ok(scene) = Scene::from_json(&mangle::spoiled(YARD.as_bytes(), &edits), "spoiled.json") {
            prop_assert!(scene.to_objects().is_ok());
            let text = scene.to_json().expect("what was read can be written");
            prop_assert_eq!(Scene::from_json(text.as_bytes(), "again.json"), Ok(scene));
        }
    }

    #[test]
    fn random_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(Scene::from_json(&bytes, "noise.json").is_err());
    }
}
