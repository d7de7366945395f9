//! The surface of a shape in a case.

use super::primitive::{cone, extrusion, plane, revolution, sphere, torus};
use super::space_curve::SpaceCurve;
use super::spec::SurfaceShape;
use super::surface::NurbsSurface;
use crate::core::fault::Fault;

impl SurfaceShape {
    /// The surface; `curve` looks up a curve by name.
    ///
    /// # Errors
    /// What its constructor refuses, an unknown curve, and a curve that is given on a surface.
    pub fn surface(&self, curve: &dyn Fn(&str) -> Option<SpaceCurve>) -> Result<NurbsSurface, Fault> {
        let profile = |name: &str| {
            let curve = curve(name).ok_or_else(|| Fault::new(format!("There is no curve \"{name}\"")))?;
            curve.nurbs().ok_or_else(|| {
                Fault::new(format!("The curve \"{name}\" lies on a surface and cannot be swept"))
                    .remedy("Define it in space")
            })
        };
        match self {
            SurfaceShape::Plane { corner, sides } => plane(*corner, *sides),
            SurfaceShape::Cone { frame, radii, height, angles } => cone(frame, *radii, *height, *angles),
            SurfaceShape::Sphere { frame, radius, angles, latitudes } => sphere(frame, *radius, *angles, *latitudes),
            SurfaceShape::Torus { frame, radius, tube, angles, tube_angles } => {
                torus(frame, *radius, *tube, *angles, *tube_angles)
            }
            SurfaceShape::Extrusion { curve, along } => extrusion(&profile(curve)?, *along),
            SurfaceShape::Revolution { curve, frame, angles } => revolution(&profile(curve)?, frame, *angles),
            SurfaceShape::Nurbs { degrees, knots, weights, points, columns } => {
                NurbsSurface::new(*degrees, knots.clone(), weights, points, *columns)
            }
        }
    }
}
