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
use crate::core::discrete::own_triangles::implied_metric_in_space;
use crate::core::discrete::repair::repair;
use crate::core::discrete::surface::{implied_sizes, sizes_within, surface};
use crate::core::discrete::{Repaired, Surface, Triangles};
use crate::core::fault::Fault;
use crate::core::formats::format::read_mesh_watched;
use crate::core::kernel::Metric2;
use crate::core::mesh::{Embedding, Mesh, Names};
use crate::core::metric::{Field, FieldSpec, MetricSource, Sizing};
use crate::core::progress::{Stage, Watch};
use crate::core::soup::second_order::Divided;
use crate::core::soup::{MeshFile, Repair};

/// The background of a given mesh: its own triangles (the default in the plane), or its shape (the default in space).
/// The metric is that of the case's fields; without fields, that given at its nodes or implied by its triangles.
pub(super) fn from_mesh(
    case: &Case,
    source: &MeshSource,
    taking: &Taking,
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
    if !file.is_plane() || taking.used == Some(MeshUse::Shape) {
        let bends = if taking.used == Some(MeshUse::Triangles) { None } else { file.divided_along_bends() };
        return from_surface(case, &file, bends, &place, taking, watch);
    }
    let mut imported = import(&file, case.split_odd).map_err(|fault| fault.at(place.clone()))?;
    imported.repairs.append(&mut file.not_read());
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

/// A mesh as a surface without CAD: its shape remeshed, or its own triangles, chart by chart. Sizes are those of the
/// case's fields; without fields, those given at its points or implied by its triangles, before they were divided along
/// their `bends`. `place` is the file's name.
fn from_surface(
    case: &Case,
    file: &MeshFile,
    bends: Option<Divided>,
    place: &str,
    taking: &Taking,
    watch: &mut dyn Watch,
) -> Result<Background, Fault> {
    // Faults of the case's fields have their own place.
    let here = |fault: Fault| if fault.is_stop() { fault } else { fault.at(place) };
    let Repaired { mesh, copied, regions, lines, points, mut repairs } = repair(file, watch).map_err(here)?;
    let surface = surface(&mesh, &regions, taking.feature_angle, taking.bound(), watch).map_err(here)?;
    if let &Some(Divided { elements, triangles, is_coarse, .. }) = &bends {
        Repair::BentElement.report(elements, &mut repairs);
        let so_far = if is_coarse { ", which are still off its bend: there would be too many" } else { "" };
        repairs.push(format!("the bend was divided into {triangles} triangles{so_far}"));
    }
    let converts = taking.used == Some(MeshUse::Triangles);
    let mut fields = Vec::new();
    for spec in &case.fields {
        fields.push(match spec {
            &FieldSpec::Curvature { chord, least, far, ref place } => {
                let sizes = curvature_sizes(&mesh, taking.feature_angle, [chord, least, far]);
                surface.table(&sizes.map_err(|fault| fault.at(place.clone()))?)?
            }
            spec => Field::compile(spec, &|_| None)?,
        });
    }
    if fields.is_empty() {
        fields.push(match &file.metric {
            Some(given) => {
                let copies = copied.iter().map(|&point| given[point as usize]);
                surface.table(&given.iter().copied().chain(copies).collect::<Vec<_>>()).map_err(here)?
            }
            None if converts => surface.table(&implied_metric_in_space(&mesh)).map_err(here)?,
            None => {
                let sizes = match &bends {
                    Some(Divided { lengths, .. }) => {
                        let copies = copied.iter().map(|&point| lengths[point as usize]);
                        sizes_within(&mesh, &lengths.iter().copied().chain(copies).collect::<Vec<_>>())
                    }
                    None => implied_sizes(&mesh),
                };
                surface.table(&sizes).map_err(here)?
            }
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
        domain.limit_chords(&shape_limits(case), &|curve| surface.features[curve]);
        from_domain(case, domain, Some(fields), lines, &[], watch)
    };
    let mut made = made.map_err(here)?;
    made.names.faces = faces;
    made.names.further.lines = file.further_lines();
    made.names.further.faces = further;
    repairs.append(&mut made.repairs);
    repairs.append(&mut file.not_read());
    Ok(Background { repairs, ..made })
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
