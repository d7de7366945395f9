//! From the specifications in a case to curves that meet at vertices.

use glam::DVec2;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::atlas::Atlas;
use super::course::Course;
use super::curve::Curve;
use super::domain_curve::{CurveId, CurveKind, DomainCurve};
use super::spec::{CurveSpec, FaceSpec};
use crate::core::fault::Fault;
use crate::core::kernel::decimal::point_text;
use crate::core::kernel::spelling::suggestion;

/// The name of loop `i` of a face in messages: 0 is the outer loop.
pub fn loop_name(face: &str, i: usize) -> String {
    if i == 0 { format!("outer loop of \"{face}\"") } else { format!("hole {i} of \"{face}\"") }
}

/// A fault with the place in the case that it is about, if that is known.
pub fn placed(fault: Fault, place: &str) -> Fault {
    if place.is_empty() { fault } else { fault.at(place) }
}

/// The fault of a second `kind` ("curve", "face") with the same name.
pub(super) fn second(kind: &str, name: &str, place: &str) -> Fault {
    placed(Fault::new(format!("There are two {kind}s \"{name}\"")), place).remedy("Rename one of them")
}

/// The fault of a face that names an unknown curve.
pub(super) fn unknown_curve<'a>(face: &FaceSpec, name: &str, known: impl Iterator<Item = &'a str>) -> Fault {
    let fault = Fault::new(format!("The face \"{}\" names the curve \"{name}\", which does not exist", face.name));
    let remedy = suggestion(name, known).unwrap_or_else(|| "Add the curve, or name another one".to_owned());
    placed(fault.remedy(remedy), &face.place)
}

/// The fault of a case without faces.
pub(super) fn no_face(remedy: &str) -> Fault {
    Fault::new("There is no face to mesh").remedy(remedy)
}

/// The curves of each loop of a face: the outer one, then the holes.
pub type Lists = Vec<Vec<CurveId>>;

/// Resolves the names in the faces and builds the curves that they use, in the order of the case.
///
/// # Errors
/// Names that are unknown, given twice or used wrongly, and invalid curves.
pub fn resolve(specs: &[CurveSpec], faces: &[FaceSpec]) -> Result<(Vec<DomainCurve>, Vec<Lists>), Fault> {
    let mut by_name: FxHashMap<&str, usize> = FxHashMap::default();
    for (i, spec) in specs.iter().enumerate() {
        if by_name.insert(&spec.name, i).is_some() {
            return Err(second("curve", &spec.name, &spec.place));
        }
    }
    if faces.is_empty() {
        return Err(no_face("Add a face with an outer loop"));
    }
    for (i, face) in faces.iter().enumerate() {
        if faces[..i].iter().any(|f| f.name == face.name) {
            return Err(second("face", &face.name, &face.place));
        }
    }
    for face in faces {
        if let Some(i) = std::iter::once(&face.outer).chain(&face.holes).position(Vec::is_empty) {
            let what = format!("The {} has no curves", loop_name(&face.name, i));
            return Err(placed(Fault::new(what).remedy("Name the curves of a closed loop"), &face.place));
        }
    }
    // How each curve is used: its kind, and for an internal line the face.
    let mut used: Vec<Option<(CurveKind, u32)>> = vec![None; specs.len()];
    let mut loops_by_spec: Vec<Vec<Vec<usize>>> = Vec::new();
    for (f, face) in faces.iter().enumerate() {
        let mut claim = |name: &String, kind: CurveKind| -> Result<usize, Fault> {
            let known = || specs.iter().map(|spec| spec.name.as_str());
            let i = *by_name.get(name.as_str()).ok_or_else(|| unknown_curve(face, name, known()))?;
            match used[i] {
                Some((CurveKind::Boundary, _)) if kind == CurveKind::Boundary => {}
                Some(_) => {
                    let what =
                        format!("The curve \"{name}\" is a crack or a repeated line, and is listed a second time");
                    return Err(placed(Fault::new(what), &face.place).remedy("Name it in one list only"));
                }
                None => used[i] = Some((kind, f as u32)),
            }
            Ok(i)
        };
        let mut of_face = Vec::new();
        for list in std::iter::once(&face.outer).chain(&face.holes) {
            of_face.push(list.iter().map(|name| claim(name, CurveKind::Boundary)).collect::<Result<Vec<_>, _>>()?);
        }
        for name in &face.cracks {
            claim(name, CurveKind::Crack)?;
        }
        for name in &face.repeated {
            claim(name, CurveKind::Repeated)?;
        }
        loops_by_spec.push(of_face);
    }
    let mut ids = vec![CurveId(u32::MAX); specs.len()];
    let mut curves = Vec::new();
    for (i, (spec, usage)) in specs.iter().zip(&used).enumerate() {
        let Some((kind, face)) = *usage else { continue };
        let named = |fault: Fault| placed(fault.at(format!("curve \"{}\"", spec.name)), &spec.place);
        if spec.segments == Some(0) {
            let fault = Fault::new("Its number of segments is 0");
            return Err(named(fault.remedy("Give at least 1, or leave the number out")));
        }
        ids[i] = CurveId(curves.len() as u32);
        let internal = (kind != CurveKind::Boundary).then_some(face);
        curves.push(DomainCurve {
            name: spec.name.clone(),
            curve: Course::of_curve(Curve::new(&spec.shape).map_err(named)?),
            segments: spec.segments,
            place: spec.place.clone(),
            ends: [0; 2],
            sides: [internal; 2],
            kind,
            fine: Vec::new(),
            first: ids[i],
            turning: None,
        });
    }
    let lists = loops_by_spec
        .into_iter()
        .map(|loops| loops.into_iter().map(|l| l.into_iter().map(|i| ids[i]).collect()).collect())
        .collect();
    Ok((curves, lists))
}

/// Merges curve ends within the tolerance into vertices, and makes the fine polylines between them.
///
/// # Errors
/// Curves of zero length.
pub fn join_ends(curves: &mut [DomainCurve], size: f64, tolerance: f64) -> Result<Vec<DVec2>, Fault> {
    // Ends given by coordinates come first: where they meet computed ones, the vertex takes the given coordinates.
    let mut ends: Vec<(bool, usize, usize, DVec2)> = Vec::new();
    for (i, c) in curves.iter().enumerate() {
        ends.extend([0, 1].map(|which| (!c.curve.ends_given(), i, which, c.curve.point(which as f64))));
    }
    ends.sort_by_key(|e| (e.0, e.1, e.2));
    let mut tree: RTree<GeomWithData<[f64; 2], u32>> = RTree::new();
    let mut vertices: Vec<DVec2> = Vec::new();
    for &(_, i, which, p) in &ends {
        // The tree works with coordinates of order 1, so that no square underflows.
        let q = [p.x / size, p.y / size];
        let known =
            tree.nearest_neighbor(q).filter(|v| vertices[v.data as usize].distance(p) <= tolerance).map(|v| v.data);
        curves[i].ends[which] = known.unwrap_or_else(|| {
            vertices.push(p);
            tree.insert(GeomWithData::new(q, vertices.len() as u32 - 1));
            vertices.len() as u32 - 1
        });
    }
    refine(curves, &vertices, size, tolerance)?;
    Ok(vertices)
}

/// Makes the fine polylines of curves between their vertices.
///
/// # Errors
/// Curves of zero length.
pub fn refine(curves: &mut [DomainCurve], vertices: &[DVec2], size: f64, tolerance: f64) -> Result<(), Fault> {
    for c in curves.iter_mut() {
        c.fine = c.curve.polyline(1e-5 * size);
        let last = c.fine.len() - 1;
        c.fine[0].1 = vertices[c.ends[0] as usize];
        c.fine[last].1 = vertices[c.ends[1] as usize];
        let (low, high) = c.curve.bounds();
        let short = c.fine.windows(2).find(|w| w[0].1.distance(w[1].1) <= tolerance && c.curve.straight());
        if (high - low).max_element() <= tolerance || short.is_some() {
            let p = short.map_or(c.first(), |w| w[0].1);
            let fault = Fault::new(format!("The curve \"{}\" has (nearly) zero length", c.name))
                .at(format!("at {}", point_text(p)))
                .remedy("Remove the curve, or the superfluous point; tolerance (a key of the case) merges such points");
            return Err(placed(fault, &c.place));
        }
    }
    Ok(())
}

/// Merges ends of images into the vertices of the plane: ends in one chart that are one vertex in space and the same
/// place there. `in_space` has the vertices in space of each curve.
pub fn join_images(
    curves: &mut [DomainCurve],
    in_space: &dyn Fn(usize) -> [u32; 2],
    atlas: &Atlas,
    tolerance: Option<f64>,
) -> Vec<DVec2> {
    let mut ends: Vec<(bool, usize, usize, DVec2)> = Vec::new();
    for (i, c) in curves.iter().enumerate() {
        ends.extend([0, 1].map(|which| (!c.curve.ends_given(), i, which, c.curve.point(which as f64))));
    }
    ends.sort_by_key(|e| (e.0, e.1, e.2));
    let mut vertices: Vec<DVec2> = Vec::new();
    // The vertices of the plane by chart and vertex in space.
    let mut known: FxHashMap<(usize, u32), SmallVec<[u32; 2]>> = FxHashMap::default();
    for (_, i, which, p) in ends {
        let chart = atlas.chart_of(p);
        let images = known.entry((chart, in_space(i)[which])).or_default();
        let (surface, offset) = (&atlas.charts()[chart], atlas.offset(chart));
        let same = |v: &u32| surface.same_place(p - offset, vertices[*v as usize] - offset, tolerance);
        let found = images.iter().copied().find(same);
        curves[i].ends[which] = found.unwrap_or_else(|| {
            vertices.push(p);
            images.push(vertices.len() as u32 - 1);
            vertices.len() as u32 - 1
        });
    }
    vertices
}

/// Merges curve ends that are equal to the last bit into vertices, and makes the fine polylines between them: for
/// images of triangle edges, whose ends are nodes of the triangles.
pub fn join_equal_ends(curves: &mut [DomainCurve]) -> Vec<DVec2> {
    let mut known: FxHashMap<[u64; 2], u32> = FxHashMap::default();
    let mut vertices: Vec<DVec2> = Vec::new();
    for curve in curves {
        curve.ends = [0.0, 1.0].map(|t| {
            let p = curve.curve.point(t);
            // The sum turns -0 into 0.
            *known.entry([(p.x + 0.0).to_bits(), (p.y + 0.0).to_bits()]).or_insert_with(|| {
                vertices.push(p);
                vertices.len() as u32 - 1
            })
        });
        curve.fine = curve.curve.polyline(0.0);
    }
    vertices
}
