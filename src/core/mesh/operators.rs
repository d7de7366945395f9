//! operators: being written.
