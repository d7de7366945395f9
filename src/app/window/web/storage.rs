//! What the browser keeps from one visit to the next: settings, autosaved runs, and meshes that runs begin with. All
//! pages of one address share it, and it has room for a few megabytes.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use web_time::SystemTime;

use super::page;
use crate::app::window::settings::state_folder;
use crate::core::formats::save::memory::{self, Kept};

/// Files of the user that are larger are not kept: the runs would have no room.
const LARGEST: usize = 1 << 20;

/// When each file was written last, in milliseconds since 1970.
static WRITTEN: Mutex<BTreeMap<PathBuf, u64>> = Mutex::new(BTreeMap::new());

/// All entries: files, and their times and bytes as text.
fn entries() -> Vec<(PathBuf, String)> {
    let mut stored = page::stored().unwrap_or_default().into_iter();
    std::iter::from_fn(|| Some((PathBuf::from(stored.next()?), stored.next()?))).collect()
}

/// The time and the bytes of an entry.
fn read(text: &str) -> Option<(u64, Vec<u8>)> {
    let (time, bytes) = text.split_once(' ')?;
    Some((time.parse().ok()?, STANDARD.decode(bytes).ok()?))
}

fn name_of(path: &Path) -> String {
    path.display().to_string()
}

/// Takes in what is kept, as files in memory.
pub fn load() {
    for (path, text) in entries() {
        if let Some((time, bytes)) = read(&text) {
            WRITTEN.lock().unwrap_or_else(PoisonError::into_inner).insert(path.clone(), time);
            memory::give(&path, bytes);
        }
    }
}

/// Whether an entry is still there: another page may have taken it.
pub fn has(path: &Path) -> bool {
    entries().iter().any(|entry| entry.0 == path)
}

/// Keeps files of the state folder, and hands all others over to the user.
pub fn keep(path: &Path, bytes: Option<&[u8]>) -> io::Result<Kept> {
    let is_state = state_folder().is_some_and(|folder| path.starts_with(folder));
    match bytes {
        _ if is_state => store(path, bytes).map(|()| Kept::Here),
        Some(bytes) => {
            page::download(&path.file_name().unwrap_or_default().to_string_lossy(), bytes);
            Ok(Kept::HandedOver)
        }
        None => Ok(Kept::Here),
    }
}

/// Keeps a file of the user, so that a run that begins with it can be recovered; where there is no room, not.
pub fn keep_given(path: &Path, bytes: &[u8]) {
    if bytes.len() <= LARGEST {
        // The file is here all the same, until the page is closed.
        let _ = store(path, Some(bytes));
    }
}

/// Gives a file another name.
pub fn rename(from: &Path, to: &Path) {
    let Some((time, bytes)) = entries().into_iter().find_map(|entry| read(&entry.1).filter(|_| entry.0 == from)) else {
        return;
    };
    if store(to, Some(&bytes)).is_ok() {
        WRITTEN.lock().unwrap_or_else(PoisonError::into_inner).insert(to.to_path_buf(), time);
        memory::give(to, bytes);
        memory::remove(from);
    }
}

/// When a file was written last.
pub fn written(path: &Path) -> Option<SystemTime> {
    let time = *WRITTEN.lock().unwrap_or_else(PoisonError::into_inner).get(path)?;
    Some(SystemTime::UNIX_EPOCH + Duration::from_millis(time))
}

fn store(path: &Path, bytes: Option<&[u8]>) -> io::Result<()> {
    let time = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_millis() as u64);
    let mut written = WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
    match bytes {
        Some(_) => written.insert(path.to_path_buf(), time),
        None => written.remove(path),
    };
    let text = bytes.map(|bytes| format!("{time} {}", STANDARD.encode(bytes)));
    page::store(&name_of(path), text).map_or(Ok(()), |what| Err(io::Error::other(what)))
}
