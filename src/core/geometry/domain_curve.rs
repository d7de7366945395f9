//! A curve in its place in a domain: its course, its vertices, the faces on its sides.

use glam::DVec2;

use super::course::Course;

/// A curve of a [`Domain`](super::domain::Domain); dense from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CurveId(pub u32);

impl CurveId {
    /// The place of this id in the arrays.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A curve run from its start to its end, or back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DirectedCurve {
    /// The curve.
    pub curve: CurveId,
    /// Whether from start to end.
    pub forward: bool,
}

/// What a curve is to its faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveKind {
    /// A side of outer loops or holes.
    Boundary,
    /// A crack line.
    Crack,
    /// A repeated line.
    Repeated,
}

/// A curve in its place in the domain.
#[derive(Clone, Debug)]
pub struct DomainCurve {
    /// Its name.
    pub name: String,
    /// Its course; at 0 and 1 the vertices hold, which may differ from it by the tolerance.
    pub curve: Course,
    /// Number of segments where the case fixes it.
    pub segments: Option<u32>,
    /// Where the case has it, for messages.
    pub place: String,
    /// Vertices at its start and end.
    pub ends: [u32; 2],
    /// Faces on its left and right.
    pub sides: [Option<u32>; 2],
    /// What it is.
    pub kind: CurveKind,
    /// Points of a fine polyline with their parameters, from vertex to vertex.
    pub fine: Vec<(f64, DVec2)>,
    /// The first image of the same curve in space: that one rules how all are divided. In the plane the curve itself.
    pub first: CurveId,
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

    /// The direction in which it leaves its start (or, `backwards`, its end): towards where it first is `radius` away.
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
