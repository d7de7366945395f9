use super::*;
use crate::core::geometry::frame::AxisFrame;
use crate::core::geometry::primitive::{cone, plane, revolution, sphere, torus};
use crate::core::geometry::space_curve::SpaceCurve;
use crate::core::geometry::spec::SpaceShape;

fn upright() -> AxisFrame {
    AxisFrame::new(DVec3::new(1.0, -2.0, 0.5), DVec3::new(0.0, 0.0, 3.0), None).unwrap()
}

/// A frame with no direction along an axis.
fn askew() -> AxisFrame {
    AxisFrame::new(DVec3::new(0.3, 0.1, -0.7), DVec3::new(1.0, 2.0, -0.5), Some(DVec3::new(0.2, 0.1, 1.0))).unwrap()
}

/// Parameters that cover a surface's domain.
fn places(surface: &NurbsSurface, n: u32) -> Vec<DVec2> {
    let [[u0, u1], [v0, v1]] = surface.domain();
    let mut places = Vec::new();
    for i in 0..=n {
        for j in 0..=n {
            let (s, t) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            places.push(DVec2::new(u0 + s * (u1 - u0), v0 + t * (v1 - v0)));
        }
    }
    places
}

/// Distance from the axis, and height over the centre.
fn cylindrical(frame: &AxisFrame, p: DVec3) -> (f64, f64) {
    let p = p - frame.centre;
    let height = p.dot(frame.axis);
    ((p - frame.axis * height).length(), height)
}

fn derivatives_agree_with_differences(surface: &NurbsSurface) {
    let [[u0, u1], [v0, v1]] = surface.domain();
    let h = 1e-5 * DVec2::new(u1 - u0, v1 - v0);
    for uv in places(surface, 7).into_iter().map(|p| p + 37.0 * h) {
        if uv.x + h.x > u1 || uv.y + h.y > v1 {
            continue;
        }
        let at = surface.at(uv, 2);
        let (e, n) = (DVec2::new(h.x, 0.0), DVec2::new(0.0, h.y));
        let slope = |along: DVec2, step: f64, of: &dyn Fn(SurfacePoint) -> DVec3| {
            (of(surface.at(uv + along, 1)) - of(surface.at(uv - along, 1))) / (2.0 * step)
        };
        let scale = [h.x, h.y].map(|h| surface.size() / (1e5 * h));
        let near = |a: DVec3, b: DVec3, size: f64| assert!(a.distance(b) < 1e-5 * size, "{uv}: {a} {b}");
        near(at.d[0], slope(e, h.x, &|p| p.p), scale[0]);
        near(at.d[1], slope(n, h.y, &|p| p.p), scale[1]);
        near(at.dd[0], slope(e, h.x, &|p| p.d[0]), scale[0] * scale[0] / surface.size());
        near(at.dd[1], slope(n, h.y, &|p| p.d[0]), scale[0] * scale[1] / surface.size());
        near(at.dd[2], slope(n, h.y, &|p| p.d[1]), scale[1] * scale[1] / surface.size());
    }
}

#[test]
fn primitives_agree_with_their_closed_forms_and_their_curvatures() {
    for frame in [upright(), askew()] {
        let cylinder = cone(&frame, [2.0, 2.0], 5.0, [0.0, 360.0]).unwrap();
        let ball = sphere(&frame, 2.0, [0.0, 360.0], [-90.0, 90.0]).unwrap();
        let ring = torus(&frame, 3.0, 0.5, [20.0, 380.0], [0.0, 360.0]).unwrap();
        let funnel = cone(&frame, [2.0, 0.0], 1.5, [-30.0, 300.0]).unwrap();
        assert_eq!(
            [cylinder.closed(), ball.closed(), ring.closed(), funnel.closed()],
            [[true, false], [true, false], [true, true], [false, false]]
        );
        assert_eq!(cylinder.degenerate(), [false; 4]);
        assert_eq!(ball.degenerate(), [true, false, true, false]);
        assert_eq!(funnel.degenerate(), [false, false, true, false]);
        for uv in places(&cylinder, 24) {
            let at = cylinder.at(uv, 2);
            let (r, z) = cylindrical(&frame, at.p);
            assert!((r - 2.0).abs() < 1e-12 && (z - uv.y).abs() < 1e-12);
            let bend = at.bend().unwrap();
            assert!((bend.curvatures[0] + 0.5).abs() < 1e-12 && bend.curvatures[1].abs() < 1e-12, "{bend:?}");
            assert!(bend.directions[0].dot(frame.axis).abs() < 1e-12);
            // The normal points outwards.
            assert!(bend.normal.dot(at.p - frame.centre - frame.axis * z) > 1.9);
        }
        for uv in places(&ball, 24) {
            let at = ball.at(uv, 2);
            assert!((at.p.distance(frame.centre) - 2.0).abs() < 1e-12);
            if uv.y.abs() < 89.0 {
                let bend = at.bend().unwrap();
                assert!(bend.curvatures.iter().all(|k| (k + 0.5).abs() < 1e-10), "{uv} {bend:?}");
                assert!(bend.normal.distance((at.p - frame.centre) / 2.0) < 1e-12);
            }
        }
        for uv in places(&ring, 24) {
            let at = ring.at(uv, 2);
            let (r, z) = cylindrical(&frame, at.p);
            assert!((libm::hypot(r - 3.0, z) - 0.5).abs() < 1e-12);
            let bend = at.bend().unwrap();
            // -1 / tube, and -cos(v) / r.
            let other = -(r - 3.0) / 0.5 / r;
            assert!((bend.curvatures[0] + 2.0).abs() < 1e-10 && (bend.curvatures[1] - other).abs() < 1e-10);
        }
        for uv in places(&funnel, 24) {
            let at = funnel.at(uv, 1);
            let (r, z) = cylindrical(&frame, at.p);
            assert!((r - 2.0 * (1.0 - z / 1.5)).abs() < 1e-12);
            assert!((at.d[1].length() - 1.0).abs() < 1e-12);
        }
        for surface in [&cylinder, &ball, &ring, &funnel] {
            derivatives_agree_with_differences(surface);
        }
    }
}

#[test]
fn angles_of_revolutions_are_exact_at_arc_ends_and_close_between() {
    let frame = upright();
    let cylinder = cone(&frame, [2.0, 2.0], 5.0, [0.0, 270.0]).unwrap();
    for i in 0..=270 {
        let angle = f64::from(i);
        let p = cylinder.at(DVec2::new(angle, 1.0), 1).p - frame.centre;
        let found = libm::atan2(p.y, p.x).to_degrees().rem_euclid(360.0);
        let off = (found - angle).abs();
        assert!(off < if i % 90 == 0 { 1e-12 } else { 1.1 }, "{angle}: {found}");
    }
}

#[test]
fn closed_surfaces_continue_periodically_and_others_linearly() {
    let ring = torus(&upright(), 3.0, 0.5, [0.0, 360.0], [0.0, 360.0]).unwrap();
    let (a, b) = (ring.at(DVec2::new(10.0, 20.0), 2), ring.at(DVec2::new(370.0, -340.0), 2));
    assert!(a.p.distance(b.p) < 1e-12 && a.d[0].distance(b.d[0]) < 1e-12);
    let sheet = plane(DVec3::ZERO, [DVec3::X * 2.0, DVec3::Y]).unwrap();
    assert!(sheet.at(DVec2::new(-1.0, 4.0), 1).p.distance(DVec3::new(-1.0, 4.0, 0.0)) < 1e-15);
}

#[test]
fn a_revolved_circle_is_a_torus() {
    let frame = upright();
    let own =
        AxisFrame::new(frame.centre + frame.start * 3.0, -frame.axis.cross(frame.start), Some(frame.start)).unwrap();
    let shape = SpaceShape::Arc { frame: own, radius: 0.5, angles: [0.0, 360.0] };
    let circle = SpaceCurve::new(&shape, &|_| None).unwrap();
    let swept = revolution(&circle.nurbs().unwrap(), &frame, [0.0, 360.0]).unwrap();
    let ring = torus(&frame, 3.0, 0.5, [0.0, 360.0], [0.0, 360.0]).unwrap();
    assert_eq!(swept.closed(), [true, true]);
    for uv in places(&ring, 12) {
        assert!(ring.at(uv, 1).p.distance(swept.at(uv, 1).p) < 1e-12);
    }
}

#[test]
fn a_bicubic_bezier_patch_agrees_with_its_bernstein_form() {
    let mut points = Vec::new();
    for i in 0..4 {
        for j in 0..4 {
            points.push(DVec3::new(f64::from(i), f64::from(j), f64::from((i * 7 + j * 3) % 5) * 0.4));
        }
    }
    let knots = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let patch = NurbsSurface::new([3, 3], [knots.clone(), knots], &[], &points, 4).unwrap();
    let bernstein = |t: f64| {
        let s = 1.0 - t;
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
    };
    for uv in places(&patch, 10) {
        let (b_u, b_v) = (bernstein(uv.x), bernstein(uv.y));
        let mut expected = DVec3::ZERO;
        for i in 0..4 {
            for j in 0..4 {
                expected += points[4 * i + j] * (b_u[i] * b_v[j]);
            }
        }
        assert!(patch.at(uv, 2).p.distance(expected) < 1e-14);
    }
    derivatives_agree_with_differences(&patch);
}

#[test]
fn series_agree_with_the_basis_functions_for_all_degrees_that_use_them() {
    for degree in 1..=SERIES + 1 {
        let count = degree + 3;
        let mut knots = vec![0.0; degree + 1];
        knots.extend([0.3, 0.35]);
        knots.extend(vec![2.0; degree + 1]);
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        for i in 0..count {
            for j in 0..count {
                points.push(DVec3::new(i as f64, j as f64, ((i * 7 + j * 5) % 4) as f64));
                weights.push(1.0 + 0.3 * ((i + 2 * j) % 3) as f64);
            }
        }
        let surface = NurbsSurface::new([degree; 2], [knots.clone(), knots], &weights, &points, count).unwrap();
        assert_eq!(surface.series.is_some(), degree <= SERIES);
        for uv in places(&surface, 23) {
            let (a, b) = (surface.at(uv, 2), surface.divided::<2>(&surface.by_basis([uv.x, uv.y], 2)));
            let near = |a: DVec3, b: DVec3, scale: f64| a.distance(b) < 1e-13 * scale * (1.0 + b.length());
            assert!(near(a.p, b.p, 10.0), "{degree} {uv}");
            assert!((0..2).all(|k| near(a.d[k], b.d[k], 100.0)), "{degree} {uv}");
            assert!((0..3).all(|k| near(a.dd[k], b.dd[k], 1e4)), "{degree} {uv} {a:?} {b:?}");
        }
    }
}

#[test]
fn invalid_surfaces_are_refused_with_the_reason() {
    let square = [DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::new(1.0, 1.0, 0.0)];
    let line = vec![0.0, 0.0, 1.0, 1.0];
    let says = |knots: Vec<f64>, weights: &[f64], points: &[DVec3], columns| {
        NurbsSurface::new([1, 1], [knots, line.clone()], weights, points, columns).unwrap_err().to_string()
    };
    assert!(says(vec![0.0, 0.0, 1.0, 0.5], &[], &square, 2).contains("less than the one before"));
    assert!(says(line.clone(), &[1.0, 1.0, 0.0, 1.0], &square, 2).contains("Weight 3 is 0"));
    assert!(says(line.clone(), &[1.0, 1.0, -1.0, 1.0], &square, 2).contains("Weight 3 is -1"));
    assert!(says(line.clone(), &[], &square, 3).contains("same length"));
    assert!(says(line.clone(), &[], &[DVec3::X; 4], 2).contains("zero size"));
    assert!(says(vec![0.0, 1.0, 1.0, 1.0, 1.0], &[], &square, 2).contains("needs 4 knots"));
    assert!(torus(&upright(), 1.0, 1.5, [0.0, 360.0], [0.0, 360.0]).is_err());
    assert!(sphere(&upright(), 1.0, [0.0, 400.0], [-90.0, 90.0]).is_err());
    assert!(AxisFrame::new(DVec3::ZERO, DVec3::ZERO, None).is_err());
    assert!(AxisFrame::new(DVec3::ZERO, DVec3::Z, Some(DVec3::Z)).is_err());
}
