//! The promise holds whatever operations fail: they are refused at random (failure injection), few or most of them.

use quadfront::core::case::Case;
use quadfront::core::case::built_in::{CASES, named};
use quadfront::core::convert::background;
use quadfront::core::convert::{Converter, Phase};
use quadfront::core::mesh::Refusals;
use quadfront::core::progress::Nobody;

use super::promise::keep_by;
use super::random::Random;
use super::{all_random_cases, random_case};

/// Shares of the operations that are refused.
const SHARES: [f64; 3] = [0.05, 0.3, 0.8];

/// The refusals of a seed; the cases of three seeds in a row get different shares.
fn refusals(seed: u64) -> Refusals {
    Refusals::new(seed, SHARES[(seed % 3) as usize])
}

/// A random case; of every ten one is read as the paper does.
fn case(seed: u64) -> Case {
    let mut case = random_case(seed);
    if seed % 10 == 9 {
        case.parameters = case.parameters.read_as_paper();
    }
    case
}

#[test]
fn every_random_case_keeps_the_promise_whatever_operations_are_refused() {
    all_random_cases(60, &|seed| {
        keep_by(&case(seed), &mut |converter| converter.mesh.set_refusals(Some(refusals(seed))))
    });
}

#[test]
fn every_built_in_case_keeps_the_promise_whatever_operations_are_refused() {
    for (name, _) in CASES {
        for paper in [false, true] {
            for share in SHARES {
                let mut case = named(name).unwrap().unwrap();
                if paper {
                    case.parameters = case.parameters.read_as_paper();
                }
                let refusals = Refusals::new(1, share);
                keep_by(&case, &mut |converter| converter.mesh.set_refusals(Some(refusals)))
                    .unwrap_or_else(|what| panic!("{name}, paper {paper}, share {share}: {what}"))
                    .unwrap_or_else(|fault| panic!("{name}, paper {paper}, share {share}: {fault}"));
            }
        }
    }
}

#[test]
fn a_run_with_refused_operations_stepped_back_and_on_ends_in_the_same_bytes() {
    for seed in 0..12 {
        let case = case(seed);
        let Ok(made) = background(&case, &mut Nobody) else { continue };
        let mut straight = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
        straight.mesh.set_refusals(Some(refusals(seed)));
        let mut walking = straight.clone();
        straight.run(&mut Nobody).unwrap();
        walking.keep_history();
        let mut random = Random::new(seed);
        // Forth by up to 400 steps and back by up to 300, so that every step is taken back once and more.
        while *walking.phase() != Phase::Done {
            for _ in 0..random.whole(1, 400) {
                walking.step().unwrap();
                if *walking.phase() == Phase::Done {
                    break;
                }
            }
            let over = *walking.phase() == Phase::Done && random.chance(0.5);
            for _ in 0..if over { 0 } else { random.whole(0, 300) } {
                walking.step_back();
            }
        }
        let state = |converter: &Converter<'_>| {
            let mut bytes = Vec::new();
            converter.write_state(&mut bytes);
            bytes
        };
        assert!(state(&straight) == state(&walking), "seed {seed}");
    }
}
