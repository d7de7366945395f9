//! The colours and strokes of figures: made for print, independent of any window's.

use super::picture::Role;

/// How a role looks in a figure: colours as `#RRGGBB`, widths in points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Colour of areas; `None` leaves the ground.
    pub fill: Option<&'static str>,
    /// Colour of lines.
    pub stroke: Option<&'static str>,
    /// Width of lines in points, whatever the scale of the mesh.
    pub width: f64,
}

/// The width in points of edges that are closer to each other than [`CROWDED`].
pub const THIN: f64 = 0.12;

/// Edges of elements whose height is under this many points are drawn thin, so that they do not run together.
pub const CROWDED: f64 = 0.4;

/// The `figure` palette in colour.
pub fn figure(role: Role) -> Style {
    let area = |fill| Style { fill: Some(fill), stroke: None, width: 0.0 };
    let line = |stroke, width| Style { fill: None, stroke: Some(stroke), width };
    match role {
        Role::LiveTriangle => area("#FFFFFF"),
        Role::DeadQuad => area("#DBE4EC"),
        Role::LiveEdge => line("#9A9A9A", 0.25),
        Role::DeadEdge => line("#6F8496", 0.35),
        Role::Boundary => line("#20262C", 0.8),
        Role::Front(4) => line("#6E7A87", 0.9),
        Role::Front(3) => line("#7C70DA", 1.1),
        Role::Front(2) => line("#00659C", 1.1),
        Role::Front(_) => line("#002B45", 1.2),
        Role::Base => line("#AD4E00", 1.8),
    }
}
