//! A mixed scene under one budget: props with a few levels each, a forest that ends in impostors, and one terrain that is
//! a vertex hierarchy.
//!
//! ```text
//! cargo run --release --features bake,sim --example mixed -- [FOLDER] [BUDGET_MS] [CELLS]
//! lod compare FOLDER/mixed.json --path FOLDER/mixed.csv
//! ```
//!
//! Bakes everything, writes the scene and a camera path to FOLDER, and runs the path, with the table of the terrain as
//! in the file and with one that a cut offers anew in every frame. To the selection the terrain is an object with a
//! table of some fifty levels; the triangles of the level that it chooses are the budget of the cut. CELLS is how many the
//! terrain has on a side (512 for 524 288 triangles). Prints Markdown, a line per second.

mod drive;
mod ground;
mod walk;
mod world;

use std::error::Error;
use std::path::Path;

use drive::{Offer, Row, drive};
use lod_budget::sim::Camera;
use world::{Sort, World};

/// Times the budget that a frame may take before it counts as missed, as in `lod compare`.
const MISSED: f64 = 1.05;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let at = |i: usize, default: &str| arguments.get(i).cloned().unwrap_or(default.into());
    let (folder, budget_ms): (String, f64) = (at(0, "mixed"), at(1, "1.2").parse()?);
    let world = world::bake(at(2, "512").parse()?)?;
    write(&world, Path::new(&folder))?;
    tell(&world);
    let camera = Camera::default();
    for offer in [Offer::Fixed, Offer::EveryFrame] {
        let rows = drive(&world, camera, 1e3 * budget_ms, offer)?;
        println!("\n## Terrain's table: {offer:?}, budget {budget_ms} ms\n");
        seconds(&rows, camera.fps as usize);
        totals(&rows, 1e3 * budget_ms);
    }
    Ok(())
}

fn write(world: &World, folder: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    world.scene.write(&folder.join("mixed.json"))?;
    Ok(world.path.write(&folder.join("mixed.csv"))?)
}

/// The tables in a line each.
fn tell(world: &World) {
    for (table, sort) in world.scene.tables.iter().zip(&world.sorts) {
        let levels = table.levels();
        let ends = [&levels[0], &levels[levels.len() - 1]];
        let [most, least] = ends.map(|level| level.triangles);
        let picture = if matches!(sort, Sort::Tree(Some(_))) { ", the last an impostor" } else { "" };
        let accuracy = ends[1].accuracy;
        println!(
            "{}: {} levels{picture}, {most} to {least} triangles, accuracy {accuracy:.3}",
            table.name(),
            levels.len()
        );
    }
}

/// The frame at every full second.
fn seconds(rows: &[Row], fps: usize) {
    println!(
        "| s | predicted | machine | gap | terrain: may have | has | px off | terrain | trees | props | props by level | trees as triangles | as impostors |"
    );
    println!("|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---|---:|---:|");
    for (second, row) in rows.iter().step_by(fps).enumerate() {
        let gap = row.gap.map_or("none".to_owned(), |gap| format!("{:.3} %", 100.0 * gap));
        let [terrain, trees, props] = row.spread_us;
        let levels: Vec<String> = row.props.iter().map(usize::to_string).collect();
        println!(
            "| {second} | {:.0} µs | {:.0} µs | {gap} | {} | {} | {:.2} | {terrain:.0} µs | {trees:.0} µs | {props:.0} µs | {} | {} | {} |",
            row.predicted_us,
            row.time_us,
            row.allowed,
            row.used,
            row.off_px,
            levels.join(" "),
            row.trees[0],
            row.trees[1]
        );
    }
}

fn totals(rows: &[Row], budget_us: f64) {
    let count = |is: &dyn Fn(&Row) -> bool| rows.iter().filter(|row| is(row)).count();
    let mean = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).sum::<f64>() / rows.len().max(1) as f64;
    let most = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).fold(0.0, f64::max);
    println!(
        "\n{} frames; on the mean {:.0} µs by the machine, the terrain off by {:.2} px",
        rows.len(),
        mean(&|r| r.time_us),
        mean(&|r| f64::from(r.off_px))
    );
    println!("cut with more triangles than allowed: {} frames", count(&|r| r.used > r.allowed));
    let switches = rows.windows(2).filter(|pair| pair[0].allowed != pair[1].allowed).count();
    println!("triangles allowed to the terrain change in {switches} frames");
    println!("selection beyond its budget: {} frames", count(&|r| r.cost_us > r.select_us * (1.0 + 1e-9)));
    println!("the cheapest of everything beyond the budget: {} frames", count(&|r| r.infeasible_us > 0.0));
    println!(
        "without a certificate: {} frames; gap at most {:.3} %",
        count(&|r| r.gap.is_none()),
        100.0 * most(&|r| r.gap.unwrap_or(0.0))
    );
    println!("predicted over the budget: {} frames", count(&|r| r.predicted_us > budget_us));
    println!(
        "machine over {MISSED} × the budget: {} frames, at most {:.2} ×",
        count(&|r| r.time_us > MISSED * budget_us),
        most(&|r| r.time_us) / budget_us
    );
}
