//! Structural and exact geometric checks of the half-edge mesh (spec 5): what must hold after every operation.

use glam::{DVec2, DVec3};
use smallvec::SmallVec;

use super::half_edge::Mesh;
use super::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::geometry::predicates::{convex, positive};

impl Mesh {
    /// Checks the whole mesh: twins, walks, anchors, free lists, repeated nodes, exact positivity, metrics.
    ///
    /// # Errors
    /// Says the first thing that does not hold, with ids and places. It is a bug of an operator.
    pub fn check(&self) -> Result<(), String> {
        let mut sides_at = vec![0_u32; self.node_slots()];
        for e in self.elements() {
            self.check_element(e)?;
            self.corners(e).for_each(|n| sides_at[n.index()] += 1);
        }
        for node in self.nodes() {
            self.check_node(node, Some(sides_at[node.index()]))?;
        }
        let (nodes, elements) = (self.nodes().count(), self.elements().count());
        if nodes != self.node_count() || elements != self.element_count() {
            return Err(format!(
                "{nodes} nodes and {elements} elements are in use, but the free lists leave {} and {}",
                self.node_count(),
                self.element_count()
            ));
        }
        Ok(())
    }

    /// Checks what may be wrong after a change of these nodes and elements, by the rules of [`check`](Mesh::check): the elements,
    /// those around the nodes, and the nodes of all of them. Where the mesh was sound before, it is sound now.
    ///
    /// # Errors
    /// As [`check`](Mesh::check).
    pub fn check_around(&self, nodes: &[NodeId], elements: &[ElementId]) -> Result<(), String> {
        let mut at = nodes.iter().copied().filter(|n| self.has_node(*n)).collect::<Vec<_>>();
        let mut around: Vec<ElementId> = elements.iter().copied().filter(|e| self.has_element(*e)).collect();
        for &node in &at {
            self.check_node(node, None)?;
            around.extend(self.fan(node).map(HalfEdgeId::element));
        }
        around.sort_unstable();
        around.dedup();
        for &e in &around {
            self.check_element(e)?;
            at.extend(self.corners(e));
        }
        at.sort_unstable();
        at.dedup();
        at.into_iter().try_for_each(|node| self.check_node(node, None))?;
        // The walk around a node meets every element that has it.
        let meets = |n: NodeId, e: ElementId| self.fan(n).any(|h| h.element() == e);
        for &e in &around {
            if let Some(n) = self.corners(e).find(|n| !meets(*n, e)) {
                return Err(format!("the fan of {n:?} does not see {e:?}"));
            }
        }
        Ok(())
    }

    /// The elements on surfaces that have a corner, between straight sides in space, whose normal does not agree with that of
    /// the surface there: they fold over it, which a mesh too coarse for its curvature does. None in the plane.
    pub fn folded(&self) -> Vec<ElementId> {
        if self.ground().is_none() {
            return Vec::new();
        }
        self.elements()
            .filter(|&e| self.corner_sines(e, &self.places(e)).any(|(surface, _)| surface.is_nan() || surface <= 0.0))
            .collect()
    }

    /// The least sine of an element's corners, between straight sides in space, seen along the normal of the surface there, and on
    /// triangles, whose normals jump, along its own too; 0 at most where a side is no longer than `near`. In the plane, where exact
    /// predicates say more, along z.
    pub fn least_sine(&self, e: ElementId, near: f64) -> f64 {
        let xyz = self.places(e);
        if (0..xyz.len()).any(|k| xyz[k].distance(xyz[(k + 1) % xyz.len()]) <= near) {
            return 0.0;
        }
        let first = self.uv(self.origin(e.half_edge(0)));
        let jumps = self.ground().is_some_and(|ground| ground.atlas.is_of_facets(first));
        let sines = self.corner_sines(e, &xyz).map(|(surface, own)| if jumps { surface.min(own) } else { surface });
        sines.fold(f64::INFINITY, f64::min)
    }

    /// The places of an element's corners in space.
    fn places(&self, e: ElementId) -> SmallVec<[DVec3; 4]> {
        self.corners(e).map(|n| self.xyz(n)).collect()
    }

    /// The sine of each corner as seen along the normal of the surface there, and along the element's own.
    /// Its corners stand at `xyz`.
    fn corner_sines<'a>(&'a self, e: ElementId, xyz: &'a [DVec3]) -> impl Iterator<Item = (f64, f64)> + 'a {
        let nodes: SmallVec<[NodeId; 4]> = self.corners(e).collect();
        let count = nodes.len();
        let middle = nodes.iter().map(|&n| self.uv(n)).sum::<DVec2>() / count as f64;
        // Twice the mean area of a quadrilateral as a vector; of a triangle too.
        let own = (xyz[2] - xyz[0]).cross(xyz[count - 1] - xyz[1]).normalize_or_zero();
        (0..count).map(move |k| {
            let (next, previous) = (xyz[(k + 1) % count] - xyz[k], xyz[(k + count - 1) % count] - xyz[k]);
            // At an apex there are many normals: that from a little within the element is meant.
            let within = self.uv(nodes[k]).lerp(middle, 1e-3);
            let normal = self.ground().map_or(DVec3::Z, |ground| ground.atlas.at(within).normal());
            let corner = next.cross(previous) / (next.length() * previous.length()).max(f64::MIN_POSITIVE);
            (corner.dot(normal), corner.dot(own))
        })
    }

    /// Checks one element: its half-edges and twins agree, its nodes differ, it is strictly positive.
    ///
    /// # Errors
    /// Says what does not hold.
    pub fn check_element(&self, e: ElementId) -> Result<(), String> {
        let nodes: Vec<NodeId> = self.corners(e).collect();
        for (k, &n) in nodes.iter().enumerate() {
            if !self.has_node(n) {
                return Err(format!("{e:?} uses {n:?}, a tombstone"));
            }
            if nodes[..k].contains(&n) {
                return Err(format!("{e:?} uses {n:?} twice"));
            }
        }
        for h in self.half_edges(e) {
            let Some(t) = self.twin(h) else {
                if !(self.is_fixed(self.origin(h)) && self.is_fixed(self.target(h))) {
                    return Err(format!("{h:?} of {e:?} has no twin, but its ends are not fixed"));
                }
                continue;
            };
            if self.twin(t) != Some(h) || !self.has_element(t.element()) || t.element() == e {
                return Err(format!("{h:?} and {t:?} are not each other's twins"));
            }
            if self.origin(t) != self.target(h) || self.target(t) != self.origin(h) {
                return Err(format!("{h:?} and {t:?} are twins with other ends"));
            }
        }
        let p: Vec<_> = nodes.iter().map(|&n| self.uv(n)).collect();
        let good = match p[..] {
            [a, b, c] => positive(a, b, c),
            [a, b, c, d] => convex(a, b, c, d),
            _ => false,
        };
        if !good {
            return Err(format!("{e:?} is not strictly positive and convex: {nodes:?} at {p:?}"));
        }
        Ok(())
    }

    /// `sides_at`: the elements that have the node, where that is known.
    fn check_node(&self, node: NodeId, sides_at: Option<u32>) -> Result<(), String> {
        let most = sides_at.unwrap_or(self.element_slots() as u32);
        let mut seen = 0;
        for h in self.fan(node) {
            if self.origin(h) != node {
                return Err(format!("the fan of {node:?} meets {h:?}, which starts elsewhere"));
            }
            seen += 1;
            if seen > most {
                break;
            }
        }
        if seen > most || sides_at.is_some_and(|sides_at| seen != sides_at) {
            return Err(format!("the fan of {node:?} sees {seen} of {most} elements"));
        }
        let start = self.fan(node).next().and_then(|h| self.twin(h));
        if self.is_fixed(node) != start.is_none() {
            return Err(format!("{node:?} is fixed exactly where it lies on a boundary: {}", self.is_fixed(node)));
        }
        if !self.metric(node).is_spd() || !self.uv(node).is_finite() {
            return Err(format!("{node:?} at {} has metric {:?}", self.uv(node), self.metric(node)));
        }
        Ok(())
    }
}
