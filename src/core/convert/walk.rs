//! A conversion walked step by step, to its end or to a stop, with a report on each step.

use std::fmt;
use std::str::FromStr;

use serde::Serialize;

use super::converter::Converter;
use super::event::Event;
use super::phase::{FinishPart, Phase};
use super::side::candidates::Candidates;
use super::split::Narrow;
use crate::core::fault::Fault;
use crate::core::kernel::number::counted;
use crate::core::mesh::NodeId;
use crate::core::progress::{Stage, Watch};

/// Where a walk stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// As soon as this many quadrilaterals stand and the local post-processing of the last one (4.3.6) is done.
    Quads(u64),
    /// After this many steps.
    Step(u64),
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Stop::Quads(quads) => write!(f, "nq={quads}"),
            Stop::Step(step) => write!(f, "step={step}"),
        }
    }
}

impl FromStr for Stop {
    type Err = ();

    /// Reads what is written: `nq=100` or `step=812`.
    fn from_str(text: &str) -> Result<Stop, ()> {
        let (kind, number) = text.split_once('=').ok_or(())?;
        let number = number.parse().map_err(|_| ())?;
        match kind {
            "nq" => Ok(Stop::Quads(number)),
            "step" => Ok(Stop::Step(number)),
            _ => Err(()),
        }
    }
}

impl Stop {
    /// Whether a converter has reached it.
    pub fn is_reached(self, converter: &Converter<'_>) -> bool {
        match self {
            Stop::Quads(quads) => quads <= converter.standing() && !converter.phase().is_local_post_processing(),
            Stop::Step(step) => step <= converter.counts.steps,
        }
    }
}

/// A report on one step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StepReport<'e> {
    /// Its number, from 1.
    pub step: u64,
    /// Quadrilaterals that stand after it.
    pub nq: u64,
    /// What it did.
    #[serde(flatten)]
    pub event: &'e Event,
    /// What a side edge was chosen from, where one was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub candidates: Option<&'e Candidates>,
    /// The edges that the line from C to D crosses, from C on, where the top edge is being recovered (4.3.4): all live;
    /// a dead one ends the recovery, and its `rolled_back` has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crossings: Option<&'e [[NodeId; 2]]>,
    /// Segments of each loop of the front that runs through the nodes at which the front has changed, after the step;
    /// an even number each (docs/algorithm.md, "The parity invariant").
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loops: Option<&'e [u32]>,
    /// The sets T and V of 4.3.6, where the front was split, or was not in spite of slender triangles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub narrow: Option<&'e Narrow>,
    /// Worst quality around the last quadrilateral before and after, where its neighbourhood was improved (4.3.6).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quality: Option<[f64; 2]>,
}

/// Receives the report on each step.
pub type Tell<'t> = &'t mut dyn FnMut(&StepReport<'_>);

/// Steps until `stop` is reached, or to the end where there is none; the same states as
/// [`Converter::run`](super::converter::Converter::run) meets. Where no history is kept, what was done stays done. What
/// an event leaves out (candidates, crossings, loops, narrow regions, qualities) is only computed where somebody
/// listens.
///
/// # Errors
/// As [`Converter::step`](super::converter::Converter::step); and where the conversion ends before the stop.
pub fn walk(
    converter: &mut Converter<'_>,
    stop: Option<Stop>,
    watch: &mut dyn Watch,
    tell: Option<Tell<'_>>,
) -> Result<(), Fault> {
    walk_editing(converter, stop, watch, tell, &mut |_, _| Ok(()))
}

/// As [`walk`]; after each step `edit`, which is told what the step did, may change parameters or pick the next base
/// segment.
///
/// # Errors
/// As [`walk`], and those of `edit`.
pub fn walk_editing(
    converter: &mut Converter<'_>,
    stop: Option<Stop>,
    watch: &mut dyn Watch,
    mut tell: Option<Tell<'_>>,
    edit: &mut dyn FnMut(&mut Converter<'_>, &Event) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let total = converter.mesh.element_count() as u64;
    watch.tell(Stage::Convert, 0, total);
    let mut shown = 0;
    while !stop.is_some_and(|stop| stop.is_reached(converter)) {
        match converter.phase() {
            Phase::Done => return stop.map_or(Ok(()), |_| Err(past_the_end(converter))),
            Phase::PostProcess { part: FinishPart::FirstSmoothing } => watch.tell(Stage::Finish, 0, 0),
            _ => {}
        }
        let crossings = tell.as_ref().and_then(|_| converter.top_crossings());
        let (candidates, element, before, narrow) = match &tell {
            Some(_) => {
                let element = converter.phase().last_formed();
                (converter.candidates(), element, element.map(|e| converter.quality_around(e)), converter.narrow())
            }
            None => (None, None, None, None),
        };
        let event = converter.step()?;
        let nq = converter.standing();
        if let Some(tell) = &mut tell {
            let quality = match (element, before) {
                (Some(element), Some(before)) if event.is_local_change() => {
                    Some([before, converter.quality_around(element)])
                }
                _ => None,
            };
            let step = converter.counts.steps;
            let (crossings, loops) = (crossings.as_deref(), converter.loops_after(&event));
            let (candidates, loops) = (candidates.as_ref(), loops.as_deref());
            let narrow = narrow.as_ref().filter(|_| event.is_about_a_split());
            tell(&StepReport { step, nq, event: &event, candidates, crossings, loops, narrow, quality });
        }
        edit(converter, &event)?;
        if shown + 1024 <= nq
            && !matches!(converter.phase(), Phase::PostProcess { .. } | Phase::NextFace | Phase::Mirror | Phase::Done)
        {
            shown = nq;
            watch.cancel().check()?;
            watch.tell(Stage::Convert, 2 * nq, total);
        }
    }
    Ok(())
}

fn past_the_end(converter: &Converter<'_>) -> Fault {
    let (steps, quads) = (converter.counts.steps, converter.standing());
    let quads = counted(quads, "quadrilateral");
    Fault::new(format!("The conversion ends after step {steps} with {quads}, before the stop"))
        .remedy(format!("Stop at step={steps} at the latest"))
}
