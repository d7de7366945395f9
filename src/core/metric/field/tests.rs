use super::*;

fn formula(helpers: &[(&str, &str)], sizes: &[&str], directions: [Option<[&str; 3]>; 3]) -> FieldSpec {
    FieldSpec::Formula {
        helpers: helpers.iter().map(|h| (h.0.to_string(), h.1.to_string())).collect(),
        sizes: std::array::from_fn(|i| sizes.get(i).map(|s| s.to_string())),
        directions: directions.map(|g| g.map(|g| g.map(str::to_string))),
        place: "case.toml, line 7".into(),
    }
}

fn example_1() -> FieldSpec {
    formula(
        &[("r", "abs(x-y)/sqrt(2)")],
        &["0.005+0.15*r", "15*(0.005+0.15*r)*exp(-5.5*r)"],
        [Some(["-1", "1", "0"]), Some(["1", "1", "0"]), None],
    )
}

fn wall(along: Option<f64>, far: Option<f64>) -> FieldSpec {
    FieldSpec::BoundaryLayer {
        curves: vec!["wall".into()],
        first: 1e-3,
        growth: 1.25,
        along,
        far,
        place: "case.toml, line 9".into(),
    }
}

/// A wall along the x axis from 0 to 2.
fn curves(name: &str) -> Option<Line> {
    (name == "wall").then(|| Line::Plane((0..=20).map(|i| DVec2::new(0.1 * f64::from(i), 0.0)).collect()))
}

fn compile(spec: &FieldSpec) -> Field {
    Field::compile(spec, &curves).unwrap()
}

fn sizing(specs: &[FieldSpec]) -> Sizing {
    Sizing::new(specs.iter().map(compile).collect(), 1.0)
}

fn bad_at(spec: FieldSpec, x: f64, y: f64) -> String {
    let error = sizing(&[spec]).metric(DVec2::new(x, y)).expect_err("a bad metric");
    assert_eq!(error.place.uv, DVec2::new(x, y));
    Fault::from(error).to_string()
}

#[test]
fn fields_may_be_shared_between_threads() {
    fn check<T: Send + Sync>() {}
    check::<Field>();
    check::<Sizing>();
}

#[test]
fn example_1_is_eq_12() {
    let sizing = sizing(&[example_1()]);
    let p = DVec2::new(0.7, 0.2);
    let m = sizing.metric(p).unwrap();
    let r = 0.5 / 2f64.sqrt();
    let h1 = 0.005 + 0.15 * r;
    let h2 = 15.0 * h1 * libm::exp(-5.5 * r);
    let (across, along) = (DVec2::new(-1.0, 1.0).normalize(), DVec2::new(1.0, 1.0).normalize());
    assert!((m.norm2(h1 * across) - 1.0).abs() < 1e-12);
    assert!((m.norm2(h2 * along) - 1.0).abs() < 1e-12);
    assert!(m.inner(across, along).abs() < 1e-12 * m.norm2(along));
    // On the diagonal, the sizes along and across it are as 15 to 1.
    let m = sizing.metric(DVec2::splat(0.3)).unwrap();
    assert!((m.norm2(0.005 * across) - 1.0).abs() < 1e-12);
    assert!((m.norm2(0.075 * along) - 1.0).abs() < 1e-12);
}

#[test]
fn example_1_has_the_metric_area_of_the_specification() {
    // The unit square less a centred disc of radius 0.2: 265.8 (docs/algorithm.md, "Examples of the paper"), by the
    // midpoint rule.
    let sizing = sizing(&[example_1()]);
    let n = 400;
    let mut area = 0.0;
    for k in 0..n * n {
        let p = DVec2::new(f64::from(k % n) + 0.5, f64::from(k / n) + 0.5) / f64::from(n);
        if p.distance(DVec2::splat(0.5)) > 0.2 {
            area += sizing.metric(p).unwrap().det().sqrt() / f64::from(n * n);
        }
    }
    assert!((area - 265.8).abs() < 0.5, "{area}");
}

#[test]
fn missing_directions_are_completed() {
    let plane = |directions| sizing(&[formula(&[], &["0.1", "2"], directions)]).metric(DVec2::ZERO).unwrap();
    assert_eq!(plane([None, None, None]), Metric2 { uu: 1.0 / (0.1 * 0.1), uv: 0.0, vv: 0.25 });
    let diagonal = plane([Some(["1", "1", "0"]), Some(["-1", "1", "0"]), None]);
    for same in [
        [Some(["2", "2", "0"]), None, None],
        [None, Some(["-1", "1", "0"]), None],
        [Some(["1", "1", "0"]), None, Some(["0", "0", "-2"])],
        [None, Some(["1", "-1", "0"]), Some(["0", "0", "1"])],
        [Some(["1+0*x", "1", "0"]), None, None],
    ] {
        let m = plane(same);
        assert!((m.uu - diagonal.uu).abs() + (m.uv - diagonal.uv).abs() < 1e-12, "{m:?}");
    }
    let space = sizing(&[formula(&[], &["1", "2", "4"], [None, Some(["0", "0", "1"]), Some(["1", "0", "0"])])]);
    let m = space.metric3(&MetricPlace::in_plane(DVec2::ZERO)).unwrap();
    assert_eq!((m.yy, m.zz, m.xx), (1.0, 0.25, 0.0625));
}

#[test]
fn invalid_sizes_are_refused_with_name_value_and_place() {
    for (h1, message) in [
        ("x-0.27", "h1 = -0.02"),
        ("x-0.25", "h1 = 0 is not positive"),
        ("sqrt(x-1)", "h1 = NaN is not finite"),
        ("1/(x-0.25)", "h1 = inf is not finite"),
        ("ln(0)", "h1 = -inf is not finite"),
    ] {
        let message_found = bad_at(formula(&[], &[h1], [None, None, None]), 0.25, 0.5);
        assert!(message_found.contains(message), "{message_found}");
        assert!(message_found.starts_with("(0.25, 0.5): "), "{message_found}");
        assert!(message_found.contains("(case.toml, line 7)"), "{message_found}");
    }
    let parallel = formula(&[], &["1", "2"], [Some(["1", "x", "0"]), Some(["1", "0.5", "0"]), None]);
    assert!(sizing(std::slice::from_ref(&parallel)).metric(DVec2::X).is_ok());
    assert!(bad_at(parallel, 0.5, 0.0).contains("parallel"));
    let zero = formula(&[], &["1", "2"], [Some(["x", "y", "0"]), None, None]);
    assert!(bad_at(zero, 0.0, 0.0).contains("not a direction"));
    assert!(bad_at(formula(&[], &["1", "x"], [None, None, None]), 1e-9, 0.0).contains("factor"));
}

#[test]
fn incomplete_formulas_are_refused_when_compiled() {
    let fault = |spec| Field::compile(&spec, &curves).expect_err("a fault").to_string();
    let mut h2_only = formula(&[], &["1"], [None, None, None]);
    if let FieldSpec::Formula { sizes, .. } = &mut h2_only {
        sizes.swap(0, 1);
    }
    assert!(fault(h2_only).contains("must be h1"));
    assert!(fault(formula(&[], &[], [None, None, None])).contains("must be h1"));
    assert!(fault(formula(&[], &["1"], [Some(["1", "0", "0"]), None, None])).contains("only size"));
    assert!(fault(formula(&[], &["1", "2"], [None, None, Some(["0", "0", "1"])])).contains("g3 alone"));
    let parallel = formula(&[], &["1", "2"], [Some(["1", "1", "0"]), Some(["2", "2", "0"]), None]);
    assert!(fault(parallel).starts_with("case.toml, line 7: "));
    assert!(fault(formula(&[], &["phi*2"], [None, None, None])).contains("h1 = \"phi*2\""));
    assert!(fault(FieldSpec::Uniform { h: -1.0 }).contains("h = -1 is not positive"));
}

#[test]
fn fields_intersect_and_sizes_scale() {
    let specs = [FieldSpec::Uniform { h: 0.5 }, formula(&[], &["x", "2"], [None, None, None])];
    let both = sizing(&specs);
    assert_eq!(both.metric(DVec2::new(0.25, 0.0)).unwrap(), Metric2 { uu: 16.0, uv: 0.0, vv: 4.0 });
    assert_eq!(both.metric(DVec2::X).unwrap(), Metric2::isotropic(0.5));
    let halved = Sizing::new(specs.iter().map(compile).collect(), 0.5);
    assert_eq!(halved.metric(DVec2::X).unwrap(), Metric2::isotropic(0.25));
}

#[test]
fn a_boundary_layer_grows_with_the_distance_across_its_curves() {
    let alone = sizing(&[wall(Some(0.1), Some(0.05))]);
    for (y, h) in [(0.0, 1e-3), (0.01, 1e-3 + 0.25 * 0.01), (-0.01, 1e-3 + 0.25 * 0.01), (0.5, 0.05)] {
        let m = alone.metric(DVec2::new(1.03, y)).unwrap();
        assert!((m.norm2(DVec2::new(0.0, h)) - 1.0).abs() < 1e-9, "{y}");
        assert!((m.norm2(DVec2::new(0.1, 0.0)) - 1.0).abs() < 1e-9, "{y}");
    }
    // Beyond the end of the wall the distance is to its last point.
    let m = alone.metric(DVec2::new(2.03, 0.04)).unwrap();
    let n = DVec2::new(0.6, 0.8);
    assert!((m.norm2((1e-3 + 0.25 * 0.05) * n) - 1.0).abs() < 1e-9);
    // Rounding beside the wall does not change the direction.
    let m = alone.metric(DVec2::new(0.3, 1e-17)).unwrap();
    assert!((m.uv / m.vv).abs() < 1e-12);
}

#[test]
fn a_boundary_layer_without_size_along_takes_that_of_the_other_fields_in_any_order() {
    let uniform = FieldSpec::Uniform { h: 0.2 };
    for specs in [[uniform.clone(), wall(None, None)], [wall(None, None), uniform]] {
        let m = sizing(&specs).metric(DVec2::new(1.0, 0.01)).unwrap();
        assert!((m.uu - 25.0).abs() < 1e-9 && m.uv.abs() < 1e-9, "{m:?}");
        assert!((m.norm2(DVec2::new(0.0, 0.0035)) - 1.0).abs() < 1e-9);
        let far = sizing(&specs).metric(DVec2::new(1.0, 5.0)).unwrap();
        assert_eq!(far, Metric2::isotropic(0.2));
    }
    let alone = sizing(&[wall(None, None)]).metric(DVec2::new(0.51, 0.003)).unwrap();
    assert!(alone.is_spd());
    assert!(alone.eigen().0[0] < 1e-5);
}

#[test]
fn bad_boundary_layers_are_refused() {
    let fault = |change: fn(&mut f64, &mut f64, &mut Option<f64>, &mut Vec<String>)| {
        let mut spec = wall(Some(0.1), Some(0.5));
        if let FieldSpec::BoundaryLayer { first, growth, far, curves, .. } = &mut spec {
            change(first, growth, far, curves);
        }
        Field::compile(&spec, &curves).expect_err("a fault").to_string()
    };
    assert!(fault(|first, _, _, _| *first = 0.0).contains("first = 0"));
    assert!(fault(|first, _, _, _| *first = 1e-9).contains("factor"));
    assert!(fault(|_, growth, _, _| *growth = 0.9).contains("growth = 0.9"));
    assert!(fault(|_, growth, _, _| *growth = f64::NAN).contains("growth"));
    assert!(fault(|_, _, far, _| *far = Some(1e-4)).contains("far is smaller"));
    assert!(fault(|_, _, _, curves| curves.clear()).contains("zero length"));
    let unknown = fault(|_, _, _, curves| curves[0] = "wal".into());
    assert!(unknown.starts_with("case.toml, line 9: ") && unknown.contains("\"wal\""), "{unknown}");
}

/// A square of 2 n^2 triangles graded towards x = 0, with sizes exp of a linear function at its nodes.
fn table(n: u32) -> (Vec<DVec2>, Vec<[u32; 3]>, Vec<Metric3>) {
    let at = |i: u32| libm::pow(f64::from(i) / f64::from(n), 4.0);
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for j in 0..=n {
        for i in 0..=n {
            points.push(DVec2::new(at(i), f64::from(j) / f64::from(n)));
            if i < n && j < n {
                let k = j * (n + 1) + i;
                // One of the two is clockwise.
                triangles.extend([[k, k + 1, k + n + 1], [k + n + 2, k + n + 1, k + 1]]);
            }
        }
    }
    let metrics = points.iter().map(|&p| exponential(p)).collect();
    (points, triangles, metrics)
}

fn exponential(p: DVec2) -> Metric3 {
    let h = libm::exp(2.0 * p.x - p.y);
    Metric3::from_sizes([0.01 * h, h, 3.0], [DVec3::new(1.0, 2.0, 0.0), DVec3::new(-2.0, 1.0, 0.0), DVec3::Z]).unwrap()
}

#[test]
fn a_table_is_log_euclidean_between_its_nodes_and_clamped_outside() {
    let (points, triangles, metrics) = table(12);
    let sizing = Sizing::new(vec![Field::table(&points, &triangles, metrics).unwrap()], 1.0);
    let close = |a: Metric2, b: Metric2| {
        let d = (a.uu - b.uu).abs() + (a.uv - b.uv).abs() + (a.vv - b.vv).abs();
        assert!(d < 1e-11 * (b.uu + b.vv), "{a:?} {b:?}");
    };
    for k in 0..500 {
        let p = DVec2::new((f64::from(k) * 0.618_034).fract(), f64::from(k) / 499.0);
        close(sizing.metric(p).unwrap(), exponential(p).plane());
        let outside = DVec2::new(1.0 + 0.1 * p.x, p.y);
        close(sizing.metric(outside).unwrap(), exponential(DVec2::new(1.0, p.y)).plane());
    }
    for &p in &points {
        close(sizing.metric(p).unwrap(), exponential(p).plane());
    }
    close(sizing.metric(DVec2::new(-1.0, 2.0)).unwrap(), exponential(DVec2::new(0.0, 1.0)).plane());
    assert!(sizing.metric(DVec2::new(f64::NAN, 0.0)).is_err());
}

#[test]
fn a_table_gives_the_same_bits_whatever_was_evaluated_before() {
    let (points, triangles, metrics) = table(6);
    let sizing = Sizing::new(vec![Field::table(&points, &triangles, metrics).unwrap()], 1.0);
    let places: Vec<DVec2> = (0..200).map(|k| points[(k * 7) % points.len()] * 0.99).collect();
    let forward: Vec<_> = places.iter().map(|&p| sizing.metric(p).unwrap()).collect();
    let backward: Vec<_> = places.iter().rev().map(|&p| sizing.metric(p).unwrap()).collect();
    assert!(forward.iter().eq(backward.iter().rev()));
}

#[test]
fn bad_tables_are_refused() {
    let (points, triangles, metrics) = table(2);
    let fault = |points: &[DVec2], triangles: &[[u32; 3]], metrics: &[Metric3]| {
        Field::table(points, triangles, metrics.to_vec()).expect_err("a fault").to_string()
    };
    assert!(fault(&points[1..], &triangles, &metrics).contains("9 metrics for 8 nodes"));
    assert!(fault(&points, &[], &metrics).contains("no triangles"));
    assert!(fault(&points, &[[0, 1, 99]], &metrics).contains("Triangle 1"));
    assert!(fault(&points, &[[0, 1, 2]], &metrics).contains("no area"));
    let mut bad = metrics.clone();
    bad[3].xy = 1e9;
    assert!(fault(&points, &triangles, &bad).contains("node 4 is not positive definite"));
    let mut bad = points.clone();
    bad[0].x = f64::NAN;
    assert!(fault(&bad, &triangles, &metrics).contains("Node 1"));
}
