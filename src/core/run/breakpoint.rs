//! Breakpoints: conditions on what a step did and on the front after it, such as `kind == seamed && quad.min_angle <
//! 30` ([`condition`]). A comparison with a field that a step does not have (`quad.min_angle` where no quadrilateral
//! was formed) is false.

mod fields;

pub use self::fields::FIELDS;

use self::fields::VALUES;
use super::front_count::FrontCount;
use super::history::History;
use super::log::Angles;
use crate::core::convert::Event;
use crate::core::fault::Fault;
use crate::core::kernel::condition;

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

/// A condition on steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition(condition::Condition);

impl Condition {
    /// Parses a condition.
    ///
    /// # Errors
    /// As [`condition::Condition::parse`].
    pub fn parse(text: &str) -> Result<Condition, Fault> {
        condition::Condition::parse(text, FIELDS).map(Condition)
    }

    /// Its text.
    pub fn text(&self) -> &str {
        self.0.text()
    }

    /// Whether it holds for a step.
    pub fn holds(&self, facts: &StepFacts<'_>) -> bool {
        self.0.holds(|field| VALUES[field](facts))
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
