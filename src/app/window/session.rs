//! The run at work, on threads of its own: the window asks for a state and is told when it is there, so that it never waits.
//!
//! One thread has the history and goes where it is asked to; another runs ahead with the history's recorder and hands over
//! what it found. A goal that lies beyond what is known waits until that thread has come so far, or until it is stopped.

mod goal;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

pub use goal::Goal;

use crate::core::convert::candidates::Candidates;
use crate::core::convert::conversion::Background;
use crate::core::convert::event::Event;
use crate::core::convert::parameters::Parameters;
use crate::core::convert::phase::Phase;
use crate::core::convert::walk::standing;
use crate::core::fault::Fault;
use crate::core::front::segment::Segment;
use crate::core::io::case::Case;
use crate::core::mesh::half_edge::Mesh;
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::progress::{Stage, Watch};
use crate::core::run::breakpoint::{self, Condition};
use crate::core::run::explain::SegmentTold;
use crate::core::run::front_table::{FrontTable, Loop, Row};
use crate::core::run::history::{BUDGET, Changes, History};
use crate::core::run::recorder::{Recorder, Stretch};
use crate::core::run::run::{Edit, Run};
use crate::core::run::watch::Watched;

/// How often progress is told.
const EVERY: Duration = Duration::from_millis(50);
/// Steps that the recorder does before it hands them over: few at first, since somebody may be waiting.
const STRETCH: [u64; 2] = [64, 8192];

/// What is asked of a session, by the window or by its own recorder.
enum Ask {
    Go(Goal),
    /// To the next step at which a condition holds, or the last one before.
    Break(Vec<Condition>, bool),
    /// To the step that touched something last.
    Touch(Watched),
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
    Track { from: u64, steps: Vec<Tracked>, end: bool },
    /// How often each of the conditions holds in what is known of the run.
    Hits(Vec<usize>),
    /// Why a segment of the front was or was not chosen, at a step.
    Explained(u64, Arc<SegmentTold>),
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
    /// The quadrilateral that it formed, with its quality.
    pub formed: Option<(ElementId, f32)>,
}

/// A state of the run, for looking at.
pub struct Moment {
    pub step: u64,
    pub standing: u64,
    pub phase: Phase,
    pub event: Option<Event>,
    pub mesh: Mesh,
    pub parameters: Parameters,
    /// What the last step changed.
    pub changed: Vec<ElementId>,
    /// The front in the order in which a selection would take it.
    pub front: Vec<Segment>,
    /// The same segments with their loops, and whether they are put off.
    pub rows: Vec<Row>,
    /// The loops of the front.
    pub loops: Vec<Loop>,
    /// What the step that led here chose a side edge from.
    pub candidates: Option<Candidates>,
    /// Why the base is the base.
    pub base: Option<SegmentTold>,
    /// What is wrong with the mesh, where its invariants do not hold.
    pub broken: Option<String>,
}

/// A run at work.
pub struct Session {
    ask: Sender<Ask>,
    told: Receiver<Told>,
    stop: Arc<AtomicBool>,
}

/// Called from other threads when there is something to be told.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

impl Session {
    /// Starts work on a run that `read` reads.
    pub fn open(read: impl FnOnce() -> Result<Run, Fault> + Send + 'static, wake: Wake) -> Session {
        let (ask, asked) = channel();
        let (tell, told) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let voice = Voice { tell, wake, last: Instant::now() };
        let (own, flag) = (ask.clone(), stop.clone());
        std::thread::spawn(move || match Worker::open(read, own, voice, flag) {
            Ok(mut worker) => worker.serve(&asked),
            Err((voice, fault)) => voice.say(Told::Fault(fault, 1)),
        });
        Session { ask, told, stop }
    }

    /// Asks to go somewhere.
    pub fn go(&self, goal: Goal) {
        self.ask(Ask::Go(goal));
    }

    /// Asks to go to where a breakpoint is met, forward or backward.
    pub fn go_to_break(&self, conditions: Vec<Condition>, forward: bool) {
        self.ask(Ask::Break(conditions, forward));
    }

    /// Asks to go to the step that touched something last.
    pub fn go_to_touch(&self, watched: Watched) {
        self.ask(Ask::Touch(watched));
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
        let words = match stage {
            Stage::Read => "Reading",
            Stage::Divide => "Dividing the curves",
            Stage::Triangulate => "Triangulating",
            Stage::Adapt => "Adapting the triangles",
            _ => "Converting",
        };
        self.progress(words, done, total);
    }
}

/// Where to go.
#[derive(Clone)]
enum Aim {
    Goal(Goal),
    Break(Vec<Condition>, bool),
}

/// The thread that has the history.
struct Worker {
    history: History,
    own: Sender<Ask>,
    voice: Voice,
    stop: Arc<AtomicBool>,
    /// Where to go as soon as that is known, and how many asks that answers.
    pending: Option<(Aim, usize)>,
    conditions: Vec<Condition>,
    /// Tells the recorder's thread that what it does is of no use any more.
    cancel: Arc<AtomicBool>,
    /// Steps that the window has been told of.
    tracked: u64,
    triangles: u64,
}

impl Worker {
    fn open(
        read: impl FnOnce() -> Result<Run, Fault>,
        own: Sender<Ask>,
        mut voice: Voice,
        stop: Arc<AtomicBool>,
    ) -> Result<Worker, (Voice, Fault)> {
        let made = read().and_then(|run| {
            let background = run.background(&mut voice)?;
            let history = History::of(run, &background, BUDGET)?;
            Ok((background, history))
        });
        let (background, history) = match made {
            Ok(made) => made,
            Err(fault) => return Err((voice, fault)),
        };
        let triangles = background.mesh.element_count() as u64;
        voice.say(Told::Opened(Arc::new(Opened {
            case: history.run().case.clone(),
            run: history.run().clone(),
            background,
        })));
        let cancel = Arc::new(AtomicBool::new(false));
        Ok(Worker {
            history,
            own,
            voice,
            stop,
            pending: Some((Aim::Goal(Goal::Step(0)), 1)),
            conditions: Vec::new(),
            cancel,
            tracked: 0,
            triangles,
        })
    }

    fn serve(&mut self, asked: &Receiver<Ask>) {
        self.lend(STRETCH[0]);
        self.arrive();
        while let Ok(ask) = asked.recv() {
            match ask {
                Ask::Gone => break,
                Ask::Go(goal) => self.go(Aim::Goal(goal)),
                Ask::Break(conditions, forward) => self.go(Aim::Break(conditions, forward)),
                Ask::Touch(watched) => self.touch(watched),
                Ask::Count(conditions) => {
                    self.conditions = conditions;
                    self.count();
                }
                Ask::Explain([a, b]) => self.explain(a, b),
                Ask::Edits(edits) => self.edit(edits),
                Ask::Found(found) => self.found(found.0, found.1),
            }
            if self.stop.swap(false, Ordering::Relaxed)
                && let Some((_, asks)) = self.pending.take()
            {
                // Everything up to here can be looked at.
                self.pending = Some((Aim::Goal(Goal::Step(self.history.log().known())), asks));
            }
            self.arrive();
        }
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// A goal replaces one that still waits; its asker is answered with the new one's.
    fn go(&mut self, aim: Aim) {
        let before = self.pending.take().map_or(0, |pending| pending.1);
        self.pending = Some((aim, before + 1));
    }

    /// Goes to the step that touched something last before the state at hand.
    fn touch(&mut self, watched: Watched) {
        match self.history.last_touch(watched, false) {
            Ok(Some(step)) => self.go(Aim::Goal(Goal::Step(step))),
            Ok(None) => self.voice.say(Told::Nothing("Nothing has touched it before this step.", 1)),
            Err(fault) => self.voice.say(Told::Fault(fault, 1)),
        }
    }

    fn explain(&self, a: NodeId, b: NodeId) {
        let told = SegmentTold::of(self.history.state(), a, b);
        if let Some(told) = told {
            self.voice.say(Told::Explained(self.history.step(), Arc::new(told)));
        }
    }

    /// Counts how often the conditions hold, in what is known and still kept of the run.
    fn count(&self) {
        let log = self.history.log();
        let mut hits = vec![0; self.conditions.len()];
        for step in (1..=log.known()).filter(|_| !self.conditions.is_empty()) {
            let Some(event) = log.event(step) else { continue };
            let moment =
                breakpoint::Moment { step, nq: log.nq(step), event, front: log.front(step), angles: log.angles(step) };
            for (hit, condition) in hits.iter_mut().zip(&self.conditions) {
                *hit += usize::from(condition.holds(&moment));
            }
        }
        self.voice.say(Told::Hits(hits));
    }

    fn edit(&mut self, edits: Vec<Edit>) {
        self.cancel.store(true, Ordering::Relaxed);
        self.cancel = Arc::new(AtomicBool::new(false));
        let step = self.history.step();
        let before = self.history.run().edits();
        let same = before.iter().zip(&edits).take_while(|(a, b)| a == b).count();
        let first = [before.get(same), edits.get(same)].into_iter().flatten().map(|edit| edit.step).min();
        if let Err(fault) = self.history.set_edits(edits) {
            return self.voice.say(Told::Fault(fault, 1));
        }
        self.tracked = self.tracked.min(first.unwrap_or(u64::MAX)).min(self.history.log().known());
        self.tell_track();
        self.lend(STRETCH[0]);
        self.go(Aim::Goal(Goal::Step(step)));
        self.count();
    }

    /// Lets another thread run ahead for a stretch.
    fn lend(&mut self, steps: u64) {
        let Some(mut recorder) = self.history.lend() else { return };
        let (own, cancel) = (self.own.clone(), self.cancel.clone());
        std::thread::spawn(move || {
            let stretch = recorder.run(steps, &cancel);
            // The session may have ended meanwhile.
            let _ = own.send(Ask::Found(Box::new((stretch, recorder))));
        });
    }

    fn found(&mut self, stretch: Stretch, recorder: Recorder) {
        self.history.accept(stretch);
        if let Err(fault) = self.history.take_back(recorder) {
            return self.voice.say(Told::Fault(fault, 0));
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
        let steps = (self.tracked + 1..=log.known()).filter_map(|step| {
            let formed = match log.event(step) {
                Some(Event::Formed { element, quality, .. }) => Some((*element, *quality as f32)),
                _ => None,
            };
            Some(Tracked {
                kind: log.kind(step)?,
                standing: log.nq(step) as u32,
                front: log.front(step).segments,
                formed,
            })
        });
        let told = Told::Track { from: self.tracked, steps: steps.collect(), end };
        self.tracked = log.known();
        self.voice.say(told);
    }

    /// Goes where it was asked to go, where that is known by now.
    fn arrive(&mut self) {
        let Some((aim, asks)) = self.pending.clone() else { return };
        let end = self.history.end();
        let found = match &aim {
            Aim::Goal(goal) => goal.resolve(self.history.log(), self.history.step(), end),
            Aim::Break(conditions, forward) => {
                let met = match forward {
                    true => self.history.next_break(conditions),
                    false => self.history.previous_break(conditions),
                };
                match met {
                    Ok(Some((step, _))) => Some(step),
                    Ok(None) if end.is_some() || !forward => {
                        self.pending = None;
                        return self.voice.say(Told::Nothing("No breakpoint is met there.", asks));
                    }
                    Ok(None) => None,
                    Err(fault) => {
                        self.pending = None;
                        return self.voice.say(Told::Fault(fault, asks));
                    }
                }
            }
        };
        let Some(step) = found else {
            let words = "Converting: quad";
            return self.voice.progress(words, self.history.log().nq(u64::MAX), self.triangles / 2);
        };
        self.pending = None;
        match self.moment(step) {
            Ok(moment) => self.voice.say(Told::Moment(Arc::new(moment), asks)),
            Err(fault) => self.voice.say(Told::Fault(fault, asks)),
        }
    }

    fn moment(&mut self, step: u64) -> Result<Moment, Fault> {
        let step = step.min(self.history.log().known());
        // What the very last step changed is seen by doing it again.
        self.history.seek(step.saturating_sub(1))?;
        let candidates = if step > 0 { self.history.state().candidates() } else { None };
        self.history.take_changes();
        self.history.seek(step)?;
        let changed = match self.history.take_changes() {
            Changes::Some { elements, .. } => elements,
            Changes::Everything => Vec::new(),
        };
        let event = self.history.event(step)?;
        let state = self.history.state();
        let table = FrontTable::of(state);
        let rows: Vec<Row> = table.in_order().into_iter().map(|place| table.rows[place]).collect();
        let base = state.phase().base().and_then(|base| SegmentTold::in_table(state, &table, base.a, base.b));
        Ok(Moment {
            step,
            standing: standing(state),
            phase: state.phase().plain(),
            event,
            mesh: state.mesh.without_journal(),
            parameters: state.parameters().clone(),
            changed,
            front: rows.iter().map(segment).collect(),
            rows,
            loops: table.loops,
            candidates,
            base,
            broken: state.mesh.check().err(),
        })
    }
}

/// A row of the table as the renderer wants it.
fn segment(row: &Row) -> Segment {
    let Row { h, a, b, class, h_value, length_metric, length_physical, theta, level, face, .. } = *row;
    Segment { h, a, b, h_value, length_metric, length_physical, theta, class, level, face }
}

/// What a session is opened with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// A built-in case, by its name.
    BuiltIn(String),
    /// A case or a mesh in a file.
    File(PathBuf),
}
