//! The content of a drawing: areas and lines with a role, in coordinates of the mesh. Deliberately absent: colours,
//! widths, pixels (which `palette` and the writers know).

use glam::{DVec2, DVec3};

use smallvec::SmallVec;

use super::orthographic::{self, Orthographic, View};

use super::look::{Layer, Layers, Look};
use super::refused::{Refused, refused};
use super::scene::Decision;
use crate::core::case::Parameters;
use crate::core::convert::{Candidates, Phase};
use crate::core::front::{Segment, Side};
use crate::core::kernel::number;
use crate::core::mesh::{ElementId, Mesh, Names, NodeId};
use crate::core::record::Export;
use crate::core::soup::MeshFile;

/// Metric ellipses are drawn at this share of unit length.
const ELLIPSE: f64 = 0.25;

/// The role of an area or a line; writers draw in the order of [`Role::ALL`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// A live triangle.
    LiveTriangle,
    /// A quadrilateral of the result.
    DeadQuad,
    /// An element that the last step changed, drawn over its own area.
    Changed,
    /// An edge between live triangles.
    LiveEdge,
    /// An edge of a quadrilateral.
    DeadEdge,
    /// An edge of an element that the last step changed.
    ChangedEdge,
    /// An edge of the boundary, of a crack or of an interior line.
    Boundary,
    /// A segment of the merging front, with its class of table 1 (1 to 4).
    Front(u8),
    /// A candidate for a side edge that was not chosen.
    Refused,
    /// A side edge of the current quadrilateral.
    Side,
    /// Its top edge, existing or still to be recovered.
    Top,
    /// The base segment of the current quadrilateral.
    Base,
}

impl Role {
    /// All roles from back to front.
    pub const ALL: [Role; 15] = [
        Role::LiveTriangle,
        Role::DeadQuad,
        Role::Changed,
        Role::LiveEdge,
        Role::DeadEdge,
        Role::ChangedEdge,
        Role::Boundary,
        Role::Front(4),
        Role::Front(3),
        Role::Front(2),
        Role::Front(1),
        Role::Refused,
        Role::Side,
        Role::Top,
        Role::Base,
    ];
}

/// An area: an element, or what is seen of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// Its role.
    pub role: Role,
    /// Its corners, anticlockwise. The outline of a hole is an area too, with its corners clockwise: what areas of one
    /// role go around in all is filled where they go around it other than zero times.
    pub outline: SmallVec<[DVec2; 4]>,
}

/// A straight line.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its role.
    pub role: Role,
    /// Ends.
    pub ends: [DVec2; 2],
    /// The smallest height over this line of the elements beside it, in units of the mesh: the room around it.
    pub room: f64,
    /// Whether elements hide it.
    pub hidden: bool,
}

/// A mark of constant size on the page; marks without room are left out.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A letter at a point.
    Letter {
        /// The point.
        at: DVec2,
        /// The point on whose opposite side it is placed.
        from: DVec2,
        /// The letter.
        letter: char,
    },
    /// A wedge in a corner of the front: the directions of its legs, anticlockwise.
    Wedge {
        /// The corner.
        at: DVec2,
        /// Its legs.
        legs: [DVec2; 2],
    },
    /// An arc in a corner of the front, with its angle.
    Arc {
        /// The corner.
        at: DVec2,
        /// Its legs.
        legs: [DVec2; 2],
        /// The angle as text.
        text: String,
        /// Whether it is drawn even where the legs are short.
        always: bool,
    },
    /// A text beside a line, on its right side where there is room.
    Beside {
        /// The line.
        ends: [DVec2; 2],
        /// The text.
        text: String,
    },
    /// A text over the far part of a line.
    Over {
        /// The line.
        ends: [DVec2; 2],
        /// The text.
        text: String,
    },
    /// A node.
    Node(DVec2),
    /// An ellipse given by its semi-axes.
    Ellipse {
        /// Its centre.
        at: DVec2,
        /// Its semi-axes.
        axes: [DVec2; 2],
    },
}

/// A picture: areas, lines over them, marks on top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// One line on what it shows.
    pub title: String,
    /// A longer description: the case and its parameters.
    pub description: String,
    /// Areas.
    pub areas: Vec<Area>,
    /// Lines, each edge once.
    pub lines: Vec<Line>,
    /// Marks; of overlapping ones the first is drawn.
    pub marks: Vec<Mark>,
}

/// The state of a conversion, as far as pictures show it.
#[derive(Clone, Copy)]
pub struct Seen<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// The parameters in force.
    pub parameters: &'a Parameters,
    /// The phase of the converter.
    pub phase: &'a Phase,
    /// Elements that the last step changed.
    pub changed: &'a [ElementId],
    /// What the last step chose a side edge from.
    pub candidates: Option<&'a Candidates>,
}

/// One side of an element, which becomes a line.
struct Edge {
    edge: [u32; 2],
    role: Role,
    room: f64,
}

impl Picture {
    /// The picture of a mesh: elements by kind, each edge once, the boundary and interior lines over them. A mesh in a
    /// plane z = constant is viewed from +z, one in space by the default view of `orthographic`.
    ///
    /// An edge belongs to the boundary where only one element has it or where the mesh has a line.
    pub fn of_mesh(mesh: &MeshFile) -> Picture {
        Picture::of_mesh_by(mesh, &Look::default())
    }

    /// The same with a look, for meshes in space.
    pub fn of_mesh_by(mesh: &MeshFile, look: &Look) -> Picture {
        Picture::in_view(mesh, look).0
    }

    /// The same, with the view on a mesh in space.
    fn in_view(mesh: &MeshFile, look: &Look) -> (Picture, Option<Orthographic>) {
        if orthographic::is_flat(mesh) {
            return (Picture::as_it_lies(mesh).0, None);
        }
        let seen = Orthographic::of(mesh, View::from(look.from));
        let (mut picture, edges) = Picture::as_it_lies(&orthographic::flattened(mesh, seen.view()));
        let ends: Vec<[DVec3; 2]> = edges.iter().map(|e| e.map(|n| mesh.points[n as usize])).collect();
        orthographic::turn_over(&mut picture);
        seen.clip_areas(&mut picture);
        seen.clip_lines(&mut picture, &ends, look.hidden);
        (picture, Some(seen))
    }

    /// The picture of a mesh in the plane, with the nodes of each line.
    fn as_it_lies(mesh: &MeshFile) -> (Picture, Vec<[u32; 2]>) {
        let at = |n: u32| mesh.points[n as usize].truncate();
        let mut picture = Picture::default();
        let mut sides = Vec::with_capacity(mesh.triangles.len() * 3 + mesh.quads.len() * 4 + mesh.lines.len());
        let mut element = |nodes: &[u32], area_role, edge_role| {
            picture.areas.push(Area { role: area_role, outline: nodes.iter().map(|n| at(*n)).collect() });
            for (k, &a) in nodes.iter().enumerate() {
                let b = nodes[(k + 1) % nodes.len()];
                let along = at(b) - at(a);
                let height = |n: u32| (along.perp_dot(at(n) - at(a)) / along.length()).abs();
                let others = nodes.iter().filter(|n| **n != a && **n != b);
                // The two other corners of a quadrilateral may have different heights; use their mean.
                let room = others.map(|n| height(*n)).sum::<f64>() / (nodes.len() - 2) as f64;
                sides.push(Edge { edge: [a.min(b), a.max(b)], role: edge_role, room });
            }
        };
        mesh.triangles.iter().for_each(|t| element(t, Role::LiveTriangle, Role::LiveEdge));
        mesh.quads.iter().for_each(|q| element(q, Role::DeadQuad, Role::DeadEdge));
        let line =
            |l: &[u32; 2]| Edge { edge: [l[0].min(l[1]), l[0].max(l[1])], role: Role::Boundary, room: f64::INFINITY };
        // The front is not a line of the mesh, and the file does not contain its classes.
        let front: Vec<usize> = mesh.front_lines().collect();
        sides.extend(
            mesh.lines.iter().enumerate().filter(|(i, _)| front.binary_search(i).is_err()).map(|(_, l)| line(l)),
        );
        sides.sort_by_key(|side| side.edge);
        let mut edges = Vec::new();
        for same in sides.chunk_by(|a, b| a.edge == b.edge) {
            let highest = same.iter().map(|s| s.role).max().expect("a chunk is never empty");
            let role = if same.len() == 1 { Role::Boundary } else { highest };
            let room = same.iter().map(|s| s.room).fold(f64::INFINITY, f64::min);
            picture.lines.push(Line { role, ends: same[0].edge.map(at), room, hidden: false });
            edges.push(same[0].edge);
        }
        (picture, edges)
    }

    /// The picture of a conversion on surfaces: the mesh, and over it the front by the classes of table 1 and the base
    /// segment. Marks are drawn only in planar domains.
    fn of_state_in_space(seen: &Seen<'_>, look: &Look) -> Picture {
        let Seen { mesh, parameters, phase, candidates, .. } = *seen;
        let file = Export::of(mesh, &Names::default()).file;
        let (mut picture, view) = Picture::in_view(&file, look);
        let base = Decision::of(phase).base.and_then(|[a, b]| mesh.front_between(a, b));
        let (mut front, mut space) = (Picture::default(), Vec::new());
        let mut add = |role: Role, ends: [NodeId; 2]| {
            let in_space = ends.map(|n| mesh.xyz(n));
            let ends = in_space.map(|p| view.as_ref().map_or(p.truncate(), |seen| seen.view().place(p)));
            front.lines.push(Line { role, ends, room: f64::INFINITY, hidden: false });
            space.push(in_space);
        };
        for h in mesh.front() {
            let segment = Segment::measure(mesh, h, parameters);
            let is_base = base == Some(h) && look.layers.has(Layer::Decision);
            add(if is_base { Role::Base } else { Role::Front(segment.class) }, [segment.a, segment.b]);
        }
        if look.layers.has(Layer::Candidates) {
            let there = refused(mesh, phase, candidates).into_iter().map(|candidate| candidate.ends);
            there.filter(|ends| ends.iter().all(|n| mesh.has_node(*n))).for_each(|ends| add(Role::Refused, ends));
        }
        if let Some(view) = &view {
            view.clip_lines(&mut front, &space, look.hidden);
        }
        picture.lines.append(&mut front.lines);
        picture
    }

    /// The picture of a conversion at some step: the mesh, and over it the front by the classes of table 1, the current
    /// quadrilateral, and the marks of the layers that are on.
    pub fn of_state(seen: &Seen<'_>, look: &Look) -> Picture {
        let (Seen { mesh, parameters, phase, changed, candidates }, layers) = (*seen, look.layers);
        if mesh.embedding().is_some() && !look.parametric {
            return Picture::of_state_in_space(seen, look);
        }
        let export = Export::of(mesh, &Names::default());
        let mut picture = match mesh.embedding() {
            None => Picture::of_mesh(&export.file),
            Some(_) => Picture::as_it_lies(&in_its_plane(export)).0,
        };
        if layers.has(Layer::Changed) {
            changed.iter().filter(|e| mesh.has_element(**e)).for_each(|e| picture.add_changed(mesh, *e));
        }
        let decision = Decision::of(phase);
        let base = decision.base.and_then(|[a, b]| mesh.front_between(a, b));
        let segments: Vec<Segment> = mesh.front().map(|h| Segment::measure(mesh, h, parameters)).collect();
        for segment in &segments {
            let is_base = base == Some(segment.h) && layers.has(Layer::Decision);
            let role = if is_base { Role::Base } else { Role::Front(segment.class) };
            picture.add_line(mesh, role, [segment.a, segment.b]);
        }
        if let Some([a, b]) = decision.base {
            let [c, d] = decision.tops;
            let sides = [c.map(|c| [a, c]), d.map(|d| [b, d])];
            sides.into_iter().flatten().for_each(|ends| picture.add_line(mesh, Role::Side, ends));
            if let (Some(c), Some(d)) = (c, d) {
                picture.add_line(mesh, Role::Top, [c, d]);
            }
        }
        picture.add_marks(mesh, parameters, &decision, &segments, layers);
        if layers.has(Layer::Candidates) {
            for Refused { ends, reason } in refused(mesh, phase, candidates) {
                picture.add_line(mesh, Role::Refused, ends);
                if ends.iter().all(|n| mesh.has_node(*n)) {
                    picture.marks.push(Mark::Over { ends: ends.map(|n| mesh.uv(n)), text: reason });
                }
            }
        }
        picture
    }

    fn add_line(&mut self, mesh: &Mesh, role: Role, ends: [NodeId; 2]) {
        if ends.iter().all(|n| mesh.has_node(*n)) {
            self.lines.push(Line { role, ends: ends.map(|n| mesh.uv(n)), room: f64::INFINITY, hidden: false });
        }
    }

    fn add_changed(&mut self, mesh: &Mesh, e: ElementId) {
        let nodes: Vec<NodeId> = mesh.half_edges(e).map(|h| mesh.origin(h)).collect();
        self.areas.push(Area { role: Role::Changed, outline: nodes.iter().map(|n| mesh.uv(*n)).collect() });
        for (k, &a) in nodes.iter().enumerate() {
            self.add_line(mesh, Role::ChangedEdge, [a, nodes[(k + 1) % nodes.len()]]);
        }
    }

    /// The marks in the order in which they are placed.
    fn add_marks(
        &mut self,
        mesh: &Mesh,
        parameters: &Parameters,
        decision: &Decision,
        segments: &[Segment],
        layers: Layers,
    ) {
        if layers.has(Layer::Ellipses) {
            for node in mesh.nodes() {
                let ([small, large], [along, across]) = mesh.metric(node).eigen();
                let axes = [along * (ELLIPSE / small.sqrt()), across * (ELLIPSE / large.sqrt())];
                self.marks.push(Mark::Ellipse { at: mesh.uv(node), axes });
            }
        }
        if layers.has(Layer::Nodes) {
            self.marks.extend(mesh.nodes().map(|node| Mark::Node(mesh.uv(node))));
        }
        let letters: Vec<_> = decision.letters().filter(|letter| mesh.has_node(letter.0)).collect();
        if layers.has(Layer::Letters) && !letters.is_empty() {
            let from = letters.iter().map(|l| mesh.uv(l.0)).sum::<DVec2>() / letters.len() as f64;
            let mark = |&(node, letter): &(NodeId, char)| Mark::Letter { at: mesh.uv(node), from, letter };
            self.marks.extend(letters.iter().map(mark));
        }
        for segment in segments {
            for side in Side::BOTH {
                let (at, legs) = corner(mesh, segment, side);
                let theta = segment.theta[side.index()];
                // Every corner of the front is the left end of one segment.
                let of_base = decision.base == Some([segment.a, segment.b]);
                let at_base = decision.base.is_some_and(|base| base.contains(&segment.a));
                if layers.has(Layer::Angles) && (of_base || side == Side::Left && !at_base) {
                    let text = format!("{}°", number::degrees(theta));
                    self.marks.push(Mark::Arc { at, legs, text, always: of_base });
                } else if layers.has(Layer::Wedges) && theta < parameters.theta_rect {
                    self.marks.push(Mark::Wedge { at, legs });
                }
            }
        }
        if layers.has(Layer::H) {
            self.marks.extend(segments.iter().map(|segment| Mark::Beside {
                ends: [mesh.uv(segment.a), mesh.uv(segment.b)],
                text: format!("{} · {}", segment.class, number::size(segment.h_value)),
            }));
        }
    }

    /// The bounding box of the picture; `None` where it is empty.
    pub fn bounds(&self) -> Option<[DVec2; 2]> {
        let corners = self.areas.iter().flat_map(|area| area.outline.iter().copied());
        let points = corners.chain(self.lines.iter().flat_map(|line| line.ends));
        let points = points.filter(|p| p.is_finite());
        points.map(|p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }
}

/// A mesh on surfaces in its parametric plane, in which each chart has nodes of its own.
fn in_its_plane(Export { uv, triangles, quads, .. }: Export) -> MeshFile {
    MeshFile { points: uv.iter().map(|p| p.extend(0.0)).collect(), triangles, quads, ..MeshFile::default() }
}

/// A corner of the front: its position and its legs, anticlockwise.
fn corner(mesh: &Mesh, segment: &Segment, side: Side) -> (DVec2, [DVec2; 2]) {
    let (at, from, to) = match side {
        Side::Left => (segment.a, segment.b, mesh.origin(mesh.front_before(segment.h))),
        Side::Right => (segment.b, mesh.target(mesh.front_after(segment.h)), segment.a),
    };
    let p = mesh.uv(at);
    (p, [mesh.uv(from) - p, mesh.uv(to) - p])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::convert::Base;
    use crate::render::fixtures::square;
    use crate::render::look::Ink;
    use glam::DVec3;

    /// Two triangles beside a quadrilateral, with a line between them.
    fn mixed() -> MeshFile {
        let points = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0), (1.0, 1.0), (2.0, 1.0)];
        MeshFile {
            points: points.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
            lines: vec![[4, 1]],
            triangles: vec![[1, 2, 5], [1, 5, 4]],
            quads: vec![[0, 1, 4, 3]],
            ..MeshFile::default()
        }
    }

    #[test]
    fn every_edge_is_there_once_with_the_role_of_its_elements() {
        let picture = Picture::of_mesh(&mixed());
        assert_eq!(picture.areas.len(), 3);
        let count = |role| picture.lines.iter().filter(|l| l.role == role).count();
        assert_eq!((count(Role::Boundary), count(Role::LiveEdge), count(Role::DeadEdge)), (7, 1, 0));
        assert_eq!(picture.bounds(), Some([DVec2::ZERO, DVec2::new(2.0, 1.0)]));
    }

    #[test]
    fn a_state_shows_every_front_segment_once_by_its_class_and_the_base_on_top() {
        let mesh = square();
        let base = Base { a: NodeId(0), b: NodeId(1), theta: [1.5; 2], length: 1.0, level: 0 };
        let phase = Phase::Defer { base };
        let parameters = Parameters::default();
        let changed = [ElementId(0), ElementId(9)];
        let seen = Seen { mesh: &mesh, parameters: &parameters, phase: &phase, changed: &changed, candidates: None };
        let mut layers = Layers::usual(Ink::Grey, false);
        layers.set(Layer::Changed, true);
        layers.set(Layer::H, true);
        let picture = Picture::of_state(&seen, &Look { layers, ..Look::default() });
        let count = |role| picture.lines.iter().filter(|l| l.role == role).count();
        assert_eq!(
            (count(Role::Front(1)), count(Role::Base), count(Role::LiveEdge), count(Role::Boundary)),
            (3, 1, 1, 4)
        );
        assert_eq!(count(Role::ChangedEdge), 3, "what is not there any more is not drawn");
        let marks = |is: fn(&Mark) -> bool| picture.marks.iter().filter(|mark| is(mark)).count();
        assert_eq!(marks(|mark| matches!(mark, Mark::Letter { .. })), 2);
        assert_eq!(marks(|mark| matches!(mark, Mark::Wedge { .. })), 8);
        assert_eq!(marks(|mark| matches!(mark, Mark::Beside { .. })), 4);
        let place = |role| Role::ALL.iter().position(|r| *r == role);
        assert!(place(Role::Base) > place(Role::Front(1)) && place(Role::Front(1)) > place(Role::Boundary));
    }

    #[test]
    fn an_edge_has_the_room_of_the_lower_element_beside_it() {
        let mut mesh = mixed();
        mesh.lines.clear();
        mesh.points[2].x = 1.25;
        mesh.points[5].x = 1.25;
        let picture = Picture::of_mesh(&mesh);
        let shared = picture.lines.iter().find(|l| l.ends == [DVec2::new(1.0, 0.0), DVec2::new(1.0, 1.0)]).unwrap();
        assert_eq!((shared.role, shared.room), (Role::DeadEdge, 0.25));
    }
}
