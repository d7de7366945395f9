//! Curves, surfaces and the domains on them, and the exact predicates that every topological decision uses.

pub mod predicates;
pub mod nurbs;
pub mod curve;
pub mod surface;
pub mod primitive;
pub mod space_curve;
pub mod chart;
pub mod facets;
pub mod ground;
pub mod atlas;
pub mod image;
pub mod place;
pub mod loops;
pub mod crossing;
pub mod inside;
pub mod assembly;
pub mod domain;
pub mod lifting;
mod whole_surface;
pub mod complex;
#[cfg(test)]
pub(crate) mod fixtures;
