//! Promise: what a step says and does is what the paper's formulas give. An oracle written apart from the code rebuilds
//! the front from the live triangles alone, measures it (eqs. 4 to 6), chooses the base by table 1 (4.3.3) and the
//! sides by steps ii to vi of their definition (4.3.4), counts the loops, and smooths by eqs. 9 and 10 (4.3.6).
#![allow(clippy::unwrap_used)]

mod oracle;
mod selection;
mod sides;
mod smoothing;

use quadfront::core::case::built_in;
use quadfront::core::convert::{Event, Phase};
use quadfront::core::progress::Nobody;
use quadfront::core::run::Run;
use sides::Sides;
use smoothing::Smoothings;

/// What was held against the oracle.
#[derive(Debug, Default)]
struct Seen {
    selections: usize,
    /// Those in which a segment was deferred.
    with_deferred: usize,
    sides: Sides,
    smoothings: Smoothings,
}

/// Holds every quadrilateral of a case, or one of so many, against the oracle.
fn examine(name: &str, paper: bool, one_of: usize) -> Seen {
    let mut case = built_in::named(name).unwrap().unwrap();
    if paper {
        case.parameters = case.parameters.read_as_paper();
    }
    let run = Run::of(case);
    let mut converter = run.start(&run.background(&mut Nobody).unwrap()).unwrap();
    let (mut seen, mut bases) = (Seen::default(), 0);
    while *converter.phase() != Phase::Done {
        let is_held = bases % one_of == 1 % one_of;
        let (expected, before) = match is_held {
            true => (sides::expected(&converter), smoothing::before(&converter)),
            false => (None, None),
        };
        let event = converter.step().unwrap();
        if let Event::BaseSelected { deferred, .. } = event {
            bases += 1;
            if bases % one_of == 1 % one_of {
                selection::examine(&converter, &event);
                seen.selections += 1;
                seen.with_deferred += usize::from(deferred > 0);
            }
        }
        seen.sides.examine(expected, &converter, &event);
        seen.smoothings.examine(before, &converter, &event);
    }
    seen
}

#[test]
fn every_step_of_examples_1_and_2_is_the_one_of_the_formulas() {
    for paper in [false, true] {
        let [one, two] = ["example1", "example2"].map(|name| examine(name, paper, 1));
        let seen = format!("{paper}: {one:?} {two:?}");
        let both = |count: fn(&Seen) -> usize| count(&one) + count(&two);
        assert!(both(|seen| seen.selections) > 450 && both(|seen| seen.with_deferred) > 10, "{seen}");
        let ways: [fn(&Sides) -> usize; 4] = [|s| s.front, |s| s.edge, |s| s.swap, |s| s.divided];
        for way in ways {
            assert!(way(&one.sides) + way(&two.sides) > 50, "{seen}");
        }
        assert_eq!(both(|seen| seen.sides.indivisible), 0, "{seen}");
        let [moved, refused] = [both(|seen| seen.smoothings.moved), both(|seen| seen.smoothings.refused)];
        assert!(moved > 1000 && refused < moved / 50 && both(|seen| seen.smoothings.joined) > 50, "{seen}");
    }
}

#[test]
fn one_of_ten_quadrilaterals_of_the_other_cases_is_the_one_of_the_formulas() {
    for (name, _) in built_in::CASES {
        for paper in [false, true] {
            let seen = examine(name, paper, 10);
            assert!(seen.selections > 20 && seen.smoothings.moved > 50, "{name} {paper}: {seen:?}");
        }
    }
}
