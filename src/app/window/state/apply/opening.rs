//! Opens cases and meshes, and gives them up.

use std::path::PathBuf;

use web_time::Instant;

use super::State;
use crate::app::command_line::Overrides;
use crate::app::window::import::{Import, ImportOptions};
use crate::app::window::session::{Session, Source};
use crate::app::window::state::Opening;
use crate::app::{input, lesson};
use crate::core::case::built_in;
use crate::core::fault::Fault;
use crate::core::formats::Format;
use crate::core::record::run_file;
use crate::core::run::Run;
use crate::core::step::is_step;

impl State {
    /// Opens a case or a mesh with its parameters changed; what is open stays until the other one is ready. A mesh is
    /// shown before it is converted.
    pub(super) fn open(&mut self, source: Source, overrides: Overrides) {
        if let Source::File(path) = &source
            && (Format::from_path(path).is_ok() || is_step(path))
        {
            self.wanted = None;
            return self.import(path.clone(), ImportOptions::default(), overrides);
        }
        let (named, changed) = (source.clone(), overrides.clone());
        self.open_read(source, overrides, move || read(&named, &changed));
    }

    /// Opens the run that `read` gives, of a source with its parameters changed.
    pub(super) fn open_read(
        &mut self,
        source: Source,
        overrides: Overrides,
        read: impl FnOnce() -> Result<Run, Fault> + Send + 'static,
    ) {
        let is_of_import =
            matches!((&source, &self.run.import), (Source::Mesh(path, _), Some(import)) if *path == import.path);
        if !is_of_import {
            self.give_up_import();
            // What was to begin with another run does not begin with this one.
            self.wanted = None;
        }
        let session = Session::open(read, self.wake.clone());
        if self.run.opening.replace(Opening { source, overrides, session }).is_none() {
            self.run.waiting += 1;
        }
        self.run.since.get_or_insert_with(Instant::now);
    }

    /// Shows a mesh and how it is to be imported.
    pub(in crate::app::window::state) fn import(
        &mut self,
        path: PathBuf,
        options: ImportOptions,
        overrides: Overrides,
    ) {
        self.give_up_import();
        self.stop_opening();
        self.run.playing = None;
        let mut import = Import::begin(path, options, self.run.pictures, self.wake.clone());
        import.overrides = overrides;
        self.run.import = Some(import);
    }

    /// Gives up what is being opened.
    pub(super) fn stop_opening(&mut self) {
        if let Some(opening) = &self.run.opening {
            opening.session.stop();
        }
    }

    /// Gives up the mesh that is about to be converted.
    pub(in crate::app::window::state) fn give_up_import(&mut self) {
        if let Some(import) = self.run.import.take() {
            self.run.pictures = import.generation;
        }
    }

    /// Stops the conversion and goes back to the import, or else gives up the mesh.
    pub(super) fn cancel_import(&mut self) {
        if self.run.is_opening() {
            self.stop_opening();
        } else {
            self.give_up_import();
        }
    }
}

/// Reads what is to be opened.
pub(super) fn read(source: &Source, overrides: &Overrides) -> Result<Run, Fault> {
    match source {
        Source::BuiltIn(name) => {
            let case = built_in::named(name);
            let missing = || Fault::new("There is no built-in case of this name").at(name.clone());
            let mut run = Run::of(case.ok_or_else(missing)??);
            overrides.apply(&mut run, "--set")?;
            Ok(run)
        }
        Source::File(path) => input::run_of(path, &ImportOptions::default(), overrides),
        Source::Mesh(path, options) => input::run_of(path, options, overrides),
        Source::Lesson(name) => Ok(lesson::found(name)?.run()),
        Source::Linked(text) => {
            let mut run = run_file::parse_alone(text, &source.name())?;
            overrides.apply(&mut run, "--set")?;
            Ok(run)
        }
    }
}
