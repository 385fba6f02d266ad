//! Baselines that heed neither size nor time.

use super::{Frame, Selector};
use crate::frame::SelectReport;
use crate::table::Level;

/// Every object at its finest allowed level: no elision.
#[derive(Clone, Copy, Debug, Default)]
pub struct Finest;

/// Every object at its cheapest choice: what a frame costs at least.
#[derive(Clone, Copy, Debug, Default)]
pub struct Coarsest;

impl Selector for Finest {
    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport {
        for (level, allowed) in levels.iter_mut().zip(&frame.candidates.allowed) {
            *level = allowed.finest;
        }
        frame.report(levels)
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(*self)
    }
}

impl Selector for Coarsest {
    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport {
        for (i, level) in levels.iter_mut().enumerate() {
            *level = frame.minimum(i);
        }
        frame.report(levels)
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(*self)
    }
}
