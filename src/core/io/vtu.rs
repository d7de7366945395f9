//! vtu: being written.
