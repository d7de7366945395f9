//! medit: being written.
