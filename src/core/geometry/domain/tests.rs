use std::f64::consts::PI;

use super::super::fixtures::*;
use super::*;
use crate::core::geometry::spec::CurveShape;

fn refusal((curves, faces): Specs) -> String {
    Domain::build(curves, faces).unwrap_err().to_string()
}

/// The domain is refused, with all these words.
#[track_caller]
fn refused<const N: usize>(specs: Specs, words: [&str; N]) {
    let says = refusal(specs);
    assert!(words.iter().all(|word| says.contains(word)), "{says}");
}

#[test]
fn all_valid_domains_are_built() {
    for (name, specs) in all() {
        if let Err(fault) = Domain::build(specs.0, specs.1) {
            panic!("{name}: {fault}");
        }
    }
}

#[test]
fn outer_loops_run_anticlockwise_and_holes_clockwise() {
    for (name, specs) in all() {
        for f in built(specs.clone()).faces {
            for (i, l) in f.loops.iter().enumerate() {
                let area = loops::doubled_area(&loops::polygon(&built(specs.clone()).curves, l));
                assert_eq!(area > 0.0, i == 0, "{name}");
            }
        }
    }
}

/// The number of curves of each walk of each face.
fn walks(specs: Specs) -> Vec<Vec<usize>> {
    built(specs).faces.iter().map(|f| f.walks.iter().map(Vec::len).collect()).collect()
}

#[test]
fn walks_include_all_connected_lines() {
    assert_eq!(walks(square()), [[4]]);
    assert_eq!(walks(square_with_hole()), [[4, 1]]);
    assert_eq!(walks(disc()), [[3]]);
    assert_eq!(walks(square_with_inlay()), [vec![4, 1], vec![1]]);
    assert_eq!(walks(two_faces()), [[4], [2]]);
    assert_eq!(walks(square_with_crack()), [[4, 2]]);
    assert_eq!(walks(square_with_edge_crack()), [[7]]);
    assert_eq!(walks(square_with_bridge()), [[8]]);
    assert_eq!(walks(square_with_t_of_cracks()), [[4, 6]]);
    assert_eq!(walks(square_cut_in_two()), [[2, 2]]);
}

#[test]
fn tangent_curves_are_told_apart_by_their_curvature() {
    // Three circles inside each other that all touch at the origin, with the same tangent there.
    let curves = vec![circle("c3", (-3.0, 0.0), 3.0), circle("c1", (-1.0, 0.0), 1.0), circle("c2", (-2.0, 0.0), 2.0)];
    let faces = vec![
        face("big", "c3", &["c2"], "", ""),
        face("middle", "c2", &["c1"], "", ""),
        face("small", "c1", &[], "", ""),
    ];
    assert_eq!(walks((curves, faces)), [[2], [2], [1]]);
}

#[test]
fn inside_finds_the_face_and_nothing_in_holes() {
    let plate = built(square_with_hole());
    assert_eq!(plate.inside(DVec2::new(0.1, 0.1)), Some(0));
    assert_eq!(plate.inside(DVec2::new(0.5, 0.5)), None);
    assert_eq!(plate.inside(DVec2::new(1.5, 0.5)), None);
    assert_eq!(plate.inside(DVec2::new(0.5, 0.71)), Some(0));
    let inlay = built(square_with_inlay());
    assert_eq!(inlay.inside(DVec2::new(0.5, 0.5)), Some(1));
    assert_eq!(inlay.inside(DVec2::new(0.9, 0.5)), Some(0));
    let two = built(two_faces());
    assert_eq!((two.inside(DVec2::new(0.99, 0.2)), two.inside(DVec2::new(1.01, 0.2))), (Some(0), Some(1)));
    assert_eq!(built(square_with_crack()).inside(DVec2::new(0.9, 0.55)), Some(0));
}

#[test]
fn sample_points_cover_the_inside() {
    for (name, specs) in all() {
        let domain = built(specs);
        let points = domain.sample_points(1000);
        let inner = points.iter().filter(|&&p| domain.inside(p).is_some()).count();
        assert!((900..2000).contains(&inner), "{name}: {inner} of {}", points.len());
        let (low, high) = (domain.lower, domain.upper);
        assert!(points.iter().all(|p| p.cmpge(low - 1e-5).all() && p.cmple(high + 1e-5).all()));
    }
}

#[test]
fn a_domain_is_the_same_at_any_scale() {
    for scale in [1e-60, 1e-6, 1e6, 1e60] {
        let scaled = |(curves, faces): Specs| {
            let curves = curves.into_iter().map(|mut c| {
                match &mut c.shape {
                    CurveShape::Segment { from, to } => (*from *= scale, *to *= scale).0,
                    CurveShape::Arc { centre, radius, .. } => (*centre *= scale, *radius *= scale).0,
                    CurveShape::Polyline { points, .. } | CurveShape::Nurbs { points, .. } => {
                        points.iter_mut().for_each(|p| *p *= scale);
                    }
                }
                c
            });
            (curves.collect(), faces)
        };
        for (name, specs) in all() {
            let plain = built(specs.clone());
            let (curves, faces) = scaled(specs);
            let domain = Domain::build(curves, faces).unwrap_or_else(|f| panic!("{name} at {scale}: {f}"));
            assert_eq!(domain.vertices.len(), plain.vertices.len());
            let walks = |d: &Domain| d.faces.iter().map(|f| f.walks.clone()).collect::<Vec<_>>();
            assert_eq!(walks(&domain), walks(&plain));
            assert_eq!(domain.inside(DVec2::splat(0.1 * scale)), plain.inside(DVec2::splat(0.1)));
        }
    }
}

#[test]
fn ends_that_nearly_meet_are_joined() {
    let mut specs = square();
    specs.0[2] = segment("east", (1.0 + 3e-10, 1.0), (1.0, -4e-10));
    assert_eq!(built(specs).vertices.len(), 4);
}

#[test]
fn a_quarter_disc_joins_arcs_and_segments() {
    let curves = vec![
        arc("round", (0.0, 0.0), 1.0, 0.0, PI / 2.0),
        segment("x", (0.0, 0.0), (1.0, 0.0)),
        segment("y", (0.0, 0.0), (0.0, 1.0)),
    ];
    let domain = built((curves, vec![face("f", "x round y", &[], "", "")]));
    assert_eq!(domain.curve("round").unwrap().last(), DVec2::new(0.0, 1.0), "the given number holds");
}

#[test]
fn names_that_are_unknown_or_given_twice_are_refused() {
    refused(with(vec![], "south eest north west", &[], ""), ["\"eest\"", "Did you mean \"east\"?"]);
    refused(with(vec![segment("west", (0.0, 0.0), (2.0, 2.0))], SQUARE, &[], ""), ["two curves \"west\""]);
    let (curves, faces) = square();
    refused((curves, [faces.clone(), faces].concat()), ["two faces \"plate\""]);
    refused(with(vec![], "south south east north west", &[], ""), ["names the curve \"south\" twice"]);
}

#[test]
fn curves_without_a_face_are_left_out_even_bad_ones() {
    let stray = vec![segment("stray", (0.5, -1.0), (0.5, 2.0)), segment("dot", (0.0, 0.0), (0.0, 0.0))];
    assert_eq!(built(with(stray, SQUARE, &[], "")).curves.len(), 4);
}

#[test]
fn loops_that_are_open_or_in_pieces_are_refused_with_their_loose_ends() {
    refused(with(vec![], "south east west", &[], ""), ["outer loop of \"plate\" is open", "\"east\" begins at (1, 1)"]);
    refused(
        with(vec![segment("gap", (0.0, 1.0), (0.9, 1.0))], "south east gap west", &[], ""),
        ["\"gap\" ends at (0.9, 1), 0.1 apart"],
    );
    refused(with(vec![], "", &[], ""), ["has no curves"]);
    refused(
        with(vec![circle("c", (3.0, 3.0), 1.0)], "south east north west c", &[], ""),
        ["several closed loops", "\"c\" is not connected"],
    );
}

#[test]
fn zero_length_is_refused() {
    refused(with(vec![segment("c", (0.5, 0.5), (0.5, 0.5))], SQUARE, &[], "c"), ["curve \"c\": It has zero length"]);
    refused(with(vec![segment("c", (0.5, 0.5), (0.5, 0.5 + 1e-12))], SQUARE, &[], "c"), ["zero length"]);
}

#[test]
fn crossings_are_refused_and_placed() {
    refused(
        with(vec![segment("c", (0.5, 0.5), (1.5, 0.5))], SQUARE, &[], "c"),
        ["\"east\" and \"c\" cross", "(1, 0.5)"],
    );
    refused(with(vec![circle("h", (0.9, 0.5), 0.2)], SQUARE, &["h"], ""), ["\"east\" and \"h\"", "cross"]);
    let eight = polyline("eight", &[(0.2, 0.2), (0.8, 0.8), (0.8, 0.2), (0.2, 0.8)], true);
    refused(with(vec![eight], SQUARE, &["eight"], ""), ["\"eight\" crosses itself", "(0.5, 0.5)"]);
}

#[test]
fn shallow_crossings_of_curves_are_found_though_their_chords_miss() {
    // The circle pokes through the side by a ten-millionth.
    refused(with(vec![circle("h", (0.5, 0.3 - 1e-7), 0.3)], SQUARE, &["h"], ""), ["\"south\" and \"h\"", "cross"]);
    built(with(vec![circle("h", (0.5, 0.3 + 1e-7), 0.3)], SQUARE, &["h"], ""));
}

#[test]
fn touching_is_refused_with_its_remedy() {
    refused(
        with(vec![segment("c", (0.5, 0.5), (1.0, 0.5))], SQUARE, &[], "c"),
        ["end of \"c\" touches the interior of \"east\"", "Divide \"east\""],
    );
    refused(with(vec![circle("h", (0.5, 0.3), 0.3)], SQUARE, &["h"], ""), ["\"south\" and \"h\" touch", "(0.5, 0)"]);
    // A crack that ends on the inside of an arc.
    let round = vec![circle("rim", (0.0, 0.0), 1.0), segment("c", (0.0, 0.0), (0.6, 0.8))];
    refused((round, vec![face("f", "rim", &[], "c", "")]), ["end of \"c\" touches the interior of \"rim\""]);
    // A fold and a line that runs along another.
    let fold = polyline("c", &[(0.2, 0.5), (0.8, 0.5), (0.4, 0.5)], false);
    refused(with(vec![fold], SQUARE, &[], "c"), ["\"c\" touches itself"]);
    refused(with(vec![segment("c", (0.0, 0.0), (0.5, 0.0))], SQUARE, &[], "c"), ["\"south\"", "\"c\""]);
    let twin = vec![circle("rim", (0.0, 0.0), 1.0), circle("twin", (0.0, 0.0), 1.0)];
    refused((twin, vec![face("f", "rim", &[], "", ""), face("g", "twin", &[], "", "")]), ["touch"]);
    let knot = vec![
        polyline("a", &[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], false),
        segment("b", (1.0, 1.0), (0.0, 0.0)),
        circle("c", (-1.0, 0.0), 1.0),
    ];
    refused((knot, vec![face("f", "a b c", &[], "", "")]), ["touches itself: 4 ends"]);
    let bow = vec![
        polyline("a", &[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0)], true),
        polyline("b", &[(0.0, 0.0), (-1.0, 0.0), (-1.0, -1.0), (0.0, 0.0)], true),
    ];
    refused((bow, vec![face("f", "a b", &[], "", "")]), ["Make a face of each closed part"]);
}

#[test]
fn holes_and_internal_lines_outside_their_face_are_refused() {
    refused(
        with(vec![circle("h", (3.0, 0.5), 0.2)], SQUARE, &["h"], ""),
        ["\"h\" of hole 1 of \"plate\" lies outside"],
    );
    let nested = vec![circle("h", (0.5, 0.5), 0.3), circle("k", (0.5, 0.5), 0.2)];
    refused(with(nested, SQUARE, &["h", "k"], ""), ["\"k\"", "lies within hole 1"]);
    refused(with(vec![segment("c", (2.0, 2.0), (3.0, 2.0))], SQUARE, &[], "c"), ["\"c\" lies outside its face"]);
    let in_hole = vec![circle("h", (0.5, 0.5), 0.3), segment("c", (0.4, 0.5), (0.6, 0.5))];
    refused(with(in_hole, SQUARE, &["h"], "c"), ["\"c\" lies outside its face"]);
    refused(
        with(vec![], SQUARE, &[], "south"),
        ["\"south\" is a crack or a repeated line, and is listed a second time"],
    );
}

#[test]
fn faces_that_overlap_are_refused() {
    let inside = with(vec![circle("h", (0.5, 0.5), 0.3)], SQUARE, &[], "");
    refused((inside.0, vec![inside.1[0].clone(), face("g", "h", &[], "", "")]), ["\"g\" and \"plate\" overlap"]);
    let (curves, faces) = square();
    refused((curves, vec![faces[0].clone(), face("g", SQUARE, &[], "", "")]), ["same side of the curve"]);
    // A face that shares a side and lies within.
    let says = refusal({
        let (mut curves, mut faces) = square();
        curves.push(polyline("tent", &[(0.0, 0.0), (0.5, 0.5), (1.0, 0.0)], false));
        faces.push(face("g", "south tent", &[], "", ""));
        (curves, faces)
    });
    assert!(says.contains("same side") || says.contains("overlap"), "{says}");
    // A crack in the wrong face of two.
    let (mut curves, mut faces) = two_faces();
    curves.push(segment("c", (1.2, 0.5), (1.8, 0.5)));
    faces[0].cracks.push("c".to_owned());
    refused((curves, faces), ["\"c\" lies outside its face \"left\""]);
}

#[test]
fn a_hole_that_touches_the_outer_loop_at_a_vertex_joins_its_walk() {
    let mut specs = square_with_hole();
    specs.0[4] = polyline("hole", &[(0.0, 0.0), (0.3, 0.5), (0.5, 0.3)], true);
    let domain = built(specs);
    assert_eq!(domain.faces[0].walks.iter().map(Vec::len).collect::<Vec<_>>(), [5]);
    assert_eq!(domain.faces[0].loops.len(), 2);
}

#[test]
fn many_curves_are_built_quickly() {
    // A comb of 20,000 teeth in one polyline; 400 holes.
    let mut points: Vec<(f64, f64)> = (0..20_000).map(|i| (f64::from(i), f64::from(i % 2))).collect();
    points.extend([(19_999.0, -50.0), (0.0, -50.0)]);
    let mut curves = vec![polyline("comb", &points, true)];
    let holes: Vec<String> = (0..400).map(|i| format!("h{i}")).collect();
    curves.extend(holes.iter().enumerate().map(|(i, n)| circle(n, (30.0 + 45.0 * i as f64, -25.0), 20.0)));
    let names: Vec<&str> = holes.iter().map(String::as_str).collect();
    let domain = built((curves, vec![face("f", "comb", &names, "", "")]));
    assert_eq!(domain.faces[0].walks.len(), 401);
}
