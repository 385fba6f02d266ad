//! Level-of-detail selection under a frame-time budget.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod bounds;
pub mod knapsack;
pub mod scene;
pub mod table;
pub mod view;

#[cfg(feature = "files")]
pub mod files;

#[cfg(feature = "sim")]
pub mod sim;
