//! Walls as the front and the laying of rows see them (docs/algorithm.md, "Rows at walls"): a node of a wall with its
//! normal, the line of edges that leaves it, and how high its rows are to be.

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use smallvec::SmallVec;

use crate::core::mesh::{HalfEdgeId, Mesh, NodeId};
use crate::core::metric::{MetricSource, Rows};

/// A wall that turns by more than this at a node has a corner there: 20 degrees.
const CORNER: f64 = PI / 9.0;
/// Metric heights of a row within which the wall has the say. Below or above, another size field has it.
const HEIGHTS: std::ops::RangeInclusive<f64> = 0.4..=1.7;
/// Beyond the first row, stems end where a row is not this much longer than high: from there on a lean costs as much in
/// the metric as it does in the plane.
const LEAST_ASPECT: f64 = 1.5;
/// So many nodes from a corner stems fan out: while the front forms it follows the metric there.
const FANNED: usize = 2;

/// A node of a wall.
pub struct WallNode {
    pub node: NodeId,
    pub rows: Rows,
    /// The nodes before and after it on the boundary, which has the mesh to its left.
    pub beside: [NodeId; 2],
    /// Directions to them.
    pub to_beside: [DVec2; 2],
    /// The angle of the mesh there, in the plane; at the tip of a crack a full turn.
    pub theta: f64,
    /// Its edges off the boundary, anticlockwise.
    pub off: SmallVec<[HalfEdgeId; 4]>,
}

impl WallNode {
    /// A node of a wall; none where no rows are asked for.
    pub fn of(mesh: &Mesh, source: &dyn MetricSource, node: NodeId) -> Option<WallNode> {
        if !mesh.is_fixed(node) {
            return None;
        }
        let p = mesh.uv(node);
        let rows = source.rows_at(p)?;
        let mut fan = mesh.fan(node);
        let first = fan.next()?;
        let off: SmallVec<[HalfEdgeId; 4]> = fan.collect();
        let last = off.last().copied().unwrap_or(first);
        let beside = [mesh.apex(last), mesh.target(first)];
        let to_beside = beside.map(|n| mesh.uv(n) - p);
        let [before, after] = to_beside;
        let turn = libm::atan2(after.perp_dot(before), after.dot(before));
        let theta = if turn > 0.0 { turn } else { turn + TAU };
        Some(WallNode { node, rows, beside, to_beside, theta, off })
    }

    /// The normal of the wall, into the mesh: of the parabola through the node and those beside it. None at a corner.
    pub fn normal(&self) -> Option<DVec2> {
        let [before, after] = self.to_beside;
        let (l_before, l_after) = (before.length(), after.length());
        let tangent = after * (l_before / l_after) - before * (l_after / l_before);
        ((self.theta - PI).abs() <= CORNER).then(|| tangent.normalize().perp())
    }

    /// Whether one of so many nodes before or after it is a corner, or belongs to no wall.
    fn is_near_corner(&self, mesh: &Mesh, source: &dyn MetricSource, nodes: usize) -> bool {
        [0, 1].into_iter().any(|side| {
            let mut beside = self.beside[side];
            (0..nodes).any(|_| match WallNode::of(mesh, source, beside).filter(|wall| wall.normal().is_some()) {
                Some(wall) => {
                    beside = wall.beside[side];
                    false
                }
                None => true,
            })
        })
    }
}

/// Whether a row, counted from 0, is laid at a place that its wall asks for: no other field rules there, and beyond the
/// first row a lean is cheap.
pub fn is_asked(source: &dyn MetricSource, place: DVec2, normal: DVec2, height: f64, row: u32) -> bool {
    let Ok(metric) = source.metric(place) else { return false };
    let length = 1.0 / metric.norm2(normal.perp()).sqrt();
    HEIGHTS.contains(&metric.norm2(normal * height).sqrt()) && (row == 0 || length >= LEAST_ASPECT * height)
}

/// The edge that goes on from the end of another where two lines of edges cross; none elsewhere.
pub fn opposite(mesh: &Mesh, h: HalfEdgeId) -> Option<HalfEdgeId> {
    let node = mesh.target(h);
    let elements = mesh.elements_at(node).filter(|&e| mesh.is_quad(e)).count();
    let is_crossing = elements == 4 && mesh.valence(node) == 4;
    if is_crossing { Some(mesh.next(mesh.twin(mesh.next(h))?)) } else { None }
}

/// The next place on the stem that ends at a node of the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onward {
    pub place: DVec2,
    /// Its row, from 1 at the wall.
    pub row: u32,
}

/// The place that follows on the stem of a node of the front, at most so many rows from the wall; none where the node
/// is on no stem, or its wall asks for no further row.
pub fn onward(mesh: &Mesh, source: &dyn MetricSource, node: NodeId, most: u16) -> Option<Onward> {
    if !source.has_walls() {
        return None;
    }
    let mut foot = node;
    let mut row = 0;
    if !mesh.is_fixed(node) {
        let is_dead =
            |h: &HalfEdgeId| mesh.is_quad(h.element()) && mesh.twin(*h).is_some_and(|t| mesh.is_quad(t.element()));
        let mut down = mesh.fan(node).filter(is_dead);
        let mut h = down.next().filter(|_| down.next().is_none())?;
        row = 1;
        foot = mesh.target(h);
        while !mesh.is_fixed(foot) {
            h = opposite(mesh, h).filter(|_| row < u32::from(most))?;
            foot = mesh.target(h);
            row += 1;
        }
    }
    let wall = WallNode::of(mesh, source, foot)?;
    let normal = wall.normal().filter(|_| !wall.is_near_corner(mesh, source, FANNED))?;
    let (mut distance, mut height) = (0.0, 0.0);
    for h in wall.rows.heights().take(row as usize + 1) {
        height = h;
        distance += h;
    }
    let place = mesh.uv(foot) + normal * distance;
    is_asked(source, place, normal, height, row).then_some(Onward { place, row: row + 1 })
}
