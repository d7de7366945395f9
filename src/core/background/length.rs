//! Metric lengths of curves: a table of the arclength of each smooth piece (docs/algorithm.md, "Curves divided at equal
//! metric length"), and its number of segments.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::core::fault::Fault;
use crate::core::geometry::assembly::placed;
use crate::core::geometry::{DomainCurve, Turning};
use crate::core::kernel::decimal::point_text;
use crate::core::metric::MetricSource;

/// The shape asks for no segment more because of rounding.
const ROUNDING: f64 = 1e-6;

/// What is measured along a curve.
pub struct Along<'a> {
    /// The images of the curve in the plane: one, except on surfaces.
    pub images: Vec<&'a DomainCurve>,
    /// The sizes.
    pub metric: &'a dyn MetricSource,
    /// Where sizes alone would lose its shape: how it turns, which is a length too.
    pub turning: Option<&'a Turning>,
}

/// A piece of a curve between two corners.
pub struct Piece {
    /// Parameters and metric lengths from the start of the piece, ascending; the quadrature is accurate between two
    /// entries.
    table: Vec<(f64, f64)>,
    /// Number of segments.
    pub segments: u32,
    /// The least number of segments that keeps its shape.
    pub least: u32,
    /// The number of the tie of pieces across a narrow gap that it belongs to.
    pub tie: Option<u32>,
}

impl Piece {
    /// One segment.
    fn with_table(table: Vec<(f64, f64)>) -> Piece {
        Piece { table, segments: 1, least: 1, tie: None }
    }

    /// Metric length.
    pub fn length(&self) -> f64 {
        self.table[self.table.len() - 1].1
    }

    /// Parameter at its start.
    pub fn start(&self) -> f64 {
        self.table[0].0
    }

    /// Metric length from its start to a parameter of it, linear between entries of the table.
    pub fn length_at(&self, t: f64) -> f64 {
        let k = self.table.partition_point(|entry| entry.0 <= t).clamp(1, self.table.len() - 1);
        let ((t0, l0), (t1, l1)) = (self.table[k - 1], self.table[k]);
        l0 + (l1 - l0) * ((t - t0) / (t1 - t0)).clamp(0.0, 1.0)
    }

    /// The parameter at a metric length from its start, linear between entries of the table.
    pub fn parameter_at(&self, length: f64) -> f64 {
        let k = self.table.partition_point(|entry| entry.1 <= length).clamp(1, self.table.len() - 1);
        let ((t0, l0), (t1, l1)) = (self.table[k - 1], self.table[k]);
        t0 + (t1 - t0) * ((length - l0) / (l1 - l0).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
    }

    /// Divides it at a parameter inside; the two parts have one segment each.
    ///
    /// # Errors
    /// If the metric fails.
    pub fn cut(&self, along: &Along<'_>, t: f64) -> Result<[Piece; 2], Fault> {
        let k = self.table.partition_point(|entry| entry.0 < t).max(1);
        let (before, length) = self.table[k - 1];
        let here = length + gauss(along, before, t)?;
        let mut first = self.table[..k].to_vec();
        first.push((t, here));
        let rest = self.table[k..].iter().filter(|entry| entry.0 > t).map(|&(t, length)| (t, length - here));
        let second = [(t, 0.0)].into_iter().chain(rest).collect();
        Ok([first, second].map(Piece::with_table))
    }

    /// Parameter at its end.
    pub fn end(&self) -> f64 {
        self.table[self.table.len() - 1].0
    }

    /// Divides it at an inner entry of its table; the two parts share its segments, and an even number of additional
    /// ones, by their lengths. `None` if there is no such entry.
    pub fn split(&self, t: f64) -> Option<[Piece; 2]> {
        let k = self.table.iter().position(|entry| entry.0 == t).filter(|&k| k > 0 && k + 1 < self.table.len())?;
        let before = self.table[k].1;
        let rest = self.table[k..].iter().map(|&(t, length)| (t, length - before)).collect();
        let mut parts = [self.table[..=k].to_vec(), rest].map(Piece::with_table);
        let share = |part: &Piece| (part.length() / self.segment_length()).round().max(1.0) as u32;
        parts.iter_mut().for_each(|part| part.segments = share(part));
        let all: u32 = parts.iter().map(|part| part.segments).sum();
        let wanted = all.max(self.segments);
        give(&mut parts, wanted + (wanted - self.segments) % 2 - all);
        Some(parts)
    }

    /// The deviation of the segment length from 1 for `n` segments.
    pub fn error(&self, n: u32) -> f64 {
        (self.length() / f64::from(n) - 1.0).abs()
    }

    /// Metric length of its segments.
    pub fn segment_length(&self) -> f64 {
        self.length() / f64::from(self.segments)
    }

    /// The parameters that divide it into its segments at equal metric arclength, without the ends.
    ///
    /// # Errors
    /// If the metric fails.
    pub fn divisions(&self, along: &Along<'_>) -> Result<Vec<f64>, Fault> {
        let mut at = 0;
        (1..self.segments)
            .map(|k| {
                let target = self.length() * (f64::from(k) / f64::from(self.segments));
                while at + 2 < self.table.len() && self.table[at + 1].1 <= target {
                    at += 1;
                }
                parameter(along, [self.table[at], self.table[at + 1]], target, 1e-7 * self.segment_length())
            })
            .collect()
    }

    /// Whether its segments keep the shape of its curve, which turns like this. Notes the number that would.
    ///
    /// # Errors
    /// If the metric fails.
    pub fn keeps_shape(&mut self, along: &Along<'_>, turning: &Turning) -> Result<bool, Fault> {
        let (start, end) = (self.table[0].0, self.end());
        let asked = turning.between(start, end);
        // One segment, or segments of equal turning, would do.
        self.least = at_least(asked);
        if asked <= 1.0 {
            return Ok(true);
        }
        let places = [vec![start], self.divisions(along)?, vec![end]].concat();
        let most = places.windows(2).map(|w| turning.between(w[0], w[1])).fold(0.0, f64::max);
        self.least = self.least.max(at_least(most * f64::from(self.segments)));
        Ok(self.segments >= self.least)
    }

    /// Gives it the number of segments closest to its length; by turning, no longer ones.
    pub fn divide(&mut self, along: &Along<'_>) {
        self.segments = (self.length().round() as u32).max(1);
        if along.turning.is_some() {
            self.least = at_least(self.length());
            self.segments = self.least;
        }
    }
}

/// The least number of segments whose lengths are at most 1.
fn at_least(length: f64) -> u32 {
    (length - ROUNDING).ceil().max(1.0) as u32
}

/// The pieces of a curve between its corners and the parameters `besides`, ascending, with one segment each. The tables
/// are bisected until the quadrature converges.
///
/// # Errors
/// If the metric fails or the length overflows.
pub fn measure(along: &Along<'_>, besides: &[f64]) -> Result<Vec<Piece>, Fault> {
    let curve = along.images[0];
    let merged = |own: &[f64]| {
        if besides.is_empty() {
            return own.to_vec();
        }
        let mut all = [own, besides].concat();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    };
    let corners = merged(curve.curve.corners());
    let breaks = merged(&curve.curve.breaks());
    // Start finely enough to miss no feature of the metric; a polyline of many pieces is already fine.
    let parts = (64 / (breaks.len() - 1)).clamp(2, 32);
    let mut pieces: Vec<Piece> = Vec::new();
    let mut table = vec![(0.0, 0.0)];
    let mut stack = Vec::new();
    for w in breaks.windows(2) {
        for i in (0..parts).rev() {
            let at = |i: usize| if i == parts { w[1] } else { w[0] + (w[1] - w[0]) * i as f64 / parts as f64 };
            stack.push((at(i), at(i + 1), None, 0));
        }
        while let Some((a, b, known, depth)) = stack.pop() {
            let whole = match known {
                Some(length) => length,
                None => gauss(along, a, b)?,
            };
            let middle = 0.5 * (a + b);
            let (first, second) = (gauss(along, a, middle)?, gauss(along, middle, b)?);
            let both = first + second;
            if (both - whole).abs() <= 1e-6 + 1e-7 * both || depth >= 30 || table.len() > 2_000_000 {
                let before: f64 = table[table.len() - 1].1;
                table.push((middle, before + first));
                table.push((b, before + both));
            } else {
                stack.push((middle, b, Some(second), depth + 1));
                stack.push((a, middle, Some(first), depth + 1));
            }
        }
        if w[1] >= 1.0 || corners.get(pieces.len()).is_some_and(|&t| t <= w[1]) {
            pieces.push(Piece::with_table(std::mem::replace(&mut table, vec![(w[1], 0.0)])));
        }
    }
    Ok(pieces)
}

/// Gives `more` segments one by one to the piece whose segments are longest.
pub fn give(pieces: &mut [Piece], more: u32) {
    // The bits of positive numbers sort like the numbers; ties go to the first.
    let key = |pieces: &[Piece], i: usize| (pieces[i].segment_length().to_bits(), Reverse(i));
    let mut heap: BinaryHeap<_> = (0..pieces.len()).map(|i| key(pieces, i)).collect();
    for _ in 0..more {
        let Some((_, Reverse(i))) = heap.pop() else { return };
        pieces[i].segments += 1;
        heap.push(key(pieces, i));
    }
}

/// Gives pieces so many segments that they have at least this number together.
pub fn give_least(pieces: &mut [Piece], least: u32) {
    let few: u32 = pieces.iter().map(|piece| piece.segments).sum();
    give(pieces, least.saturating_sub(few));
}

/// Gives pieces so many segments more, or fewer, but at least one each.
pub fn give_or_take(pieces: &mut [Piece], more: i32) {
    if more != 0 {
        let number: u32 = pieces.iter().map(|piece| piece.segments).sum();
        share_out(pieces, number.saturating_add_signed(more).max(pieces.len() as u32));
    }
}

/// Distributes `n` segments, at least one per piece, among the pieces in proportion to their lengths.
pub fn share_out(pieces: &mut [Piece], n: u32) {
    let total: f64 = pieces.iter().map(Piece::length).sum();
    let spare = f64::from(n) - pieces.len() as f64;
    // Rounded down, and at least one: the sum is at most n.
    pieces.iter_mut().for_each(|p| p.segments = ((p.length() / total * spare) as u32).max(1));
    let given: u32 = pieces.iter().map(|p| p.segments).sum();
    give(pieces, n - given);
}

/// The parameter between two entries of a table at which the length is `target`, by Newton's method within a bracket.
fn parameter(along: &Along<'_>, [from, to]: [(f64, f64); 2], target: f64, tolerance: f64) -> Result<f64, Fault> {
    let (mut low, mut high) = (from.0, to.0);
    let mut t = from.0 + (to.0 - from.0) * ((target - from.1) / (to.1 - from.1)).clamp(0.0, 1.0);
    for _ in 0..50 {
        let off = from.1 + gauss(along, from.0, t)? - target;
        if off.abs() <= tolerance || high - low <= 4.0 * f64::EPSILON * high.abs() {
            break;
        }
        if off > 0.0 {
            high = t;
        } else {
            low = t;
        }
        let next = t - off / speed(along, t)?;
        t = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    Ok(t)
}

/// Metric length of the derivative at `t`, or by turning the segments that the shape asks for, whichever is more. The
/// length is the same on every face of the curve, unless sizes depend on the surface: then the smallest sizes count.
fn speed(&Along { ref images, metric, turning }: &Along<'_>, t: f64) -> Result<f64, Fault> {
    let mut fastest = 0.0_f64;
    for curve in images {
        let (p, d) = curve.curve.at(t);
        let m = metric.metric(p).map_err(|bad| {
            let place = format!("on the curve \"{}\" at {}", curve.name, point_text(bad.place.uv));
            placed(Fault::new(bad.what.clone()).at(place), &curve.place)
        })?;
        let square = m.norm2(d);
        if !square.is_finite() {
            let fault = Fault::new(format!("The curve \"{}\" is infinitely many target sizes long", curve.name))
                .at(format!("at {}", point_text(p)));
            return Err(placed(fault.remedy("Increase the sizes there"), &curve.place));
        }
        fastest = fastest.max(square.max(0.0).sqrt());
    }
    Ok(turning.map_or(fastest, |turning| fastest.max(turning.rate(t))))
}

/// Metric length between two parameters by three-point Gauss quadrature.
fn gauss(along: &Along<'_>, a: f64, b: f64) -> Result<f64, Fault> {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    // sqrt(3/5)
    let off = 0.774_596_669_241_483_4 * half;
    let ends = speed(along, middle - off)? + speed(along, middle + off)?;
    Ok(half * (5.0 * ends + 8.0 * speed(along, middle)?) / 9.0)
}
