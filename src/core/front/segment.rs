//! The quantities that order the front segments: H-value (eq. 6), metric and physical length, frontal angles, class of
//! table 1.

use std::cmp::Ordering;

use super::sector::Side;
use crate::core::case::{Parameters, Selection, SelectionWindow};
use crate::core::mesh::{HalfEdgeId, Mesh, NodeId};

/// A front segment AB with all quantities on which its selection depends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// The half-edge from A to B in its live triangle.
    pub h: HalfEdgeId,
    /// Node A.
    pub a: NodeId,
    /// Node B.
    pub b: NodeId,
    /// H-value (eq. 6): the mean of the smallest target sizes at both ends, in units of the case.
    pub h_value: f64,
    /// Length in the metric.
    pub length_metric: f64,
    /// Euclidean length: in the plane, or in space.
    pub length_physical: f64,
    /// Frontal angles at A and B, radians.
    pub theta: [f64; 2],
    /// Class of table 1: 1 if both angles are below theta_rect, 2 if only that at A is, 3 if only that at B is, 4
    /// otherwise.
    pub class: u8,
    /// Rows from the boundary.
    pub level: u16,
    /// On surfaces its face, since faces are converted one after another (paper 5.4); in the plane 0 for all.
    pub face: u32,
}

impl Segment {
    /// Measures a front segment.
    pub fn measure(mesh: &Mesh, h: HalfEdgeId, parameters: &Parameters) -> Segment {
        let [a, b] = mesh.ends(h);
        let theta = Side::BOTH.map(|side| mesh.frontal_angle(h, side));
        let class = match theta.map(|t| t < parameters.theta_rect) {
            [true, true] => 1,
            [true, false] => 2,
            [false, true] => 3,
            [false, false] => 4,
        };
        let [(size_a, at_a), (size_b, at_b)] = [a, b].map(|n| mesh.size_and_xyz(n));
        Segment {
            h,
            a,
            b,
            h_value: 0.5 * (size_a + size_b),
            length_metric: mesh.distance(a, b),
            length_physical: at_a.distance(at_b),
            theta,
            class,
            level: front_level(mesh, h),
            face: if mesh.embedding().is_some() { mesh.region(h.element()) } else { 0 },
        }
    }

    /// The quantity that must be below c Hmin for the segment to be within reach (4.3.3, steps ii and iii; the readings
    /// of docs/algorithm.md, "The selection window").
    pub fn window(&self, window: SelectionWindow) -> f64 {
        match window {
            SelectionWindow::HValue => self.h_value,
            SelectionWindow::PhysicalLength => self.length_physical,
            SelectionWindow::MetricLengthTimesH => self.length_metric * self.h_value,
        }
    }

    /// The primary sorting key: the current face, then the rows that are offset first (4.3.3, point 3); all levels
    /// beyond those are equal.
    pub fn layer(&self, parameters: &Parameters) -> u32 {
        layer(self.face, self.level, parameters)
    }

    /// Sum of the frontal angles.
    pub fn theta_sum(&self) -> f64 {
        self.theta[0] + self.theta[1]
    }

    /// The key of the segment in its heap: smaller keys come first.
    pub fn key(&self, parameters: &Parameters) -> Key {
        let first = match parameters.selection {
            Selection::Table1 => self.window(parameters.selection_window),
            Selection::Shortest => self.length_physical,
            Selection::SmallestAngle => self.theta_sum(),
            Selection::Level => {
                // Q-Morph: by state (from the number of ends that already have a side), then level, then length.
                let state = match self.class {
                    1 => 0.0,
                    2 | 3 => 1.0,
                    _ => 2.0,
                };
                return Key([state, f64::from(self.level), self.length_metric]);
            }
        };
        Key([first, self.theta_sum(), 0.0])
    }
}

/// The H-value of a segment between two nodes (eq. 6).
pub fn h_value(mesh: &Mesh, ends: [NodeId; 2]) -> f64 {
    0.5 * (mesh.smallest_size(ends[0]) + mesh.smallest_size(ends[1]))
}

/// See [`Segment::layer`].
pub fn layer(face: u32, level: u16, parameters: &Parameters) -> u32 {
    face.saturating_mul(parameters.layers + 1).saturating_add(u32::from(level).min(parameters.layers))
}

/// The level of a front segment: one more than the quadrilateral beyond; on the boundary 0, or the number of offset
/// rows if rows are offset from other loops only.
pub fn front_level(mesh: &Mesh, h: HalfEdgeId) -> u16 {
    match mesh.twin(h) {
        Some(t) => mesh.level(t.element()).saturating_add(1),
        None => mesh.first_level(mesh.origin(h)),
    }
}

/// A sorting key of front segments, compared lexicographically.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key(pub [f64; 3]);

impl Eq for Key {}

impl Ord for Key {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.iter().zip(&other.0).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
    }
}

impl PartialOrd for Key {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
