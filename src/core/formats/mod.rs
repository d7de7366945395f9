//! Mesh files: one module a format, read and written whole. Every file is written beside its place and renamed.

pub mod save;
pub mod scan;
pub mod numbering;
pub mod msh;
pub mod medit;
pub mod vtu;
pub mod obj;
pub mod stl;
pub mod ply;
pub mod gltf;
pub mod inp;
pub mod format;
