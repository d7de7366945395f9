//! Promise: where a border ends on the edges of another sheet, or of another part in its own plane, both have the same
//! nodes there, and it is told; borders that nearly touch without that are told with their places.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use glam::{DMat3, DVec3};
use quadfront::core::discrete::repair::repair;
use quadfront::core::discrete::{Edges, Triangles};
use quadfront::core::formats::Format;
use quadfront::core::formats::format::read_bytes;
use quadfront::core::progress::{Cancel, Nobody};
use quadfront::core::soup::soundness::examine;
use quadfront::core::soup::{Allow, MeshFile, Weld};

#[path = "common/xor_shift.rs"]
mod xor_shift;
use xor_shift::XorShift;

/// From -1 to 1.
fn unit(random: &mut XorShift) -> f64 {
    random.below(2_000_001) as f64 / 1e6 - 1.0
}

/// Divisions of the interval from 0 to 1 with at least 1/20 between two of them.
fn division(random: &mut XorShift) -> Vec<f64> {
    let n = 2 + random.below(6);
    let mut at = vec![0.0];
    (1..n).for_each(|k| at.push((k as f64 + 0.3 * unit(random)) / n as f64));
    at.push(1.0);
    at
}

/// A sheet of two directions with a row of points for each of `us` by `vs`.
fn sheet(us: &[f64], vs: &[f64], at: impl Fn(f64, f64) -> DVec3) -> MeshFile {
    let points = vs.iter().flat_map(|&v| us.iter().map(move |&u| (u, v))).map(|(u, v)| at(u, v)).collect();
    let n = us.len();
    let squares = (0..vs.len() - 1).flat_map(|j| (0..n - 1).map(move |i| (i + j * n) as u32));
    let above = n as u32;
    let triangles = squares.flat_map(|a| [[a, a + 1, a + above + 1], [a, a + above + 1, a + above]]).collect();
    MeshFile { points, triangles, ..MeshFile::default() }
}

fn and(mut one: MeshFile, other: &MeshFile) -> MeshFile {
    let n = one.points.len() as u32;
    one.points.extend(&other.points);
    one.triangles.extend(other.triangles.iter().map(|t| t.map(|k| k + n)));
    one
}

fn area(points: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let of = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|k| points[k as usize]);
        0.5 * (b - a).cross(c - a).length()
    };
    triangles.iter().map(of).sum()
}

/// How many triangles there are at the edges along a line, by counting the sides of all triangles there.
fn along(mesh: &Triangles, is_on: impl Fn(DVec3) -> bool) -> BTreeMap<[u32; 2], usize> {
    let mut count = BTreeMap::new();
    for &[a, b, c] in &mesh.triangles {
        for [a, b] in [[a, b], [b, c], [c, a]] {
            if is_on(mesh.points[a as usize]) && is_on(mesh.points[b as usize]) {
                *count.entry([a.min(b), a.max(b)]).or_insert(0) += 1;
            }
        }
    }
    count
}

#[test]
fn random_t_joints_have_three_triangles_at_every_edge_between_the_nodes_of_both() {
    let mut random = XorShift::of(17);
    for round in 0..80 {
        let [ys, zs, own] = [division(&mut random), division(&mut random), division(&mut random)];
        // The plate has a row of edges along x = 0; the sheet stands there, with nodes of its own.
        let xs: Vec<f64> = division(&mut random).iter().map(|x| x - 1.0).chain([0.4, 1.0]).collect();
        let plate = sheet(&xs, &ys, |x, y| DVec3::new(x, y, 0.0));
        let lean = 0.5 * unit(&mut random);
        let upright = sheet(&own, &zs, |y, z| DVec3::new(lean * z, y, z));
        let turn = DMat3::from_euler(glam::EulerRot::XYZ, unit(&mut random), unit(&mut random), unit(&mut random));
        let noise = if round % 2 == 0 { 0.0 } else { 1e-6 };
        let mut file = and(plate, &upright);
        for p in &mut file.points {
            *p = turn * (*p + noise * DVec3::new(unit(&mut random), unit(&mut random), unit(&mut random)));
        }
        let whole = area(&file.points, &file.triangles);
        let welded = file.weld(Weld::Auto, &Cancel::default()).unwrap();
        let found = repair(&file, welded.tolerance, &mut Nobody).unwrap();

        let back = turn.transpose();
        let is_on = |p: DVec3| {
            let p = back * p;
            p.x.abs() < 1e-5 && p.z.abs() < 1e-5
        };
        let mut places: Vec<f64> = ys.iter().chain(&own).copied().collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| (*a - *b).abs() < 1e-5);
        // Nodes of both that are close, but not one, are nearer than this to each other only by chance.
        if places.windows(2).any(|pair| pair[1] - pair[0] < 1e-3) {
            continue;
        }
        let count = along(&found.mesh, is_on);
        assert_eq!(count.len(), places.len() - 1, "{round}: {:?}", found.repairs);
        assert!(count.values().all(|&n| n == 3), "{round}: {count:?}");
        assert!((area(&found.mesh.points, &found.mesh.triangles) - whole).abs() < 1e-4 * whole);
        let inside = places.len() - 2;
        let hung = ys.len() + own.len() - 4;
        assert_eq!(inside, hung, "both have the ends only in common");
        let told = |n: usize, one: &str, many: &str| format!("{n} {}", if n == 1 { one } else { many });
        let mut expected = vec![];
        if noise == 0.0 {
            expected.push("2 coincident points were merged".to_owned());
        }
        expected.push(told(hung, "hanging point was joined to the mesh", "hanging points were joined to the mesh"));
        expected.push(format!("{} edges were left with three elements or more", places.len() - 1));
        assert_eq!(found.repairs, expected, "{round}");
        // Kept apart, as before: the parts share two points at most.
        let kept = repair(&file, None, &mut Nobody).unwrap();
        let edges = Edges::of(&kept.mesh.triangles);
        assert!((0..edges.len()).all(|edge| edges.get(edge).sides.len() < 3));
    }
}

fn converted(folder: &Path, options: &[&str]) -> (Option<i32>, String, Vec<String>) {
    let output = Command::new(env!("CARGO_BIN_EXE_quadfront"))
        .args(["convert", "t.obj", "-o", "quads.msh", "--report", "report.json"])
        .args(options)
        .current_dir(folder)
        .output()
        .unwrap();
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let report = std::fs::read(folder.join("report.json")).ok();
    let report = report.map(|bytes| serde_json::from_slice::<serde_json::Value>(&bytes).unwrap());
    let repairs = report.map(|report| serde_json::from_value(report["repairs"].clone()).unwrap());
    (output.status.code(), said, repairs.unwrap_or_default())
}

fn quads(folder: &Path) -> MeshFile {
    read_bytes("quads.msh", &std::fs::read(folder.join("quads.msh")).unwrap(), Format::Msh).unwrap()
}

#[test]
fn t_junction_nonconf_joins_conformingly() {
    let folder = tempfile::tempdir().unwrap();
    let input = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/t_junction_nonconf.obj");
    std::fs::copy(input, folder.path().join("t.obj")).unwrap();
    for options in [&[][..], &["--use", "triangles", "--split-odd"], &["--weld", "1e-6"]] {
        let (code, said, repairs) = converted(folder.path(), options);
        assert_eq!(code, Some(0), "{said}");
        // A node each quarter on the plate and each third on the sheet, of a length of three: four of them are one.
        let told = [
            "4 coincident points were merged",
            "15 hanging points were joined to the mesh",
            "18 edges were left with three elements or more",
        ];
        assert_eq!(repairs[..3], told, "{said}");
        assert!(!said.contains("not joined"), "{said}");
        let quads = quads(folder.path());
        examine(&quads).verdict(Allow { triangles: false, seams: false, branching: true }).unwrap();
        assert!(quads.is_of_quads());
        let found = examine(&quads);
        // The border of the sheet begins and ends on that of the plate.
        assert_eq!((found.components, found.boundary_loops), (1, 1), "{said}");
        assert!((found.area - 18.0).abs() < 1e-5);
        // Every edge on the line has three quadrilaterals, and they cover it.
        let mut sides: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        for q in &quads.quads {
            for k in 0..4 {
                let [a, b] = [q[k], q[(k + 1) % 4]];
                *sides.entry([a.min(b), a.max(b)]).or_insert(0) += 1;
            }
        }
        let on = |k: u32| quads.points[k as usize].x.abs() < 1e-9 && quads.points[k as usize].z.abs() < 1e-9;
        let line: Vec<_> = sides.iter().filter(|(ends, _)| ends.iter().all(|&k| on(k))).collect();
        assert!(line.iter().all(|(_, count)| **count == 3), "{line:?}");
        let y = |k: u32| quads.points[k as usize].y;
        let long: f64 = line.iter().map(|(ends, _)| (y(ends[0]) - y(ends[1])).abs()).sum();
        assert!((long - 3.0).abs() < 1e-9, "{long}");
    }
    // As before, where it is asked for.
    let (code, said, repairs) = converted(folder.path(), &["--weld", "0"]);
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(repairs, ["4 coincident points were merged", "2 contact points between parts were split"], "{said}");
    assert_eq!(examine(&quads(folder.path())).components, 2);
}

/// Two plates in one plane with unlike nodes where they meet, moved apart by a gap.
fn side_by_side(gap: f64, z: f64) -> String {
    let at = |n: usize| (0..=n).map(|k| k as f64 / n as f64).collect::<Vec<_>>();
    let one = sheet(&at(4), &at(4), |x, y| DVec3::new(x, y, z * x));
    let other = sheet(&at(4), &at(6), |x, y| DVec3::new(x + 1.0 + gap, y, z * (x + 1.0)));
    let mesh = and(one, &other);
    let mut text = String::new();
    mesh.points.iter().for_each(|p| writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap());
    mesh.triangles.iter().for_each(|t| writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1).unwrap());
    text
}

#[test]
fn plates_with_unlike_nodes_join_across_a_gap_far_below_their_edges_and_a_wider_gap_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let write = |gap: f64, z: f64| std::fs::write(folder.path().join("t.obj"), side_by_side(gap, z)).unwrap();
    for z in [0.0, 0.5] {
        write(1e-6, z);
        let (code, said, repairs) = converted(folder.path(), &["--use", "shape"]);
        assert_eq!(code, Some(0), "{said}");
        // Nodes at quarters and at sixths: ends and the middle are common, 2 and 4 hang.
        let merged = "3 near points of borders were merged into others, up to 1e-6 away";
        let told = [merged, "6 hanging points were joined to the mesh"];
        assert_eq!(repairs, told, "{said}");
        let quads = quads(folder.path());
        let found = examine(&quads);
        assert_eq!((found.components, found.boundary_loops, found.findings.len()), (1, 1, 0), "{said}");

        write(5e-3, z);
        let (code, said, repairs) = converted(folder.path(), &["--use", "shape"]);
        assert_eq!((code, repairs.len()), (Some(0), 1), "{said}");
        // All five and seven nodes on both sides of the gap.
        assert!(
            repairs[0].starts_with("not joined: 12 points of borders are close to other elements, 0.005"),
            "{said}"
        );
        assert!(repairs[0].ends_with(" and 7 more") && repairs[0].contains("at (1, 0"), "{said}");
        assert_eq!(examine(&self::quads(folder.path())).components, 2);
        let (code, said, repairs) = converted(folder.path(), &["--use", "shape", "--weld", "0"]);
        assert_eq!((code, repairs.len()), (Some(0), 0), "{said}");
        // A gap as wide as an edge is none that is told.
        write(0.1, z);
        assert_eq!(converted(folder.path(), &["--use", "shape"]).2.len(), 0);
    }
}

#[test]
fn a_sheet_that_ends_inside_triangles_of_another_is_told_with_its_places() {
    let folder = tempfile::tempdir().unwrap();
    let at = |n: usize| (0..=n).map(|k| k as f64 / n as f64).collect::<Vec<_>>();
    let plate = sheet(&at(5), &at(5), |x, y| DVec3::new(x, y, 0.0));
    // Along a line that crosses the triangles, within the plate.
    let upright = sheet(&at(3), &at(2), |u, z| DVec3::new(0.13 + 0.7 * u, 0.31 + 0.2 * u, z));
    let mesh = and(plate, &upright);
    let mut text = String::new();
    mesh.points.iter().for_each(|p| writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap());
    mesh.triangles.iter().for_each(|t| writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1).unwrap());
    std::fs::write(folder.path().join("t.obj"), text).unwrap();
    let (code, said, repairs) = converted(folder.path(), &[]);
    assert_eq!(code, Some(0), "{said}");
    let told = "not joined: 4 points of borders are close to other elements, 0 away or more, at (0.13, 0.31, 0), ";
    assert!(repairs.len() == 1 && repairs[0].starts_with(told), "{said}");
    assert_eq!(repairs[0].matches(", 0)").count(), 4, "all places are named");
    assert!(said.lines().any(|line| line.trim_start().starts_with("not joined") && line.contains("(0.13, 0.31, 0)")));
}
