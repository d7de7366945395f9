//! Local post-processing around a new quadrilateral (paper 4.3.6): the order of its four parts, structural enhancement, and
//! area-weighted smoothing by eqs. (9) and (10), with guards (docs/algorithm.md, "Local smoothing"). Seaming and
//! splitting have modules of their own.

use glam::DVec2;
use smallvec::SmallVec;

use super::converter::Converter;
use super::energy;
use super::event::{Event, Purpose};
use super::phase::Phase;
use crate::core::fault::Fault;
use crate::core::kernel::tensor::Metric2;
use crate::core::mesh::half_edge::Mesh;
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::mesh::journal::Mark;

/// Looks at edges for one enhancement: four times a ring's size (docs/algorithm.md, "Structural enhancement").
const ENHANCEMENTS: u8 = 48;
/// A smoothed node must not let the worst quality around fall below this share of what it was.
const KEPT_QUALITY: f64 = 0.9;

impl Converter<'_> {
    /// The first phase of the local post-processing around a new quadrilateral; the queue has not seen what the journal holds
    /// since the mark.
    pub(super) fn begin_local(&self, element: ElementId, mark: Mark) -> Phase {
        if self.parameters.enhancement {
            Phase::Enhance { element, mark, edges: self.edges_around(element), budget: ENHANCEMENTS }
        } else {
            Phase::Smooth { element, mark }
        }
    }

    /// One enhancement (4.3.6); smoothing in the same step where there is none.
    pub(super) fn step_enhance(
        &mut self,
        element: ElementId,
        mark: Mark,
        mut edges: SmallVec<[HalfEdgeId; 24]>,
        budget: u8,
    ) -> Result<(Phase, Event), Fault> {
        let next = |edges| match budget - 1 {
            0 => Phase::Smooth { element, mark },
            budget => Phase::Enhance { element, mark, edges, budget },
        };
        if self.parameters.enhancement {
            while let Some(h) = edges.pop() {
                if let Some((event, around)) = self.enhance_edge(h) {
                    self.counts.enhanced += 1;
                    edges.extend(around);
                    return Ok((next(edges), event));
                }
            }
            if let Some(event) = self.remove_a_node(element) {
                self.counts.removed += 1;
                return Ok((next(self.edges_around(element)), event));
            }
        }
        self.step_smooth(element, mark)
    }

    /// Smoothing (4.3.6): one sweep over the nodes around; seaming in the same step where it is switched off. The queue
    /// then sees everything since the base was selected.
    pub(super) fn step_smooth(&mut self, element: ElementId, mark: Mark) -> Result<(Phase, Event), Fault> {
        let moved = self.parameters.smoothing.then(|| self.smooth_around(element));
        self.refresh(mark);
        let corners = SmallVec::from_slice(&self.mesh.quad(element));
        match moved {
            Some(nodes) => Ok((Phase::Seam { element, nodes: corners }, Event::Smoothed { nodes })),
            None => self.step_seam(element, corners),
        }
    }

    /// One seam (4.3.6), or why one is refused; splitting in the same step where there is none.
    pub(super) fn step_seam(
        &mut self,
        element: ElementId,
        mut nodes: SmallVec<[NodeId; 8]>,
    ) -> Result<(Phase, Event), Fault> {
        while self.parameters.seaming
            && let Some(at) = nodes.pop()
        {
            let mark = self.mesh.mark();
            let Some(event) = self.seam_at(at) else { continue };
            if let Event::Seamed { node, .. } | Event::TransitionSeamed { node, .. } = event {
                self.counts.seamed += 1;
                self.counts.transitions += u64::from(matches!(event, Event::TransitionSeamed { .. }));
                self.refresh(mark);
                nodes.push(node);
            }
            let next = if nodes.is_empty() { Phase::Split { element } } else { Phase::Seam { element, nodes } };
            return Ok((next, event));
        }
        self.step_split(element)
    }

    /// Front splitting (4.3.6); a selection follows in the same step where nothing is to be split.
    pub(super) fn step_split(&mut self, element: ElementId) -> Result<(Phase, Event), Fault> {
        if self.parameters.splitting {
            let mark = self.mesh.mark();
            if let Some(event) = self.split_front(element) {
                self.counts.split += 1;
                self.refresh(mark);
                return Ok((Phase::Select, event));
            }
        }
        self.select()
    }

    /// Live edges around a quadrilateral: those at its nodes and those opposite to them.
    fn edges_around(&self, element: ElementId) -> SmallVec<[HalfEdgeId; 24]> {
        let mesh = &self.mesh;
        let mut edges = SmallVec::new();
        for node in mesh.quad(element) {
            for h in mesh.fan(node).filter(|h| mesh.is_triangle(h.element())) {
                for h in [h, mesh.next(h)] {
                    if mesh.twin(h).is_some_and(|t| mesh.is_triangle(t.element())) {
                        edges.push(h);
                    }
                }
            }
        }
        edges
    }

    /// The worst quality of the elements at the nodes of a quadrilateral, itself included.
    pub fn quality_around(&self, element: ElementId) -> f64 {
        let around = self.mesh.corners(element).flat_map(|n| self.mesh.fan(n));
        around.map(|h| self.mesh.quality(h.element())).fold(f64::INFINITY, f64::min)
    }

    /// Removes one live node beside the quadrilateral that has three or four triangles (i).
    fn remove_a_node(&mut self, element: ElementId) -> Option<Event> {
        for corner in self.mesh.quad(element) {
            let around: SmallVec<[NodeId; 12]> = self.mesh.neighbours(corner).collect();
            for node in around {
                if !self.mesh.is_fixed(node) && self.mesh.delete_node(node).is_ok() {
                    return Some(Event::NodeRemoved { node, purpose: Purpose::Enhancement });
                }
            }
        }
        None
    }

    /// Swaps the edge if that lowers the largest angle of its two triangles (ii).
    fn enhance_edge(&mut self, h: HalfEdgeId) -> Option<(Event, [HalfEdgeId; 4])> {
        let mesh = &self.mesh;
        if !mesh.has_element(h.element()) || !mesh.is_triangle(h.element()) {
            return None;
        }
        let t = mesh.twin(h).filter(|t| mesh.is_triangle(t.element()))?;
        let (a, b) = (mesh.origin(h), mesh.origin(t));
        let (c, d) = (mesh.origin(mesh.previous(h)), mesh.origin(mesh.previous(t)));
        let before = least_cosine(mesh, [a, b, c]).min(least_cosine(mesh, [b, a, d]));
        // A largest angle below 90 degrees is no reason to change anything.
        if before > 0.0 {
            return None;
        }
        let after = least_cosine(mesh, [a, d, c]).min(least_cosine(mesh, [d, b, c]));
        if after <= before + 1e-6 || mesh.can_swap(h).is_err() {
            return None;
        }
        let h = self.mesh.swap(h);
        let mesh = &self.mesh;
        let t = mesh.twin(h)?;
        Some((
            Event::Enhanced { new: [mesh.origin(h), mesh.target(h)] },
            [mesh.next(h), mesh.previous(h), mesh.next(t), mesh.previous(t)],
        ))
    }

    /// Smooths around the quadrilateral in the paper's order: nodes of the triangles around it, then its own. With
    /// placement on, nodes of the front stay, and nodes that the quadrilateral buried are relaxed by the energy.
    fn smooth_around(&mut self, element: ElementId) -> u8 {
        let corners = self.mesh.quad(element);
        let mut around: SmallVec<[NodeId; 24]> = SmallVec::new();
        for corner in corners {
            for h in self.mesh.fan(corner).filter(|h| self.mesh.is_triangle(h.element())) {
                for node in [self.mesh.target(h), self.mesh.origin(self.mesh.previous(h))] {
                    if !around.contains(&node) && !corners.contains(&node) {
                        around.push(node);
                    }
                }
            }
        }
        let mut moved = 0;
        for node in around {
            let is_live = !self.is_on_front(node);
            if is_live || (!self.parameters.placement && !self.mesh.is_fixed(node)) {
                moved += u8::from(self.smooth_by_area(node));
            }
        }
        for node in corners {
            if self.mesh.is_fixed(node) {
                continue;
            }
            let buried = self.mesh.fan(node).all(|h| !self.mesh.is_triangle(h.element()));
            if self.parameters.placement {
                moved += u8::from(buried && energy::relax(&mut self.mesh, node, &*self.source) > 0.0);
            } else {
                moved += u8::from(self.smooth_by_area(node));
            }
        }
        moved
    }

    /// Moves a node to the weighted centroid of its elements (eq. 9), in steps 1, 1/2, 1/4, 1/8 until the guard holds.
    fn smooth_by_area(&mut self, node: NodeId) -> bool {
        let mesh = &self.mesh;
        let (mut sum, mut weight, mut before) = (DVec2::ZERO, 0.0, f64::INFINITY);
        for h in mesh.fan(node) {
            let e = h.element();
            let (mut centroid, mut root) = (DVec2::ZERO, 0.0);
            let sides = mesh.sides(e) as f64;
            for n in mesh.corners(e) {
                centroid += mesh.uv(n);
                root += mesh.metric_ref(n).det().sqrt();
            }
            let area = root / sides * element_area(mesh, e);
            sum += centroid / sides * area;
            weight += area;
            before = before.min(mesh.quality(e));
        }
        let here = mesh.uv(node);
        let there = sum / weight;
        // Less than a thousandth of a unit is not worth the journal's memory.
        if mesh.metric_ref(node).norm2(there - here) < 1e-6 {
            return false;
        }
        let mut step = 1.0;
        for _ in 0..4 {
            let place = here + (there - here) * step;
            step *= 0.5;
            let Ok(metric) = self.source.metric(place) else { continue };
            if self.mesh.can_move(node, place).is_err() {
                continue;
            }
            let mark = self.mesh.mark();
            self.mesh.move_node(node, place, metric);
            let after = self.mesh.fan(node).map(|h| self.mesh.quality(h.element())).fold(f64::INFINITY, f64::min);
            if after >= KEPT_QUALITY * before {
                return true;
            }
            self.mesh.take_back(mark);
        }
        false
    }
}

/// Least cosine of a triangle's angles (that of its largest angle), each in the metric of its node.
fn least_cosine(mesh: &Mesh, n: [NodeId; 3]) -> f64 {
    let mut least = f64::INFINITY;
    for k in 0..3 {
        let m: &Metric2 = mesh.metric_ref(n[k]);
        let p = mesh.uv(n[k]);
        let (a, b) = (mesh.uv(n[(k + 1) % 3]) - p, mesh.uv(n[(k + 2) % 3]) - p);
        least = least.min(m.inner(a, b) / (m.norm2(a) * m.norm2(b)).sqrt());
    }
    least
}

/// Area of an element in the parametric plane.
fn element_area(mesh: &Mesh, e: ElementId) -> f64 {
    if mesh.is_triangle(e) {
        let [a, b, c] = mesh.triangle(e).map(|n| mesh.uv(n));
        0.5 * (b - a).perp_dot(c - a)
    } else {
        let [a, b, c, d] = mesh.quad(e).map(|n| mesh.uv(n));
        0.5 * (c - a).perp_dot(d - b)
    }
}
