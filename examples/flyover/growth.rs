//! What a frame's work depends on: the change of the cut, not the size of the mesh.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use lod_budget::bake::simplify::{GarlandHeckbert, quietly};
use lod_budget::bake::{Mesh, hierarchy, shapes};
use lod_budget::hierarchy::{Budget, Cut, Hierarchy};

use crate::flight::Flight;
use crate::plot;

/// The smallest terrain, 10⁴ vertices; each has ten times as many as the one before.
const SMALLEST: f64 = 100.0;

/// Triangles of the cut, and frames at each speed.
const TRIANGLES: usize = 8_000;
const FRAMES: usize = 200;

/// What came of a mesh at a speed.
pub struct Point {
    pub vertices: usize,
    /// Splits and contractions per frame, and µs.
    pub changes: f64,
    pub us: f64,
}

/// Flies over ever larger terrains at several speeds. Hierarchies are kept in a folder, if there is one.
pub fn show(largest: u32, plot: Option<&Path>, folder: Option<&Path>) -> Result<(), Box<dyn Error>> {
    println!("| vertices | speed | changes | errors worked out | µs |\n|---:|---:|---:|---:|---:|");
    let sides = (0..).map(|i| SMALLEST * 10f64.sqrt().powi(i)).map(|side| side as u32);
    let mut points = Vec::new();
    for side in sides.take_while(|&side| side <= largest) {
        let surface = shapes::terrain(side, 1);
        let flight = Flight::over(&surface);
        let file = folder.map(|folder| folder.join(format!("terrain-{side}.lodh")));
        let mut cut = Cut::new(Arc::new(hierarchy_of(surface.into(), file.as_deref())?));
        cut.update(&[flight.view(0.0)], &Budget::triangles(TRIANGLES));
        for speed in [0.0, 1.0, 2.0, 4.0, 8.0, 16.0] {
            points.push(at_speed(&mut cut, &flight, speed));
        }
    }
    plot.map_or(Ok(()), |path| plot::growth(&points, path))
}

/// From the file, or made and written there.
fn hierarchy_of(mesh: Mesh, file: Option<&Path>) -> Result<Hierarchy, Box<dyn Error>> {
    if let Some(file) = file.filter(|file| file.exists()) {
        return Ok(hierarchy::read(file)?);
    }
    let hierarchy = hierarchy::of(&mesh, &GarlandHeckbert::default(), &mut quietly)?;
    file.map_or(Ok(()), |file| std::fs::write(file, hierarchy::to_bytes(&hierarchy)))?;
    Ok(hierarchy)
}

/// A stretch of the flight at so many 10 000ths of the round per frame.
fn at_speed(cut: &mut Cut, flight: &Flight, speed: f32) -> Point {
    cut.update(&[flight.view(0.0)], &Budget::triangles(TRIANGLES));
    let (mut changes, mut evaluated) = (0, 0);
    let start = Instant::now();
    for frame in 1..=FRAMES {
        let report = cut.update(&[flight.view(frame as f32 * speed * 1e-4)], &Budget::triangles(TRIANGLES));
        changes += report.splits + report.merges;
        evaluated += report.evaluated;
    }
    let per_frame = |sum: f64| sum / FRAMES as f64;
    let us = per_frame(start.elapsed().as_secs_f64() * 1e6);
    let (changes, evaluated) = (per_frame(changes as f64), per_frame(evaluated as f64));
    let vertices = cut.hierarchy().leaves();
    println!("| {vertices} | {speed} | {changes:.1} | {evaluated:.1} | {us:.1} |");
    Point { vertices, changes, us }
}
