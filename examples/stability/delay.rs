//! How long what is wanted waits until it is shown.
//!
//! The optimum of a frame *wants* a level of an object while it has that level or a finer one. A want that arises while
//! the object is held coarser waits until it is held so fine. Wants that last less than a second are no delays: to show
//! them would be a reversal. Those that last a second count until they are shown, or to their end if they never are.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use lod_budget::frame::{Cause, Deferral, OptionsError, SelectReport};
use lod_budget::select::{Frame, Needs, Predictive, Selector};
use lod_budget::{Level, ObjectId};

use crate::rules::plain;

/// What a change back within is called a reversal.
const LASTING_S: f64 = 1.0;

/// 95th percentiles over the wants that last.
#[derive(Clone, Copy)]
pub struct Delays {
    /// Each counts as one.
    pub each_s: f64,
    /// Each counts as much as it is worth: the benefit of the level beyond that of the next coarser one.
    pub by_benefit_s: f64,
}

impl Delays {
    /// Sums up what was watched. 0 without any want.
    pub fn of(log: &Mutex<Log>) -> Self {
        let mut log = log.lock().unwrap_or_else(PoisonError::into_inner);
        log.close(|_| true);
        log.lasting.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        Self { each_s: p95(&log.lasting, |_| 1.0), by_benefit_s: p95(&log.lasting, |worth| worth) }
    }
}

fn p95(sorted: &[(f64, f64)], weight: impl Fn(f64) -> f64) -> f64 {
    let mut left = 0.95 * sorted.iter().map(|&(_, worth)| weight(worth)).sum::<f64>();
    let reaches = |&&(_, worth): &&(f64, f64)| {
        left -= weight(worth);
        left <= 0.0
    };
    sorted.iter().find(reaches).map_or(0.0, |&(delay_s, _)| delay_s)
}

/// A level that the optimum wants of an object.
#[derive(Clone, Copy)]
struct Want {
    since: u64,
    shown: Option<u64>,
    /// Whether the object was held coarser when it arose.
    waits: bool,
    worth: f64,
}

/// What the optimum wants of an object, level by level.
struct Wants {
    seen: u64,
    by_level: Vec<Option<Want>>,
}

/// What has been watched.
pub struct Log {
    frame: u64,
    fps: f64,
    open: HashMap<ObjectId, Wants>,
    /// Delay in seconds and worth in px² of every want that lasted.
    lasting: Vec<(f64, f64)>,
}

impl Log {
    fn end(&mut self, want: Want, end: u64) {
        let seconds = |frames: u64| frames as f64 / self.fps;
        if want.waits && seconds(end - want.since) >= LASTING_S {
            self.lasting.push((seconds(want.shown.unwrap_or(end) - want.since), want.worth));
        }
    }

    /// Ends all wants of the objects that `is_gone` says are gone.
    fn close(&mut self, is_gone: impl Fn(&Wants) -> bool) {
        let gone: Vec<Wants> = self.open.extract_if(|_, wants| is_gone(wants)).map(|(_, w)| w).collect();
        for Wants { seen, by_level } in gone {
            by_level.into_iter().flatten().for_each(|want| self.end(want, seen + 1));
        }
    }

    /// Notes what the optimum has for candidate `i`, and what is held.
    fn note(&mut self, frame: &Frame<'_>, i: usize, best: Level, held: Level) {
        let Some(id) = frame.objects.id_of(frame.candidates.slot_of(i) as usize) else { return };
        let (now, table) = (self.frame, frame.candidate(i).table);
        let levels = frame.rates.levels(table).len();
        let mut wants =
            self.open.remove(&id).unwrap_or_else(|| Wants { seen: now, by_level: vec![None; levels] });
        wants.seen = now;
        // Nothing waits of what has just come into view: it is shown at once.
        let coarsest = frame.candidates.previous(i).map_or(Level::FINEST, |before| before.max(held));
        for (level, want) in (0..levels as u8).map(Level).zip(&mut wants.by_level) {
            if best > level {
                want.take().into_iter().for_each(|want| self.end(want, now));
                continue;
            }
            let coarser = if level.index() + 1 < levels { Level(level.0 + 1) } else { Level::NOT_DRAWN };
            let worth = || frame.benefit(i, level) - frame.benefit(i, coarser);
            let waits = coarsest > level;
            let want = want.get_or_insert_with(|| Want { since: now, shown: None, waits, worth: worth() });
            if held <= level {
                want.shown.get_or_insert(now);
            }
        }
        self.open.insert(id, wants);
    }
}

/// A policy, the optimum beside it, and what comes of comparing them.
#[derive(Clone)]
pub struct Watched {
    policy: Box<dyn Selector>,
    optimum: Predictive,
    best: Vec<Level>,
    log: Arc<Mutex<Log>>,
}

impl Watched {
    /// Watches `policy` at so many frames per second.
    pub fn new(policy: Box<dyn Selector>, fps: f64) -> Result<(Self, Arc<Mutex<Log>>), OptionsError> {
        let log = Log { frame: 0, fps, open: HashMap::new(), lasting: Vec::new() };
        let log = Arc::new(Mutex::new(log));
        Ok((Self { policy, optimum: plain()?, best: Vec::new(), log: log.clone() }, log))
    }
}

impl Selector for Watched {
    fn needs(&self) -> Needs {
        self.policy.needs()
    }

    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport {
        self.best.clear();
        self.best.extend_from_slice(levels);
        self.optimum.select(frame, &mut self.best);
        let report = self.policy.select(frame, levels);
        let mut log = self.log.lock().unwrap_or_else(PoisonError::into_inner);
        log.frame += 1;
        for (i, (&best, &held)) in self.best.iter().zip(&*levels).enumerate() {
            log.note(frame, i, best, held);
        }
        let now = log.frame;
        log.close(|wants| wants.seen < now);
        report
    }

    fn floor(&self) -> f64 {
        self.policy.floor()
    }

    fn cause(&self, frame: &Frame<'_>, i: usize, level: Level) -> Cause {
        self.policy.cause(frame, i, level)
    }

    fn deferred(&self) -> Option<&[Deferral]> {
        self.policy.deferred()
    }

    fn reset(&mut self) {
        self.policy.reset();
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(self.clone())
    }
}
