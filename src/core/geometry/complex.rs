//! Faces on surfaces that share curves (paper 3.1; spec 2.9): each face gets a chart, each curve an image in the chart of
//! every face that it bounds, and all charts lie side by side in the plane of an [`Atlas`]. What comes out is a [`Domain`] of
//! that plane, which knows what its curves and vertices are in space.
//!
//! Here: which chart a face gets, and the whole surface as a face. How images are chained to loops is in `lifting`.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::assembly::{join_ends, loop_name, placed};
use super::atlas::Atlas;
use super::chart::{Chart, singular_edges};
use super::curve::Curve;
use super::domain::{CurveId, CurveKind, CurveShape, DirectedCurve, Domain, DomainCurve, Extent, FaceSpec, Spatial};
use super::ground::Ground;
use super::image::Image;
use super::lifting::{Lift, Piece};
use super::primitive::SurfaceShape;
use super::space_curve::{SpaceCurve, SpaceShape, told_xyz};
use super::surface::{EDGES, Edge, NurbsSurface};
use crate::core::fault::Fault;

/// Ends of curves in space nearer than this part of the size of all are one vertex.
const SAME_VERTEX: f64 = 1e-9;

/// What the names of the parts of a face end in that is divided between its poles.
const LOWER_HALF: &str = ", lower half";
const UPPER_HALF: &str = ", upper half";

/// A surface of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceSpec {
    /// Its name.
    pub name: String,
    /// Its shape.
    pub shape: SurfaceShape,
    /// Where it stands, for messages.
    pub place: String,
}

/// A curve of a case with surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceCurveSpec {
    /// Its name.
    pub name: String,
    /// Its shape.
    pub shape: SpaceShape,
    /// Number of segments where the case fixes it.
    pub segments: Option<u32>,
    /// Where it stands, for messages.
    pub place: String,
}

/// A face of a case with surfaces; without an outer loop it is all of its surface, but for the holes.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceFaceSpec {
    /// Its surface.
    pub surface: String,
    /// Its name and its curves.
    pub face: FaceSpec,
}

/// What [`build`] makes a domain of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ComplexSpec {
    /// All surfaces.
    pub surfaces: Vec<SurfaceSpec>,
    /// All curves.
    pub curves: Vec<SpaceCurveSpec>,
    /// All faces, at least one.
    pub faces: Vec<SurfaceFaceSpec>,
}

/// A named curve in space.
pub(in crate::core) struct Named {
    pub name: String,
    pub curve: Arc<SpaceCurve>,
    pub segments: Option<u32>,
    pub place: String,
    /// Vertices in space at its start and end.
    pub ends: [u32; 2],
}

/// A face, or a part of one that is too much for one chart.
struct Part {
    spec: FaceSpec,
    surface: Arc<NurbsSurface>,
    /// The singular edge about which its chart is to be drawn; `None`: that is to be found.
    about: Option<Edge>,
    /// The outer loop is the surface's own edge.
    natural: bool,
}

/// Builds the domain of faces on surfaces. Faces stand in it by name.
///
/// # Errors
/// Surfaces and curves that are none; names that are unknown, given twice or used wrongly; curves that do not lie on the
/// surface of their face, with the distance; loops that do not close on their surface; and what [`Domain::build`] refuses.
pub fn build(spec: &ComplexSpec) -> Result<Domain, Fault> {
    let surfaces = surfaces(spec)?;
    let find = |name: &str| surfaces.iter().find(|(known, _)| known == name).map(|(_, s)| Arc::clone(s));
    let mut curves: Vec<Named> = Vec::new();
    for given in &spec.curves {
        if curves.iter().any(|c| c.name == given.name) {
            let fault = Fault::new(format!("There are two curves \"{}\"", given.name)).remedy("Rename one of them");
            return Err(placed(fault, &given.place));
        }
        let curve = SpaceCurve::new(&given.shape, &find)
            .map_err(|fault| placed(fault.at(format!("curve \"{}\"", given.name)), &given.place))?;
        curves.push(Named {
            name: given.name.clone(),
            curve: Arc::new(curve),
            segments: given.segments,
            place: given.place.clone(),
            ends: [0; 2],
        });
    }
    let mut parts = Vec::new();
    let mut faces: Vec<&SurfaceFaceSpec> = spec.faces.iter().collect();
    faces.sort_by(|a, b| a.face.name.cmp(&b.face.name));
    if let Some(w) = faces.windows(2).find(|w| w[0].face.name == w[1].face.name) {
        let fault = Fault::new(format!("There are two faces \"{}\"", w[0].face.name)).remedy("Rename one of them");
        return Err(placed(fault, &w[1].face.place));
    }
    if faces.is_empty() {
        return Err(Fault::new("There is no face to mesh").remedy("Add a face"));
    }
    for face in faces {
        let surface = find(&face.surface).ok_or_else(|| {
            let what = format!("The face \"{}\" lies on \"{}\", which is not there", face.face.name, face.surface);
            placed(Fault::new(what).remedy("Add it as [[surface]]"), &face.face.place)
        })?;
        if face.face.outer.is_empty() {
            whole(&face.face, &surface, &mut curves, &mut parts);
        } else {
            parts.push(Part { spec: face.face.clone(), surface, about: None, natural: false });
        }
    }
    let vertices = join_in_space(&mut curves);
    let mut lifts = Vec::new();
    for part in &mut parts {
        lifts.push(lift(part, &curves)?);
    }
    share_holes(&mut parts, &mut lifts)?;
    let specs: Vec<FaceSpec> = parts.into_iter().map(|part| part.spec).collect();
    assemble(&curves, &vertices, &specs, lifts)
}

fn surfaces(spec: &ComplexSpec) -> Result<Vec<(String, Arc<NurbsSurface>)>, Fault> {
    let mut surfaces: Vec<(String, Arc<NurbsSurface>)> = Vec::new();
    // Curves in space, for surfaces that are swept; curves on surfaces come after those.
    let swept = |name: &str| {
        let given = spec.curves.iter().find(|c| c.name == name)?;
        SpaceCurve::new(&given.shape, &|_| None).ok()
    };
    for given in &spec.surfaces {
        if surfaces.iter().any(|(name, _)| *name == given.name) {
            let fault = Fault::new(format!("There are two surfaces \"{}\"", given.name)).remedy("Rename one of them");
            return Err(placed(fault, &given.place));
        }
        let surface = given
            .shape
            .surface(&swept)
            .map_err(|fault| placed(fault.at(format!("surface \"{}\"", given.name)), &given.place))?;
        surfaces.push((given.name.clone(), Arc::new(surface)));
    }
    Ok(surfaces)
}

/// The whole of a surface as a face: its own edges as curves (called "face: v0" and so on by the edge's parameter), seams
/// twice in the loop. Between two poles it is divided in the middle; from an apex that is no pole run two more lines besides the
/// seam, since fewer than three edges at a node inside a mesh are too few.
fn whole(face: &FaceSpec, surface: &Arc<NurbsSurface>, curves: &mut Vec<Named>, parts: &mut Vec<Part>) {
    let domain = surface.domain();
    let (closed, degenerate) = (surface.closed(), surface.degenerate());
    let mut add = |name: String, from: DVec2, to: DVec2| {
        let name = format!("{}: {name}", face.name);
        if !curves.iter().any(|c| c.name == name) {
            let trim = Curve::new(&CurveShape::Segment { from, to }).expect("an edge has a length");
            curves.push(Named {
                name: name.clone(),
                curve: Arc::new(SpaceCurve::on(Arc::clone(surface), trim)),
                segments: None,
                place: face.place.clone(),
                ends: [0; 2],
            });
        }
        name
    };
    let singular = |edge: Edge| EDGES.iter().zip(degenerate).any(|(e, is)| *e == edge && is);
    let place = |axis: usize, value: f64, along: f64| {
        if axis == 0 { DVec2::new(value, along) } else { DVec2::new(along, value) }
    };
    // The axis whose two edges are both singular, if there is one: the surface is divided in its middle.
    let poles = [0, 1].into_iter().find(|&axis| [false, true].into_iter().all(|last| singular(Edge { axis, last })));
    // Each part: what it covers, its name, and about which singular edge its chart is drawn.
    let halves: Vec<([[f64; 2]; 2], &str, Option<Edge>)> = match poles {
        None => vec![(domain, "", singular_edges(surface).first().copied())],
        Some(axis) => {
            let [first, last] = domain[axis];
            let middle = 0.5 * (first + last);
            let half = |range: [f64; 2]| {
                let mut half = domain;
                half[axis] = range;
                half
            };
            vec![
                (half([first, middle]), LOWER_HALF, Some(Edge { axis, last: false })),
                (half([middle, last]), UPPER_HALF, Some(Edge { axis, last: true })),
            ]
        }
    };
    for (half, suffix, about) in halves {
        let disc = about.is_some_and(|edge| Chart::about(Arc::clone(surface), edge).is_disc());
        let mut spec = face.clone();
        spec.name = format!("{}{suffix}", face.name);
        // From an apex that is no pole lines run at the thirds of what closes around it.
        let thirds = about.filter(|about| closed[1 - about.axis] && !disc).map(|about| about.axis);
        for edge in EDGES {
            let Edge { axis, last } = edge;
            let letter = ["u", "v"][axis];
            let value = half[axis][usize::from(last)];
            let outermost = value == domain[axis][usize::from(last)];
            // The sides of a disc are one another.
            if (outermost && singular(edge)) || (disc && about.is_some_and(|about| about.axis != axis)) {
                continue;
            }
            let (name, value) = match (outermost, closed[axis]) {
                (false, _) => (format!("{letter} middle"), value),
                // The last edge of a closed axis is its first: the seam, which stands twice in the loop.
                (true, true) => (format!("{letter}0{suffix}"), domain[axis][0]),
                (true, false) => (format!("{letter}{}{suffix}", u8::from(last)), value),
            };
            let [a, b] = half[1 - axis];
            if thirds != Some(axis) {
                spec.outer.push(add(name, place(axis, value, a), place(axis, value, b)));
                continue;
            }
            let at = |third: u8| if third == 3 { b } else { a + (b - a) * f64::from(third) / 3.0 };
            for third in 1..=3 {
                let (from, to) = (place(axis, value, at(third - 1)), place(axis, value, at(third)));
                spec.outer.push(add(format!("{name}, {third}/3"), from, to));
            }
            for third in 1..=2 {
                let [a, b] = half[axis];
                let (from, to) = (place(axis, a, at(third)), place(axis, b, at(third)));
                spec.repeated.push(add(format!("{} {third}/3{suffix}", ["u", "v"][1 - axis]), from, to));
            }
        }
        parts.push(Part { spec, surface: Arc::clone(surface), about, natural: true });
    }
}

/// Joins ends of curves in space into vertices; ends that were given as numbers come first, theirs is the place.
fn join_in_space(curves: &mut [Named]) -> Vec<DVec3> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in curves.iter().flat_map(|c| c.curve.polyline()) {
        (low, high) = (low.min(p), high.max(p));
    }
    let tolerance = SAME_VERTEX * (high - low).max_element();
    let mut ends: Vec<(bool, usize, usize, DVec3)> = Vec::new();
    for (i, c) in curves.iter().enumerate() {
        for which in 0..2 {
            ends.push((!c.curve.ends_given(), i, which, c.curve.point(which as f64)));
        }
    }
    ends.sort_by_key(|e| (e.0, e.1, e.2));
    // Cells of a grid wider than the tolerance; the neighbours of a cell are looked into too.
    let cell = |p: DVec3| {
        let q = ((p - low) / (8.0 * tolerance.max(f64::MIN_POSITIVE))).floor();
        [q.x as i64, q.y as i64, q.z as i64]
    };
    let mut grid: FxHashMap<[i64; 3], Vec<u32>> = FxHashMap::default();
    let mut vertices: Vec<DVec3> = Vec::new();
    for (_, i, which, p) in ends {
        let mut known: Option<u32> = None;
        let home = cell(p);
        for k in 0..27_i64 {
            let near = [home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1];
            for &v in grid.get(&near).into_iter().flatten() {
                if vertices[v as usize].distance(p) <= tolerance && known.is_none_or(|known| v < known) {
                    known = Some(v);
                }
            }
        }
        curves[i].ends[which] = known.unwrap_or_else(|| {
            vertices.push(p);
            grid.entry(home).or_default().push(vertices.len() as u32 - 1);
            vertices.len() as u32 - 1
        });
    }
    vertices
}

/// A face in its chart: the images of its curves, chained.
pub(in crate::core) struct Lifted {
    pub ground: Ground,
    /// Outer loop, holes.
    pub loops: Vec<Vec<Piece>>,
    pub cracks: Vec<Piece>,
    pub repeated: Vec<Piece>,
}

/// Finds the chart of a face and the images of its curves there.
fn lift(part: &Part, curves: &[Named]) -> Result<Lifted, Fault> {
    let spec = &part.spec;
    let find = |name: &String| {
        curves.iter().position(|c| c.name == *name).ok_or_else(|| {
            let what = format!("The face \"{}\" names the curve \"{name}\", which is not there", spec.name);
            let nearest = curves.iter().map(|c| (strsim::damerau_levenshtein(name, &c.name), &c.name)).min();
            let fault = Fault::new(what);
            placed(
                match nearest {
                    Some((_, near)) => fault.remedy(format!("The nearest known name is \"{near}\"")),
                    None => fault.remedy("The case has no curves"),
                },
                &spec.place,
            )
        })
    };
    let numbers = |names: &[String]| names.iter().map(find).collect::<Result<Vec<_>, _>>();
    let outer = numbers(&spec.outer)?;
    let charts = match part.about {
        Some(edge) => vec![Chart::about(Arc::clone(&part.surface), edge)],
        None if part.natural => vec![Chart::sheet(Arc::clone(&part.surface))],
        None => charts_for(&part.surface, &outer, curves),
    };
    let mut refusal: Option<Fault> = None;
    for chart in charts {
        let chart = Arc::new(chart);
        let mut lift = Lift::new(&chart, curves, &spec.name);
        let found = lift.chain(&outer, &loop_name(spec, 0));
        let outer = match found {
            Ok(outer) => outer,
            Err(fault) => {
                refusal.get_or_insert(fault);
                continue;
            }
        };
        let around = lift.polygon(&outer);
        let mut loops = vec![outer];
        for (i, hole) in spec.holes.iter().enumerate() {
            let chained = lift.chain(&numbers(hole)?, &loop_name(spec, i + 1)).map_err(|f| placed(f, &spec.place))?;
            loops.push(lift.brought_inside(chained, &around));
        }
        let mut lines = |names: &[String]| -> Result<Vec<Piece>, Fault> {
            numbers(names)?
                .into_iter()
                .map(|curve| {
                    let piece = lift.single(curve).map_err(|f| placed(f, &spec.place))?;
                    Ok(lift.brought_inside(vec![piece], &around).remove(0))
                })
                .collect()
        };
        let (cracks, repeated) = (lines(&spec.cracks)?, lines(&spec.repeated)?);
        return Ok(Lifted { ground: Ground::Chart(chart), loops, cracks, repeated });
    }
    Err(placed(refusal.unwrap_or_else(|| Fault::new(format!("The face \"{}\" has no chart", spec.name))), &spec.place))
}

/// Charts in which a face with these outer curves may lie: about the singular point that is nearest to them, then the
/// others; the parametric plane where there is none, or last.
fn charts_for(surface: &Arc<NurbsSurface>, outer: &[usize], curves: &[Named]) -> Vec<Chart> {
    let points: Vec<DVec3> = outer.iter().flat_map(|&c| curves[c].curve.polyline()).collect();
    let domain = surface.domain();
    let mut edges: Vec<(f64, Edge)> = singular_edges(surface)
        .into_iter()
        .map(|edge| {
            let (value, along) = (domain[edge.axis][usize::from(edge.last)], domain[1 - edge.axis][0]);
            let uv = if edge.axis == 0 { DVec2::new(value, along) } else { DVec2::new(along, value) };
            let apex = surface.at(uv, 1).p;
            (points.iter().map(|p| p.distance(apex)).fold(f64::INFINITY, f64::min), edge)
        })
        .collect();
    edges.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut charts: Vec<Chart> = edges.into_iter().map(|(_, edge)| Chart::about(Arc::clone(surface), edge)).collect();
    charts.push(Chart::sheet(Arc::clone(surface)));
    charts
}

/// Where a whole surface was divided into halves, each hole and line belongs to the half in which it lies.
fn share_holes(parts: &mut [Part], lifts: &mut [Lifted]) -> Result<(), Fault> {
    for (part, lifted) in parts.iter_mut().zip(lifts.iter_mut()) {
        let halved = part.natural && [LOWER_HALF, UPPER_HALF].iter().any(|half| part.spec.name.ends_with(half));
        if !halved {
            continue;
        }
        let around = Lift::polygon_of(&lifted.loops[0]);
        let inside = |piece: &Piece| {
            let places: Vec<DVec2> = piece.image.places().collect();
            let within = places.iter().filter(|p| Lift::holds(&around, **p)).count();
            (within > 0, within < places.len())
        };
        let mut crossing: Option<String> = None;
        let mut keep = |pieces: &[Piece]| {
            let judged: Vec<(bool, bool)> = pieces.iter().map(inside).collect();
            let (any_in, any_out) = (judged.iter().any(|j| j.0), judged.iter().any(|j| j.1));
            if any_in && any_out {
                crossing = Some(part.spec.name.clone());
            }
            any_in
        };
        let kept: Vec<bool> = lifted.loops.iter().enumerate().map(|(i, pieces)| i == 0 || keep(pieces)).collect();
        let mut number = 0;
        part.spec.holes.retain(|_| {
            number += 1;
            kept[number]
        });
        let mut number = 0;
        lifted.loops.retain(|_| {
            number += 1;
            kept[number - 1]
        });
        lifted.cracks.retain(|piece| keep(std::slice::from_ref(piece)));
        lifted.repeated.retain(|piece| keep(std::slice::from_ref(piece)));
        if let Some(name) = crossing {
            let fault =
                Fault::new(format!("A hole or line crosses the line at which the surface is divided (\"{name}\")"))
                    .remedy("Turn the surface's axis, so that the line between its poles lies elsewhere");
            return Err(placed(fault, &part.spec.place));
        }
    }
    Ok(())
}

/// Puts the lifted faces side by side and makes the domain of them.
pub(in crate::core) fn assemble(
    curves: &[Named],
    vertices: &[DVec3],
    specs: &[FaceSpec],
    lifts: Vec<Lifted>,
) -> Result<Domain, Fault> {
    let bounds: Vec<[DVec2; 2]> = lifts
        .iter()
        .map(|lifted| {
            let places = lifted.loops.iter().flatten().flat_map(|piece| piece.image.places());
            places.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)])
        })
        .collect();
    let atlas = Arc::new(Atlas::new(lifts.iter().map(|l| l.ground.clone()).collect(), &bounds));
    // Every piece by curve, then by face, so that the images of one curve stand together.
    let mut pieces: Vec<(usize, usize, Option<(usize, usize)>, CurveKind, Piece)> = Vec::new();
    for (f, lifted) in lifts.into_iter().enumerate() {
        for (i, chain) in lifted.loops.into_iter().enumerate() {
            for (k, piece) in chain.into_iter().enumerate() {
                pieces.push((piece.curve, f, Some((i, k)), CurveKind::Boundary, piece));
            }
        }
        pieces.extend(lifted.cracks.into_iter().map(|p| (p.curve, f, None, CurveKind::Crack, p)));
        pieces.extend(lifted.repeated.into_iter().map(|p| (p.curve, f, None, CurveKind::Repeated, p)));
    }
    pieces.sort_by_key(|p| (p.0, p.1, p.2));
    let mut chains: Vec<Vec<Vec<DirectedCurve>>> = vec![Vec::new(); specs.len()];
    let mut places: Vec<(usize, usize, usize, DirectedCurve)> = Vec::new();
    let mut domain_curves: Vec<DomainCurve> = Vec::new();
    let mut space: Vec<Arc<SpaceCurve>> = Vec::new();
    let mut last: Option<(usize, CurveId)> = None;
    for (c, f, at, kind, piece) in pieces {
        let id = CurveId(domain_curves.len() as u32);
        let first = match last {
            Some((known, first)) if known == c => first,
            _ => id,
        };
        last = Some((c, first));
        let named = &curves[c];
        let image = Arc::new(piece.image.moved(atlas.offset(f)));
        let internal = (kind != CurveKind::Boundary).then_some(f as u32);
        domain_curves.push(DomainCurve {
            name: named.name.clone(),
            curve: Curve::of_image(image),
            segments: named.segments,
            place: named.place.clone(),
            ends: [0; 2],
            sides: [internal; 2],
            kind,
            fine: Vec::new(),
            first,
        });
        space.push(Arc::clone(&named.curve));
        if let Some((i, k)) = at {
            places.push((f, i, k, DirectedCurve { curve: id, forward: piece.forward }));
        }
    }
    places.sort_by_key(|p| (p.0, p.1, p.2));
    for (f, i, _, step) in places {
        let loops = &mut chains[f];
        if loops.len() <= i {
            loops.resize(i + 1, Vec::new());
        }
        loops[i].push(step);
    }
    let extent = Extent::of(&domain_curves)?;
    let plane = join_ends(&mut domain_curves, extent.size, extent.tolerance)?;
    let mut vertex_of = vec![u32::MAX; plane.len()];
    for curve in &domain_curves {
        let named = curves.iter().find(|c| c.name == curve.name).expect("images are of named curves");
        for (own, in_space) in curve.ends.iter().zip(named.ends) {
            let known = &mut vertex_of[*own as usize];
            if *known != u32::MAX && *known != in_space {
                let [a, b] = [*known, in_space].map(|v| told_xyz(vertices[v as usize]));
                let fault =
                    Fault::new(format!("The ends of curves at {a} and {b} come to one place of a face's chart"))
                        .remedy("Let them meet, or move them apart");
                return Err(placed(fault, &curve.place));
            }
            *known = in_space;
        }
    }
    let mut domain = Domain::assemble(domain_curves, plane, chains, specs, extent)?;
    domain.spatial = Some(Arc::new(Spatial {
        atlas,
        vertices: vertices.to_vec(),
        vertex_of,
        curves: space,
        polylines: curves.iter().map(|c| (c.name.clone(), c.curve.polyline())).collect(),
    }));
    Ok(domain)
}

/// An image of a curve in a chart on some sheet; see [`Lift`].
pub(super) fn image_on(chart: &Arc<Chart>, named: &Named, move_by: DVec2, face: &str) -> Result<Image, Fault> {
    if let Some((surface, trim)) = named.curve.trim()
        && Arc::ptr_eq(surface, chart.surface())
    {
        return Ok(Image::of_trim(chart, &named.curve, trim, move_by));
    }
    let (start, off) = chart.locate(named.curve.point(0.0));
    let refuse = |distance: f64, at: DVec3| {
        let what = format!("The curve \"{}\" does not lie on the surface of the face \"{face}\"", named.name);
        let fault = Fault::new(format!("{what}: it is {} away", super::place::number(distance)))
            .at(format!("at {}", told_xyz(at)))
            .remedy("Mend the curve, or name another one");
        placed(fault, &named.place)
    };
    if off > super::image::ON_SURFACE * chart.surface().size() {
        return Err(refuse(off, named.curve.point(0.0)));
    }
    let guess = if move_by == DVec2::ZERO { start } else { chart.from_uv(chart.uv(start) + move_by) };
    Image::projected(chart, &named.curve, guess).map_err(|off| refuse(off.distance, off.at))
}
