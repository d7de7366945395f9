//! Goals of a walk through the run, and the steps that they stand for.

use crate::core::convert::event::EventKind;
use crate::core::run::log::Log;

/// A direction along the steps of a run, or along the changes of the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To what comes later.
    Forward,
    /// To what came before.
    Back,
}

impl Direction {
    /// Both of them.
    pub const BOTH: [Direction; 2] = [Direction::Forward, Direction::Back];
}

/// Where to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// To a step.
    Step(u64),
    /// A number of steps forward, or back if it is negative.
    Steps(i64),
    /// A number of quadrilaterals forward, or back if it is negative; their local post-processing is included.
    Quads(i64),
    /// To the step at which this many quadrilaterals stand.
    ToQuads(u64),
    /// To the next event of a kind, or the one before.
    Kind(EventKind, Direction),
    /// To the end.
    End,
}

impl Goal {
    /// The step of the goal, seen from `step`; `None` if it is not known yet. `end` is the last step of the run, once
    /// it is known.
    pub fn resolve(self, log: &Log, step: u64, end: Option<u64>) -> Option<u64> {
        let known = |target: u64| if target <= log.known() { Some(target) } else { end };
        let with = |quads: u64, after: u64| if quads == 0 { Some(0) } else { log.first_with(quads, after).or(end) };
        match self {
            Goal::Step(target) => known(target),
            Goal::Steps(by) => known(step.saturating_add_signed(by)),
            Goal::Quads(by) => match u64::try_from(by) {
                Ok(on) => with(log.nq(step) + on, step),
                Err(_) => Some(back(log, step, by.unsigned_abs())),
            },
            Goal::ToQuads(quads) => with(quads, 0),
            Goal::Kind(wanted, Direction::Forward) => log.next_of(step, |kind| kind == wanted).or(end),
            Goal::Kind(wanted, Direction::Back) => {
                Some(log.last_of(step.saturating_sub(1), |kind| kind == wanted).unwrap_or(0))
            }
            Goal::End => end,
        }
    }
}

/// The step `by` quadrilaterals back. From within a quadrilateral, the first of them leads to its beginning.
fn back(log: &Log, step: u64, by: u64) -> u64 {
    let first = |quads: u64| if quads == 0 { Some(0) } else { log.first_with(quads, 0) };
    let here = log.nq(step);
    let within = first(here).is_some_and(|stood| stood < step);
    let target = here.saturating_sub(by - u64::from(within));
    first(target).unwrap_or(0).min(step.saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::progress::Nobody;
    use crate::core::run::history::History;
    use crate::core::run::run::Run;

    fn history() -> History {
        let mut case = built_in::named("example1").unwrap().unwrap();
        case.parameters.size_scale = 3.0;
        let mut history = History::open(Run::of(case), &mut Nobody).unwrap();
        history.extend(u64::MAX);
        history
    }

    #[test]
    fn a_quadrilateral_on_and_one_back_lead_to_the_same_step() {
        let history = history();
        let (log, end) = (history.log(), history.end());
        let go = |goal: Goal, from: u64| goal.resolve(log, from, end).unwrap();
        let mut step = 0;
        for quads in 1..=8 {
            let next = go(Goal::Quads(1), step);
            assert!(next > step && log.is_at_rest(next) && log.nq(next) >= quads);
            assert_eq!(go(Goal::Quads(-1), next), step);
            step = next;
        }
        assert_eq!(go(Goal::Quads(8), 0), step);
        assert_eq!(go(Goal::Quads(-8), step), 0);
        let within = go(Goal::Steps(2), step);
        assert_eq!(go(Goal::Quads(-1), within), step, "from within a quadrilateral back to where it began");
    }

    #[test]
    fn events_of_a_kind_are_met_forward_and_backward() {
        let history = history();
        let (log, end) = (history.log(), history.end());
        let first = Goal::Kind(EventKind::Formed, Direction::Forward).resolve(log, 0, end).unwrap();
        let second = Goal::Kind(EventKind::Formed, Direction::Forward).resolve(log, first, end).unwrap();
        assert!(log.kind(first) == Some(EventKind::Formed) && log.kind(second) == Some(EventKind::Formed));
        assert_eq!(Goal::Kind(EventKind::Formed, Direction::Back).resolve(log, second, end), Some(first));
        assert_eq!(Goal::Kind(EventKind::Formed, Direction::Back).resolve(log, first, end), Some(0));
    }

    #[test]
    fn what_is_not_known_yet_is_not_resolved() {
        let log = Log::default();
        for goal in [Goal::Step(5), Goal::Steps(1), Goal::Quads(1), Goal::ToQuads(3), Goal::End] {
            assert_eq!(goal.resolve(&log, 0, None), None, "{goal:?}");
            assert_eq!(goal.resolve(&log, 0, Some(0)), Some(0), "{goal:?}");
        }
        assert_eq!(Goal::Steps(-1).resolve(&log, 0, None), Some(0));
    }
}
