//! Progress and cancellation of long work, and what it will need. `core` has no clock and knows no machine: the watcher
//! measures time, and says whether there is memory enough.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::OnceLock;
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

    /// Called once it is known what the work will need, before the memory is spent; by default, all is allowed.
    ///
    /// # Errors
    /// There is less: the work ends with this fault.
    fn allow(&mut self, _: &Need) -> Result<(), Fault> {
        Ok(())
    }
}

/// What a conversion will need, as estimated before it begins (docs/algorithm.md, "Adaptation to the metric").
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Need {
    /// About how many quadrilaterals it will have.
    pub quads: f64,
    /// The size scale that gives so many; `None` where the triangles are given, and so does not change them.
    pub size_scale: Option<f64>,
}

/// Bytes of any conversion.
const BYTES: f64 = 24e6;
/// Bytes for each quadrilateral, at the time when a conversion has most: its triangles, the journal, and lists that
/// have just grown.
const BYTES_PER_QUAD: f64 = 1200.0;
/// Bytes for each quadrilateral where data for viewing are kept too.
const BYTES_PER_QUAD_WITH_DATA: f64 = 2200.0;

impl Need {
    /// The need of so many quadrilaterals, with the size scale that asks for them.
    pub fn of(quads: f64, size_scale: Option<f64>) -> Need {
        Need { quads, size_scale }
    }

    /// About how many bytes of memory the conversion takes; `with_data` for viewing (levels and births) it takes more.
    pub fn bytes(&self, with_data: bool) -> f64 {
        BYTES + self.quads * Need::per_quad(with_data)
    }

    /// The least size scale, of three digits, at which a conversion like this one fits into so many bytes; `None` where
    /// no scale helps. Quadrilaterals are as many as the scale is small, squared.
    pub fn size_scale_within(&self, bytes: f64, with_data: bool) -> Option<f64> {
        let quads = (bytes - BYTES) / Need::per_quad(with_data);
        let scale = self.size_scale? * (self.quads / quads).sqrt();
        if quads < 1.0 || !scale.is_finite() || scale <= 0.0 {
            return None;
        }
        let digit = libm::pow(10.0, libm::floor(libm::log10(scale)) - 2.0);
        // The nearest decimal number of three digits that is not below.
        let rounded = format!("{:.2e}", libm::ceil(scale / digit) * digit);
        rounded.parse().ok()
    }

    fn per_quad(with_data: bool) -> f64 {
        if with_data { BYTES_PER_QUAD_WITH_DATA } else { BYTES_PER_QUAD }
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
        if let Some(look) = ON_LOOK.get() {
            look();
        }
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

/// See [`on_look`].
static ON_LOOK: OnceLock<fn()> = OnceLock::new();

/// Has `look` called whenever any work looks whether it is to end: where there is one thread only, the work can give
/// way to others there. Only the first call counts.
pub fn on_look(look: fn()) {
    // A second one would be another way to do the same.
    let _ = ON_LOOK.set(look);
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
