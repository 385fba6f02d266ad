//! `lod inspect`: what is in a file, and what is odd about it.

mod baked;
mod progressive;

use std::fmt::Write as _;
use std::io::Write;
use std::path::PathBuf;

use lod_budget::files::inspect::{InstanceInspection, PathInspection, SceneInspection, Total};
use lod_budget::files::{Break, BreakKind, Inspection, inspect};
use lod_budget::table::LevelRecord;
use serde::Serialize;

use crate::text::{count, counted, plain};

/// Say what is in a file, and what is odd about it.
///
/// Scenes are .json, .glb and .gltf files, paths .csv, .tum and .txt, knapsack instances and impostors .json, progressive
/// meshes .lodp, vertex hierarchies .lodh.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The file
    file: PathBuf,
    /// Print one JSON object and nothing else
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  lod inspect town.glb
  lod inspect drive.csv --json";

/// What `--json` prints.
#[derive(Serialize)]
struct Inspected<'a, I> {
    file: String,
    #[serde(flatten)]
    inspection: &'a I,
}

pub fn run(args: &Args, out: &mut dyn Write) -> anyhow::Result<()> {
    if let Some(baked) = baked::inspect(&args.file)? {
        return baked::print(&baked, args, out);
    }
    if let Some(progressive) = progressive::inspect(&args.file)? {
        return say(args, &progressive, progressive::in_words, out);
    }
    say(args, &inspect(&args.file)?, in_words, out)
}

/// Prints an inspection as it was asked for.
fn say<I: Serialize>(
    args: &Args,
    inspection: &I,
    words: impl Fn(&I) -> String,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    if args.json {
        let inspected = Inspected { file: args.file.display().to_string(), inspection };
        writeln!(out, "{}", serde_json::to_string_pretty(&inspected)?)?;
    } else {
        write!(out, "{}", words(inspection))?;
    }
    Ok(())
}

fn in_words(inspection: &Inspection) -> String {
    match inspection {
        Inspection::Scene(tables) if !tables.library.is_empty() => library_in_words(tables),
        Inspection::Scene(scene) => scene_in_words(scene),
        Inspection::Path(path) => path_in_words(path),
        Inspection::Instance(instance) => instance_in_words(instance),
    }
}

/// Lines of a name and what there is to say.
#[derive(Default)]
struct Lines(String);

impl Lines {
    fn say(&mut self, name: &str, words: impl std::fmt::Display) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.0, "{name:<10}{words}");
    }
}

fn scene_in_words(s: &SceneInspection) -> String {
    let mut lines = Lines::default();
    lines.say("Scene", plain(&s.name));
    let choice = counted(s.objects_with_levels, "object");
    lines.say("Objects", format!("{}; {choice} with levels to choose from", count(s.objects as u64)));
    lines.say("Tables", format!("{}, {} of them unused", count(s.tables as u64), s.unused_tables));
    for c in &s.level_counts {
        let (levels, tables) = (counted(c.levels, "level"), counted(c.tables, "table"));
        lines.say("", format!("{levels}: {tables}, {}", counted(c.objects, "object")));
    }
    lines.say("Finest", total_in_words(&s.finest));
    lines.say("Coarsest", total_in_words(&s.coarsest));
    match (s.min, s.max) {
        (Some(min), Some(max)) => lines.say("Box", format!("{} to {}", point(min), point(max))),
        _ => lines.say("Box", "empty"),
    }
    for setting in &s.settings {
        lines.say("Setting", format!("{}: {}", setting.setting, counted(setting.objects, "object")));
    }
    if s.unseen > 0 {
        lines.say("Unseen", format!("{} that no camera can see", counted(s.unseen, "object")));
    }
    say_lints(&mut lines, s);
    lines.0
}

fn say_lints(lines: &mut Lines, s: &SceneInspection) {
    for lint in &s.lints {
        lines.say("Odd", format!("table '{}', level {}: {}", plain(&lint.table), lint.level, lint.rule));
    }
}

/// Tables that no object uses yet: what matters is their levels.
fn library_in_words(s: &SceneInspection) -> String {
    let mut lines = Lines::default();
    lines.say("Scene", format!("{}: {}, no objects", plain(&s.name), counted(s.tables, "table")));
    for table in &s.library {
        let (bounds, levels) = (table.bounds(), counted(table.levels().len(), "level"));
        let bound = format!("radius {} around {}", bounds.radius, point(bounds.center.to_array()));
        lines.say("Table", format!("{}: {levels}, {bound}", plain(table.name())));
        for (level, record) in table.levels().iter().enumerate() {
            lines.say("", format!("level {level}: {}", record_in_words(record)));
        }
    }
    say_lints(&mut lines, s);
    lines.0
}

fn record_in_words(l: &LevelRecord) -> String {
    let said = |name: &str, number: Option<f32>| number.map(|n| format!(", {name} {n}")).unwrap_or_default();
    let (error, min_size) = (said("error", l.error), said("min_size", l.min_size));
    let [triangles, vertices] = [l.triangles, l.vertices].map(|n| count(u64::from(n)));
    format!("{triangles} triangles, {vertices} vertices, accuracy {}{error}{min_size}", l.accuracy)
}

fn total_in_words(t: &Total) -> String {
    let [triangles, vertices, draws, bytes] = [t.triangles, t.vertices, t.draws, t.bytes].map(count);
    format!("{triangles} triangles, {vertices} vertices, {draws} draws, {bytes} bytes")
}

fn point([x, y, z]: [f32; 3]) -> String {
    format!("({x}, {y}, {z})")
}

fn path_in_words(p: &PathInspection) -> String {
    let mut lines = Lines::default();
    lines.say("Path", plain(&p.name));
    lines.say("Poses", format!("{}, {:.1} a second", count(p.poses as u64), p.rate_hz));
    lines.say("Time", format!("{:.3} s from {} s on", p.duration_s, p.start_s));
    lines.say("Length", format!("{:.2} units, at most {:.2} a second", p.length, p.top_speed));
    if p.dropped > 0 {
        lines
            .say("Dropped", format!("{} that repeat the time of the one before", counted(p.dropped, "pose")));
    }
    for found in &p.breaks {
        lines.say(if found.kind == BreakKind::Gap { "Gap" } else { "Jump" }, break_in_words(found));
    }
    lines.0
}

fn break_in_words(b: &Break) -> String {
    format!(
        "before pose {}, at {:.3} s: {:.3} s and {:.2} units wide",
        b.pose, b.time_s, b.duration_s, b.distance
    )
}

fn instance_in_words(i: &InstanceInspection) -> String {
    let mut lines = Lines::default();
    lines.say("Instance", format!("{} classes, {}", count(i.classes as u64), counted(i.items, "item")));
    lines.say("Class", format!("{} to {} items", i.fewest_items, i.most_items));
    lines.say("Cost", format!("{} to {}", i.least_cost, i.most_cost));
    let feasible = if i.feasible { "can be met" } else { "cannot be met" };
    lines.say("Budget", format!("{}: {feasible}", i.budget));
    lines.0
}
