//! Timing: rounds in which every contestant runs once, so that all see the same weather.

use std::time::{Duration, Instant};

/// Who is timed: called once per round with the round's number, it returns how long it took.
pub struct Contestant<'a> {
    name: &'static str,
    /// It runs in rounds that are a multiple of this.
    every: usize,
    run: Box<dyn FnMut(usize) -> Duration + 'a>,
}

impl<'a> Contestant<'a> {
    pub fn new(name: &'static str, run: impl FnMut(usize) -> Duration + 'a) -> Self {
        Self { name, every: 1, run: Box::new(run) }
    }

    /// Runs only in rounds that are a multiple of `every`, for who takes long.
    pub fn every(self, every: usize) -> Self {
        Self { every, ..self }
    }
}

/// How long `work` takes.
pub fn timed(work: impl FnOnce()) -> Duration {
    let start = Instant::now();
    work();
    start.elapsed()
}

/// The tenth percentile of each contestant's times.
pub struct Times(Vec<(&'static str, f64)>);

impl Times {
    /// Nanoseconds; `None` for who was not there.
    pub fn ns(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(n, _)| *n == name).map(|&(_, ns)| ns)
    }

    pub fn ratio(&self, above: &str, below: &str) -> Option<f64> {
        Some(self.ns(above)? / self.ns(below)?)
    }
}

/// Runs so many rounds after one that does not count.
pub fn race(rounds: usize, mut contestants: Vec<Contestant<'_>>) -> Times {
    let mut times = vec![Vec::with_capacity(rounds); contestants.len()];
    for round in 0..=rounds {
        for (contestant, times) in contestants.iter_mut().zip(&mut times) {
            if round % contestant.every != 0 {
                continue;
            }
            let time = (contestant.run)(round);
            times.extend((round > 0).then_some(time));
        }
    }
    let names = contestants.iter().map(|c| c.name);
    Times(names.zip(times).map(|(name, times)| (name, p10_ns(times))).collect())
}

/// The time that a tenth of all, and one at least, is not above.
fn p10_ns(mut times: Vec<Duration>) -> f64 {
    times.sort_unstable();
    times.get(times.len().div_ceil(10).saturating_sub(1)).map_or(f64::NAN, |t| t.as_nanos() as f64)
}
