//! soundness: being written.
