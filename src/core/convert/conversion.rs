//! From a case to its background mesh, and on to quadrilaterals: the order of the parts, and nothing of their insides.

use std::path::Path;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::converter::{Converter, Counts};
use super::finish::Finished;
use super::last_resort::Outcome;
use super::layers;
use crate::core::background::adapt::{Adapted, adapt};
use crate::core::background::discretise::DividedDomain;
use crate::core::background::import::{implied_metric, import, is_plane};
use crate::core::background::triangulate::divide_and_triangulate;
use crate::core::discrete::curvature::curvature_sizes;
use crate::core::discrete::edges::Triangles;
use crate::core::discrete::given::implied_metric_in_space;
use crate::core::discrete::sound::{Sound, sound};
use crate::core::discrete::surface::{Surface, implied_sizes, surface};
use crate::core::fault::Fault;
use crate::core::geometry::complex;
use crate::core::geometry::domain::Domain;
use crate::core::geometry::predicates::{convex, firm};
use crate::core::io::case::{Case, DomainSource, MeshUse, Taking};
use crate::core::io::format::read_mesh_watched;
use crate::core::io::mesh_file::MeshFile;
use crate::core::mesh::half_edge::{Ground, Mesh, NewElement};
use crate::core::mesh::ids::{ElementId, NodeId, PointId};
use crate::core::mesh::names::{Named, Names};
use crate::core::mesh::triangle_set::TriangleSet;
use crate::core::metric::field::{Field, FieldSpec, MetricSource, Sizing};
use crate::core::metric::gradation::bound_gradation;
use crate::core::metric::measure::triangle_area;
use crate::core::metric::tensor::{Metric2, Metric3};
use crate::core::progress::{Stage, Watch};

/// Points at which the metric is looked over before anything is made from it.
const SURVEYED: usize = 20_000;

/// The background triangle mesh of a case with its metric.
#[derive(Clone, Debug)]
pub struct Background {
    /// Triangles; every node with its metric.
    pub mesh: Mesh,
    /// What gives the metric anywhere.
    pub sizing: Sizing,
    /// What its faces and lines are called.
    pub names: Names,
    /// What the adaptation did; nothing for a mesh that was given.
    pub adapted: Adapted,
    /// What was mended in a mesh that was given, for people.
    pub repairs: Vec<String>,
}

/// The quadrilaterals of a case.
#[derive(Clone, Debug)]
pub struct Converted {
    /// All quadrilaterals, where the conversion was taken to its end.
    pub mesh: Mesh,
    /// What gives the metric anywhere.
    pub sizing: Sizing,
    /// What its faces and lines are called.
    pub names: Names,
    /// Number of triangles of the background mesh.
    pub triangles: usize,
    /// What the adaptation of the background did.
    pub adapted: Adapted,
    /// What was mended in a mesh that was given, for people.
    pub repairs: Vec<String>,
    /// How often what happened on the front.
    pub counts: Counts,
    /// What the last resort did, over all components.
    pub last_resort: Outcome,
    /// What the global post-processing did.
    pub finished: Finished,
}

/// Makes the background mesh of a case.
///
/// # Errors
/// Whatever is wrong with the case's geometry, metric or mesh.
pub fn background(case: &Case, watch: &mut dyn Watch) -> Result<Background, Fault> {
    let has_curves = matches!(case.domain, DomainSource::Curves { .. } | DomainSource::Surfaces(_));
    if !has_curves && !case.parameters.layered_loops.is_empty() {
        return Err(Fault::new("layered_loops names curves, and the case has none")
            .remedy("Leave it out: layers then holds for every loop"));
    }
    let made = match &case.domain {
        DomainSource::Curves { curves, faces } => {
            from_domain(case, Domain::build(curves.clone(), faces.clone())?, None, Lines::default(), watch)?
        }
        DomainSource::Surfaces(spec) => from_domain(case, complex::build(spec)?, None, Lines::default(), watch)?,
        DomainSource::Elements { points, triangles, quads } => from_elements(case, points, triangles, quads)?,
        DomainSource::Mesh { path, sol, taking } => from_mesh(case, path, sol.as_deref(), taking, watch)?,
    };
    refuse_needles(&made.mesh)?;
    watch.cancel().check()?;
    chosen_faces(made, &case.parameters.faces)
}

/// A background mesh of the faces of these names alone; of all where there are none. Their curves are divided as for all faces.
fn chosen_faces(made: Background, names: &[String]) -> Result<Background, Fault> {
    if names.is_empty() {
        return Ok(made);
    }
    let mut regions = Vec::new();
    for name in names {
        let faces = || made.names.faces.iter().map(|face| &face.name);
        let known = || faces().map(|face| (strsim::damerau_levenshtein(name, face), face));
        let own = faces().zip(0..).filter(|(face, _)| *face == name || is_part_of(face, name));
        let before = regions.len();
        regions.extend(own.map(|(_, number)| number));
        if regions.len() == before {
            let fault = Fault::new(format!("There is no face \"{}\"", name.escape_debug()));
            return Err(match known().min() {
                Some((_, near)) => fault.remedy(format!("The nearest known name is \"{near}\"")),
                None => fault,
            });
        }
    }
    let mesh = made.mesh.of_faces(&regions);
    Ok(Background { mesh, ..made })
}

/// Whether a face is one of those that a region was divided into: "lid, part 2" of "lid".
fn is_part_of(face: &str, region: &str) -> bool {
    face.strip_prefix(region).is_some_and(|rest| rest.starts_with(", part "))
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
    let Background { mesh, sizing, names, adapted, repairs } = background(case, watch)?;
    let triangles = mesh.element_count();
    let (mesh, counts, last_resort, finished) = {
        let mut converter = Converter::new(mesh, &sizing, case.parameters.clone());
        drive(&mut converter, watch)?;
        (converter.mesh, converter.counts, converter.last_resort, converter.finished)
    };
    Ok(Converted { mesh, sizing, names, triangles, adapted, repairs, counts, last_resort, finished })
}

/// The background mesh of a domain of curves, in the plane or on surfaces; where the case bounds the gradation, a first mesh
/// carries the table of the bounded metric for the second. `own` are fields in place of the case's.
fn from_domain(
    case: &Case,
    domain: Domain,
    own: Option<Vec<Field>>,
    lines: Lines,
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
    let layered = layers::layered_curves(&domain, &case.parameters)?;
    let mut made = adapted_mesh(case, &domain, &sizing, watch)?;
    if let Some(beta) = case.gradation {
        sizing = Sizing::new(vec![bounded(&made.mesh, &sizing, beta)?], 1.0).on(atlas);
        made = adapted_mesh(case, &domain, &sizing, watch)?;
    }
    if let Some(curves) = layered {
        layers::offset_only(&mut made.mesh, &made.divided, &curves, case.parameters.layers);
    }
    let faces = domain.faces.iter().map(|face| Named::new(&face.name)).collect();
    // Of curves only those that carry lines of a file give their names to what is written.
    let on_line = |&(ends, curve): &([PointId; 2], u32)| Some((ends, lines.of_curve.get(curve as usize).copied()??));
    let sides = made.lines.iter().filter_map(on_line).collect();
    let names = Names::of_faces(faces).with_lines(lines.names, sides);
    Ok(Background { mesh: made.mesh, sizing, names, adapted: made.adapted, repairs: Vec::new() })
}

/// A mesh that was given: its triangles as they are (in the plane where nothing is said), or its shape (in space). The metric is that
/// of the case's fields; where there are none its own, given at its nodes or implied by its triangles.
fn from_mesh(
    case: &Case,
    path: &Path,
    sol: Option<&Path>,
    taking: &Taking,
    watch: &mut dyn Watch,
) -> Result<Background, Fault> {
    watch.tell(Stage::Read, 0, 0);
    let mut file = read_mesh_watched(path, sol, watch)?;
    taking.scale(&mut file);
    let place = path.display().to_string();
    if !is_plane(&file) || taking.used == Some(MeshUse::Shape) {
        return from_surface(case, &file, &place, taking, watch);
    }
    let imported = import(&file, case.split_odd).map_err(|fault| fault.at(place.clone()))?;
    let set = &imported.set;
    let mut fields = Vec::new();
    for spec in &case.fields {
        fields.push(Field::compile(spec, &|_| None)?);
    }
    // What the triangles themselves imply is sound, however thin they are.
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
        // The mesh stays as it is, so that its nodes and the middles of its triangles show what the metric will be asked for.
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
    let names = Names::of_faces(imported.regions).with_lines(imported.lines, imported.set.lines);
    Ok(Background { mesh, sizing, names, adapted: Adapted::default(), repairs: imported.repairs })
}

/// A mesh as a surface without CAD: its shape meshed anew, or its triangles as they are, chart by chart. Sizes are those of the
/// case's fields; where there are none those given at its points, or those that its triangles have. `place` is the file's name.
fn from_surface(
    case: &Case,
    file: &MeshFile,
    place: &str,
    taking: &Taking,
    watch: &mut dyn Watch,
) -> Result<Background, Fault> {
    // What the case says of sizes has a place of its own.
    let here = |fault: Fault| if fault.is_stop { fault } else { fault.at(place) };
    let Sound { mesh, copied, regions, lines, mut repairs } = sound(file, watch).map_err(here)?;
    let surface = surface(&mesh, &regions, taking.feature_angle, taking.bound(), watch).map_err(here)?;
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
            None => surface.table(&implied_sizes(&mesh)).map_err(here)?,
        });
    }
    let faces = surface.regions.clone();
    let lines = Lines { names: lines, of_curve: surface.lines.clone() };
    let made = if converts {
        from_laid_out(case, &mesh, &surface, fields, lines, &mut repairs)
    } else {
        from_domain(case, surface.domain, Some(fields), lines, watch)
    };
    let mut made = made.map_err(here)?;
    made.names.faces = faces;
    Ok(Background { repairs, ..made })
}

/// The triangles of a surface as they are, laid flat chart by chart.
fn from_laid_out(
    case: &Case,
    surface: &Triangles,
    laid: &Surface,
    fields: Vec<Field>,
    lines: Lines,
    repairs: &mut Vec<String>,
) -> Result<Background, Fault> {
    let (set, divided) = laid.triangles(surface, case.split_odd)?;
    match divided {
        0 => {}
        1 => repairs.push("1 side of a triangle was divided to make counts even".to_owned()),
        n => repairs.push(format!("{n} sides of triangles were divided to make counts even")),
    }
    let atlas = laid.domain.spatial.as_ref().map(|spatial| Arc::clone(&spatial.atlas));
    let ground = atlas.clone().map(|atlas| Arc::new(Ground { atlas, points: set.xyz.clone() }));
    let mut sizing = Sizing::new(fields, case.parameters.size_scale).on(atlas.clone());
    sizing.survey(&set.uv, &|_| false)?;
    let meshed = |sizing: &Sizing| -> Result<Mesh, Fault> {
        let metric = set.uv.iter().map(|&uv| sizing.metric(uv)).collect::<Result<_, _>>()?;
        let mut mesh = Mesh::from_triangles(&set, metric);
        if let Some(ground) = &ground {
            mesh.set_ground(Arc::clone(ground));
        }
        Ok(mesh.reordered())
    };
    let mut mesh = meshed(&sizing)?;
    if let Some(beta) = case.gradation {
        sizing = Sizing::new(vec![bounded(&mesh, &sizing, beta)?], 1.0).on(atlas);
        mesh = meshed(&sizing)?;
    }
    let names = Names::default().with_lines(lines.names, set.lines);
    Ok(Background { mesh, sizing, names, adapted: Adapted::default(), repairs: Vec::new() })
}

/// A small mesh that the case itself holds, as it is: nodes keep its numbers, and its quadrilaterals stand already.
fn from_elements(
    case: &Case,
    points: &[DVec2],
    triangles: &[[u32; 3]],
    quads: &[[u32; 4]],
) -> Result<Background, Fault> {
    if case.gradation.is_some() {
        return Err(Fault::new("The case has a background and bounds the gradation").remedy("Leave gradation out"));
    }
    for (i, q) in quads.iter().enumerate() {
        let [a, b, c, d] = q.map(|n| points[n as usize]);
        if !convex(a, b, c, d) {
            return Err(Fault::new(format!("quads[{i}] is not strictly convex and anticlockwise"))
                .remedy("Give the numbers of its points anticlockwise, and no corner of 180 degrees or more"));
        }
    }
    // Halved for the checks that triangle meshes go through; the halves are joined again afterwards.
    let halves = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let file = MeshFile {
        points: points.iter().map(|p| p.extend(0.0)).collect(),
        triangles: triangles.iter().copied().chain(halves).collect(),
        ..MeshFile::default()
    };
    let imported = import(&file, false)?;
    if let Some(repair) = imported.repairs.first() {
        return Err(Fault::new(format!("The background would have to be mended: {repair}"))
            .remedy("Write it as it shall be: nothing is mended in a mesh that a case holds"));
    }
    let set = &imported.set;
    let fields = case.fields.iter().map(|spec| Field::compile(spec, &|_| None)).collect::<Result<_, _>>()?;
    let sizing = Sizing::new(fields, case.parameters.size_scale);
    sizing.survey(&set.uv, &|_| false)?;
    let metric = set.uv.iter().map(|&uv| sizing.metric(uv)).collect::<Result<_, _>>()?;
    let mut mesh = Mesh::from_triangles(set, metric);
    for first in (triangles.len() as u32..set.triangles.len() as u32).step_by(2) {
        let [a, b, c] = mesh.triangle(ElementId(first));
        let [_, _, d] = mesh.triangle(ElementId(first + 1));
        mesh.replace(&[ElementId(first + 1), ElementId(first)], &[NewElement::quad([a, b, c, d], 0)]);
    }
    mesh.commit();
    let names = Names::of_faces(imported.regions);
    Ok(Background { mesh, sizing, names, adapted: Adapted::default(), repairs: Vec::new() })
}

/// The lines of a file that a domain was made from.
#[derive(Default)]
struct Lines {
    /// Their names by number.
    names: Vec<Named>,
    /// The line on which each curve of the domain lies, if on one.
    of_curve: Vec<Option<u32>>,
}

/// The background mesh of a domain.
struct AdaptedMesh {
    mesh: Mesh,
    adapted: Adapted,
    divided: DividedDomain,
    /// The sides along curves, by points and curve.
    lines: Vec<([PointId; 2], u32)>,
}

fn adapted_mesh(case: &Case, domain: &Domain, sizing: &Sizing, watch: &mut dyn Watch) -> Result<AdaptedMesh, Fault> {
    watch.tell(Stage::Triangulate, 0, 0);
    let (divided, set) = divide_and_triangulate(domain, sizing)?;
    let metric = set.uv.iter().map(|&uv| sizing.metric(uv)).collect::<Result<_, _>>()?;
    refuse_the_endless(&set, sizing, case.parameters.max_quads)?;
    watch.tell(Stage::Adapt, 0, 0);
    // A unit mesh has about 2.3 triangles for each quadrilateral that the metric asks for (spec 3).
    let most = usize::try_from(case.parameters.max_quads.saturating_mul(3)).unwrap_or(usize::MAX);
    let mut mesh = Mesh::from_triangles(&set, metric);
    if let Some(spatial) = &domain.spatial {
        mesh.set_ground(Arc::new(Ground { atlas: Arc::clone(&spatial.atlas), points: set.xyz }));
    }
    let (mesh, adapted) = adapt(mesh, sizing, most, watch)?;
    Ok(AdaptedMesh { mesh, adapted, divided, lines: set.lines })
}

/// Refuses sizes that ask for far more quadrilaterals than are allowed before any memory is spent on them. The count is the
/// metric area (spec 3), one place a triangle of the boundary's triangulation: rough, so that only what is beyond doubt is
/// refused here. The adaptation itself holds the bound.
fn refuse_the_endless(set: &TriangleSet, sizing: &Sizing, max_quads: u64) -> Result<(), Fault> {
    let mut quads = 0.0;
    for triangle in &set.triangles {
        let [a, b, c] = triangle.map(|n| set.uv[n as usize]);
        quads += triangle_area(&sizing.metric((a + b + c) / 3.0)?, a, b, c);
    }
    if quads <= 4.0 * max_quads as f64 {
        return Ok(());
    }
    Err(Fault::new(format!("The metric asks for about {quads:.1e} quadrilaterals, and max_quads is {max_quads}"))
        .remedy("Make the sizes larger, or allow more by max_quads"))
}

/// The field at the nodes of a mesh with its gradation bounded, as a table. Nodes at the same place (on curves between
/// faces, on both sides of cracks) are one node of it: bounded each for itself they would differ, and the metric along the
/// curve would be now that of one side, now that of the other, as rounding has it.
fn bounded(mesh: &Mesh, sizing: &Sizing, beta: f64) -> Result<Field, Fault> {
    let (points, place) = places(mesh);
    let mut metrics = points.iter().map(|&uv| sizing.metric3_at(uv)).collect::<Result<Vec<_>, _>>()?;
    let edges: Vec<[u32; 2]> =
        mesh.edges().map(|h| [mesh.origin(h), mesh.target(h)].map(|n| place[n.index()])).collect();
    let triangles: Vec<[u32; 3]> = mesh.elements().map(|e| mesh.triangle(e).map(|n| place[n.index()])).collect();
    let Some(ground) = mesh.ground() else {
        let in_space: Vec<_> = points.iter().map(|p| p.extend(0.0)).collect();
        bound_gradation(&in_space, &edges, &mut metrics, beta);
        return Field::table(&points, &triangles, metrics);
    };
    // On surfaces, places of different charts may be one point in space; the sizes spread over it from face to face.
    let mut space_of: Vec<u32> = vec![0; points.len()];
    let (mut in_space, mut shared): (Vec<DVec3>, Vec<Metric3>) = (Vec::new(), Vec::new());
    let mut of_point: Vec<Option<u32>> = vec![None; ground.points.len()];
    for node in mesh.nodes() {
        let here = place[node.index()] as usize;
        let known = mesh.point(node).and_then(|p| of_point[p.index()]);
        let number = known.unwrap_or_else(|| {
            in_space.push(mesh.xyz(node));
            shared.push(metrics[here]);
            in_space.len() as u32 - 1
        });
        if known.is_some() {
            let both = Metric3::intersect(&shared[number as usize], &metrics[here]);
            shared[number as usize] = both;
        }
        if let Some(point) = mesh.point(node) {
            of_point[point.index()] = Some(number);
        }
        space_of[here] = number;
    }
    let edges: Vec<[u32; 2]> = edges.iter().map(|e| e.map(|n| space_of[n as usize])).collect();
    bound_gradation(&in_space, &edges, &mut shared, beta);
    Field::table(&points, &triangles, space_of.iter().map(|&n| shared[n as usize]).collect())
}

/// The different places of a mesh's nodes in the order of the first node there, and which of them each node slot has.
fn places(mesh: &Mesh) -> (Vec<DVec2>, Vec<u32>) {
    let uv = |n: u32| mesh.uv(NodeId(n));
    let by_place = |a: &u32, b: &u32| uv(*a).x.total_cmp(&uv(*b).x).then(uv(*a).y.total_cmp(&uv(*b).y));
    let mut sorted: Vec<u32> = (0..mesh.node_slots() as u32).collect();
    sorted.sort_by(by_place);
    let mut first: Vec<u32> = vec![0; sorted.len()];
    for here in sorted.chunk_by(|a, b| by_place(a, b).is_eq()) {
        here.iter().for_each(|&n| first[n as usize] = here[0]);
    }
    let (mut points, mut place) = (Vec::new(), vec![0; first.len()]);
    for n in 0..first.len() {
        if first[n] as usize == n {
            place[n] = points.len() as u32;
            points.push(uv(n as u32));
        } else {
            place[n] = place[first[n] as usize];
        }
    }
    (points, place)
}

/// Refuses a background with a triangle so flat that rounding could invert what the last resort makes of it.
fn refuse_needles(mesh: &Mesh) -> Result<(), Fault> {
    for e in mesh.elements().filter(|&e| mesh.is_triangle(e)) {
        let [a, b, c] = mesh.triangle(e).map(|n| mesh.uv(n));
        if !firm(a, b, c) {
            return Err(Fault::new(format!(
                "A triangle of the background mesh is too flat to be converted: {a}, {b}, {c}"
            ))
            .remedy("Make the boundary there less thin, its segments shorter, or the sizes less stretched"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::core::progress::Nobody;

    /// Two squares side by side; the left one asks for small elements far from the line between them.
    const TWO_SQUARES: &str = r#"
        version = 1
        gradation = 1.2
        [[metric]]
        kind = "formula"
        h1 = "0.01 + 0.5 * abs(x + 0.8)"
        [[curve]]
        name = "left"
        kind = "polyline"
        points = [[0, 1], [-1, 1], [-1, 0], [0, 0]]
        [[curve]]
        name = "between"
        kind = "segment"
        from = [0, 0]
        to = [0, 1]
        [[curve]]
        name = "right"
        kind = "polyline"
        points = [[0, 0], [1, 0], [1, 1], [0, 1]]
        [[face]]
        name = "one"
        outer = ["left", "between"]
        [[face]]
        name = "other"
        outer = ["right", "between"]
    "#;

    #[test]
    fn bounded_sizes_are_the_same_on_both_sides_of_a_curve_between_faces() {
        let case = Case::parse(TWO_SQUARES, "two", "two.toml", Path::new("")).unwrap();
        let made = background(&case, &mut Nobody).unwrap();
        let size = |x: f64, y: f64| made.sizing.metric(DVec2::new(x, y)).unwrap().min_size();
        for k in 1..40 {
            let y = f64::from(k) / 40.0;
            let (one, other) = (size(-1e-9, y), size(1e-9, y));
            assert!((one / other - 1.0).abs() < 1e-6, "at y = {y}: {one} and {other}");
        }
    }
}
