//! What two meshes have in common.

use rustc_hash::FxHashSet;

use super::places::{Place, Places};
use crate::core::mesh::{ElementId, Mesh, NodeId};

/// The quadrilaterals that two meshes have in common.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Overlap {
    /// How many both have: their corners lie within [`NEAR`](super::NEAR) of each other.
    pub both: usize,
    /// Those that only the first mesh has, and those that only the second one has, in the order of their ids.
    pub only: [Vec<ElementId>; 2],
}

impl Overlap {
    /// Compares the quadrilaterals of two meshes by the places of their nodes in the parametric plane.
    pub fn of(a: &Mesh, b: &Mesh) -> Overlap {
        let [first, second] = [a, b].map(quads);
        let nodes: Vec<NodeId> = a.nodes().collect();
        let places = Places::of(nodes.iter().map(|node| Place::of(a, *node)).collect());
        let mut near = vec![None; b.node_slots()];
        b.nodes().for_each(|node| near[node.index()] = places.nearest(b.uv(node)).map(|k| nodes[k]));
        let corners_in_a = |corners: [NodeId; 4]| -> Option<[NodeId; 4]> {
            let mut found = corners;
            for node in &mut found {
                *node = near[node.index()]?;
            }
            found.sort_unstable();
            Some(found)
        };
        let mut of_b = FxHashSet::default();
        let mut only_b = Vec::new();
        let of_a: FxHashSet<[NodeId; 4]> = first.iter().map(|quad| quad.1).collect();
        for &(element, corners) in &second {
            // Two quadrilaterals of B that lie near one of A count once.
            match corners_in_a(corners).filter(|corners| of_a.contains(corners)) {
                Some(corners) if of_b.insert(corners) => {}
                _ => only_b.push(element),
            }
        }
        let only_a = first.iter().filter(|quad| !of_b.contains(&quad.1)).map(|quad| quad.0).collect();
        Overlap { both: of_b.len(), only: [only_a, only_b] }
    }

    /// The share of the quadrilaterals that both have among those of either; 1 where there are none.
    pub fn share(&self) -> f64 {
        let all = self.both + self.only[0].len() + self.only[1].len();
        if all == 0 { 1.0 } else { self.both as f64 / all as f64 }
    }
}

/// The quadrilaterals of a mesh with their corners, sorted.
fn quads(mesh: &Mesh) -> Vec<(ElementId, [NodeId; 4])> {
    let sorted = |element: ElementId| {
        let mut corners = [NodeId(0); 4];
        for (corner, node) in corners.iter_mut().zip(mesh.corners(element)) {
            *corner = node;
        }
        corners.sort_unstable();
        (element, corners)
    };
    mesh.elements().filter(|e| mesh.is_quad(*e)).map(sorted).collect()
}
