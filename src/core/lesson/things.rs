//! Nodes, edges and elements that names mean at a state.

use super::names::{Letter, Name, Names, Point, Set};
use super::subject::Subject;
use crate::core::convert::Event;
use crate::core::fault::Fault;
use crate::core::mesh::{ElementId, HalfEdgeId, Mesh, NodeId};
use crate::core::question::swapped;
use crate::core::run::{FrontTable, LastChanges, Watched};

/// What is framed or lit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Things {
    /// Nodes.
    pub nodes: Vec<NodeId>,
    /// Edges that are there.
    pub edges: Vec<[NodeId; 2]>,
    /// Lines between nodes that no edge joins yet: the top edge before it is recovered.
    pub missing: Vec<[NodeId; 2]>,
    /// Elements.
    pub elements: Vec<ElementId>,
}

impl Things {
    /// Whether nothing is there.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty() && self.edges.is_empty() && self.missing.is_empty() && self.elements.is_empty()
    }

    /// All nodes of what is there, ascending: what a camera has to show.
    pub fn all_nodes(&self, mesh: &Mesh) -> Vec<NodeId> {
        let edges = self.edges.iter().chain(&self.missing).flatten();
        let mut nodes: Vec<NodeId> = self.nodes.iter().chain(edges).copied().collect();
        nodes.extend(self.elements.iter().filter(|e| mesh.has_element(**e)).flat_map(|e| mesh.corners(*e)));
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// What names mean at a state; the fault has no place yet.
    pub(super) fn named(names: &Names, subject: &Subject<'_>) -> Result<Things, Fault> {
        let mut things = Things::default();
        let nothing = |name: &str| {
            Fault::new(format!("At step {} there is nothing that \"{name}\" means", subject.state.counts.steps))
                .remedy("Go to another step, or name something else")
        };
        for name in &names.names {
            let mut found = Things::default();
            found.take(*name, subject)?;
            if found.is_empty() {
                let text = match name {
                    Name::Set(set) => set.name().to_owned(),
                    Name::Class(class) => format!("class {class}"),
                    Name::Level(level) => format!("level {level}"),
                    _ => names.text.clone(),
                };
                return Err(nothing(&text));
            }
            things.nodes.extend(found.nodes);
            things.edges.extend(found.edges);
            things.missing.extend(found.missing);
            things.elements.extend(found.elements);
        }
        things.nodes.sort_unstable();
        things.nodes.dedup();
        for lines in [&mut things.edges, &mut things.missing] {
            lines.iter_mut().for_each(|ends| ends.sort_unstable());
            lines.sort_unstable();
            lines.dedup();
        }
        things.elements.sort_unstable();
        things.elements.dedup();
        Ok(things)
    }

    fn take(&mut self, name: Name, subject: &Subject<'_>) -> Result<(), Fault> {
        let mesh = &subject.state.mesh;
        match name {
            Name::Point(place) => self.nodes.push(node(place, subject)?),
            Name::Edge([from, to]) => {
                let ends = [node(from, subject)?, node(to, subject)?];
                self.line(mesh, ends);
            }
            Name::Element(element) if mesh.has_element(element) => self.elements.push(element),
            Name::Element(element) => {
                return Err(Fault::new(format!(
                    "Element {} does not exist at step {}",
                    element.0, subject.state.counts.steps
                )));
            }
            Name::Class(class) => {
                let table = FrontTable::of(subject.state);
                let of = table.rows.iter().filter(|row| row.class == class && table.competes(row));
                self.edges.extend(of.map(|row| [row.a, row.b]));
            }
            Name::Level(level) => {
                self.elements.extend(mesh.elements().filter(|&e| mesh.is_quad(e) && mesh.level(e) == level));
            }
            Name::Set(set) => self.set(set, subject),
        }
        Ok(())
    }

    fn line(&mut self, mesh: &Mesh, ends: [NodeId; 2]) {
        if mesh.are_joined(ends[0], ends[1]) { self.edges.push(ends) } else { self.missing.push(ends) }
    }

    fn set(&mut self, set: Set, subject: &Subject<'_>) {
        let mesh = &subject.state.mesh;
        let [a, b, c, d] = subject.corners;
        let mut join = |from: Option<NodeId>, to: Option<NodeId>| {
            if let (Some(from), Some(to)) = (from, to) {
                self.line(mesh, [from, to]);
            }
        };
        match set {
            Set::Base => join(a, b),
            Set::Left => join(a, c),
            Set::Right => join(b, d),
            Set::Sides => {
                join(a, c);
                join(b, d);
            }
            Set::Top => join(c, d),
            Set::Crossings => self.edges.extend(subject.state.top_crossings().into_iter().flatten()),
            Set::Candidates => self.candidates(subject),
            Set::Changed => self.changed(subject),
            Set::Front => self.edges.extend(mesh.front().map(|h| mesh.ends(h))),
            Set::Loop => {
                if let Some(start) = loop_start(subject) {
                    self.edges.extend(mesh.front_loop(start).map(|h| mesh.ends(h)));
                }
            }
            Set::Boundary => {
                self.edges.extend(mesh.edges().filter(|&h| mesh.twin(h).is_none()).map(|h| mesh.ends(h)));
            }
            Set::Live => self.elements.extend(mesh.elements().filter(|&e| mesh.is_triangle(e))),
            Set::Dead => self.elements.extend(mesh.elements().filter(|&e| mesh.is_quad(e))),
            Set::New => self.elements.extend(subject.quad),
            Set::Next => self.next(subject),
            Set::Corner => self.corner(subject),
            Set::Slender => {
                let slender = subject.state.narrow().into_iter().flat_map(|narrow| narrow.slender);
                self.elements.extend(slender.map(|slender| slender.element));
            }
            Set::Irregular => {
                let is_inner = |n: &NodeId| !mesh.is_fixed(*n);
                self.nodes.extend(mesh.nodes().filter(is_inner).filter(|&n| !mesh.is_regular(n)));
            }
        }
    }

    /// What the last step changed, as far as it is still there.
    fn changed(&mut self, subject: &Subject<'_>) {
        let (mesh, step) = (&subject.state.mesh, subject.state.counts.steps);
        let mut last = LastChanges::default();
        last.follow(subject.log.changes(), step);
        // Step 0 changed nothing.
        if step > 0 {
            self.nodes.extend(mesh.nodes().filter(|n| last.of_node(n.0) == step));
            self.elements.extend(mesh.elements().filter(|e| last.of_element(e.0) == step));
        }
    }

    /// The candidates for the side at hand, those that a swap would make as missing lines.
    fn candidates(&mut self, subject: &Subject<'_>) {
        let Some((tried, base)) = subject.state.candidates().zip(subject.state.phase().base().copied()) else { return };
        let from = base.node(tried.side);
        for candidate in &tried.edges {
            let ends = [from, candidate.node];
            if candidate.swap.is_some() { self.missing.push(ends) } else { self.edges.push(ends) }
        }
    }

    /// What the next step is about.
    fn next(&mut self, subject: &Subject<'_>) {
        let mesh = &subject.state.mesh;
        let Some(event) = subject.next else { return };
        match event {
            Event::BaseSelected { a, b, .. } => self.edges.push([a, b]),
            Event::SideIsFront { .. } | Event::SideChosen { .. } | Event::SideSwapped { .. } => {
                let tried = subject.state.candidates().zip(subject.state.phase().base().copied());
                if let Some((chosen, from)) =
                    tried.and_then(|(tried, base)| Some((*tried.chosen()?, base.node(tried.side))))
                {
                    self.line(mesh, [from, chosen.node]);
                }
            }
            Event::SideDivided { side, .. } => {
                let [a, b, c, d] = subject.corners;
                let [from, to] = [[a, c], [b, d]][side.index()];
                self.edges.extend(from.zip(to).map(|(from, to)| [from, to]));
            }
            Event::TopSwapped { across, .. } => self.edges.push(across),
            Event::TopFound { ends, .. } => self.edges.push(ends),
            Event::NodeRemoved { node, .. } => self.nodes.push(node),
            Event::Formed { nodes: [a, b, d, c], .. } => {
                for ends in [[a, b], [b, d], [d, c], [c, a]] {
                    self.line(mesh, ends);
                }
            }
            Event::Enhanced { new } => self.edges.extend(swapped(mesh, new)),
            Event::Split { node, gone, .. } => self.line(mesh, [node, gone]),
            Event::Seamed { .. } | Event::TransitionSeamed { .. } | Event::SeamRefused { .. } => self.corner(subject),
            _ => {}
        }
    }

    /// The segments of the seam that comes next, or else of the last one, as far as they are there.
    fn corner(&mut self, subject: &Subject<'_>) {
        let mesh = &subject.state.mesh;
        let of = |event: Event| match event {
            Event::Seamed { at, node, gone, .. } | Event::TransitionSeamed { at, node, gone, .. } => {
                Some((at, [node, gone]))
            }
            Event::SeamRefused { at, ends, .. } => Some((at, ends)),
            _ => None,
        };
        let Some((at, ends)) = subject.next.and_then(of).or_else(|| subject.last.and_then(of)) else { return };
        self.edges.extend(
            ends.map(|end| [at, end])
                .into_iter()
                .filter(|[at, end]| mesh.has_node(*at) && mesh.has_node(*end) && mesh.are_joined(*at, *end)),
        );
    }
}

/// A segment of the loop that the state is about: of the base, of the last quadrilateral, or of the next base.
fn loop_start(subject: &Subject<'_>) -> Option<HalfEdgeId> {
    let mesh = &subject.state.mesh;
    let of_base = subject.base().and_then(|[a, b]| mesh.front_between(a, b));
    let of_quad = || {
        let nodes = subject.quad.map(|quad| mesh.quad(quad)).into_iter().flatten();
        nodes.flat_map(|node| mesh.fan(node)).find(|&h| mesh.is_front(h))
    };
    let of_next = || FrontTable::of(subject.state).choice().map(|row| row.h);
    of_base.or_else(of_quad).or_else(of_next)
}

fn node(place: Point, subject: &Subject<'_>) -> Result<NodeId, Fault> {
    let step = subject.state.counts.steps;
    match place {
        Point::Node(node) if subject.state.mesh.has_node(node) => Ok(node),
        Point::Node(node) => Err(Fault::new(format!("Node {} does not exist at step {step}", node.0))),
        Point::Letter(letter) => subject.corners[letter as usize].ok_or_else(|| {
            let which = match letter {
                Letter::A | Letter::B => "no quadrilateral is under way",
                Letter::C => "the left side is not decided yet",
                Letter::D => "the right side is not decided yet",
            };
            Fault::new(format!("At step {step} there is no {}: {which}", letter.name())).remedy("Go to a later step")
        }),
    }
}

/// The one thing that names mean, as a question needs it; the fault has no place yet.
pub(super) fn watched(names: &Names, subject: &Subject<'_>) -> Result<Watched, Fault> {
    let fault = || {
        Fault::new(format!("A question is about one node, edge or element, not \"{}\"", names.text))
            .remedy("Write for example of: \"7-4\"")
    };
    let things = Things::named(names, subject)?;
    match (&things.nodes[..], &things.edges[..], &things.elements[..]) {
        ([node], [], []) => Ok(Watched::Node(*node)),
        ([], [[a, b]], []) => Ok(Watched::Edge(*a, *b)),
        ([], [], [element]) => Ok(Watched::Element(*element)),
        _ => Err(fault()),
    }
}
