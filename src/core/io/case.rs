//! case: being written.
