//! What the global post-processing (paper 4.3.7) has under way and has done.

use super::clean_up::{CleanUp, CleanedUp, Reach};
use super::unfold::{Unfolded, Unfolding};
use super::worklist::{ListMark, Worklist};
use crate::core::convert::sums::summed;

summed! {
/// What the post-processing did.
pub struct Finished {
    /// Changes of structure.
    pub cleaned_up: CleanedUp,
    /// Nodes moved by smoothing.
    pub moves: usize,
    /// Repairs of what folded over its surface.
    pub unfolded: Unfolded,
}
}

/// The parts of the post-processing that have begun. Those that are done are kept for stepping back.
#[derive(Clone, Default)]
pub struct Finishing<'a> {
    pub(super) first_smoothing: Option<Worklist>,
    pub(super) clean_up: [Option<CleanUp<'a>>; 3],
    pub(super) last_smoothing: Option<Worklist>,
    pub(super) unfolding: Option<Unfolding<'a>>,
}

/// Where the lists of the parts stood; none where a part had not begun.
#[derive(Clone, Copy, Debug, Default)]
pub struct PartMarks([Option<ListMark>; 6]);

impl Finishing<'_> {
    fn lists(&self) -> [Option<&Worklist>; 6] {
        let [singles, pairs, longer] = self.clean_up.each_ref().map(|part| part.as_ref().map(|part| &part.list));
        let unfolding = self.unfolding.as_ref().map(|part| &part.list);
        [self.first_smoothing.as_ref(), singles, pairs, longer, self.last_smoothing.as_ref(), unfolding]
    }

    fn lists_mut(&mut self) -> [Option<&mut Worklist>; 6] {
        let [singles, pairs, longer] = self.clean_up.each_mut().map(|part| part.as_mut().map(|part| &mut part.list));
        let unfolding = self.unfolding.as_mut().map(|part| &mut part.list);
        [self.first_smoothing.as_mut(), singles, pairs, longer, self.last_smoothing.as_mut(), unfolding]
    }

    /// Whether the budget of the pairs has ended before every node was looked at.
    pub fn pairs_are_cut_short(&self) -> bool {
        self.clean_up[Reach::Pairs.place()].as_ref().is_some_and(|part| part.list.len() > 0)
    }

    /// Bytes that the parts take.
    pub fn bytes(&self) -> usize {
        self.lists().into_iter().flatten().map(Worklist::bytes).sum::<usize>()
            + self.clean_up.iter().flatten().map(CleanUp::bytes_of_rest).sum::<usize>()
            + self.unfolding.as_ref().map_or(0, Unfolding::bytes_of_rest)
    }

    /// Bytes of what the parts have written down for taking back.
    pub fn log_bytes(&self) -> usize {
        self.lists().into_iter().flatten().map(Worklist::log_bytes).sum()
    }

    /// Lets every part write down from now on what it needs to be taken back.
    pub fn record(&mut self) {
        self.lists_mut().into_iter().flatten().for_each(Worklist::record);
    }

    /// The present place.
    pub fn mark(&self) -> PartMarks {
        PartMarks(self.lists().map(|list| list.map(Worklist::mark)))
    }

    /// Takes back everything that was done after the mark; `cleaned_up` is what the clean-up had done then.
    pub fn take_back(&mut self, PartMarks(marks): PartMarks, cleaned_up: CleanedUp) {
        for (list, mark) in self.lists_mut().into_iter().zip(marks) {
            if let (Some(list), Some(mark)) = (list, mark) {
                list.take_back(mark);
            }
        }
        // A part without a mark had not begun.
        let [first, clean_up @ .., last, unfolding] = marks;
        self.first_smoothing.take_if(|_| first.is_none());
        self.last_smoothing.take_if(|_| last.is_none());
        self.unfolding.take_if(|_| unfolding.is_none());
        for (part, mark) in self.clean_up.iter_mut().zip(clean_up) {
            part.take_if(|_| mark.is_none());
            part.iter_mut().for_each(|part| part.done = cleaned_up);
        }
    }

    /// Appends what the next steps depend on.
    pub fn write_state(&self, bytes: &mut Vec<u8>) {
        self.lists().into_iter().flatten().for_each(|list| list.write_state(bytes));
        // What pairs and longer sequences have left of their trials.
        let trials = self.clean_up.iter().flatten().map(|part| part.done.trials).max().unwrap_or(0);
        bytes.extend_from_slice(&(trials as u64).to_le_bytes());
    }
}
