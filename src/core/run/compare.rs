//! Two runs side by side: the first step after which they are not in the same state, and what each of them did in it.
//!
//! The state is the mesh with the phase of the converter; a parameter, or a number that a step looks at, is no part of
//! it. So runs with different parameters are the same until one of them decides something else.

mod differences;
mod in_space;
mod overlap;
mod places;

use serde::Serialize;

pub use differences::{Difference, differences};
pub use in_space::NodesInSpace;
pub use overlap::Overlap;
pub use places::NEAR;

use super::explain::{self, Selecting, plain};
use super::history::{Changes, History};
use crate::core::convert::{Converter, Event};
use crate::core::fault::Fault;
use crate::core::mesh::NodeId;
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
