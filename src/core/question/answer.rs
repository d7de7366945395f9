//! Answers: something that is pointed at, a choice, or a number.

use super::kind::Kind;
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::spelling::suggestion;
use crate::core::kernel::worded::worded;
use crate::core::mesh::NodeId;
use crate::core::run::Sought;
use crate::core::run::explain::edge;

worded! {
    /// What a learner chooses from.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Choice by name {
        /// Yes.
        Yes = "yes",
        /// No.
        No = "no",
        /// Class 1 of table 1.
        First = "1",
        /// Class 2.
        Second = "2",
        /// Class 3.
        Third = "3",
        /// Class 4.
        Fourth = "4",
        /// The top edge is there.
        There = "there",
        /// An edge is swapped for it.
        Swap = "swap",
        /// A node is removed for it.
        Removal = "removal",
        /// The attempt fails.
        Failure = "failure",
        /// At most theta_seam.
        Seam = "seam",
        /// Below theta_rect.
        Rectangle = "rectangle",
        /// From theta_rect to theta_revr.
        Flat = "flat",
        /// Beyond theta_revr.
        Reversal = "reversal",
    }
}

impl Choice {
    /// The class of table 1.
    pub(super) fn of_class(class: u8) -> Choice {
        match class {
            1 => Choice::First,
            2 => Choice::Second,
            3 => Choice::Third,
            _ => Choice::Fourth,
        }
    }

    /// Yes or no.
    pub(super) fn of(is: bool) -> Choice {
        if is { Choice::Yes } else { Choice::No }
    }

    /// Its words for readers.
    pub fn words(self) -> &'static str {
        match self {
            Choice::Yes => "Yes",
            Choice::No => "No",
            Choice::First => "Class 1",
            Choice::Second => "Class 2",
            Choice::Third => "Class 3",
            Choice::Fourth => "Class 4",
            Choice::There => "It is there already",
            Choice::Swap => "An edge across it is swapped",
            Choice::Removal => "A node in its way is removed",
            Choice::Failure => "It cannot be recovered",
            Choice::Seam => "Narrow enough for a seam",
            Choice::Rectangle => "Below \u{3b8}_{rect}",
            Choice::Flat => "From \u{3b8}_{rect} to \u{3b8}_{revr}",
            Choice::Reversal => "A reversal",
        }
    }
}

/// What a learner answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// An edge or a segment, in either direction.
    Edge([NodeId; 2]),
    /// A node.
    Node(NodeId),
    /// A choice.
    Choice(Choice),
    /// A number.
    Number(u32),
}

impl Answer {
    /// Reads an answer to a question of a kind: an edge by its nodes (`12-40`), a node by its number, a choice by its
    /// name, a number.
    ///
    /// # Errors
    /// A text of another form, or a choice that the question does not have.
    pub fn parse(kind: Kind, text: &str) -> Result<Answer, Fault> {
        let text = text.trim();
        let wrong = |example: &str| {
            Fault::new(format!("\"{}\" is no answer to a question of the kind {}", text.escape_debug(), kind.name()))
                .of_kind(FaultKind::Syntax)
                .remedy(format!("Write for example {example}"))
        };
        let choices = kind.choices();
        if !choices.is_empty() {
            let names = || choices.iter().map(|choice| choice.name());
            let found = choices.iter().find(|choice| choice.name() == text.to_lowercase());
            return found.map(|choice| Answer::Choice(*choice)).ok_or_else(|| match suggestion(text, names()) {
                Some(near) => wrong("").remedy(near),
                None => wrong(&names().collect::<Vec<_>>().join(", ")),
            });
        }
        match (kind, Sought::parse(text)) {
            (Kind::Count, Ok(Sought::Step(n))) => u32::try_from(n).map(Answer::Number).map_err(|_| wrong("4")),
            (Kind::Count, _) => Err(wrong("4")),
            (Kind::Node, Ok(Sought::Node(node))) => Ok(Answer::Node(node)),
            (Kind::Node, Ok(Sought::Step(n))) => {
                u32::try_from(n).map(|n| Answer::Node(NodeId(n))).map_err(|_| wrong("7"))
            }
            (Kind::Node, _) => Err(wrong("7")),
            (_, Ok(Sought::Edge(ends) | Sought::Segment(ends))) => Ok(Answer::Edge(ends)),
            _ => Err(wrong("12-40")),
        }
    }

    /// The answer for readers.
    pub fn words(self) -> String {
        match self {
            Answer::Edge(ends) => edge(ends),
            Answer::Node(node) => format!("node {}", node.0),
            Answer::Choice(choice) => choice.words().to_owned(),
            Answer::Number(number) => number.to_string(),
        }
    }

    /// The answer as [`Answer::parse`] reads it.
    pub fn text(self) -> String {
        match self {
            Answer::Edge([a, b]) => format!("{}-{}", a.0, b.0),
            Answer::Node(node) => node.0.to_string(),
            Answer::Choice(choice) => choice.name().to_owned(),
            Answer::Number(number) => number.to_string(),
        }
    }
}
