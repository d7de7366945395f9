//! Running ahead: with the recorder here, or lent to others.

use std::sync::Arc;

use super::History;
use crate::core::fault::Fault;
use crate::core::progress::Cancel;
use crate::core::run::recorder::{Recorder, SPACING, Stretch};

impl History {
    /// Runs ahead until the step is known or the run ends; does nothing while the recorder is lent.
    pub fn extend(&mut self, step: u64) {
        let Some(mut recorder) = self.recorder.take() else { return };
        while self.log.known() < step && self.end().is_none() {
            let count = (step - self.log.known()).min(16 * SPACING);
            let stretch = recorder.run(count, &Cancel::default());
            self.accept(stretch);
        }
        self.recorder = Some(recorder);
    }

    /// Searches, and where nothing is found runs further ahead and searches again.
    pub(in crate::core::run) fn ahead<T>(&mut self, look: impl Fn(&History) -> Option<T>) -> Option<T> {
        loop {
            if let Some(found) = look(self) {
                return Some(found);
            }
            let known = self.log.known();
            self.extend(known + 4 * SPACING);
            if self.log.known() == known {
                return None;
            }
        }
    }

    /// Lends the recorder, so that another thread can run ahead. [`History::accept`] takes its results,
    /// [`History::take_back`] the recorder itself. `None` where it is already lent, or where the end is known.
    pub fn lend(&mut self) -> Option<Recorder> {
        if self.end().is_some() {
            return None;
        }
        let recorder = self.recorder.take()?;
        self.lent = Some(self.edition);
        Some(recorder)
    }

    /// Adds a stretch that the recorder ran. False where it belongs to other edits or other steps: then its recorder is
    /// obsolete.
    pub fn accept(&mut self, stretch: Stretch) -> bool {
        if stretch.edition != self.edition || stretch.from != self.log.known() {
            return false;
        }
        self.log.append(stretch.log);
        for keyframe in stretch.keyframes {
            self.keyframes.push(keyframe);
            self.keyframes.thin(self.budget / 4);
        }
        self.log.give_up(self.budget / 4);
        self.ended |= stretch.ended;
        self.stuck = stretch.fault;
        true
    }

    /// Takes the recorder back. One of other edits or other steps is dropped, and replaced unless another one has been
    /// lent since.
    ///
    /// # Errors
    /// An invalid edit.
    pub fn take_back(&mut self, recorder: Recorder) -> Result<(), Fault> {
        if recorder.is_of(self.edition) {
            self.lent = None;
            if recorder.step() == self.log.known() {
                self.recorder = Some(recorder);
                return Ok(());
            }
        }
        let is_replaced = self.recorder.is_some() || self.lent == Some(self.edition);
        if is_replaced { Ok(()) } else { self.resume_recorder() }
    }

    /// Makes a new recorder at the last keyframe and drops everything known after it.
    pub(super) fn resume_recorder(&mut self) -> Result<(), Fault> {
        self.edition += 1;
        let recorder = Recorder::resume(Arc::clone(&self.run), &self.keyframes, self.edition)?;
        let step = recorder.step();
        self.log.truncate(step);
        self.recorder = Some(recorder);
        (self.ended, self.stuck) = (false, None);
        self.keyframes.truncate(self.log.known());
        if self.log.known() < step { self.resume_recorder() } else { Ok(()) }
    }
}
