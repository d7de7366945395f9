//! Promise: what is told about a step is true when it is told. The base under way is explained by the front as it was
//! at its selection, whatever was stepped, edited or chosen since; every sentence of the figures of the paper was read
//! beside the paper, and its text is kept in `tests/snapshots`.
//!
//! A change that alters texts on purpose writes them anew: `INSTA_UPDATE=always cargo test --locked
//! --no-default-features --test explanations`. Read what has changed.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fmt::Write as _;

use quadfront::core::case::built_in;
use quadfront::core::convert::{Event, Phase};
use quadfront::core::front::Side;
use quadfront::core::kernel::number::degrees;
use quadfront::core::progress::Nobody;
use quadfront::core::run::explain::{self, plain};
use quadfront::core::run::history::BUDGET;
use quadfront::core::run::{EditKind, History, Run, SegmentFacts, Selecting, Verdict};

fn history(name: &str) -> History {
    let run = Run::of(built_in::named(name).unwrap().unwrap());
    let background = run.background(&mut Nobody).unwrap();
    History::of(run, &background, BUDGET).unwrap()
}

/// The base under way, explained.
fn base(history: &mut History) -> Option<SegmentFacts> {
    let selecting = history.selecting().unwrap();
    let base = selecting.base?;
    Some(selecting.explain(history.state(), base.a, base.b).unwrap())
}

/// The event that selected the base under way.
fn selection(history: &History) -> (u64, Event) {
    let step = history.log().selection(history.step()).unwrap();
    (step, history.event(step).unwrap().unwrap())
}

/// Adds a line of a kind.
fn tell(text: &mut String, kind: &str, what: &str) {
    writeln!(text, "  {kind:<5} {}", plain(what)).unwrap();
}

/// What is told of the selection of a base: of the base, and of one segment for each place that another one may have.
fn tell_selection(text: &mut String, selecting: &Selecting, history: &History) {
    let base = selecting.base.unwrap();
    let state = history.state();
    let told = selecting.explain(state, base.a, base.b).unwrap();
    told.why.iter().for_each(|sentence| tell(text, "why", sentence));
    let ends = [base.a, base.b];
    for (side, at) in [(Side::Left, "A"), (Side::Right, "B")] {
        let theta = told.row.theta[side.index()];
        let corner = explain::corner(&state.mesh, state.phase(), state.parameters(), ends, theta, side);
        tell(text, at, &format!("{}° {corner}", degrees(theta)));
    }
    let mut seen = BTreeSet::new();
    for place in selecting.table.in_order() {
        let row = &selecting.table.rows[place];
        let other = selecting.explain(state, row.a, row.b).unwrap();
        if !other.is_base && seen.insert(format!("{:?}", other.verdict)) {
            tell(text, "not", &format!("{} → {}: {}", row.a.0, row.b.0, other.why.join(" ")));
        }
    }
}

/// All that is told of all steps of a case.
fn told(name: &str) -> String {
    let mut history = history(name);
    let mut text = String::new();
    let next = |text: &mut String, history: &mut History| {
        let selecting = history.selecting().unwrap();
        tell(text, "next", &explain::next(history.state(), &selecting));
    };
    writeln!(text, "step 0").unwrap();
    next(&mut text, &mut history);
    loop {
        let before = history.state().looks_at();
        let Some(event) = history.forward().unwrap() else { return text };
        writeln!(text, "step {}, {} quads", history.step(), history.state().standing()).unwrap();
        tell(&mut text, "did", &explain::event(&event));
        for sentence in explain::about(&event, &before, history.state()) {
            tell(&mut text, "about", &sentence);
        }
        if matches!(event, Event::BaseSelected { .. }) {
            let selecting = history.selecting().unwrap();
            tell_selection(&mut text, &selecting, &history);
        }
        next(&mut text, &mut history);
    }
}

#[test]
fn every_sentence_of_every_step_of_the_figures_is_as_it_was_read() {
    for (name, _) in built_in::FIGURES {
        insta::assert_snapshot!(*name, told(name));
    }
}

/// Whether a text has a number, as exactly as it writes it.
fn names(text: &str, number: f64) -> bool {
    let written =
        text.split(" = ").map(|rest| rest.chars().take_while(|c| c.is_ascii_digit() || *c == '.').collect::<String>());
    written.filter_map(|digits| digits.parse::<f64>().ok()).any(|written| (written / number - 1.0).abs() < 5e-3)
}

/// Checks what is told of the base under way against the event that selected it. Returns whether there is one.
fn is_told_as_it_was_selected(history: &mut History) -> bool {
    let under_way = history.state().phase().base().copied();
    let told = base(history);
    assert_eq!(told.is_some(), under_way.is_some(), "step {}", history.step());
    let (Some(told), Some(under_way)) = (told, under_way) else { return false };
    let (step, event) = selection(history);
    let Event::BaseSelected { a, b, class, h_value, h_min, key, reach, within_reach, theta, picked, .. } = event else {
        panic!("step {step}: {event:?}")
    };
    assert_eq!([a, b], [under_way.a, under_way.b], "step {step}");
    let at = format!("step {}, selected at {step}: {:?}", history.step(), told.why);
    assert!(told.is_base && [told.row.a, told.row.b] == [a, b], "{at}");
    assert_eq!((told.row.class, told.row.h_value, told.row.theta), (class, h_value, theta), "{at}");
    let selecting = history.selecting().unwrap();
    if selecting.table.parameters().text_of("selection").unwrap() == "table1" {
        assert_eq!((told.h_min, told.row.window, told.reach), (h_min, key, reach), "{at}");
        assert_eq!(selecting.table.is_within_reach(&told.row), within_reach, "{at}");
    }
    assert_eq!(selecting.base.unwrap().step, step);
    if picked {
        assert!(told.why[0].starts_with("You chose it"), "{at}");
    } else {
        assert_eq!(told.rank.unwrap().0, 0, "{at}");
        assert_eq!(told.verdict, Verdict::First, "{at}");
    }
    let text = told.why.join(" ");
    assert!(
        picked || !text.contains("ot chosen") && !text.contains("It had rank") && !text.contains("You chose it"),
        "{at}"
    );
    if !picked && within_reach && selecting.table.parameters().text_of("selection").unwrap() == "table1" {
        assert!(
            text.contains(&format!("of class {class} within reach")) && names(&text, reach) && names(&text, key),
            "{at}"
        );
    }
    true
}

#[test]
fn the_base_under_way_is_told_as_its_event_has_it_at_every_step() {
    let mut seen = 0;
    for (name, every) in built_in::FIGURES.iter().map(|(name, _)| (*name, 1)).chain([("example1", 7)]) {
        let mut history = history(name);
        history.extend(u64::MAX);
        let last = history.end().unwrap();
        for step in (0..=last).step_by(every) {
            history.seek(step).unwrap();
            seen += usize::from(is_told_as_it_was_selected(&mut history));
            assert_eq!(history.step(), step);
        }
        // The same is told on the way back.
        for step in (0..=last).rev().step_by(3 * every) {
            history.seek(step).unwrap();
            is_told_as_it_was_selected(&mut history);
        }
    }
    assert!(seen > 150, "{seen}");
}

#[test]
fn the_selection_under_way_is_known_from_the_log_at_every_step() {
    for name in ["example1", "two-faces", "polar-1"] {
        let mut case = built_in::named(name).unwrap().unwrap();
        case.parameters.size_scale *= 1.5;
        let run = Run::of(case);
        let mut history = History::of(run.clone(), &run.background(&mut Nobody).unwrap(), BUDGET).unwrap();
        while history.forward().unwrap().is_some() {
            let under_way = history.state().phase().base().is_some();
            assert_eq!(history.log().selection(history.step()).is_some(), under_way, "{name}, step {}", history.step());
        }
    }
}

/// Goes to a step at which a side has just been made, some quadrilaterals on.
fn between_two_sides(history: &mut History, after: u64) -> u64 {
    history.extend(after + 200);
    history.seek(after).unwrap();
    loop {
        history.forward().unwrap().unwrap();
        if matches!(history.state().phase(), Phase::PrepareSide { side: Side::Right, .. }) {
            return history.step();
        }
    }
}

#[test]
fn a_parameter_that_is_changed_leaves_the_explanation_of_the_base_and_is_named_with_it() {
    let mut history = history("example1");
    let step = between_two_sides(&mut history, 400);
    let before = base(&mut history).unwrap();
    history.edit(EditKind::parameter("c", "1.1").unwrap()).unwrap();
    history.edit(EditKind::parameter("theta_rect", "100").unwrap()).unwrap();
    assert_eq!(history.step(), step);
    assert!(is_told_as_it_was_selected(&mut history));
    let after = base(&mut history).unwrap();
    assert_eq!((after.row, after.reach, after.verdict), (before.row, before.reach, before.verdict));
    let text = plain(&after.why.join(" "));
    assert!(text.contains("c was 2 at this selection; 1.1 counts from the next base on."), "{text}");
    assert!(text.contains("θrect was 135.0° at this selection; 100.0° counts for sides"), "{text}");
    // The other segments are told by the same front.
    let selecting = history.selecting().unwrap();
    for row in &selecting.table.rows {
        let told = selecting.explain(history.state(), row.a, row.b).unwrap();
        assert!(told.is_base || told.reach == before.reach);
    }
    // From the next base on, the change counts.
    while history.state().phase().base().is_some() {
        history.forward().unwrap().unwrap();
    }
    let next = history.selecting().unwrap();
    assert_eq!(next.table.parameters().c, 1.1);
    while history.state().phase().base().is_none() {
        history.forward().unwrap().unwrap();
    }
    assert!(is_told_as_it_was_selected(&mut history));
    assert!(!base(&mut history).unwrap().why.join(" ").contains("counts from"));
    // Back before the change nothing is said of it.
    history.seek(step - 1).unwrap();
    assert!(!base(&mut history).unwrap().why.join(" ").contains("counts from"));
}

#[test]
fn a_base_that_was_chosen_says_so_and_what_the_rules_would_have_chosen() {
    let mut history = history("example1");
    history.extend(800);
    history.seek(300).unwrap();
    while *history.state().phase() != Phase::Select {
        history.forward().unwrap().unwrap();
    }
    let step = history.step();
    let selecting = history.selecting().unwrap();
    let [first, tenth] = [0, 9].map(|k| selecting.table.rows[selecting.table.in_order()[k]]);
    let ask = |history: &mut History, row: &quadfront::core::run::front_table::Row| {
        let selecting = history.selecting().unwrap();
        selecting.explain(history.state(), row.a, row.b).unwrap().why
    };
    assert!(ask(&mut history, &first)[0].starts_with("It is the next base."));
    assert!(ask(&mut history, &tenth)[0].starts_with("It has rank 10 of "));
    history.edit(EditKind::Base { a: tenth.a, b: tenth.b }).unwrap();
    assert_eq!(ask(&mut history, &tenth)[0], "You chose it: it is the next base, whatever its rank.");
    let chosen = format!("{} → {}", tenth.a.0, tenth.b.0);
    assert_eq!(
        ask(&mut history, &first)[..2],
        [format!("You chose {chosen} as the next base."), "By the rules it comes first.".into()]
    );
    history.forward().unwrap();
    for _ in 0..3 {
        assert!(is_told_as_it_was_selected(&mut history));
        let told = ask(&mut history, &tenth);
        assert!(
            told[0].starts_with(&format!(
                "You chose it at step {}, whatever its rank. By the rules it had rank 10 of",
                step + 1
            )),
            "{told:?}"
        );
        let other = ask(&mut history, &first);
        assert_eq!(other[0], format!("By the rules it came first at step {}, but you chose {chosen}.", step + 1));
        history.forward().unwrap();
    }
}

#[test]
fn the_selection_that_is_kept_is_that_of_its_run_after_an_edit_before_it() {
    let mut history = history("example1");
    let step = between_two_sides(&mut history, 400);
    let before = base(&mut history).unwrap();
    history.seek(350).unwrap();
    history.edit(EditKind::parameter("c", "1.0").unwrap()).unwrap();
    history.seek(step).unwrap();
    while !is_told_as_it_was_selected(&mut history) {
        history.forward().unwrap().unwrap();
    }
    assert_ne!(base(&mut history).unwrap().reach, before.reach);
}
