//! Triangles as plain arrays, cut along all fixed lines: the input of the half-edge mesh.

use glam::{DVec2, DVec3};

use super::ids::PointId;

/// Triangles in the parametric plane, all strictly positive. Node ids are doubled along boundaries between faces,
/// cracks and repeated lines, and at pinched nodes: two triangles are neighbours if and only if they share both node
/// ids of a side, and each node has one fan of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleSet {
    /// Coordinates of each node.
    pub uv: Vec<DVec2>,
    /// The output point of each node, dense from 0: the copies of a node on the two sides of a shared curve or a
    /// repeated line have the same point, those on the two sides of a crack different ones.
    pub point: Vec<PointId>,
    /// Nodes of each triangle, anticlockwise.
    pub triangles: Vec<[u32; 3]>,
    /// The face (region) of each triangle.
    pub region: Vec<u32>,
    /// Nodes at hard points, which are kept where they are, each with the number of its point.
    pub hard: Vec<(u32, u32)>,
    /// On surfaces: the coordinates of each point in space. Empty in the plane.
    pub xyz: Vec<DVec3>,
    /// Sides along numbered lines (curves of a domain, groups of lines of a file): the end points and the number of the
    /// line.
    pub lines: Vec<([PointId; 2], u32)>,
}
