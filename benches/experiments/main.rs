//! The experiments behind the defaults (paper 4.3.1 to 4.3.7): each switch of the conversion against the others, on
//! several backgrounds of each case, and what every built-in case comes to. Writes Markdown to standard output, the
//! same bytes on every run; how far it is goes to standard error.
#![allow(clippy::unwrap_used)]

mod background;
mod outcome;
mod report;
mod settings;
mod work;

use quadfront::core::case::built_in::CASES;

use background::{Subject, backgrounds};
use outcome::{Outcome, convert};
use report::{features, heading, operations, spread, tables};
use settings::{QUESTIONS, Setting};
use work::in_parallel;

/// Cases of the tables that hold one switch against another, with the scale of their sizes and the number of
/// backgrounds.
const COMPARED: [(&str, f64, u64); 11] = [
    ("example1", 1.0, 5),
    ("example1", 0.5, 5),
    ("example1", 0.25, 2),
    ("uniform", 0.283, 2),
    ("graded-plate", 1.0, 2),
    ("polar-2", 1.0, 5),
    ("gear", 1.0, 5),
    ("airfoil", 1.0, 2),
    ("crack", 1.0, 5),
    ("two-faces", 1.0, 5),
    ("polar-1", 1.0, 5),
];

/// What else the table of all cases has beside each at its own size.
const FINER: [(&str, f64); 3] = [("example1", 0.5), ("example1", 0.25), ("uniform", 0.2)];

fn main() {
    println!("{}", heading());
    compare();
    every_case();
}

/// One table for each question: settings down, cases across.
fn compare() {
    let subjects: Vec<Subject> =
        COMPARED.iter().map(|&(name, scale, count)| Subject::new(name, scale, count)).collect();
    let made = in_parallel("backgrounds", &subjects, |subject| backgrounds(subject, 0.1));
    let settings = Setting::all();
    let jobs: Vec<(usize, usize, usize)> = (0..settings.len())
        .flat_map(|s| (0..subjects.len()).map(move |c| (s, c)))
        .flat_map(|(s, c)| (0..made[c].len()).map(move |b| (s, c, b)))
        .collect();
    let outcomes = in_parallel("comparisons", &jobs, |&(s, c, b)| {
        convert(&made[c][b], &settings[s].applied_to(&subjects[c].case.parameters))
    });
    let of = |setting: &Setting, c: usize| -> Vec<&Outcome> {
        let s = settings.iter().position(|s| s == setting).unwrap();
        jobs.iter().zip(&outcomes).filter(|(job, _)| (job.0, job.1) == (s, c)).map(|(_, outcome)| outcome).collect()
    };
    println!("{}", spread(&subjects, of));
    for question in &QUESTIONS {
        println!("{}", tables(question, &subjects, of));
    }
}

/// Every built-in case on its own background, by the defaults and by the paper's reading.
fn every_case() {
    let subjects: Vec<Subject> = CASES
        .iter()
        .map(|&(name, _)| (name, 1.0))
        .chain(FINER)
        .map(|(name, scale)| Subject::new(name, scale, 1))
        .collect();
    let settings = [Setting::Defaults, Setting::Paper];
    let made = in_parallel("built-in cases, backgrounds", &subjects, |subject| backgrounds(subject, 0.0));
    let jobs: Vec<(usize, Setting)> = (0..subjects.len()).flat_map(|c| settings.map(|s| (c, s))).collect();
    let outcomes = in_parallel("built-in cases", &jobs, |(c, setting)| {
        convert(&made[*c][0], &setting.applied_to(&subjects[*c].case.parameters))
    });
    for setting in settings {
        let rows: Vec<_> = jobs
            .iter()
            .zip(&outcomes)
            .filter(|(job, _)| job.1 == setting)
            .map(|(job, outcome)| (&subjects[job.0], outcome))
            .collect();
        println!("{}", features(&setting, &rows));
        println!("{}", operations(&setting, &rows));
    }
}
