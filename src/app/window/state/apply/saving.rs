//! Saves the run, figures and meshes.

use std::path::PathBuf;

use super::{Overlay, State};
use crate::app::window::autosave::Autosave;
use crate::app::window::figures::{self, Formats};
use crate::app::window::files;
use crate::app::window::film::FilmWork;
use crate::app::window::{mesh_out, page_out};
use crate::core::record::run_file;
use crate::render::film::FilmFormat;

impl State {
    /// Autosaves the run in a folder, and offers what was left there.
    pub(in crate::app::window) fn autosave_in(&mut self, folder: PathBuf) {
        self.run.autosave = Some(Autosave::new(folder, self.wake.clone()));
    }

    /// Saves the run in the working folder, under a name that is free. Returns its path.
    pub(in crate::app::window) fn save_run(&mut self) -> Option<PathBuf> {
        let run = self.current_run()?;
        let path = files::free_path(&format!("{}-run", run.case.name), "toml");
        match run_file::write(&path, &run) {
            Ok(()) => {
                let marks = self.marks();
                if let Some(autosave) = &mut self.run.autosave {
                    autosave.saved(&run, &marks);
                }
                self.notice(format!("The run was saved as {}.", path.display()));
                Some(path)
            }
            Err(fault) => {
                self.complain(&fault);
                None
            }
        }
    }

    /// Starts to make the figure that the panel describes.
    pub(super) fn save_figure(&mut self, formats: Formats) {
        match figures::begin(self, formats, self.wake.clone()) {
            Ok(writing) => self.run.figures.extend(writing),
            Err(fault) => self.complain(&fault),
        }
    }

    /// Starts to make the film that the panel describes, of the run that the panels show.
    pub(super) fn save_film(&mut self, format: FilmFormat) {
        match FilmWork::begin(self.active(), format, self.wake.clone()) {
            Ok(film) => self.film = film.or(self.film.take()),
            Err(fault) => self.complain(&fault),
        }
    }

    /// Starts to write the page with the notes on bookmarked steps.
    pub(super) fn export_notes(&mut self) {
        match figures::begin_notes(self, self.wake.clone()) {
            Ok(writing) => self.run.figures.extend(writing),
            Err(fault) => self.complain(&fault),
        }
    }

    /// Starts to write what is shown as a page.
    pub(super) fn save_page(&mut self) {
        self.run.figures.extend(page_out::begin(self.active(), self.wake.clone()));
    }

    /// Starts to write the current mesh to a path.
    pub(super) fn save_mesh(&mut self, path: &str) {
        match mesh_out::begin(self, path, self.wake.clone()) {
            Ok(writing) => {
                self.run.meshes.extend(writing);
                self.view.overlay = Overlay::Nothing;
            }
            Err(fault) => self.complain(&fault),
        }
    }
}
