//! Mesh files: one module for each format, read and written as a whole. Files are replaced atomically.

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
