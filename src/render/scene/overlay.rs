//! Overlays of the mesh: changes by the last operations, front, decision, selection.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::mesh::FADES;
use super::{Dot, Layers, Line, Scene, Spot, relative};
use crate::core::case::Parameters;
use crate::core::convert::Phase;
use crate::core::front::Segment;
use crate::core::mesh::{ElementId, Mesh, NodeId};
use crate::render::palette::{Palette, Rgba};

/// Widths of front segments by class, in points.
pub const FRONT: [f32; 4] = [3.2, 3.0, 3.0, 2.4];
const BASE: f32 = 5.0;
const SIDE: f32 = 3.2;
const TOP: f32 = 2.6;
/// The width of what a lesson speaks of.
const SPOKEN: f32 = 9.0;

/// The current quadrilateral: its base AB and, as far as they are known, its top nodes C (at A) and D (at B).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Decision {
    /// A and B.
    pub base: Option<[NodeId; 2]>,
    /// C and D.
    pub tops: [Option<NodeId>; 2],
}

impl Decision {
    /// The decision in a phase.
    pub fn of(phase: &Phase) -> Decision {
        let tops = match phase {
            Phase::PrepareSide { left, .. } => [*left, None],
            Phase::DivideSide { tops, .. } => *tops,
            Phase::RecoverTop { tops, .. } | Phase::Form { tops, .. } => tops.map(Some),
            _ => [None; 2],
        };
        Decision { base: phase.base().map(|base| [base.a, base.b]), tops }
    }

    /// Its nodes with their letters.
    pub fn letters(&self) -> impl Iterator<Item = (NodeId, char)> + '_ {
        let base = self.base.into_iter().flat_map(|[a, b]| [(a, 'A'), (b, 'B')]);
        base.chain(self.tops[0].map(|c| (c, 'C'))).chain(self.tops[1].map(|d| (d, 'D')))
    }
}

/// An item that is selected or under the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Outlined {
    /// A node.
    Node(NodeId),
    /// An edge or front segment, by its nodes.
    Edge([NodeId; 2]),
    /// An element.
    Element(ElementId),
}

/// The overlays of a mesh.
pub struct Overlay<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Its front.
    pub front: &'a [Segment],
    /// Elements that the last operations changed, the newest first.
    pub changed: &'a [Arc<[ElementId]>],
    /// The current quadrilateral.
    pub decision: Decision,
    /// Whether elements are coloured by a quantity.
    pub is_coloured: bool,
    /// Candidate edges that were rejected.
    pub refused: &'a [[NodeId; 2]],
    /// The selection.
    pub picked: Option<Outlined>,
    /// What is under the pointer.
    pub hovered: Option<Outlined>,
    /// Items that a plot or a list highlights.
    pub lit: &'a [Outlined],
    /// What a lesson speaks of: in the accent colour, behind everything else.
    pub spoken: &'a [Outlined],
    /// Whether all segments of the front look alike, so that nothing tells their classes.
    pub hides_classes: bool,
    /// The mesh at step 0, where that layer is on.
    pub background: Option<&'a Mesh>,
}

/// The front of a mesh, measured.
pub fn front(mesh: &Mesh, parameters: &Parameters) -> Vec<Segment> {
    mesh.front().map(|h| Segment::measure(mesh, h, parameters)).collect()
}

impl Scene {
    /// Rebuilds the overlays from `overlay`.
    pub fn set_overlay(&mut self, overlay: &Overlay<'_>, layers: Layers, palette: &Palette) {
        self.generation += 1;
        let (mut over, mut dots) = (Vec::new(), Vec::new());
        self.add_background(&mut over, overlay, palette);
        self.add_changed(&mut over, overlay, palette);
        self.under.replace(&over, self.generation);
        over.clear();
        self.add_spoken(&mut over, &mut dots, overlay, palette);
        self.add_lit(&mut over, overlay, palette);
        self.add_hover(&mut over, &mut dots, overlay, palette);
        self.add_front(&mut over, overlay, layers, palette);
        self.add_picked(&mut over, &mut dots, overlay, palette);
        self.add_decision(&mut over, &mut dots, overlay, palette);
        self.over.replace(&over, self.generation);
        self.over_dots.replace(&dots, self.generation);
    }

    /// A line between nodes, along the surface where elements are curved; `None` where a node does not exist.
    fn line(&self, mesh: &Mesh, ends: [NodeId; 2], colour: Rgba, width: f32, dash: [f32; 2]) -> Vec<Line> {
        if !ends.iter().all(|n| mesh.has_node(*n) && n.index() < self.spots.len()) {
            return Vec::new();
        }
        let line = Line { ends: Default::default(), colour: colour.packed(), width, dash, room: -1.0 };
        self.chain(mesh, ends, line).collect()
    }

    fn add(&self, over: &mut Vec<Line>, mesh: &Mesh, ends: [NodeId; 2], colour: Rgba, width: f32) {
        over.extend(self.line(mesh, ends, colour, width, [0.0; 2]));
    }

    fn add_sides(&self, over: &mut Vec<Line>, mesh: &Mesh, e: ElementId, colour: Rgba, width: f32) {
        mesh.half_edges(e).for_each(|h| self.add(over, mesh, mesh.ends(h), colour, width));
    }

    fn add_background(&self, over: &mut Vec<Line>, overlay: &Overlay<'_>, palette: &Palette) {
        let Some(background) = overlay.background else { return };
        for h in background.edges() {
            // Its nodes differ from those of the scene.
            let place = |n: NodeId| relative(Spot::of(background, n, self.form).at, self.anchor);
            let ends = background.ends(h).map(place);
            let colour = palette.hint.faded(0.5).packed();
            over.push(Line { ends, colour, width: 0.6, dash: [0.0; 2], room: -1.0 });
        }
    }

    fn add_changed(&self, over: &mut Vec<Line>, overlay: &Overlay<'_>, palette: &Palette) {
        let mesh = overlay.mesh;
        for (changed, fade) in overlay.changed.iter().zip(FADES).rev() {
            for &e in changed.iter().filter(|e| mesh.has_element(**e)) {
                self.add_sides(over, mesh, e, palette.changed_edge.faded(fade), 1.5);
            }
        }
    }

    fn add_front(&self, over: &mut Vec<Line>, overlay: &Overlay<'_>, layers: Layers, palette: &Palette) {
        if !layers.front {
            return;
        }
        // Every colour of a map must leave the front visible.
        let (casing, opacity) = if overlay.is_coloured { (4.0, 1.0) } else { (2.0, 0.8) };
        let class = |segment: &Segment| if overlay.hides_classes { 2 } else { segment.class };
        for segment in overlay.front {
            let width = FRONT[usize::from(class(segment)) - 1] + casing;
            self.add(over, overlay.mesh, [segment.a, segment.b], palette.ground.faded(opacity), width);
        }
        for row in (1..=4).rev() {
            for segment in overlay.front.iter().filter(|s| class(s) == row) {
                let k = usize::from(row) - 1;
                let colour = if overlay.hides_classes { palette.text } else { palette.front[k] };
                self.add(over, overlay.mesh, [segment.a, segment.b], colour, FRONT[k]);
            }
        }
    }

    fn add_spoken(&self, over: &mut Vec<Line>, dots: &mut Vec<Dot>, overlay: &Overlay<'_>, palette: &Palette) {
        let (mesh, colour) = (overlay.mesh, palette.base.faded(0.5));
        // Of elements side by side the outline of all of them.
        let mut sides: BTreeMap<[NodeId; 2], usize> = BTreeMap::new();
        for what in overlay.spoken {
            match *what {
                Outlined::Edge(ends) => self.add(over, mesh, ends, colour, SPOKEN),
                Outlined::Element(e) if mesh.has_element(e) => {
                    for h in mesh.half_edges(e) {
                        let [a, b] = mesh.ends(h);
                        *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
                    }
                }
                Outlined::Node(node) if mesh.has_node(node) => {
                    self.add_dot(dots, node, 8.0, palette.base.faded(0.25), palette.base, 2.0);
                }
                _ => {}
            }
        }
        let outline = sides.into_iter().filter(|(_, count)| *count == 1);
        outline.for_each(|(ends, _)| self.add(over, mesh, ends, colour, SPOKEN));
    }

    fn add_lit(&self, over: &mut Vec<Line>, overlay: &Overlay<'_>, palette: &Palette) {
        let mesh = overlay.mesh;
        for what in overlay.lit {
            match *what {
                Outlined::Edge(ends) => self.add(over, mesh, ends, palette.selection, 2.5),
                Outlined::Element(e) if mesh.has_element(e) => self.add_sides(over, mesh, e, palette.selection, 2.0),
                _ => {}
            }
        }
    }

    fn add_hover(&self, over: &mut Vec<Line>, dots: &mut Vec<Dot>, overlay: &Overlay<'_>, palette: &Palette) {
        let mesh = overlay.mesh;
        match overlay.hovered {
            Some(Outlined::Edge(ends)) => self.add(over, mesh, ends, palette.hover, 8.0),
            Some(Outlined::Element(e)) if mesh.has_element(e) => self.add_sides(over, mesh, e, palette.hover, 4.0),
            Some(Outlined::Node(node)) if mesh.has_node(node) => {
                self.add_dot(dots, node, 7.0, Rgba::default(), palette.hover, 2.0)
            }
            _ => {}
        }
    }

    /// A double outline around the selection.
    fn add_picked(&self, over: &mut Vec<Line>, dots: &mut Vec<Dot>, overlay: &Overlay<'_>, palette: &Palette) {
        let mesh = overlay.mesh;
        match overlay.picked {
            Some(Outlined::Edge(ends)) => {
                let base = overlay.decision.base;
                let segment = overlay.front.iter().find(|s| [s.a, s.b] == ends || [s.b, s.a] == ends);
                let is_base = base == Some(ends) || base == Some([ends[1], ends[0]]);
                let (colour, width) = match segment {
                    _ if is_base => (palette.base, BASE),
                    Some(segment) => {
                        let k = usize::from(segment.class) - 1;
                        (palette.front[k], FRONT[k])
                    }
                    None => (palette.dead_edge, 1.5),
                };
                self.add(over, mesh, ends, palette.selection, width + 5.5);
                self.add(over, mesh, ends, palette.ground, width + 3.0);
                self.add(over, mesh, ends, colour, width);
            }
            Some(Outlined::Element(e)) if mesh.has_element(e) => {
                for (colour, width) in [(palette.selection, 4.5), (palette.ground, 2.0)] {
                    self.add_sides(over, mesh, e, colour, width);
                }
            }
            Some(Outlined::Node(node)) if mesh.has_node(node) => {
                self.add_dot(dots, node, 7.5, Rgba::default(), palette.selection, 1.5);
            }
            _ => {}
        }
    }

    fn add_decision(&self, over: &mut Vec<Line>, dots: &mut Vec<Dot>, overlay: &Overlay<'_>, palette: &Palette) {
        let mesh = overlay.mesh;
        let Decision { base, tops } = overlay.decision;
        for &ends in overlay.refused {
            over.extend(self.line(mesh, ends, palette.refused, 1.25, [2.0, 4.0]));
        }
        let Some([a, b]) = base else { return };
        let sides = [tops[0].map(|c| [a, c]), tops[1].map(|d| [b, d])];
        for (colour, width) in [(palette.ground.faded(0.9), SIDE + 2.8), (palette.side, SIDE)] {
            sides.into_iter().flatten().for_each(|ends| self.add(over, mesh, ends, colour, width));
        }
        if let [Some(c), Some(d)] = tops {
            self.add(over, mesh, [c, d], palette.ground.faded(0.9), TOP + 2.8);
            over.extend(self.line(mesh, [c, d], palette.side, TOP, [7.0, 5.0]));
        }
        self.add(over, mesh, [a, b], palette.ground.faded(0.9), BASE + 2.8);
        self.add(over, mesh, [a, b], palette.base, BASE);
        for (node, _) in overlay.decision.letters().filter(|(n, _)| mesh.has_node(*n)).collect::<Vec<_>>() {
            self.add_dot(dots, node, 4.9, palette.ground, palette.base, 2.0);
        }
    }

    fn add_dot(&self, dots: &mut Vec<Dot>, node: NodeId, radius: f32, fill: Rgba, ring: Rgba, ring_width: f32) {
        let (at, fill, ring) = (relative(self.at(node), self.anchor), fill.packed(), ring.packed());
        dots.push(Dot { at, radius, fill, ring, ring_width, ..Dot::default() });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::fixtures::square;
    use crate::render::palette::DARK;
    use crate::render::scene::{Drawn, Form, Shading};
    use glam::DVec3;

    fn drawn(mesh: &Mesh) -> Scene {
        let mut scene = Scene::default();
        let (shading, layers) = (Shading::default(), Layers::default());
        let drawn = Drawn { mesh, changed: &[], shading: &shading, layers, palette: &DARK, form: Form::Plane };
        scene.set_mesh(&drawn, DVec3::ZERO);
        scene
    }

    fn bare(mesh: &Mesh) -> Overlay<'_> {
        let decision = Decision::default();
        let (picked, hovered, background) = (None, None, None);
        Overlay {
            mesh,
            front: &[],
            changed: &[],
            decision,
            refused: &[],
            picked,
            hovered,
            lit: &[],
            spoken: &[],
            hides_classes: false,
            background,
            is_coloured: false,
        }
    }

    #[test]
    fn the_decision_lies_over_the_front() {
        let mesh = square();
        let front = front(&mesh, &Parameters::default());
        let decision = Decision { base: Some([NodeId(0), NodeId(1)]), tops: [Some(NodeId(3)), Some(NodeId(2))] };
        let refused = &[[NodeId(0), NodeId(2)]];
        let overlay = Overlay { front: &front, decision, refused, ..bare(&mesh) };
        let mut scene = drawn(&mesh);
        scene.set_overlay(&overlay, Layers::default(), &DARK);
        let last = |colour: Rgba| scene.over.items().iter().rposition(|l| l.colour == colour.packed()).unwrap();
        let order = [DARK.front[0], DARK.refused, DARK.side, DARK.base].map(last);
        assert!(order.is_sorted(), "{order:?}");
        assert_eq!(scene.over_dots.items().len(), 4);
        let letters: String = decision.letters().map(|l| l.1).collect();
        assert_eq!(letters, "ABCD");
    }

    #[test]
    fn what_is_spoken_of_is_behind_the_front_and_elements_have_one_outline() {
        let mesh = square();
        let all: Vec<Outlined> = mesh.elements().map(Outlined::Element).collect();
        assert_eq!(all.len(), 2);
        let front = front(&mesh, &Parameters::default());
        let mut scene = drawn(&mesh);
        let spoken = [&all[..], &[Outlined::Node(NodeId(1)), Outlined::Node(NodeId(77))]].concat();
        let overlay = Overlay { front: &front, spoken: &spoken, ..bare(&mesh) };
        scene.set_overlay(&overlay, Layers::default(), &DARK);
        let lines = scene.over.items();
        let halo = DARK.base.faded(0.5).packed();
        // Four sides of the square; the diagonal is inside.
        assert_eq!(lines.iter().filter(|line| line.colour == halo).count(), 4);
        assert!(lines[..4].iter().all(|line| line.colour == halo));
        assert_eq!(scene.over_dots.items().len(), 1, "node 77 is not there");
    }

    #[test]
    fn a_question_about_classes_shows_a_front_of_one_colour() {
        let mesh = square();
        let front = front(&mesh, &Parameters::default());
        let mut scene = drawn(&mesh);
        let overlay = Overlay { front: &front, hides_classes: true, ..bare(&mesh) };
        scene.set_overlay(&overlay, Layers::default(), &DARK);
        let of_classes = DARK.front.map(Rgba::packed);
        assert!(scene.over.items().iter().all(|line| !of_classes.contains(&line.colour)));
        assert_eq!(scene.over.items().len(), 2 * front.len());
    }

    #[test]
    fn what_is_no_longer_there_is_not_drawn() {
        let mesh = square();
        let overlay = Overlay {
            changed: &[[ElementId(7)].into()],
            picked: Some(Outlined::Edge([NodeId(0), NodeId(9)])),
            hovered: Some(Outlined::Element(ElementId(9))),
            lit: &[Outlined::Element(ElementId(5)), Outlined::Edge([NodeId(8), NodeId(9)])],
            ..bare(&mesh)
        };
        let mut scene = drawn(&mesh);
        scene.set_overlay(&overlay, Layers { boundary: false, ..Layers::default() }, &DARK);
        assert!([&scene.over, &scene.under].iter().all(|list| list.items().is_empty()));
        assert!(scene.over_dots.items().is_empty());
    }
}
