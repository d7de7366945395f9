//! Promise: whatever is odd in a mesh, the program either mends it for certain and says so, or refuses it with the
//! elements called as the file counts them, and writes nothing. One row of a table for each oddity, for both uses of a
//! mesh.
#![allow(clippy::unwrap_used)]

use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use glam::DVec3;
use quadfront::core::formats::Format;
use quadfront::core::formats::format::{read_bytes, read_mesh};
use quadfront::core::soup::Allow;
use quadfront::core::soup::soundness::examine;

/// A mesh as an OBJ file says it: points, faces by their points from 0, and lines of text after that.
#[derive(Clone, Default)]
struct Obj {
    points: Vec<[f64; 3]>,
    faces: Vec<Vec<usize>>,
    rest: String,
}

/// What the program is to do with a mesh.
enum Outcome {
    /// It converts; each of these was mended, and nothing else.
    Mended(&'static [&'static str]),
    /// It refuses, with all of these in its one line.
    Refused(&'static [&'static str]),
}
use Outcome::{Mended, Refused};

/// Nothing is odd, or what is odd can be a mesh as it is.
const FINE: Outcome = Mended(&[]);
const ODD: &str = "an all-quad mesh needs an even count. Divide one";
const ORPHAN: &str = "1 unused point was removed";
const SPLIT: &str = "1 node was split where triangles share only a point";
const WELDED: &str = "1 coincident point was merged";
const PARTED: &str = "1 contact point between parts was split";
const CRACK: &str = "1 coincident point was kept as the other side of a crack";
const FLAT: &str = "1 degenerate triangle was removed";
const DOUBLE: &str = "1 duplicate triangle was removed";
const DOUBLES: &str = "8 duplicate triangles were removed";
const CLOCKWISE: &str = "1 clockwise triangle was reversed";
const TURNED: &str = "1 triangle was reversed to match neighbours";
const HUNG: &str = "2 hanging points were joined to the mesh";
const CUT: &str = "1 quadrilateral or polygon was split into triangles";
const CUTS: &str = "4 quadrilaterals and polygons were split into triangles";
const MADE_EVEN: &str = "2 sides of triangles were divided to make counts even";

const FLAT_PLATE: f64 = 0.0;
/// The plate along a parabola: then it lies in space, and goes through charts.
const BENT: f64 = 0.4;

impl Obj {
    /// A plate of `n` by `n` squares of two triangles, bent up.
    fn plate(n: usize, bend: f64) -> Obj {
        let at = |k: usize| k as f64 / n as f64;
        let mut obj = Obj::default();
        for k in 0..(n + 1) * (n + 1) {
            let x = at(k % (n + 1));
            obj.points.push([x, at(k / (n + 1)), bend * x * x]);
        }
        for k in 0..n * n {
            let a = k % n + k / n * (n + 1);
            obj.faces.extend([vec![a, a + 1, a + n + 2], vec![a, a + n + 2, a + n + 1]]);
        }
        obj
    }

    /// A cube of side 2.
    fn cube() -> Obj {
        let mut obj = Obj::default();
        obj.points.extend((0..8).map(|k| [k & 1, k >> 1 & 1, k >> 2].map(|x| 2.0 * x as f64)));
        for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            obj.faces.extend([vec![a, b, c], vec![a, c, d]]);
        }
        obj
    }

    /// A strip with half a twist.
    fn moebius() -> Obj {
        let (n, mut obj) = (16, Obj::default());
        for k in 0..3 * n {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * (k / 3) as f64 / n as f64);
            let (half_sin, half_cos) = libm::sincos(std::f64::consts::PI * (k / 3) as f64 / n as f64);
            let s = 0.3 * ((k % 3) as f64 - 1.0);
            obj.points.push([(1.0 + s * half_cos) * cos, (1.0 + s * half_cos) * sin, s * half_sin]);
        }
        let at = |i: usize, j: usize| if i < n { 3 * i + j } else { 2 - j };
        for (i, j) in (0..2 * n).map(|k| (k / 2, k % 2)) {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            obj.faces.extend([vec![a, b, c], vec![a, c, d]]);
        }
        obj
    }

    fn of(points: &[[f64; 3]], faces: &[&[usize]]) -> Obj {
        let faces = faces.iter().map(|face| face.to_vec()).collect();
        Obj { points: points.to_vec(), faces, rest: String::new() }
    }

    /// With another mesh beside it, without a common point.
    fn and(mut self, other: Obj, by: [f64; 3]) -> Obj {
        let n = self.points.len();
        self.points.extend(other.points.iter().map(|p| [0, 1, 2].map(|k| p[k] + by[k])));
        self.faces.extend(other.faces.iter().map(|face| face.iter().map(|k| k + n).collect()));
        self
    }

    fn point(mut self, p: [f64; 3]) -> Obj {
        self.points.push(p);
        self
    }

    fn face(mut self, face: &[usize]) -> Obj {
        self.faces.push(face.to_vec());
        self
    }

    /// Without these faces.
    fn without(mut self, faces: &[usize]) -> Obj {
        let mut k = 0..;
        self.faces.retain(|_| k.next().is_none_or(|k| !faces.contains(&k)));
        self
    }

    /// With faces turned over.
    fn turned(mut self, faces: &[usize]) -> Obj {
        faces.iter().for_each(|&face| self.faces[face].swap(1, 2));
        self
    }

    /// With all faces turned over.
    fn inside_out(mut self) -> Obj {
        self.faces.iter_mut().for_each(|face| face.reverse());
        self
    }

    /// Every point somewhere else.
    fn moved(mut self, to: impl Fn([f64; 3]) -> [f64; 3]) -> Obj {
        self.points.iter_mut().for_each(|p| *p = to(*p));
        self
    }

    /// Triangle 1 with a point of its own in the middle of its long side, and a triangle that closes the gap, `high`
    /// where it is open.
    fn gap_closed(mut self, high: f64) -> Obj {
        let [a, b, c] = [0, 1, 2].map(|k| self.faces[0][k]);
        let middle = [0, 1, 2].map(|k| 0.5 * (self.points[a][k] + self.points[c][k]));
        let n = self.points.len();
        self.faces[0] = vec![a, b, n];
        self.point([middle[0] + high, middle[1] - high, middle[2]]).face(&[b, c, n]).face(&[a, n, c])
    }

    fn text(&self) -> String {
        let mut text = String::from("# odd\n");
        for [x, y, z] in &self.points {
            writeln!(text, "v {x:e} {y:e} {z:e}").unwrap();
        }
        for face in &self.faces {
            let numbers: Vec<String> = face.iter().map(|k| (k + 1).to_string()).collect();
            writeln!(text, "f {}", numbers.join(" ")).unwrap();
        }
        text + &self.rest
    }
}

/// Converts a mesh for one use, and holds the outcome against what is expected.
fn holds(name: &str, obj: &Obj, used: &str, expected: &Outcome) {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("odd.obj", &obj.text());
    let begin = Instant::now();
    let output = Command::new(env!("CARGO_BIN_EXE_quadfront"))
        .args(["convert", "odd.obj", "--use", used, "-o", "quads.msh", "--report", "report.json"])
        .current_dir(folder.path())
        .stdin(Stdio::null())
        .output()
        .unwrap();
    assert!(begin.elapsed().as_secs() < 20, "{name}, {used}: it hangs");
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (code, summary, complaint) = (output.status.code(), said(&output.stdout), said(&output.stderr));
    let case = format!("{name}, {used}: {code:?}\n{summary}{complaint}");
    let is_there = |name: &str| folder.path().join(name).exists();
    match expected {
        Refused(parts) => {
            assert_eq!(code, Some(2), "{case}");
            assert!(complaint.starts_with("error: odd.obj") && complaint.lines().count() == 1, "{case}");
            assert!(parts.iter().all(|part| complaint.contains(part)), "{parts:?} is not in {case}");
            assert!(complaint.len() < 400 && !complaint.contains("000000000"), "{case}");
            assert!(!is_there("quads.msh") && !is_there("report.json") && summary.is_empty(), "{case}");
        }
        Mended(repairs) => {
            assert_eq!((code, complaint.as_str()), (Some(0), ""), "{case}");
            let report: serde_json::Value =
                serde_json::from_slice(&std::fs::read(folder.path().join("report.json")).unwrap()).unwrap();
            assert_eq!(report["repairs"], serde_json::json!(repairs), "{case}");
            for repair in *repairs {
                assert!(
                    summary.lines().any(|l| l.trim_start().starts_with("repaired") && l.contains(repair)),
                    "{case}"
                );
            }
            check(&case, folder.path(), obj);
        }
    }
}

/// The mesh that was written is sound in all that the one that was read could be, and of quadrilaterals.
fn check(case: &str, folder: &Path, obj: &Obj) {
    let bytes = std::fs::read(folder.join("quads.msh")).unwrap();
    let mesh = read_bytes("quads.msh", &bytes, Format::Msh).unwrap();
    let mut sides: Vec<[usize; 2]> = Vec::new();
    for face in &obj.faces {
        let ends = (0..face.len()).map(|k| [face[k], face[(k + 1) % face.len()]]);
        sides.extend(ends.map(|[a, b]| [a.min(b), a.max(b)]));
    }
    sides.sort_unstable();
    let branching = sides.chunk_by(|a, b| a == b).any(|side| side.len() > 2);
    examine(&mesh)
        .verdict(Allow { triangles: false, seams: true, branching })
        .unwrap_or_else(|e| panic!("{e}\n{case}"));
    assert!(!mesh.quads.is_empty() && mesh.points.iter().all(|p| p.is_finite()), "{case}");
}

/// What is odd, the mesh, and what becomes of its triangles and of its shape.
type Row = (&'static str, Obj, Outcome, Outcome);

fn hold(rows: Vec<Row>) {
    for (name, obj, triangles, shape) in rows {
        holds(name, &obj, "triangles", &triangles);
        holds(name, &obj, "shape", &shape);
    }
}

/// What holds for a plate in the plane and for one in space, however it is used.
fn hold_for_all(name: &str, of: impl Fn(Obj) -> Obj, expected: &Outcome) {
    for bend in [FLAT_PLATE, BENT] {
        for used in ["triangles", "shape"] {
            holds(name, &of(Obj::plate(2, bend)), used, expected);
        }
    }
}

#[test]
fn boundaries_holes_and_components() {
    let hole = |bend: f64, faces: &[usize]| Obj::plate(5, bend).without(faces);
    let apart = |a: Obj, b: Obj| a.and(b, [5.0, 0.0, 0.0]);
    // The first point of the second plate has the place of the last one of the first.
    let touching = |bend: f64| Obj::plate(2, bend).and(Obj::plate(2, bend), [1.0, 1.0, bend]);
    let in_one_point = |mut obj: Obj| {
        obj.faces.iter_mut().flatten().filter(|k| **k == 9).for_each(|k| *k = 8);
        obj.points[9] = [9.0; 3];
        obj
    };
    let pinched = || Mended(&[ORPHAN, SPLIT]);
    let cubes = Obj::cube().and(Obj::cube(), [2.0; 3]);
    let three = &["loop of 3 segments", "at (0.6, 0.4)", "49 triangles", ODD, "--split-odd"];
    let three_in_space = &["at (0.6, 0.4, 0.144)", "49 triangles", ODD, "--split-odd"];
    let [flat, bent] = [FLAT_PLATE, BENT].map(|bend| apart(Obj::plate(2, bend), Obj::plate(3, bend)));
    let odd = |bend| apart(Obj::plate(2, bend), Obj::plate(3, bend).without(&[17]));
    hold(vec![
        ("plates with one point in common", in_one_point(touching(FLAT_PLATE)), pinched(), pinched()),
        ("the same in space", in_one_point(touching(BENT)), pinched(), pinched()),
        ("plates with points at one place", touching(FLAT_PLATE), Mended(&[CRACK]), Mended(&[WELDED, SPLIT])),
        ("the same in space", touching(BENT), Mended(&[WELDED, SPLIT]), Mended(&[WELDED, SPLIT])),
        ("cubes that touch in a corner", cubes, Mended(&[WELDED, PARTED]), Mended(&[WELDED, PARTED])),
        ("a hole of three sides", hole(FLAT_PLATE, &[24]), Refused(three), FINE),
        ("the same in space", hole(BENT, &[24]), Refused(three_in_space), FINE),
        ("two holes of three sides that touch", hole(FLAT_PLATE, &[12, 24]), Mended(&[SPLIT]), Mended(&[SPLIT])),
        ("the same in space", hole(BENT, &[12, 24]), Mended(&[SPLIT]), Mended(&[SPLIT])),
        ("two plates", flat, FINE, FINE),
        ("two plates in space", bent, FINE, FINE),
        ("two plates, one of them odd", odd(FLAT_PLATE), Refused(&["at (5, 0)", "17 triangles", ODD]), FINE),
        ("the same in space", odd(BENT), Refused(&["at (5, 0, 0)", "17 triangles", ODD]), FINE),
        ("two cubes", apart(Obj::cube(), Obj::cube()), FINE, FINE),
        ("a cube and a plate", apart(Obj::cube(), Obj::plate(3, BENT)), FINE, FINE),
    ]);
}

#[test]
fn edges_of_three_faces_turned_and_double_triangles() {
    let fin =
        |p: [f64; 3]| Obj::plate(2, FLAT_PLATE).point(p).face(&[1, 4, 9]).point([0.5, -0.5, 0.4]).face(&[1, 9, 10]);
    let flat_fin = || Obj::plate(2, FLAT_PLATE).point([0.75, 0.2, 0.0]).face(&[1, 4, 9]);
    let shared =
        &["at the edge from (0.5, 0) to (0.5, 0.5)", "Triangles 1, 4 and 9 share one edge", "Remove the surplus"];
    let side_by_side = |bend: f64| {
        let other = Obj::plate(3, bend).inside_out();
        Obj::plate(2, bend).and(other, [3.0, 0.0, 0.0])
    };
    let one_side = || Refused(&["is one-sided, like a Moebius strip", "triangles 2, 4, 61 and 63", "Cut a gap"]);
    let back = |obj: Obj| {
        (0..8).fold(obj, |obj, k| {
            let [a, b, c] = [0, 1, 2].map(|corner| obj.faces[k][corner]);
            obj.face(&[b, a, c])
        })
    };
    hold(vec![
        ("a fin on a plate", fin([0.5, 0.0, 0.5]), FINE, FINE),
        ("a fin in the plane", flat_fin(), Refused(shared), Refused(&["Triangles 3, 4 and 9 overlap", "Remove"])),
        (
            "one of two plates is turned",
            side_by_side(FLAT_PLATE),
            Mended(&["18 clockwise triangles were reversed"]),
            Mended(&["18 clockwise triangles were reversed"]),
        ),
        ("the same in space", side_by_side(BENT), FINE, FINE),
        ("a cube inside out", Obj::cube().inside_out(), FINE, FINE),
        ("one triangle is turned", Obj::plate(3, FLAT_PLATE).turned(&[7]), Mended(&[CLOCKWISE]), Mended(&[CLOCKWISE])),
        ("the same in space", Obj::plate(3, BENT).turned(&[7]), Mended(&[TURNED]), Mended(&[TURNED])),
        ("a Moebius strip", Obj::moebius(), one_side(), one_side()),
    ]);
    hold_for_all("a triangle twice", |obj| obj.face(&[4, 1, 5]), &Mended(&[DOUBLE]));
    hold_for_all("a triangle with its back", |obj| obj.face(&[5, 1, 4]), &Mended(&[DOUBLE]));
    hold_for_all("all triangles with their backs", back, &Mended(&[DOUBLES]));
}

#[test]
fn triangles_without_area_and_slivers() {
    hold_for_all("a corner twice", |obj| obj.face(&[1, 1, 5]), &Mended(&[FLAT]));
    hold_for_all("three points on a line", |obj| obj.gap_closed(0.0), &Mended(&[FLAT]));
    hold_for_all("a sliver", |obj| obj.gap_closed(1e-9), &Mended(&[FLAT]));
    hold_for_all("a narrow triangle", |obj| obj.gap_closed(1e-4), &FINE);
    let line = |k: f64| [3.0 + k, 3.0 + k, 0.0];
    hold_for_all(
        "three points on a line by themselves",
        |obj| obj.point(line(0.0)).point(line(1.0)).point(line(2.0)).face(&[9, 10, 11]),
        &Mended(&[FLAT]),
    );
    let on_border = |obj: Obj| {
        let z = 0.5 * obj.points[1][2];
        obj.point([0.25, 0.0, z]).face(&[0, 9, 1])
    };
    hold_for_all("three points on the border", on_border, &Mended(&[FLAT]));
    let crack = |bend: f64| Obj::plate(2, bend).point([0.5, 0.5, 0.25 * bend]).face(&[0, 4, 9]).face(&[4, 8, 9]);
    let between = &["Triangles 9 and 10 are too flat: the first is without area", "Repair the mesh there"];
    let in_line =
        |z: f64| Obj::plate(2, FLAT_PLATE).moved(|[x, y, _]| [x + 4.0 * y, 2.0 * (x + 4.0 * y), z * (x + 4.0 * y)]);
    let none = || Refused(&["No triangle of the mesh has an area", "Export it with more digits"]);
    let one_place = || Refused(&["All points of the mesh are at (1, 2, 3)"]);
    hold(vec![
        (
            "flat triangles in a crack",
            crack(FLAT_PLATE),
            Refused(between),
            Mended(&[WELDED, "2 degenerate triangles were removed"]),
        ),
        ("all points on a line", in_line(0.0), none(), none()),
        ("the same in space", in_line(3.0), none(), none()),
        ("all points at one place", Obj::plate(2, BENT).moved(|_| [1.0, 2.0, 3.0]), one_place(), one_place()),
    ]);
}

#[test]
fn points_that_are_not_there_or_nowhere_and_meshes_of_nothing() {
    hold_for_all("a point by itself", |obj| obj.point([9.0; 3]), &Mended(&[ORPHAN]));
    hold_for_all("a corner that is not there", |obj| obj.face(&[0, 1, 98]), &Refused(&["line 19", "vertex 99 of 9"]));
    let zero = |mut obj: Obj| {
        obj.rest = "f 1 2 0\n".to_owned();
        obj
    };
    hold_for_all("a corner 0", zero, &Refused(&["line 19", "A face or line refers to vertex 0 of 9"]));
    let at = |x: f64| {
        move |mut obj: Obj| {
            obj.points[4][0] = x;
            obj
        }
    };
    hold_for_all("no number", at(f64::NAN), &Refused(&["line 6", "Expected a coordinate, found \"NaN\""]));
    hold_for_all(
        "an infinite number",
        at(f64::INFINITY),
        &Refused(&["line 6", "Expected a coordinate, found \"inf\""]),
    );
    hold_for_all("a huge number", at(1e200), &Refused(&["Point 5 is at (1e200, 0.5, ", "no larger than 1e30"]));
    let nothing = |text: &str| Obj { rest: text.to_owned(), ..Obj::default() };
    let points = Obj { faces: Vec::new(), ..Obj::plate(1, FLAT_PLATE) };
    let lines = Obj { rest: "l 1 2 3\n".to_owned(), ..points.clone() };
    let says = |parts| [Refused(parts), Refused(parts)];
    for (name, obj, parts) in [
        ("nothing", nothing(""), &["The mesh has no triangles. Give a mesh of triangles"][..]),
        ("points alone", points, &["no triangles, only 4 points"]),
        ("lines alone", lines, &["no triangles, only 2 lines and 4 points"]),
    ] {
        let [triangles, shape] = says(parts);
        hold(vec![(name, obj, triangles, shape)]);
    }
}

#[test]
fn quadrilaterals_and_polygons() {
    let up = |bend: f64, points: &[[f64; 2]]| -> Vec<[f64; 3]> {
        points.iter().map(|&[x, y]| [x, y, bend * x * x]).collect()
    };
    let quads = |bend: f64| {
        let squares: [&[usize]; 4] = [&[0, 1, 4, 3], &[1, 2, 5, 4], &[3, 4, 7, 6], &[4, 5, 8, 7]];
        Obj::of(&Obj::plate(2, bend).points, &squares)
    };
    let mixed = |bend: f64| quads(bend).without(&[3]).face(&[4, 5, 8]).face(&[4, 8, 7]);
    let three = || Mended(&["3 quadrilaterals and polygons were split into triangles"]);
    // A pentagon with a dent, a triangle in that, and others beside it.
    let dented = |bend: f64| {
        let points = up(bend, &[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 1.0], [0.0, 2.0], [3.0, 1.0]]);
        Obj::of(&points, &[&[0, 1, 2, 3, 4], &[2, 4, 3], &[1, 5, 2]]).face(&[4, 2, 6]).point([1.0, 3.0, bend])
    };
    let saddle = Obj::of(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.0, 1.0, 0.0]], &[&[0, 1, 2, 3]]);
    let corner_twice = Obj::plate(2, BENT).without(&[7]).face(&[4, 8, 7, 7]);
    // Over the cross: a square whose corners are told in the wrong order, beside one that is right.
    let crossing = |z: f64| {
        let points = [[0.0; 3], [1.0, 1.0, z], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0]];
        Obj::of(&points, &[&[2, 4, 1], &[4, 5, 1], &[0, 1, 2, 3]])
    };
    let crosses = || Refused(&["at (0, 0, 0)", "Element 3 crosses itself", "in order around it"]);
    let already = Refused(&["already quadrilateral: all of its 4", "--use shape"]);
    hold(vec![
        ("quadrilaterals alone", quads(FLAT_PLATE), already, Mended(&[CUTS])),
        ("the same in space", quads(BENT), Mended(&[CUTS]), Mended(&[CUTS])),
        ("quadrilaterals and triangles", mixed(FLAT_PLATE), three(), three()),
        ("the same in space", mixed(BENT), three(), three()),
        ("a polygon with a dent", dented(FLAT_PLATE), Mended(&[CUT]), Mended(&[CUT])),
        ("the same in space", dented(BENT), Mended(&[CUT]), Mended(&[CUT])),
        (
            "a quadrilateral out of its plane",
            saddle,
            Mended(&[CUT, "1 side of a triangle was divided to make counts even"]),
            Mended(&[CUT]),
        ),
        ("a quadrilateral with a corner twice", corner_twice, Mended(&[CUT, FLAT]), Mended(&[CUT, FLAT])),
        ("a quadrilateral across itself", crossing(0.0), crosses(), crosses()),
        ("the same in space", crossing(0.1), crosses(), crosses()),
    ]);
}

#[test]
fn t_junctions_and_sheets_across_each_other() {
    // A plate with a square on the left and one on the right, in whose sides the middles of its own hang.
    let hanging = |bend: f64| {
        let at = |x: f64, y: f64| [x, y, bend * x * x];
        let plate =
            Obj::plate(2, bend).point(at(2.0, 0.0)).point(at(2.0, 1.0)).point(at(-1.0, 0.0)).point(at(-1.0, 1.0));
        plate.face(&[2, 9, 10]).face(&[2, 10, 8]).face(&[11, 0, 6]).face(&[11, 6, 12])
    };
    // The same square on the right, with points of its own at all its corners.
    let beside = |bend: f64| {
        let at = |x: f64, y: f64| [x, y, bend * x * x];
        let square = Obj::of(&[at(1.0, 0.0), at(2.0, 0.0), at(2.0, 1.0), at(1.0, 1.0)], &[&[0, 1, 2], &[0, 2, 3]]);
        Obj::plate(2, bend).and(square, [0.0; 3])
    };
    let hangs = Refused(&["at (1, 0.5)", "Point 6 hangs on a side", "--use shape"]);
    let welded = || Mended(&["2 coincident points were merged", "1 hanging point was joined to the mesh"]);
    let across =
        Obj::plate(3, FLAT_PLATE).and(Obj::plate(3, FLAT_PLATE).moved(|[x, y, _]| [x, 0.51, y - 0.497]), [0.0; 3]);
    let over = Obj::plate(3, FLAT_PLATE).and(Obj::plate(3, FLAT_PLATE), [0.9, 0.2, 0.0]);
    let overlap = || Refused(&["Triangles 5, 6, 11, 12, 17 and 7 more overlap", "Remove the overlap"]);
    let mut folded = [FLAT_PLATE, BENT].map(|bend| Obj::plate(3, bend));
    folded.iter_mut().for_each(|obj| obj.points[5][..2].copy_from_slice(&[0.9, 0.9]));
    let [folded, folded_in_space] = folded;
    hold(vec![
        ("points in sides", hanging(FLAT_PLATE), Mended(&[HUNG]), Mended(&[HUNG])),
        ("the same in space", hanging(BENT), Mended(&[HUNG]), Mended(&[HUNG])),
        ("a point in a side of another part", beside(FLAT_PLATE), hangs, welded()),
        ("the same in space", beside(BENT), Refused(&["11 triangles", ODD]), welded()),
        ("sheets across each other", across, FINE, FINE),
        ("sheets over each other in the plane", over, overlap(), overlap()),
        (
            "a fold in the plane",
            folded,
            Refused(&["Triangles 4 and 9 overlap"]),
            Refused(&["Triangles 1, 2, 4, 7, 9 and 5 more overlap"]),
        ),
        ("a fold in space", folded_in_space, Mended(&[MADE_EVEN]), FINE),
    ]);
}

#[test]
fn units_and_places_far_and_near_and_meshes_of_one_triangle() {
    let scaled = |bend: f64, by: f64| Obj::plate(3, bend).moved(|p| p.map(|x| by * x));
    for bend in [FLAT_PLATE, BENT] {
        for by in [1e-12, 1e12] {
            hold(vec![("another unit", scaled(bend, by), FINE, FINE)]);
        }
        let small = || Refused(&["The mesh is only 1e-40 across", "another unit"]);
        let large = || Refused(&["Points 2, 3, 4, 5, 6 and 10 more", "no larger than 1e30"]);
        hold(vec![
            ("too small a unit", scaled(bend, 1e-40), small(), small()),
            ("too large a unit", scaled(bend, 1e40), large(), large()),
        ]);
    }
    let away = |bend: f64, by: f64| Obj::plate(3, bend).moved(|[x, y, z]| [x + by, y + by, z]);
    let far = || Refused(&["1 across and 1e9 from the origin", "Move it to the origin"]);
    let triangle = |z: f64| Obj::of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, z]], &[&[0, 1, 2]]);
    let single = || Refused(&["1 triangle", ODD, "--split-odd"]);
    let tetrahedron = Obj::of(
        &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]],
    );
    hold(vec![
        ("away from the origin", away(FLAT_PLATE, 1e6), FINE, FINE),
        ("the same in space", away(BENT, 1e6), FINE, FINE),
        ("far from the origin", away(FLAT_PLATE, 1e9), FINE, far()),
        ("the same in space", away(BENT, 1e9), far(), far()),
        ("one triangle", triangle(0.0), single(), FINE),
        ("one triangle in space", triangle(1.0), single(), FINE),
        ("four triangles", tetrahedron, Mended(&[MADE_EVEN]), FINE),
    ]);
}

#[test]
fn elements_are_called_as_each_format_counts_them() {
    let folder = tempfile::tempdir().unwrap();
    // Three triangles on an edge, in formats that count from elsewhere.
    let points = ["0 0 0", "1 0 0", "0 1 0", "0 -1 0", "0.5 0.2 0"];
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\nproperty double z\n\
         element face 3\nproperty list uchar int vertex_indices\nend_header\n{}\n3 0 1 2\n3 1 0 3\n3 0 1 4\n",
        points.join("\n")
    );
    let nodes: Vec<String> = points.iter().zip([7, 8, 9, 30, 31]).map(|(p, n)| format!("{n} {p}")).collect();
    let msh = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n{}\n$EndNodes\n$Elements\n4\n1 1 2 0 1 7 8\n\
         12 2 2 0 1 7 8 9\n13 2 2 0 1 8 7 30\n40 2 2 0 1 7 8 31\n$EndElements\n",
        nodes.join("\n")
    );
    for (name, text, says) in [
        ("a.ply", ply, "a.ply, at the edge from (0, 0) to (1, 0): Triangles 1, 2 and 3 share one edge"),
        ("a.msh", msh, "a.msh, at the edge from (0, 0) to (1, 0): Triangles 12, 13 and 40 share one edge"),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_quadfront"))
            .args(["convert", name, "-o", "quads.obj"])
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && complaint.contains(says), "{complaint}");
    }
}

#[test]
fn files_as_people_have_them_convert_and_what_is_not_read_of_them_is_told() {
    let middles = "*NODE\n1, 0, 0\n2, 2, 0\n3, 2, 2\n4, 0, 2\n5, 1, 0\n6, 2, 1\n7, 1, 1\n8, 1, 2\n9, 0, 1\n\
                   *ELEMENT, TYPE=CPE6\n1, 1, 2, 3, 5, 6, 7\n2, 1, 3, 4, 7, 8, 9\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("middles.inp"), middles).unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    for (name, told) in [
        ("o_cont.obj", &[][..]),
        ("o_comment.obj", &[]),
        ("o_cr.obj", &[]),
        ("p_cr.ply", &[]),
        ("p_blankline.ply", &["not read: vertex property nx, ny and nz"]),
        ("f_trailing.stl", &["not read: 37 bytes after the last triangle"]),
        ("i_cont.inp", &[]),
        ("middles.inp", &["not read: mid-side node of an element of higher order (5 times)"]),
    ] {
        let path = if data.join(name).exists() { data.join(name) } else { folder.path().join(name) };
        let output = Command::new(env!("CARGO_BIN_EXE_quadfront"))
            .arg("convert")
            .arg(path)
            .args(["-o", "quads.msh", "--report", "report.json"])
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(0), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let report = std::fs::read(folder.path().join("report.json")).unwrap();
        let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
        assert_eq!(report["repairs"], serde_json::json!(told), "{name}");
        check(name, folder.path(), &Obj::default());
    }
}

/// Runs the program on a file of `tests/data`; returns what the report says of it.
fn reported(folder: &Path, name: &str, options: &[&str]) -> serde_json::Value {
    let output = Command::new(env!("CARGO_BIN_EXE_quadfront"))
        .arg("convert")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name))
        .args(["-o", "quads.msh", "--report", "report.json"])
        .args(options)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    check(name, folder, &Obj::default());
    serde_json::from_slice(&std::fs::read(folder.join("report.json")).unwrap()).unwrap()
}

#[test]
fn points_that_are_doubled_with_noise_are_joined_unless_they_are_to_be_kept_apart() {
    let folder = tempfile::tempdir().unwrap();
    // A grid of 12 x 12 squares of two triangles each, with corners of their own: 864, of which 169 places remain.
    for (name, told) in [
        ("o_dup_1e-05.obj", "695 points were joined to others, at most 2.78202e-5 away"),
        ("o_noisy_dup.obj", "695 points were joined to others, at most 8.94986e-8 away"),
    ] {
        for options in [&[][..], &["--weld", "auto"], &["--weld=0.0001"]] {
            let report = reported(folder.path(), name, options);
            assert_eq!(report["repairs"], serde_json::json!([told]), "{name} {options:?}");
            let quads = read_mesh(&folder.path().join("quads.msh"), None).unwrap();
            let sides = quads.quads.iter().flat_map(|q| (0..4).map(|k| [q[k], q[(k + 1) % 4]]));
            let mut parts: Vec<u32> = (0..quads.points.len() as u32).collect();
            let sides: Vec<[u32; 2]> = sides.collect();
            // Labels spread until nothing changes.
            while sides.iter().fold(false, |changed, &[a, b]| {
                let least = parts[a as usize].min(parts[b as usize]);
                let change = parts[a as usize] != parts[b as usize];
                (parts[a as usize], parts[b as usize]) = (least, least);
                changed || change
            }) {}
            assert!(parts.iter().all(|&part| part == 0), "{name} {options:?}: one piece");
        }
    }
    let report = reported(folder.path(), "o_dup_1e-05.obj", &["--weld", "0"]);
    let given =
        read_mesh(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/o_dup_1e-05.obj"), None).unwrap().points;
    let is_near = |p: &&DVec3| given.iter().filter(|q| q.distance(**p) < 1e-3).count() > 1;
    let told = format!("{} border points lie on or near elements", given.iter().filter(is_near).count());
    let repairs = report["repairs"].as_array().unwrap();
    assert!(repairs.len() == 1 && repairs[0].as_str().unwrap().starts_with(&told), "{repairs:?} and {told}");
}

#[test]
fn a_plate_that_stands_on_another_with_other_nodes_is_told_with_its_places() {
    let folder = tempfile::tempdir().unwrap();
    let report = reported(folder.path(), "t_junction_nonconf.obj", &[]);
    let repairs: Vec<&str> = report["repairs"].as_array().unwrap().iter().filter_map(|told| told.as_str()).collect();
    let told = "6 border points lie on or near elements without being joined to them (nearest 0 away): (0, 0.333333, 0), \
                (0, 0.666667, 0), (0, 1.33333, 0), ...";
    assert!(repairs.contains(&told), "{repairs:?}");
}
