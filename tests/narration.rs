//! Promise: every kind of event has a sentence, and every number in it is the event's. One sentence of each kind is
//! kept in `tests/snapshots` and was read beside the paper.
//!
//! A change that alters texts on purpose writes them anew: `INSTA_UPDATE=always cargo test --locked
//! --no-default-features --test narration`. Read what has changed.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fmt::Write as _;

use quadfront::core::case::built_in;
use quadfront::core::convert::background;
use quadfront::core::convert::walk::walk;
use quadfront::core::convert::{Converter, Event, EventKind, Mending, StepReport};
use quadfront::core::mesh::{ElementId, NodeId};
use quadfront::core::progress::Nobody;
use quadfront::core::run::explain::{narration, plain};
use quadfront::core::run::{History, Run};
use serde_json::Value;

/// Cases that have all kinds of events together, with their parameters.
const CASES: [(&str, &[(&str, &str)]); 7] = [
    ("example1", &[("size_scale", "2")]),
    ("polar-1", &[("size_scale", "2")]),
    ("top-smoothing", &[]),
    ("transition-seam", &[]),
    ("two-faces", &[]),
    ("crack", &[("clean_up", "traditional")]),
    ("torus", &[("size_scale", "2")]),
];

/// Calls `look` with each event of a case, and the base under way.
fn events(name: &str, set: &[(&str, &str)], mut look: impl FnMut(&Event, Option<[NodeId; 2]>)) {
    let mut case = built_in::named(name).unwrap().unwrap();
    for (key, value) in set {
        case.parameters.set(key, value).unwrap();
    }
    let made = background(&case, &mut Nobody).unwrap();
    let mut converter = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
    let mut base = None;
    let mut tell = |step: &StepReport<'_>| {
        if let Event::BaseSelected { a, b, .. } = *step.event {
            base = Some([a, b]);
        }
        look(step.event, base);
    };
    walk(&mut converter, None, &mut Nobody, Some(&mut tell)).unwrap();
}

/// All numbers of a JSON value; attempts and faces are counted from 1 in sentences.
fn numbers(value: &Value, key: &str, found: &mut Vec<f64>) {
    match value {
        Value::Number(number) => {
            let from = if ["attempt", "region"].contains(&key) { 1.0 } else { 0.0 };
            found.push(number.as_f64().unwrap() + from);
        }
        Value::Array(list) => list.iter().for_each(|item| numbers(item, key, found)),
        Value::Object(object) => object.iter().for_each(|(key, item)| numbers(item, key, found)),
        _ => {}
    }
}

/// The numbers of a sentence, with the half of their last digit.
fn told(text: &str) -> Vec<(f64, f64)> {
    let text = text.replace('\u{2009}', "").replace('\u{2212}', "-");
    let is_part = |c: char| c.is_ascii_digit() || ".e-".contains(c);
    let words = text.split(|c: char| !is_part(c)).filter(|word| word.starts_with(|c: char| c.is_ascii_digit()));
    let number = |word: &str| -> (f64, f64) {
        let word = word.trim_end_matches(['.', 'e', '-']);
        let value: f64 = word.parse().unwrap();
        let (mantissa, power) = word.split_once('e').unwrap_or((word, "0"));
        let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len() as i32);
        (value, 0.5 * libm::pow(10.0, f64::from(power.parse::<i32>().unwrap() - decimals)))
    };
    words.map(number).collect()
}

#[test]
fn every_kind_of_event_has_a_sentence_and_its_numbers_are_those_of_the_event() {
    let mut first: BTreeMap<EventKind, String> = BTreeMap::new();
    let mut look = |event: &Event, base: Option<[NodeId; 2]>| {
        let text = plain(&narration(event, base));
        let starts = text.starts_with(|c: char| c.is_uppercase());
        assert!(starts && text.ends_with('.') && !text.contains(['{', '}']), "{event:?}: {text}");
        let mut known: Vec<f64> = base.iter().flatten().map(|node| f64::from(node.0)).collect();
        numbers(&serde_json::to_value(event).unwrap(), "", &mut known);
        for (value, half) in told(&text) {
            let is_known = known.iter().any(|number| (number - value).abs() <= half * (1.0 + 1e-9));
            assert!(is_known, "{value} is not in {event:?}: {text}");
        }
        first.entry(event.kind()).or_insert(text);
    };
    for (name, set) in CASES {
        events(name, set, &mut look);
    }
    // What none of these cases has.
    let how = Mending::Rotated { new: [NodeId(7), NodeId(9)] };
    let unfolded = Event::Unfolded { element: ElementId(4), how, sine: [-0.1, 0.2] };
    let lost = Event::PickLost { a: NodeId(3), b: NodeId(5) };
    let mirrored = Event::Mirrored { quads: 1212, nodes: 1180, on_line: 31 };
    [lost, unfolded, mirrored, Event::Finished].iter().for_each(|event| look(event, None));
    let missing: Vec<&EventKind> = EventKind::ALL.iter().filter(|kind| !first.contains_key(kind)).collect();
    assert!(missing.is_empty(), "no case has {missing:?}");
    let mut text = String::new();
    for (kind, sentence) in &first {
        writeln!(text, "{kind}: {sentence}").unwrap();
    }
    insta::assert_snapshot!(text);
}

/// The order of the front is recomputed by the library's tests of selection; here the sentence must name the rule, and
/// table 1's words only where table 1 selects.
#[test]
fn a_selection_is_told_by_the_rule_that_made_it() {
    let rules = [
        ("table1", "class "),
        ("shortest", "length in space"),
        ("smallest_angle", "the sum of both frontal angles"),
        ("level", "state, row and metric length"),
    ];
    for (rule, _) in rules {
        let mut seen = 0;
        events("figure-13", &[("selection", rule)], |event, base| {
            let Event::BaseSelected { length_physical, .. } = *event else { return };
            let text = plain(&narration(event, base));
            for (other, its) in rules {
                assert_eq!(text.contains(its), other == rule, "{rule}: {text}");
            }
            if rule == "shortest" {
                let (last, half) = *told(&text).last().unwrap();
                assert!((last - length_physical).abs() <= half * (1.0 + 1e-9), "{text}");
            }
            assert_eq!(serde_json::to_value(event).unwrap()["selection"], rule);
            seen += 1;
        });
        assert!(seen > 0, "{rule}");
    }
}

#[test]
fn a_side_is_told_without_its_base_too() {
    let mut seen = 0;
    events("figure-13", &[], |event, base| {
        if matches!(event.kind(), EventKind::SideChosen | EventKind::SideSwapped | EventKind::SideIsFront) {
            let [with, without] = [base, None].map(|base| narration(event, base));
            assert!(with != without && without.contains("to node "), "{with} {without}");
            seen += 1;
        }
    });
    assert!(seen > 0);
}

#[test]
fn the_transcript_of_any_steps_is_what_a_whole_conversion_tells() {
    let mut whole = Vec::new();
    events("example5", &[], |event, base| whole.push(narration(event, base)));
    let run = Run::of(built_in::named("example5").unwrap().unwrap());
    let made = run.background(&mut Nobody).unwrap();
    // So little memory that most events are dropped and told by replay.
    let mut history = History::of(run, &made, 1 << 16).unwrap();
    while history.end().is_none() {
        history.extend(history.log().known() + 64);
    }
    let steps = whole.len() as u64;
    assert_eq!(history.log().known(), steps);
    assert!((1..=steps).any(|step| history.log().event(step).is_none()), "nothing was dropped");
    for from in (1..=steps).step_by(113) {
        let until = from + from % 29;
        let told = history.transcript(from, until).unwrap();
        assert_eq!(told, whole[from as usize - 1..until.min(steps) as usize], "from {from} to {until}");
    }
    assert!(history.transcript(steps + 1, steps + 9).unwrap().is_empty());
}
