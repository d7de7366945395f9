//! Triangles and quadrilaterals of a mesh file as one list, with numbered half-edges.

use glam::DVec3;

use crate::core::soup::mesh_file::MeshFile;

/// All elements, triangles before quadrilaterals. Half-edge `4 * element + corner` runs from that corner to the next
/// one; a triangle has corners 0 to 2.
pub struct Faces<'a> {
    mesh: &'a MeshFile,
    flat: bool,
}

impl<'a> Faces<'a> {
    pub fn of(mesh: &'a MeshFile) -> Self {
        Faces { mesh, flat: mesh.points.windows(2).all(|w| w[0].z == w[1].z) }
    }

    pub fn len(&self) -> usize {
        self.mesh.triangles.len() + self.mesh.quads.len()
    }

    /// Whether all nodes have the same z.
    pub fn is_flat(&self) -> bool {
        self.flat
    }

    pub fn nodes(&self) -> usize {
        self.mesh.points.len()
    }

    #[inline]
    pub fn point(&self, node: u32) -> DVec3 {
        self.mesh.points[node as usize]
    }

    #[inline]
    pub fn corners(&self, element: usize) -> &'a [u32] {
        match self.mesh.triangles.get(element) {
            Some(triangle) => triangle,
            None => &self.mesh.quads[element - self.mesh.triangles.len()],
        }
    }

    /// The tag of an element's group; 0 without one.
    #[inline]
    pub fn tag(&self, element: usize) -> u32 {
        let triangles = self.mesh.triangles.len();
        let tags = if element < triangles { &self.mesh.triangle_tags } else { &self.mesh.quad_tags };
        tags.get(if element < triangles { element } else { element - triangles }).copied().unwrap_or(0)
    }

    /// The half-edge after this one in its element.
    #[inline]
    pub fn next(&self, half_edge: usize) -> usize {
        let (element, corner) = (half_edge / 4, half_edge % 4);
        let sides = if element < self.mesh.triangles.len() { 3 } else { 4 };
        if corner + 1 == sides { 4 * element } else { half_edge + 1 }
    }

    /// Origin and destination of a half-edge.
    #[inline]
    pub fn ends(&self, half_edge: usize) -> (u32, u32) {
        let corners = self.corners(half_edge / 4);
        let next = if half_edge % 4 + 1 == corners.len() { 0 } else { half_edge % 4 + 1 };
        (corners[half_edge % 4], corners[next])
    }
}
