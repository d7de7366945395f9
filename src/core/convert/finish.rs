//! finish: being written.
