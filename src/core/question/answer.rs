//! Answers: something that is pointed at, a choice, or a number.

use super::choice::Choice;
use super::kind::Kind;
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::spelling::suggestion;
use crate::core::mesh::NodeId;
use crate::core::run::Sought;
use crate::core::run::explain::edge;

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
