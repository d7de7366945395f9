//! Promise: creases of noisy scans are found in spite of the noise, and noise is no crease; on clean meshes every fold
//! beyond the feature angle is kept as it is.
#![allow(clippy::unwrap_used)]

#[path = "common/irregular.rs"]
mod irregular;
#[path = "common/xor_shift.rs"]
mod xor_shift;

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{PI, TAU};
use std::path::Path;

use glam::DVec3;
use irregular::irregular_inside;
use quadfront::core::case::Case;
use quadfront::core::convert::conversion::convert;
use quadfront::core::discrete::features::{ANGLE, features, noisy_folds};
use quadfront::core::discrete::{Edges, Feature, Triangles};
use quadfront::core::formats::format::{read_mesh, write_mesh};
use quadfront::core::formats::{Format, WriteOptions};
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::soup::soundness::examine;
use quadfront::core::soup::{Allow, MeshFile};
use xor_shift::XorShift;

/// A surface as it was constructed: its triangles, and the creases on which points lie, by numbers of their own.
struct Built {
    mesh: Triangles,
    creases: Vec<BTreeSet<u32>>,
}

/// Puts squares together; `creases` says on which creases a place lies.
#[derive(Default)]
struct Builder {
    numbers: BTreeMap<[i64; 3], u32>,
    mesh: Triangles,
}

impl Builder {
    fn point(&mut self, p: DVec3) -> u32 {
        let key = p.to_array().map(|x| (x * 1e6).round() as i64);
        *self.numbers.entry(key).or_insert_with(|| {
            self.mesh.points.push(p);
            self.mesh.points.len() as u32 - 1
        })
    }

    /// A square of two triangles, divided along one diagonal or the other.
    fn square(&mut self, corners: [DVec3; 4], first: bool) {
        let [a, b, c, d] = corners.map(|p| self.point(p));
        let both = if first { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
        self.mesh.triangles.extend(both.into_iter().filter(|[a, b, c]| a != b && b != c && c != a));
    }

    fn built(mut self, creases: impl Fn(DVec3) -> BTreeSet<u32>) -> Built {
        self.mesh.region = vec![0; self.mesh.triangles.len()];
        let creases = self.mesh.points.iter().map(|&p| creases(p)).collect();
        Built { mesh: self.mesh, creases }
    }
}

/// The unit cube of `n` by `n` squares a side; its edges are numbered from 0 to 11.
fn cube(n: u32) -> Built {
    let mut builder = Builder::default();
    for axis in 0..3 {
        for high in [false, true] {
            let at = |i: u32, j: u32| {
                let mut p = [0.0; 3];
                p[axis] = f64::from(u8::from(high));
                p[(axis + 1) % 3] = f64::from(i) / f64::from(n);
                p[(axis + 2) % 3] = f64::from(j) / f64::from(n);
                DVec3::from(p)
            };
            for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
                let mut corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                if !high {
                    corners.reverse();
                }
                builder.square(corners, (i + j) % 2 == 0);
            }
        }
    }
    builder.built(|p| {
        let side = |x: f64| if x == 0.0 { Some(0) } else { (x == 1.0).then_some(1) };
        let pairs = [(0, 1), (1, 2), (2, 0)].into_iter().zip(0_u32..);
        pairs.filter_map(|((k, l), pair)| Some(4 * pair + 2 * side(p[k])? + side(p[l])?)).collect()
    })
}

/// The cube blown up to the unit sphere, which has no creases.
fn sphere(n: u32) -> Built {
    let mut built = cube(n);
    built.mesh.points.iter_mut().for_each(|p| *p = (*p - 0.5).normalize());
    built.creases.iter_mut().for_each(BTreeSet::clear);
    built
}

/// A closed cylinder of radius 1 and height 2: its two rims are the creases 0 and 1. The lids are discs of rings, each
/// with as many points as its circumference has room for.
fn cylinder(around: u32, up: u32) -> Built {
    let mut builder = Builder::default();
    let at = |r: f64, k: f64, z: f64| {
        let (sin, cos) = libm::sincos(TAU * k / f64::from(around));
        DVec3::new(r * cos, r * sin, z)
    };
    for (k, j) in (0..around * up).map(|n| (n % around, n / around)) {
        let [left, right] = [k, (k + 1) % around].map(f64::from);
        let [low, high] = [j, j + 1].map(|j| 2.0 * f64::from(j) / f64::from(up));
        let corners = [at(1.0, left, low), at(1.0, right, low), at(1.0, right, high), at(1.0, left, high)];
        builder.square(corners, (k + j) % 2 == 0);
    }
    // A square grid within the disc, stretched to its rim, has triangles of about one size.
    let n = around / 4;
    let disc = |i: u32, j: u32, z: f64| {
        let [x, y] = [i, j].map(|k| 2.0 * f64::from(k) / f64::from(n) - 1.0);
        let r = x.abs().max(y.abs());
        // Along the side of the square the angle grows evenly, from corner to corner by a quarter.
        let eighth = f64::from(around) / 8.0;
        let k = if r == 0.0 {
            0.0
        } else if x == r {
            eighth * (y / r)
        } else if y == r {
            eighth * (2.0 - x / r)
        } else if x == -r {
            eighth * (4.0 - y / r)
        } else {
            eighth * (6.0 + x / r)
        };
        at(r, k, z)
    };
    for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
        for z in [0.0, 2.0] {
            let mut corners = [disc(i, j, z), disc(i + 1, j, z), disc(i + 1, j + 1, z), disc(i, j + 1, z)];
            if z == 0.0 {
                corners.reverse();
            }
            // At its four corners the diagonal ends at the rim.
            builder.square(corners, ((i + j) % 2 == 0) == (z != 0.0));
        }
    }
    builder.built(|p| {
        let on_rim = (p.truncate().length() - 1.0).abs() < 1e-9;
        [0.0, 2.0].into_iter().zip(0..).filter(|(z, _)| on_rim && p.z == *z).map(|(_, rim)| rim).collect()
    })
}

/// The points moved in all directions by about normal noise, in parts of the mean edge length.
fn with_noise(built: &Built, part: f64, seed: u64) -> Triangles {
    let mut random = XorShift::of(seed);
    // The sum of twelve even numbers is nearly normal, with a deviation of 1.
    let mut normal = || (0..12).map(|_| random.next() as f64 / u64::MAX as f64).sum::<f64>() - 6.0;
    let mut mesh = built.mesh.clone();
    let edges = Edges::of(&mesh.triangles);
    let length = |e: usize| {
        let [a, b] = edges.get(e).ends.map(|end| mesh.points[end as usize]);
        a.distance(b)
    };
    let mean = (0..edges.len()).map(length).sum::<f64>() / edges.len() as f64;
    mesh.points.iter_mut().for_each(|p| *p += DVec3::new(normal(), normal(), normal()) * part * mean);
    mesh
}

/// The edges between points of one crease, by the construction.
fn creases_of(built: &Built) -> BTreeSet<[u32; 2]> {
    let edges = Edges::of(&built.mesh.triangles);
    let ends = (0..edges.len()).map(|e| edges.get(e).ends);
    let shared = |[a, b]: &[u32; 2]| !built.creases[*a as usize].is_disjoint(&built.creases[*b as usize]);
    ends.filter(shared).collect()
}

fn found(mesh: &Triangles, angle: f64) -> BTreeSet<[u32; 2]> {
    let edges = Edges::of(&mesh.triangles);
    let found = features(mesh, &edges, angle);
    assert!(found.iter().flatten().all(|kind| *kind == Feature::Fold));
    (0..edges.len()).filter(|&e| found[e].is_some()).map(|e| edges.get(e).ends).collect()
}

/// The edges folded by more than an angle (radians) between the normals of their triangles.
fn folded(mesh: &Triangles, angle: f64) -> BTreeSet<[u32; 2]> {
    let mut sides: BTreeMap<[u32; 2], Vec<DVec3>> = BTreeMap::new();
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|k| mesh.points[k as usize]);
        for k in 0..3 {
            let ends = [t[k], t[(k + 1) % 3]];
            let normal = (b - a).cross(c - a);
            sides.entry([ends[0].min(ends[1]), ends[0].max(ends[1])]).or_default().push(normal);
        }
    }
    sides.into_iter().filter(|(_, n)| n[0].angle_between(n[1]) > angle).map(|(ends, _)| ends).collect()
}

#[test]
fn a_noisy_cube_keeps_its_twelve_edges_and_no_others() {
    let built = cube(12);
    let edges = creases_of(&built);
    assert_eq!(edges.len(), 144);
    for (part, seed) in [(0.02, 1), (0.06, 2), (0.1, 3), (0.1, 4), (0.1, 5)] {
        let mesh = with_noise(&built, part, seed);
        assert_eq!(found(&mesh, ANGLE), edges, "{part}, {seed}");
        assert!(part < 0.1 || folded(&mesh, ANGLE).len() > 160, "the noise folds edges");
    }
}

#[test]
fn a_noisy_sphere_has_no_creases() {
    for (part, seed) in [(0.06, 1), (0.1, 2), (0.1, 3), (0.15, 4)] {
        let mesh = with_noise(&sphere(16), part, seed);
        assert_eq!(found(&mesh, ANGLE).len(), 0, "{part}, {seed}");
        let edges = Edges::of(&mesh.triangles);
        let folds = folded(&mesh, ANGLE).len();
        assert_eq!(noisy_folds(&mesh, &edges, ANGLE, &features(&mesh, &edges, ANGLE)), folds);
        assert!(part < 0.1 || folds > 100, "the noise folds edges: {folds}");
    }
}

#[test]
fn a_noisy_cylinder_keeps_its_two_rims() {
    let built = cylinder(48, 16);
    let rims = creases_of(&built);
    assert_eq!(rims.len(), 96);
    for (part, seed) in [(0.03, 1), (0.06, 2), (0.08, 3), (0.08, 4)] {
        let mesh = with_noise(&built, part, seed);
        assert_eq!(found(&mesh, ANGLE), rims, "{part}, {seed}");
    }
}

#[test]
fn clean_folds_are_features_exactly_beyond_the_angle() {
    // A roof over a strip: a crease of 25 degrees, of one edge a square.
    let mut builder = Builder::default();
    let slope = libm::tan(12.5 / 180.0 * PI);
    let at = |i: u32, j: u32| DVec3::new(f64::from(i), f64::from(j), -slope * (f64::from(j) - 4.0).abs());
    for (i, j) in (0..80).map(|k| (k % 10, k / 10)) {
        builder.square([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], true);
    }
    let roof = builder.built(|p| (p.y == 4.0).then_some(0).into_iter().collect());
    let folds = |angle: f64| {
        let edges = Edges::of(&roof.mesh.triangles);
        let found = features(&roof.mesh, &edges, angle);
        let folds = (0..edges.len()).filter(|&e| found[e] == Some(Feature::Fold));
        folds.map(|e| edges.get(e).ends).collect::<BTreeSet<_>>()
    };
    assert_eq!(folds(ANGLE).len(), 0);
    assert_eq!(folds(20.0 / 180.0 * PI), creases_of(&roof));
    // Saddles and coarse curved surfaces: folds of both signs that add up are no noise.
    let n = 48;
    let mut builder = Builder::default();
    let at = |i: u32, j: u32| {
        let [u, v] = [i, j].map(|k| TAU * f64::from(k % n) / f64::from(n));
        let r = 4.0 + 2.0 * libm::cos(v) + 0.4 * libm::cos(6.0 * v);
        DVec3::new(r * libm::cos(u), r * libm::sin(u), 2.0 * libm::sin(v))
    };
    for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
        builder.square([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], (i + j) % 2 == 0);
    }
    let waves = builder.built(|_| BTreeSet::new()).mesh;
    for degrees in [10.0_f64, 20.0, 40.0] {
        let angle = degrees.to_radians();
        assert_eq!(found(&waves, angle), folded(&waves, angle), "{degrees}");
        assert!(degrees > 20.0 || !found(&waves, angle).is_empty());
    }
}

fn scan() -> MeshFile {
    read_mesh(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/scan_noise_0.01.obj"), None).unwrap()
}

/// The least scaled Jacobian of quadrilaterals, as Verdict defines it: at each corner the component of the cross
/// product of its sides along the normal between the diagonals, over their lengths.
fn least_scaled_jacobian(mesh: &MeshFile) -> f64 {
    let of = |quad: &[u32; 4]| {
        let p = quad.map(|k| mesh.points[k as usize]);
        let normal = (p[2] - p[0]).cross(p[3] - p[1]).normalize();
        let corner = |k: usize| {
            let (before, after) = (p[k] - p[(k + 3) % 4], p[(k + 1) % 4] - p[k]);
            before.cross(after).dot(normal) / (before.length() * after.length())
        };
        (0..4).map(corner).fold(f64::INFINITY, f64::min)
    };
    mesh.quads.iter().map(of).fold(f64::INFINITY, f64::min)
}

/// A noisy scan converted by the defaults and found sound: the quadrilaterals, how many faces, and what was told.
fn converted(scan: &MeshFile) -> (MeshFile, usize, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scan.ply");
    write_mesh(&path, Format::Ply, scan, WriteOptions::default()).unwrap();
    let done = convert(&Case::of_mesh(path, None), &mut Nobody).unwrap();
    let mesh = Export::of(&done.mesh, &done.names).file;
    assert!(mesh.triangles.is_empty() && done.mesh.folded().is_empty());
    examine(&mesh).verdict(Allow::default()).unwrap();
    assert!(least_scaled_jacobian(&mesh) > 0.0);
    (mesh, done.names.faces.len(), done.repairs)
}

#[test]
fn a_scan_becomes_few_faces_with_few_irregular_nodes() {
    let (mesh, faces, told) = converted(&scan());
    assert!(faces <= 30, "{faces} faces");
    let share = irregular_inside(&mesh) as f64 / mesh.points.len() as f64;
    assert!(share <= 0.06, "{share} are irregular");
    assert!(told.contains(&"278 folded edges were taken as noise, not kept".to_owned()), "{told:?}");
}

#[test]
fn a_scan_of_twice_the_noise_converts_relaxed_where_quadrilaterals_would_fold() {
    let clean = scan();
    let mut relaxed = 0;
    for seed in 1..4 {
        let mut random = XorShift::of(seed);
        let mut normal = || (0..12).map(|_| random.next() as f64 / u64::MAX as f64).sum::<f64>() - 6.0;
        let mut noisy = clean.clone();
        noisy.points.iter_mut().for_each(|p| *p += 0.0115 * DVec3::new(normal(), normal(), normal()));
        let (mesh, faces, told) = converted(&noisy);
        assert!(faces <= 30, "{seed}: {faces} faces");
        relaxed += usize::from(told.iter().any(|told| told.contains("moved to the mean of those around")));
        // Nothing was flattened: near each point of the surface there is a node.
        for _ in 0..300 {
            let p = clean.points[random.below(clean.points.len())];
            assert!(mesh.points.iter().any(|q| q.distance(p) < 0.1), "{seed}: no node near {p}");
        }
    }
    assert!(relaxed > 0);
}
