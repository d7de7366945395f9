//! Gmsh's MSH format, versions 2.2 and 4.1.
//!
//! Reads text and binary of either byte order; writes text. Of elements of higher order the corners are read.
//! Deliberately absent: partitions, periodicity, volume elements (counted in [`MeshFile::skipped`]).
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
    Line,
    Triangle,
    Quad,
    /// A line or surface element of higher order: the element of its corners, which come first, and its further nodes.
    HigherOrder(i64, usize),
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

/// Elements of higher order: the type, that of the element of their corners, and the number of their further nodes.
const HIGHER: [(i64, i64, usize); 19] = [
    (8, 1, 1),
    (26, 1, 2),
    (27, 1, 3),
    (28, 1, 4),
    (9, 2, 3),
    (20, 2, 6),
    (21, 2, 7),
    (22, 2, 9),
    (23, 2, 12),
    (24, 2, 12),
    (25, 2, 18),
    (16, 3, 4),
    (10, 3, 5),
    (36, 3, 12),
    (37, 3, 21),
    (38, 3, 32),
    (39, 3, 8),
    (40, 3, 12),
    (41, 3, 16),
];

/// Gmsh's table of element types.
fn shape(kind: i64) -> Option<Shape> {
    Some(match kind {
        1 => Shape::Line,
        2 => Shape::Triangle,
        3 => Shape::Quad,
        15 => Shape::Point,
        _ => {
            if let Some(&(_, corners, others)) = HIGHER.iter().find(|higher| higher.0 == kind) {
                return Some(Shape::HigherOrder(corners, others));
            }
            let of_kind = |&(name, kinds): &(&'static str, [(i64, usize); 5])| {
                Some(Shape::Volume(name, kinds.iter().find(|(known, _)| *known == kind)?.1))
            };
            return VOLUMES.iter().find_map(of_kind);
        }
    })
}
