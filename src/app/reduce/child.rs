//! Tries in processes of their own, which may panic, overflow their stack or abort.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::Duration;

use crate::core::fault::Fault;
use crate::core::progress::Cancel;
use crate::core::reduce::Panic;

/// How a process that converts a file is started.
pub(in crate::app) type Start = dyn Fn(&Path) -> io::Result<Command>;

/// How often a process is looked after.
const PAUSE: Duration = Duration::from_millis(5);
/// The end of what a process wrote, in which its panic is looked for.
const TAIL: u64 = 1 << 16;
/// The exit code of Rust after a panic.
const PANICKED: i32 = 101;
/// Signals by which a program ends itself. The other ones come from outside, such as when the system has no memory
/// left.
#[cfg(unix)]
const OWN_SIGNALS: [(i32, &str); 6] = [
    (4, "SIGILL"),
    (5, "SIGTRAP"),
    (6, "SIGABRT"),
    (if cfg!(target_os = "linux") { 7 } else { 10 }, "SIGBUS"),
    (8, "SIGFPE"),
    (11, "SIGSEGV"),
];

/// This program.
pub(in crate::app) fn convert(path: &Path) -> io::Result<Command> {
    let mut command = Command::new(std::env::current_exe()?);
    command.arg("convert").arg(path).arg("--quiet");
    Ok(command)
}

/// The panic in which a process ends; `None` if it ends otherwise.
///
/// # Errors
/// The process cannot be started; the work was cancelled.
pub(super) fn panic_of(command: io::Result<Command>, cancel: &Cancel) -> Result<Option<Panic>, Fault> {
    let refuse = |error: io::Error| Fault::new(format!("Cannot run another process: {error}"));
    let mut told = tempfile::tempfile().map_err(refuse)?;
    let ended = command.and_then(|command| run(command, &told, cancel)).map_err(refuse)?;
    cancel.check()?;
    let Some(what) = ended.and_then(how_it_panicked) else { return Ok(None) };
    let written = tail(&mut told).map_err(refuse)?;
    Ok(Some(Panic::written(&written).unwrap_or_else(|| Panic::saying(&what))))
}

/// Runs a process to its end; ends it when the work is cancelled.
fn run(mut command: Command, told: &File, cancel: &Cancel) -> io::Result<Option<ExitStatus>> {
    // One thread, so that of several faces the same one panics first each time.
    command.env("RAYON_NUM_THREADS", "1").env("RUST_BACKTRACE", "0");
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(told.try_clone()?);
    let mut child = command.spawn()?;
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if cancel.is_asked() {
            child.kill()?;
            child.wait()?;
            return Ok(None);
        }
        std::thread::sleep(PAUSE);
    }
}

/// The end of what was written.
fn tail(told: &mut File) -> io::Result<String> {
    let length = told.metadata()?.len();
    told.seek(SeekFrom::Start(length.saturating_sub(TAIL)))?;
    let mut bytes = Vec::new();
    told.read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// What is known of a panic, an abort or a stack overflow by its exit status alone; `None` for any other end.
#[cfg(unix)]
fn how_it_panicked(status: ExitStatus) -> Option<String> {
    use std::os::unix::process::ExitStatusExt;
    match status.signal() {
        Some(signal) => OWN_SIGNALS.iter().find(|own| own.0 == signal).map(|own| format!("ended by {}", own.1)),
        None => (status.code() == Some(PANICKED)).then(|| "a panic".to_owned()),
    }
}

/// What is known of a panic, an abort or a stack overflow by its exit status alone; `None` for any other end. Windows
/// has negative codes for what ends a program.
#[cfg(not(unix))]
fn how_it_panicked(status: ExitStatus) -> Option<String> {
    let what = match status.code()? {
        PANICKED => "a panic",
        -1_073_740_791 => "an abort",
        -1_073_741_571 => "stack overflow",
        -1_073_741_819 => "an access violation",
        code if code < 0 => "an exception",
        _ => return None,
    };
    Some(what.to_owned())
}

#[cfg(test)]
mod tests;
