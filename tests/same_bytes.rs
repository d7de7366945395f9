//! Promise: the same case and parameters give the same bytes. A table of fingerprints of every built-in case, at three
//! steps, at the end and as the mesh file that is written, with its own parameters and with `--paper`.
//!
//! A change that alters results on purpose writes the table anew: `QUADFRONT_SAME_BYTES=write cargo test --test
//! same_bytes`.
#![allow(clippy::unwrap_used)]

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use quadfront::core::case::built_in;
use quadfront::core::convert::background;
use quadfront::core::convert::{Converter, Phase};
use quadfront::core::formats::format::write_to;
use quadfront::core::formats::{Format, WriteOptions};
use quadfront::core::kernel::Fingerprint;
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use rayon::prelude::*;

/// Shares of all steps, in quarters, at which a state is compared.
const QUARTERS: [u64; 4] = [1, 2, 3, 4];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reading {
    Own,
    Paper,
}

impl Reading {
    fn word(self) -> &'static str {
        match self {
            Reading::Own => "own",
            Reading::Paper => "paper",
        }
    }
}

fn table() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/same_bytes.txt")
}

/// The rows of one case: of its states at the given steps, or at the quarters of all steps, and of its mesh file.
fn rows(name: &str, reading: Reading, steps: Option<&[u64]>) -> String {
    let mut case = built_in::named(name).unwrap().unwrap();
    if reading == Reading::Paper {
        case.parameters = case.parameters.read_as_paper();
    }
    let made = background(&case, &mut Nobody).unwrap();
    let start = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
    let steps = steps.map_or_else(
        || {
            let mut all = start.clone();
            all.run(&mut Nobody).unwrap();
            QUARTERS.map(|quarter| all.counts.steps * quarter / 4).to_vec()
        },
        <[u64]>::to_vec,
    );
    let mut converter = start;
    let mut rows = String::new();
    for step in steps {
        while converter.counts.steps < step && *converter.phase() != Phase::Done {
            converter.step().unwrap();
        }
        let done = if *converter.phase() == Phase::Done { "end" } else { "on the way" };
        let (at, state) = (converter.counts.steps, converter.fingerprint());
        writeln!(rows, "{name} {} step {at} {state} {done}", reading.word()).unwrap();
    }
    let mut file = Vec::new();
    let export = Export::of(&converter.mesh, &made.names);
    write_to(&mut file, Format::Msh, &export.file, WriteOptions::default()).unwrap();
    writeln!(rows, "{name} {} mesh {}", reading.word(), Fingerprint::of(&file)).unwrap();
    rows
}

/// The lines of a table that are of a case, and the steps that they name.
fn told(table: &str, name: &str, reading: Reading) -> (String, Vec<u64>) {
    let own = |line: &&str| line.split(' ').take(2).eq([name, reading.word()]);
    let lines: Vec<&str> = table.lines().filter(own).collect();
    let steps = lines.iter().filter_map(|line| line.split_once(" step ")?.1.split(' ').next()?.parse().ok()).collect();
    (lines.iter().map(|line| format!("{line}\n")).collect(), steps)
}

#[test]
fn every_built_in_case_gives_the_bytes_that_it_gave_before() {
    let pairs: Vec<_> = built_in::all().flat_map(|(name, _)| [(name, Reading::Own), (name, Reading::Paper)]).collect();
    if std::env::var("QUADFRONT_SAME_BYTES").is_ok_and(|value| value == "write") {
        let all: Vec<String> = pairs.par_iter().map(|&(name, reading)| rows(name, reading, None)).collect();
        fs::write(table(), all.concat()).unwrap();
    }
    let table = fs::read_to_string(table()).unwrap();
    let compare = |&(name, reading): &(&str, Reading)| {
        let (told, steps) = told(&table, name, reading);
        let now = rows(name, reading, Some(&steps));
        (told != now || steps.len() != QUARTERS.len()).then(|| format!("told\n{told}now\n{now}"))
    };
    let others: Vec<String> = pairs.par_iter().filter_map(compare).collect();
    assert!(others.is_empty(), "\n{}", others.join("\n"));
    assert_eq!(table.lines().count(), pairs.len() * (QUARTERS.len() + 1), "the table has rows of no built-in case");
}

#[test]
fn another_fingerprint_is_seen() {
    let name = "figure-19";
    let (right, steps) = told(&fs::read_to_string(table()).unwrap(), name, Reading::Own);
    assert_eq!(rows(name, Reading::Own, Some(&steps)), right);
    let mut case = built_in::named(name).unwrap().unwrap();
    case.parameters.c += 0.5;
    let made = background(&case, &mut Nobody).unwrap();
    let mut converter = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
    converter.run(&mut Nobody).unwrap();
    assert!(!right.contains(&converter.fingerprint().to_string()), "other parameters are another state");
}
