//! Sides (4.3.4, definition of left and right side edges, ii to vi).

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

use quadfront::core::case::{DivisionAt, Parameters};
use quadfront::core::convert::{Attempt, Base, Converter, Event, Phase};
use quadfront::core::front::Side;
use quadfront::core::mesh::{Mesh, NodeId};

use crate::oracle::{Oracle, angle, norm};

/// How many sides were held against the oracle, by how they come to be.
#[derive(Debug, Default)]
pub struct Sides {
    pub front: usize,
    pub edge: usize,
    pub swap: usize,
    pub divided: usize,
    /// Long sides that stay whole, since the halves would not be valid.
    pub indivisible: usize,
    /// The side at hand, and whether it has to be divided.
    at_hand: Option<Top>,
}

/// A side that is there.
#[derive(Debug)]
struct Top {
    ends: [NodeId; 2],
    length: f64,
    divides: bool,
}

/// What the formulas say of a side.
#[derive(Debug)]
pub struct Expected {
    base: Base,
    attempt: Attempt,
    side: Side,
    /// The front segment, where the frontal angle is small.
    front: Option<NodeId>,
    /// Deviation of each edge of the sector, from the direction aimed at.
    edges: BTreeMap<NodeId, f64>,
    /// The same of each line that a swap would give: certain to be possible (true), or only just.
    swaps: BTreeMap<NodeId, (f64, bool)>,
}

/// Twice the area of a triangle over the square of its longest side.
fn flatness(mesh: &Mesh, n: [NodeId; 3]) -> f64 {
    let [a, b, c] = n.map(|n| mesh.uv(n));
    let longest = [a - b, b - c, c - a].iter().map(|d| d.length_squared()).fold(0.0, f64::max);
    (b - a).perp_dot(c - a) / longest
}

/// What is to come of the side that this state prepares; none where it prepares none.
pub fn expected(state: &Converter<'_>) -> Option<Expected> {
    let Phase::PrepareSide { base, attempt, side, left } = *state.phase() else { return None };
    let (mesh, parameters) = (&state.mesh, state.parameters());
    let oracle = Oracle { mesh };
    let (at, other) = if side == Side::Left { (base.a, base.b) } else { (base.b, base.a) };
    // The triangles of the sector, from the base on, as the side before, the next one, and the edge between them.
    let mut corners: BTreeMap<NodeId, NodeId> = BTreeMap::new();
    let mut beyond: BTreeMap<[NodeId; 2], NodeId> = BTreeMap::new();
    for e in mesh.elements().filter(|&e| mesh.is_triangle(e)) {
        let n = mesh.triangle(e);
        for k in 0..3 {
            let [p, q, r] = [n[k], n[(k + 1) % 3], n[(k + 2) % 3]];
            beyond.insert([p, q], r);
            if p == at {
                if side == Side::Left {
                    corners.insert(q, r)
                } else {
                    corners.insert(r, q)
                };
            }
        }
    }
    let mut spokes = vec![other];
    while let Some(&next) = corners.get(spokes.last()?) {
        spokes.push(next);
    }
    let theta = base.theta[side.index()];
    let widest = 1.25 * PI;
    let target = if parameters.bisector && theta <= widest { 0.5 * theta } else { FRAC_PI_2 };
    let p = mesh.uv(at);
    let deviation = |n: NodeId| {
        let (along, up) = (mesh.uv(other) - p, mesh.uv(n) - p);
        let m = oracle.metric(at);
        let turned = if side == Side::Left { angle(m, along, up) } else { angle(m, up, along) };
        (turned - target).abs()
    };
    let may_be = |n: &NodeId| *n != base.a && *n != base.b && Some(*n) != left;
    let front = (theta < parameters.theta_rect).then(|| *spokes.last().unwrap());
    let edges = spokes[1..spokes.len() - 1].iter().copied().filter(may_be).map(|n| (n, deviation(n))).collect();
    let mut swaps = BTreeMap::new();
    for pair in spokes.windows(2) {
        let [q, r] = if side == Side::Left { [pair[0], pair[1]] } else { [pair[1], pair[0]] };
        let Some(&far) = beyond.get(&[r, q]) else { continue };
        let least = flatness(mesh, [at, q, far]).min(flatness(mesh, [at, far, r]));
        if may_be(&far) && least > 0.0 {
            let is_certain = least > 1e-6 && !mesh.are_joined(at, far);
            swaps.insert(far, (deviation(far), is_certain));
        }
    }
    Some(Expected { base, attempt, side, front, edges, swaps })
}

/// The arc cosine loses half of the digits near a straight angle.
const EXACT: f64 = 1e-7;

impl Sides {
    /// Holds what came of a side against what was expected.
    pub fn examine(&mut self, expected: Option<Expected>, state: &Converter<'_>, event: &Event) {
        self.division(state, event);
        let Some(Expected { base, attempt, side, front, edges, swaps }) = expected else { return };
        // Tops that are laid down are not chosen.
        if attempt.tops[side.index()].is_some() || attempt.divide[side.index()] {
            return;
        }
        let parameters = state.parameters();
        let best_edge = edges.values().copied().fold(f64::INFINITY, f64::min);
        let best_swap = swaps.values().filter(|s| s.1).map(|s| s.0).fold(f64::INFINITY, f64::min);
        let node = match *event {
            Event::SideIsFront { node, .. } => {
                assert_eq!(Some(node), front, "{event:?}");
                self.front += 1;
                return;
            }
            Event::SideChosen { edge } => {
                assert!(front.is_none() && edges[&edge.node] <= best_edge + EXACT, "{event:?} {edges:?}");
                assert!((edge.deviation - edges[&edge.node]).abs() < EXACT, "{event:?} {edges:?}");
                let is_near = best_edge <= parameters.side_deviation + EXACT;
                assert!(is_near || best_swap >= best_edge - EXACT, "{event:?} {edges:?} {swaps:?}");
                self.edge += 1;
                edge.node
            }
            Event::SideSwapped { edge, instead_of } => {
                let deviation = swaps[&edge.node].0;
                assert!(front.is_none() && deviation <= best_swap + EXACT, "{event:?} {swaps:?}");
                assert!((edge.deviation - deviation).abs() < EXACT && deviation < best_edge, "{event:?} {swaps:?}");
                assert!(best_edge > parameters.side_deviation - EXACT, "{event:?} {edges:?}");
                assert!(instead_of.is_none_or(|old| (old - best_edge).abs() < EXACT), "{event:?} {edges:?}");
                self.swap += 1;
                edge.node
            }
            Event::RolledBack { .. } => return,
            _ => panic!("{event:?}"),
        };
        let at = if side == Side::Left { base.a } else { base.b };
        let length = Oracle { mesh: &state.mesh }.length(at, node);
        let divides = is_divided(length, &base, parameters);
        if matches!(state.phase(), Phase::DivideSide { .. }) {
            assert!(divides, "{event:?} {length}");
            self.at_hand = Some(Top { ends: [at, node], length, divides });
        } else {
            self.indivisible += usize::from(divides);
        }
    }

    /// Holds a division against what was expected.
    fn division(&mut self, state: &Converter<'_>, event: &Event) {
        let Some(Top { ends: [p, q], length: expected, divides }) = self.at_hand.take() else { return };
        let Event::SideDivided { node, length, .. } = *event else { panic!("{event:?}") };
        assert!(divides && (length - expected).abs() < 1e-9, "{event:?} {expected}");
        let mesh = &state.mesh;
        let oracle = Oracle { mesh };
        let way = mesh.uv(q) - mesh.uv(p);
        let [lp, lq] = [p, q].map(|n| norm(oracle.metric(n), way).sqrt());
        let share = match state.parameters().division_at {
            DivisionAt::Midpoint => 0.5,
            DivisionAt::MetricMiddle => lq / (lp + lq),
        };
        assert!((mesh.uv(node) - (mesh.uv(p) + way * share)).length() < 1e-9 * way.length(), "{event:?}");
        self.divided += 1;
    }
}

/// The paper's rule for live sides (vi), and the bound below which they stay whole.
fn is_divided(length: f64, base: &Base, parameters: &Parameters) -> bool {
    length > parameters.side_split * base.length && length >= parameters.whole_below.max(0.1)
}
