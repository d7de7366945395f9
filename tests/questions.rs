//! Promise: at any state of a run any answer to a question is judged as the event that follows says: right for what the
//! step does, partly right for a segment of the same class, wrong with a reason for all others. The same seed draws the
//! same questions.
#![allow(clippy::unwrap_used)]

use quadfront::core::case::built_in;
use quadfront::core::convert::{Converter, Event, Phase};
use quadfront::core::front::Side;
use quadfront::core::mesh::{Mesh, NodeId};
use quadfront::core::progress::Nobody;
use quadfront::core::question::{Answer, Asked, Choice, Kind, Rule, Score, Series, Verdict, draw, following};
use quadfront::core::run::front_table::Row;
use quadfront::core::run::{FrontTable, History, Run};

fn history(name: &str, set: &[(&str, &str)]) -> History {
    let mut case = built_in::named(name).unwrap().unwrap();
    for (key, value) in set {
        case.parameters.set(key, value).unwrap();
    }
    let mut history = History::open(Run::of(case), &mut Nobody).unwrap();
    history.extend(u64::MAX);
    history
}

/// The class and the key of a front segment, from angles and lengths alone: table 1 with metric length times H.
fn class_and_key(mesh: &Mesh, [a, b]: [NodeId; 2]) -> (u8, f64) {
    let h = mesh.front_between(a, b).unwrap();
    let below = Side::BOTH.map(|side| mesh.frontal_angle(h, side).to_degrees() < 135.0);
    let class = match below {
        [true, true] => 1,
        [true, false] => 2,
        [false, true] => 3,
        [false, false] => 4,
    };
    (class, mesh.distance(a, b) * 0.5 * (mesh.smallest_size(a) + mesh.smallest_size(b)))
}

#[test]
fn every_segment_of_a_front_is_judged_by_its_class_and_its_key() {
    let mut history = history("example1", &[("size_scale", "2")]);
    let selections: Vec<u64> = (1..=history.log().known())
        .filter(|step| matches!(history.log().event(*step), Some(Event::BaseSelected { .. })))
        .collect();
    let (mut right, mut partly, mut wrong) = (0, 0, 0);
    for step in selections.iter().step_by(5) {
        history.seek(step - 1).unwrap();
        let Some(Event::BaseSelected { a, b, .. }) = history.event(*step).unwrap() else { panic!() };
        let asked = Asked::of(&mut history, Kind::Segment, None).unwrap();
        assert_eq!((asked.answer(), asked.step, history.step()), (Answer::Edge([a, b]), step - 1, step - 1));
        let state = history.state();
        let (class, key) = class_and_key(&state.mesh, [a, b]);
        for h in state.mesh.front() {
            let ends = state.mesh.ends(h);
            let judged = asked.judge(state, Answer::Edge(ends)).unwrap();
            let (its, its_key) = class_and_key(&state.mesh, ends);
            assert!(!judged.why.is_empty() && judged.why.len() <= 2, "{judged:?}");
            match judged.verdict {
                Verdict::Right if ends == [a, b] => right += 1,
                Verdict::Right => assert!(its == class && (its_key - key).abs() <= 1e-8 * key, "{judged:?}"),
                Verdict::Partly => {
                    assert!(its == class && judged.rule == Rule::HValue, "{judged:?}");
                    partly += 1;
                }
                Verdict::Wrong => {
                    assert!(its != class || state.mesh.is_deferred(h), "{class} {its} {judged:?}");
                    wrong += 1;
                }
            }
            // A segment that is pointed at has no direction.
            let turned = asked.judge(state, Answer::Edge([ends[1], ends[0]])).unwrap();
            assert_eq!(turned.verdict, judged.verdict);
        }
        let inner = state.mesh.edges().map(|h| state.mesh.ends(h)).find(|[a, b]| state.mesh.is_live_edge(*a, *b));
        if let Some(inner) = inner {
            let judged = asked.judge(state, Answer::Edge(inner)).unwrap();
            assert_eq!((judged.verdict, judged.rule), (Verdict::Wrong, Rule::LiveAndDead));
        }
    }
    assert!(right > 10 && partly > 100 && wrong > 100, "{right} {partly} {wrong}");
}

#[test]
fn whatever_a_step_answers_can_be_asked_before_it_and_nothing_else() {
    for (name, set) in [("example1", [("size_scale", "2")]), ("crack", [("size_scale", "3")])] {
        let mut history = history(name, &set);
        let mut met: Vec<Kind> = Vec::new();
        for step in 0..history.log().known() {
            history.seek(step).unwrap();
            let kinds = Asked::kinds_at(&mut history).unwrap();
            for kind in Kind::ALL.into_iter().filter(|kind| !kind.is_of_state()) {
                let asked = Asked::of(&mut history, kind, None);
                assert_eq!(asked.is_ok(), kinds.contains(&kind), "{name}, step {step}, {}", kind.name());
                assert_eq!(history.step(), step);
                let Ok(asked) = asked else { continue };
                met.push(kind);
                let state = history.state();
                let judged = asked.judge(state, asked.answer()).unwrap();
                assert_eq!(judged.verdict, Verdict::Right, "{name}, step {step}, {}: {judged:?}", kind.name());
                assert!(judged.why.iter().all(|why| why.ends_with('.')), "{name}, step {step}: {judged:?}");
                for choice in kind.choices().iter().filter(|choice| Answer::Choice(**choice) != asked.answer()) {
                    let judged = asked.judge(state, Answer::Choice(*choice)).unwrap();
                    assert!(judged.verdict != Verdict::Right && !judged.why.is_empty(), "{name}, step {step}");
                }
            }
        }
        let seldom = [Kind::Split, Kind::Node, Kind::Seam];
        let missing: Vec<_> = Kind::ALL
            .into_iter()
            .filter(|kind| !kind.is_of_state() && !seldom.contains(kind) && !met.contains(kind))
            .collect();
        assert!(missing.is_empty(), "{name}: {missing:?}");
    }
}

fn series(kinds: &[Kind], seed: u64, count: usize) -> Series {
    Series { seed, count, kinds: kinds.to_vec() }
}

/// Whether another segment of the front before the selection of a base comes so near to it that nobody sees which is
/// better: table 1 by hand, in the plane and without rows.
fn has_a_rival(state: &Converter<'_>, event: &Event) -> bool {
    let Event::BaseSelected { a, b, class, reach, within_reach, .. } = *event else { return false };
    let table = FrontTable::of(state);
    let of = |row: &Row| {
        let key = row.length_metric * row.h_value;
        let is_within = row.class < 4 && key < reach;
        let rivals = row.class == class && is_within == within_reach && !row.is_deferred;
        rivals.then_some(if within_reach { key } else { row.h_value })
    };
    let best = of(table.find(a, b).unwrap()).unwrap();
    let others = table.rows.iter().filter(|row| [row.a, row.b] != [a, b]).filter_map(of);
    // What is equal but for rounding counts as right, too.
    others.map(|other| (other - best) / other).any(|apart| (1e-9..=0.05).contains(&apart))
}

#[test]
fn the_next_question_along_a_run_is_the_first_one_that_a_step_leaves_open() {
    let mut history = history("example1", &[("size_scale", "2")]);
    let known = history.log().known();
    let (mut from, mut kinds) = (0, Vec::new());
    while let Some(next) = following(&mut history, from).unwrap() {
        // Between two questions there is no selection of a base by the rules, no side and no seam.
        for step in from + 1..=next.step {
            let event = history.event(step).unwrap().unwrap();
            history.seek(step - 1).unwrap();
            let is_seen = !has_a_rival(history.state(), &event);
            let is_open = matches!(event, Event::BaseSelected { picked: false, .. } if is_seen)
                || matches!(
                    event,
                    Event::SideIsFront { .. }
                        | Event::SideChosen { .. }
                        | Event::SideSwapped { .. }
                        | Event::Seamed { .. }
                        | Event::SeamRefused { .. }
                );
            assert!(!is_open, "step {step} is left out: {event:?}");
        }
        history.seek(next.step).unwrap();
        if next.kind == Kind::Segment {
            let event = history.event(next.step + 1).unwrap().unwrap();
            assert!(!has_a_rival(history.state(), &event), "step {}: a guess", next.step);
        }
        let asked = Asked::of(&mut history, next.kind, None).unwrap();
        let judged = asked.judge(history.state(), asked.answer()).unwrap();
        assert_eq!(judged.verdict, Verdict::Right);
        kinds.push(next.kind);
        from = next.step + 1;
    }
    assert!(from > known - 200 && kinds.len() > 300, "{} questions, the last at {from} of {known}", kinds.len());
    for kind in [Kind::Segment, Kind::Edge, Kind::Top, Kind::Seam] {
        assert!(kinds.contains(&kind), "{}", kind.name());
    }
}

#[test]
fn the_same_seed_draws_the_same_questions_and_another_seed_others() {
    let kinds = [Kind::Segment, Kind::Edge, Kind::Top, Kind::Seam, Kind::Form];
    let mut history = history("example1", &[("size_scale", "2")]);
    history.seek(40).unwrap();
    let mut drawn = |seed| draw(&mut history, &series(&kinds, seed, 12)).unwrap();
    let first = drawn(7);
    assert_eq!(first, drawn(7));
    assert_ne!(first, drawn(8));
    assert_eq!(first.len(), 12);
    assert!(first.windows(2).all(|pair| pair[0].step < pair[1].step), "each step is asked about once");
    assert_eq!(history.step(), 40, "the state is as it was");
    for question in first {
        history.seek(question.step).unwrap();
        Asked::of(&mut history, question.kind, None).unwrap();
    }
    let all = draw(&mut history, &series(&[Kind::Split], 1, 1_000_000)).unwrap();
    let splits = (1..=history.log().known()).filter(|step| history.log().event(*step).unwrap().is_about_a_split());
    assert_eq!(all.len(), splits.count(), "no more than there are");
    assert!(draw(&mut history, &series(&[], 1, 5)).unwrap().is_empty());
}

#[test]
fn an_answer_of_another_kind_or_at_another_state_is_refused() {
    let mut history = history("figure-14", &[]);
    let asked = Asked::of(&mut history, Kind::Segment, None).unwrap();
    assert!(asked.judge(history.state(), Answer::Choice(Choice::Yes)).is_err());
    assert!(asked.judge(history.state(), Answer::Number(1)).is_err());
    history.seek(3).unwrap();
    assert!(asked.judge(history.state(), asked.answer()).is_err());
    let asked = Asked::of(&mut history, Kind::Edge, None).unwrap();
    // What is not there is a slip of the pen: nodes that do not exist, an edge that is none.
    for ends in [[900, 901], [0, 0], [0, 3]] {
        let fault = asked.judge(history.state(), Answer::Edge(ends.map(NodeId))).unwrap_err().to_string();
        assert!(fault.starts_with("There is no "), "{fault}");
    }
    history.seek(u64::MAX).unwrap();
    assert_eq!(*history.state().phase(), Phase::Done);
    assert!(Asked::kinds_at(&mut history).unwrap().is_empty());
    for (kind, text) in
        [(Kind::Class, "5"), (Kind::Top, "gone"), (Kind::Edge, "7"), (Kind::Node, "1-2"), (Kind::Count, "-1")]
    {
        assert!(Answer::parse(kind, text).is_err(), "{text}");
    }
}

#[test]
fn a_score_counts_first_answers_and_tells_which_rules_are_missed() {
    let mut history = history("figure-14", &[]);
    let mut score = Score::default();
    // The base is right, the edge across the top wrong, and then right: too late.
    for (step, kind, text) in
        [(0, Kind::Segment, "0-1"), (3, Kind::Edge, "0-1"), (3, Kind::Edge, "6-9"), (4, Kind::Node, "9")]
    {
        history.seek(step).unwrap();
        let asked = Asked::of(&mut history, kind, None).unwrap();
        let answer = Answer::parse(kind, text).unwrap();
        let judged = asked.judge(history.state(), answer).unwrap();
        score.note(&asked, answer, &judged, 1);
    }
    let tally = score.tally();
    assert_eq!((tally.right, tally.partly, tally.wrong, score.streak()), (2, 0, 1, 1));
    assert_eq!(tally.share(), Some(2.0 / 3.0));
    let top = score.by_rule().into_iter().find(|(rule, _)| *rule == Rule::TopEdge).unwrap().1;
    assert_eq!((top.right, top.wrong), (1, 1));
    let expected = "step,kind,of,answer,right,verdict,rule,hints\n\
                    0,segment,,0-1,0-1,right,front,1\n\
                    3,edge,,0-1,6-9,wrong,top-edge,1\n\
                    4,node,,9,9,right,top-edge,1\n";
    assert_eq!(score.csv(), expected);
}

#[test]
fn a_question_shows_where_it_is_with_all_that_it_may_be_answered_by() {
    for name in ["figure-14", "figure-18", "example1"] {
        let mut history = history(name, &[("size_scale", "2")]);
        let (mut from, mut count) = (0, 0);
        while let Some(next) = following(&mut history, from).unwrap() {
            history.seek(next.step).unwrap();
            let asked = Asked::of(&mut history, next.kind, None).unwrap();
            let mesh = &history.state().mesh;
            assert!(asked.place.iter().all(|node| mesh.has_node(*node)), "{name}, step {}", next.step);
            if let Answer::Edge(ends) = asked.answer() {
                assert!(ends.iter().all(|node| asked.place.contains(node)), "{name}, step {}: {ends:?}", next.step);
            }
            // The edge that is right is one of several.
            assert!(asked.place.len() > 2, "{name}, step {}", next.step);
            count += 1;
            from = next.step + 1;
        }
        assert!(count > 3, "{name}");
    }
}
