//! What a learner has answered so far: how much of it is right, and which rules are missed.

use std::fmt::Write;

use super::answer::Answer;
use super::asked::Asked;
use super::judged::{Judged, Verdict};
use super::kind::Kind;
use super::rule::Rule;
use crate::core::run::Watched;

/// An answer that was given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// The step at which it was asked.
    pub step: u64,
    /// What was asked.
    pub kind: Kind,
    /// What it was about, where the question named that.
    pub of: Option<Watched>,
    /// The answer.
    pub answer: Answer,
    /// The right one.
    pub right: Answer,
    /// How good it was.
    pub verdict: Verdict,
    /// The rule that it knew or missed.
    pub rule: Rule,
    /// How many hints were taken before.
    pub hints: u32,
}

/// Answers counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Right ones.
    pub right: u32,
    /// Partly right ones.
    pub partly: u32,
    /// Wrong ones.
    pub wrong: u32,
}

impl Tally {
    /// How many there are.
    pub fn all(self) -> u32 {
        self.right + self.partly + self.wrong
    }

    /// The share that is right, a partly right one as a half; `None` where there is none.
    pub fn share(self) -> Option<f64> {
        (self.all() > 0).then(|| (f64::from(self.right) + 0.5 * f64::from(self.partly)) / f64::from(self.all()))
    }

    fn count(&mut self, verdict: Verdict) {
        match verdict {
            Verdict::Right => self.right += 1,
            Verdict::Partly => self.partly += 1,
            Verdict::Wrong => self.wrong += 1,
        }
    }
}

/// All answers of a learner, in their order. Only the first answer to a question at a step counts, and none where the
/// right one was shown before.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Score {
    given: Vec<Given>,
    /// The questions whose answers were shown.
    shown: Vec<Question>,
}

/// What tells questions apart: step, kind, and what they are about.
type Question = (u64, Kind, Option<Watched>);

impl Score {
    /// Notes that the right answer was shown: one that is given later does not count.
    pub fn show(&mut self, asked: &Asked) {
        self.shown.push((asked.step, asked.kind, asked.of));
    }

    /// Notes a judged answer; false where the question was answered before, or its answer was shown, which changes
    /// nothing.
    pub fn note(&mut self, asked: &Asked, answer: Answer, judged: &Judged, hints: u32) -> bool {
        let Asked { step, kind, of, .. } = *asked;
        let mut answered =
            self.given.iter().map(|given| (given.step, given.kind, given.of)).chain(self.shown.iter().copied());
        if answered.any(|question| question == (step, kind, of)) {
            return false;
        }
        let Judged { verdict, rule, .. } = *judged;
        let right = asked.answer();
        self.given.push(Given { step, kind, of, answer, right, verdict, rule, hints });
        true
    }

    /// The answers.
    pub fn given(&self) -> &[Given] {
        &self.given
    }

    /// All of them, counted.
    pub fn tally(&self) -> Tally {
        self.counted(|_| true)
    }

    /// How many of the last ones are right without a wrong or partly right one between.
    pub fn streak(&self) -> usize {
        self.given.iter().rev().take_while(|given| given.verdict == Verdict::Right).count()
    }

    /// The rules that were asked about, in the order of [`Rule::ALL`].
    pub fn by_rule(&self) -> Vec<(Rule, Tally)> {
        let tallies = Rule::ALL.into_iter().map(|rule| (rule, self.counted(|given| given.rule == rule)));
        tallies.filter(|(_, tally)| tally.all() > 0).collect()
    }

    fn counted(&self, of: impl Fn(&Given) -> bool) -> Tally {
        let mut tally = Tally::default();
        self.given.iter().filter(|given| of(given)).for_each(|given| tally.count(given.verdict));
        tally
    }

    /// One line an answer, below a line of names.
    pub fn csv(&self) -> String {
        let mut text = "step,kind,of,answer,right,verdict,rule,hints\n".to_owned();
        for Given { step, kind, of, answer, right, verdict, rule, hints } in &self.given {
            let [kind, verdict, rule] = [kind.name(), verdict.name(), rule.name()];
            let of = match of {
                None => String::new(),
                Some(Watched::Node(node)) => format!("node {}", node.0),
                Some(Watched::Edge(a, b)) => format!("{}-{}", a.0, b.0),
                Some(Watched::Element(element)) => format!("element {}", element.0),
            };
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{step},{kind},{of},{},{},{verdict},{rule},{hints}", answer.text(), right.text());
        }
        text
    }
}
