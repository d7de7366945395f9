//! Files of runs that are kept, their locks, and those that were left behind.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::core::fault::Fault;
use crate::core::record::run_file;

/// Where runs are kept: in `XDG_STATE_HOME` or what the system has in its place. `None` where it has nothing.
pub fn folder() -> Option<PathBuf> {
    let of = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = |rest: &str| of("HOME").map(|home| home.join(rest));
    let own = if cfg!(windows) {
        of("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        home("Library/Application Support")
    } else {
        of("XDG_STATE_HOME").or_else(|| home(".local/state"))
    };
    own.map(|own| own.join("quadfront").join("runs"))
}

/// A file for a run, with the lock that says whose it is.
#[derive(Debug)]
pub(super) struct Place {
    pub path: PathBuf,
    lock: PathBuf,
    /// Held while this is there.
    _held: File,
}

impl Place {
    /// A new one.
    pub fn new(folder: &Path) -> Result<Place, Fault> {
        let refuse = |what: std::io::Error| {
            Fault::new(format!("The run cannot be kept while you work on it: {what}"))
                .at(folder.display().to_string())
                .remedy("Make the folder writable, or save the run with Ctrl+S")
        };
        std::fs::create_dir_all(folder).map_err(refuse)?;
        for number in 0.. {
            let path = folder.join(format!("{}-{number}.toml", std::process::id()));
            let lock = path.with_extension("lock");
            // A number of a process long gone may come again.
            if path.exists() {
                continue;
            }
            match OpenOptions::new().write(true).create_new(true).open(&lock) {
                Ok(held) => {
                    held.lock().map_err(refuse)?;
                    return Ok(Place { path, lock, _held: held });
                }
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists && number < 10_000 => {}
                Err(error) => return Err(refuse(error)),
            }
        }
        unreachable!("the numbers do not end")
    }

    /// The one of a run that nobody works on.
    fn claim(path: PathBuf) -> Option<Place> {
        let lock = path.with_extension("lock");
        let held = OpenOptions::new().write(true).create(true).truncate(false).open(&lock).ok()?;
        held.try_lock().ok()?;
        // Another window may have taken it away meanwhile.
        path.exists().then_some(Place { path, lock, _held: held })
    }

    /// Takes it away.
    pub fn remove(self) {
        // What cannot be removed is offered once more: nothing is lost by that.
        let _ = std::fs::remove_file(&self.path);
        let _ = std::fs::remove_file(&self.lock);
    }
}

/// A run that was left behind.
#[derive(Debug)]
pub struct Offer {
    pub(super) place: Place,
    /// What is said of it.
    pub text: String,
    /// Whether it can be opened.
    pub opens: bool,
}

impl Offer {
    fn of(place: Place) -> Offer {
        let since = std::fs::metadata(&place.path).and_then(|meta| meta.modified()).ok();
        let ago = since.map_or_else(String::new, |since| format!(" from {}", ago(since)));
        let (text, opens) = match run_file::read(&place.path) {
            Ok(run) => {
                let edits = match (run.edits().len(), run.bookmarks.len()) {
                    (0, 0) => String::new(),
                    (0, 1) => " with 1 bookmark".to_owned(),
                    (0, marks) => format!(" with {marks} bookmarks"),
                    (1, _) => " with 1 edit".to_owned(),
                    (edits, _) => format!(" with {edits} edits"),
                };
                (format!("A run of {}{edits}{ago} was not closed.", run.case.name), true)
            }
            Err(fault) => (format!("A run{ago} was not closed, and cannot be opened: {fault}"), false),
        };
        Offer { place, text, opens }
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

/// Runs of a folder that were left behind, the last one first.
pub(super) fn left_behind(folder: &Path) -> Vec<Offer> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let is_run = |path: &PathBuf| path.extension().is_some_and(|e| e == "toml");
    let paths = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).filter(is_run);
    let mut places: Vec<Place> = paths.filter_map(Place::claim).collect();
    let written = |place: &Place| std::fs::metadata(&place.path).and_then(|meta| meta.modified()).ok();
    places.sort_by_key(|place| std::cmp::Reverse((written(place), place.path.clone())));
    places.into_iter().map(Offer::of).collect()
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
