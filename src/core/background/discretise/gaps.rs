//! Narrow gaps (docs/algorithm.md, "Narrow gaps"): stretches of curves that face each other at less than the size that
//! is asked for.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::{Division, SHORT};
use crate::core::fault::Fault;
use crate::core::geometry::{CurveId, DomainCurve};
use crate::core::metric::{ForcedSide, Rungs, measure};

/// Curves face each other where their directions differ by at most this sine (30 degrees).
const MOST_SINE: f64 = 0.5;

/// The places per unit length at which a curve is looked at, and the least number of them on a piece.
const PLACES: f64 = 2.0;
const FEWEST_PLACES: f64 = 3.0;

/// How far from the end of a piece the first place is, as a fraction of the distance of two places.
const FIRST: f64 = 1e-3;

/// Unit tangents of one curve that differ by less, at places this near, are of one smooth piece.
const SMOOTH: f64 = 0.01;

/// An end of a piece this near to the end of a rung, as a fraction of the rung, becomes the end of the rung.
const SNAP: f64 = 0.35;

/// What a strip leaves over of a piece is nothing, or at least `LEAST_REST` long in the metric; a shorter rest becomes
/// at least `REST` long.
const LEAST_REST: f64 = 0.5;
const REST: f64 = 0.75;

/// A strip is at least this long in the metric.
const SHORTEST: f64 = 1.0;

/// The part of its width by which a gap may become wider along one segment. Sizes are forced where that is less than
/// `WORTHWHILE` of what is asked for.
const WIDENING: f64 = 0.7;
const WORTHWHILE: f64 = 0.8;

/// Between two places that see the other side one looks again, where the widths differ by more than this ratio or the
/// one in the middle by more than this from their mean; this often at most.
const UNLIKE: f64 = 1.4;
const LOOKS: usize = 24;

/// Ends of strips that differ by this fraction are the same: two bisections have found them.
pub(super) const SAME: f64 = 1e-6;

/// The number of bisections that find the end of a strip.
const BISECTIONS: usize = 30;

/// A part of a piece of a curve, by its parameters; `from` is less than `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    pub curve: CurveId,
    pub piece: usize,
    pub from: f64,
    pub to: f64,
}

/// Two stretches that face each other across a narrow gap.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    pub sides: [Stretch; 2],
    /// Whether it lies on the left of the first.
    pub is_left: bool,
    /// Parameters of places that face each other, from end to end, those on the first side ascending.
    pub rungs: Vec<[f64; 2]>,
}

/// The narrow gaps of a domain.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gaps {
    /// The stretches that face each other, long ones first.
    pub strips: Vec<Strip>,
    /// The ends of strips at which they open abruptly: both ends of such a rung are nodes, so it forces sizes.
    pub mouths: Vec<ForcedSide>,
    /// Places where a gap narrows so quickly that segments must be shorter than asked for.
    pub narrowing: Vec<ForcedSide>,
    /// The rungs of each strip.
    pub rungs: Vec<Rungs>,
    /// Rows of quadrilaterals that are to lie across each.
    pub layers: u32,
}

/// What a ray from a place on a piece meets.
#[derive(Clone, Copy, Debug)]
struct Hit {
    curve: CurveId,
    piece: usize,
    /// Parameter on that curve.
    t: f64,
    /// Length of the ray, and in the metric.
    width: f64,
    metric_width: f64,
    /// Whether both curves run in the same direction.
    alike: bool,
}

/// Two places that face each other.
#[derive(Clone, Copy, Debug)]
struct End {
    s: f64,
    t: f64,
    width: f64,
}

impl Gaps {
    /// The narrow gaps between the curves of a planar domain that have no fixed number of segments: those that are too
    /// narrow for so many layers of the metric. (On surfaces none is looked for.)
    ///
    /// # Errors
    /// If the metric fails.
    pub fn find(division: &Division<'_>, layers: u32) -> Result<Gaps, Fault> {
        let mut found = Vec::new();
        if division.domain.spatial.is_none() {
            for (c, curve) in division.domain.curves.iter().enumerate() {
                for piece in 0..division.pieces[c].len() {
                    for side in [0, 1] {
                        if curve.segments.is_none() && curve.sides[side].is_some() {
                            let curve = CurveId(c as u32);
                            let widest = f64::from(layers);
                            Seen { division, curve, piece, is_left: side == 0, widest }.strips(&mut found)?;
                        }
                    }
                }
            }
        }
        // Long strips win where two overlap.
        let length = |strip: &Strip| division.stretch_length(&strip.sides[0]);
        found.sort_by(|a, b| length(b).total_cmp(&length(a)));
        let mut gaps = Gaps { layers, ..Gaps::default() };
        let mut taken: BTreeMap<(CurveId, usize), Vec<Stretch>> = BTreeMap::new();
        for strip in found {
            let known = |side: &Stretch| taken.get(&(side.curve, side.piece)).into_iter().flatten();
            if strip.sides.iter().all(|side| known(side).all(|other| !side.overlaps(other))) {
                strip.sides.iter().for_each(|side| taken.entry((side.curve, side.piece)).or_default().push(*side));
                gaps.strips.push(strip);
            }
        }
        gaps.mouths = gaps.open_ends(division)?;
        gaps.rungs = gaps.strips.iter().map(|strip| strip.rungs_in_space(division)).collect();
        for rungs in &gaps.rungs {
            for cell in rungs.windows(2) {
                gaps.narrowing.extend(narrowing([cell[0], cell[1]], division)?);
            }
        }
        Ok(gaps)
    }

    /// All that forces sizes.
    pub fn sides(&self) -> Vec<ForcedSide> {
        [self.mouths.as_slice(), self.narrowing.as_slice()].concat()
    }

    /// The ends of strips at the ends of pieces where no other strip goes on.
    fn open_ends(&self, division: &Division<'_>) -> Result<Vec<ForcedSide>, Fault> {
        let tolerance = SAME * division.domain.size;
        let mut ends: Vec<([DVec2; 2], bool)> = Vec::new();
        for strip in &self.strips {
            let [a, b] = &strip.sides;
            for &[s, t] in [&strip.rungs[0], &strip.rungs[strip.rungs.len() - 1]] {
                let is_corner = division.is_piece_end(a, s) || division.is_piece_end(b, t);
                ends.push(([division.point(a.curve, s), division.point(b.curve, t)], is_corner));
            }
        }
        let near = |p: DVec2, q: DVec2| p.distance(q) <= tolerance;
        let same = |[a, b]: [DVec2; 2], [c, d]: [DVec2; 2]| (near(a, c) && near(b, d)) || (near(a, d) && near(b, c));
        let place = |[a, b]: [DVec2; 2]| a.x + b.x;
        ends.sort_by(|a, b| place(a.0).total_cmp(&place(b.0)));
        let mut mouths = Vec::new();
        for &(rung, is_corner) in &ends {
            let from = ends.partition_point(|other| place(other.0) < place(rung) - 4.0 * tolerance);
            let close = ends[from..].iter().take_while(|other| place(other.0) <= place(rung) + 4.0 * tolerance);
            let goes_on = close.filter(|other| same(other.0, rung)).count() > 1;
            if !is_corner || goes_on {
                continue;
            }
            let metric_length = measure::length(&division.metric.metric(rung[0].midpoint(rung[1]))?, rung[1] - rung[0]);
            let layers = f64::from(self.layers);
            if metric_length < SHORT * layers {
                let (ends, size) = (rung.map(|p| p.extend(0.0)), rung[0].distance(rung[1]) / layers);
                mouths.push(ForcedSide { ends, size, metric_size: metric_length / layers });
            }
        }
        Ok(mouths)
    }
}

/// The size along a gap between two rungs, if it must be smaller than asked for: along one segment the gap must not
/// become wider by more than `WIDENING` of its width.
fn narrowing([a, b]: [[DVec3; 2]; 2], division: &Division<'_>) -> Result<Option<ForcedSide>, Fault> {
    let ends = [a, b].map(|[p, q]| p.midpoint(q));
    let [narrow, wide] = [a, b].map(|[p, q]| p.distance(q));
    let length = ends[0].distance(ends[1]);
    let size = WIDENING * 0.5 * (narrow + wide) * length / (wide - narrow).abs();
    let along = (ends[1] - ends[0]).truncate();
    let metric_length = measure::length(&division.metric.metric(ends[0].midpoint(ends[1]).truncate())?, along);
    let metric_size = size * metric_length / length;
    Ok((metric_size < WORTHWHILE).then_some(ForcedSide { ends, size, metric_size }))
}

impl Strip {
    fn rungs_in_space(&self, division: &Division<'_>) -> Rungs {
        let point = |k: usize, t: f64| division.point(self.sides[k].curve, t).extend(0.0);
        self.rungs.iter().map(|&[s, t]| [point(0, s), point(1, t)]).collect()
    }
}

impl Division<'_> {
    fn stretch_length(&self, stretch: &Stretch) -> f64 {
        let piece = &self.pieces[stretch.curve.index()][stretch.piece];
        piece.length_at(stretch.to) - piece.length_at(stretch.from)
    }

    fn is_piece_end(&self, stretch: &Stretch, t: f64) -> bool {
        let piece = &self.pieces[stretch.curve.index()][stretch.piece];
        t == piece.start() || t == piece.end()
    }
}

impl Stretch {
    /// Whether both have more than an end in common and are not the same.
    fn overlaps(&self, other: &Stretch) -> bool {
        let here = self.curve == other.curve && self.piece == other.piece;
        here && self != other && self.to.min(other.to) - self.from.max(other.from) > SAME * (self.to - self.from)
    }
}

/// A side of a piece, from which one looks across.
struct Seen<'a> {
    division: &'a Division<'a>,
    curve: CurveId,
    piece: usize,
    is_left: bool,
    /// The greatest width of a gap, in the metric.
    widest: f64,
}

impl Seen<'_> {
    /// Adds the strips between this side and later pieces.
    fn strips(&self, found: &mut Vec<Strip>) -> Result<(), Fault> {
        let piece = &self.division.pieces[self.curve.index()][self.piece];
        if piece.length() < SHORTEST {
            return Ok(());
        }
        let n = (PLACES * piece.length()).ceil().max(FEWEST_PLACES);
        let share = |k: usize| match k {
            0 => FIRST,
            k if k as f64 >= n => n - FIRST,
            k => k as f64,
        };
        let places: Vec<f64> = (0..=n as usize).map(|k| piece.parameter_at(piece.length() * share(k) / n)).collect();
        let hits: Vec<Option<Hit>> = places.iter().map(|&s| self.look(s)).collect::<Result<_, _>>()?;
        let mut k = 0;
        while k < places.len() {
            let first = k;
            k += 1;
            let Some(hit) = hits[first] else { continue };
            while k < places.len() && hits[k].is_some_and(|next| next.follows(&hits[k - 1].unwrap_or(hit))) {
                k += 1;
            }
            if let Some(strip) = self.strip(&places, &hits, [first, k - 1])? {
                found.push(strip);
            }
        }
        Ok(())
    }

    /// What lies across at a parameter, if it is near and faces this side.
    fn look(&self, s: f64) -> Result<Option<Hit>, Fault> {
        let domain = self.division.domain;
        let own = &domain.curves[self.curve.index()];
        let direction = own.curve.at(s).1.normalize_or_zero();
        let across = self.off(direction);
        let from = own.curve.point(s);
        let metric = self.division.metric.metric(from)?;
        let reach = self.widest / measure::length(&metric, across);
        if direction == DVec2::ZERO || !reach.is_finite() {
            return Ok(None);
        }
        let Some((curve, t)) = domain.first_across(self.curve, s, across, reach) else { return Ok(None) };
        let other = &domain.curves[curve.index()];
        if other.segments.is_some() {
            return Ok(None);
        }
        let piece = self.division.piece_at(curve, t);
        let t = straightened(other, t, from, across);
        let (at, slope) = other.curve.at(t);
        let slope = slope.normalize_or_zero();
        let is_later = (self.curve, self.piece) < (curve, piece);
        if !is_later || self.is_beside(curve, piece) || slope.perp_dot(direction).abs() > MOST_SINE {
            return Ok(None);
        }
        let width = from.distance(at);
        let metric_width = measure::length(&metric, at - from);
        let hit = Hit { curve, piece, t, width, metric_width, alike: slope.dot(direction) > 0.0 };
        Ok((hit.metric_width <= self.widest && width > 0.0).then_some(hit))
    }

    /// Whether a piece begins or ends where this one does: between them there is a corner and no gap.
    fn is_beside(&self, curve: CurveId, piece: usize) -> bool {
        let ends = |c: CurveId, p: usize| {
            let piece = &self.division.pieces[c.index()][p];
            [piece.start(), piece.end()].map(|t| self.division.point(c, t))
        };
        let (own, other) = (ends(self.curve, self.piece), ends(curve, piece));
        let near = |p: DVec2, q: DVec2| p.distance(q) <= 1e-9 * self.division.domain.size;
        own.iter().any(|&p| other.iter().any(|&q| near(p, q)))
    }

    /// The strip of a run of places that face one piece.
    fn strip(&self, places: &[f64], hits: &[Option<Hit>], [i, j]: [usize; 2]) -> Result<Option<Strip>, Fault> {
        let (Some(first), Some(last)) = (hits[i], hits[j]) else { return Ok(None) };
        let own = &self.division.pieces[self.curve.index()][self.piece];
        let before = i.checked_sub(1).map(|k| places[k]);
        let after = places.get(j + 1).copied();
        let mut ends = [self.end(places[i], first, before, own.start())?, self.end(places[j], last, after, own.end())?];
        for k in [0, 1] {
            let Some(end) = self.with_room(ends[k], k == 0, &first)? else { return Ok(None) };
            ends[k] = end;
        }
        let seen: Vec<End> = (i..=j).filter_map(|k| Some(hits[k]?.at(places[k]))).collect();
        let between = seen.into_iter().filter(|end| ends[0].s < end.s && end.s < ends[1].s);
        let coarse: Vec<End> = [ends[0]].into_iter().chain(between).chain([ends[1]]).collect();
        let mut inner = Vec::new();
        for pair in coarse.windows(2) {
            self.look_between([pair[0], pair[1]], &first, LOOKS, &mut inner)?;
            inner.push([pair[1].s, pair[1].t]);
        }
        inner.pop();
        let mut rungs = vec![[ends[0].s, ends[0].t]];
        let onwards = |a: f64, b: f64| if first.alike { a < b } else { a > b };
        for rung in inner {
            if onwards(rungs[rungs.len() - 1][1], rung[1]) && onwards(rung[1], ends[1].t) {
                rungs.push(rung);
            }
        }
        rungs.push([ends[1].s, ends[1].t]);
        let stretch = |curve, piece, a: f64, b: f64| Stretch { curve, piece, from: a.min(b), to: a.max(b) };
        let sides = [
            stretch(self.curve, self.piece, ends[0].s, ends[1].s),
            stretch(first.curve, first.piece, ends[0].t, ends[1].t),
        ];
        let is_long = sides.iter().all(|side| self.division.stretch_length(side) >= SHORTEST);
        let is_one = ends[0].s < ends[1].s && onwards(ends[0].t, ends[1].t);
        Ok((is_long && is_one).then_some(Strip { sides, is_left: self.is_left, rungs }))
    }

    /// Adds the places between two at which the width differs from theirs.
    fn look_between(&self, [a, b]: [End; 2], hit: &Hit, looks: usize, inner: &mut Vec<[f64; 2]>) -> Result<(), Fault> {
        let s = 0.5 * (a.s + b.s);
        let Some(seen) = self.look(s)?.filter(|seen| seen.is_on(hit)) else { return Ok(()) };
        let middle = seen.at(s);
        let unlike = |one: f64, other: f64| one > UNLIKE * other || other > UNLIKE * one;
        if looks > 0 && (unlike(a.width, b.width) || unlike(middle.width, 0.5 * (a.width + b.width))) {
            self.look_between([a, middle], hit, looks - 1, inner)?;
            inner.push([s, middle.t]);
            self.look_between([middle, b], hit, looks - 1, inner)?;
        }
        Ok(())
    }

    /// The direction off the curve on this side.
    fn off(&self, along: DVec2) -> DVec2 {
        if self.is_left { along.perp() } else { -along.perp() }
    }

    /// The direction across at an end of the piece, near a place on it: at a corner the one of the place, since it is
    /// of the same side of the corner.
    fn across(&self, place: f64, limit: f64) -> DVec2 {
        let curve = &self.division.domain.curves[self.curve.index()].curve;
        let [near, end] = [place, limit].map(|s| curve.at(s).1.normalize_or_zero());
        self.off(if end.distance(near) < SMOOTH { end } else { near })
    }

    /// The end of a strip near a place that still faces the other side; the next one, if there is one, does not.
    fn end(&self, place: f64, hit: Hit, next: Option<f64>, limit: f64) -> Result<End, Fault> {
        let mut end = hit.at(place);
        match next {
            None => {
                let other = &self.division.domain.curves[hit.curve.index()];
                end.s = limit;
                end.t = straightened(other, hit.t, self.division.point(self.curve, limit), self.across(place, limit));
            }
            Some(mut beyond) => {
                let mut known = hit;
                for _ in 0..BISECTIONS {
                    let middle = 0.5 * (end.s + beyond);
                    match self
                        .look(middle)?
                        .filter(|next| next.is_on(&known) && (middle < end.s) != next.is_after(&known))
                    {
                        Some(next) => {
                            known = next;
                            end = next.at(middle);
                        }
                        None => beyond = middle,
                    }
                }
            }
        }
        // Ends of pieces that are all but there.
        let division = self.division;
        let snapped = |curve: CurveId, piece: usize, at: f64, room: f64| {
            let piece = &division.pieces[curve.index()][piece];
            let p = division.point(curve, at);
            let near = |t: &f64| division.point(curve, *t).distance(p) <= room;
            // On a closed curve both ends are one point.
            let nearer = if at - piece.start() <= piece.end() - at { piece.start() } else { piece.end() };
            Some(nearer).filter(near).unwrap_or(at)
        };
        end.s = snapped(self.curve, self.piece, end.s, SNAP * end.width);
        end.t = snapped(hit.curve, hit.piece, end.t, SNAP * end.width);
        Ok(end)
    }

    /// The end, or a place farther inside, so that no short piece is left over on either side; `None` if nothing is
    /// across there.
    fn with_room(&self, end: End, is_start: bool, hit: &Hit) -> Result<Option<End>, Fault> {
        let division = self.division;
        let own = &division.pieces[self.curve.index()][self.piece];
        let other = &division.pieces[hit.curve.index()][hit.piece];
        let own_rest = if is_start { own.length_at(end.s) } else { own.length() - own.length_at(end.s) };
        let other_rest =
            if is_start == hit.alike { other.length_at(end.t) } else { other.length() - other.length_at(end.t) };
        let is_short = |rest: f64| rest > 1e-9 && rest < LEAST_REST;
        if !is_short(own_rest) && !is_short(other_rest) {
            return Ok(Some(end));
        }
        let back = REST - own_rest.min(other_rest);
        let length = own.length_at(end.s) + if is_start { back } else { -back };
        if !(0.0..=own.length()).contains(&length) {
            return Ok(None);
        }
        let s = own.parameter_at(length);
        Ok(self.look(s)?.filter(|seen| seen.is_on(hit)).map(|seen| seen.at(s)))
    }
}

impl Hit {
    /// What is seen from a parameter.
    fn at(&self, s: f64) -> End {
        End { s, t: self.t, width: self.width }
    }

    /// Whether both are on one piece, met in the same way.
    fn is_on(&self, other: &Hit) -> bool {
        (self.curve, self.piece, self.alike) == (other.curve, other.piece, other.alike)
    }

    /// Whether it lies where a later place on the first curve should see it.
    fn is_after(&self, other: &Hit) -> bool {
        if self.alike { self.t >= other.t } else { self.t <= other.t }
    }

    /// Whether it goes on from the hit of the place before.
    fn follows(&self, before: &Hit) -> bool {
        self.is_on(before) && self.is_after(before)
    }
}

/// The parameter near `t` at which a curve meets the ray from a point, by Newton's method; its end, where the ray
/// passes that by as little.
pub(super) fn straightened(curve: &DomainCurve, t: f64, from: DVec2, across: DVec2) -> f64 {
    let mut near = t;
    for _ in 0..4 {
        let (p, slope) = curve.curve.at(near);
        let next = (near - (p - from).perp_dot(across) / slope.perp_dot(across)).clamp(0.0, 1.0);
        if next.is_nan() || (next - t).abs() > 1e-3 {
            return t;
        }
        near = next;
    }
    near
}
