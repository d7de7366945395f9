//! The converter as a resumable machine (paper 4.3): one elementary operation or decision a step.
//!
//! `step` looks at the phase, does one thing, and says what comes next and what it did. `run` is a loop over it. All
//! changes go through the mesh's operators and so through the journal: an attempt that fails is taken back, and a person
//! who steps back uses the same mechanism.

use std::sync::Arc;

use smallvec::SmallVec;

use super::component::{Component, live_components};
use super::event::{Event, Why};
use super::finish::{Finished, finish};
use super::last_resort::{Outcome, last_resort};
use super::parameters::Parameters;
use super::phase::{Attempt, Base, Phase};
use super::top::{MOST_SWAPS, Recovery};
use crate::core::fault::Fault;
use crate::core::front::sector::Side;
use crate::core::front::segment::Segment;
use crate::core::front::selection::{Choice, Queue};
use crate::core::journal::Mark;
use crate::core::mesh::half_edge::{Mesh, Undone};
use crate::core::mesh::ids::{ElementId, HalfEdgeId, NodeId};
use crate::core::mesh::touched::Touched;
use crate::core::metric::field::MetricSource;
use crate::core::progress::{Stage, Watch};

/// Looks at edges for one enhancement: four times a ring's size (spec 2.8).
const ENHANCEMENTS: u8 = 48;
/// Every other edge at B, then at A, is tried up to here; the two Lee-Lo pairs come after.
const ALTERNATIVES: u8 = 4;

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
    /// Seams.
    pub seamed: u64,
    /// Front splits.
    pub split: u64,
    /// Swaps of the enhancement.
    pub enhanced: u64,
    /// Nodes removed.
    pub removed: u64,
}

/// What a step needs to be taken back.
#[derive(Clone, Debug)]
struct Record {
    phase: Phase,
    second_pass: bool,
    picked: Option<[NodeId; 2]>,
    counts: Counts,
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
    /// What gives the metric anywhere.
    pub(super) source: Arc<dyn MetricSource + Send + Sync + 'a>,
    /// Parameters; may be changed between two steps by [`Converter::set_parameters`].
    pub(super) parameters: Parameters,
    /// A cache: rebuilt from the mesh where it is missing, and then chooses the same.
    queue: Option<Queue>,
    phase: Phase,
    /// Records of the steps, where a history is kept.
    history: Option<Vec<Record>>,
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
}

impl<'a> Converter<'a> {
    /// A converter at step 0: the initial merging front is the boundary of the background mesh (4.3.2). The metric is lent
    /// (`&sizing`) or shared (`Arc<Sizing>`).
    pub fn new(mesh: Mesh, source: impl MetricSource + Send + Sync + 'a, parameters: Parameters) -> Self {
        Converter {
            mesh,
            source: Arc::new(source),
            parameters,
            queue: None,
            phase: Phase::Select,
            history: None,
            undone: None,
            step_mark: Mark::default(),
            second_pass: false,
            picked: None,
            counts: Counts::default(),
            last_resort: Outcome::default(),
            finished: Finished::default(),
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
        self.queue = None;
        true
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
        records + self.mesh.journal().bytes()
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
        let history = self.history.take();
        let rest = self.clone();
        (self.mesh, self.queue, self.history) = (mesh, queue, history);
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
        bytes.extend_from_slice(
            format!("{:?} {:?} {:?} {:?}", self.phase.plain(), self.second_pass, self.picked, self.parameters)
                .as_bytes(),
        );
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
            if self.phase == Phase::PostProcess {
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
            undo: Undo::Journal(self.mesh.mark()),
        });
        self.step_mark = self.mesh.mark();
        self.counts.steps += 1;
        let phase = std::mem::replace(&mut self.phase, Phase::Done);
        let (next, event) = match phase {
            Phase::Select => self.select()?,
            Phase::PrepareSide { base, attempt, side, left } => self.step_side(base, attempt, side, left),
            Phase::DivideSide { base, attempt, side, tops } => self.step_divide(base, attempt, side, tops),
            Phase::RecoverTop { base, attempt, tops, swaps } => self.step_top(base, attempt, tops, swaps),
            Phase::Form { base, attempt, tops } => self.step_form(base, attempt, tops),
            Phase::Retry { base, attempt } => self.retry(base, attempt),
            Phase::Enhance { element, mark, edges, budget } => self.step_enhance(element, mark, edges, budget),
            Phase::Smooth { element, mark } => self.step_smooth(element, mark),
            Phase::Seam { nodes } => self.step_seam(nodes)?,
            Phase::Close { waiting, left } => self.step_close(waiting, left)?,
            Phase::PostProcess => {
                self.finished = finish(&mut self.mesh, &*self.source, self.history.is_some());
                (Phase::Done, Event::PostProcessed)
            }
            Phase::Done => (Phase::Done, Event::Finished),
        };
        self.phase = next;
        if let (Some(history), Some(mut record)) = (&mut self.history, before) {
            if let Some(undone) = self.undone.take() {
                record.undo = Undo::Redo(undone);
            }
            history.push(record);
        }
        Ok(event)
    }

    /// Brings the queue up to date with what the journal holds since the mark.
    fn refresh(&mut self, mark: Mark) {
        let mut queue = self.take_queue();
        queue.refresh(&mut self.mesh, mark, &self.parameters);
        self.queue = Some(queue);
    }

    /// The gates that a formation must pass.
    pub(super) fn gates(&self) -> Gates {
        if self.second_pass { Gates { quality: 0.05, length: 4.0 } } else { Gates { quality: 0.15, length: 2.0 } }
    }

    /// Base segment selection (4.3.3).
    fn select(&mut self) -> Result<(Phase, Event), Fault> {
        if self.history.is_none() {
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

    /// Takes an attempt back; the next one follows.
    fn fail(&mut self, base: Base, attempt: Attempt, why: Why) -> (Phase, Event) {
        if self.history.is_some() {
            // What this very step did is not part of the state before it.
            self.mesh.take_back(self.step_mark);
            self.undone = Some(self.mesh.take_back_to_redo(attempt.mark));
        } else {
            self.mesh.take_back(attempt.mark);
        }
        self.counts.rolled_back += 1;
        (Phase::Retry { base, attempt }, Event::RolledBack { attempt: attempt.number, why })
    }

    fn step_side(&mut self, base: Base, attempt: Attempt, side: Side, left: Option<NodeId>) -> (Phase, Event) {
        match self.prepare_side(&base, &attempt, side, left) {
            Ok((top, event)) => {
                let tops = match side {
                    Side::Left => [Some(top), None],
                    Side::Right => [left, Some(top)],
                };
                let next = match event {
                    // A dead edge is never divided.
                    Event::SideIsFront { .. } => self.after_side(base, attempt, side, tops),
                    _ => Phase::DivideSide { base, attempt, side, tops },
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
    ) -> (Phase, Event) {
        let Some(top) = tops[side.index()] else { return self.fail(base, attempt, Why::NoSide(side)) };
        match self.divide_side(&base, &attempt, side, top) {
            Ok(Some((node, event))) => {
                tops[side.index()] = Some(node);
                (self.after_side(base, attempt, side, tops), event)
            }
            // Nothing to divide is no operation: the next phase does its work in this same step.
            Ok(None) => match self.after_side(base, attempt, side, tops) {
                Phase::PrepareSide { base, attempt, side, left } => self.step_side(base, attempt, side, left),
                Phase::RecoverTop { base, attempt, tops, swaps } => self.step_top(base, attempt, tops, swaps),
                other => unreachable!("after a side comes a side or the top, not {other:?}"),
            },
            Err(why) => self.fail(base, attempt, why),
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
                let edges = if self.parameters.enhancement { self.edges_around(element) } else { SmallVec::new() };
                (Phase::Enhance { element, mark: attempt.mark, edges, budget: ENHANCEMENTS }, event)
            }
            Err(why) => self.fail(base, attempt, why),
        }
    }

    /// Finds the next attempt: divisions that are forced, then every other edge at B, then at A, then the Lee-Lo pairs of
    /// the base triangle; none left puts the segment off (spec 2.4 d, 10 rules 1, 7, 9).
    fn retry(&mut self, base: Base, attempt: Attempt) -> (Phase, Event) {
        let mut number = attempt.number;
        loop {
            number = number.saturating_add(1);
            let Some(next) = self.attempt(&base, number, attempt.mark) else { break };
            let Some(next) = next else { continue };
            return self.step_side(base, next, Side::Left, None);
        }
        self.counts.deferred += 1;
        if let Some(h) = self.base_half_edge(&base) {
            let mut queue = self.take_queue();
            queue.defer(&mut self.mesh, h);
            self.queue = Some(queue);
        }
        (Phase::Select, Event::Deferred { a: base.a, b: base.b })
    }

    /// The attempt of a number: `None` past the last, `Some(None)` where it would be no different from another.
    fn attempt(&self, base: &Base, number: u8, mark: Mark) -> Option<Option<Attempt>> {
        let plain = Attempt { number, divide: [false; 2], tops: [None; 2], mark };
        let is_front = base.theta.map(|t| t < self.parameters.theta_rect);
        if number < ALTERNATIVES {
            let divide = [[false, true], [true, false], [true, true]][usize::from(number) - 1];
            let possible = !(divide[0] && is_front[0] || divide[1] && is_front[1]);
            return Some(possible.then_some(Attempt { divide, ..plain }));
        }
        let h = self.base_half_edge(base)?;
        let mut k = usize::from(number - ALTERNATIVES);
        for (side, spokes) in
            [(Side::Right, self.mesh.spokes(h, Side::Right)), (Side::Left, self.mesh.spokes(h, Side::Left))]
        {
            if let Some(spoke) = spokes.get(k) {
                let mut tops = [None; 2];
                tops[side.index()] = Some(spoke.node);
                return Some(Some(Attempt { tops, ..plain }));
            }
            k -= spokes.len();
        }
        // The base triangle with its neighbour beyond the right edge, then the left one.
        let apex = self.mesh.origin(self.mesh.previous(h));
        let (edge, beyond_right) = match k {
            0 => (self.mesh.next(h), true),
            1 => (self.mesh.previous(h), false),
            _ => return None,
        };
        let pair = self.mesh.twin(edge).filter(|t| self.mesh.is_triangle(t.element())).map(|t| {
            let far = self.mesh.origin(self.mesh.previous(t));
            let tops = if beyond_right { [Some(apex), Some(far)] } else { [Some(far), Some(apex)] };
            Attempt { tops, ..plain }
        });
        Some(pair)
    }

    /// One enhancement (4.3.6), until there is none; then smoothing.
    fn step_enhance(
        &mut self,
        element: ElementId,
        mark: Mark,
        mut edges: SmallVec<[HalfEdgeId; 24]>,
        budget: u8,
    ) -> (Phase, Event) {
        if self.parameters.enhancement && budget > 0 {
            while let Some(h) = edges.pop() {
                if let Some((event, around)) = self.enhance_edge(h) {
                    self.counts.enhanced += 1;
                    edges.extend(around);
                    return (Phase::Enhance { element, mark, edges, budget: budget - 1 }, event);
                }
            }
            if let Some(event) = self.remove_a_node(element) {
                self.counts.removed += 1;
                let edges = self.edges_around(element);
                return (Phase::Enhance { element, mark, edges, budget: budget - 1 }, event);
            }
        }
        self.step_smooth(element, mark)
    }

    /// Smoothing (4.3.6); the queue then sees everything since the base was selected.
    fn step_smooth(&mut self, element: ElementId, mark: Mark) -> (Phase, Event) {
        let nodes = if self.parameters.smoothing { self.smooth_around(element) } else { 0 };
        self.refresh(mark);
        let next = if self.parameters.seaming {
            Phase::Seam { nodes: SmallVec::from_slice(&self.mesh.quad(element)) }
        } else {
            Phase::Select
        };
        (next, Event::Smoothed { nodes })
    }

    /// One seam (4.3.6), until there is none; a selection follows in the same step where nothing is to be seamed.
    fn step_seam(&mut self, mut nodes: SmallVec<[NodeId; 8]>) -> Result<(Phase, Event), Fault> {
        while let Some(at) = nodes.pop() {
            let mark = self.mesh.mark();
            if let Some(event) = self.seam_at(at) {
                self.counts.seamed += 1;
                self.refresh(mark);
                if let Event::Seamed { node, .. } = event {
                    nodes.push(node);
                }
                return Ok((Phase::Seam { nodes }, event));
            }
        }
        self.select()
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
        let mut total = Outcome::default();
        for component in left {
            let outcome = last_resort(&mut self.mesh, &component.triangles, &*self.source)
                .map_err(|stuck| Fault::new(format!("A part of the mesh cannot be converted: {stuck}")))?;
            total = total.plus(&outcome);
        }
        self.last_resort = total;
        let next = if self.parameters.post_processing { Phase::PostProcess } else { Phase::Done };
        Ok((next, Event::LastResort(total)))
    }
}
