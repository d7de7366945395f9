//! What the global post-processing (paper 4.3.7) has under way and has done.

use super::clean_up::{CleanUp, CleanUpMark, CleanedUp};
use super::rows::RowLaying;
use super::unfold::{Unfolded, Unfolding};
use super::worklist::{ListMark, Worklist};
use crate::core::convert::sums::summed;

summed! {
/// What the post-processing did.
pub struct Finished {
    /// Changes of structure.
    pub cleaned_up: CleanedUp,
    /// Nodes laid on the normals of walls.
    pub laid: usize,
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
    pub(super) clean_up: Option<CleanUp<'a>>,
    pub(super) rows: Option<RowLaying>,
    pub(super) last_smoothing: Option<Worklist>,
    pub(super) unfolding: Option<Unfolding<'a>>,
}

/// Where the parts stood; none where a part had not begun.
#[derive(Clone, Copy, Debug, Default)]
pub struct PartMarks {
    first_smoothing: Option<ListMark>,
    clean_up: Option<CleanUpMark>,
    rows: Option<u32>,
    last_smoothing: Option<ListMark>,
    unfolding: Option<ListMark>,
}

impl Finishing<'_> {
    /// The lists of the parts, but for those of the clean-up.
    fn lists(&self) -> impl Iterator<Item = &Worklist> {
        let unfolding = self.unfolding.as_ref().map(|part| &part.list);
        [self.first_smoothing.as_ref(), self.last_smoothing.as_ref(), unfolding].into_iter().flatten()
    }

    /// Bytes that the parts take.
    pub fn bytes(&self) -> usize {
        self.lists().map(Worklist::bytes).sum::<usize>()
            + self.clean_up.as_ref().map_or(0, CleanUp::bytes)
            + self.rows.as_ref().map_or(0, RowLaying::bytes)
            + self.unfolding.as_ref().map_or(0, Unfolding::bytes_of_rest)
    }

    /// Bytes of what the parts have written down for taking back.
    pub fn log_bytes(&self) -> usize {
        self.lists().map(Worklist::log_bytes).sum::<usize>() + self.clean_up.as_ref().map_or(0, CleanUp::log_bytes)
    }

    /// Lets every part write down from now on what it needs to be taken back.
    pub fn record(&mut self) {
        let unfolding = self.unfolding.as_mut().map(|part| &mut part.list);
        let lists = [self.first_smoothing.as_mut(), self.last_smoothing.as_mut(), unfolding];
        lists.into_iter().flatten().for_each(Worklist::record);
        self.clean_up.iter_mut().for_each(CleanUp::record);
    }

    /// The present place.
    pub fn mark(&self) -> PartMarks {
        PartMarks {
            first_smoothing: self.first_smoothing.as_ref().map(Worklist::mark),
            clean_up: self.clean_up.as_ref().map(CleanUp::mark),
            rows: self.rows.as_ref().map(RowLaying::mark),
            last_smoothing: self.last_smoothing.as_ref().map(Worklist::mark),
            unfolding: self.unfolding.as_ref().map(|part| part.list.mark()),
        }
    }

    /// Takes back everything that was done after the marks; `cleaned_up` is what the clean-up had done then.
    pub fn take_back(&mut self, marks: PartMarks, cleaned_up: CleanedUp) {
        take_back(&mut self.first_smoothing, marks.first_smoothing, Worklist::take_back);
        take_back(&mut self.clean_up, marks.clean_up, |part, mark| part.take_back(mark, cleaned_up));
        take_back(&mut self.rows, marks.rows, RowLaying::take_back);
        take_back(&mut self.last_smoothing, marks.last_smoothing, Worklist::take_back);
        take_back(&mut self.unfolding, marks.unfolding, |part, mark| part.list.take_back(mark));
    }

    /// Appends what the next steps depend on.
    pub fn write_state(&self, bytes: &mut Vec<u8>) {
        self.lists().for_each(|list| list.write_state(bytes));
        self.clean_up.iter().for_each(|part| part.write_state(bytes));
        self.rows.iter().for_each(|part| part.write_state(bytes));
    }
}

/// Takes a part back to a mark; without one it had not begun.
fn take_back<P, M>(part: &mut Option<P>, mark: Option<M>, back: impl FnOnce(&mut P, M)) {
    match (part.as_mut(), mark) {
        (Some(part), Some(mark)) => back(part, mark),
        _ => *part = None,
    }
}
