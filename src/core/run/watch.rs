//! Watchpoints: the next or last step that touched a node, an edge or an element, the step that made a quadrilateral,
//! the step that killed an edge. Stretches between keyframes that did not touch it are skipped.

use smallvec::SmallVec;

use super::history::History;
use crate::core::fault::Fault;
use crate::core::mesh::{Difference, ElementId, Mesh, NodeId};

/// What a watchpoint watches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watched {
    /// A node: its position and its edges.
    Node(NodeId),
    /// An edge: whether it exists, and the elements on both sides of it.
    Edge(NodeId, NodeId),
    /// An element: its nodes and their positions.
    Element(ElementId),
}

/// What lies on one side of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beside {
    /// Nothing: the edge lies on the boundary.
    Nothing,
    /// A live triangle.
    Live,
    /// A dead quadrilateral.
    Dead,
}

/// How a watched item appears in a state; a step touched it where this changes. Positions are compared by their bits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Appearance {
    /// It does not exist.
    Absent,
    /// A node: its position, and its neighbours sorted by id, each with the element before it.
    Node([u64; 2], SmallVec<[(NodeId, Beside); 12]>),
    /// An edge: what lies to its left and right, seen from its first node.
    Edge([Beside; 2]),
    /// An element: its nodes with their positions.
    Element(SmallVec<[(NodeId, [u64; 2]); 4]>),
}

impl Appearance {
    /// How a watched item appears in a mesh.
    pub fn at(mesh: &Mesh, watched: Watched) -> Appearance {
        let beside = |e: ElementId| if mesh.is_triangle(e) { Beside::Live } else { Beside::Dead };
        let place = |n: NodeId| [mesh.uv(n).x.to_bits(), mesh.uv(n).y.to_bits()];
        match watched {
            Watched::Node(n) if mesh.has_node(n) => {
                let around = mesh.fan(n).map(|h| (mesh.target(h), beside(h.element())));
                let mut around: SmallVec<[(NodeId, Beside); 12]> = around.collect();
                around.sort_unstable_by_key(|edge| edge.0);
                Appearance::Node(place(n), around)
            }
            Watched::Edge(a, b) if mesh.has_node(a) && mesh.has_node(b) => {
                let (left, right) = (mesh.half_edge_between(a, b), mesh.half_edge_between(b, a));
                if left.is_none() && right.is_none() {
                    return Appearance::Absent;
                }
                Appearance::Edge([left, right].map(|h| h.map_or(Beside::Nothing, |h| beside(h.element()))))
            }
            Watched::Element(e) if mesh.has_element(e) => {
                Appearance::Element(mesh.corners(e).map(|n| (n, place(n))).collect())
            }
            _ => Appearance::Absent,
        }
    }

    /// Whether it is a quadrilateral.
    pub fn is_quad(&self) -> bool {
        matches!(self, Appearance::Element(corners) if corners.len() == 4)
    }

    /// Whether it is an edge that can still change: live on both sides.
    pub fn is_live_edge(&self) -> bool {
        *self == Appearance::Edge([Beside::Live; 2])
    }

    /// Whether a stretch may have changed this look; a `false` is certain.
    fn may_change(&self, watched: Watched, difference: &Difference) -> bool {
        match watched {
            Watched::Node(n) => difference.touches_node(n),
            Watched::Edge(a, b) => difference.touches_node(a) && difference.touches_node(b),
            Watched::Element(e) => {
                let Appearance::Element(corners) = self else { return difference.touches_element(e) };
                difference.touches_element(e) || corners.iter().any(|corner| difference.touches_node(corner.0))
            }
        }
    }
}

/// Tests a change from one look to the next.
type Turn<'a> = &'a dyn Fn(&Appearance, &Appearance) -> bool;

impl History {
    /// The next step after the current state that touches it. It runs ahead as far as necessary, unless the recorder is
    /// lent.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn next_touch(&mut self, watched: Watched) -> Result<Option<u64>, Fault> {
        let mut from = self.step();
        let mut look = Appearance::at(&self.state().mesh, watched);
        loop {
            let known = self.log().known();
            while from < known {
                let (until, difference) = self.stretch_from(from);
                if difference.is_none_or(|difference| look.may_change(watched, difference)) {
                    let seen = self.seen(watched, from, until, &|a, b| a != b)?;
                    if let Some(step) = seen.turns.first() {
                        return Ok(Some(step.0));
                    }
                    look = seen.last;
                }
                from = until;
            }
            if self.ahead(|history| (history.log().known() > known).then_some(())).is_none() {
                return Ok(None);
            }
        }
    }

    /// The last step that touched it, before the one that led to the current state.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn last_touch(&self, watched: Watched) -> Result<Option<u64>, Fault> {
        self.last_turn(watched, self.step().saturating_sub(1), &|a, b| a != b)
    }

    /// The steps up to the current state that touched it: the newest `most`, in ascending order.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn touches(&self, watched: Watched, most: usize) -> Result<Vec<u64>, Fault> {
        let found = self.turns(watched, 0, self.step(), &|a, b| a != b, most)?;
        Ok(found.into_iter().rev().map(|turned| turned.0).collect())
    }

    /// The steps after `since` up to the current state that touched a quadrilateral, each with its quality after it:
    /// the newest `most`, in ascending order.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub(super) fn touches_since(&self, quad: ElementId, since: u64, most: usize) -> Result<Vec<(u64, f64)>, Fault> {
        let mut found = self.turns(Watched::Element(quad), since, self.step(), &|a, b| a != b, most)?;
        found.reverse();
        Ok(found)
    }

    /// The triangles that the step which made a quadrilateral merged: live before it and no longer after it.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn merged(&self, made: u64) -> Result<Vec<ElementId>, Fault> {
        let Some(before) = made.checked_sub(1) else { return Ok(Vec::new()) };
        let (mut live, mut merged) = (Vec::new(), Vec::new());
        self.replay(before, made, &mut |step, converter, _| {
            let mesh = &converter.mesh;
            if step == before {
                live = mesh.elements().filter(|e| mesh.is_triangle(*e)).collect();
            } else {
                merged = live.iter().copied().filter(|e| !(mesh.has_element(*e) && mesh.is_triangle(*e))).collect();
            }
        })?;
        Ok(merged)
    }

    /// The last step up to the current state that turned an element into a quadrilateral, regardless of later changes.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn made(&self, element: ElementId) -> Result<Option<u64>, Fault> {
        self.last_turn(Watched::Element(element), self.step(), &|a, b| !a.is_quad() && b.is_quad())
    }

    /// The step up to the current state that killed an edge: since then it is no longer live on both sides.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn killed(&self, a: NodeId, b: NodeId) -> Result<Option<u64>, Fault> {
        let lives = |look: &Appearance| *look == Appearance::Absent || look.is_live_edge();
        self.last_turn(Watched::Edge(a, b), self.step(), &|before, after| lives(before) && !lives(after))
    }

    fn last_turn(&self, watched: Watched, until: u64, turn: Turn<'_>) -> Result<Option<u64>, Fault> {
        Ok(self.turns(watched, 0, until, turn, 1)?.first().map(|turned| turned.0))
    }

    /// The newest `most` steps after `since` up to `until` at which a turn happened, in descending order, each with the
    /// quality of the element after it.
    fn turns(
        &self,
        watched: Watched,
        since: u64,
        mut until: u64,
        turn: Turn<'_>,
        most: usize,
    ) -> Result<Vec<(u64, f64)>, Fault> {
        let mut found = Vec::new();
        let mut look = (until == self.step()).then(|| Appearance::at(&self.state().mesh, watched));
        while until > since && found.len() < most {
            let from = self.keyframes().frames()[self.keyframes().at_or_before(until - 1)].step;
            let (_, difference) = self.stretch_from(from);
            let unchanged = |difference| look.as_ref().is_some_and(|look| !look.may_change(watched, difference));
            if !difference.is_some_and(unchanged) {
                let seen = self.seen(watched, from, until, turn)?;
                found.extend(seen.turns.into_iter().rev());
                look = Some(seen.first);
            }
            until = from;
        }
        found.retain(|turned| turned.0 > since);
        found.truncate(most);
        Ok(found)
    }

    /// The end of the stretch between keyframes that contains the step after `from`, and the difference over the whole
    /// stretch; none after the last keyframe.
    fn stretch_from(&self, from: u64) -> (u64, Option<&Difference>) {
        let next = self.keyframes().frames().get(self.keyframes().at_or_before(from) + 1);
        next.map_or((self.log().known(), None), |frame| (frame.step, frame.difference()))
    }

    /// Observes the states from one step to another, by replay.
    fn seen(&self, watched: Watched, from: u64, until: u64, turn: Turn<'_>) -> Result<Seen, Fault> {
        let mut seen = Seen { first: Appearance::Absent, turns: Vec::new(), last: Appearance::Absent };
        self.replay(from, until, &mut |step, converter, _| {
            let now = Appearance::at(&converter.mesh, watched);
            if step == from {
                seen.first = now.clone();
            } else if seen.last != now && turn(&seen.last, &now) {
                seen.turns.push((step, quality(&converter.mesh, watched)));
            }
            seen.last = now;
        })?;
        Ok(seen)
    }
}

/// What was observed over a stretch of steps.
struct Seen {
    first: Appearance,
    /// The steps of the turns, with the quality of the element after each.
    turns: Vec<(u64, f64)>,
    last: Appearance,
}

/// The quality of an element that is watched; not a number where there is none.
fn quality(mesh: &Mesh, watched: Watched) -> f64 {
    match watched {
        Watched::Element(e) if mesh.has_element(e) => mesh.quality(e),
        _ => f64::NAN,
    }
}
