//! Promise: every valid case becomes strictly convex quadrilaterals, its boundary untouched (docs/algorithm.md, "What
//! is guaranteed").
//!
//! Rounds of the random tests: 60 and 100, or what QUADFRONT_SOAK_ROUNDS says, from seed 0 or QUADFRONT_SOAK_FROM on.
//! QUADFRONT_SEED runs one case alone, and QUADFRONT_SHOW=1 prints its text, which the command line takes as it is.
#![allow(clippy::unwrap_used)]

mod fit;
mod hostile;
mod promise;
mod random;
mod random_case;
mod random_metric;
mod refusals;
mod shape;

#[path = "../common/environment.rs"]
mod environment;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use promise::{Kept, keep};
use quadfront::core::case::Case;
use quadfront::core::case::built_in::{CASES, named};
use quadfront::core::convert::conversion::convert;
use quadfront::core::fault::Fault;
use quadfront::core::progress::Nobody;
use random::Random;

/// A case that takes longer is told.
const SLOW: Duration = Duration::from_secs(10);
/// So many of the slowest are told.
const SLOWEST: usize = 10;
/// Of so many cases one may be refused: curves that the generator puts too near to each other.
const ONE_REFUSED_OF: usize = 30;

/// The case of a seed, of 25 to 800 quadrilaterals.
fn random_case(seed: u64) -> Case {
    let text = random_case::text(seed);
    let mut case =
        Case::parse(&text, "random", "random.toml", Path::new("")).unwrap_or_else(|fault| panic!("{fault}\n{text}"));
    fit::fit(&mut case, Random::new(!seed).power(1.4, 2.9));
    let scale = case.parameters.size_scale;
    case.text = format!("{text}[parameters]\nsize_scale = {scale:?}\nmax_quads = 30000\n");
    Case::parse(&case.text, "random", "random.toml", Path::new("")).unwrap()
}

/// What came of all cases.
#[derive(Default)]
struct Tally {
    rounds: usize,
    kept: usize,
    quads: usize,
    templates: usize,
    refused: BTreeMap<String, Vec<u64>>,
    broken: Vec<String>,
    /// Ascending.
    slowest: Vec<(Duration, u64)>,
    largest: (usize, u64),
}

impl Tally {
    fn count(&mut self, seed: u64, took: Duration, outcome: Outcome) {
        // A long run says at once what it finds.
        match &outcome {
            Ok(Ok(_)) if took < SLOW => {}
            Ok(Ok(_)) => println!("seed {seed} takes {took:?}"),
            Ok(Err(fault)) => println!("seed {seed} is refused: {fault}"),
            Err(what) => println!("seed {seed} breaks: {what}"),
        }
        self.rounds += 1;
        if self.rounds.is_multiple_of(1000) {
            println!("{} rounds", self.rounds);
        }
        self.slowest.push((took, seed));
        self.slowest.sort_unstable();
        if self.slowest.len() > SLOWEST {
            self.slowest.remove(0);
        }
        match outcome {
            Ok(Ok(kept)) => {
                self.kept += 1;
                self.quads += kept.quads;
                self.templates += usize::from(kept.templates);
                self.largest = self.largest.max((kept.triangles, seed));
            }
            Ok(Err(fault)) => self.refused.entry(kind(&fault)).or_default().push(seed),
            Err(what) => self.broken.push(format!("seed {seed}: {what}")),
        }
    }
}

/// The words of a fault without its names and numbers.
fn kind(fault: &Fault) -> String {
    let mut words = Vec::new();
    for (i, part) in fault.what.split('"').enumerate() {
        words.push(if i % 2 == 1 {
            "_".to_owned()
        } else {
            part.replace(|c: char| c.is_ascii_digit() || c == '-', "")
        });
    }
    words.join("")
}

/// What came of one case: kept, refused by the program, or broken.
type Outcome = Result<Result<Kept, Fault>, String>;

fn caught(work: impl FnOnce() -> Outcome) -> Outcome {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let said = panic.downcast_ref::<String>().cloned();
        Err(format!("panic: {}", said.or(panic.downcast_ref::<&str>().map(|s| s.to_string())).unwrap_or_default()))
    })
}

#[test]
fn every_built_in_case_keeps_the_promise_and_gives_the_same_bytes_again() {
    for (name, _) in CASES {
        let case = named(name).unwrap().unwrap();
        keep(&case).unwrap_or_else(|what| panic!("{name}: {what}")).unwrap_or_else(|fault| panic!("{name}: {fault}"));
        let state = || {
            let mut bytes = Vec::new();
            convert(&case, &mut Nobody).unwrap().mesh.write_state(&mut bytes);
            bytes
        };
        assert!(state() == state(), "{name} differs from run to run");
    }
}

#[test]
fn every_random_case_becomes_convex_quadrilaterals_with_its_boundary_untouched() {
    all_random_cases(100, &|seed| keep(&random_case(seed)));
}

/// Holds `one` against the cases of seeds from 0 on: as many as are asked for, unless the environment says from which
/// seed on and how many.
fn all_random_cases(rounds: u64, one: &(dyn Fn(u64) -> Outcome + Sync)) {
    let one = |seed| caught(|| one(seed));
    if let Some(seed) = environment::number("QUADFRONT_SEED") {
        if std::env::var_os("QUADFRONT_SHOW").is_some() {
            println!("{}", random_case(seed).text);
        }
        match one(seed) {
            Ok(Ok(kept)) => println!("{} triangles, {} quadrilaterals", kept.triangles, kept.quads),
            Ok(Err(fault)) => println!("refused: {fault}"),
            Err(what) => panic!("{what}"),
        }
        return;
    }
    let rounds = environment::number("QUADFRONT_SOAK_ROUNDS").unwrap_or(rounds);
    let from = environment::number("QUADFRONT_SOAK_FROM").unwrap_or(0);
    let (next, tally) = (AtomicU64::new(from), Mutex::new(Tally::default()));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= from + rounds {
                        return;
                    }
                    let begun = Instant::now();
                    let outcome = one(seed);
                    tally.lock().unwrap().count(seed, begun.elapsed(), outcome);
                }
            });
        }
    });
    let mut tally = tally.into_inner().unwrap();
    tally.broken.sort();
    let refused: usize = tally.refused.values().map(Vec::len).sum();
    println!(
        "{} kept with {} quadrilaterals ({} needed more than matching), {refused} refused, {} broken; slowest {:?}, \
         largest {:?}",
        tally.kept,
        tally.quads,
        tally.templates,
        tally.broken.len(),
        tally.slowest,
        tally.largest
    );
    for (kind, seeds) in &tally.refused {
        println!("refused {} times, as with seeds {:?}: {kind}", seeds.len(), &seeds[..seeds.len().min(8)]);
    }
    let first = tally.broken.first().map_or(String::new(), |what| {
        let seed = what["seed ".len()..].split(':').next().unwrap().parse().unwrap();
        let text = catch_unwind(|| random_case(seed).text).unwrap_or_default();
        format!("{}\n\nthe first as a case:\n\n{text}", tally.broken.join("\n"))
    });
    assert!(tally.broken.is_empty(), "{first}");
    assert!(refused * ONE_REFUSED_OF <= rounds as usize, "{refused} of {rounds} valid cases are refused");
}
