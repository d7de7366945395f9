//! Promise: the decision chain of a quadrilateral is what the raw events of its run say, by an oracle written apart.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use quadfront::core::case::built_in;
use quadfront::core::convert::{Candidate, Candidates, Converter, Event, EventKind, Passed, Phase, SideRule};
use quadfront::core::mesh::{ElementId, NodeId};
use quadfront::core::progress::Nobody;
use quadfront::core::run::{EditKind, History, Run, Selecting, explain};

/// What a quadrilateral looks like: its nodes with the bits of their positions.
type Look = Vec<(u32, [u64; 2])>;

/// The steps of one quadrilateral, each with its quality afterwards, since it last became one.
#[derive(Clone, Default)]
struct Story {
    look: Option<Look>,
    changes: Vec<(u64, f64)>,
}

fn look(state: &Converter<'_>, e: ElementId) -> Option<Look> {
    let mesh = &state.mesh;
    let is_quad = mesh.has_element(e) && mesh.is_quad(e);
    is_quad.then(|| mesh.corners(e).map(|n| (n.0, mesh.uv(n).to_array().map(f64::to_bits))).collect())
}

/// All events of a run, and the story of every quadrilateral, by comparing whole meshes step by step.
fn told(run: &Run) -> (Vec<Event>, BTreeMap<u32, Story>) {
    let background = run.background(&mut Nobody).unwrap();
    let mut state = run.start(&background).unwrap();
    let (mut events, mut stories) = (Vec::new(), BTreeMap::<u32, Story>::new());
    while *state.phase() != Phase::Done {
        events.push(state.step().unwrap());
        let step = events.len() as u64;
        for slot in 0..state.mesh.element_slots() as u32 {
            let now = look(&state, ElementId(slot));
            let story = stories.entry(slot).or_default();
            if story.look == now {
                continue;
            }
            if story.look.is_none() {
                story.changes.clear();
            }
            if now.is_some() {
                story.changes.push((step, state.mesh.quality(ElementId(slot))));
            }
            story.look = now;
        }
    }
    (events, stories)
}

#[test]
fn every_chain_has_the_steps_and_qualities_of_the_raw_events() {
    for (name, scale) in [("example1", 2.0), ("two-faces", 1.5)] {
        let mut run = Run::of(built_in::named(name).unwrap().unwrap());
        run.parameters.size_scale *= scale;
        let (events, stories) = told(&run);
        let mut history = History::open(run, &mut Nobody).unwrap();
        history.seek(u64::MAX).unwrap();
        let quads: Vec<ElementId> = history.state().mesh.elements().collect();
        let (mut formed, mut failed, mut moved) = (0, 0, 0);
        for e in quads.into_iter().step_by(3) {
            let chain = history.chain(e).unwrap().unwrap();
            let story = &stories[&e.0];
            let made = story.changes[0].0;
            assert_eq!(chain.links[chain.made].step, made, "{name}: {e:?}");
            assert!(!chain.is_cut);
            // What led to it: from the last selection of a base on, of failed attempts no more than their ends.
            let mut expected = vec![made];
            if let Event::Formed { element, quality, .. } = events[made as usize - 1] {
                assert_eq!((element, Some(quality)), (e, chain.links[chain.made].quality));
                let at = |step: u64| events[step as usize - 1].kind();
                let base = (1..made).rev().find(|step| at(*step) == EventKind::BaseSelected).unwrap();
                let last_failure = (base..made).rev().find(|step| at(*step) == EventKind::RolledBack);
                let is_told = |step: &u64| {
                    *step == base || at(*step) == EventKind::RolledBack || last_failure.is_none_or(|end| *step > end)
                };
                expected = (base..=made).filter(is_told).collect();
                formed += 1;
                failed += usize::from(last_failure.is_some());
            }
            let steps: Vec<u64> = chain.links[..=chain.made].iter().map(|link| link.step).collect();
            assert_eq!(steps, expected, "{name}: {e:?}");
            let changes: Vec<(u64, f64)> =
                chain.links[chain.made..].iter().map(|link| (link.step, link.quality.unwrap())).collect();
            assert_eq!(changes, story.changes, "{name}: {e:?}");
            moved += usize::from(changes.len() > 1);
            for link in &chain.links {
                assert_eq!(link.event, events[link.step as usize - 1]);
            }
            let losses = std::iter::once(1.0).chain(changes.iter().map(|change| change.1)).collect::<Vec<_>>();
            let losses: Vec<f64> = losses.windows(2).map(|pair| pair[0] - pair[1]).collect();
            let most = losses.iter().copied().fold(0.0, f64::max);
            assert_eq!(chain.costliest().map_or(0.0, |k| chain.links[k].loss), most, "{name}: {e:?}");
        }
        assert!(formed > 10 && moved > 5, "{name}: {formed} {failed} {moved}");
        assert!(failed > 0 || name != "example1", "{failed}");
    }
}

#[test]
fn the_margin_of_a_base_in_a_chain_is_the_one_that_its_selection_had() {
    let mut run = Run::of(built_in::named("example1").unwrap().unwrap());
    run.parameters.size_scale = 2.0;
    let mut history = History::open(run.clone(), &mut Nobody).unwrap();
    history.seek(u64::MAX).unwrap();
    let quads: Vec<ElementId> = history.state().mesh.elements().step_by(9).collect();
    let chains: Vec<_> = quads.iter().map(|&e| history.chain(e).unwrap().unwrap()).collect();
    let background = run.background(&mut Nobody).unwrap();
    let mut seen = 0;
    for chain in chains {
        let first = &chain.links[0];
        let Event::BaseSelected { a, b, theta, .. } = first.event else { continue };
        let mut state = run.start(&background).unwrap();
        while state.counts.steps + 1 < first.step {
            state.step().unwrap();
        }
        let told = Selecting::next(&state).unwrap().explain(&state, a, b).unwrap();
        let margin = first.margin.as_ref().unwrap();
        assert!(told.why.contains(margin), "{margin}: {:?}", told.why);
        for link in chain.links.iter().filter(|link| link.event.kind() == EventKind::SideIsFront) {
            let side = if link.text.starts_with("left") { 0 } else { 1 };
            let angle = format!("{:.1}\u{b0} <", theta[side].to_degrees());
            assert!(link.text.contains(&angle) && link.margin.is_some(), "{}", link.text);
        }
        seen += 1;
    }
    assert!(seen > 3, "{seen}");
}

/// What a step does about a side.
fn side(event: Event) -> (EventKind, Option<NodeId>) {
    let node = match event {
        Event::SideIsFront { node, .. } => Some(node),
        Event::SideChosen { edge } | Event::SideSwapped { edge, .. } => Some(edge.node),
        _ => None,
    };
    (event.kind(), node)
}

/// The same, with a parameter changed right before the step, in degrees.
fn side_with(history: &mut History, step: u64, key: &str, degrees: f64) -> (EventKind, Option<NodeId>) {
    history.seek(step - 1).unwrap();
    let (key, value) = (key.to_owned(), degrees.to_string());
    history.edit(EditKind::Parameter { key, value }).unwrap();
    history.seek(step).unwrap();
    let done = side(history.event(step).unwrap().unwrap());
    history.set_edits(Vec::new()).unwrap();
    done
}

/// The number after a text, with its unit.
fn number_after(text: &str, before: &str) -> Option<f64> {
    text.split_once(before).map(|(_, rest)| rest.split('\u{b0}').next().unwrap().parse().unwrap())
}

/// The candidate that comes after the chosen one.
fn second(tried: &Candidates, chosen: NodeId) -> Option<&Candidate> {
    let can_be =
        |c: &&Candidate| !matches!(c.passed, None | Some(Passed::Taken | Passed::WideAngle | Passed::NotPositive));
    let mut others: Vec<_> = tried.edges.iter().filter(can_be).collect();
    if tried.rule == SideRule::Near {
        others.retain(|candidate| candidate.swap.is_none());
    }
    assert!(tried.edges.iter().any(|c| c.passed.is_none() && c.node == chosen));
    others.into_iter().reduce(|a, b| if b.deviation < a.deviation { b } else { a })
}

#[test]
fn a_side_that_was_found_is_the_same_within_its_margins_and_another_beyond_them() {
    // Sides that are near, sides with a bound of the deviation, sides by a swap.
    let (mut near, mut bounded, mut swapped) = (0, 0, 0);
    for (name, scale) in [("example1", 3.0), ("two-faces", 2.0)] {
        let mut run = Run::of(built_in::named(name).unwrap().unwrap());
        run.parameters.size_scale *= scale;
        let mut history = History::open(run, &mut Nobody).unwrap();
        history.seek(u64::MAX).unwrap();
        let quads: Vec<ElementId> = history.state().mesh.elements().collect();
        let chains: Vec<_> = quads.iter().map(|&e| history.chain(e).unwrap().unwrap()).collect();
        for link in chains.into_iter().flat_map(|chain| chain.links) {
            let (Event::SideChosen { edge } | Event::SideSwapped { edge, .. }) = link.event else { continue };
            history.seek(link.step - 1).unwrap();
            let tried = history.state().candidates().unwrap();
            if tried.rule == SideRule::Attempt {
                assert!(link.margin.is_none() && link.text.ends_with("whatever its angle"), "{link:?}");
                continue;
            }
            match second(&tried, edge.node) {
                Some(second) => {
                    let by = if second.swap.is_some() { " by a swap" } else { "" };
                    let off = number_after(&link.text, &format!("; the second best, node {}{by}, is ", second.node.0));
                    assert!((off.unwrap() - second.deviation.to_degrees()).abs() < 0.051, "{} {second:?}", link.text);
                }
                None => assert!(link.text.ends_with("there is no other"), "{}", link.text),
            }
            let is_swap = matches!(link.event, Event::SideSwapped { .. });
            // Every link by a swap, and some of the others.
            if !is_swap && near > 12 && !link.margin.as_ref().unwrap().contains("deviation") {
                continue;
            }
            let (step, done) = (link.step, side(link.event));
            let margin = explain::plain(link.margin.as_ref().unwrap());
            let mut with = |key: &str, degrees: f64| side_with(&mut history, step, key, degrees);
            let most = number_after(&margin, "< \u{3b8}rect \u{2264} ").unwrap();
            assert_eq!([with("theta_rect", 90.0), with("theta_rect", most)], [done; 2], "{margin}");
            let theta = tried.theta.to_degrees();
            assert!(most <= theta && (theta - most < 0.101 || most == 180.0), "{margin}: {theta}");
            if theta < 180.0 {
                assert_ne!(with("theta_rect", theta + 1e-9), done, "{margin}: {theta}");
            }
            let own = edge.deviation.to_degrees();
            let edges = tried.edges.iter().filter(|c| c.swap.is_none() && c.passed == Some(Passed::Farther));
            let best = edges.map(|c| c.deviation.to_degrees()).fold(f64::INFINITY, f64::min);
            let least = number_after(&margin, "side_deviation \u{2265} ");
            let below = number_after(&margin, "side_deviation < ");
            assert_eq!(with("side_deviation", least.unwrap_or(0.0)), done, "{margin}");
            assert_eq!(with("side_deviation", below.map_or(90.0, |below| below - 1e-9)), done, "{margin}");
            if let Some(least) = least {
                assert!(!is_swap && (0.0..0.101).contains(&(least - own)), "{margin}: {own}");
                assert_ne!(with("side_deviation", own - 1e-9), done, "{margin}: {own}");
                bounded += 1;
            }
            if let Some(below) = below {
                assert!(is_swap && (0.0..0.101).contains(&(best - below)), "{margin}: {best}");
                assert_ne!(with("side_deviation", best + 1e-9), done, "{margin}: {best}");
                swapped += 1;
            }
            near += usize::from(!is_swap);
        }
    }
    assert!(near > 12 && bounded > 3 && swapped > 0, "{near} {bounded} {swapped}");
}

#[test]
fn a_triangle_has_no_chain() {
    let run = Run::of(built_in::named("figure-14").unwrap().unwrap());
    let history = History::open(run, &mut Nobody).unwrap();
    let triangle = history.state().mesh.elements().find(|e| history.state().mesh.is_triangle(*e)).unwrap();
    assert_eq!(history.chain(triangle).unwrap(), None);
    assert_eq!(history.chain(ElementId(1_000_000)).unwrap(), None);
}

#[test]
fn the_attempts_of_a_state_are_those_of_the_raw_events_since_its_base() {
    let mut run = Run::of(built_in::named("example1").unwrap().unwrap());
    run.parameters.size_scale = 2.0;
    let background = run.background(&mut Nobody).unwrap();
    let mut history = History::open(run.clone(), &mut Nobody).unwrap();
    history.seek(u64::MAX).unwrap();
    let mut state = run.start(&background).unwrap();
    // What has been tried since the last base: the attempts as the phases have them, with the steps of each.
    let mut expected = Vec::new();
    let (mut seen, mut most) = (0, 0);
    while *state.phase() != Phase::Done {
        let event = state.step().unwrap();
        let step = state.counts.steps;
        if event.kind() == EventKind::BaseSelected {
            expected = vec![(state.phase().attempt().copied().unwrap(), Vec::new())];
        } else if state.phase().base().is_some() {
            let last = expected.len() - 1;
            expected[last].1.push((step, event));
            if event.kind() == EventKind::RolledBack {
                expected.extend(state.phase().attempt().map(|attempt| (*attempt, Vec::new())));
            }
        } else {
            expected.clear();
        }
        if expected.len() < 2 || !step.is_multiple_of(3) {
            continue;
        }
        history.seek(step).unwrap();
        let found = history.attempts().unwrap();
        let told: Vec<_> =
            found.iter().map(|t| (t.attempt.number, t.attempt.divide, t.attempt.tops, &t.steps)).collect();
        let known: Vec<_> = expected.iter().map(|(a, steps)| (a.number, a.divide, a.tops, steps)).collect();
        assert_eq!(told, known, "step {step}");
        for (k, tried) in found.iter().enumerate() {
            assert_eq!(tried.failed().is_some(), k + 1 < found.len() || state.phase().attempt().is_none());
            let is_plain = explain::attempt(&tried.attempt) == "sides by the rules";
            assert_eq!(is_plain, tried.attempt.number == 0, "step {step}");
        }
        (seen, most) = (seen + 1, most.max(found.len()));
    }
    assert!(seen > 10 && most > 3, "{seen} {most}");
}
