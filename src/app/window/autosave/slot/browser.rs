//! Autosaved runs in the storage of a browser, which all its pages of one address share. The name of a file says which
//! page it belongs to; a page that is closed has abandoned its runs.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use web_time::SystemTime;

use crate::app::window::settings::state_folder;
use crate::app::window::web::{page, storage};
use crate::core::fault::Fault;
use crate::core::formats::save::{self, memory};

/// The files that this page holds.
static HELD: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// The folder of autosaved runs; none if the browser keeps nothing for this page.
pub fn folder() -> Option<PathBuf> {
    state_folder().map(|own| own.join("runs"))
}

/// The file of an autosaved run, held by this page.
#[derive(Debug)]
pub struct RunSlot {
    pub path: PathBuf,
}

impl RunSlot {
    /// A new file.
    pub fn new(folder: &Path) -> Result<RunSlot, Fault> {
        let mut held = HELD.lock().unwrap_or_else(PoisonError::into_inner);
        let name = |number: u32| folder.join(format!("{}-{number}.toml", page::own()));
        let free = (0..).map(name).find(|path| !held.contains(path) && !save::is_file(path));
        let path = free.unwrap_or_else(|| name(u32::MAX));
        held.insert(path.clone());
        Ok(RunSlot { path })
    }

    /// Claims an abandoned file: it takes a name of this page.
    fn claim(path: &Path) -> Option<RunSlot> {
        let of = path.file_stem()?.to_str()?.rsplit_once('-')?.0;
        let is_held = HELD.lock().unwrap_or_else(PoisonError::into_inner).contains(path);
        if is_held || of != page::own() && page::is_alive(of) || !storage::has(path) {
            return None;
        }
        let claimed = RunSlot::new(path.parent()?).ok()?;
        storage::rename(path, &claimed.path);
        storage::rename(&path.with_extension("json"), &claimed.marks());
        Some(claimed)
    }

    /// When it was written last.
    pub fn written(&self) -> Option<SystemTime> {
        storage::written(&self.path)
    }

    /// Another run may take the name.
    pub fn let_go(self) {}
}

impl Drop for RunSlot {
    fn drop(&mut self) {
        HELD.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.path);
    }
}

/// The abandoned runs of a folder.
pub fn abandoned(folder: &Path) -> Vec<RunSlot> {
    storage::load();
    let is_run = |path: &PathBuf| path.extension().is_some_and(|e| e == "toml");
    memory::list(folder).iter().filter(|path| is_run(path)).filter_map(|path| RunSlot::claim(path)).collect()
}
