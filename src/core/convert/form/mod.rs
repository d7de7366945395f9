//! Formation of the quadrilateral (paper 4.3.4; docs/algorithm.md, "Formation") as the end of a transaction: the
//! triangles between its four sides are merged, its new tops are placed, and shape, lengths and the parity of the loops
//! that it touches are checked.

pub(super) mod attempts;
mod parity;
mod placement;

pub use placement::{Aim, Stays};

use smallvec::SmallVec;

use super::event::{Event, FewNodes, Why};
use super::front::{Done, Front};
use super::local;
use super::phase::{Attempt, Base};
use crate::core::case::Parameters;
use crate::core::front::Side;
use crate::core::kernel::predicates::convex;
use crate::core::mesh::{ElementId, Mesh, NewElement, NodeId, Operation};
use crate::core::metric::MetricSource;

/// A quadrilateral does not replace more triangles than this; its event names all nodes inside.
const MOST_TRIANGLES: usize = 2 + 2 * FewNodes::MOST;

/// What lies between the four sides of a quadrilateral to be formed.
struct Enclosed {
    /// Live triangles, that of the base first.
    triangles: SmallVec<[ElementId; 16]>,
    /// Nodes wholly inside.
    inside: SmallVec<[NodeId; 8]>,
}

/// Merges the triangles between the four sides, places the new top nodes, checks shape and parity.
pub(super) fn form(front: &mut Front<'_>, base: Base, attempt: Attempt, [c, d]: [NodeId; 2]) -> Result<Done, Why> {
    let nodes = [base.a, base.b, d, c];
    let was_on_front = [c, d].map(|n| front.mesh.is_on_front(n));
    let sides = [[base.a, c], [base.b, d]];
    let were_live = sides.map(|[at, top]| front.mesh.is_live_edge(at, top));
    let Enclosed { triangles, inside } = enclosed(front.mesh, &base, nodes)?;
    let aims = aims(front.mesh, front.source, front.parameters, &base, [c, d]);
    let element = merge(front.mesh, nodes, &triangles, &inside);
    front.mesh.set_level(element, base.level);
    for (aim, tops) in aims.iter().zip([[c, d], [d, c]]) {
        if let Ok(aim) = aim {
            placement::place(front, element, aim, tops);
        }
    }
    let quality = check_shape(front, element)?;
    let new_sides = sides.into_iter().zip(were_live).filter(|(_, was_live)| *was_live).map(|(ends, _)| ends);
    check_lengths(front, new_sides.chain([[c, d]]))?;
    // A side that joins the front to itself divides a loop, or makes one of two.
    if (0..2).any(|k| were_live[k] && was_on_front[k]) {
        parity::check(front.mesh, &nodes)?;
    }
    let merged = triangles.len() as u8;
    let (level, swallowed) = (base.level, FewNodes::of(&inside));
    let event = Event::Formed { element, nodes, quality, merged, level, attempt: attempt.number, swallowed };
    Ok((local::begin(front, element, attempt.mark), Some(event)))
}

/// Where the tops C and D are to go, or why they stay; of the mesh before the quadrilateral is merged.
pub(super) fn aims(
    mesh: &Mesh,
    source: &dyn MetricSource,
    parameters: &Parameters,
    base: &Base,
    tops: [NodeId; 2],
) -> [Result<Aim, Stays>; 2] {
    Side::BOTH.map(|side| placement::judge(mesh, source, parameters, base, side, tops[side.index()]))
}

/// The live triangles between the four sides A-B-D-C and the nodes wholly inside; they must form a disc.
fn enclosed(mesh: &Mesh, base: &Base, nodes: [NodeId; 4]) -> Result<Enclosed, Why> {
    let h = base.half_edge(mesh).ok_or(Why::NotDisc)?;
    let is_side = |from: NodeId, to: NodeId| (0..4).any(|k| nodes[k] == from && nodes[(k + 1) % 4] == to);
    let mut found: SmallVec<[ElementId; 16]> = SmallVec::from_slice(&[h.element()]);
    let mut inside: SmallVec<[NodeId; 8]> = SmallVec::new();
    let (mut next, mut sides) = (0, 0);
    while next < found.len() {
        let e = found[next];
        next += 1;
        for h in mesh.half_edges(e) {
            let [from, to] = mesh.ends(h);
            if !nodes.contains(&from) && !inside.contains(&from) {
                inside.push(from);
            }
            if is_side(from, to) {
                sides += 1;
                continue;
            }
            let t = mesh.live_twin(h).ok_or(Why::NotDisc)?;
            if !found.contains(&t.element()) {
                if found.len() == MOST_TRIANGLES {
                    return Err(Why::NotDisc);
                }
                found.push(t.element());
            }
        }
    }
    let disc = sides == 4 && found.len() == 2 + 2 * inside.len() && inside.iter().all(|&n| !mesh.is_fixed(n));
    if disc && mesh.permit(Operation::Form, &nodes).is_ok() {
        Ok(Enclosed { triangles: found, inside })
    } else {
        Err(Why::NotDisc)
    }
}

/// Replaces the triangles by the quadrilateral.
fn merge(mesh: &mut Mesh, nodes: [NodeId; 4], triangles: &[ElementId], inside: &[NodeId]) -> ElementId {
    let quad = NewElement::quad(nodes, mesh.region(triangles[0]));
    let element = mesh.replace(triangles, &[quad])[0];
    inside.iter().for_each(|&node| mesh.release_node(node));
    element
}

/// Whether the quadrilateral is strictly convex and good enough; its quality.
fn check_shape(front: &Front<'_>, element: ElementId) -> Result<f64, Why> {
    let [a, b, c, d] = front.mesh.quad(element).map(|n| front.mesh.uv(n));
    if !convex(a, b, c, d) {
        return Err(Why::NotConvex);
    }
    let quality = front.mesh.quality(element);
    if quality < front.gates().quality { Err(Why::Poor(quality)) } else { Ok(quality) }
}

/// Whether the new front segments are short enough.
fn check_lengths(front: &Front<'_>, new: impl Iterator<Item = [NodeId; 2]>) -> Result<(), Why> {
    for [from, to] in new {
        let length = front.mesh.distance(from, to);
        if length > front.gates().length && front.mesh.is_front_edge(from, to) {
            return Err(Why::TooLong(length));
        }
    }
    Ok(())
}
