//! Pictures as vectors, and as pixels rendered from them: a `sheet`, a `histogram`, a `heat_map`, a `timeline` or a
//! `decision` is drawn on a `page`, which is written as `svg`, `pdf` or `png`.

pub mod weights;
pub mod page;
pub mod sheet;
pub mod histogram;
pub mod heat_map;
pub mod timeline;
pub mod decision;
pub mod svg;
#[cfg(all(feature = "cli", not(target_arch = "wasm32")))]
pub mod pdf;
#[cfg(feature = "window")]
pub mod png;
