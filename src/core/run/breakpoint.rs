//! Breakpoints: conditions on what a step did and on the front after it, such as `kind == seamed && quad.min_angle <
//! 30`.
//!
//! ```text
//! condition  = both { "||" both }
//! both       = one { "&&" one }
//! one        = "!" one | "(" condition ")" | field [ ("==" | "!=" | "<" | "<=" | ">" | ">=") value ]
//! value      = a number (angles in degrees) | a word
//! ```
//!
//! A comparison with a field that a step does not have (`quad.min_angle` where no quadrilateral was formed) is false.

mod fields;

pub use self::fields::{FIELDS, Field, Holds};

use self::fields::Value;
use super::front_count::FrontCount;
use super::history::History;
use super::log::Angles;
use crate::core::convert::Event;
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::spelling::nearest;

/// The facts about a step that conditions test.
#[derive(Clone, Copy, Debug)]
pub struct StepFacts<'a> {
    /// The step.
    pub step: u64,
    /// The number of quadrilaterals after it.
    pub nq: u64,
    /// What it did.
    pub event: &'a Event,
    /// The counts of the front after it.
    pub front: FrontCount,
    /// The angles of the quadrilateral that it formed.
    pub angles: Option<Angles>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Comparison {
    Equal,
    Unequal,
    Less,
    AtMost,
    Greater,
    AtLeast,
}

#[derive(Clone, Debug, PartialEq)]
enum Tree {
    Any(Vec<Tree>),
    All(Vec<Tree>),
    Not(Box<Tree>),
    /// A field, by its index in [`FIELDS`], compared with a value.
    Compare(usize, Comparison, Value),
}

/// A parsed condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    text: String,
    tree: Tree,
}

impl Condition {
    /// Parses a condition.
    ///
    /// # Errors
    /// A syntax error or an unknown name, with the position of the first wrong character (from 1) and the nearest known
    /// name.
    pub fn parse(text: &str) -> Result<Condition, Fault> {
        Condition::parsed(text).map_err(|fault| fault.of_kind(FaultKind::Syntax))
    }

    fn parsed(text: &str) -> Result<Condition, Fault> {
        let mut reader = Reader { text, at: 0 };
        let tree = reader.any()?;
        reader.skip_blanks();
        if reader.at < text.len() {
            return Err(reader.fault("The condition should end here").remedy("Join conditions with && or ||"));
        }
        Ok(Condition { text: text.trim().to_owned(), tree })
    }

    /// Its text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether it holds for a step.
    pub fn holds(&self, facts: &StepFacts<'_>) -> bool {
        self.tree.holds(facts)
    }
}

impl Tree {
    fn holds(&self, facts: &StepFacts<'_>) -> bool {
        match self {
            Tree::Any(trees) => trees.iter().any(|tree| tree.holds(facts)),
            Tree::All(trees) => trees.iter().all(|tree| tree.holds(facts)),
            Tree::Not(tree) => !tree.holds(facts),
            Tree::Compare(field, comparison, value) => {
                let Some(found) = (FIELDS[*field].of)(facts) else { return false };
                match (&found, value) {
                    (Value::Number(found), Value::Number(value)) => match comparison {
                        Comparison::Equal => found == value,
                        Comparison::Unequal => found != value,
                        Comparison::Less => found < value,
                        Comparison::AtMost => found <= value,
                        Comparison::Greater => found > value,
                        Comparison::AtLeast => found >= value,
                    },
                    _ => (found == *value) == (*comparison == Comparison::Equal),
                }
            }
        }
    }
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Reader<'t> {
    fn rest(&self) -> &'t str {
        &self.text[self.at..]
    }

    fn skip_blanks(&mut self) {
        self.at = self.text.len() - self.rest().trim_start().len();
    }

    fn fault(&self, what: impl Into<String>) -> Fault {
        self.fault_at(self.at, what)
    }

    fn fault_at(&self, at: usize, what: impl Into<String>) -> Fault {
        Fault::new(what).at(format!("position {}", self.text[..at].chars().count() + 1))
    }

    fn take(&mut self, sign: &str) -> bool {
        self.skip_blanks();
        let found = self.rest().starts_with(sign);
        if found {
            self.at += sign.len();
        }
        found
    }

    fn any(&mut self) -> Result<Tree, Fault> {
        let mut trees = vec![self.all()?];
        while self.take("||") {
            trees.push(self.all()?);
        }
        Ok(if trees.len() == 1 { trees.remove(0) } else { Tree::Any(trees) })
    }

    fn all(&mut self) -> Result<Tree, Fault> {
        let mut trees = vec![self.one()?];
        while self.take("&&") {
            trees.push(self.one()?);
        }
        Ok(if trees.len() == 1 { trees.remove(0) } else { Tree::All(trees) })
    }

    fn one(&mut self) -> Result<Tree, Fault> {
        // Many signs nest deeply: limit the depth before the recursion exhausts the stack.
        let mut negated = 0;
        while !self.rest_starts_with("!=") && self.take("!") {
            negated += 1;
        }
        let tree = if self.take("(") {
            let depth = self.text[..self.at].matches('(').count() - self.text[..self.at].matches(')').count();
            if depth > 100 {
                return Err(self.fault("The parentheses are nested too deeply").remedy("Simplify the condition"));
            }
            let tree = self.any()?;
            if !self.take(")") {
                return Err(self.fault("A parenthesis is not closed").remedy("Write ) here"));
            }
            tree
        } else {
            self.comparison()?
        };
        Ok(if negated % 2 == 1 { Tree::Not(Box::new(tree)) } else { tree })
    }

    fn rest_starts_with(&mut self, sign: &str) -> bool {
        self.skip_blanks();
        self.rest().starts_with(sign)
    }

    fn comparison(&mut self) -> Result<Tree, Fault> {
        self.skip_blanks();
        let start = self.at;
        let name = self.word();
        if name.is_empty() {
            let what = if self.rest().is_empty() { "The condition ends here" } else { "A field was expected here" };
            return Err(self.fault(what).remedy("Write for example kind == formed"));
        }
        let Some(field) = FIELDS.iter().position(|field| field.name == name) else {
            let fault = self.fault_at(start, format!("The field \"{name}\" does not exist"));
            let known = FIELDS.iter().map(|field| field.name);
            return Err(match nearest(name, known.clone()) {
                Some(near) => fault.remedy(format!("The nearest known field is \"{near}\"")),
                None => fault.remedy(format!("Use one of: {}", known.collect::<Vec<_>>().join(", "))),
            });
        };
        let holds = FIELDS[field].holds;
        let signs = [
            ("==", Comparison::Equal),
            ("!=", Comparison::Unequal),
            ("<=", Comparison::AtMost),
            (">=", Comparison::AtLeast),
            ("<", Comparison::Less),
            (">", Comparison::Greater),
        ];
        self.skip_blanks();
        let sign = self.at;
        let Some((_, comparison)) = signs.into_iter().find(|(sign, _)| self.take(sign)) else {
            if holds == Holds::Flag {
                return Ok(Tree::Compare(field, Comparison::Equal, Value::Flag(true)));
            }
            let example =
                holds.words().first().map_or_else(|| format!("{name} < 30"), |word| format!("{name} == {word}"));
            return Err(self.fault("A comparison is missing").remedy(format!("Write for example {example}")));
        };
        let is_number = matches!(holds, Holds::Number | Holds::Degrees);
        if !is_number && !matches!(comparison, Comparison::Equal | Comparison::Unequal) {
            return Err(self.fault_at(sign, format!("{name} has no order")).remedy("Compare it with == or !="));
        }
        self.value(name, holds).map(|value| Tree::Compare(field, comparison, value))
    }

    fn value(&mut self, name: &str, holds: Holds) -> Result<Value, Fault> {
        self.skip_blanks();
        let start = self.at;
        let quoted = self.take("\"");
        let word = self.word();
        if quoted && !self.take("\"") {
            return Err(self.fault("A quotation mark is missing").remedy("Words need no quotation marks"));
        }
        // Shorter words for some kinds of events.
        let word = match (holds, word) {
            (Holds::Kind, "seam") => "seamed",
            (Holds::Kind, "quad" | "form") => "formed",
            (Holds::Kind, "base") => "base_selected",
            (Holds::Kind, "rollback") => "rolled_back",
            (_, word) => word,
        };
        holds.value(word).ok_or_else(|| {
            if matches!(holds, Holds::Number | Holds::Degrees) {
                let unit = if holds == Holds::Degrees { " of degrees, without a unit" } else { "" };
                let fault = self.fault_at(start, format!("{name} is compared with a number"));
                return fault.remedy(format!("Write a number{unit}"));
            }
            let fault = self.fault_at(start, format!("{name} is never \"{word}\""));
            match nearest(word, holds.words().iter().copied()) {
                Some(near) => fault.remedy(format!("The nearest known word is \"{near}\"")),
                None => fault.remedy(format!("Use one of: {}", holds.words().join(", "))),
            }
        })
    }

    fn word(&mut self) -> &'t str {
        self.skip_blanks();
        let rest = self.rest();
        let is_part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '+');
        let end = rest.find(|c| !is_part(c)).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }
}

impl History {
    /// The next step after the current state at which one of the conditions holds, and its index. It runs ahead as far
    /// as necessary, unless the recorder is lent.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn next_break(&mut self, conditions: &[Condition]) -> Result<Option<(u64, usize)>, Fault> {
        let mut from = self.step();
        loop {
            let known = self.log().known();
            while from < known {
                let (_, until) = self.log().chunk_of(from + 1);
                let events = self.events(from + 1, until)?;
                let steps = (from + 1..).zip(&*events);
                if let Some(found) = steps.into_iter().find_map(|(step, event)| self.broken(conditions, step, event)) {
                    return Ok(Some(found));
                }
                from = until;
            }
            if conditions.is_empty() || self.ahead(|history| (history.log().known() > known).then_some(())).is_none() {
                return Ok(None);
            }
        }
    }

    /// The last step before the one that led to the current state at which one of the conditions holds, and its index.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn previous_break(&self, conditions: &[Condition]) -> Result<Option<(u64, usize)>, Fault> {
        let mut until = self.step().saturating_sub(1);
        while until > 0 {
            let (from, _) = self.log().chunk_of(until);
            let events = self.events(from, until)?;
            let steps = (from..).zip(&*events).collect::<Vec<_>>();
            if let Some(found) = steps.into_iter().rev().find_map(|(step, event)| self.broken(conditions, step, event))
            {
                return Ok(Some(found));
            }
            until = from - 1;
        }
        Ok(None)
    }

    fn broken(&self, conditions: &[Condition], step: u64, event: &Event) -> Option<(u64, usize)> {
        let log = self.log();
        let facts = StepFacts { step, nq: log.nq(step), event, front: log.front(step), angles: log.angles(step) };
        conditions.iter().position(|condition| condition.holds(&facts)).map(|index| (step, index))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::convert::{FewNodes, Why};
    use crate::core::front::Side;
    use crate::core::mesh::{ElementId, NodeId};

    fn formed(quality: f64) -> Event {
        let (element, nodes, swallowed) = (ElementId(7), [NodeId(1); 4], FewNodes::of(&[NodeId(2)]));
        Event::Formed { element, nodes, quality, merged: 4, level: 3, attempt: 0, swallowed }
    }

    fn holds(text: &str, event: &Event, angles: Option<Angles>) -> bool {
        let front = FrontCount { segments: 40, loops: 2, odd: 0, live: 500 };
        Condition::parse(text).unwrap().holds(&StepFacts { step: 812, nq: 311, event, front, angles })
    }

    #[test]
    fn conditions_bind_as_usual_and_compare_fields_of_the_step() {
        let angles = Some(Angles { min: 0.4, max: 2.0 });
        let quad = formed(0.3);
        for text in [
            "quad.min_angle < 30",
            "kind == formed",
            "kind == quad && quad.quality<=.3",
            "kind == seam || front.loops > 1",
            "kind == seam && front.loops > 9 || step == 812",
            "!(kind == seam) && !fallback",
            "(kind == seam || kind == formed) && (nq >= 311)",
            "quad.element == 7 && quad.merged == 4 && quad.level != 2",
        ] {
            assert!(holds(text, &quad, angles), "{text}");
        }
        for text in ["fallback", "recovery.failed", "side == left", "base.class != 9", "kind == seam", "front.odd > 0"]
        {
            assert!(!holds(text, &quad, angles), "{text}");
        }
        assert!(!holds("quad.min_angle < 30", &Event::SecondPass, None));
        assert!(holds("fallback", &Event::SecondPass, None));
        let failed = Event::RolledBack { attempt: 0, why: Why::TopTooLong };
        assert!(holds("recovery.failed && rollback.why == top_too_long", &failed, None));
        let left = Event::SideIsFront { side: Side::Left, node: NodeId(1) };
        assert!(holds("side == \"left\"", &left, None) && !holds("side == right", &left, None));
    }

    #[test]
    fn a_bad_condition_is_reported_with_its_position_and_the_nearest_name() {
        let message = |text: &str| Condition::parse(text).unwrap_err().to_string();
        insta::assert_snapshot!(
            [
                "",
                "kind == seemed",
                "kind = seamed",
                "quad.min_angel < 30",
                "nq > 5 && (step < 3",
                "quad.min_angle < 30deg",
                "quad.min_angle",
                "kind < formed",
                "nq > 5 6",
                "colour == blue",
                "fallback == maybe",
                "&& nq > 5",
                "kind == \"formed",
            ]
            .map(|text| format!("{text:?}: {}", message(text)))
            .join("\n")
        );
        assert!(message(&"(".repeat(100_000)).contains("too deeply"));
        assert!(message(&"ä == 1 && x".repeat(3)).starts_with("position 1"));
    }

    #[test]
    fn every_field_has_a_condition_that_can_be_read() {
        for field in FIELDS {
            let value = field.holds.words().first().copied().unwrap_or("1");
            assert!(Condition::parse(&format!("{} == {value}", field.name)).is_ok(), "{}", field.name);
            assert!(!field.doc.is_empty());
        }
    }
}
