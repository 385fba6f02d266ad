//! What is said of files.

use lod_budget::files::inspect::{InstanceInspection, inspect_json};
use lod_budget::files::{Inspection, inspect};

const SCENE: &str = r#"{"format":"lod-budget scene","version":1,"name":"s","tables":[
    {"name":"tree","radius":1,"levels":[{"triangles":100,"vertices":60,"bytes":10,"accuracy":1},
                                        {"triangles":10,"vertices":80,"draws":2,"bytes":4,"accuracy":0.9}]},
    {"name":"stone","radius":1,"levels":[{"triangles":12,"vertices":8,"accuracy":1}]},
    {"name":"spare","radius":1,"levels":[{"triangles":12,"vertices":8,"accuracy":1}]}],
  "objects":[{"id":3,"table":"tree","center":[0,0,0],"radius":1},
             {"id":2,"table":"tree","center":[9,0,0],"radius":2,"forced":1},
             {"id":1,"table":"stone","center":[0,5,0],"radius":1,"hidden":true}]}"#;

#[test]
fn a_scene_is_summed_up() {
    let Ok(Inspection::Scene(s)) = inspect_json(SCENE.as_bytes(), "s.json") else { panic!("a scene") };
    assert_eq!((s.objects, s.tables, s.unused_tables, s.objects_with_levels, s.unseen), (3, 3, 1, 1, 1));
    assert_eq!((s.finest.triangles, s.coarsest.triangles), (100 + 100 + 12, 10 + 10 + 12));
    assert_eq!((s.finest.vertices, s.coarsest.vertices), (60 + 60 + 8, 80 + 80 + 8));
    assert_eq!((s.finest.draws, s.coarsest.draws), (3, 5));
    assert_eq!((s.finest.bytes, s.coarsest.bytes), (10, 4));
    let levels: Vec<_> = s.level_counts.iter().map(|c| (c.levels, c.tables, c.objects)).collect();
    assert_eq!(levels, [(1, 2, 1), (2, 1, 2)]);
    assert_eq!((s.min, s.max), (Some([-1.0, -2.0, -2.0]), Some([11.0, 6.0, 2.0])));
    let settings: Vec<_> = s.settings.iter().map(|c| (c.setting, c.objects)).collect();
    assert_eq!(settings, [("forced", 1), ("hidden", 1)]);
    let lint = s.lints.iter().find(|l| l.table == "tree").expect("more vertices than the finer level");
    assert_eq!((lint.level, lint.rule), (1, "it has more vertices than the finer level"));
}

#[test]
fn a_scene_of_nothing_has_no_extent() {
    let text = r#"{"format":"lod-budget scene","version":1,"tables":[],"objects":[]}"#;
    let Ok(Inspection::Scene(s)) = inspect_json(text.as_bytes(), "s.json") else { panic!("a scene") };
    assert_eq!((s.min, s.max, s.finest.triangles, s.level_counts.len()), (None, None, 0, 0));
}

#[test]
fn json_is_told_apart_by_its_keys() {
    let instance = br#"{"budget": 5, "classes": [[[1, 2], [3, 4]], [[0, 0]]]}"#;
    let expected = InstanceInspection {
        budget: 5.0,
        classes: 2,
        items: 3,
        fewest_items: 1,
        most_items: 2,
        least_cost: 1.0,
        most_cost: 3.0,
        feasible: true,
    };
    assert_eq!(inspect_json(instance, "i.json"), Ok(Inspection::Instance(expected)));
    let named = br#"{"format": "lod-knapsack", "version": 1, "budget": 0.5, "classes": [[[1, 2]]]}"#;
    let Ok(Inspection::Instance(found)) = inspect_json(named, "n.json") else { panic!("an instance") };
    assert!(!found.feasible);
    let error =
        inspect_json(br#"{"budget": 5, "classes": [[[-1, 2]]]}"#, "b.json").expect_err("a negative cost");
    assert!(error.to_string().starts_with("b.json: class 0, item 0: the cost"), "{error}");
    let error = inspect_json(b"{}", "other.json").expect_err("neither");
    assert_eq!(error.to_string(), "other.json: line 1, column 2: missing field `format`");
}

#[test]
fn a_path_is_measured_without_its_breaks() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("walk.txt");
    let pose = |i: i32, jump: i32| format!("{} {} 0 0 0 0 0 1\n", f64::from(i) * 0.5, i + jump);
    let text: String = (0..20).map(|i| pose(i, if i < 10 { 0 } else { 1000 })).collect();
    std::fs::write(&file, text).expect("it can be written");
    let Ok(Inspection::Path(p)) = inspect(&file) else { panic!("a path") };
    assert_eq!((p.name.as_str(), p.poses, p.dropped, p.breaks.len()), ("walk", 20, 0, 1));
    assert_eq!((p.start_s, p.duration_s, p.length), (0.0, 9.5, 18.0));
    assert_eq!((p.rate_hz, p.top_speed), (2.0, 2.0));
}

#[test]
fn a_file_of_unknown_kind_is_refused() {
    assert!(inspect("a.obj".as_ref()).expect_err("no reader").to_string().starts_with("a.obj: it must be"));
}

#[test]
fn inspections_are_plain_data() {
    let found = inspect_json(SCENE.as_bytes(), "s.json").expect("a scene");
    let json = serde_json::to_value(&found).expect("plain data");
    assert_eq!((json["kind"].as_str(), json["finest"]["triangles"].as_u64()), (Some("scene"), Some(212)));
}
