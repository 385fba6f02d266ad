//! A hecs world as the scene: a crowd walks past, people come and go, and the draw loop is a query.
//!
//! ```text
//! cargo run --example hecs_loop
//! ```
//!
//! The world stays the engine's. `Bridge::sync` carries what has changed into the store before the frame,
//! `Bridge::write_back` carries the levels back after it.

use std::error::Error;

use glam::{Quat, Vec2, Vec3};
use hecs::{Entity, World};
use lod_budget::bounds::Sphere;
use lod_budget::ecs::{Bridge, LodBounds, LodObject, LodSettings, LodShown};
use lod_budget::frame::FrameTime;
use lod_budget::rate::CostModel;
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
use lod_budget::scene::{ObjectId, Objects, Settings, TableId};
use lod_budget::select::Predictive;
use lod_budget::table::{LevelRecord, LodTable};
use lod_budget::transition::{TransitionKind, TransitionOptions};
use lod_budget::view::View;

const BUDGET_US: f64 = 2_000.0;
const MACHINE: f64 = 0.8;
const PEOPLE: u64 = 600;

/// The game's own component: where a person walks to, in metres per second.
struct Walk(Vec3);

fn main() -> Result<(), Box<dyn Error>> {
    let mut objects = Objects::new();
    let person = objects.add_table(person()?)?;
    let mut world = World::new();
    let mut bridge = Bridge::new();
    let transition = TransitionOptions { kind: TransitionKind::CrossFade, ..TransitionOptions::default() };
    let options = RuntimeOptions { transition, ..RuntimeOptions::default() };
    let mut runtime = Runtime::new(options, Box::new(Predictive::default()))?;

    let mut crowd: Vec<Entity> = (0..PEOPLE).map(|id| spawn(&mut world, id, person)).collect();
    let hero = spawn(&mut world, 1_000_015, person);
    world.insert_one(hero, LodSettings(Settings { importance: 10.0, ..Settings::default() }))?;

    let view = View::perspective(1.0, Vec2::new(1920.0, 1080.0));
    let views = [ViewInput::new(view.at(Vec3::new(0.0, 1.7, 5.0), Quat::IDENTITY), 0)];
    let mut timers: Vec<FrameTime> = Vec::new();
    println!("frame  new  gone  moved  in view  written  fades  target_us  measured_us");
    for frame in 0..180_u64 {
        walk(&mut world);
        replace_one(&mut world, &mut crowd, frame, person)?;

        let synced = bridge.sync(&mut world, &mut objects)?;
        let measured = timers.iter().rev().nth(1).copied();
        let input = FrameInput { measured: measured.as_slice(), ..FrameInput::new(&views, BUDGET_US) };
        let report = *runtime.frame(&mut objects, &input);
        let written = bridge.write_back::<0>(&mut world, &objects, &runtime);

        let measured_us = draw(&world, &objects);
        timers.push(FrameTime::busy(report.frame, measured_us as f32));
        if frame % 20 == 0 {
            println!(
                "{frame:>5} {:>4} {:>5} {:>6} {:>8} {written:>8} {:>6} {:>10.0} {measured_us:>12.0}",
                synced.inserted,
                synced.removed,
                synced.moved,
                report.candidates,
                report.fades,
                report.budget.target_us,
            );
        }
    }
    let neighbour = bridge.entity_of(ObjectId(385)).ok_or("the neighbour has left")?;
    let level_of = |entity| world.get::<&LodShown>(entity).map(|shown| shown.0.level);
    println!("The hero is at {}, a neighbour at {}.", level_of(hero)?, level_of(neighbour)?);

    // A mistake names the entity, the object and the rule, and harms nothing else.
    world.spawn((LodObject { id: ObjectId(1_000_015), table: person }, LodBounds::default()));
    if let Err(error) = bridge.sync(&mut world, &mut objects) {
        println!("Refused: {error}. {} objects are in the store.", objects.len());
    }
    Ok(())
}

fn person() -> Result<LodTable, Box<dyn Error>> {
    let levels = [24_000, 9_000, 3_000, 800, 150].map(|triangles| LevelRecord::new(triangles, triangles / 2));
    Ok(LodTable::new("person", Sphere::new(Vec3::ZERO, 1.0), levels.into())?)
}

/// Spawning with the result component spares a move between archetypes when the person is first seen.
fn spawn(world: &mut World, id: u64, table: TableId) -> Entity {
    let (column, row) = ((id % 30) as f32, (id / 30 % 20) as f32);
    let place = Vec3::new(column * 2.0 - 29.0, 1.0, row * -3.0);
    let walk = Walk(Vec3::new(if id.is_multiple_of(2) { 1.2 } else { -1.2 }, 0.0, 0.0));
    let bounds = LodBounds(Sphere::new(place, 1.0));
    world.spawn((LodObject { id: ObjectId(id), table }, bounds, walk, LodShown::<0>::default()))
}

fn walk(world: &mut World) {
    for (LodBounds(bounds), Walk(velocity)) in world.query_mut::<(&mut LodBounds, &Walk)>() {
        bounds.center += *velocity / 60.0;
    }
}

/// Somebody leaves and somebody else comes, under a new id.
fn replace_one(
    world: &mut World,
    crowd: &mut [Entity],
    frame: u64,
    table: TableId,
) -> Result<(), Box<dyn Error>> {
    let leaver = frame as usize * 37 % crowd.len();
    world.despawn(crowd[leaver])?;
    crowd[leaver] = spawn(world, PEOPLE + frame, table);
    Ok(())
}

/// The draw loop, and in place of the GPU the price of each level; a cross-fade draws two.
fn draw(world: &World, objects: &Objects) -> f64 {
    let prior = CostModel::default();
    let mut time_us = 0.0;
    for (lod, LodShown(shown)) in world.query::<(&LodObject, &LodShown)>().iter() {
        let levels = objects.tables()[usize::from(lod.table.0)].levels();
        let outgoing = Some(shown.from).filter(|_| shown.is_in_flight());
        let drawn = [Some(shown.level), outgoing].into_iter().flatten().filter(|level| level.is_drawn());
        time_us += drawn.map(|level| prior.geometry_us(&levels[level.index()])).sum::<f64>();
    }
    MACHINE * time_us
}
