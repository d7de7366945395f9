//! Specifications of curves, surfaces and faces in a case, as plain data; other modules build the geometry.

use glam::{DVec2, DVec3};

use super::frame::AxisFrame;

/// The shape of a planar curve in a case; angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveShape {
    /// A straight line.
    Segment {
        /// Start.
        from: DVec2,
        /// End.
        to: DVec2,
    },
    /// A circular arc, anticlockwise if `to_angle > from_angle`; a full turn makes a closed curve.
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
    /// Straight lines through points; the corners become nodes.
    Polyline {
        /// Points.
        points: Vec<DVec2>,
        /// Whether the last point is joined to the first.
        closed: bool,
        /// The angle by which it turns at a corner at least, radians; other points need not become nodes.
        corner_angle: f64,
    },
    /// A rational B-spline.
    Nurbs {
        /// Degree.
        degree: usize,
        /// `points.len() + degree + 1` knots in ascending order.
        knots: Vec<f64>,
        /// Positive weights, one for each point; empty: all are 1.
        weights: Vec<f64>,
        /// Control points.
        points: Vec<DVec2>,
    },
}

impl CurveShape {
    /// Leaves out the points of a polyline that are no farther than `tolerance` from the one before; the last point
    /// stays. Returns their number.
    pub(super) fn merge_points(&mut self, tolerance: f64) -> usize {
        let CurveShape::Polyline { points, closed, .. } = self else { return 0 };
        let before = points.len();
        let mut kept: Vec<DVec2> = Vec::with_capacity(before);
        for (i, &p) in points.iter().enumerate() {
            // A point that is not finite is far from all others, and refused later.
            let repeats = kept.last().is_some_and(|last| last.distance(p) <= tolerance);
            let replaces = repeats && i + 1 == before && kept.len() > 1;
            if replaces {
                kept.pop();
            }
            if !repeats || replaces {
                kept.push(p);
            }
        }
        if let (true, [first, .., last]) = (*closed, kept.as_slice())
            && first != last
            && first.distance(*last) <= tolerance
        {
            kept.pop();
        }
        *points = kept;
        before - points.len()
    }
}

/// A hard point of a case: a place in the plane that becomes a node.
#[derive(Clone, Debug, PartialEq)]
pub struct PointSpec {
    /// Its name, that of its group.
    pub name: String,
    /// Where it is.
    pub at: DVec2,
    /// The size of elements there, if it is given.
    pub size: Option<f64>,
    /// The ratio of successive sizes away from it, at least 1.
    pub growth: f64,
    /// Its place in the case, for messages.
    pub place: String,
}

/// A named curve of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveSpec<Shape = CurveShape> {
    /// Its name, unique in the case.
    pub name: String,
    /// Its shape.
    pub shape: Shape,
    /// The number of segments, if the case fixes it (for all pieces of a polyline together).
    pub segments: Option<u32>,
    /// Its place in the case, for messages ("plate.toml, line 14").
    pub place: String,
}

/// A face of a case, by the names of its curves. The curves of a loop may have any order and direction.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceSpec {
    /// Its name, unique in the case.
    pub name: String,
    /// Curves of the outer loop.
    pub outer: Vec<String>,
    /// Curves of each hole.
    pub holes: Vec<Vec<String>>,
    /// Crack lines: the mesh has separate nodes on their two sides, except at tips inside the face.
    pub cracks: Vec<String>,
    /// Repeated lines: internal lines that are edges of the mesh, with the same nodes on both sides.
    pub repeated: Vec<String>,
    /// Groups of faces in which it is, besides its own name.
    pub groups: Vec<String>,
    /// Its place in the case, for messages.
    pub place: String,
}

/// The shape of a curve in a case with surfaces; angles in degrees.
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
        /// Centre, axis, and direction of the angle 0.
        frame: AxisFrame,
        /// Radius, positive.
        radius: f64,
        /// Angles of start and end.
        angles: [f64; 2],
    },
    /// Straight lines through points; the corners become nodes.
    Polyline {
        /// Points.
        points: Vec<DVec3>,
        /// Whether the last point is joined to the first.
        closed: bool,
        /// The angle by which it turns at a corner at least, radians; other points need not become nodes.
        corner_angle: f64,
    },
    /// A rational B-spline.
    Nurbs {
        /// Degree.
        degree: usize,
        /// Knots.
        knots: Vec<f64>,
        /// Positive weights, one for each point; empty: all are 1.
        weights: Vec<f64>,
        /// Control points.
        points: Vec<DVec3>,
    },
    /// A curve in the parametric plane of a surface.
    On {
        /// Name of the surface.
        surface: String,
        /// Its shape in u and v.
        shape: CurveShape,
    },
}

/// The shape of a surface in a case.
#[derive(Clone, Debug, PartialEq)]
pub enum SurfaceShape {
    /// A parallelogram; u and v are lengths along its sides.
    Plane {
        /// A corner.
        corner: DVec3,
        /// Two sides from it.
        sides: [DVec3; 2],
    },
    /// A cone, a cylinder if both radii are equal: u is the angle in degrees, v the distance from the foot.
    Cone {
        /// Foot, axis and direction of the angle 0.
        frame: AxisFrame,
        /// Radius at the foot and at the top.
        radii: [f64; 2],
        /// Height.
        height: f64,
        /// First and last angle, degrees.
        angles: [f64; 2],
    },
    /// A sphere: u is the longitude, v the latitude, in degrees.
    Sphere {
        /// Centre, axis and direction of the angle 0.
        frame: AxisFrame,
        /// Radius.
        radius: f64,
        /// First and last longitude, degrees.
        angles: [f64; 2],
        /// First and last latitude, degrees.
        latitudes: [f64; 2],
    },
    /// A torus: u is the angle about the axis, v about the tube from the outermost circle upwards, in degrees.
    Torus {
        /// Centre, axis and direction of the angle 0.
        frame: AxisFrame,
        /// Radius of the centre line of the tube.
        radius: f64,
        /// Radius of the tube.
        tube: f64,
        /// First and last angle, degrees.
        angles: [f64; 2],
        /// First and last angle about the tube, degrees.
        tube_angles: [f64; 2],
    },
    /// The surface that a curve sweeps along a straight line: u is the curve's parameter, v the length along the line.
    Extrusion {
        /// The name of a curve.
        curve: String,
        /// Direction and length.
        along: DVec3,
    },
    /// The surface that a curve sweeps about an axis: u is the angle in degrees, v the curve's parameter.
    Revolution {
        /// The name of a curve.
        curve: String,
        /// The axis.
        frame: AxisFrame,
        /// First and last angle, degrees.
        angles: [f64; 2],
    },
    /// Control points and knots; a Bezier patch if all knots are at the ends.
    Nurbs {
        /// Degrees along u and v.
        degrees: [usize; 2],
        /// Knots along u and v.
        knots: [Vec<f64>; 2],
        /// One for each point; empty: all are 1.
        weights: Vec<f64>,
        /// Rows of points along v, one after another along u.
        points: Vec<DVec3>,
        /// The number of points in a row.
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
    /// Its place in the case, for messages.
    pub place: String,
}

/// A curve of a case with surfaces.
pub type SpaceCurveSpec = CurveSpec<SpaceShape>;

/// A face of a case with surfaces; without an outer loop and without directed loops it is its whole surface, except the
/// holes.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceFaceSpec {
    /// Its surface.
    pub surface: String,
    /// Its name and its curves.
    pub face: FaceSpec,
    /// Directed loops, instead of an outer loop and holes: the face is on the left of each, seen from where its normal
    /// points. Each curve with whether its loop runs along it.
    pub loops: Vec<Vec<(String, bool)>>,
    /// Whether its normal is against that of its surface, `r_u x r_v`.
    pub reversed: bool,
}

/// The surfaces, curves and faces from which [`build`](super::complex::build) makes a domain.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ComplexSpec {
    /// All surfaces.
    pub surfaces: Vec<SurfaceSpec>,
    /// All curves.
    pub curves: Vec<SpaceCurveSpec>,
    /// All faces, at least one.
    pub faces: Vec<SurfaceFaceSpec>,
    /// The distance up to which ends of curves are one, and curves lie on their surfaces; by default a small fraction
    /// of their size.
    pub tolerance: Option<f64>,
}
