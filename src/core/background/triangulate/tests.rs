use proptest::prelude::*;

use super::super::discretise::tests::{Stretched, Uniform};
use super::*;
use crate::core::geometry::fixtures::*;

fn area(set: &TriangleSet) -> f64 {
    let corner = |n: u32| set.uv[n as usize];
    set.triangles.iter().map(|&[a, b, c]| 0.5 * orient(corner(a), corner(b), corner(c))).sum()
}

/// Nodes, points, and lengths of boundary loops of a domain meshed with size `h`.
fn meshed(specs: Specs, h: f64) -> (TriangleSet, usize, Vec<usize>) {
    let domain = built(specs);
    let (divided, set) = divide_and_triangulate(&domain, &Uniform(h)).unwrap();
    let mesh = triangles(&domain, &divided).unwrap();
    assert_eq!(mesh.set, set);
    let points = set.point.iter().map(|p| p.index() + 1).max().unwrap();
    (set, points, mesh.loops().iter().map(Vec::len).collect())
}

#[test]
fn all_domains_are_triangulated_with_even_loops_and_their_area() {
    let hole = std::f64::consts::PI * 0.04;
    let areas = [1.0, 1.0 - hole, 4.0 * std::f64::consts::PI, 1.0, 2.0, 1.0, 1.0, 1.0 - hole, 1.0, 1.0];
    for ((name, specs), expected) in all().into_iter().zip(areas) {
        for h in [0.03, 0.11, 0.4, 5.0] {
            let (set, _, loops) = meshed(specs.clone(), h);
            assert!(loops.iter().all(|n| n % 2 == 0 && *n >= 4), "{name} at {h}: {loops:?}");
            if h < 0.1 {
                assert!((area(&set) / expected - 1.0).abs() < 5e-3, "{name}: {}", area(&set));
            }
            for t in &set.triangles {
                assert!(roomy(t.map(|n| set.uv[n as usize]), 2.0), "{name} at {h}");
            }
        }
    }
}

#[test]
fn a_square_with_a_hole_has_two_loops() {
    let (set, points, loops) = meshed(square_with_hole(), 0.1);
    assert_eq!(loops, [40, 12]);
    assert_eq!((set.uv.len(), points), (52, 52));
    // One triangle for each segment, and two more for each hole, less two.
    assert_eq!(set.triangles.len(), 52);
}

#[test]
fn faces_that_share_a_curve_have_nodes_of_their_own_and_points_in_common() {
    let (set, points, loops) = meshed(two_faces(), 0.1);
    assert_eq!(loops, [40, 40]);
    assert_eq!((set.uv.len(), points), (80, 80 - 11));
    assert_eq!(set.region.iter().filter(|&&r| r == 0).count(), 38);
    assert_eq!(set.region.iter().filter(|&&r| r == 1).count(), 38);
    let (set, points, _) = meshed(square_with_inlay(), 0.1);
    assert_eq!((set.uv.len(), points), (40 + 2 * 12, 40 + 12));
}

#[test]
fn a_crack_inside_opens_between_its_tips() {
    let (set, points, loops) = meshed(square_with_crack(), 0.1);
    assert_eq!(loops, [40, 8]);
    assert_eq!((set.uv.len(), points), (40 + 2 * 4, 40 + 8));
}

#[test]
fn a_crack_on_the_border_opens_at_its_mouth() {
    let (set, points, loops) = meshed(square_with_edge_crack(), 0.1);
    assert_eq!(loops, [52]);
    assert_eq!((set.uv.len(), points), (52, 52));
}

#[test]
fn a_repeated_line_joins_hole_and_outer_loop_into_one() {
    let (set, points, loops) = meshed(square_with_bridge(), 0.1);
    let n = loops[0];
    assert_eq!((loops.len(), n % 2), (1, 0));
    // The four nodes of the bridge are there twice, their points once.
    assert_eq!((set.uv.len(), points), (n, n - 4));
}

#[test]
fn three_cracks_that_meet_make_one_loop() {
    let (set, points, loops) = meshed(square_with_t_of_cracks(), 0.1);
    assert_eq!(loops, [40, 18]);
    assert_eq!((set.uv.len(), points), (58, 58));
}

#[test]
fn a_cut_from_side_to_side_leaves_two_even_parts() {
    for h in [0.1, 0.09, 0.23, 0.31] {
        let (set, points, loops) = meshed(square_cut_in_two(), h);
        assert_eq!(loops.len(), 2);
        assert!(loops.iter().all(|n| n % 2 == 0));
        assert_eq!(points, set.uv.len());
    }
}

#[test]
fn chords_that_cross_where_curves_do_not_are_refined() {
    // A hole that nearly fills its disc, and one that hides behind the bulge of a coarse chord.
    let ring = vec![circle("rim", (0.0, 0.0), 1.0), arc("hole", (0.0, 0.0), 0.98, 0.3, 0.3 + std::f64::consts::TAU)];
    let (set, _, loops) = meshed((ring, vec![face("ring", "rim", &["hole"], "", "")]), 1.0);
    assert!(loops.iter().all(|n| n % 2 == 0 && *n < 80), "{loops:?}");
    assert!(area(&set) > 0.0);
    let behind = vec![circle("rim", (0.0, 0.0), 1.0), circle("hole", (0.68, 0.68), 0.01)];
    let (set, ..) = meshed((behind, vec![face("ring", "rim", &["hole"], "", "")]), 1.4);
    assert!(area(&set) > 1.9);
    // A segment and an arc between the same ends, each one segment long.
    let lens = vec![
        segment("chord", (-1.0, 0.0), (1.0, 0.0)),
        arc("bow", (0.0, -1.0), 2.0_f64.sqrt(), 0.785_398_163_397_448_3, 2.356_194_490_192_345),
    ];
    meshed((lens, vec![face("lens", "chord bow", &[], "", "")]), 2.0);
}

#[test]
fn chords_that_cannot_be_refined_are_refused_with_their_names() {
    let mut curves = vec![circle("rim", (0.0, 0.0), 1.0), circle("hole", (0.0, 0.0), 0.98)];
    curves[0].segments = Some(4);
    curves[1].segments = Some(6);
    let domain = built((curves, vec![face("ring", "rim", &["hole"], "", "")]));
    let says = divide_and_triangulate(&domain, &Uniform(1.0)).unwrap_err().to_string();
    assert!(says.contains("\"rim\" and \"hole\" cross when divided"), "{says}");
}

#[test]
fn lines_too_close_for_the_templates_are_refused_with_the_place() {
    let mut curves = sides_of_square();
    curves.push(segment("crack", (0.2, 2e-8), (0.8, 2e-8)));
    let domain = built((curves, vec![face("plate", SQUARE, &[], "crack", "")]));
    let says = divide_and_triangulate(&domain, &Uniform(0.5)).unwrap_err().to_string();
    assert!(says.contains("\"crack\"") && says.contains("as high as it is long"), "{says}");
}

#[test]
fn the_same_input_gives_the_same_triangles() {
    for (name, specs) in all() {
        let domain = built(specs);
        let first = divide_and_triangulate(&domain, &Stretched).unwrap();
        for _ in 0..3 {
            assert!(divide_and_triangulate(&domain, &Stretched).unwrap() == first, "{name}");
        }
    }
}

#[test]
fn a_hub_and_collinear_nodes_do_no_harm() {
    // A sharp wedge whose tip sees 5,000 collinear nodes.
    let curves = vec![polyline("w", &[(0.0, 0.0), (1.0, -0.5), (1.0, 0.5)], true)];
    let domain = built((curves, vec![face("f", "w", &[], "", "")]));
    struct Wall;
    impl MetricSource for Wall {
        fn metric(
            &self,
            uv: DVec2,
        ) -> Result<crate::core::metric::tensor::Metric2, Box<crate::core::metric::field::BadMetric>> {
            let h = if uv.x > 0.999 { 2e-4 } else { 1.0 };
            Uniform(h).metric(uv)
        }
    }
    let (_, set) = divide_and_triangulate(&domain, &Wall).unwrap();
    assert!(set.triangles.len() > 5000);
}

/// A star-shaped polygon around the origin with radii in `low..high`.
fn star(name: &str, centre: (f64, f64), radii: &[f64]) -> crate::core::geometry::domain::CurveSpec {
    let points: Vec<(f64, f64)> = radii
        .iter()
        .enumerate()
        .map(|(i, r)| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * i as f64 / radii.len() as f64);
            (centre.0 + r * cos, centre.1 + r * sin)
        })
        .collect();
    polyline(name, &points, true)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn random_stars_with_holes_become_even_positive_triangles(
        outer in prop::collection::vec(1.0..3.0, 5..40),
        holes in prop::collection::vec((prop::collection::vec(0.03..0.14, 3..9), any::<bool>()), 0..5),
        h in 0.02..2.0,
        crack in any::<bool>(),
    ) {
        let mut curves = vec![star("outer", (0.0, 0.0), &outer)];
        let mut names = Vec::new();
        for (i, (radii, round)) in holes.iter().enumerate() {
            let (sin, cos) = libm::sincos(1.2 * i as f64);
            let centre = (0.5 * cos, 0.5 * sin);
            let name = format!("h{i}");
            curves.push(if *round { circle(&name, centre, radii[0]) } else { star(&name, centre, radii) });
            names.push(name);
        }
        curves.push(segment("crack", (-0.1, 0.0), (0.1, 0.05)));
        // Even a five-sided star holds the circle in which the holes lie: 1 * cos 36 degrees > 0.64.
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let domain = built((curves, vec![face("f", "outer", &names, if crack { "crack" } else { "" }, "")]));
        let (divided, set) = divide_and_triangulate(&domain, &Uniform(h)).unwrap();
        let mesh = triangles(&domain, &divided).unwrap();
        prop_assert_eq!(mesh.loops().len(), 1 + holes.len() + usize::from(crack));
        prop_assert!(mesh.loops().iter().all(|l| l.len() % 2 == 0));
        let polygon = |chain: &[u32]| {
            let points: Vec<DVec2> = chain[1..].iter().map(|&n| divided.nodes[n as usize]).collect();
            0.5 * crate::core::geometry::loops::doubled_area(&points)
        };
        let expected = polygon(&divided.chains[0]) - (1..=holes.len()).map(|i| polygon(&divided.chains[i])).sum::<f64>();
        prop_assert!((area(&set) - expected).abs() < 1e-10);
    }
}
