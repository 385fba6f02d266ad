//! What a bake makes beside scenes: vertex hierarchies and impostors.

use std::io::Write;
use std::path::Path;

use anyhow::anyhow;
use lod_budget::bake::hierarchy;
use lod_budget::bake::impostor::{self, Impostor, Kind};
use lod_budget::hierarchy::Hierarchy;
use serde::{Deserialize, Serialize};

use super::{Args, Lines, point};
use crate::text::{count, counted, plain};

/// What is in a file.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Baked {
    Hierarchy(Forest),
    Impostor(Pictures),
}

/// What is in a vertex hierarchy. Lengths are in object units.
#[derive(Serialize)]
pub struct Forest {
    /// Of the mesh at its finest.
    vertices: usize,
    triangles: usize,
    /// No cut has fewer.
    base_triangles: usize,
    /// Contractions.
    operations: usize,
    /// The most that rest on each other, end by end.
    depth: usize,
    /// The least, the middle and the greatest of the operations; `None` without.
    errors: Option<[f32; 3]>,
    center: [f32; 3],
    radius: f32,
    /// Of the file.
    bytes: usize,
}

/// What is in the layout of an impostor. Lengths are in object units.
#[derive(Serialize)]
pub struct Pictures {
    name: String,
    impostor: Kind,
    frames: usize,
    atlas_px: [u32; 2],
    /// Of the atlas, in memory.
    atlas_bytes: u64,
    texels_per_unit: f64,
    center: [f64; 3],
    radius: f64,
    up: [f64; 3],
    /// From where on its error holds.
    nearest: f64,
    elevation_deg: [f64; 2],
    error: f64,
    rms: f64,
    fill: f64,
    /// Of the file.
    bytes: usize,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Inspected<'a> {
    file: String,
    #[serde(flatten)]
    baked: &'a Baked,
}

/// What is in the file; `None` where it is of another kind, or cannot be read.
///
/// # Errors
/// What the readers refuse.
pub fn inspect(path: &Path) -> anyhow::Result<Option<Baked>> {
    let file = path.display().to_string();
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("lodh") => {
            let hierarchy = hierarchy::read(path).map_err(|e| anyhow!("{e}"))?;
            Ok(Some(Baked::Hierarchy(Forest::of(&hierarchy))))
        }
        Some("json") => match std::fs::read(path) {
            Ok(bytes) if is_impostor(&bytes) => {
                let impostor = Impostor::from_json(&bytes, &file).map_err(|e| anyhow!("{e}"))?;
                Ok(Some(Baked::Impostor(Pictures::of(impostor, bytes.len()))))
            }
            _ => Ok(None),
        },
        _ => Ok(None),
    }
}

fn is_impostor(bytes: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct Header {
        format: String,
    }
    serde_json::from_slice::<Header>(bytes).is_ok_and(|header| header.format == impostor::FORMAT)
}

impl Forest {
    fn of(hierarchy: &Hierarchy) -> Self {
        let operations = &hierarchy.parts().operations;
        let mut errors: Vec<f32> = operations.iter().map(|operation| operation.error).collect();
        errors.sort_by(f32::total_cmp);
        let bounds = hierarchy.bounds();
        Self {
            vertices: hierarchy.leaves(),
            triangles: hierarchy.triangles(),
            base_triangles: hierarchy.base_triangles(),
            operations: operations.len(),
            depth: depth(hierarchy),
            errors: errors.last().map(|&most| [errors[0], errors[errors.len() / 2], most]),
            center: bounds.center.to_array(),
            radius: bounds.radius,
            bytes: hierarchy::to_bytes(hierarchy).len(),
        }
    }
}

/// The longest way from an operation down to a leaf.
fn depth(hierarchy: &Hierarchy) -> usize {
    let mut depths = vec![0; hierarchy.leaves()];
    for operation in &hierarchy.parts().operations {
        let [a, b] = operation.ends.map(|end| depths[end as usize]);
        depths.push(1 + usize::max(a, b));
    }
    depths.into_iter().max().unwrap_or(0)
}

impl Pictures {
    fn of(impostor: Impostor, bytes: usize) -> Self {
        let Impostor { atlas, validity, .. } = &impostor;
        Self {
            impostor: impostor.kind,
            frames: impostor.frames.len(),
            atlas_px: [atlas.width_px, atlas.height_px],
            atlas_bytes: atlas.bytes,
            texels_per_unit: atlas.texels_per_unit,
            center: impostor.center.to_array(),
            radius: impostor.radius,
            up: impostor.up.to_array(),
            nearest: validity.nearest,
            elevation_deg: validity.elevation_deg,
            error: impostor.error,
            rms: impostor.rms,
            fill: impostor.fill,
            bytes,
            name: impostor.name,
        }
    }
}

pub fn print(baked: &Baked, args: &Args, out: &mut dyn Write) -> anyhow::Result<()> {
    if args.json {
        let inspected = Inspected { file: args.file.display().to_string(), baked };
        writeln!(out, "{}", serde_json::to_string_pretty(&inspected)?)?;
        return Ok(());
    }
    let words = match baked {
        Baked::Hierarchy(forest) => forest_in_words(forest),
        Baked::Impostor(pictures) => pictures_in_words(pictures),
    };
    write!(out, "{words}")?;
    Ok(())
}

fn forest_in_words(f: &Forest) -> String {
    let mut lines = Lines::default();
    let triangles = counted(f.triangles, "triangle");
    lines.say("Hierarchy", format!("{triangles}, {} vertices", count(f.vertices as u64)));
    let base = counted(f.base_triangles, "triangle");
    lines.say("Coarsest", format!("{base} after {}", counted(f.operations, "operation")));
    lines.say("Depth", format!("{} above each other", counted(f.depth, "operation")));
    match f.errors {
        Some([least, middle, most]) => {
            lines.say("Error", format!("{least} to {most} units, half of them up to {middle}"));
        }
        None => lines.say("Error", "none: nothing can be coarser"),
    }
    lines.say("Bound", format!("radius {} around {}", f.radius, point(f.center)));
    lines.say("File", format!("{} bytes", count(f.bytes as u64)));
    lines.0
}

fn pictures_in_words(p: &Pictures) -> String {
    let mut lines = Lines::default();
    lines.say("Impostor", format!("{}: {}", plain(&p.name), kind_in_words(p.impostor)));
    let [width, height] = p.atlas_px;
    let (frames, bytes) = (counted(p.frames, "frame"), count(p.atlas_bytes));
    lines.say("Atlas", format!("{frames} in {width} × {height} pixels, {bytes} bytes"));
    lines.say("Texels", format!("{:.4} a unit", p.texels_per_unit));
    let [low, high] = p.elevation_deg;
    lines.say("Holds", format!("from {:.4} units on, {low}° to {high}°", p.nearest));
    lines.say("Error", format!("at most {:.6} units, root mean square {:.6}", p.error, p.rms));
    lines.say("Fill", format!("{:.2} of the disc around the bound", p.fill));
    let center = p.center.map(|x| x as f32);
    lines.say("Bound", format!("radius {} around {}", p.radius as f32, point(center)));
    lines.say("File", format!("{} bytes", count(p.bytes as u64)));
    lines.0
}

fn kind_in_words(kind: Kind) -> String {
    match kind {
        Kind::Billboard { .. } => "a billboard".to_owned(),
        Kind::CrossQuads { planes, .. } => format!("{planes} quads that cross"),
        Kind::Octahedral { hemisphere: true, .. } => "octahedral, from above the horizon".to_owned(),
        Kind::Octahedral { hemisphere: false, .. } => "octahedral, from all sides".to_owned(),
    }
}
