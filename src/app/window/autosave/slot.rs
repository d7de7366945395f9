//! The files of autosaved runs, their locks, and abandoned runs.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::Marks;
use crate::app::window::settings::state_folder;
use crate::core::fault::Fault;
use crate::core::kernel::number::counted;
use crate::core::record::run_file;

/// The folder of autosaved runs; none if the user has no home.
pub fn folder() -> Option<PathBuf> {
    state_folder().map(|own| own.join("runs"))
}

/// The file of an autosaved run, with the lock of the window that it belongs to.
#[derive(Debug)]
pub(super) struct RunSlot {
    pub path: PathBuf,
    lock: PathBuf,
    /// Held for the lifetime of this value.
    _held: File,
}

impl RunSlot {
    /// A new file.
    pub fn new(folder: &Path) -> Result<RunSlot, Fault> {
        let refuse = |what: std::io::Error| {
            Fault::new(format!("The run cannot be autosaved: {what}"))
                .at(folder.display().to_string())
                .remedy("Make the folder writable, or save the run with Ctrl+S")
        };
        std::fs::create_dir_all(folder).map_err(refuse)?;
        for number in 0.. {
            let path = folder.join(format!("{}-{number}.toml", std::process::id()));
            let lock = path.with_extension("lock");
            // The system may reuse the number of a process that has ended.
            if path.exists() {
                continue;
            }
            match OpenOptions::new().write(true).create_new(true).open(&lock) {
                Ok(held) => {
                    held.lock().map_err(refuse)?;
                    return Ok(RunSlot { path, lock, _held: held });
                }
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists && number < 10_000 => {}
                Err(error) => return Err(refuse(error)),
            }
        }
        unreachable!("the numbers do not end")
    }

    /// Claims an abandoned file.
    fn claim(path: PathBuf) -> Option<RunSlot> {
        let lock = path.with_extension("lock");
        let held = OpenOptions::new().write(true).create(true).truncate(false).open(&lock).ok()?;
        held.try_lock().ok()?;
        // Another window may have removed it in the meantime.
        path.exists().then_some(RunSlot { path, lock, _held: held })
    }

    /// The file of what was set in the window beside the run.
    pub fn marks(&self) -> PathBuf {
        self.path.with_extension("json")
    }

    /// Removes it.
    pub fn remove(self) {
        // A file that cannot be removed is offered once more: nothing is lost.
        let _ = std::fs::remove_file(&self.path);
        let _ = std::fs::remove_file(self.marks());
        let _ = std::fs::remove_file(&self.lock);
    }
}

/// An abandoned run.
#[derive(Debug)]
pub struct Offer {
    pub(super) slot: RunSlot,
    /// What the offer says.
    pub text: String,
    /// Whether it can be opened.
    pub opens: bool,
    pub(super) marks: Marks,
}

impl Offer {
    fn of(slot: RunSlot) -> Offer {
        let since = std::fs::metadata(&slot.path).and_then(|meta| meta.modified()).ok();
        let marks = Marks::read(&slot.marks());
        let ago = since.map_or_else(String::new, |since| format!(" from {}", ago(since)));
        let (text, opens) = match run_file::read(&slot.path) {
            Ok(run) => {
                let of = [
                    (run.edits().len(), "edit"),
                    (run.bookmarks.len(), "bookmark"),
                    (marks.breakpoints.len(), "breakpoint"),
                    (marks.watches.len(), "watchpoint"),
                ];
                let first = of.into_iter().find(|(count, _)| *count > 0);
                let edits = first.map_or(String::new(), |(n, one)| format!(" with {}", counted(n as u64, one)));
                (format!("An unsaved run of {}{edits}{ago} can be recovered.", run.case.name), true)
            }
            Err(fault) => (format!("An unsaved run{ago} cannot be recovered: {fault}"), false),
        };
        Offer { slot, text, opens, marks }
    }
}

/// How long ago something was.
fn ago(since: SystemTime) -> String {
    let seconds = SystemTime::now().duration_since(since).map_or(0, |passed| passed.as_secs());
    match seconds {
        0..=89 => "a moment ago".to_owned(),
        90..=5399 => format!("{} minutes ago", (seconds + 30) / 60),
        5400..=129_599 => format!("{} hours ago", (seconds + 1800) / 3600),
        _ => format!("{} days ago", (seconds + 43_200) / 86_400),
    }
}

/// The abandoned runs of a folder, the latest first.
pub(super) fn left_behind(folder: &Path) -> Vec<Offer> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let is_run = |path: &PathBuf| path.extension().is_some_and(|e| e == "toml");
    let paths = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).filter(is_run);
    let mut slots: Vec<RunSlot> = paths.filter_map(RunSlot::claim).collect();
    let written = |slot: &RunSlot| std::fs::metadata(&slot.path).and_then(|meta| meta.modified()).ok();
    slots.sort_by_key(|slot| std::cmp::Reverse((written(slot), slot.path.clone())));
    slots.into_iter().map(Offer::of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn times_are_told_in_words() {
        let told = |seconds| ago(SystemTime::now() - Duration::from_secs(seconds));
        assert_eq!([5, 600, 7200, 200_000].map(told), ["a moment ago", "10 minutes ago", "2 hours ago", "2 days ago"]);
    }
}
