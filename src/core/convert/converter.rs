//! The converter as a resumable machine (paper 4.3): one elementary operation or decision a step.
//!
//! `step` looks at the phase, does one thing, and says what comes next and what it did. `run` is a loop over it. All
//! changes go through the mesh's operators and so through the journal: an attempt that fails is taken back, and a
//! person who steps back uses the same mechanism.

mod formation;
mod post_processing;
mod taking_back;

use std::sync::Arc;

use taking_back::Record;

use super::component::{Component, live_components};
use super::event::Event;
use super::finish::{Finished, Finishing};
use super::helping::next_message;
use super::last_resort::{Outcome, Plan};
use super::phase::{Attempt, Base, Part, Phase};
use crate::core::case::parameters::Parameters;
use crate::core::fault::Fault;
use crate::core::front::sector::Side;
use crate::core::front::segment::Segment;
use crate::core::front::selection::{Choice, Queue};
use crate::core::kernel::fingerprint::Fingerprint;
use crate::core::mesh::half_edge::{Mesh, Undone};
use crate::core::mesh::ids::{HalfEdgeId, NodeId};
use crate::core::mesh::journal::Mark;
use crate::core::metric::field::MetricSource;
use crate::core::progress::{Stage, Watch};

/// What a face tells that is converted at the same time as others.
enum OfFace<'a> {
    /// How many quadrilaterals it has formed so far.
    Formed(u64),
    /// It is at its end.
    Done(Box<Result<Converter<'a>, Fault>>),
}

/// Steps between two tellings of how far it is.
const TELL: u64 = 2048;

/// Least quality and largest new edge that a formation may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gates {
    pub quality: f64,
    pub length: f64,
}

/// How often what happened, since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Counts {
    /// Steps.
    pub steps: u64,
    /// Quadrilaterals formed by the front.
    pub formed: u64,
    /// Of those, how many with another right side (4.3.4).
    pub right_replaced: u64,
    /// Of those, how many with another left side or a Lee-Lo pair (docs/algorithm.md, "Rescue").
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

impl Counts {
    /// The sums of two.
    #[must_use]
    pub fn plus(&self, other: &Counts) -> Counts {
        Counts {
            steps: self.steps + other.steps,
            formed: self.formed + other.formed,
            right_replaced: self.right_replaced + other.right_replaced,
            rescued: self.rescued + other.rescued,
            rolled_back: self.rolled_back + other.rolled_back,
            deferred: self.deferred + other.deferred,
            closed: self.closed + other.closed,
            seamed: self.seamed + other.seamed,
            transitions: self.transitions + other.transitions,
            split: self.split + other.split,
            enhanced: self.enhanced + other.enhanced,
            removed: self.removed + other.removed,
        }
    }
}

/// Where the conversion of a face began.
#[derive(Clone, Copy, Debug, Default)]
struct Begun {
    /// Quadrilaterals that stood.
    stood: u64,
    /// Quadrilaterals that front and last resort had made.
    made: u64,
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
    /// Whether steps leave the journal to whoever drives them, who forgets it where nothing is under way.
    journal_kept: bool,
    /// What the step at hand took back, where a history is kept.
    undone: Option<Vec<Undone>>,
    /// Where the journal stood before the step at hand.
    step_mark: Mark,
    /// Whether the gates are wide: every segment was put off and taken up again.
    second_pass: bool,
    /// On surfaces: the faces, which are converted one after another, by region. Else none, and all is converted
    /// together.
    faces: Arc<[u32]>,
    /// Which of them is being converted; past the last one, none.
    face: usize,
    /// Elements of the faces after each, at step 0.
    waiting: Arc<[u64]>,
    /// Elements at step 0, and, where this is one of several faces at the same time, of all together.
    elements_at_first: u64,
    total: u64,
    /// What stood and had been counted when the face at hand was turned to.
    begun: Begun,
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
    /// That of the faces before, for whoever steps back.
    finished_faces: Vec<Finishing<'a>>,
}

impl<'a> Converter<'a> {
    /// A converter at step 0: the initial merging front is the boundary of the background mesh (4.3.2). The metric is
    /// lent (`&sizing`) or shared (`Arc<Sizing>`).
    pub fn new(mesh: Mesh, source: impl MetricSource + Send + Sync + 'a, parameters: Parameters) -> Self {
        let faces = if mesh.ground().is_some() { mesh.faces() } else { Vec::new() };
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
            elements_at_first: mesh.element_count() as u64,
            total: mesh.element_count() as u64,
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

    /// Lets the next selection choose the front segment from A to B, whatever its rank: a person's choice, and its
    /// event says so. Where it is not on the front any more when the selection comes, [`Event::PickLost`] says that.
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

    /// Appends the canonical serialisation of the state: mesh, front, phase and what the next steps depend on. Equal
    /// bytes are equal states; caches and counts are left out.
    pub fn write_state(&self, bytes: &mut Vec<u8>) {
        self.mesh.write_state(bytes);
        self.finishing.write_state(bytes);
        bytes.extend_from_slice(
            format!(
                "{:?} {:?} {:?} {:?} {:?}",
                self.phase.plain(),
                self.second_pass,
                self.face,
                self.picked,
                self.parameters
            )
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
        let face = self.face();
        self.queue.get_or_insert_with(|| Queue::of(&self.mesh, face, &self.parameters))
    }

    /// The number of quadrilaterals that stand.
    pub fn standing(&self) -> u64 {
        match &self.phase {
            // Everything but the faces to come is a quadrilateral, also what clean-up has put in the place of others.
            Phase::PostProcess { .. } | Phase::NextFace | Phase::Done => self.all_but_waiting(),
            phase => {
                let last = if let Phase::Patch { plan, patch, .. } = phase { plan.quads_before(*patch) } else { 0 };
                self.begun.stood + self.made() - self.begun.made + last as u64
            }
        }
    }

    /// How much of the whole mesh the face at hand is, from 0 to 1: its share of what is bounded for the whole.
    pub(super) fn share(&self) -> f64 {
        let after = |face: usize| self.waiting.get(face).copied().unwrap_or(0);
        let own = match self.face.checked_sub(1) {
            _ if self.faces.is_empty() => self.total,
            Some(before) => after(before) - after(self.face),
            // The first face is what is left of all; of a face alone, that is the face.
            None => self.elements_at_first - after(0),
        };
        own as f64 / self.total.max(1) as f64
    }

    /// Quadrilaterals that front and last resort have made so far.
    fn made(&self) -> u64 {
        self.counts.formed + self.counts.closed + self.last_resort.quads() as u64
    }

    fn all_but_waiting(&self) -> u64 {
        self.mesh.element_count() as u64 - self.waiting.get(self.face).copied().unwrap_or(0)
    }

    /// The face that is being converted, by its region; none where all is converted together.
    pub fn face(&self) -> Option<u32> {
        self.faces.get(self.face).copied()
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
        watch.tell(Stage::Convert, 2 * self.counts.formed, total);
        while self.phase != Phase::Done {
            if self.counts.steps.is_multiple_of(TELL) {
                watch.cancel().check()?;
                if !matches!(self.phase, Phase::PostProcess { .. }) {
                    watch.tell(Stage::Convert, 2 * self.counts.formed, total);
                }
            }
            if self.phase == (Phase::PostProcess { part: Part::FirstSmoothing }) {
                watch.tell(Stage::Finish, 0, 0);
            }
            self.step()?;
        }
        Ok(())
    }

    /// Runs to the end, the faces at the same time: the same mesh to the last bit as one after another. Only from step
    /// 0, and where no history is kept.
    ///
    /// # Errors
    /// As [`Converter::step`].
    pub fn run_by_faces(&mut self, watch: &mut dyn Watch) -> Result<(), Fault> {
        if self.faces.len() < 2
            || !self.mesh.is_dense()
            || self.counts.steps > 0
            || self.picked.is_some()
            || self.keeps_journal()
        {
            return self.run(watch);
        }
        let total = self.mesh.element_count() as u64;
        watch.tell(Stage::Convert, 0, total);
        let mut parts = self.mesh.face_meshes();
        let cancel = watch.cancel();
        let (sender, receiver) = std::sync::mpsc::channel();
        let mut done: Vec<Option<Result<Converter<'a>, Fault>>> = parts.iter().map(|_| None).collect();
        rayon::in_place_scope(|scope| {
            for (k, part) in parts.iter_mut().enumerate() {
                let (mesh, sender) = (std::mem::take(&mut part.mesh), sender.clone());
                let (source, parameters) = (Arc::clone(&self.source), self.parameters.clone());
                let cancel = cancel.clone();
                scope.spawn(move |_| {
                    let mut converter = Converter { total, ..Converter::new(mesh, source, parameters) };
                    let face = loop {
                        if converter.counts.steps.is_multiple_of(TELL) {
                            if let Err(stopped) = cancel.check() {
                                break Err(stopped);
                            }
                            let _ = sender.send((k, OfFace::Formed(converter.counts.formed)));
                        }
                        match converter.step() {
                            Ok(Event::FaceConverted { .. }) => break Ok(converter),
                            Ok(_) => {}
                            Err(fault) => break Err(fault),
                        }
                    };
                    // Whoever listens stays until all are there.
                    let _ = sender.send((k, OfFace::Done(Box::new(face))));
                });
            }
            drop(sender);
            let mut formed = vec![0; done.len()];
            let mut all = 0;
            while let Some((k, told)) = next_message(&receiver) {
                let own = match &told {
                    OfFace::Formed(own) => *own,
                    OfFace::Done(face) => face.as_ref().as_ref().map_or(formed[k], |converter| converter.counts.formed),
                };
                all = all + own - formed[k];
                formed[k] = own;
                watch.tell(Stage::Convert, 2 * all, total);
                if let OfFace::Done(face) = told {
                    done[k] = Some(*face);
                }
            }
        });
        for (part, face) in parts.iter_mut().zip(done) {
            let Some(face) = face else { return Err(Fault::new("A face was not converted to its end")) };
            let face = face?;
            part.mesh = face.mesh;
            self.counts = self.counts.plus(&face.counts);
            self.last_resort = self.last_resort.plus(&face.last_resort);
            self.finished = self.finished.plus(&face.finished);
            self.phase = face.phase;
        }
        self.mesh.put_back(parts);
        self.face = self.faces.len();
        self.run(watch)
    }

    /// Does one elementary operation or decision.
    ///
    /// # Errors
    /// Where what is left over cannot be converted even by the last resort: a bug, or a mesh that broke its promises.
    pub fn step(&mut self) -> Result<Event, Fault> {
        let before = self.record();
        self.step_mark = self.mesh.mark();
        self.counts.steps += 1;
        let phase = std::mem::replace(&mut self.phase, Phase::Done);
        let (next, event) = self.act(phase)?;
        self.phase = next;
        self.remember(before);
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
            Phase::NextFace => Ok(self.step_next_face()),
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
            let mut components = live_components(&self.mesh, self.face());
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

    /// Closes the next small loop that is left over (docs/algorithm.md, "Small loops"); what cannot be closed goes to
    /// the last resort together.
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

    /// Turns to the next face; past the last one, what the faces have in common is looked at.
    fn step_next_face(&mut self) -> (Phase, Event) {
        let event = Event::FaceConverted { region: self.face().unwrap_or(0) };
        self.begun = Begun { stood: self.all_but_waiting(), made: self.made() };
        self.mesh.close_free_lists();
        let finishing = std::mem::take(&mut self.finishing);
        if self.keeps_history() {
            self.finished_faces.push(finishing);
        }
        self.face += 1;
        self.second_pass = false;
        self.queue = None;
        let next = match self.face() {
            Some(_) => Phase::Select,
            None if self.parameters.post_processing => Phase::PostProcess { part: Part::Unfolding },
            None => Phase::Done,
        };
        (next, event)
    }

    /// Matches the triangles of the next component that is left over (docs/algorithm.md, "The last resort"); past the
    /// last one all are converted.
    fn step_match(&mut self, left: Arc<[Component]>, at: usize) -> Result<(Phase, Event), Fault> {
        let Some(component) = left.get(at) else {
            let next = if self.parameters.post_processing {
                Phase::PostProcess { part: Part::FirstSmoothing }
            } else if self.face().is_some() {
                Phase::NextFace
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
