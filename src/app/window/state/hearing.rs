//! Takes in what worker threads report. With `apply` this is the only place that changes [`State`].

mod files;
mod linking;
mod opening;
mod pair;
mod stopping;
mod studying;

use std::sync::Arc;
use std::time::Duration;

use web_time::Instant;

use super::{Look, State};
use crate::app::figure::another_state;
use crate::app::tasks;
use crate::app::window::film::FilmWork;
use crate::app::window::reducing::Reducing;
use crate::app::window::session::{Moment, SessionNews, Source};
use crate::app::window::sweep::SweepWork;
use crate::core::convert::Phase;
use crate::core::run::shown::fingerprint;
use crate::core::run::{Changes, ShownState};

/// How long a frame waits for the state that it asked for.
const PATIENCE: Duration = Duration::from_millis(4);

impl State {
    /// Takes in what the session reports.
    pub(in crate::app::window) fn hear(&mut self) {
        self.hear_alone();
        self.hear_second();
        if let Some(fault) = self.reducing.as_mut().and_then(Reducing::hear) {
            self.complain(&fault);
        }
        match self.film.as_mut().and_then(FilmWork::hear) {
            Some(Ok(notice)) => self.notice(notice),
            Some(Err(fault)) => self.complain(&fault),
            None => {}
        }
        if let Some(fault) = self.sweep.as_mut().and_then(SweepWork::hear) {
            self.complain(&fault);
        }
    }

    fn hear_alone(&mut self) {
        self.hear_opening();
        self.run.lists.hear();
        let Some(session) = &self.run.session else { return };
        let told: Vec<SessionNews> = session.hear().collect();
        told.into_iter().for_each(|told| self.take(told));
        self.release();
    }

    /// If the session owes an answer, waits for it, but not so long that anybody notices: most states are ready at
    /// once, and are seen in the very frame that asked for them.
    pub(in crate::app::window) fn hear_soon(&mut self) {
        let begin = Instant::now();
        self.hear_until(begin);
        if self.pair.is_some() {
            // Both runs are seen in one frame.
            self.hear_second();
            if let Some(pair) = &mut self.pair {
                pair.other.hear_until(begin);
            }
            self.hear_second();
        }
        // What comes of the answer is seen in this frame too: in a page that draws by software each one is slow.
        if tasks::give_turns(PATIENCE) {
            self.hear();
        }
    }

    fn hear_until(&mut self, begin: Instant) {
        while self.run.waiting > 0
            && let Some(left) = PATIENCE.checked_sub(begin.elapsed())
            && let Some(told) = self.run.session.as_ref().and_then(|session| session.hear_within(left))
        {
            self.take(told);
        }
        self.release();
    }

    /// For each run the differences between the current state and the one at the last call, and how many slots for
    /// elements it has.
    pub(in crate::app::window) fn take_changes(&mut self) -> [Option<(Changes, usize)>; 2] {
        let second = self.pair.as_mut().and_then(|pair| pair.other.take_changes_alone());
        [self.take_changes_alone(), second]
    }

    fn take_changes_alone(&mut self) -> Option<(Changes, usize)> {
        let slots = self.run.moment.as_ref()?.mesh.element_slots();
        Some((self.run.changes.take(), slots))
    }

    fn take(&mut self, told: SessionNews) {
        let run = &mut self.run;
        match told {
            SessionNews::Progress(progress) => run.progress = Some(progress),
            SessionNews::Opened(opened) => run.opened = Some(opened),
            SessionNews::Moment(moment, asks) => self.arrive(moment, asks),
            SessionNews::Stopped(watched) => {
                let subject = run.moment.as_ref().and_then(|moment| stopping::subject(moment, watched));
                if let Some(before) = subject.and_then(|subject| self.workspace.come_upon(subject)) {
                    self.follow(&before);
                }
            }
            SessionNews::Track { from, steps, samples, born, change_log, end } => {
                run.track.truncate(from as usize);
                run.track.extend(steps);
                run.samples.retain(|sample| sample.step <= from && from > 0);
                run.samples.extend(samples);
                run.born.truncate(from);
                run.born.append(&born);
                run.change_log = change_log;
                run.track_epoch += 1;
                run.forget_transcript_after(from);
                run.recorded = end;
            }
            SessionNews::Checked(step, verdict) => {
                if run.moment.as_ref().is_some_and(|moment| moment.step == step) {
                    run.verdict = verdict;
                }
            }
            SessionNews::Past(past) => run.past = Some(past),
            SessionNews::Transcript(told) => run.transcript = Some(told),
            SessionNews::Ended(step, watched, ended) => {
                let missing = run.missing.as_mut();
                if let Some(missing) = missing.filter(|m| (m.step, m.sought.named()) == (step, Some(watched))) {
                    missing.ended = ended;
                }
            }
            SessionNews::Chain(told) => {
                let wanted = run.to_loss.take_if(|wanted| *wanted == told.element);
                run.chain = Some(told);
                if wanted.is_some() {
                    self.seek_largest_loss();
                }
            }
            SessionNews::Hits(hits) => run.hits = hits,
            SessionNews::Taught(taught) => self.be_taught(taught),
            SessionNews::Drawn(drawn) => self.be_asked(drawn),
            SessionNews::NoQuestion => self.end_questions(),
            SessionNews::Judged(asked, answer, judged) => self.be_judged(&asked, answer, judged),
            SessionNews::Decisions(step, decisions) => {
                if let Some(study) = &mut self.study {
                    study.decisions = Some((step, decisions));
                }
            }
            SessionNews::Explained(step, told) => run.explained = Some((step, told)),
            SessionNews::Nothing(words, asks) => {
                self.notice(words.to_owned());
                self.answered(asks);
            }
            SessionNews::Fault(fault, asks) => {
                run.playing = None;
                self.complain(&fault);
                self.answered(asks);
            }
        }
    }

    fn answered(&mut self, asks: usize) {
        self.run.waiting = self.run.waiting.saturating_sub(asks);
        if self.run.waiting == 0 {
            (self.run.progress, self.run.since) = (None, None);
        }
    }

    fn arrive(&mut self, moment: Arc<Moment>, asks: usize) {
        let run = &mut self.run;
        if run.playing.is_some() && moment.phase == Phase::Done {
            run.playing = None;
        }
        run.changes.note(&moment.changes, moment.mesh.element_slots());
        run.lists.note(&moment.changes, &moment.mesh);
        run.verdict = moment.verdict.clone();
        run.forget_answers();
        run.moment = Some(moment.clone());
        self.view.lit.clear();
        self.view.over_epoch += 1;
        self.answered(asks);
        if let Some(what) = self.run.find_at.take_if(|at| at.0 == moment.step).map(|at| at.1) {
            if let Some(before) = self.workspace.come_upon(what) {
                self.follow(&before);
            }
            self.view.look.ask(Look::Near(what));
        }
        self.arrive_by_link(&moment);
        self.compare(&moment);
    }

    /// Says so if a figure has brought the window to another state than the one that it shows.
    fn compare(&mut self, moment: &Moment) {
        let is_there =
            |shown: &ShownState| shown.step == moment.step || shown.at.is_none() && moment.phase == Phase::Done;
        let Some(shown) = self.run.awaited.filter(|_| self.run.waiting == 0) else { return };
        self.run.awaited = None;
        if !is_there(&shown) || fingerprint(&moment.mesh, &moment.phase) != shown.state {
            let name = self.run.source.as_ref().map_or_else(String::new, Source::name);
            self.complain(&another_state(&name, shown.step));
        }
    }
}
