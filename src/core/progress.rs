//! Progress and cancellation of long work. `core` has no clock: the watcher measures time.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::fault::Fault;

/// The stages of a conversion, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Stage {
    /// Reading the case or the mesh, in bytes.
    Read,
    /// Repairing the given mesh.
    Repair,
    /// Cutting a surface into charts and flattening them, in triangles.
    Chart,
    /// Dividing curves with an even count for each loop.
    Divide,
    /// Constrained Delaunay triangulation.
    Triangulate,
    /// Adapting the background mesh to the metric.
    Adapt,
    /// Merging triangles into quadrilaterals.
    Convert,
    /// Clean-up and smoothing.
    Finish,
    /// Checking and measuring.
    Check,
    /// Drawing the frames of a film.
    Draw,
    /// Writing files.
    Write,
}

/// Receives progress.
pub trait Watch {
    /// Called when a stage begins (`done == 0`) and at intervals within it; `total` is an estimate, 0 if unknown.
    fn tell(&mut self, stage: Stage, done: u64, total: u64);

    /// The handle by which the work can be cancelled; by default, it cannot.
    fn cancel(&self) -> Cancel {
        Cancel::default()
    }
}

/// Ignores progress.
pub struct Nobody;

impl Watch for Nobody {
    fn tell(&mut self, _: Stage, _: u64, _: u64) {}
}

/// Cancels work from any thread. Clones share one flag. As a watch it ignores progress.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Option<Arc<AtomicBool>>);

impl Watch for Cancel {
    fn tell(&mut self, _: Stage, _: u64, _: u64) {}

    fn cancel(&self) -> Cancel {
        self.clone()
    }
}

impl Cancel {
    /// A handle that can be cancelled.
    pub fn new() -> Cancel {
        Cancel(Some(Arc::default()))
    }

    /// Requests cancellation.
    pub fn ask(&self) {
        if let Some(asked) = &self.0 {
            asked.store(true, Ordering::Relaxed);
        }
    }

    /// Whether cancellation was requested. A loop that ends by it gives no valid result: see [`Cancel::check`].
    pub fn is_asked(&self) -> bool {
        self.0.as_ref().is_some_and(|asked| asked.load(Ordering::Relaxed))
    }

    /// Returns an error if cancellation was requested.
    ///
    /// # Errors
    /// [`Fault::stopped`].
    pub fn check(&self) -> Result<(), Fault> {
        if self.is_asked() { Err(Fault::stopped()) } else { Ok(()) }
    }
}

/// Progress and cancellation while a file is read.
pub trait Pace {
    /// Reports the bytes read; returns whether to go on.
    fn goes_on(&self, done: usize, total: usize) -> bool;

    /// The handle by which reading is cancelled.
    fn cancel(&self) -> &Cancel;
}

/// Reports the reading of files to a [`Watch`].
pub struct Reading<'w> {
    watch: RefCell<&'w mut dyn Watch>,
    cancel: Cancel,
}

impl<'w> Reading<'w> {
    /// Starts reading.
    pub fn watched(watch: &'w mut dyn Watch) -> Reading<'w> {
        Reading { cancel: watch.cancel(), watch: RefCell::new(watch) }
    }
}

impl Pace for Reading<'_> {
    fn goes_on(&self, done: usize, total: usize) -> bool {
        self.watch.borrow_mut().tell(Stage::Read, done as u64, total as u64);
        !self.cancel.is_asked()
    }

    fn cancel(&self) -> &Cancel {
        &self.cancel
    }
}
