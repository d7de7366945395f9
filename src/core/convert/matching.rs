//! matching: being written.
