//! Watchpoints: when was a node, an edge or an element touched next, or last; when did a quadrilateral come to stand, when was
//! an edge killed. Stretches between keyframes that did not touch it are leapt over.

use smallvec::SmallVec;

use super::history::History;
use crate::core::fault::Fault;
use crate::core::mesh::half_edge::{Difference, Mesh};
use crate::core::mesh::ids::{ElementId, NodeId};

/// What is watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watched {
    /// A node: its place, and its edges.
    Node(NodeId),
    /// An edge: whether it is there, and what lies on both sides of it.
    Edge(NodeId, NodeId),
    /// An element: its nodes, and their places.
    Element(ElementId),
}

/// What lies beside an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beside {
    /// Nothing: the edge lies on the boundary.
    Nothing,
    /// A live triangle.
    Live,
    /// A dead quadrilateral.
    Dead,
}

/// How what is watched looks in a state; it was touched where that changes. Places are compared by their bits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Look {
    /// It does not exist.
    Absent,
    /// A node: its place, its neighbours by id with the element before each.
    Node([u64; 2], SmallVec<[(NodeId, Beside); 12]>),
    /// An edge: what lies to the left and to the right of it, seen from its first node.
    Edge([Beside; 2]),
    /// An element: its nodes with their places.
    Element(SmallVec<[(NodeId, [u64; 2]); 4]>),
}

impl Look {
    /// How something looks in a mesh.
    pub fn at(mesh: &Mesh, watched: Watched) -> Look {
        let beside = |e: ElementId| if mesh.is_triangle(e) { Beside::Live } else { Beside::Dead };
        let place = |n: NodeId| [mesh.uv(n).x.to_bits(), mesh.uv(n).y.to_bits()];
        match watched {
            Watched::Node(n) if mesh.has_node(n) => {
                let around = mesh.fan(n).map(|h| (mesh.target(h), beside(h.element())));
                let mut around: SmallVec<[(NodeId, Beside); 12]> = around.collect();
                around.sort_unstable_by_key(|edge| edge.0);
                Look::Node(place(n), around)
            }
            Watched::Edge(a, b) if mesh.has_node(a) && mesh.has_node(b) => {
                let (left, right) = (mesh.half_edge_between(a, b), mesh.half_edge_between(b, a));
                if left.is_none() && right.is_none() {
                    return Look::Absent;
                }
                Look::Edge([left, right].map(|h| h.map_or(Beside::Nothing, |h| beside(h.element()))))
            }
            Watched::Element(e) if mesh.has_element(e) => {
                Look::Element(mesh.corners(e).map(|n| (n, place(n))).collect())
            }
            _ => Look::Absent,
        }
    }

    /// Whether it is a quadrilateral.
    pub fn is_quad(&self) -> bool {
        matches!(self, Look::Element(corners) if corners.len() == 4)
    }

    /// Whether it is an edge that can be changed still: live on both sides.
    pub fn is_live_edge(&self) -> bool {
        *self == Look::Edge([Beside::Live; 2])
    }

    /// Whether a stretch may have changed this look; never wrong where it says no.
    fn may_change(&self, watched: Watched, difference: &Difference) -> bool {
        match watched {
            Watched::Node(n) => difference.touches_node(n),
            Watched::Edge(a, b) => difference.touches_node(a) && difference.touches_node(b),
            Watched::Element(e) => {
                let Look::Element(corners) = self else { return difference.touches_element(e) };
                difference.touches_element(e) || corners.iter().any(|corner| difference.touches_node(corner.0))
            }
        }
    }
}

/// From one look to the next.
type Turn<'a> = &'a dyn Fn(&Look, &Look) -> bool;

impl History {
    /// The next step after the state at hand that touches it. As far as it takes the run is made known, unless the
    /// recorder is lent.
    ///
    /// # Errors
    /// None that the way there has not met.
    pub fn next_touch(&mut self, watched: Watched) -> Result<Option<u64>, Fault> {
        let mut from = self.step();
        let mut look = Look::at(&self.state().mesh, watched);
        loop {
            let known = self.log().known();
            while from < known {
                let (until, difference) = self.stretch_from(from);
                if difference.is_none_or(|difference| look.may_change(watched, difference)) {
                    let seen = self.seen(watched, from, until, &|a, b| a != b)?;
                    if let Some(step) = seen.turns.first() {
                        return Ok(Some(*step));
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

    /// The last step before the one that led to the state at hand, or that one itself where `included`, that touched it: who
    /// touched this last.
    ///
    /// # Errors
    /// None that the way there has not met.
    pub fn last_touch(&self, watched: Watched, included: bool) -> Result<Option<u64>, Fault> {
        self.last_turn(watched, if included { self.step() } else { self.step().saturating_sub(1) }, &|a, b| a != b)
    }

    /// All steps up to the state at hand that touched it, the newest `most` of them, ascending.
    ///
    /// # Errors
    /// None that the way there has not met.
    pub fn touches(&self, watched: Watched, most: usize) -> Result<Vec<u64>, Fault> {
        let mut found = Vec::new();
        let mut until = self.step();
        let mut look = Some(Look::at(&self.state().mesh, watched));
        while until > 0 && found.len() < most {
            let from = self.keyframes().frames()[self.keyframes().at_or_before(until - 1)].step;
            let (_, difference) = self.stretch_from(from);
            let unchanged = |difference| look.as_ref().is_some_and(|look| !look.may_change(watched, difference));
            if !difference.is_some_and(unchanged) {
                let seen = self.seen(watched, from, until, &|a, b| a != b)?;
                found.extend(seen.turns.into_iter().rev());
                look = Some(seen.first);
            }
            until = from;
        }
        found.truncate(most);
        found.reverse();
        Ok(found)
    }

    /// The triangles that the step which made a quadrilateral ate: they were live before it and are not after it.
    ///
    /// # Errors
    /// None that the way there has not met.
    pub fn eaten(&self, made: u64) -> Result<Vec<ElementId>, Fault> {
        let Some(before) = made.checked_sub(1) else { return Ok(Vec::new()) };
        let (mut live, mut eaten) = (Vec::new(), Vec::new());
        self.replay(before, made, &mut |step, converter, _| {
            let mesh = &converter.mesh;
            if step == before {
                live = mesh.elements().filter(|e| mesh.is_triangle(*e)).collect();
            } else {
                eaten = live.iter().copied().filter(|e| !(mesh.has_element(*e) && mesh.is_triangle(*e))).collect();
            }
        })?;
        Ok(eaten)
    }

    /// The step up to the state at hand that made the quadrilateral of an element, however often it was changed since.
    ///
    /// # Errors
    /// None that the way there has not met.
    pub fn made(&self, element: ElementId) -> Result<Option<u64>, Fault> {
        self.last_turn(Watched::Element(element), self.step(), &|a, b| !a.is_quad() && b.is_quad())
    }

    /// The step up to the state at hand that killed an edge: since then it is not live on both sides any more.
    ///
    /// # Errors
    /// None that the way there has not met.
    pub fn killed(&self, a: NodeId, b: NodeId) -> Result<Option<u64>, Fault> {
        let lives = |look: &Look| *look == Look::Absent || look.is_live_edge();
        self.last_turn(Watched::Edge(a, b), self.step(), &|before, after| lives(before) && !lives(after))
    }

    fn last_turn(&self, watched: Watched, until: u64, turn: Turn<'_>) -> Result<Option<u64>, Fault> {
        let mut until = until;
        let mut look = (until == self.step()).then(|| Look::at(&self.state().mesh, watched));
        while until > 0 {
            let from = self.keyframes().frames()[self.keyframes().at_or_before(until - 1)].step;
            let (_, difference) = self.stretch_from(from);
            let unchanged = |difference| look.as_ref().is_some_and(|look| !look.may_change(watched, difference));
            if !difference.is_some_and(unchanged) {
                let seen = self.seen(watched, from, until, turn)?;
                if let Some(step) = seen.turns.last() {
                    return Ok(Some(*step));
                }
                look = Some(seen.first);
            }
            until = from;
        }
        Ok(None)
    }

    /// The end of the stretch between keyframes that holds the step after `from`, and what differs over the whole of it; none
    /// after the last keyframe.
    fn stretch_from(&self, from: u64) -> (u64, Option<&Difference>) {
        let next = self.keyframes().frames().get(self.keyframes().at_or_before(from) + 1);
        next.map_or((self.log().known(), None), |frame| (frame.step, frame.difference()))
    }

    /// Looks at the states from one step to another, by replay.
    fn seen(&self, watched: Watched, from: u64, until: u64, turn: Turn<'_>) -> Result<Seen, Fault> {
        let mut seen = Seen { first: Look::Absent, turns: Vec::new(), last: Look::Absent };
        self.replay(from, until, &mut |step, converter, _| {
            let now = Look::at(&converter.mesh, watched);
            if step == from {
                seen.first = now.clone();
            } else if seen.last != now && turn(&seen.last, &now) {
                seen.turns.push(step);
            }
            seen.last = now;
        })?;
        Ok(seen)
    }
}

/// What was seen over a stretch of steps.
struct Seen {
    first: Look,
    turns: Vec<u64>,
    last: Look,
}
