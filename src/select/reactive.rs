//! The reactive policy: screen size times a factor that the measured frame time steers.

use super::screen_size::ScreenSizeOptions;
use super::sweep::Sweep;
use super::{Frame, Needs, Selector};
use crate::frame::OptionsError;
use crate::frame::{Candidate, Cause, SelectReport, Timing};
use crate::rate::TableRates;
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
    /// delay the answer by a dozen frames: values from about 0.3 on hunt for ever, and a longer dwell wants a smaller
    /// one.
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
#[derive(Clone, Debug)]
pub struct Reactive {
    options: ReactiveOptions,
    factor: f32,
    in_band: u32,
    saturated: Saturation,
    probe: Probe,
    sweep: Sweep,
}

/// Whether the last selection could still follow the factor.
#[derive(Clone, Copy, Debug, Default)]
struct Saturation {
    all_finest: bool,
    all_coarsest: bool,
}

impl Saturation {
    /// One more candidate, at this level.
    fn heed(&mut self, rates: &TableRates, candidate: &Candidate, level: Level) {
        let Candidate { table, allowed, .. } = *candidate;
        self.all_finest &= level == allowed.finest;
        self.all_coarsest &= level >= allowed.coarsest.min(rates.coarsest(table));
    }
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
        Ok(Self::start(options, Sweep::default()))
    }

    /// Before the first measurement.
    fn start(options: ReactiveOptions, sweep: Sweep) -> Self {
        let saturated = Saturation::default();
        Self { options, factor: 1.0, in_band: 0, saturated, probe: Probe::START, sweep }
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
    fn needs(&self) -> Needs {
        Needs::Sizes
    }

    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport {
        self.steer(&frame.timing, frame.budget.target_us);
        let (sweep, rates) = (&mut self.sweep, frame.rates);
        let mut chosen = Saturation { all_finest: true, all_coarsest: true };
        let heed = |candidate: &Candidate, level| chosen.heed(rates, candidate, level);
        self.options.size.choose(frame, self.factor, sweep, levels, heed);
        self.saturated = Saturation {
            all_finest: chosen.all_finest && sweep.every(rates, |_, level| level == Level::FINEST),
            all_coarsest: chosen.all_coarsest && sweep.every(rates, |table, l| l == rates.coarsest(table)),
        };
        sweep.report(frame)
    }

    fn cause(&self, frame: &Frame<'_>, i: usize, level: Level) -> Cause {
        self.options.size.cause(frame, i, level, self.factor)
    }

    fn reset(&mut self) {
        *self = Self::start(self.options, std::mem::take(&mut self.sweep));
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(self.clone())
    }
}
