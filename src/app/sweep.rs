//! `sweep`: one conversion for each value of a parameter, or for each pair of values of two.

mod outputs;
mod pool;
mod shell;

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::command_line::SweepArguments;
use super::input;
use super::output::Stream;
use super::progress::{INTERRUPT, counting};
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::number::counted;
use crate::core::record::report::figures::{FIGURES, Figure};
use crate::core::record::sweep::{Axis, Cell, DEFAULT_AXES, DEFAULT_FIGURE, Sweep, TIME};
use crate::core::run::Run;
use crate::render::vector::heat_map::{Scale, meaning};
use outputs::{Adopted, Outputs, SweepLook, adopt};

/// Sweeps one or two parameters of a case.
pub(super) fn sweep(arguments: &SweepArguments) -> Result<ExitCode, Fault> {
    let SweepArguments { source, mesh, over, show, out, list, collect, jobs } = arguments;
    let look = look(show);
    let (outputs, messages) = Outputs::of(out)?;
    let input = input::read(source, &mesh.options())?;
    let defaults = DEFAULT_AXES.map(str::to_owned);
    let axes = if over.is_empty() { &defaults[..] } else { over };
    let axes: Result<_, Fault> = axes.iter().map(|text| Axis::parse(text)).collect();
    let sweep = axes.and_then(|axes| Sweep::new(&input.run, axes)).map_err(|fault| fault.at("--over"));
    let mut sweep = sweep?;
    if let Some(folder) = list {
        return list_commands(arguments, &sweep, folder).map(|()| ExitCode::SUCCESS);
    }
    let told = match collect {
        Some(folder) => collected(folder, &mut sweep)?,
        None => outputs.go_on(&mut sweep)?,
    };
    if !source.quiet {
        told.iter().for_each(|line| Stream::Error.print(line));
    }
    let write = |sweep: &Sweep| outputs.write(&input.run.case, sweep, look);
    write(&sweep)?;
    if collect.is_none() {
        let threads = jobs.or_else(|| std::thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
        convert(&input.run, &mut sweep, threads, source.quiet, &write)?;
    }
    if !source.quiet {
        messages.print(&summary(&sweep, look.figure));
    }
    if outputs.is_empty() {
        messages.print(&table(&sweep, look.figure));
    }
    Ok(ExitCode::SUCCESS)
}

/// What is shown: the first figure that is named.
fn look(show: &[&'static Figure]) -> SweepLook<'static> {
    let with_time = show.iter().any(|figure| figure.name == TIME);
    let figure = show.first().copied().or_else(|| Figure::named(DEFAULT_FIGURE));
    SweepLook { figure: figure.unwrap_or(&FIGURES[0]), with_time }
}

/// Converts the missing cells, and writes what there is after each.
fn convert(
    run: &Run,
    sweep: &mut Sweep,
    threads: usize,
    quiet: bool,
    write: &dyn Fn(&Sweep) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let bar = counting("Sweeping", "cells", sweep.cells().len(), sweep.missing().len(), quiet);
    let mut written = Ok(());
    let mut filled = sweep.clone();
    pool::convert(run, sweep, threads, &mut |cells| {
        bar.inc(cells.len() as u64);
        bar.tick();
        if !cells.is_empty() && written.is_ok() {
            cells.into_iter().for_each(|(cell, done)| filled.fill(cell, done));
            written = write(&filled);
        }
        written.is_ok() && !INTERRUPT.is_asked()
    });
    bar.finish_and_clear();
    *sweep = filled;
    written
}

/// Prints one command for each cell, and makes the folder that they write to.
fn list_commands(arguments: &SweepArguments, sweep: &Sweep, folder: &Path) -> Result<(), Fault> {
    if arguments.source.input == "-" {
        return Err(Fault::new("Commands for cells cannot read standard input").at("--list").remedy("Name a file"));
    }
    std::fs::create_dir_all(folder).map_err(|error| {
        Fault::new(format!("The folder cannot be made: {error}"))
            .of_kind(FaultKind::Io)
            .at(folder.display().to_string())
            .remedy("Name another folder: --list=FOLDER")
    })?;
    let program = std::env::args().next().unwrap_or_else(|| env!("CARGO_PKG_NAME").to_owned());
    let lines = shell::commands(arguments, sweep, &program, folder);
    Stream::Output.print(&(lines.join("\n") + "\n"));
    Ok(())
}

/// Takes over the cells of the JSON files in a folder, and returns what is to be said about it.
fn collected(folder: &Path, sweep: &mut Sweep) -> Result<Vec<String>, Fault> {
    let refuse = |error: std::io::Error| {
        Fault::new(format!("The folder cannot be read: {error}"))
            .of_kind(FaultKind::Io)
            .at(folder.display().to_string())
            .remedy("Name the folder that the commands of --list write to")
    };
    let entries = std::fs::read_dir(folder).map_err(refuse)?;
    let mut paths: Vec<PathBuf> = entries.map(|entry| Ok(entry?.path())).collect::<Result<_, _>>().map_err(refuse)?;
    paths.retain(|path| path.extension().is_some_and(|e| e == "json"));
    paths.sort();
    let mut told = Vec::new();
    for path in paths {
        let why = match adopt(&path, sweep)? {
            Adopted::Cells(0) => "it has no cell that is missing".to_owned(),
            Adopted::Cells(_) => continue,
            Adopted::Foreign(why) => why,
            Adopted::NoSweep => "it is no sweep".to_owned(),
        };
        told.push(format!("{} is left out: {why}.\n", path.display()));
    }
    Ok(told)
}

/// A few lines on a sweep.
fn summary(sweep: &Sweep, figure: &Figure) -> String {
    let mut text = format!("{}: {}\n", sweep.case.name, sweep.case.title);
    let mut row = |head: &str, value: &str| text += &format!("  {head:<14} {value}\n");
    let keys: Vec<_> = sweep.axes().iter().map(|axis| axis.key).collect();
    let refused = sweep.cells().iter().enumerate().filter_map(|(k, cell)| match cell {
        Some(Cell::Refused(why)) => Some((k, why)),
        _ => None,
    });
    let refused: Vec<_> = refused.collect();
    let missing = sweep.missing().len();
    let done = sweep.cells().len() - missing;
    let cells = if missing == 0 { counted(done as u64, "cell") } else { format!("{done} of {} cells", done + missing) };
    row("sweep", &format!("{cells} over {}", keys.join(" and ")));
    row("figure", &format!("{}: {}", figure.name, meaning(figure)));
    if let Some(scale) = Scale::of(sweep, figure) {
        let value = |cell| sweep.value(cell, figure).map(|value| scale.text_with_unit(value, figure));
        let best = sweep.best(figure);
        if let Some((cell, value)) = best.first().and_then(|cell| Some((*cell, value(*cell)?))) {
            let more = if best.len() > 1 { format!(" and {} more", best.len() - 1) } else { String::new() };
            row("best", &format!("{value} at {}{more}", sweep.name(cell)));
        }
        if let Some((cell, value)) = sweep.own().and_then(|cell| Some((cell, value(cell)?))) {
            row("the case's own", &format!("{value} at {}", sweep.name(cell)));
        }
    }
    if let Some((cell, why)) = refused.first() {
        row("refused", &format!("{}; {}: {why}", counted(refused.len() as u64, "cell"), sweep.name(*cell)));
    }
    if missing > 0 {
        row("missing", &counted(missing as u64, "cell"));
    }
    text
}

/// The values of a figure as a table, the second axis downward.
fn table(sweep: &Sweep, figure: &Figure) -> String {
    let scale = Scale::of(sweep, figure);
    let [columns, rows] = sweep.shape();
    let cell = |cell: usize| match (&sweep.cells()[cell], scale.zip(sweep.value(cell, figure))) {
        (_, Some((scale, value))) => scale.text(value),
        (Some(Cell::Refused(_)), _) => "refused".to_owned(),
        (Some(_), _) => "none".to_owned(),
        (None, _) => String::new(),
    };
    let axes = sweep.axes();
    let heads = |k: usize| axes.get(k).map_or_else(|| vec![String::new()], |axis| axis.values.clone());
    let corner = axes.iter().skip(1).map(|axis| axis.key).chain([axes[0].key]).collect::<Vec<_>>().join(" \\ ");
    let mut lines = vec![[vec![corner], heads(0)].concat()];
    for (row, head) in (0..rows).zip(heads(1)) {
        lines.push([vec![head], (0..columns).map(|column| cell(row * columns + column)).collect()].concat());
    }
    let width = |k: usize| lines.iter().map(|line| line[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..=columns).map(width).collect();
    let line = |line: &Vec<String>| {
        let padded = line.iter().zip(&widths).map(|(text, &width)| format!("{text:>width$}"));
        padded.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    lines.iter().map(line).collect()
}
