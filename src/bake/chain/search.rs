//! The coarsest level within a distance: a search over what to ask the method for.
//!
//! A method stops at an error that it estimates, which says little about the distance between surfaces. So the estimate
//! is a knob: it is turned, and what comes out is measured, until the measured distance is close below the one that is
//! wanted. All distances are searched for side by side, as a method makes several levels in one pass.

use super::measure::Gauge;
use super::plan::{Plan, Tell, tell_measuring};
use super::{BakeError, ChainLevel};
use crate::bake::mesh::Mesh;
use crate::bake::simplify::{Simplified, Target, Task};

/// How often the method is asked. Each time halves, about, what a search leaves open, at the price of a whole chain.
const ROUNDS: usize = 8;

/// A level this close below its limit is close enough: less costs rounds, more leaves triangles in that could go.
const CLOSE: f64 = 0.95;

/// The widest step while only one end of the bracket is known.
const STRIDE: f64 = 8.0;

/// What was found for a limit.
pub(super) struct Found {
    pub(super) limit: f64,
    /// `None` where nothing coarser than level 0 was within the limit.
    pub(super) level: Option<ChainLevel>,
}

/// For each of these distances, which rise, the coarsest level that was found within it.
pub(super) fn search(
    plan: &Plan,
    task: &Task<'_>,
    limits: &[f64],
    gauge: &Gauge<'_>,
    progress: &mut Tell<'_>,
) -> Result<Vec<Found>, BakeError> {
    let mut quests: Vec<Quest> = limits.iter().map(|&limit| Quest::new(limit, task.mesh)).collect();
    for _ in 0..ROUNDS {
        let mut open: Vec<&mut Quest> = quests.iter_mut().filter(|quest| !quest.is_done()).collect();
        open.sort_by(|a, b| a.knob.total_cmp(&b.knob));
        let targets: Vec<Target> = open.iter().map(|quest| Target::error(quest.knob as f32)).collect();
        let levels = plan.simplify(task, &targets, progress)?;
        for (i, (quest, level)) in open.iter_mut().zip(levels).enumerate() {
            tell_measuring(i, targets.len(), progress)?;
            quest.learn(level, gauge)?;
        }
    }
    Ok(quests.into_iter().map(|quest| Found { limit: quest.limit, level: quest.best }).collect())
}

/// The search for one limit.
struct Quest {
    limit: f64,
    /// The error to ask for next.
    knob: f64,
    /// The greatest knob that is known to be within the limit, and the least that is not.
    within: f64,
    beyond: f64,
    best: Option<ChainLevel>,
    /// Triangles of the last answer: an answer that comes again says that the method has come to its end.
    last: usize,
    is_exhausted: bool,
}

impl Quest {
    fn new(limit: f64, finest: &Mesh) -> Self {
        let last = finest.triangles.len();
        Self { limit, knob: limit, within: 0.0, beyond: f64::INFINITY, best: None, last, is_exhausted: false }
    }

    fn is_done(&self) -> bool {
        let distance = self.best.as_ref().map_or(0.0, |level| level.deviation.hausdorff);
        let is_narrow = self.beyond - self.within <= (1.0 - CLOSE) * self.within;
        self.is_exhausted || is_narrow || distance >= CLOSE * self.limit
    }

    /// Takes in what the knob led to, and turns it.
    fn learn(
        &mut self,
        Simplified { mesh, heirs, .. }: Simplified,
        gauge: &Gauge<'_>,
    ) -> Result<(), BakeError> {
        let triangles = mesh.triangles.len();
        let level = if triangles == 0 { None } else { Some(gauge.descended(mesh, heirs)?) };
        let distance = level.as_ref().map_or(f64::INFINITY, |level| level.deviation.hausdorff);
        if distance <= self.limit {
            self.is_exhausted = self.within > 0.0 && self.beyond.is_infinite() && triangles == self.last;
            self.within = self.within.max(self.knob);
            self.keep(level);
        } else {
            self.beyond = self.beyond.min(self.knob);
        }
        self.last = triangles;
        self.turn(distance);
        Ok(())
    }

    /// The coarser one is better, and of two alike the closer one.
    fn keep(&mut self, level: Option<ChainLevel>) {
        let rank = |level: &ChainLevel| (level.triangles(), level.deviation.hausdorff);
        let is_better = |new: &ChainLevel| self.best.as_ref().is_none_or(|best| rank(new) < rank(best));
        self.best = level.filter(is_better).or(self.best.take());
    }

    /// Between the ends of the bracket; towards the open end in proportion while one is not known.
    fn turn(&mut self, distance: f64) {
        let proportion = self.limit / distance;
        self.knob = if self.beyond.is_infinite() {
            self.knob * proportion.clamp(1.2, STRIDE)
        } else if self.within == 0.0 {
            self.knob * proportion.clamp(1.0 / STRIDE, 0.8)
        } else {
            (self.within * self.beyond).sqrt()
        };
    }
}
