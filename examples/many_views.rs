//! Many views, one budget: a headset's two eyes, the shadows they see, and a second player's half of a screen.
//!
//! ```text
//! cargo run --example many_views --no-default-features
//! ```
//!
//! Views of one group show the same level of every object: the eyes must not disagree. Groups choose apart, but all of
//! them compete for the same microseconds under one multiplier, so that the budget goes where it shows most.

use std::error::Error;
use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Quat, Vec2, Vec3};
use lod_budget::bounds::Sphere;
use lod_budget::frame::{FrameTime, GroupId};
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
use lod_budget::scene::{Object, Objects};
use lod_budget::select::Predictive;
use lod_budget::table::{LevelRecord, LodTable};
use lod_budget::view::{Projection, View, Window};

const EYES: u32 = 0;
const SHADOWS: u32 = 1;
const GUEST: u32 = 2;
const BUDGET_US: f64 = 4_000.0;
/// The machine, against the cost model.
const MACHINE: f64 = 1.15;

fn main() -> Result<(), Box<dyn Error>> {
    let mut objects = square()?;
    let mut runtime = Runtime::new(RuntimeOptions::default(), Box::new(Predictive::default()))?;
    let mut timers: Vec<FrameTime> = Vec::new();
    println!("              eyes               shadows            guest");
    println!(
        "frame   views in view cost_us   in view cost_us   in view cost_us   sum_us  target_us  measured_us"
    );
    for frame in 0..150_u32 {
        // The guest joins after a second and leaves again: groups come and go, and no number of views is too many.
        let guest_plays = (60..120).contains(&frame);
        let views: Vec<ViewInput<'_>> = cameras(frame, guest_plays);
        let measured = timers.iter().rev().nth(1).copied();
        let input = FrameInput { measured: measured.as_slice(), ..FrameInput::new(&views, BUDGET_US) };
        let report = *runtime.frame(&mut objects, &input);

        let costs = [EYES, SHADOWS, GUEST].map(|group| cost_of(&runtime, &objects, GroupId(group)));
        let sum_us: f64 = costs.iter().map(|&(_, cost_us)| cost_us).sum();
        let measured_us = MACHINE * sum_us;
        timers.push(FrameTime::busy(report.frame, measured_us as f32));
        if frame % 15 == 0 {
            print!("{frame:>5} {:>7}", views.len());
            costs.iter().for_each(|(in_view, cost_us)| print!(" {in_view:>7} {cost_us:>7.0}  "));
            println!("{sum_us:>7.0} {:>10.0} {measured_us:>12.0}", report.budget.target_us);
        }
    }
    compare_groups(&runtime, &objects);
    Ok(())
}

/// Four hundred market stalls on a square.
fn square() -> Result<Objects, Box<dyn Error>> {
    let levels = (0..5).map(|l| LevelRecord::new(80_000 >> (2 * l), 40_000 >> (2 * l))).collect();
    let mut objects = Objects::new();
    let stall = objects.add_table(LodTable::new("stall", Sphere::new(Vec3::ZERO, 1.5), levels)?)?;
    for i in 0..400_u64 {
        let place = Vec3::new((i % 20) as f32 * 4.0 - 38.0, 1.5, (i / 20) as f32 * -4.0);
        objects.insert(Object::new(i, Sphere::new(place, 1.5), stall))?;
    }
    Ok(objects)
}

fn cameras(frame: u32, guest_plays: bool) -> Vec<ViewInput<'static>> {
    let head = Vec3::new(0.0, 1.7, 8.0 - 0.05 * frame as f32);
    let mut views = vec![
        ViewInput::new(eye(head, -1.0), EYES),
        ViewInput::new(eye(head, 1.0), EYES),
        ViewInput::new(sun(head), SHADOWS),
    ];
    if guest_plays {
        let behind = Quat::from_rotation_y(PI);
        let half = View::perspective(1.0, Vec2::new(960.0, 1080.0)).at(Vec3::new(9.0, 1.7, -84.0), behind);
        views.push(ViewInput::new(half, GUEST));
    }
    views
}

/// An eye of a headset, 32 mm beside the nose: it sees farther to its own side. Tangents, as the headset reports them.
fn eye(head: Vec3, side: f32) -> View {
    let (outwards, inwards) = (1.2, 0.9);
    let (left, right) = if side < 0.0 { (-outwards, inwards) } else { (-inwards, outwards) };
    let window = Window { left, right, bottom: -1.1, top: 1.0 };
    let lens = View::through(Projection::Perspective(window), Vec2::new(1680.0, 1760.0));
    View { far: 60.0, ..lens }.at(head + Vec3::new(0.032 * side, 0.0, 0.0), Quat::IDENTITY)
}

/// The sun's view of what lies before the head: straight down, and no finer than the shadow map.
fn sun(head: Vec3) -> View {
    let above = head + Vec3::new(0.0, 40.0, -20.0);
    View::orthographic(50.0, Vec2::new(1024.0, 1024.0)).at(above, Quat::from_rotation_x(-FRAC_PI_2))
}

/// How many objects a group sees, and what the cost model charges for them.
fn cost_of(runtime: &Runtime, objects: &Objects, group: GroupId) -> (usize, f64) {
    let frame = runtime.last_frame(objects);
    let range = runtime.candidates().range(group);
    let price = |i| frame.cost_us(i, runtime.wanted()[i]);
    let cost_us = range.clone().map(price).fold(0.0, |sum, us| sum + us);
    (range.len(), cost_us)
}

/// A stall near the head is worth more to the eyes than to the shadow map.
fn compare_groups(runtime: &Runtime, objects: &Objects) {
    let near = lod_budget::scene::ObjectId(10);
    for (name, group) in [("eyes", EYES), ("shadows", SHADOWS)] {
        if let Some(why) = runtime.explain(objects, GroupId(group), near) {
            println!(
                "Object {} is {:.0} px wide to the {name} and shown at {}; λ is {:.2} px²/µs for all.",
                near.0, why.size_px, why.shown.level, why.lambda
            );
        }
    }
}
