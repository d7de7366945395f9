//! A surface as a face, without a loop: its own edges bound it, seams and singular points are seen to.

use std::sync::Arc;

use glam::DVec2;

use super::chart::{Chart, singular_edges};
use super::curve::Curve;
use super::named_curve::NamedCurve;
use super::space_curve::SpaceCurve;
use super::spec::{CurveShape, FaceSpec};
use super::surface::{EDGES, Edge, NurbsSurface};

/// What the names of the parts of a face end in that is divided between its poles.
const LOWER_HALF: &str = ", lower half";
const UPPER_HALF: &str = ", upper half";

/// A face, or a part of one that is too much for one chart.
pub(super) struct FacePart {
    pub spec: FaceSpec,
    pub surface: Arc<NurbsSurface>,
    /// The singular edge about which its chart is to be drawn; `None`: that is to be found.
    pub about: Option<Edge>,
    /// Whether it is the surface as a whole: the outer loop is the surface's own edge.
    pub whole: bool,
    /// Of one of two halves between poles: the axis between them, and the range of this half along it.
    pub half: Option<(usize, [f64; 2])>,
}

/// A part of a surface: the ranges of u and v, what its name ends in, and about which singular edge its chart is drawn.
type Covered = ([[f64; 2]; 2], &'static str, Option<Edge>);

/// The whole of a surface as a face: its own edges as curves (called "face: v0" and so on by the edge's parameter), seams
/// twice in the loop. Between two poles it is divided in the middle; from an apex that is no pole run two more lines besides the
/// seam, since fewer than three edges at a node inside a mesh are too few.
pub(super) fn whole(
    face: &FaceSpec,
    surface: &Arc<NurbsSurface>,
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
    let place = |axis: usize, value: f64, along: f64| {
        if axis == 0 { DVec2::new(value, along) } else { DVec2::new(along, value) }
    };
    // The axis whose two edges are both singular, if there is one: the surface is divided in its middle.
    let poles = [0, 1].into_iter().find(|&axis| [false, true].into_iter().all(|last| singular(Edge { axis, last })));
    // Each part: what it covers, its name, and about which singular edge its chart is drawn.
    let halves: Vec<Covered> = match poles {
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
        parts.push(FacePart {
            spec,
            surface: Arc::clone(surface),
            about,
            whole: true,
            half: poles.map(|axis| (axis, half[axis])),
        });
    }
}
