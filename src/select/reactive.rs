//! The reactive policy: screen size times a factor that the measured frame time steers.

use super::screen_size::ScreenSizeOptions;
use super::{Frame, Selector};
use crate::frame::OptionsError;
use crate::frame::{Cause, SelectReport, Timing};
use crate::table::Level;

/// Options of [`Reactive`].
///
/// The law is a proportional controller with what experience has taught such controllers to need: a dead band, so that
/// noise moves nothing; slew limits, slower up than down, so that a correction is never a jolt; no winding up where
/// every object is at its finest or cheapest; and, where vertical synchronisation hides how much room there is, probes
/// that grow rarer each time one fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReactiveOptions {
    /// Thresholds, hysteresis and dwell of the levels.
    pub size: ScreenSizeOptions,
    /// Half the width of the dead band around the target, as a fraction. Narrower tracks closer and hunts sooner.
    pub dead_band: f32,
    /// Share of the relative error that is corrected per measurement. Filter, dwell and measurements two frames late
    /// delay the answer by a dozen frames: values from about 0.3 on hunt for ever, and a longer dwell wants a smaller one.
    pub gain: f32,
    /// The most that the factor rises per measurement, as a fraction.
    pub rise: f32,
    /// The most that it falls.
    pub fall: f32,
    /// Smallest and largest factor.
    pub range: (f32, f32),
}

impl Default for ReactiveOptions {
    fn default() -> Self {
        Self {
            size: ScreenSizeOptions { dwell_ms: 100, ..ScreenSizeOptions::default() },
            dead_band: 0.04,
            gain: 0.2,
            rise: 0.1,
            fall: 0.2,
            range: (1e-6, 1e6),
        }
    }
}

impl ReactiveOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the option that is out of its range.
    pub fn check(&self) -> Result<(), OptionsError> {
        let share = |x: f32| x > 0.0 && x < 1.0;
        self.size.check()?;
        OptionsError::unless(share(self.dead_band), "dead_band", "must be between 0 and 1")?;
        OptionsError::unless(share(self.gain), "gain", "must be between 0 and 1")?;
        OptionsError::unless(share(self.rise), "rise", "must be between 0 and 1")?;
        OptionsError::unless(share(self.fall), "fall", "must be between 0 and 1")?;
        let (least, most) = self.range;
        let ordered = least > 0.0 && least <= 1.0 && most >= 1.0 && most.is_finite();
        OptionsError::unless(ordered, "range", "must be positive, finite and contain 1")
    }
}

/// Once inside, the dead band is so many times as wide: what has come to rest stays at rest.
const REST: f64 = 1.5;

/// Measurements in a row inside the band until it counts as rest.
const REST_AFTER: u32 = 30;

/// Measurements between probes when synchronisation hides the room there is: at first, and at most after failures.
const PROBE_EVERY: std::ops::RangeInclusive<u32> = 30..=7680;

/// Screen size with feedback. Cannot foresee: it is late by the time of measurement and filter whenever complex objects
/// come into view.
#[derive(Clone, Copy, Debug)]
pub struct Reactive {
    options: ReactiveOptions,
    factor: f32,
    in_band: u32,
    saturated: Saturation,
    probe: Probe,
}

/// Whether the last selection could still follow the factor.
#[derive(Clone, Copy, Debug, Default)]
struct Saturation {
    all_finest: bool,
    all_coarsest: bool,
}

/// The search for hidden room.
#[derive(Clone, Copy, Debug)]
struct Probe {
    /// Measurements until the next one.
    wait: u32,
    /// The wait after the next failure, half.
    every: u32,
    /// Whether the last move was a probe that has not been judged.
    pending: bool,
}

impl Probe {
    const START: Self = Self { wait: *PROBE_EVERY.start(), every: *PROBE_EVERY.start(), pending: false };
}

impl Reactive {
    /// The policy with these options.
    ///
    /// # Errors
    /// An option that is out of its range.
    pub fn new(options: ReactiveOptions) -> Result<Self, OptionsError> {
        options.check()?;
        Ok(Self { options, factor: 1.0, in_band: 0, saturated: Saturation::default(), probe: Probe::START })
    }

    /// The factor on sizes at present.
    pub fn factor(&self) -> f32 {
        self.factor
    }

    /// Moves the factor after new measurements.
    fn steer(&mut self, timing: &Timing, target_us: f64) {
        if timing.fresh == 0 || timing.filtered_us <= 0.0 || target_us <= 0.0 {
            return;
        }
        let error = target_us / timing.filtered_us - 1.0;
        let dead_band = f64::from(self.options.dead_band);
        let band = if self.in_band >= REST_AFTER { dead_band * REST } else { dead_band };
        if timing.censored && error > -band {
            self.probe_upwards();
        } else if error.abs() <= band {
            self.in_band += 1;
        } else {
            self.in_band = 0;
            self.fail_probe();
            self.correct(error as f32);
        }
    }

    fn correct(&mut self, error: f32) {
        let ReactiveOptions { gain, rise, fall, range, .. } = self.options;
        let held = error > 0.0 && self.saturated.all_finest || error < 0.0 && self.saturated.all_coarsest;
        if !held {
            let step = (gain * error).clamp(-fall, rise);
            self.factor = (self.factor * (1.0 + step)).clamp(range.0, range.1);
        }
    }

    /// The frame fits its display interval and no more is known: try a little more, rarely.
    fn probe_upwards(&mut self) {
        self.probe.wait = self.probe.wait.saturating_sub(1);
        if self.probe.wait == 0 && !self.saturated.all_finest {
            self.probe = Probe { wait: self.probe.every, pending: true, ..self.probe };
            self.correct(self.options.rise);
        }
    }

    /// Too slow: if a probe led here, wait twice as long for the next.
    fn fail_probe(&mut self) {
        if std::mem::take(&mut self.probe.pending) {
            self.probe.every = (self.probe.every * 2).min(*PROBE_EVERY.end());
            self.probe.wait = self.probe.every;
        }
    }
}

impl Selector for Reactive {
    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport {
        self.steer(&frame.timing, frame.budget.target_us);
        let mut saturated = Saturation { all_finest: true, all_coarsest: true };
        for (group, range) in frame.candidates.groups() {
            for i in range {
                levels[i] = self.options.size.level(frame, i, self.factor, group.lens.height_px);
                saturated.all_finest &= levels[i] == frame.candidates.allowed[i].finest;
                let coarsest = frame.rates.coarsest(frame.candidates.table[i]);
                saturated.all_coarsest &= levels[i] >= frame.candidates.allowed[i].coarsest.min(coarsest);
            }
        }
        self.saturated = saturated;
        frame.report(levels)
    }

    fn cause(&self, frame: &Frame<'_>, i: usize, level: Level) -> Cause {
        self.options.size.cause(frame, i, level, self.factor)
    }

    fn reset(&mut self) {
        *self = Self {
            options: self.options,
            factor: 1.0,
            in_band: 0,
            saturated: Saturation::default(),
            probe: Probe::START,
        };
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(*self)
    }
}
