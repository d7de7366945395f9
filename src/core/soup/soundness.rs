//! Whether a mesh of quadrilaterals is sound (docs/algorithm.md, "Checks"), for any mesh file, in the plane or on a
//! surface, from its plain arrays alone: nothing of the converter's own structures is trusted here.
//!
//! In the plane, the tests for convexity and for overlaps (see `overlap`) are exact. On a surface, every corner is
//! measured against the normal of its own element.

mod faces;
mod nodes;
mod overlap;
mod shape;
mod sides;

use glam::DVec3;
use serde::Serialize;

use crate::core::fault::Fault;
use crate::core::kernel::Shortest;
use crate::core::soup::mesh_file::MeshFile;
use faces::Faces;

/// Everything that can be wrong with a mesh, in the order of the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Defect {
    /// No triangles and no quadrilaterals.
    NoElements,
    /// An element or line that refers to a missing node.
    BadNode,
    /// A node with an infinite or NaN coordinate.
    NotFinite,
    /// An element that is neither a triangle nor a quadrilateral.
    OtherElements,
    /// A triangle; accepted with [`Allow::triangles`].
    Triangles,
    /// An element with a repeated node.
    RepeatedNode,
    /// An element with the same nodes as another.
    DuplicateElement,
    /// A node of no element.
    OrphanNode,
    /// An edge of three or more elements; accepted with [`Allow::branching`].
    BranchingEdge,
    /// An edge whose two elements traverse it in the same direction.
    OrientationConflict,
    /// A node whose elements form several fans or rings (non-manifold).
    PinchedNode,
    /// A node where an open boundary chain begins or ends.
    OpenBoundary,
    /// An interior node that coincides with another node.
    CoincidentNode,
    /// A boundary node that coincides with another node; accepted with [`Allow::seams`].
    SeamNode,
    /// A boundary node in the interior of another boundary edge (a T-junction).
    HangingNode,
    /// An element with (almost) zero area.
    ZeroArea,
    /// An element oriented against the others, in the plane.
    Inverted,
    /// A quadrilateral that is not strictly convex.
    NotConvex,
    /// An interior node with only two edges.
    Doublet,
    /// A boundary edge, in the plane, that another part of the mesh covers or crosses.
    Overlap,
}

/// A node or element with a defect.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Offender {
    /// Number from 1 of the node or element (triangles before quadrilaterals); for an edge, of its first node.
    pub number: u64,
    /// Its position: that of the node, of the element's first corner, or of the edge's first node.
    pub at: [f64; 3],
}

/// One kind of defect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The kind.
    pub defect: Defect,
    /// Number of occurrences.
    pub count: u64,
    /// The first few occurrences.
    pub first: Vec<Offender>,
}

/// Defects to accept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Allow {
    /// Triangles (an intermediate state, a background mesh).
    pub triangles: bool,
    /// Coincident nodes on the boundary (cracks, surfaces cut open).
    pub seams: bool,
    /// Edges of three or more elements (surfaces that meet in a curve).
    pub branching: bool,
}

/// Counts, measures and defects of a mesh.
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
    /// Number of closed chains of boundary edges.
    pub boundary_loops: u64,
    /// Total length of the boundary edges.
    pub boundary_length: f64,
    /// Euler characteristic: nodes in use - edges + elements.
    pub euler: i64,
    /// Number of components, connected through nodes.
    pub components: u64,
    /// Whether all nodes in use have the same z.
    pub planar: bool,
    /// Area; for a curved quadrilateral, half the length of its diagonals' cross product.
    pub area: f64,
    /// What was repaired before, as phrases: points that were merged.
    pub repairs: Vec<String>,
    /// What the file has and is not read ([`MeshFile::not_read`]).
    pub not_read: Vec<String>,
    /// The defects, by kind.
    pub findings: Vec<Finding>,
}

/// Examines a mesh in O(n log n): about half a second for a million quadrilaterals, more only for many separate
/// components side by side, where the rays of `overlap` are long.
///
/// With missing or non-finite nodes, nothing else is examined.
pub fn examine(mesh: &MeshFile) -> Soundness {
    let mut found = Found::default();
    let mut soundness = Soundness {
        nodes: mesh.points.len() as u64,
        triangles: mesh.triangles.len() as u64,
        quads: mesh.quads.len() as u64,
        not_read: mesh.not_read(),
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

/// The checks without connectivity.
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

/// Number of offenders kept for each kind.
const KEPT: usize = 5;

/// Collects findings.
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
    /// Number of occurrences of a defect.
    pub fn count(&self, defect: Defect) -> u64 {
        self.findings.iter().find(|finding| finding.defect == defect).map_or(0, |finding| finding.count)
    }

    /// Checks that the mesh has no defects except the allowed ones.
    ///
    /// # Errors
    /// One fault with the count of every kind of defect and the position of its first offender.
    pub fn verdict(&self, allow: Allow) -> Result<(), Fault> {
        let allowed = |defect| match defect {
            Defect::Triangles => allow.triangles,
            Defect::SeamNode => allow.seams,
            Defect::BranchingEdge => allow.branching,
            _ => false,
        };
        let bad: Vec<&Finding> = self.findings.iter().filter(|finding| !allowed(finding.defect)).collect();
        let Some(first) = bad.first() else { return Ok(()) };
        let list: Vec<String> = bad.iter().map(|finding| finding.to_string()).collect();
        Err(Fault::new(format!("The mesh is invalid: {}", list.join("; "))).remedy(first.defect.remedy()))
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
    /// The defect in words, singular and plural.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Defect::NoElements => ("it has neither triangles nor quadrilaterals", ""),
            Defect::BadNode => ("element refers to a missing node", "elements refer to missing nodes"),
            Defect::NotFinite => ("node has a non-finite coordinate", "nodes have non-finite coordinates"),
            Defect::OtherElements => {
                ("element is neither triangle nor quadrilateral", "elements are neither triangles nor quadrilaterals")
            }
            Defect::Triangles => ("element is a triangle", "elements are triangles"),
            Defect::RepeatedNode => ("element has a repeated node", "elements have a repeated node"),
            Defect::DuplicateElement => ("element is a duplicate", "elements are duplicates"),
            Defect::OrphanNode => ("node belongs to no element", "nodes belong to no element"),
            Defect::BranchingEdge => ("edge has three or more elements", "edges have three or more elements"),
            Defect::OrientationConflict => (
                "edge lies between elements of opposite orientation",
                "edges lie between elements of opposite orientation",
            ),
            Defect::PinchedNode => ("node joins several fans of elements", "nodes join several fans of elements"),
            Defect::OpenBoundary => ("node is an end of an open boundary", "nodes are ends of open boundaries"),
            Defect::CoincidentNode => {
                ("interior node coincides with another node", "interior nodes coincide with other nodes")
            }
            Defect::SeamNode => {
                ("boundary node coincides with another node", "boundary nodes coincide with other nodes")
            }
            Defect::HangingNode => ("node hangs on an edge", "nodes hang on edges"),
            Defect::ZeroArea => ("element has zero area", "elements have zero area"),
            Defect::Inverted => ("element is inverted", "elements are inverted"),
            Defect::NotConvex => ("quadrilateral is not strictly convex", "quadrilaterals are not strictly convex"),
            Defect::Doublet => ("interior node has only two edges", "interior nodes have only two edges"),
            Defect::Overlap => ("boundary edge overlaps the mesh", "boundary edges overlap the mesh"),
        }
    }

    /// What an offender's number refers to.
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
            Defect::BranchingEdge => "Separate the surfaces, or allow branching edges",
            Defect::SeamNode => "Weld them, or allow seams",
            Defect::OrphanNode => "Remove the unused nodes",
            _ => "",
        }
    }
}

#[cfg(test)]
mod tests;
