//! Live components: triangles that are connected over their sides, and the dual graph of such.
//!
//! By 3T = 2E + B a component of T triangles with B sides on its boundary has T even exactly where B is even
//! (docs/algorithm.md, "The parity invariant"), and only even ones can become quadrilaterals with their boundary kept.

use crate::core::mesh::{ElementId, HalfEdgeId, Mesh};

/// No side.
pub(super) const NONE: u32 = u32::MAX;

/// Triangles connected over their sides.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Component {
    /// Its triangles, ascending.
    pub triangles: Vec<ElementId>,
    /// Number of sides that no other triangle shares: on the boundary of the mesh or against a quadrilateral.
    pub boundary: usize,
}

impl Component {
    /// Whether it can become quadrilaterals with its boundary as it is.
    pub fn is_even(&self) -> bool {
        self.boundary.is_multiple_of(2)
    }
}

/// All live components of a face, or of all, by their least triangle. Triangles are live.
pub fn live_components(mesh: &Mesh, face: Option<u32>) -> Vec<Component> {
    let mut seen = vec![false; mesh.element_slots()];
    let mut components = Vec::new();
    for first in mesh.elements_of(face) {
        if mesh.is_triangle(first) && !seen[first.index()] {
            seen[first.index()] = true;
            let is_new = |_: &[ElementId], u: ElementId| !std::mem::replace(&mut seen[u.index()], true);
            components.extend(component_of(mesh, first, usize::MAX, is_new));
        }
    }
    components
}

/// The live component of a triangle, where it has no more than `most` triangles.
pub fn small_component(mesh: &Mesh, first: ElementId, most: usize) -> Option<Component> {
    component_of(mesh, first, most, |found, u| !found.contains(&u))
}

/// The component of a triangle; `None` where it has more than `most`. `is_new` says of a triangle whether it is found
/// for the first time.
fn component_of(
    mesh: &Mesh,
    first: ElementId,
    most: usize,
    mut is_new: impl FnMut(&[ElementId], ElementId) -> bool,
) -> Option<Component> {
    let mut triangles = vec![first];
    let (mut boundary, mut next) = (0, 0);
    while let Some(&t) = triangles.get(next) {
        next += 1;
        for h in mesh.half_edges(t) {
            match mesh.live_twin(h).map(HalfEdgeId::element) {
                Some(u) if !is_new(&triangles, u) => {}
                Some(_) if triangles.len() == most => return None,
                Some(u) => triangles.push(u),
                None => boundary += 1,
            }
        }
    }
    triangles.sort_unstable();
    debug_assert_eq!(triangles.len() % 2, boundary % 2, "3T = 2E + B");
    Some(Component { triangles, boundary })
}

/// The dual graph of some triangles of a mesh: triangle t has sides 3 t, 3 t + 1 and 3 t + 2, its half-edges in order.
#[derive(Debug)]
pub(super) struct Dual<'a> {
    pub mesh: &'a Mesh,
    pub triangles: &'a [ElementId],
    /// The same edge as a side of the neighbour; `NONE` where the neighbour is not among the triangles.
    pub across: Vec<u32>,
}

impl<'a> Dual<'a> {
    pub fn new(mesh: &'a Mesh, triangles: &'a [ElementId]) -> Self {
        // Zero is absence here, so that a small component in a large mesh costs no more than fresh memory.
        let mut place = vec![0_u32; mesh.element_slots()];
        for (t, e) in (1..).zip(triangles) {
            assert!(mesh.is_triangle(*e), "{e:?} is live, so it is a triangle");
            assert_eq!(place[e.index()], 0, "{e:?} is given once");
            place[e.index()] = t;
        }
        let sides = triangles.iter().flat_map(|&e| mesh.half_edges(e));
        let across = sides
            .map(|h| {
                let twin = mesh.twin(h).map(|t| (place[t.element().index()], t.corner()));
                twin.filter(|&(t, _)| t != 0).map_or(NONE, |(t, corner)| 3 * (t - 1) + corner)
            })
            .collect();
        Dual { mesh, triangles, across }
    }

    /// The neighbour over a side.
    #[inline]
    pub fn neighbour(&self, side: u32) -> Option<u32> {
        let across = self.across[side as usize];
        (across != NONE).then_some(across / 3)
    }

    /// The half-edge of a side.
    #[inline]
    pub fn half_edge(&self, side: u32) -> HalfEdgeId {
        self.triangles[(side / 3) as usize].half_edge(side % 3)
    }
}
