//! A mesh as stored in a file: a soup of points and polygons without connectivity. How the file numbers its elements,
//! triangulation of polygons, welding of equal points, and the validity check.

pub mod mesh_file;
pub mod counting;
mod in_memory;
pub mod polygons;
pub(in crate::core) mod weld;
pub mod soundness;
pub(in crate::core) mod repairs;
