//! Symmetric domains, made here: plates, disks, gears, annuli and others, with the line in which each is symmetric.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::Path;

use quadfront::core::case::Case;

/// A case, and what is known of it.
pub struct Domain {
    pub name: &'static str,
    /// The axis of `symmetry`.
    pub axis: char,
    /// Twice the coordinate of the mirror line.
    pub sum: f64,
    /// Curves, faces and metric.
    pub text: String,
}

impl Domain {
    /// The case, with the lines before its tables.
    pub fn case(&self, head: &str) -> Case {
        let text = format!("version = 1\n{head}\n{}", self.text);
        Case::parse(&text, self.name, self.name, Path::new("")).unwrap()
    }

    pub fn symmetric(&self) -> Case {
        self.case(&format!("symmetry = \"{}\"", self.axis))
    }
}

pub fn polygon(name: &str, points: &[[f64; 2]]) -> String {
    format!("[[curve]]\nname = \"{name}\"\nkind = \"polyline\"\npoints = {points:?}\nclosed = true\n")
}

pub fn line(name: &str, points: &[[f64; 2]]) -> String {
    format!("[[curve]]\nname = \"{name}\"\nkind = \"polyline\"\npoints = {points:?}\n")
}

/// A circle that begins at an angle in degrees.
pub fn circle(name: &str, [x, y]: [f64; 2], radius: f64, start: f64) -> String {
    format!(
        "[[curve]]\nname = \"{name}\"\nkind = \"circle\"\ncentre = [{x}, {y}]\nradius = {radius}\n\
         start_angle = {start}\n"
    )
}

fn arc(name: &str, [x, y]: [f64; 2], radius: f64, [from, to]: [f64; 2]) -> String {
    format!(
        "[[curve]]\nname = \"{name}\"\nkind = \"arc\"\ncentre = [{x}, {y}]\nradius = {radius}\nfrom_angle = {from}\n\
         to_angle = {to}\n"
    )
}

pub fn face(name: &str, outer: &[&str], holes: &[&str], more: &str) -> String {
    let holes: Vec<[&str; 1]> = holes.iter().map(|hole| [*hole]).collect();
    format!("[[face]]\nname = \"{name}\"\nouter = {outer:?}\nholes = {holes:?}\n{more}\n")
}

pub fn uniform(h: f64) -> String {
    format!("[[metric]]\nkind = \"uniform\"\nh = {h}\n")
}

pub fn rectangle([x, y]: [f64; 2], [width, height]: [f64; 2]) -> [[f64; 2]; 4] {
    [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]
}

/// The corners of a gear with its first tooth at an angle.
fn gear(teeth: u32, first: f64) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for k in 0..teeth {
        for (radius, part) in [(0.8, -0.3), (1.0, -0.15), (1.0, 0.15), (0.8, 0.3)] {
            let (sin, cos) = libm::sincos(first + TAU * (f64::from(k) + part) / f64::from(teeth));
            points.push([radius * cos, radius * sin]);
        }
    }
    points
}

/// A closed cubic spline without clamped ends: a blob that is symmetric in y.
fn blob() -> String {
    let half = [[1.2, 0.0], [1.0, 0.8], [0.1, 0.6], [-0.6, 1.0], [-1.3, 0.4]];
    let lower = half[1..].iter().rev().map(|&[x, y]| [x, -y]);
    let ring: Vec<[f64; 2]> = half.iter().copied().chain(lower).collect();
    let points: Vec<[f64; 2]> = ring.iter().chain(&ring[..3]).copied().collect();
    let knots: Vec<f64> = (0..points.len() + 4).map(|k| k as f64).collect();
    format!("[[curve]]\nname = \"blob\"\nkind = \"nurbs\"\ndegree = 3\nknots = {knots:?}\npoints = {points:?}\n")
}

/// All of them.
pub fn all() -> Vec<Domain> {
    let square = || polygon("frame", &rectangle([0.0, 0.0], [1.0, 1.0]));
    let mut domains = Vec::new();
    let mut add = |name: &'static str, axis: char, sum: f64, parts: &[String]| {
        let mut text = String::new();
        parts.iter().for_each(|part| write!(text, "{part}").unwrap());
        domains.push(Domain { name, axis, sum, text });
    };
    let hole = || circle("hole", [0.5, 0.5], 0.2, 0.0);
    add("plate with a hole, x", 'x', 1.0, &[square(), hole(), face("f", &["frame"], &["hole"], ""), uniform(0.05)]);
    add("plate with a hole, y", 'y', 1.0, &[square(), hole(), face("f", &["frame"], &["hole"], ""), uniform(0.043)]);
    add(
        "plate with two holes",
        'x',
        1.4,
        &[
            polygon("frame", &rectangle([-0.3, 0.1], [2.0, 1.0])),
            circle("left", [0.2, 0.6], 0.25, 10.0),
            circle("right", [1.2, 0.6], 0.25, 77.0),
            face("f", &["frame"], &["left", "right"], ""),
            uniform(0.06),
        ],
    );
    add(
        "plate with three holes",
        'x',
        0.3,
        &[
            polygon("frame", &rectangle([0.0, 0.0], [0.3, 0.2])),
            circle("left", [0.07, 0.1], 0.03, 0.0),
            polygon("middle", &rectangle([0.12, 0.05], [0.06, 0.08])),
            circle("right", [0.23, 0.1], 0.03, 0.0),
            face("f", &["frame"], &["left", "middle", "right"], ""),
            uniform(0.01),
        ],
    );
    add("disk", 'x', 0.0, &[circle("rim", [0.0, 0.0], 1.0, 0.0), face("f", &["rim"], &[], ""), uniform(0.1)]);
    add(
        "disk elsewhere",
        'y',
        0.6,
        &[circle("rim", [7.1, 0.3], 2.0, 33.0), face("f", &["rim"], &[], ""), uniform(0.21)],
    );
    let ring = |start| [circle("rim", [0.5, 0.0], 1.0, start), circle("bore", [0.5, 0.0], 0.4, 2.0 * start)].concat();
    add("annulus, x", 'x', 1.0, &[ring(20.0), face("f", &["rim"], &["bore"], ""), uniform(0.08)]);
    add("annulus, y", 'y', 0.0, &[ring(0.0), face("f", &["rim"], &["bore"], ""), uniform(0.11)]);
    let bore = || circle("bore", [0.0, 0.0], 0.3, 45.0);
    for (name, axis, teeth, first) in [
        ("gear of 16 teeth", 'x', 16, 0.0),
        ("gear of 7 teeth", 'x', 7, 0.5 * PI),
        ("gear of 12 teeth", 'y', 12, PI / 12.0),
        ("gear of 9 teeth", 'y', 9, 0.0),
    ] {
        let face = face("f", &["teeth"], &["bore"], "");
        add(name, axis, 0.0, &[polygon("teeth", &gear(teeth, first)), bore(), face, uniform(0.07)]);
    }
    let t = [[0, 2], [0, 3], [3, 3], [3, 2], [2, 2], [2, 0], [1, 0], [1, 2]].map(|p| p.map(f64::from));
    let t: Vec<_> = t.into_iter().rev().collect();
    add("two mirrored L", 'x', 3.0, &[polygon("t", &t), face("f", &["t"], &[], ""), uniform(0.17)]);
    let u = [[0.0, 0.0], [5.0, 0.0], [5.0, 4.0], [4.0, 4.0], [4.0, 1.5], [1.0, 1.5], [1.0, 4.0], [0.0, 4.0]];
    add("U", 'x', 5.0, &[polygon("u", &u), face("f", &["u"], &[], ""), uniform(0.23)]);
    add("blob", 'y', 0.0, &[blob(), face("f", &["blob"], &[], ""), uniform(0.08)]);
    add(
        "stadium of arcs",
        'x',
        0.0,
        &[
            line("floor", &[[-1.0, -0.5], [1.0, -0.5]]),
            line("roof", &[[-1.0, 0.5], [1.0, 0.5]]),
            arc("right", [1.0, 0.0], 0.5, [-90.0, 90.0]),
            arc("left", [-1.0, 0.0], 0.5, [90.0, 270.0]),
            face("f", &["floor", "right", "roof", "left"], &[], ""),
            uniform(0.09),
        ],
    );
    add(
        "two faces, one the image of the other",
        'x',
        0.0,
        &[
            line("left", &[[0.0, 1.0], [-1.0, 1.2], [-1.0, 0.0], [0.0, 0.0]]),
            line("between", &[[0.0, 0.0], [0.0, 1.0]]),
            line("right", &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.2], [0.0, 1.0]]),
            face("one", &["left", "between"], &[], ""),
            face("other", &["right", "between"], &[], ""),
            uniform(0.1),
        ],
    );
    add(
        "two faces across the line",
        'x',
        1.0,
        &[
            line("lower", &[[0.0, 0.5], [0.0, 0.0], [1.0, 0.0], [1.0, 0.5]]),
            arc("between", [0.5, 0.5], 0.5, [0.0, 180.0]),
            line("upper", &[[0.0, 0.5], [0.0, 1.5], [1.0, 1.5], [1.0, 0.5]]),
            face("below", &["lower", "between"], &[], ""),
            face("above", &["between", "upper"], &[], ""),
            uniform(0.06),
        ],
    );
    add(
        "disk with finer rim",
        'x',
        0.0,
        &[
            circle("rim", [0.0, 0.0], 1.0, 0.0),
            face("f", &["rim"], &[], ""),
            "[[metric]]\nkind = \"distance\"\ncurves = [\"rim\"]\nfirst = 0.05\ngrowth = 1.3\nfar = 0.2\n".to_owned(),
        ],
    );
    add(
        "plate with a stretched metric",
        'x',
        1.0,
        &[
            square(),
            hole(),
            face("f", &["frame"], &["hole"], ""),
            "[[metric]]\nkind = \"formula\"\nh1 = \"0.02 + 0.15*d\"\nh2 = 0.08\ng1 = [\"x - 0.5\", \"y - 0.5\"]\n\
             let = { d = \"abs(hypot(x - 0.5, y - 0.5) - 0.2)\" }\n"
                .to_owned(),
        ],
    );
    add(
        "cracks and a repeated line",
        'x',
        2.0,
        &[
            polygon("frame", &rectangle([0.0, 0.0], [2.0, 2.0])),
            line("across", &[[0.6, 0.5], [1.4, 0.5]]),
            line("along", &[[1.0, 0.9], [1.0, 1.3]]),
            line("repeated", &[[0.5, 1.6], [1.5, 1.6]]),
            face("f", &["frame"], &[], "cracks = [\"across\", \"along\"]\nrepeated = [\"repeated\"]"),
            uniform(0.1),
        ],
    );
    domains
}
