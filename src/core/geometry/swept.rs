//! The surface of a shape that a case gives.

use super::primitive::{cone, extrusion, plane, revolution, sphere, torus};
use super::space_curve::SpaceCurve;
use super::spec::SurfaceShape;
use super::surface::NurbsSurface;
use crate::core::fault::Fault;

impl SurfaceShape {
    /// The surface; `curve` gives the curve of a name.
    ///
    /// # Errors
    /// What its maker refuses, and a curve that is not there or is not of space.
    pub fn surface(&self, curve: &dyn Fn(&str) -> Option<SpaceCurve>) -> Result<NurbsSurface, Fault> {
        let profile = |name: &str| {
            let curve = curve(name).ok_or_else(|| Fault::new(format!("There is no curve \"{name}\"")))?;
            curve.nurbs().ok_or_else(|| {
                Fault::new(format!("The curve \"{name}\" lies on a surface and cannot be swept"))
                    .remedy("Give it by points in space")
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
