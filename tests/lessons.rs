//! Promise: every lesson of the tour resolves against its run, its questions have answers that the next step gives, and a
//! wrong answer gets a reason. Its pages in `tests/snapshots` were read beside the paper.
#![allow(clippy::unwrap_used)]

use quadfront::core::lesson::{Lesson, built_in, page};
use quadfront::core::progress::Nobody;
use quadfront::core::run::History;

/// Calls `look` with every lesson of the tour and its history.
fn tour(mut look: impl FnMut(&Lesson, &mut History)) {
    for (name, _) in built_in::LESSONS {
        let lesson = built_in::named(name).unwrap().unwrap_or_else(|fault| panic!("{fault}"));
        let mut history = History::open(lesson.run(), &mut Nobody).unwrap();
        look(&lesson, &mut history);
    }
}

#[test]
fn every_lesson_resolves_and_its_page_is_true_of_its_run() {
    let mut all = String::new();
    let mut faults = Vec::new();
    tour(|lesson, history| match page(lesson, history, true) {
        Ok(page) => all += &format!("{page}\n----\n\n"),
        Err(fault) => faults.push(fault.to_string()),
    });
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
    insta::assert_snapshot!(all);
}
