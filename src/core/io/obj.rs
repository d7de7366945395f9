//! obj: being written.
