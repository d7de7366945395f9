//! The file dialog of a browser, which hands over the bytes of the files.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use wasm_bindgen_futures::spawn_local;

use super::{Answer, extensions, main_of};
use crate::app::window::session::Wake;
use crate::app::window::web;

/// The file dialog.
pub struct Dialog {
    answer: Receiver<Option<PathBuf>>,
}

impl Dialog {
    /// Opens the dialog; `wake` is called when it has answered.
    pub fn open(wake: Wake) -> Dialog {
        let (tell, answer) = channel();
        spawn_local(async move {
            let dialog = rfd::AsyncFileDialog::new()
                .set_title("Open a case, a mesh or a figure")
                .add_filter("Cases, meshes, figures", &extensions());
            let mut given = Vec::new();
            for file in dialog.pick_files().await.unwrap_or_default() {
                given.push(web::take_in(&file.file_name(), file.read().await));
            }
            // Nobody listens once the window has opened something else.
            let _ = tell.send(main_of(&given).cloned());
            wake();
        });
        Dialog { answer }
    }

    /// Folders are for disks: no file of a browser is in one.
    pub fn choose_folder(_: Wake) -> Dialog {
        Dialog { answer: channel().1 }
    }

    /// Its answer, if there is one.
    pub fn answer(&self) -> Answer {
        match self.answer.try_recv() {
            Ok(Some(path)) => Answer::File(path),
            Ok(None) => Answer::Nothing,
            Err(TryRecvError::Disconnected) => Answer::Missing,
            Err(TryRecvError::Empty) => Answer::Waiting,
        }
    }
}
