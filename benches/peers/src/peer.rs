//! What every peer is asked for, and what is kept of its answers.

use std::time::Duration;

use serde::Deserialize;

use crate::camera::{Bound, Camera};
use crate::scene::LEVELS;

/// Objects in view at each level, after a frame.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
pub struct Census(pub [usize; LEVELS]);

impl Census {
    pub fn visible(&self) -> usize {
        self.0.iter().sum()
    }
}

/// What a policy with a budget made of it in its last frame.
#[derive(Clone, Copy, Debug)]
pub struct Spent {
    /// Predicted time ÷ budget.
    pub share: f64,
    /// How far the choice is from the best at most, as a fraction of the gain; only who optimises knows.
    pub gap: Option<f64>,
}

/// Somebody who culls and selects levels in this process.
pub trait Peer {
    fn name(&self) -> &'static str;

    /// What it tests against the view.
    fn bound(&self) -> Bound;

    /// One frame, from where the camera is to which objects are to be drawn at which level. Returns the processor's
    /// time that it took this thread.
    fn frame(&mut self, camera: &Camera) -> Duration;

    /// The last frame's answer.
    fn census(&mut self) -> Census;

    /// Nothing, for who has no budget.
    fn spent(&self) -> Option<Spent> {
        None
    }
}

/// The frames of a peer in a scene.
pub struct Frames {
    pub bound: Bound,
    /// Nanoseconds per frame.
    pub times_ns: Vec<f64>,
    /// After the last frame.
    pub census: Census,
    pub spent: Option<Spent>,
}

impl Frames {
    /// The time that a tenth of the frames, and one at least, is not above.
    pub fn p10_ns(&self) -> f64 {
        let mut times = self.times_ns.clone();
        times.sort_unstable_by(f64::total_cmp);
        times.get(times.len().div_ceil(10).saturating_sub(1)).copied().unwrap_or(f64::NAN)
    }
}

/// A row of the table: a peer in a scene, or why it was not measured.
pub struct Row {
    pub peer: String,
    pub objects: usize,
    pub outcome: Result<Frames, String>,
}
