//! Triangles as plain arrays, cut along everything that may not be changed: what the half-edge mesh is made from.

use glam::{DVec2, DVec3};

use super::ids::PointId;

/// Triangles in the parametric plane, all strictly positive, whose node ids are already doubled along boundaries shared
/// by two faces, cracks and repeated lines, and at pinched nodes: two triangles are neighbours exactly where they share
/// both node ids of a side, and each node has one fan of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleSet {
    /// Coordinates of each node.
    pub uv: Vec<DVec2>,
    /// The output point of each node: the same for the copies of a node on the two sides of a shared curve or a
    /// repeated line, different ones on the two sides of a crack. Dense from 0.
    pub point: Vec<PointId>,
    /// Nodes of each triangle, anticlockwise.
    pub triangles: Vec<[u32; 3]>,
    /// The face (region) of each triangle.
    pub region: Vec<u32>,
    /// On surfaces: the place in space of each point. Empty in the plane.
    pub xyz: Vec<DVec3>,
    /// Sides along numbered lines (curves of a domain, groups of lines of a file): the points at their ends, the number of the line.
    pub lines: Vec<([PointId; 2], u32)>,
}
