//! The parity of the loops that a new quadrilateral touches (docs/algorithm.md, "Parity after formation").

use smallvec::SmallVec;

use crate::core::convert::event::Why;
use crate::core::mesh::{HalfEdgeId, Mesh, NodeId};

/// Whether every loop through the front segments of these nodes is even. All loops but the last one to close are
/// walked, all at the same pace: the last one follows from the parity of the component.
pub fn check(mesh: &Mesh, nodes: &[NodeId; 4]) -> Result<(), Why> {
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
