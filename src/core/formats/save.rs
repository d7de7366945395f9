//! Files, as all of quadfront reads and writes them: replaced atomically, so that a reader sees the old file or the
//! complete new one. In a browser, which has no disk for programs, they are in memory.

#[cfg(not(target_arch = "wasm32"))]
mod disk;
#[cfg(any(test, target_arch = "wasm32"))]
pub mod memory;

use std::io::{self, ErrorKind};
use std::path::Path;

#[cfg(not(target_arch = "wasm32"))]
pub use disk::{abandon, exists, find, is_file, load_watched, make_folder, remove, save};
#[cfg(target_arch = "wasm32")]
pub use memory::{find, is_file, is_file as exists, load_watched, make_folder, remove, save};

use crate::core::fault::{Fault, FaultKind};
use crate::core::progress::{Nobody, Reading};

/// Whether files are on a disk, where they have folders and other programs may change them.
pub const ON_DISK: bool = cfg!(not(target_arch = "wasm32"));

/// Reads a whole file.
///
/// # Errors
/// A fault with the path: it is missing, a folder, or not permitted.
pub fn load(path: &Path) -> Result<Vec<u8>, Fault> {
    load_watched(path, &Reading::watched(&mut Nobody))
}

/// Reads a whole text.
///
/// # Errors
/// As [`load`], and bytes that are no UTF-8.
pub fn load_text(path: &Path) -> Result<String, Fault> {
    let wrong = |_| explain(path, "read", &ErrorKind::InvalidData.into());
    String::from_utf8(load(path)?).map_err(wrong)
}

/// A fault for a system error; `done` is "read" or "written".
fn explain(path: &Path, done: &str, error: &io::Error) -> Fault {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (what, remedy) = match error.kind() {
        ErrorKind::NotFound if done == "written" => {
            (format!("The folder \"{}\" does not exist", folder.display()), "Create it first, or choose another path")
        }
        ErrorKind::NotFound => ("No such file".to_owned(), "Check its name and folder"),
        ErrorKind::IsADirectory => ("This is a folder".to_owned(), "Give the path of a file in it"),
        ErrorKind::NotADirectory => {
            (format!("\"{}\" is not a folder", folder.display()), "Give the path of a file in a folder")
        }
        ErrorKind::PermissionDenied => {
            (format!("Permission denied: it cannot be {done}"), "Change its permissions, or choose another path")
        }
        ErrorKind::ReadOnlyFilesystem => ("The disk is read-only".to_owned(), "Choose another path"),
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            ("The disk is full".to_owned(), "Free some space, or choose another path")
        }
        ErrorKind::InvalidFilename => ("Invalid file name".to_owned(), "Use a shorter name without special characters"),
        _ => (format!("It cannot be {done}: {error}"), ""),
    };
    Fault::new(what).of_kind(FaultKind::Io).at(path.display().to_string()).remedy(remedy)
}
