//! Two ways to use a mesh: its triangles as they are, or its shape meshed anew; in the plane and in space, by words of
//! a case.
#![allow(clippy::unwrap_used)]

#[path = "common/grid.rs"]
mod grid;

use std::path::Path;

use glam::DVec3;
use grid::grid;
use quadfront::core::case::Case;
use quadfront::core::convert::conversion::convert;
use quadfront::core::discrete::chart::charts;
use quadfront::core::discrete::features::{ANGLE, features};
use quadfront::core::discrete::repair::repair;
use quadfront::core::discrete::{Edges, StretchBound};
use quadfront::core::fault::Fault;
use quadfront::core::formats::format::{read_bytes, read_mesh, write_mesh};
use quadfront::core::formats::{Format, WriteOptions};
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::soup::soundness::examine;
use quadfront::core::soup::{Allow, Group, MeshFile};

/// A plate of `n` by `n` squares of two regions, bent up along a parabola.
fn plate(n: u32, height: f64) -> MeshFile {
    let mut mesh = grid(n, |x, _| height * x * x);
    mesh.triangle_tags = (0..2 * n * n).map(|t| if t / 2 % n < n / 2 { 7 } else { 9 }).collect();
    for (tag, name) in [(7, "left plate"), (9, "right")] {
        mesh.groups.push(Group { dimension: 2, tag, name: name.to_owned() });
    }
    mesh
}

/// A cube of `n` by `n` squares a side, blown up to a ball.
fn ball(n: u32) -> MeshFile {
    let (mut corners, mut mesh) = (Vec::new(), MeshFile::default());
    for (normal, s) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::Z), (DVec3::Z, DVec3::X)] {
        for (normal, s) in [(normal, s), (-normal, s)] {
            let t = normal.cross(s);
            let at = |i: u32, j: u32| {
                let [u, v] = [i, j].map(|k| 2.0 * f64::from(k) / f64::from(n) - 1.0);
                normal + s * u + t * v
            };
            for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                corners.extend([a, b, c, a, c, d]);
            }
        }
    }
    let mut number = |p: DVec3| {
        let known = mesh.points.iter().position(|q: &DVec3| q.distance(p) < 1e-9);
        known.unwrap_or_else(|| {
            mesh.points.push(p);
            mesh.points.len() - 1
        }) as u32
    };
    let numbers: Vec<u32> = corners.into_iter().map(&mut number).collect();
    mesh.triangles = numbers.as_chunks().0.to_vec();
    mesh.points.iter_mut().for_each(|p| *p = p.normalize());
    mesh
}

/// The quadrilaterals of a mesh that is used as some lines of a case say.
fn used(mesh: &MeshFile, lines: &str) -> Result<MeshFile, Fault> {
    let folder = tempfile::tempdir().unwrap();
    write_mesh(&folder.path().join("a.msh"), Format::Msh, mesh, WriteOptions::default()).unwrap();
    let text = format!("version = 1\nmesh = \"a.msh\"\n{lines}\n");
    let case = Case::parse(&text, "a", "a.toml", folder.path()).unwrap();
    let done = convert(&case, &mut Nobody)?;
    let file = Export::of(&done.mesh, &done.names).file;
    assert!(file.triangles.is_empty());
    examine(&file).verdict(Allow::default()).unwrap();
    assert!(done.mesh.folded().is_empty());
    Ok(file)
}

fn has(mesh: &MeshFile, p: DVec3) -> bool {
    mesh.points.iter().any(|q| q.distance(p) < 1e-12)
}

#[test]
fn the_triangles_of_a_mesh_in_space_are_converted_with_its_border_as_it_is() {
    let given = plate(8, 0.4);
    let quads = used(&given, "use = \"triangles\"").unwrap();
    assert!((quads.quads.len() as f64 / 64.0 - 1.0).abs() < 0.3, "{}", quads.quads.len());
    for p in given.points.iter().filter(|p| p.x * p.y * (1.0 - p.x) * (1.0 - p.y) == 0.0) {
        assert!(has(&quads, *p), "{p} is lost");
    }
    // Every node lies on a triangle that was given: between the parabola and its chords.
    let within = |p: &DVec3| (-1e-12..=0.4 / 256.0 + 1e-12).contains(&(p.z - 0.4 * p.x * p.x));
    assert!(quads.points.iter().all(within));
}

#[test]
fn the_triangles_of_a_closed_surface_are_converted() {
    let given = ball(7);
    let quads = used(&given, "use = \"triangles\"").unwrap();
    assert!((quads.quads.len() as f64 / (0.5 * given.triangles.len() as f64) - 1.0).abs() < 0.3);
    let mut sides: Vec<[u32; 2]> =
        quads.quads.iter().flat_map(|q| [0, 1, 2, 3].map(|k| [q[k], q[(k + 1) % 4]])).collect();
    sides.iter_mut().for_each(|s| s.sort_unstable());
    sides.sort_unstable();
    assert!(sides.chunk_by(|a, b| a == b).all(|same| same.len() == 2), "it is closed");
}

#[test]
fn the_shape_of_a_mesh_in_the_plane_is_meshed_anew() {
    let given = plate(3, 0.0);
    let count = |lines: &str| used(&given, lines).unwrap().quads.len() as f64;
    let sized = |h: f64| count(&format!("use = \"shape\"\n[[metric]]\nkind = \"uniform\"\nh = {h}"));
    for h in [0.1, 0.05] {
        assert!((sized(h) * h * h - 1.0).abs() < 0.2, "{h}: {}", sized(h));
    }
    // Its triangles as they are have no more than the file.
    assert!(used(&plate(8, 0.0), "").unwrap().quads.len() < 100);
}

#[test]
fn sizes_follow_the_curvature_of_a_mesh_in_space_and_its_scale() {
    let ball = ball(10);
    // A chord of 2 sqrt(eps (2 - eps)) over a unit radius.
    let by = |chord: f64| {
        let lines = format!("[[metric]]\nkind = \"curvature\"\nchord = {chord}\nleast = 0.01\nfar = 10.0");
        used(&ball, &lines).unwrap().quads.len() as f64
    };
    for chord in [0.02, 0.005] {
        let h = 2.0 * f64::sqrt(chord * (2.0 - chord));
        let expected = 4.0 * std::f64::consts::PI / (h * h);
        assert!((by(chord) / expected - 1.0).abs() < 0.3, "{chord}: {} and {expected}", by(chord));
    }
    let large = used(&plate(4, 0.3), "scale = 10.0\n[[metric]]\nkind = \"uniform\"\nh = 1.0").unwrap();
    assert!(large.points.iter().any(|p| p.x == 10.0) && large.quads.len() > 80);
}

#[test]
fn an_open_part_with_an_odd_count_is_refused_and_words_that_are_none_are_named() {
    let mut given = plate(4, 0.3);
    given.triangles.pop();
    given.triangle_tags.pop();
    let fault = used(&given, "use = \"triangles\"").unwrap_err();
    assert!(fault.what.contains("even count") && !fault.remedy.is_empty(), "{fault}");
    assert!(used(&given, "use = \"triangles\"\nsplit_odd = true").is_ok());
    for (line, told) in [
        ("mesh = \"a.msh\"\nuse = \"wobble\"", "shape"),
        ("mesh = \"a.msh\"\nfeature_angle = 0", "degrees"),
        ("mesh = \"a.msh\"\nscale = -1", "factor"),
        ("use = \"shape\"", "without mesh"),
    ] {
        let fault = Case::parse(&format!("version = 1\n{line}\n"), "a", "a.toml", Path::new("")).unwrap_err();
        assert!(fault.to_string().contains(told), "{fault}");
    }
}

#[test]
fn what_is_written_of_a_surface_reads_back_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let quads = used(&ball(4), "use = \"shape\"").unwrap();
    for format in Format::written() {
        let path = folder.path().join("a").with_extension(format.extension());
        write_mesh(&path, format, &quads, WriteOptions::default()).unwrap();
        let back = read_mesh(&path, None).unwrap();
        assert_eq!((&back.points, &back.quads), (&quads.points, &quads.quads), "{format:?}");
    }
}

/// A vase: `n` by `n` squares around and along, as OBJ with the texture of its unrolled side, torn at the angle `seam`
/// (in squares).
fn vase(n: u32, seam: u32, texture: bool) -> Vec<u8> {
    let mut text = String::new();
    for k in 0..n * (n + 1) {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k % n) / f64::from(n));
        let z = f64::from(k / n) / f64::from(n);
        let r = 0.4 + 0.1 * libm::sin(4.0 * z);
        text += &format!("v {} {} {}\n", r * cos, r * sin, 2.0 * z);
    }
    for k in 0..(n + 1) * (n + 1) {
        text += &format!("vt {} {}\n", f64::from(k % (n + 1)) / f64::from(n), f64::from(k / (n + 1)) / f64::from(n));
    }
    for k in 0..n * n {
        let corner = |i: u32, j: u32| {
            let (across, along) = (k % n + i, k / n + j);
            let point = along * n + across % n + 1;
            let place = along * (n + 1) + (k % n + n - seam) % n + i + 1;
            if texture { format!("{point}/{place}") } else { point.to_string() }
        };
        text += &format!("f {} {} {} {}\n", corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1));
    }
    text.into_bytes()
}

#[test]
fn the_texture_of_a_file_lays_its_charts_where_it_is_one_to_one() {
    let n = 24;
    let vertical = |bytes: &[u8], seam: u32| {
        let given = read_bytes("a.obj", bytes, Format::Obj).unwrap();
        let laid = repair(&given, None, &mut Nobody).unwrap();
        let edges = Edges::of(&laid.mesh.triangles);
        let features = features(&laid.mesh, &edges, ANGLE);
        let found = charts(&laid.mesh, &edges, &features, StretchBound::default(), &mut Nobody).unwrap();
        assert_eq!(found.len(), 1);
        // Points that are there twice: those of the slit.
        let mut points = found[0].points.clone();
        points.sort_unstable();
        let twice: Vec<u32> = points.windows(2).filter(|w| w[0] == w[1]).map(|w| w[0] % n).collect();
        assert_eq!(twice.len(), n as usize + 1);
        assert!(used(&given, "use = \"shape\"").unwrap().quads.len() > 200);
        twice.iter().all(|&at| at == seam)
    };
    assert!([5, 17].iter().all(|&seam| vertical(&vase(n, seam, true), seam)));
    assert!(![5, 17].iter().all(|&seam| vertical(&vase(n, seam, false), seam)));
    // Numbers that lead nowhere are passed over.
    let damaged = String::from_utf8(vase(n, 5, true)).unwrap().replace("/1 ", "/999999 ");
    assert!(!vertical(damaged.replace("vt 0 1\n", "vt nan\n").as_bytes(), 17));
}
