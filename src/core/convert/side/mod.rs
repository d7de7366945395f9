//! Side edges (paper 4.3.4, definition of left and right side edges, i to vii; docs/algorithm.md, "Side edges"): the
//! left one, then the right one, prepared as `choice` and divided as `division` decide. Left and right are one
//! function.

pub mod candidates;
pub(super) mod choice;
mod division;

use self::choice::{BaseSide, SideChoice, Way};
use self::division::Division;
use super::event::{Event, Why};
use super::front::{Done, Front};
use super::phase::{Attempt, Base, Phase};
use crate::core::front::Side;
use crate::core::mesh::NodeId;

/// Prepares one side as [`BaseSide::choose`] decides (side edges i to v).
pub(super) fn prepare(
    front: &mut Front<'_>,
    base: Base,
    attempt: Attempt,
    side: Side,
    left: Option<NodeId>,
) -> Result<Done, Why> {
    let SideChoice { edge, way } =
        BaseSide { mesh: front.mesh, parameters: front.parameters, base: &base, side }.choose(&attempt, left)?;
    let event = match way {
        Way::Front => Event::SideIsFront { side, node: edge.node },
        Way::Edge => Event::SideChosen { edge },
        Way::Swap(h, instead_of) => {
            front.mesh.swap(h);
            Event::SideSwapped { edge, instead_of }
        }
    };
    let tops = match side {
        Side::Left => [Some(edge.node), None],
        Side::Right => [left, Some(edge.node)],
    };
    let here = BaseSide { mesh: front.mesh, parameters: front.parameters, base: &base, side };
    // A dead edge is never divided; what cannot be divided and must be fails in its own step.
    let stays_whole = way == Way::Front || matches!(here.division(&attempt, edge.node, front.source), Ok(None));
    let next =
        if stays_whole { after(base, attempt, side, tops) } else { Phase::DivideSide { base, attempt, side, tops } };
    Ok((next, Some(event)))
}

/// Divides a side edge that is too long, or whose division is forced (side edges vi); the half at the base is the side.
pub(super) fn divide(
    front: &mut Front<'_>,
    base: Base,
    attempt: Attempt,
    side: Side,
    mut tops: [Option<NodeId>; 2],
) -> Result<Done, Why> {
    let top = tops[side.index()].ok_or(Why::NoSide(side))?;
    let here = BaseSide { mesh: front.mesh, parameters: front.parameters, base: &base, side };
    let Some(Division { h, middle, metric, length }) = here.division(&attempt, top, front.source)? else {
        // The parameters have changed since it was judged.
        return Ok((after(base, attempt, side, tops), None));
    };
    let node = front.mesh.divide(h, middle, metric).expect("it was judged");
    tops[side.index()] = Some(node);
    Ok((after(base, attempt, side, tops), Some(Event::SideDivided { side, node, length })))
}

/// The right side comes after the left one, and the top after both (side edges vii).
fn after(base: Base, attempt: Attempt, side: Side, tops: [Option<NodeId>; 2]) -> Phase {
    match (side, tops) {
        (Side::Right, [Some(c), Some(d)]) => {
            Phase::RecoverTop { base, attempt, tops: [c, d], swaps: 0, smooths: false }
        }
        _ => Phase::PrepareSide { base, attempt, side: Side::Right, left: tops[0] },
    }
}
