//! Pictures as vectors, and as pixels rendered from them: a `sheet`, a `histogram` or a `heat_map` is drawn on a
//! `page`, which is written as `svg`, `pdf` or `png`.

pub mod weights;
pub mod page;
pub mod sheet;
pub mod histogram;
pub mod heat_map;
pub mod svg;
#[cfg(feature = "cli")]
pub mod pdf;
#[cfg(feature = "window")]
pub mod png;
