//! Adaptation of the background mesh to unit edges in the metric (docs/algorithm.md, "Adaptation to the metric"): local
//! remeshing by split, collapse, swap and smooth.
//!
//! Boundary edges and nodes never change. Every operation is checked first (exactly where it is topological) and then
//! done; the metric only ranks. First a coarse mesh is refined by division of the longest edges with Delaunay swaps in
//! the metric, which creates nearly all nodes; then a few cycles of collapse, split, swap and smooth correct edges that
//! are not unit.

use glam::DVec2;
use smallvec::SmallVec;

use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::Metric2;
use crate::core::kernel::predicates::firm;
use crate::core::mesh::quality::{length_over, quality_over};
use crate::core::mesh::{HalfEdgeId, Mesh, NodeId};
use crate::core::metric::MetricSource;
use crate::core::metric::measure::triangle_quality;
use crate::core::progress::{Stage, Watch};

/// The largest and smallest length of a unit edge.
const LONG: f64 = std::f64::consts::SQRT_2;
const SHORT: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Below this number of elements edges are also measured at their middle, so that no thin zone of small sizes between
/// nodes is missed.
const SAMPLED: usize = 20_000;
/// Cycles of collapse, split, swap and smooth after the refinement.
const CYCLES: usize = 4;
/// If a refinement pass creates fewer nodes than one per this many elements, the next pass checks only their
/// neighbourhood.
const FEW: usize = 16;
/// A longer edge is divided whatever the quality of the new triangles (on surfaces).
const MUCH_TOO_LONG: f64 = 2.5;
/// A collapse or a split must not create a triangle worse than this, or than the worst of those that it replaces.
const LEAST_QUALITY: f64 = 0.4;
/// A division must not create a triangle worse than this, unless it is not much worse than the divided one: two thirds
/// worse at most if the divided side is the longest, less than half worse otherwise.
const POOR: f64 = 0.1;
const NOT_MUCH_WORSE: f64 = 0.55;

/// The numbers of operations of an adaptation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Adapted {
    /// Edges divided.
    pub divisions: usize,
    /// Nodes removed by collapsing an edge.
    pub collapses: usize,
    /// Edges swapped.
    pub swaps: usize,
    /// Nodes moved.
    pub moves: usize,
}

/// Adapts the mesh to the metric until its edges are unit, as far as the fixed boundary allows.
///
/// # Errors
/// If the metric fails inside the domain or requires more than `most_elements` triangles.
pub fn adapt(
    mesh: Mesh,
    source: &dyn MetricSource,
    most_elements: usize,
    watch: &mut dyn Watch,
) -> Result<(Mesh, Adapted), Fault> {
    let mut adapter =
        Adapter { mesh, source, most_elements, done: Adapted::default(), stack: Vec::new(), quality: Vec::new() };
    adapter.mesh.set_recording(false);
    adapter.run(watch)?;
    adapter.mesh.set_recording(true);
    Ok((adapter.mesh, adapter.done))
}

struct Adapter<'a> {
    mesh: Mesh,
    source: &'a dyn MetricSource,
    most_elements: usize,
    done: Adapted,
    /// Candidates for swaps; a member to reuse its memory.
    stack: Vec<HalfEdgeId>,
    /// The quality of each element during swaps; a member to reuse its memory.
    quality: Vec<f64>,
}

/// An edge that is too long or too short, with what is needed to recognise it after others have changed.
#[derive(Clone, Copy)]
struct Found {
    length: f64,
    h: HalfEdgeId,
    from: NodeId,
    to: NodeId,
}

impl Adapter<'_> {
    fn run(&mut self, watch: &mut dyn Watch) -> Result<(), Fault> {
        self.swap_where_better();
        self.refine(watch)?;
        self.mesh = self.mesh.reordered();
        for cycle in 0..CYCLES {
            watch.cancel().check()?;
            watch.tell(Stage::Adapt, cycle as u64 + 1, CYCLES as u64 + 1);
            self.collapse_short();
            self.split_long(cycle == 0)?;
            self.swap_where_better();
            self.smooth()?;
        }
        self.swap_where_better();
        self.smooth()?;
        self.mesh = self.mesh.reordered();
        Ok(())
    }

    // ---- refinement ----

    /// Divides all edges longer than unit, longest first, until there are none; swaps restore the Delaunay
    /// triangulation in the metric after each division.
    fn refine(&mut self, watch: &mut dyn Watch) -> Result<(), Fault> {
        let mut ordered = self.mesh.element_count();
        let mut found = self.long_edges(self.mesh.edges(), ordered < SAMPLED)?;
        loop {
            let elements = self.mesh.element_count();
            let expected = found.iter().map(|f| f.length as u64).sum::<u64>() * 2 + elements as u64;
            watch.cancel().check()?;
            watch.tell(Stage::Adapt, elements as u64, expected);
            let mut made = Vec::new();
            for f in &found {
                made.extend(self.divide(*f, 0.5)?);
            }
            if made.is_empty() {
                return Ok(());
            }
            let sampled = self.mesh.element_count() < SAMPLED;
            found = if self.mesh.element_count() > 2 * ordered {
                // New nodes are scattered in memory; reordering as the mesh grows keeps the cost of all passes nearly
                // linear.
                self.mesh = self.mesh.reordered();
                ordered = self.mesh.element_count();
                self.long_edges(self.mesh.edges(), sampled)?
            } else if made.len() > elements / FEW {
                self.long_edges(self.mesh.edges(), sampled)?
            } else {
                self.long_edges(self.edges_after(&found, &made).into_iter(), sampled)?
            };
        }
    }

    /// The edges that may be long after a pass, by id: the remaining long ones, and those around the new nodes (every
    /// element that the pass changed has one).
    fn edges_after(&self, found: &[Found], made: &[NodeId]) -> Vec<HalfEdgeId> {
        let mesh = &self.mesh;
        let around = made.iter().flat_map(|&m| mesh.fan(m)).flat_map(|h| [h, mesh.next(h), mesh.previous(h)]);
        let left = found.iter().filter(|f| self.still_there(**f)).map(|f| f.h);
        let mut edges: Vec<_> = around.chain(left).map(|h| mesh.twin(h).map_or(h, |t| h.min(t))).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// The inner edges among these that are longer than unit, the longest first.
    fn long_edges(&self, edges: impl Iterator<Item = HalfEdgeId>, sampled: bool) -> Result<Vec<Found>, Fault> {
        let mesh = &self.mesh;
        let mut found = Vec::new();
        for h in edges {
            let [from, to] = mesh.ends(h);
            // The length is at most the larger one of those at the two ends, which nearly always decides.
            let d = mesh.uv(to) - mesh.uv(from);
            let short = mesh.metric_ref(from).norm2(d).max(mesh.metric_ref(to).norm2(d)) < LONG * LONG;
            if (short && !sampled) || mesh.twin(h).is_none() {
                continue;
            }
            let mut length = mesh.distance(from, to);
            if sampled && length <= 2.0 {
                length = length.max(self.sampled_length(from, to)?);
            }
            if length > LONG {
                found.push(Found { length, h, from, to });
            }
        }
        // Edges are sorted by id; a stable sort preserves that within a class.
        found.sort_by_key(|f| std::cmp::Reverse(length_class(f.length)));
        Ok(found)
    }

    /// Length of a straight line by Simpson's rule, with the metric at its middle; on surfaces, also at its quarters.
    fn sampled_length(&self, from: NodeId, to: NodeId) -> Result<f64, Fault> {
        let d = self.mesh.uv(to) - self.mesh.uv(from);
        let middle = self.metric(self.mesh.uv(from) + 0.5 * d)?;
        let end = |n: NodeId| self.mesh.metric_ref(n).norm2(d).sqrt();
        let middle = middle.norm2(d).sqrt();
        if self.mesh.embedding().is_none() {
            return Ok((end(from) + 4.0 * middle + end(to)) / 6.0);
        }
        // On a surface the first triangles are as large as its faces, and the size may vary several times along an
        // edge.
        let at = |t: f64| Ok::<f64, Fault>(self.metric(self.mesh.uv(from) + t * d)?.norm2(d).sqrt());
        Ok((end(from) + end(to) + 4.0 * (at(0.25)? + at(0.75)?) + 2.0 * middle) / 12.0)
    }

    /// Divides an edge that still exists and returns the new node, unless the new node would be closer than `least` to
    /// the opposite ones, or would make a poor triangle worse: beside a boundary side that is much too long, and cannot
    /// be divided, a long edge must remain.
    fn divide(&mut self, f: Found, least: f64) -> Result<Option<NodeId>, Fault> {
        let mesh = &self.mesh;
        if !self.still_there(f) {
            return Ok(None);
        }
        let Some(twin) = mesh.twin(f.h) else { return Ok(None) };
        let (c, d) = (mesh.apex(f.h), mesh.apex(twin));
        let middle = self.middle(f.from, f.to);
        let metric = self.metric(middle)?;
        let near = |n: NodeId| length_over(&metric, mesh.metric_ref(n), mesh.uv(n) - middle) < least;
        if f.length < 2.0 && (near(c) || near(d)) {
            return Ok(None);
        }
        let fit = |h_ab: HalfEdgeId| {
            let (a, b, c) = (mesh.origin(h_ab), mesh.target(h_ab), mesh.apex(h_ab));
            let half = |n: NodeId| {
                quality_over([mesh.uv(n), middle, mesh.uv(c)], [mesh.metric_ref(n), &metric, mesh.metric_ref(c)]).abs()
            };
            let after = half(a).min(half(b));
            after >= POOR || after >= NOT_MUCH_WORSE * mesh.triangle_quality([a, b, c])
        };
        // On a surface, the first triangles hardly reflect the metric: away from the boundary, a poor triangle must not
        // prevent the division of an edge that is much too long.
        let inside = |h: HalfEdgeId| mesh.half_edges(h.element()).all(|h| mesh.twin(h).is_some());
        let forced = mesh.embedding().is_some() && f.length > MUCH_TOO_LONG && inside(f.h) && inside(twin);
        if !(forced || fit(f.h) && fit(twin)) {
            return Ok(None);
        }
        if mesh.element_count() + 2 > self.most_elements {
            return Err(Fault::new(format!("The metric requires more than {} triangles", self.most_elements))
                .of_kind(FaultKind::Limit)
                .at(format!("near ({}, {}), where the smallest size is {}", middle.x, middle.y, metric.min_size()))
                .remedy("Increase the sizes there, or raise max_quads"));
        }
        let made = self.mesh.divide(f.h, middle, metric).ok();
        if let Some(m) = made {
            self.done.divisions += 1;
            self.make_delaunay(m);
        }
        Ok(made)
    }

    /// The point that halves the metric length of an edge if the size varies linearly along it.
    fn middle(&self, from: NodeId, to: NodeId) -> DVec2 {
        let (p, q) = (self.mesh.uv(from), self.mesh.uv(to));
        let (l_p, l_q) = (self.mesh.metric_ref(from).norm2(q - p).sqrt(), self.mesh.metric_ref(to).norm2(q - p).sqrt());
        let t = l_q.sqrt() / (l_p.sqrt() + l_q.sqrt());
        p + (q - p) * t.clamp(0.2, 0.8)
    }

    fn still_there(&self, f: Found) -> bool {
        self.mesh.has_element(f.h.element()) && self.mesh.origin(f.h) == f.from && self.mesh.target(f.h) == f.to
    }

    fn metric(&self, uv: DVec2) -> Result<Metric2, Fault> {
        Ok(self.source.metric(uv)?)
    }

    /// Swaps edges opposite to a new node until they are Delaunay in the metric.
    fn make_delaunay(&mut self, m: NodeId) {
        let mesh = &mut self.mesh;
        self.stack.extend(mesh.fan(m).map(|h| mesh.next(h)));
        // The criterion uses the metrics of four nodes, so that termination is not guaranteed: bound the number of
        // swaps.
        let mut budget = 100;
        while let Some(h) = self.stack.pop() {
            if budget > 0 && !is_delaunay(mesh, h) && mesh.can_swap(h).is_ok() {
                budget -= 1;
                let h = mesh.swap(h);
                let t = mesh.twin(h).expect("a swapped edge has two sides");
                // T = (a, d, m) and U = (b, m, d): opposite to m lie a-d and d-b.
                self.stack.push(mesh.previous(h));
                self.stack.push(mesh.next(t));
                self.done.swaps += 1;
            }
        }
    }

    // ---- the cycles ----

    /// Swaps every edge whose swap improves the worse of its two triangles, until there are none.
    fn swap_where_better(&mut self) {
        let mesh = &mut self.mesh;
        self.quality.clear();
        self.quality.resize(mesh.element_slots(), 0.0);
        mesh.elements().for_each(|e| self.quality[e.index()] = mesh.triangle_quality(mesh.triangle(e)));
        self.stack.extend(mesh.edges());
        self.stack.reverse();
        let mut budget = 4 * self.stack.len();
        while let Some(h) = self.stack.pop() {
            if budget == 0 {
                self.stack.clear();
                return;
            }
            let Some(qualities) = better_by_swap(mesh, &self.quality, h) else { continue };
            budget -= 1;
            self.done.swaps += 1;
            let h = mesh.swap(h);
            let t = mesh.twin(h).expect("a swapped edge has two sides");
            [self.quality[h.element().index()], self.quality[t.element().index()]] = qualities;
            self.stack.extend([mesh.next(h), mesh.previous(h), mesh.next(t), mesh.previous(t)]);
        }
    }

    /// Collapses edges shorter than unit onto their better end, the shortest first.
    fn collapse_short(&mut self) {
        let mesh = &self.mesh;
        let mut found: Vec<Found> = mesh
            .edges()
            .map(|h| Found { length: mesh.length(h), h, from: mesh.origin(h), to: mesh.target(h) })
            .filter(|f| f.length < SHORT && !(mesh.is_fixed(f.from) && mesh.is_fixed(f.to)))
            .collect();
        found.sort_by_key(|f| length_class(f.length));
        for f in found {
            if !self.still_there(f) {
                continue;
            }
            let Some(twin) = self.mesh.twin(f.h) else { continue };
            let best = [f.h, twin]
                .into_iter()
                .filter_map(|h| self.quality_after_collapse(h).map(|q| (q, h)))
                .max_by(|(q, h), (r, k)| q.total_cmp(r).then(k.cmp(h)));
            if let Some((_, h)) = best {
                let b = self.mesh.target(h);
                let (at, metric) = (self.mesh.uv(b), self.mesh.metric(b));
                self.mesh.collapse(h, at, metric);
                self.done.collapses += 1;
            }
        }
    }

    /// The worst quality around b after a collapse of a into it, if that is possible and good enough.
    fn quality_after_collapse(&self, h_ab: HalfEdgeId) -> Option<f64> {
        let mesh = &self.mesh;
        let [a, b] = mesh.ends(h_ab);
        if mesh.is_fixed(a) || mesh.neighbours(a).any(|n| n != b && mesh.distance(b, n) > LONG) {
            return None;
        }
        let (mut before, mut after) = (f64::INFINITY, f64::INFINITY);
        for h in mesh.fan(a) {
            let n = mesh.triangle(h.element());
            before = before.min(mesh.triangle_quality(n));
            if !n.contains(&b) {
                after = after.min(mesh.triangle_quality(n.map(|n| if n == a { b } else { n })));
            }
        }
        let good = after >= before.min(LEAST_QUALITY) && mesh.can_collapse(h_ab, mesh.uv(b)).is_ok();
        good.then_some(after)
    }

    /// Divides edges longer than unit again, unless that creates an edge that is much too short.
    fn split_long(&mut self, sampled: bool) -> Result<(), Fault> {
        for f in self.long_edges(self.mesh.edges(), sampled)? {
            self.divide(f, SHORT)?;
        }
        Ok(())
    }

    /// Moves every free node towards the mean of the points at unit distance from its neighbours, unless that does
    /// harm.
    fn smooth(&mut self) -> Result<(), Fault> {
        for node in (0..self.mesh.node_slots() as u32).map(NodeId) {
            if self.mesh.has_node(node) && !self.mesh.is_fixed(node) {
                self.smooth_node(node)?;
            }
        }
        Ok(())
    }

    fn smooth_node(&mut self, node: NodeId) -> Result<(), Fault> {
        let mesh = &self.mesh;
        let (here, metric) = (mesh.uv(node), mesh.metric_ref(node));
        // The star: the two other corners of each triangle, with their coordinates and the sum of their metrics.
        let mut star: SmallVec<[([DVec2; 2], Metric2); 12]> = SmallVec::new();
        let mut sum = DVec2::ZERO;
        for h in mesh.fan(node) {
            let (b, c) = (mesh.target(h), mesh.apex(h));
            let (p_b, m_b, m_c) = (mesh.uv(b), mesh.metric_ref(b), mesh.metric_ref(c));
            star.push(([p_b, mesh.uv(c)], sum_of(m_b, m_c)));
            let away = here - p_b;
            sum += p_b + away / length_over(metric, m_b, away);
        }
        let there = sum / star.len() as f64;
        let quality =
            |([b, c], m): &([DVec2; 2], Metric2), p: DVec2, m_p: &Metric2| triangle_quality(&sum_of(m, m_p), p, *b, *c);
        // A quality that is always good enough; the previous quality matters only below it.
        const GOOD: f64 = 0.6;
        let mut least = GOOD;
        for step in [1.0, 0.5, 0.25] {
            let moved = here + (there - here) * step;
            let Ok(metric) = self.source.metric(moved) else { continue };
            let worst = star.iter().map(|t| quality(t, moved, &metric)).fold(f64::INFINITY, f64::min);
            if worst < least && least == GOOD {
                let before = star.iter().map(|t| quality(t, here, mesh.metric_ref(node)));
                least = before.fold(GOOD, f64::min);
            }
            // The check of `Mesh::can_move`, with the known coordinates.
            if worst >= least && star.iter().all(|([b, c], _)| firm(moved, *b, *c)) {
                self.mesh.move_node(node, moved, metric);
                self.done.moves += 1;
                return Ok(());
            }
        }
        Ok(())
    }
}

#[inline]
fn sum_of(a: &Metric2, b: &Metric2) -> Metric2 {
    Metric2 { uu: a.uu + b.uu, uv: a.uv + b.uv, vv: a.vv + b.vv }
}

/// Lengths within a quarter of an octave count as equal, so that edges of similar length are processed in the order of
/// memory.
fn length_class(length: f64) -> i64 {
    // The exponent and the upper two bits of the fraction.
    (length.to_bits() >> 50) as i64
}

/// Whether the edge is Delaunay in the normalised mean of the metrics of its four nodes: the opposite angles sum to at
/// most 180 degrees.
#[inline]
fn is_delaunay(mesh: &Mesh, h_ab: HalfEdgeId) -> bool {
    let Some(h_ba) = mesh.twin(h_ab) else { return true };
    let (a, b) = (mesh.origin(h_ab), mesh.origin(h_ba));
    let (c, d) = (mesh.apex(h_ab), mesh.apex(h_ba));
    let mut m = Metric2 { uu: 0.0, uv: 0.0, vv: 0.0 };
    for n in [a, b, c, d] {
        let n = mesh.metric_ref(n);
        let weight = 1.0 / n.det().sqrt();
        m = Metric2 { uu: m.uu + weight * n.uu, uv: m.uv + weight * n.uv, vv: m.vv + weight * n.vv };
    }
    let (a, b, c, d) = (mesh.uv(a), mesh.uv(b), mesh.uv(c), mesh.uv(d));
    let at_c = (m.inner(a - c, b - c), (a - c).perp_dot(b - c));
    let at_d = (m.inner(b - d, a - d), (b - d).perp_dot(a - d));
    at_c.0 * at_d.1 + at_c.1 * at_d.0 >= 0.0
}

/// The qualities of the two triangles after a swap, if it improves the worse one by more than rounding errors;
/// `quality` has the current ones.
#[inline]
fn better_by_swap(mesh: &Mesh, quality: &[f64], h_ab: HalfEdgeId) -> Option<[f64; 2]> {
    let h_ba = mesh.twin(h_ab)?;
    let before = quality[h_ab.element().index()].min(quality[h_ba.element().index()]);
    if before > 0.95 {
        return None;
    }
    let (a, b) = (mesh.origin(h_ab), mesh.origin(h_ba));
    let (c, d) = (mesh.apex(h_ab), mesh.apex(h_ba));
    let least = before + 1e-6;
    let first = mesh.triangle_quality([a, d, c]);
    if first <= least {
        return None;
    }
    let second = mesh.triangle_quality([b, c, d]);
    (second > least && mesh.can_swap(h_ab).is_ok()).then_some([first, second])
}
