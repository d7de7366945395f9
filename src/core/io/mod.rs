//! Files: cases, meshes, reports. Every file is written beside its place and renamed.

pub mod mesh_file;
pub mod counting;
pub mod save;
pub mod fingerprint;
pub mod scan;
pub mod numbering;
pub mod msh;
pub mod medit;
pub mod vtu;
pub mod obj;
pub(in crate::core) mod weld;
mod polygons;
pub mod stl;
pub mod ply;
pub mod gltf;
pub mod inp;
pub mod format;
mod table;
pub mod case;
pub mod built_in;
pub mod statistics;
pub mod export;
pub mod report;
pub mod run_file;
pub mod figure;
