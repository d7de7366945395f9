//! Curves, surfaces, and the domains that they bound: their description in a case (`spec`), and the geometry built from
//! it.

pub mod frame;
pub mod spec;
pub mod nurbs;
pub mod curve;
pub mod surface;
pub mod primitive;
pub mod space_curve;
pub mod swept;
pub mod chart;
pub mod facets;
pub mod face_surface;
pub mod atlas;
pub mod image;
pub(crate) mod course;
pub mod domain_curve;
pub mod loops;
pub(crate) mod inside;
pub(crate) mod crossing;
pub(crate) mod assembly;
pub mod domain;
pub(in crate::core) mod named_curve;
pub mod lifting;
mod whole_surface;
pub mod complex;
#[cfg(test)]
pub(crate) mod fixtures;
