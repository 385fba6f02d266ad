//! Simplifying half a million triangles to a half and down to three percent. One round each: the CPU seconds of a whole
//! task, from surface to surface, on one thread (seconds by the clock where the system does not tell).
//!
//! With a folder as argument the surfaces are written there as OBJ, for others to measure:
//! `cargo bench --bench simplify -- FOLDER`.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::time::Instant;

use lod_budget::bake::shapes::{icosphere, terrain, torus_knot};
use lod_budget::bake::simplify::{GarlandHeckbert, Simplifier, Target, Task, quietly};
use lod_budget::bake::{Mesh, Surface};

/// Shares of the triangles that are kept, in percent.
const SHARES: [usize; 5] = [50, 25, 12, 6, 3];

fn main() {
    let folder = std::env::args().nth(1).filter(|a| !a.starts_with("--"));
    let shapes = [("knot", torus_knot(2_500, 100)), ("sphere", icosphere(158)), ("terrain", terrain(500, 1))];
    let method = GarlandHeckbert::default();
    println!("{:>10} {:>5} {:>9} {:>7} {:>11}", "shape", "%", "triangles", "s", "estimate");
    for (name, shape) in &shapes {
        save(folder.as_deref(), name, 100, shape);
        let mesh = Mesh::from(shape.clone());
        for share in SHARES {
            let task = Task::new(&mesh, Target::triangles(shape.triangles.len() * share / 100));
            let (start, cpu_start) = (Instant::now(), cpu_seconds());
            let simplified = method.simplify(&task, &mut quietly).expect("a good shape");
            let cpu = cpu_seconds().zip(cpu_start).map(|(end, start)| end - start);
            let seconds = cpu.unwrap_or(start.elapsed().as_secs_f64());
            let triangles = simplified.mesh.triangles.len();
            println!("{name:>10} {share:>5} {triangles:>9} {seconds:>7.3} {:>11.3e}", simplified.error);
            save(folder.as_deref(), name, share, &simplified.mesh.surface());
        }
    }
}

/// Seconds that this thread has computed, where Linux says so.
fn cpu_seconds() -> Option<f64> {
    let schedule = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = schedule.split(' ').next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}

/// Writes a surface as OBJ, if there is a folder to write it to.
fn save(folder: Option<&str>, name: &str, share: usize, surface: &Surface) {
    let Some(folder) = folder else { return };
    let mut text = String::new();
    for p in &surface.positions {
        writeln!(text, "v {} {} {}", p.x, p.y, p.z).expect("memory");
    }
    for [a, b, c] in &surface.triangles {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).expect("memory");
    }
    fs::write(Path::new(folder).join(format!("{name}_{share}.obj")), text)
        .expect("the folder can be written to");
}
