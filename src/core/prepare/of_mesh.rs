//! The background mesh from a given mesh: its own triangles, or its shape remeshed.

use std::sync::Arc;

use glam::DVec2;

use super::Background;
use super::graded::bounded;
use super::need::allow_triangles;
use super::of_domain::{FileLines, from_domain, named_points, shape_limits};
use crate::core::background::implied_metric::implied_metric;
use crate::core::background::import::import;
use crate::core::case::{Case, MeshSource, MeshUse, Taking};
use crate::core::discrete::curvature::curvature_sizes;
use crate::core::discrete::features::{features_and_noise, with_lines};
use crate::core::discrete::fitness::Fitness;
use crate::core::discrete::own_triangles::implied_metric_in_space;
use crate::core::discrete::relaxing::{Ball, relax};
use crate::core::discrete::repair::repair;
use crate::core::discrete::surface::{implied_sizes, surface};
use crate::core::discrete::{Edges, Repaired, Surface, Triangles};
use crate::core::fault::Fault;
use crate::core::formats::format::read_mesh_watched;
use crate::core::kernel::Metric2;
use crate::core::kernel::box_tree::extent;
use crate::core::mesh::{Embedding, Mesh, Names};
use crate::core::metric::fitting::{CHORD, FINEST, fitting_size, short_edge};
use crate::core::metric::{Field, FieldSpec, MetricSource, Sizing};
use crate::core::progress::{Stage, Watch};
use crate::core::soup::{MeshFile, Repair, Weld};

/// The background of a given mesh: its own triangles (the default in the plane), or its shape (the default in space,
/// and of triangles that only draw a shape). The metric is that of the case's fields; without fields, that given at its
/// nodes, that implied by its triangles, or one that fits the shape.
pub(super) fn from_mesh(
    case: &Case,
    source: &MeshSource,
    taking: &Taking,
    relaxed: &[Ball],
    watch: &mut dyn Watch,
) -> Result<Background, Fault> {
    watch.tell(Stage::Read, 0, 0);
    let (mut file, place) = match source {
        MeshSource::File { path, sol } => (read_mesh_watched(path, sol.as_deref(), watch)?, path.display().to_string()),
        MeshSource::Memory(mesh) => {
            let place = format!("the mesh \"{}\"", case.name);
            mesh.check_lists().map_err(|fault| fault.at(place.clone()))?;
            (MeshFile::clone(mesh), place)
        }
    };
    taking.scale(&mut file);
    file.ignore_groups(&case.ignore_groups).map_err(|fault| fault.at(place.clone()))?;
    let mut told = Vec::from_iter(file.join_near(taking.weld, &watch.cancel()));
    told.append(&mut file.not_read());
    let is_shape = match taking.used {
        Some(used) => used == MeshUse::Shape,
        None => !file.is_plane() || draws_shape(&file, taking.weld, watch)?,
    };
    if !file.is_plane() || is_shape {
        return from_surface(case, &file, &place, taking, told, relaxed, watch);
    }
    let mut imported = import(&file, taking.weld, case.split_odd).map_err(|fault| fault.at(place.clone()))?;
    imported.repairs.append(&mut told);
    let set = &imported.set;
    allow_triangles(set.triangles.len(), watch)?;
    let mut fields = Vec::new();
    for spec in &case.fields {
        fields.push(Field::compile(spec, &|_| None)?);
    }
    // The metric implied by the triangles needs no survey: it is valid however thin they are.
    let given = !fields.is_empty() || file.metric.is_some();
    if fields.is_empty() {
        let metrics = match &file.metric {
            Some(given) => imported.at_nodes(given),
            None => implied_metric(set).iter().map(Metric2::in_space).collect(),
        };
        fields.push(Field::table(&set.uv, &set.triangles, metrics).map_err(|fault| fault.at(place))?);
    }
    let mut sizing = Sizing::new(fields, case.parameters.size_scale);
    if given {
        // The mesh is not changed, so its nodes and centroids show where the metric will be evaluated.
        let middle = |t: &[u32; 3]| t.iter().map(|&n| set.uv[n as usize]).sum::<DVec2>() / 3.0;
        let points: Vec<DVec2> = set.uv.iter().copied().chain(set.triangles.iter().map(middle)).collect();
        sizing.survey(&points, &|_| false)?;
    }
    let meshed = |sizing: &Sizing| -> Result<Mesh, Fault> {
        let metric = set.uv.iter().map(|&uv| sizing.metric(uv)).collect::<Result<_, _>>()?;
        Ok(Mesh::from_triangles(set, metric).reordered())
    };
    let mut mesh = meshed(&sizing)?;
    if let Some(beta) = case.gradation {
        sizing = Sizing::new(vec![bounded(&mesh, &sizing, beta)?], 1.0);
        mesh = meshed(&sizing)?;
    }
    let mut names = Names::of_faces(imported.regions).with_lines(imported.lines, imported.set.lines);
    names.further = imported.further;
    Ok(Background { repairs: imported.repairs, ..Background::given(mesh, sizing, names) })
}

/// Whether a mesh in the plane only draws a shape (docs/algorithm.md, "Triangles that only draw a shape").
fn draws_shape(file: &MeshFile, weld: Weld, watch: &mut dyn Watch) -> Result<bool, Fault> {
    if !Fitness::is_open(file) {
        return Ok(false);
    }
    match repair(file, weld, watch) {
        Ok(Repaired { mesh, .. }) => Ok(Fitness::reason_of(file, &mesh, &watch.cancel())?.is_some()),
        Err(fault) if fault.is_stop() => Err(fault),
        // It is refused where its triangles are taken.
        Err(_) => Ok(false),
    }
}

/// A mesh as a surface without CAD: its shape remeshed, or its own triangles, chart by chart. Sizes are those of the
/// case's fields; without fields, those given at its points or implied by its triangles. `place` is the file's name;
/// `told` comes after the repairs.
fn from_surface(
    case: &Case,
    file: &MeshFile,
    place: &str,
    taking: &Taking,
    mut told: Vec<String>,
    relaxed: &[Ball],
    watch: &mut dyn Watch,
) -> Result<Background, Fault> {
    // Faults of the case's fields have their own place.
    let here = |fault: Fault| if fault.is_stop() { fault } else { fault.at(place) };
    let Repaired { mut mesh, copied, regions, lines, points, mut repairs } =
        repair(file, taking.weld, watch).map_err(here)?;
    if !relaxed.is_empty() {
        let edges = Edges::unless(&mesh.triangles, &watch.cancel())?;
        let found = features_and_noise(&mesh, &edges, taking.feature_angle, &watch.cancel())?.0;
        let found = with_lines(found, &mesh, &edges);
        Repair::RelaxedPoint.report(relax(&mut mesh, &edges, &found, relaxed), &mut repairs);
    }
    let surface = surface(&mesh, &regions, taking.feature_angle, taking.bound(), watch).map_err(here)?;
    Repair::NoisyFold.report(surface.dropped_folds, &mut repairs);
    let noise = surface.noise.as_ref();
    let converts = taking.used == Some(MeshUse::Triangles);
    // Triangles that are converted as they are stay where they are.
    let is_noisy = noise.is_some() && !converts;
    let mut fields = Vec::new();
    for spec in &case.fields {
        fields.push(match spec {
            &FieldSpec::Curvature { chord, least, far, ref place } => {
                let sizes = curvature_sizes(&mesh, taking.feature_angle, noise, [chord, least, far]);
                surface.table(&sizes.map_err(|fault| fault.at(place.clone()))?)?
            }
            spec => Field::compile(spec, &|_| None)?,
        });
    }
    let mut limits = shape_limits(case);
    let reason = if converts { None } else { Fitness::reason_of(file, &mesh, &watch.cancel())? };
    if let Some(reason) = &reason {
        let is_told = taking.used.is_none() && (file.is_plane() || fields.is_empty());
        repairs.extend(is_told.then(|| format!("used as a shape: {reason}")));
    }
    if fields.is_empty() {
        fields.push(match &file.metric {
            None if reason.is_some() => {
                let far = fitting(&mesh, &surface);
                let least = far / FINEST;
                limits.by_fields = [CHORD, least * case.parameters.size_scale];
                repairs
                    .push(format!("sizes fit the shape, not its triangles: at most {far}, smaller where it is curved"));
                let sizes = curvature_sizes(&mesh, taking.feature_angle, noise, [CHORD, least, far]).map_err(here)?;
                surface.table(&sizes).map_err(here)?
            }
            Some(given) => {
                let copies = copied.iter().map(|&point| given[point as usize]);
                surface.table(&given.iter().copied().chain(copies).collect::<Vec<_>>()).map_err(here)?
            }
            None if converts => surface.table(&implied_metric_in_space(&mesh)).map_err(here)?,
            None => surface.table(&implied_sizes(&mesh, noise)).map_err(here)?,
        });
    }
    let faces = surface.regions.clone();
    let further = surface.groups_by_place(file, &mesh, &mut repairs);
    let lines = FileLines { names: lines, of_curve: surface.lines.clone(), points: Some(points) };
    let made = if converts {
        allow_triangles(mesh.triangles.len(), watch)?;
        from_own_triangles(case, &mesh, &surface, fields, lines, &mut repairs)
    } else {
        let mut domain = surface.domain;
        domain.limit_chords(&limits, &|curve| surface.features[curve]);
        from_domain(case, domain, Some(fields), lines, &[], watch)
    };
    let mut made = made.map_err(here)?;
    made.names.faces = faces;
    made.names.further.lines = file.further_lines();
    made.names.further.faces = further;
    repairs.append(&mut made.repairs);
    repairs.append(&mut told);
    Ok(Background { repairs, is_noisy, ..made })
}

/// The largest size that fits the shape of a mesh.
fn fitting(mesh: &Triangles, surface: &Surface) -> f64 {
    let (low, high) = extent(mesh.triangles.as_flattened().iter().map(|&point| mesh.points[point as usize]));
    let diagonal = low.distance(high);
    fitting_size(diagonal, short_edge(surface.feature_lengths.iter().copied(), diagonal))
}

/// The own triangles of a surface, flattened chart by chart.
fn from_own_triangles(
    case: &Case,
    surface: &Triangles,
    laid: &Surface,
    fields: Vec<Field>,
    lines: FileLines,
    repairs: &mut Vec<String>,
) -> Result<Background, Fault> {
    let (set, divided) = laid.triangles(surface, case.split_odd)?;
    Repair::DividedSide.report(divided, repairs);
    let atlas = laid.domain.spatial.as_ref().map(|spatial| Arc::clone(&spatial.atlas));
    let embedding = atlas.clone().map(|atlas| Arc::new(Embedding { atlas, points: set.xyz.clone() }));
    let mut sizing = Sizing::new(fields, case.parameters.size_scale).on(atlas.clone());
    sizing.survey(&set.uv, &|_| false)?;
    let meshed = |sizing: &Sizing| -> Result<Mesh, Fault> {
        let metric = set.uv.iter().map(|&uv| sizing.metric(uv)).collect::<Result<_, _>>()?;
        let mut mesh = Mesh::from_triangles(&set, metric);
        if let Some(embedding) = &embedding {
            mesh.set_embedding(Arc::clone(embedding));
        }
        Ok(mesh.reordered())
    };
    let mut mesh = meshed(&sizing)?;
    if let Some(beta) = case.gradation {
        sizing = Sizing::new(vec![bounded(&mesh, &sizing, beta)?], 1.0).on(atlas);
        mesh = meshed(&sizing)?;
    }
    let hard: Vec<_> = set.hard.iter().map(|&(node, number)| (number, set.point[node as usize])).collect();
    let mut names = Names::default().with_lines(lines.names, set.lines);
    names.further.points = named_points(&lines.points.unwrap_or_default(), &hard);
    Ok(Background::given(mesh, sizing, names))
}
