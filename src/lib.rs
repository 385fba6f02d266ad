//! Level-of-detail selection under a frame-time budget.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod knapsack;
