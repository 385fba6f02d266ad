//! What is to be measured, and how thoroughly.

use crate::report::ROWS;

/// The seed of all scenes.
pub const SEED: u64 = 1993;

#[derive(Default)]
pub struct Plan {
    /// Smaller scenes and fewer rounds: to see that everything runs.
    pub quick: bool,
    /// The only row to measure.
    pub only: Option<String>,
}

impl Plan {
    /// Reads the command line. `--bench`, which cargo adds, means nothing.
    pub fn of(arguments: impl IntoIterator<Item = String>) -> Result<Self, String> {
        let (mut plan, mut arguments) = (Self::default(), arguments.into_iter());
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--bench" => {}
                "--quick" => plan.quick = true,
                "--only" => plan.only = Some(row(arguments.next())?),
                other => return Err(format!("'{other}' is not known: --quick, --only NAME")),
            }
        }
        Ok(plan)
    }

    /// Whether everything is measured, so that the answer is worth writing down.
    pub fn is_whole(&self) -> bool {
        !self.quick && self.only.is_none()
    }

    pub fn wants(&self, row: &str) -> bool {
        self.only.as_deref().is_none_or(|only| only == row)
    }

    pub fn wants_any(&self, rows: &[&str]) -> bool {
        rows.iter().any(|row| self.wants(row))
    }

    /// A million, or a tenth of it.
    pub fn objects(&self) -> usize {
        if self.quick { 100_000 } else { 1_000_000 }
    }

    pub fn rounds(&self, whole: usize) -> usize {
        if self.quick { (whole / 5).clamp(2, 5) } else { whole }
    }
}

fn row(name: Option<String>) -> Result<String, String> {
    let names = || ROWS.map(|r| r.name).join(", ");
    match name {
        Some(name) if ROWS.iter().any(|r| r.name == name) => Ok(name),
        Some(name) => Err(format!("there is no row '{name}'; the rows are {}", names())),
        None => Err(format!("--only needs the name of a row: {}", names())),
    }
}
