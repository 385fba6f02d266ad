//! Independent work on several threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// What `work` makes of every job, in the order of `jobs`, on up to `threads` threads, the caller's among them. Who
/// does which job is chance and changes nothing.
///
/// # Panics
/// When `work` does.
pub(super) fn in_parallel<J: Sync, R: Send>(
    jobs: &[J],
    threads: usize,
    work: impl Fn(&J) -> R + Sync,
) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let take_jobs = || {
        let taken = || {
            let at = next.fetch_add(1, Ordering::Relaxed);
            jobs.get(at).map(|job| (at, work(job)))
        };
        std::iter::from_fn(taken).collect::<Vec<_>>()
    };
    let mut done = thread::scope(|scope| {
        let others: Vec<_> = (1..threads.min(jobs.len())).map(|_| scope.spawn(take_jobs)).collect();
        let mut done = take_jobs();
        for other in others {
            done.extend(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        done
    });
    done.sort_unstable_by_key(|&(at, _)| at);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_the_order_of_jobs() {
        let jobs: Vec<usize> = (0..100).collect();
        for threads in [0, 1, 3, 200] {
            assert_eq!(
                in_parallel(&jobs, threads, |job| job * job),
                jobs.iter().map(|j| j * j).collect::<Vec<_>>()
            );
        }
        assert!(in_parallel(&[0; 0], 4, |&job: &i32| job).is_empty());
    }

    #[test]
    #[should_panic(expected = "job 3")]
    fn a_panic_is_passed_on() {
        in_parallel(&[1, 2, 3], 2, |&job| assert!(job != 3, "job {job}"));
    }
}
