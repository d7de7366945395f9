//! Promise: the decision chain of a quadrilateral is what the raw events of its run say, by an oracle written apart.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use quadfront::core::case::built_in;
use quadfront::core::convert::{Converter, Event, EventKind, Phase};
use quadfront::core::mesh::ElementId;
use quadfront::core::progress::Nobody;
use quadfront::core::run::{History, Run, Selecting};

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

#[test]
fn a_triangle_has_no_chain() {
    let run = Run::of(built_in::named("figure-14").unwrap().unwrap());
    let history = History::open(run, &mut Nobody).unwrap();
    let triangle = history.state().mesh.elements().find(|e| history.state().mesh.is_triangle(*e)).unwrap();
    assert_eq!(history.chain(triangle).unwrap(), None);
    assert_eq!(history.chain(ElementId(1_000_000)).unwrap(), None);
}
