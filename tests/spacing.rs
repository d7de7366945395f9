//! Spacing that the boundary forces: sizes grow from short segments, curves that face each other across a narrow gap
//! get nodes that face each other, and what is too near says what would help.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use glam::{DVec2, Vec3Swizzles};
use quadfront::core::case::{Case, built_in};
use quadfront::core::convert::background;
use quadfront::core::convert::conversion::{Converted, convert};
use quadfront::core::progress::Nobody;
use quadfront::core::record::{Export, Report};

/// A conversion, its report, and its quadrilaterals as corners in the plane.
struct Quads {
    report: Report,
    quads: Vec<[DVec2; 4]>,
    nodes: Vec<DVec2>,
}

fn quads(text: &str) -> Quads {
    let case = Case::parse(text, "a", "a.toml", Path::new("")).unwrap();
    let converted: Converted = convert(&case, &mut Nobody).unwrap();
    let report = Report::of(&case, &converted).unwrap();
    let file = Export::of(&converted.mesh, &converted.names).file;
    let nodes: Vec<DVec2> = file.points.iter().map(|p| p.xy()).collect();
    let quads = file.quads.iter().map(|quad| quad.map(|n| nodes[n as usize])).collect();
    assert!(report.valid && file.triangles.is_empty());
    Quads { report, quads, nodes }
}

fn refusal(text: &str) -> String {
    let case = Case::parse(text, "a", "a.toml", Path::new(""));
    case.and_then(|case| convert(&case, &mut Nobody)).map(|_| ()).unwrap_err().to_string()
}

fn data(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)).unwrap()
}

/// The angles of a quadrilateral in degrees.
fn angles(quad: &[DVec2; 4]) -> [f64; 4] {
    [0, 1, 2, 3].map(|k| {
        let (a, b) = (quad[(k + 1) % 4] - quad[k], quad[(k + 3) % 4] - quad[k]);
        a.angle_to(b).to_degrees().rem_euclid(360.0)
    })
}

/// The least and greatest angle of quadrilaterals.
fn extremes<'a>(quads: impl IntoIterator<Item = &'a [DVec2; 4]>) -> [f64; 2] {
    let all = quads.into_iter().flat_map(angles);
    all.fold([360.0, 0.0], |[low, high], angle| [f64::min(low, angle), f64::max(high, angle)])
}

/// Verdict's scaled Jacobian in the plane: the least over the corners of the cross product of its sides over their
/// lengths.
fn scaled_jacobian(quad: &[DVec2; 4]) -> f64 {
    let corner = |k: usize| {
        let (a, b) = (quad[(k + 1) % 4] - quad[k], quad[(k + 3) % 4] - quad[k]);
        a.perp_dot(b) / (a.length() * b.length())
    };
    (0..4).map(corner).fold(1.0, f64::min)
}

fn mean_side(quad: &[DVec2; 4]) -> f64 {
    (0..4).map(|k| quad[k].distance(quad[(k + 1) % 4])).sum::<f64>() / 4.0
}

fn count(nodes: &[DVec2], is_there: impl Fn(DVec2) -> bool) -> usize {
    nodes.iter().filter(|&&p| is_there(p)).count()
}

#[test]
fn a_polygon_of_short_sides_is_divided_like_the_curve_that_it_follows() {
    let made = quads(&data("poly360.toml"));
    let [low, high] = extremes(&made.quads);
    assert!(low >= 40.0 && high <= 140.0, "{low} {high}");
    assert!(made.report.last_resort.share < 0.01);
    assert!(made.report.spacing.forced.is_none());
    assert_eq!(made.report.spacing.smooth_points, 359);
    // A circle of this radius has 2 pi / 0.15 segments.
    let rim = count(&made.nodes, |p| p.length() > 0.999);
    assert!((40..=44).contains(&rim), "{rim}");
}

#[test]
fn sizes_grow_inwards_from_sides_that_are_much_shorter_than_asked_for() {
    let made = quads(&format!("corner_angle = 0\n{}", data("poly360.toml")));
    let [low, high] = extremes(&made.quads);
    assert!(low >= 40.0 && high <= 140.0, "{low} {high}");
    assert!(made.report.last_resort.share < 0.01, "{:?}", made.report.last_resort);
    assert_eq!(count(&made.nodes, |p| p.length() > 0.999_999), 360);
    let forced = made.report.spacing.forced.unwrap();
    let side = 2.0 * libm::sin(0.5_f64.to_radians());
    assert_eq!((forced.segments, forced.gradation_given), (360, false));
    assert!((forced.shortest - side).abs() < 1e-9);
    assert!((forced.shortest_in_metric - side / 0.15).abs() < 1e-6);
    // The law: the side, plus ln(1.3) times the distance, up to 0.15.
    let (mut sum, mut of) = (0.0, 0.0);
    for quad in &made.quads {
        let middle = quad.iter().sum::<DVec2>() / 4.0;
        let asked = (side + libm::log(1.3) * (1.0 - middle.length())).min(0.15);
        let ratio = mean_side(quad) / asked;
        assert!((0.4..2.5).contains(&ratio), "{middle}: {ratio}");
        sum += ratio;
        of += 1.0;
    }
    assert!((sum / of - 1.0_f64).abs() < 0.15, "{}", sum / of);
    let text = made.report.summary();
    assert!(text.contains("360 boundary segments shorter than asked for"), "{text}");
}

#[test]
fn a_fixed_count_finer_than_the_metric_forces_sizes_and_gradation_says_how_they_grow() {
    let square = |rest: &str| {
        format!(
            "version = 1\n{rest}[[curve]]\nname = \"s\"\nkind = \"segment\"\nfrom = [0, 0]\nto = [1, 0]\n\
             segments = 80\n[[curve]]\nname = \"r\"\nkind = \"polyline\"\npoints = [[1, 0], [1, 1], [0, 1], [0, 0]]\n\
             [[face]]\nname = \"f\"\nouter = [\"s\", \"r\"]\n[[metric]]\nkind = \"uniform\"\nh = 0.1\n"
        )
    };
    let made = quads(&square(""));
    let [low, high] = extremes(&made.quads);
    assert!(low >= 40.0 && high <= 140.0, "{low} {high}");
    assert!(made.report.last_resort.share < 0.01);
    assert_eq!(count(&made.nodes, |p| p.y == 0.0), 81);
    // The sides beside it are graded too.
    let mut beside: Vec<f64> = made.nodes.iter().filter(|p| p.x == 1.0).map(|p| p.y).collect();
    beside.sort_by(f64::total_cmp);
    assert!(beside[1] - beside[0] < 0.03, "{beside:?}");
    let wider = quads(&square("gradation = 2\n"));
    assert!(wider.report.spacing.forced.unwrap().gradation_given);
    assert!(wider.quads.len() < made.quads.len() * 4 / 5, "{} {}", wider.quads.len(), made.quads.len());
}

#[test]
fn nothing_is_forced_where_no_segment_is_short() {
    for name in ["uniform", "graded-plate", "example1", "two-faces"] {
        let case = built_in::named(name).unwrap().unwrap();
        let made = background(&case, &mut Nobody).unwrap();
        assert!(made.spacing.is_plain(), "{name}: {:?}", made.spacing);
    }
}

#[test]
fn a_tab_thinner_than_the_sizes_gets_one_row_of_upright_quadrilaterals() {
    let made = quads(&data("thin_tab.toml"));
    let is_low = |p: DVec2| (p.y - 4.9).abs() < 1e-12 && p.x >= 10.0;
    let is_high = |p: DVec2| (p.y - 5.0).abs() < 1e-12 && p.x >= 10.0;
    let (below, above) = (count(&made.nodes, is_low), count(&made.nodes, is_high));
    assert_eq!(below, above);
    assert!(below >= 41, "{below}");
    let in_tab: Vec<_> = made.quads.iter().filter(|quad| quad.iter().all(|p| p.x > 10.0 - 1e-9)).collect();
    assert!(in_tab.len() >= 40);
    let [low, high] = extremes(in_tab);
    assert!(low >= 80.0 && high <= 100.0, "{low} {high}");
    assert_eq!(made.report.last_resort.quads, 0);
    assert!(made.report.summary().contains("nodes face each other across 1 narrow gap"));
}

#[test]
fn a_ring_thinner_than_the_sizes_is_one_row_wherever_its_circles_begin() {
    let plain = data("thin_annulus.toml");
    for angle in [0.0, 31.0] {
        let text = plain.replacen("radius = 0.99\n", &format!("radius = 0.99\nstart_angle = {angle}\n"), 1);
        let made = quads(&text);
        let [inner, outer] = [0.99, 1.0].map(|r| count(&made.nodes, |p| (p.length() - r).abs() < 1e-6));
        assert_eq!(inner, outer);
        assert_eq!(made.nodes.len(), inner + outer);
        assert_eq!(made.quads.len(), outer);
        let [low, high] = extremes(&made.quads);
        assert!(low >= 80.0 && high <= 100.0, "{angle}: {low} {high}");
        assert_eq!(made.report.mesh.irregular.irregular, 0);
    }
}

#[test]
fn a_ring_of_three_thin_layers_has_equal_counts_throughout() {
    let circle = |name: &str, radius: f64| {
        format!("[[curve]]\nname = \"{name}\"\nkind = \"circle\"\ncentre = [0, 0]\nradius = {radius}\n")
    };
    let face = |name: &str, outer: &str, hole: &str| {
        format!("[[face]]\nname = \"{name}\"\nouter = [\"{outer}\"]\nholes = [[\"{hole}\"]]\n")
    };
    let text = format!(
        "version = 1\n{}{}{}{}{}{}{}[[metric]]\nkind = \"uniform\"\nh = 0.05\n",
        circle("a", 1.0),
        circle("b", 0.99),
        circle("c", 0.975),
        circle("d", 0.97),
        face("one", "a", "b"),
        face("two", "b", "c"),
        face("three", "c", "d"),
    );
    let made = quads(&text);
    let [low, high] = extremes(&made.quads);
    assert!(low >= 80.0 && high <= 100.0, "{low} {high}");
    assert_eq!(made.quads.len() % 3, 0);
    assert_eq!(made.nodes.len(), made.quads.len() / 3 * 4);
    assert_eq!(made.report.spacing.narrow_gaps.unwrap().pairs, 3);
}

#[test]
fn a_hole_that_all_but_touches_the_border_has_no_bad_quadrilaterals() {
    let made = quads(&data("near_touch.toml"));
    let least = made.quads.iter().map(scaled_jacobian).fold(1.0, f64::min);
    assert!(least >= 0.2, "{least}");
    assert!(made.report.last_resort.share < 0.01, "{:?}", made.report.last_resort);
}

#[test]
fn what_is_too_near_says_which_tolerance_would_help() {
    let near = data("near_touch.toml").replace("0.9999", "0.999999999");
    let says = refusal(&near);
    assert!(says.contains("touch") && says.contains("tolerance"), "{says}");
    let made = quads(&format!("tolerance = 1e-12\n{near}"));
    let least = made.quads.iter().map(scaled_jacobian).fold(1.0, f64::min);
    assert!(least >= 0.2, "{least}");
}

/// A square of two curves whose ends are `gap` apart, with a point that is repeated at that distance.
fn nearly_closed(gap: f64, rest: &str) -> String {
    format!(
        "version = 1\n{rest}[[curve]]\nname = \"a\"\nkind = \"polyline\"\n\
         points = [[0, 0], [1, 0], [1, {gap}], [1, 1]]\n[[curve]]\nname = \"b\"\nkind = \"polyline\"\npoints = [[1, 1], [0, 1], [0, {gap}]]\n\
         [[face]]\nname = \"f\"\nouter = [\"a\", \"b\"]\n[[metric]]\nkind = \"uniform\"\nh = 0.25\n"
    )
}

#[test]
fn a_tolerance_joins_ends_and_merges_points_and_says_so() {
    let says = refusal(&nearly_closed(1e-5, ""));
    assert!(says.contains("tolerance"), "{says}");
    let made = quads(&nearly_closed(1e-5, "tolerance = 1e-4\n"));
    assert_eq!(made.quads.len(), 16);
    assert_eq!(
        made.report.repairs,
        ["1 repeated point of a polyline was merged", "1 end of a curve was moved to where another one ends"]
    );
    assert!(refusal(&nearly_closed(1e-5, "tolerance = 0.5\n")).contains("a tenth of the domain"));
    let repeated = nearly_closed(1e-5, "").replace("[1, 0], [1, 0.00001]", "[1, 0], [1, 0]");
    assert!(refusal(&repeated).contains("tolerance"), "{}", refusal(&repeated));
}

#[test]
fn sides_of_a_gap_that_cannot_have_equal_numbers_are_told() {
    let side = |name: &str, from: [f64; 2], to: [f64; 2], segments: &str| {
        format!("[[curve]]\nname = \"{name}\"\nkind = \"segment\"\nfrom = {from:?}\nto = {to:?}\n{segments}\n")
    };
    // With one segment at one end and two at the other the long sides need numbers that differ by an odd one.
    let sides = [
        side("low", [0.0, 0.0], [9.0, 0.0], ""),
        side("right", [9.0, 0.0], [9.0, 0.1], "segments = 2"),
        side("high", [9.0, 0.1], [0.0, 0.1], ""),
        side("left", [0.0, 0.1], [0.0, 0.0], "segments = 1"),
    ];
    let face = "[[face]]\nname = \"f\"\nouter = [\"low\", \"right\", \"high\", \"left\"]\n";
    let made = quads(&format!("version = 1\n{}{face}[[metric]]\nkind = \"uniform\"\nh = 0.5\n", sides.concat()));
    let [low, high] = [0.0, 0.1].map(|y| count(&made.nodes, |p| p.y == y));
    assert_eq!(low.abs_diff(high) % 2, 1);
    assert!(!made.report.spacing.narrow_gaps.unwrap().facing);
    let text = made.report.summary();
    assert!(text.contains("1 narrow gap, down to 0.1 wide; equal numbers of segments on both sides did not"), "{text}");
}

#[test]
fn layers_in_gaps_are_as_many_as_asked_and_upright() {
    let layers = "[[metric]]\nkind = \"gap\"\nlayers = 3\n";
    let made = quads(&format!("{}{layers}", data("thin_tab.toml")));
    let is_at = |y: f64| move |p: DVec2| (p.y - y).abs() < 1e-9 && p.x >= 10.0;
    let below = count(&made.nodes, is_at(4.9));
    assert_eq!(below, count(&made.nodes, is_at(5.0)));
    let in_tab: Vec<_> = made.quads.iter().filter(|quad| quad.iter().all(|p| p.x > 12.0)).collect();
    let columns = count(&made.nodes, |p| (p.y - 4.9).abs() < 1e-9 && p.x > 12.0) - 1;
    assert_eq!(in_tab.len(), 3 * columns);
    let [low, high] = extremes(in_tab);
    assert!(low >= 60.0 && high <= 120.0, "{low} {high}");
    let made = quads(&format!("{}{layers}", data("thin_annulus.toml")));
    let outer = count(&made.nodes, |p| (p.length() - 1.0).abs() < 1e-6);
    assert_eq!((made.quads.len(), made.report.mesh.irregular.irregular), (3 * outer, 0));
    // Alone it is no size, and surfaces have no gaps.
    let bare = data("thin_tab.toml");
    let alone = bare.split("[[metric]]").next().unwrap();
    assert!(refusal(&format!("{alone}{layers}")).contains("no metric"));
}
