//! Closing what is left of small loops (spec 2.7, 10 rule 4): a quadrilateral over four segments, two over six, formed even
//! where they are flat, mended by the rotation of an edge with a neighbour, and relaxed together with the elements around.

use smallvec::SmallVec;

use super::component::Component;
use super::converter::Converter;
use super::event::Event;
use super::settle::{Nodes, settle, worst_quality};
use crate::core::mesh::half_edge::{Mesh, NewElement};
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};

/// A closing is kept when every element around is at least this good.
const LEAST_QUALITY: f64 = 0.1;
/// Quality from which no other way is looked for.
const GOOD: f64 = 0.35;

/// One way to close a loop: elements over it, and perhaps an edge of them rotated with a neighbour.
#[derive(Clone, Debug)]
struct Way {
    quads: SmallVec<[[NodeId; 4]; 2]>,
    /// Element, side, number of nodes to rotate by.
    rotation: Option<(usize, u32, usize)>,
}

impl Converter<'_> {
    /// Closes a component with a single loop of four or six segments at the best of all ways. Returns the number of
    /// quadrilaterals made.
    pub(super) fn close(&mut self, component: &Component) -> Option<(u64, Event)> {
        let ring = ring(&self.mesh, component)?;
        let chords: SmallVec<[SmallVec<[[NodeId; 4]; 2]>; 3]> = match ring[..] {
            [a, b, c, d] => SmallVec::from_iter([SmallVec::from_slice(&[[a, b, c, d]])]),
            [a, b, c, d, e, f] => SmallVec::from_iter(
                [[[a, b, c, d], [d, e, f, a]], [[b, c, d, e], [e, f, a, b]], [[c, d, e, f], [f, a, b, c]]]
                    .map(|pair| SmallVec::from_slice(&pair)),
            ),
            _ => return None,
        };
        let mut best: Option<(f64, Way)> = None;
        'ways: for rotated in [false, true] {
            for quads in &chords {
                let count = quads.len();
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
        let new: SmallVec<[NewElement; 2]> = way.quads.iter().map(|&q| NewElement::quad(q, region)).collect();
        if way.quads.len() == 2 && self.mesh.are_joined(way.quads[0][0], way.quads[0][3]) {
            return None;
        }
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
        (settle(&mut self.mesh, self.source, &core) && super::settle::all_convex(&self.mesh, &around))
            .then(|| worst_quality(&self.mesh, &around))
    }
}

/// The nodes of a component's single loop, anticlockwise; `None` where it is longer than six segments, has several loops,
/// or touches itself.
fn ring(mesh: &Mesh, component: &Component) -> Option<SmallVec<[NodeId; 6]>> {
    if component.boundary > 6 || component.triangles.len() > 64 {
        return None;
    }
    let start = component.triangles.iter().flat_map(|&e| mesh.half_edges(e)).find(|&h| mesh.is_front(h))?;
    let mut ring = SmallVec::new();
    let mut h = start;
    loop {
        if ring.contains(&mesh.origin(h)) || ring.len() == 6 {
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
