//! Geomorphs from level to level.

use lod_budget::bake::chain::Chain;
use lod_budget::bake::geomorph::{Fit, Geomorph};
use serde::{Deserialize, Serialize};

/// Whether there are any.
#[derive(clap::Args)]
#[command(next_help_heading = "Levels")]
pub struct GeomorphArgs {
    /// Give every level a morph target that turns it into the next coarser one; scenes are written without
    #[arg(long)]
    pub geomorph: bool,
}

impl GeomorphArgs {
    /// What it adds to the key of the settings: nothing where nobody asked, so that what was baked before stays known.
    pub fn key(is_wanted: bool) -> &'static str {
        if is_wanted { " geomorph" } else { "" }
    }
}

/// From each level of a chain to the next, if that is wanted.
///
/// # Errors
/// As [`Chain::geomorphs`].
pub fn all(chain: &Chain, is_wanted: bool) -> anyhow::Result<Vec<Geomorph>> {
    if is_wanted { Ok(chain.geomorphs()?) } else { Ok(Vec::new()) }
}

/// How a level turns into the next coarser one. Distances are in object units.
#[derive(Clone, Serialize, Deserialize)]
pub struct GeomorphRow {
    /// No vertex moves farther.
    pub max: f64,
    /// By area.
    pub mean: f64,
    /// Whether it ends in exactly the coarser level, or in its nearest points.
    pub exact: bool,
}

impl GeomorphRow {
    pub fn of(geomorph: &Geomorph) -> Self {
        let movement = geomorph.movement;
        Self { max: f64::from(movement.max), mean: movement.mean, exact: geomorph.fit == Fit::Exact }
    }
}
