//! save: being written.
