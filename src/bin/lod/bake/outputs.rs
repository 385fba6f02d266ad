//! What a mesh's bake leaves on disk: a folder of its own.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, ensure};
use lod_budget::bake::chain::{Chain, ChainLevel};
use lod_budget::bake::geomorph::Geomorph;
use lod_budget::bake::write::{LevelOut, Measured, glb, obj, sheet};
use lod_budget::files::gltf::coverage_of_size;
use lod_budget::files::{Scene, write_atomically};
use lod_budget::table::{LevelRecord, LodTable};

use super::Format;
use super::impostor::{self, Card};
use super::inputs::{Found, real};
use super::record::{Record, Stamp};
use super::settings::Settings;
use super::summary::{LevelRow, MeshRow};

/// A folder, and what the files in it are called.
pub struct Folder {
    path: PathBuf,
    name: String,
}

impl Folder {
    pub fn new(out: &Path, name: &str) -> Self {
        Self { path: out.join(name), name: name.to_owned() }
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// `NAME` with something added.
    pub fn named(&self, ending: &str) -> String {
        format!("{}{ending}", self.name)
    }

    pub fn make(&self) -> anyhow::Result<()> {
        fs::create_dir_all(&self.path).with_context(|| format!("{}: it cannot be made", self.path.display()))
    }

    /// Refuses to replace what was baked from another file that is still there.
    pub fn check_owner(&self, before: Option<&Record>, inputs: &[Stamp]) -> anyhow::Result<()> {
        let other = before.and_then(Record::input).filter(|_| !inputs.is_empty());
        let Some(other) = other.filter(|other| other.file != inputs[0].file) else { return Ok(()) };
        ensure!(
            !Path::new(&other.file).exists(),
            "{} must not be replaced, which was baked from {}; take another --out, or --force",
            self.path.display(),
            other.file
        );
        Ok(())
    }

    /// Refuses to replace what is to be read.
    pub fn check_inputs(&self, found: &Found) -> anyhow::Result<()> {
        let here = real(&self.path);
        let own = found.inputs.iter().map(|input| real(&input.file)).find(|input| {
            let name = input.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            input.parent() == Some(&here) && self.is_output(&name)
        });
        match own {
            Some(input) => {
                Err(anyhow!("{}, an input, must not be replaced; take another --out", input.display()))
            }
            None => Ok(()),
        }
    }

    /// Whether a bake may write a file of this name.
    fn is_output(&self, name: &str) -> bool {
        let ending = name.strip_prefix(&self.name).unwrap_or_default();
        [".glb", ".json", ".svg", ".impostor.json", ".lodp", ".bake.json"].contains(&ending)
            || ending.starts_with("_LOD")
    }

    /// Removes what a bake before has left and this one has not replaced. A file that stays does no harm.
    pub fn remove_stale(&self, before: &Record, now: &Record) {
        let is_kept = |file: &str| now.outputs.iter().any(|output| output.file == file);
        let stale =
            before.outputs.iter().filter(|output| self.is_output(&output.file) && !is_kept(&output.file));
        for output in stale {
            let _ = fs::remove_file(self.file(&output.file));
        }
    }
}

/// A chain and its table, to be written.
pub struct Outputs {
    pub chain: Chain,
    pub table: LodTable,
    /// From each level to the next, or none.
    pub geomorphs: Vec<Geomorph>,
    /// The last level of the table, where it is an impostor.
    pub card: Option<Card>,
    /// The file of the progressive mesh.
    pub progressive: Option<Vec<u8>>,
}

impl Outputs {
    /// Adds the impostor that was asked for, and tells the row of it.
    pub fn end_with_impostor(&mut self, row: &mut MeshRow, settings: &Settings) -> anyhow::Result<()> {
        let Some(options) = &settings.impostor else { return Ok(()) };
        let (table, card, impostor) = impostor::end_with(options, &mut self.chain, settings.accuracy)?;
        // The coarsest level of triangles turns into nothing: an impostor is no mesh of its kind.
        self.geomorphs.truncate(self.chain.levels.len() - 1);
        row.levels = LevelRow::all(&self.chain, &table, &self.geomorphs);
        row.levels.extend(card.iter().map(|card| card.level_row(&table)));
        (self.table, self.card, row.impostor) = (table, card, Some(impostor));
        Ok(())
    }

    /// Writes what was asked for and tells the row of it.
    pub fn write(
        &self,
        row: &mut MeshRow,
        folder: &Folder,
        settings: &Settings,
    ) -> anyhow::Result<Vec<Stamp>> {
        let mut stamps = Vec::new();
        let mut put = |ending: &str, bytes: &[u8]| -> anyhow::Result<String> {
            let name = folder.named(ending);
            write_atomically(&folder.file(&name), bytes)?;
            stamps.push(Stamp::of(name.clone(), bytes));
            Ok(name)
        };
        let levels = self.levels();
        if settings.wants(Format::Obj) {
            for (i, level) in levels.iter().enumerate() {
                row.levels[i].file = Some(put(&format!("_LOD{i}.obj"), obj(level.mesh).as_bytes())?);
            }
        }
        if settings.wants(Format::Glb) {
            row.scene_file = Some(put(".glb", &glb(&levels)?)?);
        }
        if settings.wants(Format::Json) {
            row.table_file = Some(put(".json", self.table_json()?.as_bytes())?);
        }
        if let (Some(card), Some(impostor)) = (&self.card, &mut row.impostor) {
            impostor.file = Some(put(".impostor.json", card.impostor.to_json()?.as_bytes())?);
        }
        if settings.wants(Format::Sheet) {
            let chain = sheet::Chain { name: &row.name, levels: &levels };
            row.sheet_file = Some(put(".svg", sheet::svg(&[chain])?.as_bytes())?);
        }
        if let Some(progressive) = &self.progressive {
            row.progressive_file = Some(put(".lodp", progressive)?);
        }
        Ok(stamps)
    }

    pub fn levels(&self) -> Vec<LevelOut<'_>> {
        let levels = self.chain.levels.iter().zip(self.table.levels()).enumerate();
        let card =
            self.card.iter().zip(self.table.levels().last()).map(|(card, record)| card.level_out(record));
        levels
            .map(|(i, (level, record))| level_out(level, record, self.geomorphs.get(i)))
            .chain(card)
            .collect()
    }

    /// A scene of the table alone.
    fn table_json(&self) -> anyhow::Result<String> {
        let name = self.table.name().to_owned();
        Ok(Scene { name, tables: vec![self.table.clone()], objects: Vec::new() }.to_json()?)
    }
}

fn level_out<'a>(
    level: &'a ChainLevel,
    record: &LevelRecord,
    geomorph: Option<&'a Geomorph>,
) -> LevelOut<'a> {
    let (hausdorff, rms) = (level.deviation.hausdorff, level.deviation.rms());
    LevelOut {
        measured: Some(Measured { error: level.error, hausdorff, rms }),
        coverage: record.min_size.map(coverage_of_size),
        accuracy: Some(record.accuracy),
        geomorph,
        ..LevelOut::new(&level.mesh)
    }
}
