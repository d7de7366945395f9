//! Faces on surfaces that share curves (paper 3.1; docs/algorithm.md, "Charts and the atlas", "Curves shared by
//! faces"): each face gets a chart, each curve an image in the chart of every face that it bounds, and all charts lie
//! side by side in the plane of an [`Atlas`]. The result is a [`Domain`] of that plane, with the geometry of its curves
//! and vertices in space.
//!
//! This module chooses the chart of each face and places the charts side by side. `lifting` chains images into loops,
//! `whole_surface` makes a face of a surface without loops.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::assembly::{join_equal_ends, join_images, loop_name, no_face, placed, refine, second, unknown_curve};
use super::atlas::Atlas;
use super::chart::Chart;
use super::course::Course;
use super::domain::{Borders, Domain, Extent, Spatial};
use super::domain_curve::{CurveId, CurveKind, DirectedCurve, DomainCurve};
use super::face_surface::FaceSurface;
use super::lifting::{Lift, Lifted, Piece, charts_for};
use super::named_curve::NamedCurve;
use super::oriented::{self, Bounded};
use super::space_curve::SpaceCurve;
use super::spec::{ComplexSpec, FaceSpec, SurfaceFaceSpec};
use super::surface::NurbsSurface;
use super::whole_surface::{FacePart, whole};
use crate::core::fault::Fault;
use crate::core::kernel::box_tree::extent;

/// Ends of curves in space closer than this fraction of the total size are one vertex.
const SAME_VERTEX: f64 = 1e-9;

/// Builds the domain of faces on surfaces; its faces are sorted by name.
///
/// # Errors
/// Invalid surfaces and curves; names that are unknown, given twice or used wrongly; curves that do not lie on the
/// surface of their face, with the distance; loops that do not close on their surface; and what [`Domain::build`]
/// refuses.
pub fn build(spec: &ComplexSpec) -> Result<Domain, Fault> {
    let surfaces = surfaces(spec)?;
    let find = |name: &str| surfaces.iter().find(|(known, _)| known == name).map(|(_, s)| Arc::clone(s));
    let mut curves: Vec<NamedCurve> = Vec::new();
    for given in &spec.curves {
        if curves.iter().any(|c| c.name == given.name) {
            return Err(second("curve", &given.name, &given.place));
        }
        let curve = SpaceCurve::new(&given.shape, &find)
            .map_err(|fault| placed(fault.at(format!("curve \"{}\"", given.name)), &given.place))?;
        curves.push(NamedCurve {
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
        return Err(second("face", &w[0].face.name, &w[1].face.place));
    }
    if faces.is_empty() {
        return Err(no_face("Add a face"));
    }
    for face in faces {
        let surface = find(&face.surface).ok_or_else(|| {
            let what = format!("The face \"{}\" lies on \"{}\", which does not exist", face.face.name, face.surface);
            placed(Fault::new(what).remedy("Add it as [[surface]]"), &face.face.place)
        })?;
        let part = |spec, lifted| FacePart {
            spec,
            surface: Arc::clone(&surface),
            reversed: face.reversed,
            lifted,
            about: None,
            whole: false,
            half: None,
        };
        if !face.loops.is_empty() {
            match oriented::lift(face, &surface, &mut curves, spec.tolerance)? {
                Bounded::Face(lifted) => {
                    let repeated = lifted.repeated.iter().map(|piece| curves[piece.curve].name.clone()).collect();
                    parts.push(part(FaceSpec { repeated, ..face.face.clone() }, Some(lifted)));
                }
                Bounded::AllBut(holes) => {
                    whole(&FaceSpec { holes, ..face.face.clone() }, &surface, face.reversed, &mut curves, &mut parts);
                }
            }
        } else if face.face.outer.is_empty() {
            whole(&face.face, &surface, face.reversed, &mut curves, &mut parts);
        } else {
            parts.push(part(face.face.clone(), None));
        }
    }
    let vertices = join_in_space(&mut curves, spec.tolerance);
    let mut lifts = Vec::new();
    for part in &mut parts {
        keep_own(part, &curves)?;
        lifts.push(match part.lifted.take() {
            Some(lifted) => lifted,
            None => lift(part, &curves, spec.tolerance)?,
        });
    }
    let specs: Vec<FaceSpec> = parts.into_iter().map(|part| part.spec).collect();
    assemble(&curves, &vertices, &specs, lifts, spec.tolerance)
}

fn surfaces(spec: &ComplexSpec) -> Result<Vec<(String, Arc<NurbsSurface>)>, Fault> {
    let mut surfaces: Vec<(String, Arc<NurbsSurface>)> = Vec::new();
    // Swept surfaces may use curves in space only: curves on surfaces are built later.
    let swept = |name: &str| {
        let given = spec.curves.iter().find(|c| c.name == name)?;
        SpaceCurve::new(&given.shape, &|_| None).ok()
    };
    for given in &spec.surfaces {
        if surfaces.iter().any(|(name, _)| *name == given.name) {
            return Err(second("surface", &given.name, &given.place));
        }
        let surface = given
            .shape
            .surface(&swept)
            .map_err(|fault| placed(fault.at(format!("surface \"{}\"", given.name)), &given.place))?;
        surfaces.push((given.name.clone(), Arc::new(surface)));
    }
    Ok(surfaces)
}

/// Merges ends of curves in space into vertices; ends given by coordinates come first, and their coordinates are kept.
fn join_in_space(curves: &mut [NamedCurve], tolerance: Option<f64>) -> Vec<DVec3> {
    let (low, high) = extent(curves.iter().flat_map(|c| c.curve.polyline()));
    let tolerance = tolerance.unwrap_or(0.0).max(SAME_VERTEX * (high - low).max_element());
    let mut ends: Vec<(bool, usize, usize, DVec3)> = Vec::new();
    for (i, c) in curves.iter().enumerate() {
        ends.extend([0, 1].map(|which| (!c.curve.ends_given(), i, which, c.curve.point(which as f64))));
    }
    ends.sort_by_key(|e| (e.0, e.1, e.2));
    // A grid with cells wider than the tolerance, so that the search visits a cell and its neighbours.
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

/// Finds the chart of a face and the images of its curves there.
fn lift(part: &FacePart, curves: &[NamedCurve], tolerance: Option<f64>) -> Result<Lifted, Fault> {
    let spec = &part.spec;
    let find = |name: &String| {
        let known = || curves.iter().map(|c| c.name.as_str());
        known().position(|known| known == name).ok_or_else(|| unknown_curve(spec, name, known()))
    };
    let numbers = |names: &[String]| names.iter().map(find).collect::<Result<Vec<_>, _>>();
    let outer = numbers(&spec.outer)?;
    let charts = match part.about {
        Some(edge) => vec![Chart::about(Arc::clone(&part.surface), edge, part.reversed)],
        None if part.whole => vec![Chart::sheet(Arc::clone(&part.surface), part.reversed)],
        None => charts_for(&part.surface, &outer, part.reversed, curves),
    };
    let mut refusal: Option<Fault> = None;
    for chart in charts {
        let chart = Arc::new(chart);
        let mut lift = Lift::new(&chart, curves, &spec.name, tolerance);
        let found = lift.chain(&outer, &loop_name(&spec.name, 0));
        let outer = match found {
            Ok(outer) => outer,
            Err(fault) => {
                refusal.get_or_insert(fault);
                continue;
            }
        };
        let around = Lift::polygon(&outer);
        let mut loops = vec![outer];
        for (i, hole) in spec.holes.iter().enumerate() {
            let chained =
                lift.chain(&numbers(hole)?, &loop_name(&spec.name, i + 1)).map_err(|f| placed(f, &spec.place))?;
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
        return Ok(Lifted { surface: FaceSurface::Chart(chart), loops, cracks, repeated });
    }
    Err(placed(refusal.unwrap_or_else(|| Fault::new(format!("The face \"{}\" has no chart", spec.name))), &spec.place))
}

/// Assigns holes and lines of a whole surface that is divided between its poles to the half in which they lie.
fn keep_own(part: &mut FacePart, curves: &[NamedCurve]) -> Result<(), Fault> {
    let Some((axis, [first, last])) = part.half else { return Ok(()) };
    let chart = Chart::sheet(Arc::clone(&part.surface), part.reversed);
    let margin = 1e-9 * (last - first);
    let mut crossing: Option<String> = None;
    let mut is_own = |names: &[String]| {
        let named = names.iter().filter_map(|name| curves.iter().find(|c| c.name == *name));
        let points: Vec<DVec3> = named.flat_map(|c| c.curve.polyline()).collect();
        let along = points.iter().map(|p| chart.uv(chart.locate(*p).0)[axis]);
        let (mut inside, mut outside) = (false, false);
        for t in along {
            inside |= t > first + margin && t < last - margin;
            outside |= t < first - margin || t > last + margin;
        }
        if inside && outside {
            crossing = names.first().cloned();
        }
        inside || !outside
    };
    let mut spec = part.spec.clone();
    spec.holes.retain(|hole| is_own(hole));
    spec.cracks.retain(|line| is_own(std::slice::from_ref(line)));
    spec.repeated.retain(|line| is_own(std::slice::from_ref(line)));
    part.spec = spec;
    let Some(name) = crossing else { return Ok(()) };
    let fault = Fault::new(format!("The curve \"{name}\" crosses the line that divides its surface between the poles"))
        .remedy("Rotate the axis of the surface to move this line, or give the face an outer loop");
    Err(placed(fault, &part.spec.place))
}

/// An image with its curve, its face, its position in a loop (the loop and the index in it) and its kind.
type PlacedImage = (usize, usize, Option<(usize, usize)>, CurveKind, Piece);

/// Places the lifted faces side by side and makes a domain of them.
pub(in crate::core) fn assemble(
    curves: &[NamedCurve],
    vertices: &[DVec3],
    specs: &[FaceSpec],
    lifts: Vec<Lifted>,
    tolerance: Option<f64>,
) -> Result<Domain, Fault> {
    let bounds: Vec<[DVec2; 2]> = lifts
        .iter()
        .map(|lifted| extent(lifted.loops.iter().flatten().flat_map(|piece| piece.image.points())).into())
        .collect();
    let atlas = Arc::new(Atlas::new(lifts.iter().map(|l| l.surface.clone()).collect(), &bounds));
    // All pieces sorted by curve, then by face, so that the images of one curve are consecutive.
    let mut pieces: Vec<PlacedImage> = Vec::new();
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
    // The curve in space of each image.
    let mut numbers: Vec<usize> = Vec::new();
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
            curve: Course::of_image(image),
            segments: named.segments,
            place: named.place.clone(),
            ends: [0; 2],
            sides: [internal; 2],
            kind,
            fine: Vec::new(),
            first,
            turning: None,
        });
        numbers.push(c);
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
    let extent = Extent::of(&domain_curves)?.within(tolerance)?;
    let is_embedded = atlas.charts().iter().all(|chart| matches!(chart, FaceSurface::Facets(_)));
    let (plane, borders) = if is_embedded {
        (join_equal_ends(&mut domain_curves), Borders::Embedded)
    } else {
        let in_space = |k: usize| curves[numbers[k]].ends;
        let widest = bounds.iter().map(|[low, high]| (*high - *low).max_element()).fold(0.0, f64::max);
        let joined = join_images(&mut domain_curves, &in_space, &atlas, tolerance);
        refine(&mut domain_curves, &joined, widest, extent.tolerance)?;
        (joined, Borders::Unchecked)
    };
    let mut vertex_of = vec![u32::MAX; plane.len()];
    for (curve, &number) in domain_curves.iter().zip(&numbers) {
        for (own, in_space) in curve.ends.iter().zip(curves[number].ends) {
            vertex_of[*own as usize] = in_space;
        }
    }
    let mut domain = Domain::assemble(domain_curves, plane, chains, specs, extent, borders)?;
    domain.spatial = Some(Arc::new(Spatial {
        atlas,
        vertices: vertices.to_vec(),
        vertex_of,
        curves: numbers.iter().map(|&number| Arc::clone(&curves[number].curve)).collect(),
        polylines: curves.iter().map(|c| (c.name.clone(), c.curve.polyline())).collect(),
    }));
    Ok(domain)
}
