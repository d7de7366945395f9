//! Selection of the base segment (paper 4.3.3, table 1) in O(log n): lazy heaps over the front segments.
//!
//! The heaps are a cache. They contain every front segment that is not deferred, with keys that are a pure function of
//! the mesh; heaps rebuilt from a state select the same segments. An entry is valid only while its stamp is that of its
//! half-edge.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use smallvec::SmallVec;

use super::segment::{Key, Segment, h_value};
use crate::core::case::{HMinOver, Parameters, Selection};
use crate::core::mesh::journal::Entry;
use crate::core::mesh::{HalfEdgeId, Mark, Mesh, NodeId};

/// A segment in the queue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Waiting {
    key: Key,
    h: HalfEdgeId,
    stamp: u32,
}

/// The selected base segment and the reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseChoice {
    /// The base segment.
    pub segment: Segment,
    /// Smallest H-value on the front (step i), over the segments that the parameters say; on surfaces, on the front of
    /// the current face. With other criteria than table 1, that of the segment itself.
    pub h_min: f64,
    /// The number of deferred segments on the front, or on that of the current face.
    pub deferred: u32,
    /// Whether the segment is within c Hmin; otherwise it is the one with the smallest H-value (step iii).
    pub within_reach: bool,
}

impl BaseChoice {
    /// The choice of a segment that a person picked instead of the one that the rules select.
    pub fn of_person(segment: Segment, by_rule: Option<BaseChoice>, parameters: &Parameters) -> BaseChoice {
        let (h_min, deferred) = by_rule.map_or((segment.h_value, 0), |choice| (choice.h_min, choice.deferred));
        let within_reach = segment.class < 4 && segment.window(parameters.selection_window) < parameters.c * h_min;
        BaseChoice { segment, h_min, deferred, within_reach }
    }
}

/// All front segments that are not deferred, ordered for selection.
#[derive(Clone, Debug, Default)]
pub struct Queue {
    /// Classes 1 to 3 by the selection window, and all segments by H-value; other criteria use only the last heap.
    heaps: [BinaryHeap<Reverse<Waiting>>; 4],
    /// The deferred segments with their H-values: they are not chosen, but stand on the front.
    deferred: Vec<(HalfEdgeId, u32, f64)>,
    stamp: Vec<u32>,
    node_epoch: Vec<u32>,
    epoch: u32,
    /// The face of its segments; `None` for all.
    face: Option<u32>,
}

impl Queue {
    /// The queue of a state, for one face or for all.
    pub fn of(mesh: &Mesh, face: Option<u32>, parameters: &Parameters) -> Queue {
        let mut queue = Queue { face, ..Queue::default() };
        queue.grow(mesh);
        for e in mesh.elements_of(face) {
            for h in mesh.half_edges(e) {
                if mesh.is_front(h) {
                    if mesh.is_deferred(h) { queue.note_deferred(mesh, h) } else { queue.push(mesh, h, parameters) }
                }
            }
        }
        queue
    }

    fn grow(&mut self, mesh: &Mesh) {
        self.stamp.resize(4 * mesh.element_slots(), 0);
        self.node_epoch.resize(mesh.node_slots(), 0);
    }

    fn push(&mut self, mesh: &Mesh, h: HalfEdgeId, parameters: &Parameters) {
        let segment = Segment::measure(mesh, h, parameters);
        let stamp = self.stamp[h.index()];
        let layer = f64::from(segment.layer(parameters));
        let mut put = |heap: usize, key: Key| self.heaps[heap].push(Reverse(Waiting { key, h, stamp }));
        if parameters.selection == Selection::Table1 {
            if segment.class < 4 {
                let Key([window, sum, _]) = segment.key(parameters);
                put(usize::from(segment.class) - 1, Key([layer, window, sum]));
            }
            put(3, Key([layer, segment.h_value, segment.theta_sum()]));
        } else {
            let Key([first, second, third]) = segment.key(parameters);
            // Face by face, and offsetting before everything else.
            put(3, Key([layer * 1e9 + first, second, third]));
        }
    }

    /// The best valid entry of a heap.
    fn top(&mut self, heap: usize, mesh: &Mesh) -> Option<Waiting> {
        let stamp = &self.stamp;
        let heap = &mut self.heaps[heap];
        while let Some(&Reverse(waiting)) = heap.peek() {
            if stamp[waiting.h.index()] == waiting.stamp {
                debug_assert!(mesh.is_front(waiting.h), "{:?} waits and is not on the front", waiting.h);
                return Some(waiting);
            }
            heap.pop();
        }
        None
    }

    /// Selects the base segment (4.3.3, steps i to iii, or the criterion of the parameters). The segment remains in the
    /// queue until it is deferred or changed by its quadrilateral. `None` if every segment is deferred.
    pub fn select(&mut self, mesh: &Mesh, parameters: &Parameters) -> Option<BaseChoice> {
        let smallest = self.top(3, mesh)?;
        let (deferred, least) = self.deferred();
        let measured = |waiting: Waiting| Segment::measure(mesh, waiting.h, parameters);
        if parameters.selection != Selection::Table1 {
            let segment = measured(smallest);
            return Some(BaseChoice { segment, h_min: segment.h_value, deferred, within_reach: true });
        }
        let Key([layer, h, _]) = smallest.key;
        let h_min = if parameters.h_min_over == HMinOver::Front { h.min(least) } else { h };
        for class in 0..3 {
            let Some(waiting) = self.top(class, mesh) else { continue };
            let Key([its_layer, window, _]) = waiting.key;
            if its_layer == layer && window < parameters.c * h_min {
                return Some(BaseChoice { segment: measured(waiting), h_min, deferred, within_reach: true });
            }
        }
        Some(BaseChoice { segment: measured(smallest), h_min, deferred, within_reach: false })
    }

    /// The number of deferred segments and their smallest H-value.
    fn deferred(&mut self) -> (u32, f64) {
        let stamp = &self.stamp;
        self.deferred.retain(|(h, stamped, _)| stamp[h.index()] == *stamped);
        (self.deferred.len() as u32, self.deferred.iter().fold(f64::INFINITY, |least, deferred| least.min(deferred.2)))
    }

    fn note_deferred(&mut self, mesh: &Mesh, h: HalfEdgeId) {
        self.deferred.push((h, self.stamp[h.index()], h_value(mesh, mesh.ends(h))));
    }

    /// Defers a segment until something near it changes.
    pub fn defer(&mut self, mesh: &mut Mesh, h: HalfEdgeId) {
        mesh.set_deferred(h, true);
        self.stamp[h.index()] = self.stamp[h.index()].wrapping_add(1);
        self.note_deferred(mesh, h);
    }

    /// Updates the queue after the changes in the journal since the mark: segments at nodes that moved or whose
    /// elements changed, and their neighbours on the loop (two of them if a node moved). Deferred segments among them
    /// become active again.
    pub fn refresh(&mut self, mesh: &mut Mesh, mark: Mark, parameters: &Parameters) {
        self.grow(mesh);
        self.epoch = self.epoch.wrapping_add(1);
        let epoch = self.epoch;
        let mut nodes: SmallVec<[NodeId; 64]> = SmallVec::new();
        let mut moved: SmallVec<[NodeId; 64]> = SmallVec::new();
        let mut touch = |node: NodeId, seen: &mut [u32]| {
            if mesh.has_node(node) && std::mem::replace(&mut seen[node.index()], epoch) != epoch {
                nodes.push(node);
            }
        };
        for entry in mesh.journal().since(mark) {
            match *entry {
                Entry::Origin(h, _) | Entry::Twin(h, _) => {
                    let Some(stamp) = self.stamp.get_mut(h.index()) else { continue };
                    *stamp = stamp.wrapping_add(1);
                    if mesh.has_element(h.element()) && (h.corner() as usize) < mesh.sides(h.element()) {
                        touch(mesh.origin(h), &mut self.node_epoch);
                    }
                }
                Entry::Uv(node, _) => {
                    touch(node, &mut self.node_epoch);
                    moved.push(node);
                }
                Entry::Sides(e, _) => {
                    for corner in 0..4 {
                        if let Some(stamp) = self.stamp.get_mut(e.half_edge(corner).index()) {
                            *stamp = stamp.wrapping_add(1);
                        }
                    }
                }
                _ => {}
            }
        }
        let mut segments: SmallVec<[HalfEdgeId; 64]> = SmallVec::new();
        for &node in nodes.iter().filter(|&&n| mesh.is_on_front(n)) {
            for h in mesh.fan(node) {
                if mesh.is_front(h) {
                    segments.push(h);
                    segments.push(mesh.front_before(h));
                }
                let p = mesh.previous(h);
                if mesh.is_front(p) {
                    segments.push(p);
                    segments.push(mesh.front_after(p));
                }
            }
        }
        // A moved front node rotates the segments beside it, and so changes the angles at their other ends.
        for &node in moved.iter().filter(|&&n| mesh.has_node(n) && mesh.is_on_front(n)) {
            for h in mesh.fan(node) {
                let p = mesh.previous(h);
                // A deferred segment remains deferred: its own ends have not moved.
                for (segment, beyond) in [(h, Mesh::front_after as fn(&Mesh, _) -> _), (p, Mesh::front_before)] {
                    if mesh.is_front(segment) {
                        let neighbour = beyond(mesh, segment);
                        if !mesh.is_deferred(neighbour) {
                            segments.push(neighbour);
                        }
                    }
                }
            }
        }
        segments.sort_unstable();
        segments.dedup();
        for &h in &segments {
            self.stamp[h.index()] = self.stamp[h.index()].wrapping_add(1);
            mesh.set_deferred(h, false);
            self.push(mesh, h, parameters);
        }
        if self.heaps[3].len() > 64 + 3 * mesh.element_count() {
            *self = Queue::of(mesh, self.face, parameters);
        }
    }

    /// Reactivates every deferred segment; returns whether there was one.
    pub fn take_up_all(&mut self, mesh: &mut Mesh, parameters: &Parameters) -> bool {
        let deferred: Vec<HalfEdgeId> = mesh.front().filter(|&h| mesh.is_deferred(h)).collect();
        for &h in &deferred {
            mesh.set_deferred(h, false);
            self.stamp[h.index()] = self.stamp[h.index()].wrapping_add(1);
            self.push(mesh, h, parameters);
        }
        !deferred.is_empty()
    }
}
