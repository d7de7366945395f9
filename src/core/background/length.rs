//! Metric lengths of curves: each smooth piece with a table of its arclength (docs/algorithm.md, "Curves divided at
//! equal metric length"), and how many segments it is to have.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::core::fault::Fault;
use crate::core::geometry::domain_curve::DomainCurve;
use crate::core::kernel::decimal::point_text;
use crate::core::metric::field::MetricSource;

/// A piece of a curve between two corners.
pub struct Piece {
    /// Parameters and metric lengths from the piece's start, ascending; between two the curve is resolved.
    table: Vec<(f64, f64)>,
    /// Number of segments that it is to have.
    pub segments: u32,
}

impl Piece {
    /// Metric length.
    pub fn length(&self) -> f64 {
        self.table[self.table.len() - 1].1
    }

    /// Parameter at its end.
    pub fn end(&self) -> f64 {
        self.table[self.table.len() - 1].0
    }

    /// Divides it at an entry of its table, its segments shared among the two by their lengths, with an even number
    /// more than before or none; `None` where there is no such entry inside.
    pub fn parted(&self, t: f64) -> Option<[Piece; 2]> {
        let k = self.table.iter().position(|entry| entry.0 == t).filter(|&k| k > 0 && k + 1 < self.table.len())?;
        let before = self.table[k].1;
        let rest = self.table[k..].iter().map(|&(t, length)| (t, length - before)).collect();
        let mut parts = [self.table[..=k].to_vec(), rest].map(|table| Piece { table, segments: 1 });
        let share = |part: &Piece| (part.length() / self.stretched()).round().max(1.0) as u32;
        parts.iter_mut().for_each(|part| part.segments = share(part));
        let all: u32 = parts.iter().map(|part| part.segments).sum();
        let wanted = all.max(self.segments);
        give(&mut parts, wanted + (wanted - self.segments) % 2 - all);
        Some(parts)
    }

    /// How far metric lengths are from 1 when divided into `n` segments.
    pub fn error(&self, n: u32) -> f64 {
        (self.length() / f64::from(n) - 1.0).abs()
    }

    /// Metric length of its segments.
    pub fn stretched(&self) -> f64 {
        self.length() / f64::from(self.segments)
    }

    /// Parameters that divide it into its segments at equal metric arclength, ends left out.
    ///
    /// # Errors
    /// Where the metric fails.
    pub fn divisions(&self, images: &[&DomainCurve], metric: &dyn MetricSource) -> Result<Vec<f64>, Fault> {
        let mut at = 0;
        (1..self.segments)
            .map(|k| {
                let target = self.length() * (f64::from(k) / f64::from(self.segments));
                while at + 2 < self.table.len() && self.table[at + 1].1 <= target {
                    at += 1;
                }
                parameter(images, metric, [self.table[at], self.table[at + 1]], target, 1e-7 * self.stretched())
            })
            .collect()
    }
}

/// The pieces of a curve, given by all its images in the plane (one, but on surfaces), between its corners, their
/// tables halved until the quadrature agrees with itself; one segment each for now.
///
/// # Errors
/// Where the metric fails or is so large that the length overflows.
pub fn measure(images: &[&DomainCurve], metric: &dyn MetricSource) -> Result<Vec<Piece>, Fault> {
    let curve = images[0];
    let corners = curve.curve.corners();
    let breaks = curve.curve.breaks();
    // So fine at first that no feature of the metric is missed; a polyline of many pieces is that fine by itself.
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
                None => gauss(images, metric, a, b)?,
            };
            let middle = 0.5 * (a + b);
            let (first, second) = (gauss(images, metric, a, middle)?, gauss(images, metric, middle, b)?);
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
            pieces.push(Piece { table: std::mem::replace(&mut table, vec![(w[1], 0.0)]), segments: 1 });
        }
    }
    Ok(pieces)
}

/// Gives `more` segments one by one to the piece whose segments are longest.
pub fn give(pieces: &mut [Piece], more: u32) {
    // The bits of positive numbers are in their order; ties go to the first.
    let key = |pieces: &[Piece], i: usize| (pieces[i].stretched().to_bits(), Reverse(i));
    let mut heap: BinaryHeap<_> = (0..pieces.len()).map(|i| key(pieces, i)).collect();
    for _ in 0..more {
        let Some((_, Reverse(i))) = heap.pop() else { return };
        pieces[i].segments += 1;
        heap.push(key(pieces, i));
    }
}

/// Divides `n` segments, no fewer than there are pieces, among them: in proportion to their lengths, one at least.
pub fn share_out(pieces: &mut [Piece], n: u32) {
    let total: f64 = pieces.iter().map(Piece::length).sum();
    let spare = f64::from(n) - pieces.len() as f64;
    // Rounded down, and at least one: never more than n together.
    pieces.iter_mut().for_each(|p| p.segments = ((p.length() / total * spare) as u32).max(1));
    let given: u32 = pieces.iter().map(|p| p.segments).sum();
    give(pieces, n - given);
}

/// A fault about a curve, placed where the case has it.
pub fn about(curve: &DomainCurve, fault: Fault) -> Fault {
    if curve.place.is_empty() { fault } else { fault.at(curve.place.clone()) }
}

/// The parameter between two entries of a table at which the length is `target`, by Newton within a bracket.
fn parameter(
    images: &[&DomainCurve],
    metric: &dyn MetricSource,
    [from, to]: [(f64, f64); 2],
    target: f64,
    tolerance: f64,
) -> Result<f64, Fault> {
    let (mut low, mut high) = (from.0, to.0);
    let mut t = from.0 + (to.0 - from.0) * ((target - from.1) / (to.1 - from.1)).clamp(0.0, 1.0);
    for _ in 0..50 {
        let off = from.1 + gauss(images, metric, from.0, t)? - target;
        if off.abs() <= tolerance || high - low <= 4.0 * f64::EPSILON * high.abs() {
            break;
        }
        if off > 0.0 {
            high = t;
        } else {
            low = t;
        }
        let next = t - off / speed(images, metric, t)?;
        t = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    Ok(t)
}

/// Metric length of the derivative at `t`: on every face of the curve the same, but where sizes depend on the surface,
/// of which the smallest rule.
fn speed(images: &[&DomainCurve], metric: &dyn MetricSource, t: f64) -> Result<f64, Fault> {
    let mut fastest = 0.0_f64;
    for curve in images {
        let (p, d) = curve.curve.at(t);
        let m = metric.metric(p).map_err(|bad| {
            let place = format!("on the curve \"{}\" at {}", curve.name, point_text(bad.place.uv));
            about(curve, Fault::new(bad.what.clone()).at(place))
        })?;
        let square = m.norm2(d);
        if !square.is_finite() {
            let fault = Fault::new(format!("The curve \"{}\" is no finite number of target sizes long", curve.name));
            return Err(about(curve, fault.at(format!("at {}", point_text(p))).remedy("Ask for larger sizes there")));
        }
        fastest = fastest.max(square.max(0.0).sqrt());
    }
    Ok(fastest)
}

/// Metric length between two parameters by three-point Gauss quadrature.
fn gauss(images: &[&DomainCurve], metric: &dyn MetricSource, a: f64, b: f64) -> Result<f64, Fault> {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    // sqrt(3/5)
    let off = 0.774_596_669_241_483_4 * half;
    let ends = speed(images, metric, middle - off)? + speed(images, metric, middle + off)?;
    Ok(half * (5.0 * ends + 8.0 * speed(images, metric, middle)?) / 9.0)
}
