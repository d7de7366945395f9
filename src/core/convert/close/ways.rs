//! The ways to close a small loop (docs/algorithm.md, "Small loops"): quadrilaterals between the nodes of the loop,
//! formed even where they are flat, repaired by the rotation of an edge with a neighbour, by their collapse or by a
//! smaller one set into them, and relaxed together with the elements around.

use smallvec::SmallVec;

use super::{MOST_SEGMENTS, MOST_TRIANGLES};
use crate::core::convert::event::Event;
use crate::core::convert::last_resort::component::Component;
use crate::core::convert::relax::{Nodes, all_convex, put, settle, worst_quality};
use crate::core::mesh::{ElementId, HalfEdgeId, Mesh, NewElement, NodeId, Operation};
use crate::core::metric::MetricSource;

/// A closing is kept when every element around is at least this good.
const LEAST_QUALITY: f64 = 0.1;
/// Quality from which no other way is looked for.
const GOOD: f64 = 0.35;

/// One way to close a loop: elements over it, and perhaps a repair of one of them.
#[derive(Clone, Debug)]
struct Way {
    quads: SmallVec<[[NodeId; 4]; 4]>,
    repair: Option<Repair>,
}

/// What is done to one of the elements over a loop, by its number.
#[derive(Clone, Copy, Debug)]
enum Repair {
    /// A side is rotated with the neighbour's, by this many nodes.
    Rotate(usize, u32, usize),
    /// The node at the start of a side is merged with the opposite one: the element goes, as by two seams.
    Collapse(usize, u32),
    /// A smaller quadrilateral is inset: every corner gets an edge of its own, even one between collinear sides.
    Inset(usize),
}

impl Repair {
    /// All repairs of this many elements, those that make no nodes first.
    fn all(quads: usize) -> impl Iterator<Item = Repair> {
        let rotations =
            (0..quads).flat_map(|q| (0..4).flat_map(move |side| [1, 2].map(|by| Repair::Rotate(q, side, by))));
        let collapses = (0..quads).flat_map(|q| (0..4).map(move |side| Repair::Collapse(q, side)));
        rotations.chain(collapses).chain((0..quads).map(Repair::Inset))
    }

    /// Quadrilaterals that it makes, less those that it takes.
    fn more(self) -> isize {
        match self {
            Repair::Rotate(..) => 0,
            Repair::Collapse(..) => -1,
            Repair::Inset(_) => 4,
        }
    }
}

/// Closes a component with a single short loop at the best of all ways.
pub fn close(mesh: &mut Mesh, source: &dyn MetricSource, component: &Component) -> Option<Event> {
    let ring = ring(mesh, component)?;
    let coverings: Vec<SmallVec<[[NodeId; 4]; 4]>> = coverings(0, ring.len() - 1)
        .into_iter()
        .map(|quads| quads.into_iter().map(|corners| corners.map(|k| ring[k])).collect())
        .collect();
    let mut best: Option<(f64, Way)> = None;
    'ways: for with_repair in [false, true] {
        for quads in &coverings {
            if with_repair && quads.len() > 2 {
                continue;
            }
            let repairs: SmallVec<[_; 32]> =
                if with_repair { Repair::all(quads.len()).map(Some).collect() } else { SmallVec::from_slice(&[None]) };
            for repair in repairs {
                if matches!(repair, Some(Repair::Inset(_))) && best.as_ref().is_some_and(|b| b.0 >= LEAST_QUALITY) {
                    break 'ways;
                }
                let way = Way { quads: quads.clone(), repair };
                let mark = mesh.mark();
                let quality = try_way(mesh, source, component, &ring, &way);
                mesh.take_back(mark);
                if let Some(quality) = quality.filter(|q| best.as_ref().is_none_or(|b| *q > b.0)) {
                    best = Some((quality, way));
                    if quality > GOOD {
                        break 'ways;
                    }
                }
            }
        }
    }
    let (quality, way) = best.filter(|b| b.0 >= LEAST_QUALITY)?;
    let again = try_way(mesh, source, component, &ring, &way);
    debug_assert_eq!(again, Some(quality), "the same way leads to the same place");
    let quads = way.quads.len().saturating_add_signed(way.repair.map_or(0, Repair::more));
    Some(Event::Closed { segments: ring.len() as u8, quads: quads as u8, quality })
}

/// Does one way; the worst quality around where all comes out valid.
fn try_way(
    mesh: &mut Mesh,
    source: &dyn MetricSource,
    component: &Component,
    ring: &[NodeId],
    way: &Way,
) -> Option<f64> {
    let region = mesh.region(component.triangles[0]);
    let inside = inner_nodes(mesh, &component.triangles, ring);
    if inside.iter().any(|&n| mesh.is_fixed(n)) {
        return None;
    }
    let new: SmallVec<[NewElement; 4]> = way.quads.iter().map(|&q| NewElement::quad(q, region)).collect();
    // A chord that is an edge already, outside of the loop, would be there twice.
    for quad in &way.quads {
        for k in 0..4 {
            let (p, q) = (quad[k], quad[(k + 1) % 4]);
            let is_chord = !(0..ring.len()).any(|i| ring[i] == p && ring[(i + 1) % ring.len()] == q);
            if is_chord && mesh.are_joined(p, q) && !mesh.is_live_edge(p, q) {
                return None;
            }
        }
    }
    mesh.permit(Operation::Close, way.quads.as_flattened()).ok()?;
    let made = mesh.replace(&component.triangles, &new);
    inside.iter().for_each(|&n| mesh.release_node(n));
    let (mut core, mut around) = (Nodes::from_slice(ring), Nodes::from_slice(ring));
    match way.repair {
        None => {}
        Some(Repair::Rotate(q, side, by)) => {
            let h: HalfEdgeId = made[q].half_edge(side);
            for n in mesh.hexagon(h).ok()? {
                if !core.contains(&n) {
                    core.push(n);
                }
            }
            mesh.rotate_edge(h, by).ok()?;
        }
        Some(Repair::Collapse(q, side)) => {
            let [gone, kept] = collapse(mesh, source, made[q].half_edge(side))?;
            core.retain(|n| *n != gone);
            around.retain(|n| *n != gone);
            core.extend(mesh.neighbours(kept).filter(|n| !around.contains(n)));
        }
        Some(Repair::Inset(q)) => core.extend(inset(mesh, source, made[q])?),
    }
    // Other live parts may touch: their nodes stay.
    core.retain(|n| mesh.is_buried(*n));
    let mut is_settled = settle(mesh, source, &core);
    if !is_settled {
        // Neighbours must make room.
        for node in core.clone() {
            let more: Nodes = mesh.neighbours(node).collect();
            core.extend(more.into_iter().filter(|&n| mesh.is_buried(n)));
        }
        core.sort_unstable();
        core.dedup();
        is_settled = settle(mesh, source, &core);
    }
    (is_settled && all_convex(mesh, &around)).then(|| worst_quality(mesh, &around))
}

/// Merges the node at the start of a side with the opposite one, half-way between them where both are free. Returns the
/// node that is gone and the other.
fn collapse(mesh: &mut Mesh, source: &dyn MetricSource, h: HalfEdgeId) -> Option<[NodeId; 2]> {
    let (gone, kept) = (mesh.origin(h), mesh.target(mesh.next(h)));
    if !mesh.is_buried(gone) || !mesh.is_buried(kept) {
        return None;
    }
    let middle = 0.5 * (mesh.uv(gone) + mesh.uv(kept));
    mesh.collapse_diamond(h).ok()?;
    let is_placed = mesh.is_fixed(kept) || put(mesh, source, kept, middle);
    is_placed.then_some([gone, kept])
}

/// Sets a smaller quadrilateral into one, half-way to its middle; returns the new nodes.
fn inset(mesh: &mut Mesh, source: &dyn MetricSource, element: ElementId) -> Option<[NodeId; 4]> {
    let outer = mesh.quad(element);
    let places = outer.map(|n| mesh.uv(n));
    let middle = 0.25 * (places[0] + places[1] + places[2] + places[3]);
    let mut inner = outer;
    for k in 0..4 {
        let place = 0.5 * (places[k] + middle);
        inner[k] = mesh.add_node(place, source.metric(place).ok()?);
    }
    let region = mesh.region(element);
    let ring = (0..4).map(|k| [outer[k], outer[(k + 1) % 4], inner[(k + 1) % 4], inner[k]]);
    let new: SmallVec<[NewElement; 5]> = ring.chain([inner]).map(|q| NewElement::quad(q, region)).collect();
    mesh.replace(&[element], &new);
    Some(inner)
}

/// The nodes of a component's loop, anticlockwise; `None` where it is too long, not the only one, or touches itself.
fn ring(mesh: &Mesh, component: &Component) -> Option<SmallVec<[NodeId; MOST_SEGMENTS]>> {
    if component.boundary > MOST_SEGMENTS || component.triangles.len() > MOST_TRIANGLES {
        return None;
    }
    let start = component.triangles.iter().flat_map(|&e| mesh.half_edges(e)).find(|&h| mesh.is_front(h))?;
    let mut ring = SmallVec::new();
    for node in mesh.front_loop(start).map(|h| mesh.origin(h)) {
        if ring.contains(&node) || ring.len() == MOST_SEGMENTS {
            return None;
        }
        ring.push(node);
    }
    (ring.len() == component.boundary).then_some(ring)
}

fn inner_nodes(mesh: &Mesh, triangles: &[ElementId], ring: &[NodeId]) -> SmallVec<[NodeId; 16]> {
    let mut inside = SmallVec::new();
    for node in triangles.iter().flat_map(|&e| mesh.triangle(e)) {
        if !ring.contains(&node) && !inside.contains(&node) {
            inside.push(node);
        }
    }
    inside
}

/// All ways to divide the polygon of the corners `from..=to` (an even number) into quadrilaterals between them.
fn coverings(from: usize, to: usize) -> Vec<Vec<[usize; 4]>> {
    if to == from + 1 {
        return vec![Vec::new()];
    }
    let mut all = Vec::new();
    // The quadrilateral over the side from..to has two more corners; what it cuts off are polygons again.
    for i in (from + 1..to).step_by(2) {
        for j in (i + 1..to).step_by(2) {
            for first in coverings(from, i) {
                for second in coverings(i, j) {
                    for third in coverings(j, to) {
                        let own = [[from, i, j, to]];
                        all.push([&first[..], &second, &third, &own].concat());
                    }
                }
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::coverings;

    #[test]
    fn a_polygon_has_as_many_coverings_as_the_ternary_trees_say() {
        assert_eq!([4, 6, 8, 10].map(|n| coverings(0, n - 1).len()), [1, 3, 12, 55]);
    }
}
