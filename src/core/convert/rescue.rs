//! The next way to try a quadrilateral whose formation was taken back (docs/algorithm.md, "Rescue").

use super::converter::Converter;
use super::phase::{Attempt, Base};
use crate::core::front::sector::Side;
use crate::core::mesh::journal::Mark;

/// Every other edge at B, then at A, is tried up to here; the two Lee-Lo pairs come after.
const ALTERNATIVES: u8 = 4;

impl Converter<'_> {
    /// Finds the next attempt: divisions that are forced, then every other edge at B, then at A, then the Lee-Lo pairs of
    /// the base triangle (docs/algorithm.md, "Rescue").
    pub(super) fn next_attempt(&self, base: &Base, failed: &Attempt) -> Option<Attempt> {
        let mut number = failed.number;
        loop {
            number = number.saturating_add(1);
            if let Some(next) = self.attempt(base, number, failed.mark)? {
                return Some(next);
            }
        }
    }

    /// The attempt of a number: `None` past the last, `Some(None)` where it would be no different from another.
    fn attempt(&self, base: &Base, number: u8, mark: Mark) -> Option<Option<Attempt>> {
        let plain = Attempt { number, divide: [false; 2], tops: [None; 2], mark };
        let is_front = base.theta.map(|t| t < self.parameters.theta_rect);
        if number < ALTERNATIVES {
            let divide = [[false, true], [true, false], [true, true]][usize::from(number) - 1];
            let possible = !(divide[0] && is_front[0] || divide[1] && is_front[1]);
            return Some(possible.then_some(Attempt { divide, ..plain }));
        }
        let h = self.base_half_edge(base)?;
        let mut k = usize::from(number - ALTERNATIVES);
        for (side, spokes) in
            [(Side::Right, self.mesh.spokes(h, Side::Right)), (Side::Left, self.mesh.spokes(h, Side::Left))]
        {
            if let Some(spoke) = spokes.get(k) {
                let mut tops = [None; 2];
                tops[side.index()] = Some(spoke.node);
                return Some(Some(Attempt { tops, ..plain }));
            }
            k -= spokes.len();
        }
        // The base triangle with its neighbour beyond the right edge, then the left one.
        let apex = self.mesh.origin(self.mesh.previous(h));
        let (edge, beyond_right) = match k {
            0 => (self.mesh.next(h), true),
            1 => (self.mesh.previous(h), false),
            _ => return None,
        };
        let pair = self.mesh.twin(edge).filter(|t| self.mesh.is_triangle(t.element())).map(|t| {
            let far = self.mesh.origin(self.mesh.previous(t));
            let tops = if beyond_right { [Some(apex), Some(far)] } else { [Some(far), Some(apex)] };
            Attempt { tops, ..plain }
        });
        Some(pair)
    }
}
