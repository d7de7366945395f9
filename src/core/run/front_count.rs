//! Counts of the merging front along a run: segments, loops and their parity, live triangles. The segments are stored
//! as a list, so that the cost of a count depends on the length of the front and not on the size of the mesh.

use serde::Serialize;

use crate::core::convert::Event;
use crate::core::mesh::{ElementId, HalfEdgeId, Mesh, NodeId, Touched};

const NONE: u32 = u32::MAX;

/// Counts of the front.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FrontCount {
    /// Number of segments.
    pub segments: u32,
    /// Number of loops (closed chains of segments).
    pub loops: u32,
    /// Number of loops with an odd number of segments.
    pub odd: u32,
    /// Number of live triangles.
    pub live: u32,
}

/// The segments of the front, kept up to date.
#[derive(Clone, Debug, Default)]
pub(super) struct FrontTracker {
    /// The segments, each with the node where it starts.
    list: Vec<(HalfEdgeId, NodeId)>,
    /// The index of each half-edge in the list.
    place: Vec<u32>,
    /// The number of segments that start at each node, which is that of its live sectors.
    sectors: Vec<u16>,
    is_live: Vec<bool>,
    /// The last count that visited each half-edge.
    epoch: Vec<u32>,
    epochs: u32,
    count: FrontCount,
}

impl FrontTracker {
    pub fn of(mesh: &Mesh) -> FrontTracker {
        let mut tracker = FrontTracker::default();
        tracker.grow(mesh);
        for e in mesh.elements() {
            tracker.examine(mesh, e);
        }
        tracker.count_loops(mesh);
        tracker
    }

    /// The counts.
    pub fn count(&self) -> FrontCount {
        self.count
    }

    /// The segments, in no particular order.
    pub fn segments(&self) -> impl Iterator<Item = HalfEdgeId> + '_ {
        self.list.iter().map(|segment| segment.0)
    }

    fn grow(&mut self, mesh: &Mesh) {
        self.place.resize(self.place.len().max(4 * mesh.element_slots()), NONE);
        self.epoch.resize(self.place.len(), 0);
        self.is_live.resize(self.is_live.len().max(mesh.element_slots()), false);
        self.sectors.resize(self.sectors.len().max(mesh.node_slots()), 0);
    }

    /// Examines again what was touched since the last update, after a step with this event.
    pub fn update(&mut self, mesh: &Mesh, touched: &Touched, event: &Event) {
        let pinched_before = self.is_pinched(event);
        self.grow(mesh);
        for &e in touched.elements() {
            self.examine(mesh, e);
            if mesh.has_element(e) {
                for h in mesh.half_edges(e) {
                    if let Some(t) = mesh.twin(h) {
                        self.examine(mesh, t.element());
                    }
                }
            }
        }
        if pinched_before || self.is_pinched(event) || !is_one_chain(mesh, event) {
            self.count_loops(mesh);
        }
    }

    /// Whether a node of the new quadrilateral has several live sectors.
    fn is_pinched(&self, event: &Event) -> bool {
        let Event::Formed { nodes, .. } = event else { return true };
        nodes.iter().any(|n| self.sectors.get(n.index()).is_some_and(|&sectors| sectors > 1))
    }

    fn examine(&mut self, mesh: &Mesh, e: ElementId) {
        if e.index() >= self.is_live.len() {
            return;
        }
        let exists = mesh.has_element(e);
        let is_live = exists && mesh.is_triangle(e);
        let was_live = std::mem::replace(&mut self.is_live[e.index()], is_live);
        self.count.live = self.count.live + u32::from(is_live) - u32::from(was_live);
        for corner in 0..4 {
            let h = e.half_edge(corner);
            let is_front = is_live && corner < 3 && mesh.is_front(h);
            let place = self.place[h.index()];
            if place != NONE {
                let (_, node) = self.list.swap_remove(place as usize);
                self.sectors[node.index()] -= 1;
                if let Some(moved) = self.list.get(place as usize) {
                    self.place[moved.0.index()] = place;
                }
                self.place[h.index()] = NONE;
            }
            if is_front {
                let node = mesh.origin(h);
                self.sectors[node.index()] += 1;
                self.place[h.index()] = self.list.len() as u32;
                self.list.push((h, node));
            }
        }
        self.count.segments = self.list.len() as u32;
    }

    fn count_loops(&mut self, mesh: &Mesh) {
        self.epochs += 1;
        let (mut loops, mut odd) = (0, 0);
        for &(start, _) in &self.list {
            if self.epoch[start.index()] == self.epochs {
                continue;
            }
            let mut segments = 0_u32;
            for h in mesh.front_loop(start) {
                self.epoch[h.index()] = self.epochs;
                segments += 1;
            }
            loops += 1;
            odd += segments % 2;
        }
        (self.count.loops, self.count.odd) = (loops, odd);
    }
}

/// Whether a step with this event can change the front. Steps of an attempt cannot; changes of half-edge ids by their
/// swaps are examined later.
pub(super) fn changes_front(event: &Event) -> bool {
    !matches!(
        event,
        Event::BaseSelected { .. }
            | Event::PickLost { .. }
            | Event::SideIsFront { .. }
            | Event::SideChosen { .. }
            | Event::SideSwapped { .. }
            | Event::SideDivided { .. }
            | Event::TopSwapped { .. }
            | Event::TopSmoothed { .. }
            | Event::TopFound { .. }
            | Event::NodeRemoved { .. }
            | Event::RolledBack { .. }
            | Event::Deferred { .. }
            | Event::Enhanced { .. }
            | Event::Smoothed { .. }
            | Event::SeamRefused { .. }
            | Event::SplitRefused { .. }
            | Event::SecondPass
            | Event::Matched { .. }
            | Event::Cleaned { .. }
            | Event::Refilled { .. }
            | Event::RowLaid { .. }
            | Event::Swept { .. }
            | Event::Unfolded { .. }
            | Event::FaceConverted { .. }
            | Event::PostProcessed
            | Event::Mirrored { .. }
            | Event::Finished
    )
}

/// Whether the sides of the new quadrilateral that lie on the front form one chain of it: then, without a pinched node,
/// no loop was opened, closed or joined.
fn is_one_chain(mesh: &Mesh, event: &Event) -> bool {
    let Event::Formed { nodes, .. } = event else { return false };
    let on_front: [Option<HalfEdgeId>; 4] = std::array::from_fn(|k| mesh.front_between(nodes[(k + 1) % 4], nodes[k]));
    let count = on_front.iter().flatten().count();
    // The chain starts at the one that follows none of the others.
    let follows = |h: HalfEdgeId| on_front.iter().flatten().any(|&other| mesh.front_after(other) == h);
    let Some(mut h) = on_front.iter().flatten().copied().find(|&h| !follows(h)) else { return false };
    (1..count).all(|_| {
        h = mesh.front_after(h);
        on_front.contains(&Some(h))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::convert::{Converter, Phase};
    use crate::core::progress::Nobody;
    use crate::core::run::run::Run;

    #[test]
    fn the_updated_count_equals_a_new_count_after_every_change_of_the_front() {
        let mut most = 0;
        for (name, scale) in [("example1", 0.7), ("two-faces", 1.0), ("gear", 1.0), ("polar-1", 1.5)] {
            let mut run = Run::of(built_in::named(name).unwrap().unwrap());
            run.parameters.size_scale *= scale;
            let background = run.background(&mut Nobody).unwrap();
            let mut converter: Converter<'_> = run.start(&background).unwrap();
            converter.keep_history();
            let mut tracker = FrontTracker::of(&converter.mesh);
            let mut touched = Touched::default();
            while *converter.phase() != Phase::Done {
                let event = converter.step().unwrap();
                converter.note_last_step(&mut touched);
                if changes_front(&event) {
                    tracker.update(&converter.mesh, &touched, &event);
                    touched.clear();
                    let new = FrontTracker::of(&converter.mesh);
                    assert_eq!(tracker.count(), new.count(), "{name}: {event:?}");
                    assert_eq!(tracker.count.odd, 0, "{name}: {event:?}");
                    most = most.max(tracker.count.loops);
                }
            }
            assert_eq!(tracker.count(), FrontCount::default(), "{name}");
        }
        assert!(most > 3, "loops come and go");
    }
}
