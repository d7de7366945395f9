//! The system's file dialog.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::{Duration, Instant};

use super::{Answer, extensions, work};
use crate::app::window::session::Wake;

/// A dialog that does not answer for this long is given up.
const PATIENCE: Duration = Duration::from_secs(120);
/// An answer that comes sooner does not come from a person.
const HASTE: Duration = Duration::from_millis(250);

/// The system's file dialog, on a thread of its own: it may hang if the desktop has no portal.
pub struct Dialog {
    answer: Receiver<Option<PathBuf>>,
    since: Instant,
}

impl Dialog {
    /// Opens the dialog; `wake` is called when it has answered.
    pub fn open(wake: Wake) -> Dialog {
        let answer = work(wake, || {
            rfd::FileDialog::new()
                .set_title("Open a case, a mesh or a figure")
                .add_filter("Cases, meshes, figures", &extensions())
                .pick_file()
        });
        Dialog { answer, since: Instant::now() }
    }

    /// The dialog for a folder.
    pub fn choose_folder(wake: Wake) -> Dialog {
        let answer = work(wake, || rfd::FileDialog::new().set_title("The folder of figures").pick_folder());
        Dialog { answer, since: Instant::now() }
    }

    /// Its answer, if there is one.
    pub fn answer(&self) -> Answer {
        match self.answer.try_recv() {
            Ok(Some(path)) => Answer::File(path),
            Ok(None) if self.since.elapsed() < HASTE => Answer::Missing,
            Ok(None) => Answer::Nothing,
            Err(TryRecvError::Disconnected) => Answer::Missing,
            Err(TryRecvError::Empty) if self.since.elapsed() > PATIENCE => Answer::Missing,
            Err(TryRecvError::Empty) => Answer::Waiting,
        }
    }
}
