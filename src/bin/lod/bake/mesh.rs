//! One mesh, from its file to its outputs.

use std::error::Error;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow};
use lod_budget::bake::chain::{Chain, Progress};
use lod_budget::bake::read;

use super::geomorph;
use super::inputs::{Found, Input};
use super::outputs::{Folder, Outputs};
use super::progressive;
use super::record::{Record, Stamp, input_stamps};
use super::settings::Settings;
use super::subdivide::{self, Subdivision};
use super::summary::{LeftOutRow, LevelRow, MeshRow, Status};
use super::work::Tell;

/// Bakes a mesh, unless that was done before. Whatever the file holds becomes one mesh.
///
/// # Errors
/// What the file, the mesh or the folder is at fault for, each naming it.
pub fn bake(
    input: &Input,
    found: &Found,
    settings: &Settings,
    tell: &mut Tell<'_>,
) -> anyhow::Result<MeshRow> {
    let stamps = input_stamps(&input.file);
    let folder = Folder::new(&settings.out, &input.name);
    let before = Record::read(&folder);
    if !settings.force {
        if let Some(row) = before.as_ref().and_then(|record| record.kept(&folder, settings, &stamps)) {
            return Ok(row.of_input(input).within(&folder));
        }
        folder.check_owner(before.as_ref(), &stamps).with_context(|| input.file.display().to_string())?;
    }
    folder.check_inputs(found).with_context(|| input.file.display().to_string())?;
    let (row, outputs) = baked(input, settings, tell)?;
    let row = write(row, outputs, &folder, before.as_ref(), settings, stamps)?;
    Ok(row.within(&folder))
}

/// The levels, in memory.
fn baked(input: &Input, settings: &Settings, tell: &mut Tell<'_>) -> anyhow::Result<(MeshRow, Outputs)> {
    if let Some(subdivision) = &settings.subdivide {
        return subdivided(input, subdivision, settings, tell);
    }
    let of_input = || input.file.display().to_string();
    let mut file = read::load(&input.file).map_err(|e| anyhow!("{e}"))?;
    file.mesh.name.clone_from(&input.name);
    let findings = file.findings.iter().map(ToString::to_string).collect();
    let bake = |progress: &mut Asked<'_>| settings.plan.bake(&file.mesh, progress);
    let (mut row, mut outputs) = timed(&input.name, bake, settings, tell).with_context(of_input)?;
    outputs.end_with_impostor(&mut row, settings).with_context(of_input)?;
    let progressive = settings.progressive.as_ref().map(|options| progressive::file(&file.mesh, options));
    outputs.progressive = progressive.transpose().with_context(of_input)?;
    Ok((MeshRow { input: of_input(), findings, ..row }, outputs))
}

/// As [`baked`], upwards.
fn subdivided(
    input: &Input,
    subdivision: &Subdivision,
    settings: &Settings,
    tell: &mut Tell<'_>,
) -> anyhow::Result<(MeshRow, Outputs)> {
    let of_input = || input.file.display().to_string();
    let file = subdivision.read(input).map_err(|e| anyhow!("{e}"))?;
    let bake = |progress: &mut Asked<'_>| subdivision.bake(&file, progress);
    let (mut row, mut outputs) = timed(&input.name, bake, settings, tell).with_context(of_input)?;
    outputs.end_with_impostor(&mut row, settings).with_context(of_input)?;
    let (method, findings) = (subdivision.method(&file), subdivide::findings(&file.findings));
    Ok((MeshRow { input: of_input(), method, findings, ..row }, outputs))
}

/// How a bake asks whether to go on.
pub type Asked<'a> = dyn FnMut(Progress) -> ControlFlow<()> + 'a;

/// Has something baked, and tells all there is to tell but where it is from.
pub fn timed<E: Error + Send + Sync + 'static>(
    name: &str,
    bake: impl FnOnce(&mut Asked<'_>) -> Result<Chain, E>,
    settings: &Settings,
    tell: &mut Tell<'_>,
) -> anyhow::Result<(MeshRow, Outputs)> {
    let mut clock = Clock::new(settings.subdivide.is_some());
    let mut progress = |at| {
        tell(clock.tick(at));
        ControlFlow::Continue(())
    };
    let chain = bake(&mut progress)?;
    clock.stop();
    let table = chain.table(settings.accuracy)?;
    let geomorphs = geomorph::all(&chain, settings.geomorph)?;
    let row = MeshRow {
        input: String::new(),
        name: name.to_owned(),
        status: Status::Baked,
        method: settings.method.to_owned(),
        preset: settings.preset.map(str::to_owned),
        seconds: clock.making.as_secs_f64(),
        measure_seconds: clock.measuring.as_secs_f64(),
        diagonal: diagonal(&chain),
        unreferenced: chain.unreferenced,
        findings: Vec::new(),
        levels: LevelRow::all(&chain, &table, &geomorphs),
        left_out: chain.left_out.iter().map(LeftOutRow::of).collect(),
        impostor: None,
        scene_file: None,
        table_file: None,
        sheet_file: None,
        progressive_file: None,
    };
    Ok((row, Outputs { chain, table, geomorphs, card: None, progressive: None }))
}

fn diagonal(chain: &Chain) -> f64 {
    let bounds = chain.levels[0].mesh.bounds();
    (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length()
}

/// Puts the files in place. The old record goes first and the new one comes last, so that whatever happens in between,
/// no record speaks of files that are not those.
fn write(
    mut row: MeshRow,
    outputs: Outputs,
    folder: &Folder,
    before: Option<&Record>,
    settings: &Settings,
    inputs: Vec<Stamp>,
) -> anyhow::Result<MeshRow> {
    folder.make()?;
    Record::remove(folder)?;
    let stamps = outputs.write(&mut row, folder, settings)?;
    let record = Record::new(settings, inputs, stamps, row);
    if let Some(before) = before {
        folder.remove_stale(before, &record);
    }
    record.write(folder)?;
    Ok(record.row)
}

/// How long making levels and measuring them takes: the time between two reports belongs to what the first one said.
struct Clock {
    since: Instant,
    is_making: bool,
    making: Duration,
    measuring: Duration,
}

impl Clock {
    /// What comes before the first report is subdivision, or getting ready to measure.
    fn new(is_making: bool) -> Self {
        let (making, measuring) = (Duration::ZERO, Duration::ZERO);
        Self { since: Instant::now(), is_making, making, measuring }
    }

    /// Takes the time, and returns how much is done, from 0 to 1.
    fn tick(&mut self, at: Progress) -> f64 {
        self.stop();
        self.is_making = matches!(at, Progress::Simplifying(_));
        let share = |part: usize, whole: usize| part as f64 / whole.max(1) as f64;
        match at {
            Progress::Simplifying(at) => {
                0.5 * share(at.from - at.triangles.min(at.from), at.from.saturating_sub(at.target))
            }
            Progress::Measuring { done, total } => 0.5 + 0.5 * share(done, total),
        }
    }

    fn stop(&mut self) {
        let now = Instant::now();
        let sum = if self.is_making { &mut self.making } else { &mut self.measuring };
        *sum += now - self.since;
        self.since = now;
    }
}
