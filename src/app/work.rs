//! The work of `core` as the commands need it: from a case to a mesh that can be written, and what is told about it.

use crate::core::fault::Fault;
use crate::core::io::case::Case;
use crate::core::io::mesh_file::MeshFile;
use crate::core::io::report::Report;
use crate::core::io::statistics::Statistics;
use crate::core::progress::Watch;

/// The triangles that a conversion starts from.
pub(super) struct Triangles {
    /// The mesh with its metric, for files.
    pub file: MeshFile,
    /// What it is like.
    pub statistics: Statistics,
}

/// A finished conversion.
pub(super) struct Quads {
    /// The mesh, for files.
    pub file: MeshFile,
    /// What is told about it; its timing is still empty.
    pub report: Report,
}

/// Makes the triangles of a case.
pub(super) fn background(case: &Case, _watch: &mut dyn Watch) -> Result<Triangles, Fault> {
    Err(Fault::new("Conversion is not built yet").at(case.name.clone()))
}

/// Converts a case.
pub(super) fn convert(case: &Case, _watch: &mut dyn Watch) -> Result<Quads, Fault> {
    Err(Fault::new("Conversion is not built yet").at(case.name.clone()))
}
