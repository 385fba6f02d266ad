//! Why an object is shown as it is: computed on demand from what the last frame left behind.

use super::Runtime;
use crate::frame::{Cause, GroupId};
use crate::scene::{BLOCK, ObjectId, Objects, Settings};
use crate::table::Level;
use crate::transition::Shown;

/// What is shown of an object, and why it is not finer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Explanation {
    /// The level that the policy wants.
    pub wanted: Level,
    /// What is shown.
    pub shown: Shown,
    /// Why not finer.
    pub cause: Cause,
    /// Projected diameter, bias included.
    pub size_px: f32,
    /// Projected geometric error of the level that is shown, at most.
    pub error_px: f32,
    /// What the next finer level would gain, in px² per µs; 0 at the finest.
    pub next_value: f64,
    /// What a microsecond is worth, in px²; 0 when everything fits or the policy does not optimise.
    pub lambda: f64,
}

impl Runtime {
    /// Why an object is shown as it was in the last frame. `None` when it was not in view of the group.
    pub fn explain(&self, objects: &Objects, group: GroupId, id: ObjectId) -> Option<Explanation> {
        let slot = objects.slot_of(id)? as u32;
        let i = self.scratch.candidates.find(group, slot)?;
        let candidate = self.last_frame(objects).candidate(i);
        let shown = self.groups.get(group)?.visible(slot as usize)?;
        let rates = self.rates.levels(candidate.table);
        let error = rates.get(shown.level.index()).map_or(0.0, |l| l.error);
        Some(Explanation {
            wanted: self.scratch.levels[i],
            shown,
            cause: self.cause(objects, i, shown),
            size_px: candidate.size_px,
            error_px: error * candidate.near_px,
            next_value: self.next_value(objects, i, shown.level),
            lambda: self.report.select.certificate.map_or(0.0, |c| c.lambda),
        })
    }

    /// Why candidate `i` is shown as it is and not finer. The first reason that applies, in the order of precedence:
    /// resident > forced > clamp > budget > dwell and hysteresis.
    pub(super) fn cause(&self, objects: &Objects, i: usize, shown: Shown) -> Cause {
        if shown.is_in_flight() || shown.level != self.scratch.levels[i] {
            Cause::Fading
        } else if !shown.level.is_drawn() {
            Cause::TooSmall
        } else if shown.level == Level::FINEST {
            Cause::Finest
        } else if let Some(settings) = self.narrowed(objects, i, shown.level) {
            narrowed_by(settings, shown.level)
        } else {
            self.selector.cause(&self.last_frame(objects), i, shown.level)
        }
    }

    /// The settings of candidate `i` where `level`, not the finest of its table, is the finest that it may be shown at.
    fn narrowed<'a>(&self, objects: &'a Objects, i: usize, level: Level) -> Option<&'a Settings> {
        let (candidates, slot) = (&self.scratch.candidates, self.scratch.candidates.slot_of(i) as usize);
        let special = objects.blocks()[slot / BLOCK].special & (1 << (slot % BLOCK)) != 0;
        let is_finest = || self.last_frame(objects).candidate(i).allowed.finest == level;
        ((special || candidates.is_detailed()) && is_finest()).then(|| objects.settings(slot))
    }

    fn next_value(&self, objects: &Objects, i: usize, level: Level) -> f64 {
        let frame = self.last_frame(objects);
        let candidate = frame.candidate(i);
        let finer = frame.rates.drawn(candidate.table, candidate.allowed).rfind(|&(l, _)| l < level);
        finer.map_or(0.0, |(finer, _)| {
            let cost = frame.cost_us(i, finer) - frame.cost_us(i, level);
            let gain = frame.benefit(i, finer) - frame.benefit(i, level);
            if cost > 0.0 { gain / cost } else { f64::INFINITY }
        })
    }
}

/// Which setting keeps an object from going finer than `level`, the finest that is allowed.
fn narrowed_by(settings: &Settings, level: Level) -> Cause {
    if settings.resident.finest >= level {
        Cause::NotResident
    } else if settings.forced.is_some() {
        Cause::Forced
    } else if settings.clamp.finest >= level {
        Cause::Clamped
    } else {
        Cause::Budget
    }
}
