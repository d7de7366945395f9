//! A whole surface as a face without loops: its own edges bound it, with special care of seams and singular points.

use std::sync::Arc;

use glam::DVec2;

use super::chart::{Chart, singular_edges};
use super::curve::Curve;
use super::lifting::Lifted;
use super::named_curve::NamedCurve;
use super::space_curve::SpaceCurve;
use super::spec::{CurveShape, FaceSpec};
use super::surface::{EDGES, Edge, NurbsSurface};

/// The suffixes of the names of the parts of a face that is divided between its poles.
const LOWER_HALF: &str = ", lower half";
const UPPER_HALF: &str = ", upper half";

/// A face, or a part of a face that does not fit in one chart.
pub(super) struct FacePart {
    pub spec: FaceSpec,
    pub surface: Arc<NurbsSurface>,
    /// Whether its normal is against that of its surface.
    pub reversed: bool,
    /// It in its chart, where that is known from its directed loops.
    pub lifted: Option<Lifted>,
    /// The singular edge at the centre of its chart; `None` if that is not yet known.
    pub about: Option<Edge>,
    /// Whether its outer loop is the edge of the surface itself.
    pub whole: bool,
    /// For one of the two halves between poles: the axis between them, and the range of this half along it.
    pub half: Option<(usize, [f64; 2])>,
}

/// A part of a surface: the ranges of u and v, the suffix of its name, and the singular edge at the centre of its
/// chart.
type SurfacePart = ([[f64; 2]; 2], &'static str, Option<Edge>);

/// Makes a face of a whole surface: its edges become curves (named "face: v0" and so on, by the parameter of the edge),
/// and seams occur twice in the loop. A surface with two poles is divided in the middle. An apex that is not a pole
/// gets two lines besides the seam, since an inner node of a mesh needs at least three edges.
pub(super) fn whole(
    face: &FaceSpec,
    surface: &Arc<NurbsSurface>,
    reversed: bool,
    curves: &mut Vec<NamedCurve>,
    parts: &mut Vec<FacePart>,
) {
    let domain = surface.domain();
    let (closed, degenerate) = (surface.closed(), surface.degenerate());
    let mut add = |name: String, from: DVec2, to: DVec2| {
        let name = format!("{}: {name}", face.name);
        if !curves.iter().any(|c| c.name == name) {
            let trim = Curve::new(&CurveShape::Segment { from, to }).expect("an edge has a length");
            curves.push(NamedCurve {
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
    // The axis whose two edges are both singular, if there is one: the surface is divided in its middle.
    let poles = [0, 1].into_iter().find(|&axis| [false, true].into_iter().all(|last| singular(Edge { axis, last })));
    let halves: Vec<SurfacePart> = match poles {
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
        let disc = about.is_some_and(|edge| Chart::about(Arc::clone(surface), edge, reversed).is_disc());
        let mut spec = face.clone();
        spec.name = format!("{}{suffix}", face.name);
        // Lines from an apex that is not a pole divide the angle around it into thirds.
        let thirds = about.filter(|about| closed[1 - about.axis] && !disc).map(|about| about.axis);
        for edge in EDGES {
            let Edge { axis, last } = edge;
            let letter = ["u", "v"][axis];
            let value = half[axis][usize::from(last)];
            let outermost = value == domain[axis][usize::from(last)];
            // The two sides of a disc coincide.
            if (outermost && singular(edge)) || (disc && about.is_some_and(|about| about.axis != axis)) {
                continue;
            }
            let (name, value) = match (outermost, closed[axis]) {
                (false, _) => (format!("{letter} middle"), value),
                // The last edge of a closed axis is its first: the seam, which occurs twice in the loop.
                (true, true) => (format!("{letter}0{suffix}"), domain[axis][0]),
                (true, false) => (format!("{letter}{}{suffix}", u8::from(last)), value),
            };
            let [a, b] = half[1 - axis];
            if thirds != Some(axis) {
                spec.outer.push(add(name, edge.uv(a, value), edge.uv(b, value)));
                continue;
            }
            let at = |third: u8| if third == 3 { b } else { a + (b - a) * f64::from(third) / 3.0 };
            for third in 1..=3 {
                let (from, to) = (edge.uv(at(third - 1), value), edge.uv(at(third), value));
                spec.outer.push(add(format!("{name}, {third}/3"), from, to));
            }
            for third in 1..=2 {
                let [a, b] = half[axis];
                let (from, to) = (edge.uv(at(third), a), edge.uv(at(third), b));
                spec.repeated.push(add(format!("{} {third}/3{suffix}", ["u", "v"][1 - axis]), from, to));
            }
        }
        parts.push(FacePart {
            spec,
            surface: Arc::clone(surface),
            reversed,
            lifted: None,
            about,
            whole: true,
            half: poles.map(|axis| (axis, half[axis])),
        });
    }
}
