//! What the session tells, and what it is asked for when a panel wants to know it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::{Progress, State};
use crate::app::window::session::{Explained, Moment, Past, Told};
use crate::core::convert::phase::Phase;
use crate::core::mesh::ids::NodeId;
use crate::core::run::watch::Watched;

/// How long a frame waits for the state that it asked for.
const PATIENCE: Duration = Duration::from_millis(4);

impl State {
    /// Hears what the session has to tell.
    pub fn hear(&mut self) {
        self.hear_opening();
        let Some(session) = &self.session else { return };
        let told: Vec<Told> = session.hear().collect();
        told.into_iter().for_each(|told| self.take(told));
    }

    /// Where the session owes an answer, waits for it, but not so long that anybody notices: most states are there at
    /// once, and are seen in the very frame that asked for them.
    pub fn hear_soon(&mut self) {
        let begin = Instant::now();
        while self.waiting > 0
            && let Some(left) = PATIENCE.checked_sub(begin.elapsed())
            && let Some(told) = self.session.as_ref().and_then(|session| session.hear_within(left))
        {
            self.take(told);
        }
    }

    fn take(&mut self, told: Told) {
        match told {
            Told::Progress { words, done, total } => self.progress = Some(Progress { words, done, total }),
            Told::Opened(opened) => self.opened = Some(opened),
            Told::Moment(moment, asks) => self.arrive(moment, asks),
            Told::Track { from, steps, samples, end } => {
                self.track.truncate(from as usize);
                self.track.extend(steps);
                self.samples.retain(|sample| sample.step <= from && from > 0);
                self.samples.extend(samples);
                self.track_epoch += 1;
                self.recorded = end;
            }
            Told::Checked(step, verdict) => {
                if self.moment.as_ref().is_some_and(|moment| moment.step == step) {
                    self.verdict = verdict;
                }
            }
            Told::Past(past) => self.past = Some(past),
            Told::Hits(hits) => self.hits = hits,
            Told::Explained(step, told) => self.explained = Some((step, told)),
            Told::Nothing(words, asks) => {
                self.notice(words.to_owned());
                self.answered(asks);
            }
            Told::Fault(fault, asks) => {
                self.complain(&fault);
                self.answered(asks);
                self.playing = None;
            }
        }
    }

    pub(super) fn answered(&mut self, asks: usize) {
        self.waiting = self.waiting.saturating_sub(asks);
        if self.waiting == 0 {
            (self.progress, self.since) = (None, None);
        }
    }

    fn arrive(&mut self, moment: Arc<Moment>, asks: usize) {
        if self.playing.is_some() && moment.phase == Phase::Done {
            self.playing = None;
        }
        self.changes.note(&moment.changes, moment.mesh.element_slots());
        self.verdict = moment.verdict.clone();
        self.times.state(moment.took);
        self.lit.clear();
        self.moment = Some(moment.clone());
        self.answered(asks);
        self.compare(&moment);
        self.over_epoch += 1;
    }

    /// Why a segment of the front was or was not chosen; asked for where it is not known yet.
    pub fn explanation(&mut self, ends: [NodeId; 2]) -> Option<Arc<Explained>> {
        let step = self.moment.as_ref()?.step;
        if let Some((at, told)) = &self.explained
            && (*at, [told.told.row.a, told.told.row.b]) == (step, ends)
        {
            return Some(told.clone());
        }
        if self.asked != Some((step, ends)) {
            self.asked = Some((step, ends));
            self.session.as_ref()?.explain(ends);
        }
        None
    }

    /// What became of something up to the step at hand; asked for where it is not known yet and nothing else is under
    /// way.
    pub fn past(&mut self, watched: Watched) -> Option<Arc<Past>> {
        let step = self.moment.as_ref()?.step;
        if let Some(past) = &self.past
            && (past.step, past.watched) == (step, watched)
        {
            return Some(past.clone());
        }
        if self.asked_past != Some((step, watched)) && !self.is_busy() && self.playing.is_none() {
            self.asked_past = Some((step, watched));
            self.session.as_ref()?.past(watched);
        }
        None
    }
}
