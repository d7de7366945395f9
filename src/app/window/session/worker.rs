//! The server that owns the history of the run: it goes to the requested steps, answers questions about the current
//! state, and lends a task of its own the recorder that runs ahead.

mod arriving;
mod teaching;

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;

use web_time::Instant;

use super::{Ask, Direction, Explained, Goal, Opened, Past, SessionNews, ToldChain, Transcript, Voice};
use crate::app::tasks::{self, Post, Rest, Serve};
use crate::core::convert::{Event, Why};
use crate::core::fault::Fault;
use crate::core::lesson::Lesson;
use crate::core::mesh::{ElementId, NodeId};
use crate::core::prepare::Background;
use crate::core::progress::Cancel;
use crate::core::question::{Drawn, Series};
use crate::core::run::copies::Since;
use crate::core::run::history::BUDGET;
use crate::core::run::timeline::Tracked;
use crate::core::run::{
    Condition, Copies, Edit, History, Recorder, Run, Sample, Stretch, Watched, WorstQuality, breakpoint,
};

/// How many steps the recorder does before it hands them over, least and most: few at first, since the window may be
/// waiting.
const STRETCH: [u64; 2] = [64, 8192];
/// How many steps back to look for changes.
const RECENT: u64 = 12;
/// How many touches to report.
const TOUCHES: usize = 40;

/// Where to stop: where a condition holds, or where something that is watched is touched.
#[derive(Clone, Debug, Default)]
pub struct Stops {
    pub conditions: Vec<Condition>,
    pub watched: Vec<Watched>,
}

/// Where to go.
enum Aim {
    /// One goal after the other.
    Goals(Vec<Goal>),
    Break(Stops, Direction),
    /// Where a part of a lesson stands.
    Part(Arc<Lesson>, usize),
    /// Where a question is asked.
    Question(Drawn),
    /// The first state from a step on at which something can be asked.
    NextQuestion(u64),
}

/// An aim that is not reached yet.
struct Pending {
    aim: Aim,
    /// How many requests it answers.
    asks: usize,
    /// The time of the request.
    since: Instant,
}

/// What owns the history.
pub(super) struct Worker {
    history: History,
    own: Post<Ask>,
    voice: Voice,
    stop: Arc<AtomicBool>,
    /// Where to go as soon as the step is known.
    pending: Option<Pending>,
    /// The series to draw as soon as the whole run is recorded.
    series: Option<Series>,
    conditions: Vec<Condition>,
    /// Ends the work of the recorder.
    cancel: Cancel,
    /// How many steps have been reported to the window.
    tracked: u64,
    triangles: u64,
    copies: Copies,
    /// The changes since the last moment that was reported.
    since: Since,
    /// The qualities in that moment.
    qualities: WorstQuality,
    /// The changes of recent steps, by step.
    recent: VecDeque<(u64, Arc<[ElementId]>)>,
    /// Whether the whole mesh is still to be checked.
    unchecked: bool,
    /// Whether an invariant was broken in the moment before: then a check around the changes is not enough.
    was_broken: bool,
    /// Whether the loops of the front at step 0 are even.
    even: bool,
}

impl Serve<Ask> for Worker {
    fn hear(&mut self, ask: Ask, _: &Receiver<Ask>) -> ControlFlow<()> {
        match ask {
            Ask::Gone => {
                self.cancel.ask();
                return ControlFlow::Break(());
            }
            Ask::Go(goal, since) => self.go(Aim::Goals(vec![goal]), since),
            Ask::Break(stops, direction) => self.go(Aim::Break(stops, direction), Instant::now()),
            Ask::Touch(watched) => {
                self.go_back(self.history.last_touch(watched), "Nothing has touched it before this step.");
            }
            Ask::Made(element) => self.go_back(self.history.made(element), "It exists from the beginning."),
            Ask::Past(watched) => self.past(watched),
            Ask::Chain(element) => self.chain(element),
            Ask::Transcript(from, until) => {
                let told = self.history.transcript(from, until).map(|sentences| Transcript { from, sentences });
                self.report(told.map(|told| SessionNews::Transcript(Arc::new(told))), 0);
            }
            Ask::Ended(watched) => {
                let step = self.history.step();
                let ended = self.history.ended(watched);
                self.report(ended.map(|ended| SessionNews::Ended(step, watched, ended)), 0);
            }
            Ask::Count(conditions) => {
                self.conditions = conditions;
                self.count();
            }
            Ask::Explain([a, b]) => self.explain(a, b),
            Ask::Part(lesson, part) => self.go(Aim::Part(lesson, part), Instant::now()),
            Ask::Question(drawn) => self.go(Aim::Question(drawn), Instant::now()),
            Ask::NextQuestion(from) => self.go(Aim::NextQuestion(from), Instant::now()),
            Ask::Draw(series) => self.series = Some(series),
            Ask::Judge(asked, answer) => self.judge(&asked, answer),
            Ask::Decisions => self.decisions(),
            Ask::Edits(edits) => self.edit(edits),
            Ask::Found(found) => self.found(found.0, found.1),
        }
        if self.stop.swap(false, Ordering::Relaxed)
            && let Some(pending) = self.pending.take()
        {
            // The steps up to here are known.
            let aim = Aim::Goals(vec![Goal::Step(self.history.log().known())]);
            self.pending = Some(Pending { aim, ..pending });
        }
        self.arrive();
        self.draw();
        ControlFlow::Continue(())
    }

    /// Checks of the whole mesh wait until there are no requests.
    fn rest(&mut self) -> Rest {
        if !self.unchecked {
            return Rest::Asleep;
        }
        self.check();
        Rest::Busy
    }
}

impl Worker {
    pub(super) fn open(
        make: impl FnOnce(&mut Voice) -> Result<(Run, Arc<Background>), Fault>,
        own: Post<Ask>,
        mut voice: Voice,
        stop: Arc<AtomicBool>,
    ) -> Result<Worker, (Voice, Box<Fault>)> {
        let made = make(&mut voice).and_then(|(run, background)| {
            let history = History::of(run, &background, BUDGET)?;
            Ok((background, history))
        });
        let (background, history) = match made {
            Ok(made) => made,
            Err(fault) => return Err((voice, Box::new(fault))),
        };
        let triangles = background.mesh.element_count() as u64;
        voice.say(SessionNews::Opened(Arc::new(Opened { run: history.run().clone(), background })));
        let even = history.log().front(0).odd == 0;
        Ok(Worker {
            history,
            own,
            voice,
            stop,
            pending: Some(Pending { aim: Aim::Goals(vec![Goal::Step(0)]), asks: 1, since: Instant::now() }),
            series: None,
            conditions: Vec::new(),
            cancel: Cancel::new(),
            tracked: 0,
            triangles,
            copies: Copies::default(),
            since: Since::everything(),
            qualities: WorstQuality::default(),
            recent: VecDeque::new(),
            unchecked: true,
            was_broken: false,
            even,
        })
    }

    /// Begins to record, and goes to the first state.
    pub(super) fn begin(&mut self) {
        self.lend(STRETCH[0]);
        self.arrive();
    }

    /// A goal follows one that still waits if it is relative, so that every key press counts; otherwise it replaces it.
    /// The arrival answers both requests.
    fn go(&mut self, aim: Aim, since: Instant) {
        let (mut aim, mut asks) = (aim, 1);
        if let Some(pending) = self.pending.take() {
            asks += pending.asks;
            let is_relative = matches!(&aim, Aim::Goals(goals) if goals.iter().all(|goal| goal.is_relative()));
            if is_relative && matches!(pending.aim, Aim::Part(..) | Aim::Question(_) | Aim::NextQuestion(_)) {
                // What is told and asked comes first.
                self.pending = Some(Pending { asks, ..pending });
                return;
            }
            if let (Aim::Goals(before), Aim::Goals(goals)) = (pending.aim, &mut aim)
                && let [goal] = goals[..]
                && goal.is_relative()
            {
                *goals = before;
                goal.follow(goals);
            }
        }
        self.pending = Some(Pending { aim, asks, since });
    }

    fn go_back(&mut self, found: Result<Option<u64>, Fault>, nothing: &'static str) {
        match found {
            Ok(Some(step)) => self.go(Aim::Goals(vec![Goal::Step(step)]), Instant::now()),
            Ok(None) => self.voice.say(SessionNews::Nothing(nothing, 1)),
            Err(fault) => self.voice.say(SessionNews::Fault(fault, 1)),
        }
    }

    fn past(&self, watched: Watched) {
        let told = || -> Result<Past, Fault> {
            let history = &self.history;
            let mut steps = history.touches(watched, TOUCHES + 1)?;
            let more = steps.len() > TOUCHES;
            steps.drain(..usize::from(more));
            let mut touches = Vec::new();
            for step in steps {
                touches.extend(history.event(step)?.map(|event| (step, event)));
            }
            let (mut made, mut killed) = (None, None);
            match watched {
                Watched::Element(element) => {
                    if let Some(step) = history.made(element)? {
                        made = Some((step, history.merged(step)?));
                    }
                }
                Watched::Edge(a, b) => killed = history.killed(a, b)?,
                Watched::Node(_) => {}
            }
            Ok(Past { step: history.step(), watched, touches, more, made, killed })
        };
        self.report(told().map(|past| SessionNews::Past(Arc::new(past))), 0);
    }

    fn chain(&self, element: ElementId) {
        let step = self.history.step();
        let told = self.history.chain(element).map(|chain| ToldChain { step, element, chain });
        self.report(told.map(|told| SessionNews::Chain(Arc::new(told))), 0);
    }

    /// Reports an answer, or the fault instead, to so many requests.
    fn report(&self, answer: Result<SessionNews, Fault>, asks: usize) {
        self.voice.say(answer.unwrap_or_else(|fault| SessionNews::Fault(fault, asks)));
    }

    fn explain(&mut self, a: NodeId, b: NodeId) {
        // Known from the report of the current state, unless no quadrilateral is under way.
        let selecting = match self.history.selecting() {
            Ok(selecting) => selecting,
            Err(fault) => return self.voice.say(SessionNews::Fault(fault, 0)),
        };
        let Some(told) = selecting.explain(self.history.state(), a, b) else { return };
        let deferred = if told.row.is_deferred { self.deferred(a, b) } else { None };
        self.voice.say(SessionNews::Explained(self.history.step(), Arc::new(Explained { told, deferred })));
    }

    /// The last step that put a segment off, with the reason of its last failure, as far as events are kept.
    fn deferred(&self, a: NodeId, b: NodeId) -> Option<(u64, Option<Why>)> {
        let log = self.history.log();
        let deferred = Event::Deferred { a, b };
        let step = (1..=self.history.step()).rev().find(|step| log.event(*step) == Some(&deferred))?;
        let why = match log.event(step - 1) {
            Some(Event::RolledBack { why, .. }) => Some(*why),
            _ => None,
        };
        Some((step, why))
    }

    /// Finds the steps of the recorded events at which the conditions hold.
    fn count(&self) {
        let log = self.history.log();
        let mut hits = vec![Vec::new(); self.conditions.len()];
        for step in (1..=log.known()).filter(|_| !self.conditions.is_empty()) {
            let Some(event) = log.event(step) else { continue };
            let moment = breakpoint::StepFacts {
                step,
                nq: log.nq(step),
                event,
                front: log.front(step),
                angles: log.angles(step),
            };
            for (hit, condition) in hits.iter_mut().zip(&self.conditions) {
                if condition.holds(&moment) {
                    hit.push(step);
                }
            }
        }
        self.voice.say(SessionNews::Hits(hits));
    }

    fn edit(&mut self, edits: Vec<Edit>) {
        self.cancel.ask();
        self.cancel = Cancel::new();
        let step = self.history.step();
        let before = self.history.run().edits();
        let same = before.iter().zip(&edits).take_while(|(a, b)| a == b).count();
        let first = [before.get(same), edits.get(same)].into_iter().flatten().map(|edit| edit.step).min();
        if let Err(fault) = self.history.set_edits(edits) {
            return self.voice.say(SessionNews::Fault(fault, 1));
        }
        self.tracked = self.tracked.min(first.unwrap_or(u64::MAX)).min(self.history.log().known());
        self.recent.clear();
        self.tell_track();
        self.lend(STRETCH[0]);
        self.go(Aim::Goals(vec![Goal::Step(step)]), Instant::now());
        self.count();
    }

    /// Has the recorder run ahead for some steps.
    fn lend(&mut self, steps: u64) {
        let Some(mut recorder) = self.history.lend() else { return };
        let (own, cancel) = (self.own.clone(), self.cancel.clone());
        tasks::work(move || {
            let stretch = recorder.run(steps, &cancel);
            own.send(Ask::Found(Box::new((stretch, recorder))));
        });
    }

    fn found(&mut self, stretch: Stretch, recorder: Recorder) {
        self.history.accept(stretch);
        if let Err(fault) = self.history.take_back(recorder) {
            return self.voice.say(SessionNews::Fault(fault, 0));
        }
        self.tell_track();
        if self.history.end().is_some() && !self.conditions.is_empty() {
            self.count();
        }
        self.lend(self.history.log().known().clamp(STRETCH[0], STRETCH[1]));
    }

    fn tell_track(&mut self) {
        let log = self.history.log();
        let end = self.history.end().is_some();
        let steps = (self.tracked + 1..=log.known()).filter_map(|step| Tracked::of(log, step));
        // The first sample is that of step 0.
        let fresh = |sample: &&Sample| sample.step > self.tracked || self.tracked == 0;
        let samples = log.samples().iter().filter(fresh).copied().collect();
        let told = SessionNews::Track {
            from: self.tracked,
            steps: steps.collect(),
            samples,
            born: log.born().after(self.tracked),
            change_log: log.changes().clone(),
            end,
        };
        self.tracked = log.known();
        self.voice.say(told);
    }

    /// Goes to the requested step, if it is known by now.
    fn arrive(&mut self) {
        let Some(Pending { aim, asks, since }) = self.pending.take() else { return };
        let end = self.history.end();
        let found = match &aim {
            Aim::Goals(goals) => {
                let log = self.history.log();
                let step = goals.iter().try_fold(self.history.step(), |step, goal| goal.resolve(log, step, end));
                step.map(|step| (step, None))
            }
            Aim::Break(stops, direction) => match self.stop_at(stops, *direction) {
                Ok(None) if end.is_some() || *direction == Direction::Back => {
                    return self.voice.say(SessionNews::Nothing("No breakpoint is hit in that direction.", asks));
                }
                Ok(found) => found,
                Err(fault) => return self.voice.say(SessionNews::Fault(fault, asks)),
            },
            Aim::Part(..) | Aim::Question(_) | Aim::NextQuestion(_) => match self.teach(&aim) {
                Ok(found) => found.map(|step| (step, None)),
                Err(fault) => return self.voice.say(SessionNews::Fault(fault, asks)),
            },
        };
        let Some((step, watched)) = found else {
            self.pending = Some(Pending { aim, asks, since });
            let words = "Converting: quad";
            return self.voice.progress(words, self.history.log().nq(u64::MAX), self.triangles / 2);
        };
        let moment = self.moment(step, since);
        let has_arrived = moment.is_ok();
        self.report(moment.map(|moment| SessionNews::Moment(Arc::new(moment), asks)), asks);
        if has_arrived && matches!(aim, Aim::Break(..)) {
            self.voice.say(SessionNews::Stopped(watched));
        }
    }

    /// The nearest step at which a breakpoint is met or something that is watched is touched, with the latter.
    fn stop_at(&mut self, stops: &Stops, direction: Direction) -> Result<Option<(u64, Option<Watched>)>, Fault> {
        let mut found = Vec::new();
        if !stops.conditions.is_empty() {
            let met = match direction {
                Direction::Forward => self.history.next_break(&stops.conditions)?,
                Direction::Back => self.history.previous_break(&stops.conditions)?,
            };
            found.extend(met.map(|met| (met.0, None)));
        }
        for &watched in &stops.watched {
            let touched = match direction {
                Direction::Forward => self.history.next_touch(watched)?,
                Direction::Back => self.history.last_touch(watched)?,
            };
            found.extend(touched.map(|step| (step, Some(watched))));
        }
        Ok(match direction {
            Direction::Forward => found.into_iter().min_by_key(|stop| stop.0),
            Direction::Back => found.into_iter().max_by_key(|stop| stop.0),
        })
    }
}
