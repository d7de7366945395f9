//! Rational B-splines as files have them: homogeneous control points, any knots; cut, reversed, and joined exactly.

use glam::{DVec3, DVec4};

use crate::core::fault::Fault;
use crate::core::geometry::{Basis, NurbsCurve, SpaceShape, cut};

/// A rational B-spline curve in space.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Spline {
    pub degree: usize,
    pub knots: Vec<f64>,
    /// Control points times their weights, and the weights.
    pub points: Vec<DVec4>,
}

impl Spline {
    /// A curve of points and weights (empty: all 1).
    pub fn new(degree: usize, knots: Vec<f64>, points: &[DVec3], weights: &[f64]) -> Spline {
        let weight = |k: usize| weights.get(k).copied().unwrap_or(1.0);
        let points = points.iter().enumerate().map(|(k, p)| (*p * weight(k)).extend(weight(k))).collect();
        Spline { degree, knots, points }
    }

    /// An arc of an ellipse about `centre` with the conjugate half axes `x` and `y`, from one angle to a larger one
    /// (radians), in pieces of at most a quarter ("The NURBS Book", 7.3).
    pub fn ellipse(centre: DVec3, x: DVec3, y: DVec3, [from, to]: [f64; 2]) -> Spline {
        let count = ((to - from) / std::f64::consts::FRAC_PI_2 - 1e-9).ceil().max(1.0);
        let half = 0.5 * (to - from) / count;
        let weight = libm::cos(half);
        let pieces = count as usize;
        let mut knots = vec![from; 3];
        let mut points = Vec::new();
        for k in 0..=2 * pieces {
            let (sin, cos) = libm::sincos(from + half * k as f64);
            // The poles between two pieces lie beyond the ellipse.
            let (reach, w) = if k % 2 == 0 { (1.0, 1.0) } else { (1.0 / weight, weight) };
            points.push(((centre + (x * cos + y * sin) * reach) * w).extend(w));
            if k % 2 == 0 && k > 0 {
                knots.extend([if k == 2 * pieces { to } else { from + half * k as f64 }; 2]);
            }
        }
        knots.push(to);
        Spline { degree: 2, knots, points }
    }

    /// A single piece of second degree by the blossom of its homogeneous points.
    pub fn conic([from, to]: [f64; 2], blossom: impl Fn(f64, f64) -> DVec4) -> Spline {
        let points = vec![blossom(from, from), blossom(from, to), blossom(to, to)];
        Spline { degree: 2, knots: vec![from, from, from, to, to, to], points }
    }

    /// The same curve, checked.
    ///
    /// # Errors
    /// What [`NurbsCurve::new`] refuses.
    pub fn checked(&self) -> Result<NurbsCurve<DVec3>, Fault> {
        NurbsCurve::new(self.degree, self.knots.clone(), &self.weights(), &self.places())
    }

    fn basis(&self) -> Result<Basis, Fault> {
        Basis::new(self.degree, self.knots.clone(), self.points.len())
    }

    /// The weights; empty if all are equal.
    pub fn weights(&self) -> Vec<f64> {
        let first = self.points.first().map_or(1.0, |p| p.w);
        if self.points.iter().all(|p| p.w == first) { Vec::new() } else { self.points.iter().map(|p| p.w).collect() }
    }

    /// The control points.
    pub fn places(&self) -> Vec<DVec3> {
        self.points.iter().map(|p| p.truncate() / p.w).collect()
    }

    /// The part between two parameters, with clamped knots.
    ///
    /// # Errors
    /// What [`Basis::new`] refuses.
    pub fn part(&self, range: [f64; 2]) -> Result<Spline, Fault> {
        let (knots, points) = cut(&self.basis()?, &self.points, range);
        Ok(Spline { degree: self.degree, knots, points })
    }

    /// The whole curve with clamped knots.
    ///
    /// # Errors
    /// What [`Basis::new`] refuses.
    pub fn clamped(&self) -> Result<Spline, Fault> {
        let (first, last) = self.basis()?.domain();
        self.part([first, last])
    }

    /// The clamped curve followed by another one of its degree that begins where it ends.
    pub fn joined(&self, next: &Spline) -> Spline {
        let shift = self.knots[self.knots.len() - 1] - next.knots[0];
        let mut knots = self.knots[..self.knots.len() - 1].to_vec();
        knots.extend(next.knots[next.degree + 1..].iter().map(|knot| knot + shift));
        let scale = self.points[self.points.len() - 1].w / next.points[0].w;
        let mut points = self.points.clone();
        points.extend(next.points[1..].iter().map(|p| *p * scale));
        Spline { degree: self.degree, knots, points }
    }

    /// The same curve in the other direction.
    pub fn reversed(&self) -> Spline {
        let sum = self.knots[0] + self.knots[self.knots.len() - 1];
        let knots = self.knots.iter().rev().map(|knot| sum - knot).collect();
        Spline { degree: self.degree, knots, points: self.points.iter().rev().copied().collect() }
    }

    /// As a curve of a case.
    pub fn shape(&self) -> SpaceShape {
        SpaceShape::Nurbs {
            degree: self.degree,
            knots: self.knots.clone(),
            weights: self.weights(),
            points: self.places(),
        }
    }
}

/// The knot parameter of the point of a curve that is nearest to a place, and the distance: by samples, then Newton's
/// method on the distance with halved steps.
pub(super) fn nearest(curve: &NurbsCurve<DVec3>, place: DVec3) -> (f64, f64) {
    let (first, last) = curve.basis().domain();
    let mut breaks = vec![first];
    breaks.extend(curve.basis().inner_knots().iter().map(|knot| knot.0));
    breaks.push(last);
    let parts = (64 / breaks.len()).max(4) * curve.basis().degree().min(3);
    let mut samples: Vec<(f64, f64)> = Vec::new();
    for w in breaks.windows(2) {
        for k in 0..=parts {
            let t = w[0] + (w[1] - w[0]) * k as f64 / parts as f64;
            samples.push((curve.at(t).0.distance(place), t));
        }
    }
    samples.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut best = (first, f64::INFINITY);
    for &(_, start) in samples.iter().take(6) {
        let mut t = start;
        let mut at = curve.at(t);
        for _ in 0..40 {
            let step = (place - at.0).dot(at.1) / at.1.length_squared().max(f64::MIN_POSITIVE);
            let mut share = 1.0;
            let mut next = (t + step).clamp(first, last);
            while curve.at(next).0.distance(place) > at.0.distance(place) && share > 1e-6 {
                share *= 0.5;
                next = (t + step * share).clamp(first, last);
            }
            let moved = (next - t).abs();
            t = next;
            at = curve.at(t);
            if moved <= 1e-15 * (last - first) {
                break;
            }
        }
        let off = at.0.distance(place);
        if off < best.1 {
            best = (t, off);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_elliptic_arc_lies_on_its_ellipse_and_parts_join_to_the_whole() {
        let (x, y) = (DVec3::new(3.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 1.0));
        let whole = Spline::ellipse(DVec3::ONE, x, y, [0.5, 0.5 + std::f64::consts::TAU]);
        let curve = whole.checked().unwrap();
        let (first, last) = curve.basis().domain();
        for i in 0..=100 {
            let p = curve.at(first + (last - first) * f64::from(i) / 100.0).0 - DVec3::ONE;
            let [a, b] = [p.dot(x) / x.length_squared(), p.dot(y) / y.length_squared()];
            assert!((a * a + b * b - 1.0).abs() < 1e-14 && (p - x * a - y * b).length() < 1e-14);
        }
        let middle = 0.3 * first + 0.7 * last;
        let joined = whole.part([middle, last]).unwrap().joined(&whole.part([first, middle]).unwrap());
        let around = joined.checked().unwrap();
        let (from, to) = around.basis().domain();
        assert!((to - from - (last - first)).abs() < 1e-12);
        for i in 0..=100 {
            let t = middle + (last - first) * f64::from(i) / 100.0;
            let of_whole = if t > last { t - (last - first) } else { t };
            assert!(around.at(t.min(to)).0.distance(curve.at(of_whole.clamp(first, last)).0) < 1e-12);
        }
        let reversed = joined.reversed().checked().unwrap();
        assert!(reversed.at(from).0.distance(around.at(to).0) < 1e-14);
        let (t, off) = nearest(&curve, curve.at(2.0).0);
        assert!((t - 2.0).abs() < 1e-9 && off < 1e-12, "{t} {off}");
    }
}
