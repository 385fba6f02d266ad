//! The direction of dependencies: a room names only rooms above it in the table.
//!
//! The sources are read as text, without comments and without their unit tests, which may name what they like.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms of `src`, in order: each may name those above it and itself.
const ROOMS: [&str; 21] = [
    "kernel",
    // vocabulary
    "bounds",
    "table",
    "view",
    "hierarchy",
    "scene",
    "frame",
    // stages
    "knapsack",
    "cull",
    "rate",
    "select",
    "transition",
    "feedback",
    "runtime",
    "check",
    // bridges and tools
    "ecs",
    "gltf",
    "files",
    "bake",
    "sim",
    "bin",
];

/// Rooms that name none of the others but `kernel`, though they could.
const HERMITS: [&str; 1] = ["knapsack"];

/// Rooms that may not name each other though one is above the other.
const STRANGERS: [(&str, &str); 1] = [("sim", "bake")];

/// Crates that one place alone may name.
const KEPT: [(&str, &str); 2] = [("obvhs", "cull/bvh.rs"), ("hecs", "ecs")];

/// A source file: its path in `src`, and what it says.
struct Source {
    path: String,
    code: String,
}

impl Source {
    /// The room it belongs to: its folder in `src`, or the file itself.
    fn room(&self) -> &str {
        self.path.split('/').next().unwrap_or_default().trim_end_matches(".rs")
    }

    /// The rooms that it names: `crate::room`, or from the binary `lod_budget::room`, one by one or in braces.
    fn named(&self) -> BTreeSet<String> {
        let roots = ["crate::", "lod_budget::"];
        let root_of_binary = |root: &str| self.room() == "bin" && root == "crate::";
        let uses = roots.into_iter().filter(|root| !root_of_binary(root));
        uses.flat_map(|root| self.code.match_indices(root).map(move |(at, _)| at + root.len()))
            .flat_map(|at| heads(&self.code[at..]))
            .collect()
    }
}

/// The first names of the paths that start here: one, or each of those in braces.
fn heads(path: &str) -> Vec<String> {
    let Some(list) = path.strip_prefix('{') else { return vec![identifier(path)] };
    let (mut depth, mut heads, mut start) = (0, Vec::new(), 0);
    for (at, c) in list.char_indices() {
        let ends_item = depth == 0 && (c == ',' || c == '}');
        if ends_item {
            heads.push(identifier(list[start..at].trim()));
            start = at + 1;
        }
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            _ => {}
        }
    }
    heads
}

fn identifier(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// Everything before the unit tests, without comments.
fn code_of(text: &str) -> String {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    code.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

fn walk(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("src can be read") {
        let path = entry.expect("src can be read").path();
        if path.is_dir() {
            walk(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

/// All sources but the front page, which names every room.
fn sources() -> Vec<Source> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    walk(&src, &mut files);
    let read = |file: PathBuf| {
        let path = file.strip_prefix(&src).expect("a file of src").to_string_lossy().replace('\\', "/");
        Source { path, code: code_of(&fs::read_to_string(&file).expect("a source is text")) }
    };
    let mut sources: Vec<Source> = files.into_iter().map(read).filter(|s| s.path != "lib.rs").collect();
    sources.sort_by(|a, b| a.path.cmp(&b.path));
    sources
}

fn rank(room: &str) -> Option<usize> {
    ROOMS.iter().position(|&r| r == room)
}

/// Whether `room` may name `other`.
fn may_name(room: &str, other: &str) -> bool {
    let known = rank(room).zip(rank(other)).is_some_and(|(room, other)| other <= room);
    let strangers = STRANGERS.iter().any(|&(a, b)| (room, other) == (a, b) || (room, other) == (b, a));
    room == other || known && !strangers && (other == "kernel" || !HERMITS.contains(&room))
}

#[test]
fn every_source_is_in_a_known_room() {
    let homeless: Vec<String> =
        sources().into_iter().filter(|s| rank(s.room()).is_none()).map(|s| s.path).collect();
    assert!(homeless.is_empty(), "add to the table of rooms: {homeless:?}");
}

#[test]
fn a_room_names_only_rooms_above_it() {
    for source in sources() {
        for other in source.named() {
            assert!(may_name(source.room(), &other), "src/{} may not name {other}", source.path);
        }
    }
}

/// A file that is a room by itself reaches the others through its parent as well.
#[test]
fn rooms_are_named_from_the_root_and_not_through_parents() {
    for source in sources() {
        let depth = source.path.matches('/').count() - usize::from(source.path.ends_with("/mod.rs"));
        let climb = "super::".repeat(depth + 1);
        assert!(!source.code.contains(&climb), "src/{} leaves its room by {climb}", source.path);
    }
}

#[test]
fn the_crates_that_are_kept_are_named_in_their_place_alone() {
    for source in sources() {
        for (name, place) in KEPT {
            let names = source.code.contains(&format!("{name}::"));
            assert!(!names || source.path.starts_with(place), "src/{} may not name {name}", source.path);
        }
    }
}

#[test]
fn the_reader_of_sources_finds_what_is_named() {
    let source = |path: &str, text: &str| Source { path: path.into(), code: code_of(text) };
    let text = "use crate::{frame::Budget, scene::{Object, Objects}, view};\n// crate::sim\nfn f() { crate::rate::cost(); }\n\
                #[cfg(test)]\nmod tests { use crate::runtime::Runtime; }";
    let named = source("cull/mod.rs", text).named();
    assert_eq!(named.iter().map(String::as_str).collect::<Vec<_>>(), ["frame", "rate", "scene", "view"]);
    assert_eq!(
        source("bin/lod/main.rs", "use crate::args;\nuse lod_budget::sim::Trial;").named(),
        ["sim".into()].into()
    );
    assert!(!may_name("sim", "bake") && !may_name("knapsack", "frame") && !may_name("rate", "select"));
    assert!(may_name("bin", "bake") && may_name("select", "knapsack"));
}
