//! The smallest embedding: no ECS, a camera that flies through a wood, and a machine that is slower than the model
//! says.
//!
//! ```text
//! cargo run --example embed --no-default-features
//! ```
//!
//! The engine's side of the contract is three things: hand over cameras and a budget, act on the changes, and say how
//! long frames took. Here "acting" is keeping a draw list, and the time comes from a formula.

use std::collections::BTreeMap;
use std::error::Error;

use glam::{Quat, Vec2, Vec3};
use lod_budget::bounds::Sphere;
use lod_budget::frame::{FrameTime, GroupId};
use lod_budget::rate::CostModel;
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
use lod_budget::scene::{Object, ObjectId, Objects};
use lod_budget::select::Predictive;
use lod_budget::table::{Level, LevelRecord, LodTable};
use lod_budget::view::View;

const BUDGET_US: f64 = 6_000.0;
/// The machine is this much slower than the cost model believes at first.
const MACHINE: f64 = 1.3;
/// Timer queries are read this many frames later.
const LATENCY: usize = 2;

fn main() -> Result<(), Box<dyn Error>> {
    let mut objects = wood()?;
    let mut runtime = Runtime::new(RuntimeOptions::default(), Box::new(Predictive::default()))?;
    let mut draw_list = BTreeMap::new();
    let mut timers: Vec<FrameTime> = Vec::new();

    println!("frame  in view  drawn  changes  target_us  measured_us  gap");
    for frame in 0..240 {
        // 1. Cameras, a budget, and the time of the frame before the one before.
        let views = [ViewInput::new(camera(frame), 0)];
        let known = timers.len().saturating_sub(LATENCY);
        let measured = &timers[known.saturating_sub(1)..known];
        let input = FrameInput { measured, ..FrameInput::new(&views, BUDGET_US) };
        let report = *runtime.frame(&mut objects, &input);

        // 2. Act on what has changed: an engine would upload, swap meshes or start a fade here.
        for change in runtime.changes() {
            match change.new {
                Level::NOT_DRAWN => draw_list.remove(&change.object),
                level => draw_list.insert(change.object, level),
            };
        }

        // 3. Draw, and time it.
        let measured_us = draw(&runtime, &objects);
        timers.push(FrameTime::busy(report.frame, measured_us as f32));
        if frame % 24 == 0 {
            let gap = report.select.certificate.map_or(f64::NAN, |c| c.gap);
            let (changes, target_us) = (runtime.changes().len(), report.budget.target_us);
            println!(
                "{frame:>5} {:>8} {:>6} {changes:>8} {target_us:>10.0} {measured_us:>12.0}  {gap:.1e}",
                report.candidates,
                draw_list.len(),
            );
        }
    }
    // The delta list is all an engine needs: it leads to the same picture as asking for everything.
    let shown = runtime.shown_slots(GroupId(0)).filter(|(_, shown)| shown.level.is_drawn());
    assert_eq!(shown.count(), draw_list.len());
    explain(&runtime, &objects, &draw_list);
    Ok(())
}

/// Three thousand trees and rocks on a jittered grid.
fn wood() -> Result<Objects, Box<dyn Error>> {
    let mut objects = Objects::new();
    let tree = objects.add_table(chain("tree", 4.0, 60_000)?)?;
    let rock = objects.add_table(chain("rock", 1.0, 8_000)?)?;
    for i in 0..3_000_u64 {
        let jitter = (i * 7919 % 100) as f32 * 0.05;
        let (x, z) = ((i % 50) as f32 * 6.0 - 150.0 + jitter, (i / 50) as f32 * -6.0 - jitter);
        let (table, radius) = if i % 3 == 0 { (rock, 1.0) } else { (tree, 4.0) };
        objects.insert(Object::new(i, Sphere::new(Vec3::new(x, radius, z), radius), table))?;
    }
    Ok(objects)
}

/// Five levels, each a quarter of the one before.
fn chain(name: &str, radius: f32, triangles: u32) -> Result<LodTable, Box<dyn Error>> {
    let levels = (0..5).map(|l| LevelRecord::new(triangles >> (2 * l), triangles >> (2 * l + 1)));
    Ok(LodTable::new(name, Sphere::new(Vec3::ZERO, radius), levels.collect())?)
}

/// Flies forward above the ground and comes to rest after 160 frames.
fn camera(frame: u32) -> View {
    let eye = Vec3::new(0.0, 3.0, 20.0 - 0.5 * frame.min(160) as f32);
    View::perspective(1.0, Vec2::new(1920.0, 1080.0)).at(eye, Quat::IDENTITY)
}

/// Stands for the GPU: the price of everything that is drawn, on a machine slower than the model.
fn draw(runtime: &Runtime, objects: &Objects) -> f64 {
    let prior = CostModel::default();
    let frame = runtime.last_frame(objects);
    let price = |(i, level): (usize, &Level)| {
        let c = frame.candidate(i);
        let record = objects.tables()[usize::from(c.table)].levels().get(level.index());
        let geometry_us = record.map(|record| prior.geometry_us(record));
        geometry_us.map_or(0.0, |us| prior.object_us(us, f64::from(c.cost_scale), f64::from(c.area_px2)))
    };
    MACHINE * runtime.wanted().iter().enumerate().map(price).sum::<f64>()
}

/// Why the tree that is nearest to a fair question is drawn as it is.
fn explain(runtime: &Runtime, objects: &Objects, draw_list: &BTreeMap<ObjectId, Level>) {
    let asked = draw_list.iter().find(|&(_, &level)| level == Level(2));
    let why = asked.and_then(|(&id, _)| Some((id, runtime.explain(objects, GroupId(0), id)?)));
    if let Some((ObjectId(id), why)) = why {
        println!("object {id} is at {}: {:?}, {:.0} px wide.", why.shown.level, why.cause, why.size_px);
        println!(
            "The next level would gain {:.3} px² per µs; the going rate is {:.3}.",
            why.next_value, why.lambda
        );
    }
}
