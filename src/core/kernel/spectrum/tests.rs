use super::*;
use proptest::prelude::*;

fn metric2() -> impl Strategy<Value = Metric2> {
    (-3.0..3.0f64, 0.0..4.0f64, 0.0..7.0f64).prop_map(|(log_h, log_ratio, turn)| {
        let h = libm::pow(10.0, log_h);
        Metric2::from_sizes([h, h * libm::pow(10.0, log_ratio)], DVec2::from_angle(turn)).unwrap()
    })
}

/// Tensors of space with anisotropy up to 1e4; every third is planar.
fn metric3() -> impl Strategy<Value = Metric3> {
    let numbers = prop::array::uniform6(-1.0..1.0f64);
    (-3.0..3.0f64, 0.0..4.0f64, 0.0..4.0f64, numbers, 0..3).prop_filter_map("directions", |(h, r1, r2, c, kind)| {
        let h = libm::pow(10.0, h);
        let sizes = [h, h * libm::pow(10.0, r1), h * libm::pow(10.0, r2)];
        let flat = if kind == 0 { 0.0 } else { 1.0 };
        let g1 = DVec3::new(c[0], c[1], flat * c[2]);
        let g2 = DVec3::new(c[3], c[4], flat * c[5]);
        if g1.cross(g2).length() < 0.01 { None } else { Metric3::from_sizes(sizes, [g1, g2, g1.cross(g2)]).ok() }
    })
}

fn close2(a: &Metric2, b: &Metric2, tolerance: f64) -> bool {
    let d = (a.uu - b.uu).abs() + (a.uv - b.uv).abs() + (a.vv - b.vv).abs();
    d <= tolerance * (a.uu + a.vv)
}

fn close3(a: &Metric3, b: &Metric3, tolerance: f64) -> bool {
    let d: f64 = a.entries().iter().zip(b.entries()).map(|(x, y)| (x - y).abs()).sum();
    d <= tolerance * (a.xx + a.yy + a.zz)
}

fn probes3() -> impl Iterator<Item = DVec3> {
    (0..60).map(|k| {
        let (t, z) = (2.4 * f64::from(k), (f64::from(k) + 0.5) / 60.0);
        (DVec2::from_angle(t) * (1.0 - z * z).sqrt()).extend(z)
    })
}

#[test]
fn eigenvalues_ascend_and_degenerate_tensors_have_a_frame() {
    let (values, g) = Metric2::isotropic(0.5).eigen();
    assert_eq!((values, g), ([4.0, 4.0], [DVec2::X, DVec2::Y]));
    let (values, g) = Metric2 { uu: 9.0, uv: 0.0, vv: 1.0 }.eigen();
    assert_eq!((values, g), ([1.0, 9.0], [DVec2::Y, DVec2::NEG_X]));
    let (values, g) = Metric3 { xx: 9.0, xy: 0.0, xz: 0.0, yy: 1.0, yz: 0.0, zz: 4.0 }.eigen();
    assert_eq!((values, g), ([1.0, 4.0, 9.0], [DVec3::Y, DVec3::Z, DVec3::X]));
}

#[test]
fn small_eigenvalues_of_nearly_diagonal_tensors_are_accurate() {
    let m = Metric2 { uu: 1e12, uv: 1e3, vv: 3.0 };
    assert!((m.eigen().0[0] - (3.0 - 1e-6)).abs() < 1e-14 * 3.0);
}

#[test]
fn the_smallest_size_against_a_form_does_not_depend_on_the_parameters() {
    // Sizes 0.02 and 0.5 in space; parameters sheared and stretched by J, M = J^T M3D J, G = J^T J.
    let m = Metric2::from_sizes([0.02, 0.5], DVec2::new(0.3, 1.0)).unwrap();
    let (a, b) = (DVec2::new(40.0, 3.0), DVec2::new(-0.2, 0.07));
    let pulled = Metric2 { uu: m.norm2(a), uv: m.inner(a, b), vv: m.norm2(b) };
    let form = Metric2 { uu: a.dot(a), uv: a.dot(b), vv: b.dot(b) };
    assert!((pulled.min_size_against(&form) - 0.02).abs() < 1e-12);
    let (values, directions) = pulled.eigen_against(&form);
    let sizes = values.map(|value| 1.0 / value.sqrt());
    assert!((sizes[0] - 0.5).abs() < 1e-12 && (sizes[1] - 0.02).abs() < 1e-12, "{sizes:?}");
    // In space the smaller size runs along (0.3, 1).
    let small = a * directions[1].x + b * directions[1].y;
    assert!((small.length() - 1.0).abs() < 1e-12);
    assert!(small.perp_dot(DVec2::new(0.3, 1.0).normalize()).abs() < 1e-12);
    assert!((m.min_size_against(&Metric2::isotropic(1.0)) - m.min_size()).abs() < 1e-15);
}

#[test]
fn min_size_is_the_smallest_size() {
    let m = Metric2::from_sizes([0.02, 3.0], DVec2::new(1.0, 2.0)).unwrap();
    assert!((m.min_size() - 0.02).abs() < 1e-15);
    let m = Metric3::from_sizes([7.0, 0.02, 3.0], [DVec3::ONE, DVec3::X, DVec3::Y]).unwrap();
    assert!((m.min_size() - 0.02).abs() < 1e-15);
}

#[test]
fn log_euclidean_mean_of_sizes_is_geometric() {
    let logarithms = [0.1, 0.4].map(|h| Metric2::isotropic(h).ln());
    let mean = LogMetric::log_euclidean([0.5, 0.5].into_iter().zip(&logarithms)).exp();
    assert!((mean.min_size() - 0.2).abs() < 1e-15);
    let m = Metric3::from_sizes([0.1, 1.0, 2.0], [DVec3::ONE, DVec3::X, DVec3::Y]).unwrap();
    let same = [m.ln(); 3];
    assert!(close3(&LogMetric::log_euclidean([0.2, 0.3, 0.5].into_iter().zip(&same)).exp(), &m, 1e-13));
    assert_eq!(LogMetric2::ZERO.exp(), Metric2::isotropic(1.0));
    assert_eq!(LogMetric3::ZERO.exp(), Metric3::isotropic(1.0));
}

#[test]
fn intersections_of_contained_and_proportional_metrics_are_exact() {
    let thin = Metric2::from_sizes([1e-4, 1.0], DVec2::new(1.0, 0.3)).unwrap();
    assert_eq!(Metric2::intersect(&thin, &thin.scaled(0.5)), thin.scaled(0.5));
    assert_eq!(Metric2::intersect(&thin, &thin.scaled(2.0)), thin);
    assert_eq!(Metric2::intersect(&thin, &Metric2::isotropic(5.0)), thin);
    assert_eq!(Metric2::intersect(&Metric2::isotropic(5.0), &thin), thin);
    let thin = Metric3::from_sizes([1e-4, 1.0, 1.0], [DVec3::ONE, DVec3::X, DVec3::Y]).unwrap();
    assert_eq!(Metric3::intersect(&thin, &thin.scaled(0.5)), thin.scaled(0.5));
    assert_eq!(Metric3::intersect(&Metric3::isotropic(5.0), &thin), thin);
    assert!(close2(&Metric2::intersect(&thin.plane(), &thin.plane()), &thin.plane(), 1e-12));
}

#[test]
fn the_intersection_of_crossing_strips_is_their_square() {
    let x = Metric2::from_sizes([1e-4, 1.0], DVec2::X).unwrap();
    let y = Metric2::from_sizes([1e-4, 1.0], DVec2::Y).unwrap();
    assert!(close2(&Metric2::intersect(&x, &y), &Metric2::isotropic(1e-4), 1e-12));
    let space = |m: Metric2| Metric3 { xx: m.uu, xy: m.uv, xz: 0.0, yy: m.vv, yz: 0.0, zz: 1.0 };
    let tilted = Metric3::from_sizes([1e-4, 1.0, 1.0], [DVec3::Y, DVec3::X, DVec3::Z]).unwrap();
    assert!(close3(&Metric3::intersect(&space(x), &tilted), &space(Metric2::isotropic(1e-4)), 1e-12));
}

#[test]
fn a_slab_cuts_back_one_size_and_no_other() {
    let m = Metric3::isotropic(1.0);
    let n = DVec3::new(0.6, 0.8, 0.0);
    let cut = m.intersect_slab(n, 1e-3);
    assert!((cut.norm2(n) - 1e6).abs() < 1e-6);
    assert!((cut.norm2(DVec3::new(-0.8, 0.6, 0.0)) - 1.0).abs() < 1e-9);
    assert_eq!(m.intersect_slab(n, 2.0), m);
    // The ball of a thin tensor reaches far along n only askew; it is cut where it leaves the slab, and no earlier.
    let thin = Metric3::from_sizes([0.01, 1.0, 1.0], [DVec3::X, DVec3::Y, DVec3::Z]).unwrap();
    let reach = (0.36 * 1e-4 + 0.64f64).sqrt();
    assert_eq!(thin.intersect_slab(n, reach * 1.001), thin);
    assert!(thin.intersect_slab(n, reach * 0.999).norm2(n) > thin.norm2(n));
}

proptest! {
    #[test]
    fn eigen_rebuilds_the_tensor(m2 in metric2(), m3 in metric3()) {
        let (values, g) = m2.eigen();
        prop_assert!(values[0] <= values[1]);
        prop_assert!((g[0].length() - 1.0).abs() < 1e-14 && (g[0].perp() - g[1]).length() < 1e-14);
        prop_assert!(close2(&Metric2::from_eigen(values, g), &m2, 1e-14));
        let (values, g) = m3.eigen();
        prop_assert!(values[0] <= values[1] && values[1] <= values[2]);
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            prop_assert!(g[i].dot(g[j]).abs() < 1e-14);
        }
        prop_assert!(close3(&Metric3::from_eigen(values, g), &m3, 1e-14));
    }

    #[test]
    fn exp_takes_ln_back_and_sqrt_squares(m2 in metric2(), m3 in metric3()) {
        prop_assert!(close2(&m2.ln().exp(), &m2, 1e-12));
        prop_assert!(close3(&m3.ln().exp(), &m3, 1e-12));
        let (s, t) = (m2.sqrt(), m3.sqrt());
        let squared = Metric2 { uu: s.uu * s.uu + s.uv * s.uv, uv: s.uv * (s.uu + s.vv), vv: s.uv * s.uv + s.vv * s.vv };
        prop_assert!(close2(&squared, &m2, 1e-12));
        for d in probes3() {
            prop_assert!((t.times(d).length_squared() - m3.norm2(d)).abs() < 1e-12 * (m3.xx + m3.yy + m3.zz));
        }
    }

    #[test]
    fn the_intersection_covers_both_and_no_more_than_it_must(a in metric2(), b in metric2()) {
        let m = Metric2::intersect(&a, &b);
        prop_assert!(m.is_spd());
        let slack = 1e-12 * (m.uu + m.vv);
        for k in 0..60 {
            let d = DVec2::from_angle(0.053 * f64::from(k));
            let needed = a.norm2(d).max(b.norm2(d));
            prop_assert!(m.norm2(d) >= needed * (1.0 - 1e-7) - slack, "{} {needed}", m.norm2(d));
            prop_assert!(m.norm2(d) <= (a.norm2(d) + b.norm2(d)) * (1.0 + 1e-7) + slack);
        }
        prop_assert!(close2(&Metric2::intersect(&b, &a), &m, 1e-6));
    }

    #[test]
    fn the_intersection_in_space_covers_both(a in metric3(), b in metric3()) {
        let m = Metric3::intersect(&a, &b);
        prop_assert!(m.is_spd());
        let slack = 1e-12 * (m.xx + m.yy + m.zz);
        for d in probes3() {
            let needed = a.norm2(d).max(b.norm2(d));
            prop_assert!(m.norm2(d) >= needed * (1.0 - 1e-6) - slack, "{} {needed}", m.norm2(d));
            prop_assert!(m.norm2(d) <= (a.norm2(d) + b.norm2(d)) * (1.0 + 1e-6) + slack);
        }
    }

    #[test]
    fn nearly_equal_metrics_intersect_to_themselves(a in metric2(), e in prop::array::uniform3(-1e-14..1e-14f64)) {
        let b = Metric2 { uu: a.uu * (1.0 + e[0]), uv: a.uv * (1.0 + e[1]), vv: a.vv * (1.0 + e[2]) };
        // The oblique reduction amplifies the perturbation.
        prop_assert!(close2(&Metric2::intersect(&a, &b), &a, 1e-10));
    }
}
