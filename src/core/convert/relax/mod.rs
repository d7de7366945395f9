//! Relaxation of nodes by an energy, and settling: making valid what a change of structure may have left inverted.
//! Nodes move to the middle of their neighbours, then down the energy. For use inside a transaction.

pub mod energy;

use glam::DVec2;
use smallvec::SmallVec;

use crate::core::kernel::predicates::{convex, firm};
use crate::core::mesh::{ElementId, Mesh, NodeId};
use crate::core::metric::MetricSource;

/// Rounds of relaxation of the nodes around a trial.
pub const RELAX_ROUNDS: usize = 4;
/// Rounds of moving nodes to the middle of their neighbours.
const UNTANGLE_ROUNDS: usize = 3;

/// A few nodes that a change concerns.
pub type Nodes = SmallVec<[NodeId; 12]>;

/// Places a node, whatever becomes of its elements. False where there is no metric, or the move is refused.
pub fn put(mesh: &mut Mesh, source: &dyn MetricSource, node: NodeId, uv: DVec2) -> bool {
    let Ok(metric) = source.metric(uv) else { return false };
    if mesh.permit_move(node, uv).is_err() {
        return false;
    }
    mesh.move_node(node, uv, metric);
    true
}

/// Relaxes the free ones of some nodes, all of whose elements must be quadrilaterals; where elements are inverted first
/// moves them to the middle of their neighbours. True when every element around is strictly convex in the end.
pub fn settle(mesh: &mut Mesh, source: &dyn MetricSource, core: &Nodes) -> bool {
    let convex = untangle(mesh, source, core);
    if convex {
        relax(mesh, source, core, RELAX_ROUNDS);
    }
    convex
}

/// Moves the free ones of some nodes to the middle of their neighbours where elements around are inverted. True when
/// every element around is strictly convex in the end.
pub fn untangle(mesh: &mut Mesh, source: &dyn MetricSource, core: &Nodes) -> bool {
    for _ in 0..UNTANGLE_ROUNDS {
        if all_convex(mesh, core) {
            return true;
        }
        for &node in core.iter().filter(|&&n| !mesh.is_fixed(n)).collect::<SmallVec<[_; 12]>>() {
            let around: Nodes = mesh.neighbours(node).collect();
            let middle = around.iter().fold(DVec2::ZERO, |s, &n| s + mesh.uv(n)) / around.len() as f64;
            if !put(mesh, source, node, middle) {
                return false;
            }
        }
    }
    all_convex(mesh, core)
}

/// Relaxes the free ones of some nodes, for at most this many rounds.
pub fn relax(mesh: &mut Mesh, source: &dyn MetricSource, core: &Nodes, rounds: usize) {
    for _ in 0..rounds {
        let mut moved: f64 = 0.0;
        for &node in core {
            moved = moved.max(energy::relax(mesh, node, source));
        }
        if moved < 0.02 {
            break;
        }
    }
}

/// The elements at some nodes, each once.
pub fn elements_around(mesh: &Mesh, nodes: &[NodeId]) -> SmallVec<[ElementId; 24]> {
    let mut elements: SmallVec<[ElementId; 24]> = nodes.iter().flat_map(|&n| mesh.elements_at(n)).collect();
    elements.sort_unstable();
    elements.dedup();
    elements
}

/// Whether every element around is strictly convex, exactly; live triangles count as they are.
pub fn all_convex(mesh: &Mesh, core: &Nodes) -> bool {
    elements_around(mesh, core).iter().all(|&e| is_sound(mesh, e))
}

/// Whether an element is strictly convex and positive.
fn is_sound(mesh: &Mesh, e: ElementId) -> bool {
    if mesh.is_triangle(e) {
        let [a, b, c] = mesh.triangle(e).map(|n| mesh.uv(n));
        return firm(a, b, c);
    }
    let [a, b, c, d] = mesh.quad(e).map(|n| mesh.uv(n));
    convex(a, b, c, d)
}

/// The worst quality of the elements at some nodes.
pub fn worst_quality(mesh: &Mesh, nodes: &Nodes) -> f64 {
    elements_around(mesh, nodes).iter().map(|&e| mesh.quality(e)).fold(f64::INFINITY, f64::min)
}
