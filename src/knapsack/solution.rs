//! The answer, the same for every solver.

/// One item of every class, and how good that is.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Solution {
    /// The chosen item of each class, as an index into the class.
    pub choice: Vec<u32>,
    /// Sum of the chosen costs: exact, then rounded once. Never above the budget when `feasible`.
    pub cost: f64,
    /// Sum of the chosen benefits: exact, then rounded once.
    pub benefit: f64,
    /// No choice within the budget has a higher benefit; rounded up. `None` when nothing is feasible.
    pub upper_bound: Option<f64>,
    /// (upper bound − benefit) ÷ upper bound; 0 when `optimal` or when the bound is 0, `None` when nothing is feasible.
    pub gap: Option<f64>,
    /// The multiplier λ: the slope of the step that the budget cuts, so what one more unit of budget is worth. 0 when
    /// every useful step fits, infinite when nothing is feasible.
    pub lambda: f64,
    /// Whether any choice, and so this one, fits the budget. If not, this is the cheapest choice.
    pub feasible: bool,
    /// Whether it is proved that no choice within the budget has a benefit that, rounded to `f64`, is above this one's.
    pub optimal: bool,
    /// How far the cheapest choice exceeds the budget; 0 when feasible.
    pub shortfall: f64,
    /// Steps of work counted against a limit, the same on every machine: see [`greedy_within`](super::greedy_within)
    /// and [`capped`](super::capped).
    pub steps: u64,
}
