//! The next way to try a quadrilateral whose formation was taken back (docs/algorithm.md, "Rescue").

use smallvec::SmallVec;

use crate::core::case::{FirstRescue, Parameters};
use crate::core::convert::phase::{Attempt, Base};
use crate::core::convert::side::choice::BaseSide;
use crate::core::front::Side;
use crate::core::mesh::{Mark, Mesh};

/// The attempt after a failed one.
pub fn next(mesh: &Mesh, parameters: &Parameters, base: &Base, failed: &Attempt) -> Option<Attempt> {
    let attempts = attempts(mesh, parameters, base, failed.mark);
    let next = attempts.get(usize::from(failed.number))?;
    Some(Attempt { number: failed.number.checked_add(1)?, ..*next })
}

/// All attempts after the first one, in order (their numbers follow from that): forced divisions, then every edge at B,
/// then at A, then the base triangle's Lee-Lo pairs. With `FirstRescue::LeftNeighbour`, the left-hand neighbours of the
/// right side come before them all.
fn attempts(mesh: &Mesh, parameters: &Parameters, base: &Base, mark: Mark) -> SmallVec<[Attempt; 24]> {
    let mut all = SmallVec::new();
    let plain = Attempt { number: 0, divide: [false; 2], tops: [None; 2], mark };
    let is_front = base.theta.map(|t| t < parameters.theta_rect);
    for divide in [[false, true], [true, false], [true, true]] {
        if !(divide[0] && is_front[0] || divide[1] && is_front[1]) {
            all.push(Attempt { divide, ..plain });
        }
    }
    let Some(h) = base.half_edge(mesh) else { return all };
    for side in [Side::Right, Side::Left] {
        let first = all.len();
        for spoke in mesh.spokes(h, side) {
            let mut tops = [None; 2];
            tops[side.index()] = Some(spoke.node);
            all.push(Attempt { tops, ..plain });
        }
        if side == Side::Right && parameters.first_rescue == FirstRescue::LeftNeighbour {
            // Edges are met from the base on: those before the right side are to its left, the last of them beside it.
            let to_its_left = left_of_the_right_side(mesh, parameters, base, &plain);
            all[first..first + to_its_left].reverse();
            all[..first + to_its_left].rotate_left(first);
        }
    }
    // The base triangle with its neighbour beyond the right edge, then the left one.
    let apex = mesh.apex(h);
    for (edge, beyond_right) in [(mesh.next(h), true), (mesh.previous(h), false)] {
        if let Some(far) = mesh.live_twin(edge).map(|t| mesh.apex(t)) {
            let tops = if beyond_right { [Some(apex), Some(far)] } else { [Some(far), Some(apex)] };
            all.push(Attempt { tops, ..plain });
        }
    }
    all
}

/// The number of edges at B to the left of the right side of the first attempt.
fn left_of_the_right_side(mesh: &Mesh, parameters: &Parameters, base: &Base, first: &Attempt) -> usize {
    let side = |side| BaseSide { mesh, parameters, base, side };
    let left = side(Side::Left).choose(first, None).ok().map(|choice| choice.edge.node);
    let right = side(Side::Right);
    let Ok(chosen) = right.choose(first, left) else { return 0 };
    let spokes = base.half_edge(mesh).map(|h| mesh.spokes(h, Side::Right)).unwrap_or_default();
    let is_left = |node| node != chosen.edge.node && right.edge(node).angle < chosen.edge.angle;
    spokes.iter().take_while(|spoke| is_left(spoke.node)).count()
}
