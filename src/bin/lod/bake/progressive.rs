//! The option `--progressive`: a progressive mesh beside the levels.

use lod_budget::bake::Mesh;
use lod_budget::bake::progressive::{Options, Progressive};
use lod_budget::bake::simplify::quietly;

/// What is made beside the levels.
#[derive(clap::Args)]
#[command(next_help_heading = "Progressive mesh")]
pub struct ProgressiveArgs {
    /// Write NAME.lodp, too: a coarse mesh and the splits that lead to the original, for any level in between; always by
    /// the method quadric
    #[arg(long, conflicts_with = "subdivide")]
    progressive: bool,
    /// Prefixes of it to measure while the number of triangles halves: more make its errors tighter
    #[arg(long, value_name = "N", default_value_t = Options::default().marks_per_halving, requires = "progressive")]
    marks: u32,
}

impl ProgressiveArgs {
    /// How to make one, if that is asked for.
    pub fn options(&self, like: Options) -> Option<Options> {
        self.progressive.then_some(Options { marks_per_halving: self.marks, ..like })
    }
}

/// The file.
///
/// # Errors
/// What the mesh is at fault for.
pub fn file(mesh: &Mesh, options: &Options) -> anyhow::Result<Vec<u8>> {
    Ok(Progressive::build(mesh, options, &mut quietly)?.bytes().to_vec())
}
