//! Faces, edges, boundary and nodes of a mesh: all of them, or those that a step changed.

use std::sync::Arc;

use glam::DVec3;

use super::placed::Places;
use super::{ColourBy, Dot, Face, Form, Layers, Line, Scene, Shading, Spot, ink, relative};
use crate::core::mesh::{ElementId, HalfEdgeId, Mesh, NodeId};
use crate::render::palette::Palette;

/// Widths of mesh edges in points: live, dead.
const EDGES: [f32; 2] = [0.75, 0.95];

/// The opacity of the highlight of changes by the last step, by the one before, and by the one before that.
pub(super) const FADES: [f32; 3] = [1.0, 0.4, 0.15];

/// A dot that is not drawn.
const NO_DOT: Dot =
    Dot { at: [0.0; 3], radius: 0.0, fill: 0, ring: 0, ring_width: 0.0, room: 0.0, least: f32::INFINITY };

/// A mesh, and how to draw it.
#[derive(Clone, Copy)]
pub struct Drawn<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// The elements that the last steps changed, the newest first.
    pub changed: &'a [Arc<[ElementId]>],
    /// The colouring of elements.
    pub shading: &'a Shading,
    /// The layers drawn.
    pub layers: Layers,
    /// The colours.
    pub palette: &'a Palette,
    /// The form in which it is drawn; patching a scene keeps its form.
    pub form: Form,
}

impl Scene {
    /// Rebuilds faces, edges, boundary and nodes from a mesh, relative to `anchor`.
    pub fn set_mesh(&mut self, drawn: &Drawn<'_>, anchor: DVec3) {
        self.anchor = anchor;
        self.generation += 1;
        let pieces = drawn.form.pieces(drawn.mesh.element_slots());
        if pieces != self.pieces {
            self.pieces = pieces;
            (self.places, self.boundary_places) = (Places::of_chains(pieces), Places::of_chains(pieces));
            self.edges.replace(&[], self.generation);
            self.boundary.replace(&[], self.generation);
        }
        self.form = drawn.form;
        self.resize(drawn.mesh);
        self.copies.clear();
        for node in drawn.mesh.nodes() {
            self.set_spot(drawn.mesh, node);
        }
        let slots = (0..drawn.mesh.element_slots() as u32).map(ElementId);
        slots.clone().for_each(|e| self.leave_places(drawn.mesh, e));
        slots.for_each(|e| self.set_element(drawn, e));
        for node in (0..drawn.mesh.node_slots() as u32).map(NodeId) {
            self.set_node(drawn, node);
        }
        self.standing_out.clear();
        self.set_standing_out(drawn);
    }

    /// Updates them from the state drawn before to another state of the mesh, which differs in `nodes` and `elements`.
    pub fn patch_mesh(&mut self, drawn: &Drawn<'_>, nodes: &[NodeId], elements: &[ElementId]) {
        let mesh = drawn.mesh;
        self.generation += 1;
        self.resize(mesh);
        let moved = nodes.iter().copied().filter(|n| mesh.has_node(*n));
        for node in moved.clone() {
            self.set_spot(mesh, node);
        }
        let mut around: Vec<ElementId> = moved.flat_map(|n| mesh.fan(n)).map(HalfEdgeId::element).collect();
        around.extend(elements.iter().copied().filter(|e| e.index() < mesh.element_slots()));
        around.sort_unstable();
        around.dedup();
        // Free the slots of removed edges first, so that new edges can use them.
        around.iter().for_each(|e| self.leave_places(mesh, *e));
        around.iter().for_each(|e| self.set_element(drawn, *e));
        let here = around.iter().filter(|e| mesh.has_element(**e));
        let mut near: Vec<NodeId> = here.flat_map(|e| mesh.corners(*e)).collect();
        near.extend(nodes.iter().copied().filter(|n| n.index() < mesh.node_slots()));
        near.sort_unstable();
        near.dedup();
        for node in near {
            self.set_node(drawn, node);
        }
        self.set_standing_out(drawn);
    }

    fn resize(&mut self, mesh: &Mesh) {
        let generation = self.generation;
        self.faces.resize(self.faces_per_element() * mesh.element_slots(), Face::default(), generation);
        self.spots.resize(mesh.node_slots(), Spot::default());
        self.dots.resize(mesh.node_slots(), NO_DOT, generation);
        self.places.resize(4 * mesh.element_slots(), &mut self.edges, generation);
        self.boundary_places.resize(4 * mesh.element_slots(), &mut self.boundary, generation);
    }

    /// Removes the edges of an element slot that belong to other half-edges now or no longer exist.
    fn leave_places(&mut self, mesh: &Mesh, e: ElementId) {
        for h in (0..4).map(|corner| e.half_edge(corner)) {
            let twin = side(mesh, h).map(|h| mesh.twin(h));
            if twin.is_none_or(|twin| twin.is_some_and(|t| t < h)) {
                self.places.put(h.index(), &[], &mut self.edges, self.generation);
            }
            if twin != Some(None) {
                self.boundary_places.put(h.index(), &[], &mut self.boundary, self.generation);
            }
        }
    }

    /// Updates the face of an element slot (nothing for a tombstone) and the edges around it.
    fn set_element(&mut self, drawn: &Drawn<'_>, e: ElementId) {
        let mesh = drawn.mesh;
        self.set_faces(drawn, e, 0.0);
        for h in mesh.half_edges(e) {
            // An edge belongs to that of its two half-edges with the smaller id.
            let twin = mesh.twin(h);
            let first = twin.map_or(h, |t| t.min(h));
            let edge = self.edge(drawn, first);
            self.places.put(first.index(), &edge, &mut self.edges, self.generation);
            if twin.is_none() {
                let line = self.boundary_line(drawn, h);
                self.boundary_places.put(h.index(), &line, &mut self.boundary, self.generation);
            }
        }
    }

    fn set_faces(&mut self, drawn: &Drawn<'_>, e: ElementId, change: f32) {
        let faces = self.faces_of(drawn, e, change);
        let count = self.faces_per_element();
        for k in 0..count {
            self.faces.set(count * e.index() + k, faces.get(k).copied().unwrap_or_default(), self.generation);
        }
    }

    /// The faces of an element, blended with the highlight of changes by `change`; none where it is not drawn.
    fn faces_of(&self, drawn: &Drawn<'_>, e: ElementId, change: f32) -> Vec<Face> {
        let Drawn { mesh, shading, layers, palette, .. } = *drawn;
        if !mesh.has_element(e) {
            return Vec::new();
        }
        let (shown, plain) = if mesh.is_quad(e) { (layers.dead, palette.dead) } else { (layers.live, palette.live) };
        if !shown && change == 0.0 {
            return Vec::new();
        }
        let colour = match shading.by {
            ColourBy::State => plain.mixed(palette.changed, change),
            _ => shading.colour(e).unwrap_or(plain),
        };
        self.element_faces(mesh, e, ink(colour))
    }

    /// Highlights the faces just changed, and removes the previous highlight.
    fn set_standing_out(&mut self, drawn: &Drawn<'_>) {
        let mesh = drawn.mesh;
        for e in std::mem::take(&mut self.standing_out) {
            if e.index() < mesh.element_slots() {
                self.set_faces(drawn, e, 0.0);
            }
        }
        for (changed, fade) in drawn.changed.iter().zip(FADES).rev() {
            for &e in changed.iter().filter(|e| mesh.has_element(**e)) {
                self.set_faces(drawn, e, fade);
                self.standing_out.push(e);
            }
        }
    }

    fn edge(&self, drawn: &Drawn<'_>, h: HalfEdgeId) -> Vec<Line> {
        let Drawn { mesh, layers, palette, .. } = *drawn;
        let sides = [Some(h), mesh.twin(h)];
        let dead = sides.iter().flatten().any(|h| mesh.is_quad(h.element()));
        let shown = sides.iter().flatten().any(|h| if mesh.is_quad(h.element()) { layers.dead } else { layers.live });
        if !shown {
            return Vec::new();
        }
        let ends = mesh.ends(h);
        let heights = sides.iter().flatten().map(|h| self.room_over(mesh, *h, ends));
        let line = Line {
            ends: Default::default(),
            colour: ink(if dead { palette.dead_edge } else { palette.live_edge }),
            width: EDGES[usize::from(dead)],
            dash: [0.0; 2],
            room: heights.fold(f64::INFINITY, f64::min) as f32,
        };
        self.chain(mesh, ends, line).collect()
    }

    fn boundary_line(&self, drawn: &Drawn<'_>, h: HalfEdgeId) -> Vec<Line> {
        let mesh = drawn.mesh;
        if !drawn.layers.boundary {
            return Vec::new();
        }
        let line = Line {
            ends: Default::default(),
            colour: ink(drawn.palette.boundary),
            width: 1.75,
            dash: [0.0; 2],
            room: -1.0,
        };
        self.chain(mesh, mesh.ends(h), line).collect()
    }

    fn set_node(&mut self, drawn: &Drawn<'_>, node: NodeId) {
        let Drawn { mesh, layers, palette, .. } = *drawn;
        if !layers.nodes || !mesh.has_node(node) {
            return self.dots.set(node.index(), NO_DOT, self.generation);
        }
        let p = self.at(node);
        let nearest = mesh.neighbours(node).map(|n| self.at(n).distance_squared(p)).fold(f64::INFINITY, f64::min);
        let front = mesh.fan(node).any(|h| mesh.is_front(h) || mesh.is_front(mesh.previous(h)));
        let dot = Dot {
            at: relative(p, self.anchor),
            radius: 2.8,
            fill: ink(if front { palette.label } else { palette.weak }),
            ring: ink(palette.ground),
            ring_width: 0.8,
            room: nearest.sqrt() as f32,
            least: if front { 6.0 } else { 14.0 },
        };
        self.dots.set(node.index(), dot, self.generation);
    }

    /// The height over the side `h` of its element, which has these ends: of a quadrilateral the mean of its two other
    /// corners.
    fn room_over(&self, mesh: &Mesh, h: HalfEdgeId, ends: [NodeId; 2]) -> f64 {
        let [a, b] = ends.map(|n| self.at(n));
        let along = (b - a).normalize_or_zero();
        let height = |h: HalfEdgeId| along.cross(self.at(mesh.origin(h)) - a).length();
        let last = mesh.previous(h);
        if mesh.is_triangle(h.element()) { height(last) } else { 0.5 * (height(last) + height(mesh.previous(last))) }
    }
}

/// The half-edge in a slot, if it is a side of its element.
fn side(mesh: &Mesh, h: HalfEdgeId) -> Option<HalfEdgeId> {
    ((h.corner() as usize) < mesh.sides(h.element())).then_some(h)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::progress::Nobody;
    use crate::core::run::{Changes, History, Run};
    use crate::render::fixtures::two_squares;
    use crate::render::palette::DARK;

    fn draw(mesh: &Mesh, scene: &mut Scene, layers: Layers) {
        let drawn =
            Drawn { mesh, changed: &[], shading: &Shading::default(), layers, palette: &DARK, form: Form::Plane };
        scene.set_mesh(&drawn, DVec3::ZERO);
    }

    #[test]
    fn a_swap_changes_the_places_of_its_own_edge_alone() {
        let mut mesh = two_squares();
        let mut scene = Scene::default();
        draw(&mesh, &mut scene, Layers::default());
        let before = scene.edges.items().to_vec();
        assert_eq!(before.len(), 9);
        let h = mesh.edges().find(|&h| mesh.can_swap(h).is_ok()).unwrap();
        mesh.swap(h);
        draw(&mesh, &mut scene, Layers::default());
        assert_eq!(scene.edges.items().len(), before.len());
        let changed = scene.edges.items().iter().zip(&before).filter(|(a, b)| a.ends != b.ends).count();
        // The swapped edge itself; of the four around it those whose half-edge changed its slot move with it.
        assert!((1..=5).contains(&changed), "{changed}");
        let mut ends: Vec<_> = scene.edges.items().iter().map(|l| format!("{:?}", l.ends)).collect();
        ends.sort();
        ends.dedup();
        assert_eq!(ends.len(), 9, "every edge once");
    }

    #[test]
    fn a_layer_that_is_off_is_not_drawn() {
        let mesh = two_squares();
        let mut scene = Scene::default();
        let layers = Layers { live: false, nodes: false, ..Layers::default() };
        draw(&mesh, &mut scene, layers);
        assert!(scene.faces.items().iter().all(|f| f.colour == 0) && scene.edges.items().is_empty());
        assert!(scene.dots.items().iter().all(|d| d.least.is_infinite()));
    }

    /// Everything drawn, in no order: faces, edges, boundary, dots.
    fn seen(scene: &Scene) -> [Vec<String>; 4] {
        let lines = |lines: &[Line]| {
            let mut seen: Vec<_> = lines.iter().filter(|l| l.colour != 0).map(|l| format!("{l:?}")).collect();
            seen.sort();
            seen
        };
        let faces = scene.faces.items().iter().map(|face| format!("{face:?}")).collect();
        let dots = scene.dots.items().iter().map(|dot| format!("{dot:?}")).collect();
        [faces, lines(scene.edges.items()), lines(scene.boundary.items()), dots]
    }

    #[test]
    fn a_scene_that_follows_what_changes_is_that_of_the_state_and_costs_what_changed() {
        follows("example1", 2.0, Form::Plane);
    }

    #[test]
    fn so_does_one_in_space_with_flat_and_with_curved_elements() {
        follows("example2", 2.5, Form::Flat);
        follows("sphere", 2.5, Form::Curved);
    }

    fn follows(name: &str, size_scale: f64, form: Form) {
        let mut case = built_in::named(name).unwrap().unwrap();
        case.parameters.size_scale = size_scale;
        let mut history = History::open(Run::of(case), &mut Nobody).unwrap();
        history.extend(u64::MAX);
        let end = history.end().unwrap();
        let mut scene = Scene::default();
        let (mut most, mut patched) = (0, 0);
        for step in (0..end).chain((end / 2..end).rev()).chain([end / 2 + 60]) {
            history.seek(step).unwrap();
            let changes = history.take_changes();
            let mesh = &history.state().mesh;
            let changed = match &changes {
                Changes::Some { elements, .. } => elements.clone(),
                Changes::Everything => Vec::new(),
            };
            let changed = [Arc::from(changed)];
            let shading = Shading::default();
            let (layers, palette) = (Layers::default(), &DARK);
            let drawn = Drawn { mesh, changed: &changed, shading: &shading, layers, palette, form };
            match &changes {
                Changes::Everything => scene.set_mesh(&drawn, DVec3::ZERO),
                Changes::Some { nodes, elements } => {
                    let before = scene.edges.items().to_vec();
                    scene.patch_mesh(&drawn, nodes, elements);
                    let pairs = scene.edges.items().iter().zip(&before);
                    most = most.max(pairs.filter(|(a, b)| a != b).count());
                    patched += 1;
                }
            }
            if step % 23 == 0 || step + 40 > end {
                let mut afresh = Scene::default();
                afresh.set_mesh(&drawn, DVec3::ZERO);
                assert_eq!(seen(&scene), seen(&afresh), "step {step}");
            }
        }
        assert!(patched as u64 > end, "{patched} of {end}");
        assert!(most < scene.edges.items().len(), "{most}");
    }
}
