//! Promises about files: what is written reads back the same and is the same mesh to readers that share no code with
//! ours, what others write is read, what is broken is refused with its place, and no bytes make a reader panic or hang.
#![allow(clippy::unwrap_used)]

mod as_people_have_them;
mod defects;
mod foreign;
mod independent;
mod mutation;
mod names;
mod plain_readers;
mod read_back;
mod refused;

#[path = "../common/environment.rs"]
mod environment;
#[path = "../common/grid.rs"]
mod grid;
#[path = "../common/xor_shift.rs"]
mod xor_shift;

use std::path::{Path, PathBuf};

use glam::DVec3;
use quadfront::core::formats::format::write_to;
use quadfront::core::formats::{Format, WriteOptions};
use quadfront::core::kernel::Metric3;
use quadfront::core::soup::{Data, Group, MeshFile};

const TEXT: WriteOptions = WriteOptions { msh2: false };

const MSH2: WriteOptions = WriteOptions { msh2: true };

/// Two squares of two regions, one of them halved, with a boundary, a metric and data; nothing lies on a round number.
fn plates() -> MeshFile {
    let points = [(0.0, 0.0), (0.1, -1e-7), (1.0 / 3.0, 0.2), (0.0, 0.7), (1.1, 0.0), (1.0, 1e17f64.recip())];
    let mut mesh = MeshFile {
        points: points.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect(),
        lines: vec![[0, 1], [1, 4], [3, 0]],
        triangles: vec![[1, 4, 5], [1, 5, 2]],
        quads: vec![[0, 1, 2, 3]],
        line_tags: vec![7, 7, 0],
        triangle_tags: vec![2, 2],
        quad_tags: vec![1],
        groups: vec![
            Group { dimension: 1, tag: 7, name: "floor".into() },
            Group { dimension: 2, tag: 1, name: "left & \"plate\"".replace('"', "'") },
            Group { dimension: 2, tag: 2, name: "right".into() },
        ],
        ..MeshFile::default()
    };
    mesh.metric = Some((1..=6).map(|i| tensor(f64::from(i))).collect());
    mesh.point_data = vec![Data { name: "u".into(), values: vec![0.1, -2e-9, 3.0, 4e20, 5.5, 6.0] }];
    mesh.element_data = vec![Data { name: "quality".into(), values: vec![0.25, 0.5, 1.0 / 7.0] }];
    mesh
}

/// A planar metric (z is free) whose determinant is a perfect square, so that the completion of a planar `.sol` is
/// exact.
fn tensor(i: f64) -> Metric3 {
    Metric3 { xx: 4.0 * i, xy: 0.0, xz: 0.0, yy: i, yz: 0.0, zz: 2.0 * i }
}

fn bytes_of(format: Format, mesh: &MeshFile, options: WriteOptions) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_to(&mut bytes, format, mesh, options).unwrap();
    bytes
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}
