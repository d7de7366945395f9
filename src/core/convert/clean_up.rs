//! Clean-up of the structure around irregular nodes (spec 10, 2.11): diamond collapse, edge rotation, vertex opening and
//! the removal of doublets, each tried as a transaction and kept when the local energy falls.
//!
//! A worklist, not sweeps: the nodes whose valence is not ideal, and again the neighbours of whatever changed.

use std::sync::Arc;

use glam::DVec2;
use smallvec::SmallVec;

use super::energy;
use super::event::{Cleaning, Event};
use super::settle::{Nodes, elements_around, put, settle};
use super::worklist::{ListMark, Worklist};
use crate::core::mesh::half_edge::Mesh;
use crate::core::mesh::ids::{HalfEdgeId, NodeId};
use crate::core::mesh::operators::Refusal;
use crate::core::metric::field::MetricSource;
use crate::core::metric::measure::angle;

/// A kept change must leave every element around at least this quality, or not worse than the worst before.
const LEAST_QUALITY: f64 = 0.2;
/// The energy must fall by this much: differences below it are noise of the relaxation.
const LEAST_GAIN: f64 = 1e-2;
/// Candidates tried at one node, best valence gain first.
const MOST_TRIALS: usize = 16;
/// An element below this quality is poor.
const POOR: f64 = 0.4;

/// What the clean-up did, by operation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CleanedUp {
    /// Diamonds collapsed.
    pub collapses: usize,
    /// Edges rotated.
    pub rotations: usize,
    /// Vertices opened.
    pub openings: usize,
    /// Doublets removed.
    pub doublets: usize,
    /// Trials taken back.
    pub refused: usize,
}

/// One change to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Candidate {
    Doublet(NodeId),
    Collapse(HalfEdgeId),
    Rotate(HalfEdgeId, usize),
    Open(HalfEdgeId, HalfEdgeId),
}

/// Valence that fits the angle of the domain at each fixed node: round(theta / 90 degrees) + 1; 0 for free nodes.
fn boundary_ideals(mesh: &Mesh) -> Vec<u8> {
    let mut ideal = vec![0; mesh.node_slots()];
    for node in mesh.nodes().filter(|&n| mesh.is_fixed(n)) {
        let p = mesh.uv(node);
        let theta: f64 = mesh
            .fan(node)
            .map(|h| {
                let (next, previous) = (mesh.target(h), mesh.origin(mesh.previous(h)));
                angle(mesh.metric_ref(node), mesh.uv(next) - p, mesh.uv(previous) - p)
            })
            .sum();
        ideal[node.index()] = (theta / std::f64::consts::FRAC_PI_2).round().max(1.0) as u8 + 1;
    }
    ideal
}

/// The clean-up of an all-quadrilateral mesh under way: until no candidate lowers the energy, within a budget linear in the
/// size of the mesh.
#[derive(Clone)]
pub(super) struct CleanUp<'a> {
    source: Arc<dyn MetricSource + Send + Sync + 'a>,
    /// Ideal valence of fixed nodes.
    ideal: Vec<u8>,
    /// Irregular nodes.
    list: Worklist,
    done: CleanedUp,
}

/// A candidate that was kept.
struct Kept {
    /// Nodes whose surroundings changed.
    touched: Nodes,
    event: Event,
}

impl<'a> CleanUp<'a> {
    /// A clean-up at its beginning, whose list writes down what it needs to be taken back where `recording`.
    pub fn begin(mesh: &Mesh, source: Arc<dyn MetricSource + Send + Sync + 'a>, recording: bool) -> CleanUp<'a> {
        // Energy falls with every kept change, so this ends by itself; the budget bounds the time on hostile input.
        let list = Worklist::new(20 * mesh.node_count() + 1000, recording);
        let mut work = CleanUp { source, ideal: boundary_ideals(mesh), list, done: CleanedUp::default() };
        mesh.nodes().for_each(|node| work.enqueue(mesh, node));
        work
    }

    /// One change of structure: looks at the nodes that wait until a candidate is kept. None where no node waits any more.
    pub fn step(&mut self, mesh: &mut Mesh, keep_journal: bool) -> Option<Event> {
        while let Some(node) = self.list.take() {
            let event = if mesh.has_node(node) { self.mend(mesh, node) } else { None };
            if !keep_journal {
                mesh.commit();
            }
            if event.is_some() {
                return event;
            }
        }
        None
    }

    /// What was done so far.
    pub fn done(&self) -> CleanedUp {
        self.done
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.ideal.capacity() + self.list.bytes()
    }

    pub fn list(&self) -> &Worklist {
        &self.list
    }

    pub fn list_mut(&mut self) -> &mut Worklist {
        &mut self.list
    }

    /// Takes the list back to a mark, at which `done` was done.
    pub fn take_back(&mut self, mark: ListMark, done: CleanedUp) {
        self.list.take_back(mark);
        self.done = done;
    }
}

impl CleanUp<'_> {
    fn ideal(&self, mesh: &Mesh, node: NodeId) -> i32 {
        if mesh.is_fixed(node) { i32::from(self.ideal[node.index()]) } else { 4 }
    }

    /// Valence less the ideal one.
    fn excess(&self, mesh: &Mesh, node: NodeId) -> i32 {
        mesh.valence(node) as i32 - self.ideal(mesh, node)
    }

    fn enqueue(&mut self, mesh: &Mesh, node: NodeId) {
        if !self.list.holds(node) && self.excess(mesh, node) != 0 {
            self.list.add(node);
        }
    }

    /// Tries the candidates around one irregular node, best valence gain first, and keeps the first that is good.
    fn mend(&mut self, mesh: &mut Mesh, node: NodeId) -> Option<Event> {
        let mut candidates = self.candidates(mesh, node);
        candidates.sort_unstable();
        candidates.truncate(MOST_TRIALS);
        let Kept { touched, event } =
            candidates.into_iter().find_map(|(_, candidate)| self.attempt(mesh, candidate))?;
        for node in touched {
            let around: Nodes = mesh.neighbours(node).collect();
            for n in around {
                self.enqueue(mesh, n);
            }
            self.enqueue(mesh, node);
        }
        Some(event)
    }

    /// Changes around a node that do not raise the sum of squared excesses (or only by two where an element there is
    /// poor), with their gain: negative is better.
    fn candidates(&self, mesh: &Mesh, node: NodeId) -> SmallVec<[(i32, Candidate); 32]> {
        let mut found = SmallVec::new();
        if !mesh.is_fixed(node) && mesh.fan(node).count() == 2 {
            found.push((-100, Candidate::Doublet(node)));
            return found;
        }
        let change = |n: NodeId, by: i32| {
            let e = self.excess(mesh, n);
            (e + by) * (e + by) - e * e
        };
        // Where an element is poor a worse structure may be the better mesh.
        let spokes: SmallVec<[HalfEdgeId; 8]> = mesh.fan(node).collect();
        let worst = spokes.iter().map(|h| mesh.quality(h.element())).fold(f64::INFINITY, f64::min);
        let most_gain = if worst < POOR { 2 } else { 0 };
        let mut push = |gain: i32, candidate: Candidate| {
            if gain <= most_gain {
                found.push((gain, candidate));
            }
        };
        for &h in &spokes {
            let e = h.element();
            if !mesh.is_quad(e) {
                continue;
            }
            // Both diagonals of the element, both directions.
            for h_ab in mesh.half_edges(e) {
                let h_bc = mesh.next(h_ab);
                let (a, b, c, d) =
                    (mesh.origin(h_ab), mesh.origin(h_bc), mesh.target(h_bc), mesh.origin(mesh.previous(h_ab)));
                if !mesh.is_fixed(a) && (mesh.is_fixed(c) || a < c || mesh.is_fixed(a)) {
                    let (e_a, e_c) = (self.excess(mesh, a), self.excess(mesh, c));
                    let merged = e_c + mesh.valence(a) as i32 - 2;
                    push(
                        merged * merged - e_a * e_a - e_c * e_c + change(b, -1) + change(d, -1),
                        Candidate::Collapse(h_ab),
                    );
                }
                if let Ok(n) = mesh.hexagon(h_ab) {
                    // An edge between two elements of the star is met from both sides: once is enough.
                    let away = change(n[0], -1) + change(n[3], -1);
                    push(away + change(n[1], 1) + change(n[4], 1), Candidate::Rotate(h_ab, 1));
                    push(away + change(n[2], 1) + change(n[5], 1), Candidate::Rotate(h_ab, 2));
                }
            }
        }
        // Openings of a node with too many edges.
        if self.excess(mesh, node) > 0 {
            let n = spokes.len();
            for i in 0..n {
                for count in 2..n.saturating_sub(1) {
                    let k = i + count;
                    if k >= n && mesh.is_fixed(node) {
                        break;
                    }
                    let (h_vp, h_vq) = (spokes[i], spokes[k % n]);
                    let (e_v, handed) = (self.excess(mesh, node), count as i32);
                    // v keeps n - count elements and gains the new one; w has count + 1 of them.
                    let v_after = e_v - handed + 1;
                    let w_after = handed + 1 - 4;
                    let gain = v_after * v_after + w_after * w_after - e_v * e_v
                        + change(mesh.target(h_vp), 1)
                        + change(mesh.target(h_vq), 1);
                    push(gain, Candidate::Open(h_vp, h_vq));
                }
            }
        }
        found
    }

    /// Does a candidate, relaxes the nodes around, and keeps it if the energy falls; else takes all of it back.
    fn attempt(&mut self, mesh: &mut Mesh, candidate: Candidate) -> Option<Kept> {
        let mut core = core_nodes(mesh, candidate);
        let (energy_before, quality_before) = self.patch(mesh, &core);
        let mark = mesh.mark();
        let done = self.apply(mesh, candidate, &mut core).ok().filter(|_| settle(mesh, &*self.source, &core));
        let kept = done.and_then(|what| {
            let (energy, quality) = self.patch(mesh, &core);
            let falls = energy < energy_before - LEAST_GAIN && quality >= quality_before.min(LEAST_QUALITY);
            falls.then_some(Event::Cleaned { what, energy: [energy_before, energy] })
        });
        let Some(event) = kept else {
            mesh.take_back(mark);
            self.done.refused += 1;
            return None;
        };
        match candidate {
            Candidate::Doublet(_) => self.done.doublets += 1,
            Candidate::Collapse(_) => self.done.collapses += 1,
            Candidate::Rotate(..) => self.done.rotations += 1,
            Candidate::Open(..) => self.done.openings += 1,
        }
        Some(Kept { touched: core, event })
    }

    /// Does the change of structure; `core` becomes the nodes that it leaves.
    fn apply(&self, mesh: &mut Mesh, candidate: Candidate, core: &mut Nodes) -> Result<Cleaning, Refusal> {
        Ok(match candidate {
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
                    put_or_refuse(mesh, &*self.source, c, middle)?;
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
                    put_or_refuse(mesh, &*self.source, node, here + (middle - here) * 0.33)?;
                }
                core.push(w);
                Cleaning::VertexOpened { node: v, new: w, along: [p, q] }
            }
        })
    }

    /// Energy of everything that depends on the core nodes, and the worst quality of the elements there.
    fn patch(&self, mesh: &Mesh, core: &Nodes) -> (f64, f64) {
        let (mut sum, mut quality) = (0.0, f64::INFINITY);
        for e in elements_around(mesh, core) {
            sum += energy::of_element(mesh, e);
            quality = quality.min(mesh.quality(e));
        }
        for (k, &node) in core.iter().enumerate() {
            let excess = f64::from(self.excess(mesh, node));
            sum += excess * excess;
            for n in mesh.neighbours(node) {
                if !core[..k].contains(&n) {
                    sum += energy::of_edge(mesh, node, n);
                }
            }
        }
        (sum, quality)
    }
}

/// The nodes whose elements a candidate changes: those are relaxed, and compared before and after.
fn core_nodes(mesh: &Mesh, candidate: Candidate) -> Nodes {
    let mut core = Nodes::new();
    let mut add = |n: NodeId| {
        if !core.contains(&n) {
            core.push(n);
        }
    };
    match candidate {
        Candidate::Doublet(node) => {
            mesh.fan(node).for_each(|h| mesh.corners(h.element()).for_each(&mut add));
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

fn put_or_refuse(mesh: &mut Mesh, source: &dyn MetricSource, node: NodeId, uv: DVec2) -> Result<(), Refusal> {
    if put(mesh, source, node, uv) { Ok(()) } else { Err(Refusal::NotPositive) }
}
