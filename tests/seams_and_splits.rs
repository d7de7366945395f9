//! Promise: what seams and splits of the front say that they looked at (4.3.6) is what an oracle finds that was written
//! apart from the code: it rebuilds the front from the live triangles, measures corners and triangles by the formulas,
//! walks the loops, and knows when something should have been said and was not.
#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

use glam::DVec2;
use quadfront::core::case::{Parameters, built_in};
use quadfront::core::convert::background;
use quadfront::core::convert::walk::walk;
use quadfront::core::convert::{Converter, Event, Narrow, NotSlender, Phase, SeamCorner, StepReport, Unmerged};
use quadfront::core::mesh::{ElementId, Mesh, NodeId};
use quadfront::core::progress::Nobody;

type Segment = [NodeId; 2];

/// The front of a mesh, from its triangles.
struct Front<'a> {
    mesh: &'a Mesh,
    /// At each node, from each neighbour to the next one anticlockwise across a live triangle; and back.
    turns: BTreeMap<(NodeId, NodeId), NodeId>,
    back: BTreeMap<(NodeId, NodeId), NodeId>,
    /// Sides of live triangles without a live triangle beyond them.
    segments: BTreeSet<Segment>,
}

impl<'a> Front<'a> {
    fn of(mesh: &'a Mesh) -> Front<'a> {
        let (mut turns, mut back, mut sides) = (BTreeMap::new(), BTreeMap::new(), BTreeSet::new());
        for e in mesh.elements() {
            let n: Vec<NodeId> = mesh.corners(e).collect();
            for k in (0..3).filter(|_| n.len() == 3) {
                let [a, b, c] = [0, 1, 2].map(|i| n[(k + i) % 3]);
                turns.insert((a, b), c);
                back.insert((a, c), b);
                sides.insert([a, b]);
            }
        }
        let segments = sides.iter().copied().filter(|&[a, b]| !sides.contains(&[b, a])).collect();
        Front { mesh, turns, back, segments }
    }

    /// The last neighbour of a node that is met from one on, in one sense.
    fn last(around: &BTreeMap<(NodeId, NodeId), NodeId>, at: NodeId, from: NodeId) -> NodeId {
        let mut to = from;
        while let Some(&next) = around.get(&(at, to)) {
            to = next;
        }
        to
    }

    /// The front segment that leaves a node, in the live sector of one of its neighbours.
    fn leaving(&self, at: NodeId, towards: NodeId) -> Segment {
        [at, Front::last(&self.back, at, towards)]
    }

    /// The segment before another one on its loop.
    fn before(&self, [a, b]: Segment) -> Segment {
        [Front::last(&self.turns, a, b), a]
    }

    /// The segment after another one on its loop.
    fn after(&self, [a, b]: Segment) -> Segment {
        self.leaving(b, a)
    }

    fn is_on_front(&self, n: NodeId) -> bool {
        self.segments.range([n, NodeId(0)]..=[n, NodeId(u32::MAX)]).next().is_some()
    }

    fn norm(&self, at: NodeId, d: DVec2) -> f64 {
        let m = self.mesh.metric(at);
        (m.uu * d.x * d.x + 2.0 * m.uv * d.x * d.y + m.vv * d.y * d.y).sqrt()
    }

    /// The length of an edge: l = (4 sqrt(l_a l_b) + l_a + l_b) / 6.
    fn length(&self, [a, b]: Segment) -> f64 {
        let d = self.mesh.uv(b) - self.mesh.uv(a);
        let [l_a, l_b] = [a, b].map(|n| self.norm(n, d));
        (4.0 * (l_a * l_b).sqrt() + l_a + l_b) / 6.0
    }

    /// The corners at a node: the segments that leave and arrive, and the angle between them by the arc cosine (eq. 5).
    fn corners(&self, at: NodeId) -> Vec<(NodeId, NodeId, f64)> {
        let leaving = self.segments.range([at, NodeId(0)]..=[at, NodeId(u32::MAX)]);
        let corner = |&[_, b]: &Segment| {
            let c = Front::last(&self.turns, at, b);
            let m = self.mesh.metric(at);
            let [p, q] = [b, c].map(|n| self.mesh.uv(n) - self.mesh.uv(at));
            let inner = m.uu * p.x * q.x + m.uv * (p.x * q.y + p.y * q.x) + m.vv * p.y * q.y;
            let theta = libm::acos((inner / (self.norm(at, p) * self.norm(at, q))).clamp(-1.0, 1.0));
            (b, c, if p.perp_dot(q) >= 0.0 { theta } else { TAU - theta })
        };
        leaving.map(corner).collect()
    }

    /// Segments of the two loops that the collapse of an edge makes of one; none where its ends lie on two loops.
    fn parts(&self, [p, q]: Segment) -> Option<[u32; 2]> {
        let (from, to) = (self.leaving(p, q), self.leaving(q, p));
        let (mut at, mut count, mut met) = (from, 0, None);
        loop {
            if at == to {
                met = Some(count);
            }
            (at, count) = (self.after(at), count + 1);
            if at == from {
                return met.filter(|&met| met > 0).map(|met| [met, count - met]);
            }
        }
    }
}

fn close(x: f64, y: f64, to: f64) -> bool {
    (x - y).abs() <= to * x.abs().max(y.abs())
}

/// Checks what a seam looked at.
fn seam(front: &Front<'_>, parameters: &Parameters, at: NodeId, corner: &SeamCorner) -> [NodeId; 2] {
    let SeamCorner { angle, theta_seam, widest, length, ratio } = *corner;
    // The arc cosine loses half of the digits near zero.
    let nearest = front.corners(at).into_iter().min_by(|x, y| (x.2 - angle).abs().total_cmp(&(y.2 - angle).abs()));
    let (b, c, theta) = nearest.unwrap();
    assert!((theta - angle).abs().to_degrees() < 1e-5, "{theta} {corner:?}");
    let [l_b, l_c] = [[at, b], [c, at]].map(|segment| front.length(segment));
    assert!(close(ratio, l_b.max(l_c) / l_b.min(l_c), 1e-12), "{corner:?}");
    let after = front.after([at, b]);
    let before = front.before([c, at]);
    let around = [[at, b], after, front.after(after), [c, at], before, front.before(before)];
    assert!(close(length, around.map(|segment| front.length(segment)).iter().sum::<f64>() / 6.0, 1e-12), "{corner:?}");
    assert_eq!(theta_seam, parameters.theta_seam);
    // Widened by degrees: not at all from a length of 0.97 on, and as far as may be up to 0.82.
    let most = theta_seam * parameters.seam_widening;
    let bound = match length {
        0.97.. => theta_seam,
        ..0.82 => most,
        _ => theta_seam + (most - theta_seam) * (0.97 - length) / 0.15,
    };
    let bound = if bound > theta_seam { bound.min(90_f64.to_radians()).max(theta_seam) } else { bound };
    assert!(close(widest, bound, 1e-12), "{corner:?}");
    assert!(angle <= widest, "{corner:?}");
    [b, c]
}

/// Checks why a seam was refused, as far as the state says so by itself.
fn refused(front: &Front<'_>, at: NodeId, ends: [NodeId; 2], corner: &SeamCorner, why: Unmerged) {
    let is_transition = corner.ratio > 2.5;
    let fixed = ends.iter().all(|&n| front.mesh.is_fixed(n));
    if !is_transition {
        assert_eq!(why == Unmerged::BothFixed, fixed, "{why:?}");
        let neighbours = front.mesh.neighbours(at).count();
        if !fixed && neighbours < if front.mesh.is_fixed(at) { 3 } else { 4 } {
            assert_eq!(why, Unmerged::Doublet);
        }
    }
    if let Unmerged::Poor { quality, least } = why {
        assert!(quality < least && least <= 0.7 * 0.3 + 1e-12, "{why:?}");
    }
    assert!(why != Unmerged::Unlike || is_transition, "{corner:?}");
}

/// The sets T and V around a quadrilateral, checked triangle by triangle. Returns how many of both, and whether a side
/// leaves two even loops.
fn split(front: &Front<'_>, parameters: &Parameters, quad: ElementId, narrow: &Narrow) -> ([usize; 2], bool) {
    let mesh = front.mesh;
    let corners: Vec<NodeId> = mesh.corners(quad).collect();
    let mut slender = Vec::new();
    let mut t = 0;
    for e in mesh.elements() {
        let n: Vec<NodeId> = mesh.corners(e).collect();
        if n.len() != 3 || !n.iter().any(|n| corners.contains(n)) || !n.iter().all(|&n| front.is_on_front(n)) {
            continue;
        }
        t += 1;
        let told = narrow.on_front.iter().find(|told| told.element == e).unwrap();
        let roots: f64 = n.iter().map(|&n| mesh.metric(n)).map(|m| (m.uu * m.vv - m.uv * m.uv).sqrt()).sum();
        let [p, q, r] = [0, 1, 2].map(|k| mesh.uv(n[k]));
        let area = roots / 3.0 * 0.5 * (q - p).perp_dot(r - p);
        let sides = [0, 1, 2].map(|k| [n[k], n[(k + 1) % 3]]);
        let width = sides.iter().map(|&side| front.length(side)).fold(0.0, f64::max);
        let ratio = width / (2.0 * area / width);
        assert!(close(told.area, area, 1e-9) && close(told.ratio, ratio, 1e-9), "{told:?} {area} {ratio}");
        let on_front = sides.iter().filter(|side| front.segments.contains(*side)).count();
        let passed = match on_front {
            0 => Some(NotSlender::NoBase),
            1 if told.area >= parameters.eps1 => Some(NotSlender::Large),
            1 if told.ratio <= parameters.eps2 => Some(NotSlender::Wide),
            1 => None,
            _ => Some(NotSlender::Adjacent),
        };
        assert_eq!(told.passed, passed, "{told:?}");
        if passed.is_none() {
            slender.push((e, sides));
        }
    }
    assert_eq!((narrow.on_front.len(), narrow.slender.len()), (t, slender.len()));
    assert!(narrow.slender.is_sorted_by(|s, t| s.area / s.ratio <= t.area / t.ratio));
    let mut splits = false;
    for told in &narrow.slender {
        let (_, sides) = slender.iter().find(|(e, _)| *e == told.element).unwrap();
        let free = sides.iter().filter(|side| !front.segments.contains(*side)).collect::<Vec<_>>();
        assert!(
            free.len() == 2 && front.length(told.sides[0].ends) <= front.length(told.sides[1].ends) * (1.0 + 1e-12)
        );
        for side in &told.sides {
            assert!(free.contains(&&side.ends));
            let sorted = |parts: Option<[u32; 2]>| parts.map(|[m, n]| [m.min(n), m.max(n)]);
            let parts = sorted(front.parts(side.ends));
            assert_eq!(sorted(side.segments), parts, "{side:?}");
            let even = parts.is_some_and(|parts| parts.iter().all(|n| n % 2 == 0 && *n >= 4));
            assert_eq!(side.splits(), even);
            splits |= even;
        }
    }
    ([t, slender.len()], splits)
}

/// What was checked.
#[derive(Debug, Default)]
struct Checked {
    seamed: usize,
    refused: usize,
    widened: usize,
    split: usize,
    split_refused: usize,
    by_parity: usize,
    nothing_slender: usize,
}

fn check(name: &str, paper: bool, set: &[(&str, &str)], checked: &mut Checked) {
    let mut case = built_in::named(name).unwrap().unwrap();
    if paper {
        case.parameters = case.parameters.read_as_paper();
    }
    for (key, value) in set {
        case.parameters.set(key, value).unwrap();
    }
    let made = background(&case, &mut Nobody).unwrap();
    let mut converter = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
    while !matches!(converter.phase(), Phase::PostProcess { .. } | Phase::Done) {
        let quad = converter.phase().last_formed();
        let Some(quad) = quad else {
            converter.step().unwrap();
            continue;
        };
        let (narrow, before) = (converter.narrow().unwrap(), converter.mesh.clone());
        let event = converter.step().unwrap();
        let parameters = converter.parameters();
        match event {
            Event::Seamed { at, corner, .. } | Event::TransitionSeamed { at, corner, .. } => {
                seam(&Front::of(&before), parameters, at, &corner);
                checked.seamed += 1;
                checked.widened += usize::from(corner.widest > corner.theta_seam);
            }
            Event::SeamRefused { at, ends, corner, why } => {
                let front = Front::of(&before);
                assert_eq!(seam(&front, parameters, at, &corner), ends);
                refused(&front, at, ends, &corner, why);
                checked.refused += 1;
            }
            Event::Split { node, gone, area, ratio, segments } => {
                let (_, splits) = split(&Front::of(&before), parameters, quad, &narrow);
                assert!(splits && segments.iter().all(|n| n % 2 == 0));
                let told = narrow.slender.iter().find(|s| s.area == area && s.ratio == ratio).unwrap();
                assert!(told.sides.iter().any(|side| side.ends == [node, gone] || side.ends == [gone, node]));
                checked.split += 1;
            }
            Event::SplitRefused { element, on_front, slender, why } => {
                let ([t, v], splits) = split(&Front::of(&before), parameters, quad, &narrow);
                assert_eq!((element, usize::from(on_front), usize::from(slender)), (quad, t, v));
                assert_eq!(why.is_some(), splits, "{name}: {why:?}");
                checked.split_refused += 1;
                checked.by_parity += usize::from(!splits);
            }
            Event::BaseSelected { .. } if parameters.splitting => {
                let ([_, v], _) = split(&Front::of(&before), parameters, quad, &narrow);
                assert_eq!(v, 0, "{name}: nothing is said of a slender triangle");
                checked.nothing_slender += 1;
            }
            _ => {}
        }
    }
}

#[test]
fn seams_and_splits_say_what_the_formulas_give() {
    let mut checked = Checked::default();
    check("example1", false, &[], &mut checked);
    check("example1", true, &[], &mut checked);
    check("repeated-line", false, &[("eps1", "1"), ("eps2", "2")], &mut checked);
    check("polar-1", false, &[("size_scale", "1.5"), ("seam_widening", "2.5")], &mut checked);
    let Checked { seamed, refused, widened, split, split_refused, by_parity, nothing_slender } = checked;
    assert!(seamed > 50 && refused > 10 && widened > 20, "{checked:?}");
    assert!(split > 5 && split_refused > 20 && by_parity > 5 && nothing_slender > 200, "{checked:?}");
}

#[test]
fn the_json_of_a_split_has_its_triangles_and_that_of_a_seam_its_bound() {
    let case = built_in::named("figure-19").unwrap().unwrap();
    let made = background(&case, &mut Nobody).unwrap();
    let mut converter = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
    let mut lines = Vec::new();
    let mut tell = |told: &StepReport<'_>| lines.push(serde_json::to_value(told).unwrap());
    walk(&mut converter, None, &mut Nobody, Some(&mut tell)).unwrap();
    let told: Vec<_> = lines.iter().filter(|line| !line["narrow"].is_null()).collect();
    let [split] = told[..] else { panic!("{told:?}") };
    assert_eq!(split["kind"], "split");
    let narrow = &split["narrow"];
    assert_eq!((narrow["eps1"].as_f64(), narrow["eps2"].as_f64()), (Some(0.1), Some(5.0)));
    assert_eq!(narrow["on_front"].as_array().unwrap().len(), 4);
    assert_eq!(narrow["on_front"][0]["passed"], "large");
    let slender = narrow["slender"].as_array().unwrap();
    assert_eq!(slender[1]["sides"][0]["ends"], serde_json::json!([0, 2]));
    assert_eq!(slender[1]["sides"][0]["segments"], serde_json::json!([4, 4]));
    let corner = SeamCorner { angle: 0.5, theta_seam: 0.5, widest: 0.75, length: 0.8, ratio: 1.0 };
    let (at, ends) = (NodeId(3), [NodeId(1), NodeId(2)]);
    let why = Unmerged::Poor { quality: 0.1, least: 0.2 };
    let json = serde_json::to_value(Event::SeamRefused { at, ends, corner, why }).unwrap();
    assert_eq!(json["widest"].as_f64(), Some(0.75_f64.to_degrees()));
    assert_eq!(json["why"], serde_json::json!({ "kind": "poor", "value": { "quality": 0.1, "least": 0.2 } }));
}
