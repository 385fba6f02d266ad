//! The static policy: the level follows from the object's size in the image alone.

use super::{Frame, Selector};
use crate::frame::OptionsError;
use crate::frame::{Cause, SelectReport};
use crate::rate::LevelRate;
use crate::scene::LevelRange;
use crate::table::Level;

/// What decides that a level is good enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Its geometric error, projected at the distance of the object's centre, is at most so many pixels. (At the nearest
    /// point, an object that contains the eye would be finest at any price.)
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

    /// The level for candidate `i` when sizes are multiplied by `scale`, hysteresis and dwell heeded.
    pub(super) fn level(&self, frame: &Frame<'_>, i: usize, scale: f32, height_px: f32) -> Level {
        let candidates = frame.candidates;
        let allowed = candidates.allowed[i];
        let levels = frame.rates.levels(candidates.table[i]);
        let size_px = candidates.size_px[i];
        let needed = |scale: f32| self.needed(levels, allowed, size_px * scale, height_px);
        let wanted = match candidates.previous[i] {
            None => needed(scale),
            Some(previous) => {
                let edge = 1.0 + self.band * 0.5;
                previous.clamp(needed(scale * edge), needed(scale / edge))
            }
        };
        match candidates.previous[i].filter(|&previous| allowed.contains(previous)) {
            Some(previous) if candidates.age_ms[i] < self.dwell_ms => previous,
            _ => wanted,
        }
    }

    /// Held back where the thresholds alone, without band and dwell, ask for a finer level.
    pub(super) fn cause(&self, frame: &Frame<'_>, i: usize, level: Level, scale: f32) -> Cause {
        let candidates = frame.candidates;
        let plain = Self { band: 0.0, dwell_ms: 0, ..*self };
        let group = candidates.group_of(i);
        let height_px =
            candidates.groups().find(|(g, _)| g.group == group).map_or(1.0, |(g, _)| g.lens.height_px);
        let held = candidates.previous[i] == Some(level) && plain.level(frame, i, scale, height_px) < level;
        match held {
            true if candidates.age_ms[i] < self.dwell_ms => Cause::Dwell,
            true => Cause::Hysteresis,
            false => Cause::Budget,
        }
    }

    /// The coarsest level that is good enough at this projected diameter.
    fn needed(&self, levels: &[LevelRate], allowed: LevelRange, size_px: f32, height_px: f32) -> Level {
        let finest = allowed.finest.index();
        let coarsest = allowed.coarsest.index().min(levels.len() - 1);
        let choice = &levels[finest..=coarsest];
        let found = match self.measure {
            Measure::Authored { .. } if choice.iter().all(|l| !l.min_size.is_nan()) => Some(
                choice.iter().position(|l| size_px >= l.min_size * height_px).unwrap_or(choice.len() - 1),
            ),
            _ => choice.iter().rposition(|l| l.error * size_px * 0.5 <= self.measure.error_px()),
        };
        Level((finest + found.unwrap_or(0)) as u8)
    }
}

/// Levels by size in the image, against fixed thresholds. Simple, and blind to the frame time.
#[derive(Clone, Copy, Debug, Default)]
pub struct ScreenSize {
    options: ScreenSizeOptions,
}

impl ScreenSize {
    /// The policy with these options.
    ///
    /// # Errors
    /// An option that is out of its range.
    pub fn new(options: ScreenSizeOptions) -> Result<Self, OptionsError> {
        options.check()?;
        Ok(Self { options })
    }
}

impl Selector for ScreenSize {
    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport {
        for (group, range) in frame.candidates.groups() {
            for i in range {
                levels[i] = self.options.level(frame, i, self.options.scale, group.lens.height_px);
            }
        }
        frame.report(levels)
    }

    fn cause(&self, frame: &Frame<'_>, i: usize, level: Level) -> Cause {
        self.options.cause(frame, i, level, self.options.scale)
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(*self)
    }
}
