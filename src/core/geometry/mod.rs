//! Curves, surfaces, and the domains that they bound: their description in a case (`spec`), and the geometry built from
//! it.

mod frame;
mod mirror;
mod spec;
mod nurbs;
mod nurbs_part;
mod nurbs_cut;
pub mod curve;
mod surface;
mod primitive;
mod space_curve;
mod swept;
mod turning;
mod chart;
mod facets;
mod face_surface;
mod atlas;
mod image;
mod course;
mod domain_curve;
mod domain_point;
pub mod loops;
mod inside;
pub(crate) mod crossing;
pub(crate) mod assembly;
mod domain;
mod hard;
mod chord_limits;
mod named_curve;
pub mod lifting;
mod whole_surface;
mod oriented;
pub mod complex;

pub use atlas::Atlas;
pub use chart::{Chart, ChartPoint};
pub use course::Course;
pub use domain::{Domain, DomainFace, Half, Line, Spatial};
pub use domain_curve::{CurveId, CurveKind, DirectedCurve, DomainCurve};
pub use domain_point::{DomainPoint, PointOn};
pub use face_surface::FaceSurface;
pub use facets::Facets;
pub use frame::AxisFrame;
pub use image::{Deviation, Image};
pub use mirror::{Axis, Joint, Mirror};
pub(in crate::core) use named_curve::NamedCurve;
pub use nurbs::{Basis, NurbsCurve, Vector};
pub use nurbs_cut::cut;
pub(in crate::core) use oriented::unseamed;
pub use primitive::revolution;
pub use space_curve::SpaceCurve;
pub use spec::{
    ComplexSpec, CurveShape, CurveSpec, FaceSpec, PointSpec, SpaceCurveSpec, SpaceShape, SurfaceFaceSpec, SurfaceShape,
    SurfaceSpec,
};
pub use surface::{Bend, Edge, NurbsSurface, SurfacePoint};
pub use turning::{ShapeLimits, Turning};
#[cfg(test)]
pub(crate) mod fixtures;
