//! What a step did, in one line.

use super::numbers::{apart, count, edge, segment};
use super::side::name;
use crate::core::convert::{Attempt, Event, Mending, Purpose, Unmerged, Why};
use crate::core::front::Side;
use crate::core::kernel::number::{degrees, fixed, grouped, size};
use crate::core::mesh::NodeId;

/// What an attempt at a quadrilateral tries, in a phrase.
pub fn attempt(attempt: &Attempt) -> String {
    let side = |side: Side, node: NodeId| format!("{} side set to node {}", name(side), node.0);
    match (attempt.divide, attempt.tops) {
        ([true, true], _) => "both sides divided".to_owned(),
        ([true, false], _) => "left side divided".to_owned(),
        ([false, true], _) => "right side divided".to_owned(),
        (_, [Some(c), Some(d)]) => format!("triangles paired: left top {}, right top {}", c.0, d.0),
        (_, [Some(c), None]) => side(Side::Left, c),
        (_, [None, Some(d)]) => side(Side::Right, d),
        (_, [None, None]) => "sides by the rules".to_owned(),
    }
}

/// What a step did, in one line.
pub fn event(event: &Event) -> String {
    match *event {
        Event::BaseSelected { a, b, class, h_value, picked, .. } => {
            let by = if picked { "you chose the base" } else { "base selected" };
            format!("{by}: {}, class {class}, H {}", segment([a, b]), size(h_value))
        }
        Event::PickLost { a, b } => format!("{} was chosen as base, but is no longer on the front", segment([a, b])),
        Event::SideIsFront { side, node } => format!("{} side is the front, to node {}", name(side), node.0),
        Event::SideChosen { edge } => {
            let off = degrees(edge.deviation);
            format!("{} side chosen: node {}, {off}\u{b0} off the target direction", name(edge.side), edge.node.0)
        }
        Event::SideSwapped { edge, .. } => {
            let (which, off) = (name(edge.side), degrees(edge.deviation));
            format!("{which} side made by a swap: node {}, {off}\u{b0} off the target direction", edge.node.0)
        }
        Event::SideDivided { side, node, length } => {
            format!("{} side divided at new node {}; its metric length was {}", name(side), node.0, fixed(length, 2))
        }
        Event::TopSwapped { across, new } => format!("top: {} swapped for {}", edge(across), edge(new)),
        Event::TopSmoothed { nodes } => format!("{} smoothed around the left top", count(nodes.into(), "node")),
        Event::TopFound { ends, swaps: 0 } => format!("top edge found: {}", edge(ends)),
        Event::TopFound { ends, swaps } => {
            format!("top edge found: {}, after {}", edge(ends), count(swaps.into(), "change"))
        }
        Event::NodeRemoved { node, purpose: Purpose::Recovery } => {
            format!("node {} removed to clear the way for the top", node.0)
        }
        Event::NodeRemoved { node, purpose: Purpose::Enhancement } => {
            format!("node {}, with three or four triangles, removed", node.0)
        }
        Event::Formed { element, quality, merged, swallowed, .. } => {
            let inside: Vec<String> = swallowed.iter().map(|node| node.0.to_string()).collect();
            let gone = match inside.len() {
                0 => String::new(),
                1 => format!(", node {} between them removed", inside[0]),
                _ => format!(", nodes {} between them removed", inside.join(", ")),
            };
            format!(
                "quadrilateral {} formed: quality {}, {merged} triangles merged{gone}",
                element.0,
                fixed(quality, 2)
            )
        }
        Event::RolledBack { attempt, why } => {
            format!("attempt {} rolled back: {}", u32::from(attempt) + 1, why_rolled_back(why))
        }
        Event::Deferred { a, b } => format!("segment {} deferred: every attempt failed", segment([a, b])),
        Event::Enhanced { new } => format!("edge {} made by a swap beside the new quadrilateral", edge(new)),
        Event::Smoothed { nodes } => format!("{} smoothed", count(nodes.into(), "node")),
        Event::Seamed { at, node, corner, .. } => {
            format!("seam at node {}: {}\u{b0} closed, ends joined in node {}", at.0, degrees(corner.angle), node.0)
        }
        Event::TransitionSeamed { at, node, corner, .. } => format!(
            "transition seam at node {}: {}\u{b0} closed, one side {} times the other, joined in node {}",
            at.0,
            degrees(corner.angle),
            fixed(corner.ratio, 1),
            node.0
        ),
        Event::SeamRefused { at, corner, why, .. } => {
            format!("corner of {}\u{b0} at node {} not seamed: {}", degrees(corner.angle), at.0, why_unmerged(why))
        }
        Event::Split { node, gone, segments: [first, second], .. } => {
            format!("front split: node {} joined to node {}, loops of {first} and {second} segments", gone.0, node.0)
        }
        Event::SplitRefused { slender, why, .. } => {
            let triangles = count(slender.into(), "slender triangle");
            let why = why.map_or("no side leaves two even loops".to_owned(), why_unmerged);
            format!("front not split at {triangles}: {why}")
        }
        Event::Closed { segments, quads: 0, quality } => format!(
            "loop of {segments} segments closed without a new quadrilateral, worst quality {}",
            fixed(quality, 2)
        ),
        Event::Closed { segments, quads, quality } => format!(
            "loop of {segments} segments closed by {}, worst quality {}",
            count(quads.into(), "quadrilateral"),
            fixed(quality, 2)
        ),
        Event::SecondPass => "all segments are deferred: second pass with wider tolerances".to_owned(),
        Event::Matched { triangles, unmatched, .. } => format!(
            "last resort: the matching gives a partner to {} of {}",
            grouped(triangles.saturating_sub(unmatched) as u64),
            count(triangles, "triangle")
        ),
        Event::Patched { triangles, quads, element, .. } => {
            format!("last resort: {quads} quadrilaterals of {triangles} triangles, from element {}", element.0)
        }
        Event::Cleaned { energy: [before, after], .. } => {
            let [before, after] = apart(before, after);
            format!("mesh structure cleaned up locally: energy {before} to {after}")
        }
        Event::Refilled { sides, quads: [old, new], irregular: [from, to], energy: [before, after] } => {
            let [before, after] = apart(before, after);
            let sides: Vec<String> = sides.iter().filter(|&&n| n > 0).map(|n| n.to_string()).collect();
            let border = match &*sides {
                [edges] => format!("a border of {edges} edges"),
                sides => format!("sides of {} edges", sides.join(", ")),
            };
            let quads = count(new as usize, "quadrilateral");
            let irregular = count(to as usize, "irregular node");
            format!(
                "cavity with {border} filled anew: {quads} instead of {old}, {irregular} instead of {from}, \
                 energy {before} to {after}"
            )
        }
        Event::Unfolded { element, how, .. } => {
            let how = match how {
                Mending::Moved => "its corners were moved",
                Mending::Rotated { .. } => "an edge was rotated",
                Mending::Collapsed { .. } => "two of its corners were merged",
                Mending::Pillowed { .. } => "a smaller quadrilateral was inserted",
            };
            format!("element {} folded over the surface: {how}", element.0)
        }
        Event::FaceConverted { region } => format!("face {} is converted", region + 1),
        Event::RowLaid { row, nodes, laid, .. } => {
            format!("row {row} from the walls: {laid} of {} laid on the normals", count(nodes as usize, "node"))
        }
        Event::Swept { looked, moved } => {
            format!("{moved} of {} moved to lower the energy", count(looked as usize, "node"))
        }
        Event::LastResort(outcome) if outcome.triangles == 0 => "nothing was left for the last resort".to_owned(),
        Event::LastResort(outcome) => {
            format!("the last resort has converted {} triangles", grouped(outcome.triangles as u64))
        }
        Event::PostProcessed => "whole mesh cleaned up and smoothed".to_owned(),
        Event::Mirrored { quads, nodes, on_line } => format!(
            "mirror image added: {}, {}; {on_line} on the mirror line",
            count(quads, "quadrilateral"),
            count(nodes, "node")
        ),
        Event::Finished => "done".to_owned(),
    }
}

/// Why an attempt was taken back.
pub fn why_rolled_back(why: Why) -> String {
    match why {
        Why::NoSide(side) => format!("no edge fits the {} side", name(side)),
        Why::NoDivision(side) => {
            format!("the {} side cannot be divided: it is dead or too short, or its middle is not valid", name(side))
        }
        Why::TopBlocked(ends) => format!("dead edge {} lies across the top", edge(ends)),
        Why::TopThroughNode(node) => format!("node {} lies on the top edge", node.0),
        Why::TopTooLong => "too many edges cross the top edge, or too many changes are needed".to_owned(),
        Why::TopStuck => "no swap helps among the edges across the top edge, and no node there can go".to_owned(),
        Why::TooLong(length) => format!("a new side or the top is too long: {}", fixed(length, 2)),
        Why::NotDisc => "the four sides do not enclose a disc of live triangles".to_owned(),
        Why::NotConvex => "it would not be strictly convex".to_owned(),
        Why::Poor(quality) => format!("its quality would be only {}", fixed(quality, 2)),
        Why::OddLoop(segments) => format!("a loop would become odd, with {segments} segments"),
        Why::NoMetric => "the field gives no metric at a new node".to_owned(),
    }
}

/// Why two nodes of the front were not joined.
pub(super) fn why_unmerged(why: Unmerged) -> String {
    match why {
        Unmerged::BothFixed => "both nodes are fixed".to_owned(),
        Unmerged::Unlike => "the longer segment cannot be divided".to_owned(),
        Unmerged::Doublet => "a node would be left with two edges".to_owned(),
        Unmerged::NotRecovered => "the edge between the ends cannot be recovered".to_owned(),
        Unmerged::NotEmpty => "something lies between the two segments".to_owned(),
        Unmerged::NotPositive => "an element would be turned over".to_owned(),
        Unmerged::Poor { quality, least } => {
            let [quality, least] = apart(quality, least);
            format!("an element would have quality {quality}, and {least} is the least allowed")
        }
    }
}
