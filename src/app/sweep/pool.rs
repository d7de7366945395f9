//! Conversion of the cells of a sweep on several threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use crate::app::work;
use crate::core::progress::{Cancel, Stage, Watch};
use crate::core::record::sweep::{Cell, Sweep};
use crate::core::run::Run;

/// The time between two calls while no cell is finished.
const PATIENCE: Duration = Duration::from_millis(20);

/// Converts the cells that a sweep of a run does not have yet, on so many threads. Calls `hear` from this thread with
/// the cells that were finished since the last call, and at least every 20 milliseconds. Ends when `hear` returns
/// false: the cells in work are then given up.
pub(in crate::app) fn convert(
    run: &Run,
    sweep: &Sweep,
    threads: usize,
    hear: &mut dyn FnMut(Vec<(usize, Cell)>) -> bool,
) {
    let cancel = Cancel::new();
    let missing = sweep.missing();
    let next = AtomicUsize::new(0);
    let (sender, receiver) = channel();
    std::thread::scope(|scope| {
        for _ in 0..threads.clamp(1, missing.len().max(1)) {
            let sender = sender.clone();
            let (missing, next, cancel) = (&missing, &next, &cancel);
            scope.spawn(move || {
                while let Some(&cell) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let Some(done) = cell_of(&sweep.run_of(cell, run), cancel) else { return };
                    if sender.send((cell, done)).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        loop {
            let goes_on = match receiver.recv_timeout(PATIENCE) {
                Ok(first) => hear(std::iter::once(first).chain(receiver.try_iter()).collect()),
                Err(RecvTimeoutError::Timeout) => hear(Vec::new()),
                Err(RecvTimeoutError::Disconnected) => return,
            };
            if !goes_on {
                cancel.ask();
            }
        }
    });
}

/// What a run ends with; `None` if it is cancelled.
fn cell_of(run: &Run, cancel: &Cancel) -> Option<Cell> {
    cancel.check().ok()?;
    let begin = Instant::now();
    let converted = work::convert(run, None, None, false, &mut OnlyCancel(cancel));
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

/// Reports nothing, and can be cancelled.
struct OnlyCancel<'c>(&'c Cancel);

impl Watch for OnlyCancel<'_> {
    fn tell(&mut self, _: Stage, _: u64, _: u64) {}

    fn cancel(&self) -> Cancel {
        self.0.clone()
    }
}
