//! import: being written.
