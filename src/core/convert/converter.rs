//! The converter as a resumable machine (paper 4.3): one elementary operation or decision a step.
//!
//! `step` looks at the phase, does one thing, and says what comes next and what it did. `run` is a loop over it. All
//! changes go through the mesh's operators and so through the journal: an attempt that fails is taken back, and a person
//! who steps back uses the same mechanism.

use std::sync::Arc;

use super::component::{Component, live_components};
use super::event::{Event, Why};
use super::finish::{Finished, Finishing, PartMarks};
use super::last_resort::{Outcome, Plan};
use super::parameters::Parameters;
use super::phase::{Attempt, Base, Part, Phase};
use super::top::{MOST_SWAPS, Recovery};
use crate::core::fault::Fault;
use crate::core::front::sector::Side;
use crate::core::front::segment::Segment;
use crate::core::front::selection::{Choice, Queue};
use crate::core::io::fingerprint::Fingerprint;
use crate::core::journal::Mark;
use crate::core::mesh::half_edge::{Mesh, Undone};
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::mesh::touched::Touched;
use crate::core::metric::field::MetricSource;
use crate::core::progress::{Stage, Watch};

/// Least quality and largest new edge that a formation may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gates {
    pub quality: f64,
    pub length: f64,
}

/// How often what happened, since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Steps.
    pub steps: u64,
    /// Quadrilaterals formed by the front.
    pub formed: u64,
    /// Of those, how many with another right side (4.3.4).
    pub right_replaced: u64,
    /// Of those, how many by the other rescues of spec 2.4 (b, c).
    pub rescued: u64,
    /// Attempts taken back.
    pub rolled_back: u64,
    /// Segments put off.
    pub deferred: u64,
    /// Quadrilaterals over small loops that were closed.
    pub closed: u64,
    /// Seams, those with a transition included.
    pub seamed: u64,
    /// Of those, how many with a transition.
    pub transitions: u64,
    /// Front splits.
    pub split: u64,
    /// Swaps of the enhancement.
    pub enhanced: u64,
    /// Nodes removed.
    pub removed: u64,
}

/// What a step needs to be taken back.
#[derive(Clone, Debug)]
pub(super) struct Record {
    phase: Phase,
    second_pass: bool,
    picked: Option<[NodeId; 2]>,
    counts: Counts,
    last_resort: Outcome,
    finished: Finished,
    parts: PartMarks,
    undo: Undo,
}

/// How a step is taken back.
#[derive(Clone, Debug)]
enum Undo {
    /// By the journal, from here.
    Journal(Mark),
    /// It was a rollback itself: by doing again what it took back.
    Redo(Vec<Undone>),
}

/// A conversion at some step.
#[derive(Clone)]
pub struct Converter<'a> {
    /// The mesh: live triangles and dead quadrilaterals.
    pub mesh: Mesh,
    /// Quadrilaterals that stood at step 0.
    pub(super) given: u64,
    /// What gives the metric anywhere.
    pub(super) source: Arc<dyn MetricSource + Send + Sync + 'a>,
    /// Parameters; may be changed between two steps by [`Converter::set_parameters`].
    pub(super) parameters: Parameters,
    /// A cache: rebuilt from the mesh where it is missing, and then chooses the same.
    queue: Option<Queue>,
    phase: Phase,
    /// Records of the steps, where a history is kept.
    pub(super) history: Option<Vec<Record>>,
    /// Whether steps leave the journal to whoever drives them, who forgets it where nothing is under way.
    journal_kept: bool,
    /// What the step at hand took back, where a history is kept.
    undone: Option<Vec<Undone>>,
    /// Where the journal stood before the step at hand.
    step_mark: Mark,
    /// Whether the gates are wide: every segment was put off and taken up again.
    second_pass: bool,
    /// The base segment that a person picked for the next selection.
    picked: Option<[NodeId; 2]>,
    /// How often what happened.
    pub counts: Counts,
    /// What the last resort did.
    pub last_resort: Outcome,
    /// What the post-processing did.
    pub finished: Finished,
    /// What it has under way.
    pub(super) finishing: Finishing<'a>,
}

impl<'a> Converter<'a> {
    /// A converter at step 0: the initial merging front is the boundary of the background mesh (4.3.2). The metric is lent
    /// (`&sizing`) or shared (`Arc<Sizing>`).
    pub fn new(mesh: Mesh, source: impl MetricSource + Send + Sync + 'a, parameters: Parameters) -> Self {
        Converter {
            given: mesh.elements().filter(|&e| mesh.is_quad(e)).count() as u64,
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

    /// Lets the next selection choose the front segment from A to B, whatever its rank: a person's choice, and its event says
    /// so. Where it is not on the front any more when the selection comes, [`Event::PickLost`] says that.
    ///
    /// # Errors
    /// Where there is no such front segment now.
    pub fn override_base(&mut self, a: NodeId, b: NodeId) -> Result<(), Fault> {
        self.check_base(a, b)?;
        self.pick(a, b);
        Ok(())
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
        self.front_segment(a, b).map(drop).ok_or_else(none)
    }

    /// As [`Converter::override_base`], without asking whether there is such a segment now.
    pub(in crate::core) fn pick(&mut self, a: NodeId, b: NodeId) {
        self.picked = Some([a, b]);
    }

    /// The base segment that a person picked for the next selection.
    pub fn picked(&self) -> Option<[NodeId; 2]> {
        self.picked
    }

    fn front_segment(&self, a: NodeId, b: NodeId) -> Option<HalfEdgeId> {
        if self.mesh.has_node(a) && self.mesh.has_node(b) { self.mesh.front_between(a, b) } else { None }
    }

    /// Keeps from now on what [`step_back`](Converter::step_back) needs.
    pub fn keep_history(&mut self) {
        self.mesh.commit();
        self.finishing.record();
        self.history = Some(Vec::new());
    }

    /// Takes the last step back, exactly. False at the beginning of the history, or where none is kept.
    pub fn step_back(&mut self) -> bool {
        let Some(record) = self.history.as_mut().and_then(Vec::pop) else { return false };
        match record.undo {
            Undo::Journal(mark) => self.mesh.take_back(mark),
            Undo::Redo(undone) => self.mesh.redo(undone),
        }
        self.phase = record.phase;
        self.second_pass = record.second_pass;
        self.picked = record.picked;
        self.counts = record.counts;
        self.last_resort = record.last_resort;
        self.finished = record.finished;
        self.finishing.take_back(record.parts, record.finished.cleaned_up);
        self.queue = None;
        true
    }

    /// Lets the journal stand from step to step without keeping a history: it tells what the steps touched. Whoever drives
    /// forgets it ([`Mesh::commit`]) where [`Phase::mark`] says that nothing is under way.
    pub(in crate::core) fn keep_journal(&mut self) {
        self.mesh.commit();
        self.journal_kept = true;
    }

    pub(super) fn keeps_journal(&self) -> bool {
        self.journal_kept || self.history.is_some()
    }

    /// Number of steps that can be taken back.
    pub fn history_len(&self) -> usize {
        self.history.as_ref().map_or(0, Vec::len)
    }

    /// Bytes that the history takes: records, journal, and what rollbacks need to be taken back. Linear in its length.
    pub fn history_bytes(&self) -> usize {
        let records = self.history.as_ref().map_or(0, |records| {
            let redo = |record: &Record| match &record.undo {
                Undo::Redo(undone) => undone.capacity() * size_of::<Undone>(),
                Undo::Journal(_) => 0,
            };
            records.capacity() * size_of::<Record>() + records.iter().map(redo).sum::<usize>()
        });
        records + self.mesh.journal().bytes() + self.finishing.bytes()
    }

    /// Bytes that everything but mesh, queue and history takes, beside its own size.
    pub(in crate::core) fn bytes_of_rest(&self) -> usize {
        let of = |component: &Component| size_of::<Component>() + component.triangles.len() * size_of::<ElementId>();
        let phase = match &self.phase {
            Phase::Close { waiting, left } => waiting.iter().chain(left).map(of).sum(),
            // The plan is shared by all states that carry it out.
            Phase::Match { left, .. } | Phase::Patch { left, .. } => left.iter().map(of).sum(),
            _ => 0,
        };
        phase + self.finishing.bytes()
    }

    /// Forgets the older steps of the history, so that about `keep` can still be taken back: a few more where an attempt
    /// was under way.
    pub fn shorten_history(&mut self, keep: usize) {
        let Some(records) = &mut self.history else { return };
        // Later steps take back no further than to the selection at which nothing was under way.
        let last = records.len().saturating_sub(keep);
        let at_rest = |record: &Record| record.phase.mark().is_none();
        let Some(first) = (0..=last).rev().find(|&i| records.get(i).is_some_and(at_rest)) else { return };
        let Undo::Journal(mark) = records[first].undo else { return };
        records.drain(..first);
        records.shrink_to(2 * records.len());
        self.mesh.forget_before(mark);
    }

    /// The ids of what the last step changed, from the history; false where there is none.
    pub(in crate::core) fn note_last_step(&self, touched: &mut Touched) -> bool {
        let Some(record) = self.history.as_ref().and_then(|records| records.last()) else { return false };
        match &record.undo {
            Undo::Journal(mark) => touched.note_since(&self.mesh, *mark),
            Undo::Redo(undone) => touched.note_undone(&self.mesh, undone),
        }
        true
    }

    /// Everything but the mesh and caches, history left out: with the mesh, a state to go on from.
    pub(in crate::core) fn without_mesh(&mut self) -> Converter<'a> {
        let (mesh, queue) = (std::mem::take(&mut self.mesh), self.queue.take());
        let (history, journal_kept) = (self.history.take(), std::mem::take(&mut self.journal_kept));
        let rest = self.clone();
        (self.mesh, self.queue, self.history, self.journal_kept) = (mesh, queue, history, journal_kept);
        rest
    }

    /// The state that [`without_mesh`](Converter::without_mesh) was made of, on its mesh.
    pub(in crate::core) fn with_mesh(&self, mesh: Mesh) -> Converter<'a> {
        Converter { mesh, ..self.clone() }
    }

    /// Appends the canonical serialisation of the state: mesh, front, phase and what the next steps depend on. Equal
    /// bytes are equal states; caches and counts are left out.
    pub fn write_state(&self, bytes: &mut Vec<u8>) {
        self.mesh.write_state(bytes);
        self.finishing.write_state(bytes);
        bytes.extend_from_slice(
            format!("{:?} {:?} {:?} {:?}", self.phase.plain(), self.second_pass, self.picked, self.parameters)
                .as_bytes(),
        );
    }

    /// The fingerprint of the state: equal states have equal ones.
    pub fn fingerprint(&self) -> Fingerprint {
        let mut bytes = Vec::new();
        self.write_state(&mut bytes);
        Fingerprint::of(&bytes)
    }

    fn queue(&mut self) -> &mut Queue {
        self.queue.get_or_insert_with(|| Queue::of(&self.mesh, &self.parameters))
    }

    /// The queue taken out, so that it can be handed the mesh; it must be put back.
    fn take_queue(&mut self) -> Queue {
        self.queue();
        self.queue.take().expect("it was just made")
    }

    /// Runs to the end.
    ///
    /// # Errors
    /// As [`Converter::step`].
    pub fn run(&mut self, watch: &mut dyn Watch) -> Result<(), Fault> {
        let total = self.mesh.element_count() as u64;
        watch.tell(Stage::Convert, 0, total);
        while self.phase != Phase::Done {
            if self.counts.steps.is_multiple_of(8192) {
                watch.tell(Stage::Convert, 2 * self.counts.formed, total);
            }
            if self.phase == (Phase::PostProcess { part: Part::FirstSmoothing }) {
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
        let before = self.history.is_some().then(|| Record {
            phase: self.phase.clone(),
            second_pass: self.second_pass,
            picked: self.picked,
            counts: self.counts,
            last_resort: self.last_resort,
            finished: self.finished,
            parts: self.finishing.mark(),
            undo: Undo::Journal(self.mesh.mark()),
        });
        self.step_mark = self.mesh.mark();
        self.counts.steps += 1;
        let phase = std::mem::replace(&mut self.phase, Phase::Done);
        let (next, event) = self.act(phase)?;
        self.phase = next;
        if let (Some(history), Some(mut record)) = (&mut self.history, before) {
            if let Some(undone) = self.undone.take() {
                record.undo = Undo::Redo(undone);
            }
            history.push(record);
        }
        Ok(event)
    }

    /// What a phase asks for: the phase after it, and what was done.
    fn act(&mut self, phase: Phase) -> Result<(Phase, Event), Fault> {
        match phase {
            Phase::Select => self.select(),
            Phase::PrepareSide { base, attempt, side, left } => Ok(self.step_side(base, attempt, side, left)),
            Phase::DivideSide { base, attempt, side, tops } => self.step_divide(base, attempt, side, tops),
            Phase::RecoverTop { base, attempt, tops, swaps } => Ok(self.step_top(base, attempt, tops, swaps)),
            Phase::Form { base, attempt, tops } => Ok(self.step_form(base, attempt, tops)),
            Phase::Defer { base } => Ok(self.step_defer(base)),
            Phase::Enhance { element, mark, edges, budget } => self.step_enhance(element, mark, edges, budget),
            Phase::Smooth { element, mark } => self.step_smooth(element, mark),
            Phase::Seam { element, nodes } => self.step_seam(element, nodes),
            Phase::Split { element } => self.step_split(element),
            Phase::Close { waiting, left } => self.step_close(waiting, left),
            Phase::Match { left, at } => self.step_match(left, at),
            Phase::Patch { left, at, plan, patch } => Ok(self.step_patch(left, at, plan, patch)),
            Phase::PostProcess { part } => Ok(self.step_post_process(part)),
            Phase::Done => Ok((Phase::Done, Event::Finished)),
        }
    }

    /// Brings the queue up to date with what the journal holds since the mark.
    pub(super) fn refresh(&mut self, mark: Mark) {
        let mut queue = self.take_queue();
        queue.refresh(&mut self.mesh, mark, &self.parameters);
        self.queue = Some(queue);
    }

    /// The gates that a formation must pass.
    pub(super) fn gates(&self) -> Gates {
        if self.second_pass { Gates { quality: 0.05, length: 4.0 } } else { Gates { quality: 0.15, length: 2.0 } }
    }

    /// Base segment selection (4.3.3).
    pub(super) fn select(&mut self) -> Result<(Phase, Event), Fault> {
        if !self.keeps_journal() {
            // Nobody steps back: what was done stays done, and its memory is free again.
            self.mesh.commit();
        }
        let picked = match self.picked.take() {
            Some([a, b]) => match self.front_segment(a, b) {
                Some(h) => Some(Segment::measure(&self.mesh, h, &self.parameters)),
                None => return Ok((Phase::Select, Event::PickLost { a, b })),
            },
            None => None,
        };
        let mut queue = self.take_queue();
        let choice = queue.select(&self.mesh, &self.parameters);
        let choice = picked.map_or(choice, |segment| Some(Choice::of_person(segment, choice, &self.parameters)));
        let taken_up = choice.is_none() && !self.second_pass && queue.take_up_all(&mut self.mesh, &self.parameters);
        self.queue = Some(queue);
        let Some(Choice { segment, h_min, within_reach }) = choice else {
            if taken_up {
                self.second_pass = true;
                return Ok((Phase::Select, Event::SecondPass));
            }
            let mut components = live_components(&self.mesh);
            components.reverse();
            return self.step_close(components, Vec::new());
        };
        let base = Base {
            a: segment.a,
            b: segment.b,
            theta: segment.theta,
            length: segment.length_metric,
            level: segment.level,
        };
        let attempt = Attempt { number: 0, divide: [false; 2], tops: [None; 2], mark: self.mesh.mark() };
        Ok((
            Phase::PrepareSide { base, attempt, side: Side::Left, left: None },
            Event::BaseSelected {
                a: segment.a,
                b: segment.b,
                h_value: segment.h_value,
                h_min,
                class: segment.class,
                theta: segment.theta,
                length_metric: segment.length_metric,
                length_physical: segment.length_physical,
                level: segment.level,
                within_reach,
                picked: picked.is_some(),
            },
        ))
    }

    /// Takes an attempt back; the next one follows, or where there is none the segment is put off (spec 2.4 d).
    fn fail(&mut self, base: Base, attempt: Attempt, why: Why) -> (Phase, Event) {
        if self.history.is_some() {
            // What this very step did is not part of the state before it.
            self.mesh.take_back(self.step_mark);
            self.undone = Some(self.mesh.take_back_to_redo(attempt.mark));
        } else {
            self.mesh.take_back(attempt.mark);
        }
        self.counts.rolled_back += 1;
        let next = match self.next_attempt(&base, &attempt) {
            Some(attempt) => Phase::PrepareSide { base, attempt, side: Side::Left, left: None },
            None => Phase::Defer { base },
        };
        (next, Event::RolledBack { attempt: attempt.number, why })
    }

    fn step_side(&mut self, base: Base, attempt: Attempt, side: Side, left: Option<NodeId>) -> (Phase, Event) {
        match self.prepare_side(&base, &attempt, side, left) {
            Ok((top, event)) => {
                let tops = match side {
                    Side::Left => [Some(top), None],
                    Side::Right => [left, Some(top)],
                };
                // A dead edge is never divided; what cannot be divided and must be fails in its own step.
                let next = match event {
                    Event::SideIsFront { .. } => self.after_side(base, attempt, side, tops),
                    _ => match self.division(&base, &attempt, side, top) {
                        Ok(None) => self.after_side(base, attempt, side, tops),
                        _ => Phase::DivideSide { base, attempt, side, tops },
                    },
                };
                (next, event)
            }
            Err(why) => self.fail(base, attempt, why),
        }
    }

    fn after_side(&self, base: Base, attempt: Attempt, side: Side, tops: [Option<NodeId>; 2]) -> Phase {
        match (side, tops) {
            (Side::Right, [Some(c), Some(d)]) => Phase::RecoverTop { base, attempt, tops: [c, d], swaps: 0 },
            _ => Phase::PrepareSide { base, attempt, side: Side::Right, left: tops[0] },
        }
    }

    fn step_divide(
        &mut self,
        base: Base,
        attempt: Attempt,
        side: Side,
        mut tops: [Option<NodeId>; 2],
    ) -> Result<(Phase, Event), Fault> {
        let Some(top) = tops[side.index()] else { return Ok(self.fail(base, attempt, Why::NoSide(side))) };
        match self.division(&base, &attempt, side, top) {
            Ok(Some(division)) => {
                let (node, event) = self.divide_side(side, division);
                tops[side.index()] = Some(node);
                Ok((self.after_side(base, attempt, side, tops), event))
            }
            // Somebody has changed the parameters since it was judged.
            Ok(None) => self.act(self.after_side(base, attempt, side, tops)),
            Err(why) => Ok(self.fail(base, attempt, why)),
        }
    }

    fn step_top(&mut self, base: Base, attempt: Attempt, tops: [NodeId; 2], swaps: u8) -> (Phase, Event) {
        let [c, d] = tops;
        match self.recover_step(c, d, &[base.a, base.b, c, d]) {
            Ok(Recovery::Found) => (Phase::Form { base, attempt, tops }, Event::TopFound { ends: tops, swaps }),
            Ok(Recovery::Changed(_)) if swaps == MOST_SWAPS => self.fail(base, attempt, Why::TopTooLong),
            Ok(Recovery::Changed(event)) => (Phase::RecoverTop { base, attempt, tops, swaps: swaps + 1 }, event),
            Err(why) => self.fail(base, attempt, why),
        }
    }

    fn step_form(&mut self, base: Base, attempt: Attempt, tops: [NodeId; 2]) -> (Phase, Event) {
        match self.form(&base, &attempt, tops) {
            Ok(event) => {
                let Event::Formed { element, .. } = event else { unreachable!("form forms") };
                self.counts.formed += 1;
                let right_replaced = attempt.tops[1].is_some() && attempt.tops[0].is_none();
                self.counts.right_replaced += u64::from(right_replaced);
                self.counts.rescued += u64::from(attempt.tops[0].is_some());
                (self.begin_local(element, attempt.mark), event)
            }
            Err(why) => self.fail(base, attempt, why),
        }
    }

    /// Puts a segment off until something near it changes.
    fn step_defer(&mut self, base: Base) -> (Phase, Event) {
        self.counts.deferred += 1;
        if let Some(h) = self.base_half_edge(&base) {
            let mut queue = self.take_queue();
            queue.defer(&mut self.mesh, h);
            self.queue = Some(queue);
        }
        (Phase::Select, Event::Deferred { a: base.a, b: base.b })
    }

    /// Closes the next small loop that is left over (spec 2.7); what cannot be closed goes to the last resort together.
    fn step_close(&mut self, mut waiting: Vec<Component>, mut left: Vec<Component>) -> Result<(Phase, Event), Fault> {
        while let Some(component) = waiting.pop() {
            if let Some((quads, event)) = self.close(&component) {
                self.counts.closed += quads;
                return Ok((Phase::Close { waiting, left }, event));
            }
            left.push(component);
        }
        self.step_match(left.into(), 0)
    }

    /// Matches the triangles of the next component that is left over (spec 2.10); past the last one all are converted.
    fn step_match(&mut self, left: Arc<[Component]>, at: usize) -> Result<(Phase, Event), Fault> {
        let Some(component) = left.get(at) else {
            let next = if self.parameters.post_processing {
                Phase::PostProcess { part: Part::FirstSmoothing }
            } else {
                Phase::Done
            };
            return Ok((next, Event::LastResort(self.last_resort)));
        };
        let plan = Plan::new(&self.mesh, &component.triangles, &*self.source)
            .map_err(|stuck| Fault::new(format!("A part of the mesh cannot be converted: {stuck}")))?;
        let Outcome { triangles, unmatched, unmatched_at_all, .. } = plan.outcome();
        let event = Event::Matched { triangles, unmatched, unmatched_at_all, patches: plan.patches() };
        Ok((Phase::Patch { left, at, plan: Arc::new(plan), patch: 0 }, event))
    }

    /// Makes quadrilaterals of the next patch of the component at hand.
    fn step_patch(&mut self, left: Arc<[Component]>, at: usize, plan: Arc<Plan>, patch: usize) -> (Phase, Event) {
        let made = plan.carry_out(&mut self.mesh, patch);
        let (means, triangles) = (plan.means(patch), plan.triangles(patch).len());
        let event = Event::Patched { means, triangles, quads: made.len(), element: made[0] };
        if !self.keeps_journal() {
            self.mesh.commit();
        }
        if patch + 1 < plan.patches() {
            return (Phase::Patch { left, at, plan, patch: patch + 1 }, event);
        }
        self.last_resort = self.last_resort.plus(&plan.outcome());
        (Phase::Match { left, at: at + 1 }, event)
    }
}
