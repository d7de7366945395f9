//! The command line and the window: they tie `core` and `render` together.

mod command_line;
mod input;
mod memory;
mod output;
mod progress;
mod work;
mod figure;
mod convert;
mod check;
mod cases;
mod lesson;
mod compare;
mod reduce;
mod sweep;
mod render;
mod notes;
#[cfg(feature = "window")]
mod film;
#[cfg(feature = "window")]
pub mod window;

use std::io::{self, Write};
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::time::Duration;

use clap::Parser;

use crate::core::fault::Fault;
use crate::core::formats::save;
#[cfg(feature = "window")]
use command_line::Overrides;
use command_line::{Cli, Command, OpenArguments};
use progress::{INTERRUPT, KEEPS};

/// A mesh that was checked or converted is not valid, or runs that were compared differ.
const FALLS_SHORT: u8 = 1;
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
    let mut source = window::Source::named(input);
    if let window::Source::Lesson(name) = &source {
        if *overrides != Overrides::default() || options != Default::default() || predict.is_some() {
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
    window::open(source, overrides.clone(), predict.clone())
}

/// Opens a lesson in the window.
#[cfg(feature = "window")]
fn open_lesson(name: &str) -> Result<ExitCode, Fault> {
    // Faults of the file are reported on the terminal.
    lesson::found(name)?;
    window::open(window::Source::Lesson(name.to_owned()), Overrides::default(), None)
}

#[cfg(not(feature = "window"))]
fn open(_: &OpenArguments) -> Result<ExitCode, Fault> {
    Err(without_window())
}

#[cfg(not(feature = "window"))]
fn open_lesson(_: &str) -> Result<ExitCode, Fault> {
    Err(without_window())
}

#[cfg(not(feature = "window"))]
fn without_window() -> Fault {
    Fault::new("This quadfront was built without its window")
        .remedy("Build it with the feature \"window\", or use quadfront convert and quadfront render")
}

/// Reports a fault as one line on standard error.
fn complain(fault: &Fault) {
    let line: String = fault.to_string().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    // A closed standard error leaves nowhere to report to.
    let _ = writeln!(io::stderr(), "error: {line}");
}
