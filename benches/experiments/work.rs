//! Independent jobs on as many threads as the machine has; the results in the order of the jobs.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{available_parallelism, scope};

/// Does every job; how many are done goes to standard error.
pub fn in_parallel<J: Sync, R: Send>(what: &str, jobs: &[J], work: impl Fn(&J) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new((0..jobs.len()).map(|_| None).collect::<Vec<Option<R>>>());
    let one_thread = || {
        while let Some((i, job)) = Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|i| Some((i, jobs.get(i)?))) {
            let result = work(job);
            let mut done = done.lock().unwrap();
            done[i] = Some(result);
            let count = done.iter().flatten().count();
            if count.is_multiple_of(50) || count == jobs.len() {
                eprintln!("{what}: {count} of {}", jobs.len());
            }
        }
    };
    scope(|threads| {
        for _ in 0..available_parallelism().map_or(1, usize::from) {
            threads.spawn(one_thread);
        }
    });
    done.into_inner().unwrap().into_iter().map(|result| result.expect("every job was done")).collect()
}
