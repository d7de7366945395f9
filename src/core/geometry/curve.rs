//! curve: being written.
