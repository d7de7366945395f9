//! quality: being written.
