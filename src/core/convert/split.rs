//! Front splitting (paper 4.3.6, fig. 19): where a new quadrilateral leaves a narrow region, two nodes of the front
//! that face each other over a slender triangle become one and the loop two even ones, before a quadrilateral is.

use smallvec::SmallVec;

use super::event::Event;
use super::front::{Done, Front};
use super::phase::Phase;
use super::seam::merge::merge;
use crate::core::case::Parameters;
use crate::core::mesh::{ElementId, HalfEdgeId, Mesh};

/// Neither part of a loop that is split may be shorter: two segments would be one edge glued to itself.
const LEAST_PART: usize = 4;

/// A slender triangle between nodes of the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slender {
    /// The triangle.
    pub element: ElementId,
    /// Its only side on the front; one of the other two is to be collapsed.
    pub base: HalfEdgeId,
    /// Its metric area Ae.
    pub area: f64,
    /// Its width over its height re.
    pub ratio: f64,
}

/// The sets of the paper's steps (i) and (ii) around a new quadrilateral.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Narrow {
    /// T: live triangles at its nodes that have all their nodes on the front, ascending.
    pub on_front: SmallVec<[ElementId; 16]>,
    /// V: the slender ones of T, the smallest Ae/re first.
    pub slender: SmallVec<[Slender; 4]>,
}

/// Front splitting (4.3.6) around a new quadrilateral; then the next base segment is to be selected.
pub(super) fn step(front: &mut Front<'_>, element: ElementId) -> Done {
    if !front.parameters.splitting {
        return (Phase::Select, None);
    }
    let mark = front.mesh.mark();
    let event = split_front(front, element);
    if event.is_some() {
        front.refresh(mark);
    }
    (Phase::Select, event)
}

/// Looks for slender triangles around a quadrilateral (steps i and ii).
pub(super) fn narrow(mesh: &Mesh, parameters: &Parameters, quad: ElementId) -> Narrow {
    let mut narrow = Narrow::default();
    for node in mesh.quad(quad) {
        let live = mesh.elements_at(node).filter(|&e| mesh.is_triangle(e));
        narrow.on_front.extend(live.filter(|&e| mesh.triangle(e).iter().all(|&n| mesh.is_on_front(n))));
    }
    narrow.on_front.sort_unstable();
    narrow.on_front.dedup();
    narrow.slender.extend(narrow.on_front.iter().filter_map(|&e| slender(mesh, parameters, e)));
    narrow.slender.sort_by(|s, t| (s.area / s.ratio).total_cmp(&(t.area / t.ratio)).then(s.element.cmp(&t.element)));
    narrow
}

/// Judges a triangle by the conditions (a) to (c) of step (ii).
fn slender(mesh: &Mesh, parameters: &Parameters, element: ElementId) -> Option<Slender> {
    // (a) Two sides on the front are two adjacent front segments. Without any there is no base, and so no side edge.
    let mut on_front = mesh.half_edges(element).filter(|&h| mesh.is_front(h));
    let (Some(base), None) = (on_front.next(), on_front.next()) else { return None };
    let area = metric_area(mesh, element);
    if area >= parameters.eps1 {
        return None;
    }
    let longest = mesh.half_edges(element).map(|h| mesh.length(h)).fold(0.0, f64::max);
    let ratio = longest * longest / (2.0 * area);
    (ratio > parameters.eps2).then_some(Slender { element, base, area, ratio })
}

/// Splits the front at the first slender triangle around a new quadrilateral that has a side edge whose collapse leaves
/// two even loops (step iii), the shorter side first. What would spoil an element is not done.
fn split_front(front: &mut Front<'_>, quad: ElementId) -> Option<Event> {
    for Slender { base, area, ratio, .. } in narrow(front.mesh, front.parameters, quad).slender {
        let mut sides = [front.mesh.next(base), front.mesh.previous(base)];
        if front.mesh.length(sides[1]) < front.mesh.length(sides[0]) {
            sides.swap(0, 1);
        }
        for side in sides {
            let ends = front.mesh.ends(side);
            let Some(segments) = parts(front.mesh, side) else { continue };
            if segments.iter().any(|n| n % 2 == 1 || *n < LEAST_PART) {
                continue;
            }
            let mark = front.mesh.mark();
            // Slender triangles may stay in a narrow region; quadrilaterals are permanent.
            match merge(front, side, &|mesh, e| mesh.is_quad(e)) {
                Ok(node) => {
                    let gone = if node == ends[0] { ends[1] } else { ends[0] };
                    return Some(Event::Split { node, gone, area, ratio, segments: segments.map(|n| n as u32) });
                }
                Err(_) => front.mesh.take_back(mark),
            }
        }
    }
    None
}

/// Segments of the two loops that the loop through both ends of a live edge would become by its collapse; `None` where
/// the ends lie on two loops, which no collapse splits.
fn parts(mesh: &Mesh, side: HalfEdgeId) -> Option<[usize; 2]> {
    // The front segments that leave both ends, in the sector of the edge.
    let from = mesh.front_after(mesh.previous(side));
    let to = mesh.front_after(side);
    let (mut first, mut all) = (0, 0);
    for h in mesh.front_loop(from) {
        if h == to {
            first = all;
        }
        all += 1;
    }
    (first > 0).then_some([first, all - first])
}

/// Area of a triangle in the mean metric of its nodes.
fn metric_area(mesh: &Mesh, element: ElementId) -> f64 {
    let nodes = mesh.triangle(element);
    let [a, b, c] = nodes.map(|n| mesh.uv(n));
    let root = nodes.iter().map(|&n| mesh.metric_ref(n).det().sqrt()).sum::<f64>() / 3.0;
    0.5 * root * (b - a).perp_dot(c - a)
}
