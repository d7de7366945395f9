//! What a step at which the run stops is about: it is selected, so that the inspector tells of it.

use crate::app::window::session::Moment;
use crate::core::convert::{Cleaning, Event};
use crate::core::front::Side;
use crate::core::run::Watched;
use crate::render::scene::{Decision, Outlined};

/// What a stop is about: what is watched, or else what the step did; none if that is gone.
pub(super) fn subject(moment: &Moment, watched: Option<Watched>) -> Option<Outlined> {
    let base = moment.selecting.base.map(|base| [base.a, base.b]).or(Decision::of(&moment.phase).base);
    let from = |side: Side| base.map(|base| base[side.index()]);
    let subject = match (watched, moment.event.as_ref()?) {
        (Some(Watched::Node(node)), _) => Outlined::Node(node),
        (Some(Watched::Edge(a, b)), _) => Outlined::Edge([a, b]),
        (Some(Watched::Element(element)), _) => Outlined::Element(element),
        (None, event) => match *event {
            Event::BaseSelected { a, b, .. } | Event::PickLost { a, b } | Event::Deferred { a, b } => {
                Outlined::Edge([a, b])
            }
            Event::SideIsFront { side, node } => Outlined::Edge([from(side)?, node]),
            Event::SideChosen { edge } | Event::SideSwapped { edge, .. } => {
                Outlined::Edge([from(edge.side)?, edge.node])
            }
            Event::TopSwapped { new, .. } | Event::Enhanced { new } => Outlined::Edge(new),
            Event::TopFound { ends, .. } => Outlined::Edge(ends),
            Event::Formed { element, .. }
            | Event::SplitRefused { element, .. }
            | Event::Patched { element, .. }
            | Event::Unfolded { element, .. } => Outlined::Element(element),
            Event::Seamed { at, .. } | Event::TransitionSeamed { at, .. } | Event::SeamRefused { at, .. } => {
                Outlined::Node(at)
            }
            Event::Split { node, .. } | Event::SideDivided { node, .. } => Outlined::Node(node),
            Event::Cleaned { what: Cleaning::EdgeRotated { new, .. }, .. } => Outlined::Edge(new),
            Event::Cleaned { what: Cleaning::DiamondCollapsed { kept, .. }, .. } => Outlined::Node(kept),
            Event::Cleaned { what: Cleaning::VertexOpened { node, .. }, .. } => Outlined::Node(node),
            Event::RolledBack { .. } | Event::NodeRemoved { .. } | Event::TopSmoothed { .. } => Outlined::Edge(base?),
            _ => return None,
        },
    };
    let mesh = &moment.mesh;
    let is_there = match subject {
        Outlined::Node(node) => mesh.has_node(node),
        Outlined::Edge([a, b]) => mesh.has_node(a) && mesh.has_node(b) && mesh.are_joined(a, b),
        Outlined::Element(element) => mesh.has_element(element),
    };
    is_there.then_some(subject)
}
