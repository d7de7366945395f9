//! Promise: the figures of the paper that show one operation each (5-8, 12-14, 16-19) are small cases, and come out as
//! the paper draws them by the converter's own steps. Nodes have the numbers of the case files.
#![allow(clippy::unwrap_used)]

use glam::DVec2;
use quadfront::core::case::built_in;
use quadfront::core::convert::background;
use quadfront::core::convert::{Converter, Event, Phase, Purpose};
use quadfront::core::front::Segment;
use quadfront::core::mesh::{HalfEdgeId, Mesh, NodeId, Refusal};
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

/// Steps until an event is as it is wanted; the mesh before it, and the event.
fn step_to(converter: &mut Converter<'_>, wanted: impl Fn(&Event) -> bool) -> (Mesh, Event) {
    loop {
        assert!(*converter.phase() != Phase::Done, "it never happens");
        let before = converter.mesh.clone();
        let event = converter.step().unwrap();
        if wanted(&event) {
            return (before, event);
        }
    }
}

fn edge(mesh: &Mesh, a: u32, b: u32) -> HalfEdgeId {
    mesh.half_edge_between(NodeId(a), NodeId(b)).unwrap()
}

fn joined(mesh: &Mesh, a: u32, b: u32) -> bool {
    mesh.are_joined(NodeId(a), NodeId(b))
}

/// The nodes of an element from the least one on.
fn from_least(mut nodes: Vec<u32>) -> Vec<u32> {
    let least = (0..nodes.len()).min_by_key(|&k| nodes[k]).unwrap();
    nodes.rotate_left(least);
    nodes
}

/// The elements of a mesh by the numbers of their nodes, each from its least one on, in order.
fn elements(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut all: Vec<Vec<u32>> = mesh.elements().map(|e| from_least(mesh.corners(e).map(|n| n.0).collect())).collect();
    all.sort();
    all
}

fn sorted(elements: impl Iterator<Item = Vec<u32>>) -> Vec<Vec<u32>> {
    let mut all: Vec<Vec<u32>> = elements.collect();
    all.sort();
    all
}

#[test]
fn figure_3_a_swap_and_a_division_make_a_side_and_four_triangles_become_a_quadrilateral() {
    with_figure("figure-3", |mut converter| {
        let events = step_until(&mut converter, |e| matches!(e, Event::Formed { .. }));
        let kinds: Vec<&str> = events.iter().map(|event| event.kind().name()).collect();
        let expected = [
            "base_selected",
            "side_chosen",
            "side_swapped",
            "side_divided",
            "top_swapped",
            "top_smoothed",
            "top_found",
            "formed",
        ];
        assert_eq!(kinds, expected);
        let Some(Event::Formed { nodes, merged, ref swallowed, .. }) = events.last().copied() else { panic!() };
        assert_eq!((nodes.map(|n| n.0), merged, swallowed.to_vec()), ([0, 1, 12, 6], 4, vec![NodeId(10)]));
        converter.mesh.check().unwrap();
    });
}

#[test]
fn figure_4_the_front_runs_between_quadrilaterals_and_triangles_and_along_the_boundary_of_triangles() {
    let mesh = mesh_of("figure-4");
    let live: Vec<_> = mesh.elements().filter(|&e| mesh.is_triangle(e)).collect();
    assert_eq!((live.len(), mesh.elements().count() - live.len()), (14, 5));
    // A side of exactly one live triangle.
    let sides = |e| {
        let nodes: Vec<u32> = mesh.corners(e).map(|n| n.0).collect();
        [0, 1, 2].map(|k| [nodes[k], nodes[(k + 1) % 3]])
    };
    let all: Vec<[u32; 2]> = live.iter().flat_map(|&e| sides(e)).collect();
    let mut alone: Vec<[u32; 2]> = all.iter().copied().filter(|[a, b]| !all.contains(&[*b, *a])).collect();
    let mut front: Vec<[u32; 2]> = mesh.front().map(|h| mesh.ends(h).map(|n| n.0)).collect();
    alone.sort_unstable();
    front.sort_unstable();
    assert_eq!(front, alone);
    assert!(front.contains(&[7, 8]) && front.contains(&[9, 14]) && !front.contains(&[7, 12]));
}

#[test]
fn figure_11_the_h_value_is_the_mean_of_the_smaller_sizes_at_both_ends() {
    with_figure("figure-11", |mut converter| {
        let (before, event) = step_to(&mut converter, |e| matches!(e, Event::BaseSelected { .. }));
        let Event::BaseSelected { a, b, h_value, .. } = event else { panic!() };
        // h2 = 0.5 + 0.1 x is smaller than h1 = 1 + 0.15 x everywhere.
        let size = |n| 0.5 + 0.1 * before.uv(n).x;
        assert!((h_value - 0.5 * (size(a) + size(b))).abs() < 1e-12);
        assert!(size(a) != size(b));
    });
}

#[test]
fn figure_5_two_triangles_are_swapped_where_both_new_angles_stay_below_180_degrees() {
    with_figure("figure-5", |mut converter| {
        let (before, event) = step_to(&mut converter, |e| matches!(e, Event::TopSwapped { .. }));
        let Event::TopSwapped { across, new } = event else { panic!() };
        assert_eq!((across.map(|n| n.0), new.map(|n| n.0)), ([5, 3], [4, 1]));
        assert_eq!(elements(&before), [[0, 1, 5], [1, 2, 3], [1, 3, 5], [3, 4, 5]]);
        assert_eq!(elements(&converter.mesh), [[0, 1, 5], [1, 2, 3], [1, 3, 4], [1, 4, 5]]);
        converter.mesh.check().unwrap();
    });
    // Fig. 5b: at node 7 the two angles add up to more than 180 degrees, at node 6 to just that.
    let mesh = mesh_of("figure-8");
    assert_eq!(mesh.can_swap(edge(&mesh, 4, 7)), Err(Refusal::NotPositive));
    assert_eq!(mesh.can_swap(edge(&mesh, 3, 6)), Err(Refusal::NotPositive));
    assert_eq!(mesh.can_swap(edge(&mesh, 0, 1)), Err(Refusal::OnBoundary));
}

#[test]
fn figure_6_a_seam_collapses_an_edge_and_takes_one_node_and_two_triangles() {
    with_figure("figure-6", |mut converter| {
        let (before, event) = step_to(&mut converter, |e| matches!(e, Event::Seamed { .. }));
        let Event::Seamed { at, node, gone, corner } = event else { panic!() };
        assert_eq!([at, node, gone], [5, 6, 7].map(NodeId));
        assert_eq!(corner.angle.to_degrees().round(), 21.0);
        let standing = [vec![0, 1, 7, 5], vec![3, 4, 5, 6]];
        let live = [[2, 6, 7], [1, 8, 7], [2, 7, 8], [2, 9, 6], [3, 6, 9], [5, 7, 6]];
        assert_eq!(elements(&before), sorted(standing.into_iter().chain(live.map(Vec::from))));
        let standing = [vec![0, 1, 6, 5], vec![3, 4, 5, 6]];
        let live = [[1, 8, 6], [2, 6, 8], [2, 9, 6], [3, 6, 9]];
        assert_eq!(elements(&converter.mesh), sorted(standing.into_iter().chain(live.map(Vec::from))));
        let middle = 0.5 * (before.uv(NodeId(6)) + before.uv(NodeId(7)));
        assert!(converter.mesh.uv(NodeId(6)).distance(middle) < 1e-12);
        assert_eq!(converter.mesh.node_count(), before.node_count() - 1);
        converter.mesh.check().unwrap();
    });
}

#[test]
fn figure_7_dividing_an_edge_makes_four_triangles_of_two() {
    with_figure("figure-7", |mut converter| {
        let (before, event) = step_to(&mut converter, |e| matches!(e, Event::SideDivided { .. }));
        let Event::SideDivided { node, length, .. } = event else { panic!() };
        assert!(node == NodeId(6) && (length - 2.2).abs() < 1e-12);
        assert_eq!(elements(&before), [[0, 1, 5], [1, 2, 3], [1, 3, 4], [1, 4, 5]]);
        let expected = [[0, 1, 5], [1, 2, 3], [1, 3, 6], [1, 6, 5], [3, 4, 6], [4, 5, 6]];
        assert_eq!(elements(&converter.mesh), expected);
        assert_eq!(converter.mesh.uv(node), DVec2::new(0.0, 1.1));
        converter.mesh.check().unwrap();
    });
}

#[test]
fn figure_8_a_node_with_three_triangles_leaves_one_and_one_with_four_leaves_two() {
    with_figure("figure-8", |mut converter| {
        let removed = |e: &Event| matches!(e, Event::NodeRemoved { purpose: Purpose::Enhancement, .. });
        let (formed, outer) = (vec![0, 1, 2, 3], vec![1, 8, 2]);
        let three = [[2, 7, 4], [2, 8, 7], [4, 7, 8]].map(Vec::from);
        let four = [[2, 4, 6], [2, 6, 3], [3, 6, 5], [4, 5, 6]].map(Vec::from);
        let standing = || [formed.clone(), outer.clone()].into_iter();
        let (before, event) = step_to(&mut converter, removed);
        assert!(matches!(event, Event::NodeRemoved { node: NodeId(6), .. }), "{event:?}");
        assert_eq!(elements(&before), sorted(standing().chain(three.clone()).chain(four)));
        // 2-5 is the shorter diagonal of 3-2-4-5.
        let length = |a, b| before.uv(NodeId(a)).distance(before.uv(NodeId(b)));
        assert!(length(2, 5) < length(3, 4));
        let two = [[2, 4, 5], [2, 5, 3]].map(Vec::from);
        assert_eq!(elements(&converter.mesh), sorted(standing().chain(three).chain(two.clone())));

        let event = converter.step().unwrap();
        assert!(removed(&event) && matches!(event, Event::NodeRemoved { node: NodeId(7), .. }), "{event:?}");
        assert_eq!(elements(&converter.mesh), sorted(standing().chain([vec![2, 8, 4]]).chain(two)));
        converter.mesh.check().unwrap();
    });
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
fn a_top_edge_that_swaps_alone_do_not_recover_is_recovered_by_smoothing_after_a_swap() {
    let told = |converter: &mut Converter<'_>| {
        let events = step_until(converter, |e| matches!(e, Event::Formed { .. } | Event::RolledBack { .. }));
        let told = |event: &Event| match *event {
            Event::TopSwapped { across, new } => format!("{:?} to {:?}", across.map(|n| n.0), new.map(|n| n.0)),
            Event::TopSmoothed { nodes } => format!("{nodes} nodes smoothed"),
            Event::TopFound { ends, swaps } => format!("{:?} after {swaps}", ends.map(|n| n.0)),
            Event::Formed { nodes, attempt, .. } => format!("{:?} formed in attempt {attempt}", nodes.map(|n| n.0)),
            Event::RolledBack { why, .. } => format!("{why:?}"),
            ref other => panic!("{other:?}"),
        };
        events[3..].iter().map(told).collect::<Vec<String>>()
    };
    with_figure("top-smoothing", |mut converter| {
        let expected = [
            "[6, 9] to [5, 7]",
            "3 nodes smoothed",
            "[7, 9] to [5, 10]",
            "4 nodes smoothed",
            "[7, 10] to [5, 8]",
            "5 nodes smoothed",
            "[8, 10] to [5, 2]",
            "5 nodes smoothed",
            "[5, 2] after 4",
            "[0, 1, 2, 5] formed in attempt 0",
        ];
        assert_eq!(told(&mut converter), expected);
        converter.mesh.check().unwrap();
    });
    with_figure("top-smoothing", |mut converter| {
        let mut parameters = converter.parameters().clone();
        parameters.top_smoothing = false;
        converter.set_parameters(parameters);
        assert_eq!(told(&mut converter), ["[6, 9] to [5, 7]", "TopStuck"]);
    });
    // What the first smoothing changes: the corner at node 9 beside the swap to 5-10 is reflex before, and not after.
    with_figure("top-smoothing", |mut converter| {
        let (before, _) = step_to(&mut converter, |e| matches!(e, Event::TopSmoothed { .. }));
        let side = |mesh: &Mesh| {
            let [p, q, r] = [5, 10, 9].map(|n| mesh.uv(NodeId(n)));
            (q - p).perp_dot(r - p)
        };
        assert!(side(&before) < 0.0 && side(&converter.mesh) > 0.0);
    });
}

#[test]
fn figure_16_enhancement_swaps_the_edge_with_the_largest_angle_and_removes_the_node_that_keeps_four_triangles() {
    let largest = |mesh: &Mesh, nodes: [u32; 3]| {
        let [p, q, r] = nodes.map(|n| mesh.uv(NodeId(n)));
        [(p, q, r), (q, r, p), (r, p, q)]
            .map(|(at, to, from)| (to - at).angle_to(from - at).to_degrees())
            .into_iter()
            .fold(0.0, f64::max)
    };
    for order in ["swap_first", "delete_first"] {
        with_figure("figure-16", |mut converter| {
            let mut parameters = converter.parameters().clone();
            parameters.set("enhancement_order", order).unwrap();
            converter.set_parameters(parameters);
            let (before, event) = step_to(&mut converter, |e| matches!(e, Event::Enhanced { .. }));
            let swap = Event::Enhanced { new: [NodeId(5), NodeId(2)] };
            assert_eq!(event, swap, "{order}");
            let (formed, others) = (vec![0, 1, 2, 3], [[1, 4, 2], [2, 7, 3], [3, 7, 6], [5, 6, 7]].map(Vec::from));
            let standing = || others.iter().cloned().chain([formed.clone()]);
            assert_eq!(elements(&before), sorted(standing().chain([vec![2, 4, 7], vec![4, 5, 7]])));
            let swapped = converter.mesh.clone();
            assert_eq!(elements(&swapped), sorted(standing().chain([vec![2, 4, 5], vec![2, 5, 7]])));
            let worst =
                |mesh: &Mesh, pair: [[u32; 3]; 2]| pair.map(|t| largest(mesh, t)).into_iter().fold(0.0, f64::max);
            let angles = [worst(&before, [[2, 4, 7], [4, 5, 7]]), worst(&swapped, [[2, 4, 5], [2, 5, 7]])];
            assert_eq!(angles.map(|angle: f64| angle.round()), [105.0, 92.0]);

            assert_eq!(swapped.live_fan(NodeId(7)).count(), 4);
            let event = converter.step().unwrap();
            assert_eq!(event, Event::NodeRemoved { node: NodeId(7), purpose: Purpose::Enhancement });
            let left = [[1, 4, 2], [2, 4, 5], [2, 5, 3], [3, 5, 6]].map(Vec::from);
            assert_eq!(elements(&converter.mesh), sorted(left.into_iter().chain([formed])));
            converter.mesh.check().unwrap();
        });
    }
}

/// The metric of the case of figure 17, from its formulas: sizes along x and y.
fn sizes_of_figure_17(p: DVec2) -> DVec2 {
    DVec2::new(0.8 * libm::exp(0.5 * p.x), 0.5 * libm::exp(0.7 * p.x))
}

#[test]
fn figure_17_a_node_moves_to_the_mean_of_centroids_weighted_by_areas() {
    // Eq. (4), with the metrics of both ends (docs/algorithm.md, "Lengths and angles").
    let length = |a: DVec2, b: DVec2| {
        let [l_a, l_b] = [a, b].map(|at| ((b - a) / sizes_of_figure_17(at)).length());
        (4.0 * (l_a * l_b).sqrt() + l_a + l_b) / 6.0
    };
    // Eqs. (10a) and (10b) as printed: lengths from P and the angle between them in the metric of P.
    let printed = |corners: &[DVec2]| {
        let p = corners[0];
        let triangle = |pair: &[DVec2]| {
            let [a, b] = [pair[0], pair[1]].map(|q| (q - p) / sizes_of_figure_17(p));
            0.5 * length(p, pair[0]) * length(p, pair[1]) * libm::sin(a.angle_to(b))
        };
        corners[1..].windows(2).map(triangle).sum::<f64>()
    };
    // The default: the area in the plane times the mean of sqrt(det M) = 1 / (h1 h2) over the corners.
    let by_determinant = |corners: &[DVec2]| {
        let twice: f64 = (0..corners.len()).map(|k| corners[k].perp_dot(corners[(k + 1) % corners.len()])).sum();
        let root = |p: &DVec2| 1.0 / (sizes_of_figure_17(*p).x * sizes_of_figure_17(*p).y);
        0.5 * twice * corners.iter().map(root).sum::<f64>() / corners.len() as f64
    };
    type Area<'a> = &'a dyn Fn(&[DVec2]) -> f64;
    let mut targets = Vec::new();
    for (weights, area) in [("printed", &printed as Area<'_>), ("determinant", &by_determinant)] {
        with_figure("figure-17", |mut converter| {
            let mut parameters = converter.parameters().clone();
            parameters.set("smoothing_weights", weights).unwrap();
            converter.set_parameters(parameters);
            let (mesh, event) = step_to(&mut converter, |e| matches!(e, Event::Smoothed { .. }));
            assert_eq!(event, Event::Smoothed { nodes: 1 });
            let node = NodeId(4);
            // Eq. (9), over the elements before.
            let (mut sum, mut total) = (DVec2::ZERO, 0.0);
            for e in mesh.fan(node).map(HalfEdgeId::element) {
                let mut nodes: Vec<NodeId> = mesh.corners(e).collect();
                let at = nodes.iter().position(|&n| n == node).unwrap();
                nodes.rotate_left(at);
                let corners: Vec<DVec2> = nodes.iter().map(|&n| mesh.uv(n)).collect();
                sum += area(&corners) * corners.iter().sum::<DVec2>() / corners.len() as f64;
                total += area(&corners);
            }
            assert_eq!(mesh.fan(node).filter(|h| mesh.is_quad(h.element())).count(), 1, "both kinds are weighted");
            let target = sum / total;
            let (before, moved) = (mesh.uv(node), converter.mesh.uv(node));
            assert!(moved.distance(target) < 1e-12 && moved.distance(before) > 0.1, "{weights}: {moved}, not {target}");
            targets.push(target);
        });
    }
    let apart = targets[0] - targets[1];
    assert!((0.065..0.075).contains(&apart.x), "the two differ clearly: {targets:?}");
}

#[test]
fn figure_18_seaming_recovers_the_edge_between_the_far_ends_and_collapses_it() {
    with_figure("figure-18", |mut converter| {
        let (live, standing) = (10, 1);
        assert_eq!(converter.mesh.element_count(), live + standing);
        let (before, event) = step_to(&mut converter, |e| matches!(e, Event::Seamed { .. }));
        let Event::Seamed { at, node, gone, corner } = event else { panic!() };
        assert!(joined(&before, 1, 8) && !joined(&before, 9, 10), "the edge 1-8 is to be swapped first");
        // One swap and the collapse take 1-9-8 and 1-8-10 away, and what was at 9 is at 10.
        let kept = elements(&before).into_iter().filter(|nodes| ![vec![1, 8, 10], vec![1, 9, 8]].contains(nodes));
        let moved = kept.map(|nodes| from_least(nodes.into_iter().map(|n| if n == 9 { 10 } else { n }).collect()));
        assert_eq!(elements(&converter.mesh), sorted(moved));
        assert_eq!((at, node, gone), (NodeId(1), NodeId(10), NodeId(9)));
        assert!((20.0..20.5).contains(&corner.angle.to_degrees()));
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
        let [Event::TransitionSeamed { at, node, gone, corner }] = events[..] else { panic!("{events:?}") };
        assert_eq!((at, node, gone), (NodeId(1), NodeId(8), NodeId(9)));
        assert!(corner.angle.to_degrees() < 30.0 && (2.5..2.7).contains(&corner.ratio));
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
        let letters = |mesh: &Mesh, e| {
            let mut letters: Vec<&str> = mesh.triangle(e).iter().map(|n| LETTERS[n.index()]).collect();
            letters.sort_unstable();
            letters.concat()
        };
        let narrow = converter.narrow().unwrap();
        let mut t: Vec<String> = narrow.on_front.iter().map(|t| letters(&converter.mesh, t.element)).collect();
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
            let expected = match segment.a.0 {
                3 => 0,
                0 | 5 | 7 | 8 => 1,
                1 | 2 | 9 => 2,
                _ => 3,
            };
            assert_eq!(class(segment.theta[0]), expected, "node {}", segment.a.0);
        }
        // Every corner is the left one of one segment and the right one of another.
        assert_eq!(classes, [[1, 4, 3, 2]; 2], "seam, side, between, reverse");
    });
}

/// Figure 13: all segments have the same H-value, though some are four times as long as others.
#[test]
fn figure_13_has_one_h_value_and_by_length_alone_only_short_segments_are_bases() {
    let bases = |selection: &str, count: usize| {
        let mut lengths = Vec::new();
        let mut case = built_in::named("figure-13").unwrap().unwrap();
        case.parameters.set("selection", selection).unwrap();
        let made = background(&case, &mut Nobody).unwrap();
        let mut converter = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
        for h in converter.mesh.front() {
            let h_value = Segment::measure(&converter.mesh, h, converter.parameters()).h_value;
            assert!((h_value - 0.25).abs() < 1e-12, "{h_value}");
        }
        while lengths.len() < count {
            if let Event::BaseSelected { a, b, .. } = converter.step().unwrap() {
                lengths.push(converter.mesh.uv(a).distance(converter.mesh.uv(b)));
            }
        }
        lengths
    };
    assert!(bases("shortest", 6).iter().all(|length| (length - 0.25).abs() < 1e-9));
    let lengths = bases("table1", 8);
    assert!(
        [0.25, 1.0].iter().all(|wanted| lengths.iter().any(|length| (length - wanted).abs() < 1e-9)),
        "{lengths:?}"
    );
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
