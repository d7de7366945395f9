//! Meshes in space, without CAD: whatever the shape, they become sound meshes of quadrilaterals on the same surface.
#![allow(clippy::unwrap_used)]

#[path = "common/environment.rs"]
mod environment;

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use quadfront::core::case::Case;
use quadfront::core::convert::conversion::{convert, convert_by};
use quadfront::core::formats::format::write_mesh;
use quadfront::core::formats::{Format, WriteOptions};
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::soup::soundness::examine;
use quadfront::core::soup::{Allow, MeshFile};

/// A grid over the unit square, wrapped around where asked to, at the places that `at` gives.
fn grid(nu: u32, nv: u32, wrap: [bool; 2], at: impl Fn(f64, f64) -> DVec3) -> MeshFile {
    let [columns, rows] = [nu + u32::from(!wrap[0]), nv + u32::from(!wrap[1])];
    let node = |i: u32, j: u32| (j % rows) * columns + i % columns;
    let place = |k: u32| at(f64::from(k % columns) / f64::from(nu), f64::from(k / columns) / f64::from(nv));
    let squares = (0..nu * nv).flat_map(|k| {
        let (i, j) = (k % nu, k / nu);
        let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    MeshFile { points: (0..columns * rows).map(place).collect(), triangles: squares.collect(), ..MeshFile::default() }
}

fn on_circle(angle: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(TAU * angle);
    DVec2::new(cos, sin)
}

fn torus() -> MeshFile {
    grid(40, 20, [true, true], |u, v| {
        let r = 2.0 + 0.7 * on_circle(v).x;
        (on_circle(u) * r).extend(0.7 * on_circle(v).y)
    })
}

fn tube(length: f64) -> MeshFile {
    grid(24, 30, [true, false], |u, v| on_circle(u).extend(length * v))
}

fn bumps() -> MeshFile {
    grid(24, 24, [false, false], |u, v| DVec3::new(u, v, 0.1 * on_circle(u).y * on_circle(v).y))
}

/// Converts a mesh and looks at what comes out; `allow` is for shapes that branch.
fn converted(name: &str, file: &MeshFile, allow: Allow) -> MeshFile {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.ply");
    write_mesh(&path, Format::Ply, file, WriteOptions::default()).unwrap();
    let done = convert(&Case::of_mesh(path, None), &mut Nobody).unwrap_or_else(|fault| panic!("{name}: {fault}"));
    let mesh = Export::of(&done.mesh, &done.names).file;
    assert!(mesh.triangles.is_empty() && !mesh.quads.is_empty(), "{name}");
    let found = examine(&mesh);
    assert!(found.verdict(allow).is_ok(), "{name}: {:?}", found.verdict(allow));
    let far = farthest(&mesh, file);
    assert!(far < 0.01, "{name} leaves its surface by {far} of its size");
    mesh
}

/// How far the points of two meshes lie from each other's elements, both ways, by the diagonal of the box of the
/// second.
fn farthest(mesh: &MeshFile, file: &MeshFile) -> f64 {
    let used: Vec<DVec3> = file.triangles.as_flattened().iter().map(|&k| file.points[k as usize]).collect();
    let (low, high) =
        used.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
    let given: Vec<[DVec3; 3]> = file.triangles.iter().map(|t| t.map(|k| file.points[k as usize])).collect();
    let halves = mesh.quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let made: Vec<[DVec3; 3]> = halves.map(|t| t.map(|k| mesh.points[k as usize])).collect();
    let one_way = |from: &[[DVec3; 3]], to: &[[DVec3; 3]]| {
        let points = from.iter().flat_map(|t| [t[0], t.iter().sum::<DVec3>() / 3.0]);
        let nearest = |p: DVec3| to.iter().map(|t| distance_to_triangle(p, *t)).fold(f64::INFINITY, f64::min);
        points.map(nearest).fold(0.0, f64::max)
    };
    one_way(&made, &given).max(one_way(&given, &made)) / (high - low).length()
}

fn distance_to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let n = (b - a).cross(c - a).normalize_or_zero();
    let inside = n != DVec3::ZERO && [(a, b), (b, c), (c, a)].iter().all(|&(s, t)| n.dot((t - s).cross(p - s)) >= 0.0);
    if inside {
        return n.dot(p - a).abs();
    }
    let to_side = |(s, t): (DVec3, DVec3)| {
        p.distance(s + (t - s) * ((p - s).dot(t - s) / (t - s).length_squared()).clamp(0.0, 1.0))
    };
    [(a, b), (b, c), (c, a)].into_iter().map(to_side).fold(f64::INFINITY, f64::min)
}

/// V - E + F.
fn euler(mesh: &MeshFile) -> i64 {
    let mut edges: Vec<[u32; 2]> = mesh
        .quads
        .iter()
        .flat_map(|q| (0..4).map(|k| [q[k], q[(k + 1) % 4]]))
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    mesh.points.len() as i64 - edges.len() as i64 + mesh.quads.len() as i64
}

fn boundary_edges(mesh: &MeshFile) -> usize {
    let mut edges: Vec<[u32; 2]> = mesh
        .quads
        .iter()
        .flat_map(|q| (0..4).map(|k| [q[k], q[(k + 1) % 4]]))
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).filter(|group| group.len() == 1).count()
}

#[test]
fn open_and_closed_surfaces_keep_their_topology() {
    for (name, file, characteristic, open) in [
        ("torus", torus(), 0, false),
        ("short tube", tube(1.0), 0, true),
        ("long tube", tube(12.0), 0, true),
        ("bumps", bumps(), 1, true),
    ] {
        let mesh = converted(name, &file, Allow::default());
        assert_eq!((euler(&mesh), boundary_edges(&mesh) > 0), (characteristic, open), "{name}");
    }
}

#[test]
fn edges_of_a_box_are_kept() {
    // A tube over a square, closed by two lids.
    let corners = [DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0), DVec2::new(1.0, 1.0), DVec2::new(-1.0, 1.0)];
    let n = 8;
    let around = |u: f64| {
        let at = u * 4.0;
        let k = (at.floor() as usize).min(3);
        corners[k].lerp(corners[(k + 1) % 4], at - k as f64)
    };
    let mut file = grid(4 * n, 10, [true, false], |u, v| around(u).extend(3.0 * v));
    let ring = 4 * n;
    for (first, turn) in [(0, true), (10 * ring, false)] {
        let middle = file.points.len() as u32;
        file.points.push(DVec3::new(0.0, 0.0, file.points[first as usize].z));
        for k in 0..ring {
            let (a, b) = (first + k, first + (k + 1) % ring);
            file.triangles.push(if turn { [b, a, middle] } else { [a, b, middle] });
        }
    }
    let mesh = converted("box", &file, Allow::default());
    assert_eq!((euler(&mesh), boundary_edges(&mesh)), (2, 0));
    // Every corner is a node, and no quadrilateral bends over an edge.
    for z in [0.0, 3.0] {
        for corner in corners {
            assert!(mesh.points.iter().any(|p| p.distance(corner.extend(z)) < 1e-9), "{corner} {z}");
        }
    }
    let flat = |q: &[u32; 4]| {
        let [a, b, c, d] = q.map(|k| mesh.points[k as usize]);
        (b - a).cross(d - a).normalize().dot((c - d).cross(c - b).normalize()) > 0.99
    };
    assert!(mesh.quads.iter().all(flat));
}

#[test]
fn what_branches_is_taken_as_it_is_what_is_turned_is_mended_and_what_has_one_side_is_refused() {
    // Three half planes about a line.
    let mut pages = MeshFile::default();
    for k in 0..3 {
        let out = on_circle(f64::from(k) / 3.0);
        let page = grid(6, 8, [false, false], |u, v| (out * u).extend(v));
        let first = pages.points.len() as u32;
        let mut number = Vec::new();
        for p in &page.points {
            let known = pages.points.iter().position(|q| q.distance(*p) < 1e-12);
            number.push(known.unwrap_or_else(|| {
                pages.points.push(*p);
                pages.points.len() - 1
            }) as u32);
        }
        assert!(first < pages.points.len() as u32);
        pages.triangles.extend(page.triangles.iter().map(|t| t.map(|n| number[n as usize])));
    }
    converted("pages", &pages, Allow { branching: true, ..Allow::default() });
    // A torus with every third triangle the wrong way round.
    let mut turned = torus();
    turned.triangles.iter_mut().step_by(3).for_each(|t| t.swap(0, 1));
    assert_eq!(euler(&converted("turned", &turned, Allow::default())), 0);
    // A Moebius strip: no mesh of it has an outside.
    let strip = grid(60, 5, [false, false], |u, v| {
        let (c, half) = (on_circle(u), on_circle(0.5 * u));
        let r = 2.0 + (v - 0.5) * half.x;
        (c * r).extend((v - 0.5) * half.y)
    });
    let (points, triangles) = {
        let n = 61;
        let same = |k: u32| if k % n == n - 1 { (5 - k / n) * n } else { k };
        (strip.points, strip.triangles.iter().map(|t| t.map(same)).collect())
    };
    let moebius = MeshFile { points, triangles, ..MeshFile::default() };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("moebius.ply");
    write_mesh(&path, Format::Ply, &moebius, WriteOptions::default()).unwrap();
    let fault = convert(&Case::of_mesh(path, None), &mut Nobody).unwrap_err();
    assert!(fault.to_string().contains("is one-sided"), "{fault}");
    // The edges across it, from border to border.
    assert_eq!((fault.shapes.len(), fault.shapes[0].len()), (5, 2));
}

#[test]
fn the_same_mesh_gives_the_same_bytes() {
    assert_eq!(converted("once", &bumps(), Allow::default()), converted("again", &bumps(), Allow::default()));
    // Charts one after another, as the debugger goes through them, and at the same time.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("torus.ply");
    write_mesh(&path, Format::Ply, &torus(), WriteOptions::default()).unwrap();
    let made =
        convert_by(&Case::of_mesh(path, None), &mut Nobody, &mut |converter, watch| converter.run(watch)).unwrap();
    assert!(made.names.faces.len() > 1);
    assert_eq!(Export::of(&made.mesh, &made.names).file, converted("together", &torus(), Allow::default()));
}

#[test]
fn sizes_of_a_case_hold_on_a_mesh_in_space() {
    let folder = tempfile::tempdir().unwrap();
    write_mesh(&folder.path().join("torus.ply"), Format::Ply, &torus(), WriteOptions::default()).unwrap();
    let quads = |h: f64| {
        let text = format!("version = 1\nmesh = \"torus.ply\"\n[[metric]]\nkind = \"uniform\"\nh = {h}\n");
        let case = Case::parse(&text, "torus", "torus.toml", folder.path()).unwrap();
        convert(&case, &mut Nobody).unwrap().mesh.elements().count() as f64
    };
    // The area of the torus by that of an element.
    let area = TAU * 2.0 * TAU * 0.7;
    for h in [0.2, 0.1] {
        assert!((quads(h) / (area / (h * h)) - 1.0).abs() < 0.15, "{h}: {}", quads(h));
    }
}

/// Triangles of several meshes, without a common point.
fn together(parts: &[(&MeshFile, DVec3)]) -> MeshFile {
    let mut all = MeshFile::default();
    for (part, by) in parts {
        let n = all.points.len() as u32;
        all.points.extend(part.points.iter().map(|p| *p + *by));
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|k| k + n)));
    }
    all
}

/// The sides of the unit cube, `n` squares along each edge, points repeated along the edges.
fn cube(n: u32) -> MeshFile {
    let side = |turn: DVec3, flip: bool| {
        grid(n, n, [false, false], |u, v| {
            let p = if flip { DVec3::new(v, u, 0.0) } else { DVec3::new(u, v, 1.0) };
            if turn.x > 0.0 {
                p
            } else if turn.y > 0.0 {
                DVec3::new(p.z, p.x, p.y)
            } else {
                DVec3::new(p.y, p.z, p.x)
            }
        })
    };
    let sides: Vec<MeshFile> =
        [DVec3::X, DVec3::Y, DVec3::Z].iter().flat_map(|&turn| [side(turn, false), side(turn, true)]).collect();
    together(&sides.iter().map(|side| (side, DVec3::ZERO)).collect::<Vec<_>>())
}

#[test]
fn surfaces_that_touch_themselves_are_sound_all_the_same() {
    let branching = Allow { branching: true, seams: true, ..Allow::default() };
    // Cubes that have a corner, an edge, a side and a part of a side in common.
    let [one, other] = [cube(4), cube(3)];
    let mesh = converted("corner", &together(&[(&one, DVec3::ZERO), (&one, DVec3::ONE)]), Allow::default());
    assert_eq!((euler(&mesh), boundary_edges(&mesh)), (4, 0));
    converted("edge", &together(&[(&one, DVec3::ZERO), (&one, DVec3::new(1.0, 1.0, 0.0))]), branching);
    converted("side", &together(&[(&one, DVec3::ZERO), (&one, DVec3::X)]), branching);
    converted("side, other triangles", &together(&[(&one, DVec3::ZERO), (&other, DVec3::X)]), branching);
    // A plate twice, cut along the other diagonals the second time.
    let plate = grid(3, 3, [false, false], |u, v| DVec3::new(u, v, 0.0));
    let mut turned = plate.clone();
    for k in (0..turned.triangles.len()).step_by(2) {
        let ([a, b, c], [_, _, d]) = (turned.triangles[k], turned.triangles[k + 1]);
        (turned.triangles[k], turned.triangles[k + 1]) = ([a, b, d], [b, c, d]);
    }
    let tilted = |mesh: &MeshFile| {
        let points = mesh.points.iter().map(|p| DVec3::new(p.x, p.y, 0.5 * p.x)).collect();
        MeshFile { points, ..mesh.clone() }
    };
    converted("doubled", &together(&[(&tilted(&plate), DVec3::ZERO), (&tilted(&turned), DVec3::ZERO)]), branching);
    // Points of the one hang in sides of the other.
    let coarse = grid(2, 2, [false, false], |u, v| DVec3::new(u, v, u * v));
    let fine = grid(4, 5, [false, false], |u, v| DVec3::new(1.0 + u, v, v));
    let mesh = converted("hanging", &together(&[(&coarse, DVec3::ZERO), (&fine, DVec3::ZERO)]), Allow::default());
    assert_eq!(euler(&mesh), 1);
}

#[test]
fn narrow_corners_and_spikes_are_sound() {
    // A fan of triangles between two spirals that meet under three degrees.
    let leaf = grid(40, 4, [false, false], |u, v| {
        let angle = 2.0 * u + (v - 0.5) * 0.1 * u;
        DVec3::new(u * libm::cos(angle), u * libm::sin(angle), 0.3 * u * u)
    });
    converted("leaf", &leaf, Allow::default());
    // A ball with spikes.
    let spiky = grid(36, 18, [true, true], |u, v| {
        let far = if (7 * (36.0 * u) as u32 + 5 * (18.0 * v) as u32).is_multiple_of(11) { 1.25 } else { 1.0 };
        let r = 2.0 + 0.7 * far * on_circle(v).x;
        (on_circle(u) * r).extend(0.7 * far * on_circle(v).y)
    });
    assert_eq!(euler(&converted("spikes", &spiky, Allow::default())), 0);
}

/// A surface and what was done to it, by numbers from a generator.
fn damaged(seed: u64) -> MeshFile {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut file = match (random() * 4.0) as u32 {
        0 => {
            grid(14, 9, [true, true], |u, v| (on_circle(u) * (2.0 + 0.8 * on_circle(v).x)).extend(0.8 * on_circle(v).y))
        }
        1 => grid(12, 12, [true, false], |u, v| on_circle(u).extend(2.0 * v)),
        2 => cube(4),
        _ => grid(12, 10, [false, false], |u, v| DVec3::new(u, v, 0.2 * on_circle(u).y * on_circle(v).y)),
    };
    let noise = [0.0, 0.01, 0.05, 0.15][(random() * 4.0) as usize];
    // Points at one place move together.
    let jolt = |p: DVec3, amount: f64| {
        let part = |x: f64| libm::sin(1e3 * x + 17.0 * (p.x + 2.0 * p.y + 3.0 * p.z));
        p + DVec3::new(part(p.x), part(p.y), part(p.z)) * amount
    };
    file.points.iter_mut().for_each(|p| *p = jolt(*p, noise));
    let many = file.triangles.len() as f64;
    for _ in 0..(random() * 6.0) as u32 {
        let k = (random() * many) as usize % file.triangles.len();
        match (random() * 4.0) as u32 {
            0 => drop(file.triangles.swap_remove(k)),
            1 => file.triangles[k].swap(0, 1),
            2 => file.triangles.push(file.triangles[k]),
            _ => {
                // A tooth on a side, so that it branches.
                let [a, b, _] = file.triangles[k];
                let middle = (file.points[a as usize] + file.points[b as usize]) * 0.5;
                file.points.push(middle + DVec3::new(random(), random(), random()) * 0.4);
                file.triangles.push([a, b, file.points.len() as u32 - 1]);
            }
        }
    }
    file
}

/// `QUADFRONT_SOAK_ROUNDS` sets the number of rounds (`make soak`).
#[test]
fn damaged_surfaces_become_sound_meshes() {
    let rounds = environment::number("QUADFRONT_SOAK_ROUNDS").unwrap_or(12);
    for seed in 0..rounds {
        converted(&format!("seed {seed}"), &damaged(seed), Allow { branching: true, seams: true, ..Allow::default() });
    }
}
