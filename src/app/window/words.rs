//! Numbers and events in words, as everywhere in the window: integers grouped by thin spaces, a true minus, an en dash
//! for what is not defined.

use super::session::words_of;
use super::state::Progress;
use crate::core::convert::{Candidate, Candidates, Event, EventKind, Mending, Passed, Purpose, Why};
use crate::core::front::Side;
use crate::core::mesh::NodeId;
use crate::core::progress::Stage;
use crate::render::scene::Outlined;

pub use crate::render::number::{UNDEFINED, decimals, degrees, fixed, grouped, size};

/// The progress of some work.
pub fn progress(progress: &Progress) -> String {
    let Progress { words, done, total } = *progress;
    // These stages count bytes, or steps of unequal length.
    if total > 0 && [Stage::Read, Stage::Repair].map(words_of).contains(&words) {
        format!("{words}: {} %", 100 * done.min(total) / total)
    } else if total > 0 {
        format!("{words} {} of about {}", grouped(done), grouped(total.max(done)))
    } else {
        words.to_owned()
    }
}

/// A front segment by its nodes.
pub fn segment(a: NodeId, b: NodeId) -> String {
    format!("{} → {}", a.0, b.0)
}

/// An edge by its nodes.
pub fn edge([a, b]: [NodeId; 2]) -> String {
    format!("{}–{}", a.0, b.0)
}

/// The name of something that can be selected.
pub fn thing(what: Outlined) -> String {
    match what {
        Outlined::Node(node) => format!("node {}", node.0),
        Outlined::Edge(ends) => format!("edge {}", edge(ends)),
        Outlined::Element(element) => format!("element {}", element.0),
    }
}

/// A side.
pub fn side(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}

/// The name of a kind of event.
pub fn kind(kind: EventKind) -> String {
    kind.name().replace('_', " ")
}

/// What a step did, in one line.
pub fn event(event: &Event) -> String {
    match *event {
        Event::BaseSelected { a, b, class, h_value, .. } => {
            format!("base selected: {}, class {class}, H {}", segment(a, b), size(h_value))
        }
        Event::PickLost { a, b } => format!("{} was chosen as base, but is no longer on the front", segment(a, b)),
        Event::SideIsFront { side: s, node } => format!("{} side is the front, to node {}", side(s), node.0),
        Event::SideChosen { edge } => {
            let off = degrees(edge.deviation);
            format!("{} side chosen: node {}, {off}° off the target direction", side(edge.side), edge.node.0)
        }
        Event::SideSwapped { edge, .. } => {
            let off = degrees(edge.deviation);
            format!("{} side made by a swap: node {}, {off}° off the target direction", side(edge.side), edge.node.0)
        }
        Event::SideDivided { side: s, node, length } => {
            format!("{} side divided at new node {}; it was {} long", side(s), node.0, fixed(length, 2))
        }
        Event::TopSwapped { across, new } => format!("top: {} swapped for {}", edge(across), edge(new)),
        Event::TopSmoothed { nodes } => format!("{nodes} nodes smoothed around the left top"),
        Event::TopFound { ends, swaps } => match swaps {
            0 => format!("top edge found: {}", edge(ends)),
            1 => format!("top edge found: {}, after 1 swap", edge(ends)),
            _ => format!("top edge found: {}, after {swaps} swaps", edge(ends)),
        },
        Event::NodeRemoved { node, purpose: Purpose::Recovery } => {
            format!("node {} removed to clear the way for the top", node.0)
        }
        Event::NodeRemoved { node, purpose: Purpose::Enhancement } => format!("node {} of low valence removed", node.0),
        Event::Formed { element, quality, merged, swallowed, .. } => {
            let inside: Vec<String> = swallowed.iter().map(|node| node.0.to_string()).collect();
            let with = if inside.is_empty() { String::new() } else { format!(", with node {}", inside.join(", ")) };
            format!(
                "quadrilateral {} formed: quality {}, {merged} triangles merged{with}",
                element.0,
                fixed(quality, 2)
            )
        }
        Event::RolledBack { attempt, why: reason } => {
            format!("attempt {} rolled back: {}", u32::from(attempt) + 1, why(reason))
        }
        Event::Deferred { a, b } => format!("segment {} deferred", segment(a, b)),
        Event::Enhanced { new } => format!("edge {} made by a swap beside the new quadrilateral", edge(new)),
        Event::Smoothed { nodes } => format!("{nodes} nodes smoothed"),
        Event::Seamed { at, node, angle, .. } => {
            format!("seam at node {}: {}° closed, ends joined in node {}", at.0, degrees(angle), node.0)
        }
        Event::TransitionSeamed { at, node, angle, ratio, .. } => format!(
            "transition seam at node {}: {}° closed, one side {} times the other, joined in node {}",
            at.0,
            degrees(angle),
            fixed(ratio, 1),
            node.0
        ),
        Event::SeamRefused { at, angle, .. } => {
            format!("no seam at node {} of {}°: its ends cannot be joined", at.0, degrees(angle))
        }
        Event::Split { node, .. } => format!("front split at node {}", node.0),
        Event::Closed { segments, quads, quality } => {
            format!("loop of {segments} segments closed by {quads} quadrilaterals, worst quality {}", fixed(quality, 2))
        }
        Event::SecondPass => "all segments are deferred: second pass with wider tolerances".to_owned(),
        Event::Matched { triangles, unmatched, .. } => format!(
            "last resort: {} triangles paired, {} without a partner",
            grouped(triangles as u64),
            grouped(unmatched as u64)
        ),
        Event::Patched { triangles, quads, element, .. } => {
            format!("last resort: {quads} quadrilaterals of {triangles} triangles, from element {}", element.0)
        }
        Event::Cleaned { energy: [before, after], .. } => {
            format!("mesh structure cleaned up locally: energy {} to {}", size(before), size(after))
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
        Event::Swept { looked, moved } => format!("{moved} of {looked} nodes smoothed by the energy"),
        Event::LastResort(outcome) => format!("last resort: {} triangles left", grouped(outcome.triangles as u64)),
        Event::PostProcessed => "whole mesh cleaned up and smoothed".to_owned(),
        Event::Finished => "done".to_owned(),
    }
}

/// Why an edge is not the side.
pub fn passed(passed: Passed, candidate: &Candidate, tried: &Candidates) -> String {
    match passed {
        Passed::Taken => "ends at a corner in use".to_owned(),
        Passed::WideAngle => "front, but not below \u{3b8}rect".to_owned(),
        Passed::SmallAngle => "the front is the side".to_owned(),
        Passed::LaidDown => "not used in this attempt".to_owned(),
        Passed::Farther if candidate.deviation > tried.limit => format!("more than {}°", degrees(tried.limit)),
        Passed::Farther => "another is nearer".to_owned(),
        Passed::NotNeeded => "no swap is needed".to_owned(),
        Passed::NotPositive => "it would fold over".to_owned(),
    }
}

/// Why an attempt was taken back.
pub fn why(why: Why) -> String {
    match why {
        Why::NoSide(s) => format!("no edge fits the {} side", side(s)),
        Why::NoDivision(s) => format!("the {} side cannot be divided at the required point", side(s)),
        Why::TopBlocked(ends) => format!("dead edge {} lies across the top", edge(ends)),
        Why::TopThroughNode(node) => format!("node {} lies on the top edge", node.0),
        Why::TopTooLong => "the top edge needs too many swaps".to_owned(),
        Why::TopStuck => "no swap helps among the edges across the top edge, and no node there can go".to_owned(),
        Why::TooLong(length) => format!("a new side or the top is too long: {}", fixed(length, 2)),
        Why::NotDisc => "the four sides do not enclose a disc of live triangles".to_owned(),
        Why::NotConvex => "it would not be strictly convex".to_owned(),
        Why::Poor(quality) => format!("its quality would be only {}", fixed(quality, 2)),
        Why::OddLoop(segments) => format!("a loop would become odd, with {segments} segments"),
        Why::NoMetric => "the field gives no metric at a new node".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_and_have_true_minus_signs() {
        assert_eq!(grouped(7), "7");
        assert_eq!(grouped(1267), "1\u{2009}267");
        assert_eq!(grouped(1_234_567), "1\u{2009}234\u{2009}567");
        assert_eq!(fixed(-45.04, 1), "−45.0");
        assert_eq!(fixed(-0.01, 1), "0.0");
        assert_eq!(fixed(f64::NAN, 2), "–");
    }

    #[test]
    fn sizes_have_three_digits_and_powers_only_where_they_must() {
        assert_eq!(size(0.022_43), "0.0224");
        assert_eq!(size(0.3978), "0.3978");
        assert_eq!(size(12.345), "12.35");
        assert_eq!(size(-1.5e-6), "−1.50e−6");
        assert_eq!(decimals([0.0224, 0.1, 3.0].into_iter()), 4);
        assert_eq!(decimals([12.0, 150.0].into_iter()), 1);
        assert_eq!(decimals(std::iter::empty()), 4);
    }
}
