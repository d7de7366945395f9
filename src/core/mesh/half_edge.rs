//! half_edge: being written.
