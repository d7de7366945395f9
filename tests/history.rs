//! Promise: a run is a value. Whatever walk of stepping, seeking and editing leads to a step, its state has the bytes
//! that running there afresh gives; and what a history takes stays within its budget.
#![allow(clippy::unwrap_used)]

#[path = "common/environment.rs"]
mod environment;

use proptest::prelude::*;
use quadfront::core::case::built_in;
use quadfront::core::convert::{Converter, Event, EventKind, Phase};
use quadfront::core::mesh::NodeId;
use quadfront::core::prepare::Background;
use quadfront::core::progress::{Cancel, Nobody};
use quadfront::core::run::history::BUDGET;
use quadfront::core::run::timeline::{LANES, Span, Tracked, count};
use quadfront::core::run::{Appearance, Changes, Condition, Edit, EditKind, History, Run, Watched};

fn run_of(name: &str, size_scale: f64) -> (Run, Background) {
    let mut run = Run::of(built_in::named(name).unwrap().unwrap());
    run.parameters.size_scale *= size_scale;
    let background = run.background(&mut Nobody).unwrap();
    (run, background)
}

fn bytes(converter: &Converter<'_>) -> Vec<u8> {
    let mut bytes = Vec::new();
    converter.write_state(&mut bytes);
    bytes
}

/// The state at a step, or at the end where that comes before, by running there and nothing else.
fn fresh(run: &Run, background: &Background, step: u64) -> Vec<u8> {
    let mut converter = run.start(background).unwrap();
    for at in 1..=step {
        if *converter.phase() == Phase::Done {
            break;
        }
        converter.step().unwrap();
        run.make_edits(&mut converter, at).unwrap();
    }
    bytes(&converter)
}

fn parameter(key: &str, value: &str) -> EditKind {
    EditKind::parameter(key, value).unwrap()
}

#[test]
fn any_step_sought_from_any_other_is_that_of_a_fresh_run() {
    for name in ["example1", "crack", "two-faces"] {
        let (run, background) = run_of(name, 1.0);
        let mut history = History::of(run.clone(), &background, BUDGET).unwrap();
        let end = history.seek(u64::MAX).unwrap();
        assert_eq!(history.end(), Some(end), "{name}");
        assert_eq!(bytes(history.state()), fresh(&run, &background, end), "{name}");
        for share in [0.9, 0.05, 0.5, 0.97, 0.47, 1.0, 0.0, 0.3, 0.31, 0.99, 0.985] {
            let step = (share * end as f64) as u64;
            assert_eq!(history.seek(step).unwrap(), step);
            assert!(bytes(history.state()) == fresh(&run, &background, step), "{name}, step {step} of {end}");
        }
    }
}

#[test]
fn a_tiny_budget_is_kept_and_changes_no_state() {
    let (run, background) = run_of("example1", 0.3);
    let budget = 6 << 20;
    let mut history = History::of(run.clone(), &background, budget).unwrap();
    // Meshes of this size: the first one must be kept in any case.
    assert!(background.mesh.bytes() < budget / 4, "{}", background.mesh.bytes());
    let end = history.seek(u64::MAX).unwrap();
    let mut most = history.memory();
    for k in (0..30).rev() {
        let step = end * k / 30;
        history.seek(step).unwrap();
        for _ in 0..300 {
            history.back().unwrap();
        }
        for _ in 0..200 {
            history.forward().unwrap();
        }
        most = most.max(history.memory());
    }
    assert!(most <= budget, "{most} of {budget}");
    assert!(most > budget / 4, "the budget is used: {most} of {budget}");
    let step = end / 3;
    history.seek(step).unwrap();
    assert!(bytes(history.state()) == fresh(&run, &background, step));
    // Events that were given up are had again.
    let (mut roomy, at) = (History::of(run, &background, BUDGET).unwrap(), end / 2);
    roomy.seek(end).unwrap();
    assert_eq!(history.event(at).unwrap(), roomy.event(at).unwrap());
}

#[test]
fn an_edit_changes_what_follows_and_nothing_before() {
    let (run, background) = run_of("example1", 1.0);
    let mut history = History::of(run.clone(), &background, BUDGET).unwrap();
    let end = history.seek(u64::MAX).unwrap();
    let last = bytes(history.state());
    let at = end / 2;
    let before: Vec<_> = (1..=at).map(|step| history.event(step).unwrap()).collect();
    history.seek(at).unwrap();
    history.edit(parameter("theta_rect", "110")).unwrap();
    assert_eq!(history.step(), at);
    assert_eq!(history.state().parameters().theta_rect, 110_f64.to_radians());
    let edited = history.seek(u64::MAX).unwrap();
    assert_ne!(bytes(history.state()), last, "it changes something");
    assert_eq!(bytes(history.state()), fresh(history.run(), &background, edited));
    assert_eq!((1..=at).map(|step| history.event(step).unwrap()).collect::<Vec<_>>(), before);
    history.seek(at - 1).unwrap();
    assert_eq!(history.state().parameters().theta_rect, 135_f64.to_radians(), "before it the old value is in force");
    // Undone, everything is as it was.
    history.set_edits(Vec::new()).unwrap();
    assert_eq!(history.seek(u64::MAX).unwrap(), end);
    assert_eq!(bytes(history.state()), last);
}

#[test]
fn a_picked_base_segment_is_chosen_next_and_its_event_says_so() {
    let (run, background) = run_of("example1", 1.0);
    let mut history = History::of(run, &background, BUDGET).unwrap();
    history.seek(200).unwrap();
    while *history.state().phase() != Phase::Select && history.state().phase().base().is_some() {
        history.forward().unwrap();
    }
    let mesh = &history.state().mesh;
    let h = mesh.front().last().unwrap();
    let (a, b) = (mesh.origin(h), mesh.target(h));
    assert!(history.edit(EditKind::Base { a: b, b: a }).is_err(), "the live region lies to the left");
    assert!(history.edit(EditKind::Base { a: NodeId(999_999), b }).is_err());
    history.edit(EditKind::Base { a, b }).unwrap();
    let chosen = loop {
        if let Event::BaseSelected { a, b, picked, .. } = history.forward().unwrap().unwrap() {
            break (a, b, picked);
        }
    };
    assert_eq!(chosen, (a, b, true));
    let step = history.step();
    history.back().unwrap();
    assert_eq!(history.state().picked(), Some([a, b]));
    history.seek(step + 500).unwrap();
    assert_eq!(bytes(history.state()), fresh(history.run(), &background, step + 500));
}

#[test]
fn a_pick_that_is_not_on_the_front_any_more_is_told_and_the_rules_choose() {
    let (mut run, background) = run_of("example1", 1.0);
    let kind = EditKind::Base { a: NodeId(999_999), b: NodeId(3) };
    run.set_edits(vec![Edit { step: 10, kind }]);
    let mut history = History::of(run, &background, BUDGET).unwrap();
    let end = history.seek(u64::MAX).unwrap();
    let lost = history.log().next_of(0, |kind| kind == EventKind::PickLost).unwrap();
    assert!(10 < lost && lost < end);
    assert_eq!(history.log().kind(lost + 1), Some(EventKind::BaseSelected));
}

#[test]
fn running_ahead_elsewhere_gives_the_same_history() {
    fn goes_anywhere<T: Send>(_: &T) {}
    let (run, background) = run_of("example1", 0.5);
    let mut alone = History::of(run.clone(), &background, BUDGET).unwrap();
    let end = alone.seek(u64::MAX).unwrap();
    let mut history = History::of(run, &background, BUDGET).unwrap();
    goes_anywhere(&history);
    let mut recorder = history.lend().unwrap();
    assert!(history.lend().is_none());
    let (send, stretches) = std::sync::mpsc::channel();
    let worker = std::thread::spawn(move || {
        while !recorder.is_done() {
            send.send(recorder.run(700, &Cancel::default())).unwrap();
        }
        recorder
    });
    for stretch in stretches {
        assert!(history.accept(stretch));
        let known = history.log().known();
        assert_eq!(history.seek(u64::MAX).unwrap(), known, "no further than is known");
    }
    history.take_back(worker.join().unwrap()).unwrap();
    assert_eq!(history.seek(u64::MAX).unwrap(), end);
    assert_eq!(bytes(history.state()), bytes(alone.state()));
    // What was found before an edit is of no use after it.
    history.set_edits(Vec::new()).unwrap();
    history.seek(end / 2).unwrap();
    history.edit(parameter("c", "1.5")).unwrap();
    let mut recorder = history.lend().unwrap();
    let stretch = recorder.run(100, &Cancel::default());
    history.edit(parameter("c", "1.7")).unwrap();
    // Another one is lent before the first one is back, and is of use afterwards.
    let mut next = history.lend().unwrap();
    assert!(!history.accept(stretch));
    history.take_back(recorder).unwrap();
    assert!(history.accept(next.run(100, &Cancel::default())));
    history.take_back(next).unwrap();
    let reached = history.seek(u64::MAX).unwrap();
    assert_eq!(bytes(history.state()), fresh(history.run(), &background, reached));
}

#[test]
fn what_is_told_to_have_changed_is_all_that_changed() {
    let (run, background) = run_of("example1", 1.0);
    let mut history = History::of(run, &background, BUDGET).unwrap();
    assert_eq!(history.take_changes(), Changes::Everything);
    let picture = |history: &History| {
        let mesh = &history.state().mesh;
        let nodes: Vec<_> = mesh.nodes().map(|n| (n, mesh.uv(n))).collect();
        let elements: Vec<_> = mesh.elements().map(|e| (e, mesh.corners(e).collect::<Vec<_>>())).collect();
        (nodes, elements)
    };
    let mut before = picture(&history);
    let strides = [1, 7, 1, -1, 30, -12, 1, 1, 1, -3, 90, 1, -40];
    for stride in strides.iter().cycle().take(200) {
        let step = history.step().saturating_add_signed(*stride);
        history.seek(step).unwrap();
        let Changes::Some { nodes, elements } = history.take_changes() else { panic!("these are near each other") };
        let after = picture(&history);
        let moved = after.0.iter().filter(|slot| !before.0.contains(slot));
        assert!(moved.into_iter().all(|(n, _)| nodes.contains(n)), "step {step}");
        let other = after.1.iter().filter(|slot| !before.1.contains(slot));
        assert!(other.into_iter().all(|(e, _)| elements.contains(e)), "step {step}");
        before = after;
    }
}

#[test]
fn conditions_stop_forward_and_back_at_the_same_steps_whatever_is_kept() {
    let (run, background) = run_of("example1", 0.4);
    let conditions = ["quad.quality < 0.5 || recovery.failed", "front.loops > 2"].map(|c| Condition::parse(c).unwrap());
    let mut found = Vec::new();
    for budget in [BUDGET, 1 << 20] {
        let mut history = History::of(run.clone(), &background, budget).unwrap();
        let mut forward = Vec::new();
        while let Some((step, index)) = history.next_break(&conditions).unwrap() {
            forward.push((step, index));
            history.seek(step).unwrap();
            if forward.len() == 60 {
                break;
            }
        }
        history.seek(history.step() + 1).unwrap();
        let mut back = Vec::new();
        while let Some((step, index)) = history.previous_break(&conditions).unwrap() {
            back.push((step, index));
            history.seek(step).unwrap();
        }
        back.reverse();
        assert_eq!(forward, back);
        assert!(forward.iter().any(|f| f.1 == 0) && forward.len() > 5, "{forward:?}");
        found.push(forward);
    }
    assert_eq!(found[0], found[1]);
}

#[test]
fn what_touched_a_thing_is_found_forward_and_back_as_by_looking_at_every_state() {
    let (run, background) = run_of("example1", 0.6);
    let mut history = History::of(run.clone(), &background, BUDGET).unwrap();
    let end = history.seek(u64::MAX).unwrap();
    let mesh = &history.state().mesh;
    let quads: Vec<_> = mesh.elements().step_by(137).collect();
    let watched: Vec<Watched> = quads
        .iter()
        .flat_map(|&e| {
            let [a, b, ..] = mesh.quad(e);
            [Watched::Element(e), Watched::Node(a), Watched::Edge(a, b)]
        })
        .collect();
    // By looking at every state.
    let mut converter = run.start(&background).unwrap();
    let mut looks: Vec<_> = watched.iter().map(|&w| Appearance::at(&converter.mesh, w)).collect();
    let mut touches = vec![Vec::new(); watched.len()];
    let mut made = vec![None; watched.len()];
    let mut killed = vec![None; watched.len()];
    for step in 1..=end {
        converter.step().unwrap();
        for (k, &w) in watched.iter().enumerate() {
            let look = Appearance::at(&converter.mesh, w);
            if look != looks[k] {
                touches[k].push(step);
                if look.is_quad() && !looks[k].is_quad() {
                    made[k] = Some(step);
                }
                let lives = |look: &Appearance| *look == Appearance::Absent || look.is_live_edge();
                if lives(&looks[k]) && !lives(&look) {
                    killed[k] = Some(step);
                }
                looks[k] = look;
            }
        }
    }
    for (k, &w) in watched.iter().enumerate() {
        assert_eq!(history.touches(w, usize::MAX).unwrap(), touches[k], "{w:?}");
        let before = touches[k].iter().copied().rfind(|&step| step < history.step());
        assert_eq!(history.last_touch(w).unwrap(), before, "{w:?}");
        if let Watched::Element(e) = w {
            assert_eq!(history.made(e).unwrap(), made[k], "{w:?}");
        }
        if let Watched::Edge(a, b) = w {
            assert_eq!(history.killed(a, b).unwrap(), killed[k], "{w:?}");
        }
    }
    history.seek(end / 3).unwrap();
    for (k, &w) in watched.iter().enumerate() {
        let next = touches[k].iter().copied().find(|&step| step > end / 3);
        assert_eq!(history.next_touch(w).unwrap(), next, "{w:?}");
    }
}

#[test]
fn the_samples_along_a_run_say_that_its_invariants_hold() {
    for (name, scale) in [("example1", 0.4), ("two-faces", 0.5)] {
        let (run, background) = run_of(name, scale);
        let mut history = History::of(run, &background, BUDGET).unwrap();
        let end = history.seek(u64::MAX).unwrap();
        let samples = history.log().samples();
        assert!(samples.len() as u64 >= end / 1200, "{name}: {} samples of {end} steps", samples.len());
        let first = samples[0];
        for sample in samples {
            assert_eq!((sample.inverted, sample.front.odd, sample.euler), (0, 0, first.euler), "{name}: {sample:?}");
            assert!((sample.area / first.area - 1.0).abs() < 1e-12, "{name}: {sample:?}");
            assert!((sample.area_metric / first.area_metric - 1.0).abs() < 0.1, "{name}: {sample:?}");
            assert_eq!(sample.front.segments == 0, sample.front_length == 0.0);
        }
        let last = samples.last().unwrap();
        assert_eq!((last.step, last.nq, last.front.live), (end, history.log().nq(end), 0), "{name}");
        let mesh = &history.state().mesh;
        let worst = mesh.elements().map(|e| mesh.quality(e)).fold(f64::INFINITY, f64::min);
        assert!((last.worst_quality - worst).abs() < 1e-6, "{name}: {} is {worst}", last.worst_quality);
        let track: Vec<Tracked> = (1..=end).map(|step| Tracked::of(history.log(), step).unwrap()).collect();
        let span = Span { steps: [0.0, end as f64], columns: 100 };
        for (lane, counted) in LANES.iter().zip(count(&track, &LANES.map(|lane| lane.kinds), &span)) {
            let all = history.log().kinds(1, end).filter(|kind| lane.kinds.contains(kind)).count() as u64;
            let in_columns: u64 = counted.bins.iter().copied().map(u64::from).sum();
            assert_eq!([counted.total, in_columns], [all; 2], "{name}: each event is in one column of {}", lane.name);
        }
    }
}

#[derive(Clone, Debug)]
enum Move {
    Forward(u64),
    Back(u64),
    Seek(f64),
    Parameter(&'static str, &'static str),
    Pick(usize),
    Undo(usize),
}

fn moves() -> impl Strategy<Value = Move> {
    prop_oneof![
        (1..40_u64).prop_map(Move::Forward),
        (1..40_u64).prop_map(Move::Back),
        (0.0..1.1).prop_map(Move::Seek),
        prop_oneof![
            Just(("theta_rect", "120")),
            Just(("theta_rect", "150")),
            Just(("c", "1.5")),
            Just(("placement", "false")),
            Just(("smoothing", "false")),
            Just(("selection", "level")),
        ]
        .prop_map(|(key, value)| Move::Parameter(key, value)),
        (0..500_usize).prop_map(Move::Pick),
        (0..8_usize).prop_map(Move::Undo),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(environment::number("QUADFRONT_SOAK_ROUNDS").unwrap_or(120) as u32))]

    #[test]
    fn every_walk_of_stepping_seeking_and_editing_ends_in_the_bytes_of_a_fresh_run(
        walk in prop::collection::vec(moves(), 1..14),
        small in any::<bool>(),
    ) {
        thread_local! {
            static CASE: (Run, Background) = run_of("example1", 1.6);
        }
        CASE.with(|(run, background)| {
            // A budget too small for anything but the first mesh, or the usual one.
            let budget = if small { 1 << 20 } else { BUDGET };
            let mut history = History::of(run.clone(), background, budget).unwrap();
            for step in walk {
                match step {
                    Move::Forward(count) => for _ in 0..count { history.forward().unwrap(); },
                    Move::Back(count) => for _ in 0..count { history.back().unwrap(); },
                    Move::Seek(share) => { history.seek((share * 1100.0) as u64).unwrap(); }
                    Move::Parameter(key, value) => history.edit(parameter(key, value)).unwrap(),
                    Move::Pick(k) => {
                        let mesh = &history.state().mesh;
                        let front: Vec<_> = mesh.front().map(|h| (mesh.origin(h), mesh.target(h))).collect();
                        if let Some(&(a, b)) = front.get(k % front.len().max(1)) {
                            history.edit(EditKind::Base { a, b }).unwrap();
                        }
                    }
                    Move::Undo(k) => {
                        let mut edits = history.run().edits().to_vec();
                        if !edits.is_empty() {
                            edits.remove(k % edits.len());
                            history.set_edits(edits).unwrap();
                        }
                    }
                }
            }
            let expected = fresh(history.run(), background, history.step());
            prop_assert!(bytes(history.state()) == expected, "step {}", history.step());
            Ok(())
        })?;
    }
}
