//! `lod inspect` of a progressive mesh.

use std::path::Path;

use lod_budget::bake::progressive::{Counts, Extent, Mark, Progressive};
use serde::Serialize;

use super::Lines;
use crate::text::{count, plain};

/// Errors are told at so many numbers of triangles.
const MARKS: usize = 12;

/// What is in a file.
#[derive(Serialize)]
pub struct ProgressiveInspection {
    pub name: String,
    pub bytes: usize,
    pub base_bytes: usize,
    pub split_bytes: usize,
    pub original_bytes: usize,
    pub base: CountsRow,
    pub full: CountsRow,
    pub original: CountsRow,
    pub splits: usize,
    /// Whether the file ends too early.
    pub is_truncated: bool,
    /// Coarse to fine.
    pub marks: Vec<MarkRow>,
}

#[derive(Serialize)]
pub struct CountsRow {
    pub positions: usize,
    pub wedges: usize,
    pub triangles: usize,
}

#[derive(Serialize)]
pub struct MarkRow {
    pub splits: usize,
    pub triangles: usize,
    /// Bound of the deviation, in object units.
    pub error: f32,
}

/// Reads a progressive mesh and does all its splits to see whether that can be done; `None` where the file is of another
/// kind.
///
/// # Errors
/// What the file is at fault for.
pub fn inspect(file: &Path) -> anyhow::Result<Option<ProgressiveInspection>> {
    if !file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("lodp")) {
        return Ok(None);
    }
    let (mesh, extent) = Progressive::load(file)?;
    mesh.verify()?;
    let sizes = mesh.sizes();
    Ok(Some(ProgressiveInspection {
        name: mesh.name().to_owned(),
        bytes: mesh.bytes().len(),
        base_bytes: sizes.base,
        split_bytes: sizes.splits,
        original_bytes: sizes.original,
        base: CountsRow::of(mesh.base()),
        full: CountsRow::of(mesh.full()),
        original: CountsRow::of(mesh.of_original()),
        splits: mesh.splits(),
        is_truncated: extent != Extent::Whole,
        marks: marks(&mesh),
    }))
}

impl CountsRow {
    fn of(Counts { positions, wedges, triangles }: Counts) -> Self {
        Self { positions, wedges, triangles }
    }
}

/// The first and last mark, and some between by their triangles.
fn marks(mesh: &Progressive) -> Vec<MarkRow> {
    let all: Vec<Mark> = mesh.marks().collect();
    let (few, many) = (mesh.base().triangles.max(1) as f64, mesh.full().triangles.max(1) as f64);
    let target = |i: usize| few * (many / few).powf(i as f64 / (MARKS - 1) as f64);
    let mut picked: Vec<Mark> = Vec::new();
    for at in (0..MARKS).map(target) {
        let mark = all.iter().find(|mark| mark.triangles as f64 >= at - 0.5).or(all.last());
        picked.extend(mark.filter(|mark| picked.last().is_none_or(|last| last.splits < mark.splits)));
    }
    picked.iter().map(|m| MarkRow { splits: m.splits, triangles: m.triangles, error: m.error }).collect()
}

pub fn in_words(p: &ProgressiveInspection) -> String {
    let mut lines = Lines::default();
    let bytes = |n: usize| count(n as u64);
    let counts = |c: &CountsRow| {
        let [positions, wedges, triangles] = [c.positions, c.wedges, c.triangles].map(|n| count(n as u64));
        format!("{triangles} triangles, {positions} positions, {wedges} wedges")
    };
    lines.say("Mesh", plain(&p.name));
    lines.say("Base", counts(&p.base));
    lines.say("Splits", format!("{}, to {}", count(p.splits as u64), counts(&p.full)));
    lines.say("Original", counts(&p.original));
    let parts = [("base", p.base_bytes), ("splits", p.split_bytes), ("original", p.original_bytes)];
    let parts = parts.map(|(name, n)| format!("{name} {}", bytes(n))).join(", ");
    let each = p.bytes as f64 / p.original.triangles.max(1) as f64;
    lines.say("Bytes", format!("{}, {each:.2} a triangle: {parts}", bytes(p.bytes)));
    for mark in &p.marks {
        lines.say("Error", format!("{} at {} triangles", mark.error, count(mark.triangles as u64)));
    }
    if p.is_truncated {
        lines.say("Odd", "it ends too early: what is whole can be used, but not the original");
    }
    lines.0
}
