//! Files: dialogs, autosaved runs, files that are written, and the file that is open when it changes.

use std::time::Duration;

use crate::app::window::command::Command;
use crate::app::window::files::{Answer, Watcher, answers};
use crate::app::window::session::Source;
use crate::app::window::state::{Overlay, State};

impl State {
    /// Opens the file that the user has chosen in the dialog.
    pub(in crate::app::window) fn hear_dialog(&mut self) {
        self.hear_folder();
        let Some(dialog) = &self.run.dialog else { return };
        let answer = dialog.answer();
        if !matches!(answer, Answer::Waiting) {
            self.run.dialog = None;
        }
        match answer {
            Answer::File(path) => self.apply(Command::Open(Source::of_file(path))),
            Answer::Missing => {
                self.view.overlay = Overlay::Path;
                self.notice("The system has no file dialog: type the path.".to_owned());
            }
            Answer::Nothing | Answer::Waiting => {}
        }
    }

    /// Takes in the folder of figures that the user has chosen in the dialog.
    fn hear_folder(&mut self) {
        let Some(dialog) = &self.run.folder_dialog else { return };
        let answer = dialog.answer();
        if matches!(answer, Answer::Waiting) {
            return;
        }
        self.run.folder_dialog = None;
        match answer {
            Answer::File(path) => self.workspace.figure.folder = path.display().to_string(),
            Answer::Missing => self.notice("The system has no dialog for folders: type the folder.".to_owned()),
            Answer::Nothing | Answer::Waiting => {}
        }
    }

    /// Autosaves the run, and takes in what became of files. Returns when to look again.
    pub(in crate::app::window) fn hear_files(&mut self) -> Option<Duration> {
        let second = self.pair.as_mut().and_then(|pair| pair.other.hear_files());
        self.lift_messages();
        [second, self.hear_files_alone()].into_iter().flatten().min()
    }

    fn hear_files_alone(&mut self) -> Option<Duration> {
        let mut again = None;
        if let Some(mut autosave) = self.run.autosave.take() {
            let (opened, source) = (self.run.opened.clone(), self.run.source.clone());
            let (faults, wait) =
                autosave.look(opened.as_ref(), source.as_ref(), || Some((self.current_run()?, self.marks())));
            faults.iter().for_each(|fault| self.complain(fault));
            self.run.autosave = Some(autosave);
            again = wait;
        }
        let mut written = answers(&mut self.run.figures);
        written.extend(answers(&mut self.run.meshes));
        let changed = self.run.watcher.as_ref().and_then(Watcher::news);
        let changed = changed.map(|news| news.map(|name| format!("{name} has changed: Ctrl+R opens it again.")));
        for news in written.into_iter().chain(changed) {
            match news {
                Ok(notice) => self.notice(notice),
                Err(fault) => self.complain(&fault),
            }
        }
        again
    }
}
