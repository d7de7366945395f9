//! Edges that coincide, of bodies or faces that do not share them, become one.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::topology::{Edge, Face, Topology};
use crate::core::geometry::SpaceCurve;

/// The points of an edge that are compared with another one.
const COMPARED: usize = 7;

/// What was sewn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sewn {
    /// Pairs of edges that became one.
    pub pairs: usize,
    /// The largest distance between two of them.
    pub apart: f64,
    /// Edges that still bound one face only.
    pub open: usize,
    /// Edges shorter than the tolerance, which were left out.
    pub short: usize,
    /// Faces of two bodies that touch there, of which one was left out.
    pub doubled: usize,
}

impl Topology {
    /// Makes edges one that lie within `tolerance` of one another and belong to different bodies or bound one face
    /// each, leaves out one of two faces that are the same then, and leaves out edges shorter than the tolerance.
    pub fn sew(&mut self, tolerance: f64) -> Sewn {
        let mut sewn = Sewn { short: self.leave_out_short(tolerance), ..Sewn::default() };
        let uses = self.uses();
        // For each edge the one that takes its place, and whether in the same direction.
        let mut instead: FxHashMap<usize, (usize, bool)> = FxHashMap::default();
        let cell = |p: DVec3| (p / (8.0 * tolerance)).floor().to_array().map(|x| x as i64);
        // Open edges that have no partner yet, by the cells of their ends; a ring by that of its middle.
        let mut waiting: FxHashMap<[i64; 3], Vec<usize>> = FxHashMap::default();
        for edge in (0..uses.len()).filter(|&edge| uses[edge] > 0) {
            let own = &self.edges[edge];
            let key = if own.is_closed() { middle(own) } else { own.points[0] };
            let home = cell(key);
            let mut found: Option<(usize, bool, f64)> = None;
            for k in 0..27_i64 {
                let near = [home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1];
                for &other in waiting.get(&near).into_iter().flatten() {
                    let is_sooner = found.is_none_or(|known| other < known.0);
                    let may_be = self.edges[other].body != own.body || (uses[other] == 1 && uses[edge] == 1);
                    if is_sooner
                        && may_be
                        && let Some((forward, apart)) = coincide(&self.edges[other], own, tolerance)
                    {
                        found = Some((other, forward, apart));
                    }
                }
            }
            if let Some((other, forward, apart)) = found {
                instead.insert(edge, (other, forward));
                sewn.pairs += 1;
                sewn.apart = sewn.apart.max(apart);
                continue;
            }
            waiting.entry(home).or_default().push(edge);
            if !own.is_closed() {
                let last = cell(own.points[own.points.len() - 1]);
                if last != home {
                    waiting.entry(last).or_default().push(edge);
                }
            }
        }
        for step in self.faces.iter_mut().flat_map(|face| &mut face.loops).flatten() {
            if let Some(&(other, same)) = instead.get(&step.0) {
                *step = (other, step.1 == same);
            }
        }
        sewn.doubled = self.leave_out_doubled(tolerance);
        sewn.open = self.uses().into_iter().filter(|uses| *uses == 1).count();
        sewn
    }

    /// How often loops use each edge.
    fn uses(&self) -> Vec<u32> {
        let mut uses = vec![0_u32; self.edges.len()];
        for (edge, _) in self.faces.iter().flat_map(|face| &face.loops).flatten() {
            uses[*edge] += 1;
        }
        uses
    }

    /// Leaves out one of two faces with the same edges, surface and side of their loops.
    fn leave_out_doubled(&mut self, tolerance: f64) -> usize {
        let before = self.faces.len();
        let mut by_edges: FxHashMap<Vec<usize>, Vec<usize>> = FxHashMap::default();
        let mut is_doubled = vec![false; before];
        for (number, face) in self.faces.iter().enumerate() {
            let mut edges: Vec<usize> = face.loops.iter().flatten().map(|step| step.0).collect();
            if edges.is_empty() {
                continue;
            }
            edges.sort_unstable();
            let others = by_edges.entry(edges).or_default();
            is_doubled[number] = others.iter().any(|&other| self.faces[other].is_same(face, tolerance));
            others.push(number);
        }
        let mut doubled = is_doubled.into_iter();
        self.faces.retain(|_| !doubled.next().unwrap_or(false));
        before - self.faces.len()
    }

    /// Leaves edges shorter than the tolerance out of their loops, where the loop has others.
    fn leave_out_short(&mut self, tolerance: f64) -> usize {
        let is_short: Vec<bool> = self.edges.iter().map(|edge| edge.length() <= tolerance).collect();
        let mut left_out = vec![false; self.edges.len()];
        for steps in self.faces.iter_mut().flat_map(|face| &mut face.loops) {
            if steps.iter().any(|step| !is_short[step.0]) {
                steps.iter().filter(|step| is_short[step.0]).for_each(|step| left_out[step.0] = true);
                steps.retain(|step| !is_short[step.0]);
            }
        }
        left_out.into_iter().filter(|out| *out).count()
    }
}

impl Face {
    /// Whether a face with the same edges is this one, seen from either side: on the same surface, on the same side of
    /// its loops.
    fn is_same(&self, other: &Face, tolerance: f64) -> bool {
        let Some(same_normal) = self.surface.coincides(&other.surface, tolerance) else { return false };
        let looks_alike = (self.reversed == other.reversed) == same_normal;
        let step = self.loops[0][0];
        let along = other.loops.iter().flatten().find(|known| known.0 == step.0);
        along.is_some_and(|known| (known.1 == step.1) == looks_alike)
    }
}

/// The middle of the points of a ring, each weighted by the lengths beside it.
fn middle(edge: &Edge) -> DVec3 {
    let pairs = edge.points.windows(2);
    let sum: DVec3 = pairs.map(|w| (w[0] + w[1]) * (0.5 * w[0].distance(w[1]))).sum();
    sum / edge.length().max(f64::MIN_POSITIVE)
}

/// Whether two edges are the same within a tolerance: whether in the same direction, and how far they are apart.
fn coincide(one: &Edge, other: &Edge, tolerance: f64) -> Option<(bool, f64)> {
    if one.is_closed() != other.is_closed() {
        return None;
    }
    let ends = |edge: &Edge| [edge.points[0], edge.points[edge.points.len() - 1]];
    let ([a, b], [c, d]) = (ends(one), ends(other));
    let forward = a.distance(c) <= tolerance && b.distance(d) <= tolerance;
    let backward = a.distance(d) <= tolerance && b.distance(c) <= tolerance;
    if !one.is_closed() && !forward && !backward {
        return None;
    }
    let [curve, own] = [one, other].map(|edge| SpaceCurve::new(&edge.shape, &|_| None).ok());
    let (curve, own) = (curve?, own?);
    let mut apart: f64 = 0.0;
    let mut along = Vec::new();
    for k in 1..=COMPARED {
        let (t, off) = nearest(&curve, own.point(k as f64 / (COMPARED + 1) as f64));
        apart = apart.max(off);
        along.push(t);
    }
    if apart > tolerance {
        return None;
    }
    // A ring runs the same way if most of the points follow one another along the other ring.
    let rising = along.windows(2).filter(|w| w[0] < w[1]).count();
    Some((
        if one.is_closed() { 2 * rising >= COMPARED } else { forward && (!backward || 2 * rising >= COMPARED) },
        apart,
    ))
}

/// The parameter in [0, 1] of the point of a curve that is nearest to a place, and the distance.
fn nearest(curve: &SpaceCurve, place: DVec3) -> (f64, f64) {
    const SAMPLES: usize = 96;
    let at = |k: usize| k as f64 / SAMPLES as f64;
    let off = |t: f64| curve.point(t).distance(place);
    let start = (0..=SAMPLES).min_by(|&a, &b| off(at(a)).total_cmp(&off(at(b)))).unwrap_or(0);
    let mut t = at(start);
    for _ in 0..30 {
        let (p, d) = curve.at(t);
        let step = (place - p).dot(d) / d.length_squared().max(f64::MIN_POSITIVE);
        let mut next = (t + step).clamp(0.0, 1.0);
        if off(next) > p.distance(place) {
            next = 0.5 * (next + t);
        }
        let moved = (next - t).abs();
        t = next;
        if moved < 1e-14 {
            break;
        }
    }
    (t, off(t))
}
