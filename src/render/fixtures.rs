//! Small meshes for the tests of this room.

use glam::DVec2;

use crate::core::kernel::Metric2;
use crate::core::mesh::{Mesh, PointId, TriangleSet};

/// A unit square of two triangles, in the unit metric.
pub fn square() -> Mesh {
    mesh(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], vec![[0, 1, 2], [0, 2, 3]])
}

/// Two unit squares side by side, of two triangles each, in the unit metric.
pub fn two_squares() -> Mesh {
    let uv = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0), (1.0, 1.0), (2.0, 1.0)];
    mesh(&uv, vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])
}

fn mesh(uv: &[(f64, f64)], triangles: Vec<[u32; 3]>) -> Mesh {
    let set = TriangleSet {
        uv: uv.iter().map(|&(x, y)| DVec2::new(x, y)).collect(),
        point: (0..uv.len() as u32).map(PointId).collect(),
        region: vec![0; triangles.len()],
        triangles,
        ..TriangleSet::default()
    };
    Mesh::from_triangles(&set, vec![Metric2::isotropic(1.0); uv.len()])
}
