//! What was baked how, so that it need not be done again.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use lod_budget::files::write_atomically;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::inputs::real;
use super::outputs::Folder;
use super::settings::Settings;
use super::summary::MeshRow;

const FORMAT: &str = "lod-budget bake record";
const VERSION: u32 = 1;

/// A bake that is done.
#[derive(Serialize, Deserialize)]
pub struct Record {
    format: String,
    version: u32,
    /// [`Settings::key`].
    settings: String,
    /// The mesh file, then the files it names.
    inputs: Vec<Stamp>,
    /// In the folder of the record.
    pub outputs: Vec<Stamp>,
    /// Its files are names in the folder of the record.
    pub row: MeshRow,
}

/// A file and what was in it.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    pub file: String,
    bytes: u64,
    /// Tells contents apart that nobody has made to look alike.
    hash: String,
}

impl Stamp {
    pub fn of(file: String, contents: &[u8]) -> Self {
        Self { file, bytes: contents.len() as u64, hash: format!("{:016x}", fnv(contents)) }
    }

    fn of_file(path: &Path) -> Option<Self> {
        Some(Self::of(real(path).display().to_string(), &fs::read(path).ok()?))
    }

    /// Whether the file is in this folder as it was.
    fn holds(&self, folder: &Folder) -> bool {
        fs::read(folder.file(&self.file)).is_ok_and(|bytes| Self::of(self.file.clone(), &bytes) == *self)
    }
}

/// FNV-1a (G. Fowler, L. Noll, K. Vo), 64 bits, eight bytes at a time for speed.
fn fnv(bytes: &[u8]) -> u64 {
    let step = |hash: u64, word: u64| {
        let mixed = (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
        mixed ^ mixed >> 32
    };
    let (words, rest) = bytes.as_chunks::<8>();
    let hash = words.iter().fold(0xcbf2_9ce4_8422_2325, |hash, word| step(hash, u64::from_le_bytes(*word)));
    rest.iter().fold(hash, |hash, &byte| step(hash, u64::from(byte)))
}

/// The mesh file and the buffers that it names. A file that cannot be read has no stamp: reading it says why.
pub fn input_stamps(file: &Path) -> Vec<Stamp> {
    std::iter::once(file.to_owned()).chain(buffers(file)).filter_map(|file| Stamp::of_file(&file)).collect()
}

/// The files that a `.gltf` has its buffers in.
fn buffers(file: &Path) -> Vec<PathBuf> {
    let is_gltf = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("gltf"));
    let document = is_gltf.then(|| fs::read(file).ok()).flatten();
    let document: Value = document.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default();
    let uris =
        document["buffers"].as_array().into_iter().flatten().filter_map(|buffer| buffer["uri"].as_str());
    uris.filter(|uri| !uri.starts_with("data:"))
        .map(|uri| file.with_file_name(uri.replace("%20", " ")))
        .collect()
}

impl Record {
    pub fn new(settings: &Settings, inputs: Vec<Stamp>, outputs: Vec<Stamp>, row: MeshRow) -> Self {
        Self { format: FORMAT.to_owned(), version: VERSION, settings: settings.key(), inputs, outputs, row }
    }

    fn file(folder: &Folder) -> PathBuf {
        folder.file(&folder.named(".bake.json"))
    }

    /// `None` where there is none that can be read, and all has to be done again.
    pub fn read(folder: &Folder) -> Option<Self> {
        let record: Self = serde_json::from_slice(&fs::read(Self::file(folder)).ok()?).ok()?;
        (record.format == FORMAT && record.version == VERSION).then_some(record)
    }

    pub fn write(&self, folder: &Folder) -> anyhow::Result<()> {
        let text = serde_json::to_string_pretty(self)? + "\n";
        Ok(write_atomically(&Self::file(folder), text.as_bytes())?)
    }

    pub fn remove(folder: &Folder) -> anyhow::Result<()> {
        let file = Self::file(folder);
        if !file.exists() {
            return Ok(());
        }
        fs::remove_file(&file).with_context(|| format!("{}: it cannot be replaced", file.display()))
    }

    /// The mesh file.
    pub fn input(&self) -> Option<&Stamp> {
        self.inputs.first()
    }

    /// What was baked, if inputs and settings are those of now and all outputs are still there as they were.
    pub fn kept(&self, folder: &Folder, settings: &Settings, inputs: &[Stamp]) -> Option<MeshRow> {
        let is_same = self.settings == settings.key() && self.inputs == inputs && !inputs.is_empty();
        let is_whole = || self.outputs.iter().all(|output| output.holds(folder));
        (is_same && is_whole()).then(|| self.row.clone().kept())
    }
}
