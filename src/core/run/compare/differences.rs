//! The decisions in which two runs differ although their fronts are the same there.
//!
//! Once two runs have parted, their states are never the same again as a whole: each later step is another one, mostly
//! because of what came before. A difference that says something new needs a place where both face the same situation.
//!
//! The *situation* of a base segment is the piece of the front around it when it is selected: the segment and its two
//! neighbours. Nodes of two runs are the same where they lie within [`NEAR`](super::NEAR) of each other. Two runs
//! *differ* in either of two ways:
//!
//! 1. Both select the same base between the same neighbours, and do not form the same quadrilateral of it. The
//!    difference is the first step in which they do not do the same: find another side, need a swap more or less, place
//!    the top elsewhere, take the attempt back.
//! 2. On both fronts two segments lie side by side between the same neighbours; one run selects the first of them, the
//!    other run the second, and not both of the quadrilaterals formed so are formed in both runs. The difference is the
//!    selection.
//!
//! What follows from a difference is no further one: the front around it is not the same any more. Neither is a mere
//! change of order, by which the same quadrilaterals are formed. Each base of a run is in one difference at most.
//!
//! Only selections and what follows from them until a quadrilateral is formed, or is not, are decisions here. Seams,
//! splits, smoothing and the clean-up of the whole mesh are not: what they change shows in the fronts.

use std::ops::Range;

use serde::Serialize;
use smallvec::SmallVec;

use super::places::{Place, Places};
use super::{Did, did};
use crate::core::convert::{Converter, Event, EventKind, WhyKind};
use crate::core::fault::Fault;
use crate::core::front::Side;
use crate::core::mesh::{Mesh, NodeId};
use crate::core::progress::{Stage, Watch};
use crate::core::run::history::History;

/// Steps between two reports of progress.
const REPORT: u64 = 1024;

/// A decision in which two runs differ although their fronts are the same around the base.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// The step of the decision in each run.
    pub steps: [u64; 2],
    /// The base of each run, by its own nodes.
    pub bases: [[NodeId; 2]; 2],
    /// Where each run has selected a neighbour of the other's base: that one, by the nodes of this run. `None` where
    /// both have the same base.
    pub not_selected: Option<[[NodeId; 2]; 2]>,
}

impl Difference {
    /// What each run did in its step, and why; where they selected different segments, also why not the other's. Both
    /// stand after that step afterwards.
    ///
    /// # Errors
    /// A conversion that cannot continue.
    pub fn told(&self, runs: [&mut History; 2]) -> Result<[Option<Did>; 2], Fault> {
        let others = self.not_selected.map_or([None; 2], |bases| bases.map(Some));
        let [a, b] = runs;
        let events = [a.event(self.steps[0])?, b.event(self.steps[1])?];
        Ok([did(a, self.steps[0], events[0], others[0])?, did(b, self.steps[1], events[1], others[1])?])
    }
}

/// The decisions from a step on in which two runs differ although their fronts are the same there, in the order of the
/// first run's steps. The states before that step are the same in both, or it is 0. The runs stand where they stood.
///
/// # Errors
/// A conversion that cannot continue, and cancellation.
pub fn differences(runs: [&mut History; 2], from: u64, watch: &mut dyn Watch) -> Result<Vec<Difference>, Fault> {
    let [a, b] = runs;
    let [a, b] = [Bases::of(a, from, watch)?, Bases::of(b, from, watch)?];
    Ok(between(&a, &b))
}

/// Nodes of the front around a base: two before A, then A and B, and two after B.
const CHAIN: usize = 6;

/// What became of a base.
#[derive(Clone, Copy)]
enum Outcome {
    /// A quadrilateral with these corners was formed.
    Formed([Place; 4]),
    /// Its loop was closed.
    Closed,
    /// It was deferred.
    Deferred,
}

/// A base that a run selected.
struct Selected {
    step: u64,
    ids: [NodeId; CHAIN],
    chain: [Place; CHAIN],
    /// Its steps, from the selection on.
    acts: Range<usize>,
    outcome: Outcome,
}

impl Selected {
    fn corners(&self) -> Option<&[Place; 4]> {
        match &self.outcome {
            Outcome::Formed(corners) => Some(corners),
            _ => None,
        }
    }
}

/// A step on the way from a base to its quadrilateral.
struct Act {
    kind: EventKind,
    /// Of an attempt that was taken back: which, and why.
    failed: Option<(u8, WhyKind)>,
    /// The nodes that it decided on: the top of a side, the ends of the top edge. Swaps on the way to it are alike
    /// wherever the nodes inside lie, which is no decision.
    nodes: SmallVec<[Place; 2]>,
}

impl Act {
    fn of(mesh: &Mesh, event: &Event) -> Act {
        let nodes: SmallVec<[NodeId; 2]> = match *event {
            Event::SideIsFront { node, .. } | Event::SideDivided { node, .. } => SmallVec::from_slice(&[node]),
            Event::SideChosen { edge } | Event::SideSwapped { edge, .. } => SmallVec::from_slice(&[edge.node]),
            Event::TopFound { ends, .. } => SmallVec::from_slice(&ends),
            _ => SmallVec::new(),
        };
        let failed = match event {
            Event::RolledBack { attempt, why } => Some((*attempt, why.kind())),
            _ => None,
        };
        Act { kind: event.kind(), failed, nodes: nodes.iter().map(|node| Place::of(mesh, *node)).collect() }
    }

    fn is_like(&self, other: &Act) -> bool {
        let are_same = |(own, its): (&Place, &Place)| own.is_at(its.at);
        (self.kind, self.failed) == (other.kind, other.failed)
            && self.nodes.len() == other.nodes.len()
            && self.nodes.iter().zip(&other.nodes).all(are_same)
    }
}

/// The bases that a run selected, in their order.
#[derive(Default)]
struct Bases {
    list: Vec<Selected>,
    acts: Vec<Act>,
}

impl Bases {
    /// Those whose quadrilateral was under way at a step or later.
    fn of(run: &mut History, from: u64, watch: &mut dyn Watch) -> Result<Bases, Fault> {
        let total = run.state().mesh.element_count() as u64;
        while run.end().is_none() {
            watch.cancel().check()?;
            run.extend(run.log().known() + REPORT);
        }
        let first = run.log().selection(from.saturating_sub(1)).unwrap_or(from).saturating_sub(1);
        let is_outcome = |kind| matches!(kind, EventKind::Formed | EventKind::Closed | EventKind::Deferred);
        let mut bases = Bases::default();
        let Some(last) = run.log().last_of(run.log().known(), is_outcome) else { return Ok(bases) };
        let mut open = None;
        run.replay_while(first, last, &mut |step, state, event| {
            if step.is_multiple_of(REPORT) {
                watch.cancel().check()?;
                watch.tell(Stage::Convert, 2 * state.standing(), total);
            }
            if let Some(event) = event {
                open = bases.note(open.take(), step, state, event);
            }
            Ok(())
        })?;
        Ok(bases)
    }

    /// Takes in a step; `open` is the base under way. Returns that after the step.
    fn note(&mut self, open: Option<Selected>, step: u64, state: &Converter<'_>, event: &Event) -> Option<Selected> {
        let mesh = &state.mesh;
        let begin = self.acts.len();
        let mut open = match *event {
            Event::BaseSelected { a, b, .. } => {
                let ids = chain(mesh, [a, b])?;
                let chain = ids.map(|node| Place::of(mesh, node));
                Selected { step, ids, chain, acts: begin..begin, outcome: Outcome::Deferred }
            }
            _ => open?,
        };
        self.acts.push(Act::of(mesh, event));
        open.acts.end = self.acts.len();
        open.outcome = match event {
            Event::Formed { nodes, .. } => Outcome::Formed(nodes.map(|node| Place::of(mesh, node))),
            Event::Closed { .. } => Outcome::Closed,
            Event::Deferred { .. } => Outcome::Deferred,
            _ => return Some(open),
        };
        self.list.push(open);
        None
    }

    fn acts(&self, selected: &Selected) -> &[Act] {
        &self.acts[selected.acts.clone()]
    }
}

/// The nodes of the front around a segment.
fn chain(mesh: &Mesh, [a, b]: [NodeId; 2]) -> Option<[NodeId; CHAIN]> {
    let h = mesh.front_between(a, b)?;
    let (before, after) = (mesh.front_before(h), mesh.front_after(h));
    let (first, last) = (mesh.front_before(before), mesh.front_after(after));
    Some([mesh.origin(first), mesh.origin(before), a, b, mesh.target(after), mesh.target(last)])
}

/// The differences between the bases of two runs, in the order of the first one's steps.
fn between(a: &Bases, b: &Bases) -> Vec<Difference> {
    let by_left_node = Places::of(a.list.iter().map(|base| base.chain[2]).collect());
    let formed_in_both = formed_in_both(a, b);
    let mut is_taken = vec![false; a.list.len()];
    let mut found = Vec::new();
    for (k, its) in b.list.iter().enumerate() {
        // The first base of A for which the nodes `own` of its chain are the nodes `others` of this one's.
        let first = |left_node: usize, own: Range<usize>, others: Range<usize>, is_taken: &[bool]| {
            let is_same = |x: &Selected| {
                x.chain[own.clone()].iter().zip(&its.chain[others.clone()]).all(|(own, its)| own.is_at(its.at))
            };
            let near = by_left_node.near(its.chain[left_node].at);
            near.filter(|&x| !is_taken[x] && is_same(&a.list[x])).min()
        };
        if let Some(x) = first(2, 1..5, 1..5, &is_taken) {
            is_taken[x] = true;
            found.extend(same_base([(a, &a.list[x]), (b, its)]));
            continue;
        }
        for side in Side::BOTH {
            // The base of B is the neighbour of that of A on this side.
            let (left_node, own, others, selected_by_b) = match side {
                Side::Left => (3, 0..5, 1..6, 1),
                Side::Right => (1, 1..6, 0..5, 3),
            };
            let Some(x) = first(left_node, own, others, &is_taken) else { continue };
            let own = &a.list[x];
            let are_formed = own.corners().is_some() && its.corners().is_some();
            if !are_formed || formed_in_both[0][x] && formed_in_both[1][k] {
                continue;
            }
            is_taken[x] = true;
            let selected_by_a = CHAIN - 2 - selected_by_b;
            found.push(Difference {
                steps: [own.step, its.step],
                bases: [base(&own.ids, 2), base(&its.ids, 2)],
                not_selected: Some([base(&own.ids, selected_by_b), base(&its.ids, selected_by_a)]),
            });
            break;
        }
    }
    found.sort_unstable_by_key(|difference| difference.steps);
    found
}

/// A segment of a chain, by where it starts.
fn base(ids: &[NodeId; CHAIN], at: usize) -> [NodeId; 2] {
    [ids[at], ids[at + 1]]
}

/// The difference in what two runs make of the same base.
fn same_base([(a, own), (b, its)]: [(&Bases, &Selected); 2]) -> Option<Difference> {
    let are_same = match (&own.outcome, &its.outcome) {
        (Outcome::Formed(own), Outcome::Formed(its)) => own.iter().zip(its).all(|(own, its)| own.is_at(its.at)),
        (own, its) => std::mem::discriminant(own) == std::mem::discriminant(its),
    };
    let [acts, others] = [a.acts(own), b.acts(its)];
    // Where all steps are alike, the last one made the difference: it placed the nodes elsewhere.
    let alike = acts.iter().zip(others).take_while(|(own, its)| own.is_like(its)).count();
    let at = alike.min(acts.len() - 1).min(others.len() - 1) as u64;
    let bases = [own, its].map(|selected| base(&selected.ids, 2));
    (!are_same).then_some(Difference { steps: [own.step + at, its.step + at], bases, not_selected: None })
}

/// For each base of both runs whether its quadrilateral is formed in the other run too, wherever that begins.
fn formed_in_both(a: &Bases, b: &Bases) -> [Vec<bool>; 2] {
    let formed = || a.list.iter().enumerate().filter_map(|(x, base)| Some((x, base.corners()?)));
    let of: Vec<usize> = formed().flat_map(|(x, _)| [x; 4]).collect();
    let corners = Places::of(formed().flat_map(|(_, corners)| *corners).collect());
    let mut found = [vec![false; a.list.len()], vec![false; b.list.len()]];
    for (k, its) in b.list.iter().enumerate() {
        let Some(its) = its.corners() else { continue };
        for x in corners.near(its[0].at).map(|corner| of[corner]) {
            let own = a.list[x].corners().is_some_and(|own| are_same_corners(own, its));
            found[0][x] |= own;
            found[1][k] |= own;
        }
    }
    found
}

/// Whether two quadrilaterals have the same corners, wherever they begin.
fn are_same_corners(own: &[Place; 4], its: &[Place; 4]) -> bool {
    (0..4).any(|by| (0..4).all(|k| own[k].is_at(its[(k + by) % 4].at)))
}
