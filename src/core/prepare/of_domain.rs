//! The background mesh of a domain of curves, in the plane or on surfaces.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use super::graded::bounded;
use super::need::allow_sizes;
use super::spacing::{Divided, divided};
use super::{Background, layers, symmetric, walls};
use crate::core::background::adapt::adapt;
use crate::core::background::triangulate::divide_by;
use crate::core::background::{Adapted, DividedDomain, Division};
use crate::core::case::Case;
use crate::core::discrete::lines::PointGroups;
use crate::core::fault::{Fault, FaultKind};
use crate::core::geometry::{Domain, Line, PointSpec, ShapeLimits};
use crate::core::mesh::{Embedding, Mesh, Named, Names, PointId};
use crate::core::metric::{Field, FieldSpec, MetricSource, Sizing};
use crate::core::progress::{Stage, Watch};
use crate::core::soup::Repair;

/// Number of points at which the metric is checked first.
const SURVEYED: usize = 20_000;
/// Beyond this multiple of the domain, a size at a hard point limits nothing.
const FAR: f64 = 10.0;
/// The length of a hard point as a curve for fields by distance, as a fraction of the domain.
const SHORT: f64 = 1e-6;

/// The background mesh of a domain of curves, in the plane or on surfaces. If the case bounds the gradation, a first
/// mesh carries the table of the bounded metric for the second. `own` replaces the fields of the case.
pub(super) fn from_domain(
    case: &Case,
    domain: Domain,
    own: Option<Vec<Field>>,
    lines: FileLines,
    more: &[i32],
    watch: &mut dyn Watch,
) -> Result<Background, Fault> {
    watch.tell(Stage::Divide, 0, 0);
    let atlas = domain.spatial.as_ref().map(|spatial| Arc::clone(&spatial.atlas));
    let has_own_fields = own.is_none();
    let compile = |spec| Field::compile(spec, &|name| domain.curve_polyline(name));
    // On surfaces no gaps are looked for, and the field is refused.
    let is_of_gaps = |spec: &FieldSpec| domain.spatial.is_none() && matches!(spec, FieldSpec::Gap { .. });
    let mut fields = match own {
        Some(own) => own,
        None => case.fields.iter().filter(|spec| !is_of_gaps(spec)).map(compile).collect::<Result<_, _>>()?,
    };
    for point in &case.points {
        fields.extend(size_at(point, domain.size)?);
    }
    let mut sizing = Sizing::new(fields, case.parameters.size_scale).on(atlas.clone());
    let points = domain.sample_points(SURVEYED);
    sizing.survey(&points, &|p| domain.inside(p).is_some())?;
    let mut half = case.symmetry.map(|symmetry| symmetric::half(&domain, symmetry, &sizing, &points)).transpose()?;
    if let Some(half) = &mut half {
        half.domain.limit_chords(&shape_limits(case), &|_| true);
        half.give_segments(more);
        half.give_points(&case.points)?;
    }
    let mirror = half.as_ref().map(|half| half.mirror);
    let layered = layers::layered_curves(&domain, &case.parameters);
    let layered = layered.map_err(|fault| fault.of_kind(FaultKind::Parameter))?;
    let layered = match (layered, &half) {
        (Some(curves), Some(half)) => Some(half.parts_of(&domain, &curves)),
        (layered, _) => layered,
    };
    let whole = &domain;
    let domain = half.as_ref().map_or(whole, |half| &half.domain);
    sizing = sizing.mirrored(mirror);
    watch.tell(Stage::Triangulate, 0, 0);
    let first = divided(domain, &sizing, layers_in_gaps(case), case.gradation)?;
    sizing = first.sizing.clone();
    let (mut spacing, gaps) = (first.spacing.clone(), first.gaps.clone());
    let mut shaped = first.divided.shaped;
    let mut made = adapted_mesh(case, domain, first, watch)?;
    if let Some(beta) = case.gradation {
        sizing = Sizing::new(vec![bounded(&made.mesh, &sizing, beta)?], 1.0).on(atlas).mirrored(mirror);
        watch.tell(Stage::Triangulate, 0, 0);
        let (divided, set) = divide_by(Division::measure(domain, &sizing)?.across(&gaps)?)?;
        spacing.follow(&divided);
        shaped = shaped.max(divided.shaped);
        let again = Divided { divided, set, sizing: sizing.clone(), spacing: spacing.clone(), gaps };
        made = adapted_mesh(case, domain, again, watch)?;
    }
    if let Some(half) = &half {
        made.mesh.set_symmetry(symmetric::symmetry(&made.mesh, half, &made.lines, &made.hard));
        layers::not_along_the_line(&mut made.mesh, case.parameters.layers);
    }
    if has_own_fields {
        let with_images = |curves: &[String]| half.as_ref().map(|half| half.with_images(whole, curves));
        sizing = sizing.with_walls(walls::of_fields(case, domain, &made.divided, &with_images));
    }
    if let Some(curves) = layered {
        layers::offset_only(&mut made.mesh, &made.divided, &curves, case.parameters.layers);
    }
    let faces = domain.faces.iter().map(|face| Named::new(&face.name)).collect();
    // Only curves on lines of a file name lines of the output.
    let on_line = |&(ends, curve): &([PointId; 2], u32)| Some((ends, lines.of_curve.get(curve as usize).copied()??));
    let sides = made.lines.iter().filter_map(on_line).collect();
    let mut names = Names::of_faces(faces).with_lines(lines.names, sides);
    let own = case.points.iter().map(|point| vec![Some(Named::new(&point.name))]);
    let hard = half.as_ref().map_or(made.hard.clone(), |half| symmetric::hard_points(half, &made.mesh, &made.hard));
    names.further.of_faces = groups_of_faces(domain);
    names.further.points = named_points(&lines.points.unwrap_or_else(|| own.collect()), &hard);
    let mut repairs = Vec::new();
    Repair::RepeatedPoint.report(domain.merged_points, &mut repairs);
    Repair::JoinedEnd.report(domain.joined_ends, &mut repairs);
    Repair::ShapedCurve.report(shaped, &mut repairs);
    let mirror_line = half.map_or_else(Vec::new, |half| half.segments(&made.divided.chains));
    Ok(Background {
        mesh: made.mesh,
        sizing,
        names,
        adapted: made.adapted,
        repairs,
        spacing,
        mirror_line,
        is_noisy: false,
    })
}

/// The groups of the faces of a domain, by name.
fn groups_of_faces(domain: &Domain) -> Vec<(Named, Vec<u32>)> {
    let mut groups: BTreeMap<&str, Vec<u32>> = BTreeMap::new();
    for (number, face) in (0..).zip(&domain.faces) {
        face.groups.iter().for_each(|group| groups.entry(group).or_default().push(number));
    }
    groups.into_iter().map(|(name, faces)| (Named::new(name), faces)).collect()
}

/// The lines and hard points of the file of a domain.
#[derive(Default)]
pub(super) struct FileLines {
    /// Their names, by index.
    pub names: Vec<Named>,
    /// The line on which each curve of the domain lies, if any.
    pub of_curve: Vec<Option<u32>>,
    /// The groups of its hard points, by number; `None` in a case without a file.
    pub points: Option<PointGroups>,
}

/// The groups of hard points, which have these numbers.
pub(super) fn named_points(groups: &PointGroups, hard: &[(u32, PointId)]) -> Vec<(Option<Named>, PointId)> {
    let mut hard = hard.to_vec();
    hard.sort_unstable();
    let of = |number: u32| groups.get(number as usize).into_iter().flatten();
    hard.into_iter().flat_map(|(number, point)| of(number).map(move |named| (named.clone(), point))).collect()
}

/// The background mesh of a domain.
struct AdaptedMesh {
    mesh: Mesh,
    adapted: Adapted,
    divided: DividedDomain,
    /// The sides along curves, by points and curve.
    lines: Vec<([PointId; 2], u32)>,
    /// The hard points, by number.
    hard: Vec<(u32, PointId)>,
}

/// The layers that a case asks for in narrow gaps: the most of any field, or one row.
fn layers_in_gaps(case: &Case) -> u32 {
    let layers = |spec: &FieldSpec| if let FieldSpec::Gap { layers, .. } = spec { *layers } else { 1 };
    case.fields.iter().map(layers).max().unwrap_or(1)
}

/// The limits that a case sets on the chords of curves.
pub(super) fn shape_limits(case: &Case) -> ShapeLimits {
    let mut by_fields = ShapeLimits::NO_FIELD;
    for spec in &case.fields {
        if let FieldSpec::Curvature { chord, least, .. } = spec {
            by_fields = [by_fields[0].min(*chord), by_fields[1].min(*least * case.parameters.size_scale)];
        }
    }
    ShapeLimits { chord: case.chord, least_segments: case.least_segments, by_fields }
}

/// The field of the size that a hard point asks for.
fn size_at(point: &PointSpec, extent: f64) -> Result<Option<Field>, Fault> {
    let Some(first) = point.size else { return Ok(None) };
    let curves = vec![point.name.clone()];
    let far = first.max(FAR * extent);
    let spec = FieldSpec::Distance { curves, first, growth: point.growth, far, place: point.place.clone() };
    // A curve so short that it is a point.
    let line = Line::Plane(vec![point.at, point.at + DVec2::X * (SHORT * extent)]);
    Field::compile(&spec, &|_| Some(line.clone())).map(Some)
}

fn adapted_mesh(case: &Case, domain: &Domain, of: Divided, watch: &mut dyn Watch) -> Result<AdaptedMesh, Fault> {
    let Divided { divided, set, sizing, .. } = of;
    let metric = set.uv.iter().map(|&uv| sizing.metric(uv)).collect::<Result<_, _>>()?;
    // The mirror image of a half counts too.
    let copies = if case.symmetry.is_some() { 2 } else { 1 };
    allow_sizes(&set, &sizing, &case.parameters, copies, watch)?;
    watch.tell(Stage::Adapt, 0, 0);
    // A unit mesh has about 2.3 triangles for each quadrilateral that the metric asks for (docs/algorithm.md,
    // "Adaptation to the metric").
    let most = (case.parameters.max_quads / u64::from(copies)).saturating_mul(3);
    let most = usize::try_from(most).unwrap_or(usize::MAX);
    let hard = set.hard.iter().map(|&(node, number)| (number, set.point[node as usize])).collect();
    let mut mesh = Mesh::from_triangles(&set, metric);
    if let Some(spatial) = &domain.spatial {
        mesh.set_embedding(Arc::new(Embedding { atlas: Arc::clone(&spatial.atlas), points: set.xyz }));
    }
    let (mesh, adapted) = adapt(mesh, &sizing, most, watch)?;
    Ok(AdaptedMesh { mesh, adapted, divided, lines: set.lines, hard })
}
