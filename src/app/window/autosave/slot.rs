//! The files of autosaved runs, and abandoned runs.

#[cfg(not(target_arch = "wasm32"))]
mod disk;
#[cfg(not(target_arch = "wasm32"))]
use disk as place;
#[cfg(target_arch = "wasm32")]
mod browser;
#[cfg(target_arch = "wasm32")]
use browser as place;

use std::path::{Path, PathBuf};

use web_time::SystemTime;

use super::Marks;
use crate::core::formats::save;
use crate::core::kernel::number::counted;
use crate::core::record::run_file;

pub(super) use place::RunSlot;
pub use place::folder;

impl RunSlot {
    /// The file of what was set in the window beside the run.
    pub fn marks(&self) -> PathBuf {
        self.path.with_extension("json")
    }

    /// Removes it.
    pub fn remove(self) {
        // A file that cannot be removed is offered once more: nothing is lost.
        save::remove(&self.path);
        save::remove(&self.marks());
        self.let_go();
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
        let since = slot.written();
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
    let mut slots = place::abandoned(folder);
    slots.sort_by_key(|slot| std::cmp::Reverse((slot.written(), slot.path.clone())));
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
