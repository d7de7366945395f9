//! What a step did, in one sentence for a reader who sees it for the first time: what was done, with its numbers, and
//! what it means. Every number is the event's, or names a node of its base.

use super::event::{why_rolled_back, why_unmerged};
use super::numbers::{apart, capital, count, edge, segment};
use super::side::name;
use crate::core::case::Selection;
use crate::core::convert::{Cleaning, Event, Means, Mending, Purpose, SideEdge};
use crate::core::front::Side;
use crate::core::kernel::number::{degrees, fixed, grouped, size};
use crate::core::mesh::{Mesh, NodeId};

/// Tells the steps of a run one after another: it knows the base under way.
#[derive(Clone, Copy, Debug, Default)]
pub struct Narrator {
    base: Option<[NodeId; 2]>,
}

impl Narrator {
    /// Takes in what a step did; it has to be told of every selection of a base.
    pub fn note(&mut self, event: &Event) {
        if let Event::BaseSelected { a, b, .. } = *event {
            self.base = Some([a, b]);
        }
    }

    /// Tells what the step that was taken in last did, in a sentence (see [`narration`]).
    pub fn tell(&self, event: &Event) -> String {
        narration(event, self.base)
    }
}

/// The state before the first step, in a sentence.
pub fn beginning(mesh: &Mesh) -> String {
    match mesh.elements().filter(|&e| mesh.is_quad(e)).count() {
        0 => "Nothing is converted yet: the front is the boundary of the mesh.".to_owned(),
        quads => format!(
            "{} there already: the front is the boundary of what is left.",
            capital(&are(quads, "quadrilateral"))
        ),
    }
}

/// Tells what a step did in a sentence; `base` is the base of the quadrilateral under way, where there is one.
pub fn narration(event: &Event, base: Option<[NodeId; 2]>) -> String {
    let told = match *event {
        Event::BaseSelected { .. } | Event::PickLost { .. } | Event::Deferred { .. } => selection(event),
        Event::SideIsFront { .. }
        | Event::SideChosen { .. }
        | Event::SideSwapped { .. }
        | Event::SideDivided { .. } => side(event, base),
        Event::TopSwapped { .. } | Event::TopSmoothed { .. } | Event::TopFound { .. } => top(event),
        Event::NodeRemoved { node, purpose: Purpose::Recovery } => {
            format!("top: node {} stood in the way of the top edge, so it is removed", node.0)
        }
        Event::NodeRemoved { node, purpose: Purpose::Enhancement } => format!(
            "beside the new quadrilateral node {} has only three or four triangles, too few for good quadrilaterals, \
             so it is removed",
            node.0
        ),
        Event::Formed { .. } => formed(event),
        Event::RolledBack { attempt, why } => format!(
            "attempt {} fails: {}; all that it changed is taken back",
            u32::from(attempt) + 1,
            why_rolled_back(why)
        ),
        Event::Enhanced { new } => format!(
            "beside the new quadrilateral a swap makes the edge {}, since the largest angle of the two triangles \
             becomes smaller",
            edge(new)
        ),
        Event::Smoothed { nodes: 0 } => "around the new quadrilateral smoothing moves no node".to_owned(),
        Event::Smoothed { nodes } => format!(
            "around the new quadrilateral {} moved to better places, so that the front can go on from there",
            are(nodes.into(), "node")
        ),
        Event::Seamed { .. } | Event::TransitionSeamed { .. } | Event::SeamRefused { .. } => seam(event),
        Event::Split { .. } | Event::SplitRefused { .. } => split(event),
        Event::Closed { segments, quads: 0, quality } => format!(
            "a small loop of {segments} segments is closed without a new quadrilateral: its sides are joined, and the \
             worst element there has quality {}",
            fixed(quality, 2)
        ),
        Event::Closed { segments, quads, quality } => format!(
            "a small loop of {segments} segments is filled with {} at once; the worst element there has quality {}",
            count(quads.into(), "quadrilateral"),
            fixed(quality, 2)
        ),
        Event::SecondPass => {
            "every segment of the front is deferred, so all are tried once more with wider tolerances".to_owned()
        }
        Event::Matched { .. } | Event::Patched { .. } | Event::LastResort(_) => last_resort(event),
        Event::Cleaned { what, energy } => cleaned(what, energy),
        Event::Refilled { .. } => refilled(event),
        Event::RowLaid { row, nodes, laid, lean } => format!(
            "of {} in row {row} from the walls, {} on the normal of the wall at the height that the boundary layer asks \
             for; the edges to them leaned {}\u{b0} from the normals on average, and lean {}\u{b0} now",
            count(nodes as usize, "node"),
            if laid == 1 { "1 stands".to_owned() } else { format!("{} stand", grouped(laid.into())) },
            degrees(lean[0]),
            degrees(lean[1])
        ),
        Event::Swept { looked, moved } => format!(
            "of {} that may move, {} to places where the mesh has a lower energy",
            count(looked as usize, "node"),
            moved_nodes(moved)
        ),
        Event::Unfolded { element, how, .. } => format!(
            "quadrilateral {} had folded over the surface; {}, and now it lies flat",
            element.0,
            match how {
                Mending::Moved => "its corners were moved".to_owned(),
                Mending::Rotated { new } => format!("an edge of it was rotated to {}", edge(new)),
                Mending::Collapsed { kept } => format!("two opposite corners were merged into node {}", kept.0),
                Mending::Pillowed { .. } => "a smaller quadrilateral was put inside it".to_owned(),
            }
        ),
        Event::FaceConverted { region } => {
            format!("face {} has only quadrilaterals now, so the next face can be converted", region + 1)
        }
        Event::PostProcessed => "the clean-up and the smoothing of all quadrilaterals are finished".to_owned(),
        Event::Mirrored { quads, nodes, on_line } => format!(
            "the other half of the domain is filled with the mirror image of this one, {} and {}; the two halves share \
             {} on the mirror line",
            count(quads, "quadrilateral"),
            count(nodes, "node"),
            count(on_line, "node")
        ),
        Event::Finished => "the conversion is finished".to_owned(),
    };
    format!("{}.", capital(&told))
}

/// The selection of a base (4.3.3, table 1), and what became of one that was chosen or could not be converted.
fn selection(event: &Event) -> String {
    match *event {
        Event::BaseSelected { a, b, selection, picked, .. } if selection != Selection::Table1 => {
            let order = order(event);
            match picked {
                true => {
                    format!("segment {}, which you chose, is the base; the rules order by {order}", segment([a, b]))
                }
                false => format!("segment {} is the next base, first in the order by {order}", segment([a, b])),
            }
        }
        Event::BaseSelected { a, b, class, theta: [at_a, at_b], key, reach, picked, .. } => {
            let [at_a, at_b] = [at_a, at_b].map(degrees);
            let rect = "\u{3b8}_{rect}";
            let why = match class {
                1 => format!("both frontal angles, {at_a}\u{b0} and {at_b}\u{b0}, are below {rect}"),
                2 => format!("only the frontal angle at A, {at_a}\u{b0}, is below {rect}"),
                3 => format!("only the frontal angle at B, {at_b}\u{b0}, is below {rect}"),
                _ => format!("neither frontal angle, {at_a}\u{b0} nor {at_b}\u{b0}, is below {rect}"),
            };
            let by = if picked { "which you chose, is the base" } else { "is the next base" };
            let lies = if key < reach { "below" } else { "not below" };
            let [key, reach] = apart(key, reach);
            format!(
                "segment {} {by}: class {class}, since {why}; its key {key} is {lies} the reach {reach}",
                segment([a, b])
            )
        }
        Event::PickLost { a, b } => format!(
            "segment {}, which you chose as the base, is no longer on the front, so the rules select one",
            segment([a, b])
        ),
        Event::Deferred { a, b } => format!(
            "every attempt at a quadrilateral on {} failed, so this segment waits until something near it changes",
            segment([a, b])
        ),
        _ => String::new(),
    }
}

/// By what a rule other than table 1 orders the segments (4.3.3), and what the base has of it.
fn order(event: &Event) -> String {
    let Event::BaseSelected { theta, level, length_metric, length_physical, selection, .. } = *event else {
        return String::new();
    };
    let [at_a, at_b] = theta.map(degrees);
    match selection {
        Selection::Shortest | Selection::Table1 => format!("length in space, here {}", size(length_physical)),
        Selection::SmallestAngle => format!("the sum of both frontal angles, here {at_a}\u{b0} and {at_b}\u{b0}"),
        Selection::Level => format!(
            "state, row and metric length: here frontal angles of {at_a}\u{b0} and {at_b}\u{b0}, row {level} from the \
             boundary, and length {}",
            size(length_metric)
        ),
    }
}

/// A side edge: that of the front, an edge that was there, or one that a swap made; and its division (4.3.4).
fn side(event: &Event, base: Option<[NodeId; 2]>) -> String {
    // The edge by its nodes where the base is known, otherwise by its top.
    let edge_to = |side: Side, top: NodeId| match base {
        Some(ends) => edge([ends[side.index()], top]),
        None => format!("to node {}", top.0),
    };
    let found = |found: &SideEdge| {
        let SideEdge { side, node, angle, deviation } = *found;
        let [angle, off] = [angle, deviation].map(degrees);
        (name(side), edge_to(side, node), angle, off)
    };
    match *event {
        Event::SideIsFront { side, node } => format!(
            "{} side: the angle to the neighbouring segment of the front, {}, is below \u{3b8}_{{rect}}, so this \
             serves as it is",
            name(side),
            edge_to(side, node)
        ),
        Event::SideChosen { edge } => {
            let (which, text, angle, off) = found(&edge);
            format!(
                "{which} side: the edge {text}, at {angle}\u{b0} with the base, is {off}\u{b0} off the direction aimed \
                 at and is taken"
            )
        }
        Event::SideSwapped { edge, instead_of } => {
            let (which, text, angle, off) = found(&edge);
            let best = match instead_of {
                Some(best) => format!("while the best edge before was {}\u{b0} off", degrees(best)),
                None => "where no edge was to be had".to_owned(),
            };
            format!(
                "{which} side: a swap makes the edge {text}, at {angle}\u{b0} with the base and {off}\u{b0} off the \
                 direction aimed at, {best}"
            )
        }
        Event::SideDivided { side, node, length } => format!(
            "{} side: the edge is {} long in the metric, so it is divided at the new node {}",
            name(side),
            fixed(length, 2),
            node.0
        ),
        _ => String::new(),
    }
}

/// The recovery of the top edge (4.3.4).
fn top(event: &Event) -> String {
    match *event {
        Event::TopSwapped { across, new } => {
            format!("top: the edge {} lies across the top edge, so it is swapped for {}", edge(across), edge(new))
        }
        Event::TopSmoothed { nodes: 0 } => "top: after the swap smoothing moves no node around the left top".to_owned(),
        Event::TopSmoothed { nodes } => {
            format!("top: after the swap {} moved to better places around the left top", are(nodes.into(), "node"))
        }
        Event::TopFound { ends, swaps: 0 } => {
            format!("top: the edge {} is there already, so all four sides are known", edge(ends))
        }
        Event::TopFound { ends, swaps } => format!(
            "top: after {} the edge {} is there, so all four sides are known",
            count(swaps.into(), "change"),
            edge(ends)
        ),
        _ => String::new(),
    }
}

/// The formation of a quadrilateral.
fn formed(event: &Event) -> String {
    let Event::Formed { element, nodes: [a, b, d, c], quality, merged, ref swallowed, .. } = *event else {
        return String::new();
    };
    let inside: Vec<String> = swallowed.iter().map(|node| node.0.to_string()).collect();
    let gone = match &*inside {
        [] => String::new(),
        [node] => format!("; node {node} between them goes with them"),
        nodes => format!("; nodes {} between them go with them", nodes.join(", ")),
    };
    format!(
        "the {} between nodes {}, {}, {} and {} become quadrilateral {}, of quality {}, and the front moves on to its \
         other side{gone}",
        count(merged.into(), "triangle"),
        a.0,
        b.0,
        d.0,
        c.0,
        element.0,
        fixed(quality, 2)
    )
}

/// Two segments of the front that make a small angle (4.3.6, fig. 18).
fn seam(event: &Event) -> String {
    match *event {
        Event::Seamed { at, node, corner, .. } => format!(
            "seam: the two segments at node {} make only {}\u{b0}, so they become one edge to node {}",
            at.0,
            degrees(corner.angle),
            node.0
        ),
        Event::TransitionSeamed { at, node, corner, .. } => format!(
            "seam: the two segments at node {} make only {}\u{b0}, but one is {} times as long as the other, so the \
             longer one is divided first, and then they become one edge to node {}",
            at.0,
            degrees(corner.angle),
            fixed(corner.ratio, 1),
            node.0
        ),
        Event::SeamRefused { at, corner, why, .. } => format!(
            "no seam: the two segments at node {} make only {}\u{b0}, but they stay apart, since {}",
            at.0,
            degrees(corner.angle),
            why_unmerged(why)
        ),
        _ => String::new(),
    }
}

/// A narrow region, in which two nodes of the front become one (4.3.6, fig. 19).
fn split(event: &Event) -> String {
    match *event {
        Event::Split { node, gone, segments: [first, second], .. } => format!(
            "split: the front is narrow here, so node {} is joined to node {}, and the loop becomes two, of {first} \
             and {second} segments",
            gone.0, node.0
        ),
        Event::SplitRefused { slender, why, .. } => {
            let there = match slender {
                1 => "1 slender triangle lies".to_owned(),
                n => format!("{n} slender triangles lie"),
            };
            let why = why.map_or("no side of it leaves two even loops".to_owned(), why_unmerged);
            format!("no split: {there} across a narrow part of the front, but the front stays whole, since {why}")
        }
        _ => String::new(),
    }
}

/// What the front leaves over.
fn last_resort(event: &Event) -> String {
    match *event {
        Event::Matched { triangles, unmatched, .. } => format!(
            "last resort: the front can go no further, so {} left over are paired, and {} without a partner",
            count(triangles, "triangle"),
            match unmatched {
                0 => "none remains".to_owned(),
                1 => "1 remains".to_owned(),
                n => format!("{} remain", grouped(n as u64)),
            }
        ),
        Event::Patched { means, triangles, quads, .. } => {
            let [triangles, quads] = [(triangles, "triangle"), (quads, "quadrilateral")].map(|(n, one)| count(n, one));
            match means {
                Means::Merge => format!("last resort: {triangles} are merged into {quads}"),
                Means::Recut => format!("last resort: {triangles} are cut anew into {quads}"),
                Means::Templates => {
                    format!("last resort: edges are divided, and templates make {quads} of {triangles}")
                }
            }
        }
        Event::LastResort(outcome) if outcome.triangles == 0 => {
            "last resort: the front has left nothing over, so there is nothing to do".to_owned()
        }
        Event::LastResort(outcome) => {
            format!("last resort: all {} left over are quadrilaterals now", count(outcome.triangles, "triangle"))
        }
        _ => String::new(),
    }
}

/// A change of the structure in the clean-up (4.3.7).
fn cleaned(what: Cleaning, energy: [f64; 2]) -> String {
    let done = match what {
        Cleaning::DiamondCollapsed { gone, kept } => {
            format!("two opposite corners of a quadrilateral are merged, node {} into node {}", gone.0, kept.0)
        }
        Cleaning::EdgeRotated { old, new } => {
            format!("the edge {} between two quadrilaterals is rotated to {}", edge(old), edge(new))
        }
        Cleaning::VertexOpened { node, new, .. } => {
            format!("a quadrilateral is opened between node {} and the new node {}", node.0, new.0)
        }
        Cleaning::DoubletRemoved { node } => {
            format!("node {}, which has only two edges, is removed with the quadrilaterals beside it made one", node.0)
        }
    };
    format!("clean-up: {done}, and the energy of the place {}", falls(energy))
}

/// A part of the mesh that the clean-up filled anew (4.3.7).
fn refilled(event: &Event) -> String {
    let Event::Refilled { quads: [old, new], irregular: [from, to], energy, .. } = *event else { return String::new() };
    format!(
        "clean-up: a cavity is filled with {} instead of {old}, with {} instead of {from}, and the energy of the place \
         {}",
        count(new as usize, "quadrilateral"),
        count(to as usize, "irregular node"),
        falls(energy)
    )
}

/// How an energy changed.
fn falls([before, after]: [f64; 2]) -> String {
    let [from, to] = apart(before, after);
    let how = if after < before { "falls" } else { "goes" };
    format!("{how} from {from} to {to}")
}

/// So many things, and what they did: `2 nodes are`.
fn are(n: usize, one: &str) -> String {
    format!("{} {}", count(n, one), if n == 1 { "is" } else { "are" })
}

/// So many nodes that moved.
fn moved_nodes(moved: u32) -> String {
    match moved {
        0 => "none moves".to_owned(),
        1 => "1 moves".to_owned(),
        n => format!("{} move", grouped(n.into())),
    }
}
