//! The rules that are compared. What the library does not offer is a selector of its own here.

use lod_budget::Level;
use lod_budget::frame::{OptionsError, SelectReport};
use lod_budget::knapsack::{Item, Step, upper_hull};
use lod_budget::select::{Frame, Predictive, PredictiveOptions, Selector, Steadiness};

/// A rule and its name.
type Rule = (&'static str, Box<dyn Selector>);

/// All of them; the first is what the others are compared with.
pub fn all() -> Result<[Rule; 6], OptionsError> {
    Ok([
        ("plain", Box::new(plain()?)),
        ("stop rule", Box::new(InOrder::new(false))),
        ("skip rule", Box::new(InOrder::new(true))),
        ("hysteresis", Box::new(Predictive::new(hysteresis())?)),
        ("bucket", Box::new(Predictive::new(steady(bucket()))?)),
        ("steadiness", Box::new(Predictive::default())),
    ])
}

/// The optimum of every frame, whatever was shown before.
pub fn plain() -> Result<Predictive, OptionsError> {
    Predictive::new(PredictiveOptions { hysteresis: 0.0, dwell: 0.0, ease: 0.0, ..hysteresis() })
}

/// Prices of switching inside the objective, and a dead band of the budget.
fn hysteresis() -> PredictiveOptions {
    PredictiveOptions { steadiness: None, ..PredictiveOptions::default() }
}

fn steady(steadiness: Steadiness) -> PredictiveOptions {
    PredictiveOptions { steadiness: Some(steadiness), ..PredictiveOptions::default() }
}

/// The leaky bucket alone: what is owed is due at once, as long as the object has refinements left.
fn bucket() -> Steadiness {
    let at_once = Steadiness { patience_s: 0.0, soon_ms: 0, longest_ms: 0, ..Steadiness::default() };
    Steadiness { turn: 1.0, margin: 1.0, content: 0.0, spare: 0.0, burst: 1, ..at_once }
}

/// The textbook's greedy: all steps of all hulls by slope, and what to do at the first that does not fit: stop, or
/// leave out that object's further steps and go on.
#[derive(Clone)]
struct InOrder {
    goes_on: bool,
    steps: Vec<Candidacy>,
    items: Vec<Item>,
    hull: Vec<u32>,
}

/// A step of a candidate to a level.
#[derive(Clone, Copy)]
struct Candidacy {
    slope: f64,
    candidate: usize,
    to: Level,
    cost_us: f64,
}

impl InOrder {
    fn new(goes_on: bool) -> Self {
        Self { goes_on, steps: Vec::new(), items: Vec::new(), hull: Vec::new() }
    }

    /// Lists the steps of candidate `i` from its cheapest choice on, best first.
    fn push_steps(&mut self, frame: &Frame<'_>, i: usize) {
        let candidate = frame.candidate(i);
        let drawn = frame.rates.drawn(candidate.table, candidate.allowed).map(|(level, _)| level);
        let levels: Vec<Level> = std::iter::once(frame.minimum(i)).chain(drawn).collect();
        self.items.clear();
        self.items
            .extend(levels.iter().map(|&l| Item { cost: frame.cost_us(i, l), benefit: frame.benefit(i, l) }));
        upper_hull(&self.items, &mut self.hull);
        for pair in self.hull.windows(2) {
            let [from, to] = [pair[0], pair[1]].map(|k| self.items[k as usize]);
            let slope = Step { from, to }.slope();
            let to_level = levels[pair[1] as usize];
            self.steps.push(Candidacy { slope, candidate: i, to: to_level, cost_us: to.cost - from.cost });
        }
    }
}

impl Selector for InOrder {
    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport {
        self.steps.clear();
        let mut spare_us = frame.budget.select_us;
        for (i, level) in levels.iter_mut().enumerate() {
            *level = frame.minimum(i);
            spare_us -= frame.cost_us(i, *level);
            self.push_steps(frame, i);
        }
        // A stable sort: equal steps of one candidate stay in order.
        self.steps.sort_by(|a, b| {
            b.slope.total_cmp(&a.slope).then_with(|| frame.key(a.candidate).cmp(&frame.key(b.candidate)))
        });
        let mut left_out = vec![false; levels.len()];
        for step in self.steps.iter().filter(|step| step.cost_us > 0.0) {
            if left_out[step.candidate] {
                continue;
            }
            if step.cost_us <= spare_us {
                spare_us -= step.cost_us;
                levels[step.candidate] = step.to;
            } else if self.goes_on {
                left_out[step.candidate] = true;
            } else {
                break;
            }
        }
        frame.report(levels)
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(self.clone())
    }
}
