//! Clean-up over a distance (docs/algorithm.md, "Cavities"): a cavity grows around an irregular node, by topology
//! alone, until it is a polygon that can be filled with fewer irregular nodes. Only then geometry is looked at: the
//! fillings are smoothed on their own, and the best one is put into the mesh, relaxed with its surroundings, and
//! judged.

mod disc;
mod filled;
mod filling;
mod smooth;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use rustc_hash::FxHashSet;

use self::disc::{Disc, Growth};
use self::filling::{Filling, fillings, fillings_with_a_pair, least_irregular};
use self::smooth::Draft;
use super::candidate::Valences;
use super::region::VALENCE_WEIGHT;
use super::seen::Seen;
use super::{CleanedUp, Kept, Touched};
use crate::core::convert::event::Event;
use crate::core::convert::finish::STIRRED;
use crate::core::convert::relax::energy::{self, Judged};
use crate::core::mesh::{Mesh, NodeId};
use crate::core::metric::MetricSource;

/// A kept cavity may have this much more energy for each irregular node that it removes, beside the energy of the
/// valence.
const MOST_RISE: f64 = 2.0;
/// A kept cavity that removes none must lower the energy by this much.
const LEAST_GAIN: f64 = 0.5;
/// The least sine of a corner that a kept cavity may leave, where there was no smaller one before.
const LEAST_SINE: f64 = 0.66;
/// The lengths of edges that a kept cavity may leave, where there were no shorter or longer ones before.
const LENGTHS: [f64; 2] = [0.45, 1.8];
/// Fillings of each kind that are drawn: those with a number of quadrilaterals that fits the metric.
const MOST_DRAFTS: usize = 5;
/// The same for a whole face.
const MOST_WHOLE_DRAFTS: usize = 4;
/// Rounds of relaxation of a cavity and its surroundings.
const ROUNDS: usize = 8;
/// After so many rounds a filling is given up if its energy is too high by `LATER_ROUNDS_GIVE`.
const EARLY_ROUNDS: usize = 2;
/// The other rounds give back less.
const LATER_ROUNDS_GIVE: f64 = 1.0;
/// A drawing is put into the mesh only if its energy is too high by no more than this, where it removes no irregular
/// nodes and where it removes some: the relaxation together with the surroundings gives back less (for one kept in a
/// hundred).
const RELAXATION_GIVES: [f64; 2] = [8.0, 25.0];
/// A filling is drawn only if its number of quadrilaterals is that for which the cavity has metric area, within this
/// many times the root of it, or fits it no worse than what it replaces: sizes are kept.
const WITHIN: f64 = 3.0;
/// A cavity with more misfits is not filled: one in two hundred would be kept.
const MOST_MISFITS: usize = 1;
/// A cavity of more elements is filled only where a filling can remove irregular nodes.
const LARGE: usize = 100;
/// Rings of nodes around a cavity that move with it.
const RINGS: usize = 1;
/// A whole face is drawn as one cavity only where its filling has as many quadrilaterals as its metric area asks for,
/// within this share.
const WHOLE_WITHIN: f64 = 0.15;
/// A drawing of a whole face is relaxed only if its energy is no more than this many times what it may be.
const WHOLE_RELAXATION_GIVES: f64 = 1.1;

/// What grows cavities and fills them anew. Everything but the refusals is kept for its memory only.
#[derive(Clone)]
pub(super) struct Cavities<'a> {
    source: Arc<dyn MetricSource + Send + Sync + 'a>,
    disc: Disc,
    draft: Draft,
    /// The best drawing of the present cavity.
    best: Draft,
    ring: Vec<NodeId>,
    seen: Seen,
    movable: Seen,
    refused: Refused,
}

/// Cavities of which no filling was good: fingerprints of their elements, in the order in which they were refused.
#[derive(Clone, Default)]
struct Refused {
    order: Vec<u64>,
    all: FxHashSet<u64>,
}

/// The result of a change that is judged.
struct Change {
    energy: [f64; 2],
    quads: [u32; 2],
}

impl<'a> Cavities<'a> {
    pub fn new(source: Arc<dyn MetricSource + Send + Sync + 'a>) -> Cavities<'a> {
        Cavities {
            source,
            disc: Disc::default(),
            draft: Draft::default(),
            best: Draft::default(),
            ring: Vec::new(),
            seen: Seen::default(),
            movable: Seen::default(),
            refused: Refused::default(),
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.disc.bytes()
            + self.draft.bytes()
            + self.best.bytes()
            + size_of::<NodeId>() * self.ring.capacity()
            + self.seen.bytes()
            + self.movable.bytes()
            + 2 * size_of::<u64>() * (self.refused.order.capacity() + self.refused.all.capacity())
    }

    /// Number of cavities refused so far.
    pub fn refusals(&self) -> usize {
        self.refused.order.len()
    }

    /// Forgets all refused cavities but the first ones.
    pub fn forget_refusals(&mut self, first: usize) {
        for key in self.refused.order.drain(first.min(self.refused.order.len())..) {
            self.refused.all.remove(&key);
        }
    }

    /// Fills a whole face anew where it is a polygon with a better filling than it has. The filling is judged on its
    /// own, for nothing lies around: as it is drawn, else relaxed.
    pub fn whole(
        &mut self,
        mesh: &mut Mesh,
        valences: &Valences,
        face: Option<u32>,
        keep_journal: bool,
        done: &mut CleanedUp,
    ) -> Option<Kept> {
        self.disc.begin_whole(mesh, valences, face);
        let growth = self.disc.become_polygon(mesh, valences, usize::MAX);
        if growth != Growth::Polygon || !self.disc.gather_inner(mesh) {
            return None;
        }
        let polygon = &self.disc.polygon;
        let (sides, now) = (polygon.sides.clone(), polygon.irregular);
        let area = self.disc.metric_area(mesh);
        let mut best: Option<(Judged, Filling)> = None;
        for filling in nearest(fillings(&sides), &sides, area, MOST_WHOLE_DRAFTS) {
            let better = filling.irregular() + polygon.misfits < now;
            if !better || (filling.quads(&sides) as f64 / area - 1.0).abs() > WHOLE_WITHIN {
                continue;
            }
            done.trials += 1;
            let drawn = self.draft.draw(mesh, &*self.source, &self.disc.polygon, &filling);
            let Some(judged) = drawn else { continue };
            if best.as_ref().is_none_or(|(least, _)| judged.energy < least.energy) {
                best = Some((judged, filling));
                std::mem::swap(&mut self.draft, &mut self.best);
            }
        }
        let (after, filling) = best?;
        let before = self.disc.judge(mesh);
        let left = filling.irregular() + self.disc.polygon.misfits;
        let rise = (now - left) as f64 * VALENCE_WEIGHT;
        // Where nodes of three shorten the edges around, the smoothing that follows makes them longer.
        let is_good = |after: Judged| {
            let after = Judged { lengths: [f64::INFINITY, after.lengths[1]], ..after };
            after.energy <= before.energy + rise && is_sound(before, after)
        };
        let is_decided = is_good(after);
        if !is_decided && after.energy > WHOLE_RELAXATION_GIVES * (before.energy + rise) {
            done.refused += 1;
            return None;
        }
        // The journal is large for a large face, and is not needed to take back what is decided.
        let (quads, recording) = (self.disc.elements.len(), mesh.journal().is_recording());
        mesh.set_recording(recording && (keep_journal || !is_decided));
        let mark = mesh.mark();
        let placed = self.best.place(mesh, &self.disc);
        mesh.set_recording(recording);
        let (nodes, made) = placed?;
        let mut energy = [before.energy, after.energy];
        if !is_decided {
            self.movable.clear(mesh.node_slots());
            nodes.iter().for_each(|n| _ = self.movable.add(n.index()));
            self.relax(mesh, nodes.clone(), ROUNDS);
            let mut after = Judged::NOTHING;
            made.iter().for_each(|&e| after += energy::judge(mesh, e));
            if !is_good(after) {
                done.refused += 1;
                mesh.take_back(mark);
                return None;
            }
            energy[1] = after.energy;
        }
        done.refills += 1;
        let change = Change { energy, quads: [quads as u32, made.len() as u32] };
        let touched = nodes.into_iter().filter(|&n| valences.excess(mesh, n) != 0).collect();
        Some(self.kept(&sides, [now, left], change, touched))
    }

    /// Grows a cavity of at most `limit` elements around an irregular node until one of its shapes has a better
    /// filling, and fills it.
    pub fn grow(
        &mut self,
        mesh: &mut Mesh,
        valences: &Valences,
        node: NodeId,
        limit: usize,
        done: &mut CleanedUp,
    ) -> Option<Kept> {
        self.disc.begin(mesh, valences, node);
        loop {
            match self.disc.become_polygon(mesh, valences, limit) {
                Growth::Polygon => {
                    if let Some(kept) = self.fill(mesh, valences, done) {
                        return Some(kept);
                    }
                }
                Growth::NoPolygon => {}
                Growth::Stuck => return None,
            }
            if !self.disc.grow(mesh, valences, 4 * limit) {
                return None;
            }
        }
    }

    /// Fills the cavity that has grown, where that makes it better.
    fn fill(&mut self, mesh: &mut Mesh, valences: &Valences, done: &mut CleanedUp) -> Option<Kept> {
        let (sides, misfits) = (self.disc.polygon.sides.clone(), self.disc.polygon.misfits);
        let now = self.disc.polygon.irregular;
        let least = least_irregular(&sides);
        // A grid and a star are the only fillings with their numbers of irregular nodes.
        let is_known = least == now && least < 2 && self.disc.polygon.on_border == 0;
        if misfits > MOST_MISFITS
            || least + misfits > now
            || is_known
            || (least + misfits == now && self.disc.elements.len() > LARGE)
        {
            return None;
        }
        let key = self.disc.fingerprint(mesh);
        if self.refused.all.contains(&key) || !self.disc.gather_inner(mesh) {
            return None;
        }
        let area = self.disc.metric_area(mesh);
        let mut found = nearest(fillings(&sides), &sides, area, MOST_DRAFTS);
        if least + 2 + misfits <= now {
            found.extend(nearest(fillings_with_a_pair(&sides), &sides, area, MOST_DRAFTS));
        }
        let misfit = |quads: u64| (quads as f64 - area).abs();
        let most = misfit(self.disc.elements.len() as u64).max(WITHIN * area.sqrt());
        found.retain(|filling| misfit(filling.quads(&sides)) <= most);
        let mut best: Option<(f64, &Filling)> = None;
        for filling in &found {
            let Some(drawn) = self.draft.draw(mesh, &*self.source, &self.disc.polygon, filling) else { continue };
            let energy = drawn.energy + VALENCE_WEIGHT * filling.irregular() as f64;
            if best.is_none_or(|(least, _)| energy < least) {
                best = Some((energy, filling));
                std::mem::swap(&mut self.draft, &mut self.best);
            }
        }
        let before = self.disc.judge(mesh).energy;
        let is_hopeful = |&(energy, filling): &(f64, &Filling)| {
            let removed = now - misfits - filling.irregular();
            let drawn = energy - VALENCE_WEIGHT * filling.irregular() as f64;
            drawn < before + most_rise(removed) + RELAXATION_GIVES[usize::from(removed > 0)]
        };
        if let Some((_, filling)) = best.filter(is_hopeful) {
            let left = filling.irregular() + misfits;
            done.trials += 1;
            let mark = mesh.mark();
            if let Some((change, touched)) = self.attempt(mesh, valences, now - left) {
                done.refills += 1;
                return Some(self.kept(&sides, [now, left], change, touched));
            }
            done.refused += 1;
            mesh.take_back(mark);
        }
        self.refused.order.push(key);
        self.refused.all.insert(key);
        None
    }

    /// Puts the best drawing into the mesh and relaxes it with its surroundings. None where the result is not good
    /// enough for that many irregular nodes removed; it is to be taken back then.
    fn attempt(&mut self, mesh: &mut Mesh, valences: &Valences, removed: usize) -> Option<(Change, Touched)> {
        self.gather_rings(mesh);
        let inner = std::mem::take(&mut self.disc.inner);
        let before = self.judge(mesh, &inner);
        self.disc.inner = inner;
        let quads = self.disc.elements.len() as u32;
        let (inner, made) = self.best.place(mesh, &self.disc)?;
        // What may move: new nodes, the border and the rings; at first those that see something new.
        self.movable.clear(mesh.node_slots());
        inner.iter().chain(&self.ring).for_each(|n| _ = self.movable.add(n.index()));
        let waiting = inner.iter().chain(&self.disc.polygon.border).copied().collect();
        let waiting = self.relax(mesh, waiting, EARLY_ROUNDS);
        if !waiting.is_empty() {
            if self.judge(mesh, &inner).energy > before.energy + most_rise(removed) + LATER_ROUNDS_GIVE {
                return None;
            }
            self.relax(mesh, waiting, ROUNDS - EARLY_ROUNDS);
        }
        let after = self.judge(mesh, &inner);
        if !is_good(before, after, removed) {
            return None;
        }
        let touched = inner.iter().chain(&self.ring).copied().filter(|&n| valences.excess(mesh, n) != 0).collect();
        Some((Change { energy: [before.energy, after.energy], quads: [quads, made.len() as u32] }, touched))
    }

    /// Rounds of relaxation of the nodes that may move: these first, then those that see something new. Returns those
    /// that are left.
    fn relax(&mut self, mesh: &mut Mesh, mut waiting: Vec<NodeId>, rounds: usize) -> Vec<NodeId> {
        for _ in 0..rounds {
            if waiting.is_empty() {
                break;
            }
            let mut next = Vec::with_capacity(waiting.len());
            self.seen.clear(mesh.node_slots());
            for &node in &waiting {
                if energy::relax(mesh, node, &*self.source) > STIRRED {
                    let around = mesh.neighbours(node).chain([node]);
                    next.extend(around.filter(|n| self.movable.has(n.index()) && self.seen.add(n.index())));
                }
            }
            waiting = next;
        }
        waiting
    }

    /// The nodes of the border, and those of the rings around.
    fn gather_rings(&mut self, mesh: &Mesh) {
        self.ring.clear();
        self.seen.clear(mesh.node_slots());
        for &node in self.disc.inner.iter().chain(&self.disc.polygon.border) {
            self.seen.add(node.index());
        }
        self.ring.extend_from_slice(&self.disc.polygon.border);
        let mut from = 0;
        for _ in 0..RINGS {
            let to = self.ring.len();
            for k in from..to {
                for e in mesh.elements_at(self.ring[k]) {
                    for node in mesh.quad(e) {
                        if self.seen.add(node.index()) {
                            self.ring.push(node);
                        }
                    }
                }
            }
            from = to;
        }
    }

    /// Judges the elements around some nodes and around those of the rings.
    fn judge(&mut self, mesh: &Mesh, inner: &[NodeId]) -> Judged {
        self.seen.clear(mesh.element_slots());
        let mut judged = Judged::NOTHING;
        for &node in inner.iter().chain(&self.ring) {
            for e in mesh.elements_at(node) {
                if self.seen.add(e.index()) {
                    judged += energy::judge(mesh, e);
                }
            }
        }
        judged
    }

    fn kept(&self, sides: &[u32], irregular: [usize; 2], change: Change, touched: Touched) -> Kept {
        let irregular = irregular.map(|count| count as u32);
        let mut all = [0; filling::MOST_CORNERS];
        all[..sides.len()].copy_from_slice(sides);
        Kept { touched, event: Event::Refilled { sides: all, quads: change.quads, irregular, energy: change.energy } }
    }
}

/// The `most` fillings whose numbers of quadrilaterals are nearest to the metric area.
fn nearest(mut fillings: Vec<Filling>, sides: &[u32], area: f64, most: usize) -> Vec<Filling> {
    fillings.sort_by_cached_key(|filling| (filling.quads(sides) as f64 - area).abs() as u64);
    fillings.truncate(most);
    fillings
}

/// How much the energy may rise with a filling that removes so many irregular nodes.
fn most_rise(removed: usize) -> f64 {
    if removed == 0 { -LEAST_GAIN } else { removed as f64 * (VALENCE_WEIGHT + MOST_RISE) }
}

/// Whether a filling that removes so many irregular nodes is good enough.
fn is_good(before: Judged, after: Judged, removed: usize) -> bool {
    after.energy <= before.energy + most_rise(removed) && is_sound(before, after)
}

/// Whether no corner and no edge has become too poor.
fn is_sound(before: Judged, after: Judged) -> bool {
    after.sine >= LEAST_SINE.min(before.sine)
        && after.lengths[0] >= LENGTHS[0].min(before.lengths[0])
        && after.lengths[1] <= LENGTHS[1].max(before.lengths[1])
}
