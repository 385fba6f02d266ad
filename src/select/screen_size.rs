//! The static policy: the level follows from the object's size in the image alone.

use std::ops::RangeInclusive;

use super::sweep::{Interval, NEVER, Sweep};
use super::{Frame, Needs, Selector};
use crate::frame::OptionsError;
use crate::frame::{Candidate, Cause, SelectReport};
use crate::rate::LevelRate;
use crate::scene::LevelRange;
use crate::table::Level;

/// What decides that a level is good enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Its geometric error, projected at the distance of the object's centre, is at most so many pixels. (At the
    /// nearest point, an object that contains the eye would be finest at any price.)
    ErrorPx(f32),
    /// The object is smaller than its author's size for the next finer level ([`crate::table::LevelRecord::min_size`]).
    /// Tables that do not say fall back to the error in pixels.
    Authored {
        /// Tolerance for tables without sizes.
        error_px: f32,
    },
}

impl Measure {
    fn error_px(self) -> f32 {
        match self {
            Self::ErrorPx(error_px) | Self::Authored { error_px } => error_px,
        }
    }
}

/// Options of [`ScreenSize`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenSizeOptions {
    /// What decides that a level is good enough.
    pub measure: Measure,
    /// Factor on every size: above 1 asks for more detail. > 0.
    pub scale: f32,
    /// Width of the hysteresis band, as a fraction of a threshold: the object improves above the threshold times
    /// 1 + band/2 and reduces below the threshold divided by it. 0 has no hysteresis.
    pub band: f32,
    /// A level stays for so long at least.
    pub dwell_ms: u32,
}

impl Default for ScreenSizeOptions {
    fn default() -> Self {
        Self { measure: Measure::Authored { error_px: 1.0 }, scale: 1.0, band: 0.1, dwell_ms: 250 }
    }
}

impl ScreenSizeOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the option that is out of its range.
    pub fn check(&self) -> Result<(), OptionsError> {
        let positive = |x: f32| x.is_finite() && x > 0.0;
        OptionsError::unless(positive(self.measure.error_px()), "error_px", "must be finite and positive")?;
        OptionsError::unless(positive(self.scale), "scale", "must be finite and positive")?;
        OptionsError::unless((0.0..=1.0).contains(&self.band), "band", "must be from 0 to 1")
    }

    /// Chooses the levels of all candidates when sizes are multiplied by `scale`. `chosen` is told of those that were
    /// decided one by one.
    pub(super) fn choose(
        &self,
        frame: &Frame<'_>,
        scale: f32,
        sweep: &mut Sweep,
        levels: &mut [Level],
        mut chosen: impl FnMut(&Candidate, Level),
    ) {
        sweep.begin(frame);
        for (group, range) in frame.candidates.groups() {
            let height_px = group.lens.height_px;
            sweep.set_holds(frame.rates, |table, intervals| {
                self.intervals(frame.rates.levels(table), scale, height_px, intervals);
            });
            sweep.choose(frame, range, levels, |i, candidate| {
                let level = self.level(frame, i, candidate, scale, height_px);
                chosen(candidate, level);
                level
            });
        }
    }

    /// The level for candidate `i` when sizes are multiplied by `scale`, hysteresis and dwell heeded.
    pub(super) fn level(
        &self,
        frame: &Frame<'_>,
        i: usize,
        candidate: &Candidate,
        scale: f32,
        height_px: f32,
    ) -> Level {
        let candidates = frame.candidates;
        let Candidate { table, allowed, size_px, .. } = *candidate;
        let levels = frame.rates.levels(table);
        let needed = |scale: f32| self.needed(levels, allowed, size_px * scale, height_px);
        let wanted = match candidates.previous(i) {
            None => needed(scale),
            Some(previous) => {
                let [up, down] = self.scales(scale);
                previous.clamp(needed(up), needed(down))
            }
        };
        match candidates.previous(i).filter(|&previous| allowed.contains(previous)) {
            Some(previous) if frame.age_ms(i) < self.dwell_ms => previous,
            _ => wanted,
        }
    }

    /// The factors on sizes by which an object improves, and by which it reduces.
    fn scales(&self, scale: f32) -> [f32; 2] {
        let edge = 1.0 + self.band * 0.5;
        [scale * edge, scale / edge]
    }

    /// The sizes at which [`ScreenSizeOptions::level`] stays at each of `levels`, finest first, when all of them are
    /// allowed: on the safe side, which leaves out some at the ends.
    fn intervals(&self, levels: &[LevelRate], scale: f32, height_px: f32, intervals: &mut Vec<Interval>) {
        let [up, down] = self.scales(scale);
        let ordinary = [up, down, self.measure.error_px()].iter().all(|x| ORDINARY.contains(x));
        let (first, end) = (intervals.len(), intervals.len() + levels.len());
        intervals.resize(end, if ordinary { [*ORDINARY.start(), *ORDINARY.end()] } else { NEVER });
        if ordinary {
            self.each_edge(levels, height_px, |level, edge| {
                let [finer, coarser] = [first + level - 1, first + level];
                intervals[finer][0] = intervals[finer][0].max(edge / up * (1.0 + INWARDS));
                intervals[coarser][1] = intervals[coarser][1].min(edge / down * (1.0 - INWARDS));
            });
        }
    }

    /// Tells of each level but the finest the size at which a finer one is needed.
    fn each_edge(&self, levels: &[LevelRate], height_px: f32, mut tell: impl FnMut(usize, f32)) {
        let mut least = f32::INFINITY;
        if self.is_authored(levels) {
            for (finer, level) in levels[..levels.len() - 1].iter().enumerate() {
                least = least.min(level.min_size);
                tell(finer + 1, least * height_px);
            }
        } else {
            for (coarser, level) in levels.iter().enumerate().skip(1).rev() {
                least = least.min(level.error);
                tell(coarser, 2.0 * self.measure.error_px() / least);
            }
        }
    }

    /// Whether the author's sizes decide among these levels.
    fn is_authored(&self, levels: &[LevelRate]) -> bool {
        matches!(self.measure, Measure::Authored { .. }) && levels.iter().all(|l| !l.min_size.is_nan())
    }

    /// Held back where the thresholds alone, without band and dwell, ask for a finer level.
    pub(super) fn cause(&self, frame: &Frame<'_>, i: usize, level: Level, scale: f32) -> Cause {
        let candidates = frame.candidates;
        let plain = Self { band: 0.0, dwell_ms: 0, ..*self };
        let group = candidates.group_of(i);
        let height_px =
            candidates.groups().find(|(g, _)| g.group == group).map_or(1.0, |(g, _)| g.lens.height_px);
        let plainly = plain.level(frame, i, &frame.candidate(i), scale, height_px);
        let held = candidates.previous(i) == Some(level) && plainly < level;
        match held {
            true if frame.age_ms(i) < self.dwell_ms => Cause::Dwell,
            true => Cause::Hysteresis,
            false => Cause::Budget,
        }
    }

    /// The coarsest level that is good enough at this projected diameter.
    fn needed(&self, levels: &[LevelRate], allowed: LevelRange, size_px: f32, height_px: f32) -> Level {
        let finest = allowed.finest.index();
        let coarsest = allowed.coarsest.index().min(levels.len() - 1);
        let choice = &levels[finest..=coarsest];
        let found = if self.is_authored(choice) {
            choice.iter().position(|l| size_px >= l.min_size * height_px).unwrap_or(choice.len() - 1)
        } else {
            let error_px = self.measure.error_px();
            choice.iter().rposition(|l| l.error * size_px * 0.5 <= error_px).unwrap_or(0)
        };
        Level((finest + found) as u8)
    }
}

/// Sizes and factors between which products of a few of them neither overflow nor lose digits. Beyond, objects are
/// decided one by one.
const ORDINARY: RangeInclusive<f32> = 1e-18..=1e18;

/// Intervals are made narrower by more than the five roundings of single precision between an edge and the rule.
const INWARDS: f32 = 1e-6;

/// Levels by size in the image, against fixed thresholds. Simple, and blind to the frame time.
#[derive(Clone, Debug, Default)]
pub struct ScreenSize {
    options: ScreenSizeOptions,
    sweep: Sweep,
}

impl ScreenSize {
    /// The policy with these options.
    ///
    /// # Errors
    /// An option that is out of its range.
    pub fn new(options: ScreenSizeOptions) -> Result<Self, OptionsError> {
        options.check()?;
        Ok(Self { options, ..Self::default() })
    }
}

impl Selector for ScreenSize {
    fn needs(&self) -> Needs {
        Needs::Sizes
    }

    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport {
        self.options.choose(frame, self.options.scale, &mut self.sweep, levels, |_, _| {});
        self.sweep.report(frame)
    }

    fn cause(&self, frame: &Frame<'_>, i: usize, level: Level) -> Cause {
        self.options.cause(frame, i, level, self.options.scale)
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(self.clone())
    }
}
