//! From triangles to quadrilaterals. For now the guarantee alone (spec 2.10) and what makes its mesh better (spec 10).

pub mod parameters;
pub mod component;
pub mod matching;
pub mod t_join;
pub mod last_resort;
pub mod energy;
pub mod clean_up;
pub mod finish;
pub mod conversion;
