//! Step 4 of the last resort: a pair whose union is not firmly convex, cut anew together with pairs around it.

use glam::DVec2;
use smallvec::SmallVec;

use super::component::NONE;
use super::planner::{Planner, firm_quad};
use super::{Means, Stuck};
use crate::core::mesh::{ElementId, NodeId};
use crate::core::metric::measure::quad_quality;

/// A crooked pair is cut anew with up to this many pairs in all, itself included.
const MOST_PAIRS: usize = 4;
/// Larger rings are not tried once the worst quadrilateral of a smaller one is this good.
const GOOD: f64 = 0.2;

/// A way to fill a ring.
#[derive(Clone, Debug)]
struct Cut {
    /// Quality of the worst quadrilateral.
    worst: f64,
    /// The quadrilaterals; `NONE` stands for the new node.
    quads: SmallVec<[[u32; 4]; MOST_PAIRS + 1]>,
    centre: Option<DVec2>,
    /// The pairs that it replaces.
    pairs: Pairs,
}

/// Pairs of triangles, each by the lesser side of the edge between the two; ascending.
type Pairs = SmallVec<[u32; MOST_PAIRS]>;

/// The outline of some connected pairs of triangles.
#[derive(Clone, Debug)]
struct Ring {
    /// Its nodes, anticlockwise, each with the side from it to the next.
    corners: SmallVec<[(u32, u32); 2 * MOST_PAIRS + 2]>,
    pairs: Pairs,
}

impl Planner<'_> {
    /// Divides a crooked pair again together with pairs around it: first with one, then with two, and so on, at last
    /// with a new node in their middle. If all of that fails, the pair is left to the templates.
    pub fn recut(&mut self, side: u32, allowed: &dyn Fn(Means, [ElementId; 2]) -> bool) -> Result<(), Stuck> {
        let pair = self.pair(side);
        let start = Ring {
            corners: (pair.nodes.into_iter().zip(pair.outline)).collect(),
            pairs: SmallVec::from_slice(&[side]),
        };
        let mut rings = vec![start];
        let mut outer = 0..1;
        let mut best: Option<Cut> = None;
        let worst = |best: &Option<Cut>| best.as_ref().map_or(0.0, |cut| cut.worst);
        while worst(&best) < GOOD && rings[outer.start..].first().is_some_and(|ring| ring.pairs.len() < MOST_PAIRS) {
            for place in outer.clone() {
                self.grow(place, &mut rings, allowed);
            }
            outer = outer.end..rings.len();
            for ring in &rings[outer.clone()] {
                best = self.cut(ring, worst(&best)).or(best);
            }
        }
        if worst(&best) < GOOD {
            for ring in &rings {
                best = self.star(ring, worst(&best)).or(best);
            }
        }
        let Some(cut) = best else { return Ok(()) };
        let centre = cut.centre.map_or(Ok(NONE), |uv| self.add_node(uv))?;
        self.plan.outcome.recut += cut.quads.len();
        self.plan.quads.extend(cut.quads.iter().map(|quad| quad.map(|n| if n == NONE { centre } else { n })));
        let triangles: SmallVec<[u32; 2 * MOST_PAIRS]> =
            cut.pairs.iter().flat_map(|&side| [side / 3, self.dual.across[side as usize] / 3]).collect();
        self.close_patch(Means::Recut, &triangles);
        Ok(())
    }

    /// Appends a ring with one more pair for every pair beside the given one, where it is not there already.
    fn grow(&self, place: usize, rings: &mut Vec<Ring>, allowed: &dyn Fn(Means, [ElementId; 2]) -> bool) {
        let ring = rings[place].clone();
        for k in 0..ring.corners.len() {
            let outline = ring.corners[k].1;
            let across = self.dual.across[outline as usize];
            if across == NONE || self.done[(across / 3) as usize] {
                continue;
            }
            let Some(inner) = self.partner_side(across / 3) else { continue };
            let inner = inner.min(self.dual.across[inner as usize]);
            if ring.pairs.contains(&inner) || !allowed(Means::Recut, self.elements([outline / 3, across / 3])) {
                continue;
            }
            // The side k to k + 1 of the ring gives way to the other three of the pair.
            let beside = self.pair(inner);
            let at = (beside.outline.iter().position(|&s| s == across)).expect("the pair beside has the shared side");
            let mut more = ring.clone();
            more.pairs.push(inner);
            more.pairs.sort_unstable();
            if rings
                .iter()
                .rev()
                .take_while(|known| known.pairs.len() == more.pairs.len())
                .any(|known| known.pairs == more.pairs)
            {
                continue;
            }
            more.corners[k].1 = beside.outline[(at + 1) % 4];
            more.corners.insert_many(k + 1, [2, 3].map(|i| (beside.nodes[(at + i) % 4], beside.outline[(at + i) % 4])));
            rings.push(more);
        }
    }

    /// The best way to cut a ring into firm quadrilaterals without new nodes, where the worst of them is better than
    /// `least`: by dynamic programming over its stretches.
    ///
    /// Quadrilaterals that are positive, and whose sides cancel out but for the ring, cover each place as often as the
    /// ring winds around it: once inside and never outside. So this is right also where the ring meets itself.
    fn cut(&self, ring: &Ring, least: f64) -> Option<Cut> {
        let n = ring.corners.len();
        // Of the stretch from i to j, closed by the chord between them: the worst quadrilateral of the best cut, and
        // the other two corners of the one at the chord.
        let mut best = [[(least, 0, 0); 2 * MOST_PAIRS + 2]; 2 * MOST_PAIRS + 2];
        for i in 0..n - 1 {
            best[i][i + 1].0 = f64::INFINITY;
        }
        for length in (3..n).step_by(2) {
            for i in 0..n - length {
                let j = i + length;
                for a in (i + 1..j).step_by(2) {
                    for b in (a + 1..j).step_by(2) {
                        let parts = best[i][a].0.min(best[a][b].0).min(best[b][j].0);
                        if parts > best[i][j].0 {
                            let quad = [i, a, b, j].map(|k| ring.corners[k].0);
                            let worst = if self.is_firm(quad) { parts.min(self.quality(quad)) } else { least };
                            if worst > best[i][j].0 {
                                best[i][j] = (worst, a, b);
                            }
                        }
                    }
                }
            }
        }
        let (worst, ..) = best[0][n - 1];
        if worst <= least {
            return None;
        }
        let mut quads = SmallVec::new();
        let mut open: SmallVec<[(usize, usize); 8]> = SmallVec::from_slice(&[(0, n - 1)]);
        while let Some((i, j)) = open.pop() {
            if j > i + 1 {
                let (_, a, b) = best[i][j];
                quads.push([i, a, b, j].map(|k| ring.corners[k].0));
                open.extend([(i, a), (a, b), (b, j)]);
            }
        }
        Some(Cut { worst, quads, centre: None, pairs: ring.pairs.clone() })
    }

    /// The best way to fill a ring around one new node that every other node of the ring is joined to, where the worst
    /// quadrilateral is better than `least`. Right for the same reason as [`cut`](Planner::cut).
    ///
    /// ```text
    ///      o-------o
    ///     / \       \
    ///    o   *-------o
    ///     \ /       /
    ///      o-------o
    /// ```
    fn star(&self, ring: &Ring, least: f64) -> Option<Cut> {
        let n = ring.corners.len();
        let node = |k: usize| ring.corners[k % n].0;
        let mean = |first: usize, step: usize| {
            (first..n).step_by(step).fold(DVec2::ZERO, |sum, k| sum + self.uv(node(k))) / (n / step) as f64
        };
        let all = mean(0, 1);
        let mut best: Option<Cut> = None;
        for first in 0..2 {
            let joined = mean(first, 2);
            for centre in [all, joined, 0.5 * (all + joined)] {
                let Ok(metric) = self.source.metric(centre) else { continue };
                let quads = (first..n).step_by(2).map(|k| [NONE, node(k), node(k + 1), node(k + 2)]);
                let quality = |[_, a, b, c]: [u32; 4]| {
                    let [p_a, p_b, p_c] = [a, b, c].map(|n| self.uv(n));
                    let [m_a, m_b, m_c] = [a, b, c].map(|n| self.mesh().metric_ref(NodeId(n)));
                    let places = [centre, p_a, p_b, p_c];
                    if firm_quad(places) { quad_quality([&metric, m_a, m_b, m_c], places) } else { 0.0 }
                };
                let worst = quads.clone().map(quality).fold(f64::INFINITY, f64::min);
                if worst > best.as_ref().map_or(least, |cut| cut.worst) {
                    best = Some(Cut { worst, quads: quads.collect(), centre: Some(centre), pairs: ring.pairs.clone() });
                }
            }
        }
        best
    }
}
