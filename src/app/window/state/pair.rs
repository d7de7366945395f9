//! A second run beside the first: a state of its own, whose steps and cameras are linked with those of the first.

use std::sync::Arc;

use super::{Progress, State, Workspace};
use crate::app::window::command::Rules;
use crate::app::window::pair::{Arrangement, Comparing, LinkedBy, Which};
use crate::core::record::Report;
use crate::core::run::compare::{Did, Difference, FirstDifference, Overlap};
use crate::core::run::{Edit, Run};

/// Two runs.
pub struct Pair {
    /// Run B.
    pub(super) other: Box<State>,
    /// The run that the panels show.
    pub active: Which,
    /// How their steps are linked.
    pub link: LinkedBy,
    /// How they are shown.
    pub arrangement: Arrangement,
    /// The step of the fork; `None` where B was opened from elsewhere.
    forked: Option<u64>,
    /// The numbers of both runs once B was open.
    pub(super) numbers: Option<[u64; 2]>,
    /// What the comparison of both has found so far, once the first difference is known.
    pub comparison: Option<Comparison>,
    /// The difference that is shown in place of the first one.
    pub shown: Option<ShownDifference>,
    /// The steps of the two runs at a difference to which both were sent; until one of them moves on, they are not
    /// linked.
    pub(super) apart: Option<[u64; 2]>,
    /// Whether both have the same case, parameters and changes.
    pub is_same: bool,
    /// How far the comparison is.
    pub progress: Option<Progress>,
    /// The quadrilaterals that both have in the states that are shown.
    pub overlap: Option<Arc<Overlap>>,
    pub(super) comparing: Option<Comparing>,
    /// What was compared last.
    pub(super) compared: Option<[Compared; 2]>,
    /// Whether B has not reached its first state yet.
    pub(super) is_starting: bool,
    /// The state of the active run that the other one has followed last.
    pub(super) followed: Option<(Which, u64, u64, LinkedBy)>,
    /// The runs, with their steps, of which the overlap is known.
    pub(super) overlapped: Option<[(Compared, u64); 2]>,
    /// Where B goes first, until it has been asked to.
    pub(super) first_step: Option<u64>,
    /// The parameters that B takes there.
    pub(super) first_rules: Option<Rules>,
    /// Whether both meshes lie in one place, so that one camera shows both; and the numbers of the runs.
    pub(super) is_in_one_place: Option<(bool, [u64; 2])>,
}

/// What the comparison of two runs has found so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// `None` where they never differ.
    pub first_difference: Option<FirstDifference>,
    /// The report of each at its end, with the time that it takes by itself.
    pub reports: Option<[Report; 2]>,
    /// The decisions in which they differ although their fronts are the same there.
    pub differences: Option<Vec<Difference>>,
}

/// A decision in which both runs differ although their fronts are the same there.
pub struct ShownDifference {
    /// Its place in the list of the comparison.
    pub place: usize,
    /// What both did, and why, once that is known.
    pub did: Option<[Option<Did>; 2]>,
}

/// The number of a run and its changes.
pub(super) type Compared = (u64, Vec<Edit>);

impl Pair {
    pub(super) fn new(other: Box<State>, forked: Option<u64>) -> Pair {
        Pair {
            other,
            active: Which::B,
            link: LinkedBy::default(),
            arrangement: Arrangement::default(),
            forked,
            numbers: None,
            comparison: None,
            shown: None,
            apart: None,
            is_same: false,
            progress: None,
            overlap: None,
            comparing: None,
            compared: None,
            is_starting: true,
            followed: None,
            overlapped: None,
            first_step: None,
            first_rules: None,
            is_in_one_place: None,
        }
    }

    /// The run that was forked from the other one, and at which step; `None` where B was opened from elsewhere, and
    /// where one of them has been replaced since.
    pub fn fork(&self, numbers: [u64; 2]) -> Option<(Which, u64)> {
        let (step, [a, b]) = (self.forked?, self.numbers?);
        match numbers {
            _ if numbers == [a, b] => Some((Which::B, step)),
            _ if numbers == [b, a] => Some((Which::A, step)),
            _ => None,
        }
    }

    /// Forgets what was compared.
    pub(super) fn forget_comparison(&mut self) {
        (self.comparison, self.progress, self.comparing) = (None, None, None);
        (self.shown, self.apart) = (None, None);
    }

    /// Whether the comparison still goes on, or waits to be asked about a difference.
    pub fn is_comparing(&self) -> bool {
        self.comparing.is_some()
    }

    /// The step at which the runs differ first, once it is known.
    pub fn first_difference(&self) -> Option<u64> {
        self.comparison.as_ref()?.first_difference.as_ref().map(|found| found.step)
    }
}

impl State {
    /// The pair of runs, where there is a second one.
    pub fn pair(&self) -> Option<&Pair> {
        self.pair.as_ref()
    }

    /// One of the two runs: A is this one.
    pub fn of(&self, which: Which) -> &State {
        match &self.pair {
            Some(pair) if which == Which::B => &pair.other,
            _ => self,
        }
    }

    /// Which of the runs the panels show.
    pub fn active_run(&self) -> Which {
        self.pair.as_ref().map_or(Which::A, |pair| pair.active)
    }

    /// The run that the panels show.
    pub fn active(&self) -> &State {
        self.of(self.active_run())
    }

    /// The state of a second run with nothing open, which looks like this one.
    pub(super) fn beside(&self) -> State {
        let mut other = State::new(self.wake.clone(), Workspace::default());
        other.workspace.look_like(&self.workspace);
        other.is_second = true;
        // Panels tell the runs apart by their numbers.
        other.run.number = self.run.number + SECOND;
        other.run.track_epoch = self.run.track_epoch + SECOND;
        other.run.autosave = self.run.autosave.as_ref().map(|autosave| autosave.beside());
        other
    }
}

/// What the numbers of a second run begin with.
const SECOND: u64 = 1 << 32;

/// Whether two runs lead to the same states.
pub(super) fn are_same(a: &Run, b: &Run) -> bool {
    a.case == b.case && a.parameters == b.parameters && a.edits() == b.edits()
}
