//! The program: what its arguments ask for, and how it ends.

use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::time::Duration;

use clap::Parser;

#[cfg(feature = "window")]
use super::command_line::Overrides;
use super::command_line::{Cli, Command, OpenArguments};
#[cfg(feature = "window")]
use super::film;
use super::progress::{INTERRUPT, KEEPS};
use super::{cases, check, compare, complain, convert, lesson, notes, page, reduce, render, sweep};
#[cfg(feature = "window")]
use super::{input, window};
use crate::core::fault::Fault;
use crate::core::formats::save;
#[cfg(feature = "window")]
use crate::core::record::link::Link;

/// Bad input or usage.
const BAD_INPUT: u8 = 2;
/// Ctrl-C, as shells report it.
const INTERRUPTED: u8 = 130;
/// The time that work has to end by itself after Ctrl-C.
const GRACE: Duration = Duration::from_millis(500);

/// Runs the program with the process's own arguments.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // clap returns help and version as "errors" for standard output. A failed write cannot be reported
            // anywhere.
            let _ = error.print();
            return if error.use_stderr() { ExitCode::from(BAD_INPUT) } else { ExitCode::SUCCESS };
        }
    };
    // Files are renamed into place when complete; the handler removes incomplete ones. Without a handler (no system
    // refuses one) Ctrl-C would still end the process, but leave a temporary file.
    let _ = ctrlc::set_handler(|| {
        if !KEEPS.load(Ordering::Relaxed) {
            save::abandon();
        }
        INTERRUPT.ask();
        // Work that notices ends by itself and removes its own temporary files.
        std::thread::sleep(GRACE);
        save::abandon();
        std::process::exit(i32::from(INTERRUPTED));
    });
    let done = match cli.command.as_ref().unwrap_or(&Command::Open(OpenArguments::of("example1"))) {
        Command::Open(arguments) => open(arguments),
        Command::Convert(arguments) => convert::convert(arguments),
        Command::Background(arguments) => convert::background(arguments).map(|()| ExitCode::SUCCESS),
        Command::Check(arguments) => check::check(arguments),
        Command::Compare(arguments) => compare::compare(arguments),
        Command::Reduce(arguments) => reduce::reduce(arguments).map(|()| ExitCode::SUCCESS),
        Command::Sweep(arguments) => sweep::sweep(arguments),
        Command::Notes(arguments) => notes::notes(arguments).map(|()| ExitCode::SUCCESS),
        #[cfg(feature = "window")]
        Command::Animate(arguments) => film::animate(arguments).map(|()| ExitCode::SUCCESS),
        Command::Render(arguments) => render::render(arguments).map(|()| ExitCode::SUCCESS),
        Command::Page(arguments) => page::page(arguments).map(|()| ExitCode::SUCCESS),
        Command::Lesson(arguments) => lesson::lesson(arguments),
        Command::Cases(arguments) => cases::cases(arguments).map(|()| ExitCode::SUCCESS),
    };
    if INTERRUPT.is_asked() {
        return ExitCode::from(INTERRUPTED);
    }
    done.unwrap_or_else(|fault| {
        complain(&fault);
        ExitCode::from(BAD_INPUT)
    })
}

/// Opens the window.
#[cfg(feature = "window")]
fn open(arguments: &OpenArguments) -> Result<ExitCode, Fault> {
    let OpenArguments { input, overrides, mesh, predict } = arguments;
    let options = mesh.options();
    let has_options = *overrides != Overrides::default() || options != Default::default() || predict.is_some();
    if Link::is_link(input) {
        if has_options {
            return Err(Fault::new("A link says by itself what is opened, and how")
                .at("the link")
                .remedy("Leave the options out, or write parameters into the link: &c=1.8 for --set c=1.8"));
        }
        // Faults are reported on the terminal, before the window opens.
        Link::parse(input)?;
        return window::open(vec![window::Command::OpenLink(input.clone())]);
    }
    let mut source = window::Source::named(input);
    if let window::Source::Lesson(name) = &source {
        if has_options {
            return Err(Fault::new("A lesson has a run and questions of its own")
                .at(name)
                .remedy("Leave the options out, or write [parameters] into the head of the lesson"));
        }
        return open_lesson(name);
    }
    // Report missing files and unsuitable options on the terminal, before the window opens.
    input::check(input, &options, overrides)?;
    if let window::Source::File(path) = &source {
        save::find(path)?;
        if options != Default::default() {
            source = window::Source::Mesh(path.clone(), options);
        }
    }
    let mut first = vec![window::Command::OpenWith(source, Box::new(overrides.clone()))];
    first.extend(predict.clone().map(|series| window::Command::Study(window::StudyCommand::PredictSeries(series))));
    window::open(first)
}

/// Opens a lesson in the window.
#[cfg(feature = "window")]
pub(super) fn open_lesson(name: &str) -> Result<ExitCode, Fault> {
    // Faults of the file are reported on the terminal.
    lesson::found(name)?;
    window::open(vec![window::Command::Open(window::Source::Lesson(name.to_owned()))])
}

#[cfg(not(feature = "window"))]
fn open(_: &OpenArguments) -> Result<ExitCode, Fault> {
    Err(without_window())
}

#[cfg(not(feature = "window"))]
pub(super) fn open_lesson(_: &str) -> Result<ExitCode, Fault> {
    Err(without_window())
}

#[cfg(not(feature = "window"))]
fn without_window() -> Fault {
    Fault::new("This quadfront was built without its window")
        .remedy("Build it with the feature \"window\", or use quadfront convert and quadfront render")
}
