//! Detection of curves that cross or touch: chords of the fine polylines whose boxes overlap are bisected until they
//! are straight within the tolerance, then compared by exact orientation.

use glam::DVec2;
use rstar::RTree;

use super::assembly::placed;
use super::curve::distance_to_segment;
use super::domain_curve::{CurveId, DomainCurve};
use super::inside::Chord;
use crate::core::fault::Fault;
use crate::core::kernel::decimal::{number, point_text};
use crate::core::kernel::predicates::orient;

/// Curves that share a vertex may cross within so many tolerances of it.
const AT_VERTEX: f64 = 4.0;

/// The tolerances of the test. Two curves may be closer than `tolerance` only within `near` of a vertex that they share
/// (they may be tangent there).
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Ends closer than this are one vertex.
    pub tolerance: f64,
    /// The distance from a shared vertex within which curves may run together.
    pub near: f64,
}

/// The part of a curve between two parameters.
#[derive(Clone, Copy)]
struct Arc<'a> {
    curve: &'a DomainCurve,
    from: (f64, DVec2),
    to: (f64, DVec2),
    /// Bound on the distance of the curve from the chord.
    bulge: f64,
}

#[derive(Clone, Copy)]
enum Meeting {
    Crosses(DVec2),
    Touches(DVec2),
}

/// Bound on the distance of a curve from its chord, estimated at its middle.
pub fn bulge(curve: &DomainCurve, from: (f64, DVec2), to: (f64, DVec2)) -> f64 {
    if curve.curve.straight() {
        return 0.0;
    }
    2.0 * distance_to_segment(curve.curve.point(0.5 * (from.0 + to.0)), from.1, to.1)
}

impl<'a> Arc<'a> {
    fn new(curve: &'a DomainCurve, from: (f64, DVec2), to: (f64, DVec2)) -> Self {
        Arc { curve, from, to, bulge: bulge(curve, from, to) }
    }

    fn chord(curve: &'a DomainCurve, i: u32) -> Self {
        Arc::new(curve, curve.fine[i as usize], curve.fine[i as usize + 1])
    }

    fn halves(self) -> [Self; 2] {
        let t = 0.5 * (self.from.0 + self.to.0);
        let middle = (t, self.curve.curve.point(t));
        [Arc::new(self.curve, self.from, middle), Arc::new(self.curve, middle, self.to)]
    }
}

/// Refuses curves that cross or touch each other or themselves anywhere but at shared vertices.
///
/// # Errors
/// The first such pair in the order of the curves, with names and position; `face_of` names a face that a curve bounds.
pub fn check<'n>(
    curves: &[DomainCurve],
    tree: &RTree<Chord>,
    limits: Limits,
    face_of: impl Fn(CurveId) -> Option<&'n str>,
) -> Result<(), Fault> {
    let mut pairs: Vec<(CurveId, u32, CurveId, u32)> = tree
        .intersection_candidates_with_other_tree(tree)
        .map(|(a, b)| (a.data.0, a.data.1, b.data.0, b.data.1))
        .filter(|&(a, i, b, j)| (a, i) < (b, j))
        .collect();
    pairs.sort_unstable();
    for (a, i, b, j) in pairs {
        let (first, second) = (&curves[a.index()], &curves[b.index()]);
        let found = if a == b {
            meets_itself(first, i, j, limits)
        } else {
            meet(Arc::chord(first, i), Arc::chord(second, j), &shared_vertices(first, second), limits)
        };
        if let Some(meeting) = found {
            return Err(refusal(first, second, meeting, limits, face_of(b).or_else(|| face_of(a))));
        }
    }
    Ok(())
}

fn meets_itself(curve: &DomainCurve, i: u32, j: u32, limits: Limits) -> Option<Meeting> {
    let (a, b) = (Arc::chord(curve, i), Arc::chord(curve, j));
    let last = curve.fine.len() as u32 - 2;
    let wraps = curve.ends[0] == curve.ends[1] && i == 0 && j == last;
    if j == i + 1 || wraps {
        // Neighbours share a point; straight ones may still fold back on each other.
        let (corner, far_a, far_b) = if j == i + 1 { (a.to.1, a.from.1, b.to.1) } else { (a.from.1, a.to.1, b.from.1) };
        let folds = curve.curve.straight() && runs_along(corner, far_a, far_b, limits.tolerance);
        return folds.then_some(Meeting::Touches(corner));
    }
    // Chords separated only by a short stretch of the curve may legitimately be close to each other.
    let stretch = |from: u32, to: u32| {
        let points = &curve.fine[from as usize..=to as usize];
        let mut length = 0.0;
        for w in points.windows(2) {
            length += w[0].1.distance(w[1].1);
            if length > limits.near {
                return length;
            }
        }
        length
    };
    match meet(a, b, &[], limits) {
        Some(Meeting::Touches(p)) => {
            let mut between = stretch(i + 1, j);
            if curve.ends[0] == curve.ends[1] {
                between = between.min(stretch(0, i) + stretch(j + 1, last + 1));
            }
            if between > limits.near { Some(Meeting::Touches(p)) } else { crossing(&a, &b).map(Meeting::Crosses) }
        }
        found => found,
    }
}

fn shared_vertices(a: &DomainCurve, b: &DomainCurve) -> Vec<DVec2> {
    [(a.ends[0], a.first()), (a.ends[1], a.last())]
        .iter()
        .filter(|(v, _)| b.ends.contains(v))
        .map(|&(_, p)| p)
        .collect()
}

/// Whether two straight pieces leave their common corner in the same direction.
fn runs_along(corner: DVec2, p: DVec2, q: DVec2, tolerance: f64) -> bool {
    (p - corner).dot(q - corner) > 0.0
        && distance_to_segment(p, corner, q).min(distance_to_segment(q, corner, p)) <= tolerance
}

/// The first point at which two pieces meet, by bisection of the one that bulges more.
fn meet(a: Arc, b: Arc, shared: &[DVec2], limits: Limits) -> Option<Meeting> {
    let mut stack = vec![(a, b, 0)];
    // After a first touch the search continues for a while, to locate the point better or to find a crossing.
    let (mut touch, mut patience): (Option<(f64, DVec2)>, u32) = (None, 500);
    while let Some((a, b, depth)) = stack.pop() {
        if touch.is_some() {
            patience -= 1;
            if patience == 0 {
                break;
            }
        }
        let distance = chord_distance(&a, &b);
        if distance > a.bulge + b.bulge + limits.tolerance {
            continue;
        }
        let flat = 1e-3 * limits.tolerance;
        if a.bulge.max(b.bulge) > flat && depth < 80 {
            if a.bulge >= b.bulge {
                let [first, second] = a.halves();
                stack.extend([(second, b, depth + 1), (first, b, depth + 1)]);
            } else {
                let [first, second] = b.halves();
                stack.extend([(a, second, depth + 1), (a, first, depth + 1)]);
            }
            continue;
        }
        let within = |p: DVec2, reach: f64| shared.iter().any(|v| v.distance(p) <= reach);
        if let Some(p) = crossing(&a, &b) {
            // Curves that end beside their vertex may cross there.
            if within(p, AT_VERTEX * limits.tolerance) {
                continue;
            }
            return Some(Meeting::Crosses(p));
        }
        if distance > limits.tolerance {
            continue;
        }
        let near = |p: DVec2| within(p, limits.near);
        let straight = a.curve.curve.straight() && b.curve.curve.straight();
        let ends = |x: &Arc| [(x.from.1, x.to.1), (x.to.1, x.from.1)];
        let corner = ends(&a).into_iter().flat_map(|m| ends(&b).map(|n| (m, n))).find(|(m, n)| m.0 == n.0);
        if let (true, Some(((corner, p), (_, q)))) = (straight, corner) {
            if runs_along(corner, p, q, limits.tolerance) {
                return Some(Meeting::Touches(corner.midpoint(if corner.distance(p) < corner.distance(q) {
                    p
                } else {
                    q
                })));
            }
            continue;
        }
        let (_, p) = nearest_end(&a, &b);
        if !near(p) && touch.is_none_or(|(least, _)| distance < least) {
            touch = Some((distance, p));
        }
    }
    touch.map(|(_, p)| Meeting::Touches(p))
}

/// The point at which the interiors of two chords cross; the decision is exact, the point is rounded.
fn crossing(a: &Arc, b: &Arc) -> Option<DVec2> {
    crossing_of([a.from.1, a.to.1], [b.from.1, b.to.1])
}

/// The point at which the interiors of two straight segments cross; the decision is exact, the point is rounded.
pub fn crossing_of(a: [DVec2; 2], b: [DVec2; 2]) -> Option<DVec2> {
    let (s, t) = (orient(a[0], a[1], b[0]), orient(a[0], a[1], b[1]));
    let (u, v) = (orient(b[0], b[1], a[0]), orient(b[0], b[1], a[1]));
    let opposite = |x: f64, y: f64| (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0);
    (opposite(s, t) && opposite(u, v)).then(|| b[0] + (s / (s - t)).clamp(0.0, 1.0) * (b[1] - b[0]))
}

fn chord_distance(a: &Arc, b: &Arc) -> f64 {
    if crossing(a, b).is_some() {
        return 0.0;
    }
    nearest_end(a, b).0
}

/// The end of one chord that is closest to the other chord, and its distance.
fn nearest_end(a: &Arc, b: &Arc) -> (f64, DVec2) {
    let from_b = |p: DVec2| (distance_to_segment(p, b.from.1, b.to.1), p);
    let from_a = |p: DVec2| (distance_to_segment(p, a.from.1, a.to.1), p);
    let all = [from_b(a.from.1), from_b(a.to.1), from_a(b.from.1), from_a(b.to.1)];
    all.into_iter().fold(all[0], |least, end| if end.0 < least.0 { end } else { least })
}

fn refusal(a: &DomainCurve, b: &DomainCurve, meeting: Meeting, limits: Limits, face: Option<&str>) -> Fault {
    let (Meeting::Crosses(p) | Meeting::Touches(p)) = meeting;
    let is_end = |c: &DomainCurve| {
        c.first().distance(p) <= 2.0 * limits.tolerance || c.last().distance(p) <= 2.0 * limits.tolerance
    };
    let (what, remedy) = match meeting {
        _ if a.name == b.name => {
            let verb = if matches!(meeting, Meeting::Crosses(_)) { "crosses" } else { "touches" };
            (format!("The curve \"{}\" {verb} itself", a.name), "Move its points apart".to_owned())
        }
        _ if is_end(a) != is_end(b) => {
            let (end, whole) = if is_end(a) { (a, b) } else { (b, a) };
            (
                format!("The end of \"{}\" touches the interior of \"{}\"", end.name, whole.name),
                format!("Divide \"{}\" there into two curves that share this end point", whole.name),
            )
        }
        Meeting::Crosses(_) => (
            format!("The curves \"{}\" and \"{}\" cross", a.name, b.name),
            "Move one of them, or divide both there at a common end point".to_owned(),
        ),
        Meeting::Touches(_) => (
            format!("The curves \"{}\" and \"{}\" touch or cross", a.name, b.name),
            format!(
                "They are nearer than the tolerance, {}: move them apart, make them meet at end points only, or set \
                 tolerance (a key of the case) to less than their distance",
                number(limits.tolerance)
            ),
        ),
    };
    let fault = Fault::new(what).at(format!("at {}", point_text(p))).remedy(remedy);
    let fault = match face {
        Some(face) => fault.at(format!("face \"{face}\"")),
        None => fault,
    };
    placed(fault, &b.place)
}
