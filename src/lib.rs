//! Level-of-detail selection under a frame-time budget.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod bounds;
pub mod check;
pub mod cull;
pub mod feedback;
pub mod frame;
pub mod knapsack;
pub mod rate;
pub mod runtime;
pub mod scene;
pub mod select;
pub mod table;
pub mod transition;
pub mod view;

#[cfg(feature = "hecs")]
pub mod ecs;

#[cfg(feature = "files")]
pub mod files;

#[cfg(feature = "sim")]
pub mod sim;
