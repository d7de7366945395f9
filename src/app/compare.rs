//! `compare`: two runs side by side: their first difference, and what both end with.

use std::process::ExitCode;

use serde::Serialize;

use super::command_line::{CompareArguments, Overrides, Source};
use super::output::Stream;
use super::progress::Progress;
use super::{FALLS_SHORT, input, work};
use crate::core::case::Parameters;
use crate::core::fault::Fault;
use crate::core::kernel::number::{counted, fixed, grouped};
use crate::core::progress::{Stage, Watch};
use crate::core::record::Report;
use crate::core::record::statistics::Range;
use crate::core::run::compare::{Did, FirstDifference, first_difference};
use crate::core::run::{History, Run};

/// The names of the two runs in what is printed.
const NAMES: [&str; 2] = ["A", "B"];

/// Where two runs differ first, and what they end with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// `None` where they never differ.
    pub first_difference: Option<FirstDifference>,
    /// The report of each at its end, with the time that it takes by itself.
    pub reports: [Report; 2],
}

impl Comparison {
    /// Compares two runs; `report` gives the report of each at its end.
    ///
    /// # Errors
    /// A conversion that cannot continue, and cancellation.
    pub fn of(
        runs: &[Run; 2],
        watch: &mut dyn Watch,
        mut report: impl FnMut(&Run) -> Result<Report, Fault>,
    ) -> Result<Comparison, Fault> {
        let first_difference = {
            let [mut a, mut b] = [History::open(runs[0].clone(), watch)?, History::open(runs[1].clone(), watch)?];
            first_difference([&mut a, &mut b], watch)?
        };
        Ok(Comparison { first_difference, reports: [report(&runs[0])?, report(&runs[1])?] })
    }
}

/// The report of a run at its end, without its times.
pub(super) fn report(run: &Run, watch: &mut dyn Watch) -> Result<Report, Fault> {
    watch.tell(Stage::Read, 0, 0);
    Ok(work::convert(run, None, None, false, watch)?.report)
}

/// Compares two runs: success where they never differ, exit code 1 where they do.
pub(super) fn compare(arguments: &CompareArguments) -> Result<ExitCode, Fault> {
    let CompareArguments { source, mesh, other, with, with_paper, json } = arguments;
    let first = input::read(source, &mesh.options())?;
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
    let mut progress = Progress::new(source.quiet);
    let comparison = Comparison::of(&runs, &mut progress, |run| {
        let mut progress = Progress::new(source.quiet);
        let mut report = report(run, &mut progress)?;
        report.timing = progress.finish();
        Ok(report)
    })?;
    progress.finish();
    let differ = comparison.first_difference.is_some();
    if *json {
        let text = serde_json::to_string_pretty(&comparison).expect("JSON can express all figures");
        Stream::Output.print(&format!("{text}\n"));
    } else {
        let inputs = [&source.input, other.as_ref().unwrap_or(&source.input)];
        Stream::Output.print(&text(inputs, &runs, comparison.first_difference.as_ref(), &comparison.reports));
    }
    Ok(if differ { ExitCode::from(FALLS_SHORT) } else { ExitCode::SUCCESS })
}

fn text(inputs: [&String; 2], runs: &[Run; 2], found: Option<&FirstDifference>, reports: &[Report; 2]) -> String {
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
            for (name, did) in NAMES.iter().zip(&found.did) {
                match did {
                    Some(Did { text: line, why, .. }) => {
                        text += &format!("  {name}: {line}\n");
                        why.iter().for_each(|sentence| text += &format!("     {sentence}\n"));
                    }
                    None => text += &format!("  {name}: had ended\n"),
                }
            }
        }
    }
    text + &table(reports)
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
pub(super) fn kinds(did: &[Option<Did>; 2]) -> String {
    let [a, b] = did.each_ref().map(|did| did.as_ref().map_or("ended", |did| did.event.kind().name()));
    if a == b { a.replace('_', " ") } else { format!("A {}, B {}", a.replace('_', " "), b.replace('_', " ")) }
}

/// What both end with.
fn table(reports: &[Report; 2]) -> String {
    let jacobian = |range: Option<Range>| {
        range.map_or("none".to_owned(), |range| format!("{} / {}", fixed(range.min, 3), fixed(range.mean, 3)))
    };
    type Figure<'f> = (&'f str, &'f dyn Fn(&Report) -> String);
    let rows: [Figure<'_>; 9] = [
        ("quadrilaterals", &|r| grouped(r.mesh.quads as u64)),
        ("background triangles", &|r| grouped(r.background_triangles as u64)),
        ("irregular nodes", &|r| {
            format!("{} ({} %)", grouped(r.mesh.irregular.irregular as u64), fixed(r.mesh.irregular.percent, 1))
        }),
        ("angles, metric", &|r| {
            format!("{}–{}°", fixed(r.mesh.metric_angles.min, 1), fixed(r.mesh.metric_angles.max, 1))
        }),
        ("within 60–120°", &|r| format!("{} %", fixed(100.0 * r.mesh.metric_angles.share_60_120, 1))),
        ("edge length", &|r| format!("{} ± {}", fixed(r.mesh.lengths.mean, 2), fixed(r.mesh.lengths.deviation, 2))),
        ("scaled Jacobian", &|r| jacobian(r.mesh.metric_scaled_jacobian)),
        ("by the last resort", &|r| grouped(r.last_resort.quads as u64)),
        ("time", &|r| format!("{} s", fixed(r.timing.iter().map(|(_, seconds)| seconds).sum(), 2))),
    ];
    let mut text = format!("  {:<22} {:>16} {:>16}\n", "", "A", "B");
    for (head, value) in rows {
        let [a, b] = reports.each_ref().map(value);
        text += &format!("  {head:<22} {a:>16} {b:>16}\n");
    }
    text
}
