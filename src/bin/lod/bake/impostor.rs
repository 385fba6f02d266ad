//! Impostors: chains that end with pictures.

use clap::ValueEnum;
use glam::DVec3;
use lod_budget::bake::Mesh;
use lod_budget::bake::chain::{Accuracy, Chain};
use lod_budget::bake::impostor::{Facing, Impostor, Joined, Kind, Options};
use lod_budget::bake::write::{LevelOut, Measured, sheet};
use lod_budget::files::gltf::coverage_of_size;
use lod_budget::table::{LevelRecord, LodTable};
use serde::{Deserialize, Serialize};

use super::summary::LevelRow;

/// What is not said is as it is by default for the kind.
#[derive(clap::Args)]
#[command(next_help_heading = "Impostor")]
pub struct ImpostorArgs {
    /// End with a level of pictures: their layout and cameras are written, for an engine to draw them
    #[arg(long, value_name = "KIND", value_enum)]
    impostor: Option<ImpostorKind>,
    /// Pictures of a billboard, quads that cross, or pictures each way of the octahedral grid [default: 8, 3 or 9]
    #[arg(long, value_name = "N", requires = "impostor")]
    impostor_frames: Option<u32>,
    /// The axis that is upright
    #[arg(long, value_name = "AXIS", value_enum, requires = "impostor")]
    impostor_up: Option<UpAxis>,
    /// Diameter in the image, in pixels, up to which the impostor is to be sharp [default: 64]
    #[arg(long, value_name = "PX", requires = "impostor")]
    impostor_size: Option<f64>,
    /// Most pixels of its atlas each way [default: 2048]
    #[arg(long, value_name = "PX", requires = "impostor")]
    impostor_atlas: Option<u32>,
}

#[derive(Clone, Copy, ValueEnum)]
enum ImpostorKind {
    /// One upright quad that turns to the viewer
    Billboard,
    /// Upright quads that cross
    Cross,
    /// One quad with a blend of three pictures, from above the horizon
    Octahedral,
}

#[derive(Clone, Copy, ValueEnum)]
enum UpAxis {
    X,
    /// As in glTF, and by default
    Y,
    Z,
}

impl UpAxis {
    fn vector(self) -> DVec3 {
        match self {
            Self::X => DVec3::X,
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }
}

impl ImpostorArgs {
    /// `None` where no impostor is asked for.
    pub fn options(&self) -> Option<Options> {
        let mut options = Options::new(self.impostor?.kind(self.impostor_frames));
        options.up = self.impostor_up.map_or(options.up, UpAxis::vector);
        options.size_px = self.impostor_size.unwrap_or(options.size_px);
        options.atlas.side_px = self.impostor_atlas.unwrap_or(options.atlas.side_px);
        Some(options)
    }
}

impl ImpostorKind {
    fn kind(self, frames: Option<u32>) -> Kind {
        match self {
            Self::Billboard => Kind::Billboard { facing: Facing::Axis, frames: frames.unwrap_or(8) },
            Self::Cross => Kind::CrossQuads { planes: frames.unwrap_or(3), horizontal: false },
            Self::Octahedral => Kind::Octahedral { frames: frames.unwrap_or(9), hemisphere: true },
        }
    }
}

/// The last level, to be written.
pub struct Card {
    pub impostor: Impostor,
    /// In its chain.
    error: f64,
    quads: Mesh,
    /// As a contact sheet sees it.
    seen: Mesh,
}

/// What was made of the wish for an impostor. Lengths are in object units.
#[derive(Clone, Serialize, Deserialize)]
pub struct ImpostorRow {
    pub frames: usize,
    pub atlas_px: [u32; 2],
    pub texels_per_unit: f64,
    /// From where on its error holds.
    pub nearest: f64,
    pub elevation_deg: [f64; 2],
    /// The proved bound, on the screen.
    pub error: f64,
    pub rms: f64,
    /// Pixels drawn, in those of the disc around the bound.
    pub fill: f64,
    /// Levels of triangles that are no more accurate, and are left out for it.
    pub levels_left_out: usize,
    /// Why it is no level.
    pub left_out: Option<String>,
    /// Its layout.
    pub file: Option<String>,
}

/// Ends a chain with the impostor of its finest level, if that is of use. The chain loses the levels that are of none
/// then.
pub fn end_with(
    options: &Options,
    chain: &mut Chain,
    accuracy: Accuracy,
) -> anyhow::Result<(LodTable, Option<Card>, ImpostorRow)> {
    let finest = &chain.levels[0].mesh;
    let impostor = options.bake(finest)?;
    let seen = impostor.seen(finest, sheet::direction(finest));
    let error = impostor.error_in(chain);
    let Joined { table, kept, left_out } = impostor.join(chain, accuracy)?;
    let levels_left_out = chain.levels.len() - kept;
    chain.levels.truncate(kept);
    let row = ImpostorRow {
        frames: impostor.frames.len(),
        atlas_px: [impostor.atlas.width_px, impostor.atlas.height_px],
        texels_per_unit: impostor.atlas.texels_per_unit,
        nearest: impostor.validity.nearest,
        elevation_deg: impostor.validity.elevation_deg,
        error,
        rms: impostor.rms,
        fill: impostor.fill,
        levels_left_out,
        left_out: left_out.map(|reason| reason.to_string()),
        file: None,
    };
    let card = left_out.is_none().then(|| Card { error, quads: impostor.mesh(), seen, impostor });
    Ok((table, card, row))
}

impl Card {
    pub fn level_out(&self, record: &LevelRecord) -> LevelOut<'_> {
        // Every level of a table that was joined has an error.
        let error = record.error.unwrap_or(f32::MAX);
        LevelOut {
            measured: Some(Measured { error, hausdorff: self.error, rms: self.impostor.rms }),
            coverage: record.min_size.map(coverage_of_size),
            accuracy: Some(record.accuracy),
            impostor: Some(&self.impostor),
            picture: Some(&self.seen),
            ..LevelOut::new(&self.quads)
        }
    }

    /// The last row of the levels.
    pub fn level_row(&self, table: &LodTable) -> LevelRow {
        let level = table.levels().len() - 1;
        let record = &table.levels()[level];
        LevelRow {
            level,
            triangles: record.triangles as usize,
            vertices: record.vertices as usize,
            draws: record.draws as usize,
            bytes: record.bytes,
            hausdorff: self.error,
            attained: 0.0,
            rms: self.impostor.rms,
            error: record.error.map_or(self.error, f64::from),
            accuracy: record.accuracy,
            min_size: record.min_size,
            appearance: None,
            geomorph: None,
            file: None,
        }
    }
}

impl ImpostorRow {
    /// What there is to say of it beside its level.
    pub fn note(&self) -> String {
        if let Some(reason) = &self.left_out {
            return format!("the impostor is left out: {reason}");
        }
        let [width, height] = self.atlas_px;
        let [low, high] = self.elevation_deg;
        let fewer = match self.levels_left_out {
            0 => String::new(),
            levels => format!("; {levels} coarser levels of triangles left out, no more accurate"),
        };
        format!(
            "the impostor has {} frames in {width} × {height} pixels, and holds from {:.4} units on, {low}° to {high}°{fewer}",
            self.frames, self.nearest
        )
    }
}
