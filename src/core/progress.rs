//! How work tells how far it is, and hears that it is to end. `core` has no clock: whoever watches measures time.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::fault::Fault;

/// The parts of a conversion, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Stage {
    /// Reading the case or the mesh; counted in bytes.
    Read,
    /// Mending a mesh that was given.
    Mend,
    /// Cutting a surface into charts and laying them flat; counted in triangles.
    Chart,
    /// Dividing curves and making loops even.
    Divide,
    /// Constrained Delaunay triangulation.
    Triangulate,
    /// Adapting the background mesh to the metric.
    Adapt,
    /// Triangles into quadrilaterals.
    Convert,
    /// Clean-up and smoothing.
    Finish,
    /// Checking and measuring.
    Check,
    /// Writing files.
    Write,
}

/// Whoever wants to know how far the work is.
pub trait Watch {
    /// Told when a stage begins (`done == 0`) and now and then within it; `total` is a guess, 0 where there is none.
    fn tell(&mut self, stage: Stage, done: u64, total: u64);

    /// By what the work is told to end before it is done; by nothing where nobody can want that.
    fn cancel(&self) -> Cancel {
        Cancel::default()
    }
}

/// Nobody watches.
pub struct Nobody;

impl Watch for Nobody {
    fn tell(&mut self, _: Stage, _: u64, _: u64) {}
}

/// Tells work, from any thread, that its result is not wanted any more. All copies are one.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Option<Arc<AtomicBool>>);

impl Cancel {
    /// One that can be asked for.
    pub fn new() -> Cancel {
        Cancel(Some(Arc::default()))
    }

    /// Asks for it.
    pub fn ask(&self) {
        if let Some(asked) = &self.0 {
            asked.store(true, Ordering::Relaxed);
        }
    }

    /// Whether it has been asked for. What comes out of a loop that ended by it is of no use: see [`Cancel::check`].
    pub fn is_asked(&self) -> bool {
        self.0.as_ref().is_some_and(|asked| asked.load(Ordering::Relaxed))
    }

    /// Ends the work where it has been asked for.
    ///
    /// # Errors
    /// [`Fault::stopped`].
    pub fn check(&self) -> Result<(), Fault> {
        if self.is_asked() { Err(Fault::stopped()) } else { Ok(()) }
    }
}

/// How a file is read: whoever reads it tells, and asks.
pub trait Pace {
    /// Tells how many of the file's bytes are read, and whether to go on.
    fn goes_on(&self, done: usize, total: usize) -> bool;

    /// By what reading is told to end.
    fn cancel(&self) -> &Cancel;
}

/// The reading of files while somebody watches.
pub struct Reading<'w> {
    watch: RefCell<&'w mut dyn Watch>,
    cancel: Cancel,
}

impl<'w> Reading<'w> {
    /// It begins.
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
