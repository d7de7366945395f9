//! Where on the mesh a question is: what a view has to show, so that it can be answered by looking. That tells no more
//! than a glance at the whole mesh: of a choice among segments it holds those that come first.

use crate::core::convert::{Event, LookedAt};
use crate::core::mesh::{Mesh, NodeId};
use crate::core::run::{Selecting, Watched};

/// How many of the segments that come first are shown: so few that they can be told apart where they are far apart.
const FIRST: usize = 4;

/// The nodes of the segments that would come first.
pub(super) fn of_selection(selecting: &Selecting) -> Vec<NodeId> {
    let table = &selecting.table;
    let first = table.in_order().into_iter().take(FIRST);
    sorted(first.flat_map(|place| [table.rows[place].a, table.rows[place].b]))
}

/// The nodes around the step that answers: the base with its tops and all that is joined to it, the corner of a seam,
/// what is swapped, removed or split with all that is joined to it.
pub(super) fn of_step(mesh: &Mesh, event: &Event, before: &LookedAt) -> Vec<NodeId> {
    let of_base = || {
        let base = before.base.iter().flat_map(|base| [base.a, base.b]);
        let tops = before.top.iter().flat_map(|(top, crossings)| top.iter().chain(crossings.iter().flatten())).copied();
        base.chain(tops).collect::<Vec<_>>()
    };
    let (middle, reaches) = match *event {
        Event::Seamed { at, node, gone, .. } | Event::TransitionSeamed { at, node, gone, .. } => {
            (vec![at, node, gone], false)
        }
        Event::SeamRefused { at, ends, .. } => (vec![at, ends[0], ends[1]], false),
        Event::Enhanced { new } => (new.to_vec(), true),
        Event::NodeRemoved { node, .. } => (vec![node], true),
        Event::Split { node, gone, .. } => (vec![node, gone], true),
        _ => (of_base(), before.top.is_none()),
    };
    let middle: Vec<NodeId> = middle.into_iter().filter(|node| mesh.has_node(*node)).collect();
    let around = middle.iter().filter(|_| reaches).flat_map(|node| mesh.neighbours(*node));
    sorted(middle.iter().copied().chain(around))
}

/// The nodes of what a question names, with all that is joined to them.
pub(super) fn of_subject(mesh: &Mesh, subject: Watched) -> Vec<NodeId> {
    let nodes: Vec<NodeId> = match subject {
        Watched::Node(node) => vec![node],
        Watched::Edge(a, b) => vec![a, b],
        Watched::Element(element) if mesh.has_element(element) => mesh.corners(element).collect(),
        Watched::Element(_) => Vec::new(),
    };
    let nodes: Vec<NodeId> = nodes.into_iter().filter(|node| mesh.has_node(*node)).collect();
    let around = nodes.iter().flat_map(|node| mesh.neighbours(*node));
    sorted(nodes.iter().copied().chain(around))
}

fn sorted(nodes: impl Iterator<Item = NodeId>) -> Vec<NodeId> {
    let mut nodes: Vec<NodeId> = nodes.collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}
