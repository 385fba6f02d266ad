//! The contestants of the simplification comparison that Rust has, one call each: `../../../simplify/` asks them,
//! and measures everybody's results alike.
//!
//! ```text
//! simplify shapes FOLDER                       # the made meshes, as PLY
//! simplify clean MESH OUT.ply                  # any mesh, welded and repaired
//! simplify lower CONTESTANT IN.ply TRIANGLES OUT.ply
//! simplify bound FINE.ply COARSE.ply           # the proved bound that a table would store
//! simplify serve                               # all of those, one after the other
//! ```
//!
//! Every answer is one line of JSON. Times are the processor's, of simplification alone. `serve` reads lines, each a list
//! of the words of a command, and answers them in turn: so that who is timed here runs in a process that has run before,
//! as who is timed from Python does, and does not wait for the system to give it memory for the first time.

#[cfg(feature = "meshopt")]
mod meshoptimizer;
mod ours;
mod ply;

use std::error::Error;
use std::io::{self, BufRead, Write};
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use cpu_time::ThreadTime;
use lod_budget::bake::deviation::{Options, deviation};
use lod_budget::bake::read::load;
use lod_budget::bake::{Surface, shapes};
use serde_json::{Value, json};

type Answer = Result<Value, Box<dyn Error>>;

/// A way to simplify a surface to so many triangles, and the time that it takes.
type Contestant = fn(&Surface, usize) -> Result<(Surface, Duration), Box<dyn Error>>;

const CONTESTANTS: &[(&str, Contestant)] = &[
    ("lod-budget", ours::preserving_topology),
    ("lod-budget-free", ours::of_any_topology),
    #[cfg(feature = "meshopt")]
    ("meshoptimizer-update", meshoptimizer::moving_vertices),
    #[cfg(feature = "meshopt")]
    ("meshoptimizer", meshoptimizer::keeping_vertices),
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match arguments[..] {
        ["serve"] => serve(),
        _ => answer(&arguments).map(|answer| println!("{answer}")),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("simplify: {why}");
            ExitCode::FAILURE
        }
    }
}

/// Answers command after command. One that fails is answered by what was wrong.
fn serve() -> Result<(), Box<dyn Error>> {
    for line in io::stdin().lock().lines() {
        let words: Vec<String> = serde_json::from_str(&line?)?;
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let answer = answer(&words).unwrap_or_else(|why| json!({"error": why.to_string()}));
        println!("{answer}");
        io::stdout().flush()?;
    }
    Ok(())
}

fn answer(arguments: &[&str]) -> Answer {
    match arguments {
        ["shapes", folder] => make(Path::new(folder)),
        ["clean", mesh, out] => clean(Path::new(mesh), Path::new(out)),
        ["lower", contestant, fine, triangles, out] => {
            lower(contestant, Path::new(fine), triangles.parse()?, Path::new(out))
        }
        ["bound", fine, coarse] => bound(Path::new(fine), Path::new(coarse)),
        other => Err(format!("shapes, clean, lower or bound, but {}", other.join(" ")).into()),
    }
}

/// Half a million triangles of a smooth body, of the smoothest, and of noise.
fn make(folder: &Path) -> Answer {
    let knot = ("torus_knot", shapes::torus_knot(2_500, 100));
    let made = [knot, ("icosphere", shapes::icosphere(158)), ("terrain", shapes::terrain(500, 1))];
    for (name, shape) in &made {
        ply::write(&folder.join(name).with_extension("ply"), shape)?;
    }
    Ok(made.iter().map(|(name, _)| *name).collect())
}

fn clean(mesh: &Path, out: &Path) -> Answer {
    let surface = load(mesh)?.mesh.surface();
    ply::write(out, &surface)?;
    Ok(json!({"vertices": surface.positions.len(), "triangles": surface.triangles.len()}))
}

fn lower(contestant: &str, fine: &Path, triangles: usize, out: &Path) -> Answer {
    let found = CONTESTANTS.iter().find(|(name, _)| *name == contestant);
    let (_, contestant) = found.ok_or_else(|| format!("there is no {contestant} in this build"))?;
    let (surface, time) = contestant(&load(fine)?.mesh.surface(), triangles)?;
    ply::write(out, &surface)?;
    Ok(json!({"cpu_s": time.as_secs_f64()}))
}

fn bound(fine: &Path, coarse: &Path) -> Answer {
    let [fine, coarse] = [load(fine)?, load(coarse)?].map(|file| file.mesh.surface());
    let found = deviation(&fine, &coarse, &Options::default())?;
    Ok(json!({"bound": found.hausdorff, "attained": found.attained}))
}

/// What something gives, and the time that this thread computes for it.
fn timed<T>(what: impl FnOnce() -> T) -> (T, Duration) {
    let start = ThreadTime::now();
    let answer = what();
    (answer, start.elapsed())
}
