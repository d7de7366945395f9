//! Formation of the quadrilateral as the end of a transaction (paper 4.3.4), its placement and the parity of the loops
//! that it touches (docs/algorithm.md, "Formation", "Placement of new top nodes", "Parity after formation").

use glam::DVec2;
use smallvec::SmallVec;

use super::converter::Converter;
use super::event::{Event, Why};
use super::phase::{Attempt, Base};
use crate::core::front::sector::Side;
use crate::core::kernel::predicates::convex;
use crate::core::mesh::half_edge::NewElement;
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::mesh::quality::length_over;
use crate::core::mesh::refusals::Operation;
use crate::core::metric::measure::quad_quality;

/// A quadrilateral does not eat more triangles than this.
const MOST_EATEN: usize = 64;

/// What lies between the four sides of a quadrilateral to be formed.
struct Enclosed {
    /// Live triangles, that of the base first.
    triangles: SmallVec<[ElementId; 16]>,
    /// Nodes wholly inside.
    inside: SmallVec<[NodeId; 8]>,
}

impl Converter<'_> {
    /// Merges the triangles between the four sides, places the new top nodes, checks shape and parity.
    pub(super) fn form(&mut self, base: &Base, attempt: &Attempt, [c, d]: [NodeId; 2]) -> Result<Event, Why> {
        let (a, b) = (base.a, base.b);
        let was_on_front = [c, d].map(|n| self.is_on_front(n));
        let sides_were_live = Side::BOTH.map(|side| {
            let at = self.base_node(base, side);
            self.is_live_edge(at, [c, d][side.index()])
        });
        let gate = self.gates();
        let nodes = [a, b, d, c];
        let Enclosed { triangles: eaten, inside } = self.enclosed(base, nodes)?;
        let quad = NewElement::quad(nodes, self.mesh.region(eaten[0]));
        let element = self.mesh.replace(&eaten, &[quad])[0];
        for node in inside {
            self.mesh.release_node(node);
        }
        self.mesh.set_level(element, base.level);
        if self.parameters.placement {
            for side in Side::BOTH {
                if !was_on_front[side.index()] {
                    self.place(base, element, side, [c, d]);
                }
            }
        }
        let p = nodes.map(|n| self.mesh.uv(n));
        if !convex(p[0], p[1], p[2], p[3]) {
            return Err(Why::NotConvex);
        }
        let quality = self.mesh.quality(element);
        if quality < gate.quality {
            return Err(Why::Poor(quality));
        }
        let mut made = SmallVec::<[(NodeId, NodeId); 3]>::new();
        for side in Side::BOTH {
            if sides_were_live[side.index()] {
                made.push((self.base_node(base, side), [c, d][side.index()]));
            }
        }
        made.push((c, d));
        for &(from, to) in &made {
            let length = self.mesh.distance(from, to);
            if length > gate.length && self.is_front_edge(from, to) {
                return Err(Why::TooLong(length));
            }
        }
        let contact = Side::BOTH.iter().any(|s| sides_were_live[s.index()] && was_on_front[s.index()]);
        if contact {
            self.check_parity(&nodes)?;
        }
        Ok(Event::Formed {
            element,
            nodes,
            quality,
            eaten: eaten.len() as u8,
            level: base.level,
            attempt: attempt.number,
        })
    }

    /// The live triangles between the four sides A-B-D-C and the nodes wholly inside; they must form a disc.
    fn enclosed(&self, base: &Base, nodes: [NodeId; 4]) -> Result<Enclosed, Why> {
        let mesh = &self.mesh;
        let h = self.base_half_edge(base).ok_or(Why::NotDisc)?;
        let is_side = |from: NodeId, to: NodeId| (0..4).any(|k| nodes[k] == from && nodes[(k + 1) % 4] == to);
        let mut found: SmallVec<[ElementId; 16]> = SmallVec::from_slice(&[h.element()]);
        let mut inside: SmallVec<[NodeId; 8]> = SmallVec::new();
        let (mut next, mut sides) = (0, 0);
        while next < found.len() {
            let e = found[next];
            next += 1;
            for h in mesh.half_edges(e) {
                let (from, to) = (mesh.origin(h), mesh.target(h));
                if !nodes.contains(&from) && !inside.contains(&from) {
                    inside.push(from);
                }
                if is_side(from, to) {
                    sides += 1;
                    continue;
                }
                let t = mesh.twin(h).filter(|t| mesh.is_triangle(t.element())).ok_or(Why::NotDisc)?;
                if !found.contains(&t.element()) {
                    if found.len() == MOST_EATEN {
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

    /// Places a new top node at the mean of the place at unit metric length along the side's target direction and the
    /// parallelogram's corner, as far as everything around stays valid and good (docs/algorithm.md, "Placement of new
    /// top nodes").
    fn place(&mut self, base: &Base, element: ElementId, side: Side, tops: [NodeId; 2]) {
        let mesh = &self.mesh;
        let (node, other_top) = (tops[side.index()], tops[side.other().index()]);
        if mesh.is_fixed(node) {
            return;
        }
        let (at, other) = (self.base_node(base, side), self.base_node(base, side.other()));
        let (p, here) = (mesh.uv(at), mesh.uv(node));
        let Some(unit) = self.unit_place(base, side) else { return };
        // The top is to have unit length, not the base's: rows that run into larger or smaller sizes would keep the number of
        // their columns for ever, and drift away from the metric.
        let widen = (1.0 / base.length).clamp(0.5, 2.0);
        let parallel = mesh.uv(other_top) + (p - mesh.uv(other)) * widen;
        let there = 0.5 * (unit + parallel);
        let old = mesh.quality(element);
        let mut step = 1.0;
        for _ in 0..4 {
            let place = here + (there - here) * step;
            step *= 0.5;
            let Ok(metric) = self.source.metric(place) else { continue };
            let nodes = mesh.quad(element);
            let quality = quad_quality(
                nodes.map(|n| if n == node { &metric } else { mesh.metric_ref(n) }),
                nodes.map(|n| if n == node { place } else { mesh.uv(n) }),
            );
            if (quality >= 0.2 || quality >= 0.7 * old) && self.mesh.can_move(node, place).is_ok() {
                self.mesh.move_node(node, place, metric);
                return;
            }
        }
    }

    /// The place at unit metric length from the base's node along the side's target direction, by three corrections.
    fn unit_place(&self, base: &Base, side: Side) -> Option<DVec2> {
        let mesh = &self.mesh;
        let (at, other) = (self.base_node(base, side), self.base_node(base, side.other()));
        let (p, m) = (mesh.uv(at), mesh.metric_ref(at));
        let along = mesh.uv(other) - p;
        let along = along / m.norm2(along).sqrt();
        // The unit vector of the metric perpendicular to the base, on the live side.
        let normal = {
            let t = m.times(along);
            let w = match side {
                Side::Left => DVec2::new(-t.y, t.x),
                Side::Right => DVec2::new(t.y, -t.x),
            };
            w / m.norm2(w).sqrt()
        };
        let (sin, cos) = libm::sincos(self.target_angle(base, side));
        let direction = along * cos + normal * sin;
        let mut reach = 1.0;
        for _ in 0..3 {
            let metric = self.source.metric(p + direction * reach).ok()?;
            let length = length_over(m, &metric, direction * reach);
            reach = (reach / length).clamp(0.2 * reach, 5.0 * reach);
        }
        Some(p + direction * reach)
    }

    /// Whether every loop through the front segments of these nodes is even. All loops but the last one to close are
    /// walked, all at the same pace: the last one follows from the parity of the component.
    fn check_parity(&self, nodes: &[NodeId; 4]) -> Result<(), Why> {
        let mesh = &self.mesh;
        let mut starts: SmallVec<[HalfEdgeId; 8]> = SmallVec::new();
        for k in 0..4 {
            // The quadrilateral runs A-B-D-C; the front runs the other way along it.
            if let Some(h) = mesh.front_between(nodes[(k + 1) % 4], nodes[k]) {
                starts.push(h);
            }
        }
        let mut walkers: SmallVec<[(HalfEdgeId, usize, bool); 8]> = starts.iter().map(|&h| (h, 0, true)).collect();
        let mut walking = walkers.len();
        while walking > 1 {
            for k in 0..walkers.len() {
                if !walkers[k].2 || walking <= 1 {
                    continue;
                }
                let h = mesh.front_after(walkers[k].0);
                walkers[k].0 = h;
                walkers[k].1 += 1;
                if h == starts[k] {
                    if walkers[k].1 % 2 == 1 {
                        return Err(Why::OddLoop(walkers[k].1));
                    }
                    walkers[k].2 = false;
                    walking -= 1;
                } else if starts.contains(&h) {
                    // It has met the start of another: both are on one loop, and one walker is enough for it.
                    let met = starts.iter().position(|&s| s == h).unwrap_or(k);
                    if walkers[met].2 || walkers[met].0 == starts[met] {
                        walkers[k].2 = false;
                        walking -= 1;
                    }
                }
            }
        }
        Ok(())
    }

    /// Whether a node lies on the front (or on the boundary).
    pub(super) fn is_on_front(&self, node: NodeId) -> bool {
        self.mesh.is_fixed(node) || self.mesh.fan(node).any(|h| !self.mesh.is_triangle(h.element()))
    }

    /// Whether the two nodes are joined by an edge between two live triangles.
    pub(super) fn is_live_edge(&self, a: NodeId, b: NodeId) -> bool {
        let mesh = &self.mesh;
        mesh.half_edge_between(a, b).is_some_and(|h| {
            mesh.is_triangle(h.element()) && mesh.twin(h).is_some_and(|t| mesh.is_triangle(t.element()))
        })
    }

    /// Whether the edge between the two nodes is a front segment, in either direction.
    fn is_front_edge(&self, a: NodeId, b: NodeId) -> bool {
        self.mesh.front_between(a, b).is_some() || self.mesh.front_between(b, a).is_some()
    }
}
