//! Whether a mesh of quadrilaterals is sound (spec 5), for any mesh file, in the plane or on a surface, from its plain
//! arrays alone: nothing of the converter's own structures is trusted here.
//!
//! In the plane convexity is exact, and so is the proof that nothing overlaps (see `overlap`). On a surface every corner
//! is measured against the normal of its own element.

mod faces;
mod nodes;
mod overlap;
mod shape;
mod sides;

use glam::DVec3;
use serde::Serialize;

use crate::core::fault::Fault;
use crate::core::kernel::decimal::Shortest;
use crate::core::soup::mesh_file::MeshFile;
use faces::Faces;

/// Everything that can be wrong with a mesh, in the order in which it is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Defect {
    /// There is neither a triangle nor a quadrilateral.
    NoElements,
    /// An element (or line) whose node does not exist.
    BadNode,
    /// A node with a coordinate that is infinite or not a number.
    NotFinite,
    /// Elements that are neither triangles nor quadrilaterals.
    OtherElements,
    /// Triangles; allowed where [`Allow::triangles`] says so.
    Triangles,
    /// An element that has a node twice.
    RepeatedNode,
    /// An element with the same nodes as another.
    DuplicateElement,
    /// A node that no element has.
    OrphanNode,
    /// An edge of three elements or more; allowed where [`Allow::branching`] says so.
    BranchingEdge,
    /// An edge that its two elements run through in the same direction.
    OrientationConflict,
    /// A node around which the elements are not one fan or ring.
    PinchedNode,
    /// A node at which the boundary begins or ends.
    OpenBoundary,
    /// A node inside the mesh at the place of another.
    CoincidentNode,
    /// A node of the boundary at the place of another; allowed where [`Allow::seams`] says so.
    SeamNode,
    /// A node of the boundary within another edge of the boundary (a T-junction).
    HangingNode,
    /// An element with (nearly) no area.
    ZeroArea,
    /// An element that runs against the others, in the plane.
    Inverted,
    /// A quadrilateral that is not strictly convex.
    NotConvex,
    /// A node inside the mesh with two edges only.
    Doublet,
    /// An edge of the boundary, in the plane, that another part of the mesh covers or crosses.
    Overlap,
}

/// A place where a mesh is not sound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Offender {
    /// Node, or element (triangles come first, quadrilaterals after them), numbered from 1; for an edge, its first node.
    pub number: u64,
    /// A point at it: the node, the first corner of the element, the first end of the edge.
    pub at: [f64; 3],
}

/// One kind of defect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// What is wrong.
    pub defect: Defect,
    /// How many times.
    pub count: u64,
    /// The first few.
    pub first: Vec<Offender>,
}

/// What may be in a mesh all the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Allow {
    /// Triangles (an intermediate state, a background mesh).
    pub triangles: bool,
    /// Nodes at the same place on the boundary (cracks, surfaces cut open).
    pub seams: bool,
    /// Edges of three or more elements (surfaces that meet in a curve).
    pub branching: bool,
}

/// What a mesh is and what is wrong with it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Soundness {
    /// Number of nodes.
    pub nodes: u64,
    /// Number of triangles.
    pub triangles: u64,
    /// Number of quadrilaterals.
    pub quads: u64,
    /// Number of edges of elements.
    pub edges: u64,
    /// Number of edges with one element.
    pub boundary_edges: u64,
    /// Number of closed chains of them.
    pub boundary_loops: u64,
    /// Their length.
    pub boundary_length: f64,
    /// Nodes that are in use - edges + elements.
    pub euler: i64,
    /// Number of pieces that hang together by nodes.
    pub components: u64,
    /// Whether all nodes that are in use have the same z.
    pub planar: bool,
    /// Area; of a curved quadrilateral, half its diagonals' cross product.
    pub area: f64,
    /// What is wrong, by kind.
    pub findings: Vec<Finding>,
}

/// Examines a mesh. O(n log n), about half a second for a million quadrilaterals; more only where they are many separate
/// pieces in rows, between which `overlap` looks far.
///
/// Where nodes do not exist or are not finite, nothing else is examined.
pub fn examine(mesh: &MeshFile) -> Soundness {
    let mut found = Found::default();
    let mut soundness = Soundness {
        nodes: mesh.points.len() as u64,
        triangles: mesh.triangles.len() as u64,
        quads: mesh.quads.len() as u64,
        ..Soundness::default()
    };
    let faces = Faces::of(mesh);
    basics(mesh, &faces, &mut found);
    if ![Defect::NoElements, Defect::BadNode, Defect::NotFinite].iter().any(|&defect| found.has(defect)) {
        let sides = sides::Sides::of(&faces, &mut found);
        let spots = nodes::examine(&faces, &sides, &mut found);
        let sense = shape::examine(&faces, &mut soundness, &mut found);
        if soundness.planar {
            overlap::examine(&faces, &sides, &spots, sense, &mut found);
        }
        soundness.edges = sides.edges;
        soundness.boundary_edges = sides.boundary.len() as u64;
        soundness.boundary_loops = sides.loops;
        let ends = sides.boundary.iter().map(|&h| faces.ends(h));
        soundness.boundary_length = ends.map(|(a, b)| faces.point(a).distance(faces.point(b))).sum();
        let used = sides.used.iter().filter(|&&used| used).count();
        soundness.euler = used as i64 - sides.edges as i64 + faces.len() as i64;
        soundness.components = sides.components;
    }
    soundness.findings = found.into_list();
    soundness
}

/// What needs no connectivity.
fn basics(mesh: &MeshFile, faces: &Faces, found: &mut Found) {
    if faces.len() == 0 {
        found.note(Defect::NoElements, 0, DVec3::ZERO);
    }
    let exists = |node: &u32| (*node as usize) < mesh.points.len();
    for element in 0..faces.len() {
        if !faces.corners(element).iter().all(exists) {
            found.note(Defect::BadNode, element, DVec3::ZERO);
        }
    }
    for (i, line) in mesh.lines.iter().enumerate() {
        if !line.iter().all(exists) {
            found.note(Defect::BadNode, i, DVec3::ZERO);
        }
    }
    for (node, &p) in mesh.points.iter().enumerate() {
        if !p.is_finite() {
            found.note(Defect::NotFinite, node, p);
        }
    }
    for (_, count) in &mesh.skipped {
        found.note_many(Defect::OtherElements, *count as u64);
    }
    found.note_many(Defect::OtherElements, mesh.polygons.len() as u64);
    found.note_many(Defect::Triangles, mesh.triangles.len() as u64);
}

/// How many offenders of each kind are kept.
const KEPT: usize = 5;

/// Findings being gathered.
#[derive(Default)]
struct Found {
    list: std::collections::BTreeMap<Defect, (u64, Vec<Offender>)>,
}

impl Found {
    fn note(&mut self, defect: Defect, index: usize, at: DVec3) {
        let (count, first) = self.list.entry(defect).or_default();
        *count += 1;
        if first.len() < KEPT {
            first.push(Offender { number: index as u64 + 1, at: at.to_array() });
        }
    }

    fn note_many(&mut self, defect: Defect, count: u64) {
        if count > 0 {
            self.list.entry(defect).or_default().0 += count;
        }
    }

    fn has(&self, defect: Defect) -> bool {
        self.list.contains_key(&defect)
    }

    fn into_list(self) -> Vec<Finding> {
        self.list.into_iter().map(|(defect, (count, first))| Finding { defect, count, first }).collect()
    }
}

impl Soundness {
    /// How often a defect was found.
    pub fn count(&self, defect: Defect) -> u64 {
        self.findings.iter().find(|finding| finding.defect == defect).map_or(0, |finding| finding.count)
    }

    /// Whether the mesh is sound, but for what is allowed.
    ///
    /// # Errors
    /// One fault that tells every kind of defect with its count, and the first offender with its place.
    pub fn verdict(&self, allow: Allow) -> Result<(), Fault> {
        let allowed = |defect| match defect {
            Defect::Triangles => allow.triangles,
            Defect::SeamNode => allow.seams,
            Defect::BranchingEdge => allow.branching,
            _ => false,
        };
        let bad: Vec<&Finding> = self.findings.iter().filter(|finding| !allowed(finding.defect)).collect();
        let Some(first) = bad.first() else { return Ok(()) };
        let told: Vec<String> = bad.iter().map(|finding| finding.to_string()).collect();
        Err(Fault::new(format!("The mesh is not sound: {}", told.join("; "))).remedy(first.defect.remedy()))
    }
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (one, many) = self.defect.words();
        match self.count {
            _ if self.defect == Defect::NoElements => return f.write_str(one),
            1 => write!(f, "1 {one}")?,
            count => write!(f, "{count} {many}")?,
        }
        if let Some(Offender { number, at: [x, y, z] }) = self.first.first() {
            let (thing, [x, y, z]) = (self.defect.thing(), [x, y, z].map(|x| Shortest(*x)));
            write!(f, " ({}{thing} {number} at {x}, {y}, {z})", if self.count > 1 { "first " } else { "" })?;
        }
        Ok(())
    }
}

impl Defect {
    /// The defect in words, once and many times.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Defect::NoElements => ("it has neither triangles nor quadrilaterals", ""),
            Defect::BadNode => ("element has a node that does not exist", "elements have nodes that do not exist"),
            Defect::NotFinite => ("node is not at a finite place", "nodes are not at finite places"),
            Defect::OtherElements => {
                ("element is neither triangle nor quadrilateral", "elements are neither triangles nor quadrilaterals")
            }
            Defect::Triangles => ("element is a triangle", "elements are triangles"),
            Defect::RepeatedNode => ("element has a node twice", "elements have a node twice"),
            Defect::DuplicateElement => ("element is there twice", "elements are there twice"),
            Defect::OrphanNode => ("node belongs to no element", "nodes belong to no element"),
            Defect::BranchingEdge => ("edge has three elements or more", "edges have three elements or more"),
            Defect::OrientationConflict => (
                "edge lies between elements of opposite orientation",
                "edges lie between elements of opposite orientation",
            ),
            Defect::PinchedNode => ("node holds several fans of elements", "nodes hold several fans of elements"),
            Defect::OpenBoundary => ("node is an end of an open boundary", "nodes are ends of open boundaries"),
            Defect::CoincidentNode => ("inner node lies on another node", "inner nodes lie on other nodes"),
            Defect::SeamNode => ("boundary node lies on another node", "boundary nodes lie on other nodes"),
            Defect::HangingNode => ("node hangs in an edge", "nodes hang in edges"),
            Defect::ZeroArea => ("element has no area", "elements have no area"),
            Defect::Inverted => ("element is inverted", "elements are inverted"),
            Defect::NotConvex => ("quadrilateral is not strictly convex", "quadrilaterals are not strictly convex"),
            Defect::Doublet => ("inner node has two edges only", "inner nodes have two edges only"),
            Defect::Overlap => ("boundary edge is overlapped", "boundary edges are overlapped"),
        }
    }

    /// What an offender's number counts.
    fn thing(self) -> &'static str {
        match self {
            Defect::NotFinite
            | Defect::OrphanNode
            | Defect::PinchedNode
            | Defect::OpenBoundary
            | Defect::CoincidentNode
            | Defect::SeamNode
            | Defect::HangingNode
            | Defect::Doublet => "node",
            Defect::BranchingEdge | Defect::OrientationConflict | Defect::Overlap => "edge from node",
            _ => "element",
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Defect::Triangles => "Convert them, or allow triangles",
            Defect::BranchingEdge => "Take the surfaces apart, or allow branching edges",
            Defect::SeamNode => "Weld them, or allow seams",
            Defect::OrphanNode => "Leave out the nodes that are not in use",
            _ => "",
        }
    }
}

#[cfg(test)]
mod tests;
