//! The candidates for a side edge that were not chosen, as views and figures draw and label them.

use super::scene::{Decision, Outlined};
use crate::core::convert::{Candidates, Phase};
use crate::core::front::Side;
use crate::core::mesh::{Mesh, NodeId};
use crate::core::run::explain;

/// A candidate that was not chosen.
pub struct Refused {
    /// From the end of the base to the top that it would have had. A swap would have made this edge.
    pub ends: [NodeId; 2],
    /// Why it was not chosen.
    pub reason: String,
}

impl Refused {
    /// Whether a row of the table or something under the pointer stands for it.
    pub fn is(&self, what: Outlined) -> bool {
        let [from, top] = self.ends;
        match what {
            Outlined::Edge(ends) => ends == self.ends || ends == [top, from],
            Outlined::Node(node) => node == top,
            Outlined::Element(_) => false,
        }
    }
}

/// Those of the candidates of the last step, while a side is chosen.
pub fn refused(mesh: &Mesh, phase: &Phase, candidates: Option<&Candidates>) -> Vec<Refused> {
    let (Some(tried), Some([a, b])) = (candidates, Decision::of(phase).base) else { return Vec::new() };
    let from = if tried.side == Side::Left { a } else { b };
    // The edges of the front and the base are there without that.
    let is_front = |node| mesh.front_between(from, node).or(mesh.front_between(node, from)).is_some();
    let edges = tried.edges.iter().filter(|edge| !is_front(edge.node));
    edges
        .filter_map(|edge| {
            let reason = explain::passed(edge.passed?, edge, tried);
            let reason = match edge.swap {
                None => reason,
                Some(across) => format!("swap {}: {reason}", explain::edge(across)),
            };
            Some(Refused { ends: [from, edge.node], reason })
        })
        .collect()
}
