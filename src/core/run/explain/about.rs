//! What a step looked at and why it did what it did, in sentences: for every kind of event, also for those that follow
//! from what was decided before.

use super::event::attempt;
use super::formation::{formation, gates};
use super::narrow::{angle, regions};
use super::numbers::{angles_apart, apart, capital, count, edge, value};
use super::side::{name, side_rule};
use crate::core::case::{CleanUpBy, Parameters};
use crate::core::convert::{
    Attempt, Base, Cleaning, Converter, Event, FinishPart, Gates, LookedAt, MOST_CROSSINGS, MOST_SEGMENTS, MOST_SWAPS,
    MOST_TRIANGLES, MOST_UNLIKE, Means, Outcome, Phase, Purpose, Why,
};
use crate::core::front::Side;
use crate::core::kernel::number::{fixed, grouped};
use crate::core::mesh::{Mesh, NodeId};
use crate::core::metric::measure;

/// What a step looked at, and why it did what it did: `before` is of the state before it, `after` the state after it.
/// Why a base was selected is told by [`Selecting`](super::Selecting) instead, which knows the front.
pub fn about(event: &Event, before: &LookedAt, after: &Converter<'_>) -> Vec<String> {
    let mesh = &after.mesh;
    match event {
        Event::BaseSelected { .. } => Vec::new(),
        Event::PickLost { .. } => {
            one("A step since you chose it has changed the front there; the rules select the next base (4.3.3).")
        }
        Event::SideIsFront { .. } | Event::SideChosen { .. } | Event::SideSwapped { .. } => {
            before.candidates.as_ref().map(side_rule).into_iter().collect()
        }
        Event::SideDivided { side, length, .. } => division(*side, *length, before),
        Event::TopSmoothed { .. } => {
            one("After a swap the free nodes that live triangles join to C are smoothed (4.3.4, top edge v).")
        }
        Event::TopSwapped { across, .. } => top_swap(*across, before),
        Event::TopFound { ends, .. } => {
            let [c, d] = ends.map(|node| node.0);
            vec![format!("An edge joins the tops {c} and {d}: it is the top edge (4.3.4, top edge vi).")]
        }
        Event::NodeRemoved { node, purpose: Purpose::Recovery } => top_removal(*node, before),
        Event::NodeRemoved { purpose: Purpose::Enhancement, .. } => removal(&before.parameters),
        Event::Formed { element, attempt, .. } => {
            formation(*element, *attempt, before, mesh, &after.loops_after(event).unwrap_or_default())
        }
        Event::RolledBack { why, .. } => rolled_back(*why, before, after),
        Event::Deferred { .. } => deferred(before),
        Event::Enhanced { new } => enhanced(*new, mesh).into_iter().collect(),
        Event::Smoothed { .. } => smoothed(&before.parameters),
        Event::Seamed { corner, .. } | Event::SeamRefused { corner, .. } => vec![angle(corner)],
        Event::TransitionSeamed { corner, .. } => vec![
            angle(corner),
            format!(
                "One segment is {} times as long as the other, more than {MOST_UNLIKE}: it was divided first.",
                fixed(corner.ratio, 2)
            ),
        ],
        Event::Split { .. } | Event::SplitRefused { .. } => before.narrow.as_ref().map(regions).unwrap_or_default(),
        Event::Closed { .. } => closed(before),
        Event::SecondPass => {
            let [first, second] = [false, true].map(Gates::of);
            vec![format!(
                "No segment can be selected. Once, all are tried again: a quadrilateral then needs a quality of {} in \
                 place of {}, and its new edges may be {} in place of {} long.",
                second.quality, first.quality, second.length, first.length
            )]
        }
        Event::Matched { triangles, unmatched, unmatched_at_all, patches } => {
            let left = |n: usize, by: &str| format!("{} without a partner after {by}", grouped(n as u64));
            vec![format!(
                "Of {}: {}, {}; steps to come: {}.",
                count(*triangles, "triangle"),
                left(*unmatched, "the matching of neighbours whose union is convex"),
                left(*unmatched_at_all, "that over all inner edges"),
                grouped(*patches as u64)
            )]
        }
        Event::Patched { means, .. } => vec![patched(*means).to_owned()],
        Event::LastResort(outcome) => vec![last_resort(outcome, &before.parameters)],
        Event::Cleaned { what, energy } => cleaned(*what, *energy, &before.parameters),
        Event::Refilled { irregular, energy, .. } => refilled(*irregular, *energy),
        Event::RowLaid { .. } => one(
            "In a stretched metric an edge across the wall may lean far at next to no cost. So the rows of a boundary \
             layer are laid from the wall outwards: each node goes along the normal of the wall to the height asked \
             for, as far as every element around stays convex and good enough.",
        ),
        Event::Swept { .. } => swept(before.part),
        Event::Unfolded { sine, .. } => unfolded(*sine),
        Event::FaceConverted { .. } => one("Nothing of this face is left to convert; the next one is taken."),
        Event::PostProcessed => one("No node waits to be smoothed any more (4.3.7)."),
        Event::Mirrored { .. } => one(
            "The case asks for symmetry: one half of the domain was converted, and the other one is its image to the \
             last bit. Nodes inside the mirror line lie on no boundary any more.",
        ),
        Event::Finished => one("Nothing is left to convert."),
    }
}

fn one(sentence: &str) -> Vec<String> {
    vec![sentence.to_owned()]
}

/// Why a side is too long, or is divided all the same.
fn division(side: Side, length: f64, before: &LookedAt) -> Vec<String> {
    let (Some(base), Some(attempt)) = (&before.base, &before.attempt) else { return Vec::new() };
    let why = divided(&before.parameters, base, attempt, side, length);
    vec![format!("{} The half at the base is the side ({}).", capital(&why), value(&before.parameters, "division_at"))]
}

/// Why a side is to be divided, as a sentence that begins with its length or the attempt.
pub(super) fn divided(parameters: &Parameters, base: &Base, attempt: &Attempt, side: Side, length: f64) -> String {
    if attempt.divide[side.index()] {
        return format!("this attempt divides the {} side, whatever its length.", name(side));
    }
    let split = parameters.side_split;
    let [length, bound] = apart(length, split * base.length);
    let of_base = fixed(base.length, 3);
    format!("its metric length {length} is above {split} l_{{AB}} = {split} \u{d7} {of_base} = {bound} (4.3.4, vi).")
}

/// Which of the edges across the top was swapped.
fn top_swap(across: [NodeId; 2], before: &LookedAt) -> Vec<String> {
    let Some((top, crossings)) = &before.top else { return Vec::new() };
    let is_it = |ends: &[NodeId; 2]| *ends == across || [ends[1], ends[0]] == across;
    let place = crossings.iter().position(is_it).unwrap_or(0);
    let lie = lie_across(*top, crossings.len());
    let it = edge(across);
    let why = match (crossings.len(), place) {
        (1, _) => format!("{it} is swapped"),
        (_, 0) => format!("{it}, the first one from C on, can be swapped"),
        (_, 1) => format!("{it} is swapped; the one before it cannot be, or would still lie across"),
        (_, n) => format!("{it} is swapped; the {n} before it cannot be, or would still lie across"),
    };
    vec![format!("{lie}: {why} (4.3.4, top edge ii to iv).")]
}

fn lie_across(top: [NodeId; 2], edges: usize) -> String {
    let lie = if edges == 1 { "lies" } else { "lie" };
    format!("{} {lie} across the top {}", capital(&count(edges, "edge")), edge(top))
}

fn top_removal(node: NodeId, before: &LookedAt) -> Vec<String> {
    let Some((top, crossings)) = &before.top else { return Vec::new() };
    let lie = lie_across(*top, crossings.len());
    let none = "none can be swapped without lying across again";
    vec![format!("{lie}; {none}. Node {} is their first end that can be removed (4.3.4, top edge iii).", node.0)]
}

fn removal(parameters: &Parameters) -> Vec<String> {
    let order = value(parameters, "enhancement_order");
    vec![format!("It stood beside the new quadrilateral with triangles only around it (4.3.6, i; {order}).")]
}

/// What did not pass, against its bound, and what is tried next.
fn rolled_back(why: Why, before: &LookedAt, after: &Converter<'_>) -> Vec<String> {
    let mut sentences: Vec<String> = match why {
        Why::NoSide(_) => before.candidates.as_ref().map(side_rule).into_iter().collect(),
        Why::NoDivision(_) => one("This attempt divides the side, whatever its length."),
        Why::TopBlocked(_) => one("An edge of the front or of the boundary is dead: it cannot be swapped."),
        Why::TopThroughNode(_) => one("No swap makes an edge that runs through a node."),
        Why::TopTooLong => {
            vec![format!("At most {MOST_CROSSINGS} edges may lie across the top, and at most {MOST_SWAPS} may change.")]
        }
        Why::TopStuck => match &before.top {
            Some((top, crossings)) => {
                vec![format!("{} (4.3.4, top edge ii to iv).", lie_across(*top, crossings.len()))]
            }
            None => Vec::new(),
        },
        Why::TooLong(_) | Why::Poor(_) => vec![gates(before)],
        Why::NotDisc => one("Between the four sides there must be no hole, no front and no fixed node."),
        Why::NotConvex => one("All four corners are judged exactly, in the parametric plane."),
        Why::OddLoop(_) => one("Every loop of the front keeps an even number of segments."),
        Why::NoMetric => Vec::new(),
    };
    sentences.push(match after.phase() {
        Phase::PrepareSide { attempt: next, .. } => {
            format!("Attempt {} follows: {}.", u32::from(next.number) + 1, attempt(next))
        }
        _ => "It was the last attempt.".to_owned(),
    });
    sentences
}

fn deferred(before: &LookedAt) -> Vec<String> {
    let waits = "It waits until something near it changes";
    match before.segments {
        Some(segments) if segments > MOST_SEGMENTS => {
            vec![format!("{waits}; its loop has more than {MOST_SEGMENTS} segments and is not closed as a small one.")]
        }
        Some(segments) => vec![format!(
            "{waits}; its loop of {segments} segments has more than {MOST_TRIANGLES} triangles inside, or no way to \
             close it is good enough."
        )],
        None => vec![format!("{waits}.")],
    }
}

fn closed(before: &LookedAt) -> Vec<String> {
    let why = if before.front_has_ended { "The front has ended" } else { "Every attempt at a base of it has failed" };
    vec![format!(
        "{why}, and it has no more than {MOST_SEGMENTS} segments and {MOST_TRIANGLES} triangles: the best of all ways \
         to fill it is taken."
    )]
}

/// The largest metric angle of the two triangles at a live edge, and that of the two triangles that its swap would
/// give, in radians; `None` where the edge is not live.
pub fn angles_of_swap(mesh: &Mesh, [a, b]: [NodeId; 2]) -> Option<[f64; 2]> {
    let h = mesh.half_edge_between(a, b).filter(|&h| mesh.is_triangle(h.element()))?;
    let (c, d) = (mesh.apex(h), mesh.apex(mesh.live_twin(h)?));
    let largest = |triangles: [[NodeId; 3]; 2]| {
        let angles = triangles.into_iter().flat_map(|[p, q, r]| {
            [[p, q, r], [q, r, p], [r, p, q]].map(|[at, from, to]| {
                let here = mesh.uv(at);
                let angle = measure::angle(mesh.metric_ref(at), mesh.uv(from) - here, mesh.uv(to) - here);
                angle.min(std::f64::consts::TAU - angle)
            })
        });
        angles.fold(0.0, f64::max)
    };
    Some([largest([[a, b, c], [b, a, d]]), largest([[d, c, a], [c, d, b]])])
}

/// The largest angles before and after a swap.
fn enhanced(new: [NodeId; 2], mesh: &Mesh) -> Option<String> {
    let h = mesh.half_edge_between(new[0], new[1])?;
    let old = edge([mesh.apex(h), mesh.apex(mesh.twin(h)?)]);
    // Seen from the new edge, the old one is the swap.
    let [after, before] = angles_of_swap(mesh, new)?;
    let [after, before] = angles_apart(after, before);
    Some(format!(
        "With {old} the largest angle of the two triangles was {before}\u{b0}; now it is {after}\u{b0} (4.3.6, ii)."
    ))
}

fn smoothed(parameters: &Parameters) -> Vec<String> {
    let keys = [value(parameters, "smoothing_weights"), value(parameters, "smooth_joined")].join(", ");
    let stays = if parameters.placement {
        " Nodes of the front and of cut grids stay; those that the quadrilateral buries are relaxed (placement = true)."
    } else {
        " Nodes of the front move too (placement = false)."
    };
    vec![format!("One sweep over the nodes around the quadrilateral (4.3.6, eqs. 9 and 10; {keys}).{stays}")]
}

fn patched(means: Means) -> &'static str {
    match means {
        Means::Merge => "Two triangles whose union is convex are merged.",
        Means::Recut => "The union of a pair is not convex: it is cut anew together with pairs around it.",
        Means::Templates => {
            "Triangles without a partner are linked by edges that are divided, and filled by templates."
        }
    }
}

fn last_resort(outcome: &Outcome, parameters: &Parameters) -> String {
    let then = if parameters.post_processing {
        "the whole mesh is cleaned up and smoothed next (4.3.7)"
    } else {
        "the conversion ends without post-processing (post_processing = false)"
    };
    if outcome.triangles == 0 {
        return format!("The front and small loops have left no triangle; {then}.");
    }
    let of = |n: usize| grouped(n as u64);
    format!(
        "{} quadrilaterals are two merged triangles, {} were cut anew, {} come from templates; {then}.",
        of(outcome.merged),
        of(outcome.recut),
        of(outcome.template_quads)
    )
}

fn cleaned(what: Cleaning, energy: [f64; 2], parameters: &Parameters) -> Vec<String> {
    let what = match what {
        Cleaning::DiamondCollapsed { gone, kept } => {
            format!("Nodes {} and {} were merged into the latter", gone.0, kept.0)
        }
        Cleaning::EdgeRotated { old, new } => format!("The edge {} was rotated to {}", edge(old), edge(new)),
        Cleaning::VertexOpened { node, new, .. } => format!("Node {} was opened, with the new node {}", node.0, new.0),
        Cleaning::DoubletRemoved { node } => format!("Node {} with two elements was removed", node.0),
    };
    let [before, after] = apart(energy[0], energy[1]);
    let by = value(parameters, "clean_up");
    let why = match parameters.clean_up {
        CleanUpBy::Traditional => "the sum of the squared excesses of the valences falls".to_owned(),
        CleanUpBy::Search => format!("the energy of all that it moved falls from {before} to {after}"),
    };
    vec![format!("{what}; the change is kept since {why} (4.3.7; {by}).")]
}

fn refilled([from, to]: [u32; 2], energy: [f64; 2]) -> Vec<String> {
    let [before, after] = apart(energy[0], energy[1]);
    let less = from.saturating_sub(to);
    let why = match less {
        0 => "no irregular node goes, but the energy falls".to_owned(),
        _ => format!("{} fewer, for which the energy may rise a little", count(less as usize, "irregular node")),
    };
    vec![format!("The filling is kept: {why}; it goes from {before} to {after} (4.3.7).")]
}

fn swept(part: Option<FinishPart>) -> Vec<String> {
    let when = if part == Some(FinishPart::LastSmoothing) { "after the clean-up" } else { "before the clean-up" };
    vec![format!(
        "Each free node that waits goes to where the energy of its elements is least; one that moves far lets its \
         neighbours wait ({when}, 4.3.7)."
    )]
}

fn unfolded(sine: [f64; 2]) -> Vec<String> {
    let [before, after] = apart(sine[0], sine[1]);
    vec![format!(
        "The smallest sine of its corners in space was {before}, that of the elements around is {after} now. A repair \
         is kept only if fewer elements fold, or none folds more where nodes coincide."
    )]
}
