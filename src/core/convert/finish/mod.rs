//! Global post-processing (paper 4.3.7): smoothing by the energy, clean-up of the structure, laying of the rows at
//! walls, smoothing again; once every face is converted, what folds over its surface is repaired. A step is one sweep
//! of the smoothing, one change of the structure or one row.

pub(super) mod parts;
mod worklist;
pub mod clean_up;
mod rows;
pub mod unfold;

pub use self::parts::Finished;

use std::sync::Arc;

use self::clean_up::CleanUp;
use self::parts::Finishing;
use self::rows::RowLaying;
use self::unfold::{Unfolded, Unfolding};
use self::worklist::Worklist;
use super::event::{Event, Mending};
use super::front::Done;
use super::phase::{FinishPart, Phase};
use super::relax::energy;
use crate::core::case::CleanUpBy;
use crate::core::mesh::{Mesh, NodeId};
use crate::core::metric::MetricSource;

/// A node that moved farther than this (in its metric) sends its neighbours to be looked at again.
const STIRRED: f64 = 0.02;
/// Looks at one node at the most, on average.
const MOST_LOOKS: usize = 12;

/// The post-processing of a mesh, or of the face of it that is at hand.
pub(super) struct PostProcessing<'f, 'a> {
    pub mesh: &'f mut Mesh,
    pub source: &'f Arc<dyn MetricSource + Send + Sync + 'a>,
    /// The face, by its region; none where it is all.
    pub face: Option<u32>,
    /// What is under way.
    pub parts: &'f mut Finishing<'a>,
    /// What was done.
    pub finished: &'f mut Finished,
    /// How the structure is cleaned up.
    pub by: CleanUpBy,
    /// Whether rows at walls are laid.
    pub lays_rows: bool,
    /// Whether the parts write down what they need to be taken back.
    pub keeps_history: bool,
    /// Whether the journal stays; else it is forgotten on the way.
    pub keeps_journal: bool,
}

impl PostProcessing<'_, '_> {
    /// The next sweep or change of structure; where a part is done, the next part. Elements stay strictly convex.
    pub fn step(&mut self, part: FinishPart) -> Done {
        let event = match part {
            FinishPart::FirstSmoothing | FinishPart::LastSmoothing => self.sweep(part),
            FinishPart::CleanUp => self.clean_up(),
            FinishPart::Rows => self.lay_row(),
            FinishPart::Unfolding => self.unfold(),
        };
        if event.is_some() {
            return (Phase::PostProcess { part }, event);
        }
        let next = match part {
            FinishPart::FirstSmoothing => FinishPart::CleanUp,
            FinishPart::CleanUp if self.lays_rows => FinishPart::Rows,
            FinishPart::CleanUp | FinishPart::Rows => FinishPart::LastSmoothing,
            FinishPart::LastSmoothing if self.face.is_some() => return (Phase::NextFace, Some(Event::PostProcessed)),
            FinishPart::LastSmoothing | FinishPart::Unfolding => return (Phase::Done, Some(Event::PostProcessed)),
        };
        (Phase::PostProcess { part: next }, None)
    }

    /// The next change of structure.
    fn clean_up(&mut self) -> Option<Event> {
        let (mesh, done) = (&mut *self.mesh, self.finished.cleaned_up);
        let begin = || CleanUp::begin(mesh, self.face, self.source, self.by, done, self.keeps_history);
        let part = self.parts.clean_up.get_or_insert_with(begin);
        let event = part.step(mesh, self.keeps_journal);
        self.finished.cleaned_up = part.done;
        event
    }

    /// Lays the next row at the walls.
    fn lay_row(&mut self) -> Option<Event> {
        let (mesh, source) = (&mut *self.mesh, &**self.source);
        let part = self.parts.rows.get_or_insert_with(|| RowLaying::begin(mesh, source, self.face));
        let event = part.step(mesh, source)?;
        if let Event::RowLaid { laid, .. } = event {
            self.finished.laid += laid as usize;
        }
        if !self.keeps_journal {
            mesh.commit();
        }
        Some(event)
    }

    /// Repairs the next quadrilateral that folds over its surface.
    fn unfold(&mut self) -> Option<Event> {
        let (mesh, recording) = (&mut *self.mesh, self.keeps_history);
        let begin = || Unfolding::begin(mesh, Arc::clone(self.source), recording);
        let event = self.parts.unfolding.get_or_insert_with(begin).step(mesh, self.keeps_journal)?;
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
    /// where no node waits any more. Nodes of rows that are laid stay.
    fn sweep(&mut self, part: FinishPart) -> Option<Event> {
        let mesh = &mut *self.mesh;
        let Finishing { first_smoothing, last_smoothing, rows, .. } = &mut *self.parts;
        let list = if part == FinishPart::FirstSmoothing { first_smoothing } else { last_smoothing };
        let stays = |mesh: &Mesh, n: NodeId| mesh.is_fixed(n) || rows.as_ref().is_some_and(|rows| rows.stays(mesh, n));
        let list = list.get_or_insert_with(|| every_free_node(mesh, self.face, &stays, self.keeps_history));
        let (mut looked, mut moved) = (0, 0);
        for _ in 0..list.len() {
            let Some(node) = list.take() else { break };
            looked += 1;
            let distance = energy::relax(mesh, node, &**self.source);
            moved += u32::from(distance > 0.0);
            if distance > STIRRED {
                for n in mesh.neighbours(node).chain([node]) {
                    if !stays(mesh, n) {
                        list.add(n);
                    }
                }
            }
            if !self.keeps_journal {
                mesh.commit();
            }
        }
        self.finished.moves += moved as usize;
        (looked > 0).then_some(Event::Swept { looked, moved })
    }
}

/// Waiting: every node that does not stay.
fn every_free_node(mesh: &Mesh, face: Option<u32>, stays: &dyn Fn(&Mesh, NodeId) -> bool, recording: bool) -> Worklist {
    let free = || mesh.nodes_of(face).filter(|&n| !stays(mesh, n));
    let mut list = Worklist::new(MOST_LOOKS * free().count(), recording);
    free().for_each(|node| list.add(node));
    list
}
