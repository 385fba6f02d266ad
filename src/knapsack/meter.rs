//! Work counted in steps, so that a search can be cut at the same place on every machine.

/// Counts steps against a limit and asks the caller now and then.
pub(super) struct Meter<'a> {
    left: u64,
    made: u64,
    stop: &'a mut dyn FnMut() -> bool,
}

impl<'a> Meter<'a> {
    /// Runs out after `steps`, or as soon as `stop` returns true.
    pub fn new(steps: u64, stop: &'a mut dyn FnMut() -> bool) -> Self {
        Self { left: steps, made: 0, stop }
    }

    /// Steps counted so far.
    pub fn made(&self) -> u64 {
        self.made
    }

    /// Steps that may still be made.
    pub fn left(&self) -> u64 {
        self.left
    }

    /// Counts `steps` if there are as many left, and says so; else none are left from then on.
    pub fn spend(&mut self, steps: u64) -> bool {
        if self.left < steps || (self.stop)() {
            self.left = 0;
            return false;
        }
        self.left -= steps;
        self.made += steps;
        true
    }
}
