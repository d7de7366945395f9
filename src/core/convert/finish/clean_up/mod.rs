//! Clean-up of the structure around irregular nodes (docs/algorithm.md, "Clean-up"): diamond collapse, edge rotation,
//! vertex opening and the removal of doublets, each a transaction, kept when the energy of all that it moves falls. Or
//! the traditional operations alone, judged by the valences.
//!
//! A worklist, not sweeps: the nodes whose valence is not ideal, and again the neighbours of whatever changed. Single
//! changes come first, everywhere. Most irregular nodes that are then left are ends of columns that no single change
//! moves downhill; pairs of changes do, and are tried at the worst nodes first, as far as a budget of trials reaches.

mod candidate;
mod region;

use std::sync::Arc;

use smallvec::SmallVec;

use super::worklist::Worklist;
use crate::core::convert::event::{Cleaning, Event};
use crate::core::convert::relax::{Nodes, RELAX_ROUNDS, energy, relax, untangle, worst_quality};
use crate::core::convert::sums::summed;
use crate::core::mesh::{Mesh, NodeId};
use crate::core::metric::MetricSource;
use candidate::{Candidate, Ranked, Valences};
use region::Region;

/// A kept change must leave every element around at least this quality, or not worse than the worst before.
const LEAST_QUALITY: f64 = 0.2;
/// The energy must fall by this much: differences below it are noise of the relaxation.
const LEAST_GAIN: f64 = 1e-2;
/// Single changes tried at one node, best valence gain first.
const MOST_TRIALS: usize = 16;
/// An element below this quality is poor: around it the structure may become worse where the mesh becomes better.
const POOR: f64 = 0.4;
/// All changes of a sequence but the last may raise the sum of squared excesses by this much.
const MOST_WORSE: i32 = 2;
/// A trial whose energy has risen by this much when its own nodes are relaxed is given up before its surroundings are:
/// those seldom give back more (for one trial in a hundred).
const HOPELESS: f64 = 1.5;
/// It is also given up if it has risen by this much after one round: the other rounds give back less.
const LATER_ROUNDS_GIVE: f64 = 0.5;
/// Up to this many elements, a face is searched thoroughly for sequences of changes. What a thorough search finds
/// beyond the lean one is a tenth of the irregular nodes, for three times the trials: it matters where there are few.
const SMALL: usize = 3000;
/// Trials of pairs for every mesh, which search small meshes to the end.
const PAIR_TRIALS: usize = 30_000;
/// One trial more for this many elements, so that the time of large meshes is linear.
const ELEMENTS_A_PAIR_TRIAL: usize = 20;
/// Trials of longer sequences, for every mesh whose pairs were searched to the end.
const LONGER_TRIALS: usize = 40_000;

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
    /// Sequences of two changes that were kept only together.
    pub pairs: usize,
    /// Sequences of three and of four.
    pub longer: usize,
    /// Changes tried, repetitions included.
    pub trials: usize,
    /// Trials taken back.
    pub refused: usize,
}
}

/// How far a clean-up looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reach {
    /// The traditional operations, at every irregular node.
    Traditional,
    /// Single changes, at every irregular node.
    Singles,
    /// Pairs of changes too, at the worst nodes first.
    Pairs,
    /// And sequences of up to four.
    Longer,
}

impl Reach {
    /// Its place among the clean-ups of a mesh: one of the first two is done, by the parameters.
    pub fn place(self) -> usize {
        match self {
            Reach::Traditional | Reach::Singles => 0,
            Reach::Pairs => 1,
            Reach::Longer => 2,
        }
    }

    /// Changes of the longest sequence that is tried.
    fn longest(self) -> usize {
        match self {
            Reach::Traditional | Reach::Singles => 1,
            Reach::Pairs => 2,
            Reach::Longer => 4,
        }
    }

    /// How wide a face of this many elements is searched.
    fn breadth(self, elements: usize) -> Breadth {
        let (firsts, most_rise, later) = match (self, elements <= SMALL) {
            (Reach::Longer, true) => (24, 6.0, [4, 3, 3]),
            (_, true) => (16, 5.0, [4, 3, 3]),
            (Reach::Longer, false) => (12, 3.0, [2, 2, 2]),
            (_, false) => (8, 3.0, [2, 2, 2]),
        };
        Breadth { firsts, most_rise, later }
    }
}

/// How many ways a search for sequences of changes goes.
#[derive(Clone, Copy, Debug)]
struct Breadth {
    /// First changes tried at a node, best valence gain first.
    firsts: usize,
    /// How much energy all changes but the last may cost.
    most_rise: f64,
    /// Changes tried second, third and fourth, after each way to get there.
    later: [usize; 3],
}

/// Changes made one after the other.
type Steps = SmallVec<[(Candidate, Cleaning); 4]>;

/// What a trial that stands in the mesh has come to.
struct Trial {
    /// The energy before and after.
    energy: [f64; 2],
    /// The worst quality before and after.
    quality: [f64; 2],
    /// The nodes around which the mesh has changed.
    touched: Nodes,
    steps: Steps,
}

/// A trial that was kept.
struct Kept {
    touched: Nodes,
    event: Event,
}

impl Trial {
    /// The trial that this one and another after it are together.
    fn and(&self, next: Trial, mesh: &Mesh) -> Trial {
        let mut touched = self.touched.clone();
        touched.extend(next.touched.iter().copied().filter(|n| !self.touched.contains(n)));
        touched.retain(|n| mesh.has_node(*n));
        // What the next one found was this one's doing, and part of that may lie outside of its reach.
        let after = next.quality[1].min(worst_quality(mesh, &touched));
        let energy = [self.energy[0], self.energy[1] + next.rise()];
        let steps = self.steps.iter().chain(&next.steps).copied().collect();
        Trial { energy, quality: [self.quality[0], after], touched, steps }
    }

    fn rise(&self) -> f64 {
        self.energy[1] - self.energy[0]
    }

    fn is_good(&self) -> bool {
        self.rise() < -LEAST_GAIN && self.quality[1] >= self.quality[0].min(LEAST_QUALITY)
    }
}

/// A clean-up of an all-quadrilateral mesh under way: until no change that it reaches lowers the energy, within a
/// budget linear in the size of the mesh.
#[derive(Clone)]
pub(super) struct CleanUp<'a> {
    source: Arc<dyn MetricSource + Send + Sync + 'a>,
    reach: Reach,
    breadth: Breadth,
    valences: Valences,
    /// Irregular nodes.
    pub list: Worklist,
    /// Trials after which it ends.
    most_trials: usize,
    /// Kept for their memory.
    before: Region,
    after: Region,
    /// What was done so far.
    pub done: CleanedUp,
}

impl<'a> CleanUp<'a> {
    /// A clean-up of a face, which is that share of the whole, or of all, at its beginning. Its list writes down what
    /// it needs to be taken back where `recording`. Counts continue from `done`.
    pub fn begin(
        mesh: &Mesh,
        (face, share): (Option<u32>, f64),
        source: Arc<dyn MetricSource + Send + Sync + 'a>,
        reach: Reach,
        done: CleanedUp,
        recording: bool,
    ) -> CleanUp<'a> {
        // Twice its share: small faces are seldom searched to the end, and have most of the irregular nodes.
        let of_all = |trials: usize| (trials as f64 * (2.0 * share).min(1.0)).ceil() as usize;
        let elements = mesh.elements_of(face).count();
        let most_trials = match reach {
            Reach::Traditional | Reach::Singles => usize::MAX,
            Reach::Pairs => done.trials + of_all(PAIR_TRIALS) + elements / ELEMENTS_A_PAIR_TRIAL,
            Reach::Longer => done.trials + of_all(LONGER_TRIALS),
        };
        let mut work = CleanUp {
            source,
            reach,
            breadth: reach.breadth(elements),
            valences: Valences::of(mesh),
            // Energy falls with every kept change, so this ends by itself; the budget bounds the time on hostile input.
            list: Worklist::new(20 * mesh.nodes_of(face).count() + 1000, recording),
            most_trials,
            before: Region::default(),
            after: Region::default(),
            done,
        };
        match reach {
            Reach::Traditional | Reach::Singles => mesh.nodes_of(face).for_each(|node| work.enqueue(mesh, node)),
            Reach::Pairs | Reach::Longer => work.enqueue_worst_first(mesh, face),
        }
        work
    }

    /// One kept change, or pair of changes, of the structure: looks at the nodes that wait until there is one. None
    /// where no node waits any more, or the budget is spent.
    pub fn step(&mut self, mesh: &mut Mesh, keep_journal: bool) -> Option<Event> {
        while self.done.trials < self.most_trials {
            let node = self.list.take()?;
            if !mesh.has_node(node) {
                continue;
            }
            let kept = match self.reach {
                Reach::Traditional => self.traditional(mesh, node),
                Reach::Singles => self.single(mesh, node),
                Reach::Pairs | Reach::Longer => self.sequence(mesh, node),
            };
            if !keep_journal {
                mesh.commit();
            }
            if let Some(Kept { touched, event }) = kept {
                for node in touched {
                    for n in mesh.neighbours(node).collect::<Nodes>() {
                        self.enqueue(mesh, n);
                    }
                    self.enqueue(mesh, node);
                }
                return Some(event);
            }
        }
        None
    }

    /// Bytes that it takes beside its list.
    pub fn bytes_of_rest(&self) -> usize {
        self.valences.bytes() + self.before.bytes() + self.after.bytes()
    }

    fn enqueue(&mut self, mesh: &Mesh, node: NodeId) {
        if !self.list.holds(node) && self.valences.excess(mesh, node) != 0 {
            self.list.add(node);
        }
    }

    /// All irregular nodes of a face, or of all, those with the greatest energy around them first.
    fn enqueue_worst_first(&mut self, mesh: &Mesh, face: Option<u32>) {
        let mut nodes: Vec<(f64, NodeId)> = mesh
            .nodes_of(face)
            .filter(|&n| self.valences.excess(mesh, n) != 0)
            .map(|n| (mesh.elements_at(n).map(|e| energy::judge(mesh, e).0).sum::<f64>(), n))
            .collect();
        nodes.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        nodes.into_iter().for_each(|(_, node)| self.list.add(node));
    }

    // ---- changes ----

    /// Tries the candidates around one irregular node, best valence gain first, and keeps the first that is good.
    fn single(&mut self, mesh: &mut Mesh, node: NodeId) -> Option<Kept> {
        let worst = mesh.worst_quality_at(node);
        for (_, candidate) in
            self.valences.candidates(mesh, node, if worst < POOR { MOST_WORSE } else { 0 }, MOST_TRIALS)
        {
            let mark = mesh.mark();
            if let Some(trial) = self.attempt(mesh, candidate, HOPELESS).filter(Trial::is_good) {
                return Some(self.keep(trial));
            }
            self.done.refused += 1;
            mesh.take_back(mark);
        }
        None
    }

    /// Tries the traditional operations at one irregular node, best valence gain first, and keeps the first that leaves
    /// no element around too poor.
    fn traditional(&mut self, mesh: &mut Mesh, node: NodeId) -> Option<Kept> {
        for (_, candidate) in self.valences.candidates(mesh, node, -1, usize::MAX) {
            if !self.valences.is_traditional(mesh, candidate) {
                continue;
            }
            let mark = mesh.mark();
            let trial = self.attempt(mesh, candidate, f64::INFINITY);
            if let Some(trial) = trial.filter(|trial| trial.quality[1] >= trial.quality[0].min(LEAST_QUALITY)) {
                return Some(self.keep(trial));
            }
            self.done.refused += 1;
            mesh.take_back(mark);
        }
        None
    }

    /// Tries sequences of changes around one irregular node: first changes that cost little energy, cheapest first,
    /// each with those that make up for what it did to the valences.
    fn sequence(&mut self, mesh: &mut Mesh, node: NodeId) -> Option<Kept> {
        let mut first: SmallVec<[(f64, Ranked); 24]> = SmallVec::new();
        for ranked in self.valences.candidates(mesh, node, MOST_WORSE, self.breadth.firsts) {
            let mark = mesh.mark();
            if let Some(trial) = self.attempt(mesh, ranked.1, self.breadth.most_rise) {
                if trial.is_good() {
                    return Some(self.keep(trial));
                }
                first.push((trial.rise(), ranked));
            }
            mesh.take_back(mark);
        }
        first.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, (gain, candidate)) in first {
            let mark = mesh.mark();
            if let Some(trial) = self.attempt(mesh, candidate, self.breadth.most_rise)
                && let Some(all) = self.go_on(mesh, gain, &trial)
            {
                return Some(self.keep(all));
            }
            self.done.refused += 1;
            mesh.take_back(mark);
        }
        None
    }

    /// Goes on with a sequence whose changes so far have this valence gain, until all of it is good.
    fn go_on(&mut self, mesh: &mut Mesh, gain: i32, so_far: &Trial) -> Option<Trial> {
        let is_last = so_far.steps.len() + 1 == self.reach.longest();
        let (worse, most) = if is_last { (0, HOPELESS) } else { (MOST_WORSE, self.breadth.most_rise) };
        let trials = self.breadth.later[so_far.steps.len() - 1];
        let mut found: SmallVec<[Ranked; 32]> = SmallVec::new();
        for &node in so_far.touched.iter().filter(|&&n| self.valences.excess(mesh, n) != 0) {
            found.extend(self.valences.candidates(mesh, node, worse - gain, trials));
        }
        found.sort_unstable();
        found.dedup();
        found.truncate(trials);
        for (its_gain, candidate) in found {
            let mark = mesh.mark();
            if let Some(next) = self.attempt(mesh, candidate, most - so_far.rise()) {
                let all = so_far.and(next, mesh);
                if all.is_good() {
                    return Some(all);
                }
                if !is_last && let Some(all) = self.go_on(mesh, gain + its_gain, &all) {
                    return Some(all);
                }
            }
            self.done.refused += 1;
            mesh.take_back(mark);
        }
        None
    }

    /// Does a candidate and relaxes the nodes around. None where it cannot be done, or the energy has risen beyond
    /// `most` when its own nodes are settled; whatever it did then is to be taken back.
    fn attempt(&mut self, mesh: &mut Mesh, candidate: Candidate, most: f64) -> Option<Trial> {
        self.done.trials += 1;
        let mut core = candidate.core(mesh);
        self.before.gather(mesh, &core);
        let before = self.before.judge(mesh, &self.valences);
        let what = candidate.apply(mesh, &*self.source, &mut core).ok()?;
        if !untangle(mesh, &*self.source, &core) {
            return None;
        }
        self.after.gather(mesh, &core);
        self.after.add_those_left_of(mesh, &self.before);
        for (rounds, allowed) in [(1, most + LATER_ROUNDS_GIVE), (RELAX_ROUNDS - 1, most)] {
            relax(mesh, &*self.source, &core, rounds);
            if self.after.judge(mesh, &self.valences).energy - before.energy > allowed {
                return None;
            }
        }
        for &node in &self.after.nodes {
            energy::relax(mesh, node, &*self.source);
        }
        let after = self.after.judge(mesh, &self.valences);
        let energy = [before.energy, after.energy];
        let steps = SmallVec::from_slice(&[(candidate, what)]);
        Some(Trial { energy, quality: [before.quality, after.quality], touched: core, steps })
    }

    fn keep(&mut self, trial: Trial) -> Kept {
        for (candidate, _) in &trial.steps {
            match candidate {
                Candidate::Doublet(_) => self.done.doublets += 1,
                Candidate::Collapse(_) => self.done.collapses += 1,
                Candidate::Rotate(..) => self.done.rotations += 1,
                Candidate::Open(..) => self.done.openings += 1,
            }
        }
        self.done.pairs += usize::from(trial.steps.len() == 2);
        self.done.longer += usize::from(trial.steps.len() > 2);
        let then = [1, 2, 3].map(|k| trial.steps.get(k).map(|step| step.1));
        let event = Event::Cleaned { what: trial.steps[0].1, then, energy: trial.energy };
        Kept { touched: trial.touched, event }
    }
}
