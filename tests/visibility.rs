//! Promise: figures of meshes in space show of faces and lines what a ray from the viewer meets first, and nothing
//! else. The rays are cast here, through all faces, by formulas written apart from those of the figures.
#![allow(clippy::unwrap_used)]

use glam::{DVec2, DVec3};
use quadfront::core::case::built_in;
use quadfront::core::convert::Converter;
use quadfront::core::convert::background;
use quadfront::core::mesh::Names;
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::soup::MeshFile;
use quadfront::render::camera::Bearing;
use quadfront::render::look::{Ink, Layers, Look};
use quadfront::render::orthographic::{Cover, OnFaces, SeenFace};
use quadfront::render::picture::Picture;
use quadfront::render::vector::sheet::{Sheet, page};
use quadfront::render::vector::svg::write;

/// Fills of live triangles and dead quadrilaterals in a figure.
const LIVE: &str = "#FFFFFF";
const DEAD: &str = "#DBE4EC";

struct Random(u64);

impl Random {
    /// A number from 0 to 1.
    fn share(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn place(&mut self) -> DVec3 {
        DVec3::new(self.share(), self.share(), self.share())
    }
}

/// A mesh turned so that the viewer looks along -z: first about z, then about x.
fn turned(mesh: &MeshFile, azimuth: f64, elevation: f64) -> MeshFile {
    let about = |p: DVec2, degrees: f64| {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        DVec2::new(p.x * cos - p.y * sin, p.x * sin + p.y * cos)
    };
    let turn = |p: &DVec3| {
        let level = about(p.truncate(), -azimuth);
        let upright = about(DVec2::new(level.y, p.z), elevation - 90.0);
        DVec3::new(level.x, upright.x, upright.y)
    };
    MeshFile { points: mesh.points.iter().map(turn).collect(), ..mesh.clone() }
}

/// The faces as triangles, each with its number: the quadrilaterals follow the triangles. A quadrilateral is divided
/// along its first diagonal; those of these meshes have no corner that turns inwards.
fn triangles(mesh: &MeshFile) -> Vec<(usize, [DVec3; 3])> {
    let at = |n: u32| mesh.points[n as usize];
    let halves = mesh.quads.iter().enumerate().flat_map(|(k, &[a, b, c, d])| {
        let number = mesh.triangles.len() + k;
        [(number, [a, b, c]), (number, [a, c, d])]
    });
    let whole = mesh.triangles.iter().copied().enumerate();
    whole.chain(halves).map(|(number, corners)| (number, corners.map(at))).collect()
}

/// Where a ray through a place of the picture meets a triangle: its smallest share of a corner, and the nearness there.
fn meets([a, b, c]: [DVec3; 3], p: DVec2) -> Option<(f64, f64)> {
    let (u, v, w) = ((b - a).truncate(), (c - a).truncate(), p - a.truncate());
    let area = u.x * v.y - u.y * v.x;
    if area.abs() < 1e-14 {
        return None;
    }
    let (of_b, of_c) = ((w.x * v.y - w.y * v.x) / area, (u.x * w.y - u.y * w.x) / area);
    let of_a = 1.0 - of_b - of_c;
    Some((of_a.min(of_b).min(of_c), of_a * a.z + of_b * b.z + of_c * c.z))
}

/// The number of the face that a ray meets first.
fn first(faces: &[(usize, [DVec3; 3])], p: DVec2) -> Option<usize> {
    let met = faces.iter().filter_map(|(number, corners)| Some((*number, meets(*corners, p)?)));
    let met = met.filter(|(_, (inside, _))| *inside >= 0.0);
    met.max_by(|a, b| a.1.1.total_cmp(&b.1.1)).map(|(number, _)| number)
}

/// The number of times that an outline goes around a place.
fn turns(outline: &[DVec2], p: DVec2) -> i32 {
    let around = (0..outline.len()).map(|k| (outline[k], outline[(k + 1) % outline.len()]));
    around
        .map(|(a, b)| {
            let left = (b - a).perp_dot(p - a);
            i32::from(a.y <= p.y && b.y > p.y && left > 0.0) - i32::from(a.y > p.y && b.y <= p.y && left < 0.0)
        })
        .sum()
}

/// Checks every face and every line of a mesh, and the SVG of it, at random places. Returns how many places lay on
/// areas that are partly hidden.
fn check(name: &str, mesh: &MeshFile, [azimuth, elevation]: [f64; 2], places: usize) -> usize {
    let seen = turned(mesh, azimuth, elevation);
    let faces = triangles(&seen);
    let at = |n: &u32| seen.points[*n as usize];
    let outlines: Vec<Vec<DVec3>> = seen
        .triangles
        .iter()
        .map(|t| t.iter().map(at).collect())
        .chain(seen.quads.iter().map(|q| q.iter().map(at).collect()))
        .collect();
    let cover = Cover::of(outlines.iter().map(|face| face.iter().copied().collect()));
    let parts: Vec<SeenFace> = (0..outlines.len()).map(|k| cover.seen(k)).collect();
    let shows = |k: usize, p: DVec2| match &parts[k] {
        SeenFace::Whole => turns(&outlines[k].iter().map(|p| p.truncate()).collect::<Vec<_>>(), p) != 0,
        SeenFace::Parts(parts) => parts.iter().map(|part| turns(part, p)).sum::<i32>() != 0,
    };
    let used = || outlines.iter().flatten();
    let low = used().fold(DVec2::INFINITY, |low, p| low.min(p.truncate()));
    let high = used().fold(DVec2::NEG_INFINITY, |high, p| high.max(p.truncate()));
    let size = (high - low).max_element();

    let look = Look {
        layers: Layers::usual(Ink::Colour, false),
        from: Bearing::Angles([azimuth, elevation, 0.0]),
        ..Look::default()
    };
    let sheet = Sheet { width: 502.0, ..Sheet::column("", "", look) };
    let svg = write(&page(&Picture::of_mesh_by(mesh, &look), &sheet));
    // The picture is as wide as the page within a margin of a point.
    let scale = 500.0 / (high - low).x;
    let on_page = |p: DVec2| DVec2::new(1.0 + (p.x - low.x) * scale, 1.0 + (high.y - p.y) * scale);
    let fills: Vec<(String, Vec<Vec<DVec2>>)> = paths(&svg, "fill");
    let strokes: Vec<Vec<DVec2>> = paths(&svg, "stroke").into_iter().flat_map(|(_, lines)| lines).collect();

    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let (mut partly, mut unclear) = (0, 0);
    for _ in 0..places {
        let p = low + (high - low) * DVec2::new(random.share(), random.share());
        let expected = first(&faces, p);
        // At an outline the whole numbers of the figure may decide otherwise: all rays around must agree.
        let step = 1e-5 * size;
        let around =
            [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)];
        if around.iter().any(|(x, y)| first(&faces, p + step * DVec2::new(*x, *y)) != expected) {
            unclear += 1;
            continue;
        }
        let shown: Vec<usize> = (0..outlines.len()).filter(|k| shows(*k, p)).collect();
        assert_eq!(shown, expected.into_iter().collect::<Vec<_>>(), "{name}: face at {p}");
        partly += usize::from(expected.is_some_and(|k| parts[k] != SeenFace::Whole));
        let colour = |k: usize| if k < mesh.triangles.len() { LIVE } else { DEAD };
        let here = on_page(p);
        let on_top = fills.iter().rfind(|(_, outlines)| outlines.iter().map(|o| turns(o, here)).sum::<i32>() != 0);
        let expected = expected.map(colour);
        assert_eq!(on_top.map(|(fill, _)| fill.as_str()), expected, "{name}: fill at {here}");
    }
    assert!(unclear < places / 4, "{name}: {unclear} of {places} places are unclear");

    let (mut visible, mut hidden) = (0, 0);
    for face in &outlines {
        for (k, &a) in face.iter().enumerate() {
            let b = face[(k + 1) % face.len()];
            let t = random.share();
            let p = a.lerp(b, t);
            let others = || faces.iter().filter(|(_, corners)| !(corners.contains(&a) && corners.contains(&b)));
            let met: Vec<(f64, f64)> = others().filter_map(|(_, c)| meets(*c, p.truncate())).collect();
            let is_hidden = met.iter().any(|(inside, nearness)| *inside > 1e-4 && nearness - p.z > 1e-4 * size);
            let is_visible = met.iter().all(|(inside, nearness)| *inside < -1e-4 || nearness - p.z < -1e-4 * size);
            if is_hidden == is_visible {
                continue;
            }
            let parts = cover.parts([a, b], OnFaces::Along);
            let told = parts.iter().find(|([from, to], _)| (*from..=*to).contains(&t)).unwrap().1;
            assert_eq!(told, is_hidden, "{name}: line {a} {b} at {t}: {parts:?}");
            // A line of the same direction goes through the place of the page, or none.
            let (here, along) = (on_page(p.truncate()), on_page(b.truncate()) - on_page(a.truncate()));
            if along.length() < 1.0 {
                continue;
            }
            let is_drawn = strokes.iter().any(|line| {
                let [from, to] = [line[0], line[1]];
                let own = (to - from).perp_dot(along).abs() <= 0.02 * along.length();
                let near = (here - from).perp_dot(along).abs() <= 0.01 * along.length();
                let share = |p: DVec2| (p - from).dot(along);
                own && near
                    && share(here).min(0.0) >= share(to).min(0.0) - 0.01
                    && share(here) <= share(to).max(0.0) + 0.01
            });
            assert!(is_drawn == is_visible || is_hidden && is_drawn && covered(&seen, a, b, p, size), "{name}: {here}");
            visible += usize::from(is_visible);
            hidden += usize::from(is_hidden);
        }
    }
    assert!(visible > 0 && visible + hidden > outlines.len() / 2, "{name}: {visible} visible, {hidden} hidden");
    partly
}

/// Whether a line before this one has the same image: another edge, nearer to the viewer, through the same place.
fn covered(seen: &MeshFile, a: DVec3, b: DVec3, p: DVec3, size: f64) -> bool {
    let sides = triangles(seen).into_iter().flat_map(|(_, [p, q, r])| [[p, q], [q, r], [r, p]]);
    sides.into_iter().any(|[c, d]| {
        let (along, to) = ((d - c).truncate(), (p - c).truncate());
        let t = to.dot(along) / along.length_squared();
        let apart = along.perp_dot(to).abs() / along.length();
        let other = ![a, b].contains(&c) || ![a, b].contains(&d);
        other && (0.0..=1.0).contains(&t) && apart < 1e-4 * size && c.z + t * (d.z - c.z) > p.z
    })
}

/// The paths of an SVG with an attribute other than "none": its value, and the points of their outlines or lines.
fn paths(svg: &str, attribute: &str) -> Vec<(String, Vec<Vec<DVec2>>)> {
    let of = |path: &str, name: &str| {
        Some(path.split_once(&format!(" {name}=\""))?.1.split_once('"')?.0.to_owned()).filter(|value| value != "none")
    };
    let points = |walk: &str| {
        let points = walk.trim_end_matches(['Z', '\n']).split('L');
        let number = |text: &str| text.parse::<f64>().unwrap();
        points.map(|p| p.trim().split_once(' ').unwrap()).map(|(x, y)| DVec2::new(number(x), number(y))).collect()
    };
    let found = svg.split("<path").skip(1).filter_map(|path| Some((of(path, attribute)?, of(path, "d").unwrap())));
    found.map(|(value, data)| (value, data.split('M').skip(1).map(points).collect())).collect()
}

/// The mesh of a built-in case with this many quadrilaterals, or all.
fn converted(name: &str, scale: &str, quads: u64) -> MeshFile {
    let mut case = built_in::named(name).unwrap().unwrap();
    case.parameters.set("size_scale", scale).unwrap();
    let made = background(&case, &mut Nobody).unwrap();
    let mut converter = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
    while *converter.phase() != quadfront::core::convert::Phase::Done && converter.standing() < quads {
        converter.step().unwrap();
    }
    Export::of(&converter.mesh, &Names::default()).file
}

/// A grid of quadrilaterals over the unit square, without those of some columns and rows.
fn grid(n: u32, at: impl Fn(f64, f64) -> DVec3, missing: impl Fn(u32, u32) -> bool) -> MeshFile {
    let share = |k: u32| f64::from(k) / f64::from(n);
    let points = (0..(n + 1) * (n + 1)).map(|k| at(share(k % (n + 1)), share(k / (n + 1)))).collect();
    let squares = (0..n * n).filter(|k| !missing(k % n, k / n)).map(|k| k / n * (n + 1) + k % n);
    let quads = squares.map(|a| [a, a + 1, a + n + 2, a + n + 1]).collect();
    MeshFile { points, quads, ..MeshFile::default() }
}

fn both(mut a: MeshFile, b: MeshFile) -> MeshFile {
    let from = a.points.len() as u32;
    a.points.extend(b.points);
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|n| n + from)));
    a.quads.extend(b.quads.iter().map(|q| q.map(|n| n + from)));
    a
}

#[test]
fn a_tube_through_a_plate_shows_what_the_rays_meet() {
    let mesh = converted("example5", "1", 300);
    for view in [[-60.0, 20.0], [33.0, 27.0]] {
        assert!(check("example 5", &mesh, view, 1500) > 10);
    }
}

#[test]
fn closed_surfaces_show_what_the_rays_meet() {
    let torus = converted("torus", "2", u64::MAX);
    let partly: usize = [[10.0, 15.0], [-130.0, -40.0]].map(|view| check("torus", &torus, view, 1500)).iter().sum();
    assert!(partly > 10, "{partly}");
    check("sphere", &converted("sphere", "2", 40), [33.0, 27.0], 1000);
}

#[test]
fn a_plate_is_seen_through_the_hole_of_another_one() {
    let hole = |i: u32, j: u32| (3..6).contains(&i) && (2..7).contains(&j);
    let front = grid(9, |x, y| DVec3::new(x, 0.0, y), hole);
    let behind = grid(4, |x, y| DVec3::new(1.4 * x - 0.2, 0.3 + 0.2 * y, 1.2 * y - 0.1), |_, _| false);
    assert!(check("hole", &both(front, behind), [12.0, 8.0], 3000) > 100);
    // A face that goes around a hole of what is seen of it.
    let small = grid(1, |x, y| DVec3::new(0.4 + 0.2 * x, -0.5, 0.4 + 0.2 * y), |_, _| false);
    let large = grid(1, |x, y| DVec3::new(x, 0.0, y), |_, _| false);
    assert!(check("island", &both(large, small), [0.0, 0.0], 1000) > 100);
}

#[test]
fn surfaces_that_cross_are_cut_where_they_cross() {
    let level = grid(7, |x, y| DVec3::new(x, y, 0.3 * x * y), |_, _| false);
    let upright = grid(5, |x, y| DVec3::new(0.5 + 0.2 * (x - 0.5), 1.2 * x - 0.1, y - 0.4), |_, _| false);
    for view in [[33.0, 27.0], [-50.0, 60.0], [140.0, -20.0]] {
        assert!(check("crossing", &both(level.clone(), upright.clone()), view, 2000) > 100);
    }
}

#[test]
fn triangles_at_random_through_each_other_show_what_the_rays_meet() {
    for seed in 1..=6 {
        let mut random = Random(seed * 0x1234_5678_9ABC_DEF1);
        let mut mesh = MeshFile::default();
        for k in 0..40 {
            mesh.points.extend([random.place(), random.place(), random.place()]);
            mesh.triangles.push([0, 1, 2].map(|i| 3 * k + i));
        }
        // Some share an edge, and fold over it.
        for k in 0..20 {
            mesh.points.push(random.place());
            mesh.triangles.push([3 * k, 3 * k + 2, 120 + k]);
        }
        assert!(check("random", &mesh, [20.0 * seed as f64, 25.0], 1500) > 100);
    }
}

#[test]
fn ten_thousand_faces_are_drawn_with_the_same_bytes_and_not_many_more_of_them() {
    let bumps = grid(100, |x, y| DVec3::new(x, y, 0.2 * libm::sin(9.0 * x) * libm::cos(7.0 * y)), |_, _| false);
    let look =
        Look { layers: Layers::usual(Ink::Colour, false), from: Bearing::Angles([33.0, 12.0, 0.0]), ..Look::default() };
    let drawn = |mesh: &MeshFile| write(&page(&Picture::of_mesh_by(mesh, &look), &Sheet::column("", "", look)));
    let svg = drawn(&bumps);
    assert!(svg == drawn(&bumps));
    let whole = svg.matches('Z').count();
    assert!((2000..11_000).contains(&whole), "{whole} outlines");
    assert!(svg.len() < 900_000, "{} bytes", svg.len());
}
