//! Relaxation of nodes: the energy that it lowers, and settling after a change of structure.

pub mod energy;
pub mod settle;
