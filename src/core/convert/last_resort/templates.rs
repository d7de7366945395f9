//! Step 5 of the last resort: edges of the join divided, and the triangles between them filled by templates.

use glam::DVec2;

use super::component::NONE;
use super::planner::Planner;
use super::{Means, Stuck};
use crate::core::kernel::predicates::{convex, firm};

impl Planner<'_> {
    /// The templates of step 5, a patch for each connected part of the join.
    pub fn fill_with_templates(&mut self) -> Result<(), Stuck> {
        for first in 0..self.dual.triangles.len() as u32 {
            if self.done[first as usize] {
                continue;
            }
            let mut patch = vec![first];
            self.done[first as usize] = true;
            // Middles of divided edges that the triangles still to come share, by their side of the edge.
            let mut middles: Vec<(u32, u32)> = Vec::new();
            let mut next = 0;
            while let Some(&t) = patch.get(next) {
                next += 1;
                let mut divided = [NONE; 3];
                for k in 0..3 {
                    let side = 3 * t + k;
                    if self.join[t as usize] >> k & 1 == 0 {
                        continue;
                    }
                    divided[k as usize] = if let Some(at) = middles.iter().position(|&(s, _)| s == side) {
                        middles.swap_remove(at).1
                    } else {
                        let across = self.dual.across[side as usize];
                        let [a, b] = self.ends(side);
                        let middle = self.add_node(0.5 * (self.uv(a) + self.uv(b)))?;
                        middles.push((across, middle));
                        self.plan.outcome.divided += 1;
                        // The join may have cycles: a triangle can be reached over several sides.
                        if !std::mem::replace(&mut self.done[(across / 3) as usize], true) {
                            patch.push(across / 3);
                        }
                        middle
                    };
                }
                self.fill(t, divided)?;
            }
            debug_assert!(middles.is_empty());
            self.close_patch(Means::Templates, &patch);
        }
        Ok(())
    }

    /// One triangle with one or three divided sides.
    ///
    /// ```text
    ///              C                             C
    ///             /|\                           / \
    ///            / | \                         /   \
    ///           /  C'  \                      /     \
    ///          / _/ \_  \                   m2       m1
    ///         / /     \  \                  / \_   _/ \
    ///        / A'_   _B'  \                /    \G/    \
    ///       / /   \m'/  \  \              /      |      \
    ///      //      |      \ \            /       |       \
    ///     A--------m---------B          A--------m0-------B
    /// ```
    /// One side: five quadrilaterals, the least there can be; the barycentric places of A', B', C' and m' are the best
    /// found (least scaled Jacobian 0.5 on the equilateral triangle). Three sides: the centroid G.
    fn fill(&mut self, t: u32, middles: [u32; 3]) -> Result<(), Stuck> {
        let first = self.plan.quads.len();
        let corners = self.mesh().triangle(self.dual.triangles[t as usize]).map(|n| n.0);
        if middles.iter().all(|&m| m != NONE) {
            let [a, b, c] = corners;
            let [m0, m1, m2] = middles;
            let centre = self.add_node(self.barycentric(corners, [1.0 / 3.0; 3]))?;
            self.plan.quads.extend([[a, m0, centre, m2], [b, m1, centre, m0], [c, m2, centre, m1]]);
        } else {
            let k = middles.iter().position(|&m| m != NONE).expect("a triangle has one or three edges in the join");
            let m = middles[k];
            let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
            let mut inner = [0; 4];
            let weights = [[0.5, 0.25, 0.25], [0.25, 0.5, 0.25], [0.25, 0.25, 0.5], [0.4375, 0.4375, 0.125]];
            for (node, weights) in inner.iter_mut().zip(weights) {
                *node = self.add_node(self.barycentric([a, b, c], weights))?;
            }
            let [a_in, b_in, c_in, m_in] = inner;
            self.plan.quads.extend([
                [a, m, m_in, a_in],
                [m, b, b_in, m_in],
                [b, c, c_in, b_in],
                [c, a, a_in, c_in],
                [a_in, m_in, b_in, c_in],
            ]);
        }
        self.plan.outcome.template_quads += self.plan.quads.len() - first;
        let is_convex = |quad: &[u32; 4]| {
            let [a, b, c, d] = quad.map(|n| self.uv(n));
            convex(a, b, c, d)
        };
        if self.plan.quads[first..].iter().all(is_convex) {
            return Ok(());
        }
        let element = self.dual.triangles[t as usize];
        let [p_a, p_b, p_c] = corners.map(|n| self.uv(n));
        debug_assert!(!firm(p_a, p_b, p_c), "a template of {element:?} is inverted though the triangle is firm");
        Err(Stuck::TooFlat { element, uv: self.uv(corners[0]) })
    }

    fn barycentric(&self, corners: [u32; 3], weights: [f64; 3]) -> DVec2 {
        let [a, b, c] = corners.map(|n| self.uv(n));
        weights[0] * a + weights[1] * b + weights[2] * c
    }
}
