//! Clean-up of the structure around irregular nodes (docs/algorithm.md, "Clean-up"): changes of one or two elements
//! first, then cavities of many that are filled anew. Each is a transaction, judged by the energy of all that it moves,
//! which may rise a little where irregular nodes go. Or the traditional operations alone, judged by the valences.
//!
//! Worklists, not sweeps: the irregular nodes, and again those around whatever changed. Nodes wait for every reach, and
//! the narrowest reach at which a node waits comes first.

mod candidate;
mod local;
mod cavity;
mod region;
mod seen;

use std::sync::Arc;

use smallvec::SmallVec;

use self::candidate::Valences;
use self::cavity::Cavities;
use self::local::Local;
use super::worklist::{ListMark, Worklist};
use crate::core::case::CleanUpBy;
use crate::core::convert::event::Event;
use crate::core::convert::sums::summed;
use crate::core::mesh::{Mesh, NodeId};
use crate::core::metric::MetricSource;

summed! {
/// What the clean-up did, by operation.
pub struct CleanedUp {
    /// Diamonds collapsed.
    pub collapses: usize,
    /// Edges rotated.
    pub rotations: usize,
    /// Vertices opened.
    pub openings: usize,
    /// Doublets removed.
    pub doublets: usize,
    /// Cavities filled anew.
    pub refills: usize,
    /// Changes tried.
    pub trials: usize,
    /// Trials taken back.
    pub refused: usize,
}
}

/// How much of the mesh a change may replace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reach {
    /// The whole face.
    Whole,
    /// The elements at one edge or node.
    Local,
    /// A cavity of at most this many elements.
    Cavity(usize),
}

/// The reaches, in the order in which they are tried. A whole face that can be a grid needs nothing else. Beyond 600
/// elements a cavity is seldom found that a smaller one does not make superfluous (docs/experiments.md).
const REACHES: [Reach; 5] = [Reach::Whole, Reach::Local, Reach::Cavity(40), Reach::Cavity(150), Reach::Cavity(600)];

/// The nodes around which a change has altered the mesh.
type Touched = SmallVec<[NodeId; 24]>;

/// A change that was kept.
struct Kept {
    /// The nodes around which the mesh has changed.
    touched: Touched,
    event: Event,
}

/// The clean-up of an all-quadrilateral mesh, or of a face of it, under way: until no change that it reaches is an
/// improvement, within budgets linear in the number of nodes.
#[derive(Clone)]
pub(super) struct CleanUp<'a> {
    by: CleanUpBy,
    face: Option<u32>,
    valences: Valences,
    /// Irregular nodes that wait, for each reach.
    lists: [Worklist; REACHES.len()],
    local: Local<'a>,
    cavities: Cavities<'a>,
    /// What was done so far.
    pub done: CleanedUp,
}

/// A place to which a clean-up can be taken back.
#[derive(Clone, Copy, Debug)]
pub struct CleanUpMark {
    lists: [ListMark; REACHES.len()],
    refusals: usize,
}

impl<'a> CleanUp<'a> {
    /// A clean-up of a face, or of all, at its beginning. It writes down what it needs to be taken back where
    /// `recording`. Counts continue from `done`.
    pub fn begin(
        mesh: &Mesh,
        face: Option<u32>,
        source: &Arc<dyn MetricSource + Send + Sync + 'a>,
        by: CleanUpBy,
        done: CleanedUp,
        recording: bool,
    ) -> CleanUp<'a> {
        let valences = Valences::of(mesh);
        let irregular: Vec<NodeId> = mesh.nodes_of(face).filter(|&n| valences.excess(mesh, n) != 0).collect();
        let nodes = mesh.nodes_of(face).count();
        let lists = REACHES.map(|reach| {
            // Kept changes lower the energy or the number of irregular nodes; the budgets bound how many there are.
            let looks = match reach {
                Reach::Whole => 1,
                Reach::Local => 20 * nodes + 1000,
                Reach::Cavity(_) => nodes + 1000,
            };
            let mut list = Worklist::new(looks, recording);
            if by == CleanUpBy::Search || reach == Reach::Local {
                let most = if reach == Reach::Whole { 1 } else { usize::MAX };
                irregular.iter().take(most).for_each(|&node| list.add(node));
            }
            list
        });
        CleanUp {
            by,
            face,
            valences,
            lists,
            local: Local::new(Arc::clone(source)),
            cavities: Cavities::new(Arc::clone(source)),
            done,
        }
    }

    /// One kept change of the structure: looks at the nodes that wait until there is one. None where no node waits any
    /// more, or the budgets are spent.
    pub fn step(&mut self, mesh: &mut Mesh, keep_journal: bool) -> Option<Event> {
        loop {
            let (reach, node) = self.next()?;
            if !mesh.has_node(node) || self.valences.excess(mesh, node) == 0 {
                continue;
            }
            let (valences, done) = (&self.valences, &mut self.done);
            let kept = match reach {
                Reach::Whole => self.cavities.whole(mesh, valences, self.face, keep_journal, done),
                Reach::Local => self.local.change(mesh, valences, node, self.by, done),
                Reach::Cavity(limit) => self.cavities.grow(mesh, valences, node, limit, done),
            };
            if !keep_journal {
                mesh.commit();
            }
            if let Some(Kept { touched, event }) = kept {
                for node in touched {
                    self.enqueue(mesh, node);
                }
                return Some(event);
            }
        }
    }

    /// The next node that waits, with the reach for which it waits.
    fn next(&mut self) -> Option<(Reach, NodeId)> {
        REACHES.iter().zip(&mut self.lists).find_map(|(&reach, list)| Some((reach, list.take()?)))
    }

    /// Lets the irregular ones of a node and its neighbours wait, for every reach but the whole face.
    fn enqueue(&mut self, mesh: &Mesh, node: NodeId) {
        let around: Touched = mesh.neighbours(node).chain([node]).collect();
        for n in around.into_iter().filter(|&n| self.valences.excess(mesh, n) != 0) {
            for (reach, list) in REACHES.iter().zip(&mut self.lists) {
                if *reach == Reach::Local || (self.by == CleanUpBy::Search && *reach != Reach::Whole) {
                    list.add(n);
                }
            }
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.lists.iter().map(Worklist::bytes).sum::<usize>()
            + self.valences.bytes()
            + self.local.bytes()
            + self.cavities.bytes()
    }

    /// Bytes of what is written down for taking back.
    pub fn log_bytes(&self) -> usize {
        self.lists.iter().map(Worklist::log_bytes).sum()
    }

    /// Writes down from now on what it needs to be taken back.
    pub fn record(&mut self) {
        self.lists.iter_mut().for_each(Worklist::record);
    }

    /// The present place.
    pub fn mark(&self) -> CleanUpMark {
        CleanUpMark { lists: self.lists.each_ref().map(Worklist::mark), refusals: self.cavities.refusals() }
    }

    /// Takes back everything that was done after the mark; `done` is what had been done then.
    pub fn take_back(&mut self, mark: CleanUpMark, done: CleanedUp) {
        self.lists.iter_mut().zip(mark.lists).for_each(|(list, mark)| list.take_back(mark));
        self.cavities.forget_refusals(mark.refusals);
        self.done = done;
    }

    /// Appends what the next steps depend on.
    pub fn write_state(&self, bytes: &mut Vec<u8>) {
        self.lists.iter().for_each(|list| list.write_state(bytes));
    }
}
