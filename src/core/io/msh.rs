//! msh: being written.
