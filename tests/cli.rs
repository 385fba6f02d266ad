//! The `lod` command from outside: what it prints, what it writes, what it refuses.
#![cfg(feature = "cli")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use lod_budget::bake::hierarchy;
use lod_budget::bake::impostor::Impostor;
use lod_budget::bake::simplify::{GarlandHeckbert, quietly};
use lod_budget::files::{CameraPath, Scene};
use lod_budget::knapsack::{Instance, exact, greedy};
use lod_budget::sim::generate::{Recipe, scatter};
use serde_json::Value;
use tempfile::TempDir;

/// A folder that the command runs in.
struct Room(TempDir);

impl Room {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn put(&self, name: &str, contents: impl AsRef<[u8]>) -> &Self {
        fs::write(self.path(name), contents).expect("written");
        self
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect(name)
    }

    fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lod"));
        command.current_dir(self.0.path()).args(line.split_whitespace());
        command
    }

    fn run(&self, line: &str) -> Output {
        self.command(line).output().expect("it runs")
    }

    /// Standard output of a run that must do.
    fn done(&self, line: &str) -> String {
        let output = self.run(line);
        assert!(output.status.success(), "lod {line}: {}", text(&output.stderr));
        assert_eq!(text(&output.stderr), "", "lod {line}");
        text(&output.stdout)
    }

    /// The one object that a run prints.
    fn json(&self, line: &str) -> Value {
        let value: Value = serde_json::from_str(&self.done(line)).expect(line);
        assert!(value.is_object(), "lod {line}");
        value
    }

    /// A run that must be refused with status 2, nothing on standard output, and one line that has all these words.
    fn refused(&self, line: &str, words: &[&str]) {
        let output = self.run(line);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "lod {line}: {message}");
        assert_eq!(text(&output.stdout), "", "lod {line}");
        assert!(message.starts_with("lod: ") && message.lines().count() == 1, "lod {line}: {message}");
        assert!(words.iter().all(|word| message.contains(word)), "lod {line}: {message}");
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// Of the levels of a mesh, as printed.
fn triangles(mesh: &Value) -> Vec<u64> {
    let levels = mesh["levels"].as_array().into_iter().flatten();
    levels.filter_map(|level| level["triangles"].as_u64()).collect()
}

/// No level has more triangles than were asked for, and at most one less, since a contraction may take two.
fn assert_met(triangles: &[u64], asked: &[u64]) {
    let is_met = |(&triangles, &asked): (&u64, &u64)| triangles <= asked && asked <= triangles + 1;
    assert_eq!(triangles.len(), asked.len(), "{triangles:?}");
    assert!(triangles.iter().zip(asked).all(is_met), "{triangles:?}, not {asked:?}");
}

const PATH: &str = "time_s,x,y,z,qx,qy,qz,qw\n0,0,2,30,0,0,0,1\n0.1,0,2,28,0,0,0,1\n0.3,0,2,20,0,0,0,1\n";

/// A room with a scene of 60 objects, `yard.json`, and a path of 19 frames, `yard.csv`.
fn yard() -> Room {
    let room = Room::new();
    let scene = Scene { name: "yard".into(), ..scatter(60, 1) };
    room.put("yard.json", scene.to_json().expect("a good scene")).put("yard.csv", PATH);
    room
}

/// Two nodes that share a mesh of `triangles` triangles, without levels.
fn gltf(triangles: u32) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0, 1]}}],
        "nodes": [{{"mesh": 0, "name": "a"}}, {{"mesh": 0, "name": "b", "translation": [3, 0, 0]}}],
        "meshes": [{{"name": "rock", "primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
        "accessors": [{{"componentType": 5126, "count": {}, "type": "VEC3", "min": [-1, -1, -1], "max": [1, 1, 1]}}]}}"#,
        3 * triangles
    )
}

#[test]
fn every_command_says_how_it_is_used() {
    let room = Room::new();
    assert_eq!(room.done("--version"), concat!("lod ", env!("CARGO_PKG_VERSION"), "\n"));
    for command in ["", "compare", "bake", "inspect", "solve", "generate"] {
        let help = room.done(&format!("{command} --help"));
        let examples = help.split("Examples:\n").nth(1).unwrap_or_else(|| panic!("{command}: {help}"));
        assert!(examples.contains(&format!("lod {command}")), "{help}");
        assert!(!help.contains('\x1b'), "colours in a pipe: {help}");
    }
    let nothing = room.run("");
    assert_eq!((nothing.status.code(), nothing.stdout.len()), (Some(2), 0));
    assert!(text(&nothing.stderr).contains("compare"));
}

#[test]
fn usage_that_makes_no_sense_is_one_line() {
    let room = yard();
    room.refused("paint", &["paint"]);
    room.refused("solve", &["INSTANCE"]);
    room.refused("compare yard.json --colour", &["--colour"]);
    room.refused("compare yard.json --policies static,fastest", &["fastest", "predictive"]);
    room.refused("compare yard.json --machine fast", &["fast", "--machine"]);
    room.refused("compare yard.json --budget-ms -3", &["-3", "--budget-ms", "positive"]);
    room.refused("compare yard.json --budget-ms 0", &["--budget-ms", "positive"]);
    room.refused("compare yard.json --budget-ms NaN", &["--budget-ms", "positive"]);
    room.refused("compare yard.json --budget-ms inf", &["--budget-ms", "positive"]);
    room.refused("compare yard.json --seed -1", &["--seed"]);
    for viewport in ["1920", "1920x", "0x1080", "-1x5", "1920x1080x3", "1e3x1e3", "99999999x1"] {
        room.refused(&format!("compare yard.json --viewport={viewport}"), &["--viewport", "1920x1080"]);
    }
    room.refused("compare yard.json --fps 0", &["yard.json", "fps", "positive"]);
    room.refused("compare yard.json --fps -60", &["fps"]);
    room.refused("compare yard.json --fps 1e9", &["fps", "1000000"]);
    room.refused("compare yard.json --fov 180", &["fov", "180"]);
    room.refused("compare yard.json --fov NaN", &["fov"]);
    room.refused("compare yard.json --near 0", &["near"]);
    room.refused("compare yard.json --near 5 --far 2", &["near", "far"]);
    room.refused("compare yard.json --assume-levels 0", &["levels to assume", "0"]);
    room.refused("compare yard.json --assume-levels 999", &["levels to assume", "999"]);
    room.refused("generate building --objects 5", &["--objects", "scatter"]);
    room.refused("generate scatter --objects -5", &["--objects", "-5"]);
    room.refused("generate castle", &["castle", "building"]);
    room.refused("solve x.json --limit-s 5", &["--exact"]);
    room.refused("solve x.json --exact --limit-s -5", &["--limit-s", "-5"]);
}

#[test]
fn files_that_are_no_good_are_named() {
    let room = yard();
    let scene = room.read("yard.json");
    let table_gone = scene.replacen(r#""table":"scatter "#, r#""table":"lost "#, 1);
    room.put("cut.json", &scene[..scene.len() / 2])
        .put("lost.json", table_gone)
        .put("cut.gltf", &gltf(8)[..200])
        .put("cut.glb", b"glTF\x02\0\0\0\xff\xff\0\0\x10\0\0\0JSON{}")
        .put("lone.gltf", gltf(8))
        .put("nan.csv", PATH.replace("28", "NaN"))
        .put("back.csv", PATH.replace("0.3", "0.05"))
        .put("word.csv", PATH.replace("28", "far"))
        .put("empty.csv", "")
        .put("long.csv", PATH.replace("0.3", "1e12"))
        .put("scene.obj", "v 0 0 0");
    for command in ["compare", "inspect"] {
        room.refused(&format!("{command} gone.json"), &["gone.json: it cannot be read"]);
        room.refused(&format!("{command} cut.json"), &["cut.json: line", "EOF"]);
        room.refused(&format!("{command} lost.json"), &["lost.json: object 0: its table 'lost "]);
        room.refused(&format!("{command} cut.gltf"), &["cut.gltf: "]);
        room.refused(&format!("{command} cut.glb"), &["cut.glb: "]);
        room.refused(&format!("{command} scene.obj"), &["scene.obj", ".glb"]);
        room.refused(&format!("{command} ."), &[".: "]);
    }
    for read in ["inspect", "compare yard.json --path"] {
        room.refused(&format!("{read} nan.csv"), &["nan.csv: line 3: its numbers must be finite"]);
        room.refused(&format!("{read} back.csv"), &["back.csv: line 4", "0.05"]);
        room.refused(&format!("{read} word.csv"), &["word.csv: line 3", "'far'"]);
        room.refused(&format!("{read} empty.csv"), &["empty.csv: "]);
        room.refused(&format!("{read} gone.csv"), &["gone.csv: it cannot be read"]);
    }
    room.refused("compare lone.gltf", &["lone.gltf", "lone.csv", "--path"]);
    room.refused("compare yard.json --path long.csv", &["1000000 frames"]);
    room.refused("compare castle", &["castle"]);
}

#[test]
fn what_cannot_be_written_is_named_and_leaves_nothing() {
    let room = yard();
    room.put("taken", "a file");
    room.refused("generate scatter --objects 3 --out taken", &["taken: it cannot be made"]);
    room.refused("compare yard.json --policies coarsest --out taken", &["taken: it cannot be made"]);
    fs::create_dir_all(room.path("out/scatter.json")).expect("a folder in the way");
    room.refused("generate scatter --objects 3 --out out", &["scatter.json: it cannot be written"]);
    assert_eq!(fs::read_dir(room.path("out")).expect("there").count(), 1);
}

/// Funkhouser and Séquin's rule ends at 35.17 here.
const COUNTEREXAMPLE: &str = r#"{"budget": 346.8607, "classes": [
    [[0.1136, 0.4652], [1.7599, 5.0387], [18.8952, 34.5056], [346.7490, 618.5195]],
    [[0.1086, 0.3795], [0.3057, 0.6621], [5.2287, 2.1120], [21.4700, 6.1775]]]}"#;

/// Items with no order in them, so that the optimum is work to prove.
fn tangled(classes: u64) -> String {
    let number = |seed: u64| 1 + seed.wrapping_mul(6_364_136_223_846_793_005).rotate_left(21) % 9973;
    let item = |c: u64, i: u64| format!("[{}, {}]", i * number(7 * c + i), i * number(7 * c + i) + 40 * i);
    let class = |c| format!("[{}]", (0..4).map(|i| item(c, i)).collect::<Vec<_>>().join(", "));
    let all: Vec<String> = (0..classes).map(class).collect();
    format!(r#"{{"budget": {}, "classes": [{}]}}"#, classes * 7919, all.join(", "))
}

#[test]
fn a_knapsack_is_solved_and_its_answer_is_the_librarys() {
    let room = Room::new();
    room.put("two.json", COUNTEREXAMPLE).put("many.json", tangled(12));
    let quick = room.json("solve two.json --json");
    assert_eq!(quick["choice"], serde_json::json!([3, 0]));
    assert!((quick["benefit"].as_f64().expect("a number") - 618.90).abs() < 0.005);
    let proved = room.json("solve two.json --exact --json");
    assert_eq!((&proved["optimal"], &proved["gap"]), (&Value::Bool(true), &serde_json::json!(0.0)));
    for key in ["choice", "cost", "benefit", "upper_bound", "gap", "feasible", "optimal", "shortfall"] {
        assert!(proved.get(key).is_some_and(|v| !v.is_null()), "{key}");
    }
    let instance = Instance::from_json(&tangled(12)).expect("a good instance");
    let (fast, best) = (greedy(&instance), exact(&instance, &mut || false));
    assert_eq!(room.json("solve many.json --json")["benefit"], fast.benefit);
    assert_eq!(room.json("solve many.json --exact --json")["choice"], serde_json::json!(best.choice));
    let words = room.done("solve two.json --exact");
    assert!(
        words.contains("618.899") && words.contains("optimal, proved") && words.contains("3 0"),
        "{words}"
    );
}

#[test]
fn a_search_that_is_cut_short_says_so() {
    let room = Room::new();
    room.put("many.json", tangled(200));
    let cut = room.json("solve many.json --exact --limit-s 0 --json");
    assert_eq!((&cut["optimal"], &cut["feasible"]), (&Value::Bool(false), &Value::Bool(true)));
    assert!(cut["upper_bound"].as_f64() > cut["benefit"].as_f64());
    assert!(cut["gap"].as_f64() > Some(0.0));
}

#[test]
fn infeasible_and_empty_instances_have_answers() {
    let room = Room::new();
    room.put("poor.json", r#"{"budget": 1, "classes": [[[3, 9], [2, 1]], [[0.5, 0]]]}"#);
    room.put("none.json", r#"{"budget": 0, "classes": []}"#);
    let poor = room.json("solve poor.json --json");
    assert_eq!(poor["choice"], serde_json::json!([1, 0]));
    assert_eq!((&poor["feasible"], poor["shortfall"].as_f64()), (&Value::Bool(false), Some(1.5)));
    assert!(poor["upper_bound"].is_null() && poor["gap"].is_null());
    assert!(room.done("solve poor.json --exact").contains("exceeds the budget by 1.5"));
    assert!(room.done("inspect none.json").contains("0 to 0"));
    assert!(!room.done("solve none.json --json").contains("-0"));
    let none = room.json("solve none.json --exact --json");
    assert_eq!((&none["choice"], &none["gap"]), (&serde_json::json!([]), &serde_json::json!(0.0)));
    assert_eq!((&none["feasible"], &none["optimal"]), (&Value::Bool(true), &Value::Bool(true)));
}

#[test]
fn instances_that_are_no_good_are_named() {
    let room = Room::new();
    let instance =
        |budget: &str, item: &str| format!(r#"{{"budget": {budget}, "classes": [[[1, 1]], [{item}]]}}"#);
    for (contents, words) in [
        (instance("1", "[-1, 1]"), &["class 1, item 0", "cost", "-1"][..]),
        (instance("1", "[1, -1]"), &["class 1, item 0", "benefit", "-1"]),
        (instance("1", "[NaN, 1]"), &["class 1, item 0"]),
        (instance("1", "[1e999, 1]"), &["class 1, item 0"]),
        (instance("-5", "[1, 1]"), &["budget", "-5"]),
        (instance("1", ""), &["class 1", "empty"]),
        (instance("1", "[1, 1]")[..40].to_owned(), &["EOF"]),
        (String::new(), &["EOF"]),
        ("\u{feff}[]".to_owned(), &["line 1"]),
    ] {
        room.put("a.json", &contents);
        let all: Vec<&str> = words.iter().copied().chain(["a.json: "]).collect();
        room.refused("solve a.json", &all);
    }
    room.put("a.json", b"{\"budget\": \xff\xff}");
    room.refused("solve a.json", &["a.json: ", "UTF-8"]);
    room.refused("solve gone.json", &["gone.json: it cannot be read"]);
    room.put("a.json", instance("1", "[-1, 1]"));
    room.refused("inspect a.json", &["a.json", "class 1, item 0", "-1"]);
}

#[test]
fn an_instance_comes_from_standard_input_as_well() {
    let ask = |input: &str| {
        let mut command = Room::new().command("solve - --json");
        let mut child = command
            .current_dir("/")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it runs");
        child.stdin.take().expect("a pipe").write_all(input.as_bytes()).expect("written");
        child.wait_with_output().expect("it ends")
    };
    let answer: Value = serde_json::from_slice(&ask(COUNTEREXAMPLE).stdout).expect("an object");
    assert_eq!(answer["choice"], serde_json::json!([3, 0]));
    let refused = ask("{");
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).starts_with("lod: standard input: "), "{}", text(&refused.stderr));
}

/// The output is larger than a pipe, so that it is cut while it is written.
#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let room = Room::new();
    room.put("large.json", tangled(60_000));
    let mut command = room.command("solve large.json --json");
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it runs");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    assert!(room.done("solve large.json --json").len() > 1 << 16);
}

#[test]
fn scenes_paths_and_instances_are_inspected() {
    let room = yard();
    room.put("two.json", COUNTEREXAMPLE)
        .put("rock.gltf", gltf(40))
        .put("drive.txt", "5 0 0 0 0 0 0 1\n6 1 0 0 0 0 0 1\n");
    let scene = room.json("inspect yard.json --json");
    assert_eq!((&scene["kind"], scene["objects"].as_u64()), (&Value::from("scene"), Some(60)));
    assert_eq!(scene["file"], "yard.json");
    let mesh = room.json("inspect rock.gltf --json");
    assert_eq!((mesh["objects"].as_u64(), mesh["finest"]["triangles"].as_u64()), (Some(2), Some(80)));
    let path = room.json("inspect yard.csv --json");
    assert_eq!((&path["kind"], path["poses"].as_u64()), (&Value::from("path"), Some(3)));
    let instance = room.json("inspect two.json --json");
    assert_eq!((&instance["kind"], instance["items"].as_u64()), (&Value::from("instance"), Some(8)));
    assert_eq!((&instance["feasible"], instance["budget"].as_f64()), (&Value::Bool(true), Some(346.8607)));
    assert!(room.done("inspect yard.json").contains("60"));
    assert!(room.done("inspect rock.gltf").contains("80 triangles"));
    assert!(room.done("inspect drive.txt").contains("1.000 s from 5 s on"));
    assert!(room.done("inspect two.json").contains("2 classes, 8 items"));
}

#[test]
fn generated_scenes_are_the_generators() {
    let room = Room::new();
    let said = room.done("generate building --out new/folder");
    assert!(said.contains("2322 objects") && said.contains("building.csv"), "{said}");
    let bundled = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    for name in ["building.json", "building.csv"] {
        let written = fs::read(room.path("new/folder").join(name)).expect(name);
        assert!(written == fs::read(bundled.join(name)).expect(name), "{name} differs");
    }
    let scattered = room.json("generate scatter --objects 40 --seed 9 --json");
    assert_eq!((scattered["objects"].as_u64(), scattered["seed"].as_u64()), (Some(40), Some(9)));
    let scene = Scene::read(&room.path("scatter.json")).expect("a scene");
    assert_eq!(scene, scatter(40, 9));
    assert_eq!(CameraPath::read(&room.path("scatter.csv")).expect("a path").duration_s().round(), 30.0);
    room.done("generate city --seed 3");
    assert_eq!(Scene::read(&room.path("city.json")).expect("a scene"), Recipe::City.scene(3));
}

/// Every key that is relied upon, and the keys of `frame_ms`.
const POLICY_KEYS: [&str; 12] = [
    "policy",
    "frame_ms",
    "std_over_budget",
    "tracking_over_budget",
    "max_over_budget",
    "missed",
    "infeasible",
    "budget_used",
    "gain_over_bound",
    "switches_per_object_second",
    "reversals_per_object_second",
    "visible_mean",
];
const FRAME_KEYS: [&str; 6] = ["mean", "std", "p50", "p95", "p99", "max"];
const NAMES: [&str; 7] =
    ["coarsest", "finest", "static-default", "static", "reactive", "funkhouser-sequin", "predictive"];

#[test]
fn a_comparison_has_every_key() {
    let room = yard();
    let all = room.json("compare yard.json --json");
    assert_eq!(
        (&all["scene"], &all["path"], &all["machine"]),
        (&"yard".into(), &"yard".into(), &"default".into())
    );
    assert_eq!((all["frames"].as_u64(), all["seed"].as_u64()), (Some(19), Some(1)));
    assert!(all["budget_ms"].as_f64() > Some(0.0));
    assert_eq!((all["assumed_tables"].as_u64(), &all["assume_levels"]), (Some(0), &Value::Null));
    assert!(all["shortfall_ms"]["mean"].is_f64() && all["shortfall_ms"]["max"].is_f64());
    for model in ["prior", "true"] {
        assert!(all["cost_model"][model]["triangle_us"].as_f64() > Some(0.0), "{model}");
    }
    assert!(!room.done("compare yard.json --json").contains("-0.0"), "a zero is a zero");
    let policies = all["policies"].as_array().expect("a list");
    assert_eq!(policies.iter().map(|p| p["policy"].as_str().expect("a name")).collect::<Vec<_>>(), NAMES);
    for policy in policies {
        for key in &POLICY_KEYS[2..] {
            assert!(policy[key].is_f64(), "{key} of {policy}");
        }
        for key in FRAME_KEYS {
            assert!(policy["frame_ms"][key].as_f64() > Some(0.0) || key == "std", "{key} of {policy}");
        }
        assert_eq!(policy.get("scale").is_some(), policy["policy"] == "static");
    }
    let mean = |i: usize| policies[i]["frame_ms"]["mean"].as_f64().expect("a number");
    assert!((2..7).all(|i| mean(i) < mean(1) * 1.0001 && mean(i) > mean(0) * 0.9999));
}

#[test]
fn the_same_comparison_prints_the_same() {
    let room = yard();
    let line = "compare yard.json --seed 7 --json";
    assert_eq!(room.done(line), room.done(line));
    assert_ne!(room.json(line)["policies"], room.json("compare yard.json --seed 8 --json")["policies"]);
}

#[test]
fn a_comparison_is_on_what_was_asked_for() {
    let room = yard();
    room.put("still.csv", "time_s,x,y,z,qx,qy,qz,qw\n5,0,2,30,0,0,0,1\n");
    let few = room.json(
        "compare yard.json --path still.csv --policies predictive,finest,predictive --machine ideal --budget-ms 0.5 --json",
    );
    let names: Vec<&str> =
        few["policies"].as_array().expect("a list").iter().filter_map(|p| p["policy"].as_str()).collect();
    assert_eq!(names, ["predictive", "finest"]);
    assert_eq!((few["frames"].as_u64(), few["budget_ms"].as_f64()), (Some(1), Some(0.5)));
    assert_eq!((&few["machine"], &few["path"]), (&"ideal".into(), &"still".into()));
    assert_eq!(few["cost_model"]["prior"], few["cost_model"]["true"]);
    let half = room.json("compare yard.json --fps 30 --policies coarsest --json");
    assert_eq!(half["frames"].as_u64(), Some(10));
    let small = room.json("compare yard.json --viewport 320x200 --policies coarsest --json");
    let time = |v: &Value| v["policies"][0]["frame_ms"]["mean"].as_f64().expect("a number");
    assert!(time(&small) < time(&half));
}

#[test]
fn a_budget_that_cannot_be_met_is_reported() {
    let room = yard();
    let poor = room.json("compare yard.json --budget-ms 0.0001 --policies predictive --json");
    assert_eq!(poor["policies"][0]["infeasible"].as_f64(), Some(1.0));
    assert_eq!(poor["infeasible_frames"].as_u64(), Some(19));
    let (mean, max) = (poor["shortfall_ms"]["mean"].as_f64(), poor["shortfall_ms"]["max"].as_f64());
    assert!(mean > Some(0.0) && max >= mean);
    let words = room.done("compare yard.json --budget-ms 0.0001 --policies predictive --out out");
    let plot = room.read("out/time_over_budget.svg");
    let lines = plot.lines().filter(|line| line.starts_with("<polyline") && line.contains("#0072B2"));
    assert_eq!(lines.count(), 2, "the policy's line and its legend");
    assert!(words.contains("In 19 frames (100.0 %) the coarsest levels alone exceed the budget"), "{words}");
}

#[test]
fn a_comparison_in_words_has_a_row_per_policy() {
    let room = yard();
    let words = room.done("compare yard.json");
    for name in NAMES {
        assert_eq!(words.lines().filter(|l| l.starts_with(&format!("{name} "))).count(), 1, "{words}");
    }
    for expected in ["60 objects", "19 frames at 60 Hz", "seed 1", "ms", "% budget", "Best in tracking: "] {
        assert!(words.contains(expected), "{expected}: {words}");
    }
    assert!(!words.contains('\x1b') && !words.contains("ASSUMED"), "{words}");
}

#[test]
fn assumed_levels_are_owned_up_to_everywhere() {
    let room = Room::new();
    room.put("rock.gltf", gltf(400))
        .put("drive.csv", PATH.replace("30", "9").replace("28", "8").replace("20", "7"));
    let line = "compare rock.gltf --path drive.csv --assume-levels 3 --policies finest,predictive --out out";
    assert!(room.done(line).contains("levels ASSUMED, up to 3, for 1 table without levels"));
    let json: Value = serde_json::from_str(&room.read("out/comparison.json")).expect("an object");
    assert_eq!((json["assume_levels"].as_u64(), json["assumed_tables"].as_u64()), (Some(3), Some(1)));
    assert!(room.read("out/report.html").contains("levels ASSUMED"));
    assert!(room.read("out/frames.csv").lines().skip(1).all(|l| l.ends_with(",1")));
    for plot in ["frame_time", "time_over_budget", "gain_over_bound"] {
        assert!(room.read(&format!("out/{plot}.svg")).contains("levels assumed"), "{plot}");
    }
    assert_eq!(
        room.json(&format!("{line} --json"))["policies"][1]["gain_over_bound"].as_f64().map(f64::signum),
        Some(1.0)
    );
}

#[test]
fn a_report_is_whole_and_needs_nothing_else() {
    let room = yard();
    let printed = room.json("compare yard.json --out deep/report --json");
    let written: Value = serde_json::from_str(&room.read("deep/report/comparison.json")).expect("an object");
    assert_eq!(printed, written);
    let page = room.read("deep/report/report.html");
    assert_eq!(page.matches("<svg").count(), 3);
    for outside in ["<script", "<link", "<img", "src=", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    for name in NAMES {
        assert!(page.contains(&format!("<td>{name}</td>")), "{name}");
    }
    let files =
        fs::read_dir(room.path("deep/report")).expect("there").map(|f| f.expect("a file").file_name());
    let mut files: Vec<_> = files.collect();
    files.sort();
    let expected = [
        "comparison.json",
        "frame_time.svg",
        "frames.csv",
        "gain_over_bound.svg",
        "report.html",
        "time_over_budget.svg",
    ];
    assert_eq!(files, expected);
}

#[test]
fn the_frames_add_up_to_the_summary() {
    let room = yard();
    let summary = room.json("compare yard.json --out out --json");
    let csv = room.read("out/frames.csv");
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let place = |name: &str| header.iter().position(|column| *column == name).expect("a column");
    let mut sums: BTreeMap<&str, (f64, u32)> = BTreeMap::new();
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), header.len(), "{line}");
        let sum = sums.entry(fields[place("policy")]).or_default();
        sum.0 += fields[place("frame_ms")].parse::<f64>().expect("a number");
        sum.1 += 1;
    }
    assert_eq!(sums.len(), NAMES.len());
    for policy in summary["policies"].as_array().expect("a list") {
        let (sum, frames) = sums[policy["policy"].as_str().expect("a name")];
        let mean = policy["frame_ms"]["mean"].as_f64().expect("a number");
        assert_eq!(frames, 19);
        assert!((sum / 19.0 - mean).abs() < 1e-6, "{policy}");
    }
}

#[test]
fn plots_stay_small_however_long_the_path_is() {
    let room = yard();
    room.put("long.csv", PATH.replace("0.3", "90"));
    room.done("compare yard.json --path long.csv --policies coarsest,static-default,predictive --out out");
    assert_eq!(room.read("out/frames.csv").lines().count(), 1 + 3 * 5401);
    for plot in ["frame_time", "time_over_budget", "gain_over_bound"] {
        assert!(room.read(&format!("out/{plot}.svg")).len() < 200_000, "{plot}");
    }
}

#[test]
fn a_scene_cannot_write_on_the_page_or_steer_the_terminal() {
    let room = yard();
    let scene = room.read("yard.json").replacen("\"yard\"", r#""<script>alert(1)</script>\u001b[31m&""#, 1);
    room.put("evil.json", scene).put("evil.csv", PATH);
    let words = room.done("compare evil.json --policies coarsest --out out");
    assert!(!words.contains('\x1b') && words.contains("\\u{1b}"), "{words}");
    for file in ["report.html", "frame_time.svg", "time_over_budget.svg"] {
        let page = room.read(&format!("out/{file}"));
        assert!(
            !page.contains("<script") && !page.contains('\x1b') && page.contains("&lt;script&gt;"),
            "{file}"
        );
    }
    assert!(!room.done("inspect evil.json").contains('\x1b'));
}

#[test]
fn nothing_in_view_is_no_reason_to_fail() {
    let room = Room::new();
    let empty =
        r#"{"format": "lod-budget scene", "version": 1, "name": "void", "tables": [], "objects": []}"#;
    room.put("void.json", empty).put("void.csv", PATH);
    let void = room.json("compare void.json --out out --json");
    assert_eq!(void["frames"].as_u64(), Some(19));
    for policy in void["policies"].as_array().expect("a list") {
        assert_eq!(policy["visible_mean"].as_f64(), Some(0.0));
        assert!(POLICY_KEYS[2..].iter().all(|key| policy[key].is_f64()), "{policy}");
    }
    assert!(room.read("out/report.html").contains("void"));
}

// -- bake

/// A hilly field of 2 · `side`² triangles, as OBJ.
fn field(side: u32) -> String {
    let corner = |i: u32| {
        let (x, z) = (i % (side + 1), i / (side + 1));
        format!("v {x} {} {z}\n", f64::from(x * x + 3 * z + x * z % 7).sin())
    };
    let face = |i: u32| {
        let a = 1 + i % side + i / side * (side + 1);
        let (b, c) = (a + 1, a + side + 1);
        format!("f {a} {c} {b}\nf {b} {c} {}\n", c + 1)
    };
    let corners = (0..(side + 1) * (side + 1)).map(corner);
    corners.chain((0..side * side).map(face)).collect()
}

/// A room with a mesh of 128 triangles, `field.obj`.
fn meadow() -> Room {
    let room = Room::new();
    room.put("field.obj", field(8));
    room
}

/// All files of a folder and below, by name.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files.extend(self::files(&path));
        } else {
            files.insert(path.clone(), fs::read(&path).expect("a file"));
        }
    }
    files
}

#[test]
fn a_bake_has_every_key_and_every_file_it_names() {
    let room = meadow();
    let baked = room.json("bake field.obj --levels 4 --json");
    let mesh = &baked["meshes"][0];
    assert_eq!((mesh["input"].as_str(), mesh["method"].as_str()), (Some("field.obj"), Some("quadric")));
    assert!(mesh["seconds"].as_f64() > Some(0.0) && mesh["measure_seconds"].as_f64() > Some(0.0));
    let levels = mesh["levels"].as_array().expect("levels");
    assert_met(&triangles(mesh), &[128, 64, 32, 16]);
    for (i, level) in levels.iter().enumerate() {
        let number = |key: &str| level[key].as_f64().unwrap_or_else(|| panic!("{key} of {level}"));
        assert_eq!(number("level"), i as f64);
        assert!(number("rms") <= number("hausdorff") && number("hausdorff") <= number("error"));
        assert!(number("attained") <= number("hausdorff") && number("bytes") > 0.0);
        let text = room.read(level["file"].as_str().expect("a file"));
        let lines = |kind: &str| text.lines().filter(|line| line.starts_with(kind)).count() as f64;
        assert_eq!((lines("f "), lines("v ")), (number("triangles"), number("vertices")));
    }
    let table = room.path(mesh["table_file"].as_str().expect("a table"));
    let scene = room.path(mesh["scene_file"].as_str().expect("a scene"));
    let [table, scene] = [table, scene].map(|file| Scene::read(&file).expect("it can be read"));
    assert_eq!((table.objects.len(), scene.objects.len()), (0, 1));
    let [table, scene] = [&table, &scene].map(|scene| scene.tables[0].levels());
    for ((row, table), scene) in levels.iter().zip(table).zip(scene) {
        assert_eq!(table.error.map(f64::from), row["error"].as_f64());
        assert_eq!((table.triangles, table.vertices), (scene.triangles, scene.vertices));
        let sizes = [table, scene].map(|level| level.min_size.expect("a size"));
        assert!((sizes[0] - sizes[1]).abs() <= 1e-5 * sizes[0], "{sizes:?}");
    }
    assert!(room.read(mesh["sheet_file"].as_str().expect("a sheet")).contains("<svg"));
    assert_eq!(baked["failed"].as_array().map(Vec::len), Some(0));
}

#[test]
fn a_bake_can_end_with_an_impostor() {
    let room = meadow();
    let before = room.json("bake field.obj --levels 3 --json")["meshes"][0].clone();
    for kind in ["billboard", "cross", "octahedral"] {
        let command = format!("bake field.obj --levels 3 --impostor {kind} --out {kind} --json");
        let mesh = room.json(&command)["meshes"][0].clone();
        let impostor = &mesh["impostor"];
        assert!(
            impostor["error"].as_f64() >= impostor["rms"].as_f64() && impostor["fill"].as_f64() > Some(0.0)
        );
        let levels = mesh["levels"].as_array().expect("levels");
        let table = Scene::read(&room.path(mesh["table_file"].as_str().expect("a table"))).expect("a table");
        let scene = Scene::read(&room.path(mesh["scene_file"].as_str().expect("a scene"))).expect("a scene");
        let [table, scene] = [&table, &scene].map(|scene| scene.tables[0].levels());
        assert_eq!((levels.len(), levels.len()), (table.len(), scene.len()));
        for (table, scene) in table.iter().zip(scene) {
            assert_eq!((table.accuracy, table.error), (scene.accuracy, scene.error));
        }
        if let Some(reason) = impostor["left_out"].as_str() {
            assert!(!reason.is_empty() && mesh["levels"] != Value::Null && levels.len() == 3);
            continue;
        }
        let kept = 3 - impostor["levels_left_out"].as_u64().expect("a number") as usize;
        assert_eq!(levels.len(), kept + 1);
        assert_eq!(levels[0]["triangles"], before["levels"][0]["triangles"]);
        let text = room.read(impostor["file"].as_str().expect("a layout"));
        let read = Impostor::from_json(text.as_bytes(), "it").expect("a layout");
        assert_eq!(impostor["frames"].as_u64(), Some(read.frames.len() as u64));
        assert!(room.read(levels[kept]["file"].as_str().expect("a file")).contains("\nvt "));
    }
    let kept = room.json("bake field.obj --levels 3 --impostor octahedral --out octahedral --json");
    assert_eq!(kept["meshes"][0]["status"], "kept");
    assert!(room.path("octahedral/field/field.impostor.json").exists());
    room.done("bake field.obj --levels 3 --out octahedral");
    assert!(!room.path("octahedral/field/field.impostor.json").exists(), "it is stale");
}

const CAGE: &str = "\
v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

fn workshop() -> Room {
    let room = Room::new();
    room.put("cage.obj", CAGE);
    room
}

/// The vertices of an OBJ, and with how many normals they are shown in all.
fn places(text: &str) -> (Vec<String>, usize) {
    let lines = |kind: &'static str| text.lines().filter_map(move |line| line.strip_prefix(kind));
    let corners: BTreeSet<&str> = lines("f ").flat_map(str::split_whitespace).collect();
    assert!(corners.iter().all(|corner| corner.contains("//")), "every corner has a normal");
    (lines("v ").map(str::to_owned).collect(), corners.len())
}

#[test]
fn levels_go_upwards_from_a_cage() {
    let room = workshop();
    let baked = room.json("bake cage.obj --subdivide 2 --json");
    let mesh = &baked["meshes"][0];
    assert_eq!((mesh["method"].as_str(), triangles(mesh)), (Some("catmull-clark"), vec![192, 48, 12]));
    let seconds = |key: &str| mesh[key].as_f64().expect("seconds");
    assert!(seconds("seconds") > 0.0 && seconds("measure_seconds") > 0.0);
    let levels = mesh["levels"].as_array().expect("levels");
    let errors: Vec<f64> = levels.iter().filter_map(|level| level["error"].as_f64()).collect();
    assert!(errors.len() == 3 && errors[0] > 0.0 && errors.is_sorted(), "{errors:?}");
    let texts = levels.iter().map(|level| room.read(level["file"].as_str().expect("a file")));
    let places: Vec<_> = texts.map(|text| places(&text)).collect();
    for pair in places.windows(2) {
        assert!(pair[0].0.starts_with(&pair[1].0), "finer levels keep the vertices of coarser ones");
        assert_eq!(pair[0].0.len(), pair[0].1, "a smooth vertex has one normal");
    }
    let table = Scene::read(&room.path(mesh["table_file"].as_str().expect("a table"))).expect("a table");
    let in_table = table.tables[0].levels().iter().map(|level| u64::from(level.triangles));
    assert_eq!(in_table.collect::<Vec<_>>(), [192, 48, 12]);
    let creased = room.json("bake cage.obj --subdivide 1 --crease-angle 60 --out creased --json");
    let finest = &creased["meshes"][0]["levels"][0];
    let (corners, normals) = self::places(&room.read(finest["file"].as_str().expect("a file")));
    assert_eq!((corners.len(), normals), (26, 6 * 9), "every side of the cube has normals of its own");
    assert_eq!(finest["attained"].as_f64(), Some(0.0));
}

#[test]
fn subdivision_is_limited_and_named() {
    let room = workshop();
    let bake = |options: &str| room.json(&format!("bake cage.obj --format json --json {options}"));
    let counts = |options: &str| triangles(&bake(options)["meshes"][0]);
    assert_eq!(counts("--subdivide 9 --most-triangles 200"), [192, 48, 12]);
    assert_eq!(counts("--subdivide 9 --within 50%"), [48, 12]);
    room.put("tent.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    let tent = room.json("bake tent.obj --subdivide 1 --format json --json");
    assert_eq!(tent["meshes"][0]["method"], "loop");
    room.refused("bake cage.obj --subdivide 2 --scheme loop", &["cage.obj", "face 0", "triangle"]);
    room.refused("bake cage.obj --subdivide 2 --most-triangles 40", &["cage.obj", "at most 40", "48"]);
    let words = room.done("bake cage.obj --subdivide 1 --out words");
    assert!(words.contains("1 mesh baked") && words.contains("s to make"), "{words}");
}

#[test]
fn subdivision_that_makes_no_sense_is_refused() {
    let room = workshop();
    for number in ["0", "254", "-1", "x"] {
        room.refused(&format!("bake cage.obj --subdivide={number}"), &[number]);
    }
    for other in ["--levels 3", "--ratios 0.5", "--method melax", "--scene", "--split 100", "--progressive"] {
        let name = other.split(' ').next().expect("a name");
        room.refused(&format!("bake cage.obj --subdivide 2 {other}"), &["--subdivide", name]);
    }
    for lonely in ["--scheme loop", "--crease-angle 30", "--within 1%", "--most-triangles 9"] {
        room.refused(&format!("bake cage.obj {lonely}"), &["--subdivide"]);
    }
    room.refused("bake cage.obj --subdivide 2 --scheme doo-sabin", &["doo-sabin", "catmull-clark"]);
    room.refused("bake cage.obj --subdivide 2 --crease-angle 181", &["181", "180"]);
    room.refused("bake cage.obj --subdivide 2 --within=-1", &["-1", "positive"]);
    assert!(!room.path("baked").exists());
}

/// The impostor is of the finest level, which is itself off the surface that is meant.
#[test]
fn levels_upwards_can_end_with_an_impostor() {
    let room = workshop();
    let bake = |options: &str| {
        let command = format!("bake cage.obj --subdivide 2 --impostor octahedral --json {options}");
        room.json(&command)["meshes"][0].clone()
    };
    let mesh = bake("");
    let levels = mesh["levels"].as_array().expect("levels");
    assert!(mesh["impostor"]["left_out"].is_null(), "{mesh}");
    let text = room.read(mesh["impostor"]["file"].as_str().expect("a layout"));
    let impostor = Impostor::from_json(text.as_bytes(), "it").expect("a layout");
    let finest = levels[0]["hausdorff"].as_f64().expect("a distance");
    let last = levels[levels.len() - 1]["error"].as_f64().expect("an error");
    assert!(finest > 0.0 && last >= impostor.error + finest, "{last} < {} + {finest}", impostor.error);
    assert!(mesh["impostor"]["error"].as_f64() >= Some(impostor.error + finest));
}

/// Vertices of a finer level go to the nearest points of the coarser one: no farther than both levels are off.
#[test]
fn levels_upwards_can_morph() {
    let room = workshop();
    let mesh = room.json("bake cage.obj --subdivide 2 --geomorph --json")["meshes"][0].clone();
    let number = |value: &Value| value.as_f64().expect("a number");
    for pair in mesh["levels"].as_array().expect("levels").windows(2) {
        let morph = &pair[0]["geomorph"];
        let apart = number(&pair[0]["hausdorff"]) + number(&pair[1]["hausdorff"]);
        assert!(morph["exact"] == false && number(&morph["max"]) > 0.0 && number(&morph["max"]) <= apart);
    }
}

#[test]
fn impostors_stand_as_they_are_told() {
    let room = workshop();
    room.put(
        "mast.obj",
        CAGE.replace("v 0 0 1", "v 0 0 5")
            .replace("v 1 0 1", "v 1 0 5")
            .replace("v 1 1 1", "v 1 1 5")
            .replace("v 0 1 1", "v 0 1 5"),
    );
    for (axis, up) in [("x", [1.0, 0.0, 0.0]), ("y", [0.0, 1.0, 0.0]), ("z", [0.0, 0.0, 1.0])] {
        let options = format!("--impostor billboard --impostor-up {axis} --subdivide 1 --out {axis}");
        let mesh = room.json(&format!("bake mast.obj {options} --json"))["meshes"][0].clone();
        let Some(file) = mesh["impostor"]["file"].as_str() else { panic!("{}", mesh["impostor"]) };
        let impostor = Impostor::from_json(room.read(file).as_bytes(), file).expect("a layout");
        assert_eq!(impostor.up.to_array(), up);
        assert!(impostor.frames.iter().all(|frame| frame.up.to_array() == up));
    }
    room.refused("bake mast.obj --impostor billboard --impostor-up w", &["w", "--impostor-up"]);
    room.refused("bake mast.obj --impostor-up z", &["--impostor"]);
}

#[test]
fn hierarchies_and_impostors_are_inspected() {
    let room = meadow();
    let ball = lod_budget::bake::shapes::icosphere(3).into();
    let forest = hierarchy::of(&ball, &GarlandHeckbert::default(), &mut quietly).expect("a good shape");
    let bytes = hierarchy::to_bytes(&forest);
    room.put("ball.lodh", &bytes);
    let words = room.done("inspect ball.lodh");
    let finest = format!("{} triangles, {} vertices", forest.triangles(), forest.leaves());
    assert!(words.contains(&finest), "{words}");
    let seen = room.json("inspect ball.lodh --json");
    let number = |key: &str| seen[key].as_u64().unwrap_or_else(|| panic!("{key} of {seen}")) as usize;
    assert_eq!((seen["kind"].as_str(), number("bytes")), (Some("hierarchy"), bytes.len()));
    assert_eq!(number("operations"), forest.parts().operations.len());
    assert_eq!(number("base_triangles"), forest.base_triangles());
    // A forest of so many operations is no flatter than a full binary tree, and no deeper than a list.
    assert!(
        number("depth") >= number("operations").ilog2() as usize / 2
            && number("depth") <= number("operations")
    );
    let errors: Vec<f64> =
        seen["errors"].as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    assert!(errors.len() == 3 && errors.is_sorted(), "{errors:?}");

    room.done("bake field.obj --levels 3 --impostor octahedral");
    let words = room.done("inspect baked/field/field.impostor.json");
    assert!(words.contains("octahedral") && words.contains("81 frames"), "{words}");
    let seen = room.json("inspect baked/field/field.impostor.json --json");
    assert_eq!((seen["kind"].as_str(), seen["frames"].as_u64()), (Some("impostor"), Some(81)));

    let cut = &bytes[..bytes.len() - 1];
    room.put("cut.lodh", cut).put("none.lodh", "PNG and so on, more than a head");
    room.refused("inspect cut.lodh", &[&format!("cut.lodh: byte {}: it is cut off", cut.len())]);
    room.refused("inspect none.lodh", &["none.lodh: byte 0: it must start with LODH"]);
    room.refused("inspect gone.lodh", &["gone.lodh", "cannot be read"]);
    let text = room.read("baked/field/field.impostor.json");
    room.put("wide.json", text.replacen("\"radius\": ", "\"radius\": -", 1));
    room.refused("inspect wide.json", &["wide.json: radius: "]);
}

#[test]
fn a_progressive_mesh_is_written_and_inspected() {
    let room = meadow();
    let mesh = room.json("bake field.obj --levels 3 --progressive --json")["meshes"][0].clone();
    let file = mesh["progressive_file"].as_str().expect("a file");
    let seen = room.json(&format!("inspect {file} --json"));
    assert_eq!(seen["original"]["triangles"], mesh["levels"][0]["triangles"]);
    assert_eq!((seen["is_truncated"].as_bool(), seen["bytes"].as_u64().is_some()), (Some(false), true));
    assert!(room.done(&format!("inspect {file}")).contains("Splits"));

    let bytes = std::fs::read(room.path(file)).expect("it is there");
    room.put("cut.lodp", &bytes[..bytes.len() - 1]).put("none.lodp", "PNG and so on, more than a head");
    assert_eq!(room.json("inspect cut.lodp --json")["is_truncated"].as_bool(), Some(true));
    room.refused("inspect none.lodp", &["none.lodp"]);
}

#[test]
fn the_levels_are_those_that_were_asked_for() {
    let room = meadow();
    let bake = |options: &str| {
        room.json(&format!("bake field.obj --format json --json {options}"))["meshes"][0].clone()
    };
    assert_met(&triangles(&bake("--levels 1")), &[128]);
    assert_met(&triangles(&bake("--ratios 0.5,0.125")), &[128, 64, 16]);
    assert_met(&triangles(&bake("--triangles 100,90")), &[128, 100, 90]);
    let by_error = bake("--errors 2%,5%");
    let most = by_error["diagonal"].as_f64().expect("a diagonal") * 0.05;
    let levels = by_error["levels"].as_array().expect("levels");
    assert!(levels.len() > 1 && levels.iter().all(|level| level["hausdorff"].as_f64() <= Some(most)));
    assert!(levels.iter().all(|level| level["file"].is_null()) && by_error["scene_file"].is_null());
    let placed = |placement: &str| bake(&format!("--levels 3 --topology free --placement {placement}"));
    assert_ne!(placed("midpoint")["levels"], placed("endpoint")["levels"]);
    let vista = bake("--preset vista --accuracy triangles");
    let counts = triangles(&vista);
    assert_met(&counts[..2], &[128, 32]);
    let accuracy = vista["levels"][1]["accuracy"].as_f64().expect("an accuracy");
    assert!(vista["preset"] == "vista" && (accuracy - (1.0 - 0.5 / counts[1] as f64)).abs() < 1e-6);
}

#[test]
fn a_bake_that_makes_no_sense_is_refused_before_anything_is_done() {
    let room = meadow();
    room.refused("bake", &["MESH"]);
    room.refused("bake field.obj --levels 0", &["1 to 254", "0"]);
    room.refused("bake field.obj --levels 300", &["1 to 254", "300"]);
    room.refused("bake field.obj --ratios 0.25,0.5", &["shares", "fall"]);
    room.refused("bake field.obj --ratios 2", &["between 0 and 1"]);
    room.refused("bake field.obj --triangles 0", &["at least 1"]);
    room.refused("bake field.obj --errors 5,-1", &["-1", "positive"]);
    room.refused("bake field.obj --errors NaN%", &["NaN", "positive"]);
    room.refused("bake field.obj --levels 3 --ratios 0.5", &["--levels", "--ratios"]);
    room.refused("bake field.obj --border=-1", &["--border", "negative"]);
    room.refused("bake field.obj --jobs 0", &["--jobs"]);
    room.refused("bake field.obj --preset castle", &["castle", "vista"]);
    room.refused("bake field.obj --method magic", &["magic", "quadric"]);
    room.refused("bake field.obj --format dae", &["dae", "glb"]);
    room.refused("bake field.obj --impostor ghost", &["ghost", "octahedral"]);
    room.refused("bake field.obj --impostor octahedral --impostor-frames 8", &["odd"]);
    room.refused("bake field.obj --impostor cross --impostor-size 1", &["8 to 4096"]);
    room.refused("bake field.obj --impostor-atlas 512", &["--impostor"]);
    assert!(!room.path("baked").exists());
}

#[test]
fn a_bad_mesh_among_good_ones_is_named_and_the_others_are_baked() {
    let room = meadow();
    room.put("bad.obj", "v 0 0 0\nf 1 2 3\n").put("flat.obj", "v 1 1 1\n").put("notes.txt", "mow the field");
    room.put("packed.ply", [0x1f, 0x8b, 8, 0]);
    let output = room.run("bake bad.obj field.obj flat.obj notes.txt packed.ply gone.ply *.stl --json");
    assert_eq!(output.status.code(), Some(2));
    let printed: Value = serde_json::from_slice(&output.stdout).expect("one object");
    assert_eq!(printed["meshes"].as_array().map(Vec::len), Some(1));
    assert_eq!(printed["meshes"][0]["input"], "field.obj");
    assert!(room.path("baked/field/field.glb").exists());
    let errors = text(&output.stderr);
    let expected = [
        ["bad.obj", "line 2"],
        ["flat.obj", "triangle"],
        ["notes.txt", ".obj"],
        ["packed.ply", "gzip"],
        ["gone.ply", "cannot be read"],
        ["*.stl", "no file matches"],
    ];
    for [file, rule] in expected {
        let line = errors.lines().find(|line| line.starts_with(&format!("lod: {file}: ")));
        assert!(line.is_some_and(|line| line.contains(rule)), "{file}: {errors}");
    }
    assert_eq!(errors.lines().count(), expected.len());
    assert_eq!(fs::read_dir(room.path("baked")).expect("the folder").count(), 1);
}

#[test]
fn what_was_baked_before_is_kept_as_long_as_it_is_the_same() {
    let room = meadow();
    let bake = |options: &str| {
        room.json(&format!("bake field.obj --levels 3 --json {options}"))["meshes"][0].clone()
    };
    let first = bake("");
    assert_eq!(first["status"], "baked");
    let before = files(&room.path("baked"));
    let mut again = bake("");
    assert_eq!(again["status"], "kept");
    again["status"] = "baked".into();
    assert_eq!((again, files(&room.path("baked"))), (first, before));
    assert_eq!(bake("--force")["status"], "baked");
    assert_eq!(bake("--accuracy hausdorff")["status"], "baked", "another setting");
    assert_eq!(bake("")["status"], "baked", "the first setting again");
    let level = room.path("baked/field/field_LOD1.obj");
    fs::write(&level, "v 0 0 0").expect("damaged");
    assert_eq!(bake("")["status"], "baked", "a damaged output");
    fs::remove_file(&level).expect("removed");
    assert_eq!(bake("")["status"], "baked", "a missing output");
    room.put("field.obj", field(6));
    assert_eq!(bake("")["status"], "baked", "another mesh");
    assert_eq!(bake("")["status"], "kept");
    room.put("baked/field/field.bake.json", "{");
    assert_eq!(bake("")["status"], "baked", "a broken record");
}

#[test]
fn outputs_that_are_no_longer_made_go_and_other_files_stay() {
    let room = meadow();
    room.done("bake field.obj --levels 4");
    room.put("baked/field/field_LOD9.txt", "mine");
    room.done("bake field.obj --levels 2 --format obj");
    let left: Vec<_> = files(&room.path("baked"))
        .into_keys()
        .filter_map(|file| file.file_name().map(|n| n.to_owned()))
        .collect();
    assert_eq!(left, ["field.bake.json", "field_LOD0.obj", "field_LOD1.obj", "field_LOD9.txt"]);
}

#[test]
fn meshes_of_one_name_do_not_meet() {
    let room = meadow();
    for folder in ["a", "b"] {
        fs::create_dir(room.path(folder)).expect("a folder");
    }
    room.put("a/rock.obj", field(4)).put("b/rock.obj", field(5));
    let baked = room.json("bake a/rock.obj b/rock.obj --json --levels 2 --format obj");
    let files: Vec<_> =
        [0, 1].map(|i| baked["meshes"][i]["levels"][0]["file"].as_str().unwrap_or("").to_owned()).to_vec();
    assert_eq!(files.iter().map(|file| room.read(file).matches("f ").count()).collect::<Vec<_>>(), [32, 50]);
    room.done("bake a/rock.obj --levels 2");
    room.refused("bake b/rock.obj --levels 2", &["b/rock.obj", "a/rock.obj", "--out", "--force"]);
    room.done("bake b/rock.obj --levels 2 --out elsewhere");
    room.done("bake b/rock.obj --levels 2 --force");
}

#[test]
fn a_bake_replaces_no_file_that_it_reads() {
    let room = meadow();
    fs::create_dir_all(room.path("baked/field")).expect("a folder");
    room.put("baked/field/field_LOD0.obj", field(3)).put("baked/field/field.obj", field(3));
    let before = files(&room.path("baked"));
    let output = room.run("bake field.obj baked/field/field_LOD0.obj --out baked/field/.. --levels 1");
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).starts_with("lod: field.obj: "), "{}", text(&output.stderr));
    assert!(before.iter().all(|(file, bytes)| fs::read(file).ok().as_ref() == Some(bytes)));
}

#[test]
fn patterns_and_folders_stand_for_their_meshes() {
    let room = meadow();
    fs::create_dir(room.path("props")).expect("a folder");
    room.put("props/b.obj", field(2)).put("props/a.obj", field(3)).put("props/read.me", "not a mesh");
    let inputs = |line: &str| -> Vec<String> {
        let baked = room.json(&format!("bake {line} --json --levels 1 --format json"));
        let inputs = baked["meshes"].as_array().into_iter().flatten();
        inputs.filter_map(|mesh| Some(mesh["input"].as_str()?.replace('\\', "/"))).collect()
    };
    assert_eq!(inputs("props/*.obj"), ["props/a.obj", "props/b.obj"]);
    assert_eq!(inputs("props"), ["props/a.obj", "props/b.obj"]);
    assert_eq!(inputs("props/b.obj props/?.obj field.obj"), ["props/b.obj", "props/a.obj", "field.obj"]);
    fs::create_dir(room.path("none")).expect("a folder");
    room.refused("bake none", &["none", "no mesh"]);
}

#[test]
fn the_number_of_jobs_changes_nothing() {
    let room = meadow();
    for side in 2..8 {
        room.put(&format!("m{side}.obj"), field(side));
    }
    let bake = |jobs: u32| {
        let mut baked = room.json(&format!("bake m*.obj --jobs {jobs} --out jobs{jobs} --json"));
        for mesh in baked["meshes"].as_array_mut().expect("meshes") {
            for key in ["seconds", "measure_seconds"] {
                mesh[key] = 0.into();
            }
        }
        baked.to_string().replace(&format!("jobs{jobs}"), "jobs")
    };
    assert_eq!(bake(1), bake(3));
    let made = |folder: &str| {
        let files = files(&room.path(folder)).into_iter();
        let files = files.filter(|(file, _)| !file.to_string_lossy().ends_with(".bake.json"));
        files.map(|(_, bytes)| bytes).collect::<Vec<_>>()
    };
    assert_eq!(made("jobs1"), made("jobs3"));
}

#[test]
fn a_bake_in_words_has_a_row_per_level_or_per_mesh() {
    let room = meadow();
    room.put("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 7 7 7\nf 1 2 3\n");
    let few = room.done("bake field.obj broken.obj --levels 3");
    let rows: Vec<&str> = few.lines().take_while(|line| !line.is_empty()).collect();
    assert_eq!(rows.len(), 2 + 3 + 1, "{few}");
    assert!(rows[0].contains("Hausdorff") && few.contains("1 positions without a face, left out"), "{few}");
    assert!(few.contains("2 meshes baked"), "{few}");
    assert!(room.done("bake field.obj broken.obj --levels 3").contains("2 kept"));
    for side in 1..10 {
        room.put(&format!("m{side}.obj"), field(side));
    }
    let many = room.done("bake m*.obj --format json");
    assert_eq!(many.lines().take_while(|line| !line.is_empty()).count(), 2 + 9, "{many}");
}

#[test]
fn a_baked_table_is_inspected_and_compared() {
    let room = meadow();
    room.done("bake field.obj --levels 3");
    let words = room.done("inspect baked/field/field.json");
    let inspected = room.json("inspect baked/field/field.json --json");
    let counts = triangles(&inspected["library"][0]);
    assert_met(&counts, &[128, 64, 32]);
    assert!(words.contains("3 levels"), "{words}");
    assert!(words.contains(&format!("level 2: {} triangles", counts[2])), "{words}");
    room.put("walk.csv", PATH);
    let compared = room.json("compare baked/field/field.glb --path walk.csv --policies static,finest --json");
    assert_eq!(compared["policies"].as_array().map(Vec::len), Some(2));
}

/// A chain with geomorphs is inspected, compared and baked again like one without.
#[test]
fn geomorphs_are_written_told_of_and_read_back() {
    let room = meadow();
    let still = room.json("bake field.obj --levels 3 --out still --json");
    let baked = room.json("bake field.obj --levels 3 --geomorph --json");
    let levels = baked["meshes"][0]["levels"].as_array().expect("levels");
    for level in &levels[..2] {
        let number = |key: &str| level["geomorph"][key].as_f64().expect("a number");
        assert!(number("max") > number("mean") && number("mean") > 0.0, "{level}");
        assert_eq!(level["geomorph"]["exact"], true);
    }
    assert!(levels[2]["geomorph"].is_null() && still["meshes"][0]["levels"][0]["geomorph"].is_null());
    assert_eq!(room.json("bake field.obj --levels 3 --geomorph --json")["meshes"][0]["status"], "kept");
    assert_eq!(room.json("bake field.obj --levels 3 --json")["meshes"][0]["status"], "baked");
    room.done("bake field.obj --levels 3 --geomorph");
    let [with, without] = ["baked", "still"].map(|out| {
        Scene::read(&room.path(&format!("{out}/field/field.glb"))).expect("it can be read").tables.remove(0)
    });
    assert_eq!(with.bounds(), without.bounds());
    room.put("walk.csv", PATH);
    let compared = room.json("compare baked/field/field.glb --path walk.csv --policies static,finest --json");
    assert_eq!(compared["policies"].as_array().map(Vec::len), Some(2));
    let again = room.json("bake baked/field/field.glb --scene --out again --json");
    assert_eq!(again["scenes"][0]["measured"], 1, "{again}");
    assert_eq!(again["failed"].as_array().map(Vec::len), Some(0));
}
