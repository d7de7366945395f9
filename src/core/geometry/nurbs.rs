//! nurbs: being written.
