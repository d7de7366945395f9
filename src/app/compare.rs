//! `compare`: two runs side by side, or a run and a finished mesh: their first difference, and what both end with.

mod finished;

use std::process::ExitCode;

use serde::Serialize;

use super::command_line::{CompareArguments, Overrides, Source};
use super::memory::Beside;
use super::output::Stream;
use super::progress::Progress;
use super::{FALLS_SHORT, input, work};
use crate::core::case::Parameters;
use crate::core::fault::Fault;
use crate::core::kernel::number::{UNDEFINED, counted, fixed, grouped, size};
use crate::core::progress::{Stage, Watch};
use crate::core::record::statistics::Range;
use crate::core::record::{Report, Statistics};
use crate::core::run::compare::{Did, Difference, FirstDifference, differences, first_difference};
use crate::core::run::{History, Run};
use crate::core::soup::MeshFile;
use finished::{Finished, Parted};

/// The names of the two runs in what is printed.
const NAMES: [&str; 2] = ["A", "B"];

/// A difference, and what both did there.
#[derive(Serialize)]
struct ToldDifference {
    #[serde(flatten)]
    difference: Difference,
    did: [Option<Did>; 2],
}

/// The first ones of all differences.
#[derive(Serialize)]
struct ToldDifferences {
    number: usize,
    first: Vec<ToldDifference>,
}

/// A comparison as it is written as JSON.
#[derive(Serialize)]
struct WrittenComparison<'c> {
    first_difference: Option<&'c FirstDifference>,
    #[serde(skip_serializing_if = "Option::is_none")]
    differences: Option<ToldDifferences>,
    reports: &'c [Report; 2],
}

/// The report of a run at its end, without its times.
pub(super) fn report(run: &Run, watch: &mut dyn Watch) -> Result<Report, Fault> {
    watch.tell(Stage::Read, 0, 0);
    Ok(work::convert(run, None, None, false, watch)?.report)
}

/// Compares two runs: success where they never differ, exit code 1 where they do.
pub(super) fn compare(arguments: &CompareArguments) -> Result<ExitCode, Fault> {
    let CompareArguments { source, mesh, other, with, with_paper, differences, json } = arguments;
    let first = input::read(source, &mesh.options())?;
    if let Some(name) = other
        && let Some(found) = input::read_mesh(name, None, &mut Progress::new(source.quiet))?
        && found.is_of_quads()
    {
        if !with.is_empty() || *with_paper {
            return Err(Fault::new("A finished mesh has no parameters").at(name.clone()).remedy("Leave --with out"));
        }
        if differences.is_some() {
            let fault = Fault::new("A finished mesh has no decisions").at(name.clone());
            return Err(fault.remedy("Leave --differences out"));
        }
        return with_mesh(&first.run, [&source.input, name], &found, *json, source.quiet);
    }
    let second = match other {
        Some(other) => {
            let Source { from, sol, overrides, quiet, .. } = source;
            let (from, sol) = (*from, sol.clone());
            let source = Source { input: other.clone(), from, sol, overrides: overrides.clone(), quiet: *quiet };
            input::read(&source, &mesh.options())?.run
        }
        None if with.is_empty() && !with_paper => {
            return Err(Fault::new("There is nothing to compare with")
                .at(source.input.clone())
                .remedy("Name another run, or change parameters: --with c=1.5, --with-paper"));
        }
        None => first.run.clone(),
    };
    let mut runs = [first.run, second];
    let changes = Overrides { set: with.clone(), paper: *with_paper, ..Overrides::default() };
    changes.apply(&mut runs[1], "--with")?;
    let mut progress = Progress::new(source.quiet).keeping(Beside::States(2));
    let [mut a, mut b] =
        [History::open(runs[0].clone(), &mut progress)?, History::open(runs[1].clone(), &mut progress)?];
    let found = first_difference([&mut a, &mut b], &mut progress)?;
    let all = match &found {
        Some(first) if differences.is_some() => self::differences([&mut a, &mut b], first.step, &mut progress)?,
        _ => Vec::new(),
    };
    let report = |run: &Run| {
        let mut progress = Progress::new(source.quiet);
        let mut report = report(run, &mut progress)?;
        report.timing = progress.finish();
        Ok::<_, Fault>(report)
    };
    let reports = &[report(&runs[0])?, report(&runs[1])?];
    let told = differences.map(|n| {
        let first = all
            .iter()
            .take(n)
            .map(|difference| Ok(ToldDifference { difference: *difference, did: difference.told([&mut a, &mut b])? }));
        Ok::<_, Fault>(ToldDifferences { number: all.len(), first: first.collect::<Result<_, Fault>>()? })
    });
    let told = told.transpose()?;
    progress.finish();
    let first_difference = found.as_ref();
    let differ = first_difference.is_some();
    if *json {
        let written = WrittenComparison { first_difference, differences: told, reports };
        let text = serde_json::to_string_pretty(&written).expect("JSON can express all figures");
        Stream::Output.print(&format!("{text}\n"));
    } else {
        let inputs = [&source.input, other.as_ref().unwrap_or(&source.input)];
        Stream::Output.print(&text(inputs, &runs, first_difference, told.as_ref(), reports));
    }
    Ok(if differ { ExitCode::from(FALLS_SHORT) } else { ExitCode::SUCCESS })
}

fn text(
    inputs: [&String; 2],
    runs: &[Run; 2],
    found: Option<&FirstDifference>,
    differences: Option<&ToldDifferences>,
    reports: &[Report; 2],
) -> String {
    let mut text = String::new();
    for (k, name) in NAMES.into_iter().enumerate() {
        let run = &runs[k];
        let set = values_that_differ(&run.parameters, &runs[1 - k].parameters);
        let edits = match run.edits().len() as u64 {
            0 => String::new(),
            n => format!(", {}", counted(n, "edit")),
        };
        text += &format!("{name}: {}{}{set}{edits}\n", inputs[k], if set.is_empty() { "" } else { " with " });
    }
    match found {
        None => text += "no difference: every step of both leads to the same state\n",
        Some(FirstDifference { step: 0, .. }) => text += "first difference: step 0 (the background meshes differ)\n",
        Some(found) => {
            text += &format!("first difference: step {} ({})\n", found.step, kinds(&found.did));
            text += &decisions(&found.did);
        }
    }
    if let Some(ToldDifferences { number, first }) = differences {
        let differ = if *number == 1 { "differs" } else { "differ" };
        let all = counted(*number as u64, "decision");
        text += &format!("{all} {differ} although both fronts are the same around the base\n");
        for (k, ToldDifference { difference, did }) in first.iter().enumerate() {
            let [a, b] = difference.steps.map(grouped);
            text += &format!("difference {} of {number}: A at step {a}, B at step {b} ({})\n", k + 1, kinds(did));
            text += &decisions(did);
        }
    }
    text + &table(reports.each_ref().map(Ends::of))
}

/// What both did, and why.
fn decisions(did: &[Option<Did>; 2]) -> String {
    let mut text = String::new();
    for (name, did) in NAMES.iter().zip(did) {
        match did {
            Some(Did { text: line, why, .. }) => {
                text += &format!("  {name}: {line}\n");
                why.iter().for_each(|sentence| text += &format!("     {sentence}\n"));
            }
            None => text += &format!("  {name}: had ended\n"),
        }
    }
    text
}

/// The parameters that differ from others, with their values.
pub(super) fn values_that_differ(parameters: &Parameters, others: &Parameters) -> String {
    let differ = Parameters::KEYS.iter().filter_map(|key| {
        let [value, other] = [parameters, others].map(|parameters| parameters.text_of(key));
        (value != other).then(|| format!("{key} = {}", value.as_deref().unwrap_or("(none)")))
    });
    differ.collect::<Vec<_>>().join(", ")
}

/// The kinds of what both did.
fn kinds(did: &[Option<Did>; 2]) -> String {
    let [a, b] = did.each_ref().map(|did| did.as_ref().map_or("ended", |did| did.event.kind().name()));
    if a == b { a.replace('_', " ") } else { format!("A {}, B {}", a.replace('_', " "), b.replace('_', " ")) }
}

/// Compares a run with a finished mesh.
fn with_mesh(run: &Run, inputs: [&String; 2], mesh: &MeshFile, json: bool, quiet: bool) -> Result<ExitCode, Fault> {
    let mut progress = Progress::new(quiet);
    let found = finished::compare(run, mesh, &mut progress)?;
    progress.finish();
    let mut progress = Progress::new(quiet);
    let mut report = report(run, &mut progress)?;
    report.timing = progress.finish();
    let differ = found.first_difference.is_some();
    if json {
        let text = serde_json::json!({ "comparison": found, "report": report });
        Stream::Output.print(&format!("{text:#}\n"));
    } else {
        Stream::Output.print(&text_beside_mesh(inputs, &found, &report));
    }
    Ok(if differ { ExitCode::from(FALLS_SHORT) } else { ExitCode::SUCCESS })
}

fn text_beside_mesh([a, b]: [&String; 2], found: &Finished, report: &Report) -> String {
    let Finished { both, only: [only_a, only_b], statistics, first_difference } = found;
    let quads = |n: usize| counted(n as u64, "quadrilateral");
    let mut text = format!("A: {a}\nB: {b}, a mesh of {}\n", quads(both + only_b));
    match first_difference {
        None => text += "no difference: both have the same quadrilaterals\n",
        Some(Parted { step, corners, did }) => {
            let kind = did.as_ref().map_or("given", |did| did.event.kind().name()).replace('_', " ");
            text += &format!("first difference: step {step} ({kind})\n");
            if let Some(Did { text: line, why, .. }) = did {
                text += &format!("  A: {line}\n");
                why.iter().for_each(|sentence| text += &format!("     {sentence}\n"));
            }
            text += &match corners {
                Some(corners) => {
                    let corners = corners.map(|p| format!("({})", p.map(size).join(", ")));
                    format!("  B: has no quadrilateral with the corners {}\n", corners.join(", "))
                }
                None => format!("  B: has {} more\n", quads(*only_b)),
            };
        }
    }
    text += &format!("{} in both, {only_a} only in A, {only_b} only in B\n", quads(*both));
    text + &table([Ends::of(report), Ends::of_mesh(both + only_b, statistics.as_ref())])
}

/// What a run ends with, or what a mesh has.
struct Ends<'r> {
    quads: usize,
    mesh: Option<&'r Statistics>,
    report: Option<&'r Report>,
}

impl<'r> Ends<'r> {
    fn of(report: &'r Report) -> Ends<'r> {
        Ends { quads: report.mesh.quads, mesh: Some(&report.mesh), report: Some(report) }
    }

    fn of_mesh(quads: usize, mesh: Option<&'r Statistics>) -> Ends<'r> {
        Ends { quads, mesh, report: None }
    }

    fn measured(&self, text: impl Fn(&Statistics) -> String) -> String {
        self.mesh.map_or_else(|| UNDEFINED.to_owned(), text)
    }

    fn told(&self, text: impl Fn(&Report) -> String) -> String {
        self.report.map_or_else(|| UNDEFINED.to_owned(), text)
    }
}

/// What both end with.
fn table(ends: [Ends<'_>; 2]) -> String {
    let jacobian = |range: Option<Range>| {
        range.map_or("none".to_owned(), |range| format!("{} / {}", fixed(range.min, 3), fixed(range.mean, 3)))
    };
    type Figure<'f> = (&'f str, &'f dyn Fn(&Ends<'_>) -> String);
    let rows: [Figure<'_>; 9] = [
        ("quadrilaterals", &|e| grouped(e.quads as u64)),
        ("background triangles", &|e| e.told(|r| grouped(r.background_triangles as u64))),
        ("irregular nodes", &|e| {
            e.measured(|m| format!("{} ({} %)", grouped(m.irregular.irregular as u64), fixed(m.irregular.percent, 1)))
        }),
        ("angles, metric", &|e| {
            e.measured(|m| format!("{}–{}°", fixed(m.metric_angles.min, 1), fixed(m.metric_angles.max, 1)))
        }),
        ("within 60–120°", &|e| e.measured(|m| format!("{} %", fixed(100.0 * m.metric_angles.share_60_120, 1)))),
        ("edge length", &|e| {
            e.measured(|m| format!("{} ± {}", fixed(m.lengths.mean, 2), fixed(m.lengths.deviation, 2)))
        }),
        ("scaled Jacobian", &|e| e.measured(|m| jacobian(m.metric_scaled_jacobian))),
        ("by the last resort", &|e| e.told(|r| grouped(r.last_resort.quads as u64))),
        ("time", &|e| e.told(|r| format!("{} s", fixed(r.timing.iter().map(|(_, seconds)| seconds).sum(), 2)))),
    ];
    let mut text = format!("  {:<22} {:>16} {:>16}\n", "", "A", "B");
    for (head, value) in rows {
        let [a, b] = ends.each_ref().map(value);
        text += &format!("  {head:<22} {a:>16} {b:>16}\n");
    }
    text
}
