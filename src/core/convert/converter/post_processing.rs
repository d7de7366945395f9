//! Global post-processing (paper 4.3.7): smoothing by the energy, clean-up of the structure, smoothing again, all by
//! worklists. A step is one sweep of the smoothing, or one change of the structure.

use std::sync::Arc;

use super::Converter;
use crate::core::convert::clean_up::{CleanUp, Reach};
use crate::core::convert::energy;
use crate::core::convert::event::{Event, Mending};
use crate::core::convert::phase::{Part, Phase};
use crate::core::convert::unfold::{Unfolded, Unfolding};
use crate::core::convert::worklist::Worklist;
use crate::core::mesh::half_edge::Mesh;

/// A node that moved farther than this (in its metric) sends its neighbours to be looked at again.
const STIRRED: f64 = 0.02;
/// Looks at one node at the most, on average.
const MOST_LOOKS: usize = 12;

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
