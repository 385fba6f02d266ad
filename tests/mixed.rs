//! Props, a forest that ends in impostors, and a terrain whose cut gets the triangles of its level: one budget for all.
#![cfg(feature = "bake")]

use std::sync::Arc;

use glam::{Mat3, Quat, Vec2, Vec3};
use lod_budget::Sphere;
use lod_budget::bake::chain::{Accuracy, Plan};
use lod_budget::bake::impostor::{Kind, Options};
use lod_budget::bake::simplify::{GarlandHeckbert, quietly};
use lod_budget::bake::{Mesh, Surface, chain, hierarchy, shapes};
use lod_budget::check::{Promise, Replay};
use lod_budget::frame::GroupId;
use lod_budget::hierarchy::{Budget, Cut, Hierarchy};
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
use lod_budget::scene::{Object, ObjectId, Objects, TableId};
use lod_budget::select::{Frame, Predictive};
use lod_budget::table::LodTable;
use lod_budget::view::View;

const FRAMES: usize = 100;

/// Tables, by what they are of.
const TERRAIN: u16 = 0;
const TREE: u16 = 1;
const PROP: u16 = 2;

/// Length of a side of the terrain.
const SIDE: f32 = 200.0;

struct World {
    objects: Objects,
    tables: Vec<LodTable>,
    hierarchy: Arc<Hierarchy>,
    positions: Vec<Vec3>,
}

/// Forty cells on a side, with +Y up around the origin.
fn hills() -> Surface {
    let mut hills = shapes::terrain(40, 3);
    hills.positions.iter_mut().for_each(|p| *p = Vec3::new(p.x - 0.5, 0.3 * p.z, 0.5 - p.y) * SIDE);
    hills
}

fn world() -> World {
    let hills = hills();
    let positions = hills.positions.clone();
    let hierarchy = hierarchy::of(&hills.into(), &GarlandHeckbert::default(), &mut quietly).expect("a mesh");
    let terrain = hierarchy.table("terrain", 40).expect("it has an extent");
    let tables = vec![terrain, tree(), prop()];
    let objects = planted(&tables, &positions);
    World { objects, tables, hierarchy: Arc::new(hierarchy), positions }
}

/// A crown with a picture of itself as the last level.
fn tree() -> LodTable {
    let crown: Mesh = shapes::torus_knot(24, 6).into();
    let chain = Plan::default().bake(&crown, &mut chain::quietly).expect("a good mesh");
    let kind = Kind::Octahedral { frames: 3, hemisphere: true };
    let impostor = Options::new(kind).bake(&crown).expect("a good mesh");
    let joined = impostor.join(&chain, Accuracy::Hausdorff).expect("a good chain");
    assert_eq!(joined.left_out, None, "the forest has impostors");
    joined.table
}

fn prop() -> LodTable {
    let rock: Mesh = shapes::icosphere(5).into();
    let chain = Plan::default().bake(&rock, &mut chain::quietly).expect("a good mesh");
    chain.table(Accuracy::Hausdorff).expect("a good chain")
}

/// Trees on one half of the terrain and props on the other, on its vertices.
fn planted(tables: &[LodTable], positions: &[Vec3]) -> Objects {
    let mut objects = Objects::new();
    for table in tables {
        objects.add_table(table.clone()).expect("room for three");
    }
    let terrain = Object::new(0, tables[0].bounds(), TableId(TERRAIN));
    objects.insert(terrain).expect("the first");
    for (id, &place) in (1u64..).zip(positions.iter().step_by(5)) {
        let (table, radius) = if place.x < 0.0 { (TREE, 3.0) } else { (PROP, 1.0) };
        let bounds = Sphere::new(place + Vec3::Y * radius, radius);
        objects.insert(Object::new(id, bounds, TableId(table))).expect("a new id");
    }
    objects
}

/// From high above the middle down among the trees, then through the props.
fn camera(world: &World, frame: usize) -> View {
    let share = frame as f32 / (FRAMES - 1) as f32;
    let height = world.positions.iter().map(|p| p.y).fold(0.0, f32::max) + 2.0;
    let x = (2.0 * share - 1.0) * 0.45 * SIDE;
    let eye = Vec3::new(x, height + 60.0 * (0.3 - share).max(0.0), 0.4 * SIDE);
    let forward = Vec3::new(0.3 * (6.0 * share).sin(), -0.25, -1.0).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let rotation = Quat::from_mat3(&Mat3::from_cols(right, right.cross(forward), -forward));
    View { far: 1000.0, ..View::perspective(1.0, Vec2::new(1280.0, 720.0)).at(eye, rotation) }
}

/// What each table's objects cost by the model in the last frame.
fn spread_us(runtime: &Runtime, objects: &Objects) -> [f64; 3] {
    let detailed = runtime.last_frame(objects).detailed();
    let frame = Frame { candidates: &detailed, ..runtime.last_frame(objects) };
    let mut spread_us = [0.0; 3];
    for (i, &level) in runtime.wanted().iter().enumerate() {
        spread_us[usize::from(detailed.table[i])] += frame.cost_us(i, level);
    }
    spread_us
}

/// A budget between all at their cheapest and all at their finest over the middle of the terrain.
fn budget_us(world: &World) -> f64 {
    let mut runtime = runtime(RuntimeOptions::default());
    let views = [ViewInput::new(camera(world, 0), 0)];
    let mut objects = world.objects.clone();
    let mut cost_us =
        |budget_us| runtime.frame(&mut objects, &FrameInput::new(&views, budget_us)).select.cost_us;
    let (most, least) = (cost_us(1e12), cost_us(0.0));
    assert!(least < 0.8 * most, "there is something to choose: {least} to {most} µs");
    // Three quarters are spent as long as nobody measures.
    (0.6 * least + 0.4 * most) / 0.75
}

fn runtime(options: RuntimeOptions) -> Runtime {
    Runtime::new(options, Box::new(Predictive::default())).expect("good options")
}

/// A hundred frames; the cost of each table in each.
fn run(world: &World, offers: bool) -> Vec<[f64; 3]> {
    let options = RuntimeOptions::default();
    let (mut runtime, mut replay) = (runtime(options), Replay::new(options));
    let (mut objects, mut cut) = (world.objects.clone(), Cut::new(world.hierarchy.clone()));
    let budget_us = budget_us(world);
    let table = &world.tables[usize::from(TERRAIN)];
    let mut spreads = Vec::new();
    for frame in 0..FRAMES {
        let view = camera(world, frame);
        if offers {
            let offer = cut.offer(table).expect("a good table");
            objects.replace_table(TableId(TERRAIN), offer).expect("as many levels");
        }
        let views = [ViewInput::new(view, 0)];
        let input = FrameInput::new(&views, budget_us);
        let report = *runtime.frame(&mut objects, &input);
        if let Err(violation) = replay.frame(&runtime, &objects, &input, Promise::Budget) {
            panic!("frame {frame}: {violation}");
        }
        assert_eq!(report.select.infeasible_us, 0.0, "frame {frame} can be had for the budget");
        assert!(report.select.cost_us <= report.budget.select_us, "frame {frame} keeps it: {report:?}");
        assert!(report.predicted_us <= budget_us, "frame {frame} is expected to: {report:?}");
        let certificate = report.select.certificate.expect("there is one");
        assert!(certificate.upper_bound >= report.select.benefit);

        let level = runtime.shown(&objects, GroupId(0), ObjectId(0)).level;
        assert!(level.is_drawn(), "the eye is within the terrain's bound");
        let allowed = table.levels()[level.index()].triangles as usize;
        let used = cut.update(&[view], &Budget::triangles(allowed)).triangles;
        assert!(used <= allowed, "frame {frame}: {used} of {allowed} triangles");
        spreads.push(spread_us(&runtime, &objects));
    }
    spreads
}

/// How much of the budget goes to a table at least and at most, as shares of what is spent.
fn range(spreads: &[[f64; 3]], table: u16) -> (f64, f64) {
    let shares = spreads.iter().map(|s| s[usize::from(table)] / s.iter().sum::<f64>());
    shares.fold((1.0, 0.0), |(least, most), share| (share.min(least), share.max(most)))
}

#[test]
fn one_budget_holds_for_terrain_trees_and_props() {
    let world = world();
    for offers in [false, true] {
        let spreads = run(&world, offers);
        for table in [TERRAIN, TREE, PROP] {
            let (least, most) = range(&spreads, table);
            assert!(
                most > 0.0 && most - least > 0.05,
                "table {table} gets {least} to {most} wherever the camera is"
            );
        }
    }
}

#[test]
fn an_offer_keeps_triangles_and_order_of_levels() {
    let world = world();
    let table = &world.tables[usize::from(TERRAIN)];
    let mut cut = Cut::new(world.hierarchy.clone());
    assert_eq!(&cut.offer(table).expect("a good table"), table, "no camera, no other worth");
    for frame in [0, FRAMES / 2, FRAMES - 1] {
        cut.update(&[camera(&world, frame)], &Budget::triangles(400));
        let offer = cut.offer(table).expect("a good table");
        assert_ne!(offer.levels(), table.levels());
        let triangles = |t: &LodTable| t.levels().iter().map(|l| l.triangles).collect::<Vec<_>>();
        assert_eq!(triangles(&offer), triangles(table));
        assert!(offer.levels().is_sorted_by(|finer, coarser| finer.accuracy >= coarser.accuracy));
    }
    let unknown = world.objects.clone().replace_table(TableId(3), table.clone());
    assert!(unknown.is_err(), "there are three tables");
}
