//! A part of a curve, between two of its parameters.

use glam::DVec2;

use super::{Curve, Path};

impl Curve {
    /// The part of it between two parameters, with its ends at `ends`, which lie on the curve but for rounding. A `to`
    /// above 1 stands for a part that goes on through the start of a closed curve.
    pub(in crate::core::geometry) fn part(&self, from: f64, to: f64, ends: [DVec2; 2]) -> Curve {
        let path = match &self.path {
            Path::Segment { .. } => Path::Segment { from: ends[0], to: ends[1] },
            Path::Arc { centre, radius, from_angle, turn } => Path::Arc {
                centre: *centre,
                radius: *radius,
                from_angle: from_angle + from * turn,
                turn: (to - from) * turn,
            },
            Path::Polyline { points, corners } => {
                let n = points.len() - 1;
                let place = |k: usize| if k < n { k as f64 / n as f64 } else { 1.0 + (k - n) as f64 / n as f64 };
                let inner: Vec<usize> = (1..2 * n).filter(|&k| from < place(k) && place(k) < to).collect();
                // The start of a closed polyline stays a node.
                let is_corner = |k: usize| k.is_multiple_of(n) || corners.contains(&((k % n) as u32));
                let corners = (1..).zip(&inner).filter(|(_, k)| is_corner(**k)).map(|(i, _)| i).collect();
                let inner = inner.into_iter().map(|k| points[k % n]);
                Path::Polyline { points: [ends[0]].into_iter().chain(inner).chain([ends[1]]).collect(), corners }
            }
            Path::Nurbs(nurbs) => Path::Nurbs(nurbs.part(from, to)),
        };
        let mut part = Curve { path, closed: false, corners: Vec::new() };
        part.corners = part.find_corners();
        part
    }
}
