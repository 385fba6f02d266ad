//! A forest whose last levels are impostors: what that buys under a budget, and what the policies make of it.
//!
//! ```text
//! cargo run --release --features bake,sim --example impostor_forest -- forest
//! lod compare forest/impostor_forest.json
//! ```
//! Bakes the trees of the bundled forest with a few levels of triangles each, adds an octahedral impostor, and plants
//! some thousand of them, once with and once without impostors. Writes both scenes and the path through them to the
//! folder named, and prints a row for each policy and budget.

use std::error::Error;
use std::f32::consts::TAU;
use std::path::Path;

use glam::{Quat, Vec3};
use lod_budget::bake::chain::{Accuracy, Preset, quietly};
use lod_budget::bake::impostor::{Kind, Options};
use lod_budget::bake::{Mesh, Surface};
use lod_budget::files::{CameraPath, Pose, Scene};
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
use lod_budget::scene::{Object, TableId};
use lod_budget::select::{Coarsest, Finest, FunkhouserSequin, Predictive, ScreenSize, Selector};
use lod_budget::sim::Camera;
use lod_budget::sim::generate::{Model, Recipe};
use lod_budget::table::LodTable;
use lod_budget::{Level, Sphere};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const TREES: u64 = 4000;

/// Half of a side of the forest, in metres.
const REACH: f32 = 400.0;

/// Of one frame; the runtime spends three quarters, as long as nobody measures.
const BUDGETS_US: [f64; 4] = [500.0, 1000.0, 2000.0, 4000.0];

/// Frames that are looked at, per second of the path.
const FPS: f64 = 2.0;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "forest".to_owned());
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for model in Recipe::Forest.models() {
        if ["beech", "spruce", "birch"].contains(&model.name.as_str()) {
            let [triangles, pictures] = tables(&mesh_of(model))?;
            without.push(triangles);
            with.push(pictures);
        }
    }
    let scenes = [planted("triangle_forest", without)?, planted("impostor_forest", with)?];
    let path = walk()?;
    write(&scenes, &path, Path::new(&folder))?;
    println!("| scene | policy | budget | cost | benefit | trees as impostors |");
    println!("|---|---|---:|---:|---:|---:|");
    let camera = Camera { fps: FPS, ..Camera::default() };
    let most = run(&scenes[0], &path, camera, Box::new(Finest), f64::MAX)?;
    for budget_us in BUDGETS_US {
        for scene in &scenes {
            for (name, policy) in policies() {
                let Sum { cost_us, benefit, impostors } = run(scene, &path, camera, policy, budget_us)?;
                println!(
                    "| {} | {name} | {budget_us} µs | {cost_us:.0} µs | {:.4} | {:.1} % |",
                    scene.name,
                    benefit / most.benefit,
                    100.0 * impostors
                );
            }
        }
    }
    Ok(())
}

fn mesh_of(model: Model) -> Mesh {
    let surface = Surface { positions: model.positions, triangles: model.triangles };
    Mesh { name: model.name, ..surface.into() }
}

/// Of the levels of triangles, and with the impostor.
fn tables(tree: &Mesh) -> Result<[LodTable; 2], Box<dyn Error>> {
    let chain = Preset::SmallProp.plan().bake(tree, &mut quietly)?;
    let impostor = Options::new(Kind::Octahedral { frames: 9, hemisphere: true }).bake(tree)?;
    let joined = impostor.join(&chain, Accuracy::Rms)?;
    let table = chain.table(Accuracy::Rms)?;
    for (i, level) in joined.table.levels().iter().enumerate() {
        println!(
            "{} {i}: {} triangles, accuracy {:.4}, error {:?}",
            tree.name, level.triangles, level.accuracy, level.error
        );
    }
    println!(
        "{}: {} of {} levels stay; atlas {} × {}, rms {:.3} m, fill {:.2}\n",
        tree.name,
        joined.kept,
        chain.levels.len(),
        impostor.atlas.width_px,
        impostor.atlas.height_px,
        impostor.rms,
        impostor.fill
    );
    Ok([table, joined.table])
}

/// Trees all over the square, on level ground, of 0.6 to 1.3 times their size.
fn planted(name: &str, tables: Vec<LodTable>) -> Result<Scene, Box<dyn Error>> {
    let mut dice = Pcg64Mcg::seed_from_u64(1995);
    let mut objects = Vec::new();
    for id in 0..TREES {
        let kind = dice.random_range(0..tables.len());
        let [x, z] = [0, 1].map(|_| dice.random_range(-REACH..REACH));
        let scale = dice.random_range(0.6..1.3);
        let bounds = tables[kind].bounds();
        let center = bounds.center * scale + Vec3::new(x, 0.0, z);
        objects.push(Object::new(
            id,
            Sphere::new(center, bounds.radius * scale),
            TableId(u16::try_from(kind)?),
        ));
    }
    Ok(Scene { name: name.to_owned(), tables, objects })
}

/// Through the forest at eye level, then up above the trees: 40 s.
fn walk() -> Result<CameraPath, Box<dyn Error>> {
    let pose = |i: u32| {
        let share = i as f32 / 400.0;
        let climb = (share - 0.6).max(0.0) * 150.0;
        let place = Vec3::new(0.0, 1.8 + climb, REACH * (0.9 - 1.2 * share));
        let turn = Quat::from_rotation_y(0.1 * TAU * (share * TAU).sin());
        let rotation = turn * Quat::from_rotation_x(-0.006 * climb);
        Pose { time_s: f64::from(i) / 10.0, position: place.as_dvec3(), rotation }
    };
    Ok(CameraPath::new("walk", (0..=400).map(pose).collect())?)
}

fn write(scenes: &[Scene], path: &CameraPath, folder: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    for scene in scenes {
        scene.write(&folder.join(format!("{}.json", scene.name)))?;
        path.write(&folder.join(format!("{}.csv", scene.name)))?;
    }
    Ok(())
}

fn policies() -> [(&'static str, Box<dyn Selector>); 4] {
    [
        ("predictive", Box::new(Predictive::default())),
        ("Funkhouser, Séquin", Box::new(FunkhouserSequin::default())),
        ("screen size", Box::new(ScreenSize::default())),
        ("coarsest", Box::new(Coarsest)),
    ]
}

/// Means over the frames of a path.
#[derive(Default)]
struct Sum {
    cost_us: f64,
    benefit: f64,
    /// Share of the trees in view.
    impostors: f64,
}

fn run(
    scene: &Scene,
    path: &CameraPath,
    camera: Camera,
    policy: Box<dyn Selector>,
    budget_us: f64,
) -> Result<Sum, Box<dyn Error>> {
    let mut runtime = Runtime::new(RuntimeOptions::default(), policy)?;
    let mut objects = scene.to_objects()?;
    let mut sum = Sum::default();
    let frames = camera.frames(path);
    for k in 0..frames {
        let view = camera.view(&path.sample(k as f64 / FPS));
        let report = runtime.frame(&mut objects, &FrameInput::new(&[ViewInput::new(view, 0)], budget_us));
        sum.cost_us += report.select.cost_us / frames as f64;
        sum.benefit += report.select.benefit / frames as f64;
        let frame = runtime.last_frame(&objects);
        let is_impostor = |i: usize, level: Level| {
            let table = &scene.tables[usize::from(frame.candidate(i).table)];
            level == table.coarsest() && table.levels()[usize::from(level.0)].triangles == 2
        };
        let wanted = runtime.wanted();
        let shown = (0..wanted.len()).filter(|&i| is_impostor(i, wanted[i])).count();
        sum.impostors += shown as f64 / wanted.len().max(1) as f64 / frames as f64;
    }
    Ok(sum)
}
