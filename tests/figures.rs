//! Promise: the figures of the paper that show one operation each (5-8, 12-14, 16-19) are small cases, and come out as
//! the paper draws them. Nodes have the numbers of the case files.
#![allow(clippy::unwrap_used)]

use glam::DVec2;
use quadfront::core::case::built_in;
use quadfront::core::convert::{Converter, Event, Phase, Purpose};
use quadfront::core::front::Segment;
use quadfront::core::kernel::Metric2;
use quadfront::core::mesh::{HalfEdgeId, Mesh, NodeId, Refusal};
use quadfront::core::prepare::background;
use quadfront::core::progress::Nobody;

fn mesh_of(name: &str) -> Mesh {
    background(&built_in::named(name).unwrap().unwrap(), &mut Nobody).unwrap().mesh
}

/// Calls `look` with a converter of a figure at step 0.
fn with_figure(name: &str, look: impl FnOnce(Converter<'_>)) {
    let case = built_in::named(name).unwrap().unwrap();
    let made = background(&case, &mut Nobody).unwrap();
    look(Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone()));
}

/// Steps until an event is as it is wanted, which it is told by; all events up to it.
fn step_until(converter: &mut Converter<'_>, wanted: impl Fn(&Event) -> bool) -> Vec<Event> {
    let mut events = Vec::new();
    while events.last().is_none_or(|event| !wanted(event)) {
        assert!(*converter.phase() != Phase::Done, "it never happens: {events:?}");
        events.push(converter.step().unwrap());
    }
    events
}

fn edge(mesh: &Mesh, a: u32, b: u32) -> HalfEdgeId {
    mesh.half_edge_between(NodeId(a), NodeId(b)).unwrap()
}

fn joined(mesh: &Mesh, a: u32, b: u32) -> bool {
    mesh.are_joined(NodeId(a), NodeId(b))
}

/// The elements of a mesh by the numbers of their nodes, each from its least one on, in order.
fn elements(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut all: Vec<Vec<u32>> = mesh
        .elements()
        .map(|e| {
            let mut nodes: Vec<u32> = mesh.corners(e).map(|n| n.0).collect();
            let least = (0..nodes.len()).min_by_key(|&k| nodes[k]).unwrap();
            nodes.rotate_left(least);
            nodes
        })
        .collect();
    all.sort();
    all
}

#[test]
fn figure_5_two_triangles_are_swapped_where_both_new_angles_stay_below_180_degrees() {
    let mut mesh = mesh_of("figure-5");
    let h = edge(&mesh, 5, 3);
    mesh.can_swap(h).unwrap();
    mesh.swap(h);
    mesh.check().unwrap();
    assert_eq!(elements(&mesh), [vec![0, 1, 5], vec![1, 2, 3], vec![1, 3, 4], vec![1, 4, 5]]);
    // Fig. 5b: at node 7 the two angles add up to more than 180 degrees, at node 6 to just that.
    let mesh = mesh_of("figure-8");
    assert_eq!(mesh.can_swap(edge(&mesh, 1, 7)), Err(Refusal::NotPositive));
    assert_eq!(mesh.can_swap(edge(&mesh, 0, 6)), Err(Refusal::NotPositive));
    assert_eq!(mesh.can_swap(edge(&mesh, 0, 1)), Err(Refusal::OnBoundary));

    with_figure("figure-5", |mut converter| {
        let events = step_until(&mut converter, |e| matches!(e, Event::TopSwapped { .. }));
        let Some(Event::TopSwapped { across, new }) = events.last() else { panic!() };
        assert_eq!((across.map(|n| n.0), new.map(|n| n.0)), ([5, 3], [4, 1]));
    });
}

#[test]
fn figure_6_collapsing_an_edge_takes_one_node_and_two_triangles() {
    let mut mesh = mesh_of("figure-6");
    let (h, middle) = (edge(&mesh, 6, 7), DVec2::ZERO);
    mesh.can_collapse(h, middle).unwrap();
    mesh.collapse(h, middle, Metric2::isotropic(1.0));
    mesh.check().unwrap();
    let expected = [[0, 1, 7], [0, 7, 5], [1, 2, 7], [2, 3, 7], [3, 4, 7], [4, 5, 7]];
    assert_eq!(elements(&mesh), expected);
    assert_eq!((mesh.uv(NodeId(7)), mesh.node_count()), (middle, 7));
}

#[test]
fn figure_7_dividing_an_edge_makes_four_triangles_of_two() {
    let mut mesh = mesh_of("figure-7");
    let m = mesh.divide(edge(&mesh, 1, 4), DVec2::new(0.0, 1.1), Metric2::isotropic(1.0)).unwrap();
    mesh.check().unwrap();
    assert_eq!(m, NodeId(6));
    let expected = [[0, 1, 5], [1, 2, 3], [1, 3, 6], [1, 6, 5], [3, 4, 6], [4, 5, 6]];
    assert_eq!(elements(&mesh), expected);

    with_figure("figure-7", |mut converter| {
        step_until(&mut converter, |e| matches!(e, Event::SideDivided { .. }));
        assert_eq!(elements(&converter.mesh), expected);
        assert_eq!(converter.mesh.uv(m), DVec2::new(0.0, 1.1));
    });
}

#[test]
fn figure_8_a_node_with_three_triangles_leaves_one_and_one_with_four_leaves_two() {
    let mut mesh = mesh_of("figure-8");
    mesh.delete_node(NodeId(7)).unwrap();
    mesh.delete_node(NodeId(6)).unwrap();
    mesh.check().unwrap();
    // 1-3 is the shorter diagonal of 0-1-2-3.
    assert_eq!(elements(&mesh), [[0, 1, 3], [0, 3, 4], [1, 2, 3], [1, 5, 2]]);
}

#[test]
fn figure_14_a_top_edge_is_recovered_by_swaps_and_where_none_is_possible_by_removing_a_node() {
    with_figure("figure-14", |mut converter| {
        let events = step_until(&mut converter, |e| matches!(e, Event::Formed { .. }));
        let told: Vec<(&str, Vec<u32>)> = events[3..]
            .iter()
            .map(|event| match event {
                Event::TopSwapped { across, new } => {
                    ("swap", across.iter().chain(new).map(|n| n.0).collect::<Vec<u32>>())
                }
                Event::NodeRemoved { node, purpose: Purpose::Recovery } => ("remove", vec![node.0]),
                Event::TopFound { ends, .. } => ("found", ends.map(|n| n.0).to_vec()),
                Event::Formed { nodes, .. } => ("formed", nodes.map(|n| n.0).to_vec()),
                other => panic!("{other:?}"),
            })
            .collect();
        let expected = [
            ("swap", vec![6, 9, 5, 7]),
            ("remove", vec![9]),
            ("swap", vec![7, 10, 5, 8]),
            ("swap", vec![8, 10, 5, 2]),
            ("found", vec![5, 2]),
            ("formed", vec![0, 1, 2, 5]),
        ];
        assert_eq!(told, expected);
        converter.mesh.check().unwrap();
    });
}

#[test]
fn figure_16_enhancement_swaps_the_edge_with_the_largest_angle_and_removes_the_node_of_three_triangles() {
    with_figure("figure-16", |mut converter| {
        let formed = step_until(&mut converter, |e| matches!(e, Event::Formed { .. }));
        let Some(Event::Formed { nodes, .. }) = formed.last() else { panic!() };
        assert_eq!(nodes.map(|n| n.0), [0, 1, 2, 3]);
        let events = step_until(&mut converter, |e| matches!(e, Event::NodeRemoved { .. }));
        let Event::Enhanced { new } = events[0] else { panic!("{events:?}") };
        assert_eq!(new.map(|n| n.0), [2, 6]);
        let removed = Event::NodeRemoved { node: NodeId(8), purpose: Purpose::Enhancement };
        assert_eq!(events.last(), Some(&removed));
        assert!(!joined(&converter.mesh, 3, 5) && joined(&converter.mesh, 2, 6));
        assert_eq!(
            elements(&converter.mesh),
            [vec![0, 1, 2, 3], vec![2, 4, 5], vec![2, 5, 6], vec![2, 6, 3], vec![3, 6, 7]]
        );
    });
}

#[test]
fn figure_17_a_node_moves_to_the_mean_of_centroids_weighted_by_areas() {
    with_figure("figure-17", |mut converter| {
        step_until(&mut converter, |e| matches!(e, Event::Formed { .. }));
        let mesh = &converter.mesh;
        let p = mesh.uv(NodeId(4));
        // Eqs. (9), (10a) and (10b) as they are printed; the metric is the identity, so that lengths and angles are the
        // plane's.
        let triangle = |a: DVec2, b: DVec2| {
            let (a, b) = (a - p, b - p);
            0.5 * a.length() * b.length() * libm::sin(a.angle_to(b))
        };
        let (mut sum, mut total) = (DVec2::ZERO, 0.0);
        for e in mesh.fan(NodeId(4)).map(HalfEdgeId::element) {
            let nodes: Vec<NodeId> = mesh.corners(e).collect();
            let at = nodes.iter().position(|&n| n == NodeId(4)).unwrap();
            let corner = |k: usize| mesh.uv(nodes[(at + k) % nodes.len()]);
            let area = if mesh.is_triangle(e) {
                triangle(corner(1), corner(2))
            } else {
                // l' is the diagonal from P, corner 2; alpha and beta lie on its two sides.
                triangle(corner(1), corner(2)) + triangle(corner(2), corner(3))
            };
            let centroid = nodes.iter().map(|&n| mesh.uv(n)).sum::<DVec2>() / nodes.len() as f64;
            sum += centroid * area;
            total += area;
        }
        assert_eq!(mesh.fan(NodeId(4)).filter(|h| mesh.is_quad(h.element())).count(), 1, "both kinds are weighted");
        let events = step_until(&mut converter, |e| matches!(e, Event::Smoothed { .. }));
        assert_eq!(events.last(), Some(&Event::Smoothed { nodes: 1 }));
        let moved = converter.mesh.uv(NodeId(4));
        assert!(moved.distance(sum / total) < 1e-12 && moved.distance(p) > 0.1, "{p} to {moved}, not {}", sum / total);
    });
}

#[test]
fn figure_18_seaming_recovers_the_edge_between_the_far_ends_and_collapses_it() {
    with_figure("figure-18", |mut converter| {
        let (live, standing) = (10, 1);
        assert_eq!(converter.mesh.element_count(), live + standing);
        step_until(&mut converter, |e| matches!(e, Event::Formed { .. }));
        assert!(joined(&converter.mesh, 1, 8) && !joined(&converter.mesh, 9, 10));
        let events = step_until(&mut converter, |e| matches!(e, Event::Seamed { .. }));
        let [Event::Seamed { at, node, gone, angle }] = events[..] else { panic!("{events:?}") };
        assert_eq!((at, node, gone), (NodeId(1), NodeId(10), NodeId(9)));
        assert!((20.0..20.5).contains(&angle.to_degrees()));
        let mesh = &converter.mesh;
        mesh.check().unwrap();
        assert!(!mesh.has_node(NodeId(9)) && mesh.uv(node).distance(DVec2::new(0.0, 0.9)) < 1e-12);
        let between = mesh.twin(edge(mesh, 1, 10)).unwrap();
        assert!(mesh.is_quad(between.element()) && mesh.is_quad(edge(mesh, 1, 10).element()), "the seam is dead");
        // Two triangles for the quadrilateral that was formed, two for the seam.
        assert_eq!(mesh.elements().filter(|&e| mesh.is_triangle(e)).count(), live - 4);
    });
}

#[test]
fn a_transition_seam_divides_the_longer_segment_and_frees_a_triangle_of_the_quadrilateral_beyond() {
    with_figure("transition-seam", |mut converter| {
        let formed = step_until(&mut converter, |e| matches!(e, Event::Formed { .. }));
        let Some(&Event::Formed { element, nodes, .. }) = formed.last() else { panic!() };
        assert_eq!(nodes.map(|n| n.0), [2, 3, 4, 1]);
        let live = |mesh: &Mesh| mesh.elements().filter(|&e| mesh.is_triangle(e)).count();
        let before = live(&converter.mesh);
        let events = step_until(&mut converter, |e| matches!(e, Event::TransitionSeamed { .. }));
        let [Event::TransitionSeamed { at, node, gone, angle, ratio }] = events[..] else { panic!("{events:?}") };
        assert_eq!((at, node, gone), (NodeId(1), NodeId(8), NodeId(9)));
        assert!(angle.to_degrees() < 30.0 && (2.5..2.7).contains(&ratio));
        let mesh = &converter.mesh;
        mesh.check().unwrap();
        // Two more by the division, two fewer by the seam; the quadrilateral is the same one with its corner elsewhere.
        assert_eq!(live(mesh), before);
        let mut corners = mesh.quad(element).map(|n| n.0);
        corners.sort_unstable();
        assert_eq!(corners, [1, 2, 3, 8]);
        let seam = edge(mesh, 1, 8);
        assert!(mesh.is_quad(seam.element()) && mesh.is_quad(mesh.twin(seam).unwrap().element()), "the seam is dead");
        assert!(
            mesh.front_between(NodeId(8), NodeId(3)).is_some() && mesh.front_between(NodeId(3), NodeId(4)).is_some()
        );
    });
}

#[test]
fn figure_19_the_front_is_split_at_the_edge_that_leaves_two_even_loops() {
    with_figure("figure-19", |mut converter| {
        const LETTERS: [&str; 6] = ["A", "B", "C", "D", "E", "F"];
        step_until(&mut converter, |e| matches!(e, Event::Formed { .. }));
        let element = converter.phase().last_formed().unwrap();
        let letters = |mesh: &Mesh, e| {
            let mut letters: Vec<&str> = mesh.triangle(e).iter().map(|n| LETTERS[n.index()]).collect();
            letters.sort_unstable();
            letters.concat()
        };
        let narrow = converter.narrow(element);
        let mut t: Vec<String> = narrow.on_front.iter().map(|&e| letters(&converter.mesh, e)).collect();
        t.sort_unstable();
        assert_eq!(t, ["ABC", "ABE", "ACF", "ADE"]);
        let v: Vec<String> = narrow.slender.iter().map(|s| letters(&converter.mesh, s.element)).collect();
        assert_eq!(v, ["ABE", "ABC"], "the least area over ratio first");
        let parameters = converter.parameters().clone();
        assert!(narrow.slender.iter().all(|s| s.area < parameters.eps1 && s.ratio > parameters.eps2));

        let events = step_until(&mut converter, |e| matches!(e, Event::Split { .. }));
        let [Event::Split { node, gone, segments, .. }] = events[..] else { panic!("{events:?}") };
        assert_eq!((gone, node, segments), (NodeId(0), NodeId(2), [4, 4]), "A goes to C");
        let mesh = &converter.mesh;
        mesh.check().unwrap();
        let around = |start: HalfEdgeId| {
            let mut nodes = vec![mesh.origin(start).0];
            let mut h = mesh.front_after(start);
            while h != start {
                nodes.push(mesh.origin(h).0);
                h = mesh.front_after(h);
            }
            nodes
        };
        let front = |a, b| mesh.front_between(NodeId(a), NodeId(b)).unwrap();
        assert_eq!(around(front(2, 1)), [2, 1, 4, 3], "C, B, E, D");
        assert_eq!(around(front(5, 2)), [5, 2, 6, 8], "F, C and the two nodes beyond");
    });
}

/// Figure 12: the classes of frontal angles, by the bounds theta_seam, theta_rect and theta_revr.
#[test]
fn figure_12_has_a_node_of_every_class_of_frontal_angles() {
    with_figure("figure-12", |converter| {
        let parameters = converter.parameters();
        let bounds = [parameters.theta_seam, parameters.theta_rect, parameters.theta_revr];
        let class = |theta: f64| bounds.iter().filter(|bound| theta > **bound).count();
        let mut classes = [[0; 4], [0; 4]];
        for h in converter.mesh.front() {
            let segment = Segment::measure(&converter.mesh, h, parameters);
            for (theta, count) in segment.theta.iter().zip(&mut classes) {
                count[class(*theta)] += 1;
            }
            if segment.a == NodeId(3) {
                assert!((segment.theta[0].to_degrees() - 20.136).abs() < 1e-3, "{}", segment.theta[0].to_degrees());
            }
        }
        // Every corner is the left one of one segment and the right one of another.
        assert_eq!(classes, [[1, 4, 3, 2]; 2], "seam, side, between, reverse");
    });
}

/// Figure 13: all segments have the same H-value, though some are four times as long as others.
#[test]
fn figure_13_has_one_h_value_and_by_length_alone_only_short_segments_are_bases() {
    let bases = |selection: &str| {
        let mut lengths = Vec::new();
        let mut case = built_in::named("figure-13").unwrap().unwrap();
        case.parameters.set("selection", selection).unwrap();
        let made = background(&case, &mut Nobody).unwrap();
        let mut converter = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
        for h in converter.mesh.front() {
            let h_value = Segment::measure(&converter.mesh, h, converter.parameters()).h_value;
            assert!((h_value - 0.25).abs() < 1e-12, "{h_value}");
        }
        while lengths.len() < 6 {
            if let Event::BaseSelected { a, b, .. } = converter.step().unwrap() {
                lengths.push(converter.mesh.uv(a).distance(converter.mesh.uv(b)));
            }
        }
        lengths
    };
    assert!(bases("shortest").iter().all(|length| (length - 0.25).abs() < 1e-9));
    assert!(bases("table1").iter().all(|length| (length - 1.0).abs() < 1e-9), "both are as good by eq. 6");
}

#[test]
fn every_figure_ends_in_quadrilaterals() {
    for (name, _) in built_in::FIGURES {
        with_figure(name, |mut converter| {
            converter.run(&mut Nobody).unwrap();
            let mesh = &converter.mesh;
            mesh.check().unwrap();
            assert!(mesh.elements().all(|e| mesh.is_quad(e)), "{name}");
        });
    }
}
