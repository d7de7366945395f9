//! A mesh as stored in a file: a soup of points and polygons without connectivity. How the file numbers its elements,
//! triangulation of polygons, welding of equal points, and the validity check.

pub mod mesh_file;
mod counting;
pub(in crate::core) mod groups;
mod in_memory;
mod polygons;
pub(in crate::core) mod weld;
pub mod soundness;
mod repairs;
mod not_read;
pub(in crate::core) mod second_order;

pub use counting::{Count, Counting, Elements};
pub use groups::Ignored;
pub use mesh_file::{Data, Group, Members, MeshFile, Omitted, SecondOrder, Texture};
pub use not_read::NOT_READ;
pub(in crate::core) use not_read::{CELL_DATA, EMPTY_GROUP, POINT_DATA, times};
pub(in crate::core) use repairs::Repair;
pub use soundness::{Allow, Defect, Soundness};
pub(in crate::core) use weld::Welder;
