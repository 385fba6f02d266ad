//! What to measure: everything, or a glance at whether it runs.

/// Sizes, repetitions and limits.
pub struct Plan {
    /// Objects per scene.
    pub sizes: &'static [usize],
    /// Turns that this process and those of node take.
    pub bouts: usize,
    /// Frames of the walk.
    pub frames: usize,
    /// Classes per knapsack.
    pub classes: &'static [usize],
    /// Seconds after which a proof is given up.
    pub limit_s: f64,
    /// Whether the answers are worth writing to `docs/`.
    pub whole: bool,
}

const WHOLE: Plan = Plan {
    sizes: &[10_000, 100_000, 1_000_000],
    bouts: 5,
    frames: 16,
    classes: &[100, 1_000, 10_000],
    limit_s: 60.0,
    whole: true,
};

const QUICK: Plan =
    Plan { sizes: &[10_000], bouts: 1, frames: 8, classes: &[100], limit_s: 1.0, whole: false };

impl Plan {
    /// Reads the command's arguments; an error says what may be given.
    pub fn of(arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        match arguments.collect::<Vec<_>>().as_slice() {
            [] => Ok(WHOLE),
            [only] if only == "--quick" => Ok(QUICK),
            other => Err(format!("no argument or --quick, but {}", other.join(" "))),
        }
    }
}
