//! The mirror image of one half of a symmetric mesh, joined to it along the mirror line (docs/algorithm.md,
//! "Symmetry").

use std::sync::Arc;

use glam::DVec2;

use super::fixed::HARD;
use super::slots::Element;
use super::{Mesh, NONE};
use crate::core::fault::Fault;
use crate::core::geometry::{Joint, Mirror};
use crate::core::kernel::predicates::{convex, positive};
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId, PointId};
use crate::core::metric::MetricSource;

/// How the mirror image of a half is joined to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Symmetry {
    /// The mirror line.
    mirror: Mirror,
    /// The face that is the image of each face.
    image_of: Vec<u32>,
    /// Sides on the line that are not glued, by their points in ascending order.
    borders: Vec<([PointId; 2], Joint)>,
    /// The number of points of the half.
    points: u32,
    /// Its hard points, ascending.
    hard: Vec<PointId>,
}

impl Symmetry {
    /// The half of a mesh on one side of a mirror line, with the image of each face; sides on the line are glued to
    /// their images, except for `borders` (their points in either order). `hard` are its hard points.
    pub fn new(
        half: &Mesh,
        mirror: Mirror,
        image_of: Vec<u32>,
        mut borders: Vec<([PointId; 2], Joint)>,
        mut hard: Vec<PointId>,
    ) -> Symmetry {
        let points = half.nodes().filter_map(|node| half.point(node)).map(|point| point.0 + 1).max().unwrap_or(0);
        borders.iter_mut().for_each(|border| border.0.sort_unstable());
        borders.sort_unstable_by_key(|border| border.0);
        hard.sort_unstable();
        Symmetry { mirror, image_of, borders, points, hard }
    }

    /// The mirror line.
    pub fn mirror(&self) -> &Mirror {
        &self.mirror
    }

    /// The image of a face; of a face that crosses the line, the face itself.
    pub fn image_of(&self, region: u32) -> u32 {
        self.image_of.get(region as usize).copied().unwrap_or(region)
    }

    /// What becomes of a side on the mirror line; `None` for all others.
    pub fn joint(&self, mesh: &Mesh, side: HalfEdgeId) -> Option<Joint> {
        let ends = mesh.ends(side);
        if mesh.twin(side).is_some() || !ends.iter().all(|&n| self.mirror.holds(mesh.uv(n))) {
            return None;
        }
        let [a, b] = [mesh.point(ends[0])?, mesh.point(ends[1])?];
        let at = self.borders.binary_search_by_key(&[a.min(b), a.max(b)], |border| border.0);
        Some(at.map_or(Joint::Glued, |at| self.borders[at].1))
    }
}

/// The joints of the two boundary sides at a node that lie on the mirror line.
#[derive(Clone, Copy, Debug, Default)]
struct Seams {
    /// That of the side that leaves it.
    leaving: Option<Joint>,
    /// That of the side that ends at it.
    entering: Option<Joint>,
}

impl Seams {
    fn has(self, joint: Joint) -> bool {
        self.leaving == Some(joint) || self.entering == Some(joint)
    }
}

/// A node on glued sides.
struct Glued {
    node: NodeId,
    /// The glued side that leaves it, and its image.
    leaving: Option<[HalfEdgeId; 2]>,
    /// Whether the side that ends at it is glued.
    entering: bool,
    /// The image of the side that ends at it, which leaves it.
    beyond: HalfEdgeId,
}

/// The slots of the images.
struct Slots {
    /// The node that is the image of each node.
    node: Vec<u32>,
    /// The element that is the image of each element.
    element: Vec<u32>,
}

impl Mesh {
    /// Makes it the half of a symmetric mesh.
    pub(in crate::core) fn set_symmetry(&mut self, symmetry: Symmetry) {
        self.symmetry = Some(Arc::new(symmetry));
    }

    /// How its mirror image is joined to it, if it is or was one half of a symmetric mesh.
    pub fn symmetry(&self) -> Option<&Arc<Symmetry>> {
        self.symmetry.as_ref()
    }

    /// The nodes minus the sides on the mirror line that a half is to share with its image; 0 without symmetry.
    pub(in crate::core) fn seam(&self) -> i64 {
        let Some(symmetry) = &self.symmetry else { return 0 };
        let seams = self.seams(symmetry);
        let glued = seams.iter().filter(|seams| seams.has(Joint::Glued)).count();
        glued as i64 - seams.iter().filter(|seams| seams.leaving == Some(Joint::Glued)).count() as i64
    }

    /// Adds the mirror image of all elements and joins it along the mirror line. Nodes inside the line become free.
    /// Coordinates are rounded first to where their images are exact ([`Mirror::rounded`]).
    ///
    /// ```text
    ///   |                      |
    ///   d----c            d----c----d'
    ///   |    |     ->     |    |    |      a, b, c, d and c, b, a', d':
    ///   a----b            a----b----a'     images run the other way round
    ///   |                      |
    /// ```
    ///
    /// Ids: images of nodes and elements are appended in the order of the originals; nodes on glued sides have no
    /// images. Returns the numbers of nodes and elements that were added.
    ///
    /// # Errors
    /// An element so flat that the rounding would turn it over; and where the metric fails.
    pub(in crate::core) fn add_image(
        &mut self,
        symmetry: &Symmetry,
        source: &dyn MetricSource,
    ) -> Result<[usize; 2], Fault> {
        let mirror = &symmetry.mirror;
        self.check_rounding(mirror)?;
        for node in self.nodes().collect::<Vec<_>>() {
            let (uv, rounded) = (self.uv(node), mirror.rounded(self.uv(node)));
            if rounded != uv {
                let metric = source.metric(rounded)?;
                self.set_place(node, rounded, metric);
            }
        }
        let seams = self.seams(symmetry);
        let slots = self.image_slots(&seams);
        let points = self.points_of_images(symmetry, &seams);
        let nodes = self.nodes().filter(|n| slots.node[n.index()] != n.0).collect::<Vec<_>>();
        let elements = self.elements().collect::<Vec<_>>();
        let glued = self.nodes().filter(|n| slots.node[n.index()] == n.0);
        let glued: Vec<Glued> = glued.map(|node| self.glued(node, seams[node.index()], &slots)).collect();
        for &node in &nodes {
            let (uv, metric) = (mirror.image(self.uv(node)), mirror.image_of_metric(self.metric_ref(node)));
            let hard = if self.is_hard(node) { HARD } else { 0 };
            let point = self.point(node).map_or(NONE, |point| points[point.index()].0 | hard);
            self.append_node((uv, metric, NONE, point));
            self.set_anchor(NodeId(slots.node[node.index()]), self.image_half_edge(self.last_to(node), &slots));
        }
        for &e in &elements {
            self.append_element(&self.image_element(symmetry, e, &slots));
        }
        for h in elements.iter().flat_map(|&e| self.half_edges(e)).collect::<Vec<_>>() {
            let twin = self.twin(h).map(|twin| self.image_half_edge(twin, &slots));
            self.set_twin(self.image_half_edge(h, &slots), twin);
        }
        for Glued { node, leaving, entering, beyond } in glued {
            if let Some([h, image]) = leaving {
                self.hook(h, Some(image));
            }
            match (leaving, entering) {
                (Some(_), true) => self.set_inside(node, symmetry),
                // Its fan begins beyond the line.
                (Some(_), false) => self.set_anchor(node, beyond),
                _ => {}
            }
        }
        Ok([nodes.len(), elements.len()])
    }

    /// Makes a node that lies on no boundary any more free, unless it is a hard point.
    fn set_inside(&mut self, node: NodeId, symmetry: &Symmetry) {
        let is_hard = self.point(node).filter(|point| symmetry.hard.binary_search(point).is_ok());
        self.set_point(node, is_hard.map_or(NONE, |point| point.0 | HARD));
    }

    /// What changes at a node on glued sides.
    fn glued(&self, node: NodeId, seams: Seams, slots: &Slots) -> Glued {
        let [leaving, entering] = [seams.leaving, seams.entering].map(|joint| joint == Some(Joint::Glued));
        let first = HalfEdgeId(self.anchor[node.index()]);
        Glued {
            node,
            leaving: leaving.then(|| [first, self.image_half_edge(first, slots)]),
            entering,
            beyond: self.image_half_edge(self.last_to(node), slots),
        }
    }

    /// Refuses elements that would not be valid after rounding.
    fn check_rounding(&self, mirror: &Mirror) -> Result<(), Fault> {
        for e in self.elements() {
            let given: Vec<DVec2> = self.corners(e).map(|n| self.uv(n)).collect();
            let rounded: Vec<DVec2> = given.iter().map(|&p| mirror.rounded(p)).collect();
            let valid = match *rounded {
                [a, b, c] => positive(a, b, c),
                [a, b, c, d] => convex(a, b, c, d),
                _ => false,
            };
            if given != rounded && !valid {
                return Err(Fault::new("An element is too flat for an exact mirror image")
                    .at(format!("at ({}, {})", given[0].x, given[0].y))
                    .remedy(
                        "Move the domain so that its mirror line is an axis, or use less anisotropic sizes there",
                    ));
            }
        }
        Ok(())
    }

    /// The last half-edge that ends at a node, in the order of its fan: its boundary side, if it lies on a boundary.
    fn last_to(&self, node: NodeId) -> HalfEdgeId {
        let last = self.fan(node).last().unwrap_or(HalfEdgeId(self.anchor[node.index()]));
        self.previous(last)
    }

    /// The joints of the sides on the line, at each node slot.
    fn seams(&self, symmetry: &Symmetry) -> Vec<Seams> {
        let mut seams = vec![Seams::default(); self.places.len()];
        for h in self.edges() {
            if let Some(joint) = symmetry.joint(self, h) {
                let [a, b] = self.ends(h);
                seams[a.index()].leaving = Some(joint);
                seams[b.index()].entering = Some(joint);
            }
        }
        seams
    }

    /// The images of nodes and elements: new slots after the last ones; nodes on glued sides are their own images.
    fn image_slots(&self, seams: &[Seams]) -> Slots {
        let mut node = vec![NONE; self.places.len()];
        let mut next = self.places.len() as u32;
        for n in self.nodes() {
            let is_glued = seams[n.index()].has(Joint::Glued);
            node[n.index()] = if is_glued { n.0 } else { next };
            next += u32::from(!is_glued);
        }
        let mut element = vec![NONE; self.sides.len()];
        for (e, image) in self.elements().zip(self.sides.len() as u32..) {
            element[e.index()] = image;
        }
        Slots { node, element }
    }

    /// The output point of the images of the nodes of each point of a half: itself where sides on the line join the two
    /// halves, else a new one.
    pub(in crate::core) fn image_points(&self, symmetry: &Symmetry) -> Vec<PointId> {
        self.points_of_images(symmetry, &self.seams(symmetry))
    }

    fn points_of_images(&self, symmetry: &Symmetry, seams: &[Seams]) -> Vec<PointId> {
        let mut image: Vec<PointId> = (0..symmetry.points).map(|point| PointId(point + symmetry.points)).collect();
        for (seams, point) in self.nodes().filter_map(|n| Some((seams[n.index()], self.point(n)?))) {
            if seams.has(Joint::Glued) || seams.has(Joint::Shared) {
                image[point.index()] = point;
            }
        }
        image
    }

    /// The image of a half-edge: the same side, run the other way.
    fn image_half_edge(&self, h: HalfEdgeId, slots: &Slots) -> HalfEdgeId {
        let corner = u32::from(self.sides[h.element().index()]) - 1 - h.corner();
        ElementId(slots.element[h.element().index()]).half_edge(corner)
    }

    /// The image of an element: its nodes from the first one, the other way round, without twins.
    fn image_element(&self, symmetry: &Symmetry, e: ElementId, slots: &Slots) -> Element {
        let nodes: Vec<u32> = self.corners(e).map(|n| slots.node[n.index()]).collect();
        let mut origin = [NONE; 4];
        for (corner, node) in origin.iter_mut().enumerate().take(nodes.len()) {
            *node = nodes[(nodes.len() - corner) % nodes.len()];
        }
        Element {
            origin,
            twin: [NONE; 4],
            deferred: [false; 4],
            sides: self.sides[e.index()],
            region: symmetry.image_of(self.region(e)),
            level: self.level(e),
        }
    }
}
