//! A curve of a domain: its course, its vertices, the faces on its sides.

use std::sync::Arc;

use glam::DVec2;

use super::course::Course;
use super::turning::Turning;

/// A curve of a [`Domain`](super::domain::Domain); dense from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CurveId(pub u32);

impl CurveId {
    /// The index of this curve in the arrays.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A curve traversed from its start to its end, or backwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DirectedCurve {
    /// The curve.
    pub curve: CurveId,
    /// Whether it is traversed from start to end.
    pub forward: bool,
}

/// The role of a curve in its faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveKind {
    /// Part of outer loops or holes.
    Boundary,
    /// A crack line.
    Crack,
    /// A repeated line.
    Repeated,
}

/// A curve of a domain.
#[derive(Clone, Debug)]
pub struct DomainCurve {
    /// Its name.
    pub name: String,
    /// Its course; its ends may differ from its vertices by the tolerance, and then the vertices count.
    pub curve: Course,
    /// The number of segments, if the case fixes it.
    pub segments: Option<u32>,
    /// Its place in the case, for messages.
    pub place: String,
    /// Vertices at its start and end.
    pub ends: [u32; 2],
    /// Faces on its left and right.
    pub sides: [Option<u32>; 2],
    /// Its role in its faces.
    pub kind: CurveKind,
    /// Points of a fine polyline with their parameters, from vertex to vertex.
    pub fine: Vec<(f64, DVec2)>,
    /// The first image of the same space curve, which determines the subdivision of all images; in planar domains the
    /// curve itself.
    pub first: CurveId,
    /// The limit of its chords, of the first image of a curve.
    pub turning: Option<Arc<Turning>>,
}

impl DomainCurve {
    /// The vertex at its start.
    pub fn first(&self) -> DVec2 {
        self.fine[0].1
    }

    /// The vertex at its end.
    pub fn last(&self) -> DVec2 {
        self.fine[self.fine.len() - 1].1
    }

    /// The direction in which it leaves its start (or, `backwards`, its end): towards the first point at distance
    /// `radius`.
    pub fn leaves(&self, backwards: bool, radius: f64) -> DVec2 {
        let n = self.fine.len() - 1;
        let (origin, next) = if backwards { (self.fine[n], self.fine[n - 1]) } else { (self.fine[0], self.fine[1]) };
        if self.curve.straight() || self.curve.polygonal() {
            return next.1 - origin.1;
        }
        let (mut near, mut far) = (origin.0, next.0);
        for _ in 0..60 {
            let t = 0.5 * (near + far);
            if self.curve.point(t).distance(origin.1) < radius { near = t } else { far = t }
        }
        self.curve.point(far) - origin.1
    }
}
