//! The kinds of questions, and at which states each can be asked.

use super::choice::Choice;
use super::rule::Rule;
use crate::core::convert::{Event, EventKind, Phase, Purpose};
use crate::core::kernel::worded::worded;

worded! {
    /// What is asked.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Kind by name {
        /// Which front segment is the next base.
        Segment = "segment",
        /// Of which class of table 1 it is.
        Class = "class",
        /// Which edge becomes a side, or is swapped.
        Edge = "edge",
        /// Which node is removed.
        Node = "node",
        /// What happens to the top edge.
        Top = "top",
        /// Whether the attempt at the quadrilateral succeeds.
        Form = "form",
        /// Whether the front is seamed.
        Seam = "seam",
        /// Whether the front is split.
        Split = "split",
        /// How many triangles become the quadrilateral.
        Count = "count",
        /// Whether an edge or element is live.
        Live = "live",
        /// Which kind of frontal angle a node has (figure 12).
        Angle = "angle",
    }
}

impl Kind {
    /// The kind of this name.
    pub fn named(name: &str) -> Option<Kind> {
        Kind::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Whether the state answers it; the next step answers the others.
    pub fn is_of_state(self) -> bool {
        matches!(self, Kind::Live | Kind::Angle)
    }

    /// Whether it is about something that the question names.
    pub fn names_its_subject(self) -> bool {
        self.is_of_state()
    }

    /// Whether a step answers it, by the phase before the step and its event.
    pub fn is_answered_by(self, phase: &Phase, event: &Event) -> bool {
        match self {
            Kind::Segment | Kind::Class => matches!(event, Event::BaseSelected { picked: false, .. }),
            Kind::Edge => matches!(
                event.kind(),
                EventKind::SideIsFront
                    | EventKind::SideChosen
                    | EventKind::SideSwapped
                    | EventKind::TopSwapped
                    | EventKind::Enhanced
            ),
            Kind::Node => event.kind() == EventKind::NodeRemoved,
            Kind::Top => match event {
                Event::TopFound { .. } | Event::TopSwapped { .. } => true,
                Event::NodeRemoved { purpose, .. } => *purpose == Purpose::Recovery,
                Event::RolledBack { .. } => matches!(phase, Phase::RecoverTop { .. }),
                _ => false,
            },
            Kind::Form => match event {
                Event::Formed { .. } => true,
                Event::RolledBack { .. } => matches!(phase, Phase::Form { .. }),
                _ => false,
            },
            Kind::Seam => {
                matches!(event.kind(), EventKind::Seamed | EventKind::TransitionSeamed | EventKind::SeamRefused)
            }
            Kind::Split => event.is_about_a_split(),
            Kind::Count => event.kind() == EventKind::Formed,
            Kind::Live | Kind::Angle => false,
        }
    }

    /// The state at which it is asked, in words, for messages.
    pub(super) fn asks_before(self) -> &'static str {
        match self {
            Kind::Segment | Kind::Class => "before a step that selects a base, such as base_selected#1-1",
            Kind::Edge => {
                "before a step that prepares a side or swaps an edge, such as side_chosen#1-1 or top_swapped#1-1"
            }
            Kind::Node => "before a step that removes a node, such as node_removed#1-1",
            Kind::Top => "before a step that recovers the top edge, such as top_found#1-1 or top_swapped#1-1",
            Kind::Form => "before a step that forms a quadrilateral or takes one back, such as formed#1-1",
            Kind::Seam => "before a step that seams the front or refuses to, such as seamed#1-1",
            Kind::Split => "before a step that splits the front or refuses to, such as split#1-1",
            Kind::Count => "before a step that forms a quadrilateral, such as formed#1-1",
            Kind::Live | Kind::Angle => "at any state",
        }
    }

    /// What can be chosen from; none where the learner points at something or says a number.
    pub fn choices(self) -> &'static [Choice] {
        match self {
            Kind::Class => &[Choice::First, Choice::Second, Choice::Third, Choice::Fourth],
            Kind::Top => &[Choice::There, Choice::Swap, Choice::Removal, Choice::Failure],
            Kind::Form | Kind::Seam | Kind::Split | Kind::Live => &[Choice::Yes, Choice::No],
            Kind::Angle => &[Choice::Seam, Choice::Rectangle, Choice::Flat, Choice::Reversal],
            Kind::Segment | Kind::Edge | Kind::Node | Kind::Count => &[],
        }
    }

    /// The question in words, where nobody has others.
    pub fn words(self) -> &'static str {
        match self {
            Kind::Segment => "Which segment comes next?",
            Kind::Class => "Of which class is the next base?",
            Kind::Edge => "Which edge is taken next?",
            Kind::Node => "Which node is removed?",
            Kind::Top => "What happens to the top edge?",
            Kind::Form => "Will this quadrilateral be formed?",
            Kind::Seam => "Will this seam be allowed?",
            Kind::Split => "Will the front be split here?",
            Kind::Count => "How many triangles become the quadrilateral?",
            Kind::Live => "Is it live?",
            Kind::Angle => "Which kind of frontal angle is this?",
        }
    }

    /// The rule that it is about, before anybody has answered.
    pub fn rule(self, event: Option<&Event>) -> Rule {
        match (self, event.map(Event::kind)) {
            (Kind::Segment | Kind::Class, _) => Rule::Table1,
            (Kind::Edge, Some(EventKind::TopSwapped)) => Rule::TopEdge,
            (Kind::Edge, Some(EventKind::Enhanced)) => Rule::Enhancement,
            (Kind::Edge, _) => Rule::SideEdges,
            (Kind::Node, _) => match event {
                Some(Event::NodeRemoved { purpose: Purpose::Recovery, .. }) => Rule::TopEdge,
                _ => Rule::Enhancement,
            },
            (Kind::Top, _) => Rule::TopEdge,
            (Kind::Form | Kind::Count, _) => Rule::Formation,
            (Kind::Seam, _) => Rule::Seams,
            (Kind::Split, _) => Rule::Splitting,
            (Kind::Live, _) => Rule::LiveAndDead,
            (Kind::Angle, _) => Rule::Angles,
        }
    }
}
