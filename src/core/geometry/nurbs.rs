//! Rational B-splines after Piegl & Tiller, "The NURBS Book": the basis with its derivatives (A2.1, A2.3), which
//! surfaces use too, and curves (A4.2) in the plane and in space.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Sub};

use glam::{DVec2, DVec3, DVec4};
use smallvec::SmallVec;

use crate::core::fault::Fault;

/// Values of the `degree + 1` basis functions that do not vanish on a span.
pub type BasisValues = SmallVec<[f64; 8]>;

/// A B-spline basis: degree and knots.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    degree: usize,
    knots: Vec<f64>,
}

impl Basis {
    /// The basis of `count` functions of the given degree over the given knots.
    ///
    /// # Errors
    /// Degree 0, too few functions, a wrong number of knots, knots that are not finite or decrease, an empty domain,
    /// and a knot repeated so often that the curve would be discontinuous there.
    pub fn new(degree: usize, knots: Vec<f64>, count: usize) -> Result<Self, Fault> {
        if degree == 0 {
            return Err(Fault::new("The degree of a NURBS is 0").remedy("Give a degree of at least 1"));
        }
        if count <= degree {
            return Err(Fault::new(format!(
                "A NURBS of degree {degree} needs at least {} control points and has {count}",
                degree.saturating_add(1)
            ))
            .remedy("Lower the degree, or add control points"));
        }
        let wanted = count + degree + 1;
        if knots.len() != wanted {
            return Err(Fault::new(format!(
                "A NURBS with {count} control points of degree {degree} needs {wanted} knots and has {}",
                knots.len()
            ))
            .remedy("The number of knots must be that of the control points plus the degree plus 1"));
        }
        if let Some(i) = knots.iter().position(|k| !k.is_finite()) {
            return Err(Fault::new(format!("Knot {} is not a finite number", i + 1)));
        }
        if let Some(i) = (1..knots.len()).find(|&i| knots[i] < knots[i - 1]) {
            return Err(Fault::new(format!(
                "Knot {} ({}) is less than the one before it ({})",
                i + 1,
                knots[i],
                knots[i - 1]
            ))
            .remedy("Give the knots in ascending order"));
        }
        let (first, last) = (knots[degree], knots[count]);
        if last <= first || !(last - first).is_finite() {
            return Err(Fault::new(format!(
                "The knots give the NURBS an empty parameter range, from {first} to {last}"
            )));
        }
        let mut start = 0;
        for end in 1..=knots.len() {
            if end < knots.len() && knots[end] == knots[start] {
                continue;
            }
            let (times, knot) = (end - start, knots[start]);
            let most = if knot > first && knot < last { degree } else { degree + 1 };
            if times > most {
                return Err(Fault::new(format!(
                    "The knot {knot} occurs {times} times; at degree {degree} it may occur {most} times there"
                ))
                .remedy("Remove knots, or divide the curve there"));
            }
            start = end;
        }
        Ok(Basis { degree, knots })
    }

    /// The degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The knots.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// First and last parameter of the curve.
    pub fn domain(&self) -> (f64, f64) {
        (self.knots[self.degree], self.knots[self.knots.len() - 1 - self.degree])
    }

    /// The inner knots of the domain, ascending, each with its multiplicity.
    pub fn inner_knots(&self) -> Vec<(f64, usize)> {
        let (first, last) = self.domain();
        let mut found: Vec<(f64, usize)> = Vec::new();
        for &knot in self.knots.iter().filter(|&&k| k > first && k < last) {
            match found.last_mut() {
                Some((value, times)) if *value == knot => *times += 1,
                _ => found.push((knot, 1)),
            }
        }
        found
    }

    /// The inner knots, ascending, as parameters in [0, 1] relative to the domain.
    pub fn unit_knots(&self) -> impl Iterator<Item = f64> {
        let (first, last) = self.domain();
        self.inner_knots().into_iter().map(move |(knot, _)| (knot - first) / (last - first))
    }

    /// The span `i` with `knots[i] <= t < knots[i+1]`, the last one at the end of the domain (A2.1).
    pub fn span(&self, t: f64) -> usize {
        let (low, high) = (self.degree, self.knots.len() - 1 - self.degree);
        let span = self.knots.partition_point(|&k| k <= t).saturating_sub(1).clamp(low, high - 1);
        // At the end of the domain (and where the last knots are repeated), the last span that is not empty.
        (low..=span).rev().find(|&i| self.knots[i + 1] > self.knots[i]).unwrap_or(low)
    }

    /// Basis functions and their derivatives up to `order` at `t` in the span (A2.3): `[derivative][function]` for the
    /// functions `span - degree ..= span`.
    pub fn derivatives(&self, span: usize, t: f64, order: usize) -> SmallVec<[BasisValues; 3]> {
        let p = self.degree;
        let u = &self.knots;
        // ndu: basis functions above and on the diagonal, knot differences below.
        let w = p + 1;
        let mut ndu: SmallVec<[f64; 32]> = SmallVec::from_elem(0.0, w * w);
        let (mut left, mut right) = (BasisValues::from_elem(0.0, w), BasisValues::from_elem(0.0, w));
        ndu[0] = 1.0;
        for j in 1..=p {
            left[j] = t - u[span + 1 - j];
            right[j] = u[span + j] - t;
            let mut saved = 0.0;
            for r in 0..j {
                ndu[j * w + r] = right[r + 1] + left[j - r];
                let temp = ndu[r * w + j - 1] / ndu[j * w + r];
                ndu[r * w + j] = saved + right[r + 1] * temp;
                saved = left[j - r] * temp;
            }
            ndu[j * w + j] = saved;
        }
        let mut ders: SmallVec<[BasisValues; 3]> = SmallVec::from_elem(BasisValues::from_elem(0.0, w), order + 1);
        for j in 0..=p {
            ders[0][j] = ndu[j * w + p];
        }
        let mut a = [BasisValues::from_elem(0.0, w), BasisValues::from_elem(0.0, w)];
        for r in 0..=p {
            let (mut s1, mut s2) = (0, 1);
            a[0][0] = 1.0;
            for k in 1..=order.min(p) {
                let mut d = 0.0;
                let pk = p - k;
                if r >= k {
                    a[s2][0] = a[s1][0] / ndu[(pk + 1) * w + r - k];
                    d = a[s2][0] * ndu[(r - k) * w + pk];
                }
                let j1 = if r + 1 >= k { 1 } else { k - r };
                let j2 = if r <= pk + 1 { k - 1 } else { p - r };
                for j in j1..=j2 {
                    a[s2][j] = (a[s1][j] - a[s1][j - 1]) / ndu[(pk + 1) * w + r + j - k];
                    d += a[s2][j] * ndu[(r + j - k) * w + pk];
                }
                if r <= pk {
                    a[s2][k] = -a[s1][k - 1] / ndu[(pk + 1) * w + r];
                    d += a[s2][k] * ndu[r * w + pk];
                }
                ders[k][r] = d;
                std::mem::swap(&mut s1, &mut s2);
            }
        }
        let mut factor = p as f64;
        for k in 1..=order.min(p) {
            for j in 0..=p {
                ders[k][j] *= factor;
            }
            factor *= (p - k) as f64;
        }
        ders
    }
}

/// Vectors of the plane or of space, as control points.
pub trait Vector:
    Copy
    + Debug
    + Default
    + PartialEq
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
}

impl Vector for DVec2 {}
impl Vector for DVec3 {}
/// Homogeneous points of space.
impl Vector for DVec4 {}

/// Control points times their weights, and the weights. Only ratios of weights matter, so the largest is scaled to 1
/// and no product overflows.
///
/// # Errors
/// Points that are not finite; weights that are not positive and finite, or differ in number from the points.
pub fn weighted<P: Vector>(points: &[P], weights: &[f64]) -> Result<Vec<(P, f64)>, Fault> {
    if !weights.is_empty() && weights.len() != points.len() {
        return Err(Fault::new(format!("A NURBS with {} control points has {} weights", points.len(), weights.len()))
            .remedy("Give one weight for each point, or none"));
    }
    // A component that is not finite times zero is NaN.
    if let Some(i) = points.iter().position(|&p| p * 0.0 != P::default()) {
        return Err(Fault::new(format!("Control point {} is not finite", i + 1)));
    }
    if let Some(i) = weights.iter().position(|w| !(w.is_finite() && *w > 0.0)) {
        return Err(
            Fault::new(format!("Weight {} is {}", i + 1, weights[i])).remedy("Weights must be positive and finite")
        );
    }
    let largest = weights.iter().copied().fold(0.0, f64::max);
    let weight = |i: usize| weights.get(i).map_or(1.0, |w| w / largest);
    if let Some(i) = (0..points.len()).find(|&i| weight(i) < 1e-100) {
        return Err(Fault::new(format!("Weight {} is negligible compared with the largest", i + 1)));
    }
    Ok(points.iter().enumerate().map(|(i, &p)| (p * weight(i), weight(i))).collect())
}

/// A rational B-spline curve, by default in the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsCurve<P = DVec2> {
    basis: Basis,
    /// Control points times their weights, and the weights.
    weighted: Vec<(P, f64)>,
}

impl<P: Vector> NurbsCurve<P> {
    /// A curve; an empty list of weights means that all are 1.
    ///
    /// # Errors
    /// What [`Basis::new`] refuses, points that are not finite, and weights that are not one positive number for each.
    pub fn new(degree: usize, knots: Vec<f64>, weights: &[f64], points: &[P]) -> Result<Self, Fault> {
        let basis = Basis::new(degree, knots, points.len())?;
        let weighted = weighted(points, weights)?;
        Ok(NurbsCurve { basis, weighted })
    }

    /// The basis.
    pub fn basis(&self) -> &Basis {
        &self.basis
    }

    /// The control points.
    pub fn control_points(&self) -> impl Iterator<Item = P> + '_ {
        self.weighted.iter().map(|&(p, w)| p / w)
    }

    /// The control points times their weights, and the weights.
    pub fn weighted_points(&self) -> &[(P, f64)] {
        &self.weighted
    }

    /// Point and first derivative at the knot parameter `t` (A4.2); at an inner knot the right-hand derivative.
    pub fn at(&self, t: f64) -> (P, P) {
        self.at_in(self.basis.span(t), t)
    }

    /// Point and first derivative at `t`, with the polynomial piece of the given span: at a knot, this selects the
    /// left-hand or the right-hand derivative.
    pub fn at_in(&self, span: usize, t: f64) -> (P, P) {
        let ders = self.basis.derivatives(span, t, 1);
        let first = span - self.basis.degree;
        let (mut a, mut w, mut da, mut dw) = (P::default(), 0.0, P::default(), 0.0);
        for (j, &(point, weight)) in self.weighted[first..=span].iter().enumerate() {
            a += point * ders[0][j];
            w += ders[0][j] * weight;
            da += point * ders[1][j];
            dw += ders[1][j] * weight;
        }
        let p = a / w;
        (p, (da - p * dw) / w)
    }

    /// Point and derivative by `t` at the parameter `t` in [0, 1], relative to the domain.
    pub fn at_unit(&self, t: f64) -> (P, P) {
        let (first, last) = self.basis.domain();
        let (p, d) = self.at(if t >= 1.0 { last } else { (first + t * (last - first)).min(last) });
        (p, d * (last - first))
    }

    /// The inner knots, as parameters in [0, 1], at which the derivatives before and after make `is_sharp` true.
    pub fn sharp_knots(&self, is_sharp: impl Fn(P, P) -> bool) -> Vec<f64> {
        // A knot of multiplicity below the degree leaves the curve smooth.
        let sharp = |&(knot, times): &(f64, usize)| {
            times >= self.basis.degree
                && is_sharp(self.at_in(self.basis.span(knot.next_down()), knot).1, self.at(knot).1)
        };
        let knots = self.basis.inner_knots();
        knots.iter().zip(self.basis.unit_knots()).filter(|(knot, _)| sharp(knot)).map(|(_, t)| t).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit circle as a rational quadratic with nine control points.
    fn circle() -> NurbsCurve {
        let h = 0.5_f64.sqrt();
        let points = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
            .map(|(x, y)| DVec2::new(f64::from(x), f64::from(y)));
        let knots = vec![0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0];
        NurbsCurve::new(2, knots, &[1.0, h, 1.0, h, 1.0, h, 1.0, h, 1.0], &points).unwrap()
    }

    #[test]
    fn a_rational_quadratic_is_a_circle_and_its_derivative_is_tangent() {
        let circle = circle();
        for i in 0..=1000 {
            let t = f64::from(i) / 1000.0;
            let (p, d) = circle.at(t);
            assert!((p.length() - 1.0).abs() < 1e-12, "{t}: {p}");
            assert!(p.dot(d).abs() < 1e-12 * d.length());
            if i > 0 && i < 1000 {
                let e = 1e-6;
                let slope = (circle.at(t + e).0 - circle.at(t - e).0) / (2.0 * e);
                assert!((slope - d).length() < 1e-3, "{t}: {slope} {d}");
            }
        }
    }

    #[test]
    fn a_basis_of_any_degree_sums_to_one_and_its_derivatives_to_zero() {
        for degree in 1..=12 {
            let count = degree + 5;
            let mut knots = vec![0.0; degree + 1];
            knots.extend([0.1, 0.4, 0.4, 0.9]);
            knots.extend(vec![2.0; degree + 1]);
            if degree == 1 {
                knots[4] = 0.5;
            }
            let basis = Basis::new(degree, knots, count).unwrap();
            for i in 0..=40 {
                let t = f64::from(i) * 0.05;
                let ders = basis.derivatives(basis.span(t), t, 2);
                assert!((ders[0].iter().sum::<f64>() - 1.0).abs() < 1e-13);
                assert!(ders[0].iter().all(|&v| v >= 0.0));
                assert!(ders[1].iter().sum::<f64>().abs() < 1e-9 * (degree * degree) as f64);
                assert!(ders[2].iter().sum::<f64>().abs() < 1e-7 * (degree * degree * degree) as f64);
            }
        }
    }

    #[test]
    fn a_cubic_bezier_agrees_with_its_bernstein_form() {
        let points = [(0.0, 0.0), (1.0, 2.0), (3.0, -1.0), (4.0, 0.5)].map(|(x, y)| DVec2::new(x, y));
        let curve = NurbsCurve::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], &[], &points).unwrap();
        for i in 0..=10 {
            let t = f64::from(i) / 10.0;
            let s = 1.0 - t;
            let p = s * s * s * points[0]
                + 3.0 * s * s * t * points[1]
                + 3.0 * s * t * t * points[2]
                + t * t * t * points[3];
            let d = 3.0
                * (s * s * (points[1] - points[0])
                    + 2.0 * s * t * (points[2] - points[1])
                    + t * t * (points[3] - points[2]));
            let (q, e) = curve.at(t);
            assert!((p - q).length() < 1e-14 && (d - e).length() < 1e-13);
        }
    }

    #[test]
    fn an_unclamped_curve_keeps_to_its_domain() {
        let points = [(0.0, 0.0), (1.0, 2.0), (3.0, -1.0), (4.0, 0.5)].map(|(x, y)| DVec2::new(x, y));
        let curve = NurbsCurve::new(2, vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0], &[], &points).unwrap();
        assert_eq!(curve.basis().domain(), (2.0, 4.0));
        assert!((curve.at(2.0).0 - 0.5 * (points[0] + points[1])).length() < 1e-15);
        assert!((curve.at(4.0).0 - 0.5 * (points[2] + points[3])).length() < 1e-15);
    }

    #[test]
    fn invalid_curves_are_refused_with_the_reason() {
        let points = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        let refusal = |degree, knots: &[f64], weights: &[f64]| {
            NurbsCurve::new(degree, knots.to_vec(), weights, &points).unwrap_err().to_string()
        };
        let good = [0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0];
        assert!(refusal(0, &good, &[]).contains("degree of a NURBS is 0"));
        assert!(refusal(4, &good, &[]).contains("at least 5 control points"));
        assert!(refusal(usize::MAX, &good, &[]).contains("control points"));
        assert!(refusal(2, &good[1..], &[]).contains("needs 7 knots and has 6"));
        assert!(refusal(2, &[0.0, 0.0, 0.0, 0.5, 0.4, 1.0, 1.0], &[]).contains("Knot 5 (0.4) is less"));
        assert!(refusal(2, &[0.0, 0.0, 0.0, f64::NAN, 1.0, 1.0, 1.0], &[]).contains("Knot 4"));
        assert!(refusal(2, &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0], &[]).contains("occurs 4 times"));
        assert!(refusal(1, &[0.0, 0.0, 0.5, 0.5, 1.0, 1.0], &[]).contains("occurs 2 times"));
        assert!(refusal(2, &[1.0; 7], &[]).contains("empty parameter range"));
        assert!(refusal(2, &good, &[1.0, 1.0]).contains("has 2 weights"));
        assert!(refusal(2, &good, &[1.0, 0.0, 1.0, 1.0]).contains("Weight 2 is 0"));
        assert!(refusal(2, &good, &[1.0, -1.0, 1.0, 1.0]).contains("Weight 2 is -1"));
        assert!(refusal(2, &good, &[1.0, f64::NAN, 1.0, 1.0]).contains("Weight 2"));
        assert!(NurbsCurve::new(2, good.to_vec(), &[], &[DVec2::NAN; 4]).is_err());
    }
}
