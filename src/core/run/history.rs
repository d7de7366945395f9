//! Reaching any state of a run, bit-identical to a new run to that step.
//!
//! A near state is reached by steps: forward by the converter, back by its journal. A far one starts from a keyframe.
//! All stored data stays within a budget: whole meshes, differences, events, the journal of the current state, and that
//! of the stretch before it, which is prepared during steps back.

mod ahead;
mod editing;

use std::sync::Arc;

use super::explain::Selecting;
use super::keyframes::{Keyframe, Keyframes};
use super::log::Log;
use super::recorder::{Recorder, SPACING};
use super::run::{EditKind, Run};
use crate::core::convert::{Converter, Event, EventKind};
use crate::core::fault::Fault;
use crate::core::mesh::{ElementId, Mesh, NodeId, Touched};
use crate::core::prepare::Background;
use crate::core::progress::Watch;

/// The default budget of a history, in bytes: 512 MiB.
pub const BUDGET: usize = 512 << 20;
/// Up to this distance, stepping is faster than starting from a keyframe.
const NEAR: u64 = 2 * SPACING;
/// At least this many steps can be undone at once after a leap.
const BEHIND: u64 = 128;
/// Steps by which each step back advances the preparation of the stretch before.
const PREPARED: u64 = 64;
/// Steps between two checks of the memory of the journal.
const CHECK: u64 = 64;

/// A state of the run with its journal: the steps that lead to it, as far back as they are stored.
struct Cursor {
    converter: Converter<'static>,
    step: u64,
    /// The step of the next check of its memory.
    next_check: u64,
}

/// A run with access to all its states.
pub struct History {
    run: Arc<Run>,
    budget: usize,
    log: Log,
    keyframes: Keyframes,
    /// `None` while lent.
    recorder: Option<Recorder>,
    /// Counts changes of the edits and restarts of the recorder.
    edition: u64,
    /// The edition of the recorder that was lent last, until it is back.
    lent: Option<u64>,
    ended: bool,
    /// Why the conversion cannot continue after the last known step.
    stuck: Option<Fault>,
    now: Cursor,
    /// What the selection of a base looked at that was asked for last.
    selecting: Option<Arc<Selecting>>,
    /// A cursor on its way from a keyframe to the beginning of the journal of `now`.
    behind: Option<Cursor>,
    /// A mesh whose memory can be reused.
    spare: Mesh,
    /// What changed since the last [`History::take_changes`].
    changed: Touched,
    /// Whether that is everything.
    all_changed: bool,
}

/// What changed between two states.
#[derive(Clone, Debug, PartialEq)]
pub enum Changes {
    /// Everything, or too much to list.
    Everything,
    /// These nodes and elements, each listed once. Some may be deleted, together with slots at the end.
    Some {
        /// Nodes that moved, appeared or disappeared, or whose elements changed.
        nodes: Vec<NodeId>,
        /// Elements that appeared or disappeared, or whose nodes, neighbours or levels changed. Elements of nodes that
        /// merely moved are not listed.
        elements: Vec<ElementId>,
    },
}

/// Looks at a step: its number, the state after it, and what it did.
type Visit<'v> = &'v mut dyn FnMut(u64, &Converter<'static>, Option<&Event>) -> Result<(), Fault>;

impl History {
    /// The history of a run, at step 0, with the usual budget.
    ///
    /// # Errors
    /// An invalid case or edit.
    pub fn open(run: Run, watch: &mut dyn Watch) -> Result<History, Fault> {
        let background = run.background(watch)?;
        History::of(run, &background, BUDGET)
    }

    /// The history of a run whose background mesh exists, within a budget in bytes.
    ///
    /// # Errors
    /// An invalid edit.
    pub fn of(run: Run, background: &Background, budget: usize) -> Result<History, Fault> {
        // All edits must be valid, not only those of the steps that are visited.
        run.parameters_at(u64::MAX)?;
        let sizing = Arc::new(background.sizing.clone());
        let mut mesh = background.mesh.clone();
        mesh.commit();
        let mut raw = Converter::new(mesh, sizing, run.parameters.clone());
        let keyframes = Keyframes::new(Keyframe::first(raw.without_mesh(), raw.mesh.clone()));
        let run = Arc::new(run);
        let mut recorder = Recorder::resume(Arc::clone(&run), &keyframes, 0)?;
        let log = recorder.begin();
        let mut now = Cursor { converter: raw, step: 0, next_check: CHECK };
        now.converter.keep_history();
        run.enter(&mut now.converter, 0)?;
        Ok(History {
            run,
            budget,
            log,
            keyframes,
            recorder: Some(recorder),
            edition: 0,
            lent: None,
            ended: false,
            stuck: None,
            now,
            selecting: None,
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

    /// The current state.
    pub fn state(&self) -> &Converter<'static> {
        &self.now.converter
    }

    /// The step of the current state.
    pub fn step(&self) -> u64 {
        self.now.step
    }

    /// What the steps did, as far as they are known.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// What the selection of the base under way looked at, or what the next one does where no quadrilateral is under
    /// way. The current state is the same afterwards, though it may be visited anew.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn selecting(&mut self) -> Result<Arc<Selecting>, Fault> {
        let step = self.now.step;
        let Some(selected) = self.log.selection(step) else {
            let selecting = Selecting::next(&self.now.converter).expect("no quadrilateral is under way");
            return Ok(Arc::new(selecting));
        };
        if let Some(known) =
            self.selecting.as_ref().filter(|known| known.base.is_some_and(|base| base.step == selected))
        {
            return Ok(Arc::clone(known));
        }
        let event = self.event(selected)?.expect("the step is known");
        self.seek(selected - 1)?;
        let made = Selecting::of_base(&self.now.converter, &event).map(Arc::new).expect("the step selects a base");
        self.seek(step)?;
        self.selecting = Some(Arc::clone(&made));
        Ok(made)
    }

    /// The last step of the run, once it is known.
    pub fn end(&self) -> Option<u64> {
        (self.ended || self.stuck.is_some()).then(|| self.log.known())
    }

    /// Why the conversion cannot continue after the last known step; `None` where it can.
    pub fn stuck(&self) -> Option<&Fault> {
        self.stuck.as_ref()
    }

    /// The memory of the history in bytes, without the meshes of the current state, of the recorder and of the prepared
    /// stretch.
    pub fn memory(&self) -> usize {
        let behind = self.behind.as_ref().map_or(0, |behind| behind.converter.history_bytes());
        self.log.bytes() + self.keyframes.bytes() + self.now.converter.history_bytes() + behind
    }

    /// What changed since the last call.
    pub fn take_changes(&mut self) -> Changes {
        if std::mem::replace(&mut self.all_changed, false) {
            self.changed.clear();
            return Changes::Everything;
        }
        let (nodes, elements) = (self.changed.nodes().to_vec(), self.changed.elements().to_vec());
        self.changed.clear();
        Changes::Some { nodes, elements }
    }

    // ---- seeking ----

    /// Goes to a step, or to the last known one before it: the end of the run, or the last step of a lent recorder.
    /// Returns the step reached.
    ///
    /// # Errors
    /// The conversion cannot continue before that step. The current state is then the last one of the run.
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

    /// Goes one step forward; `None` at the end, or at the last step of a lent recorder.
    ///
    /// # Errors
    /// The conversion cannot continue.
    pub fn forward(&mut self) -> Result<Option<Event>, Fault> {
        let step = self.now.step;
        self.seek(step + 1)?;
        Ok(if self.now.step > step { self.event(step + 1)? } else { None })
    }

    /// Goes one step back; false at the beginning.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn back(&mut self) -> Result<bool, Fault> {
        let Some(step) = self.now.step.checked_sub(1) else { return Ok(false) };
        self.seek(step).map(|_| true)
    }

    /// What a step did, by replay where its event was dropped; `None` where the step is not known.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn event(&self, step: u64) -> Result<Option<Event>, Fault> {
        if !(1..=self.log.known()).contains(&step) {
            return Ok(None);
        }
        Ok(self.events(step, step)?.first().copied())
    }

    /// What the steps from `from` to `until` (both included) did, as far as they are known, by replay where their
    /// events were dropped.
    ///
    /// # Errors
    /// A step of the replay failed.
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

    /// Visits the states from `from` to `until` without changing the current state: calls `visit` with step, state and
    /// the event that led there, `None` for the first.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub(super) fn replay(
        &self,
        from: u64,
        until: u64,
        visit: &mut dyn FnMut(u64, &Converter<'static>, Option<&Event>),
    ) -> Result<(), Fault> {
        self.replay_while(from, until, &mut |step, state, event| {
            visit(step, state, event);
            Ok(())
        })
    }

    /// As [`replay`](History::replay), until `visit` fails.
    pub(super) fn replay_while(&self, from: u64, until: u64, visit: Visit<'_>) -> Result<(), Fault> {
        let mut cursor = self.cursor_before(from, Mesh::default())?;
        while cursor.step < from {
            cursor.advance(&self.run)?;
        }
        visit(cursor.step, &cursor.converter, None)?;
        while cursor.step < until.min(self.log.known()) {
            let event = cursor.advance(&self.run)?;
            visit(cursor.step, &cursor.converter, Some(&event))?;
        }
        Ok(())
    }

    pub(super) fn keyframes(&self) -> &Keyframes {
        &self.keyframes
    }

    /// The state of the last keyframe at or before a step, with its edits applied.
    fn cursor_before(&self, step: u64, spare: Mesh) -> Result<Cursor, Fault> {
        let index = self.keyframes.at_or_before(step);
        let step = self.keyframes.frames()[index].step;
        let mut converter = self.keyframes.state(index, spare);
        self.run.enter(&mut converter, step)?;
        Ok(Cursor { converter, step, next_check: step + CHECK })
    }

    fn leap(&mut self, step: u64) -> Result<(), Fault> {
        if let Some(behind) = self.behind.take() {
            self.spare = behind.converter.mesh;
        }
        let spare = std::mem::take(&mut self.now.converter.mesh);
        self.now = self.cursor_before(self.before(step), spare)?;
        self.now.converter.keep_history();
        self.all_changed = true;
        // Prepare now what a step back would have no time for.
        if self.now.step > 0 { self.prepare(0) } else { Ok(()) }
    }

    /// The step from which a leap to a step starts: some steps earlier, so that these can be undone at once. In the
    /// global post-processing, where a step may sweep the whole mesh, one step earlier is enough.
    fn before(&self, step: u64) -> u64 {
        let sweeps = self.log.kind(step).is_some_and(|kind| {
            matches!(kind, EventKind::RowLaid | EventKind::Swept | EventKind::PostProcessed | EventKind::Mirrored)
        });
        step.saturating_sub(if sweeps { 1 } else { BEHIND })
    }

    fn forward_one(&mut self) -> Result<(), Fault> {
        let event = self.now.advance(&self.run)?;
        debug_assert_eq!(Some(event.kind()), self.log.kind(self.now.step), "a run is a value");
        self.note_changes();
        self.now.limit_memory(self.budget / 8);
        Ok(())
    }

    fn back_one(&mut self) -> Result<(), Fault> {
        if self.now.converter.history_len() == 0 {
            self.prepare(u64::MAX)?;
            // The same state, with a journal that reaches further back.
            let further = self.behind.take().expect("`prepare` sets it");
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

    /// Advances the prepared stretch, at most by `steps`, towards the beginning of the journal of the current state.
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
        behind.limit_memory(self.budget / 8);
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
    /// One step forward, with the edits of the step reached.
    fn advance(&mut self, run: &Run) -> Result<Event, Fault> {
        let event = self.converter.step()?;
        self.step += 1;
        run.make_edits(&mut self.converter, self.step)?;
        Ok(event)
    }

    /// Shortens the journal to fit the budget; the last step can always be undone.
    fn limit_memory(&mut self, budget: usize) {
        // The journal takes most of the memory, and its size is known at once.
        if self.step < self.next_check && self.converter.mesh.journal().bytes() <= budget {
            return;
        }
        self.next_check = self.step + CHECK;
        while self.converter.history_bytes() > budget {
            let before = self.converter.history_len();
            self.converter.shorten_history(before / 2);
            if self.converter.history_len() == before {
                return;
            }
        }
    }
}
