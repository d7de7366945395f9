//! Curves and planar domains, and the exact predicates that every topological decision uses.

pub mod predicates;
pub mod nurbs;
pub mod curve;
pub mod domain;
