//! Autosaved runs on a disk, each with the lock of its window.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::app::window::settings::state_folder;
use crate::core::fault::Fault;
use crate::core::formats::save;

/// The folder of autosaved runs; none if the user has no home.
pub fn folder() -> Option<PathBuf> {
    state_folder().map(|own| own.join("runs"))
}

/// The file of an autosaved run, with the lock of the window that it belongs to.
#[derive(Debug)]
pub struct RunSlot {
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

    /// When it was written last.
    pub fn written(&self) -> Option<SystemTime> {
        std::fs::metadata(&self.path).and_then(|meta| meta.modified()).ok()
    }

    /// Removes what is beside the files of the run.
    pub fn let_go(self) {
        save::remove(&self.lock);
    }
}

/// The abandoned runs of a folder.
pub fn abandoned(folder: &Path) -> Vec<RunSlot> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let is_run = |path: &PathBuf| path.extension().is_some_and(|e| e == "toml");
    let paths = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).filter(is_run);
    paths.filter_map(RunSlot::claim).collect()
}
