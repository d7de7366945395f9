//! Where a part of a lesson stands in the run: `start`, `end`, a step, a number of quadrilaterals, or an event by its
//! kind and count with an offset.
//!
//! ```text
//! go = "start" | "end" | step | "nq=" number | kind [ "#" count ] [ ("+" | "-") steps ]
//! ```

use super::attributes::shortened;
use crate::core::convert::EventKind;
use crate::core::fault::Fault;
use crate::core::kernel::number::grouped;
use crate::core::kernel::spelling::suggestion;
use crate::core::run::History;

/// Steps to run ahead at once.
const AHEAD: u64 = 4096;

/// A place in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Go {
    /// The state before the first step.
    Start,
    /// The state after the last one.
    End,
    /// The state after this step.
    Step(u64),
    /// As soon as so many quadrilaterals stand and no local post-processing is under way.
    Quads(u64),
    /// The state after a step of a kind, the `count`th one, or so many steps later or earlier.
    Event {
        /// The kind.
        kind: EventKind,
        /// Which of them, from 1.
        count: u64,
        /// Steps later, or earlier where it is negative.
        offset: i64,
    },
}

impl Go {
    /// Reads a place in a run; the fault has no place yet.
    ///
    /// # Errors
    /// A text of another form, an unknown kind of event.
    pub fn parse(text: &str) -> Result<Go, Fault> {
        let text = text.trim();
        let example = "Write for example end, 12, nq=100 or top_swapped#1-1";
        let wrong = || Fault::new(format!("\"{}\" is no place in a run", shortened(text))).remedy(example);
        match text {
            "start" => return Ok(Go::Start),
            "end" => return Ok(Go::End),
            _ => {}
        }
        if text.bytes().next().is_some_and(|b| b.is_ascii_digit()) {
            return text.parse().map(Go::Step).map_err(|_| wrong());
        }
        if let Some((name, number)) = text.split_once('=') {
            return match name.trim() {
                "nq" => number.trim().parse().map(Go::Quads).map_err(|_| wrong()),
                "step" => number.trim().parse().map(Go::Step).map_err(|_| wrong()),
                _ => Err(wrong()),
            };
        }
        let end = text.find(['#', '+', '-']).unwrap_or(text.len());
        let (name, rest) = text.split_at(end);
        let name = name.trim();
        let kind = name.parse().map_err(|()| {
            let known = || EventKind::NAMES.iter().copied().chain(["start", "end"]);
            let remedy = suggestion(name, known()).unwrap_or_else(|| example.to_owned());
            Fault::new(format!("There is no kind of event \"{}\"", shortened(name))).remedy(remedy)
        })?;
        let (count, offset) = match rest.strip_prefix('#') {
            Some(rest) => rest.split_at(rest.find(['+', '-']).unwrap_or(rest.len())),
            None => ("1", rest),
        };
        let count = count.trim().parse().ok().filter(|count| *count > 0).ok_or_else(wrong)?;
        let offset = if offset.is_empty() { 0 } else { offset.parse().map_err(|_| wrong())? };
        Ok(Go::Event { kind, count, offset })
    }

    /// The step of the place in a run, which is run ahead as far as necessary; the fault has no place yet.
    ///
    /// # Errors
    /// The run has no such place.
    pub fn resolve(self, history: &mut History) -> Result<u64, Fault> {
        match self {
            Go::Start => Ok(0),
            Go::End => {
                history.extend(u64::MAX);
                Ok(history.log().known())
            }
            Go::Step(step) => {
                history.extend(step);
                let known = history.log().known();
                let fault = || {
                    Fault::new(format!("The run has no step {}", grouped(step)))
                        .remedy(format!("Its last one is {}", grouped(known)))
                };
                if step <= known { Ok(step) } else { Err(fault()) }
            }
            Go::Quads(quads) if history.log().nq(0) >= quads => Ok(0),
            Go::Quads(quads) => ahead(history, |history| history.log().first_with(quads, 0)).ok_or_else(|| {
                Fault::new(format!("The run never has {} quadrilaterals", grouped(quads)))
                    .remedy("Write a smaller number, or end")
            }),
            Go::Event { kind, count, offset } => {
                let mut step = 0;
                for nth in 0..count {
                    let found = ahead(history, |history| history.log().next_of(step, |other| other == kind));
                    step = found.ok_or_else(|| {
                        Fault::new(format!("The run has only {} steps of the kind {kind}", grouped(nth)))
                            .remedy("Write a smaller count, or another kind; --events lists what a run does")
                    })?;
                }
                let to = step.checked_add_signed(offset).ok_or_else(|| {
                    Fault::new(format!("Step {step}{offset:+} lies before the beginning")).remedy("Write start")
                })?;
                Go::Step(to).resolve(history)
            }
        }
    }
}

/// Looks for a step, and where it is not known yet runs further.
fn ahead(history: &mut History, look: impl Fn(&History) -> Option<u64>) -> Option<u64> {
    loop {
        if let Some(found) = look(history) {
            return Some(found);
        }
        let known = history.log().known();
        history.extend(known + AHEAD);
        if history.log().known() == known {
            return None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read() {
        let event = |kind, count, offset| Go::Event { kind, count, offset };
        for (text, go) in [
            ("start", Go::Start),
            (" end ", Go::End),
            ("12", Go::Step(12)),
            ("step=12", Go::Step(12)),
            ("nq=100", Go::Quads(100)),
            ("nq = 100", Go::Quads(100)),
            ("top_swapped", event(EventKind::TopSwapped, 1, 0)),
            ("top_swapped-1", event(EventKind::TopSwapped, 1, -1)),
            ("formed#3", event(EventKind::Formed, 3, 0)),
            ("formed#3+2", event(EventKind::Formed, 3, 2)),
        ] {
            assert_eq!(Go::parse(text).unwrap(), go, "{text}");
        }
        for text in ["", "12a", "nq", "nq=x", "formed#0", "formed#", "formed#1-", "formed#1-x", "1e9", "-1", "x=1"] {
            assert!(Go::parse(text).is_err(), "{text}");
        }
        let fault = Go::parse("top_swaped#1").unwrap_err().to_string();
        assert!(fault.contains("Did you mean \"top_swapped\"?"), "{fault}");
    }
}
