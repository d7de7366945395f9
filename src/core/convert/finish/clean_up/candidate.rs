//! The changes of structure that the clean-up tries, and what each does to the valences.

use glam::DVec2;
use smallvec::SmallVec;

use crate::core::convert::event::Cleaning;
use crate::core::convert::relax::{Nodes, put};
use crate::core::mesh::{HalfEdgeId, Mesh, NodeId, Refusal};
use crate::core::metric::MetricSource;
use crate::core::metric::measure::angle;

/// One change to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Candidate {
    /// The two elements of an inner node with two edges become one.
    Doublet(NodeId),
    /// The element's node at the start of the half-edge is merged with the opposite one.
    Collapse(HalfEdgeId),
    /// The edge is rotated within its hexagon, by one place or two.
    Rotate(HalfEdgeId, usize),
    /// The elements between the two edges of a node get a node of their own, and a new element opens between.
    Open(HalfEdgeId, HalfEdgeId),
}

/// A candidate with the change of the sum of squared excesses: negative is better.
pub type Ranked = (i32, Candidate);

/// The number of elements that fits each node.
#[derive(Clone, Debug)]
pub struct Valences {
    /// For nodes on boundaries, by id; others want four.
    ideal: Vec<u8>,
}

impl Valences {
    /// Elements that fit the angle of the domain at each node on a boundary: round(theta / 90 degrees).
    pub fn of(mesh: &Mesh) -> Valences {
        let mut ideal = vec![4; mesh.node_slots()];
        for node in mesh.nodes().filter(|&n| mesh.is_on_boundary(n)) {
            let p = mesh.uv(node);
            let theta: f64 = mesh
                .fan(node)
                .map(|h| {
                    let (next, previous) = (mesh.target(h), mesh.apex(h));
                    angle(mesh.metric_ref(node), mesh.uv(next) - p, mesh.uv(previous) - p)
                })
                .sum();
            ideal[node.index()] = (theta / std::f64::consts::FRAC_PI_2).round().max(1.0) as u8;
        }
        Valences { ideal }
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        self.ideal.capacity()
    }

    /// Elements at a node less those that fit it.
    #[inline]
    pub fn excess(&self, mesh: &Mesh, node: NodeId) -> i32 {
        self.excess_of(node, mesh.fan(node).count())
    }

    /// As [`excess`](Valences::excess), from the number of elements.
    #[inline]
    pub fn excess_of(&self, node: NodeId, elements: usize) -> i32 {
        // A node made since is free.
        elements as i32 - self.ideal.get(node.index()).map_or(4, |&ideal| i32::from(ideal))
    }

    /// The `most` best changes around a node that raise the sum of squared excesses by at most `worse`, best first.
    pub fn candidates(&self, mesh: &Mesh, node: NodeId, worse: i32, most: usize) -> SmallVec<[Ranked; 32]> {
        let mut found: SmallVec<[Ranked; 32]> = SmallVec::new();
        let spokes: SmallVec<[HalfEdgeId; 8]> = mesh.fan(node).collect();
        if !mesh.is_fixed(node) && spokes.len() == 2 {
            found.push((-100, Candidate::Doublet(node)));
            return found;
        }
        let mut push = |gain: i32, candidate: Candidate| {
            if gain <= worse {
                found.push((gain, candidate));
            }
        };
        let change = |n: NodeId, by: i32| {
            let e = self.excess(mesh, n);
            (e + by) * (e + by) - e * e
        };
        for h in spokes.iter().filter(|h| mesh.is_quad(h.element())) {
            // Both diagonals of the element, both directions.
            for h_ab in mesh.half_edges(h.element()) {
                let h_bc = mesh.next(h_ab);
                let (a, b, c, d) = (mesh.origin(h_ab), mesh.origin(h_bc), mesh.target(h_bc), mesh.apex(h_ab));
                if !mesh.is_fixed(a) && (mesh.is_fixed(c) || a < c) {
                    let (e_a, e_c) = (self.excess(mesh, a), self.excess(mesh, c));
                    // c takes over the elements of a but for the one that goes, and loses that one itself.
                    let merged = e_a + e_c + 2;
                    push(
                        merged * merged - e_a * e_a - e_c * e_c + change(b, -1) + change(d, -1),
                        Candidate::Collapse(h_ab),
                    );
                }
                if let Ok(n) = mesh.hexagon(h_ab) {
                    let away = change(n[0], -1) + change(n[3], -1);
                    push(away + change(n[1], 1) + change(n[4], 1), Candidate::Rotate(h_ab, 1));
                    push(away + change(n[2], 1) + change(n[5], 1), Candidate::Rotate(h_ab, 2));
                }
            }
        }
        // Openings of a node with too many elements.
        let excess = self.excess_of(node, spokes.len());
        if excess > 0 {
            let n = spokes.len();
            for i in 0..n {
                for count in 2..n.saturating_sub(1) {
                    let k = i + count;
                    if k >= n && mesh.is_on_boundary(node) {
                        break;
                    }
                    let (h_vp, h_vq) = (spokes[i], spokes[k % n]);
                    // v keeps n - count elements and gains the new one; w has count + 1 of them.
                    let (v_after, w_after) = (excess - count as i32 + 1, count as i32 - 3);
                    let gain = v_after * v_after + w_after * w_after - excess * excess
                        + change(mesh.target(h_vp), 1)
                        + change(mesh.target(h_vq), 1);
                    push(gain, Candidate::Open(h_vp, h_vq));
                }
            }
        }
        found.sort_unstable();
        found.truncate(most);
        found
    }

    /// Whether a change is one of the traditional operations: the elimination of a node with two elements, that of an
    /// element between two opposite nodes with three, or the rotation of an edge.
    pub fn is_traditional(&self, mesh: &Mesh, candidate: Candidate) -> bool {
        let lacks_one = |n| !mesh.is_fixed(n) && self.excess(mesh, n) == -1;
        match candidate {
            Candidate::Doublet(_) | Candidate::Rotate(..) => true,
            Candidate::Collapse(h) => lacks_one(mesh.origin(h)) && lacks_one(mesh.target(mesh.next(h))),
            Candidate::Open(..) => false,
        }
    }
}

impl Candidate {
    /// The nodes whose elements the change alters: those are settled, and compared before and after.
    pub fn core(self, mesh: &Mesh) -> Nodes {
        let mut core = Nodes::new();
        let mut add = |n: NodeId| {
            if !core.contains(&n) {
                core.push(n);
            }
        };
        match self {
            Candidate::Doublet(node) => {
                mesh.elements_at(node).for_each(|e| mesh.corners(e).for_each(&mut add));
            }
            Candidate::Collapse(h) => mesh.corners(h.element()).for_each(add),
            Candidate::Rotate(h, _) => {
                mesh.corners(h.element()).for_each(&mut add);
                mesh.twin(h).into_iter().for_each(|t| mesh.corners(t.element()).for_each(&mut add));
            }
            Candidate::Open(h_vp, h_vq) => {
                add(mesh.origin(h_vp));
                add(mesh.target(h_vp));
                add(mesh.target(h_vq));
            }
        }
        core
    }

    /// Does the change and says what it was; `core` becomes the nodes that it leaves.
    ///
    /// # Errors
    /// Where the operator refuses, or the field gives no metric at a node's new place: the rest is to be taken back.
    pub fn apply(self, mesh: &mut Mesh, source: &dyn MetricSource, core: &mut Nodes) -> Result<Cleaning, Refusal> {
        Ok(match self {
            Candidate::Doublet(node) => {
                mesh.remove_doublet(node)?;
                core.retain(|n| *n != node);
                Cleaning::DoubletRemoved { node }
            }
            Candidate::Collapse(h_ab) => {
                let (a, c) = (mesh.origin(h_ab), mesh.target(mesh.next(h_ab)));
                let middle = 0.5 * (mesh.uv(a) + mesh.uv(c));
                mesh.collapse_diamond(h_ab)?;
                core.retain(|n| *n != a);
                if !mesh.is_fixed(c) {
                    put_or_refuse(mesh, source, c, middle)?;
                }
                Cleaning::DiamondCollapsed { gone: a, kept: c }
            }
            Candidate::Rotate(h, by) => {
                let n = mesh.hexagon(h)?;
                mesh.rotate_edge(h, by)?;
                Cleaning::EdgeRotated { old: [n[0], n[3]], new: [n[by], n[by + 3]] }
            }
            Candidate::Open(h_vp, h_vq) => {
                let (v, p, q) = (mesh.origin(h_vp), mesh.target(h_vp), mesh.target(h_vq));
                let here = mesh.uv(v);
                let w = mesh.open_vertex(h_vp, h_vq, here, mesh.metric(v))?;
                // Each half goes a little towards the middle of its own neighbours.
                for node in [w, v] {
                    if mesh.is_fixed(node) {
                        continue;
                    }
                    let own: Nodes = mesh.neighbours(node).filter(|&n| n != p && n != q).collect();
                    let middle = own.iter().fold(DVec2::ZERO, |s, &n| s + mesh.uv(n)) / own.len().max(1) as f64;
                    put_or_refuse(mesh, source, node, here + (middle - here) * 0.33)?;
                }
                core.push(w);
                Cleaning::VertexOpened { node: v, new: w, along: [p, q] }
            }
        })
    }
}

fn put_or_refuse(mesh: &mut Mesh, source: &dyn MetricSource, node: NodeId, uv: DVec2) -> Result<(), Refusal> {
    if put(mesh, source, node, uv) { Ok(()) } else { Err(Refusal::NotPositive) }
}
