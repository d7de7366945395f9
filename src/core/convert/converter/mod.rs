//! The converter as a resumable machine (paper 4.3): one elementary operation or decision a step.
//!
//! `step` looks at the phase, does one thing, and says what comes next and what it did. `run` is a loop over it. All
//! changes go through the mesh's operators and so through the journal: a failed attempt is taken back, and stepping
//! back uses the same mechanism.

mod counts;
mod explaining;
mod waiting;
mod faces;
mod image;
mod taking_back;

pub use counts::Counts;
pub use explaining::LookedAt;

use std::sync::Arc;

use faces::Begun;
use taking_back::Record;

use super::event::{Event, Why};
use super::finish::parts::Finishing;
use super::finish::{Finished, PostProcessing};
use super::front::{Done, Front};
use super::last_resort::Outcome;
use super::phase::{Attempt, Base, FinishPart, Phase};
use super::{close, form, local, seam, select, side, split, top};
use crate::core::case::Parameters;
use crate::core::fault::Fault;
use crate::core::front::{Queue, Side};
use crate::core::kernel::Fingerprint;
use crate::core::mesh::{Mark, Mesh, NodeId, Undone};
use crate::core::metric::MetricSource;
use crate::core::progress::{Stage, Watch};

/// Steps between two reports of progress.
const TELL: u64 = 2048;

/// A conversion at some step.
#[derive(Clone)]
pub struct Converter<'a> {
    /// The mesh: live triangles and dead quadrilaterals.
    pub mesh: Mesh,
    /// The metric field.
    source: Arc<dyn MetricSource + Send + Sync + 'a>,
    /// Parameters; may be changed between two steps by [`Converter::set_parameters`].
    parameters: Parameters,
    /// A cache: rebuilt from the mesh where it is missing, and then chooses the same.
    queue: Option<Queue>,
    phase: Phase,
    /// Records of the steps, where a history is kept.
    history: Option<Vec<Record>>,
    /// Whether steps leave the journal to their caller, who commits it where nothing is under way.
    journal_kept: bool,
    /// What the step at hand took back, where a history is kept.
    undone: Option<Vec<Undone>>,
    /// Where the journal stood before the step at hand.
    step_mark: Mark,
    /// Whether the gates are wide: every segment was deferred and taken up again.
    second_pass: bool,
    /// On surfaces the faces by region, converted one after another; else none: all is converted together.
    faces: Arc<[u32]>,
    /// Which of them is being converted; past the last one, none.
    face: usize,
    /// Elements of the faces after each, at step 0.
    waiting: Arc<[u64]>,
    /// Where the conversion of the face at hand began.
    begun: Begun,
    /// The base segment that a person picked for the next selection.
    picked: Option<[NodeId; 2]>,
    /// Counts of what was done.
    pub counts: Counts,
    /// What the last resort did.
    pub last_resort: Outcome,
    /// What the post-processing did.
    pub finished: Finished,
    /// The post-processing under way.
    finishing: Finishing<'a>,
    /// That of the faces before, for stepping back.
    finished_faces: Vec<Finishing<'a>>,
}

impl<'a> Converter<'a> {
    /// A converter at step 0: the initial merging front is the boundary of the background mesh (4.3.2). The metric is
    /// lent (`&sizing`) or shared (`Arc<Sizing>`).
    pub fn new(mesh: Mesh, source: impl MetricSource + Send + Sync + 'a, parameters: Parameters) -> Self {
        let faces = if mesh.embedding().is_some() { mesh.faces() } else { Vec::new() };
        let mut waiting = vec![0; faces.len()];
        if !faces.is_empty() {
            // Before each face, for now; then after it.
            mesh.elements().for_each(|e| waiting[faces.partition_point(|&face| face < mesh.region(e))] += 1);
            let mut after = 0;
            waiting.iter_mut().rev().for_each(|own| (*own, after) = (after, after + *own));
        }
        let given = mesh.elements().filter(|&e| mesh.is_quad(e)).count() as u64;
        Converter {
            faces: faces.into(),
            face: 0,
            waiting: waiting.into(),
            begun: Begun { stood: given, made: 0 },
            finished_faces: Vec::new(),
            mesh,
            source: Arc::new(source),
            parameters,
            queue: None,
            phase: Phase::Select,
            history: None,
            journal_kept: false,
            undone: None,
            step_mark: Mark::default(),
            second_pass: false,
            picked: None,
            counts: Counts::default(),
            last_resort: Outcome::default(),
            finished: Finished::default(),
            finishing: Finishing::default(),
        }
    }

    /// Where it stands.
    pub fn phase(&self) -> &Phase {
        &self.phase
    }

    /// The parameters in force.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Changes the parameters from the next step on.
    pub fn set_parameters(&mut self, parameters: Parameters) {
        self.parameters = parameters;
        self.queue = None;
    }

    /// Whether there is a front segment from A to B.
    ///
    /// # Errors
    /// Where there is none.
    pub fn check_base(&self, a: NodeId, b: NodeId) -> Result<(), Fault> {
        let none = || {
            Fault::new(format!("There is no front segment from node {} to node {}", a.0, b.0))
                .remedy("Name its nodes so that the live triangles lie to its left")
        };
        select::front_segment(&self.mesh, a, b).map(drop).ok_or_else(none)
    }

    /// Lets the next selection choose the front segment from A to B, whatever its rank: a person's choice, and its
    /// event says so. If it is not on the front when the selection comes, [`Event::PickLost`] says that.
    pub fn pick(&mut self, a: NodeId, b: NodeId) {
        self.picked = Some([a, b]);
    }

    /// The base segment that a person picked for the next selection.
    pub fn picked(&self) -> Option<[NodeId; 2]> {
        self.picked
    }

    /// Appends the canonical serialisation of the state: mesh, front, phase and what the next steps depend on. Equal
    /// bytes are equal states; caches and counts are left out.
    pub fn write_state(&self, bytes: &mut Vec<u8>) {
        self.mesh.write_state(bytes);
        self.finishing.write_state(bytes);
        let Converter { second_pass, face, picked, parameters, .. } = self;
        let rest = format!("{:?} {second_pass:?} {face:?} {picked:?} {parameters:?}", self.phase.plain());
        bytes.extend_from_slice(rest.as_bytes());
    }

    /// The fingerprint of the state: equal states have equal ones.
    pub fn fingerprint(&self) -> Fingerprint {
        let mut bytes = Vec::new();
        self.write_state(&mut bytes);
        Fingerprint::of(&bytes)
    }

    /// The number of finished quadrilaterals (NQ) at this step.
    pub fn standing(&self) -> u64 {
        match &self.phase {
            // Everything but the faces to come is a quadrilateral, also what clean-up has put in the place of others.
            Phase::PostProcess { .. } | Phase::NextFace | Phase::Mirror | Phase::Done => self.all_but_waiting(),
            phase => {
                let last = if let Phase::Patch { plan, patch, .. } = phase { plan.quads_before(*patch) } else { 0 };
                self.begun.stood + self.made() - self.begun.made + last as u64
            }
        }
    }

    /// Quadrilaterals that front and last resort have made so far.
    fn made(&self) -> u64 {
        self.counts.formed + self.counts.closed + self.last_resort.quads() as u64
    }

    /// Runs to the end.
    ///
    /// # Errors
    /// As [`Converter::step`].
    pub fn run(&mut self, watch: &mut dyn Watch) -> Result<(), Fault> {
        let total = self.mesh.element_count() as u64;
        watch.tell(Stage::Convert, 2 * self.counts.formed, total);
        while self.phase != Phase::Done {
            if self.counts.steps.is_multiple_of(TELL) {
                watch.cancel().check()?;
                if !matches!(self.phase, Phase::PostProcess { .. }) {
                    watch.tell(Stage::Convert, 2 * self.counts.formed, total);
                }
            }
            if self.phase == (Phase::PostProcess { part: FinishPart::FirstSmoothing }) {
                watch.tell(Stage::Finish, 0, 0);
            }
            self.step()?;
        }
        Ok(())
    }

    /// Does one elementary operation or decision.
    ///
    /// # Errors
    /// Where what is left over cannot be converted even by the last resort: a bug, or a mesh that broke its promises.
    pub fn step(&mut self) -> Result<Event, Fault> {
        let (before, attempt) = (self.record(), self.phase.attempt().copied());
        self.step_mark = self.mesh.mark();
        self.counts.steps += 1;
        let event = loop {
            let phase = std::mem::replace(&mut self.phase, Phase::Done);
            let is_half = self.is_half(&phase);
            let (next, event) = self.act(phase)?;
            self.phase = if is_half && next == Phase::Done { Phase::Mirror } else { next };
            if let Some(event) = event {
                break event;
            }
        };
        self.counts.count(&event, attempt);
        self.remember(before);
        Ok(event)
    }

    /// What a phase asks for.
    fn act(&mut self, phase: Phase) -> Result<Done, Fault> {
        let (face, keeps_journal) = (self.face(), self.keeps_journal());
        let front = &mut Front {
            mesh: &mut self.mesh,
            source: &*self.source,
            parameters: &self.parameters,
            queue: &mut self.queue,
            face,
            second_pass: &mut self.second_pass,
            keeps_journal,
        };
        Ok(match phase {
            Phase::Select => select::select(front, self.picked.take()),
            Phase::PrepareSide { base, attempt, side, left } => side::prepare(front, base, attempt, side, left)
                .unwrap_or_else(|why| self.take_attempt_back(base, attempt, why)),
            Phase::DivideSide { base, attempt, side, tops } => side::divide(front, base, attempt, side, tops)
                .unwrap_or_else(|why| self.take_attempt_back(base, attempt, why)),
            Phase::RecoverTop { base, attempt, tops, swaps, smooths: true } => {
                top::smooth(front, base, attempt, tops, swaps)
            }
            Phase::RecoverTop { base, attempt, tops, swaps, smooths: false } => {
                top::recover(front, base, attempt, tops, swaps)
                    .unwrap_or_else(|why| self.take_attempt_back(base, attempt, why))
            }
            Phase::Form { base, attempt, tops } => {
                form::form(front, base, attempt, tops).unwrap_or_else(|why| self.take_attempt_back(base, attempt, why))
            }
            Phase::Defer { base } => close::close_or_defer(front, base),
            Phase::Enhance { element, mark, edges, budget } => local::enhance(front, element, mark, edges, budget),
            Phase::Smooth { element, mark } => local::smooth(front, element, mark),
            Phase::Seam { element, nodes } => seam::step(front, element, nodes),
            Phase::Split { element } => split::step(front, element),
            Phase::Close { waiting, left } => close::close_next(front, waiting, left),
            Phase::Match { left, at } => close::match_next(front, left, at, self.last_resort)?,
            Phase::Patch { left, at, plan, patch } => close::patch(front, left, at, plan, patch, &mut self.last_resort),
            Phase::PostProcess { part } => self.post_processing().step(part),
            Phase::NextFace => self.next_face(),
            Phase::Mirror => self.add_image()?,
            Phase::Done => (Phase::Done, Some(Event::Finished)),
        })
    }

    fn post_processing(&mut self) -> PostProcessing<'_, 'a> {
        PostProcessing {
            face: self.face(),
            by: self.parameters.clean_up,
            lays_rows: self.parameters.placement,
            keeps_history: self.keeps_history(),
            keeps_journal: self.keeps_journal(),
            mesh: &mut self.mesh,
            source: &self.source,
            parts: &mut self.finishing,
            finished: &mut self.finished,
        }
    }

    /// Takes an attempt back; the next one follows, or where there is none the segment is deferred (docs/algorithm.md,
    /// "Rescue").
    fn take_attempt_back(&mut self, base: Base, attempt: Attempt, why: Why) -> Done {
        if self.keeps_history() {
            // What this very step did is not part of the state before it.
            self.mesh.take_back(self.step_mark);
            self.undone = Some(self.mesh.take_back_to_redo(attempt.mark));
        } else {
            self.mesh.take_back(attempt.mark);
        }
        let next = match form::attempts::next(&self.mesh, &self.parameters, &base, &attempt) {
            Some(attempt) => Phase::PrepareSide { base, attempt, side: Side::Left, left: None },
            None => Phase::Defer { base },
        };
        (next, Some(Event::RolledBack { attempt: attempt.number, why }))
    }
}
