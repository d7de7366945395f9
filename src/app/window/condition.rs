//! Conditions of breakpoints on the events of the run: `kind == seamed`, `quad.quality < 0.3`, `step == 812`.

use super::session::Tracked;
use crate::core::convert::event::Event;
use crate::core::convert::parameters::nearest;
use crate::core::fault::Fault;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// At every event of a kind.
    Kind(&'static str),
    /// Where a quadrilateral is formed whose quality is below this.
    Quality(f64),
    /// At one step.
    Step(u64),
}

impl Condition {
    /// Reads a condition.
    ///
    /// # Errors
    /// What cannot be read, with what can.
    pub fn parse(text: &str) -> Result<Condition, Fault> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let number = |text: &str| {
            let fault =
                || Fault::new(format!("\"{text}\" is not a number")).remedy("Write for example quad.quality < 0.3");
            text.parse::<f64>().map_err(|_| fault())
        };
        match words[..] {
            ["kind", "==", kind] | [kind] => kind_of(kind).map(Condition::Kind),
            ["quad.quality", "<", bound] => number(bound).map(Condition::Quality),
            ["step", "==", step] => number(step).map(|step| Condition::Step(step as u64)),
            _ => Err(Fault::new(format!("\"{text}\" is no condition"))
                .remedy("Write kind == seamed, quad.quality < 0.3 or step == 812")),
        }
    }

    /// Whether a step meets it.
    pub fn is_met(self, step: u64, tracked: &Tracked) -> bool {
        match self {
            Condition::Kind(kind) => tracked.kind == kind,
            Condition::Quality(bound) => tracked.formed.is_some_and(|formed| f64::from(formed.1) < bound),
            Condition::Step(at) => step == at,
        }
    }
}

fn kind_of(name: &str) -> Result<&'static str, Fault> {
    let name = name.trim_matches('"');
    Event::KINDS.iter().copied().find(|kind| *kind == name).ok_or_else(|| {
        let fault = Fault::new(format!("There is no kind of event \"{name}\""));
        match nearest(name, Event::KINDS.iter().copied()) {
            Some(near) => fault.remedy(format!("The nearest is {near}")),
            None => fault.remedy(format!("Kinds are {}", Event::KINDS.join(", "))),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::mesh::ids::ElementId;

    #[test]
    fn conditions_are_read_and_met() {
        let formed = Tracked { kind: "formed", standing: 1, front: 0, formed: Some((ElementId(1), 0.25)) };
        let met = |text: &str| Condition::parse(text).unwrap().is_met(7, &formed);
        assert!(met("kind == formed") && met("formed") && met("quad.quality < 0.3") && met("step == 7"));
        assert!(!met("kind == seamed") && !met("quad.quality < 0.2") && !met("step == 8"));
    }

    #[test]
    fn a_bad_condition_says_what_would_be_good() {
        assert!(Condition::parse("kind == seamd").unwrap_err().remedy.contains("seamed"));
        assert!(Condition::parse("quad.quality < low").is_err());
        assert!(Condition::parse("when it rains").unwrap_err().remedy.contains("kind == seamed"));
    }
}
