//! A mesh as a file has it, a soup of points and polygons without connectivity: how it counts its elements, its polygons cut
//! into triangles, equal points welded, and whether it is sound.

pub mod mesh_file;
pub mod counting;
mod in_memory;
pub mod polygons;
pub(in crate::core) mod weld;
pub mod soundness;
