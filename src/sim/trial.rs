//! One policy over one scene and one camera path.

use std::collections::HashMap;

use glam::Vec2;

use super::machine::Machine;
use crate::files::{CameraPath, Pose, Scene};
use crate::frame::{Budget, Candidates, Change, FrameTime, GroupId, OptionsError};
use crate::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
use crate::scene::{ObjectError, ObjectId, Objects};
use crate::select::{Coarsest, Frame, Predictive, PredictiveOptions, Selector};
use crate::table::Level;
use crate::transition::Shown;
use crate::view::View;

/// How the path is looked along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Frames per second of path time, whatever frames take.
    pub fps: f64,
    /// Vertical field of view in degrees.
    pub fov_deg: f32,
    /// Viewport in pixels.
    pub viewport_px: Vec2,
    /// Near plane.
    pub near: f32,
    /// Far plane.
    pub far: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Self { fps: 60.0, fov_deg: 60.0, viewport_px: Vec2::new(1920.0, 1080.0), near: 0.1, far: 1000.0 }
    }
}

/// A path may have so many frames.
const MOST_FRAMES: usize = 1_000_000;

impl Camera {
    /// Whether the camera can be used, and the path has no more than a million frames in it: a time stamp that went
    /// wrong is no reason to run for a year.
    ///
    /// # Errors
    /// Names the option and the rule it breaks.
    pub fn check(&self, path: &CameraPath) -> Result<(), OptionsError> {
        let fps = self.fps.is_finite() && self.fps > 0.0;
        OptionsError::unless(fps, "fps", "must be finite and positive")?;
        let fov = self.fov_deg > 0.0 && self.fov_deg < 180.0;
        OptionsError::unless(fov, "fov", "must be above 0 and below 180 degrees")?;
        let view = self.view(&path.poses()[0]);
        view.check().map_err(|e| OptionsError { option: "camera", rule: e.rule })?;
        let short = self.frames(path) <= MOST_FRAMES;
        OptionsError::unless(short, "fps", "must be so low that the path has at most 1000000 frames")
    }

    /// The view from a pose.
    pub fn view(&self, pose: &Pose) -> View {
        let base = View::perspective(self.fov_deg.to_radians(), self.viewport_px);
        View { origin: pose.position, rotation: pose.rotation, near: self.near, far: self.far, ..base }
    }

    /// How many frames a path has: one at its start, the last not after its end.
    pub fn frames(&self, path: &CameraPath) -> usize {
        ((path.duration_s() * self.fps + 1e-6).floor() as usize).saturating_add(1)
    }

    fn views(self, path: &CameraPath) -> impl Iterator<Item = View> + '_ {
        let start_s = path.poses()[0].time_s;
        (0..self.frames(path)).map(move |k| self.view(&path.sample(start_s + k as f64 / self.fps)))
    }
}

/// What a frame costs at least and at most, without noise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reference {
    /// Every object at its cheapest choice.
    pub coarsest_us: f64,
    /// Every object at its finest level.
    pub finest_us: f64,
}

/// What happened in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FrameRow {
    /// Time the machine took, noise included.
    pub time_us: f64,
    /// Time by the runtime's model and correction.
    pub predicted_us: f64,
    /// Time of all objects at their cheapest choice, without noise.
    pub coarsest_us: f64,
    /// Time of all objects at their finest, without noise.
    pub finest_us: f64,
    /// Objects in view.
    pub visible: usize,
    /// Changes of level of objects that stayed in view.
    pub switches: usize,
    /// Changes back to where a change less than a second ago came from.
    pub reversals: usize,
    /// Plain benefit of what is shown.
    pub benefit: f64,
    /// Gain over the cheapest choice ÷ the certified bound of it at the true cost that was spent; `None` where nothing
    /// can be gained, or where it was not asked for.
    pub gain_over_bound: Option<f64>,
    /// The runtime's own certified gap, where the policy has one.
    pub gap: Option<f64>,
}

/// A scene, a path and a machine, ready for any policy.
#[derive(Clone, Debug)]
pub struct Trial<'a> {
    objects: Objects,
    path: &'a CameraPath,
    machine: &'a Machine,
    camera: Camera,
    options: RuntimeOptions,
}

impl<'a> Trial<'a> {
    /// Makes ready.
    ///
    /// # Errors
    /// An object that the hot store refuses.
    pub fn new(
        scene: &Scene,
        path: &'a CameraPath,
        machine: &'a Machine,
        camera: Camera,
        options: RuntimeOptions,
    ) -> Result<Self, ObjectError> {
        Ok(Self { objects: scene.to_objects()?, path, machine, camera, options })
    }

    /// What each frame of the path costs at least and at most.
    ///
    /// # Errors
    /// Runtime options out of range.
    pub fn references(&self) -> Result<Vec<Reference>, OptionsError> {
        let mut runtime = Runtime::new(self.options, Box::new(Coarsest))?;
        let mut objects = self.objects.clone();
        let mut seen = Candidates::default();
        let reference = |view| {
            runtime.frame(&mut objects, &FrameInput::new(&[ViewInput::new(view, 0)], f64::MAX));
            seen.clone_from(runtime.candidates());
            self.machine.see(&mut seen);
            Reference {
                coarsest_us: self.machine.time_us(&seen, runtime.wanted().iter().copied()),
                finest_us: self.machine.time_us(&seen, seen.allowed.iter().map(|a| a.finest)),
            }
        };
        Ok(self.camera.views(self.path).map(reference).collect())
    }

    /// Runs a policy over the path. With `bounds`, every frame is held against the best that its true cost could have
    /// bought. `tick` is told of every frame.
    ///
    /// # Errors
    /// Runtime options out of range.
    pub fn run(
        &self,
        selector: Box<dyn Selector>,
        budget_us: f64,
        bounds: Bounds,
        references: &[Reference],
        tick: &mut dyn FnMut(),
    ) -> Result<Vec<FrameRow>, OptionsError> {
        let mut runtime = Runtime::new(self.options, selector)?;
        let mut objects = self.objects.clone();
        let mut judge = Judge::new(self.machine, bounds)?;
        let mut pending = Vec::new();
        let mut rows = Vec::with_capacity(references.len());
        let frames = self.camera.views(self.path).zip(self.machine.noise()).zip(references);
        for ((view, noise), reference) in frames {
            let known =
                rows.len().checked_sub(self.machine.latency() - 1).and_then(|k| pending.get(k)).copied();
            let measured: &[FrameTime] = known.as_slice();
            let views = [ViewInput::new(view, 0)];
            let dt_s = (1.0 / self.camera.fps) as f32;
            runtime.frame(&mut objects, &FrameInput { dt_s, measured, ..FrameInput::new(&views, budget_us) });
            let row = judge.row(&runtime, &objects, reference, noise, rows.len() as f64 / self.camera.fps);
            pending.push(FrameTime::busy(runtime.report().frame, row.time_us as f32));
            rows.push(row);
            tick();
        }
        Ok(rows)
    }
}

/// Whether every frame is held against its bound, which costs a second selection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bounds {
    /// No.
    Skip,
    /// Yes.
    Certify,
}

/// Turns a finished frame into a row.
struct Judge<'a> {
    machine: &'a Machine,
    bounds: Bounds,
    oracle: Predictive,
    seen: Candidates,
    levels: Vec<Level>,
    shown: Vec<Level>,
    history: HashMap<ObjectId, (Level, f64)>,
}

/// A change back within this time is a reversal.
const REVERSAL_S: f64 = 1.0;

impl<'a> Judge<'a> {
    fn new(machine: &'a Machine, bounds: Bounds) -> Result<Self, OptionsError> {
        let free =
            PredictiveOptions { steadiness: None, hysteresis: 0.0, dwell_ms: 0, dwell: 0.0, ease: 0.0 };
        Ok(Self {
            machine,
            bounds,
            oracle: Predictive::new(free)?,
            seen: Candidates::default(),
            levels: Vec::new(),
            shown: Vec::new(),
            history: HashMap::new(),
        })
    }

    fn row(
        &mut self,
        runtime: &Runtime,
        objects: &Objects,
        reference: &Reference,
        noise: f64,
        time_s: f64,
    ) -> FrameRow {
        self.seen = runtime.last_frame(objects).detailed();
        self.machine.see(&mut self.seen);
        let shown = runtime.shown_slots(GroupId(0)).map(|(_, Shown { level, .. })| level);
        self.shown.clear();
        self.shown.extend(shown);
        let spent_us = self.machine.time_us(&self.seen, self.shown.iter().copied());
        let (switches, reversals) = self.count_switches(runtime.changes(), time_s);
        let frame = Frame {
            rates: self.machine.rates(),
            model: self.machine.model(),
            candidates: &self.seen,
            budget: outward(spent_us, self.shown.len()),
            floor: 0.0,
            ..runtime.last_frame(objects)
        };
        let benefit = frame.report(&self.shown).benefit;
        let gain_over_bound = match self.bounds {
            Bounds::Certify if spent_us > reference.coarsest_us * (1.0 + ROUNDING) => {
                gain_over_bound(&mut self.oracle, &mut self.levels, &frame, benefit)
            }
            _ => None,
        };
        let report = runtime.report();
        FrameRow {
            time_us: spent_us * noise,
            predicted_us: report.predicted_us,
            coarsest_us: reference.coarsest_us,
            finest_us: reference.finest_us,
            visible: report.candidates,
            switches,
            reversals,
            benefit,
            gain_over_bound,
            gap: report.select.certificate.map(|c| c.gap),
        }
    }

    /// Counts changes of objects that stayed in view, and those that go back to where they came from.
    fn count_switches(&mut self, changes: &[Change], time_s: f64) -> (usize, usize) {
        let (mut switches, mut reversals) = (0, 0);
        for change in changes {
            if !(change.old.is_drawn() && change.new.is_drawn()) {
                self.history.remove(&change.object);
                continue;
            }
            switches += 1;
            let last = self.history.insert(change.object, (change.old, time_s));
            let back = last.is_some_and(|(from, at)| from == change.new && time_s - at <= REVERSAL_S);
            reversals += usize::from(back);
        }
        (switches, reversals)
    }
}

/// Relative room for the rounding of sums of costs.
const ROUNDING: f64 = 1e-9;

/// The budget that holds a selection of this cost when each of its costs is rounded up to a tick of the knapsack.
fn outward(spent_us: f64, objects: usize) -> Budget {
    let select_us = spent_us * (1.0 + ROUNDING) + objects as f64 * 1e-6;
    Budget { frame_us: spent_us, target_us: spent_us, select_us }
}

/// Gain of `benefit` over the cheapest choice against the bound at the frame's budget.
fn gain_over_bound(
    oracle: &mut Predictive,
    levels: &mut Vec<Level>,
    frame: &Frame<'_>,
    benefit: f64,
) -> Option<f64> {
    levels.clear();
    levels.extend((0..frame.candidates.len()).map(|i| frame.minimum(i)));
    let least = frame.report(levels).benefit;
    let certificate = oracle.select(frame, levels).certificate?;
    let attainable = certificate.upper_bound - least;
    (attainable > 0.0).then(|| (benefit - least) / attainable)
}
