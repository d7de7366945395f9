//! Global post-processing (paper 4.3.7): clean-up of the structure, then smoothing by the energy, both by worklists.

use std::collections::VecDeque;

use super::clean_up::{CleanedUp, clean_up};
use super::energy;
use crate::core::mesh::half_edge::Mesh;
use crate::core::mesh::ids::NodeId;
use crate::core::metric::field::MetricSource;

/// A node that moved farther than this (in its metric) sends its neighbours to be looked at again.
const STIRRED: f64 = 0.02;
/// Looks at one node at the most, on average.
const MOST_LOOKS: usize = 12;

/// What the post-processing did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Finished {
    /// Changes of structure.
    pub cleaned_up: CleanedUp,
    /// Nodes moved by smoothing.
    pub moves: usize,
}

/// Smooths, cleans up and smooths again. Every step keeps all elements strictly convex. The journal is kept where
/// `keep_journal` says so, else forgotten on the way.
pub fn finish(mesh: &mut Mesh, source: &dyn MetricSource, keep_journal: bool) -> Finished {
    let mut moves = smooth(mesh, source, keep_journal);
    let cleaned_up = clean_up(mesh, source, keep_journal);
    moves += smooth(mesh, source, keep_journal);
    Finished { cleaned_up, moves }
}

/// Relaxes all free nodes until none moves any more that matters. Returns the number of moves.
fn smooth(mesh: &mut Mesh, source: &dyn MetricSource, keep_journal: bool) -> usize {
    let mut queue: VecDeque<NodeId> = mesh.nodes().filter(|&n| !mesh.is_fixed(n)).collect();
    let mut queued = vec![false; mesh.node_slots()];
    queue.iter().for_each(|n| queued[n.index()] = true);
    let mut looks = MOST_LOOKS * queue.len();
    let mut moves = 0;
    while let Some(node) = queue.pop_front() {
        queued[node.index()] = false;
        if looks == 0 {
            break;
        }
        looks -= 1;
        let moved = energy::relax(mesh, node, source);
        moves += usize::from(moved > 0.0);
        if moved > STIRRED {
            for n in mesh.neighbours(node).chain([node]) {
                if !queued[n.index()] && !mesh.is_fixed(n) {
                    queued[n.index()] = true;
                    queue.push_back(n);
                }
            }
        }
        if !keep_journal {
            mesh.commit();
        }
    }
    moves
}
