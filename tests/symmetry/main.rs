//! Promise: with `symmetry` the mesh is its own mirror image to the last bit, valid, and no worse than without; what is
//! not symmetric is refused with the place where it is not.
#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use quadfront::core::case::{Case, Symmetry, built_in};
use quadfront::core::convert::conversion::convert;
use quadfront::core::convert::{Converted, Event, Phase, background};
use quadfront::core::mesh::Mesh;
use quadfront::core::progress::Nobody;
use quadfront::core::record::report::{Report, background_summary};
use quadfront::core::record::{Export, Statistics};
use quadfront::core::run::timeline::{Timeline, Tracked};
use quadfront::core::run::{History, Run};
use quadfront::core::soup::soundness::examine;
use quadfront::core::soup::{MeshFile, Soundness};

#[path = "../common/irregular.rs"]
mod irregular;
mod domains;

use domains::{Domain, all, circle, face, polygon, rectangle, uniform};
use irregular::irregular_inside;

/// Whether two doubles add up to a third exactly: the error of a rounded sum is itself a double (Knuth).
fn add_up(a: f64, b: f64, sum: f64) -> bool {
    let s = a + b;
    let part = s - a;
    s == sum && (a - (s - part)) + (b - part) == 0.0
}

/// The image of each point; `None` where no point lies exactly there. Points at one place (both sides of a crack) are
/// images of each other in some order, so places stand for points.
fn images(mesh: &MeshFile, axis: char, sum: f64) -> Vec<Option<[u64; 2]>> {
    let split = |p: &DVec3| if axis == 'x' { (p.x, p.y) } else { (p.y, p.x) };
    let mut at: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
    mesh.points.iter().map(split).for_each(|(along, across)| at.entry(across.to_bits()).or_default().push(along));
    let image = |(along, across): (f64, f64)| {
        let found = at[&across.to_bits()].iter().find(|other| add_up(along, **other, sum))?;
        Some([found.to_bits(), across.to_bits()])
    };
    mesh.points.iter().map(|p| image(split(p))).collect()
}

/// Checks that points and quadrilaterals are their own mirror image, in a line at half of about this sum; returns the
/// exact sum.
fn check_image(mesh: &MeshFile, axis: char, about: f64, name: &str) -> f64 {
    let along = |p: &DVec3| if axis == 'x' { p.x } else { p.y };
    let (low, high) = mesh.points.iter().map(along).fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
    let sum = low + high;
    assert!((sum - about).abs() <= 2.0 * f64::EPSILON * low.abs().max(high.abs()), "{name}: {sum} for {about}");
    let images = images(mesh, axis, sum);
    let missing = images.iter().filter(|image| image.is_none()).count();
    assert_eq!(missing, 0, "{name}: of {} nodes so many have no image", images.len());
    let place = |n: u32| {
        let p = mesh.points[n as usize];
        let (along, across) = if axis == 'x' { (p.x, p.y) } else { (p.y, p.x) };
        [along + 0.0, across].map(f64::to_bits)
    };
    let zero = |p: [u64; 2]| [(f64::from_bits(p[0]) + 0.0).to_bits(), p[1]];
    let sorted = |mut corners: [[u64; 2]; 4]| {
        corners.sort_unstable();
        corners
    };
    let quads: BTreeSet<_> = mesh.quads.iter().map(|quad| sorted(quad.map(place))).collect();
    for quad in &mesh.quads {
        let image = sorted(quad.map(|n| zero(images[n as usize].unwrap())));
        assert!(quads.contains(&image), "{name}: a quadrilateral has no image");
    }
    assert!(mesh.triangles.is_empty() && mesh.quads.len().is_multiple_of(2), "{name}");
    sum
}

fn exported(converted: &Converted) -> MeshFile {
    Export::of(&converted.mesh, &converted.names).file
}

fn is_sound(converted: &Converted) -> bool {
    Export::of(&converted.mesh, &converted.names).flaw(&converted.mesh, false).is_none()
        && converted.mesh.check().is_ok()
}

fn refusal(text: &str, axis: &str) -> String {
    let text = format!("version = 1\nsymmetry = \"{axis}\"\n{text}");
    let case = Case::parse(&text, "a", "a.toml", std::path::Path::new("")).unwrap();
    convert(&case, &mut Nobody).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn twenty_symmetric_domains_are_their_own_images_with_no_more_irregular_nodes_than_without() {
    let (mut with, mut without) = (0, 0);
    let domains = all();
    assert!(domains.len() >= 20);
    for domain in &domains {
        let done = convert(&domain.symmetric(), &mut Nobody).unwrap_or_else(|fault| panic!("{}: {fault}", domain.name));
        let mesh = exported(&done);
        assert!(is_sound(&done), "{}", domain.name);
        let sum = check_image(&mesh, domain.axis, domain.sum, domain.name);
        let plain = exported(&convert(&domain.case(""), &mut Nobody).unwrap());
        let irregular = [&mesh, &plain].map(irregular_inside);
        println!(
            "{}: {} and {} quadrilaterals, {} and {} irregular nodes",
            domain.name,
            mesh.quads.len(),
            plain.quads.len(),
            irregular[0],
            irregular[1]
        );
        let share = mesh.quads.len() as f64 / plain.quads.len() as f64;
        assert!((0.8..1.25).contains(&share), "{}: {share} times the quadrilaterals", domain.name);
        let report = Report::of(&domain.symmetric(), &done).unwrap();
        let symmetry = report.symmetry.clone().unwrap();
        assert_eq!((symmetry.mirrored, symmetry.at), (symmetry.nodes, 0.5 * sum), "{}", domain.name);
        assert_eq!(symmetry.nodes, mesh.points.len());
        assert!(report.summary().contains(&format!("{}, ", domain.axis)) && report.summary().contains("have an image"));
        with += irregular[0];
        without += irregular[1];
    }
    assert!(with <= without, "{with} irregular nodes with symmetry, {without} without");
}

#[test]
fn faces_curves_and_cracks_stay_what_they_are() {
    let domains = all();
    let named = |name: &str| domains.iter().find(|domain| domain.name == name).unwrap();
    let sides = |domain: &Domain, head: &str| {
        let done = convert(&if head.is_empty() { domain.case("") } else { domain.symmetric() }, &mut Nobody).unwrap();
        let mesh = exported(&done);
        let tags: BTreeMap<u32, usize> = mesh.quad_tags.iter().fold(BTreeMap::new(), |mut tags, tag| {
            *tags.entry(*tag).or_default() += 1;
            tags
        });
        let kinds: BTreeSet<u32> = mesh.line_tags.iter().copied().collect();
        let Soundness { boundary_loops, components, euler, .. } = examine(&mesh);
        (tags, kinds, [boundary_loops as i64, components as i64, euler])
    };
    for name in ["two faces, one the image of the other", "two faces across the line", "cracks and a repeated line"] {
        let domain = named(name);
        let ((tags, kinds, pieces), (_, plain_kinds, plain_pieces)) = (sides(domain, "x"), sides(domain, ""));
        assert_eq!((kinds, pieces), (plain_kinds, plain_pieces), "{name}");
        if name.starts_with("two faces, one") {
            assert_eq!(tags.len(), 2, "{name}");
            assert_eq!(tags.values().collect::<BTreeSet<_>>().len(), 1, "{name}: both faces have as many");
        }
    }
    // The crack on the line is open: its inner nodes are two points at one place.
    let cracked = exported(&convert(&named("cracks and a repeated line").symmetric(), &mut Nobody).unwrap());
    let on_crack = |p: &&DVec3| p.x == 1.0 && p.y > 0.9 + 1e-9 && p.y < 1.3 - 1e-9;
    let places: Vec<u64> = cracked.points.iter().filter(on_crack).map(|p| p.y.to_bits()).collect();
    let distinct: BTreeSet<u64> = places.iter().copied().collect();
    assert!(!distinct.is_empty() && places.len() == 2 * distinct.len(), "{} and {}", places.len(), distinct.len());
}

/// The number of edges of a mesh, by the nodes at their ends.
fn edges(mesh: &Mesh) -> i64 {
    let ends = mesh.elements().flat_map(|e| mesh.half_edges(e)).map(|h| mesh.ends(h));
    ends.map(|[a, b]| [a.min(b), a.max(b)]).collect::<BTreeSet<_>>().len() as i64
}

#[test]
fn the_image_is_one_step_that_can_be_taken_back() {
    for k in [1, 6, 16, 20] {
        the_image_can_be_taken_back(&all()[k]);
    }
}

fn the_image_can_be_taken_back(domain: &Domain) {
    let mut history = History::open(Run::of(domain.symmetric()), &mut Nobody).unwrap();
    history.seek(u64::MAX).unwrap();
    let end = history.step();
    let whole = history.state().fingerprint();
    let event = history.event(end).unwrap();
    let Some(Event::Mirrored { quads, nodes, on_line }) = event else { panic!("{event:?}") };
    assert_eq!(*history.state().phase(), Phase::Done);
    let mesh = &history.state().mesh;
    assert_eq!((mesh.element_count(), history.state().standing()), (2 * quads, 2 * quads as u64));
    assert!(on_line > 2 && mesh.node_count() > nodes + on_line);
    mesh.check().unwrap();
    // By the samples of the timeline no invariant is broken: the whole has twice the area of the half.
    let log = history.log();
    let track: Vec<Tracked> = (1..=end).filter_map(|step| Tracked::of(log, step)).collect();
    let samples = log.samples();
    let timeline = Timeline::of(&track, samples);
    assert_eq!(samples.iter().filter_map(|sample| timeline.broken(sample)).collect::<Vec<_>>(), [""; 0]);
    let (first, last) = (samples.first().unwrap(), samples.last().unwrap());
    assert!(last.step == end && (last.area / first.area - 2.0).abs() < 1e-12);
    assert_eq!(last.euler, mesh.node_count() as i64 - edges(mesh) + mesh.element_count() as i64);
    history.seek(end - 1).unwrap();
    assert_eq!((history.state().mesh.element_count(), history.state().phase()), (quads, &Phase::Mirror));
    history.state().mesh.check().unwrap();
    history.seek(end / 2).unwrap();
    history.seek(end).unwrap();
    assert_eq!(history.state().fingerprint(), whole);
}

#[test]
fn auto_finds_the_line() {
    let wide =
        [polygon("p", &[[0.0, 0.0], [2.0, 0.5], [2.0, 1.5], [0.0, 2.0]]), face("f", &["p"], &[], ""), uniform(0.2)];
    let domain = Domain { name: "trapezium", axis: 'y', sum: 2.0, text: wide.concat() };
    let done = convert(&domain.case("symmetry = \"auto\""), &mut Nobody).unwrap();
    check_image(&exported(&done), 'y', 2.0, domain.name);
    let skew =
        [polygon("p", &[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.5]]), face("f", &["p"], &[], ""), uniform(0.2)];
    let said = refusal(&skew.concat(), "auto");
    assert!(said.contains("not symmetric in x") && said.contains("not symmetric in y"), "{said}");
}

#[test]
fn what_is_not_symmetric_is_refused_with_its_place() {
    let square = || polygon("frame", &rectangle([0.0, 0.0], [1.0, 1.0]));
    let with_hole =
        |hole: &str| [square(), hole.to_owned(), face("f", &["frame"], &["hole"], ""), uniform(0.1)].concat();
    let said = refusal(&with_hole(&circle("hole", [0.4, 0.5], 0.2, 0.0)), "x");
    assert!(said.contains("the curve \"hole\" has no image") && said.contains("x = 0.5"), "{said}");
    // A thousandth off is not the same place.
    let said = refusal(&with_hole(&circle("hole", [0.5005, 0.5], 0.2, 0.0)), "x");
    assert!(said.contains("the curve \"hole\" has no image"), "{said}");
    let metric = "[[metric]]\nkind = \"formula\"\nh1 = \"0.05 + 0.1*x\"\n".to_owned();
    let said = refusal(&[square(), face("f", &["frame"], &[], ""), metric].concat(), "x");
    assert!(said.contains("The metric is not symmetric in x") && said.contains(" at ("), "{said}");
    let metric = "[[metric]]\nkind = \"formula\"\nh1 = 0.05\nh2 = 0.2\ng1 = [1, 1]\n".to_owned();
    let said = refusal(&[square(), face("f", &["frame"], &[], ""), metric].concat(), "y");
    assert!(said.contains("The metric is not symmetric in y"), "{said}");
    let odd = circle("hole", [0.5, 0.5], 0.2, 0.0) + "segments = 13\n";
    let said = refusal(&with_hole(&odd), "x");
    assert!(said.contains("\"hole\" crosses the mirror line and has 13 segments"), "{said}");
    // Both holes are images of each other, but only one has a face in it.
    let faces = [
        polygon("frame", &rectangle([-1.0, 0.0], [2.0, 1.0])),
        circle("left", [-0.5, 0.5], 0.2, 0.0),
        circle("right", [0.5, 0.5], 0.2, 0.0),
        face("around", &["frame"], &["left", "right"], ""),
        face("inside", &["left"], &[], ""),
        uniform(0.2),
    ];
    let said = refusal(&faces.concat(), "x");
    assert!(said.contains("lies the face \"inside\", beside its image no face"), "{said}");
    for name in ["sphere", "figure-13"] {
        let mut case = built_in::named(name).unwrap().unwrap();
        case.symmetry = Some(Symmetry::X);
        let said = convert(&case, &mut Nobody).map(|_| ()).unwrap_err().to_string();
        assert!(said.contains("symmetry is only for planar domains of curves"), "{said}");
    }
}

#[test]
fn fixed_numbers_are_halved_and_given_to_both_sides() {
    let text = [
        polygon("frame", &rectangle([0.0, 0.0], [1.0, 1.0])) + "segments = 36\n",
        circle("hole", [0.5, 0.5], 0.2, 0.0) + "segments = 14\n",
        face("f", &["frame"], &["hole"], ""),
        uniform(0.1),
    ];
    let domain = Domain { name: "fixed", axis: 'x', sum: 1.0, text: text.concat() };
    let mesh = exported(&convert(&domain.symmetric(), &mut Nobody).unwrap());
    check_image(&mesh, 'x', 1.0, domain.name);
    let on_hole = |p: &&DVec3| (libm::hypot(p.x - 0.5, p.y - 0.5) - 0.2).abs() < 1e-9;
    assert_eq!(mesh.points.iter().filter(on_hole).count(), 14);
    assert_eq!(mesh.lines.len(), 36 + 14);
}

/// The groups of points, each with the places of its points.
fn groups_of_points(mesh: &MeshFile) -> Vec<(String, Vec<DVec3>)> {
    let name = |tag: u32| mesh.group_name(0, tag).unwrap_or("none").to_owned();
    let of = |of: &[u32]| of.iter().map(|&k| mesh.points[k as usize]).collect();
    mesh.members.iter().filter(|m| m.dimension == 0).map(|m| (name(m.tag), of(&m.of))).collect()
}

#[test]
fn hard_points_and_their_images_are_nodes_in_their_groups() {
    let plate = || {
        let hole = circle("hole", [0.5, 0.5], 0.2, 0.0);
        [polygon("frame", &rectangle([0.0, 0.0], [1.0, 1.0])), hole, face("f", &["frame"], &["hole"], "")].concat()
    };
    // Inside, on a curve, at a corner, on the line inside and on a curve that crosses it.
    let places =
        [[0.125, 0.75], [0.875, 0.75], [0.25, 0.0], [0.75, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.875], [0.5, 0.7]];
    let named = |k: usize, [x, y]: [f64; 2]| format!("[[point]]\nname = \"p{k}\"\nat = [{x:?}, {y:?}]\n");
    let points: Vec<String> = places.iter().enumerate().map(|(k, &at)| named(k, at)).collect();
    let text = [plate(), points.concat() + "size = 0.03\n", uniform(0.1)].concat();
    let domain = Domain { name: "points", axis: 'x', sum: 1.0, text };
    let done = convert(&domain.symmetric(), &mut Nobody).unwrap();
    let mesh = exported(&done);
    check_image(&mesh, 'x', 1.0, domain.name);
    assert!(is_sound(&done));
    let expected = places.iter().enumerate().map(|(k, &[x, y])| (format!("p{k}"), vec![DVec3::new(x, y, 0.0)]));
    assert_eq!(groups_of_points(&mesh), expected.collect::<Vec<_>>());
    for [x, y] in places {
        let corners = mesh.quads.iter().flatten().filter(|&&k| mesh.points[k as usize] == DVec3::new(x, y, 0.0));
        assert!(corners.count() >= 1, "{x} {y}");
    }
    let said = |points: &str| refusal(&[plate(), points.to_owned(), uniform(0.1)].concat(), "x");
    let alone = said(&named(0, [0.125, 0.75]));
    assert!(alone.contains("the point \"p0\" has no image at (0.875, 0.75)"), "{alone}");
    let unlike = said(&[named(0, [0.125, 0.75]), named(1, [0.875, 0.75]) + "size = 0.03\n"].concat());
    assert!(unlike.contains("not symmetric"), "{unlike}");
}

#[test]
fn what_is_told_of_the_line_is_how_it_is_divided() {
    let disk = |h: &str| [circle("rim", [0.0, 0.0], 1.0, 0.0), face("f", &["rim"], &[], ""), h.to_owned()].concat();
    let mut told = 0;
    for k in 0..12 {
        let text = disk(&uniform(0.08 + 0.005 * f64::from(k)));
        let domain = Domain { name: "disk", axis: 'x', sum: 0.0, text };
        let done = convert(&domain.symmetric(), &mut Nobody).unwrap();
        let Some(line) = done.spacing.mirror_line.clone() else { continue };
        // Sides whose image they are themselves lie on the line or across it.
        let mesh = exported(&done);
        let on_line = |k: u32| mesh.points[k as usize].x == 0.0;
        let sides = mesh.quads.iter().flat_map(|q| (0..4).map(move |k| [q[k], q[(k + 1) % 4]]));
        let sides: BTreeSet<[u32; 2]> =
            sides.filter(|side| side.iter().all(|&k| on_line(k))).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        assert_eq!(line.segments, [sides.len() as u32]);
        assert_eq!(line.segments[0].abs_diff(line.by_sizes[0]), 2);
        let text = Report::of(&domain.symmetric(), &done).unwrap().summary();
        assert!(text.contains(&format!("mirror line with {} segments instead of", sides.len())), "{text}");
        told += 1;
    }
    assert!(told > 2, "{told}");
}

#[test]
fn a_background_says_that_it_is_one_half() {
    let domain = &all()[0];
    let text = |case: &Case| {
        let made = background(case, &mut Nobody).unwrap();
        let export = Export::of(&made.mesh, &made.names);
        let statistics = Statistics::measure(export.measured(), &made.sizing).unwrap();
        background_summary(case, &statistics, &made.repairs, &made.spacing, &[])
    };
    assert!(text(&domain.symmetric()).contains("one half; the last step of the conversion adds its mirror image"));
    assert!(!text(&domain.case("")).contains("one half"));
}
