//! Gmsh's MSH format, versions 2.2 and 4.1.
//!
//! Reads text and binary of either byte order; writes text. Deliberately absent: partitions, periodicity, elements of
//! higher order (rejected), volume elements (counted in [`MeshFile::skipped`]).
//!
//! [`MeshFile::skipped`]: crate::core::soup::MeshFile::skipped

mod input;
mod read;
mod data;
mod write;

pub use read::read;
pub use write::{Version, write};

/// The name of the node data that holds a metric: nine components for each node, row by row.
const METRIC: &str = "metric";

/// How an element type of Gmsh is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Point,
    Line,
    Triangle,
    Quad,
    /// A line or surface element with nodes other than its corners.
    HigherOrder,
    /// A volume element: name and number of nodes.
    Volume(&'static str, usize),
}

/// Gmsh's table of element types.
fn shape(kind: i64) -> Option<Shape> {
    Some(match kind {
        1 => Shape::Line,
        2 => Shape::Triangle,
        3 => Shape::Quad,
        15 => Shape::Point,
        8 | 9 | 10 | 16 | 20..=28 | 36..=62 => Shape::HigherOrder,
        4 => Shape::Volume("tetrahedron", 4),
        11 => Shape::Volume("tetrahedron", 10),
        29 => Shape::Volume("tetrahedron", 20),
        30 => Shape::Volume("tetrahedron", 35),
        31 => Shape::Volume("tetrahedron", 56),
        5 => Shape::Volume("hexahedron", 8),
        12 => Shape::Volume("hexahedron", 27),
        17 => Shape::Volume("hexahedron", 20),
        92 => Shape::Volume("hexahedron", 64),
        93 => Shape::Volume("hexahedron", 125),
        6 => Shape::Volume("prism", 6),
        13 => Shape::Volume("prism", 18),
        18 => Shape::Volume("prism", 15),
        90 => Shape::Volume("prism", 40),
        91 => Shape::Volume("prism", 75),
        7 => Shape::Volume("pyramid", 5),
        14 => Shape::Volume("pyramid", 14),
        19 => Shape::Volume("pyramid", 13),
        118 => Shape::Volume("pyramid", 30),
        119 => Shape::Volume("pyramid", 55),
        _ => return None,
    })
}
