//! Changing a run: edits at steps, parameters from the beginning.

use std::sync::Arc;

use super::History;
use crate::core::case::Parameters;
use crate::core::fault::Fault;
use crate::core::run::run::{Edit, EditKind, OF_BACKGROUND, Run};

impl History {
    /// Makes an edit at the current step; it replaces an edit of the same thing there. It changes what follows and
    /// nothing before.
    ///
    /// # Errors
    /// A segment that is not on the front. Then nothing changes.
    pub fn edit(&mut self, kind: EditKind) -> Result<(), Fault> {
        if let EditKind::Base { a, b } = kind {
            self.now.converter.check_base(a, b)?;
        }
        self.set_edits(self.run.edits_with(Edit { step: self.now.step, kind }))
    }

    /// Replaces all edits of the run. The current state becomes that of the same step with the new edits, or the last
    /// one where the run is now shorter.
    ///
    /// # Errors
    /// An invalid edit. Then nothing changes.
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
    /// A change of a parameter of the background mesh, which needs a new history. Then nothing changes.
    pub fn set_parameters(&mut self, parameters: Parameters) -> Result<(), Fault> {
        for key in OF_BACKGROUND {
            if parameters.text_of(key) != self.run.parameters.text_of(key) {
                return Err(
                    Fault::new(format!("{key} belongs to the background mesh")).remedy("Open the run again with it")
                );
            }
        }
        let mut run = Run::clone(&self.run);
        run.parameters = parameters;
        self.change(run, 0)
    }

    /// Replaces the run by one that differs from step `first` on.
    fn change(&mut self, run: Run, first: u64) -> Result<(), Fault> {
        let step = self.now.step;
        self.run = Arc::new(run);
        self.selecting = None;
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
        // The run may be stuck before that step: then the state is its last one.
        if self.stuck.is_some() { Ok(()) } else { reached.map(drop) }
    }
}
