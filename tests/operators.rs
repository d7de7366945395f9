//! Promise: any sequence of operators keeps the checks, and taking back gives identical bytes.
#![allow(clippy::unwrap_used)]

#[path = "common/environment.rs"]
mod environment;

use glam::DVec2;
use proptest::prelude::*;
use quadfront::core::kernel::Metric2;
use quadfront::core::mesh::{ElementId, HalfEdgeId, Mesh, NewElement, NodeId, PointId, Refusal, TriangleSet};

/// A grid of `n` by `n` squares, each cut along one diagonal chosen by the bits, its inner nodes moved a little; from
/// three squares a side on, the middle one is a hole.
fn jittered_grid(n: u32, bits: u64, jitter: &[(f64, f64)]) -> Mesh {
    let side = n + 1;
    let mut set = TriangleSet::default();
    for y in 0..side {
        for x in 0..side {
            let k = (y * side + x) as usize;
            let inner = x > 0 && y > 0 && x < n && y < n;
            let (dx, dy) = if inner { jitter[k % jitter.len()] } else { (0.0, 0.0) };
            set.uv.push(DVec2::new(f64::from(x) + 0.24 * dx, f64::from(y) + 0.24 * dy));
            set.point.push(PointId(k as u32));
        }
    }
    for y in 0..n {
        for x in 0..n {
            let a = y * side + x;
            let (b, c, d) = (a + 1, a + side + 1, a + side);
            if x == n / 2 && y == n / 2 && n > 2 {
                continue; // A hole.
            }
            if bits >> ((y * n + x) % 64) & 1 == 0 {
                set.triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                set.triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    set.region = vec![0; set.triangles.len()];
    let metric = set.uv.iter().map(|p| Metric2::isotropic(1.0 + 0.1 * p.x)).collect();
    Mesh::from_triangles(&set, metric)
}

fn bytes(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    mesh.write_state(&mut bytes);
    bytes
}

/// One operation on whatever the numbers happen to name; refusals are fine.
#[derive(Clone, Copy, Debug)]
enum Operation {
    Swap(usize),
    Collapse(usize),
    Divide(usize, f64),
    Delete(usize),
    Move(usize, f64, f64),
    Merge(usize),
    Diamond(usize),
    Rotate(usize, usize),
    Open(usize, usize),
}

fn operation() -> impl Strategy<Value = Operation> {
    let any = 0..10_000_usize;
    prop_oneof![
        any.clone().prop_map(Operation::Swap),
        any.clone().prop_map(Operation::Collapse),
        (any.clone(), 0.1..0.9).prop_map(|(k, t)| Operation::Divide(k, t)),
        any.clone().prop_map(Operation::Delete),
        (any.clone(), -0.5..0.5, -0.5..0.5).prop_map(|(k, x, y)| Operation::Move(k, x, y)),
        any.clone().prop_map(Operation::Merge),
        any.clone().prop_map(Operation::Diamond),
        (any.clone(), 1..3_usize).prop_map(|(k, by)| Operation::Rotate(k, by)),
        (any.clone(), 2..5_usize).prop_map(|(k, n)| Operation::Open(k, n)),
    ]
}

fn pick<T: Copy>(all: &[T], k: usize) -> Option<T> {
    (!all.is_empty()).then(|| all[k % all.len()])
}

fn half_edge(mesh: &Mesh, k: usize) -> Option<HalfEdgeId> {
    let all: Vec<HalfEdgeId> = mesh.elements().flat_map(|e| mesh.half_edges(e)).collect();
    pick(&all, k)
}

/// Does the operation; says whether the result is only sound in structure (and may be inverted).
fn apply(mesh: &mut Mesh, operation: Operation) -> Option<bool> {
    let metric = Metric2::isotropic(1.0);
    let nodes: Vec<NodeId> = mesh.nodes().collect();
    match operation {
        Operation::Swap(k) => {
            let h = half_edge(mesh, k)?;
            mesh.can_swap(h).ok()?;
            let new = mesh.swap(h);
            assert_eq!(mesh.twin(mesh.twin(new).unwrap()), Some(new));
        }
        Operation::Collapse(k) => {
            let h = half_edge(mesh, k)?;
            let at = mesh.uv(mesh.target(h));
            mesh.can_collapse(h, at).ok()?;
            mesh.collapse(h, at, metric);
        }
        Operation::Divide(k, t) => {
            let h = half_edge(mesh, k)?;
            let at = mesh.uv(mesh.origin(h)).lerp(mesh.uv(mesh.target(h)), t);
            let m = mesh.divide(h, at, metric).ok()?;
            assert_eq!(mesh.valence(m), 4);
        }
        Operation::Delete(k) => {
            mesh.delete_node(pick(&nodes, k)?).ok()?;
        }
        Operation::Move(k, x, y) => {
            let node = pick(&nodes, k)?;
            let at = mesh.uv(node) + DVec2::new(x, y);
            mesh.can_move(node, at).ok()?;
            mesh.move_node(node, at, metric);
        }
        Operation::Merge(k) => {
            let h = half_edge(mesh, k)?;
            let t = mesh.twin(h)?;
            let (e, f) = (h.element(), t.element());
            if !mesh.is_triangle(e) || !mesh.is_triangle(f) {
                return None;
            }
            let (c, d) = (mesh.origin(mesh.previous(h)), mesh.origin(mesh.previous(t)));
            let quad = [mesh.origin(h), d, mesh.origin(t), c];
            let [a, b, c, d] = quad.map(|n| mesh.uv(n));
            if !quadfront::core::kernel::predicates::convex(a, b, c, d) {
                return None;
            }
            mesh.replace(&[e, f], &[NewElement::quad(quad, 0)]);
        }
        Operation::Diamond(k) => {
            mesh.collapse_diamond(half_edge(mesh, k)?).ok()?;
            return Some(true);
        }
        Operation::Rotate(k, by) => {
            mesh.rotate_edge(half_edge(mesh, k)?, by).ok()?;
            return Some(true);
        }
        Operation::Open(k, n) => {
            let node = pick(&nodes, k)?;
            let spokes: Vec<HalfEdgeId> = mesh.fan(node).collect();
            let (p, q) = (spokes[k % spokes.len()], spokes[(k + n) % spokes.len()]);
            let uv = mesh.uv(node);
            mesh.open_vertex(p, q, uv, metric).ok()?;
            return Some(true);
        }
    }
    Some(false)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: environment::number("QUADFRONT_SOAK_ROUNDS").unwrap_or(300) as u32, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_sequence_of_operators_keeps_the_checks_and_is_taken_back_exactly(
        n in 1..7_u32,
        bits in any::<u64>(),
        jitter in prop::collection::vec((-1.0..1.0, -1.0..1.0), 7),
        operations in prop::collection::vec(operation(), 1..80),
    ) {
        let mut mesh = jittered_grid(n, bits, &jitter);
        mesh.check().unwrap();
        let at_first = euler(&mesh);
        let (start, at_start) = (mesh.mark(), bytes(&mesh));
        let mut stops = vec![(start, at_start)];
        for operation in operations {
            let (mark, before) = (mesh.mark(), bytes(&mesh));
            match apply(&mut mesh, operation) {
                // A refused operation changes nothing.
                None => prop_assert!(bytes(&mesh) == before, "{operation:?} was refused and left a trace"),
                Some(structure_only) => {
                    let sound = mesh.check();
                    if sound.is_err() && structure_only {
                        // Inverted elements are the caller's business; everything else must hold.
                        prop_assert!(sound.as_ref().unwrap_err().contains("not strictly positive"), "{operation:?}: {sound:?}");
                        mesh.take_back(mark);
                        prop_assert!(bytes(&mesh) == before);
                    } else {
                        prop_assert!(sound.is_ok(), "{operation:?}: {sound:?}");
                        stops.push((mesh.mark(), bytes(&mesh)));
                    }
                    prop_assert_eq!(euler(&mesh), at_first, "{:?}", operation);
                }
            }
        }
        for (mark, state) in stops.into_iter().rev() {
            mesh.take_back(mark);
            prop_assert!(bytes(&mesh) == state);
        }
    }
}

fn euler(mesh: &Mesh) -> i64 {
    mesh.node_count() as i64 - mesh.edges().count() as i64 + mesh.element_count() as i64
}

/// Many more in `make soak`.
fn two_triangles() -> Mesh {
    let set = TriangleSet {
        uv: vec![DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y],
        point: (0..4).map(PointId).collect(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        region: vec![0; 2],
        ..TriangleSet::default()
    };
    Mesh::from_triangles(&set, vec![Metric2::isotropic(1.0); 4])
}

#[test]
fn swapping_joins_the_opposite_nodes_as_in_fig_5() {
    let mut mesh = two_triangles();
    let h = mesh.half_edge_between(NodeId(0), NodeId(2)).unwrap();
    mesh.can_swap(h).unwrap();
    mesh.swap(h);
    assert!(mesh.are_joined(NodeId(1), NodeId(3)) && !mesh.are_joined(NodeId(0), NodeId(2)));
    mesh.check().unwrap();
}

#[test]
fn a_swap_that_would_make_a_straight_angle_is_refused() {
    let set = TriangleSet {
        uv: vec![DVec2::ZERO, DVec2::X, DVec2::new(2.0, 0.0), DVec2::new(1.0, 1.0)],
        point: (0..4).map(PointId).collect(),
        triangles: vec![[0, 1, 3], [1, 2, 3]],
        region: vec![0; 2],
        ..TriangleSet::default()
    };
    let mesh = Mesh::from_triangles(&set, vec![Metric2::isotropic(1.0); 4]);
    let h = mesh.half_edge_between(NodeId(1), NodeId(3)).unwrap();
    assert_eq!(mesh.can_swap(h), Err(Refusal::NotPositive));
}

#[test]
fn division_makes_four_elements_of_two_as_in_fig_7_and_collapsing_makes_two_again_as_in_fig_6() {
    let mut mesh = two_triangles();
    let h = mesh.half_edge_between(NodeId(0), NodeId(2)).unwrap();
    let m = mesh.divide(h, DVec2::splat(0.5), Metric2::isotropic(1.0)).unwrap();
    assert_eq!((mesh.element_count(), mesh.node_count()), (4, 5));
    mesh.check().unwrap();
    let h = mesh.half_edge_between(m, NodeId(0)).unwrap();
    mesh.can_collapse(h, DVec2::ZERO).unwrap();
    mesh.collapse(h, DVec2::ZERO, Metric2::isotropic(1.0));
    assert_eq!((mesh.element_count(), mesh.node_count()), (2, 4));
    mesh.check().unwrap();
}

#[test]
fn deleting_a_node_of_four_elements_leaves_the_shorter_diagonal_as_in_fig_8() {
    let mut set = TriangleSet {
        uv: vec![DVec2::ZERO, DVec2::new(3.0, 0.0), DVec2::new(3.2, 1.0), DVec2::new(0.2, 1.0), DVec2::new(1.6, 0.5)],
        point: (0..5).map(PointId).collect(),
        triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        region: vec![0; 4],
        ..TriangleSet::default()
    };
    let mut mesh = Mesh::from_triangles(&set, vec![Metric2::isotropic(1.0); 5]);
    assert_eq!(mesh.delete_node(NodeId(4)).unwrap().len(), 2);
    assert!(mesh.are_joined(NodeId(1), NodeId(3)), "the shorter diagonal");
    mesh.check().unwrap();
    // Three elements become one.
    set.uv = vec![DVec2::ZERO, DVec2::new(2.0, 0.0), DVec2::new(1.0, 2.0), DVec2::new(1.0, 0.5)];
    set.point.truncate(4);
    set.triangles = vec![[0, 1, 3], [1, 2, 3], [2, 0, 3]];
    set.region.truncate(3);
    let mut mesh = Mesh::from_triangles(&set, vec![Metric2::isotropic(1.0); 4]);
    assert_eq!(mesh.delete_node(NodeId(3)).unwrap().to_vec(), [ElementId(2)]);
    assert_eq!((mesh.element_count(), mesh.node_count()), (1, 3));
    mesh.check().unwrap();
}
