//! adapt: being written.
