//! Mesh files: one module for each format, read and written as a whole. Files are replaced atomically.

pub mod save;
pub(crate) mod scan;
pub(crate) mod numbering;
pub(crate) mod msh;
pub mod medit;
pub(crate) mod vtu;
pub(crate) mod obj;
pub(crate) mod stl;
pub(crate) mod ply;
pub(crate) mod gltf;
pub(crate) mod inp;
pub mod format;
