//! What one has learnt so far, from one start of the window to the next: which lessons are done, where one was last,
//! and how sure one is of each rule.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::core::lesson::built_in;
use crate::core::question::{Rule, Tally, Verdict};

/// What one has learnt. Rules and verdicts are kept by name; those that another quadfront does not have do not count.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Learned {
    /// The lesson that was open last, and its part.
    #[serde(default)]
    pub last: Option<(String, usize)>,
    /// By lesson.
    #[serde(default)]
    lessons: BTreeMap<String, LessonRecord>,
    /// Answers to predictions by rule: right, partly right and wrong ones.
    #[serde(default)]
    predicted: BTreeMap<String, [u32; 3]>,
}

/// What was done of a lesson.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct LessonRecord {
    /// Whether its last part was left.
    #[serde(default)]
    is_done: bool,
    /// The first answer to each question when the lesson was open last: rule and verdict, by part and question.
    #[serde(default)]
    answers: BTreeMap<String, [String; 2]>,
}

impl Learned {
    /// Whether a lesson is done.
    pub fn is_done(&self, lesson: &str) -> bool {
        self.lessons.get(lesson).is_some_and(|record| record.is_done)
    }

    /// Whether nothing was learnt yet.
    pub fn is_nothing(&self) -> bool {
        *self == Learned::default()
    }

    /// The lesson of the tour to go on with, and its part: the last one where it is of the tour, else the first one
    /// that is not done.
    pub fn next(&self) -> (&'static str, usize) {
        let named = |name: &str| built_in::LESSONS.iter().map(|lesson| lesson.0).find(|known| *known == name);
        let last = self.last.as_ref().and_then(|(name, part)| Some((named(name)?, *part)));
        let open = || built_in::LESSONS.iter().map(|lesson| lesson.0).find(|name| !self.is_done(name));
        last.filter(|(name, _)| !self.is_done(name)).unwrap_or_else(|| (open().unwrap_or(built_in::LESSONS[0].0), 0))
    }

    /// A lesson is at a part.
    pub fn be_at(&mut self, lesson: &str, part: usize) {
        self.last = Some((lesson.to_owned(), part));
    }

    /// The last part of a lesson is left.
    pub fn finish(&mut self, lesson: &str) {
        self.lessons.entry(lesson.to_owned()).or_default().is_done = true;
    }

    /// Notes the first answer to a question of a lesson.
    pub fn answer(&mut self, lesson: &str, [part, question]: [usize; 2], rule: Rule, verdict: Verdict) {
        let answers = &mut self.lessons.entry(lesson.to_owned()).or_default().answers;
        answers.insert(format!("{part}.{question}"), [rule.name().to_owned(), verdict.name().to_owned()]);
    }

    /// Notes the first answer to a prediction.
    pub fn predict(&mut self, rule: Rule, verdict: Verdict) {
        let counts = self.predicted.entry(rule.name().to_owned()).or_default();
        counts[verdict as usize] = counts[verdict as usize].saturating_add(1);
    }

    /// The rules that were asked about, with the answers counted, in the order of [`Rule::ALL`].
    pub fn by_rule(&self) -> Vec<(Rule, Tally)> {
        let mut tallies = Rule::ALL.map(|rule| (rule, Tally::default()));
        let answers = self.lessons.values().flat_map(|record| record.answers.values());
        let answers = answers.filter_map(|[rule, verdict]| {
            let verdict = Verdict::ALL.into_iter().find(|known| known.name() == verdict)?;
            Some((Rule::named(rule)?, verdict, 1))
        });
        let predicted = self.predicted.iter().flat_map(|(rule, counts)| {
            let rule = Rule::named(rule);
            Verdict::ALL.into_iter().zip(*counts).filter_map(move |(verdict, count)| Some((rule?, verdict, count)))
        });
        for (rule, verdict, count) in answers.chain(predicted) {
            let tally = &mut tallies[rule as usize].1;
            match verdict {
                Verdict::Right => tally.right += count,
                Verdict::Partly => tally.partly += count,
                Verdict::Wrong => tally.wrong += count,
            }
        }
        tallies.into_iter().filter(|(_, tally)| tally.all() > 0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_learnt_counts_once_a_question_and_outlasts_the_file() {
        let mut learned = Learned::default();
        assert!(learned.is_nothing());
        assert_eq!(learned.next(), (built_in::LESSONS[0].0, 0));
        learned.answer("figure-12", [0, 0], Rule::Angles, Verdict::Wrong);
        learned.answer("figure-12", [0, 0], Rule::Angles, Verdict::Right);
        learned.answer("figure-12", [1, 0], Rule::Angles, Verdict::Partly);
        learned.predict(Rule::Table1, Verdict::Wrong);
        learned.predict(Rule::Table1, Verdict::Wrong);
        let tally = |right, partly, wrong| Tally { right, partly, wrong };
        let expected = vec![(Rule::Angles, tally(1, 1, 0)), (Rule::Table1, tally(0, 0, 2))];
        assert_eq!(learned.by_rule(), expected);
        learned.be_at("figure-12", 2);
        assert_eq!(learned.next(), ("figure-12", 2));
        learned.finish("figure-12");
        assert!(learned.is_done("figure-12") && !learned.is_done("figure-13"));
        assert_eq!(learned.next(), (built_in::LESSONS[0].0, 0), "what is done is not gone on with");
        let text = serde_json::to_string(&learned).unwrap();
        assert_eq!(serde_json::from_str::<Learned>(&text).unwrap(), learned);
        // Names that another version does not have.
        let text = text.replace("table-1", "table-9");
        assert_eq!(serde_json::from_str::<Learned>(&text).unwrap().by_rule(), expected[..1]);
    }

    #[test]
    fn rules_and_verdicts_stand_in_their_order() {
        assert!(Rule::ALL.into_iter().enumerate().all(|(k, rule)| rule as usize == k));
        assert!(Verdict::ALL.into_iter().enumerate().all(|(k, verdict)| verdict as usize == k));
    }
}
