//! Running ahead: a converter at the last known step that goes on, writes the log and sets keyframes. It may be lent to
//! another thread, and hands over what it found in stretches.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::front_count::{FrontTracker, changes_front};
use super::keyframes::{Keyframe, Keyframes};
use super::log::{Angles, Log};
use super::run::Run;
use super::sample::{Measures, Sample};
use crate::core::convert::converter::Converter;
use crate::core::convert::event::Event;
use crate::core::convert::phase::Phase;
use crate::core::fault::Fault;
use crate::core::mesh::half_edge::touched::Touched;
use crate::core::mesh::half_edge::{FreeLists, Mesh};
use crate::core::mesh::ids::ElementId;
use crate::core::metric::measure::angle;

/// A keyframe is set at the first chance after so many steps: replaying them takes about a millisecond.
pub(super) const SPACING: u64 = 1024;

/// It is set sooner where so many nodes, and half of all, were touched: a sweep over the whole mesh is one step.
const SWEPT: usize = 1024;

/// A converter that runs ahead.
pub struct Recorder {
    run: Arc<Run>,
    converter: Converter<'static>,
    step: u64,
    /// Which edits it knows: what it finds is of use only to a history that knows the same.
    edition: u64,
    /// What was touched since the last keyframe, and the free lists of then.
    touched: Touched,
    free: FreeLists,
    keyframe: u64,
    /// Bytes of differences since the last whole mesh.
    since_whole: usize,
    front: FrontTracker,
    /// What was touched since the front was looked at.
    since_front: Touched,
    measures: Measures,
}

/// What a stretch of steps did.
pub struct Stretch {
    pub(super) from: u64,
    pub(super) edition: u64,
    pub(super) log: Log,
    pub(super) keyframes: Vec<Keyframe>,
    pub(super) ended: bool,
    pub(super) fault: Option<Fault>,
}

impl Stretch {
    /// The last step of it.
    pub fn until(&self) -> u64 {
        self.from + self.log.known()
    }

    /// Whether nothing comes after it: the conversion is done, or cannot go on.
    pub fn is_last(&self) -> bool {
        self.ended || self.fault.is_some()
    }
}

impl Recorder {
    /// A recorder that goes on from the last keyframe.
    pub(super) fn resume(run: Arc<Run>, keyframes: &Keyframes, edition: u64) -> Result<Recorder, Fault> {
        let frames = keyframes.frames();
        let last = frames.len() - 1;
        let (mut converter, step) = (keyframes.state(last, Mesh::default()), frames[last].step);
        let free = converter.mesh.free_lists();
        run.enter(&mut converter, step)?;
        converter.keep_journal();
        let touched = Touched::default();
        let (front, measures) = (FrontTracker::of(&converter.mesh), Measures::of(&converter.mesh));
        Ok(Recorder {
            run,
            converter,
            step,
            edition,
            touched,
            free,
            keyframe: step,
            since_whole: 0,
            front,
            since_front: Touched::default(),
            measures,
        })
    }

    /// A log with what is known of the state that it starts from.
    pub(super) fn begin(&mut self) -> Log {
        let mut log = Log::beginning_with(self.converter.standing());
        log.push_front(self.step, self.front.count());
        log.push_sample(self.sample());
        log
    }

    fn sample(&mut self) -> Sample {
        let mesh = &self.converter.mesh;
        let length = self.front.segments().map(|h| mesh.length(h)).sum();
        self.measures.sample(mesh, self.step, self.converter.standing(), self.front.count(), length)
    }

    /// The last step that it did.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Whether it knows the edits of this edition.
    pub(super) fn is_of(&self, edition: u64) -> bool {
        self.edition == edition
    }

    /// Whether nothing is left to do.
    pub fn is_done(&self) -> bool {
        *self.converter.phase() == Phase::Done
    }

    /// Goes on for so many steps, or until it is done, cannot go on, or is told to stop.
    pub fn run(&mut self, steps: u64, stop: &AtomicBool) -> Stretch {
        let mut stretch = Stretch {
            from: self.step,
            edition: self.edition,
            log: Log::default(),
            keyframes: Vec::new(),
            ended: false,
            fault: None,
        };
        for _ in 0..steps {
            if self.is_done() || stop.load(Ordering::Relaxed) {
                break;
            }
            if let Err(fault) = self.advance(&mut stretch) {
                stretch.fault = Some(fault);
                break;
            }
        }
        stretch.ended = self.is_done();
        stretch
    }

    fn advance(&mut self, stretch: &mut Stretch) -> Result<(), Fault> {
        let mark = self.converter.mesh.mark();
        let event = self.converter.step()?;
        self.step += 1;
        self.touched.note_since(&self.converter.mesh, mark);
        self.since_front.note_since(&self.converter.mesh, mark);
        if changes_front(&event) {
            self.look_at_front(&event);
            stretch.log.push_front(self.step, self.front.count());
        }
        if let Event::Formed { element, .. } = event {
            stretch.log.push_angles(self.step, angles(&self.converter.mesh, element));
        }
        let phase = self.converter.phase();
        let at_rest = !phase.is_local_post_processing();
        let is_due = self.step >= self.keyframe + SPACING
            || *phase == Phase::Done
            || self.touched.nodes().len() > SWEPT + self.converter.mesh.node_slots() / 2;
        let can_be_kept = phase.mark().is_none();
        stretch.log.push(event, self.converter.standing(), at_rest);
        if can_be_kept {
            self.converter.mesh.commit();
            if is_due {
                // Swaps have given other ids to the half-edges of the front.
                self.look_at_front(&event);
                self.measures.update(&self.converter.mesh, &self.touched);
                stretch.log.push_sample(self.sample());
                let keyframe = self.keyframe();
                stretch.keyframes.push(keyframe);
            }
        }
        self.run.make_edits(&mut self.converter, self.step)
    }

    fn look_at_front(&mut self, event: &Event) {
        self.front.update(&self.converter.mesh, &self.since_front, event);
        self.since_front.clear();
    }

    fn keyframe(&mut self) -> Keyframe {
        let difference = self.converter.mesh.difference(&self.touched, &self.free);
        self.since_whole += difference.bytes();
        // Applying differences shall not cost much more than copying a mesh.
        let is_whole = self.since_whole > self.converter.mesh.bytes() / 4;
        if is_whole {
            self.since_whole = 0;
        }
        let whole = is_whole.then(|| self.converter.mesh.clone());
        self.touched.clear();
        self.free = self.converter.mesh.free_lists();
        self.keyframe = self.step;
        Keyframe::after(self.step, self.converter.without_mesh(), difference, whole)
    }
}

/// The angles of a quadrilateral.
fn angles(mesh: &Mesh, element: ElementId) -> Angles {
    let n = mesh.quad(element);
    let corner = |k: usize| {
        let p = mesh.uv(n[k]);
        let (next, previous) = (mesh.uv(n[(k + 1) % 4]) - p, mesh.uv(n[(k + 3) % 4]) - p);
        angle(mesh.metric_ref(n[k]), next, previous) as f32
    };
    let corners: [f32; 4] = std::array::from_fn(corner);
    Angles { min: corners.into_iter().fold(f32::INFINITY, f32::min), max: corners.into_iter().fold(0.0, f32::max) }
}
