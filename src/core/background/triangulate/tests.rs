use proptest::prelude::*;

use super::super::discretise::tests::{Stretched, Uniform};
use super::*;
use crate::core::geometry::fixtures::*;
use crate::core::kernel::predicates::orient;
use crate::core::metric::MetricSource;

fn area(set: &TriangleSet) -> f64 {
    let corner = |n: u32| set.uv[n as usize];
    set.triangles.iter().map(|&[a, b, c]| 0.5 * orient(corner(a), corner(b), corner(c))).sum()
}

/// Nodes, points, and lengths of boundary loops of a domain meshed with size `h`.
fn meshed(specs: Specs, h: f64) -> (TriangleSet, usize, Vec<usize>) {
    let domain = built(specs);
    let (divided, set) = divide_and_triangulate(&domain, &Uniform(h)).unwrap();
    let (mesh, _) = triangles(&domain, &divided).unwrap();
    assert_eq!(mesh.set, set);
    let points = set.point.iter().map(|p| p.index() + 1).max().unwrap();
    let mut loops: Vec<usize> = mesh.loops().iter().map(Vec::len).collect();
    loops.sort_unstable_by(|a, b| b.cmp(a));
    (set, points, loops)
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
                assert!(firm(set.uv[t[0] as usize], set.uv[t[1] as usize], set.uv[t[2] as usize]), "{name} at {h}");
            }
        }
    }
}

#[test]
fn shared_curves_and_cracks_have_nodes_on_both_sides() {
    for (name, specs, expected, nodes_and_points) in [
        ("a hole", square_with_hole(), &[40, 12][..], (52, 52)),
        ("faces that share a curve have points in common", two_faces(), &[40, 40], (80, 80 - 11)),
        ("a crack opens between its tips", square_with_crack(), &[40, 8], (40 + 2 * 4, 40 + 8)),
        ("a crack on the border opens at its mouth", square_with_edge_crack(), &[52], (52, 52)),
        ("three cracks that meet make one loop", square_with_t_of_cracks(), &[40, 18], (58, 58)),
    ] {
        let (set, points, loops) = meshed(specs, 0.1);
        assert_eq!((&loops[..], (set.uv.len(), points)), (expected, nodes_and_points), "{name}");
    }
    // One triangle for each segment, and two more for each hole, less two.
    assert_eq!(meshed(square_with_hole(), 0.1).0.triangles.len(), 52);
    let regions = meshed(two_faces(), 0.1).0.region;
    assert_eq!([0, 1].map(|face| regions.iter().filter(|&&r| r == face).count()), [38, 38]);
    let (set, points, _) = meshed(square_with_inlay(), 0.1);
    assert_eq!((set.uv.len(), points), (40 + 2 * 12, 40 + 12));
}

#[test]
fn a_repeated_line_joins_hole_and_outer_loop_into_one() {
    let (set, points, loops) = meshed(square_with_bridge(), 0.1);
    let n = loops[0];
    assert_eq!((loops.len(), n % 2), (1, 0));
    // The four nodes of the bridge are doubled, their points are not.
    assert_eq!((set.uv.len(), points), (n, n - 4));
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
    // A hole that nearly fills its disc, and one outside a coarse chord but inside the arc.
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
        arc("bow", (0.0, -1.0), 2.0_f64.sqrt(), std::f64::consts::FRAC_PI_4, 3.0 * std::f64::consts::FRAC_PI_4),
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
    assert!(says.contains("\"hole\" and \"rim\" cross when divided"), "{says}");
}

#[test]
fn a_curve_is_not_refined_for_ever_beside_chords_that_stay() {
    // The square in the rim cuts the hole, however finely the hole is divided.
    let mut curves = vec![circle("rim", (0.0, 0.0), 1.0), circle("hole", (0.0, 0.0), 0.8)];
    curves[0].segments = Some(4);
    let domain = built((curves, vec![face("ring", "rim", &["hole"], "", "")]));
    let says = divide_and_triangulate(&domain, &Uniform(0.5)).unwrap_err().to_string();
    assert!(says.contains("\"hole\" and \"rim\" cross when divided"), "{says}");
}

#[test]
fn lines_too_close_for_the_templates_are_refused_with_the_place() {
    let mut curves = sides_of_square();
    curves.push(segment("crack", (0.2, 2e-8), (0.8, 2e-8)));
    let domain = built((curves, vec![face("plate", SQUARE, &[], "crack", "")]));
    let says = divide_and_triangulate(&domain, &Uniform(0.5)).unwrap_err().to_string();
    assert!(says.contains("\"crack\"") && says.contains("as high as long"), "{says}");
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
fn a_hub_and_collinear_nodes_are_triangulated() {
    // A sharp wedge whose tip is connected to 5,000 collinear nodes.
    let curves = vec![polyline("w", &[(0.0, 0.0), (1.0, -0.5), (1.0, 0.5)], true)];
    let domain = built((curves, vec![face("f", "w", &[], "", "")]));
    struct Wall;
    impl MetricSource for Wall {
        fn metric(&self, uv: DVec2) -> Result<crate::core::kernel::Metric2, Box<crate::core::metric::BadMetric>> {
            let h = if uv.x > 0.999 { 2e-4 } else { 1.0 };
            Uniform(h).metric(uv)
        }
    }
    let (_, set) = divide_and_triangulate(&domain, &Wall).unwrap();
    assert!(set.triangles.len() >= 5000, "{}", set.triangles.len());
}

/// A star-shaped polygon around the origin with radii in `low..high`.
fn star(name: &str, centre: (f64, f64), radii: &[f64]) -> crate::core::geometry::CurveSpec {
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
        let (mesh, _) = triangles(&domain, &divided).unwrap();
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

/// A grid of square faces; some edges are arcs, some have fixed numbers, diagonals are cracks or repeated lines.
fn grid(m: usize, n: usize, shapes: &[u8], fixed: &[Option<u32>], diagonals: &[u8]) -> Specs {
    let vertex = |i: usize, j: usize| (i as f64, j as f64);
    let (mut curves, mut faces) = (Vec::new(), Vec::new());
    let mut edge = |name: String, a: (f64, f64), b: (f64, f64)| {
        let k = curves.len();
        let middle = ((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0);
        let mut curve = match shapes[k % shapes.len()] % 3 {
            0 => segment(&name, a, b),
            // A shallow arc over the edge: centre off to one side, radius by Pythagoras.
            1 => {
                let (dx, dy) = (b.0 - a.0, b.1 - a.1);
                let centre = (middle.0 + 2.0 * dy, middle.1 - 2.0 * dx);
                let (from, to) =
                    (libm::atan2(a.1 - centre.1, a.0 - centre.0), libm::atan2(b.1 - centre.1, b.0 - centre.0));
                let turn = (to - from + 3.0 * std::f64::consts::PI) % std::f64::consts::TAU - std::f64::consts::PI;
                arc(&name, centre, 4.25_f64.sqrt(), from, from + turn)
            }
            _ => polyline(&name, &[b, (middle.0 + 0.05, middle.1 - 0.1), a], false),
        };
        curve.segments = fixed[k % fixed.len()].map(|n| n.max(2));
        curves.push(curve);
    };
    for (i, j) in (0..=n).flat_map(|j| (0..=m).map(move |i| (i, j))) {
        if i < m {
            edge(format!("x{i}_{j}"), vertex(i, j), vertex(i + 1, j));
        }
        if j < n {
            edge(format!("y{i}_{j}"), vertex(i, j), vertex(i, j + 1));
        }
    }
    for (k, (i, j)) in (0..n).flat_map(|j| (0..m).map(move |i| (i, j))).enumerate() {
        let outer = format!("x{i}_{j} y{i}_{j} x{i}_{} y{}_{j}", j + 1, i + 1);
        let name = format!("d{i}_{j}");
        let (a, b, c) = (vertex(i, j), vertex(i + 1, j + 1), (i as f64 + 0.4, j as f64 + 0.5));
        let diagonal = diagonals[k % diagonals.len()] % 6;
        match diagonal {
            1 | 2 => curves.push(segment(&name, a, b)),
            3 | 4 => curves.push(segment(&name, c, b)),
            5 => curves.push(circle(&name, c, 0.15)),
            _ => {}
        }
        let (crack, repeated) = match diagonal {
            1 | 3 => (name.as_str(), ""),
            2 | 4 | 5 => ("", name.as_str()),
            _ => ("", ""),
        };
        faces.push(face(&format!("f{i}_{j}"), &outer, &[], crack, repeated));
    }
    (curves, faces)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(80))]
    #[test]
    fn random_complexes_are_even_or_refused_for_their_fixed_numbers(
        (m, n) in (1_usize..4, 1_usize..4),
        shapes in prop::collection::vec(any::<u8>(), 1..9),
        fixed in prop::collection::vec(prop::option::weighted(0.2, 1_u32..9), 1..15),
        diagonals in prop::collection::vec(any::<u8>(), 1..7),
        h in 0.05..3.0,
    ) {
        let domain = built(grid(m, n, &shapes, &fixed, &diagonals));
        match divide_and_triangulate(&domain, &Uniform(h)) {
            Ok((divided, set)) => {
                let (mesh, _) = triangles(&domain, &divided).unwrap();
                prop_assert!(mesh.loops().iter().all(|l| l.len().is_multiple_of(2) && l.len() >= 4));
                prop_assert_eq!(mesh.loops().len(), domain.faces.iter().map(|f| f.walks.len()).sum::<usize>());
                for (curve, chain) in domain.curves.iter().zip(&divided.chains) {
                    prop_assert!(curve.segments.is_none_or(|n| chain.len() == n as usize + 1));
                }
                // A closed repeated line keeps both its sides in one face.
                prop_assert!(set.region.iter().all(|&r| (r as usize) < domain.faces.len()));
            }
            Err(fault) => prop_assert!(fixed.iter().any(Option::is_some), "{fault}"),
        }
    }

    /// Lines between points of a grid inside a square, straight or bent; for straight ones it is known which sets are
    /// valid.
    #[test]
    fn random_internal_lines_are_accepted_exactly_if_they_are_valid(
        lines in prop::collection::vec(((1_i64..6, 1_i64..6), (1_i64..6, 1_i64..6), 0_u8..6), 1..7),
        bent in any::<bool>(),
        h in 0.2..9.0,
    ) {
        let point = |p: (i64, i64)| (p.0 as f64, p.1 as f64);
        let mut curves = vec![polyline("rim", &[(0.0, 0.0), (6.0, 0.0), (6.0, 6.0), (0.0, 6.0)], true)];
        let (mut cracks, mut repeated) = (String::new(), String::new());
        for (i, &(a, b, kind)) in lines.iter().enumerate() {
            let name = format!("l{i}");
            let list = if kind % 2 == 0 { &mut cracks } else { &mut repeated };
            *list += &format!("{name} ");
            curves.push(match (bent, kind) {
                (true, 4) => circle(&name, point(a), 0.5),
                (true, 2 | 3) => arc(&name, point(a), 1.0, (b.0 - 3) as f64, b.1 as f64),
                _ => segment(&name, point(a), point(b)),
            });
        }
        let result = Domain::build(curves, vec![face("f", "rim", &[], &cracks, &repeated)]);
        if !bent {
            let side = |a: (i64, i64), b: (i64, i64), p: (i64, i64)| ((b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0)).signum();
            let on = |a: (i64, i64), b: (i64, i64), p: (i64, i64)| {
                side(a, b, p) == 0 && (p.0 - a.0) * (p.0 - b.0) <= 0 && (p.1 - a.1) * (p.1 - b.1) <= 0
            };
            let valid = |&(a, b, _): &((i64, i64), (i64, i64), u8), &(c, d, _): &((i64, i64), (i64, i64), u8)| {
                let crosses = side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
                let inside = |a, b, p| on(a, b, p) && p != a && p != b;
                let touches = inside(a, b, c) || inside(a, b, d) || inside(c, d, a) || inside(c, d, b);
                let same = (a, b) == (c, d) || (a, b) == (d, c);
                !(crosses || touches || same)
            };
            let all = lines.iter().all(|(a, b, _)| a != b)
                && (0..lines.len()).all(|i| (0..i).all(|j| valid(&lines[i], &lines[j])));
            prop_assert_eq!(result.is_ok(), all, "{:?}", result.err());
        }
        if let Ok(domain) = result {
            let (divided, _) = divide_and_triangulate(&domain, &Uniform(h)).map_err(|f| TestCaseError::fail(f.to_string()))?;
            prop_assert_eq!(triangles(&domain, &divided).unwrap().0.loops().len(), domain.faces[0].walks.len());
        }
    }
}
