//! last_resort: being written.
