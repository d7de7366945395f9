//! triangulate: being written.
