//! Explanations: a segment of the front, a node, an edge or an element with its numbers in the paper's formulas; why a
//! segment was or was not chosen; what a step did, by which rule, and what comes next. Each is computed on request and
//! has a text form.
//!
//! Sentences have a little markup, `_{x}` for a subscript; [`plain`] takes it out.

mod numbers;
mod segment;
mod words;
mod selecting;
mod why;
mod side;
mod narrow;
mod event;
mod formation;
mod about;
mod next;
mod narration;
mod tables;

pub use about::{about, angles_of_swap};
pub use event::{attempt, event, why_rolled_back};
pub use narration::{Narrator, beginning, narration};
pub use next::next;
pub use numbers::{angles_apart, apart, capital, edge, plain, segment};
pub use segment::{SegmentFacts, Verdict};
pub use selecting::{SelectedBase, Selecting};
pub use side::{corner, passed, second, side_margins, side_rule};
pub use tables::{Entry, FRONT, Table, candidates, front, front_row};
pub use why::{key_name, key_text, margins};

use glam::DVec3;
use serde::Serialize;

use crate::core::case::Parameters;
use crate::core::front::Side;
use crate::core::mesh::{ElementId, HalfEdgeId, Mesh, NodeId};
use crate::core::metric::measure::{angle, scaled_jacobian};

/// A metric with its eigenpairs: sizes h = 1 / sqrt(lambda). On surfaces they are the sizes in space, as in eq. (6).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MetricFacts {
    /// The tensor (eq. 3): uu, uv, vv.
    pub tensor: [f64; 3],
    /// Eigenvalues.
    pub lambda: [f64; 2],
    /// The sizes h in space, in units of the case.
    pub sizes: [f64; 2],
    /// The corresponding directions in the parameters, of unit length in space: the axes of the ellipse of unit length.
    pub directions: [[f64; 2]; 2],
}

impl MetricFacts {
    /// Computes the eigenpairs of the metric of a node.
    pub fn of(mesh: &Mesh, node: NodeId) -> MetricFacts {
        let metric = mesh.metric_ref(node);
        let (lambda, directions) = match mesh.embedding() {
            None => metric.eigen(),
            Some(embedding) => metric.eigen_against(&embedding.atlas.at(mesh.uv(node)).first_form()),
        };
        MetricFacts {
            tensor: [metric.uu, metric.uv, metric.vv],
            lambda,
            sizes: lambda.map(|lambda| 1.0 / lambda.sqrt()),
            directions: directions.map(|d| [d.x, d.y]),
        }
    }
}

/// The class of a frontal angle (fig. 12).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Corner {
    /// At most theta_seam: a seam closes it (4.3.6).
    Seam,
    /// Below theta_rect: the neighbouring segment is the side edge (4.3.4, side edges ii).
    Rectangle,
    /// Up to theta_revr: a side edge must be found.
    Flat,
    /// Beyond theta_revr: a reversal.
    Reversal,
}

impl Corner {
    /// The class of a frontal angle.
    pub fn of(theta: f64, parameters: &Parameters) -> Corner {
        if theta <= parameters.theta_seam {
            Corner::Seam
        } else if theta < parameters.theta_rect {
            Corner::Rectangle
        } else if theta <= parameters.theta_revr {
            Corner::Flat
        } else {
            Corner::Reversal
        }
    }
}

/// A node, explained.
#[derive(Clone, Debug, Serialize)]
pub struct NodeFacts {
    /// Its id.
    pub node: NodeId,
    /// Parametric coordinates.
    pub uv: [f64; 2],
    /// Coordinates in space.
    pub xyz: [f64; 3],
    /// Its metric.
    pub metric: MetricFacts,
    /// Whether it is fixed, as all nodes on the boundary are.
    pub is_fixed: bool,
    /// Whether it is a hard point, fixed inside.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_hard: bool,
    /// Live triangles around it, anticlockwise.
    pub live: Vec<ElementId>,
    /// Dead quadrilaterals around it, anticlockwise.
    pub dead: Vec<ElementId>,
    /// Number of edges.
    pub valence: usize,
    /// Frontal angles in degrees, one for each live sector, with the segment that leaves there.
    pub sectors: Vec<(HalfEdgeId, f64)>,
}

impl NodeFacts {
    /// Explains a node; `None` where it does not exist.
    pub fn of(mesh: &Mesh, node: NodeId) -> Option<NodeFacts> {
        if !mesh.has_node(node) {
            return None;
        }
        let uv = mesh.uv(node);
        let (live, dead) = mesh.elements_at(node).partition(|&e| mesh.is_triangle(e));
        let leaving = mesh.fan(node).filter(|&h| mesh.is_front(h));
        Some(NodeFacts {
            node,
            uv: [uv.x, uv.y],
            xyz: mesh.xyz(node).to_array(),
            metric: MetricFacts::of(mesh, node),
            is_fixed: mesh.is_fixed(node),
            is_hard: mesh.is_hard(node),
            live,
            dead,
            valence: mesh.valence(node),
            sectors: leaving.map(|h| (h, mesh.frontal_angle(h, Side::Left).to_degrees())).collect(),
        })
    }
}

/// The kind of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EdgeKind {
    /// Between two live triangles: it can change.
    Live,
    /// On the merging front, with live triangles on one side.
    Front,
    /// Between two dead quadrilaterals.
    Dead,
    /// On the boundary, with a dead quadrilateral beside it.
    Boundary,
}

/// An edge, explained.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EdgeFacts {
    /// Its ends.
    pub ends: [NodeId; 2],
    /// Its kind.
    pub kind: EdgeKind,
    /// Whether it lies on the boundary.
    pub is_boundary: bool,
    /// Length in the metric.
    pub length_metric: f64,
    /// Length in space.
    pub length_physical: f64,
}

impl EdgeFacts {
    /// Explains the edge between two nodes; `None` where no edge connects them.
    pub fn of(mesh: &Mesh, a: NodeId, b: NodeId) -> Option<EdgeFacts> {
        if !mesh.has_node(a) || !mesh.has_node(b) {
            return None;
        }
        let h = mesh.half_edge_between(a, b).or_else(|| mesh.half_edge_between(b, a))?;
        let beside = [Some(h), mesh.twin(h)].map(|h| h.map(|h| mesh.is_triangle(h.element())));
        let kind = match beside {
            [Some(true), Some(true)] => EdgeKind::Live,
            [Some(false), Some(false)] => EdgeKind::Dead,
            [Some(false), None] | [None, _] => EdgeKind::Boundary,
            _ => EdgeKind::Front,
        };
        Some(EdgeFacts {
            ends: [a, b],
            kind,
            is_boundary: mesh.twin(h).is_none(),
            length_metric: mesh.distance(a, b),
            length_physical: mesh.physical_distance(a, b),
        })
    }
}

/// An element, explained.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ElementFacts {
    /// Its id.
    pub element: ElementId,
    /// True for a live triangle, false for a dead quadrilateral.
    pub is_live: bool,
    /// Its nodes, anticlockwise.
    pub nodes: Vec<NodeId>,
    /// Quality, 0 to 1 (docs/algorithm.md, "Quality").
    pub quality: f64,
    /// Angles at its nodes in their metrics, in degrees.
    pub angles_metric: Vec<f64>,
    /// Angles at its nodes in space, between straight sides, in degrees.
    pub angles_physical: Vec<f64>,
    /// Lengths of its sides in the metric, from its first node on.
    pub lengths_metric: Vec<f64>,
    /// Lengths of its sides in space.
    pub lengths_physical: Vec<f64>,
    /// Scaled Jacobian of a quadrilateral in the metric, and in space in the tangent plane of each corner.
    pub jacobians: Option<[f64; 2]>,
    /// Area in space, between straight sides.
    pub area: f64,
    /// Area in the metric.
    pub area_metric: f64,
    /// Rows from the boundary.
    pub level: u16,
    /// Its region.
    pub region: u32,
}

impl ElementFacts {
    /// Explains an element; `None` where it does not exist.
    pub fn of(mesh: &Mesh, element: ElementId) -> Option<ElementFacts> {
        if !mesh.has_element(element) {
            return None;
        }
        let nodes: Vec<NodeId> = mesh.corners(element).collect();
        let count = nodes.len();
        let around = |k: usize| [nodes[k], nodes[(k + 1) % count], nodes[(k + count - 1) % count]];
        let in_metric = |k: usize| {
            let [p, next, last] = around(k).map(|n| mesh.uv(n));
            angle(mesh.metric_ref(nodes[k]), next - p, last - p).to_degrees()
        };
        let sides = || (0..count).map(|k| (nodes[k], nodes[(k + 1) % count]));
        let jacobians = mesh.is_quad(element).then(|| {
            let n = mesh.quad(element);
            let in_space = n.map(|n| mesh.first_form(n));
            [n.map(|n| mesh.metric(n)), in_space].map(|metrics| scaled_jacobian(&metrics, n.map(|n| mesh.uv(n))))
        });
        let (p, q) = (mesh.uv(nodes[0]), mesh.xyz(nodes[0]));
        let pairs = || nodes.windows(2).skip(1);
        let area_uv = 0.5 * pairs().map(|n| (mesh.uv(n[0]) - p).perp_dot(mesh.uv(n[1]) - p)).sum::<f64>();
        let area = 0.5 * pairs().map(|n| (mesh.xyz(n[0]) - q).cross(mesh.xyz(n[1]) - q)).sum::<DVec3>().length();
        let root = nodes.iter().map(|&n| mesh.metric_ref(n).det().sqrt()).sum::<f64>() / count as f64;
        Some(ElementFacts {
            element,
            is_live: mesh.is_triangle(element),
            quality: mesh.quality(element),
            angles_metric: (0..count).map(in_metric).collect(),
            angles_physical: mesh.angles_in_space(element).into_iter().map(f64::to_degrees).collect(),
            lengths_metric: sides().map(|(a, b)| mesh.distance(a, b)).collect(),
            lengths_physical: sides().map(|(a, b)| mesh.physical_distance(a, b)).collect(),
            jacobians,
            area,
            area_metric: root * area_uv,
            level: mesh.level(element),
            region: mesh.region(element),
            nodes,
        })
    }
}
