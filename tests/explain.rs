//! Promise: what is told about a choice is true: the table of the front says what will be chosen, and a margin says how
//! far a parameter may go without another choice.
#![allow(clippy::unwrap_used)]

use quadfront::core::case::{Parameters, built_in};
use quadfront::core::convert::{Converter, Event, Phase};
use quadfront::core::mesh::NodeId;
use quadfront::core::progress::Nobody;
use quadfront::core::run::{
    Corner, EdgeFacts, EdgeKind, ElementFacts, FrontTable, NodeFacts, Run, SegmentFacts, Selecting, Verdict,
};

/// Calls `look` with each state before a selection and the base that was selected.
fn selections(name: &str, settings: &[(&str, &str)], mut look: impl FnMut(u64, &Converter<'_>, [NodeId; 2])) {
    let mut run = Run::of(built_in::named(name).unwrap().unwrap());
    for (key, value) in settings {
        run.parameters.set(key, value).unwrap();
    }
    let background = run.background(&mut Nobody).unwrap();
    let mut converter = run.start(&background).unwrap();
    while *converter.phase() != Phase::Done {
        let before = converter.clone();
        if let Event::BaseSelected { a, b, .. } = converter.step().unwrap() {
            look(converter.counts.steps, &before, [a, b]);
        }
    }
}

/// A segment at the next selection.
fn at_the_next(state: &Converter<'_>, [a, b]: [NodeId; 2]) -> SegmentFacts {
    Selecting::next(state).unwrap().explain(state, a, b).unwrap()
}

/// What is selected from a state with other parameters.
fn selected(state: &Converter<'_>, change: impl FnOnce(&mut Parameters)) -> Option<[NodeId; 2]> {
    let mut converter = state.clone();
    let mut parameters = state.parameters().clone();
    change(&mut parameters);
    converter.set_parameters(parameters);
    match converter.step().unwrap() {
        Event::BaseSelected { a, b, .. } => Some([a, b]),
        _ => None,
    }
}

#[test]
fn the_first_of_the_front_table_is_what_is_selected_next() {
    for settings in [
        &[][..],
        &[("selection_window", "physical_length"), ("c", "1.5")],
        &[("selection_window", "h_value"), ("layers", "2")],
        &[("selection", "shortest")],
        &[("selection", "smallest_angle")],
        &[("selection", "level"), ("layers", "1")],
    ] {
        let mut count = 0;
        selections("example1", settings, |step, state, [a, b]| {
            let table = FrontTable::of(state);
            let choice = table.choice().unwrap();
            assert_eq!([choice.a, choice.b], [a, b], "step {step}, {settings:?}");
            assert_eq!(table.rank(choice), Some(0));
            assert_eq!(table.loops.iter().map(|l| l.segments as usize).sum::<usize>(), table.rows.len());
            assert!(table.loops.iter().all(|l| l.segments.is_multiple_of(2)));
            count += 1;
        });
        assert!(count > 150, "{count}");
    }
}

#[test]
fn within_its_margins_a_choice_stays_and_beyond_them_it_does_not() {
    let (mut checked, mut bounded) = (0, [0; 4]);
    selections("example1", &[("c", "1.6")], |step, state, base| {
        if !step.is_multiple_of(3) {
            return;
        }
        let told = at_the_next(state, base);
        assert_eq!(told.verdict, Verdict::First);
        let [low, high] = told.margin_of_c.unwrap();
        let with_c = |c: f64| selected(state, |p| p.c = c);
        let inside = low + (if high.is_finite() { high } else { low + 9.0 } - low) * 0.999;
        for c in [inside, low + 1e-6 * (inside - low)] {
            assert_eq!(with_c(c), Some(base), "step {step}, c = {c} of {low} to {high}");
        }
        if low > 0.0 {
            assert_ne!(with_c(low * (1.0 - 1e-9)), Some(base), "step {step}, below {low}");
            bounded[0] += 1;
        }
        if high.is_finite() {
            assert_ne!(with_c(high * (1.0 + 1e-9)), Some(base), "step {step}, above {high}");
            bounded[1] += 1;
        }
        let [low, high] = told.margin_of_theta_rect.unwrap().map(f64::to_radians);
        // Only the classes shall change, not what else looks at theta_rect: a selection alone does not.
        let with_rect = |theta: f64| selected(state, |p| p.theta_rect = theta);
        for share in [1e-6, 0.3, 0.7, 1.0 - 1e-6] {
            let theta = low + (high - low) * share;
            assert_eq!(with_rect(theta), Some(base), "step {step}, theta_rect = {theta} of {low} to {high}");
        }
        if low > 90.001_f64.to_radians() {
            assert_ne!(with_rect(low - 1e-9), Some(base), "step {step}, below {low}");
            bounded[2] += 1;
        }
        if high < 179.999_f64.to_radians() {
            assert_ne!(with_rect(high + 1e-9), Some(base), "step {step}, above {high}");
            bounded[3] += 1;
        }
        checked += 1;
    });
    assert!(checked > 40, "{checked}");
    assert!(bounded.iter().all(|&count| count > 3), "{bounded:?}");
}

#[test]
fn every_segment_has_its_reason_in_words() {
    let mut seen = std::collections::BTreeSet::new();
    selections("example1", &[("layers", "1")], |step, state, base| {
        if !step.is_multiple_of(40) {
            return;
        }
        let selecting = Selecting::next(state).unwrap();
        for row in &selecting.table.rows {
            let told = selecting.explain(state, row.a, row.b).unwrap();
            assert_eq!(told.verdict == Verdict::First, [row.a, row.b] == base);
            assert_eq!(told.rank.is_none(), told.verdict == Verdict::Deferred);
            let text = told.to_string();
            assert!(text.contains("eq. 6"), "{text}");
            assert!(!told.why.is_empty() && told.why.iter().all(|sentence| sentence.ends_with('.')), "{text}");
            seen.insert(format!("{:?}", told.verdict).split([' ', '{']).next().unwrap().to_owned());
        }
    });
    for verdict in ["First", "LaterRow", "OutOfReach", "BetterClass", "LargerKey"] {
        assert!(seen.contains(verdict), "{verdict} is not among {seen:?}");
    }
}

#[test]
fn an_order_of_selection_is_named_whatever_the_window() {
    let settings = [("selection", "smallest_angle"), ("selection_window", "physical_length")];
    let mut seen = 0;
    selections("figure-14", &settings, |_, state, [a, b]| {
        let text = at_the_next(state, [a, b]).to_string();
        assert!(text.contains("it comes first by sum of frontal angles"), "{text}");
        seen += 1;
    });
    assert!(seen > 0);
}

#[test]
fn the_explanations_put_the_numbers_into_the_formulas() {
    let mut texts = Vec::new();
    // A case whose mesh is given: no text changes with the conversion.
    selections("figure-19", &[("selection", "table1")], |_, state, [a, b]| {
        if texts.is_empty() {
            let mesh = &state.mesh;
            let told = at_the_next(state, [a, b]);
            let by_equation = 0.5 * told.metric.map(|m| 1.0 / m.lambda[1].sqrt()).iter().sum::<f64>();
            assert!((told.row.h_value / by_equation - 1.0).abs() < 1e-12, "eq. (6)");
            assert_eq!(told.corners[0] == Corner::Rectangle, told.row.theta[0] < 135_f64.to_radians());
            texts.push(told.to_string());
            let node = NodeFacts::of(mesh, a).unwrap();
            assert_eq!(node.live.len() + node.dead.len(), mesh.fan(a).count());
            assert!(!node.sectors.is_empty());
            texts.push(node.to_string());
            let edge = EdgeFacts::of(mesh, a, b).unwrap();
            assert_eq!(edge.kind, EdgeKind::Front);
            assert_eq!(edge, EdgeFacts { ends: [a, b], ..EdgeFacts::of(mesh, b, a).unwrap() });
            texts.push(edge.to_string());
            let quad = mesh.elements().find(|&e| mesh.is_quad(e));
            for e in quad.into_iter().chain([mesh.half_edge_between(a, b).unwrap().element()]) {
                let told = ElementFacts::of(mesh, e).unwrap();
                let sum: f64 = told.angles_physical.iter().sum();
                assert!((sum - 180.0 * (told.nodes.len() as f64 - 2.0)).abs() < 1e-9, "{told}");
                texts.push(told.to_string());
            }
            assert!(NodeFacts::of(mesh, NodeId(1_000_000)).is_none());
        }
    });
    insta::assert_snapshot!(texts.join("\n"));
}

#[test]
fn on_surfaces_the_terms_of_an_h_value_add_up_to_that_of_the_selection() {
    let run = Run::of(built_in::named("wing").unwrap().unwrap());
    let mut converter = run.start(&run.background(&mut Nobody).unwrap()).unwrap();
    let (mut seen, mut unlike) = (0, 0);
    while seen < 200 {
        let next = Selecting::next(&converter);
        let Event::BaseSelected { a, b, h_value, length_physical, .. } = converter.step().unwrap() else { continue };
        let told = next.unwrap().explain(&converter, a, b).unwrap();
        let [h_a, h_b] = told.smallest_sizes;
        assert!((0.5 * (h_a + h_b) - h_value).abs() <= 1e-15 * h_value);
        // The tensor of the chart has other eigenvalues than the sizes in space that are told.
        assert!((told.metric[0].sizes[1] / h_a - 1.0).abs() < 1e-7);
        unlike += usize::from((converter.mesh.metric(a).min_size() / h_a - 1.0).abs() > 0.01);
        let edge = EdgeFacts::of(&converter.mesh, a, b).unwrap();
        let [p, q] = [a, b].map(|n| glam::DVec3::from(NodeFacts::of(&converter.mesh, n).unwrap().xyz));
        assert_eq!(edge.length_physical, length_physical);
        assert!((p.distance(q) - length_physical).abs() <= 1e-14 * length_physical);
        let e = converter.mesh.front_between(a, b).unwrap().element();
        let triangle = ElementFacts::of(&converter.mesh, e).unwrap();
        assert!((triangle.angles_physical.iter().sum::<f64>() - 180.0).abs() < 1e-9);
        // Heron's formula on the sides in space.
        let [x, y, z] = converter.mesh.triangle(e).map(|n| converter.mesh.xyz(n));
        let [i, j, k] = [x.distance(y), y.distance(z), z.distance(x)];
        let s = 0.5 * (i + j + k);
        assert!((triangle.area / (s * (s - i) * (s - j) * (s - k)).sqrt() - 1.0).abs() < 1e-6);
        seen += 1;
    }
    assert!(unlike > 50, "{unlike}");
}
