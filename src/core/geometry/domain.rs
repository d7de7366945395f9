//! Planar domains: outer loops and holes made of named curves, crack lines, repeated lines, several faces sharing curves.

use glam::DVec2;

/// The shape of a curve as a case gives it; angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveShape {
    /// A straight line.
    Segment {
        /// Start.
        from: DVec2,
        /// End.
        to: DVec2,
    },
    /// A circular arc, anticlockwise where `to_angle > from_angle`; a full turn makes a closed curve.
    Arc {
        /// Centre.
        centre: DVec2,
        /// Radius, positive.
        radius: f64,
        /// Angle of the start.
        from_angle: f64,
        /// Angle of the end.
        to_angle: f64,
    },
    /// Straight lines through points, whose corners are kept as nodes.
    Polyline {
        /// Corners.
        points: Vec<DVec2>,
        /// Whether the last corner is joined to the first.
        closed: bool,
    },
    /// A rational B-spline.
    Nurbs {
        /// Degree.
        degree: usize,
        /// Knots, `points.len() + degree + 1` of them, not decreasing.
        knots: Vec<f64>,
        /// Positive weights, one a point; empty means all 1.
        weights: Vec<f64>,
        /// Control points.
        points: Vec<DVec2>,
    },
}

/// A named curve of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveSpec {
    /// Its name, unique in the case.
    pub name: String,
    /// Its shape.
    pub shape: CurveShape,
    /// Number of segments where the case fixes it (for each straight piece of a polyline taken together).
    pub segments: Option<u32>,
    /// Where it stands, for messages ("plate.toml, line 14").
    pub place: String,
}

/// A face of a case: names of curves. Order and direction within a loop are found, not demanded.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceSpec {
    /// Its name, unique in the case.
    pub name: String,
    /// Curves of the outer loop.
    pub outer: Vec<String>,
    /// Curves of each hole.
    pub holes: Vec<Vec<String>>,
    /// Crack lines: the two sides are apart in the mesh, but for the tips inside the face.
    pub cracks: Vec<String>,
    /// Repeated lines: internal lines meshed on both sides with the same nodes.
    pub repeated: Vec<String>,
    /// Where it stands, for messages.
    pub place: String,
}
