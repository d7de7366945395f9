//! The unit square as a mesh of triangles in space.

use glam::DVec3;
use quadfront::core::soup::MeshFile;

/// `n` by `n` squares of two triangles each, row by row, at the height `z(x, y)`.
pub fn grid(n: u32, z: impl Fn(f64, f64) -> f64) -> MeshFile {
    let mut mesh = MeshFile::default();
    for k in 0..(n + 1) * (n + 1) {
        let (x, y) = (f64::from(k % (n + 1)) / f64::from(n), f64::from(k / (n + 1)) / f64::from(n));
        mesh.points.push(DVec3::new(x, y, z(x, y)));
    }
    for k in 0..n * n {
        let a = k % n + k / n * (n + 1);
        mesh.triangles.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
    }
    mesh
}
