//! Closing what is left of small loops (spec 2.7, 10 rule 4): quadrilaterals between the nodes of the loop, formed even where
//! they are flat, mended by the rotation of an edge with a neighbour, and relaxed together with the elements around.

use smallvec::SmallVec;

use super::component::Component;
use super::converter::Converter;
use super::event::Event;
use super::settle::{Nodes, settle, worst_quality};
use crate::core::mesh::half_edge::{Mesh, NewElement};
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::mesh::refusals::Operation;

/// A closing is kept when every element around is at least this good.
const LEAST_QUALITY: f64 = 0.1;
/// Quality from which no other way is looked for.
const GOOD: f64 = 0.35;

/// Longer loops are left to the last resort.
const MOST_SEGMENTS: usize = 10;

/// One way to close a loop: elements over it, and perhaps an edge of them rotated with a neighbour.
#[derive(Clone, Debug)]
struct Way {
    quads: SmallVec<[[NodeId; 4]; 4]>,
    /// Element, side, number of nodes to rotate by.
    rotation: Option<(usize, u32, usize)>,
}

impl Converter<'_> {
    /// Closes a component with a single short loop at the best of all ways. Returns the number of
    /// quadrilaterals made.
    pub(super) fn close(&mut self, component: &Component) -> Option<(u64, Event)> {
        let ring = ring(&self.mesh, component)?;
        let coverings: Vec<SmallVec<[[NodeId; 4]; 4]>> = coverings(0, ring.len() - 1)
            .into_iter()
            .map(|quads| quads.into_iter().map(|corners| corners.map(|k| ring[k])).collect())
            .collect();
        let mut best: Option<(f64, Way)> = None;
        'ways: for rotated in [false, true] {
            for quads in &coverings {
                let count = quads.len();
                if rotated && count > 2 {
                    continue;
                }
                let rotations: SmallVec<[_; 16]> = if rotated {
                    (0..count).flat_map(|q| (0..4).flat_map(move |k| [Some((q, k, 1)), Some((q, k, 2))])).collect()
                } else {
                    SmallVec::from_slice(&[None])
                };
                for rotation in rotations {
                    let way = Way { quads: quads.clone(), rotation };
                    let mark = self.mesh.mark();
                    let quality = self.try_way(component, &ring, &way);
                    self.mesh.take_back(mark);
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
        let again = self.try_way(component, &ring, &way);
        debug_assert_eq!(again, Some(quality), "the same way leads to the same place");
        let quads = way.quads.len();
        Some((quads as u64, Event::Closed { segments: ring.len() as u8, quads: quads as u8, quality }))
    }

    /// Does one way; the worst quality around where all comes out valid.
    fn try_way(&mut self, component: &Component, ring: &[NodeId], way: &Way) -> Option<f64> {
        let region = self.mesh.region(component.triangles[0]);
        let inside = inner_nodes(&self.mesh, &component.triangles, ring);
        let new: SmallVec<[NewElement; 4]> = way.quads.iter().map(|&q| NewElement::quad(q, region)).collect();
        // A chord that is an edge already, outside of the loop, would be there twice.
        for quad in &way.quads {
            for k in 0..4 {
                let (p, q) = (quad[k], quad[(k + 1) % 4]);
                let is_chord = !(0..ring.len()).any(|i| ring[i] == p && ring[(i + 1) % ring.len()] == q);
                if is_chord && self.mesh.are_joined(p, q) && !self.is_live_edge(p, q) {
                    return None;
                }
            }
        }
        self.mesh.permit(Operation::Close, way.quads.as_flattened()).ok()?;
        let made = self.mesh.replace(&component.triangles, &new);
        inside.iter().for_each(|&n| self.mesh.release_node(n));
        let mut core = Nodes::from_slice(ring);
        if let Some((q, side, by)) = way.rotation {
            let h: HalfEdgeId = made[q].half_edge(side);
            for n in self.mesh.hexagon(h).ok()? {
                if !core.contains(&n) {
                    core.push(n);
                }
            }
            self.mesh.rotate_edge(h, by).ok()?;
        }
        let all_quads = core.iter().all(|&n| self.mesh.fan(n).all(|h| self.mesh.is_quad(h.element())));
        // Other live parts may touch: their nodes stay.
        if !all_quads {
            let mesh = &self.mesh;
            core.retain(|n| mesh.fan(*n).all(|h| mesh.is_quad(h.element())));
        }
        let around = Nodes::from_slice(ring);
        (settle(&mut self.mesh, &*self.source, &core) && super::settle::all_convex(&self.mesh, &around))
            .then(|| worst_quality(&self.mesh, &around))
    }
}

/// The nodes of a component's single loop, anticlockwise; `None` where it is too long, has several loops,
/// or touches itself.
fn ring(mesh: &Mesh, component: &Component) -> Option<SmallVec<[NodeId; MOST_SEGMENTS]>> {
    if component.boundary > MOST_SEGMENTS || component.triangles.len() > 64 {
        return None;
    }
    let start = component.triangles.iter().flat_map(|&e| mesh.half_edges(e)).find(|&h| mesh.is_front(h))?;
    let mut ring = SmallVec::new();
    let mut h = start;
    loop {
        if ring.contains(&mesh.origin(h)) || ring.len() == MOST_SEGMENTS {
            return None;
        }
        ring.push(mesh.origin(h));
        h = mesh.front_after(h);
        if h == start {
            break;
        }
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

/// All ways to cover the polygon of the corners `from..=to` (an even number of them) by quadrilaterals between its corners.
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
