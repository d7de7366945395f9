//! quadfront: anisotropic quadrilateral meshes after Lee & Lee (2002).
//!
//! `core` is the converter and everything it stands on; it knows no screen. `render` makes pictures of its states.
//! `app` is the command line (and the window). Arrows run `app -> render -> core` and never back.
#![cfg_attr(test, allow(clippy::unwrap_used))]

pub mod core;
pub mod render;
#[cfg(feature = "cli")]
pub mod app;
