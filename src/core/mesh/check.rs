//! Structural and exact geometric checks of the half-edge mesh (docs/algorithm.md, "Checks"): the invariants after
//! every operation.

use super::half_edge::Mesh;
use super::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::kernel::predicates::{convex, positive};

impl Mesh {
    /// Checks the whole mesh: twins, walks, anchors, free lists, repeated nodes, exact positivity, metrics.
    ///
    /// # Errors
    /// The first invariant that is violated, with ids and coordinates. That is a bug of an operator.
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

    /// Checks the invariants of [`check`](Mesh::check) around changed nodes and elements: these elements, those around
    /// the nodes, and the nodes of all of them. If the mesh was valid before the change, it is valid now.
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
        // The fan of a node must contain every element that has the node.
        let meets = |n: NodeId, e: ElementId| self.fan(n).any(|h| h.element() == e);
        for &e in &around {
            if let Some(n) = self.corners(e).find(|n| !meets(*n, e)) {
                return Err(format!("the fan of {n:?} does not see {e:?}"));
            }
        }
        Ok(())
    }

    /// Checks one element: its half-edges and twins agree, its nodes are distinct, it is strictly positive.
    ///
    /// # Errors
    /// The first invariant that is violated.
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

    /// `sides_at` is the number of elements that have the node, if known.
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
