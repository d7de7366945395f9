use super::*;
use crate::core::discrete::StretchBound;
use crate::core::discrete::features::ANGLE;
use crate::core::discrete::repair::repair;
use crate::core::discrete::surface::surface;
use crate::core::geometry::fixtures::*;
use crate::core::kernel::Metric2;
use crate::core::metric::{BadMetric, MetricPlace};
use crate::core::progress::Nobody;
use crate::core::soup::MeshFile;

/// The same size everywhere.
pub struct Uniform(pub f64);

impl MetricSource for Uniform {
    fn metric(&self, _: DVec2) -> Result<Metric2, Box<BadMetric>> {
        let m = 1.0 / (self.0 * self.0);
        Ok(Metric2 { uu: m, uv: 0.0, vv: m })
    }
}

/// Finer to the left, ten times finer across x than along.
pub struct Stretched;

impl MetricSource for Stretched {
    fn metric(&self, p: DVec2) -> Result<Metric2, Box<BadMetric>> {
        let h = 0.01 + 0.05 * p.x * p.x;
        Ok(Metric2 { uu: 1.0 / (h * h), uv: 0.0, vv: 0.01 / (h * h) })
    }
}

fn counts(specs: Specs, h: f64) -> Vec<usize> {
    divide(&built(specs), &Uniform(h)).unwrap().chains.iter().map(|c| c.len() - 1).collect()
}

fn refusal(specs: Specs, h: f64) -> String {
    divide(&built(specs), &Uniform(h)).unwrap_err().to_string()
}

#[test]
fn uniform_sizes_give_equal_segments() {
    let divided = divide(&built(square()), &Uniform(0.1)).unwrap();
    assert_eq!(divided.nodes.len(), 40);
    for chain in &divided.chains {
        assert_eq!(chain.len(), 11);
        for w in chain.windows(2) {
            let length = divided.nodes[w[0] as usize].distance(divided.nodes[w[1] as usize]);
            assert!((length - 0.1).abs() < 1e-8);
        }
    }
}

#[test]
fn segments_are_equally_long_in_a_varying_metric() {
    // Along y = 0 the length from 0 to x is the integral of 1 / (0.01 + 0.05 x^2).
    let exact = |x: f64| libm::atan(x * 5.0_f64.sqrt()) / (0.01 * 0.05_f64).sqrt();
    let domain = built((
        vec![segment("low", (0.0, 0.0), (3.0, 0.0)), polyline("up", &[(3.0, 0.0), (3.0, 1.0), (0.0, 0.0)], false)],
        vec![face("f", "low up", &[], "", "")],
    ));
    let divided = divide(&domain, &Stretched).unwrap();
    let chain = &divided.chains[0];
    let n = chain.len() - 1;
    assert!((n as f64 - exact(3.0)).abs() < 1.6);
    for (k, &node) in chain.iter().enumerate() {
        let target = exact(3.0) * k as f64 / n as f64;
        assert!((exact(divided.nodes[node as usize].x) - target).abs() < 1e-4, "{k}");
    }
}

#[test]
fn a_sudden_jump_of_size_is_resolved() {
    struct Jump;
    impl MetricSource for Jump {
        fn metric(&self, p: DVec2) -> Result<Metric2, Box<BadMetric>> {
            Uniform(if (p.x - 0.337).abs() < 0.01 { 1e-4 } else { 0.1 }).metric(p)
        }
    }
    let divided = divide(&built(square()), &Jump).unwrap();
    let inside = divided.chains[0].iter().filter(|&&n| (divided.nodes[n as usize].x - 0.337).abs() < 0.01).count();
    assert!((inside as f64 - 200.0).abs() <= 2.0, "{inside}");
}

#[test]
fn loops_are_even_and_at_least_four_long() {
    for (name, specs) in all() {
        let domain = built(specs);
        for h in [0.013, 0.1, 0.17, 0.3, 0.7, 3.0, 100.0] {
            let divided = divide(&domain, &Uniform(h)).unwrap();
            for face in &domain.faces {
                for walk in &face.walks {
                    let n: usize = walk.iter().map(|s| divided.chains[s.curve.index()].len() - 1).sum();
                    assert!(n.is_multiple_of(2) && n >= 4, "{name} at {h}: {n}");
                }
            }
        }
    }
}

#[test]
fn the_curve_that_suffers_least_is_toggled() {
    // Sides of 10.5 and 1 in units of the size: the relative change of the long one is least.
    let curves = vec![
        segment("a", (0.0, 0.0), (10.5, 0.0)),
        segment("b", (10.5, 0.0), (10.5, 1.0)),
        segment("c", (10.5, 1.0), (0.0, 1.0)),
        segment("d", (0.0, 1.0), (0.0, 0.0)),
    ];
    let mut specs = (curves, vec![face("f", "a b c d", &[], "", "")]);
    specs.0[2].segments = Some(10);
    assert_eq!(counts(specs, 1.0), [10, 1, 10, 1]);
}

#[test]
fn polylines_keep_their_corners_and_toggle_one_piece() {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.3), (0.5, 0.2)];
    let divided =
        divide(&built((vec![polyline("p", &corners, true)], vec![face("f", "p", &[], "", "")])), &Uniform(0.1))
            .unwrap();
    for corner in corners {
        assert!(divided.nodes.contains(&DVec2::from(corner)));
    }
    // Pieces of 10, 3, 5.1 and 5.39 lengths: the last gains one.
    assert_eq!(divided.chains[0].len() - 1, 24);
}

#[test]
fn fixed_numbers_are_kept_and_shared_among_pieces() {
    let mut specs = square_with_hole();
    specs.0[4].segments = Some(26);
    assert_eq!(counts(specs, 0.1)[4], 26);
    let mut specs =
        (vec![polyline("p", &[(0.0, 0.0), (1.0, 0.0), (1.0, 0.3)], true)], vec![face("f", "p", &[], "", "")]);
    specs.0[0].segments = Some(8);
    assert_eq!(counts(specs.clone(), 0.01), [8]);
    specs.0[0].segments = Some(2);
    assert!(refusal(specs, 0.1).contains("3 pieces between corners, but only 2 segments"));
}

#[test]
fn a_fixed_odd_loop_is_refused_with_its_name() {
    let mut specs = square_with_hole();
    specs.0[4].segments = Some(27);
    specs.0[4].place = "plate.toml, line 14".to_owned();
    assert_eq!(
        refusal(specs, 0.1),
        "plate.toml, line 14: The boundary loop \"hole\" has 27 segments; an all-quad mesh needs an even count. \
         Set the segments of \"hole\" to 26 or 28, or leave the number out."
    );
    let mut specs = square();
    specs.0.iter_mut().zip([5, 4, 4, 4]).for_each(|(c, n)| c.segments = Some(n));
    let says = refusal(specs, 0.1);
    assert!(says.contains("outer loop of \"plate\" has 17 segments"), "{says}");
    let mut specs = square();
    specs.0.iter_mut().zip([1, 1, 1]).for_each(|(c, n)| c.segments = Some(n));
    assert_eq!(counts(specs, 0.1), [1, 1, 1, 11]);
}

#[test]
fn loops_that_are_odd_only_together_are_named_together() {
    // The shared side is free, the others have an odd sum: 3 + 3 + 3 and 10 cannot both be made even.
    let mut specs = two_faces();
    for (c, n) in specs.0.iter_mut().zip([Some(3), Some(3), None, Some(3), Some(10)]) {
        c.segments = n;
    }
    let says = refusal(specs, 0.1);
    assert!(
        says.contains("outer loop of \"left\"")
            && says.contains("outer loop of \"right\"")
            && says.contains("19 segments"),
        "{says}"
    );
}

#[test]
fn loops_fixed_too_short_are_refused() {
    let mut specs = square_with_hole();
    specs.0[4].segments = Some(2);
    assert!(refusal(specs, 0.1).contains("\"hole\" has 2 segments; it needs at least 4"));
}

#[test]
fn absurd_sizes_are_refused_before_anything_is_allocated() {
    assert!(refusal(square(), 1e-12).contains("would get 1.000e12 segments"));
    let mut specs = square();
    specs.0[0].segments = Some(u32::MAX);
    assert!(refusal(specs, 0.1).contains("fewer segments"));
    assert!(refusal(square(), 1e-200).contains("target sizes long"));
}

#[test]
fn a_metric_that_fails_is_placed_on_its_curve() {
    struct Bad;
    impl MetricSource for Bad {
        fn metric(&self, p: DVec2) -> Result<Metric2, Box<BadMetric>> {
            if p.x > 0.5 {
                let place = MetricPlace::in_plane(p);
                return Err(Box::new(BadMetric { what: "h1 = -1 is not positive".to_owned(), place }));
            }
            Uniform(0.1).metric(p)
        }
    }
    let says = divide(&built(square()), &Bad).unwrap_err().to_string();
    assert!(says.contains("on the curve \"south\"") && says.contains("h1 = -1 is not positive"), "{says}");
}

#[test]
fn shared_curves_are_divided_once() {
    let domain = built(two_faces());
    let divided = divide(&domain, &Uniform(0.1)).unwrap();
    assert_eq!(divided.nodes.len(), 40 + 29);
    assert_eq!(&divided.nodes[..domain.vertices.len()], &domain.vertices[..]);
}

/// A floor and a wall with a narrow gap between them, straight along the wall and bent along the floor.
#[test]
fn a_bent_chord_beside_a_divided_one_is_divided_too() {
    let points = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.5, 0.03, 0.0],
        [-1.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
    ];
    let floor = [[0, 2, 5], [2, 6, 5], [2, 1, 6], [3, 0, 5], [1, 4, 6]];
    let wall = [[0, 7, 8], [0, 8, 1], [3, 7, 0], [1, 8, 4]];
    let file = MeshFile {
        points: points.into_iter().map(DVec3::from).collect(),
        triangles: floor.into_iter().chain(wall).collect(),
        ..MeshFile::default()
    };
    let given = repair(&file, None, &mut Nobody).unwrap();
    let domain = surface(&given.mesh, &given.regions, ANGLE, StretchBound::default(), &mut Nobody).unwrap().domain;
    let spatial = domain.spatial.clone().unwrap();
    let between = |id: &CurveId| {
        let ends = domain.curves[id.index()].ends.map(|v| spatial.vertices[spatial.vertex_of[v as usize] as usize]);
        ends.iter().all(|p| *p == DVec3::ZERO || *p == DVec3::X)
    };
    let first = (0..domain.curves.len() as u32).map(CurveId).filter(|id| domain.curves[id.index()].first == *id);
    let (straight, bent): (Vec<CurveId>, Vec<CurveId>) =
        first.filter(between).partition(|id| spatial.curves[id.index()].is_chord());
    let ([straight], [bent]) = (&straight[..], &bent[..]) else { panic!("{straight:?} {bent:?}") };
    for n in [1, 2, 5] {
        let mut division = Division::measure(&domain, &Uniform(5.0)).unwrap();
        division.pieces[straight.index()][0].segments = n;
        assert_eq!(division.segments(*bent), 1);
        division.open_lenses();
        // By an even number, so that loops stay even.
        assert_eq!(division.segments(*bent), if n == 1 { 1 } else { 3 });
        assert_eq!(division.segments(*straight), n);
    }
}
