//! The faces of a surface: converted one after another, or in parallel with the same result.

use std::sync::Arc;

use super::waiting::next_message;
use super::{Converter, TELL};
use crate::core::convert::event::Event;
use crate::core::convert::front::Done;
use crate::core::convert::phase::{FinishPart, Phase};
use crate::core::fault::Fault;
use crate::core::progress::{Stage, Watch};

/// A report on a face that is converted in parallel with others.
enum OfFace<'a> {
    /// How many quadrilaterals it has formed so far.
    Formed(u64),
    /// It is at its end.
    Done(Box<Result<Converter<'a>, Fault>>),
}

/// Counts at the start of a face.
#[derive(Clone, Copy, Debug, Default)]
pub struct Begun {
    /// Quadrilaterals that stood.
    pub stood: u64,
    /// Quadrilaterals that front and last resort had made.
    pub made: u64,
}

impl<'a> Converter<'a> {
    /// Elements of all faces but those to come.
    pub(super) fn all_but_waiting(&self) -> u64 {
        self.mesh.element_count() as u64 - self.waiting.get(self.face).copied().unwrap_or(0)
    }

    /// The face that is being converted, by its region; none where all is converted together.
    pub fn face(&self) -> Option<u32> {
        self.faces.get(self.face).copied()
    }

    /// Goes on to the next face; after the last one, to what folds over the surface across faces.
    pub(super) fn next_face(&mut self) -> Done {
        let event = Event::FaceConverted { region: self.face().unwrap_or(0) };
        self.begun = Begun { stood: self.all_but_waiting(), made: self.made() };
        self.mesh.close_free_lists();
        let finishing = std::mem::take(&mut self.finishing);
        if self.keeps_history() {
            self.finished_faces.push(finishing);
        }
        self.face += 1;
        self.second_pass = false;
        self.queue = None;
        let next = match self.face() {
            Some(_) => Phase::Select,
            None if self.parameters.post_processing => Phase::PostProcess { part: FinishPart::Unfolding },
            None => Phase::Done,
        };
        (next, Some(event))
    }

    /// Runs to the end with the faces in parallel, to the same bytes as one after another. In parallel only from step 0
    /// and without a history; else as [`Converter::run`].
    ///
    /// # Errors
    /// As [`Converter::step`].
    pub fn run_by_faces(&mut self, watch: &mut dyn Watch) -> Result<(), Fault> {
        if self.faces.len() < 2
            || !self.mesh.is_dense()
            || self.counts.steps > 0
            || self.picked.is_some()
            || self.keeps_journal()
        {
            return self.run(watch);
        }
        let total = self.mesh.element_count() as u64;
        watch.tell(Stage::Convert, 0, total);
        let mut parts = self.mesh.face_meshes();
        let cancel = watch.cancel();
        let (sender, receiver) = std::sync::mpsc::channel();
        let mut done: Vec<Option<Result<Converter<'a>, Fault>>> = parts.iter().map(|_| None).collect();
        rayon::in_place_scope(|scope| {
            for (k, part) in parts.iter_mut().enumerate() {
                let (mesh, sender) = (std::mem::take(&mut part.mesh), sender.clone());
                let (source, parameters) = (Arc::clone(&self.source), self.parameters.clone());
                let cancel = cancel.clone();
                scope.spawn(move |_| {
                    let mut converter = Converter::new(mesh, source, parameters);
                    let face = loop {
                        if converter.counts.steps.is_multiple_of(TELL) {
                            if let Err(stopped) = cancel.check() {
                                break Err(stopped);
                            }
                            let _ = sender.send((k, OfFace::Formed(converter.counts.formed)));
                        }
                        match converter.step() {
                            Ok(Event::FaceConverted { .. }) => break Ok(converter),
                            Ok(_) => {}
                            Err(fault) => break Err(fault),
                        }
                    };
                    // The receiver listens until all senders are gone.
                    let _ = sender.send((k, OfFace::Done(Box::new(face))));
                });
            }
            drop(sender);
            let mut formed = vec![0; done.len()];
            let mut all = 0;
            while let Some((k, told)) = next_message(&receiver) {
                let own = match &told {
                    OfFace::Formed(own) => *own,
                    OfFace::Done(face) => face.as_ref().as_ref().map_or(formed[k], |converter| converter.counts.formed),
                };
                all = all + own - formed[k];
                formed[k] = own;
                watch.tell(Stage::Convert, 2 * all, total);
                if let OfFace::Done(face) = told {
                    done[k] = Some(*face);
                }
            }
        });
        for (part, face) in parts.iter_mut().zip(done) {
            let Some(face) = face else { return Err(Fault::new("A face was not converted to its end")) };
            let face = face?;
            part.mesh = face.mesh;
            self.counts += face.counts;
            self.last_resort += face.last_resort;
            self.finished += face.finished;
            self.phase = face.phase;
        }
        self.mesh.put_back(parts);
        self.face = self.faces.len();
        self.run(watch)
    }
}
