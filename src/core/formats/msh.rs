//! Gmsh's MSH format, versions 2.2 and 4.1.
//!
//! Reads text and binary of either byte order; writes text. Of elements of order 2 the corners are read, and the other
//! nodes beside them. Deliberately absent: partitions, periodicity, elements of higher order (rejected), volume elements (counted in [`MeshFile::skipped`]).
//!
//! [`MeshFile::skipped`]: crate::core::soup::MeshFile::skipped

mod input;
mod read;
mod data;
mod groups;
mod write;

pub use read::read;
pub use write::{Version, write};

/// The name of the node data that holds a metric: nine components for each node, row by row.
const METRIC: &str = "metric";

/// How an element type of Gmsh is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Point,
    /// A line, and the number of its nodes that are no corners; likewise the next two.
    Line(usize),
    Triangle(usize),
    Quad(usize),
    /// A line or surface element of order 3 or more, or of order 2 with nodes at some places only.
    HigherOrder,
    /// A volume element: name and number of nodes.
    Volume(&'static str, usize),
}

/// Volume elements by name: the type and its number of nodes.
const VOLUMES: [(&str, [(i64, usize); 5]); 4] = [
    ("tetrahedron", [(4, 4), (11, 10), (29, 20), (30, 35), (31, 56)]),
    ("hexahedron", [(5, 8), (12, 27), (17, 20), (92, 64), (93, 125)]),
    ("prism", [(6, 6), (13, 18), (18, 15), (90, 40), (91, 75)]),
    ("pyramid", [(7, 5), (14, 14), (19, 13), (118, 30), (119, 55)]),
];

/// Gmsh's table of element types.
fn shape(kind: i64) -> Option<Shape> {
    Some(match kind {
        1 => Shape::Line(0),
        2 => Shape::Triangle(0),
        3 => Shape::Quad(0),
        8 => Shape::Line(1),
        9 => Shape::Triangle(3),
        10 => Shape::Quad(5),
        16 => Shape::Quad(4),
        15 => Shape::Point,
        20..=28 | 36..=62 => Shape::HigherOrder,
        _ => {
            let of_kind = |&(name, kinds): &(&'static str, [(i64, usize); 5])| {
                Some(Shape::Volume(name, kinds.iter().find(|(known, _)| *known == kind)?.1))
            };
            return VOLUMES.iter().find_map(of_kind);
        }
    })
}
