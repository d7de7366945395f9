//! From a case to quadrilaterals: the order of the parts, and nothing of their insides.

use super::converter::{Converter, Counts};
use super::finish::Finished;
use super::last_resort::Outcome;
use super::mirror_line::background;
use crate::core::background::Adapted;
use crate::core::case::Case;
use crate::core::fault::Fault;
use crate::core::mesh::{Mesh, Names};
use crate::core::metric::Sizing;
use crate::core::prepare::{Background, Spacing};
use crate::core::progress::Watch;

/// The quadrilaterals of a case.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Converted {
    /// All quadrilaterals, where the conversion was taken to its end.
    pub mesh: Mesh,
    /// The metric field.
    pub sizing: Sizing,
    /// What its faces and lines are called.
    pub names: Names,
    /// Number of triangles of the background mesh.
    pub triangles: usize,
    /// What the adaptation of the background did.
    pub adapted: Adapted,
    /// Repairs of a given mesh, and what of its file is not read, in words.
    pub repairs: Vec<String>,
    /// What the boundary makes of the sizes that are asked for.
    pub spacing: Spacing,
    /// What the steps of the front did.
    pub counts: Counts,
    /// What the last resort did, over all components.
    pub last_resort: Outcome,
    /// What the global post-processing did.
    pub finished: Finished,
}

/// Converts a case: its background mesh, then the front and what closes it, then post-processing.
///
/// # Errors
/// As [`background`]; and where a component cannot be converted, which its checks should have found.
pub fn convert(case: &Case, watch: &mut dyn Watch) -> Result<Converted, Fault> {
    convert_by(case, watch, &mut |converter, watch| converter.run_by_faces(watch))
}

/// Converts a case as far as `drive` takes its converter.
///
/// # Errors
/// As [`background`], and what `drive` says.
pub fn convert_by(
    case: &Case,
    watch: &mut dyn Watch,
    drive: &mut dyn FnMut(&mut Converter<'_>, &mut dyn Watch) -> Result<(), Fault>,
) -> Result<Converted, Fault> {
    let Background { mesh, sizing, names, adapted, repairs, spacing, .. } = background(case, watch)?;
    let triangles = mesh.element_count();
    let (mesh, counts, last_resort, finished) = {
        let mut converter = Converter::new(mesh, &sizing, case.parameters.clone());
        drive(&mut converter, watch)?;
        (converter.mesh, converter.counts, converter.last_resort, converter.finished)
    };
    Ok(Converted { mesh, sizing, names, triangles, adapted, repairs, spacing, counts, last_resort, finished })
}
