//! The command line (and, with the next issues, the window): ties `core` and `render` together.

mod command_line;
mod input;
mod output;
mod progress;
mod work;
mod figure;
mod convert;
mod check;
mod cases;
mod render;
#[cfg(feature = "window")]
pub mod window;

use std::io::{self, Write};
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;

use crate::core::fault::Fault;
use crate::core::formats::save;
use command_line::{Cli, Command, OpenArguments};
use progress::INTERRUPT;

/// A checked mesh falls short.
const FALLS_SHORT: u8 = 1;
/// Bad input or usage.
const BAD_INPUT: u8 = 2;
/// Ctrl-C, as shells tell it.
const INTERRUPTED: u8 = 130;
/// So long work has to end by itself.
const GRACE: Duration = Duration::from_millis(500);

/// Runs the program with the process's own arguments.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are "errors" of clap's that go to standard output; whether they arrive is not ours to mend.
            let _ = error.print();
            return if error.use_stderr() { ExitCode::from(BAD_INPUT) } else { ExitCode::SUCCESS };
        }
    };
    // Files are renamed into place when they are whole; what is half-written is removed before the process ends. Without a
    // handler (no system refuses one) Ctrl-C would end the process all the same and leave a temporary file.
    let _ = ctrlc::set_handler(|| {
        save::abandon();
        INTERRUPT.ask();
        // Work that hears of it ends by itself, and takes with it what it has put down elsewhere.
        std::thread::sleep(GRACE);
        std::process::exit(i32::from(INTERRUPTED));
    });
    let done = match cli
        .command
        .as_ref()
        .unwrap_or(&Command::Open(OpenArguments { input: "example1".to_owned(), mesh: Default::default() }))
    {
        Command::Open(arguments) => open(arguments),
        Command::Convert(arguments) => convert::convert(arguments),
        Command::Background(arguments) => convert::background(arguments).map(|()| ExitCode::SUCCESS),
        Command::Check(arguments) => check::check(arguments),
        Command::Render(arguments) => render::render(arguments).map(|()| ExitCode::SUCCESS),
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
    let OpenArguments { input, mesh } = arguments;
    let mut source = window::Source::named(input);
    // What does not exist, and options that do not fit, are said where the command was given.
    input::run_of(std::path::Path::new(input), mesh)?;
    if let window::Source::File(path) = &source {
        save::find(path)?;
        if *mesh != Default::default() {
            source = window::Source::Mesh(path.clone(), mesh.clone());
        }
    }
    window::open(source)
}

#[cfg(not(feature = "window"))]
fn open(_: &OpenArguments) -> Result<ExitCode, Fault> {
    Err(Fault::new("This quadfront was built without its window")
        .remedy("Build it with the feature \"window\", or use quadfront convert and quadfront render"))
}

/// Tells a fault as one line on standard error.
fn complain(fault: &Fault) {
    let line: String = fault.to_string().chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    // Where standard error is closed there is nobody to tell.
    let _ = writeln!(io::stderr(), "error: {line}");
}
