//! Files on the disk: written to a temporary file and renamed.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::explain;
use crate::core::fault::Fault;
use crate::core::progress::Pace;

/// Bytes read between two reports of progress.
const BATCH: u64 = 1 << 22;

/// Temporary files in use, and whether [`abandon`] was called.
struct Unfinished {
    files: Vec<PathBuf>,
    abandoned: bool,
}

static UNFINISHED: Mutex<Unfinished> = Mutex::new(Unfinished { files: Vec::new(), abandoned: false });

fn unfinished() -> MutexGuard<'static, Unfinished> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of every [`save`] in progress, and makes every later start or end of one fail: for the
/// handler of Ctrl-C, just before the process exits.
pub fn abandon() {
    let mut unfinished = unfinished();
    unfinished.abandoned = true;
    for file in unfinished.files.drain(..) {
        // The process is about to exit: there is nobody to report an error to.
        let _ = fs::remove_file(file);
    }
}

/// Writes the file `path` with `write`: into a temporary file in the same folder, which replaces `path` only when it is
/// complete and flushed to disk. An existing file keeps its permissions; through a symbolic link, the target is
/// replaced. Anything but a regular file (a pipe, `/dev/stdout`) is written directly.
///
/// # Errors
/// A fault with the path: it is a folder, its folder is missing, no permission, no space, or an error of `write`. An
/// existing file is unchanged, and no temporary file remains.
pub fn save(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Fault> {
    let explain = |error: io::Error| explain(path, "written", &error);
    // Replace the target of a link, not the link.
    let (target, old) = match fs::metadata(path) {
        Ok(meta) if meta.is_dir() => return Err(explain(ErrorKind::IsADirectory.into())),
        Ok(meta) if !meta.is_file() => {
            let out = OpenOptions::new().write(true).open(path).map_err(explain)?;
            return buffered(out, write).map(drop).map_err(explain);
        }
        Ok(meta) => {
            // Renaming over a write-protected file would succeed.
            OpenOptions::new().write(true).open(path).map_err(explain)?;
            (fs::canonicalize(path).map_err(explain)?, Some(meta.permissions()))
        }
        Err(error) if error.kind() == ErrorKind::NotFound => (path.to_path_buf(), None),
        Err(error) => return Err(explain(error)),
    };
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let temporary = begin(folder).map_err(explain)?;
    let beside = temporary.path().to_path_buf();
    let done = (|| {
        let file = buffered(temporary.as_file(), write)?;
        if let Some(permissions) = old {
            file.set_permissions(permissions)?;
        }
        file.sync_all()?;
        let unfinished = unfinished();
        if unfinished.abandoned {
            return Err(io::Error::other("writing was cancelled"));
        }
        temporary.persist(&target).map_err(|refused| refused.error)?;
        drop(unfinished);
        Ok(())
    })();
    unfinished().files.retain(|file| *file != beside);
    done.map_err(explain)
}

/// A new temporary file, registered for [`abandon`].
fn begin(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut unfinished = unfinished();
    if unfinished.abandoned {
        return Err(io::Error::other("writing was cancelled"));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".quadfront-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As for any new file; the umask applies.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let temporary = builder.tempfile_in(folder)?;
    unfinished.files.push(temporary.path().to_path_buf());
    Ok(temporary)
}

fn buffered<W: Write>(out: W, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<W> {
    let mut out = BufWriter::with_capacity(1 << 18, out);
    write(&mut out)?;
    out.into_inner().map_err(|unwritten| unwritten.into_error())
}

/// Checks that a file exists and can be read.
///
/// # Errors
/// As [`super::load`].
pub fn find(path: &Path) -> Result<(), Fault> {
    match File::open(path).and_then(|file| file.metadata()) {
        Ok(meta) if meta.is_dir() => Err(explain(path, "read", &ErrorKind::IsADirectory.into())),
        Ok(_) => Ok(()),
        Err(error) => Err(explain(path, "read", &error)),
    }
}

/// Whether there is a file of this path.
pub fn is_file(path: &Path) -> bool {
    path.is_file()
}

/// Whether there is anything of this path, or something that cannot be looked at.
pub fn exists(path: &Path) -> bool {
    !matches!(path.try_exists(), Ok(false))
}

/// Makes a folder with those above it, unless it is there.
///
/// # Errors
/// What the system says.
pub fn make_folder(path: &Path) -> io::Result<()> {
    fs::create_dir_all(path)
}

/// Removes a file, if there is one.
pub fn remove(path: &Path) {
    // What cannot be removed is found again later.
    let _ = fs::remove_file(path);
}

/// As [`super::load`], with progress and cancellation.
///
/// # Errors
/// As [`super::load`], and [`Fault::stopped`].
pub fn load_watched(path: &Path, pace: &dyn Pace) -> Result<Vec<u8>, Fault> {
    let bytes = File::open(path)
        .and_then(|mut file| {
            let meta = file.metadata()?;
            if meta.is_dir() {
                return Err(ErrorKind::IsADirectory.into());
            }
            let mut bytes = Vec::new();
            // Only a hint: for special files, the system reports any size.
            bytes.try_reserve_exact(meta.len() as usize)?;
            while pace.goes_on(0, meta.len() as usize) && (&mut file).take(BATCH).read_to_end(&mut bytes)? > 0 {}
            Ok(bytes)
        })
        .map_err(|error| explain(path, "read", &error))?;
    pace.cancel().check()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::formats::save::load;

    #[test]
    fn a_file_that_fails_halfway_leaves_the_old_one_and_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.msh");
        save(&path, |out| out.write_all(b"old")).unwrap();
        let fault = save(&path, |out| {
            out.write_all(&[b'x'; 1 << 20])?;
            Err(ErrorKind::StorageFull.into())
        })
        .unwrap_err();
        assert!(fault.what.contains("disk is full"), "{fault}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_a_missing_folder_and_a_missing_file_have_different_faults() {
        let folder = tempfile::tempdir().unwrap();
        let message = |path: &Path| save(path, |_| Ok(())).unwrap_err().to_string();
        assert!(message(folder.path()).contains("This is a folder"));
        assert!(message(&folder.path().join("no/a.msh")).contains("does not exist. Create it first"));
        let file = folder.path().join("file");
        save(&file, |_| Ok(())).unwrap();
        assert!(message(&file.join("a.msh")).contains("is not a folder"));
        assert!(load(&folder.path().join("b")).unwrap_err().to_string().contains("No such file"));
        assert!(load(folder.path()).unwrap_err().to_string().contains("This is a folder"));
    }

    #[cfg(unix)]
    #[test]
    fn permissions_and_links_are_kept_and_devices_are_written_directly() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a"), folder.path().join("link"));
        save(&path, |out| out.write_all(b"1")).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        save(&link, |out| out.write_all(b"2")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"2");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        save(Path::new("/dev/null"), |out| out.write_all(b"3")).unwrap();
        #[cfg(target_os = "linux")]
        assert!(save(Path::new("/dev/full"), |out| out.write_all(b"3")).unwrap_err().what.contains("disk is full"));
    }
}
