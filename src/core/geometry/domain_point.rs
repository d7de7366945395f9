//! A hard point of a domain: its place, and what it lies on.

use glam::{DVec2, DVec3};

use super::domain_curve::CurveId;

/// What a hard point lies on.
#[derive(Clone, Debug, PartialEq)]
pub enum PointOn {
    /// The inside of a face.
    Face,
    /// A curve, at this parameter strictly between its ends.
    Curve(CurveId, f64),
    /// Vertices of the plane: on surfaces, the images of one vertex in space.
    Vertices(Vec<u32>),
}

/// A hard point.
#[derive(Clone, Debug, PartialEq)]
pub struct DomainPoint {
    /// Its place in the parametric plane.
    pub uv: DVec2,
    /// Its place in space.
    pub xyz: DVec3,
    /// What it lies on.
    pub on: PointOn,
}
