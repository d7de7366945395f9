//! Any state of a run, bit-identical to running there afresh.
//!
//! Near states are reached by stepping: forward by the converter, back by its journal. Far ones start from a keyframe.
//! Everything that is kept stays within a budget: whole meshes, differences, events, and the journals of the state at hand and of
//! the stretch before it, which is prepared while one steps back.

mod editing;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::keyframes::{Keyframe, Keyframes};
use super::log::Log;
use super::recorder::{Recorder, SPACING, Stretch};
use super::run::{EditKind, Run};
use crate::core::convert::converter::Converter;
use crate::core::convert::event::Event;
use crate::core::fault::Fault;
use crate::core::mesh::half_edge::Mesh;
use crate::core::mesh::half_edge::touched::Touched;
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::prepare::Background;
use crate::core::progress::Watch;

/// Bytes that a history may take unless it is told otherwise: 512 MiB.
pub const BUDGET: usize = 512 << 20;
/// Steps that are rather stepped than sought.
const NEAR: u64 = 2 * SPACING;
/// After a leap so many steps, at least, can be taken back at once.
const BEHIND: u64 = 128;
/// Steps by which the stretch before is prepared for every step back.
const PREPARED: u64 = 64;
/// Steps between two looks at the memory that the journal takes.
const LOOK: u64 = 64;

/// A state of the run with the steps that lead to it, as far back as they are kept.
struct Cursor {
    converter: Converter<'static>,
    step: u64,
    /// When the memory is looked at next.
    look: u64,
}

/// A run and any state of it.
pub struct History {
    run: Arc<Run>,
    budget: usize,
    log: Log,
    keyframes: Keyframes,
    /// `None` while it is lent.
    recorder: Option<Recorder>,
    /// How often the edits changed.
    edition: u64,
    ended: bool,
    /// Why the conversion cannot go on after the last known step.
    stuck: Option<Fault>,
    now: Cursor,
    /// On its way from a keyframe to where the history of the state at hand begins.
    behind: Option<Cursor>,
    /// A mesh whose memory can be used again.
    spare: Mesh,
    /// What changed since somebody last took note of it.
    changed: Touched,
    /// Whether that is everything.
    all_changed: bool,
}

/// What may look other than before.
#[derive(Clone, Debug, PartialEq)]
pub enum Changes {
    /// Another state altogether, or the same elements in great number.
    Everything,
    /// These nodes and elements, each once; some may have gone, and slots at the end with them.
    Some {
        /// Nodes that moved, came or went, or whose elements changed.
        nodes: Vec<NodeId>,
        /// Elements whose nodes, neighbours or levels changed, that came or went. What merely has a node that moved is not
        /// among them.
        elements: Vec<ElementId>,
    },
}

impl History {
    /// The history of a run, at step 0, with the usual budget.
    ///
    /// # Errors
    /// What is wrong with the case, or with an edit.
    pub fn open(run: Run, watch: &mut dyn Watch) -> Result<History, Fault> {
        let background = run.background(watch)?;
        History::of(run, &background, BUDGET)
    }

    /// The history of a run whose background mesh is made already, within a budget of bytes.
    ///
    /// # Errors
    /// An edit that is no valid one.
    pub fn of(run: Run, background: &Background, budget: usize) -> Result<History, Fault> {
        // The edits must be valid everywhere, not only where one looks.
        run.parameters_at(u64::MAX)?;
        let sizing = Arc::new(background.sizing.clone());
        let mut mesh = background.mesh.clone();
        mesh.commit();
        let mut raw = Converter::new(mesh, sizing, run.parameters.clone());
        let keyframes = Keyframes::new(Keyframe::first(raw.without_mesh(), raw.mesh.clone()));
        let run = Arc::new(run);
        let mut recorder = Recorder::resume(Arc::clone(&run), &keyframes, 0)?;
        let log = recorder.begin();
        let mut now = Cursor { converter: raw, step: 0, look: LOOK };
        now.converter.keep_history();
        run.enter(&mut now.converter, 0)?;
        Ok(History {
            run,
            budget,
            log,
            keyframes,
            recorder: Some(recorder),
            edition: 0,
            ended: false,
            stuck: None,
            now,
            behind: None,
            spare: Mesh::default(),
            changed: Touched::default(),
            all_changed: true,
        })
    }

    /// The run.
    pub fn run(&self) -> &Run {
        &self.run
    }

    /// The state at hand.
    pub fn state(&self) -> &Converter<'static> {
        &self.now.converter
    }

    /// Its step.
    pub fn step(&self) -> u64 {
        self.now.step
    }

    /// What the steps did, as far as they are known.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// The last step of the run, once it is known.
    pub fn end(&self) -> Option<u64> {
        (self.ended || self.stuck.is_some()).then(|| self.log.known())
    }

    /// Why the conversion cannot go on after the last known step, where that is so.
    pub fn stuck(&self) -> Option<&Fault> {
        self.stuck.as_ref()
    }

    /// Bytes that the history takes: everything but the state at hand, the one that runs ahead, and the one on its way.
    pub fn memory(&self) -> usize {
        let behind = self.behind.as_ref().map_or(0, |behind| behind.converter.history_bytes());
        self.log.bytes() + self.keyframes.bytes() + self.now.converter.history_bytes() + behind
    }

    /// What changed since this was asked last.
    pub fn take_changes(&mut self) -> Changes {
        if std::mem::replace(&mut self.all_changed, false) {
            self.changed.clear();
            return Changes::Everything;
        }
        let (nodes, elements) = (self.changed.nodes().to_vec(), self.changed.elements().to_vec());
        self.changed.clear();
        Changes::Some { nodes, elements }
    }

    // ---- running ahead ----

    /// Runs ahead until the step is known or the run ends; where the recorder is lent, nothing is done.
    pub fn extend(&mut self, step: u64) {
        let Some(mut recorder) = self.recorder.take() else { return };
        while self.log.known() < step && self.end().is_none() {
            let count = (step - self.log.known()).min(16 * SPACING);
            let stretch = recorder.run(count, &AtomicBool::new(false));
            self.accept(stretch);
        }
        self.recorder = Some(recorder);
    }

    /// Lends the recorder, so that another thread can run ahead; what it finds comes back by [`History::accept`], itself by
    /// [`History::take_back`]. `None` where it is lent already, or where the end is known.
    pub fn lend(&mut self) -> Option<Recorder> {
        if self.end().is_some() { None } else { self.recorder.take() }
    }

    /// Takes over what was found on the way ahead. False where it belongs to other edits or other steps: then the recorder
    /// that found it is of no use any more.
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

    /// Takes the recorder back. One that knows other edits or other steps is let go, and a new one made.
    ///
    /// # Errors
    /// An edit that is no valid one.
    pub fn take_back(&mut self, recorder: Recorder) -> Result<(), Fault> {
        if recorder.is_of(self.edition) && recorder.step() == self.log.known() {
            self.recorder = Some(recorder);
            return Ok(());
        }
        if self.recorder.is_none() { self.resume_recorder() } else { Ok(()) }
    }

    /// A new recorder at the last keyframe; what is known after that is forgotten and will be found again.
    fn resume_recorder(&mut self) -> Result<(), Fault> {
        self.edition += 1;
        let recorder = Recorder::resume(Arc::clone(&self.run), &self.keyframes, self.edition)?;
        let step = recorder.step();
        self.log.truncate(step);
        self.recorder = Some(recorder);
        (self.ended, self.stuck) = (false, None);
        self.keyframes.truncate(self.log.known());
        if self.log.known() < step { self.resume_recorder() } else { Ok(()) }
    }

    // ---- seeking ----

    /// Goes to a step, or as near to it as is known: to the end of the run where that comes before, or to where a lent
    /// recorder has come. Returns the step.
    ///
    /// # Errors
    /// Where the conversion cannot go on before that: the state is the last one that there is.
    pub fn seek(&mut self, step: u64) -> Result<u64, Fault> {
        self.extend(step);
        let target = step.min(self.log.known());
        let (now, kept) = (self.now.step, self.now.converter.history_len() as u64);
        if target < now && (now - target > 16 * NEAR || now - target > kept + NEAR) || target > now + NEAR {
            self.leap(target)?;
        }
        while self.now.step > target {
            self.back_one()?;
        }
        while self.now.step < target {
            self.forward_one()?;
        }
        match &self.stuck {
            Some(fault) if step > target => Err(fault.clone()),
            _ => Ok(target),
        }
    }

    /// One step forward; `None` at the end, or where a lent recorder has not come further.
    ///
    /// # Errors
    /// Where the conversion cannot go on.
    pub fn forward(&mut self) -> Result<Option<Event>, Fault> {
        let step = self.now.step;
        self.seek(step + 1)?;
        Ok(if self.now.step > step { self.event(step + 1)? } else { None })
    }

    /// One step back; false at the beginning.
    ///
    /// # Errors
    /// None that the way there has not met.
    pub fn back(&mut self) -> Result<bool, Fault> {
        let Some(step) = self.now.step.checked_sub(1) else { return Ok(false) };
        self.seek(step).map(|_| true)
    }

    /// What a step did, by replay where its event was given up; `None` where it is not known.
    ///
    /// # Errors
    /// None that the way there has not met.
    pub fn event(&self, step: u64) -> Result<Option<Event>, Fault> {
        if !(1..=self.log.known()).contains(&step) {
            return Ok(None);
        }
        Ok(self.events(step, step)?.first().copied())
    }

    /// What the steps from `from` to `until` (both included) did, as far as they are known, by replay where their events were
    /// given up.
    ///
    /// # Errors
    /// None that the way there has not met.
    pub fn events(&self, from: u64, until: u64) -> Result<Vec<Event>, Fault> {
        let until = until.min(self.log.known());
        let kept: Option<Vec<Event>> = (from..=until).map(|step| self.log.event(step).copied()).collect();
        if let Some(events) = kept {
            return Ok(events);
        }
        let mut events = Vec::new();
        self.replay(from - 1, until, &mut |_, _, event| events.extend(event))?;
        Ok(events)
    }

    /// Walks the states from `from` to `until` without moving the state at hand: tells step, state and the event that led
    /// there, none for the first.
    ///
    /// # Errors
    /// None that the way there has not met.
    pub(super) fn replay(
        &self,
        from: u64,
        until: u64,
        tell: &mut dyn FnMut(u64, &Converter<'static>, Option<&Event>),
    ) -> Result<(), Fault> {
        let mut cursor = self.cursor_before(from, Mesh::default())?;
        while cursor.step < from {
            cursor.advance(&self.run)?;
        }
        tell(cursor.step, &cursor.converter, None);
        while cursor.step < until.min(self.log.known()) {
            let event = cursor.advance(&self.run)?;
            tell(cursor.step, &cursor.converter, Some(&event));
        }
        Ok(())
    }

    pub(super) fn keyframes(&self) -> &Keyframes {
        &self.keyframes
    }

    /// The state of the keyframe at or before a step, its edits made.
    fn cursor_before(&self, step: u64, spare: Mesh) -> Result<Cursor, Fault> {
        let index = self.keyframes.at_or_before(step);
        let step = self.keyframes.frames()[index].step;
        let mut converter = self.keyframes.state(index, spare);
        self.run.enter(&mut converter, step)?;
        Ok(Cursor { converter, step, look: step + LOOK })
    }

    fn leap(&mut self, step: u64) -> Result<(), Fault> {
        if let Some(behind) = self.behind.take() {
            self.spare = behind.converter.mesh;
        }
        let spare = std::mem::take(&mut self.now.converter.mesh);
        self.now = self.cursor_before(self.before(step), spare)?;
        self.now.converter.keep_history();
        self.all_changed = true;
        // A leap has time for what a step back has not.
        if self.now.step > 0 { self.prepare(0) } else { Ok(()) }
    }

    /// The step from which a leap to a step starts: some steps earlier, so that they can be taken back at once. In the global
    /// post-processing a step may be a sweep over the whole mesh, and one is enough.
    fn before(&self, step: u64) -> u64 {
        let sweeps = self.log.kind(step).is_some_and(|kind| matches!(kind, "swept" | "post_processed"));
        step.saturating_sub(if sweeps { 1 } else { BEHIND })
    }

    fn forward_one(&mut self) -> Result<(), Fault> {
        let event = self.now.advance(&self.run)?;
        debug_assert_eq!(Some(event.kind()), self.log.kind(self.now.step), "a run is a value");
        self.note_changes();
        self.now.look_at_memory(self.budget / 8);
        Ok(())
    }

    fn back_one(&mut self) -> Result<(), Fault> {
        if self.now.converter.history_len() == 0 {
            self.prepare(u64::MAX)?;
            // It is the same state; its history goes further back.
            let further = self.behind.take().expect("it was just prepared");
            self.spare = std::mem::replace(&mut self.now, further).converter.mesh;
        }
        self.note_changes();
        let step = self.now.step;
        self.now.converter.step_back();
        self.now.step = step - 1;
        if self.run.edits_at(step).iter().any(|edit| matches!(edit.kind, EditKind::Parameter { .. })) {
            self.now.converter.set_parameters(self.run.parameters_at(step - 1)?);
        }
        let kept = self.now.converter.history_len() as u64;
        if kept < NEAR && kept < self.now.step {
            self.prepare(PREPARED)?;
        }
        Ok(())
    }

    /// Brings the stretch before that which can be taken back nearer to it by so many steps.
    fn prepare(&mut self, steps: u64) -> Result<(), Fault> {
        let begin = self.now.step - self.now.converter.history_len() as u64;
        let mut behind = match self.behind.take() {
            Some(behind) => behind,
            None => {
                let spare = std::mem::take(&mut self.spare);
                let mut behind = self.cursor_before(self.before(begin), spare)?;
                behind.converter.keep_history();
                behind
            }
        };
        for _ in 0..steps.min(begin - behind.step) {
            behind.advance(&self.run)?;
        }
        behind.look_at_memory(self.budget / 8);
        self.behind = Some(behind);
        Ok(())
    }

    fn note_changes(&mut self) {
        if self.all_changed || !self.now.converter.note_last_step(&mut self.changed) {
            return;
        }
        if self.changed.elements().len() > self.now.converter.mesh.element_slots() / 8 + 256 {
            self.all_changed = true;
            self.changed.clear();
        }
    }
}

impl Cursor {
    /// One step forward, and the edits of where that leads.
    fn advance(&mut self, run: &Run) -> Result<Event, Fault> {
        let event = self.converter.step()?;
        self.step += 1;
        run.make_edits(&mut self.converter, self.step)?;
        Ok(event)
    }

    /// Shortens the history to what the budget allows; the last step can always be taken back.
    fn look_at_memory(&mut self, budget: usize) {
        // The journal is most of it, and its size is known at once.
        if self.step < self.look && self.converter.mesh.journal().bytes() <= budget {
            return;
        }
        self.look = self.step + LOOK;
        while self.converter.history_bytes() > budget {
            let before = self.converter.history_len();
            self.converter.shorten_history(before / 2);
            if self.converter.history_len() == before {
                return;
            }
        }
    }
}
