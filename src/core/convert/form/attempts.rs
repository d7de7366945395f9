//! The next way to try a quadrilateral whose formation was taken back (docs/algorithm.md, "Rescue").

use crate::core::case::Parameters;
use crate::core::convert::phase::{Attempt, Base};
use crate::core::front::Side;
use crate::core::mesh::{Mark, Mesh};

/// The first attempt that lays tops down: every other edge at B, then at A; the two Lee-Lo pairs come after.
const ALTERNATIVES: u8 = 4;

/// The next attempt: forced divisions, then every other edge at B, then at A, then the base triangle's Lee-Lo pairs.
pub fn next(mesh: &Mesh, parameters: &Parameters, base: &Base, failed: &Attempt) -> Option<Attempt> {
    let mut number = failed.number;
    loop {
        number = number.saturating_add(1);
        if let Some(next) = attempt(mesh, parameters, base, number, failed.mark)? {
            return Some(next);
        }
    }
}

/// The attempt of a number: `None` past the last, `Some(None)` where it would be no different from another.
fn attempt(mesh: &Mesh, parameters: &Parameters, base: &Base, number: u8, mark: Mark) -> Option<Option<Attempt>> {
    let plain = Attempt { number, divide: [false; 2], tops: [None; 2], mark };
    if number < ALTERNATIVES {
        let is_front = base.theta.map(|t| t < parameters.theta_rect);
        let divide = [[false, true], [true, false], [true, true]][usize::from(number) - 1];
        let possible = !(divide[0] && is_front[0] || divide[1] && is_front[1]);
        return Some(possible.then_some(Attempt { divide, ..plain }));
    }
    let h = base.half_edge(mesh)?;
    let mut k = usize::from(number - ALTERNATIVES);
    for side in [Side::Right, Side::Left] {
        let spokes = mesh.spokes(h, side);
        if let Some(spoke) = spokes.get(k) {
            let mut tops = [None; 2];
            tops[side.index()] = Some(spoke.node);
            return Some(Some(Attempt { tops, ..plain }));
        }
        k -= spokes.len();
    }
    // The base triangle with its neighbour beyond the right edge, then the left one.
    let apex = mesh.apex(h);
    let (edge, beyond_right) = match k {
        0 => (mesh.next(h), true),
        1 => (mesh.previous(h), false),
        _ => return None,
    };
    let pair = mesh.live_twin(edge).map(|t| {
        let far = mesh.apex(t);
        let tops = if beyond_right { [Some(apex), Some(far)] } else { [Some(far), Some(apex)] };
        Attempt { tops, ..plain }
    });
    Some(pair)
}
