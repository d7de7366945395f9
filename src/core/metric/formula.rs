//! formula: being written.
