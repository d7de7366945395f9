//! Step 4 of the last resort: a pair of triangles whose union is not convex, cut anew together with pairs around it.

use smallvec::SmallVec;

use super::{Means, Planner};
use crate::core::convert::component::NONE;
use crate::core::mesh::ids::ElementId;

/// A crooked pair is cut anew with up to this many pairs in all, itself included.
const MOST_PAIRS: usize = 4;
/// Larger rings are not tried once the worst quadrilateral of a smaller one is this good.
const GOOD: f64 = 0.2;

type Quads = SmallVec<[[u32; 4]; MOST_PAIRS]>;

/// The outline of some pairs of triangles that hang together.
#[derive(Clone, Debug)]
struct Ring {
    /// Its nodes, anticlockwise, each with the side from it to the next.
    corners: SmallVec<[(u32, u32); 2 * MOST_PAIRS + 2]>,
    /// The pairs, by the lesser side of the edge between their triangles.
    pairs: SmallVec<[u32; MOST_PAIRS]>,
}

impl Planner<'_> {
    /// Cuts a crooked pair anew together with a few pairs around it: with one, and where that gives nothing good with
    /// two, and so on.
    pub(super) fn recut(&mut self, side: u32, allowed: &dyn Fn(Means, [ElementId; 2]) -> bool) {
        let pair = self.pair(side);
        let start = Ring {
            corners: (pair.nodes.into_iter().zip(pair.outline)).collect(),
            pairs: SmallVec::from_slice(&[side]),
        };
        let mut rings = vec![start];
        let mut best: Option<(f64, Ring, Quads)> = None;
        for _ in 1..MOST_PAIRS {
            rings = rings.iter().flat_map(|ring| self.grown(ring, allowed)).collect();
            for ring in &rings {
                let least = best.as_ref().map_or(0.0, |(quality, ..)| *quality);
                if let Some((quality, quads)) = self.cut(ring, least) {
                    best = Some((quality, ring.clone(), quads));
                }
            }
            if best.as_ref().is_some_and(|(quality, ..)| *quality >= GOOD) {
                break;
            }
        }
        if let Some((_, ring, quads)) = best {
            self.plan.outcome.recut += quads.len();
            self.plan.quads.extend(quads);
            let triangles: SmallVec<[u32; 8]> =
                ring.pairs.iter().flat_map(|&side| [side / 3, self.dual.across[side as usize] / 3]).collect();
            self.close_patch(Means::Recut, &triangles);
        }
    }

    /// The ring with one more pair, for every pair beside it.
    fn grown(&self, ring: &Ring, allowed: &dyn Fn(Means, [ElementId; 2]) -> bool) -> Vec<Ring> {
        let mut grown = Vec::new();
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
            more.corners[k].1 = beside.outline[(at + 1) % 4];
            more.corners.insert_many(k + 1, [2, 3].map(|i| (beside.nodes[(at + i) % 4], beside.outline[(at + i) % 4])));
            grown.push(more);
        }
        grown
    }

    /// The best way to cut a ring into strictly convex quadrilaterals without new nodes, where the worst of them is
    /// better than `least`: by dynamic programming over its stretches.
    ///
    /// Quadrilaterals that are positive, and whose sides cancel out but for the ring, cover each place as often as the
    /// ring winds around it: once inside and never outside. So this is right also where the ring meets itself.
    fn cut(&self, ring: &Ring, least: f64) -> Option<(f64, Quads)> {
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
                            let worst = if self.is_convex(quad) { parts.min(self.quality(quad)) } else { least };
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
        let mut quads = Quads::new();
        let mut open: SmallVec<[(usize, usize); 8]> = SmallVec::from_slice(&[(0, n - 1)]);
        while let Some((i, j)) = open.pop() {
            if j > i + 1 {
                let (_, a, b) = best[i][j];
                quads.push([i, a, b, j].map(|k| ring.corners[k].0));
                open.extend([(i, a), (a, b), (b, j)]);
            }
        }
        Some((worst, quads))
    }
}
