//! Changing a run: edits at steps, parameters from the beginning, bookmarks and camera.

use std::sync::Arc;

use super::History;
use crate::core::case::parameters::Parameters;
use crate::core::fault::Fault;
use crate::core::run::run::{Bookmark, Camera, Edit, EditKind, OF_BACKGROUND, Run};

impl History {
    /// Makes an edit at the step at hand, in place of one that changes the same thing there. What follows from it on is
    /// changed; what comes before stays.
    ///
    /// # Errors
    /// A segment that is not on the front. Nothing is changed then.
    pub fn edit(&mut self, kind: EditKind) -> Result<(), Fault> {
        if let EditKind::Base { a, b } = kind {
            self.now.converter.check_base(a, b)?;
        }
        self.set_edits(self.run.edits_with(Edit { step: self.now.step, kind }))
    }

    /// Replaces all edits of the run. The state at hand stays at its step, as it is with these edits, or at the end where the
    /// run is shorter now.
    ///
    /// # Errors
    /// An edit that is no valid one: nothing is changed then.
    pub fn set_edits(&mut self, edits: Vec<Edit>) -> Result<(), Fault> {
        let mut run = Run::clone(&self.run);
        run.set_edits(edits);
        run.parameters_at(u64::MAX)?;
        let Some(first) = Run::first_difference(self.run.edits(), run.edits()) else { return Ok(()) };
        self.change(run, first)
    }

    /// Replaces the parameters from step 0 on.
    ///
    /// # Errors
    /// A change of what the background mesh is made with: that needs another history. Nothing is changed then.
    pub fn set_parameters(&mut self, parameters: Parameters) -> Result<(), Fault> {
        for key in OF_BACKGROUND {
            if parameters.text_of(key) != self.run.parameters.text_of(key) {
                return Err(
                    Fault::new(format!("{key} belongs to the background mesh")).remedy("Open the run anew with it")
                );
            }
        }
        let mut run = Run::clone(&self.run);
        run.parameters = parameters;
        self.change(run, 0)
    }

    /// Replaces bookmarks and camera, which change no state.
    pub fn annotate(&mut self, change: impl FnOnce(&mut Vec<Bookmark>, &mut Option<Camera>)) {
        let run = Arc::make_mut(&mut self.run);
        change(&mut run.bookmarks, &mut run.camera);
    }

    /// The run becomes another from a step on.
    fn change(&mut self, run: Run, first: u64) -> Result<(), Fault> {
        let step = self.now.step;
        self.run = Arc::new(run);
        self.log.truncate(first);
        self.keyframes.truncate(self.log.known());
        self.resume_recorder()?;
        if step < first {
            self.extend(step);
            return Ok(());
        }
        self.extend(first);
        self.leap(first)?;
        let reached = self.seek(step);
        // The run may end before, or be stuck there: then the state is its last one.
        if self.stuck.is_some() { Ok(()) } else { reached.map(drop) }
    }
}
