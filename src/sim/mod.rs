//! Simulation: policies over scenes and camera paths on simulated machines, and how well they did.
//!
//! [`compare`] is the whole job; [`Trial`] runs one policy, [`Machine`] says how long a frame would really take, and
//! [`Metrics`] sums up.

pub mod generate;

mod compare;
mod machine;
mod metrics;
mod threads;
mod trial;

pub use compare::{CompareError, CompareOptions, Comparison, Policy, PolicyResult, Progress, compare};
pub use machine::Machine;
pub use metrics::{FrameMs, Metrics};
pub use trial::{Bounds, Camera, FrameRow, Reference, Trial};
