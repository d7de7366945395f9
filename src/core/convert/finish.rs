//! What the global post-processing (paper 4.3.7) has under way and has done; its steps are in `converter/post_processing`.

use super::clean_up::{CleanUp, CleanedUp, Reach};
use super::unfold::{Unfolded, Unfolding};
use super::worklist::{ListMark, Worklist};

/// What the post-processing did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Finished {
    /// Changes of structure.
    pub cleaned_up: CleanedUp,
    /// Nodes moved by smoothing.
    pub moves: usize,
    /// What folded over its surface and was mended.
    pub unfolded: Unfolded,
}

impl Finished {
    /// The sums of two.
    #[must_use]
    pub fn plus(&self, other: &Finished) -> Finished {
        Finished {
            cleaned_up: self.cleaned_up.plus(&other.cleaned_up),
            moves: self.moves + other.moves,
            unfolded: self.unfolded.plus(&other.unfolded),
        }
    }
}

/// What the post-processing has under way: the parts that have begun. Those that are done are only there for whoever
/// steps back.
#[derive(Clone, Default)]
pub(super) struct Finishing<'a> {
    pub first_smoothing: Option<Worklist>,
    pub clean_up: [Option<CleanUp<'a>>; 3],
    pub last_smoothing: Option<Worklist>,
    pub unfolding: Option<Unfolding<'a>>,
}

/// Where the lists of the parts stood; none where a part had not begun.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PartMarks([Option<ListMark>; 6]);

impl Finishing<'_> {
    fn lists(&self) -> [Option<&Worklist>; 6] {
        let [singles, pairs, longer] = self.clean_up.each_ref().map(|part| part.as_ref().map(CleanUp::list));
        let unfolding = self.unfolding.as_ref().map(Unfolding::list);
        [self.first_smoothing.as_ref(), singles, pairs, longer, self.last_smoothing.as_ref(), unfolding]
    }

    /// Whether the budget of the pairs has ended before every node was looked at.
    pub fn pairs_are_cut_short(&self) -> bool {
        self.clean_up[Reach::Pairs as usize].as_ref().is_some_and(CleanUp::is_cut_short)
    }

    /// Bytes that the parts take.
    pub fn bytes(&self) -> usize {
        let lists = [&self.first_smoothing, &self.last_smoothing].into_iter().flatten();
        lists.map(Worklist::bytes).sum::<usize>()
            + self.clean_up.iter().flatten().map(CleanUp::bytes).sum::<usize>()
            + self.unfolding.as_ref().map_or(0, Unfolding::bytes)
    }

    /// Bytes of what the parts have written down for taking back.
    pub fn log_bytes(&self) -> usize {
        self.lists().into_iter().flatten().map(Worklist::log_bytes).sum()
    }

    /// Lets every part write down from now on what it needs to be taken back.
    pub fn record(&mut self) {
        let clean_up = self.clean_up.iter_mut().flatten().map(CleanUp::list_mut);
        let smoothing = [self.first_smoothing.as_mut(), self.last_smoothing.as_mut()];
        let unfolding = self.unfolding.iter_mut().map(Unfolding::list_mut);
        clean_up.chain(smoothing.into_iter().flatten()).chain(unfolding).for_each(Worklist::record);
    }

    /// The present place.
    pub fn mark(&self) -> PartMarks {
        PartMarks(self.lists().map(|list| list.map(Worklist::mark)))
    }

    /// Takes back everything that was done after the mark; `cleaned_up` is what the clean-up had done then.
    pub fn take_back(
        &mut self,
        PartMarks([first, singles, pairs, longer, last, unfolding]): PartMarks,
        cleaned_up: CleanedUp,
    ) {
        let list = |list: &mut Option<Worklist>, mark: Option<ListMark>| match (list.as_mut(), mark) {
            (Some(list), Some(mark)) => list.take_back(mark),
            _ => *list = None,
        };
        list(&mut self.first_smoothing, first);
        list(&mut self.last_smoothing, last);
        for (part, mark) in self.clean_up.iter_mut().zip([singles, pairs, longer]) {
            match (part.as_mut(), mark) {
                (Some(part), Some(mark)) => part.take_back(mark, cleaned_up),
                _ => *part = None,
            }
        }
        match (self.unfolding.as_mut(), unfolding) {
            (Some(part), Some(mark)) => part.take_back(mark),
            _ => self.unfolding = None,
        }
    }

    /// Appends what the next steps depend on.
    pub fn write_state(&self, bytes: &mut Vec<u8>) {
        self.lists().into_iter().flatten().for_each(|list| list.write_state(bytes));
        // What pairs and longer sequences have left of their trials.
        let trials = self.clean_up.iter().flatten().map(|part| part.done().trials).max().unwrap_or(0);
        bytes.extend_from_slice(&(trials as u64).to_le_bytes());
    }
}
