//! What a case says of curves, surfaces and faces, as plain data; other modules build geometry of it.

use glam::{DVec2, DVec3};

use super::frame::Frame;

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

/// The shape of a curve as a case with surfaces gives it; angles in degrees.
#[derive(Clone, Debug, PartialEq)]
pub enum SpaceShape {
    /// A straight line.
    Segment {
        /// Start.
        from: DVec3,
        /// End.
        to: DVec3,
    },
    /// A circular arc about an axis; a full turn makes a closed curve.
    Arc {
        /// Centre, axis, and where the angle is 0.
        frame: Frame,
        /// Radius, positive.
        radius: f64,
        /// Angles of start and end.
        angles: [f64; 2],
    },
    /// Straight lines through points, whose corners are kept as nodes.
    Polyline {
        /// Corners.
        points: Vec<DVec3>,
        /// Whether the last corner is joined to the first.
        closed: bool,
    },
    /// A rational B-spline.
    Nurbs {
        /// Degree.
        degree: usize,
        /// Knots.
        knots: Vec<f64>,
        /// Positive weights, one a point; empty means all 1.
        weights: Vec<f64>,
        /// Control points.
        points: Vec<DVec3>,
    },
    /// A curve in the parametric plane of a surface.
    On {
        /// Name of the surface.
        surface: String,
        /// Its course in u and v.
        shape: CurveShape,
    },
}

/// A surface as a case gives it.
#[derive(Clone, Debug, PartialEq)]
pub enum SurfaceShape {
    /// See [`plane`](super::primitive::plane).
    Plane {
        /// A corner.
        corner: DVec3,
        /// Two sides from it.
        sides: [DVec3; 2],
    },
    /// See [`cone`](super::primitive::cone); a cylinder where both radii are equal.
    Cone {
        /// Foot, axis and where the angle is 0.
        frame: Frame,
        /// Radius at the foot and at the top.
        radii: [f64; 2],
        /// Height.
        height: f64,
        /// First and last angle, degrees.
        angles: [f64; 2],
    },
    /// See [`sphere`](super::primitive::sphere).
    Sphere {
        /// Centre, axis and where the angle is 0.
        frame: Frame,
        /// Radius.
        radius: f64,
        /// First and last longitude, degrees.
        angles: [f64; 2],
        /// First and last latitude, degrees.
        latitudes: [f64; 2],
    },
    /// See [`torus`](super::primitive::torus).
    Torus {
        /// Centre, axis and where the angle is 0.
        frame: Frame,
        /// Radius of the circle in the middle of the tube.
        radius: f64,
        /// Radius of the tube.
        tube: f64,
        /// First and last angle, degrees.
        angles: [f64; 2],
        /// First and last angle about the tube, degrees.
        tube_angles: [f64; 2],
    },
    /// See [`extrusion`](super::primitive::extrusion).
    Extrusion {
        /// The name of a curve.
        curve: String,
        /// Direction and length.
        along: DVec3,
    },
    /// See [`revolution`](super::primitive::revolution).
    Revolution {
        /// The name of a curve.
        curve: String,
        /// The axis.
        frame: Frame,
        /// First and last angle, degrees.
        angles: [f64; 2],
    },
    /// Control points and knots; a Bezier patch where the knots are only at the ends.
    Nurbs {
        /// Degrees along u and v.
        degrees: [usize; 2],
        /// Knots along u and v.
        knots: [Vec<f64>; 2],
        /// One a point, or none.
        weights: Vec<f64>,
        /// Rows along v, one for each place along u.
        points: Vec<DVec3>,
        /// Points in a row.
        columns: usize,
    },
}

/// A surface of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceSpec {
    /// Its name.
    pub name: String,
    /// Its shape.
    pub shape: SurfaceShape,
    /// Where it stands, for messages.
    pub place: String,
}

/// A curve of a case with surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceCurveSpec {
    /// Its name.
    pub name: String,
    /// Its shape.
    pub shape: SpaceShape,
    /// Number of segments where the case fixes it.
    pub segments: Option<u32>,
    /// Where it stands, for messages.
    pub place: String,
}

/// A face of a case with surfaces; without an outer loop it is all of its surface, but for the holes.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceFaceSpec {
    /// Its surface.
    pub surface: String,
    /// Its name and its curves.
    pub face: FaceSpec,
}

/// What [`build`](super::complex::build) makes a domain of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ComplexSpec {
    /// All surfaces.
    pub surfaces: Vec<SurfaceSpec>,
    /// All curves.
    pub curves: Vec<SpaceCurveSpec>,
    /// All faces, at least one.
    pub faces: Vec<SurfaceFaceSpec>,
}
