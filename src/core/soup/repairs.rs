//! The kinds of repairs of a mesh and how reports word them, for meshes in the plane and in space.

/// A kind of repair, or of deviation from the file that is reported with the repairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repair {
    /// Quadrilaterals and polygons split into triangles.
    Triangulated,
    /// Points of no triangle, removed.
    UnusedPoint,
    /// Coincident points, merged.
    MergedPoint,
    /// Coincident points, kept as the two sides of a crack.
    CrackPoint,
    /// Points on the side of a triangle, which is split there.
    HangingPoint,
    /// Triangles with the nodes of another, removed.
    DuplicateTriangle,
    /// Triangles without area, removed.
    DegenerateTriangle,
    /// Clockwise triangles in the plane, reversed.
    ClockwiseTriangle,
    /// Triangles in space oriented against their neighbours, reversed.
    ReversedTriangle,
    /// Points at which closed parts touch, duplicated and set apart.
    ContactPoint,
    /// Nodes with several fans of triangles, split.
    PinchedNode,
    /// Lines of the file on no edge.
    LineOffEdges,
    /// Lines inside regions without a group.
    UngroupedLine,
    /// Boundary segments divided for an even number of triangles.
    DividedSegment,
    /// Sides of triangles between charts divided for even counts.
    DividedSide,
}

impl Repair {
    /// Appends a phrase such as "2 degenerate triangles were removed" to `repairs`; nothing for a count of 0.
    pub(in crate::core) fn report(self, count: usize, repairs: &mut Vec<String>) {
        let (one, many) = match self {
            Repair::Triangulated => (
                "quadrilateral or polygon was split into triangles",
                "quadrilaterals and polygons were split into triangles",
            ),
            Repair::UnusedPoint => ("unused point was removed", "unused points were removed"),
            Repair::MergedPoint => ("coincident point was merged", "coincident points were merged"),
            Repair::CrackPoint => (
                "coincident point was kept as the other side of a crack",
                "coincident points were kept as the other sides of cracks",
            ),
            Repair::HangingPoint => {
                ("hanging point was inserted into its edge", "hanging points were inserted into their edges")
            }
            Repair::DuplicateTriangle => ("duplicate triangle was removed", "duplicate triangles were removed"),
            Repair::DegenerateTriangle => ("degenerate triangle was removed", "degenerate triangles were removed"),
            Repair::ClockwiseTriangle => ("clockwise triangle was reversed", "clockwise triangles were reversed"),
            Repair::ReversedTriangle => {
                ("triangle was reversed to match its neighbours", "triangles were reversed to match their neighbours")
            }
            Repair::ContactPoint => {
                ("contact point between parts was split", "contact points between parts were split")
            }
            Repair::PinchedNode => (
                "node was split where triangles share only a point",
                "nodes were split where triangles share only a point",
            ),
            Repair::LineOffEdges => {
                ("line on no edge of the mesh was ignored", "lines on no edge of the mesh were ignored")
            }
            Repair::UngroupedLine => (
                "line inside a region without a group was ignored",
                "lines inside regions without a group were ignored",
            ),
            Repair::DividedSegment => (
                "boundary segment was divided to make a triangle count even",
                "boundary segments were divided to make triangle counts even",
            ),
            Repair::DividedSide => (
                "side of a triangle was divided to make counts even",
                "sides of triangles were divided to make counts even",
            ),
        };
        match count {
            0 => {}
            1 => repairs.push(format!("1 {one}")),
            n => repairs.push(format!("{n} {many}")),
        }
    }
}
