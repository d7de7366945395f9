//! Pictures as vectors, and as pixels drawn from those.

pub mod svg;
pub mod histogram;
#[cfg(feature = "window")]
pub mod png;
