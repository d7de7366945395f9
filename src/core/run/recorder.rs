//! Running ahead: a converter that continues from the last known step, writes the log and stores keyframes. It can be
//! lent to another thread and returns its results in stretches.

use std::sync::Arc;

use super::births::Appearing;
use super::front_count::{FrontTracker, changes_front};
use super::keyframes::{Keyframe, Keyframes};
use super::last_changes::Changing;
use super::log::{Angles, Log};
use super::run::Run;
use super::sample::{Measures, Sample};
use crate::core::convert::{Converter, Event, EventKind, Phase};
use crate::core::fault::Fault;
use crate::core::mesh::{ElementId, FreeLists, Mesh, Touched};
use crate::core::metric::measure::angle;
use crate::core::progress::Cancel;

/// A keyframe is due after this many steps, whose replay takes about a millisecond.
pub(super) const SPACING: u64 = 1024;

/// It is due earlier once this many nodes plus half of all are touched, since one step may sweep the whole mesh.
const SWEPT: usize = 1024;

/// A converter that runs ahead.
pub struct Recorder {
    run: Arc<Run>,
    converter: Converter<'static>,
    step: u64,
    /// The edition of the edits it knows: its results are valid only for a history of the same edition.
    edition: u64,
    /// What was touched since the last keyframe.
    touched: Touched,
    /// The free lists at the last keyframe.
    free: FreeLists,
    /// The step of the last keyframe.
    keyframe: u64,
    /// Bytes of differences since the last whole mesh.
    since_whole: usize,
    front: FrontTracker,
    /// What was touched since the last update of the front.
    since_front: Touched,
    measures: Measures,
    /// What the last step touched.
    last: Touched,
    appearing: Appearing,
    changing: Changing,
}

/// The log and keyframes of a stretch of steps.
pub struct Stretch {
    pub(super) from: u64,
    pub(super) edition: u64,
    pub(super) log: Log,
    pub(super) keyframes: Vec<Keyframe>,
    pub(super) ended: bool,
    pub(super) fault: Option<Fault>,
}

impl Stretch {
    /// Its last step.
    pub fn until(&self) -> u64 {
        self.from + self.log.known()
    }

    /// Whether nothing follows it: the conversion is finished or cannot continue.
    pub fn is_last(&self) -> bool {
        self.ended || self.fault.is_some()
    }
}

impl Recorder {
    /// A recorder that continues from the last keyframe.
    pub(super) fn resume(run: Arc<Run>, keyframes: &Keyframes, edition: u64) -> Result<Recorder, Fault> {
        let frames = keyframes.frames();
        let last = frames.len() - 1;
        let (mut converter, step) = (keyframes.state(last, Mesh::default()), frames[last].step);
        let free = converter.mesh.free_lists();
        run.enter(&mut converter, step)?;
        converter.keep_journal();
        let touched = Touched::default();
        let (front, measures) = (FrontTracker::of(&converter.mesh), Measures::of(&converter.mesh));
        let (appearing, changing) = (Appearing::of(&converter.mesh), Changing::of(&converter.mesh));
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
            last: Touched::default(),
            appearing,
            changing,
        })
    }

    /// A log with the front and a sample of the first state.
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

    /// Its last step.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Whether its edits are of this edition.
    pub(super) fn is_of(&self, edition: u64) -> bool {
        self.edition == edition
    }

    /// Whether the conversion is finished.
    pub fn is_done(&self) -> bool {
        *self.converter.phase() == Phase::Done
    }

    /// Runs at most this many steps, until the conversion is finished or cannot continue, or until `cancel` is asked.
    pub fn run(&mut self, steps: u64, cancel: &Cancel) -> Stretch {
        let mut stretch = Stretch {
            from: self.step,
            edition: self.edition,
            log: Log::default(),
            keyframes: Vec::new(),
            ended: false,
            fault: None,
        };
        for _ in 0..steps {
            if self.is_done() || cancel.is_asked() {
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
        self.last.clear();
        self.last.note_since(&self.converter.mesh, mark);
        for all in [&mut self.touched, &mut self.since_front] {
            all.note_ids(self.last.nodes(), self.last.elements());
        }
        if changes_front(&event) {
            self.update_front(&event);
            stretch.log.push_front(self.step, self.front.count());
        }
        if let Event::Formed { element, .. } = event {
            stretch.log.push_angles(self.step, angles(&self.converter.mesh, element));
        }
        if event.kind() == EventKind::Mirrored {
            self.measures.mirror(&self.converter.mesh);
        }
        let phase = self.converter.phase();
        let at_rest = !phase.is_local_post_processing();
        let is_due = self.step >= self.keyframe + SPACING
            || *phase == Phase::Done
            || self.touched.nodes().len() > SWEPT + self.converter.mesh.node_slots() / 2;
        let can_be_kept = phase.mark().is_none();
        self.appearing.note(&self.converter.mesh, &self.last, self.step, can_be_kept, stretch.log.born_mut());
        let ends = [can_be_kept, event.kind() == EventKind::RolledBack];
        self.changing.note(&self.converter.mesh, &self.last, self.step, ends, stretch.log.changes_mut());
        stretch.log.push(event, self.converter.standing(), at_rest);
        if can_be_kept {
            self.converter.mesh.commit();
            if is_due {
                // Swaps may have changed the ids of half-edges on the front.
                self.update_front(&event);
                self.measures.update(&self.converter.mesh, &self.touched);
                stretch.log.push_sample(self.sample());
                let keyframe = self.keyframe();
                stretch.keyframes.push(keyframe);
            }
        }
        self.run.make_edits(&mut self.converter, self.step)
    }

    fn update_front(&mut self, event: &Event) {
        self.front.update(&self.converter.mesh, &self.since_front, event);
        self.since_front.clear();
    }

    fn keyframe(&mut self) -> Keyframe {
        let difference = self.converter.mesh.difference(&self.touched, &self.free);
        self.since_whole += difference.bytes();
        // Applying differences must not cost much more than copying a mesh.
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

/// The smallest and the largest angle of a quadrilateral.
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
