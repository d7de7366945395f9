//! The command line (and, with the next issues, the window): ties `core` and `render` together.

use std::process::ExitCode;

/// Runs the program with the process's own arguments.
pub fn run() -> ExitCode {
    ExitCode::SUCCESS
}
