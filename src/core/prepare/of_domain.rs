//! The background mesh of a domain of curves, in the plane or on surfaces.

use std::sync::Arc;

use super::graded::bounded;
use super::need::allow_sizes;
use super::spacing::{Divided, divided};
use super::{Background, layers};
use crate::core::background::adapt::adapt;
use crate::core::background::triangulate::divide_by;
use crate::core::background::{Adapted, DividedDomain, Division};
use crate::core::case::Case;
use crate::core::fault::{Fault, FaultKind};
use crate::core::geometry::Domain;
use crate::core::mesh::{Embedding, Mesh, Named, Names, PointId};
use crate::core::metric::{Field, MetricSource, Sizing};
use crate::core::progress::{Stage, Watch};
use crate::core::soup::Repair;

/// Number of points at which the metric is checked first.
const SURVEYED: usize = 20_000;

/// The background mesh of a domain of curves, in the plane or on surfaces. If the case bounds the gradation, a first
/// mesh carries the table of the bounded metric for the second. `own` replaces the fields of the case.
pub(super) fn from_domain(
    case: &Case,
    domain: Domain,
    own: Option<Vec<Field>>,
    lines: FileLines,
    watch: &mut dyn Watch,
) -> Result<Background, Fault> {
    watch.tell(Stage::Divide, 0, 0);
    let atlas = domain.spatial.as_ref().map(|spatial| Arc::clone(&spatial.atlas));
    let compile = |spec| Field::compile(spec, &|name| domain.curve_polyline(name));
    let fields = match own {
        Some(own) => own,
        None => case.fields.iter().map(compile).collect::<Result<_, _>>()?,
    };
    let mut sizing = Sizing::new(fields, case.parameters.size_scale).on(atlas.clone());
    sizing.survey(&domain.sample_points(SURVEYED), &|p| domain.inside(p).is_some())?;
    let layered =
        layers::layered_curves(&domain, &case.parameters).map_err(|fault| fault.of_kind(FaultKind::Parameter))?;
    watch.tell(Stage::Triangulate, 0, 0);
    let first = divided(&domain, &sizing, case.gradation)?;
    sizing = first.sizing.clone();
    let (spacing, gaps) = (first.spacing.clone(), first.gaps.clone());
    let mut made = adapted_mesh(case, &domain, first, watch)?;
    if let Some(beta) = case.gradation {
        sizing = Sizing::new(vec![bounded(&made.mesh, &sizing, beta)?], 1.0).on(atlas);
        watch.tell(Stage::Triangulate, 0, 0);
        let (divided, set) = divide_by(Division::measure(&domain, &sizing)?.across(&gaps)?)?;
        let again = Divided { divided, set, sizing: sizing.clone(), spacing: spacing.clone(), gaps };
        made = adapted_mesh(case, &domain, again, watch)?;
    }
    if let Some(curves) = layered {
        layers::offset_only(&mut made.mesh, &made.divided, &curves, case.parameters.layers);
    }
    let faces = domain.faces.iter().map(|face| Named::new(&face.name)).collect();
    // Only curves on lines of a file name lines of the output.
    let on_line = |&(ends, curve): &([PointId; 2], u32)| Some((ends, lines.of_curve.get(curve as usize).copied()??));
    let sides = made.lines.iter().filter_map(on_line).collect();
    let names = Names::of_faces(faces).with_lines(lines.names, sides);
    let mut repairs = Vec::new();
    Repair::RepeatedPoint.report(domain.merged_points, &mut repairs);
    Repair::JoinedEnd.report(domain.joined_ends, &mut repairs);
    Ok(Background { mesh: made.mesh, sizing, names, adapted: made.adapted, repairs, spacing })
}

/// The lines of the file of a domain.
#[derive(Default)]
pub(super) struct FileLines {
    /// Their names, by index.
    pub names: Vec<Named>,
    /// The line on which each curve of the domain lies, if any.
    pub of_curve: Vec<Option<u32>>,
}

/// The background mesh of a domain.
struct AdaptedMesh {
    mesh: Mesh,
    adapted: Adapted,
    divided: DividedDomain,
    /// The sides along curves, by points and curve.
    lines: Vec<([PointId; 2], u32)>,
}

fn adapted_mesh(case: &Case, domain: &Domain, of: Divided, watch: &mut dyn Watch) -> Result<AdaptedMesh, Fault> {
    let Divided { divided, set, sizing, .. } = of;
    let metric = set.uv.iter().map(|&uv| sizing.metric(uv)).collect::<Result<_, _>>()?;
    allow_sizes(&set, &sizing, &case.parameters, watch)?;
    watch.tell(Stage::Adapt, 0, 0);
    // A unit mesh has about 2.3 triangles for each quadrilateral that the metric asks for (docs/algorithm.md,
    // "Adaptation to the metric").
    let most = usize::try_from(case.parameters.max_quads.saturating_mul(3)).unwrap_or(usize::MAX);
    let mut mesh = Mesh::from_triangles(&set, metric);
    if let Some(spatial) = &domain.spatial {
        mesh.set_embedding(Arc::new(Embedding { atlas: Arc::clone(&spatial.atlas), points: set.xyz }));
    }
    let (mesh, adapted) = adapt(mesh, &sizing, most, watch)?;
    Ok(AdaptedMesh { mesh, adapted, divided, lines: set.lines })
}
