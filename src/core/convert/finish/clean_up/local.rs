//! Changes of the elements at one edge or node: diamond collapse, edge rotation, vertex opening and the removal of
//! doublets, tried by what they do to the valences and judged by the energy.

use std::sync::Arc;

use smallvec::SmallVec;

use super::candidate::{Candidate, Valences};
use super::region::Region;
use super::{CleanedUp, Kept};
use crate::core::case::CleanUpBy;
use crate::core::convert::event::{Cleaning, Event};
use crate::core::convert::relax::{RELAX_ROUNDS, energy, relax, untangle};
use crate::core::mesh::{Mesh, NodeId};
use crate::core::metric::MetricSource;

/// A kept change must leave every element around at least this quality, or not worse than the worst before.
const LEAST_QUALITY: f64 = 0.2;
/// The energy must fall by this much: differences below it are noise of the relaxation.
const LEAST_GAIN: f64 = 1e-2;
/// Changes tried at one node, best valence gain first.
const MOST_TRIALS: usize = 16;
/// An element below this quality is poor: around it the structure may become worse where the mesh becomes better.
const POOR: f64 = 0.4;
/// How much worse: the rise of the sum of squared excesses.
const MOST_WORSE: i32 = 2;
/// A trial whose energy has risen by this much when its own nodes are relaxed is given up before its surroundings are:
/// those seldom give back more (for one trial in a hundred).
const HOPELESS: f64 = 1.5;
/// It is also given up if it has risen by this much after one round: the other rounds give back less.
const LATER_ROUNDS_GIVE: f64 = 0.5;

/// What tries changes of a few elements.
#[derive(Clone)]
pub(super) struct Local<'a> {
    source: Arc<dyn MetricSource + Send + Sync + 'a>,
    /// Kept for their memory.
    before: Region,
    after: Region,
}

/// What a trial that stands in the mesh has come to.
struct Trial {
    /// The energy before and after.
    energy: [f64; 2],
    /// The worst quality before and after.
    quality: [f64; 2],
    kept: Kept,
}

impl Trial {
    /// Whether no element around has become too poor.
    fn is_sound(&self) -> bool {
        self.quality[1] >= self.quality[0].min(LEAST_QUALITY)
    }

    fn is_good(&self) -> bool {
        self.energy[1] - self.energy[0] < -LEAST_GAIN && self.is_sound()
    }
}

impl<'a> Local<'a> {
    pub fn new(source: Arc<dyn MetricSource + Send + Sync + 'a>) -> Local<'a> {
        Local { source, before: Region::default(), after: Region::default() }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.before.bytes() + self.after.bytes()
    }

    /// Tries the changes at one irregular node, best valence gain first, and keeps the first that is good: by the
    /// energy, or, for the traditional operations, by the valences alone.
    pub fn change(
        &mut self,
        mesh: &mut Mesh,
        valences: &Valences,
        node: NodeId,
        by: CleanUpBy,
        done: &mut CleanedUp,
    ) -> Option<Kept> {
        let traditional = by == CleanUpBy::Traditional;
        let (worse, most) = match by {
            CleanUpBy::Traditional => (-1, usize::MAX),
            CleanUpBy::Search => (if mesh.worst_quality_at(node) < POOR { MOST_WORSE } else { 0 }, MOST_TRIALS),
        };
        let hopeless = if traditional { f64::INFINITY } else { HOPELESS };
        for (_, candidate) in valences.candidates(mesh, node, worse, most) {
            if traditional && !valences.is_traditional(mesh, candidate) {
                continue;
            }
            done.trials += 1;
            let mark = mesh.mark();
            let good = |trial: &Trial| if traditional { trial.is_sound() } else { trial.is_good() };
            if let Some(trial) = self.attempt(mesh, valences, candidate, hopeless).filter(good) {
                match candidate {
                    Candidate::Doublet(_) => done.doublets += 1,
                    Candidate::Collapse(_) => done.collapses += 1,
                    Candidate::Rotate(..) => done.rotations += 1,
                    Candidate::Open(..) => done.openings += 1,
                }
                return Some(trial.kept);
            }
            done.refused += 1;
            mesh.take_back(mark);
        }
        None
    }

    /// Does a candidate and relaxes the nodes around. None where it cannot be done, or the energy has risen beyond
    /// `most` when its own nodes are settled; whatever it did then is to be taken back.
    fn attempt(&mut self, mesh: &mut Mesh, valences: &Valences, candidate: Candidate, most: f64) -> Option<Trial> {
        let mut core = candidate.core(mesh);
        self.before.gather(mesh, &core);
        let before = self.before.judge(mesh, valences);
        let what: Cleaning = candidate.apply(mesh, &*self.source, &mut core).ok()?;
        if !untangle(mesh, &*self.source, &core) {
            return None;
        }
        self.after.gather(mesh, &core);
        self.after.add_those_left_of(mesh, &self.before);
        for (rounds, allowed) in [(1, most + LATER_ROUNDS_GIVE), (RELAX_ROUNDS - 1, most)] {
            relax(mesh, &*self.source, &core, rounds);
            if self.after.judge(mesh, valences).energy - before.energy > allowed {
                return None;
            }
        }
        for &node in &self.after.nodes {
            energy::relax(mesh, node, &*self.source);
        }
        let after = self.after.judge(mesh, valences);
        let energy = [before.energy, after.energy];
        let kept = Kept { touched: SmallVec::from_slice(&core), event: Event::Cleaned { what, energy } };
        Some(Trial { energy, quality: [before.quality, after.quality], kept })
    }
}
