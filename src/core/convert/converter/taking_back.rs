//! The steps of a converter taken back: what each needs for that, and what of it is kept.

use super::{Begun, Converter, Counts};
use crate::core::convert::finish::Finished;
use crate::core::convert::finish::parts::PartMarks;
use crate::core::convert::last_resort::Outcome;
use crate::core::convert::last_resort::component::Component;
use crate::core::convert::phase::Phase;
use crate::core::mesh::{ElementId, Mark, Mesh, NodeId, Touched, Undone};

/// What a step needs to be taken back.
#[derive(Clone, Debug)]
pub(super) struct Record {
    phase: Phase,
    second_pass: bool,
    face: usize,
    begun: Begun,
    picked: Option<[NodeId; 2]>,
    counts: Counts,
    last_resort: Outcome,
    finished: Finished,
    parts: PartMarks,
    undo: Undo,
}

/// How a step is taken back.
#[derive(Clone, Debug)]
enum Undo {
    /// By the journal, from here.
    Journal(Mark),
    /// It was a rollback itself: by doing again what it took back.
    Redo(Vec<Undone>),
}

impl<'a> Converter<'a> {
    /// What the next step needs to be taken back, where a history is kept.
    pub(super) fn record(&self) -> Option<Record> {
        self.keeps_history().then(|| Record {
            phase: self.phase.clone(),
            second_pass: self.second_pass,
            face: self.face,
            begun: self.begun,
            picked: self.picked,
            counts: self.counts,
            last_resort: self.last_resort,
            finished: self.finished,
            parts: self.finishing.mark(),
            undo: Undo::Journal(self.mesh.mark()),
        })
    }

    /// Adds the record of the step that was just done to the history.
    pub(super) fn remember(&mut self, record: Option<Record>) {
        if let (Some(history), Some(mut record)) = (&mut self.history, record) {
            if let Some(undone) = self.undone.take() {
                record.undo = Undo::Redo(undone);
            }
            history.push(record);
        }
    }

    /// Keeps from now on what [`step_back`](Converter::step_back) needs.
    pub fn keep_history(&mut self) {
        self.mesh.commit();
        self.finishing.record();
        self.history = Some(Vec::new());
    }

    /// Takes the last step back, exactly. False at the beginning of the history, or where none is kept.
    pub fn step_back(&mut self) -> bool {
        let Some(record) = self.history.as_mut().and_then(Vec::pop) else { return false };
        match record.undo {
            Undo::Journal(mark) => self.mesh.take_back(mark),
            Undo::Redo(undone) => self.mesh.redo(undone),
        }
        self.phase = record.phase;
        self.second_pass = record.second_pass;
        if record.face != self.face {
            (self.face, self.begun) = (record.face, record.begun);
            self.finishing = self.finished_faces.pop().unwrap_or_default();
        }
        self.picked = record.picked;
        self.counts = record.counts;
        self.last_resort = record.last_resort;
        self.finished = record.finished;
        self.finishing.take_back(record.parts, record.finished.cleaned_up);
        self.queue = None;
        true
    }

    /// Keeps the journal from step to step without a history: it records what the steps touched. The caller clears it
    /// ([`Mesh::commit`]) where [`Phase::mark`] says that nothing is under way.
    pub(in crate::core) fn keep_journal(&mut self) {
        self.mesh.commit();
        self.journal_kept = true;
    }

    /// Whether steps can be taken back.
    pub(super) fn keeps_history(&self) -> bool {
        self.history.is_some()
    }

    pub(super) fn keeps_journal(&self) -> bool {
        self.journal_kept || self.keeps_history()
    }

    /// Number of steps that can be taken back.
    pub fn history_len(&self) -> usize {
        self.history.as_ref().map_or(0, Vec::len)
    }

    /// Bytes that the history takes: records, journal, and what rollbacks need to be taken back. Linear in its length.
    pub fn history_bytes(&self) -> usize {
        let records = self.history.as_ref().map_or(0, |records| {
            let redo = |record: &Record| match &record.undo {
                Undo::Redo(undone) => undone.capacity() * size_of::<Undone>(),
                Undo::Journal(_) => 0,
            };
            records.capacity() * size_of::<Record>() + records.iter().map(redo).sum::<usize>()
        });
        records + self.mesh.journal().bytes() + self.finishing.log_bytes()
    }

    /// Bytes that everything but mesh, queue and history takes, beside its own size.
    pub(in crate::core) fn bytes_of_rest(&self) -> usize {
        let of = |component: &Component| size_of::<Component>() + component.triangles.len() * size_of::<ElementId>();
        let phase = match &self.phase {
            Phase::Close { waiting, left } => waiting.iter().chain(left).map(of).sum(),
            // The plan is shared by all states that carry it out.
            Phase::Match { left, .. } | Phase::Patch { left, .. } => left.iter().map(of).sum(),
            _ => 0,
        };
        phase + self.finishing.bytes()
    }

    /// Forgets the older steps of the history, so that about `keep` can still be taken back: a few more where an
    /// attempt was under way.
    pub fn shorten_history(&mut self, keep: usize) {
        let Some(records) = &mut self.history else { return };
        // Later steps take back no further than to the selection at which nothing was under way.
        let last = records.len().saturating_sub(keep);
        let at_rest = |record: &Record| record.phase.mark().is_none();
        let Some(first) = (0..=last).rev().find(|&i| records.get(i).is_some_and(at_rest)) else { return };
        let Undo::Journal(mark) = records[first].undo else { return };
        records.drain(..first);
        records.shrink_to(2 * records.len());
        self.mesh.forget_before(mark);
    }

    /// The ids of what the last step changed, from the history; false where there is none.
    pub fn note_last_step(&self, touched: &mut Touched) -> bool {
        let Some(record) = self.history.as_ref().and_then(|records| records.last()) else { return false };
        match &record.undo {
            Undo::Journal(mark) => touched.note_since(&self.mesh, *mark),
            Undo::Redo(undone) => touched.note_undone(&self.mesh, undone),
        }
        true
    }

    /// Everything but the mesh and caches, history left out: with the mesh, a state to go on from.
    pub(in crate::core) fn without_mesh(&mut self) -> Converter<'a> {
        let (mesh, queue) = (std::mem::take(&mut self.mesh), self.queue.take());
        let (history, journal_kept) = (self.history.take(), std::mem::take(&mut self.journal_kept));
        let rest = self.clone();
        (self.mesh, self.queue, self.history, self.journal_kept) = (mesh, queue, history, journal_kept);
        rest
    }

    /// The state that [`without_mesh`](Converter::without_mesh) was made of, on its mesh.
    pub(in crate::core) fn with_mesh(&self, mesh: Mesh) -> Converter<'a> {
        Converter { mesh, ..self.clone() }
    }
}
