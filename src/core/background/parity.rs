//! parity: being written.
