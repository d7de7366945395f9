//! Promise: the first difference of two runs is the first step after which their states differ, whatever differs later,
//! and what is said of it is what each run did there.
#![allow(clippy::unwrap_used)]

use quadfront::core::case::built_in;
use quadfront::core::convert::walk::walk;
use quadfront::core::convert::{Converter, Event, Phase, StepReport};
use quadfront::core::progress::Nobody;
use quadfront::core::run::compare::{FirstDifference, first_difference};
use quadfront::core::run::shown::fingerprint;
use quadfront::core::run::{EditKind, History, Run};

fn run(name: &str, set: &[(&str, &str)]) -> Run {
    let mut case = built_in::named(name).unwrap().unwrap();
    set.iter().for_each(|(key, value)| case.parameters.set(key, value).unwrap());
    Run::of(case)
}

fn compared(runs: [Run; 2]) -> Option<FirstDifference> {
    let [mut a, mut b] = runs.map(|run| History::open(run, &mut Nobody).unwrap());
    first_difference([&mut a, &mut b], &mut Nobody).unwrap()
}

/// The first step after which the fingerprints of two runs, made anew, differ.
fn by_fingerprints(runs: [&Run; 2]) -> Option<u64> {
    let backgrounds = runs.map(|run| run.background(&mut Nobody).unwrap());
    let [mut a, mut b] = [0, 1].map(|k| {
        let made = &backgrounds[k];
        Converter::new(made.mesh.clone(), &made.sizing, runs[k].parameters.clone())
    });
    let state = |of: &Converter<'_>| fingerprint(&of.mesh, of.phase());
    loop {
        if state(&a) != state(&b) {
            return Some(a.counts.steps.max(b.counts.steps));
        }
        if *a.phase() == Phase::Done {
            return None;
        }
        a.step().unwrap();
        b.step().unwrap();
    }
}

#[test]
fn the_first_difference_is_that_of_the_fingerprints() {
    let pairs: [(&str, &[(&str, &str)]); 7] = [
        ("example1", &[("c", "1.5")]),
        ("example1", &[("theta_rect", "120")]),
        ("example1", &[("smoothing_weights", "determinant")]),
        ("example1", &[("clean_up", "traditional")]),
        ("example4", &[("enhancement", "false")]),
        ("two-faces", &[("seaming", "false")]),
        ("top-smoothing", &[("top_smoothing", "false")]),
    ];
    let mut steps = Vec::new();
    for (name, set) in pairs {
        let [a, b] = [run(name, &[]), run(name, set)];
        let expected = by_fingerprints([&a, &b]);
        let found = compared([a, b]);
        assert_eq!(found.as_ref().map(|found| found.step), expected, "{name} {set:?}");
        steps.push(expected);
    }
    // The pairs are worth comparing: most differ, at several places, and one while the whole mesh is cleaned up.
    steps.dedup();
    assert!(steps.iter().flatten().filter(|&&step| step > 0).count() >= 5, "{steps:?}");
    assert_eq!(steps.iter().filter(|step| step.is_none()).count(), 0, "{steps:?}");
}

#[test]
fn the_first_difference_of_two_values_of_c_is_that_of_the_two_event_files() {
    // What an event did, without the bound that depends on c.
    let did = |event: &Event| {
        let mut json = serde_json::to_value(event).unwrap();
        json.as_object_mut().unwrap().remove("reach");
        json
    };
    let runs = [run("example1", &[]), run("example1", &[("c", "1.5")])];
    let files = runs.each_ref().map(|run| {
        let made = run.background(&mut Nobody).unwrap();
        let mut converter = Converter::new(made.mesh.clone(), &made.sizing, run.parameters.clone());
        let mut lines = Vec::new();
        let mut tell = |told: &StepReport<'_>| lines.push((told.step, *told.event));
        walk(&mut converter, None, &mut Nobody, Some(&mut tell)).unwrap();
        lines
    });
    let differ = files[0].iter().zip(&files[1]).find(|(a, b)| did(&a.1) != did(&b.1));
    let (a, b) = differ.unwrap();
    let found = compared(runs).unwrap();
    assert_eq!(found.step, a.0);
    let [of_a, of_b] = found.did.map(Option::unwrap);
    assert_eq!((of_a.event, of_b.event), (a.1, b.1));
    // Both selected a base segment there, and each says why, and why not the other one.
    assert!(of_a.text.starts_with("base selected: ") && of_b.text.starts_with("base selected: "), "{of_a:?} {of_b:?}");
    let Event::BaseSelected { a: from, b: to, .. } = b.1 else { panic!("{b:?}") };
    let other = format!("{} → {}", from.0, to.0);
    assert!(of_a.why.len() > 1 && of_a.why.last().unwrap().contains(&other), "{of_a:?}");
}

#[test]
fn runs_that_are_the_same_do_not_differ_and_other_backgrounds_differ_at_step_0() {
    assert_eq!(compared([run("example2", &[]), run("example2", &[])]), None);
    // A parameter that nothing here depends on.
    assert_eq!(compared([run("figure-13", &[]), run("figure-13", &[("eps2", "6")])]), None);
    let found = compared([run("example2", &[]), run("example2", &[("size_scale", "0.9")])]).unwrap();
    assert_eq!(found, FirstDifference { step: 0, did: [None, None] });
}

#[test]
fn an_edit_differs_where_it_acts() {
    let plain = run("example4", &[]);
    let mut history = History::open(plain.clone(), &mut Nobody).unwrap();
    // A base segment picked at the first selection after step 300: another one than the front gives.
    history.seek(300).unwrap();
    while *history.state().phase() != Phase::Select {
        history.forward().unwrap();
    }
    let step = history.step();
    let table = quadfront::core::run::FrontTable::of(history.state());
    let Some(Event::BaseSelected { a, b, .. }) = history.forward().unwrap() else { panic!("no base is selected") };
    history.back().unwrap();
    let other = table.rows.iter().find(|row| [row.a, row.b] != [a, b]).unwrap();
    history.edit(EditKind::Base { a: other.a, b: other.b }).unwrap();
    let edited = history.run().clone();
    let found = compared([plain, edited]).unwrap();
    assert_eq!(found.step, step + 1);
    let [_, Some(did)] = found.did else { panic!("{found:?}") };
    assert!(did.text.starts_with("you chose the base"), "{did:?}");
}
