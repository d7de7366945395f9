//! Small surfaces for tests.

use std::f64::consts::TAU;

use glam::DVec3;

use super::chart::{Chart, charts};
use super::edges::{Edges, Triangles};
use super::features::features;
use super::planar_map::StretchBound;
use crate::core::progress::Nobody;

/// The charts of a surface whose features are folds beyond `angle`.
pub fn charted(mesh: &Triangles, angle: f64, bound: StretchBound) -> Vec<Chart> {
    let edges = Edges::of(&mesh.triangles);
    charts(mesh, &edges, &features(mesh, &edges, angle), bound, &mut Nobody).unwrap()
}

/// The number of edges with one side.
pub fn border_edges(mesh: &Triangles) -> usize {
    let edges = Edges::of(&mesh.triangles);
    (0..edges.len()).filter(|&e| edges.get(e).sides.len() == 1).count()
}

/// Both meshes in one, the other moved, without shared points.
pub fn beside(mut one: Triangles, other: &Triangles, by: DVec3) -> Triangles {
    let n = one.points.len() as u32;
    one.points.extend(other.points.iter().map(|p| *p + by));
    one.triangles.extend(other.triangles.iter().map(|t| t.map(|k| k + n)));
    one.region.extend(&other.region);
    one
}

fn whole(points: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Triangles {
    let region = vec![0; triangles.len()];
    Triangles { points, triangles, region, ..Triangles::default() }
}

/// The unit cube, each side divided into `n` by `n` squares of two triangles.
pub fn cube(n: u32) -> Triangles {
    let mut points: Vec<DVec3> = Vec::new();
    let mut triangles = Vec::new();
    let mut at = |p: DVec3| {
        points.iter().position(|q| q.distance(p) < 1e-9).unwrap_or_else(|| {
            points.push(p);
            points.len() - 1
        }) as u32
    };
    for (o, u, v) in [
        (DVec3::ZERO, DVec3::Y, DVec3::X),
        (DVec3::Z, DVec3::X, DVec3::Y),
        (DVec3::ZERO, DVec3::X, DVec3::Z),
        (DVec3::Y, DVec3::Z, DVec3::X),
        (DVec3::ZERO, DVec3::Z, DVec3::Y),
        (DVec3::X, DVec3::Y, DVec3::Z),
    ] {
        for i in 0..n {
            for j in 0..n {
                let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)]
                    .map(|(k, l)| at(o + (u * f64::from(i + k) + v * f64::from(j + l)) / f64::from(n)));
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    whole(points, triangles)
}

/// A grid closed along `u`, and closed or open along `v`: a torus or a tube.
fn wrapped(nu: u32, nv: u32, closed: bool, at: impl Fn(f64, f64) -> DVec3) -> Triangles {
    let rows = if closed { nv } else { nv + 1 };
    let points = (0..rows * nu).map(|k| at(f64::from(k % nu) / f64::from(nu), f64::from(k / nu) / f64::from(nv)));
    let node = |i: u32, j: u32| (j % rows) * nu + i % nu;
    let squares = (0..nu * nv).flat_map(|k| {
        let (i, j) = (k % nu, k / nu);
        let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    whole(points.collect(), squares.collect())
}

/// A torus of radii 2 and 1.
pub fn torus(nu: u32, nv: u32) -> Triangles {
    wrapped(nu, nv, true, |u, v| {
        let (u, v) = (TAU * u, TAU * v);
        let r = 2.0 + libm::cos(v);
        DVec3::new(r * libm::cos(u), r * libm::sin(u), libm::sin(v))
    })
}

/// An open tube of radius 1.
pub fn tube(nu: u32, nv: u32, length: f64) -> Triangles {
    wrapped(nu, nv, false, |u, v| DVec3::new(libm::cos(TAU * u), libm::sin(TAU * u), length * v))
}

/// A strip of about `n` nodes: squares of two triangles, so many times as wide as long.
pub fn strip(n: u32, width: f64) -> Triangles {
    let points = (0..n).map(|k| DVec3::new(f64::from(k / 2), width * f64::from(k % 2), 0.0));
    let squares = (0..n / 2 - 1).flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 1]]);
    whole(points.collect(), squares.collect())
}

/// Two cones over one circle of `n` nodes, with one tip each.
pub fn double_cone(n: u32) -> Triangles {
    let at = |k: u32| {
        let (sin, cos) = libm::sincos(TAU * f64::from(k) / f64::from(n));
        DVec3::new(cos, sin, 0.0)
    };
    let triangles = (0..n).flat_map(|k| [[k, (k + 1) % n, n], [(k + 1) % n, k, n + 1]]);
    whole((0..n).map(at).chain([DVec3::Z, -DVec3::Z]).collect(), triangles.collect())
}

/// The unit sphere: a projected cube.
pub fn sphere(n: u32) -> Triangles {
    let mut mesh = cube(n);
    mesh.points.iter_mut().for_each(|p| *p = (*p - 0.5).normalize());
    mesh
}

/// A bumpy plate of `n` by `n` squares over the unit square.
pub fn plate(n: u32, height: f64) -> Triangles {
    let points = (0..(n + 1) * (n + 1)).map(|k| {
        let (x, y) = (f64::from(k % (n + 1)) / f64::from(n), f64::from(k / (n + 1)) / f64::from(n));
        DVec3::new(x, y, height * libm::sin(TAU * x) * libm::sin(TAU * y))
    });
    let squares = (0..n * n).flat_map(|k| {
        let a = (k / n) * (n + 1) + k % n;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    });
    whole(points.collect(), squares.collect())
}

/// Three half planes that meet in a line, two triangles each.
pub fn three_half_planes() -> Triangles {
    let mut points = vec![DVec3::ZERO, DVec3::Z];
    let mut triangles = Vec::new();
    for k in 0..3_u32 {
        let angle = TAU * f64::from(k) / 3.0;
        let out = DVec3::new(libm::cos(angle), libm::sin(angle), 0.0);
        points.extend([out, out + DVec3::Z]);
        let (c, d) = (2 + 2 * k, 3 + 2 * k);
        triangles.extend([[0, c, d], [0, d, 1]]);
    }
    whole(points, triangles)
}
