//! What a state is about: the corners of the quadrilateral under way, or of the last one, and the next step.

use crate::core::convert::{Converter, Event, EventKind, Phase};
use crate::core::fault::Fault;
use crate::core::mesh::{ElementId, NodeId};
use crate::core::run::{History, Log};

/// A state of a run, with what is before and after it.
pub(super) struct Subject<'h> {
    /// The state.
    pub state: &'h Converter<'static>,
    /// What the steps did.
    pub log: &'h Log,
    /// The corners A, B, C and D, as far as they are known.
    pub corners: [Option<NodeId>; 4],
    /// The last quadrilateral that was formed, where it stands.
    pub quad: Option<ElementId>,
    /// What the last step did.
    pub last: Option<Event>,
    /// What the next step does.
    pub next: Option<Event>,
}

impl Subject<'_> {
    /// The current state of a history.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub(super) fn of(history: &mut History) -> Result<Subject<'_>, Fault> {
        let step = history.step();
        history.extend(step + 1);
        let last = history.event(step)?;
        let next = history.event(step + 1)?;
        let formed = history.log().last_of(step, |kind| kind == EventKind::Formed);
        let formed = formed.map(|step| history.event(step)).transpose()?.flatten();
        let (state, log) = (history.state(), history.log());
        let mesh = &state.mesh;
        let quad = match formed {
            Some(Event::Formed { element, .. }) if mesh.has_element(element) && mesh.is_quad(element) => Some(element),
            _ => None,
        };
        let corners = match (state.phase().base(), quad) {
            (Some(base), _) => {
                let [c, d] = tops(state.phase());
                [Some(base.a), Some(base.b), c, d]
            }
            (None, Some(quad)) => {
                let [a, b, d, c] = mesh.quad(quad);
                [a, b, c, d].map(Some)
            }
            (None, None) => [None; 4],
        };
        Ok(Subject { state, log, corners, quad, last, next })
    }

    /// The base of the quadrilateral under way; none between two of them.
    pub(super) fn base(&self) -> Option<[NodeId; 2]> {
        self.state.phase().base().map(|base| [base.a, base.b])
    }
}

/// The tops C and D, as far as they are decided.
fn tops(phase: &Phase) -> [Option<NodeId>; 2] {
    match phase {
        Phase::PrepareSide { left, .. } => [*left, None],
        Phase::DivideSide { tops, .. } => *tops,
        Phase::RecoverTop { tops, .. } | Phase::Form { tops, .. } => tops.map(Some),
        _ => [None; 2],
    }
}
