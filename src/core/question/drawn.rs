//! Questions drawn from a run: the same seed gives the same ones, on every machine.

use super::kind::Kind;
use super::selection::can_be_seen;
use super::series::Series;
use crate::core::convert::EventKind;
use crate::core::fault::Fault;
use crate::core::run::{FrontTable, History, Log};

/// What is asked of a run step by step, for each step the first that it answers. Nothing is asked about steps that only
/// change what is around a quadrilateral, and not whether one succeeds where it does: most do.
const ALONG: [Kind; 6] = [Kind::Segment, Kind::Edge, Kind::Top, Kind::Form, Kind::Seam, Kind::Split];

/// A question that was drawn: where it is asked, and what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Drawn {
    /// The step of the state at which it is asked.
    pub step: u64,
    /// What is asked.
    pub kind: Kind,
}

/// Draws the questions of a series from a whole run, in the order of their steps; fewer where the run has fewer. Each
/// step is asked about once. It runs to the end, unless the recorder is lent.
///
/// # Errors
/// A step of the replay failed.
pub fn draw(history: &mut History, series: &Series) -> Result<Vec<Drawn>, Fault> {
    history.extend(u64::MAX);
    let mut of_kind: Vec<(Kind, Vec<u64>)> = Vec::new();
    for &kind in &series.kinds {
        let steps = steps_of(history.log(), kind);
        if !steps.is_empty() && !of_kind.iter().any(|(known, _)| *known == kind) {
            of_kind.push((kind, steps));
        }
    }
    let mut source = Source(series.seed);
    let mut drawn: Vec<Drawn> = Vec::new();
    // Kinds take turns, so that rare ones are asked too.
    let mut turn = 0;
    while drawn.len() < series.count && !of_kind.is_empty() {
        turn %= of_kind.len();
        let (kind, steps) = &mut of_kind[turn];
        let kind = *kind;
        let step = steps.swap_remove(source.below(steps.len()));
        if steps.is_empty() {
            of_kind.remove(turn);
        } else {
            turn += 1;
        }
        let is_new = !drawn.iter().any(|known| known.step == step);
        if is_new && is_asked(history, kind, step)? {
            drawn.push(Drawn { step, kind });
        }
    }
    drawn.sort_unstable();
    Ok(drawn)
}

/// The first question that can be asked at a state or at one after it; `None` where the run has no such state, as far
/// as it is known. The current state is the same afterwards.
///
/// # Errors
/// A step of the replay failed.
pub fn following(history: &mut History, from: u64) -> Result<Option<Drawn>, Fault> {
    let events: Vec<EventKind> = history.log().kinds(from + 1, history.log().known()).collect();
    for (step, event) in (from..).zip(events) {
        for kind in ALONG.into_iter().filter(|kind| may_answer(*kind, event) && is_open(*kind, event)) {
            if is_asked(history, kind, step)? {
                return Ok(Some(Drawn { step, kind }));
            }
        }
    }
    Ok(None)
}

/// Whether the answer is no foregone conclusion: the kind of the event alone does not give it.
fn is_open(kind: Kind, event: EventKind) -> bool {
    !matches!((kind, event), (Kind::Edge, EventKind::Enhanced) | (Kind::Form, EventKind::Formed))
}

/// The states before steps that may answer questions of a kind.
fn steps_of(log: &Log, kind: Kind) -> Vec<u64> {
    log.kinds(1, log.known()).zip(0..).filter(|(event, _)| may_answer(kind, *event)).map(|(_, before)| before).collect()
}

/// Whether a step with such an event may answer questions of a kind.
fn may_answer(kind: Kind, event: EventKind) -> bool {
    match kind {
        Kind::Segment | Kind::Class => event == EventKind::BaseSelected,
        Kind::Edge => matches!(
            event,
            EventKind::SideIsFront
                | EventKind::SideChosen
                | EventKind::SideSwapped
                | EventKind::TopSwapped
                | EventKind::Enhanced
        ),
        Kind::Node => event == EventKind::NodeRemoved,
        Kind::Top => matches!(
            event,
            EventKind::TopFound | EventKind::TopSwapped | EventKind::NodeRemoved | EventKind::RolledBack
        ),
        Kind::Form => matches!(event, EventKind::Formed | EventKind::RolledBack),
        Kind::Seam => {
            matches!(event, EventKind::Seamed | EventKind::TransitionSeamed | EventKind::SeamRefused)
        }
        Kind::Split => matches!(event, EventKind::Split | EventKind::SplitRefused),
        Kind::Count => event == EventKind::Formed,
        Kind::Live | Kind::Angle => false,
    }
}

/// Whether the question can be asked there, and answered by looking: events do not say in which phase they were, nor
/// how near a second one came.
fn is_asked(history: &mut History, kind: Kind, step: u64) -> Result<bool, Fault> {
    if !matches!(kind, Kind::Top | Kind::Form | Kind::Segment | Kind::Class) {
        return Ok(true);
    }
    let at = history.step();
    history.seek(step)?;
    let event = history.event(step + 1)?;
    let is_answered = event.is_some_and(|event| kind.is_answered_by(history.state().phase(), &event));
    let is = is_answered && (kind != Kind::Segment || can_be_seen(&FrontTable::of(history.state())));
    history.seek(at)?;
    Ok(is)
}

/// Numbers from a seed (Steele, Lea and Flood 2014, SplitMix64).
struct Source(u64);

impl Source {
    /// A number below a bound, which is positive. The bias is that of 64 bits.
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z % bound.max(1) as u64) as usize
    }
}
