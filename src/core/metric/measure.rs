//! Lengths, angles, areas and shape in a metric, angles in space (eqs. 4, 5; docs/algorithm.md, "Lengths and angles").

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::field::{BadMetric, MetricSource};
use crate::core::kernel::Metric2;

/// Eq. (4): the length of `d` in the metric `m`.
#[inline]
pub fn length(m: &Metric2, d: DVec2) -> f64 {
    m.norm2(d).max(0.0).sqrt()
}

/// Eq. (5): the anticlockwise angle from `du` to `dv` in the metric `m`, in [0, 2 pi).
///
/// The paper takes the arc cosine of the normalised inner product and the sign of the cross product. The arc tangent of
/// `sqrt(det M) x(du, dv)` and `du^T M dv` is the same angle (they are its sine and cosine times both lengths) and is
/// fully accurate near 0 and pi, where the arc cosine loses half of the digits.
#[inline]
pub fn angle(m: &Metric2, du: DVec2, dv: DVec2) -> f64 {
    let sine = m.det().max(0.0).sqrt() * du.perp_dot(dv);
    let t = libm::atan2(sine, m.inner(du, dv));
    if t < 0.0 {
        // A tiny clockwise angle is nearly a full turn: rounding must not reach 2 pi.
        (t + TAU).min(TAU.next_down())
    } else {
        // Turns -0 into 0.
        t + 0.0
    }
}

/// The angles at the corners of an element in space, between its straight sides, in radians: what programs that check
/// meshes compute from coordinates alone. Corners go anticlockwise. A corner that turns against the normal of the
/// element is reflex, beyond pi; the normal is that of its area vector, for a quadrilateral that of its diagonals.
pub fn angles_in_space(corners: &[DVec3]) -> impl Iterator<Item = f64> {
    let (n, at) = (corners.len(), move |k: usize| corners[k % corners.len()]);
    let normal: DVec3 = (2..n).map(|k| (at(k - 1) - at(0)).cross(at(k) - at(0))).sum();
    (0..n).map(move |k| {
        let (out, back) = (at(k + 1) - at(k), at(k + n - 1) - at(k));
        let turn = out.cross(back);
        let angle = libm::atan2(turn.length(), out.dot(back));
        if turn.dot(normal) < 0.0 { TAU - angle } else { angle }
    })
}

/// Positive nodes and weights of the symmetric Gauss-Legendre rule of eight points on (-1, 1).
const GAUSS_8: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// The length of the straight edge from `a` to `b` in the parametric plane: the integral of eq. (4) along it, by eight
/// Gauss points.
///
/// # Errors
/// If the source has no metric at a point of the edge.
pub fn length_exact(source: &dyn MetricSource, a: DVec2, b: DVec2) -> Result<f64, Box<BadMetric>> {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let mut sum = 0.0;
    for (node, weight) in GAUSS_8 {
        for side in [-node, node] {
            sum += weight * length(&source.metric(middle + side * half)?, half);
        }
    }
    Ok(sum)
}

/// The signed area of the triangle a, b, c in the metric `m`, positive when anticlockwise.
#[inline]
pub fn triangle_area(m: &Metric2, a: DVec2, b: DVec2, c: DVec2) -> f64 {
    0.5 * m.det().max(0.0).sqrt() * (b - a).perp_dot(c - a)
}

/// `4 sqrt(3) A / sum of l^2` of a triangle in the metric `m`: 1 for the equilateral one, negative when clockwise.
#[inline]
pub fn triangle_quality(m: &Metric2, a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let squares = m.norm2(b - a) + m.norm2(c - b) + m.norm2(a - c);
    if squares > 0.0 { 4.0 * 3f64.sqrt() * triangle_area(m, a, b, c) / squares } else { 0.0 }
}

/// Quality of a quadrilateral (docs/algorithm.md, "Quality"): the least over its corners of `2 sqrt(det M_k) x(a, b) /
/// (a^T M_k a + b^T M_k b)` with a and b the sides that leave the corner, anticlockwise, and M_k its metric; 1 for a
/// metric square, at most 0 if a corner is not convex.
#[inline]
pub fn quad_quality(metrics: [&Metric2; 4], corners: [DVec2; 4]) -> f64 {
    let mut least = f64::INFINITY;
    for k in 0..4 {
        let m = metrics[k];
        let a = corners[(k + 1) % 4] - corners[k];
        let b = corners[(k + 3) % 4] - corners[k];
        let squares = m.norm2(a) + m.norm2(b);
        let q = if squares > 0.0 { 2.0 * m.det().max(0.0).sqrt() * a.perp_dot(b) / squares } else { 0.0 };
        least = least.min(q);
    }
    least
}

/// The scaled Jacobian of a quadrilateral: the smallest sine of its corner angles, each in the metric of its corner;
/// negative at a reflex corner.
pub fn scaled_jacobian(metrics: &[Metric2; 4], corners: [DVec2; 4]) -> f64 {
    let sine = |k: usize| {
        let (a, b) = (corners[(k + 1) % 4] - corners[k], corners[(k + 3) % 4] - corners[k]);
        let m = &metrics[k];
        m.det().max(0.0).sqrt() * a.perp_dot(b) / (m.norm2(a) * m.norm2(b)).sqrt()
    };
    (0..4).map(sine).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn stretched() -> Metric2 {
        Metric2::from_sizes([0.02, 0.5], DVec2::new(2.0, 1.0)).unwrap()
    }

    #[test]
    fn length_is_that_of_eq_4() {
        let m = stretched();
        let across = DVec2::new(2.0, 1.0).normalize();
        assert!((length(&m, 0.02 * across) - 1.0).abs() < 1e-12);
        assert!((length(&m, 0.5 * across.perp()) - 1.0).abs() < 1e-12);
        assert_eq!(length(&m, DVec2::ZERO), 0.0);
    }

    struct Linear;
    impl MetricSource for Linear {
        fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>> {
            let place = crate::core::metric::place::MetricPlace::in_plane(uv);
            if uv.x > 1.0 {
                return Err(Box::new(BadMetric { what: "too far".into(), place }));
            }
            Ok(Metric2::isotropic(1.0 + uv.x))
        }
    }

    #[test]
    fn the_exact_length_is_the_integral() {
        let l = length_exact(&Linear, DVec2::ZERO, DVec2::X).unwrap();
        assert!((l - libm::log(2.0)).abs() < 1e-11, "{l}");
        let back = length_exact(&Linear, DVec2::X, DVec2::ZERO).unwrap();
        assert!((l - back).abs() < 1e-14);
        assert!(length_exact(&Linear, DVec2::ZERO, 2.0 * DVec2::X).is_err());
        assert!((GAUSS_8.iter().map(|g| g.1).sum::<f64>() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn angle_is_that_of_eq_5_with_the_sign_test() {
        let m = Metric2::isotropic(0.3);
        assert_eq!(angle(&m, DVec2::X, DVec2::X), 0.0);
        assert!((angle(&m, DVec2::X, DVec2::Y) - FRAC_PI_2).abs() < 1e-15);
        assert_eq!(angle(&m, DVec2::X, DVec2::NEG_X), PI);
        assert!((angle(&m, DVec2::X, DVec2::NEG_Y) - 3.0 * FRAC_PI_2).abs() < 1e-15);
        let hair = angle(&m, DVec2::X, DVec2::new(1.0, -1e-300));
        assert!(hair < TAU && hair > TAU - 1e-14);
        let d = DVec2::new(0.1, 0.7);
        assert_eq!(angle(&stretched(), d, d), 0.0);
        assert_eq!(angle(&stretched(), d, -d), PI);
        assert!(angle(&stretched(), d, -d).is_sign_positive());
    }

    #[test]
    fn angles_in_space_are_those_between_straight_sides_and_reflex_where_the_element_turns_back() {
        let degrees = |corners: &[DVec3]| angles_in_space(corners).map(f64::to_degrees).collect::<Vec<_>>();
        let close = |found: Vec<f64>, expected: &[f64]| {
            assert_eq!(found.len(), expected.len());
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        };
        // A right-angled triangle in a slanted plane; a dart, seen from either side; a square bent along a diagonal.
        let (x, y) = (DVec3::new(0.0, 0.6, 0.8), DVec3::new(1.0, 0.0, 0.0));
        close(degrees(&[DVec3::ZERO, x, y]), &[90.0, 45.0, 45.0]);
        let dart = [DVec3::ZERO, 2.0 * x, 0.5 * (x + y), 2.0 * y];
        let tip = libm::atan2(1.0, 3.0).to_degrees();
        close(degrees(&dart), &[90.0, tip, 270.0 - 2.0 * tip, tip]);
        let turned = [dart[0], dart[3], dart[2], dart[1]];
        close(degrees(&turned), &[90.0, tip, 270.0 - 2.0 * tip, tip]);
        let bent = [DVec3::ZERO, DVec3::X, DVec3::new(0.5, 0.5, 0.5f64.sqrt()), DVec3::Y];
        close(degrees(&bent), &[90.0, 60.0, 90.0, 60.0]);
        close(degrees(&[DVec3::ZERO; 2]), &[0.0, 0.0]);
    }

    #[test]
    fn qualities_of_known_shapes() {
        let m = Metric2::isotropic(2.0);
        let (a, b, c) = (DVec2::ZERO, DVec2::X, DVec2::new(0.5, 0.75f64.sqrt()));
        assert!((triangle_quality(&m, a, b, c) - 1.0).abs() < 1e-15);
        assert!((triangle_quality(&m, a, c, b) + 1.0).abs() < 1e-15);
        assert_eq!(triangle_quality(&m, a, a, a), 0.0);
        assert!((triangle_area(&m, a, b, c) - 0.25 * 0.75f64.sqrt() / 2.0).abs() < 1e-15);
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        assert_eq!(quad_quality([&m; 4], square), 1.0);
        assert!(quad_quality([&m; 4], [square[0], square[3], square[2], square[1]]) < 0.0);
        let flat = [DVec2::ZERO, DVec2::X, DVec2::new(0.5, 0.5), DVec2::Y];
        assert!(quad_quality([&m; 4], flat).abs() < 1e-15);
        let wide = Metric2::from_sizes([1.0, 2.0], DVec2::X).unwrap();
        assert_eq!(quad_quality([&wide; 4], square), 0.8);
        assert!((quad_quality([&wide; 4], square.map(|p| p * DVec2::new(1.0, 2.0))) - 1.0).abs() < 1e-15);
    }

    fn metric() -> impl Strategy<Value = Metric2> {
        (-6.0..2.0f64, 0.0..4.0f64, 0.0..TAU).prop_map(|(log_h, log_ratio, turn)| {
            let h = libm::pow(10.0, log_h);
            Metric2::from_sizes([h, h * libm::pow(10.0, log_ratio)], DVec2::from_angle(turn)).unwrap()
        })
    }

    fn turned(m: &Metric2, turn: f64) -> Metric2 {
        let (values, g) = m.eigen();
        Metric2::from_eigen(values, g.map(|g| DVec2::from_angle(turn).rotate(g)))
    }

    proptest! {
        #[test]
        fn angle_agrees_with_the_arc_cosine(m in metric(), s in 0.0..TAU, t in 0.0..TAU) {
            let (du, dv) = (DVec2::from_angle(s), DVec2::from_angle(t));
            let cosine = m.inner(du, dv) / (length(&m, du) * length(&m, dv));
            let acos = libm::acos(cosine.clamp(-1.0, 1.0));
            let expected = if du.perp_dot(dv) >= 0.0 { acos } else { TAU - acos };
            let difference = (angle(&m, du, dv) - expected).abs();
            prop_assert!(difference.min(TAU - difference) < 1e-6, "{difference}");
        }

        #[test]
        fn consecutive_angles_at_a_node_add_to_a_full_turn(
            m in metric(),
            mut turns in prop::collection::vec(0.0..TAU, 3..12),
        ) {
            turns.sort_by(f64::total_cmp);
            turns.dedup();
            let spokes: Vec<_> = turns.iter().map(|&t| DVec2::from_angle(t)).collect();
            // In the metric a gap of more than pi stays one, so that the sum is one turn whatever the stretching.
            let sum: f64 = (0..spokes.len()).map(|i| angle(&m, spokes[i], spokes[(i + 1) % spokes.len()])).sum();
            prop_assert!((sum - TAU).abs() < 1e-6, "{sum}");
        }

        #[test]
        fn measures_do_not_change_when_everything_turns(
            m in metric(), turn in 0.0..TAU, a in 0.0..TAU, b in 0.3..3.0f64, c in 0.1..2.0f64,
        ) {
            let root = m.sqrt();
            // A triangle of moderate shape in the metric: laid out there and pulled back.
            let back = |p: DVec2| {
                let det = root.det();
                DVec2::new(root.vv * p.x - root.uv * p.y, root.uu * p.y - root.uv * p.x) / det
            };
            let d = [back(DVec2::from_angle(a)), back(c * DVec2::from_angle(a + b))];
            let rotation = DVec2::from_angle(turn);
            let m_turned = turned(&m, turn);
            let d_turned = d.map(|d| rotation.rotate(d));
            prop_assert!((length(&m, d[0]) - 1.0).abs() < 1e-4);
            prop_assert!((length(&m_turned, d_turned[0]) - 1.0).abs() < 1e-4);
            prop_assert!((angle(&m, d[0], d[1]) - b).abs() < 1e-4);
            prop_assert!((angle(&m_turned, d_turned[0], d_turned[1]) - b).abs() < 1e-4);
            let q = triangle_quality(&m, DVec2::ZERO, d[0], d[1]);
            let q_turned = triangle_quality(&m_turned, DVec2::ZERO, d_turned[0], d_turned[1]);
            prop_assert!((q - q_turned).abs() < 1e-4, "{q} {q_turned}");
        }
    }
}
