//! Global post-processing (paper 4.3.7): smoothing by the energy, clean-up of the structure, smoothing again, all by
//! worklists. A step is one sweep of the smoothing, or one change of the structure.

use std::sync::Arc;

use super::clean_up::{CleanUp, CleanedUp, Reach};
use super::converter::Converter;
use super::energy;
use super::event::{Event, Mending};
use super::phase::{Part, Phase};
use super::unfold::{Unfolded, Unfolding};
use super::worklist::{ListMark, Worklist};
use crate::core::mesh::half_edge::Mesh;

/// A node that moved farther than this (in its metric) sends its neighbours to be looked at again.
const STIRRED: f64 = 0.02;
/// Looks at one node at the most, on average.
const MOST_LOOKS: usize = 12;

/// What the post-processing did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    first_smoothing: Option<Worklist>,
    clean_up: [Option<CleanUp<'a>>; 3],
    last_smoothing: Option<Worklist>,
    unfolding: Option<Unfolding<'a>>,
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
    fn pairs_are_cut_short(&self) -> bool {
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

impl Converter<'_> {
    /// The next sweep or change of structure. Every one keeps all elements strictly convex. Where no history is kept, the
    /// journal is forgotten on the way.
    pub(super) fn step_post_process(&mut self, mut part: Part) -> (Phase, Event) {
        loop {
            let event = match part {
                Part::FirstSmoothing | Part::LastSmoothing => self.sweep(part),
                Part::CleanUp => self.clean_up(Reach::Singles),
                Part::CleanUpByPairs => self.clean_up(Reach::Pairs),
                Part::CleanUpBySequences => self.clean_up(Reach::Longer),
                Part::Unfolding => self.unfold(),
            };
            if let Some(event) = event {
                return (Phase::PostProcess { part }, event);
            }
            match part {
                Part::FirstSmoothing => part = Part::CleanUp,
                Part::CleanUp => part = Part::CleanUpByPairs,
                Part::CleanUpByPairs if self.finishing.pairs_are_cut_short() => part = Part::LastSmoothing,
                Part::CleanUpByPairs => part = Part::CleanUpBySequences,
                Part::CleanUpBySequences => part = Part::LastSmoothing,
                Part::LastSmoothing if self.face().is_some() => return (Phase::NextFace, Event::PostProcessed),
                Part::LastSmoothing | Part::Unfolding => return (Phase::Done, Event::PostProcessed),
            }
        }
    }

    /// The next change of structure within reach.
    fn clean_up(&mut self, reach: Reach) -> Option<Event> {
        let (recording, keep_journal) = (self.keeps_history(), self.keeps_journal());
        let (face, share) = (self.face(), self.share());
        let (mesh, source, done) = (&mut self.mesh, Arc::clone(&self.source), self.finished.cleaned_up);
        let part = &mut self.finishing.clean_up[reach as usize];
        let part = part.get_or_insert_with(|| CleanUp::begin(mesh, (face, share), source, reach, done, recording));
        let event = part.step(mesh, keep_journal);
        self.finished.cleaned_up = part.done();
        event
    }

    /// Mends the next quadrilateral that folds over its surface.
    fn unfold(&mut self) -> Option<Event> {
        let (recording, keep_journal) = (self.keeps_history(), self.keeps_journal());
        let (mesh, source) = (&mut self.mesh, Arc::clone(&self.source));
        let part = self.finishing.unfolding.get_or_insert_with(|| Unfolding::begin(mesh, source, recording));
        let event = part.step(mesh, keep_journal)?;
        if let Event::Unfolded { how, .. } = event {
            let Unfolded { moved, rotated, collapsed, pillowed } = &mut self.finished.unfolded;
            match how {
                Mending::Moved => *moved += 1,
                Mending::Rotated { .. } => *rotated += 1,
                Mending::Collapsed { .. } => *collapsed += 1,
                Mending::Pillowed { .. } => *pillowed += 1,
            }
        }
        Some(event)
    }

    /// Looks at every free node that waits: all in the first sweep of a part, then those around nodes that moved. None
    /// where no node waits any more.
    fn sweep(&mut self, part: Part) -> Option<Event> {
        let (recording, keep_journal) = (self.keeps_history(), self.keeps_journal());
        let face = self.face();
        let mesh = &mut self.mesh;
        let list = match part {
            Part::FirstSmoothing => &mut self.finishing.first_smoothing,
            _ => &mut self.finishing.last_smoothing,
        };
        let list = list.get_or_insert_with(|| every_free_node(mesh, face, recording));
        let (mut looked, mut moved) = (0, 0);
        for _ in 0..list.len() {
            let Some(node) = list.take() else { break };
            looked += 1;
            let distance = energy::relax(mesh, node, &*self.source);
            moved += u32::from(distance > 0.0);
            if distance > STIRRED {
                for n in mesh.neighbours(node).chain([node]) {
                    if !mesh.is_fixed(n) {
                        list.add(n);
                    }
                }
            }
            if !keep_journal {
                mesh.commit();
            }
        }
        self.finished.moves += moved as usize;
        (looked > 0).then_some(Event::Swept { looked, moved })
    }
}

fn every_free_node(mesh: &Mesh, face: Option<u32>, recording: bool) -> Worklist {
    let free = || mesh.nodes_of(face).filter(|&n| !mesh.is_fixed(n));
    let mut list = Worklist::new(MOST_LOOKS * free().count(), recording);
    free().for_each(|node| list.add(node));
    list
}
