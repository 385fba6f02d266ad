//! `lod bake`: meshes in, levels and LOD tables out.

mod geomorph;
mod impostor;
mod inputs;
mod mesh;
mod outputs;
mod progressive;
mod quadric;
mod record;
mod scene;
mod settings;
mod subdivide;
mod summary;
mod words;
mod work;

use std::io::Write;
use std::num::NonZero;
use std::path::PathBuf;
use std::thread;

use anyhow::ensure;
use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use lod_budget::bake::chain::{Accuracy, Length, Preset};
use lod_budget::bake::simplify::Method;

use geomorph::GeomorphArgs;
use impostor::ImpostorArgs;
use inputs::{Found, Input};
use progressive::ProgressiveArgs;
use quadric::QuadricArgs;
use scene::SceneArgs;
use settings::Settings;
use subdivide::SubdivideArgs;
use summary::{Baked, Summary};
use work::Tell;

/// Make levels of meshes, measure how far each is from the original, and write them with their LOD tables.
///
/// Reads .obj, .ply, .off, .stl, .gltf and .glb files; all of a file is one mesh, unless it is glTF that shows several:
/// of such a scene every mesh gets levels. Writes a folder per file. What was baked before from the same bytes in the
/// same way is kept; scenes are baked anew.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Mesh files, folders of them, or patterns such as 'props/*.obj'
    #[arg(required = true, value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// Folder to write to; made where there is none
    #[arg(long, value_name = "DIR", default_value = "baked")]
    out: PathBuf,
    /// What to write, separated by commas
    #[arg(
        long,
        value_name = "FORMATS",
        value_delimiter = ',',
        value_enum,
        default_value = "glb,obj,json,sheet"
    )]
    format: Vec<Format>,
    /// Meshes to work on at a time [default: as many as there are processors]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZero<usize>>,
    /// Bake what was baked before, too, and replace what was baked from another file
    #[arg(long)]
    force: bool,
    /// Print one JSON object and nothing else
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    chain: ChainArgs,
    #[command(flatten)]
    geomorph: GeomorphArgs,
    #[command(flatten)]
    quadric: QuadricArgs,
    #[command(flatten)]
    impostor: ImpostorArgs,
    #[command(flatten)]
    progressive: ProgressiveArgs,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    subdivide: SubdivideArgs,
}

/// What the levels shall be like.
#[derive(clap::Args)]
#[command(next_help_heading = "Levels")]
struct ChainArgs {
    /// How to simplify
    #[arg(long, value_name = "NAME", default_value = "quadric", value_parser = methods())]
    method: Method,
    /// Choices for a kind of object
    #[arg(long, value_name = "KIND", value_parser = presets())]
    preset: Option<Preset>,
    /// So many levels, level 0 included [default: until a level is 10 % of the diagonal off or has under 16 triangles]
    #[arg(long, value_name = "N", conflicts_with_all = ["ratios", "triangles", "errors"])]
    levels: Option<usize>,
    /// A level for each of these shares of the triangles: 0.5,0.25
    #[arg(long, value_name = "SHARES", value_delimiter = ',', conflicts_with_all = ["triangles", "errors"])]
    ratios: Vec<f64>,
    /// A level for each of these numbers of triangles: 5000,800
    #[arg(long, value_name = "COUNTS", value_delimiter = ',', conflicts_with = "errors")]
    triangles: Vec<usize>,
    /// The coarsest level within each of these measured distances, in object units or percent of the diagonal: 0.1%,1%
    #[arg(long, value_name = "ERRORS", value_delimiter = ',', value_parser = length)]
    errors: Vec<Length>,
    /// What the table's accuracy is worked out from
    #[arg(long, value_name = "FROM", value_enum, default_value = "rms")]
    accuracy: AccuracyKind,
}

const EXAMPLES: &str = "\
Examples:
  lod bake rock.obj
  lod bake 'props/*.glb' --preset small-prop --out lods --jobs 4
  lod bake statue.ply --errors 0.1%,0.5%,2% --format glb
  lod bake town.glb                      every mesh of a scene, in baked/town/town.glb
  lod bake cage.obj --subdivide 3        levels upwards from a control mesh of quads
  lod bake statue.ply --ratios 0.5,0.25,0.12 --json > statue.json

Writes to DIR/NAME, NAME being that of the file:
  NAME.glb            all levels, with MSFT_lod and MSFT_screencoverage
  NAME_LOD0.obj …     each level by itself
  NAME.json           the LOD table, in a scene without objects
  NAME.impostor.json  with --impostor: frames, cameras and atlas
  NAME.svg            the levels side by side
  NAME.lodp           any level in between, with --progressive
  NAME.bake.json      what was baked how, to know next time";

/// What a bake leaves behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// All levels in one file
    Glb,
    /// Each level by itself
    Obj,
    /// The LOD table
    Json,
    /// The levels side by side, as SVG
    Sheet,
}

#[derive(Clone, Copy, ValueEnum)]
enum AccuracyKind {
    /// The measured root mean square distance
    Rms,
    /// The measured Hausdorff distance
    Hausdorff,
    /// The number of triangles alone, as in 1993
    Triangles,
}

impl AccuracyKind {
    fn accuracy(self) -> Accuracy {
        match self {
            Self::Rms => Accuracy::Rms,
            Self::Hausdorff => Accuracy::Hausdorff,
            Self::Triangles => Accuracy::Triangles,
        }
    }
}

/// Bakes all there is to bake, prints what came of it, and returns what there is to complain of.
pub fn run(args: &Args, out: &mut dyn Write) -> anyhow::Result<Vec<String>> {
    let settings = Settings::of(args)?;
    let found = inputs::find(&args.meshes);
    let jobs = args.jobs.or_else(|| thread::available_parallelism().ok()).map_or(1, NonZero::get);
    let bar = work::progress_bar(args.json)?;
    let results =
        work::all(&found.inputs, jobs, &bar, |input, tell| bake(input, &found, args, &settings, jobs, tell));
    bar.finish_and_clear();
    let summary = Summary::of(&found, results);
    if args.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&summary)?)?;
    } else {
        write!(out, "{}", words::of(&summary))?;
    }
    Ok(summary.failed.into_iter().map(|failure| failure.error).collect())
}

fn methods() -> impl TypedValueParser<Value = Method> {
    let names = PossibleValuesParser::new(Method::ALL.map(Method::name));
    names.try_map(|name| name.parse::<Method>())
}

fn presets() -> impl TypedValueParser<Value = Preset> {
    let names = PossibleValuesParser::new(Preset::ALL.map(Preset::name));
    names.try_map(|name| Preset::named(&name).ok_or("is no preset"))
}

/// A number in object units, or percent of the diagonal.
fn length(text: &str) -> Result<Length, String> {
    let number = |text: &str| text.trim().parse().ok().filter(|x: &f64| x.is_finite() && *x > 0.0);
    let length = match text.trim().strip_suffix('%') {
        Some(percent) => number(percent).map(|percent| Length::OfDiagonal(percent / 100.0)),
        None => number(text).map(Length::Units),
    };
    length.ok_or_else(|| "must be a positive number, with % for percent of the diagonal".to_owned())
}

/// One file, as what it is. A scene's parts share the jobs where there is nothing beside it.
fn bake(
    input: &Input,
    found: &Found,
    args: &Args,
    settings: &Settings,
    jobs: usize,
    tell: &mut Tell<'_>,
) -> anyhow::Result<Baked> {
    if settings.subdivide.is_none() && args.scene.means(&input.file) {
        let file = input.file.display();
        ensure!(settings.impostor.is_none(), "{file}: --impostor is for single meshes");
        ensure!(settings.progressive.is_none(), "{file}: --progressive is for single meshes");
        let jobs = if found.inputs.len() == 1 { jobs } else { 1 };
        let (scene, parts) = scene::bake(input, found, settings, jobs, tell)?;
        return Ok(Baked::Scene(scene, parts));
    }
    let row = mesh::bake(input, found, settings, tell)?;
    Ok(Baked::Mesh(Box::new(row)))
}
