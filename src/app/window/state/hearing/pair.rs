//! Takes in what a second run reports: its states, what the comparison of both found, and where each has to follow the
//! other.

use std::sync::Arc;
use std::sync::mpsc::TryRecvError;

use super::super::pair::{Compared, Comparison, Pair, are_same};
use super::super::{RunState, State};
use crate::app::window::command::Command;
use crate::app::window::pair::{CompareNews, Comparing, LinkedBy, Which};
use crate::app::window::session::{Goal, Moment};
use crate::app::window::state::apply::are_in_one_place;
use crate::core::convert::Phase;
use crate::core::run::compare::Overlap;

/// Up to how many elements the overlap of two states is computed while they are played.
const QUICK: usize = 20_000;

impl State {
    /// Takes in what the second run and the comparison report.
    pub(super) fn hear_second(&mut self) {
        let Some(pair) = &mut self.pair else { return };
        pair.other.hear_alone();
        self.lift_messages();
        let Some(mut pair) = self.pair.take() else { return };
        if pair.other.run.opened.is_none() && pair.other.run.opening.is_none() {
            // It could not be opened; the fault has been told.
            self.pair = Some(pair);
            return self.close_second();
        }
        self.start(&mut pair);
        let is_new = pair.other.workspace.look_like(&self.workspace);
        pair.other.view.style_epoch += u64::from(is_new);
        self.follow_run(&mut pair);
        self.compare_runs(&mut pair);
        self.overlap(&mut pair);
        self.pair = Some(pair);
    }

    /// Brings the second run to the state of the first, once it is open, and looks whether both lie in one place.
    fn start(&mut self, pair: &mut Pair) {
        let (Some(a), Some(b)) = (&self.run.opened, &pair.other.run.opened) else { return };
        let numbers = [self.run.number, pair.other.run.number];
        if pair.is_in_one_place.is_none_or(|known| known.1 != numbers) {
            pair.is_in_one_place = Some((are_in_one_place(a, b), numbers));
        }
        if let Some(step) = pair.first_step.take() {
            pair.numbers = Some(numbers);
            pair.other.view.notes = self.view.notes;
            pair.other.go(Goal::Step(step));
        } else if pair.is_starting && !pair.other.run.is_busy() {
            pair.is_starting = false;
            pair.followed = Some(position(pair, self));
            if let Some(rules) = pair.first_rules.take() {
                pair.other.apply(Command::SetRules(rules));
            }
        }
    }

    /// Sends the other run where the active one is, as their steps are linked.
    fn follow_run(&mut self, pair: &mut Pair) {
        if pair.is_starting {
            return;
        }
        let at = position(pair, self);
        if let Some(steps) = pair.apart {
            let runs = [&self.run, &pair.other.run];
            if runs.iter().any(|run| run.is_busy()) {
                return;
            }
            if runs.map(|run| run.moment.as_ref().map(|moment| moment.step)) == steps.map(Some) {
                pair.followed = Some(at);
                return;
            }
            pair.apart = None;
        }
        if pair.link == LinkedBy::Free {
            return;
        }
        let active = pair.active;
        let (leader, follower) = match active {
            Which::A => (&*self, &mut *pair.other),
            Which::B => (&*pair.other, &mut *self),
        };
        let (Some(moment), Some(there)) = (&leader.run.moment, &follower.run.moment) else { return };
        if pair.followed == Some(at) {
            return;
        }
        let is_waiting = follower.run.is_busy();
        let goal = match pair.link {
            LinkedBy::Free => return,
            LinkedBy::Step => Goal::Step(moment.step),
            LinkedBy::Quad | LinkedBy::Event if moment.phase == Phase::Done => Goal::End,
            LinkedBy::Quad => Goal::ToQuads(moment.standing),
            LinkedBy::Event => match same_event(&leader.run, moment, &follower.run) {
                Some(step) => Goal::Step(step),
                // The other run is not recorded that far yet.
                None => return,
            },
        };
        let is_there = !is_waiting && matches!(goal, Goal::Step(step) if step == there.step);
        if !is_there {
            follower.go(goal);
        }
        pair.followed = Some(at);
    }

    /// Compares the runs anew when one of them has changed.
    fn compare_runs(&mut self, pair: &mut Pair) {
        let is_known = pair.compared.as_ref().is_some_and(|[a, b]| is_of(a, self) && is_of(b, &pair.other));
        if !is_known && let (Some(a), Some(b)) = (self.current_run(), pair.other.current_run()) {
            pair.is_same = are_same(&a, &b);
            pair.forget_comparison();
            if !pair.is_same {
                pair.comparing = Some(Comparing::begin([a, b], self.wake.clone()));
            }
            pair.compared = Some([compared(self), compared(&pair.other)]);
        }
        while let Some(comparing) = &pair.comparing {
            match comparing.hear() {
                Ok(CompareNews::Progress(progress)) => pair.progress = Some(progress),
                Ok(CompareNews::First(found)) => {
                    let first_difference = found.map(|found| *found);
                    pair.comparison = Some(Comparison { first_difference, reports: None, differences: None });
                }
                Ok(CompareNews::Reports(reports)) => {
                    if let Some(comparison) = &mut pair.comparison {
                        comparison.reports = Some(*reports);
                    }
                }
                Ok(CompareNews::Differences(all)) => {
                    pair.progress = None;
                    if let Some(comparison) = &mut pair.comparison {
                        comparison.differences = Some(all);
                    }
                }
                Ok(CompareNews::Told(place, did)) => {
                    if let Some(shown) = pair.shown.as_mut().filter(|shown| shown.place == place) {
                        shown.did = Some(*did);
                    }
                }
                Ok(CompareNews::Fault(fault)) => self.complain(&fault),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => (pair.comparing, pair.progress) = (None, None),
            }
        }
    }

    /// Finds what both states have in common.
    fn overlap(&self, pair: &mut Pair) {
        let (a, b) = (&self.run, &pair.other.run);
        let (Some(of_a), Some(of_b)) = (&a.moment, &b.moment) else { return };
        if a.is_busy() || b.is_busy() {
            return;
        }
        let is_known = pair.overlapped.as_ref().is_some_and(|[(a, at_a), (b, at_b)]| {
            (*at_a, *at_b) == (of_a.step, of_b.step) && is_of(a, self) && is_of(b, &pair.other)
        });
        let is_playing = a.playing.is_some() || b.playing.is_some();
        let is_large = of_a.mesh.element_count() + of_b.mesh.element_count() > QUICK;
        let waits = is_playing && is_large;
        if !is_known && !waits {
            pair.overlap = Some(Arc::new(Overlap::of(&of_a.mesh, &of_b.mesh)));
            pair.overlapped = Some([(compared(self), of_a.step), (compared(&pair.other), of_b.step)]);
        }
    }
}

/// What the states of a run depend on.
fn compared(state: &State) -> Compared {
    (state.run.number, state.document().edits.clone())
}

/// Whether this is what the states of a run depend on.
fn is_of((number, edits): &Compared, state: &State) -> bool {
    *number == state.run.number && *edits == state.document().edits
}

/// Where the active run is.
fn position(pair: &Pair, first: &State) -> (Which, u64, u64, LinkedBy) {
    let run = match pair.active {
        Which::A => &first.run,
        Which::B => &pair.other.run,
    };
    (pair.active, run.number, run.moment.as_ref().map_or(0, |moment| moment.step), pair.link)
}

/// The step of the event in another run that has the kind and the number of the last event: its end where there is
/// none, `None` where it is not known yet.
fn same_event(leader: &RunState, moment: &Moment, follower: &RunState) -> Option<u64> {
    let Some(kind) = moment.event.as_ref().map(|event| event.kind()) else { return Some(0) };
    let before = leader.track.iter().take(moment.step as usize);
    let number = before.filter(|tracked| tracked.kind == kind).count();
    let mut same = follower.track.iter().zip(1..).filter(|(tracked, _)| tracked.kind == kind);
    match same.nth(number.saturating_sub(1)) {
        Some((_, step)) => Some(step),
        None => follower.recorded.then_some(follower.track.len() as u64),
    }
}
