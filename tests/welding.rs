//! Promise: points that are meant to be one become one, and it is told; points that are not meant to be stay apart.
//! What is merged is what comparing all pairs of points gives.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use glam::DVec3;
use quadfront::core::progress::Cancel;
use quadfront::core::soup::soundness::examine;
use quadfront::core::soup::{MeshFile, Weld, Welded};
use quadfront::core::{formats::Format, formats::format::read_bytes};

/// Random numbers by xorshift.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// From -1 to 1.
    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit())
    }
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// A bent plate of `n` by `n` squares of two triangles.
fn plate(n: usize) -> MeshFile {
    let at = |k: usize| k as f64 / n as f64;
    let points = (0..(n + 1) * (n + 1)).map(|k| {
        let (x, y) = (at(k % (n + 1)), at(k / (n + 1)));
        DVec3::new(x, y, 0.4 * x * x + 0.1 * y)
    });
    let triangles = (0..n * n).flat_map(|k| {
        let a = (k % n + k / n * (n + 1)) as u32;
        let above = a + n as u32 + 1;
        [[a, a + 1, above + 1], [a, above + 1, above]]
    });
    MeshFile { points: points.collect(), triangles: triangles.collect(), ..MeshFile::default() }
}

/// The same with corners of its own for each triangle, moved by up to `noise` along each axis; and the point of the
/// mesh at each corner.
fn torn(mesh: &MeshFile, noise: f64, random: &mut Random) -> (MeshFile, Vec<u32>) {
    let truth = mesh.triangles.as_flattened().to_vec();
    let points = truth.iter().map(|&k| mesh.points[k as usize] + noise * random.vector()).collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    (MeshFile { points, triangles, ..MeshFile::default() }, truth)
}

fn welded(mesh: &MeshFile, how: Weld) -> (MeshFile, Welded) {
    let mut mesh = mesh.clone();
    let welded = mesh.weld(how, &Cancel::default()).unwrap();
    (mesh, welded)
}

/// The ends of the sides that one triangle only has, by looking at all pairs of sides.
fn border(mesh: &MeshFile) -> BTreeSet<u32> {
    let sides: Vec<[u32; 2]> = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    let alone = |&&[a, b]: &&[u32; 2]| sides.iter().filter(|side| **side == [a, b] || **side == [b, a]).count() == 1;
    sides.iter().filter(alone).flatten().copied().collect()
}

fn mean_side(mesh: &MeshFile) -> f64 {
    let at = |k: u32| mesh.points[k as usize];
    let sides = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    sides.map(|[a, b]| at(a).distance(at(b))).sum::<f64>() / (3 * mesh.triangles.len()) as f64
}

/// Merges points up to a distance, comparing all pairs: each into the first that stands, if one of both is on a border
/// and no triangle has both.
fn by_all_pairs(mesh: &MeshFile, distance: f64) -> MeshFile {
    let border = border(mesh);
    let mut first: Vec<u32> = (0..mesh.points.len() as u32).collect();
    for k in 0..first.len() as u32 {
        let found = (0..k).find(|&other| {
            let stands = first[other as usize] == other && mesh.triangles.as_flattened().contains(&other);
            let near = mesh.points[k as usize].distance(mesh.points[other as usize]) <= distance;
            let of_one = |t: &[u32; 3]| t.contains(&k) && t.iter().any(|&c| c < k && first[c as usize] == other);
            stands && near && (border.contains(&k) || border.contains(&other)) && !mesh.triangles.iter().any(of_one)
        });
        if let Some(other) = found.filter(|_| mesh.triangles.as_flattened().contains(&k)) {
            first[k as usize] = other;
        }
    }
    let stands: Vec<u32> = (0..first.len() as u32).filter(|&k| first[k as usize] == k).collect();
    let new = |k: u32| stands.iter().position(|&own| own == first[k as usize]).unwrap() as u32;
    MeshFile {
        points: stands.iter().map(|&k| mesh.points[k as usize]).collect(),
        triangles: mesh.triangles.iter().map(|t| t.map(new)).collect(),
        ..MeshFile::default()
    }
}

#[test]
fn what_is_merged_up_to_a_distance_is_what_all_pairs_give() {
    let mut random = Random(7);
    let (mut merged, mut refused) = (0, 0);
    for round in 0..120 {
        let whole = plate(2 + round % 3);
        let edge = 1.0 / (2 + round % 3) as f64;
        // From noise far below the edges to distances beyond them.
        let noise = edge * 10.0_f64.powf(-3.0 + 3.0 * (random.unit() + 1.0) / 2.0);
        let (mut mesh, _) = torn(&whole, noise, &mut random);
        // Some triangles share their corners, and there are points of nothing.
        for _ in 0..random.below(40) {
            let (a, b) = (random.below(mesh.points.len()) as u32, random.below(mesh.points.len()) as u32);
            if !mesh.triangles.iter().any(|t| t.contains(&a) && t.contains(&b)) {
                mesh.triangles.as_flattened_mut().iter_mut().filter(|k| **k == b).for_each(|k| *k = a);
            }
        }
        for factor in [0.3, 1.0, 4.0] {
            let distance = factor * noise;
            if mesh.clone().weld(Weld::Within(distance), &Cancel::default()).is_err() {
                assert!(distance > mean_side(&mesh), "{round}, {distance}");
                refused += 1;
                continue;
            }
            assert!(distance <= mean_side(&mesh), "{round}, {distance}");
            let ((found, told), oracle) = (welded(&mesh, Weld::Within(distance)), by_all_pairs(&mesh, distance));
            assert_eq!((&found.points, &found.triangles), (&oracle.points, &oracle.triangles), "{round}, {distance}");
            assert_eq!(told.merged, mesh.points.len() - found.points.len());
            assert!(
                told.farthest <= distance
                    && found.triangles.iter().all(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
            );
            merged += told.merged;
        }
    }
    assert!(merged > 1000 && refused > 10, "{merged}, {refused}");
}

#[test]
fn a_torn_plate_is_joined_as_it_was_whatever_the_noise_and_the_unit() {
    let mut random = Random(11);
    for round in 0..60 {
        let whole = plate(2 + round % 7);
        let unit = 10.0_f64.powi(round as i32 % 13 - 6);
        let edge = 1.0 / (2 + round % 7) as f64;
        let noise = edge * 10.0_f64.powf(-9.0 + 5.0 * (random.unit() + 1.0) / 2.0);
        let (mut mesh, truth) = torn(&whole, noise, &mut random);
        mesh.points.iter_mut().for_each(|p| *p *= unit);
        let (found, told) = welded(&mesh, Weld::Auto);
        assert_eq!((found.points.len(), told.apart, told.branching), (whole.points.len(), 0, 0), "{round}, {noise}");
        assert!(told.farthest <= 2.0 * 3.0_f64.sqrt() * noise * unit && told.farthest > 0.0);
        // Corners are one if and only if they were.
        for (a, &own) in found.triangles.as_flattened().iter().zip(&truth) {
            for (b, &other) in found.triangles.as_flattened().iter().zip(&truth) {
                assert_eq!(a == b, own == other, "{round}");
            }
        }
        // Once more: there is nothing to do. And nothing at all without near points.
        assert_eq!(welded(&found, Weld::Auto), (found.clone(), Welded { tolerance: Some(0.0), ..Welded::default() }));
        assert_eq!(welded(&mesh, Weld::Within(0.0)), (mesh.clone(), Welded::default()));
    }
}

#[test]
fn gaps_without_a_clear_distance_and_elements_as_small_as_the_gap_stay_as_they_are() {
    // Two plates with a gap that opens from a thousandth of an edge to a tenth.
    let (mut mesh, other) = (plate(4), plate(4));
    mesh.points.extend(other.points.iter().map(|p| *p + DVec3::new(1.0 + 2.5e-4 * 3.0_f64.powf(4.0 * p.y), 0.0, 0.0)));
    mesh.points[..25].iter_mut().chain(&mut []).for_each(|p| p.z = 0.0);
    mesh.points[25..].iter_mut().for_each(|p| p.z = 0.0);
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|k| k + 25)));
    assert_eq!(welded(&mesh, Weld::Auto).1.merged, 0);
    // Up to a distance, some of them are: the first three.
    assert_eq!(welded(&mesh, Weld::Within(2.5e-3)).1.merged, 3);
    // A gap of the same width all along is closed by itself only where it is far below the edges.
    for (gap, merged) in [(1e-5, 5), (2e-4, 5), (5e-3, 0)] {
        let mut mesh = mesh.clone();
        mesh.points[25..].iter_mut().zip(&other.points).for_each(|(p, q)| p.x = q.x + 1.0 + gap);
        assert_eq!(welded(&mesh, Weld::Auto).1.merged, merged, "{gap}");
    }
    // The banks of a crack are at exactly one place: they are not near, but the same.
    let mut crack = plate(4);
    crack.points.push(crack.points[2]);
    crack.triangles.as_flattened_mut().iter_mut().rev().find(|k| **k == 2).map(|k| *k = 25).unwrap();
    assert_eq!(welded(&crack, Weld::Auto).1.merged, 0);
    // A needle as thin as the noise keeps its corners.
    let mut needle = plate(2);
    needle.points.extend([DVec3::new(2.0, 0.0, 0.0), DVec3::new(2.0, 1e-7, 0.0), DVec3::new(3.0, 0.0, 0.0)]);
    needle.triangles.push([9, 10, 11]);
    assert_eq!(welded(&needle, Weld::Auto).1.merged, 0);
    let told = welded(&needle, Weld::Within(1e-3)).1;
    assert_eq!((told.merged, told.apart), (0, 1));
}

#[test]
fn what_belongs_to_points_follows_them_and_numbers_stay_those_of_the_file() {
    let text =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1.0000001 0 0\nv 1 1 0\nv 0 0.9999999 0\nv 7 7 7\nf 1 2 3\nf 4 5 6\nl 2 5\n";
    let mut mesh = read_bytes("a.obj", text.as_bytes(), Format::Obj).unwrap();
    mesh.uv = Some(mesh.points.iter().map(|p| p.truncate()).collect());
    let (found, told) = welded(&mesh, Weld::Auto);
    assert_eq!((told.merged, &found.triangles[..], &found.lines[..]), (2, &[[0, 1, 2], [1, 3, 2]][..], &[[1, 3]][..]));
    assert_eq!(found.uv.unwrap(), found.points.iter().map(|p| p.truncate()).collect::<Vec<_>>());
    assert_eq!(found.points.len(), 5);
    assert_eq!(MeshFile { uv: None, ..found }.describe_points(&[2, 3, 4]), "points 3, 5 and 7");
}

#[test]
fn a_distance_with_thousands_of_points_within_is_refused_before_it_takes_quadratic_time() {
    // Dense in the middle, far from the border.
    let mut mesh = plate(200);
    let middle = DVec3::new(0.5, 0.5, 0.0);
    for p in &mut mesh.points {
        let away = (*p - middle).with_z(0.0);
        *p = middle + away * away.abs().max_element().powi(6);
    }
    let distance = 0.99 * mean_side(&mesh);
    let begin = std::time::Instant::now();
    let fault = mesh.weld(Weld::Within(distance), &Cancel::default()).unwrap_err();
    assert!(fault.what.contains("hundreds of others") && fault.remedy.contains("--weld"), "{fault}");
    assert!(begin.elapsed().as_secs() < 20);
}

#[test]
fn many_triangles_around_one_place_do_not_take_quadratic_time() {
    let mut random = Random(5);
    // A fan of triangles of their own corners.
    let n = 60_000;
    let at = |k: usize| {
        let angle = k as f64 / n as f64 * std::f64::consts::TAU;
        DVec3::new(angle.cos(), angle.sin(), 0.0)
    };
    let points = (0..n).flat_map(|k| [DVec3::ZERO, at(k), at(k + 1)].map(|p| p + 1e-9 * random.vector()));
    let mut mesh = MeshFile { points: points.collect(), ..MeshFile::default() };
    mesh.triangles = (0..n as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let begin = std::time::Instant::now();
    let told = mesh.weld(Weld::Auto, &Cancel::default()).unwrap();
    assert!(begin.elapsed().as_secs() < 20, "{:?}", begin.elapsed());
    assert_eq!((told.merged, mesh.points.len()), (3 * n - n - 1, n + 1));
}

fn quadfront(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quadfront")).args(arguments).current_dir(folder).output().unwrap()
}

/// Converts a mesh; what was repaired, and the mesh that was written.
fn converted(name: &str, options: &[&str]) -> (Vec<String>, MeshFile) {
    let folder = tempfile::tempdir().unwrap();
    let input = data(name);
    let mut arguments = vec!["convert", input.to_str().unwrap(), "-o", "quads.msh", "--report", "report.json"];
    arguments.extend(options);
    let output = quadfront(&arguments, folder.path());
    assert_eq!(output.status.code(), Some(0), "{name}: {output:?}");
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&read("report.json")).unwrap();
    let repairs: Vec<String> = serde_json::from_value(report["repairs"].clone()).unwrap();
    let summary = String::from_utf8(output.stdout).unwrap();
    assert!(repairs.iter().all(|repair| summary.contains(repair)), "{summary}");
    (repairs, read_bytes("quads.msh", &read("quads.msh"), Format::Msh).unwrap())
}

#[test]
fn o_dup_and_o_noisy_dup_become_one_piece_of_quadrilaterals() {
    // 288 triangles of their own corners, of a plate of 13 by 13 points.
    for (name, farthest) in [("o_dup_1e-05.obj", "2.78202e-5"), ("o_noisy_dup.obj", "8.94986e-8")] {
        for options in
            [&[][..], &["--weld", "auto"], &["--weld", "0.0001"], &["--use", "triangles"], &["--scale", "0.001"]]
        {
            let (repairs, quads) = converted(name, options);
            let scaled = options.contains(&"--scale");
            let farthest = if scaled {
                format!("{}e-{}", &farthest[..7], if name == "o_dup_1e-05.obj" { 8 } else { 11 })
            } else {
                farthest.to_owned()
            };
            assert_eq!(repairs, [format!("695 near points of borders were merged into others, up to {farthest} away")]);
            let found = examine(&quads);
            assert!(quads.is_of_quads() && found.findings.is_empty(), "{name}, {options:?}: {:?}", found.findings);
            assert_eq!((found.components, found.boundary_loops, found.euler), (1, 1, 1));
        }
    }
    // As before, where it is asked for.
    let (repairs, loose) = converted("o_dup_1e-05.obj", &["--weld", "0"]);
    assert_eq!((repairs.len(), examine(&loose).components), (0, 288));
}

#[test]
fn check_merges_first_and_tells() {
    let folder = tempfile::tempdir().unwrap();
    let input = data("o_noisy_dup.obj");
    let input = input.to_str().unwrap();
    let facts = |options: &[&str]| {
        let output =
            quadfront(&[&["check", input, "--triangles", "--report", "found.json"], options].concat(), folder.path());
        let json: serde_json::Value =
            serde_json::from_slice(&std::fs::read(folder.path().join("found.json")).unwrap()).unwrap();
        (String::from_utf8(output.stdout).unwrap(), json["components"].as_u64(), json["repairs"].clone())
    };
    let told = "695 near points of borders were merged into others, up to 8.94986e-8 away";
    let (text, components, repairs) = facts(&[]);
    assert!(text.contains(told) && text.contains("1 pieces"), "{text}");
    assert_eq!((components, repairs), (Some(1), serde_json::json!([told])));
    let (text, components, repairs) = facts(&["--weld", "0"]);
    assert!(!text.contains("near points"), "{text}");
    assert_eq!((components, repairs), (Some(288), serde_json::json!([])));
}

#[test]
fn what_is_no_distance_is_refused_in_words_and_cases_say_weld() {
    let folder = tempfile::tempdir().unwrap();
    let input = data("o_noisy_dup.obj");
    for wrong in ["-1", "nan", "inf", "some"] {
        let output = quadfront(&["convert", input.to_str().unwrap(), &format!("--weld={wrong}")], folder.path());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains("write a distance, 0 or auto"), "{said}");
    }
    let case = |line: &str| {
        let text = format!("version = 1\nmesh = '{}'\n{line}\n", input.display());
        std::fs::write(folder.path().join("case.toml"), text).unwrap();
        let output = quadfront(&["background", "case.toml"], folder.path());
        format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
    };
    for merges in ["", "weld = \"auto\"", "weld = 1e-6"] {
        assert!(case(merges).contains("695 near points"), "{}", case(merges));
    }
    assert!(!case("weld = 0").contains("near points"));
    for wrong in ["weld = -1", "weld = \"on\"", "weld = true"] {
        let said = case(wrong);
        assert!(
            said.contains("case.toml, line 3: weld =") && said.contains("is not a distance, 0 or \"auto\""),
            "{said}"
        );
    }
}
