//! Smoothing around a new quadrilateral (4.3.6, eqs. 9 and 10).

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use quadfront::core::case::SmoothingWeights;
use quadfront::core::convert::{Converter, Event, Phase};
use quadfront::core::mesh::{Mesh, NodeId};

use crate::oracle::{Matrix, angle, norm};

/// How many nodes were held against the oracle.
#[derive(Debug, Default)]
pub struct Smoothings {
    pub moved: usize,
    /// Nodes of the second group: joined to the quadrilateral by dead elements alone.
    pub joined: usize,
    /// Nodes that stay, though the formula wants them elsewhere: the guards refused every step.
    pub refused: usize,
}

/// What a smoothing may touch, before it.
#[derive(Debug)]
pub struct Before {
    /// The nodes that it looks at, in the paper's order, and how many of them are in the first two groups.
    nodes: Vec<NodeId>,
    groups: [usize; 2],
    elements: Vec<Vec<NodeId>>,
    places: BTreeMap<NodeId, (DVec2, Matrix)>,
}

fn place(mesh: &Mesh, n: NodeId) -> (DVec2, Matrix) {
    let m = mesh.metric(n);
    (mesh.uv(n), [m.uu, m.uv, m.vv])
}

/// The state before a step that may smooth.
pub fn before(state: &Converter<'_>) -> Option<Before> {
    // An enhancement that finds nothing goes on to the smoothing in the same step.
    let (Phase::Enhance { element, .. } | Phase::Smooth { element, .. }) = *state.phase() else { return None };
    let (mesh, parameters) = (&state.mesh, state.parameters());
    let quad = mesh.quad(element);
    let mut nodes: Vec<NodeId> = Vec::new();
    let add = |nodes: &mut Vec<NodeId>, n: NodeId| {
        if !quad.contains(&n) && !nodes.contains(&n) {
            nodes.push(n);
        }
    };
    // Anticlockwise around each corner, as the mesh turns.
    for corner in quad {
        for h in mesh.fan(corner).filter(|h| mesh.is_triangle(h.element())) {
            let n = mesh.triangle(h.element());
            let k = n.iter().position(|&n| n == corner).unwrap();
            add(&mut nodes, n[(k + 1) % 3]);
            add(&mut nodes, n[(k + 2) % 3]);
        }
    }
    let of_triangles = nodes.len();
    if parameters.smooth_joined {
        for corner in quad {
            mesh.neighbours(corner).for_each(|n| add(&mut nodes, n));
        }
    }
    let groups = [of_triangles, nodes.len()];
    nodes.extend(quad);
    let around: BTreeSet<_> = nodes.iter().flat_map(|&n| mesh.elements_at(n)).collect();
    let elements: Vec<Vec<NodeId>> = around.into_iter().map(|e| mesh.corners(e).collect()).collect();
    let places = elements.iter().flatten().map(|&n| (n, place(mesh, n))).collect();
    Some(Before { nodes, groups, elements, places })
}

/// The place where eq. 9 wants a node.
fn target(node: NodeId, before: &Before, weights: SmoothingWeights) -> DVec2 {
    let at = |n: &NodeId| before.places[n];
    let (p, m) = at(&node);
    let (mut sum, mut areas) = (DVec2::ZERO, 0.0);
    for element in before.elements.iter().filter(|e| e.contains(&node)) {
        let k = element.iter().position(|&n| n == node).unwrap();
        let others: Vec<NodeId> = (1..element.len()).map(|i| element[(k + i) % element.len()]).collect();
        let centroid = element.iter().map(|n| at(n).0).sum::<DVec2>() / element.len() as f64;
        let area = match weights {
            // Eqs. 10a and 10b.
            SmoothingWeights::Printed => {
                let length = |n: &NodeId| {
                    let d = at(n).0 - p;
                    let [a, b] = [m, at(n).1].map(|m| norm(m, d));
                    (4.0 * (a * b).sqrt() + a + b) / 6.0
                };
                let part = |i: usize| {
                    let [a, b] = [&others[i], &others[i + 1]];
                    0.5 * length(a) * length(b) * libm::sin(angle(m, at(a).0 - p, at(b).0 - p))
                };
                (0..others.len() - 1).map(part).sum::<f64>()
            }
            // The area in the plane by the shoelace formula, times the mean of the roots of the determinants.
            SmoothingWeights::Determinant => {
                let roots: f64 = element.iter().map(|n| at(n).1).map(|[a, b, c]| (a * c - b * b).sqrt()).sum();
                let next = |i: usize| at(&element[(i + 1) % element.len()]).0 - p;
                let twice: f64 = (0..element.len()).map(|i| (at(&element[i]).0 - p).perp_dot(next(i))).sum();
                0.5 * twice * roots / element.len() as f64
            }
        };
        sum += centroid * area;
        areas += area;
    }
    sum / areas
}

impl Smoothings {
    /// Holds a smoothing against the formulas, node by node in its order.
    pub fn examine(&mut self, before: Option<Before>, state: &Converter<'_>, event: &Event) {
        let (Some(mut before), Event::Smoothed { nodes: told }) = (before, event) else { return };
        let (mesh, parameters) = (&state.mesh, state.parameters());
        let mut moved = 0;
        for (k, node) in before.nodes.clone().into_iter().enumerate() {
            let is_corner = k >= before.groups[1];
            let here = before.places[&node].0;
            let after = place(mesh, node);
            let has_moved = after.0 != here;
            moved += u8::from(has_moved);
            // With placement, nodes of the front stay, and nodes that the quadrilateral buried are relaxed instead.
            let is_buried = before.elements.iter().filter(|e| e.contains(&node)).all(|e| e.len() == 4);
            let stays = !is_buried && mesh.is_on_front(node);
            let by_formula = !mesh.is_fixed(node) && (!parameters.placement || !(is_corner || stays));
            if by_formula {
                let there = target(node, &before, parameters.smoothing_weights);
                let is = |share: f64| (after.0 - (here + (there - here) * share)).length();
                let scale = 1e-9 * (there - here).length().max(1e-6);
                if has_moved {
                    assert!([1.0, 0.5, 0.25, 0.125].iter().any(|&share| is(share) < scale), "{node:?} {event:?}");
                    self.moved += 1;
                    self.joined += usize::from((before.groups[0]..before.groups[1]).contains(&k));
                } else {
                    self.refused += usize::from(norm(before.places[&node].1, there - here) > 1.001e-3);
                }
            } else if mesh.is_fixed(node) || !is_corner {
                assert!(!has_moved, "{node:?} {event:?}");
            }
            before.places.insert(node, after);
        }
        assert_eq!(moved, *told);
    }
}
