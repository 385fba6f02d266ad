//! Simplifying step by step: what the methods that take vertices out of a [`Workpiece`] one after another share.

use std::ops::ControlFlow;

use super::workpiece::Workpiece;
use super::{Progress, Simplified, SimplifyError, Task};

/// The steps of a method, best first.
pub(super) trait Steps {
    /// Takes the best step, or finds that it may not be taken; breaks where there is none left.
    fn step(&mut self, piece: &mut Workpiece) -> ControlFlow<()>;

    /// The largest error of a step so far, in places.
    fn error(&self) -> f64;
}

/// Takes steps until the target is met or none is left. `begin` knows the first ones.
///
/// # Errors
/// A task that breaks a rule of [`Task`].
pub(super) fn step_by_step<S: Steps>(
    task: &Task,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    begin: impl FnOnce(&Workpiece) -> S,
) -> Result<Simplified, SimplifyError> {
    task.check()?;
    let mut piece = Workpiece::new(task);
    let mut steps = begin(&piece);
    let stopped = piece.run(progress, |piece| steps.step(piece));
    let error = piece.in_units(steps.error());
    Ok(piece.finish(error, stopped))
}
