//! A whole scene, from its file to the same scene with levels.

use std::fs;
use std::path::Path;
use std::sync::Mutex;

use anyhow::{Context, anyhow};
use lod_budget::bake::chain::{BakeError, Chain};
use lod_budget::bake::scene::{Chunks, Options, Part, Scene};
use lod_budget::bake::{Format, split};
use lod_budget::files::write_atomically;

use super::inputs::{Found, Input};
use super::mesh::timed;
use super::outputs::{Folder, Outputs};
use super::record::Record;
use super::settings::Settings;
use super::summary::{LeftRow, MeshRow, SceneRow};
use super::work::{self, Tell};

/// What is done to scenes.
#[derive(clap::Args)]
#[command(next_help_heading = "Scenes")]
pub struct SceneArgs {
    /// Take a glTF file as a scene even if it shows one mesh alone
    #[arg(long)]
    scene: bool,
    /// Take a glTF file as one mesh, whatever it shows
    #[arg(long, conflicts_with = "scene")]
    one_mesh: bool,
    /// Split all meshes of a scene into chunks of so many triangles at most [default: those much larger than their
    /// neighbours, at 8192]
    #[arg(long, value_name = "TRIANGLES", value_parser = clap::value_parser!(u32).range(1..))]
    split: Option<u32>,
    /// Split no mesh
    #[arg(long, conflicts_with = "split")]
    no_split: bool,
}

impl SceneArgs {
    pub fn options(&self) -> Options {
        let chunks = match (self.no_split, self.split) {
            (true, _) => Chunks::Never,
            (_, Some(most)) => {
                Chunks::All(split::Options { triangles: most as usize, ..split::Options::default() })
            }
            _ => Options::default().chunks,
        };
        Options { chunks, ..Options::default() }
    }

    /// Whether to bake a file as a scene. One that cannot be read is none: as a mesh it is refused with all the
    /// reasons.
    pub fn means(&self, file: &Path) -> bool {
        if self.one_mesh || Format::guess(&[], &file.to_string_lossy()) != Some(Format::Gltf) {
            return false;
        }
        let is_one = |bytes: Vec<u8>| Scene::is_one(&bytes, "", file.parent()).unwrap_or(false);
        self.scene || fs::read(file).is_ok_and(is_one)
    }
}

/// Bakes a scene, `jobs` of its parts at a time: what there is to say of it, and of each part.
///
/// # Errors
/// What the file, a part or the folder is at fault for, each naming it.
pub fn bake(
    input: &Input,
    found: &Found,
    settings: &Settings,
    jobs: usize,
    tell: &mut Tell<'_>,
) -> anyhow::Result<(SceneRow, Vec<MeshRow>)> {
    let file = input.file.display().to_string();
    let folder = Folder::new(&settings.out, &input.name);
    folder.check_inputs(found)?;
    let bytes = fs::read(&input.file).with_context(|| format!("{file}: it cannot be read"))?;
    let scene =
        Scene::open(&bytes, &file, input.file.parent(), &settings.scene).map_err(|e| anyhow!("{e}"))?;
    let (mut rows, outputs) = bake_parts(&scene, &file, settings, jobs, tell)?;
    let mut row = row(&scene, &file, &rows);
    let levels: Vec<_> =
        outputs.iter().map(|part| part.as_ref().map_or_else(Vec::new, Outputs::levels)).collect();
    let authored = measure_authored(&scene, settings, jobs);
    let measured: Vec<_> =
        authored.iter().map(|chain| chain.as_ref().map_or_else(Vec::new, Outputs::levels)).collect();
    row.measured = authored.iter().flatten().count();
    let written = scene.write(&levels, &measured).map_err(|e| anyhow!("{e}"))?;
    folder.make()?;
    Record::remove(&folder)?;
    let scene_file = folder.file(&folder.named(".glb"));
    write_atomically(&scene_file, &written)?;
    row.scene_file = scene_file.display().to_string();
    carry_path(input, &folder)?;
    rows.iter_mut().for_each(|part| part.scene_file = Some(row.scene_file.clone()));
    Ok((row, rows))
}

/// The camera path that belongs to a scene, the CSV file of its name beside it, goes along.
fn carry_path(input: &Input, folder: &Folder) -> anyhow::Result<()> {
    let path = input.file.with_extension("csv");
    if path.is_file() {
        let bytes = fs::read(&path).with_context(|| format!("{}: it cannot be read", path.display()))?;
        write_atomically(&folder.file(&folder.named(".csv")), &bytes)?;
    }
    Ok(())
}

/// A row for each part that could be baked, and for each part what it came to. One without extent gets no levels.
fn bake_parts(
    scene: &Scene<'_>,
    file: &str,
    settings: &Settings,
    jobs: usize,
    tell: &mut Tell<'_>,
) -> anyhow::Result<(Vec<MeshRow>, Vec<Option<Outputs>>)> {
    let all: usize = scene.parts().iter().map(|part| part.chunk.mesh.triangles.len()).sum();
    let done = Mutex::new((0, tell));
    let finish = |part: &Part| {
        let (done, tell) = &mut *done.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        *done += part.chunk.mesh.triangles.len();
        tell(*done as f64 / all as f64);
    };
    let bake = |_, part: &Part| {
        let baked = timed(&part.name, |progress| part.bake(&settings.plan, progress), settings, &mut |_| {});
        finish(part);
        match baked {
            Err(error) if error.downcast_ref() == Some(&BakeError::NoExtent) => Ok(None),
            baked => baked.map(Some).with_context(|| format!("{file}: {}", part.name)),
        }
    };
    let (mut rows, mut outputs) = (Vec::new(), Vec::new());
    for baked in work::each(scene.parts(), jobs, bake) {
        let (row, output) = baked?.unzip();
        rows.extend(row.map(|row| MeshRow { input: file.to_owned(), ..row }));
        outputs.push(output);
    }
    Ok((rows, outputs))
}

/// What the author's chains come to; `None` for those that cannot be measured.
fn measure_authored(scene: &Scene<'_>, settings: &Settings, jobs: usize) -> Vec<Option<Outputs>> {
    work::each(scene.authored(), jobs, |_, authored| {
        let chain = Chain::of_levels(authored.levels.clone(), &settings.plan.measure).ok()?;
        let table = chain.table(settings.accuracy).ok()?;
        Some(Outputs { chain, table, geomorphs: Vec::new(), card: None, progressive: None })
    })
}

fn row(scene: &Scene<'_>, file: &str, rows: &[MeshRow]) -> SceneRow {
    let parts = scene.parts();
    SceneRow {
        input: file.to_owned(),
        scene_file: String::new(),
        chains: rows.iter().filter(|row| row.levels.len() > 1).count(),
        chunks: parts.iter().filter(|part| part.is_chunk).count(),
        nodes: parts.iter().filter(|part| !part.is_chunk).map(|part| part.instances).sum(),
        measured: 0,
        left: scene.left().iter().map(LeftRow::of).collect(),
        findings: scene.odd().iter().map(|odd| format!("{}: {}", odd.place, odd.finding)).collect(),
    }
}
