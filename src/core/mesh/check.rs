//! check: being written.
