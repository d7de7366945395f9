//! Structural and exact geometric checks of the half-edge mesh (docs/algorithm.md, "Checks"): the invariants after
//! every operation.

use super::half_edge::Mesh;
use super::ids::{ElementId, NodeId};
use crate::core::kernel::predicates::{convex, positive};

/// Returns a message as an error unless an invariant holds.
macro_rules! ensure {
    ($holds:expr, $($message:tt)+) => {
        if !$holds {
            return Err(format!($($message)+));
        }
    };
}

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
        ensure!(
            nodes == self.node_count() && elements == self.element_count(),
            "{nodes} nodes and {elements} elements are in use, but the free lists leave {} and {}",
            self.node_count(),
            self.element_count()
        );
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
            around.extend(self.elements_at(node));
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
            ensure!(self.has_node(n), "{e:?} uses {n:?}, a tombstone");
            ensure!(!nodes[..k].contains(&n), "{e:?} uses {n:?} twice");
        }
        for h in self.half_edges(e) {
            let Some(t) = self.twin(h) else {
                let ends_fixed = self.is_on_boundary(self.origin(h)) && self.is_on_boundary(self.target(h));
                ensure!(ends_fixed, "{h:?} of {e:?} has no twin, but its ends are not fixed");
                continue;
            };
            let are_twins = self.twin(t) == Some(h) && self.has_element(t.element()) && t.element() != e;
            ensure!(are_twins, "{h:?} and {t:?} are not each other's twins");
            let same_ends = self.origin(t) == self.target(h) && self.target(t) == self.origin(h);
            ensure!(same_ends, "{h:?} and {t:?} are twins with other ends");
        }
        let p: Vec<_> = nodes.iter().map(|&n| self.uv(n)).collect();
        let good = match p[..] {
            [a, b, c] => positive(a, b, c),
            [a, b, c, d] => convex(a, b, c, d),
            _ => false,
        };
        ensure!(good, "{e:?} is not strictly positive and convex: {nodes:?} at {p:?}");
        Ok(())
    }

    /// `sides_at` is the number of elements that have the node, if known.
    fn check_node(&self, node: NodeId, sides_at: Option<u32>) -> Result<(), String> {
        let most = sides_at.unwrap_or(self.element_slots() as u32);
        let mut seen = 0;
        for h in self.fan(node) {
            ensure!(self.origin(h) == node, "the fan of {node:?} meets {h:?}, which starts elsewhere");
            seen += 1;
            if seen > most {
                break;
            }
        }
        let sees_all = seen <= most && sides_at.is_none_or(|sides_at| seen == sides_at);
        ensure!(sees_all, "the fan of {node:?} sees {seen} of {most} elements");
        let start = self.fan(node).next().and_then(|h| self.twin(h));
        let fixed = self.is_on_boundary(node);
        ensure!(fixed == start.is_none(), "{node:?} has a boundary exactly where it is fixed on it: {fixed}");
        let (uv, metric) = (self.uv(node), self.metric(node));
        ensure!(metric.is_spd() && uv.is_finite(), "{node:?} at {uv} has metric {metric:?}");
        Ok(())
    }
}
