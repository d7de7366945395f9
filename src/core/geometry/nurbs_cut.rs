//! Parts of B-splines, exactly: control points of a part are values of the blossom of a polynomial piece ("The NURBS
//! Book", 5.2; Ramshaw's blossoming principle). Rational ones are cut as homogeneous points.

use super::nurbs::{Basis, Vector};

/// Knots and control points of the part of a B-spline between two parameters of its domain, `from < to`; its outer
/// knots have full multiplicity. `points` has one entry for each function of the basis.
pub fn cut<P: Vector>(basis: &Basis, points: &[P], [from, to]: [f64; 2]) -> (Vec<f64>, Vec<P>) {
    let degree = basis.degree();
    let mut knots = vec![from; degree + 1];
    knots.extend(basis.knots().iter().filter(|knot| **knot > from && **knot < to));
    knots.extend(vec![to; degree + 1]);
    let piece_of = |i: usize| {
        let j = (i..=i + degree).find(|&j| knots[j] < knots[j + 1]).unwrap_or(i);
        basis.span(0.5 * (knots[j] + knots[j + 1]))
    };
    let found = (0..knots.len() - degree - 1).map(|i| blossom(basis, points, piece_of(i), &knots[i + 1..=i + degree]));
    let found = found.collect();
    (knots, found)
}

/// The blossom of the polynomial piece on a span, by de Boor's scheme with an argument of its own in each stage.
fn blossom<P: Vector>(basis: &Basis, points: &[P], span: usize, arguments: &[f64]) -> P {
    let (degree, knots) = (basis.degree(), basis.knots());
    let first = span - degree;
    let mut d = points[first..=span].to_vec();
    for (r, &argument) in (1..).zip(arguments) {
        for j in (r..=degree).rev() {
            let (low, high) = (knots[first + j], knots[first + j + degree + 1 - r]);
            let share = (argument - low) / (high - low);
            d[j] = d[j - 1] * (1.0 - share) + d[j] * share;
        }
    }
    d[degree]
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::nurbs::NurbsCurve;
    use super::*;

    #[test]
    fn a_part_lies_on_the_whole_at_the_same_parameters() {
        let clamped = vec![0.0, 0.0, 0.0, 0.0, 0.3, 0.3, 0.7, 1.0, 1.0, 1.0, 1.0];
        let uniform: Vec<f64> = (0..11).map(|k| f64::from(k) / 10.0).collect();
        let points: Vec<DVec3> =
            (0..7).map(|k| DVec3::new(f64::from(k), f64::from(k * k % 5), f64::from(k % 3))).collect();
        for knots in [clamped, uniform] {
            let whole = NurbsCurve::new(3, knots, &[], &points).unwrap();
            let (first, last) = whole.basis().domain();
            for [a, b] in [[0.0, 1.0], [0.1, 0.9], [0.25, 0.35], [0.0, 0.3], [0.3, 0.7]] {
                let [from, to] = [a, b].map(|t| first + t * (last - first));
                let (knots, cut_points) = cut(whole.basis(), &points, [from, to]);
                let part = NurbsCurve::new(3, knots, &[], &cut_points).unwrap();
                assert_eq!(part.basis().domain(), (from, to));
                for i in 0..=50 {
                    let t = from + (to - from) * f64::from(i) / 50.0;
                    assert!(part.at(t).0.distance(whole.at(t).0) < 1e-12, "{from} to {to} at {t}");
                }
            }
        }
    }
}
