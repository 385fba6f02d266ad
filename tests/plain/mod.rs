//! The rule of the policies that go by size, object by object, as a check inside a policy that is running.

use std::cmp::Ordering;

use lod_budget::check::{self, Promise};
use lod_budget::frame::{Candidates, SelectReport};
use lod_budget::select::{
    Frame, Measure, Needs, Reactive, ReactiveOptions, ScreenSize, ScreenSizeOptions, Selector,
};
use lod_budget::table::Level;
use proptest::prelude::*;

/// Measure, band and dwell at random.
pub fn size_options() -> impl Strategy<Value = ScreenSizeOptions> {
    let measure = prop_oneof![
        (0.05f32..20.0).prop_map(Measure::ErrorPx),
        (0.05f32..20.0).prop_map(|error_px| Measure::Authored { error_px }),
    ];
    let scale = prop_oneof![4 => 0.05f32..20.0, 1 => Just(1e-30f32), 1 => Just(1e30)];
    let band = prop_oneof![Just(0.0f32), Just(0.1), Just(1.0)];
    (measure, scale, band, prop_oneof![2 => Just(0u32), 1 => Just(20), 1 => Just(250)])
        .prop_map(|(measure, scale, band, dwell_ms)| ScreenSizeOptions { measure, scale, band, dwell_ms })
}

/// What a policy by size multiplies sizes by.
pub trait BySize: Selector + Clone + 'static {
    fn scale(&self, options: &ScreenSizeOptions) -> f32;

    /// Checks the step from the scale before, given whether everything was at its finest, and at its coarsest then.
    fn check_step(&self, before: Option<f32>, saturated: [bool; 2], frame: &Frame<'_>);
}

impl BySize for ScreenSize {
    fn scale(&self, options: &ScreenSizeOptions) -> f32 {
        options.scale
    }

    fn check_step(&self, _: Option<f32>, _: [bool; 2], _: &Frame<'_>) {}
}

impl BySize for Reactive {
    fn scale(&self, _: &ScreenSizeOptions) -> f32 {
        self.factor()
    }

    fn check_step(&self, before: Option<f32>, [finest, coarsest]: [bool; 2], frame: &Frame<'_>) {
        let before = before.unwrap_or(1.0);
        let ReactiveOptions { dead_band, range, .. } = ReactiveOptions::default();
        let error = frame.budget.target_us / frame.timing.filtered_us - 1.0;
        let is_news =
            frame.timing.fresh > 0 && frame.timing.filtered_us > 0.0 && frame.budget.target_us > 0.0;
        let is_off = is_news && error.abs() > 2.0 * f64::from(dead_band);
        let held = if error > 0.0 { finest || before >= range.1 } else { coarsest || before <= range.0 };
        let step = self.factor().total_cmp(&before);
        let expected = match held {
            true => Ordering::Equal,
            false => error.total_cmp(&0.0),
        };
        assert!(!is_off || step == expected, "{before} to {} by an error of {error}", self.factor());
    }
}

/// A policy by size whose every answer is held against the rule.
#[derive(Clone)]
pub struct Checked<P> {
    policy: P,
    options: ScreenSizeOptions,
    before: Option<f32>,
    saturated: [bool; 2],
}

impl<P: BySize> Checked<P> {
    pub fn new(policy: P, options: ScreenSizeOptions) -> Self {
        Self { policy, options, before: None, saturated: [false; 2] }
    }
}

impl<P: BySize> Selector for Checked<P> {
    fn needs(&self) -> Needs {
        self.policy.needs()
    }

    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport {
        let report = self.policy.select(frame, levels);
        let scale = self.policy.scale(&self.options);
        self.policy.check_step(self.before, self.saturated, frame);
        self.before = Some(scale);
        let detailed = frame.detailed();
        let frame = Frame { candidates: &detailed, ..*frame };
        for (group, range) in detailed.groups() {
            for i in range {
                let expected = level(&self.options, &frame, i, scale, group.lens.height_px);
                assert_eq!(levels[i], expected, "candidate {i} of {}", detailed.len());
            }
        }
        let honest = check::selection(&frame, levels, &report, Promise::Levels);
        assert!(honest.is_ok(), "{honest:?}");
        self.saturated = saturated(&frame, levels);
        report
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(self.clone())
    }
}

/// Whether everything is at its finest, and at its coarsest drawn level.
fn saturated(frame: &Frame<'_>, levels: &[Level]) -> [bool; 2] {
    let Candidates { allowed, table, .. } = frame.candidates;
    let coarsest = |i: usize| allowed[i].coarsest.0.min(frame.rates.levels(table[i]).len() as u8 - 1);
    let all = 0..levels.len();
    [all.clone().all(|i| levels[i] == allowed[i].finest), all.clone().all(|i| levels[i].0 >= coarsest(i))]
}

/// The level of a candidate, its last one and its age heeded.
fn level(options: &ScreenSizeOptions, frame: &Frame<'_>, i: usize, scale: f32, height_px: f32) -> Level {
    let allowed = &frame.candidates.allowed;
    let edge = 1.0 + options.band * 0.5;
    let Some(held) = frame.candidates.previous(i) else { return needed(options, frame, i, scale, height_px) };
    let waits = frame.age_ms(i) < options.dwell_ms && allowed[i].contains(held);
    let finest = needed(options, frame, i, scale * edge, height_px);
    let coarsest = needed(options, frame, i, scale / edge, height_px);
    if waits { held } else { held.max(finest).min(coarsest) }
}

/// The coarsest level that is good enough.
fn needed(options: &ScreenSizeOptions, frame: &Frame<'_>, i: usize, scale: f32, height_px: f32) -> Level {
    let Candidates { allowed, table, size_px, .. } = frame.candidates;
    let (finest, levels) = (allowed[i].finest.0, frame.rates.levels(table[i]));
    let coarsest = allowed[i].coarsest.0.min(levels.len() as u8 - 1);
    let size_px = size_px[i] * scale;
    let is_said = (finest..=coarsest).all(|l| !levels[usize::from(l)].min_size.is_nan());
    let found = match options.measure {
        Measure::Authored { .. } if is_said => (finest..coarsest)
            .find(|&l| size_px >= levels[usize::from(l)].min_size * height_px)
            .unwrap_or(coarsest),
        Measure::Authored { error_px } | Measure::ErrorPx(error_px) => {
            let good = |l: &u8| levels[usize::from(*l)].error * size_px * 0.5 <= error_px;
            (finest..=coarsest).rev().find(good).unwrap_or(finest)
        }
    };
    Level(found)
}
