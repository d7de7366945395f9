//! Two runs side by side: the first step after which they are not in the same state, and what each of them did in it.
//!
//! The state is the mesh with the phase of the converter; a parameter, or a number that a step looks at, is no part of
//! it. So runs with different parameters are the same until one of them decides something else.

use serde::Serialize;

use rustc_hash::FxHashSet;

use super::explain::{self, Selecting, plain};
use super::history::{Changes, History};
use crate::core::convert::{Converter, Event};
use crate::core::fault::Fault;
use crate::core::mesh::{ElementId, Mesh, NodeId};
use crate::core::progress::{Stage, Watch};

/// Steps between two reports of progress.
const REPORT: u64 = 1024;

/// The first step after which two runs are not in the same state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FirstDifference {
    /// The step; 0 where the background meshes differ.
    pub step: u64,
    /// What each run did in it: nothing at step 0, and where a run had ended before.
    pub did: [Option<Did>; 2],
}

/// What a run did in a step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Did {
    /// Its event.
    pub event: Event,
    /// The same in one line.
    pub text: String,
    /// What it looked at and why it decided so, a sentence each. Where both runs selected a base segment, also why this
    /// one did not select that of the other.
    pub why: Vec<String>,
}

/// Steps two runs from their beginning until they are not in the same state, and says what they did last. `None` where
/// they never differ. Both stand after that step afterwards, or at their ends.
///
/// # Errors
/// A conversion that cannot continue, and cancellation.
pub fn first_difference(
    [first, second]: [&mut History; 2],
    watch: &mut dyn Watch,
) -> Result<Option<FirstDifference>, Fault> {
    for run in [&mut *first, &mut *second] {
        run.seek(0)?;
        run.take_changes();
    }
    let total = first.state().mesh.element_count() as u64;
    if !is_same([first.state(), second.state()], [&Changes::Everything; 2]) {
        return Ok(Some(FirstDifference { step: 0, did: [None, None] }));
    }
    loop {
        let step = first.step() + 1;
        let going = [first.forward()?.is_some(), second.forward()?.is_some()];
        match going {
            [false, false] => return Ok(None),
            [true, true] => {
                let changes = [first.take_changes(), second.take_changes()];
                if is_same([first.state(), second.state()], changes.each_ref()) {
                    if step.is_multiple_of(REPORT) {
                        watch.cancel().check()?;
                        watch.tell(Stage::Convert, 2 * first.state().standing(), total);
                    }
                    continue;
                }
            }
            _ => {}
        }
        return told(step, [first, second]).map(Some);
    }
}

/// Whether two states are the same, of which no more than these changes can differ.
fn is_same([a, b]: [&Converter<'_>; 2], changes: [&Changes; 2]) -> bool {
    let meshes_are_same = match changes {
        [Changes::Some { nodes, elements }, Changes::Some { nodes: others, elements: other_elements }] => {
            a.mesh.is_same_at(&b.mesh, nodes, elements) && a.mesh.is_same_at(&b.mesh, others, other_elements)
        }
        _ => a.mesh.is_same(&b.mesh),
    };
    meshes_are_same && a.phase().plain() == b.phase().plain()
}

/// What both runs did in a step.
fn told(step: u64, [first, second]: [&mut History; 2]) -> Result<FirstDifference, Fault> {
    let events = [first.event(step)?, second.event(step)?];
    let bases = events.map(|event| event.as_ref().and_then(base));
    let [a, b] = events;
    let did = [did(first, step, a, bases[1])?, did(second, step, b, bases[0])?];
    Ok(FirstDifference { step, did })
}

/// The base segment that an event selected.
fn base(event: &Event) -> Option<[NodeId; 2]> {
    match *event {
        Event::BaseSelected { a, b, .. } => Some([a, b]),
        _ => None,
    }
}

/// What a run did in a step, where it did anything. It stands after that step afterwards.
///
/// # Errors
/// A conversion that cannot continue.
pub fn did_at(run: &mut History, step: u64) -> Result<Option<Did>, Fault> {
    let event = if step == 0 { None } else { run.event(step)? };
    did(run, step, event, None)
}

/// What a run did in a step, where it did anything; `other` is the base segment that the other run selected.
fn did(run: &mut History, step: u64, event: Option<Event>, other: Option<[NodeId; 2]>) -> Result<Option<Did>, Fault> {
    let Some(event) = event else { return Ok(None) };
    run.seek(step - 1)?;
    let looked_at = run.state().looks_at();
    run.seek(step)?;
    let mut why = explain::about(&event, &looked_at, run.state());
    if let Some([a, b]) = base(&event) {
        let selecting = run.selecting()?;
        why.extend(about_segment(&selecting, run.state(), [a, b]));
        if let Some(other) = other.filter(|other| *other != [a, b]) {
            let sentences = about_segment(&selecting, run.state(), other).join(" ");
            why.push(format!("Why not {}? {sentences}", explain::segment(other)));
        }
    }
    let why = why.iter().map(|sentence| plain(sentence)).collect();
    Ok(Some(Did { event, text: plain(&explain::event(&event)), why }))
}

/// Why a segment was selected or not; nothing where it was not on the front.
fn about_segment(selecting: &Selecting, state: &Converter<'_>, [a, b]: [NodeId; 2]) -> Vec<String> {
    selecting.explain(state, a, b).map_or_else(|| vec!["It is not on this front.".to_owned()], |told| told.why)
}

/// The quadrilaterals that two meshes have in common.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Overlap {
    /// How many both have: their nodes lie within [`NEAR`] of each other.
    pub both: usize,
    /// Those that only the first mesh has, and those that only the second one has, in the order of their ids.
    pub only: [Vec<ElementId>; 2],
}

/// How near two nodes must be to count as one, as a length in the metric, in which an edge has length 1.
pub const NEAR: f64 = 0.1;

impl Overlap {
    /// Compares the quadrilaterals of two meshes by the places of their nodes in the parametric plane.
    pub fn of(a: &Mesh, b: &Mesh) -> Overlap {
        let [first, second] = [a, b].map(quads);
        let near = nearest_nodes(a, b);
        let corners_in_a = |corners: [NodeId; 4]| -> Option<[NodeId; 4]> {
            let mut found = corners;
            for node in &mut found {
                *node = near[node.index()]?;
            }
            found.sort_unstable();
            Some(found)
        };
        let mut of_b = FxHashSet::default();
        let mut only_b = Vec::new();
        let of_a: FxHashSet<[NodeId; 4]> = first.iter().map(|quad| quad.1).collect();
        for &(element, corners) in &second {
            // Two quadrilaterals of B that lie near one of A count once.
            match corners_in_a(corners).filter(|corners| of_a.contains(corners)) {
                Some(corners) if of_b.insert(corners) => {}
                _ => only_b.push(element),
            }
        }
        let only_a = first.iter().filter(|quad| !of_b.contains(&quad.1)).map(|quad| quad.0).collect();
        Overlap { both: of_b.len(), only: [only_a, only_b] }
    }

    /// The share of the quadrilaterals that both have among those of either; 1 where there are none.
    pub fn share(&self) -> f64 {
        let all = self.both + self.only[0].len() + self.only[1].len();
        if all == 0 { 1.0 } else { self.both as f64 / all as f64 }
    }
}

/// The quadrilaterals of a mesh with their corners, sorted.
fn quads(mesh: &Mesh) -> Vec<(ElementId, [NodeId; 4])> {
    let sorted = |element: ElementId| {
        let mut corners = [NodeId(0); 4];
        for (corner, node) in corners.iter_mut().zip(mesh.corners(element)) {
            *corner = node;
        }
        corners.sort_unstable();
        (element, corners)
    };
    mesh.elements().filter(|e| mesh.is_quad(*e)).map(sorted).collect()
}

/// For each node of `b`, by its index, the nearest node of `a` in the metric at `b`, if it is near enough.
fn nearest_nodes(a: &Mesh, b: &Mesh) -> Vec<Option<NodeId>> {
    let mut by_u: Vec<NodeId> = a.nodes().collect();
    by_u.sort_unstable_by(|x, y| a.uv(*x).x.total_cmp(&a.uv(*y).x));
    let mut near = vec![None; b.nodes().map(|n| n.index() + 1).max().unwrap_or(0)];
    for node in b.nodes() {
        let (at, metric) = (b.uv(node), b.metric(node));
        // Half the width of the ball of this radius along u.
        let width = NEAR * (metric.vv / metric.det()).sqrt();
        let start = by_u.partition_point(|n| a.uv(*n).x < at.x - width);
        let strip = by_u[start..].iter().take_while(|n| a.uv(**n).x <= at.x + width);
        let found = strip.map(|n| (metric.norm2(a.uv(*n) - at), *n)).min_by(|x, y| x.0.total_cmp(&y.0));
        near[node.index()] = found.filter(|found| found.0 <= NEAR * NEAR).map(|found| found.1);
    }
    near
}
