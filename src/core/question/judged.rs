//! The judgement of an answer, and hints.

use super::rule::Rule;
use crate::core::kernel::worded::worded;
use crate::core::mesh::NodeId;

worded! {
    /// How good an answer is.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Verdict by name {
        /// It is what the step does, or nothing but rounding tells it from that.
        Right = "right",
        /// The rule is met, and another one meets it better: a segment of the right class, an edge that would do.
        Partly = "partly",
        /// It is not.
        Wrong = "wrong",
    }
}

/// An answer, judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// How good it is.
    pub verdict: Verdict,
    /// Why, in one or two sentences, with their numbers and the markup of `run/explain`.
    pub why: Vec<String>,
    /// The rule that the answer knows or misses.
    pub rule: Rule,
}

impl Judged {
    pub(super) fn right(rule: Rule, why: Vec<String>) -> Judged {
        Judged { verdict: Verdict::Right, why, rule }
    }

    pub(super) fn partly(rule: Rule, why: Vec<String>) -> Judged {
        Judged { verdict: Verdict::Partly, why, rule }
    }

    pub(super) fn wrong(rule: Rule, why: Vec<String>) -> Judged {
        Judged { verdict: Verdict::Wrong, why, rule }
    }

    /// Right where it is, else wrong.
    pub(super) fn of(is_right: bool, rule: Rule, why: Vec<String>) -> Judged {
        if is_right { Judged::right(rule, why) } else { Judged::wrong(rule, why) }
    }
}

/// A hint: a sentence, and labels for what it speaks of.
#[derive(Clone, Debug, PartialEq)]
pub struct Hint {
    /// What it says.
    pub text: String,
    /// Labels at edges.
    pub labels: Vec<([NodeId; 2], String)>,
}

impl Hint {
    pub(super) fn of(text: impl Into<String>) -> Hint {
        Hint { text: text.into(), labels: Vec::new() }
    }
}
