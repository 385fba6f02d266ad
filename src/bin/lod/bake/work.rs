//! Several meshes at a time.

use std::fs;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::inputs::Input;

/// Takes how much of a mesh is done, from 0 to 1.
pub type Tell<'a> = dyn FnMut(f64) + Send + 'a;

/// What `bake` makes of each input, in their order; `jobs` of them at a time.
pub fn all<T: Send>(
    inputs: &[Input],
    jobs: usize,
    bar: &ProgressBar,
    bake: impl Fn(&Input, &mut Tell<'_>) -> T + Sync,
) -> Vec<T> {
    let sizes: Vec<u64> = inputs.iter().map(size).collect();
    bar.set_length(sizes.iter().sum());
    each(inputs, jobs, |i, input| {
        bar.set_message(input.name.clone());
        let mut share = Share { bar, size: sizes[i], told: 0 };
        let result = bake(input, &mut |done| share.tell(done));
        share.tell(1.0);
        result
    })
}

/// What `work` makes of each item, told with its number, in their order; `jobs` of them at a time.
pub fn each<I: Sync, T: Send>(items: &[I], jobs: usize, work: impl Fn(usize, &I) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<(usize, T)>> = Mutex::new(Vec::with_capacity(items.len()));
    let worker = || {
        while let Some((i, item)) = take(&next, items) {
            let result = work(i, item);
            // A thread that panics ends the scope with it: nobody looks at what it may have left broken.
            results.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push((i, result));
        }
    };
    thread::scope(|scope| {
        (1..jobs.min(items.len())).for_each(|_| _ = scope.spawn(worker));
        worker();
    });
    let mut results = results.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    results.sort_unstable_by_key(|&(i, _)| i);
    results.into_iter().map(|(_, result)| result).collect()
}

fn take<'a, I>(next: &AtomicUsize, items: &'a [I]) -> Option<(usize, &'a I)> {
    let i = next.fetch_add(1, Ordering::Relaxed);
    items.get(i).map(|item| (i, item))
}

/// How much work an input is thought to be: its size, in bytes, and a bit for each file.
fn size(input: &Input) -> u64 {
    1 + fs::metadata(&input.file).map_or(0, |about| about.len())
}

/// An input's part of the bar.
struct Share<'a> {
    bar: &'a ProgressBar,
    size: u64,
    told: u64,
}

impl Share<'_> {
    /// Never goes back.
    fn tell(&mut self, done: f64) {
        let now = (done.clamp(0.0, 1.0) * self.size as f64) as u64;
        self.bar.inc(now.saturating_sub(self.told));
        self.told = self.told.max(now);
    }
}

/// On standard error, and there only where it is a terminal.
pub fn progress_bar(hidden: bool) -> anyhow::Result<ProgressBar> {
    let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {eta} left  {msg:24!}")?;
    Ok(ProgressBar::with_draw_target(Some(1), target).with_style(style))
}
