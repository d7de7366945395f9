//! Faces that are given by directed loops, as CAD files have them: which loop is the outer one, which chart shows the
//! face, and where a face that goes around a closed surface is cut, follow from the loops.

use std::sync::Arc;

use glam::DVec2;

use super::assembly::{placed, unknown_curve};
use super::chart::{Chart, singular_edges};
use super::crossing::crossing_of;
use super::curve::Curve;
use super::face_surface::FaceSurface;
use super::image::Image;
use super::lifting::{Lift, Lifted, Piece, charts_for};
use super::loops::doubled_area;
use super::named_curve::NamedCurve;
use super::space_curve::SpaceCurve;
use super::spec::{CurveShape, SurfaceFaceSpec};
use super::surface::{Edge, NurbsSurface};
use crate::core::fault::Fault;

/// A chart about one of two poles shows no face that goes farther than this fraction of the way to the other.
const FARTHEST: f64 = 0.8;

/// A seam that ends nearer to an apex than this fraction of the surface ends there.
const AT_APEX: f64 = 1e-6;

/// A curve by number, and whether its loop runs along it.
type Directed = (usize, bool);

/// A loop in a chart: its pieces, and by how much its end is past its start on a closed surface, in u and v.
struct Ring {
    pieces: Vec<Piece>,
    past: DVec2,
}

/// What directed loops bound.
pub(super) enum Bounded {
    /// A face in a chart.
    Face(Lifted),
    /// All of a closed surface but these holes, each by the names of its curves.
    AllBut(Vec<Vec<String>>),
}

/// Finds the chart of a face with directed loops, and its loops there: the outer one first. A face that goes around a
/// closed surface between two loops is cut by a seam, which is added to the curves.
///
/// # Errors
/// Unknown curves, curves that do not lie on the surface, loops that do not close or do not bound one face.
pub(super) fn lift(
    face: &SurfaceFaceSpec,
    surface: &Arc<NurbsSurface>,
    curves: &mut Vec<NamedCurve>,
    tolerance: Option<f64>,
) -> Result<Bounded, Fault> {
    let spec = &face.face;
    let mut loops: Vec<Vec<Directed>> = Vec::new();
    for given in &face.loops {
        let mut steps = Vec::new();
        for (name, forward) in given {
            let known = || curves.iter().map(|c| c.name.as_str());
            let number = known().position(|known| known == name).ok_or_else(|| unknown_curve(spec, name, known()))?;
            steps.push((number, *forward));
        }
        loops.push(steps);
    }
    let all: Vec<usize> = loops.iter().flatten().map(|step| step.0).collect();
    let without_seams = unseamed(&loops);
    let mut refusal: Option<Fault> = None;
    let charts = charts_for(surface, &all, face.reversed, curves).into_iter().map(Arc::new);
    let mut tries: Vec<(Arc<Chart>, &[Vec<Directed>])> = Vec::new();
    for chart in charts {
        tries.push((Arc::clone(&chart), if chart.is_disc() { &without_seams } else { &loops }));
        if chart.keeps_lines() && is_closed_up(surface) && without_seams != loops {
            tries.push((chart, &without_seams));
        }
    }
    let known = curves.len();
    for (chart, loops) in tries {
        match in_chart(&chart, loops, spec.name.as_str(), curves, tolerance) {
            Ok(Bounded::AllBut(_)) => {
                let names = |steps: &Vec<Directed>| steps.iter().map(|step| curves[step.0].name.clone()).collect();
                return Ok(Bounded::AllBut(loops.iter().map(names).collect()));
            }
            Ok(bounded) => return Ok(bounded),
            // The parametric plane comes last, and its refusal is the easiest to understand.
            Err(fault) => {
                curves.truncate(known);
                refusal = Some(fault);
            }
        }
    }
    Err(placed(refusal.unwrap_or_else(|| Fault::new(format!("The face \"{}\" has no chart", spec.name))), &spec.place))
}

fn in_chart(
    chart: &Arc<Chart>,
    loops: &[Vec<Directed>],
    name: &str,
    curves: &mut Vec<NamedCurve>,
    tolerance: Option<f64>,
) -> Result<Bounded, Fault> {
    let mut rings = Vec::new();
    let mut lift = Lift::new(chart, curves, name, tolerance);
    for steps in loops {
        let (pieces, past) = lift.follow(steps)?;
        rings.push(Ring { pieces, past });
    }
    if chart.is_disc() && rings.iter().any(|ring| reaches_far(chart, &ring.pieces)) {
        let what = format!("The face \"{name}\" goes too far around its surface for one chart");
        return Err(Fault::new(what).remedy("Divide it"));
    }
    let is_past = |ring: &Ring| ring.past != DVec2::ZERO;
    let area = |ring: &Ring| doubled_area(&Lift::polygon(&ring.pieces));
    let parts = || {
        Fault::new(format!("The loops of the face \"{name}\" do not bound one part of its surface"))
            .remedy("Give each loop the direction in which the face is on its left")
    };
    let (around, closed): (Vec<Ring>, Vec<Ring>) = rings.into_iter().partition(is_past);
    let (outer, holes): (Vec<Ring>, Vec<Ring>) = closed.into_iter().partition(|ring| area(ring) > 0.0);
    let mut holes: Vec<Vec<Piece>> = holes.into_iter().map(|ring| ring.pieces).collect();
    let outer = match (outer.len(), around.len()) {
        (1, 0) => outer.into_iter().flat_map(|ring| ring.pieces).collect(),
        (0, _) if chart.keeps_lines() && is_closed_up(chart.surface()) => return Ok(Bounded::AllBut(Vec::new())),
        (0, 2) if chart.keeps_lines() => {
            let cut = Cut { chart, around: &around, holes: &holes };
            let (seam, pieces) = cut.shortest(name, curves.len()).ok_or_else(|| {
                parts().remedy("Divide the face by a seam: name a curve from one of the loops to the other in the loop")
            })?;
            curves.push(seam);
            pieces
        }
        (0, 1) if !chart.keeps_lines() => {
            let (seam, pieces) = to_apex(chart, &around[0], name, curves.len()).ok_or_else(parts)?;
            curves.push(seam);
            pieces
        }
        _ => return Err(parts()),
    };
    let polygon = Lift::polygon(&outer);
    if doubled_area(&polygon) <= 0.0 {
        return Err(parts());
    }
    let lift = Lift::new(chart, curves, name, tolerance);
    for hole in &mut holes {
        *hole = lift.brought_inside(std::mem::take(hole), &polygon);
        let inside = Lift::polygon(hole).into_iter().filter(|p| Lift::holds(&polygon, *p)).count();
        if inside == 0 {
            return Err(parts());
        }
    }
    let mut found = vec![outer];
    found.extend(holes);
    let repeated = lines_from_apex(chart, &found, name, curves);
    let surface = FaceSurface::Chart(Arc::clone(chart));
    Ok(Bounded::Face(Lifted { surface, loops: found, cracks: Vec::new(), repeated }))
}

/// The loops without seams: where a loop runs along a curve and later back along it, what lies between and the rest are
/// loops of their own.
pub(in crate::core) fn unseamed(loops: &[Vec<Directed>]) -> Vec<Vec<Directed>> {
    let mut found = Vec::new();
    let mut left: Vec<Vec<Directed>> = loops.iter().rev().cloned().collect();
    while let Some(steps) = left.pop() {
        let back = |i: usize| (i + 1..steps.len()).find(|&j| steps[j] == (steps[i].0, !steps[i].1));
        match (0..steps.len()).find_map(|i| back(i).map(|j| (i, j))) {
            Some((i, j)) => {
                left.push(steps[i + 1..j].to_vec());
                left.push([&steps[..i], &steps[j + 1..]].concat());
            }
            None if steps.is_empty() => {}
            None => found.push(steps),
        }
    }
    found
}

/// A loop around an apex, cut from its first vertex to the apex: the seam, and the outer loop that it makes. `number`
/// is the index that the seam will have.
fn to_apex(chart: &Arc<Chart>, ring: &Ring, face: &str, number: usize) -> Option<(NamedCurve, Vec<Piece>)> {
    let centre = chart.centre()?;
    let first = ring.pieces.first()?;
    let from = chart.uv(first.image.point(if first.forward { 0.0 } else { 1.0 }));
    let apex = chart.surface().domain()[centre.axis][usize::from(centre.last)];
    let to = centre.uv(if centre.axis == 0 { from.y } else { from.x }, apex);
    let trim = Curve::new(&CurveShape::Segment { from, to }).ok()?;
    let curve = Arc::new(SpaceCurve::on(Arc::clone(chart.surface()), trim.clone()));
    let image = |by: DVec2| Image::of_trim(chart, &curve, &trim, by);
    let mut pieces = ring.pieces.clone();
    pieces.push(Piece { curve: number, image: image(ring.past), forward: true });
    pieces.push(Piece { curve: number, image: image(DVec2::ZERO), forward: false });
    let name = format!("{face}: seam");
    Some((NamedCurve { name, curve, segments: None, place: String::new(), ends: [0; 2] }, pieces))
}

/// Two lines into the face from an apex to which a seam leads, added to the curves: such an apex is a node inside the
/// mesh, and needs three edges at least.
fn lines_from_apex(chart: &Arc<Chart>, loops: &[Vec<Piece>], face: &str, curves: &mut Vec<NamedCurve>) -> Vec<Piece> {
    let outer = &loops[0];
    let small = AT_APEX * chart.surface().size();
    let ends_there = |piece: &Piece| piece.image.point(if piece.forward { 1.0 } else { 0.0 }).length() <= small;
    let seam = (0..outer.len()).find(|&k| {
        let next = &outer[(k + 1) % outer.len()];
        outer[k].curve == next.curve && outer[k].forward != next.forward && ends_there(&outer[k])
    });
    let (Some(seam), Some(centre), false) = (seam, chart.centre(), chart.is_disc()) else { return Vec::new() };
    // The face lies between the seam's two images.
    let away = |piece: &Piece| piece.image.point(if piece.forward { 0.0 } else { 1.0 });
    let back = &outer[(seam + 1) % outer.len()];
    let (to, from) = (away(&outer[seam]), back.image.point(if back.forward { 1.0 } else { 0.0 }));
    let turn = from.angle_to(to);
    let turn = if turn <= 0.0 { turn + std::f64::consts::TAU } else { turn };
    let borders: Vec<[DVec2; 2]> = loops
        .iter()
        .flatten()
        .flat_map(|piece| piece.image.points().collect::<Vec<_>>().windows(2).map(|w| [w[0], w[1]]).collect::<Vec<_>>())
        .collect();
    let mut pieces = Vec::new();
    for third in [1.0, 2.0] {
        let ray = DVec2::from_angle(turn * third / 3.0).rotate(from.normalize_or(DVec2::X));
        let far = ray * (4.0 * from.length().max(to.length()));
        let hits = borders.iter().filter_map(|border| crossing_of([ray * small, far], *border));
        let reach = 0.5 * hits.map(DVec2::length).fold(far.length(), f64::min);
        let end = chart.uv(ray * reach);
        // Along a straight line of the chart only one parameter changes.
        let apex = chart.surface().domain()[centre.axis][usize::from(centre.last)];
        let start = centre.uv(if centre.axis == 0 { end.y } else { end.x }, apex);
        let Ok(trim) = Curve::new(&CurveShape::Segment { from: start, to: end }) else { return Vec::new() };
        let curve = Arc::new(SpaceCurve::on(Arc::clone(chart.surface()), trim.clone()));
        pieces.push(Piece {
            curve: curves.len(),
            image: Image::of_trim(chart, &curve, &trim, DVec2::ZERO),
            forward: true,
        });
        curves.push(NamedCurve {
            name: format!("{face}: {third}/3"),
            curve,
            segments: None,
            place: String::new(),
            ends: [0; 2],
        });
    }
    pieces
}

/// Whether a loop comes near the pole opposite to the centre of its chart, where the chart is stretched without bound.
fn reaches_far(chart: &Chart, pieces: &[Piece]) -> bool {
    let Some(centre) = chart.centre() else { return false };
    let surface = chart.surface();
    let opposite = Edge { last: !centre.last, ..centre };
    let has_opposite = singular_edges(surface).contains(&opposite);
    let [first, last] = surface.domain()[centre.axis];
    let away = |uv: DVec2| {
        let t = (if centre.axis == 0 { uv.x } else { uv.y } - first) / (last - first);
        if centre.last { 1.0 - t } else { t }
    };
    has_opposite && pieces.iter().flat_map(|piece| piece.image.uvs()).any(|uv| away(uv) > FARTHEST)
}

/// Whether a surface has no edge: closed or ending in a point in every direction.
fn is_closed_up(surface: &NurbsSurface) -> bool {
    let degenerate = surface.degenerate();
    let ends = |axis: usize| if axis == 1 { degenerate[0] && degenerate[2] } else { degenerate[1] && degenerate[3] };
    (0..2).all(|axis| surface.closed()[axis] || ends(axis))
}

/// A face between two loops that go around a closed surface, in the parametric plane.
struct Cut<'c> {
    chart: &'c Arc<Chart>,
    around: &'c [Ring],
    holes: &'c [Vec<Piece>],
}

impl Cut<'_> {
    /// The shortest straight line between a vertex of one loop and one of the other that crosses no loop: the seam, and
    /// the outer loop that it makes. `number` is the index that the seam will have.
    fn shortest(&self, face: &str, number: usize) -> Option<(NamedCurve, Vec<Piece>)> {
        let [one, other] = self.around else { return None };
        let by = |ring: &Ring| self.chart.of_uv(ring.past) - self.chart.of_uv(DVec2::ZERO);
        let period = by(one);
        if (period + by(other)).length() > 1e-9 * period.length() {
            return None;
        }
        let starts = |ring: &Ring| -> Vec<DVec2> {
            let start = |piece: &Piece| piece.image.point(if piece.forward { 0.0 } else { 1.0 });
            ring.pieces.iter().map(start).collect()
        };
        let mut candidates: Vec<(f64, usize, usize, f64, [DVec2; 2])> = Vec::new();
        for (i, from) in starts(one).into_iter().enumerate() {
            for (j, to) in starts(other).into_iter().enumerate() {
                // The loops may lie on different sheets.
                let turns = ((from - to).dot(period) / period.length_squared()).round();
                for turns in [turns - 1.0, turns, turns + 1.0] {
                    let to = to + period * turns;
                    candidates.push((from.distance(to), i, j, turns, [from, to]));
                }
            }
        }
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let borders = self.borders(period);
        // Its ends lie on the loops.
        let free = |&[a, b]: &[DVec2; 2]| {
            let line = [a.lerp(b, 1e-6), b.lerp(a, 1e-6)];
            !borders.iter().any(|border| crossing_of(line, *border).is_some())
        };
        let (_, i, j, turns, [from, to]) = candidates.into_iter().find(|candidate| free(&candidate.4))?;
        let surface = self.chart.surface();
        let [a, b] = [from, to].map(|p| self.chart.uv(p));
        let trim = Curve::new(&CurveShape::Segment { from: a, to: b }).ok()?;
        let curve = Arc::new(SpaceCurve::on(Arc::clone(surface), trim.clone()));
        let image = Image::of_trim(self.chart, &curve, &trim, DVec2::ZERO);
        let seam =
            NamedCurve { name: format!("{face}: seam"), curve, segments: None, place: String::new(), ends: [0; 2] };
        let rotated = |ring: &Ring, first: usize, by: DVec2| -> Vec<Piece> {
            let moved = |piece: &Piece, by: DVec2| Piece { image: piece.image.clone().moved(by), ..piece.clone() };
            let (before, after) = ring.pieces.split_at(first);
            let after = after.iter().map(|piece| moved(piece, by));
            let past = self.chart.of_uv(ring.past) - self.chart.of_uv(DVec2::ZERO);
            after.chain(before.iter().map(|piece| moved(piece, by + past))).collect()
        };
        let mut pieces = rotated(one, i, DVec2::ZERO);
        pieces.push(Piece { curve: number, image: image.clone().moved(period), forward: true });
        // The other loop comes back by the period that the first one went.
        pieces.extend(rotated(other, j, period * (turns + 1.0)));
        pieces.push(Piece { curve: number, image, forward: false });
        Some((seam, pieces))
    }

    /// The chords of all loops, on the sheets beside one another.
    fn borders(&self, period: DVec2) -> Vec<[DVec2; 2]> {
        let mut chords = Vec::new();
        let around = self.around.iter().map(|ring| &ring.pieces);
        for piece in around.chain(self.holes).flatten() {
            let points: Vec<DVec2> = piece.image.points().collect();
            for turns in -3..=3 {
                let by = period * f64::from(turns);
                chords.extend(points.windows(2).map(|w| [w[0] + by, w[1] + by]));
            }
        }
        chords
    }
}
