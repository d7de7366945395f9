//! Conversion of the cells of a sweep on several threads.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

use web_time::Instant;

use crate::app::memory::{self, Beside};
use crate::app::work;
use crate::core::fault::Fault;
use crate::core::progress::{Cancel, Need, Stage, Watch};
use crate::core::record::sweep::{Cell, Sweep};
use crate::core::run::Run;

/// The time between two calls while no cell is finished.
const PATIENCE: Duration = Duration::from_millis(20);

/// The name of each of the threads.
const THREAD: &str = "sweep";

/// The work that the threads share.
struct Work {
    run: Run,
    sweep: Sweep,
    missing: Vec<usize>,
    /// The place in `missing` of the next cell to convert.
    next: AtomicUsize,
    cancel: Cancel,
    threads: usize,
}

/// The watch of one of several conversions at the same time.
struct Worker {
    cancel: Cancel,
    others: usize,
}

impl Watch for Worker {
    fn tell(&mut self, _: Stage, _: u64, _: u64) {}

    fn cancel(&self) -> Cancel {
        self.cancel.clone()
    }

    fn allow(&mut self, need: &Need) -> Result<(), Fault> {
        memory::allow(need, Beside::Conversions(self.others))
    }
}

/// Converts the cells that a sweep of a run does not have yet, on so many threads. Calls `hear` from this thread with
/// the cells that were finished since the last call, and at least every 20 milliseconds, or after each cell where there
/// are no threads. Returns as soon as `hear` returns false, without the cells in work; their threads end by themselves.
pub(in crate::app) fn convert(
    run: &Run,
    sweep: &Sweep,
    threads: usize,
    hear: &mut dyn FnMut(Vec<(usize, Cell)>) -> bool,
) {
    let missing = sweep.missing();
    let threads = threads.clamp(1, missing.len().max(1));
    let (run, sweep, next) = (run.clone(), sweep.clone(), AtomicUsize::new(0));
    let work = Arc::new(Work { run, sweep, missing, next, cancel: Cancel::new(), threads });
    let (sender, receiver) = channel();
    let threads: Vec<_> = (0..threads)
        .filter_map(|_| {
            let (work, sender) = (Arc::clone(&work), sender.clone());
            // A machine that has no more threads makes do with those that there are.
            std::thread::Builder::new().name(THREAD.to_owned()).spawn(move || work.convert(&sender)).ok()
        })
        .collect();
    drop(sender);
    if threads.is_empty() {
        return work.convert_here(hear);
    }
    loop {
        let goes_on = match receiver.recv_timeout(PATIENCE) {
            Ok(first) => hear(std::iter::once(first).chain(receiver.try_iter()).collect()),
            Err(RecvTimeoutError::Timeout) => hear(Vec::new()),
            Err(RecvTimeoutError::Disconnected) => break,
        };
        if !goes_on {
            work.cancel.ask();
            return;
        }
    }
    for thread in threads {
        // A bug in a conversion is one here too.
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    }
}

impl Work {
    fn convert(&self, sender: &Sender<(usize, Cell)>) {
        while let Some(&cell) = self.missing.get(self.next.fetch_add(1, Ordering::Relaxed)) {
            let Some(done) = cell_of(&self.sweep.run_of(cell, &self.run), self.worker()) else { return };
            if sender.send((cell, done)).is_err() {
                return;
            }
        }
    }

    /// Converts the cells one after the other, where there are no threads.
    fn convert_here(&self, hear: &mut dyn FnMut(Vec<(usize, Cell)>) -> bool) {
        for &cell in &self.missing {
            let done = cell_of(&self.sweep.run_of(cell, &self.run), self.worker());
            if !hear(done.map(|done| (cell, done)).into_iter().collect()) {
                return;
            }
        }
    }

    fn worker(&self) -> Worker {
        Worker { cancel: self.cancel.clone(), others: self.threads - 1 }
    }
}

/// What a run ends with; `None` if it is cancelled.
fn cell_of(run: &Run, mut worker: Worker) -> Option<Cell> {
    worker.cancel.check().ok()?;
    let begin = Instant::now();
    let converted = work::convert(run, None, None, false, &mut worker);
    match converted {
        Ok(mut quads) => Some(match quads.flaw {
            Some(flaw) => Cell::Refused(flaw.to_string()),
            None => {
                // The stages are of no interest here: their sum is.
                quads.report.timing = vec![(Stage::Convert, begin.elapsed().as_secs_f64())];
                Cell::of(&quads.report)
            }
        }),
        Err(fault) if fault.is_stop() => None,
        Err(fault) => Some(Cell::Refused(fault.to_string())),
    }
}
