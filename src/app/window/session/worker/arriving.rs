//! Arriving at a step: the report of the state, and the checks of its invariants.

use std::collections::VecDeque;
use std::sync::Arc;

use web_time::Instant;

use super::super::SessionNews;
use super::super::moment::{Moment, Verdict, segment};
use super::{RECENT, Worker};
use crate::core::convert::{Event, EventKind, LookedAt, Phase};
use crate::core::fault::Fault;
use crate::core::mesh::ElementId;
use crate::core::run::front_table::Row;
use crate::core::run::{Changes, explain};

impl Worker {
    /// Goes to a step and notes the changes.
    fn walk(&mut self, step: u64) -> Result<Changes, Fault> {
        self.history.seek(step)?;
        let changes = self.history.take_changes();
        self.copies.note(&changes);
        self.since.note(&changes, self.history.state().mesh.element_slots());
        Ok(changes)
    }

    /// Goes to a step such that the changes of the last steps are known. Returns what the last step looked at.
    fn walk_with_recent(&mut self, step: u64) -> Result<Option<LookedAt>, Fault> {
        let first = (step + 1).saturating_sub(RECENT).max(1);
        let is_known = |recent: &VecDeque<(u64, _)>, step: u64| recent.iter().any(|known| known.0 == step);
        let unknown = (first..=step).find(|k| !is_known(&self.recent, *k)).unwrap_or(step);
        if step == 0 {
            self.walk(0)?;
            return Ok(None);
        }
        self.walk(unknown - 1)?;
        let mut looked_at = None;
        for k in unknown..=step {
            if k == step {
                looked_at = Some(self.history.state().looks_at());
            }
            let changed: Arc<[ElementId]> = match self.walk(k)? {
                Changes::Some { elements, .. } => elements.into(),
                Changes::Everything => Arc::new([]),
            };
            if !is_known(&self.recent, k) {
                self.recent.push_back((k, changed));
            }
        }
        while self.recent.len() > 4 * RECENT as usize {
            self.recent.pop_front();
        }
        Ok(looked_at)
    }

    pub(super) fn moment(&mut self, step: u64, since: Instant) -> Result<Moment, Fault> {
        let step = step.min(self.history.log().known());
        let looked_at = self.walk_with_recent(step)?;
        let selecting = self.history.selecting()?;
        // That may have gone back and come again.
        self.walk(step)?;
        let just_changed = self.recent.iter().find(|r| r.0 == step).map_or_else(|| Arc::new([]) as _, |r| r.1.clone());
        let mut recent: Vec<_> = self.recent.iter().filter(|r| r.0 <= step && !r.1.is_empty()).collect();
        recent.sort_unstable_by_key(|r| std::cmp::Reverse(r.0));
        recent.retain(|r| r.0 + RECENT > step);
        let changed = std::array::from_fn(|k| recent.get(k).map_or_else(|| Arc::new([]) as _, |r| r.1.clone()));
        let event = self.history.event(step)?;
        let so_far: Vec<(u64, Event)> = match &selecting.base {
            Some(base) => (base.step..).zip(self.history.events(base.step, step)?).collect(),
            None => Vec::new(),
        };
        let is_rolled_back = |told: &(u64, Event)| told.1.kind() == EventKind::RolledBack;
        let attempts = if so_far.iter().any(is_rolled_back) { self.history.attempts()? } else { Vec::new() };
        let last_quad = self.last_quad(step)?;
        let state = self.history.state();
        let table = &selecting.table;
        let rows: Vec<Row> = table.in_order().into_iter().map(|place| table.rows[place]).collect();
        let base = selecting.base.and_then(|base| selecting.explain(state, base.a, base.b));
        let changes = self.since.take();
        self.qualities.follow(&state.mesh, &changes);
        self.unchecked |= std::mem::take(&mut self.was_broken) || changes == Changes::Everything;
        let found = match &changes {
            Changes::Everything => Ok(()),
            Changes::Some { nodes, elements } => state.mesh.check_around(nodes, elements),
        };
        let about = match (&event, &looked_at) {
            (Some(event), Some(before)) => explain::about(event, before, state),
            _ => Vec::new(),
        };
        let (candidates, narrow) = looked_at.map_or((None, None), |before| (before.candidates, before.narrow));
        let odd = table.loops.iter().position(|ring| self.even && !ring.segments.is_multiple_of(2));
        let odd = odd.map(|k| format!("loop {} of the front is odd, with {} segments", k + 1, table.loops[k].segments));
        let verdict = match found.err().or(odd) {
            Some(what) => {
                self.was_broken = true;
                Verdict::Broken(what)
            }
            None if self.unchecked => Verdict::Looking,
            None => Verdict::Holds,
        };
        Ok(Moment {
            step,
            standing: state.standing(),
            phase: state.phase().plain(),
            event,
            // A step that is told with its base has that under way still.
            narration: match &event {
                Some(event) => explain::narration(event, state.phase().base().map(|base| [base.a, base.b])),
                None => explain::beginning(&state.mesh),
            },
            about,
            mesh: self.copies.of(&state.mesh),
            parameters: state.parameters().clone(),
            changes,
            changed,
            just_changed,
            front: rows.iter().map(segment).collect(),
            rows,
            loops: table.loops.clone(),
            candidates,
            narrow: narrow.filter(|_| event.is_some_and(|event| event.is_about_a_split())),
            worst: self.qualities.worst(),
            base,
            so_far,
            attempts,
            last_quad,
            next: explain::next(state, &selecting),
            selecting,
            verdict,
            took: since.elapsed(),
        })
    }

    /// The last quadrilateral that the front formed up to the current step, until the next base is selected.
    fn last_quad(&self, step: u64) -> Result<Option<ElementId>, Fault> {
        let state = self.history.state();
        let formed = match state.phase() {
            Phase::Select => {
                let kinds = [EventKind::Formed, EventKind::BaseSelected];
                self.history.log().last_of(step, |kind| kinds.contains(&kind))
            }
            phase => return Ok(phase.last_formed()),
        };
        let event = formed.map(|step| self.history.event(step)).transpose()?.flatten();
        Ok(match event {
            Some(Event::Formed { element, .. }) if state.mesh.has_element(element) => Some(element),
            _ => None,
        })
    }

    /// Checks the whole mesh.
    pub(super) fn check(&mut self) {
        self.unchecked = false;
        let verdict = match self.history.state().mesh.check() {
            Ok(()) => Verdict::Holds,
            Err(what) => {
                self.was_broken = true;
                Verdict::Broken(what)
            }
        };
        self.voice.say(SessionNews::Checked(self.history.step(), verdict));
    }
}
