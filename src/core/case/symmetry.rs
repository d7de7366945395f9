//! `symmetry` of a case file: the mirror line in which the mesh is to be symmetric.

use super::table::Table;
use crate::core::fault::Fault;
use crate::core::kernel::worded::worded;

worded! {
    /// The line in which a planar domain is its own mirror image.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Symmetry by word {
        /// The line through its middle on which x is the same.
        X = "x",
        /// The line through its middle on which y is the same.
        Y = "y",
        /// The first of the two in which it is symmetric.
        Auto = "auto",
    }
}

pub(super) fn symmetry(table: &Table<'_>) -> Result<Option<Symmetry>, Fault> {
    let Some(value) = table.get("symmetry") else { return Ok(None) };
    let word = value.text().unwrap_or_default();
    let known = Symmetry::ALL.into_iter().find(|symmetry| symmetry.word() == word);
    known.map(Some).ok_or_else(|| value.wrong("\"x\", \"y\" or \"auto\"", "symmetry = \"x\""))
}
