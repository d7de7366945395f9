//! Front splitting (paper 4.3.6, fig. 19): where a new quadrilateral leaves a narrow region, two nodes of the front
//! that face each other over a slender triangle become one and the loop two even ones, before a quadrilateral is.

use serde::Serialize;
use smallvec::SmallVec;

use super::event::{Event, Unmerged};
use super::front::{Done, Front};
use super::phase::Phase;
use super::seam::merge::merge;
use crate::core::case::Parameters;
use crate::core::mesh::{ElementId, HalfEdgeId, Mesh, NodeId};

/// Neither part of a loop that is split may be shorter: two segments would be one edge glued to itself.
pub(in crate::core) const LEAST_PART: u32 = 4;

/// Why a triangle of T is not slender (step ii).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NotSlender {
    /// Its nodes are the ends of two adjacent front segments (condition a).
    Adjacent,
    /// It has no side on the front, and so no side edges.
    NoBase,
    /// Its metric area is not below eps1 (condition b).
    Large,
    /// Its width over its height is not above eps2 (condition c).
    Wide,
}

/// A live triangle with all its nodes on the front.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OnFront {
    /// The triangle.
    pub element: ElementId,
    /// Its metric area Ae.
    pub area: f64,
    /// Its width over its height re.
    pub ratio: f64,
    /// The first of the conditions (a) to (c) that it does not meet; none where it is slender.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub passed: Option<NotSlender>,
}

/// A side edge of a slender triangle, which a split would collapse (step iii).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SideToCollapse {
    #[serde(skip)]
    h: HalfEdgeId,
    /// Its ends.
    pub ends: [NodeId; 2],
    /// Segments of the two loops that its collapse makes of one; none where its ends lie on two loops.
    pub segments: Option<[u32; 2]>,
}

impl SideToCollapse {
    /// Whether its collapse leaves two even loops of four segments or more.
    pub fn splits(&self) -> bool {
        self.segments.is_some_and(|parts| parts.iter().all(|n| n % 2 == 0 && *n >= LEAST_PART))
    }
}

/// A slender triangle between nodes of the front.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Slender {
    /// The triangle.
    pub element: ElementId,
    /// Its metric area Ae.
    pub area: f64,
    /// Its width over its height re.
    pub ratio: f64,
    /// The sides that are not on the front, the shorter one first.
    pub sides: [SideToCollapse; 2],
}

/// The sets of the paper's steps (i) and (ii) around a new quadrilateral.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Narrow {
    /// The area below which a triangle is slender.
    pub eps1: f64,
    /// The width over the height above which it is.
    pub eps2: f64,
    /// T: live triangles at its nodes that have all their nodes on the front, ascending.
    pub on_front: Vec<OnFront>,
    /// V: the slender ones of T, the smallest Ae/re first.
    pub slender: Vec<Slender>,
}

/// Front splitting (4.3.6) around a new quadrilateral; then the next base segment is to be selected.
pub(super) fn step(front: &mut Front<'_>, element: ElementId) -> Done {
    if !front.parameters.splitting {
        return (Phase::Select, None);
    }
    let mark = front.mesh.mark();
    let event = split_front(front, element);
    if let Some(Event::Split { .. }) = event {
        front.refresh(mark);
    }
    (Phase::Select, event)
}

/// Looks for slender triangles around a quadrilateral (steps i and ii).
pub(super) fn narrow(mesh: &Mesh, parameters: &Parameters, quad: ElementId) -> Narrow {
    let mut elements: SmallVec<[ElementId; 16]> = SmallVec::new();
    for node in mesh.quad(quad) {
        elements.extend(mesh.elements_at(node).filter(|&e| mesh.is_triangle(e)));
    }
    elements.sort_unstable();
    elements.dedup();
    elements.retain(|e| mesh.triangle(*e).iter().all(|&n| mesh.is_on_front(n)));
    let Parameters { eps1, eps2, .. } = *parameters;
    let mut narrow = Narrow { eps1, eps2, on_front: Vec::new(), slender: Vec::new() };
    for element in elements {
        let measured = measure(mesh, parameters, element);
        narrow.on_front.push(measured);
        if measured.passed.is_none() {
            narrow.slender.extend(slender(mesh, &measured));
        }
    }
    narrow.slender.sort_by(|s, t| (s.area / s.ratio).total_cmp(&(t.area / t.ratio)).then(s.element.cmp(&t.element)));
    narrow
}

/// Judges a triangle by the conditions (a) to (c) of step (ii).
fn measure(mesh: &Mesh, parameters: &Parameters, element: ElementId) -> OnFront {
    let area = metric_area(mesh, element);
    let longest = mesh.half_edges(element).map(|h| mesh.length(h)).fold(0.0, f64::max);
    let ratio = longest * longest / (2.0 * area);
    let passed = match mesh.half_edges(element).filter(|&h| mesh.is_front(h)).count() {
        0 => Some(NotSlender::NoBase),
        1 if area >= parameters.eps1 => Some(NotSlender::Large),
        1 if ratio > parameters.eps2 => None,
        1 => Some(NotSlender::Wide),
        // (a) Two sides on the front are two adjacent front segments.
        _ => Some(NotSlender::Adjacent),
    };
    OnFront { element, area, ratio, passed }
}

/// A slender triangle with its side edges.
fn slender(mesh: &Mesh, measured: &OnFront) -> Option<Slender> {
    let OnFront { element, area, ratio, .. } = *measured;
    let base = mesh.half_edges(element).find(|&h| mesh.is_front(h))?;
    let mut sides = [mesh.next(base), mesh.previous(base)];
    if mesh.length(sides[1]) < mesh.length(sides[0]) {
        sides.swap(0, 1);
    }
    let sides = sides.map(|h| SideToCollapse { h, ends: mesh.ends(h), segments: parts(mesh, h) });
    Some(Slender { element, area, ratio, sides })
}

/// Splits the front at the first slender triangle around a new quadrilateral that has a side edge whose collapse leaves
/// two even loops (step iii), the shorter side first. What would spoil an element is not done. Says what was looked at
/// where there are slender triangles and no split.
fn split_front(front: &mut Front<'_>, element: ElementId) -> Option<Event> {
    let Narrow { on_front, slender, .. } = narrow(front.mesh, front.parameters, element);
    let mut why: Option<Unmerged> = None;
    for &Slender { area, ratio, sides, .. } in &slender {
        for side in sides.iter().filter(|side| side.splits()) {
            let Some(segments) = side.segments else { continue };
            let mark = front.mesh.mark();
            // Slender triangles may stay in a narrow region; quadrilaterals are permanent.
            match merge(front, side.h, &|mesh, e| mesh.is_quad(e)) {
                Ok(node) => {
                    let gone = if node == side.ends[0] { side.ends[1] } else { side.ends[0] };
                    return Some(Event::Split { node, gone, area, ratio, segments });
                }
                Err(refusal) => {
                    front.mesh.take_back(mark);
                    why = why.or(Some(refusal));
                }
            }
        }
    }
    let count = |n: usize| u8::try_from(n).unwrap_or(u8::MAX);
    let (on_front, slender) = (count(on_front.len()), count(slender.len()));
    (slender > 0).then_some(Event::SplitRefused { element, on_front, slender, why })
}

/// Segments of the two loops that the loop through both ends of a live edge would become by its collapse; `None` where
/// the ends lie on two loops, which no collapse splits.
fn parts(mesh: &Mesh, side: HalfEdgeId) -> Option<[u32; 2]> {
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
