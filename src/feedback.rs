//! Feedback: from measured frame times to the next budget and to a cost model that fits the machine.
//!
//! Two estimators look at the same measurements. A scalar *correction*, measured ÷ predicted time, follows fast
//! whatever the model leaves out: the assets in view, heat, another program. A ridge *refit* of the coefficients
//! towards their prior learns slowly what kind of machine this is, so that the prediction holds when the scene changes.
//! Both are Kalman filters; what they say is applied only when it leaves a dead band, so that with a still camera noise
//! moves neither the budget nor a coefficient.
//!
//! Measurements are matched to their frames by id. A single one far off is a hitch and ignored; several in a row are
//! news. Under vertical synchronisation a time is a bound, not a measurement, and is used as such: nothing probes for
//! hidden room.

use crate::frame::OptionsError;
use crate::frame::{Budget, Clock, FrameId, FrameTime, Timing};
use crate::rate::{CostModel, DRIVERS, Drivers};

/// Options of [`Feedback`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedbackOptions {
    /// Share of the budget that is left free for noise, in 0…1. More misses fewer frames and shows less.
    pub headroom: f64,
    /// Share of the budget to aim at until `warm_up` measurements have arrived, in 0…1.
    pub start: f64,
    /// Measurements until the whole budget is used.
    pub warm_up: usize,
    /// How wrong the prior may be: relative standard deviation of each coefficient. 0 keeps the coefficients.
    pub prior_deviation: f64,
    /// Corrections closer than this to the one in use change nothing. Below about 0.005 noise comes through.
    pub dead_band: f64,
}

impl Default for FeedbackOptions {
    fn default() -> Self {
        Self { headroom: 0.03, start: 0.75, warm_up: 8, prior_deviation: 0.2, dead_band: 0.01 }
    }
}

impl FeedbackOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the option that is out of its range.
    pub fn check(&self) -> Result<(), OptionsError> {
        let share = |x: f64| (0.0..1.0).contains(&x);
        OptionsError::unless(share(self.headroom), "headroom", "must be at least 0 and below 1")?;
        OptionsError::unless(
            self.start > 0.0 && self.start <= 1.0,
            "start",
            "must be above 0 and at most 1",
        )?;
        OptionsError::unless(
            share(self.prior_deviation),
            "prior_deviation",
            "must be at least 0 and below 1",
        )?;
        OptionsError::unless(share(self.dead_band), "dead_band", "must be at least 0 and below 1")
    }
}

/// What was expected of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prediction {
    /// The frame.
    pub frame: FrameId,
    /// Counts of draw calls, vertices, triangles and pixels that were to be drawn.
    pub drivers: Drivers,
    /// Time by the cost model in use, not corrected.
    pub model_us: f64,
    /// Share of the objects in view that came or went, 0 to 1: how much news a measurement may hold.
    pub churn: f64,
    /// Whether a measurement of this frame may be learnt from; not so of a paused one.
    pub usable: bool,
}

/// Predictions that wait for their measurement: a frame measured later than this is not learnt from.
const WAITING: usize = 64;

/// The loop from measured time to the next budget.
#[derive(Clone, Debug)]
pub struct Feedback {
    options: FeedbackOptions,
    model: CostModel,
    model_revision: u64,
    waiting: [Prediction; WAITING],
    correction: Correction,
    refit: Refit,
    timing: Timing,
    measurements: usize,
}

impl Feedback {
    /// Starts from the cost model `prior`.
    ///
    /// # Errors
    /// An option that is out of its range.
    pub fn new(options: FeedbackOptions, prior: CostModel) -> Result<Self, OptionsError> {
        options.check()?;
        prior
            .check()
            .map_err(|e| OptionsError { option: e.coefficient, rule: "must be from 0 to 1e6 µs" })?;
        Ok(Self::start(options, prior))
    }

    fn start(options: FeedbackOptions, prior: CostModel) -> Self {
        Self {
            options,
            model: prior,
            model_revision: 0,
            waiting: [Prediction::default(); WAITING],
            correction: Correction::NEW,
            refit: Refit::new(prior, options.prior_deviation),
            timing: Timing::default(),
            measurements: 0,
        }
    }

    /// Forgets all measurements and starts again from the cost model `prior`, which must be a good one.
    pub fn reset(&mut self, prior: CostModel) {
        let model_revision = self.model_revision + 1;
        *self = Self { model_revision, ..Self::start(self.options, prior) };
    }

    /// The cost model in use.
    pub fn model(&self) -> &CostModel {
        &self.model
    }

    /// Raised whenever the cost model in use changes.
    pub fn model_revision(&self) -> u64 {
        self.model_revision
    }

    /// How much slower than the cost model the machine has shown to be.
    pub fn correction(&self) -> f64 {
        self.correction.applied
    }

    /// What is known of the time that frames take.
    pub fn timing(&self) -> Timing {
        self.timing
    }

    /// The budget of the next frame.
    pub fn budget(&self, frame_us: f64) -> Budget {
        let cold = self.measurements < self.options.warm_up;
        let share = if cold { self.options.start } else { 1.0 - self.options.headroom };
        let target_us = frame_us * share;
        Budget { frame_us, target_us, select_us: target_us / self.correction.applied }
    }

    /// Remembers what is expected of a frame until its measurement arrives.
    pub fn expect(&mut self, prediction: Prediction) {
        self.waiting[prediction.frame.0 as usize % WAITING] = prediction;
    }

    /// Learns from measurements, in the order they arrive. Those of unknown frames, those that are no positive finite
    /// time and those of paused frames are passed over.
    pub fn measure(&mut self, times: &[FrameTime]) {
        self.timing.fresh = 0;
        for time in times {
            let expected = self.waiting[time.frame.0 as usize % WAITING];
            let valid = time.time_us.is_finite() && time.time_us > 0.0;
            if valid && expected.usable && expected.frame == time.frame {
                self.waiting[time.frame.0 as usize % WAITING].usable = false;
                self.learn(time, &expected);
            }
        }
    }

    fn learn(&mut self, time: &FrameTime, expected: &Prediction) {
        self.timing.censored = is_censored(time);
        self.measurements += 1;
        let before_us = expected.model_us * self.correction.value;
        let Some(time_us) = informative_us(time, before_us) else {
            self.filter(f64::from(time.time_us));
            return;
        };
        // The model may have been refitted since; the correction is to the model in use.
        let model_us = expected.model_us * self.drift_since(expected);
        if model_us <= 0.0 || !self.correction.observe(time_us / model_us, expected.churn) {
            return;
        }
        self.filter(f64::from(time.time_us));
        self.correction.apply(self.options.dead_band);
        self.refit.observe(&expected.drivers, time_us);
        self.adopt_refit(&expected.drivers);
    }

    fn filter(&mut self, time_us: f64) {
        let step = if self.timing.filtered_us > 0.0 { FILTER } else { 1.0 };
        self.timing.filtered_us += step * (time_us - self.timing.filtered_us);
        self.timing.fresh += 1;
    }

    /// How the model in use prices a frame, against how it was priced when it was predicted.
    fn drift_since(&self, expected: &Prediction) -> f64 {
        match self.refit.is_linear() && expected.model_us > 0.0 {
            true => price(&self.model.coefficients(), &expected.drivers) / expected.model_us,
            false => 1.0,
        }
    }

    /// Takes the refitted coefficients into use when they price this frame's drivers differently enough, one by one.
    /// The correction moves the other way, so that the price of this frame stays.
    fn adopt_refit(&mut self, drivers: &Drivers) {
        let (old, new) = (self.model.coefficients(), self.refit.coefficients());
        let total = price(&old, drivers);
        let moved = (0..DRIVERS).map(|k| ((new[k] - old[k]) * drivers[k]).abs()).fold(0.0, f64::max);
        if self.refit.is_settled() && moved > REFIT_BAND * total {
            self.correction.rescale(total / price(&new, drivers));
            self.model = self.model.with_coefficients(new);
            self.model_revision += 1;
            self.refit.fresh = 0;
        }
    }
}

/// Share of a new measurement in the filtered time.
const FILTER: f64 = 0.2;

/// A refit is taken into use when a driver's share of the frame's price moves by this fraction of the whole. Changing
/// coefficients shifts every object's value, so this is wider than the dead band of the correction.
const REFIT_BAND: f64 = 0.02;

fn price(coefficients: &Drivers, drivers: &Drivers) -> f64 {
    coefficients.iter().zip(drivers).map(|(c, d)| c * d).sum()
}

/// Whether the time says only that the frame fits one display interval.
fn is_censored(time: &FrameTime) -> bool {
    match time.clock {
        Clock::Busy => false,
        Clock::Vsync { interval_us } => time.time_us < 1.5 * interval_us,
    }
}

/// What the measurement says about the frame's own time: the time itself, or the end of the range of whole intervals
/// that contradicts the expectation; `None` where the expectation lies within it.
fn informative_us(time: &FrameTime, expected_us: f64) -> Option<f64> {
    let Clock::Vsync { interval_us } = time.clock else {
        return Some(f64::from(time.time_us));
    };
    let interval_us = f64::from(interval_us);
    let intervals = (f64::from(time.time_us) / interval_us + 0.5).floor().max(1.0);
    let (least, most) = ((intervals - 1.0) * interval_us, intervals * interval_us);
    match expected_us {
        e if e > most => Some(most),
        e if e < least => Some(least * 1.02),
        _ => None,
    }
}

/// Measured ÷ predicted time, as a scalar Kalman filter with relative variances.
#[derive(Clone, Copy, Debug)]
struct Correction {
    value: f64,
    applied: f64,
    variance: f64,
    /// Estimated variance of one measurement.
    noise: f64,
    /// Measurements in a row that were too far off, positive for slow ones.
    surprises: i32,
}

/// Variance that the correction gains per frame by itself: a drift of about 1 % in a second.
const DRIFT: f64 = 4e-8;
/// Variance that it gains when everything in view is exchanged: assets differ from the model by about 10 %, and a view
/// holds many of them.
const CHURN: f64 = 5e-4;
/// Range of the estimated noise variance.
const NOISE: (f64, f64) = (1e-4, 4e-2);
/// Share of a measurement in the noise estimate.
const NOISE_RATE: f64 = 0.02;
/// Standard deviations beyond which a measurement is a surprise.
const SURPRISE: f64 = 4.0;
/// So many surprises of one sign in a row are news, not hitches.
const NEWS: i32 = 3;

impl Correction {
    const NEW: Self = Self { value: 1.0, applied: 1.0, variance: 0.09, noise: 1.6e-3, surprises: 0 };

    /// Learns from a measured ÷ predicted ratio. False for a hitch, which is not learnt from.
    fn observe(&mut self, ratio: f64, churn: f64) -> bool {
        self.variance += DRIFT + CHURN * churn;
        let innovation = ratio / self.value - 1.0;
        let spread = self.variance + self.noise;
        if innovation.abs() > SURPRISE * spread.sqrt() {
            let sign = if innovation > 0.0 { 1 } else { -1 };
            self.surprises = if self.surprises * sign > 0 { self.surprises + sign } else { sign };
            if self.surprises.abs() < NEWS {
                return false;
            }
            self.variance = innovation * innovation;
        }
        self.surprises = 0;
        let gain = self.variance / (self.variance + self.noise);
        self.noise += NOISE_RATE * ((innovation * innovation - self.variance).max(0.0) - self.noise);
        self.noise = self.noise.clamp(NOISE.0, NOISE.1);
        self.value *= 1.0 + gain * innovation;
        self.variance *= 1.0 - gain;
        true
    }

    /// Follows the value with a dead band's slack: a move back within it changes nothing.
    fn apply(&mut self, dead_band: f64) {
        let slack = 1.0 + dead_band;
        self.applied = self.applied.clamp(self.value / slack, self.value * slack);
    }

    fn rescale(&mut self, factor: f64) {
        self.value *= factor;
        self.applied *= factor;
    }
}

/// Bayesian linear regression of measured time on drivers: multipliers of the prior's coefficients, their mean at first
/// 1. The prior acts as the ridge.
///
/// Source: A. Hoerl and R. Kennard, "Ridge Regression: Biased Estimation for Nonorthogonal Problems", 1970; in
/// recursive form R. E. Kalman, "A New Approach to Linear Filtering and Prediction Problems", 1960.
#[derive(Clone, Copy, Debug)]
struct Refit {
    prior: CostModel,
    multipliers: Drivers,
    covariance: [Drivers; DRIVERS],
    fresh: usize,
}

/// Relative standard deviation of a frame's time around the best linear model: frame noise and the assets' own.
const MISFIT: f64 = 0.06;
/// Measurements between refits that are taken into use.
const REFIT_EVERY: usize = 30;
/// No multiplier leaves this range.
const MULTIPLIER: (f64, f64) = (0.2, 5.0);

impl Refit {
    fn new(prior: CostModel, deviation: f64) -> Self {
        let mut covariance = [[0.0; DRIVERS]; DRIVERS];
        (0..DRIVERS).for_each(|k| covariance[k][k] = deviation * deviation);
        Self { prior, multipliers: [1.0; DRIVERS], covariance, fresh: 0 }
    }

    /// Where the slower of two stages counts, time is no linear function of the drivers, and the correction is alone.
    fn is_linear(&self) -> bool {
        self.prior.stages == crate::rate::Stages::Sum
    }

    fn is_settled(&self) -> bool {
        self.is_linear() && self.fresh >= REFIT_EVERY
    }

    fn coefficients(&self) -> Drivers {
        let prior = self.prior.coefficients();
        std::array::from_fn(|k| prior[k] * self.multipliers[k])
    }

    fn observe(&mut self, drivers: &Drivers, time_us: f64) {
        if !self.is_linear() {
            return;
        }
        let prior = self.prior.coefficients();
        let shares: Drivers = std::array::from_fn(|k| prior[k] * drivers[k] / time_us);
        let spread: Drivers = std::array::from_fn(|k| price(&self.covariance[k], &shares));
        let variance = price(&shares, &spread) + MISFIT * MISFIT;
        let innovation = 1.0 - price(&self.multipliers, &shares);
        for k in 0..DRIVERS {
            let moved = self.multipliers[k] + spread[k] / variance * innovation;
            self.multipliers[k] = moved.clamp(MULTIPLIER.0, MULTIPLIER.1);
            for j in 0..DRIVERS {
                self.covariance[k][j] -= spread[k] * spread[j] / variance;
            }
        }
        self.fresh += 1;
    }
}
