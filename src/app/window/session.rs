//! The run at work, on threads of its own: the window asks for a state and is told when it is there, so that it never waits.
//!
//! One thread has the history and goes where it is asked to; another runs ahead with the history's recorder and hands over
//! what it found. A goal that lies beyond what is known waits until that thread has come so far, or until it is stopped.

mod goal;
mod moment;
mod worker;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

pub use goal::Goal;
pub use moment::{Moment, Verdict};
pub use worker::Stops;

use crate::app::command_line::MeshOptions;
use crate::core::case::Case;
use crate::core::convert::event::{Event, Why};
use crate::core::fault::Fault;
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::prepare::Background;
use crate::core::progress::{Cancel, Stage, Watch};
use crate::core::run::breakpoint::Condition;
use crate::core::run::explain::SegmentTold;
use crate::core::run::recorder::{Recorder, Stretch};
use crate::core::run::run::{Edit, Run};
use crate::core::run::sample::Sample;
use crate::core::run::watch::Watched;
use worker::Worker;

/// How often progress is told.
pub(super) const EVERY: Duration = Duration::from_millis(50);

/// What is asked of a session, by the window or by its own recorder.
enum Ask {
    /// To a goal; asked then.
    Go(Goal, Instant),
    /// To the next step at which a condition holds or something that is watched is touched, or the last one before.
    Break(Stops, bool),
    /// To the step that touched something last.
    Touch(Watched),
    /// To the step that made the quadrilateral of an element.
    Made(ElementId),
    /// What became of something up to the state at hand.
    Past(Watched),
    /// How often conditions hold.
    Count(Vec<Condition>),
    Explain([NodeId; 2]),
    Edits(Vec<Edit>),
    Found(Box<(Stretch, Recorder)>),
    Gone,
}

/// What a session tells.
pub enum Told {
    /// How far the work is: what is done, of how much (0: unknown).
    Progress { words: &'static str, done: u64, total: u64 },
    /// The case stands with its background mesh.
    Opened(Arc<Opened>),
    /// A state is there; so many asks are answered by it.
    Moment(Arc<Moment>, usize),
    /// More of the run: steps after `from`, in place of what was known after it; whether the end is among them.
    Track { from: u64, steps: Vec<Tracked>, samples: Vec<Sample>, end: bool },
    /// What the checks of the whole mesh found at a step.
    Checked(u64, Verdict),
    /// What became of something up to a step.
    Past(Arc<Past>),
    /// How often each of the conditions holds in what is known of the run.
    Hits(Vec<usize>),
    /// Why a segment of the front was or was not chosen, at a step.
    Explained(u64, Arc<Explained>),
    /// There is nothing of what was asked for; so many asks are answered by that.
    Nothing(&'static str, usize),
    /// Something went wrong; so many asks are answered by that.
    Fault(Fault, usize),
}

/// A case that stands.
pub struct Opened {
    pub case: Case,
    /// The run as it was opened.
    pub run: Run,
    pub background: Background,
}

/// What is kept of each step of the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracked {
    /// What the step did.
    pub kind: &'static str,
    /// Quadrilaterals that stand after it.
    pub standing: u32,
    /// Segments of the front after it.
    pub front: u32,
    /// Loops of the front, and how many of them are odd.
    pub loops: [u16; 2],
    /// Live triangles after it.
    pub live: u32,
    /// The quadrilateral that it formed, with its quality.
    pub formed: Option<(ElementId, f32)>,
}

/// Why a segment was or was not chosen.
#[derive(Clone, Debug)]
pub struct Explained {
    pub told: SegmentTold,
    /// The step that put it off, with what spoke against its last attempt; where it is put off.
    pub put_off: Option<(u64, Option<Why>)>,
}

/// What became of something up to a step.
#[derive(Clone, Debug)]
pub struct Past {
    pub step: u64,
    pub watched: Watched,
    /// The last steps that touched it, the newest last, with what they did.
    pub touches: Vec<(u64, Event)>,
    /// Whether there are more.
    pub more: bool,
    /// The step that made the quadrilateral, and the triangles that it ate.
    pub made: Option<(u64, Vec<ElementId>)>,
    /// The step that killed the edge.
    pub killed: Option<u64>,
}

/// A run at work.
pub struct Session {
    ask: Sender<Ask>,
    told: Receiver<Told>,
    stop: Arc<AtomicBool>,
    /// Ends the opening.
    opening: Cancel,
}

/// Called from other threads when there is something to be told.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

impl Session {
    /// Starts work on a run that `read` reads.
    pub fn open(read: impl FnOnce() -> Result<Run, Fault> + Send + 'static, wake: Wake) -> Session {
        let (ask, asked) = channel();
        let (tell, told) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let opening = Cancel::new();
        let voice = Voice { tell, wake, last: Instant::now(), cancel: opening.clone() };
        let (own, flag) = (ask.clone(), stop.clone());
        std::thread::spawn(move || match Worker::open(read, own, voice, flag) {
            Ok(mut worker) => worker.serve(&asked),
            Err((voice, fault)) => voice.say(Told::Fault(*fault, 1)),
        });
        Session { ask, told, stop, opening }
    }

    /// Asks to go somewhere.
    pub fn go(&self, goal: Goal) {
        self.ask(Ask::Go(goal, Instant::now()));
    }

    /// Asks to go to where a breakpoint is met, forward or backward.
    pub fn go_to_break(&self, stops: Stops, forward: bool) {
        self.ask(Ask::Break(stops, forward));
    }

    /// Asks to go to the step that touched something last.
    pub fn go_to_touch(&self, watched: Watched) {
        self.ask(Ask::Touch(watched));
    }

    /// Asks to go to the step that made the quadrilateral of an element.
    pub fn go_to_making(&self, element: ElementId) {
        self.ask(Ask::Made(element));
    }

    /// Asks what became of something up to the state at hand.
    pub fn past(&self, watched: Watched) {
        self.ask(Ask::Past(watched));
    }

    /// Asks how often conditions hold.
    pub fn count(&self, conditions: Vec<Condition>) {
        self.ask(Ask::Count(conditions));
    }

    /// Asks why a segment of the front was or was not chosen.
    pub fn explain(&self, ends: [NodeId; 2]) {
        self.ask(Ask::Explain(ends));
    }

    /// Changes the run.
    pub fn set_edits(&self, edits: Vec<Edit>) {
        self.ask(Ask::Edits(edits));
    }

    fn ask(&self, ask: Ask) {
        // A session that has ended has told why.
        let _ = self.ask.send(ask);
    }

    /// Stops what is under way, where it is.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
        self.opening.ask();
    }

    /// What is told next, where that comes soon.
    pub fn hear_within(&self, patience: Duration) -> Option<Told> {
        self.told.recv_timeout(patience).ok()
    }

    /// What has been told since the last time.
    pub fn hear(&self) -> impl Iterator<Item = Told> + '_ {
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
    tell: Sender<Told>,
    wake: Wake,
    last: Instant,
    cancel: Cancel,
}

impl Voice {
    fn say(&self, told: Told) {
        // Nobody listens any more: the window has opened something else.
        let _ = self.tell.send(told);
        (self.wake)();
    }

    fn progress(&mut self, words: &'static str, done: u64, total: u64) {
        if self.last.elapsed() >= EVERY {
            self.last = Instant::now();
            self.say(Told::Progress { words, done, total });
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
}

/// What the window calls a part of the work.
pub(super) fn words_of(stage: Stage) -> &'static str {
    match stage {
        Stage::Read => "Reading",
        Stage::Repair => "Repairing the mesh",
        Stage::Chart => "Laying the surface flat",
        Stage::Divide => "Dividing the curves",
        Stage::Triangulate => "Triangulating",
        Stage::Adapt => "Adapting the triangles",
        _ => "Converting",
    }
}

/// What a session is opened with.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A built-in case, by its name.
    BuiltIn(String),
    /// A case, a run or a figure in a file; or a mesh, of which the window shows first what it is like.
    File(PathBuf),
    /// A mesh, taken as the options say.
    Mesh(PathBuf, MeshOptions),
}
