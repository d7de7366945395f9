//! discretise: being written.
