//! scan: being written.
