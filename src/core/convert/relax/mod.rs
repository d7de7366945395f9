//! Nodes moved until the elements around them are good: the energy that is lowered, and what a change of structure needs.

pub mod energy;
pub mod settle;
