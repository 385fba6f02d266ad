//! Whether answers agree, which is checked before anything is timed.

use crate::baselines::classes::{Classes, Totals};

/// Benefits may differ by so much of the gain over the cheapest choice. Slopes that differ in the last bit swap
/// places at the cut.
const ROUNDING: f64 = 1e-6;
/// What a fill may add to the textbook's answer, which ends at the first step that does not fit: so many average
/// gains.
const FILL: f64 = 32.0;

/// Refuses a baseline that does not give the textbook's answer, bit for bit.
pub fn with_textbook(name: &str, answer: &[u8], textbook: &[u8]) -> Result<(), String> {
    let differing = answer.iter().zip(textbook).filter(|(a, b)| a != b).count();
    match differing {
        0 => Ok(()),
        _ => Err(format!("{name} differs from the textbook greedy at {differing} objects")),
    }
}

/// What an answer of the crate is compared with.
pub struct Reference {
    pub textbook: Totals,
    /// The cheapest choice.
    pub least: Totals,
    pub budget: u64,
    /// What a choice may cost beyond the budget: nothing, where costs are integers on both sides.
    pub slack: u64,
    pub classes: usize,
}

impl Reference {
    /// The textbook's answer as a reference.
    pub fn of(classes: &Classes<'_>, textbook: &[u8], budget: u64) -> Self {
        let least = classes.totals(&vec![0; classes.len()]);
        Self { textbook: classes.totals(textbook), least, budget, slack: 0, classes: classes.len() }
    }

    /// Refuses a choice that is over the budget, worse than the textbook's, or better than a fill can explain.
    /// Otherwise says by how much it is better.
    pub fn check(&self, ours: Totals) -> Result<f64, String> {
        let gain = self.textbook.benefit - self.least.benefit;
        let surplus = (ours.benefit - self.textbook.benefit) / gain;
        if ours.units > self.budget + self.slack {
            return Err(format!("the frame costs {} of {}", ours.units, self.budget));
        }
        if !(-ROUNDING..=FILL / self.classes as f64 + ROUNDING).contains(&surplus) {
            return Err(format!("the frame's gain is {surplus:+.2e} of the textbook's off"));
        }
        Ok(surplus)
    }
}
