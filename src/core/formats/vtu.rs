//! VTK's XML format for unstructured grids (`.vtu`), as inline text.
//!
//! Writes triangles, quadrilaterals and the lines of named groups, including the merging front of an intermediate
//! state. Tags are the cell data "tag". A line has the cell data of an adjacent element (at the front, the live
//! triangle), so that it does not extend the range of values in ParaView. The metric at points is a symmetric tensor in
//! ParaView's order XX, YY, ZZ, XY, YZ, XZ; "uv" is the position of a point in the parametric plane. A group name is a
//! field data array of that name with its pairs of tag and dimension (meshio's convention for Gmsh groups).
//! Deliberately absent: compressed, appended and binary arrays (rejected).

mod read;
mod write;

pub use read::read;
pub use write::write;

/// The name of the point data that holds a metric.
const METRIC: &str = "metric";
/// The name of the point data that holds positions in the parametric plane.
const UV: &str = "uv";
/// The name of the cell data that holds the tags.
const TAG: &str = "tag";
