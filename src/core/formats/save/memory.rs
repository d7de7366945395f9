//! Files in memory, for a browser. Who is told of each file that is written may hand it over to the user or keep it
//! elsewhere; all other files are kept here, and are gone with the page.

use std::collections::BTreeMap;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use super::explain;
use crate::core::fault::Fault;
use crate::core::progress::Pace;

/// Where a file is that has been written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// In memory.
    Here,
    /// It was handed over: nothing of it stays.
    HandedOver,
}

/// Is told of each file that is written or removed (without bytes). An error is that of writing.
pub type Keeper = fn(&Path, Option<&[u8]>) -> io::Result<Kept>;

static FILES: Mutex<BTreeMap<PathBuf, Arc<[u8]>>> = Mutex::new(BTreeMap::new());
static KEEPER: OnceLock<Keeper> = OnceLock::new();

fn files() -> MutexGuard<'static, BTreeMap<PathBuf, Arc<[u8]>>> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Tells `keeper` of files from now on. Only the first call counts.
pub fn tell(keeper: Keeper) {
    // A second keeper would be told what the first one has handed over.
    let _ = KEEPER.set(keeper);
}

/// A file that was given, by the user or by what was kept: nobody is told of it.
pub fn give(path: &Path, bytes: Vec<u8>) {
    files().insert(path.to_path_buf(), bytes.into());
}

/// The files of a folder.
pub fn list(folder: &Path) -> Vec<PathBuf> {
    files().keys().filter(|path| path.parent() == Some(folder)).cloned().collect()
}

/// Writes the file `path` with `write`: into memory, then at once.
///
/// # Errors
/// A fault with the path: an error of `write` or of the keeper. An existing file is unchanged.
pub fn save(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Fault> {
    let explain = |error: io::Error| explain(path, "written", &error);
    let mut bytes = Vec::new();
    write(&mut bytes).map_err(explain)?;
    let kept = KEEPER.get().map_or(Ok(Kept::Here), |keeper| keeper(path, Some(&bytes))).map_err(explain)?;
    if kept == Kept::Here {
        files().insert(path.to_path_buf(), bytes.into());
    }
    Ok(())
}

/// Checks that a file exists.
///
/// # Errors
/// As [`super::load`].
pub fn find(path: &Path) -> Result<(), Fault> {
    if is_file(path) { Ok(()) } else { Err(explain(path, "read", &ErrorKind::NotFound.into())) }
}

/// Whether there is a file of this path.
pub fn is_file(path: &Path) -> bool {
    files().contains_key(path)
}

/// Files in memory need no folder.
///
/// # Errors
/// None.
pub fn make_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

/// Removes a file, if there is one.
pub fn remove(path: &Path) {
    if files().remove(path).is_some()
        && let Some(keeper) = KEEPER.get()
    {
        // What cannot be removed is found again later.
        let _ = keeper(path, None);
    }
}

/// As [`super::load`], with progress and cancellation.
///
/// # Errors
/// As [`super::load`], and [`Fault::stopped`].
pub fn load_watched(path: &Path, pace: &dyn Pace) -> Result<Vec<u8>, Fault> {
    let found = files().get(path).cloned();
    let Some(bytes) = found else { return Err(explain(path, "read", &ErrorKind::NotFound.into())) };
    // All of it is there at once.
    pace.goes_on(bytes.len(), bytes.len());
    pace.cancel().check()?;
    Ok(bytes.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::progress::{Nobody, Reading};

    #[test]
    fn a_file_is_read_as_it_was_written_until_it_is_removed() {
        let (folder, path) = (Path::new("in memory"), Path::new("in memory/a.msh"));
        let load = || load_watched(path, &Reading::watched(&mut Nobody));
        assert!(find(path).unwrap_err().to_string().contains("No such file"));
        save(path, |out| out.write_all(b"old")).unwrap();
        let fault = save(path, |out| {
            out.write_all(b"new")?;
            Err(ErrorKind::StorageFull.into())
        });
        assert!(fault.unwrap_err().what.contains("disk is full"));
        assert_eq!((load().unwrap(), list(folder)), (b"old".to_vec(), vec![path.to_path_buf()]));
        give(path, b"given".to_vec());
        assert_eq!(load().unwrap(), b"given");
        find(path).unwrap();
        remove(path);
        assert!(!is_file(path) && list(folder).is_empty());
    }
}
