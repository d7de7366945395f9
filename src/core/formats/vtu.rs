//! VTK's XML format for unstructured grids (`.vtu`), as inline text.
//!
//! Triangles and quadrilaterals are written, and of the lines those that are in a group of their own, the merging front of a state
//! among them: what ParaView colours are the surface's cells. Tags are the cell data "tag". A line has the data of the element
//! beside it (of a state's front, of the live triangle), so that it lies in the range that they span. The metric at points is a
//! symmetric tensor in the order that ParaView has for them: XX, YY, ZZ, XY, YZ, XZ; "uv" is a point's place in the
//! parametric plane. Names of groups are field data: an array of that name with the pairs of tag and dimension that have it (as
//! meshio knows groups of Gmsh). Deliberately absent: compressed, appended and binary arrays (refused).

mod read;
mod write;

pub use read::read;
pub use write::write;

/// The name of the point data that holds a metric.
const METRIC: &str = "metric";
/// The name of the point data that holds places in the parametric plane.
const UV: &str = "uv";
/// The name of the cell data that holds the tags.
const TAG: &str = "tag";
