//! A quadrilateral that was formed (docs/algorithm.md, "Formation"), in sentences: where its tops were placed and by
//! which rule, and what it had to pass.

use glam::DVec2;

use super::numbers::{apart, edge, value};
use super::side::name;
use crate::core::convert::{Aim, Base, LookedAt, Stays};
use crate::core::front::Side;
use crate::core::kernel::number::{decimals, degrees, fixed, grouped};
use crate::core::mesh::{ElementId, Mesh, NodeId};
use crate::core::metric::measure::angle;

/// How its tops were placed, its shape, what is new on the front, and the loops through it; `mesh` is that after it.
pub(super) fn formation(element: ElementId, attempt: u8, before: &LookedAt, mesh: &Mesh, loops: &[u32]) -> Vec<String> {
    let (Some(base), Some(tops)) = (&before.base, &before.tops) else { return Vec::new() };
    let [a, b, d, c] = mesh.quad(element);
    let mut sentences = Vec::new();
    if let Some(tried) = before.attempt.filter(|_| attempt > 0) {
        sentences.push(format!("It is attempt {}: {}.", u32::from(attempt) + 1, super::attempt(&tried)));
    }
    // The left top is placed first, while the right one is where it was.
    let others = [tops[1].0, mesh.uv(c)];
    for (side, top) in [(Side::Left, c), (Side::Right, d)] {
        let (here, aim) = &tops[side.index()];
        let placed = Placed { mesh, base, side, top, here: *here, other: others[side.index()] };
        sentences.push(match aim {
            Ok(aim) => placed.by(aim),
            Err(stays) => placed.stays(*stays, before),
        });
    }
    let corners = [[a, b, c], [b, d, a], [d, c, b], [c, a, d]];
    let angles = corners.map(|[at, next, last]| {
        let p = mesh.uv(at);
        degrees(angle(mesh.metric_ref(at), mesh.uv(next) - p, mesh.uv(last) - p))
    });
    let names = [a, b, d, c].map(|n| n.0.to_string()).join(", ");
    sentences.push(format!("It is strictly convex, with angles of {}\u{b0} at {names}.", angles.join(", ")));
    let [gates, _] = before.gates;
    let [quality, least] = apart(mesh.quality(element), gates.quality);
    let sides = [[a, c], [b, d], [c, d]].into_iter().filter(|ends| mesh.is_front_edge(ends[0], ends[1]));
    let lengths: Vec<String> =
        sides.map(|ends| format!("{} {}", edge(ends), fixed(mesh.distance(ends[0], ends[1]), 3))).collect();
    let lengths = match lengths.is_empty() {
        true => "it leaves no edge on the front".to_owned(),
        false => format!("new on the front, and at most {} long: {}", fixed(gates.length, 1), lengths.join(", ")),
    };
    sentences.push(format!("Its quality is {quality}, not below {least}; {lengths}."));
    if !loops.is_empty() {
        let loops: Vec<String> = loops.iter().map(|n| grouped(u64::from(*n))).collect();
        sentences.push(format!("Loops of the front through it: {} segments, all even.", loops.join(", ")));
    }
    sentences
}

/// What a quadrilateral must pass beside being convex.
pub(super) fn gates(before: &LookedAt) -> String {
    let [gates, wide] = before.gates;
    let pass = if gates == wide { " (second pass)" } else { "" };
    format!(
        "It needs a quality of {}, and what is new on the front may be {} long in the metric{pass}.",
        gates.quality,
        fixed(gates.length, 1)
    )
}

/// A top node after the formation, and where it was before.
struct Placed<'a> {
    mesh: &'a Mesh,
    base: &'a Base,
    side: Side,
    top: NodeId,
    here: DVec2,
    /// The other top, when this one was placed.
    other: DVec2,
}

impl Placed<'_> {
    /// It stays where it was, and why.
    fn stays(&self, stays: Stays, before: &LookedAt) -> String {
        let why = match stays {
            Stays::OnFront => "it was on the front already".to_owned(),
            Stays::InCutGrid => "it belongs to a grid of the background that was cut into triangles".to_owned(),
            Stays::SwitchedOff => value(&before.parameters, "placement"),
            Stays::Fixed => "it is fixed".to_owned(),
            Stays::NoMetric => "the field gives no metric where it would go".to_owned(),
        };
        format!("The {} stays where it was: {why}. {}", self.name(), self.measures())
    }

    /// It was placed between two places, as far as what is around stays valid.
    fn by(&self, aim: &Aim) -> String {
        let there = aim.place(self.other);
        let (wanted, moved) = (there - self.here, self.mesh.uv(self.top) - self.here);
        let way = if wanted == DVec2::ZERO { 1.0 } else { moved.length() / wanted.length() };
        // Steps are halved; what is between them is rounding.
        let way = match way {
            way if way > 0.75 => "all the way",
            way if way > 0.375 => "half of the way, since what is around does not allow more",
            way if way > 0.1875 => "a quarter of the way, since what is around does not allow more",
            way if way > 0.0625 => "an eighth of the way, since what is around does not allow more",
            _ => "not at all, since what is around does not allow it",
        };
        if let Some(row) = aim.row {
            return format!(
                "The {} aims at {}: on the normal of the wall, at the height of row {row} from there. It went there \
                 from {} {way}. {}",
                self.name(),
                self.at(there),
                self.at(self.here),
                self.measures()
            );
        }
        let percent = fixed(100.0 * aim.share, 1);
        let length = fixed(self.base.length, 3);
        format!(
            "The {} aims at {}: between the place at unit length along the target of {}\u{b0}, {}, and the corner of \
             the parallelogram, {}, with a share of {percent} % for the latter by l_{{AB}} = {length}. It went there \
             from {} {way}. {}",
            self.name(),
            self.at(there),
            degrees(aim.target),
            self.at(aim.unit),
            self.at(self.other + aim.along_base),
            self.at(self.here),
            self.measures()
        )
    }

    fn name(&self) -> String {
        format!("{} top, node {},", name(self.side), self.top.0)
    }

    /// The side that ends there: its angle with the base and its length.
    fn measures(&self) -> String {
        let (mesh, from) = (self.mesh, self.base.node(self.side));
        let p = mesh.uv(from);
        let (along, up) = (mesh.uv(self.base.node(self.side.other())) - p, mesh.uv(self.top) - p);
        let theta = match self.side {
            Side::Left => angle(mesh.metric_ref(from), along, up),
            Side::Right => angle(mesh.metric_ref(from), up, along),
        };
        format!("Its side is {} long, {}\u{b0} from the base.", fixed(mesh.distance(from, self.top), 3), degrees(theta))
    }

    /// A place in the parametric plane, with four digits of the base or of the side, whichever is shorter.
    fn at(&self, p: DVec2) -> String {
        let from = self.mesh.uv(self.base.node(self.side));
        let ends = [self.mesh.uv(self.base.node(self.side.other())), self.mesh.uv(self.top)];
        let decimals = decimals(ends.map(|end| from.distance(end)).into_iter()) + 1;
        format!("({}, {})", fixed(p.x, decimals), fixed(p.y, decimals))
    }
}
