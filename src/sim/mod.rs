//! Simulation: procedural scenes to try the selection on.

pub mod generate;
