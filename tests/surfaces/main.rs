//! Promise: faces on curved surfaces become sound quadrilateral meshes that conform across shared curves, follow the
//! metric in space, lie on their surfaces, and do not depend on the order of the faces.
#![allow(clippy::unwrap_used)]

mod faults;
mod random;

#[path = "../common/environment.rs"]
mod environment;

use std::path::Path;

use glam::DVec3;
use quadfront::core::case::{Case, built_in};
use quadfront::core::convert::background;
use quadfront::core::convert::conversion::convert;
use quadfront::core::convert::{Converted, Converter, Event, Phase};
use quadfront::core::front::Segment;
use quadfront::core::metric::MetricSource;
use quadfront::core::metric::measure::triangle_area;
use quadfront::core::progress::Nobody;
use quadfront::core::record::{Export, Statistics};
use quadfront::core::soup::soundness::examine;
use quadfront::core::soup::{Allow, Defect, MeshFile, Soundness};

/// A converted case with everything that is held against it.
pub(crate) struct Made {
    pub(crate) converted: Converted,
    pub(crate) export: Export,
    pub(crate) sound: Soundness,
}

pub(crate) fn make(case: &Case) -> Made {
    let converted = convert(case, &mut Nobody).unwrap();
    let export = Export::of(&converted.mesh, &converted.names);
    let sound = examine(&export.file);
    Made { converted, export, sound }
}

impl Made {
    /// All quadrilaterals, conforming, convex in the plane by exact predicates, and on the surface's side at every
    /// corner.
    pub(crate) fn assert_sound(&self, name: &str) {
        let allow = Allow { seams: true, branching: true, ..Allow::default() };
        self.converted.mesh.check().unwrap();
        self.sound.verdict(allow).unwrap_or_else(|fault| panic!("{name}: {fault}"));
        assert_eq!(self.converted.mesh.folded(), [], "{name}");
        assert_eq!(self.sound.triangles, 0, "{name}");
    }

    fn statistics(&self) -> Statistics {
        Statistics::measure(self.export.measured(), &self.converted.sizing).unwrap()
    }
}

pub(crate) fn built_in(name: &str, set: &[(&str, &str)]) -> Case {
    let mut case = built_in::named(name).unwrap().unwrap();
    for (key, value) in set {
        case.parameters.set(key, value).unwrap();
    }
    case
}

pub(crate) fn parsed(text: &str) -> Case {
    Case::parse(text, "test", "test.toml", Path::new("")).unwrap()
}

#[test]
fn example_2_has_the_papers_angles_in_both_readings() {
    for name in ["example2", "example2-half"] {
        for scale in ["1", "0.8", "0.64"] {
            let made = make(&built_in(name, &[("size_scale", scale)]));
            assert_eq!(made.converted.mesh.folded(), [], "{name} {scale}");
            let angles = made.statistics().metric_angles;
            assert!(angles.min >= 30.0 && angles.max <= 160.0, "{name} {scale}: {} {}", angles.min, angles.max);
            assert!(angles.share_60_120 >= 0.9, "{name} {scale}: {}", angles.share_60_120);
        }
    }
}

#[test]
fn whole_surfaces_are_sound_and_have_their_own_topology() {
    // Sphere and torus close; a cone has one rim.
    for (name, euler, boundary) in [("sphere", 2, 0), ("torus", 0, 0), ("cone", 1, 1), ("saddle", 1, 1), ("wing", 1, 1)]
    {
        let made = make(&built_in(name, &[]));
        made.assert_sound(name);
        assert_eq!((made.sound.euler, made.sound.boundary_loops), (euler, boundary), "{name}");
        assert_eq!(made.sound.components, 1, "{name}");
    }
}

#[test]
fn three_faces_share_the_nodes_of_the_line_from_which_they_branch() {
    let made = make(&built_in("branching", &[]));
    made.assert_sound("branching");
    assert_eq!(made.sound.count(Defect::SeamNode), 0);
    let on_line = |p: &DVec3| p.x == 0.0 && p.z == 0.0;
    let file = &made.export.file;
    let nodes = file.points.iter().filter(|p| on_line(p)).count();
    assert!(nodes > 10);
    assert_eq!(made.sound.count(Defect::BranchingEdge), nodes as u64 - 1);
}

#[test]
fn areas_and_arc_lengths_of_meshes_converge_to_the_closed_form_with_second_order() {
    use std::f64::consts::PI;
    // The arc length is that of the rims.
    for (name, text, area, rims) in [
        ("sphere", "kind = \"sphere\"\nradius = 1", 4.0 * PI, 0.0),
        ("cylinder", "kind = \"cylinder\"\nradius = 1\nheight = 2", 4.0 * PI, 4.0 * PI),
        ("cone", "kind = \"cone\"\nradius = 1\nheight = 1.5", PI * libm::hypot(1.0, 1.5), 2.0 * PI),
        ("torus", "kind = \"torus\"\nradius = 2\ntube = 0.7", 4.0 * PI * PI * 1.4, 0.0),
    ] {
        let error = |h: f64| {
            let case = parsed(&format!(
                "version = 1\n[[surface]]\nname = \"s\"\n{text}\n[[face]]\nname = \"f\"\nsurface = \"s\"\n\
                 [[metric]]\nkind = \"uniform\"\nh = {h}\n"
            ));
            let made = make(&case);
            made.assert_sound(name);
            assert_eq!(made.sound.boundary_edges > 0, rims > 0.0, "{name}");
            let arc = if rims > 0.0 { 1.0 - made.sound.boundary_length / rims } else { 0.0 };
            // A chord's error goes with (h / radius)^2. Over a cone, whose radius falls to zero at the apex, that
            // integrates to h^2 ln(1 / h).
            let apex = if name == "cone" { libm::log(1.0 / h) } else { 1.0 };
            [(1.0 - made.sound.area / area).abs() / apex, arc]
        };
        // The slope of a line through the logarithms: one mesh's error is its pattern's, not its size's alone.
        let sizes = [0.25_f64, 0.2, 0.16, 0.125, 0.1, 0.08];
        let errors = sizes.map(error);
        for kind in 0..if rims > 0.0 { 2 } else { 1 } {
            let points = sizes.iter().zip(errors).map(|(h, error)| (libm::log(*h), libm::log(error[kind])));
            let n = sizes.len() as f64;
            let (x, y) = points.clone().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
            let [over, under] =
                points.fold([0.0; 2], |[o, u], p| [o + (p.0 - x) * (p.1 - y), u + (p.0 - x) * (p.0 - x)]);
            let (order, fine) = (over / under, errors[5][kind]);
            assert!(order > 1.7 && fine < 3e-3, "{name}: {errors:?}, order {order}");
        }
    }
}

#[test]
fn chosen_faces_are_converted_as_they_are_among_all_and_the_others_left_out() {
    let all = make(&built_in("example6", &[("size_scale", "2")]));
    let flange = make(&built_in("example6", &[("size_scale", "2"), ("faces", "top flange")]));
    flange.assert_sound("top flange");
    let of = |made: &Made, name: &str| {
        let region = made.converted.names.faces.iter().position(|face| face.name == name).unwrap() as u32;
        made.converted.mesh.elements_of(Some(region)).count()
    };
    // The curves are divided as for all faces; alone it has all trials of the clean-up.
    let (alone, among) = (of(&flange, "top flange") as f64, of(&all, "top flange") as f64);
    assert!((alone / among - 1.0).abs() < 0.1, "{alone} {among}");
    assert_eq!(flange.converted.mesh.faces().len(), 1);
    let fault = convert(&built_in("example6", &[("faces", "top flanje")]), &mut Nobody).err().unwrap().to_string();
    assert!(fault.contains("no face \"top flanje\"") && fault.contains("top flange"), "{fault}");
}

const UNIFORM: &str = "[[metric]]\nkind = \"uniform\"\nh = 0.2\n";

#[test]
fn a_lid_shares_an_edge_of_a_whole_cylinder_whose_crack_stays_open() {
    let made = make(&parsed(&format!(
        "version = 1\n[[surface]]\nname = \"pipe\"\nkind = \"cylinder\"\nradius = 1\nheight = 3\n\
         [[surface]]\nname = \"floor\"\nkind = \"plane\"\ncorner = [-2, -2, 0]\nu = [4, 0, 0]\nv = [0, 4, 0]\n\
         [[curve]]\nname = \"crack\"\nkind = \"segment\"\non = \"pipe\"\nfrom = [100, 1]\nto = [200, 2]\nsegments = 8\n\
         [[face]]\nname = \"pipe\"\nsurface = \"pipe\"\ncracks = [\"crack\"]\n\
         [[face]]\nname = \"lid\"\nsurface = \"floor\"\nouter = [\"pipe: v0\"]\n{UNIFORM}"
    )));
    made.assert_sound("lid");
    // The seven nodes inside the crack are there on both sides; its tips and the foot's circle only once.
    assert_eq!(made.sound.count(Defect::SeamNode), 14);
    // A cup is a disc; the crack is a second boundary.
    assert_eq!((made.sound.euler, made.sound.boundary_loops), (0, 2));
}

#[test]
fn a_face_may_cross_the_place_where_its_surface_closes() {
    let made = make(&parsed(&format!(
        "version = 1\n[[surface]]\nname = \"pipe\"\nkind = \"cylinder\"\nradius = 1\nheight = 3\n\
         [[curve]]\nname = \"patch\"\nkind = \"polyline\"\non = \"pipe\"\n\
         points = [[-60, 0.5], [60, 0.5], [70, 2.5], [-50, 2.5]]\nclosed = true\n\
         [[curve]]\nname = \"hole\"\nkind = \"polyline\"\non = \"pipe\"\n\
         points = [[350, 1], [370, 1], [370, 2], [350, 2]]\nclosed = true\n\
         [[face]]\nname = \"f\"\nsurface = \"pipe\"\nouter = [\"patch\"]\nholes = [[\"hole\"]]\n{UNIFORM}"
    )));
    made.assert_sound("patch");
    assert_eq!((made.sound.euler, made.sound.boundary_loops), (0, 2));
}

#[test]
fn holes_of_a_whole_sphere_belong_to_the_half_in_which_they_lie() {
    let made = make(&parsed(&format!(
        "version = 1\n[[surface]]\nname = \"s\"\nkind = \"sphere\"\nradius = 1\n\
         [[curve]]\nname = \"about the pole\"\nkind = \"circle\"\ncentre = [0, 0, 0.8]\nradius = 0.6\n\
         [[curve]]\nname = \"through the pole\"\nkind = \"circle\"\ncentre = [0.48, 0, -0.64]\naxis = [0.48, 0, -0.64]\n\
         radius = 0.6\n\
         [[face]]\nname = \"f\"\nsurface = \"s\"\nholes = [[\"about the pole\"], [\"through the pole\"]]\n{UNIFORM}"
    )));
    made.assert_sound("holes");
    assert_eq!((made.sound.euler, made.sound.boundary_loops, made.sound.components), (0, 2, 1));
}

/// Points and quadrilaterals by place, whatever their numbers.
fn by_place(file: &MeshFile) -> Vec<[[u64; 3]; 4]> {
    let bits = |n: u32| file.points[n as usize].to_array().map(f64::to_bits);
    let mut quads: Vec<_> = file
        .quads
        .iter()
        .map(|q| {
            let mut corners = q.map(bits);
            let first = (0..4).min_by_key(|&k| corners[k]).unwrap();
            corners.rotate_left(first);
            corners
        })
        .collect();
    quads.sort_unstable();
    quads
}

#[test]
fn the_mesh_does_not_depend_on_the_order_of_the_faces_and_surfaces() {
    let case = built_in("branching", &[]);
    let text = case.text.clone();
    let parts: Vec<&str> = text.split("\n\n").collect();
    let is = |part: &&&str, what: &str| part.contains(&format!("[[{what}]]"));
    let all = |what: &str, turn: usize| {
        let mut some: Vec<&str> = parts.iter().filter(|p| is(p, what)).copied().collect();
        some.rotate_left(turn);
        some.join("\n\n")
    };
    let rest = parts.iter().filter(|p| !is(p, "surface") && !is(p, "face")).copied().collect::<Vec<_>>().join("\n\n");
    let first = by_place(&make(&case).export.file);
    for turn in 1..3 {
        let turned = parsed(&format!("{rest}\n\n{}\n\n{}", all("face", turn), all("surface", turn)));
        assert_eq!(by_place(&make(&turned).export.file), first);
    }
}

#[test]
fn the_h_value_is_that_of_space_whatever_the_parameters() {
    // Sizes of 0.2 and 0.5 on a plane that its parameters stretch and shear.
    let case = parsed(
        "version = 1\n[[surface]]\nname = \"s\"\nkind = \"bezier\"\n\
         points = [[[0, 0, 1], [0.1, 2, 1]], [[7, 0.5, 1], [7.1, 2.5, 1]]]\n\
         [[face]]\nname = \"f\"\nsurface = \"s\"\n\
         [[metric]]\nkind = \"formula\"\nh1 = 0.2\nh2 = 0.5\ng1 = [3, 1]\ng2 = [-1, 3]\n",
    );
    let made = background(&case, &mut Nobody).unwrap();
    let mut seen = 0;
    for h in made.mesh.front() {
        let segment = Segment::measure(&made.mesh, h, &case.parameters);
        assert!((segment.h_value - 0.2).abs() < 1e-12, "{}", segment.h_value);
        let [a, b] = [segment.a, segment.b].map(|n| made.mesh.xyz(n));
        assert!((segment.length_physical - a.distance(b)).abs() < 1e-15);
        assert!(made.mesh.normal(segment.a).distance(DVec3::Z) < 1e-12);
        seen += 1;
    }
    assert!(seen > 20);
}

#[test]
fn the_same_case_gives_the_same_mesh_and_faces_are_converted_one_after_the_other() {
    let case = built_in("example5", &[]);
    assert_eq!(make(&case).export.file, make(&case).export.file);
    let made = background(&case, &mut Nobody).unwrap();
    let mut converter = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
    let (mut last, mut seen) = (0, 0);
    while *converter.phase() != Phase::Done {
        match converter.step().unwrap() {
            Event::BaseSelected { a, b, .. } => {
                let mesh = &converter.mesh;
                let face = mesh.region(mesh.front_between(a, b).unwrap().element());
                assert!(face >= last, "face {face} after {last}");
                (last, seen) = (face, seen + 1);
            }
            Event::SecondPass => break,
            _ => {}
        }
    }
    assert!(last == 1 && seen > 500, "{last} {seen}");
}

#[test]
fn examples_3_to_6_keep_the_grading_and_are_sound() {
    for name in ["example3", "example4", "example5", "example6"] {
        let made = make(&built_in(name, &[]));
        made.assert_sound(name);
        // The grading is kept: each face has as many quadrilaterals as its metric area says, within a quarter.
        let mut area = vec![0.0; made.converted.names.faces.len()];
        let (mesh, sizing) = (&made.converted.mesh, &made.converted.sizing);
        let mut count = vec![0.0; area.len()];
        for e in mesh.elements() {
            let [a, b, c, d] = mesh.quad(e).map(|n| mesh.uv(n));
            // In four by four parts: sizes change much over an element of a boundary layer.
            let at = |i: i32, j: i32| {
                let (s, t) = (f64::from(i) / 4.0, f64::from(j) / 4.0);
                a.lerp(b, s).lerp(d.lerp(c, s), t)
            };
            for (i, j) in (0..16).map(|k| (k / 4, k % 4)) {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let m = sizing.metric((a + b + c + d) / 4.0).unwrap();
                area[mesh.region(e) as usize] += triangle_area(&m, a, b, c) + triangle_area(&m, a, c, d);
            }
            count[mesh.region(e) as usize] += 1.0;
        }
        for (face, (count, area)) in made.converted.names.faces.iter().zip(count.iter().zip(&area)) {
            assert!((count / area - 1.0_f64).abs() < 0.25, "{name}, {face:?}: {count} for {area}");
        }
        let front = made.converted.counts.formed + made.converted.counts.closed;
        let resort = made.converted.last_resort.quads() as f64;
        assert!(resort <= 0.02 * (front as f64 + resort), "{name}: {resort} by the last resort");
    }
}
