//! Promise: what a step did and why can be read from its event, and every operation of the paper's sections 4.2 to
//! 4.3.7 is done somewhere on the built-in cases.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use quadfront::core::case::{Parameters, built_in};
use quadfront::core::convert::background;
use quadfront::core::convert::walk::walk;
use quadfront::core::convert::{Candidate, Converter, Event, Phase, Purpose, StepReport, Why};
use quadfront::core::progress::Nobody;

/// Calls `look` with a converter of a built-in case.
fn with_case(name: &str, set: &[(&str, &str)], look: impl FnOnce(Converter<'_>)) {
    let mut case = built_in::named(name).unwrap().unwrap();
    for (key, value) in set {
        case.parameters.set(key, value).unwrap();
    }
    let made = background(&case, &mut Nobody).unwrap();
    look(Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone()));
}

#[test]
fn the_candidates_of_a_side_name_the_one_that_the_next_step_chooses() {
    let mut seen = [0; 4];
    for (name, set) in [("example1", vec![]), ("crack", vec![]), ("polar-1", vec![("bisector", "false")])] {
        with_case(name, &set, |mut converter| {
            while !matches!(converter.phase(), Phase::PostProcess { .. }) {
                let candidates = converter.candidates();
                let event = converter.step().unwrap();
                let Some(candidates) = candidates else {
                    let is_side = matches!(
                        event,
                        Event::SideIsFront { .. } | Event::SideChosen { .. } | Event::SideSwapped { .. }
                    );
                    assert!(!is_side, "{event:?} comes with its candidates");
                    continue;
                };
                let chosen: Vec<&Candidate> = candidates.edges.iter().filter(|c| c.passed.is_none()).collect();
                match event {
                    Event::RolledBack { why: Why::NoSide(side), .. } => {
                        assert!(chosen.is_empty() && side == candidates.side);
                        seen[0] += 1;
                    }
                    Event::SideIsFront { side, node } => {
                        assert_eq!((chosen.len(), chosen[0].node, candidates.side), (1, node, side));
                        assert!(candidates.theta < converter.parameters().theta_rect);
                        seen[1] += 1;
                    }
                    Event::SideChosen { edge } => {
                        assert_eq!((chosen.len(), chosen[0].node, chosen[0].swap), (1, edge.node, None));
                        assert_eq!((chosen[0].angle, chosen[0].deviation), (edge.angle, edge.deviation));
                        seen[2] += 1;
                    }
                    Event::SideSwapped { edge, instead_of } => {
                        assert_eq!((chosen.len(), chosen[0].node), (1, edge.node));
                        assert!(chosen[0].swap.is_some() && chosen[0].deviation < instead_of.unwrap_or(f64::INFINITY));
                        assert!(instead_of.is_none_or(|d| d > candidates.limit));
                        seen[3] += 1;
                    }
                    other => panic!("a side is to be chosen, and there is {other:?}"),
                }
            }
        });
    }
    assert!(seen.iter().all(|&n| n > 20), "{seen:?}");
}

#[test]
fn every_operation_of_the_paper_is_done_on_some_built_in_case() {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    // By default nobody smooths around the left top (top edge v), and no case needs a second pass.
    let besides = [("example1", &[("top_smoothing", "true")][..]), ("wing", &[("h_min_over", "waiting")])];
    for (name, set) in built_in::CASES.iter().map(|(name, _)| (*name, &[][..])).chain(besides) {
        with_case(name, set, |mut converter| {
            let mut tell = |told: &StepReport<'_>| {
                let kind = match told.event {
                    Event::NodeRemoved { purpose: Purpose::Recovery, .. } => "node_removed for a top edge",
                    Event::NodeRemoved { purpose: Purpose::Enhancement, .. } => "node_removed by enhancement",
                    event => event.kind().name(),
                };
                *counts.entry(kind.to_owned()).or_default() += 1;
            };
            walk(&mut converter, None, &mut Nobody, Some(&mut tell)).unwrap();
            *counts.entry("right side replaced".to_owned()).or_default() += converter.counts.right_replaced as usize;
        });
    }
    for operation in [
        "base_selected",               // 4.3.3
        "side_is_front",               // 4.3.4, side edges ii
        "side_chosen",                 // iii
        "side_swapped",                // iv, v; 4.2.1
        "side_divided",                // vi; 4.2.3
        "top_swapped",                 // top edge iv
        "node_removed for a top edge", // iii; 4.2.4
        "top_smoothed",                // v
        "top_found",                   // vi
        "right side replaced",         // vii
        "formed",                      // 4.3.4, 4.3.5
        "rolled_back",
        "deferred",
        "node_removed by enhancement", // 4.3.6, enhancement i
        "enhanced",                    // ii
        "smoothed",                    // eqs. 9, 10
        "seamed",                      // fig. 18; 4.2.2
        "transition_seamed",
        "seam_refused",
        "split", // fig. 19
        "split_refused",
        "closed",
        "second_pass",
        "last_resort",
        "post_processed", // 4.3.7
    ] {
        assert!(counts.get(operation).is_some_and(|&n| n > 0), "{operation} never happens: {counts:?}");
    }
}

#[test]
fn an_operation_that_is_switched_off_is_not_done() {
    for (key, kinds) in [
        ("enhancement", &["enhanced"][..]),
        ("smoothing", &["smoothed"]),
        ("seaming", &["seamed", "transition_seamed", "seam_refused"]),
        ("splitting", &["split"]),
        ("post_processing", &["post_processed"]),
    ] {
        assert_eq!(Parameters::default().text_of(key).unwrap(), "true");
        with_case("repeated-line", &[(key, "false")], |mut converter| {
            let mut tell =
                |told: &StepReport<'_>| assert!(!kinds.contains(&told.event.kind().name()), "{key}: {:?}", told.event);
            walk(&mut converter, None, &mut Nobody, Some(&mut tell)).unwrap();
        });
    }
}

#[test]
fn loops_where_the_front_has_changed_are_told_and_even_and_crossings_name_the_edge_that_is_swapped() {
    for (name, least) in [("crack", 1), ("gear", 1), ("example1", 2)] {
        with_case(name, &[], |mut converter| {
            let (mut formed, mut several, mut swapped) = (0, 0, 0);
            let mut look = |told: &StepReport<'_>| {
                if let Some(loops) = told.loops {
                    assert!(loops.iter().all(|n| n % 2 == 0 && *n >= 2), "{name}, step {}: {loops:?}", told.step);
                    several += usize::from(loops.len() > 1);
                }
                match told.event {
                    Event::Formed { .. } => {
                        assert!(told.loops.is_some());
                        formed += 1;
                    }
                    Event::TopSwapped { across, .. } => {
                        let crossings = told.crossings.unwrap();
                        let same = |edge: &[_; 2]| edge == across || [edge[1], edge[0]] == *across;
                        assert!(crossings.iter().any(same), "{name}, step {}: {crossings:?}", told.step);
                        swapped += 1;
                    }
                    Event::TopFound { .. } => assert_eq!(told.crossings, Some(&[][..])),
                    Event::BaseSelected { .. } => assert!(told.loops.is_none() && told.crossings.is_none()),
                    _ => {}
                }
            };
            walk(&mut converter, None, &mut Nobody, Some(&mut look)).unwrap();
            assert!(formed > 100 && swapped > 20 && several >= least, "{name}: {formed} {swapped} {several}");
        });
    }
}
