//! A flight over one huge terrain: a cut that follows the camera under a budget of triangles, beside the best level of
//! a chain that has as many.
//!
//! ```text
//! cargo run --release --features bake --example flyover -- [TERRAIN] [TRIANGLES] [PLOT.svg]
//! cargo run --release --features bake --example flyover -- growth [LARGEST] [PLOT.svg] [FOLDER]
//! ```
//!
//! TERRAIN is how many cells a procedural one has on a side (1024 for 2 097 152 triangles), or a file (OBJ, PLY, OFF,
//! STL, GLB; z upwards). How far off either is on the screen is measured at the vertices of the terrain and does not
//! know of any stored bound. `growth` flies over terrains of 10⁴ vertices and more, up to LARGEST cells on a side (3162 for
//! 10⁷ vertices), and shows what a frame's work depends on; their hierarchies are kept in FOLDER, as making the largest
//! takes ten minutes and 5 GB of memory. Prints Markdown.

mod flight;
mod growth;
mod heights;
mod land;
mod plot;

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use flight::Flight;
use heights::Heights;
use lod_budget::bake::simplify::{GarlandHeckbert, Simplifier, Target, Task, quietly};
use lod_budget::bake::{Mesh, Surface, hierarchy, read};
use lod_budget::hierarchy::{Budget, Cut, Hierarchy};

/// Frames of a flight, and how many pass between two measurements.
const FRAMES: usize = 600;
const STRIDE: usize = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let at = |i: usize, default: &str| arguments.get(i).cloned().unwrap_or(default.into());
    let path = |i: usize| arguments.get(i).map(Path::new);
    if at(0, "") == "growth" {
        return growth::show(at(1, "1024").parse()?, path(2), path(3));
    }
    let mesh = terrain(&at(0, "1024"))?;
    fly(&mesh, at(1, "50000").parse()?, path(2))
}

fn terrain(named: &str) -> Result<Mesh, Box<dyn Error>> {
    Ok(match named.parse() {
        Ok(side) => land::land(side).into(),
        Err(_) => read::load(Path::new(named))?.mesh,
    })
}

/// What is known of a frame.
pub struct Row {
    pub triangles: usize,
    pub changes: usize,
    pub evaluated: usize,
    pub us: f64,
    /// What the cut says that it is off by at most, in px.
    pub bound_px: f32,
    /// What the cut and the level are off by, where that was measured.
    pub measured_px: Option<[f32; 2]>,
}

fn fly(mesh: &Mesh, budget: usize, plot: Option<&Path>) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let hierarchy = Arc::new(hierarchy::of(mesh, &GarlandHeckbert::default(), &mut quietly)?);
    println!("{} triangles, hierarchy in {:.1} s", hierarchy.triangles(), start.elapsed().as_secs_f64());
    let heights = Heights::new(&mesh.surface());
    let levels = levels(mesh, &hierarchy, budget)?;
    let grounds: Vec<Vec<f32>> = levels.iter().map(|level| heights.under(level)).collect();
    let flight = Flight::over(&mesh.surface());
    let mut cut = Cut::new(hierarchy);
    let mut rows = Vec::new();
    for frame in 0..FRAMES {
        let view = flight.view(frame as f32 / FRAMES as f32);
        let start = Instant::now();
        let report = cut.update(&[view], &Budget::triangles(budget));
        let us = start.elapsed().as_secs_f64() * 1e6;
        let measured_px = (frame % STRIDE == 0).then(|| {
            let ground = heights.under(&surface(&cut));
            let least = grounds.iter().map(|g| heights.error_px(g, &view)).fold(f32::INFINITY, f32::min);
            [heights.error_px(&ground, &view), least]
        });
        let changes = report.splits + report.merges;
        let bound_px = report.max_error_px;
        rows.push(Row {
            triangles: report.triangles,
            changes,
            evaluated: report.evaluated,
            us,
            bound_px,
            measured_px,
        });
    }
    summarise(&rows);
    plot.map_or(Ok(()), |path| plot::flight(&rows, path))
}

/// What may stand for the whole terrain at that many triangles: a level of the usual chain, and the hierarchy's own
/// record up to there.
fn levels(mesh: &Mesh, hierarchy: &Hierarchy, budget: usize) -> Result<Vec<Surface>, Box<dyn Error>> {
    let task = Task::new(mesh, Target::triangles(budget));
    let level = GarlandHeckbert::default().simplify(&task, &mut quietly)?.mesh.surface();
    Ok(vec![level, prefix(hierarchy, budget)])
}

/// The first operations of the record, until there are so few triangles.
fn prefix(hierarchy: &Hierarchy, budget: usize) -> Surface {
    let parts = hierarchy.parts();
    let leaves = hierarchy.leaves();
    let mut left = parts.triangles.len();
    let mut done = 0;
    while done < parts.operations.len() && left > budget {
        left -= parts.operations[done].triangles as usize;
        done += 1;
    }
    let mut node: Vec<u32> = (0..(leaves + done) as u32).collect();
    for (i, operation) in parts.operations[..done].iter().enumerate().rev() {
        operation.ends.iter().for_each(|&end| node[end as usize] = node[leaves + i]);
    }
    let triangles = parts.triangles[parts.triangles.len() - left..].iter();
    let triangles = triangles.map(|t| t.map(|leaf| node[leaf as usize])).collect();
    Surface { positions: parts.positions.clone(), triangles }
}

/// What the cut shows.
fn surface(cut: &Cut) -> Surface {
    Surface { positions: cut.hierarchy().positions().to_vec(), triangles: cut.triangles().to_vec() }
}

fn summarise(rows: &[Row]) {
    let sorted = |of: &dyn Fn(&Row) -> f64| {
        let mut values: Vec<f64> = rows.iter().skip(1).map(of).collect();
        values.sort_unstable_by(f64::total_cmp);
        values
    };
    let line = |name: &str, values: Vec<f64>| {
        let at = |share: f64| values[((values.len() - 1) as f64 * share) as usize];
        println!("| {name} | {:.1} | {:.1} | {:.1} |", at(0.5), at(0.95), at(1.0));
    };
    println!("\n| per frame, after the first | median | 95 % | most |\n|---|---:|---:|---:|");
    line("triangles", sorted(&|r| r.triangles as f64));
    line("splits and contractions", sorted(&|r| r.changes as f64));
    line("errors worked out", sorted(&|r| r.evaluated as f64));
    line("µs", sorted(&|r| r.us));
    line("bound, px", sorted(&|r| f64::from(r.bound_px)));
    let measured: Vec<[f32; 2]> = rows.iter().skip(1).filter_map(|r| r.measured_px).collect();
    let most = |i: usize| measured.iter().map(|m| m[i]).fold(0.0, f32::max);
    let mut ratios: Vec<f32> = measured.iter().map(|[cut, level]| level / cut).collect();
    ratios.sort_unstable_by(f32::total_cmp);
    println!("\nfirst frame: {:.0} µs, {} changes", rows[0].us, rows[0].changes);
    println!(
        "\nmeasured, most over the flight: cut {:.2} px, level {:.2} px, {:.1} ×",
        most(0),
        most(1),
        most(1) / most(0)
    );
    println!("frame by frame: {:.1} × at least, {:.1} × in the median", ratios[0], ratios[ratios.len() / 2]);
}
