//! The run beside the window: the window asks for a state and the session reports it, so that the window never waits.
//!
//! A server owns the history and goes to the requested steps; a task runs ahead with the history's recorder and hands
//! over its record. A goal beyond the recorded steps waits until the recorder gets there, or until it is stopped.

mod goal;
mod moment;
mod worker;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use web_time::Instant;

pub use goal::{Direction, Goal};
pub use moment::{Moment, Verdict};
pub use worker::Stops;

use super::import::ImportOptions;
use super::state::Progress;
use crate::app::memory::{self, Beside};
use crate::app::progress;
use crate::app::tasks::{self, Post};
use crate::core::convert::{Event, Why};
use crate::core::fault::Fault;
use crate::core::lesson::{Decision, Lesson, Scene};
use crate::core::mesh::{ElementId, NodeId};
use crate::core::prepare::Background;
use crate::core::progress::{Cancel, Need, Stage, Watch};
use crate::core::question::{Answer, Asked, Drawn, Hint, Judged, Series};
use crate::core::run::timeline::Tracked;
use crate::core::run::{
    Born, Chain, ChangeLog, Condition, Edit, Recorder, Run, Sample, SegmentFacts, Stretch, Watched,
};
use worker::Worker;

/// How often progress is reported.
pub(super) const EVERY: Duration = Duration::from_millis(50);

/// Requests to a session, from the window or from its own recorder.
pub enum Ask {
    /// Go to a goal, requested at this time.
    Go(Goal, Instant),
    /// Go to the next or the previous step at which a condition holds or something that is watched is touched.
    Break(Stops, Direction),
    /// Go to the step that touched something last.
    Touch(Watched),
    /// Go to the step that made the quadrilateral of an element.
    Made(ElementId),
    /// Report the history of something up to the current step.
    Past(Watched),
    /// Report the decision chain of a quadrilateral.
    Chain(ElementId),
    /// Report what the steps from one to another did, a sentence each.
    Transcript(u64, u64),
    /// Report the step that ended something.
    Ended(Watched),
    /// Count how often conditions hold.
    Count(Vec<Condition>),
    /// Report why a segment of the front was or was not chosen.
    Explain([NodeId; 2]),
    /// Go where a part of a lesson stands, and tell it.
    Part(Arc<Lesson>, usize),
    /// Go where a question is asked, and pose it.
    Question(Drawn),
    /// Go to the first state from this step on at which something can be asked, and pose that.
    NextQuestion(u64),
    /// Draw the questions of a series, once the whole run is recorded.
    Draw(Series),
    /// Judge an answer.
    Judge(Arc<Asked>, Answer),
    /// Report the decisions that led to the current state.
    Decisions,
    /// Change the run.
    Edits(Vec<Edit>),
    /// The recorder hands over what it has recorded.
    Found(Box<(Stretch, Recorder)>),
    /// The window has closed the session.
    Gone,
}

/// What a session reports.
pub enum SessionNews {
    Progress(Progress),
    /// The case is open and has its background mesh.
    Opened(Arc<Opened>),
    /// A state, with the number of requests that it answers.
    Moment(Arc<Moment>, usize),
    /// The state before this was reached because a breakpoint was met, or because this was touched.
    Stopped(Option<Watched>),
    /// More of the run: steps after `from`, which replace those known before; `end`: they include the last one.
    Track {
        from: u64,
        steps: Vec<Tracked>,
        samples: Vec<Sample>,
        born: Born,
        /// What all known steps changed.
        change_log: ChangeLog,
        end: bool,
    },
    /// The result of the checks of the whole mesh at a step.
    Checked(u64, Verdict),
    /// The history of something up to a step.
    Past(Arc<Past>),
    /// The decision chain of a quadrilateral.
    Chain(Arc<ToldChain>),
    /// What some steps did.
    Transcript(Arc<Transcript>),
    /// The step that ended something, seen from a step.
    Ended(u64, Watched, Option<u64>),
    /// The steps of the recorded part of the run at which each condition holds.
    Hits(Vec<Vec<u64>>),
    /// Why a segment of the front was or was not chosen, at a step.
    Explained(u64, Arc<Explained>),
    /// What is told and asked at the state that comes next.
    Taught(Arc<Taught>),
    /// The questions of a series.
    Drawn(Vec<Drawn>),
    /// No question can be asked from there on.
    NoQuestion,
    /// An answer to a question, judged, or why it is none.
    Judged(Arc<Asked>, Answer, Result<Judged, Fault>),
    /// The decisions that led to the state of a step.
    Decisions(u64, Vec<Decision>),
    /// There is no such step, with the number of requests that this answers.
    Nothing(&'static str, usize),
    /// Something went wrong, with the number of requests that this answers.
    Fault(Fault, usize),
}

/// A case that is open.
pub struct Opened {
    /// The run as it was opened.
    pub run: Run,
    pub background: Arc<Background>,
}

/// Why a segment was or was not chosen.
#[derive(Clone, Debug)]
pub struct Explained {
    pub told: SegmentFacts,
    /// The step that deferred it, with the reason of its last failure; none unless it is deferred.
    pub deferred: Option<(u64, Option<Why>)>,
}

/// What is told and asked at a state.
#[derive(Clone, Debug)]
pub struct Taught {
    /// The step of the state.
    pub step: u64,
    /// The part of a lesson; none where a question is asked alone.
    pub scene: Option<Scene>,
    /// The questions.
    pub posed: Vec<Posed>,
}

/// A question with its hints, the weakest first.
#[derive(Clone, Debug)]
pub struct Posed {
    pub asked: Arc<Asked>,
    /// The question in words.
    pub text: String,
    pub hints: Vec<Hint>,
}

/// What some steps did, a sentence each.
#[derive(Clone, Debug)]
pub struct Transcript {
    /// The first of them.
    pub from: u64,
    pub sentences: Vec<String>,
}

/// The history of something up to a step.
#[derive(Clone, Debug)]
pub struct Past {
    pub step: u64,
    pub watched: Watched,
    /// The last steps that touched it, the latest last, with their events.
    pub touches: Vec<(u64, Event)>,
    /// Whether there are more.
    pub more: bool,
    /// The step that made the quadrilateral, and the triangles that it merged.
    pub made: Option<(u64, Vec<ElementId>)>,
    /// The step after which the edge was no longer live on both sides.
    pub killed: Option<u64>,
}

/// The decision chain of a quadrilateral at a step.
#[derive(Clone, Debug)]
pub struct ToldChain {
    pub step: u64,
    pub element: ElementId,
    /// None for a quadrilateral that the background mesh has.
    pub chain: Option<Chain>,
}

/// A run and what works on it.
pub struct Session {
    ask: Post<Ask>,
    told: Receiver<SessionNews>,
    stop: Arc<AtomicBool>,
    /// Stops the opening.
    opening: Cancel,
}

/// Called by work beside the window when it has something to report.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

impl Session {
    /// Opens the run that `read` returns.
    pub fn open(read: impl FnOnce() -> Result<Run, Fault> + Send + 'static, wake: Wake) -> Session {
        Session::begin(
            |voice| {
                let run = read()?;
                let background = Arc::new(run.background(voice)?);
                Ok((run, background))
            },
            wake,
        )
    }

    /// Opens a run whose background mesh is known.
    pub fn fork(run: Run, background: Arc<Background>, wake: Wake) -> Session {
        Session::begin(|_| Ok((run, background)), wake)
    }

    fn begin(
        make: impl FnOnce(&mut Voice) -> Result<(Run, Arc<Background>), Fault> + Send + 'static,
        wake: Wake,
    ) -> Session {
        let (tell, told) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let opening = Cancel::new();
        let voice = Voice { tell, wake, last: Instant::now(), cancel: opening.clone() };
        let flag = stop.clone();
        let (ask, _) = tasks::serve(move |own| match Worker::open(make, own.clone(), voice, flag) {
            Ok(mut worker) => {
                worker.begin();
                Some(worker)
            }
            Err((voice, fault)) => {
                voice.say(SessionNews::Fault(*fault, 1));
                None
            }
        });
        Session { ask, told, stop, opening }
    }

    /// Asks for something.
    pub fn ask(&self, ask: Ask) {
        self.ask.send(ask);
    }

    /// Stops the work under way.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
        self.opening.ask();
    }

    /// The next report, if it comes soon.
    pub fn hear_within(&self, patience: Duration) -> Option<SessionNews> {
        tasks::hear_within(&self.told, patience)
    }

    /// What has been reported since the last call.
    pub fn hear(&self) -> impl Iterator<Item = SessionNews> + '_ {
        self.told.try_iter()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.stop();
        self.ask(Ask::Gone);
    }
}

struct Voice {
    tell: Sender<SessionNews>,
    wake: Wake,
    last: Instant,
    cancel: Cancel,
}

impl Voice {
    fn say(&self, told: SessionNews) {
        // Nobody listens any more if the window has opened something else.
        let _ = self.tell.send(told);
        (self.wake)();
    }

    fn progress(&mut self, words: &'static str, done: u64, total: u64) {
        if self.last.elapsed() >= EVERY {
            self.last = Instant::now();
            self.say(SessionNews::Progress(Progress { words, done, total }));
        }
    }
}

impl Watch for Voice {
    fn tell(&mut self, stage: Stage, done: u64, total: u64) {
        self.progress(words_of(stage), done, total);
    }

    fn cancel(&self) -> Cancel {
        self.cancel.clone()
    }

    fn allow(&mut self, need: &Need) -> Result<(), Fault> {
        memory::allow(need, Beside::States(1))
    }
}

/// The name of a stage of the work in the window.
pub(super) fn words_of(stage: Stage) -> &'static str {
    // The later stages are parts of the conversion here.
    progress::words(stage.min(Stage::Convert))
}

/// What a session is opened with.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A built-in case, by its name.
    BuiltIn(String),
    /// A case, a run or a figure in a file; or a mesh, which the window shows before it is converted.
    File(PathBuf),
    /// A mesh, imported with these options.
    Mesh(PathBuf, ImportOptions),
    /// A lesson: one of the tour by its name, or a file by its path.
    Lesson(String),
    /// A run that came with a link, as the text of a run file.
    Linked(String),
}
