//! Goals of a walk through the run, and the steps that they stand for.

use crate::core::convert::EventKind;
use crate::core::run::Log;

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
    /// This many times to where the next quadrilateral is complete with its local post-processing, or back if it is
    /// negative. From within a quadrilateral, the first time is to its end, or its beginning; a loop that is closed by
    /// several at once counts once.
    Quads(i64),
    /// To the step at which this many quadrilaterals stand.
    ToQuads(u64),
    /// To the next event of a kind, or the one before.
    Kind(EventKind, Direction),
    /// To the end.
    End,
}

impl Goal {
    /// Whether it is seen from the step where one stands.
    pub fn is_relative(self) -> bool {
        matches!(self, Goal::Steps(_) | Goal::Quads(_) | Goal::Kind(..))
    }

    /// Adds it behind other goals; what goes on in the direction of the last one is added up with it.
    pub fn follow(self, goals: &mut Vec<Goal>) {
        match (goals.last_mut(), self) {
            (Some(Goal::Steps(last)), Goal::Steps(by)) | (Some(Goal::Quads(last)), Goal::Quads(by))
                if last.signum() == by.signum() =>
            {
                *last = last.saturating_add(by);
            }
            _ => goals.push(self),
        }
    }

    /// The step of the goal, seen from `step`; `None` if it is not known yet. `end` is the last step of the run, once
    /// it is known.
    pub fn resolve(self, log: &Log, step: u64, end: Option<u64>) -> Option<u64> {
        let known = |target: u64| if target <= log.known() { Some(target) } else { end };
        match self {
            Goal::Step(target) => known(target),
            Goal::Steps(by) => known(step.saturating_add_signed(by)),
            Goal::Quads(by) if by < 0 => Some((by..0).fold(step, |at, _| log.previous_quad(at))),
            Goal::Quads(by) => (0..by).try_fold(step, |at, _| log.next_quad(at)).or(end),
            Goal::ToQuads(0) => Some(0),
            Goal::ToQuads(quads) => log.first_with(quads, 0).or(end),
            Goal::Kind(wanted, Direction::Forward) => log.next_of(step, |kind| kind == wanted).or(end),
            Goal::Kind(wanted, Direction::Back) => {
                Some(log.last_of(step.saturating_sub(1), |kind| kind == wanted).unwrap_or(0))
            }
            Goal::End => end,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::progress::Nobody;
    use crate::core::run::{History, Run};

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
        let mut stands = vec![0];
        while stands.last() < end.as_ref() {
            let step = go(Goal::Quads(1), stands[stands.len() - 1]);
            assert!(step > stands[stands.len() - 1] && log.is_at_rest(step), "{step}");
            stands.push(step);
        }
        stands.pop();
        assert!(stands.len() > 30, "{}", stands.len());
        for (quads, pair) in (1..).zip(stands.windows(2)) {
            assert!(log.nq(pair[1]) >= quads);
            assert_eq!(go(Goal::Quads(-1), pair[1]), pair[0]);
            assert_eq!(go(Goal::Quads(-1), pair[1] + 1), pair[1], "from within a quadrilateral to its beginning");
        }
        assert_eq!((go(Goal::Quads(8), 0), go(Goal::Quads(-8), stands[8])), (stands[8], 0));
    }

    #[test]
    fn goals_that_follow_each_other_lead_where_each_in_its_turn_leads() {
        let history = history();
        let (log, end) = (history.log(), history.end());
        let turns =
            [Goal::Quads(1), Goal::Quads(1), Goal::Steps(3), Goal::Quads(-1), Goal::Steps(-2), Goal::Steps(-900)];
        let (mut goals, mut expected) = (vec![Goal::Step(7)], 7);
        for goal in turns.into_iter().chain([Goal::Quads(1); 20]) {
            assert!(goal.is_relative());
            goal.follow(&mut goals);
            expected = goal.resolve(log, expected, end).unwrap();
            let found = goals.iter().try_fold(0, |step, goal| goal.resolve(log, step, end));
            assert_eq!(found, Some(expected), "{goals:?}");
        }
        assert_eq!(goals[goals.len() - 1], Goal::Quads(20));
        assert!(goals.len() == 6, "{goals:?}");
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
