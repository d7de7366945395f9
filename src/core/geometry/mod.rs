//! Curves and planar domains, and the exact predicates that every topological decision uses.

pub mod predicates;
pub mod nurbs;
pub mod curve;
pub mod place;
pub mod loops;
pub mod crossing;
pub mod inside;
pub mod assembly;
pub mod domain;
#[cfg(test)]
pub(crate) mod fixtures;
