//! `lod generate`: procedural scenes and their camera paths, as files.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use clap::ValueEnum;
use lod_budget::bake::write::obj;
use lod_budget::bake::{Group, Mesh, Surface};
use lod_budget::files::{CameraPath, Scene, write_atomically};
use lod_budget::sim::generate::{Model, Recipe, scatter, scatter_path};
use lod_budget::table::LodTable;
use serde::Serialize;

use crate::text;

/// Write a procedural scene (NAME.json) and a camera path through it (NAME.csv).
///
/// The same seed gives the same bytes on every platform. Without --seed they are those of the bundled scenes.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct Args {
    /// What to make
    #[arg(value_enum)]
    what: What,
    /// Seed of all that chance decides [default: that of the bundled scene; 1 for scatter]
    #[arg(long)]
    seed: Option<u64>,
    /// How many objects a scatter has [default: 10000]
    #[arg(long)]
    objects: Option<usize>,
    /// Folder to write to; made where there is none
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Write the mesh of each kind of object instead, to DIR/CLASS/KIND.obj, CLASS being its preset for `lod bake`
    #[arg(long, conflicts_with_all = ["seed", "objects"])]
    meshes: bool,
    /// Gather the tables that `lod bake --out BAKED` has written of these meshes in DIR/NAME.json instead
    #[arg(long, value_name = "BAKED", conflicts_with_all = ["seed", "objects", "meshes", "json"])]
    tables: Option<PathBuf>,
    /// Print one JSON object and nothing else
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  lod generate building --out scenes
  lod generate city --seed 7
  lod generate forest --meshes --out meshes
  lod generate scatter --objects 100000 --out /tmp";

#[derive(Clone, Copy, ValueEnum)]
enum What {
    /// A furnished building of five storeys
    Building,
    /// A city of ten by ten blocks
    City,
    /// A forest with a festival in a clearing
    Forest,
    /// Any number of objects in blocks like a city's, for benchmarks
    Scatter,
}

impl What {
    /// A scatter has none.
    fn recipe(self) -> Option<Recipe> {
        match self {
            Self::Building => Some(Recipe::Building),
            Self::City => Some(Recipe::City),
            Self::Forest => Some(Recipe::Forest),
            Self::Scatter => None,
        }
    }
}

/// A scatter's size and seed where none are given.
const SCATTER_OBJECTS: usize = 10_000;
const SCATTER_SEED: u64 = 1;
/// Ids and slots of objects are 32 bits wide; memory runs out long before.
const MOST_OBJECTS: usize = 10_000_000;

/// What was written.
#[derive(Serialize)]
struct Written {
    scene: String,
    path: String,
    seed: u64,
    objects: usize,
    tables: usize,
    poses: usize,
}

/// A mesh that was written.
#[derive(Serialize)]
struct WrittenMesh {
    mesh: String,
    triangles: usize,
    materials: usize,
}

pub fn run(args: &Args, out: &mut dyn Write) -> anyhow::Result<()> {
    match &args.tables {
        Some(baked) => gather_tables(args, baked, out),
        None if args.meshes => write_meshes(args, out),
        None => write_scene(args, out),
    }
}

fn gather_tables(args: &Args, baked: &Path, out: &mut dyn Write) -> anyhow::Result<()> {
    let recipe = args.what.recipe().context("--tables: those of a scatter are not measured")?;
    let tables =
        recipe.models().iter().map(|model| baked_table(&model.name, baked)).collect::<Result<_, _>>()?;
    let library = Scene { name: recipe.name().to_owned(), tables, objects: Vec::new() };
    fs::create_dir_all(&args.out).with_context(|| format!("{}: it cannot be made", args.out.display()))?;
    let file = args.out.join(format!("{recipe}.json"));
    library.write(&file)?;
    writeln!(out, "{}: {}", file.display(), text::counted(library.tables.len(), "table"))?;
    Ok(())
}

fn baked_table(name: &str, baked: &Path) -> anyhow::Result<LodTable> {
    let file = baked.join(name).join(format!("{name}.json"));
    let table = Scene::read(&file)?.tables.into_iter().find(|table| table.name() == name);
    table.with_context(|| format!("{}: it must have a table '{name}'", file.display()))
}

fn write_meshes(args: &Args, out: &mut dyn Write) -> anyhow::Result<()> {
    let recipe = args.what.recipe().context("--meshes: the kinds of a scatter have none")?;
    let written: Vec<_> =
        recipe.models().into_iter().map(|model| write_mesh(model, &args.out)).collect::<Result<_, _>>()?;
    if args.json {
        writeln!(out, "{}", serde_json::to_string(&written)?)?;
        return Ok(());
    }
    for WrittenMesh { mesh, triangles, materials } in &written {
        let (triangles, materials) =
            (text::counted(*triangles, "triangle"), text::counted(*materials, "material"));
        writeln!(out, "{mesh}: {triangles}, {materials}")?;
    }
    Ok(())
}

fn write_mesh(model: Model, folder: &Path) -> anyhow::Result<WrittenMesh> {
    let folder = folder.join(model.class.name());
    fs::create_dir_all(&folder).with_context(|| format!("{}: it cannot be made", folder.display()))?;
    let file = folder.join(format!("{}.obj", model.name));
    let (triangles, materials) = (model.triangles.len(), model.materials.len());
    write_atomically(&file, obj(&mesh_of(model)).as_bytes())?;
    Ok(WrittenMesh { mesh: file.display().to_string(), triangles, materials })
}

fn mesh_of(model: Model) -> Mesh {
    let group = |(material, triangles): (&str, _)| Group {
        name: String::new(),
        material: Some(material.to_owned()),
        triangles,
    };
    let groups = model.materials.into_iter().map(group).collect();
    let surface = Surface { positions: model.positions, triangles: model.triangles };
    Mesh { name: model.name, groups, ..surface.into() }
}

fn write_scene(args: &Args, out: &mut dyn Write) -> anyhow::Result<()> {
    let (seed, scene, path) = make(args)?;
    let written = write(seed, &scene, &path, &args.out)?;
    if args.json {
        writeln!(out, "{}", serde_json::to_string(&written)?)?;
    } else {
        let (objects, tables) =
            (text::counted(written.objects, "object"), text::counted(written.tables, "table"));
        writeln!(out, "{}: {objects}, {tables}, seed {seed}", written.scene)?;
        writeln!(
            out,
            "{}: {}, {:.1} s",
            written.path,
            text::counted(written.poses, "pose"),
            path.duration_s()
        )?;
    }
    Ok(())
}

fn make(args: &Args) -> anyhow::Result<(u64, Scene, CameraPath)> {
    let Some(recipe) = args.what.recipe() else { return make_scatter(args) };
    ensure!(args.objects.is_none(), "--objects: only a scatter has as many objects as asked for");
    let seed = args.seed.unwrap_or(recipe.bundled_seed());
    Ok((seed, recipe.scene(seed), recipe.path(seed)))
}

fn make_scatter(args: &Args) -> anyhow::Result<(u64, Scene, CameraPath)> {
    let (objects, seed) = (args.objects.unwrap_or(SCATTER_OBJECTS), args.seed.unwrap_or(SCATTER_SEED));
    ensure!(objects <= MOST_OBJECTS, "--objects: must be at most {MOST_OBJECTS}, not {objects}");
    Ok((seed, scatter(objects, seed), scatter_path(objects, seed)))
}

fn write(seed: u64, scene: &Scene, path: &CameraPath, folder: &Path) -> anyhow::Result<Written> {
    fs::create_dir_all(folder).with_context(|| format!("{}: it cannot be made", folder.display()))?;
    let scene_file = folder.join(format!("{}.json", scene.name));
    let path_file = folder.join(format!("{}.csv", scene.name));
    scene.write(&scene_file)?;
    path.write(&path_file)?;
    Ok(Written {
        scene: scene_file.display().to_string(),
        path: path_file.display().to_string(),
        seed,
        objects: scene.objects.len(),
        tables: scene.tables.len(),
        poses: path.poses().len(),
    })
}
