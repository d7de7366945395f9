//! The run at work, on threads of its own: the window asks for a state and is told when it is there, so that it never waits.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use crate::core::convert::conversion::{Background, background};
use crate::core::convert::converter::{Converter, Counts};
use crate::core::convert::event::Event;
use crate::core::convert::parameters::Parameters;
use crate::core::convert::phase::Phase;
use crate::core::convert::walk::standing;
use crate::core::fault::Fault;
use crate::core::front::segment::Segment;
use crate::core::io::case::Case;
use crate::core::mesh::half_edge::Mesh;
use crate::core::mesh::ids::ElementId;
use crate::core::progress::{Stage, Watch};
use crate::render::scene;

/// How often progress is told.
const EVERY: Duration = Duration::from_millis(50);

/// Where to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// To a step.
    Step(u64),
    /// So many steps on, or back.
    Steps(i64),
    /// So many quadrilaterals on, or back: until they stand and their local post-processing is done.
    Quads(i64),
    /// To where so many quadrilaterals stand.
    ToQuads(u64),
    /// To the next event of a kind, or the one before.
    Kind(&'static str, bool),
    /// To the end.
    End,
}

/// A parameter that a person changed: from this step on.
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    pub step: u64,
    pub key: String,
    pub value: String,
}

/// What is asked of a session.
enum Ask {
    Go(Goal),
    Edits(Vec<Edit>),
}

/// What a session tells.
pub enum Told {
    /// How far the work is: what is done, of how much (0: unknown).
    Progress { words: &'static str, done: u64, total: u64 },
    /// The case stands with its background mesh.
    Opened(Arc<Opened>),
    /// A state is there.
    Moment(Arc<Moment>),
    /// More of the run's events, from the step that is named first.
    Track { epoch: u64, from: u64, steps: Vec<Tracked> },
    /// The run has been recorded to its end.
    Recorded { epoch: u64 },
    /// Something went wrong.
    Fault(Fault),
}

/// A case that stands.
pub struct Opened {
    pub case: Case,
    pub background: Background,
}

/// What is kept of each step of the run.
#[derive(Clone, Copy, Debug)]
pub struct Tracked {
    pub event: Event,
    pub standing: u32,
    pub front: u32,
    /// Whether the local post-processing of the last quadrilateral is done.
    pub settled: bool,
}

/// A state of the run, for looking at.
pub struct Moment {
    pub step: u64,
    pub standing: u64,
    pub phase: Phase,
    pub event: Option<Event>,
    pub mesh: Mesh,
    pub parameters: Parameters,
    pub counts: Counts,
    pub changed: Vec<ElementId>,
    pub front: Vec<Segment>,
}

/// A run at work.
pub struct Session {
    ask: Sender<Ask>,
    told: Receiver<Told>,
    stop: Arc<AtomicBool>,
    gone: Arc<AtomicBool>,
}

/// Called from other threads when there is something to be told.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

impl Session {
    /// Starts work on a case that `read` reads.
    pub fn open(read: impl FnOnce() -> Result<Case, Fault> + Send + 'static, wake: Wake) -> Session {
        let (ask, asked) = channel();
        let (tell, told) = channel();
        let (stop, gone) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
        let voice = Voice { tell, wake, last: Instant::now() };
        let flags = Flags { stop: stop.clone(), gone: gone.clone() };
        std::thread::spawn(move || work(read, &asked, voice, flags));
        Session { ask, told, stop, gone }
    }

    /// Asks to go somewhere.
    pub fn go(&self, goal: Goal) {
        // A session that has ended has told why.
        let _ = self.ask.send(Ask::Go(goal));
    }

    /// Changes the run.
    pub fn set_edits(&self, edits: Vec<Edit>) {
        let _ = self.ask.send(Ask::Edits(edits));
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
        self.gone.store(true, Ordering::Relaxed);
        self.stop();
    }
}

#[derive(Clone)]
struct Flags {
    stop: Arc<AtomicBool>,
    gone: Arc<AtomicBool>,
}

struct Voice {
    tell: Sender<Told>,
    wake: Wake,
    last: Instant,
}

impl Voice {
    fn tell(&self, told: Told) {
        // Nobody listens any more: the window has opened something else.
        let _ = self.tell.send(told);
        (self.wake)();
    }

    fn progress(&mut self, words: &'static str, done: u64, total: u64) {
        if self.last.elapsed() >= EVERY {
            self.last = Instant::now();
            self.tell(Told::Progress { words, done, total });
        }
    }

    fn again(&self) -> Voice {
        Voice { tell: self.tell.clone(), wake: self.wake.clone(), last: Instant::now() }
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

fn work(
    read: impl FnOnce() -> Result<Case, Fault>,
    asked: &Receiver<Ask>,
    mut voice: Voice,
    flags: Flags,
) {
    let opened = read().and_then(|case| {
        let background = background(&case, &mut voice)?;
        Ok(Arc::new(Opened { case, background }))
    });
    let opened = match opened {
        Ok(opened) => opened,
        Err(fault) => return voice.tell(Told::Fault(fault)),
    };
    voice.tell(Told::Opened(opened.clone()));
    let mut run = Run::new(&opened);
    voice.tell(Told::Moment(Arc::new(run.moment())));
    let mut ahead = Arc::new(AtomicBool::new(false));
    let mut epoch = 0;
    record(&opened, Vec::new(), epoch, ahead.clone(), voice.again());
    while let Ok(ask) = asked.recv() {
        flags.stop.store(false, Ordering::Relaxed);
        if flags.gone.load(Ordering::Relaxed) {
            break;
        }
        let done = match ask {
            Ask::Go(goal) => run.go(goal, &mut voice, &flags.stop),
            Ask::Edits(edits) => {
                ahead.store(true, Ordering::Relaxed);
                ahead = Arc::new(AtomicBool::new(false));
                epoch += 1;
                record(&opened, edits.clone(), epoch, ahead.clone(), voice.again());
                run.set_edits(edits, &mut voice, &flags.stop)
            }
        };
        match done {
            Ok(()) => voice.tell(Told::Moment(Arc::new(run.moment()))),
            Err(fault) => voice.tell(Told::Fault(fault)),
        }
    }
    ahead.store(true, Ordering::Relaxed);
}

/// Runs to the end on a thread of its own and tells of each step.
fn record(opened: &Arc<Opened>, edits: Vec<Edit>, epoch: u64, cancel: Arc<AtomicBool>, voice: Voice) {
    let opened = opened.clone();
    std::thread::spawn(move || {
        let mut run = Run::new(&opened);
        run.edits = edits;
        let mut from = 0;
        let mut since = Instant::now();
        while *run.converter.phase() != Phase::Done && !cancel.load(Ordering::Relaxed) {
            if let Err(fault) = run.forward() {
                return voice.tell(Told::Fault(fault));
            }
            if since.elapsed() > 2 * EVERY {
                since = Instant::now();
                voice.tell(Told::Track { epoch, from, steps: run.track[from as usize..].to_vec() });
                from = run.track.len() as u64;
            }
        }
        if !cancel.load(Ordering::Relaxed) {
            voice.tell(Told::Track { epoch, from, steps: run.track[from as usize..].to_vec() });
            voice.tell(Told::Recorded { epoch });
        }
    });
}

/// A converter with its edits and the record of the steps that it has done.
struct Run<'a> {
    converter: Converter<'a>,
    initial: Parameters,
    edits: Vec<Edit>,
    track: Vec<Tracked>,
}

impl<'a> Run<'a> {
    fn new(opened: &'a Opened) -> Run<'a> {
        let parameters = opened.case.parameters.clone();
        let background = &opened.background;
        let mut converter = Converter::new(background.mesh.clone(), &background.sizing, parameters.clone());
        converter.keep_history();
        Run { converter, initial: parameters, edits: Vec::new(), track: Vec::new() }
    }

    fn step(&self) -> u64 {
        self.converter.counts.steps
    }

    fn take_parameters(&mut self) {
        let mut parameters = self.initial.clone();
        for edit in self.edits.iter().filter(|edit| edit.step <= self.step()) {
            // Edits were checked when they were made.
            let _ = parameters.set(&edit.key, &edit.value);
        }
        if *self.converter.parameters() != parameters {
            self.converter.set_parameters(parameters);
        }
    }

    fn forward(&mut self) -> Result<(), Fault> {
        self.take_parameters();
        let event = self.converter.step()?;
        let settled = !self.converter.phase().is_local_post_processing();
        let tracked = Tracked {
            event,
            standing: standing(&self.converter) as u32,
            front: self.track.last().map_or(0, |last| last.front),
            settled,
        };
        self.track.truncate(self.step() as usize - 1);
        self.track.push(tracked);
        Ok(())
    }

    fn is_done(&self) -> bool {
        *self.converter.phase() == Phase::Done
    }

    fn set_edits(&mut self, edits: Vec<Edit>, voice: &mut Voice, stop: &AtomicBool) -> Result<(), Fault> {
        let step = self.step();
        let first = self.edits.iter().chain(&edits).filter(|e| !(self.edits.contains(e) && edits.contains(e)));
        let first = first.map(|e| e.step).min().unwrap_or(step);
        while self.step() > first && self.converter.step_back() {}
        self.track.truncate(self.step() as usize);
        self.edits = edits;
        self.take_parameters();
        self.go(Goal::Step(step), voice, stop)
    }

    fn go(&mut self, goal: Goal, voice: &mut Voice, stop: &AtomicBool) -> Result<(), Fault> {
        let (step, nq) = (self.step(), standing(&self.converter));
        let back_to = |target: u64| {
            let found = self.track.iter().position(|t| t.settled && u64::from(t.standing) >= target);
            if target == 0 { 0 } else { found.map_or(0, |i| i as u64 + 1) }
        };
        match goal {
            Goal::Step(target) => self.until(voice, stop, |run| run.step() >= target, target),
            Goal::Steps(by) => {
                let target = step.saturating_add_signed(by);
                self.until(voice, stop, |run| run.step() >= target, target)
            }
            Goal::Quads(by) if by >= 0 => self.until(voice, stop, |run| run.has(nq + by as u64), u64::MAX),
            Goal::Quads(by) => {
                let within = step > back_to(nq);
                let target = back_to(nq.saturating_sub(by.unsigned_abs() - u64::from(within)));
                self.until(voice, stop, |_| true, target.min(step.saturating_sub(1)))
            }
            Goal::ToQuads(target) if target > nq => self.until(voice, stop, |run| run.has(target), u64::MAX),
            Goal::ToQuads(target) => {
                let target = back_to(target);
                self.until(voice, stop, |_| true, target)
            }
            Goal::Kind(kind, true) => {
                let seen = |run: &Run<'_>| run.step() > step && run.track.get(run.step() as usize - 1).is_some_and(|t| t.event.kind() == kind);
                self.until(voice, stop, seen, u64::MAX)
            }
            Goal::Kind(kind, false) => {
                let before = &self.track[..(step as usize).saturating_sub(1)];
                let target = before.iter().rposition(|t| t.event.kind() == kind).map_or(0, |i| i as u64 + 1);
                self.until(voice, stop, |_| true, target)
            }
            Goal::End => self.until(voice, stop, |_| false, u64::MAX),
        }
    }

    fn has(&self, quads: u64) -> bool {
        standing(&self.converter) >= quads && !self.converter.phase().is_local_post_processing()
    }

    /// Back to `target` where that is before, else forward until `reached`, the end, or a stop.
    fn until(
        &mut self,
        voice: &mut Voice,
        stop: &AtomicBool,
        reached: impl Fn(&Run<'a>) -> bool,
        target: u64,
    ) -> Result<(), Fault> {
        while self.step() > target && self.converter.step_back() {
            self.take_parameters();
        }
        while self.step() < target && !reached(self) && !self.is_done() && !stop.load(Ordering::Relaxed) {
            self.forward()?;
            voice.progress("Converting", self.step(), 0);
        }
        self.take_parameters();
        Ok(())
    }

    fn moment(&mut self) -> Moment {
        let step = self.step();
        let converter = &self.converter;
        Moment {
            step,
            standing: standing(converter),
            phase: converter.phase().plain(),
            event: (step as usize).checked_sub(1).and_then(|i| self.track.get(i)).map(|t| t.event),
            mesh: converter.mesh.clone(),
            parameters: converter.parameters().clone(),
            counts: converter.counts,
            changed: Vec::new(),
            front: scene::front(&converter.mesh, converter.parameters()),
        }
    }
}

/// What a session is opened with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// A built-in case, by its name.
    BuiltIn(String),
    /// A case or a mesh in a file.
    File(PathBuf),
}
