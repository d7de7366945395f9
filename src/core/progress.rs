//! How work tells how far it is. `core` has no clock: whoever watches measures time.

/// The parts of a conversion, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Reading the case or the mesh.
    Read,
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
}

/// Nobody watches.
pub struct Nobody;

impl Watch for Nobody {
    fn tell(&mut self, _: Stage, _: u64, _: u64) {}
}
