//! Curves, surfaces and the domains on them: what a case says of them (`spec`), and what is built of that.

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
pub mod ground;
pub mod atlas;
pub mod image;
pub mod course;
pub mod domain_curve;
pub mod loops;
pub mod inside;
pub mod crossing;
pub mod assembly;
pub mod domain;
pub(in crate::core) mod named_curve;
pub mod lifting;
mod whole_surface;
pub mod complex;
#[cfg(test)]
pub(crate) mod fixtures;
