//! Promise: the measures of quadrilaterals are those that VTK's Verdict computes, in the report and in files, and what
//! is called valid has scaled Jacobians above 0 there.
#![allow(clippy::unwrap_used)]

use glam::DVec3;
use quadfront::core::case::{Parameters, built_in};
use quadfront::core::convert::conversion::convert;
use quadfront::core::metric::straight_quad::{StraightQuad, VerdictMeasures};
use quadfront::core::progress::Nobody;
use quadfront::core::record::{Export, Report};
use quadfront::core::run::{History, Run};
use quadfront::core::soup::soundness::examine;
use quadfront::core::soup::{Defect, MeshFile};

/// A quadrilateral with VTK's values.
struct ByVtk {
    name: &'static str,
    quad: StraightQuad,
    /// Scaled Jacobian, aspect ratio, skew and warpage.
    values: [f64; 4],
}

fn by_vtk() -> Vec<ByVtk> {
    let text = include_str!("data/verdict.txt");
    let numbers = |text: &str| text.split_whitespace().map(|word| word.parse().unwrap()).collect::<Vec<f64>>();
    let of_line = |line: &'static str| {
        let parts: Vec<&str> = line.split(';').collect();
        let corners = [1, 2, 3, 4].map(|k| DVec3::from_slice(&numbers(parts[k])));
        ByVtk { name: parts[0], quad: StraightQuad(corners), values: numbers(parts[5]).try_into().unwrap() }
    };
    let all: Vec<ByVtk> = text.lines().filter(|line| !line.starts_with('#')).map(of_line).collect();
    assert!(all.len() >= 20, "{}", all.len());
    all
}

#[test]
fn measures_are_those_that_vtk_computes() {
    for ByVtk { name, quad, values } in by_vtk() {
        let VerdictMeasures { scaled_jacobian, aspect_ratio, skew, warpage } = quad.measures();
        for (found, expected) in [scaled_jacobian, aspect_ratio, skew, warpage].into_iter().zip(values) {
            assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{name}: {found} and {expected}");
        }
    }
    let point = StraightQuad([DVec3::ONE; 4]).measures();
    assert_eq!([point.scaled_jacobian, point.skew], [0.0; 2]);
    assert!(point.aspect_ratio.is_finite() && point.warpage.is_finite());
}

#[test]
fn a_scaled_jacobian_does_not_depend_on_the_first_corner_nor_on_the_sense() {
    // Verdict itself takes a quadrilateral whose last two corners are at one place for a triangle.
    for ByVtk { name, quad: StraightQuad([a, b, c, d]), values } in by_vtk() {
        if [a, b, c, d].windows(2).all(|two| two[0] != two[1]) {
            for corners in [[b, c, d, a], [c, d, a, b], [d, a, b, c], [d, c, b, a]] {
                let found = StraightQuad(corners).scaled_jacobian();
                assert!((found - values[0]).abs() < 1e-12, "{name}: {found} and {}", values[0]);
            }
        }
    }
}

#[test]
fn a_quadrilateral_in_space_is_convex_where_vtk_has_its_scaled_jacobian_above_0() {
    let mut counts = [0; 2];
    for ByVtk { name, quad: StraightQuad(corners), values } in by_vtk() {
        if corners.iter().all(|p| p.z == corners[0].z) {
            continue;
        }
        let file = MeshFile { points: corners.to_vec(), quads: vec![[0, 1, 2, 3]], ..MeshFile::default() };
        let is_convex = values[0] > 0.0;
        assert_eq!(examine(&file).count(Defect::NotConvex) == 0, is_convex, "{name}");
        counts[usize::from(is_convex)] += 1;
    }
    assert!(counts[0] >= 2 && counts[1] >= 8, "{counts:?}");
}

#[test]
fn elements_of_a_file_have_the_measures_by_their_names_and_triangles_have_minus_1() {
    let mut run = Run::of(built_in::named("wing").unwrap().unwrap());
    run.parameters.size_scale *= 2.0;
    let background = run.background(&mut Nobody).unwrap();
    let mut history = History::of(run, &background, 64 << 20).unwrap();
    history.extend(u64::MAX);
    history.seek(history.end().unwrap() / 4).unwrap();
    let mesh = &history.state().mesh;
    let mut export = Export::of_state(mesh, &background.names);
    export.describe(mesh, &background.sizing, None).unwrap();
    let file = &export.file;
    assert!(file.triangles.len() > 10 && file.quads.len() > 10);
    type Measure = fn(&StraightQuad) -> f64;
    let measures: [(&str, Measure); 4] = [
        ("scaled_jacobian", StraightQuad::scaled_jacobian),
        ("aspect_ratio", StraightQuad::aspect_ratio),
        ("skew", StraightQuad::skew),
        ("warpage", StraightQuad::warpage),
    ];
    for (name, measure) in measures {
        let data = file.element_data.iter().find(|data| data.name == name).unwrap();
        let of_quads = file.quads.iter().map(|quad| measure(&StraightQuad(quad.map(|n| file.points[n as usize]))));
        let expected: Vec<f64> = file.triangles.iter().map(|_| -1.0).chain(of_quads).collect();
        assert_eq!(data.values, expected, "{name}");
    }
}

/// Converts every built-in case at a size scale, by the default parameters and by the paper's.
fn assert_all_above_0(scale: f64) {
    for (name, _) in built_in::CASES {
        for rules in [Parameters::default(), Parameters::paper()] {
            let mut case = built_in::named(name).unwrap().unwrap();
            case.parameters = case.parameters.with_rules_of(rules);
            case.parameters.size_scale *= scale;
            let converted = convert(&case, &mut Nobody).unwrap();
            let report = Report::of(&case, &converted).unwrap();
            let least = report.mesh.verdict.unwrap().scaled_jacobian.min;
            assert!(report.valid && least > 0.0, "{name} at {scale}: {least}");
            // The same from the file alone.
            let file = Export::of(&converted.mesh, &converted.names).file;
            let jacobian = |quad: &[u32; 4]| StraightQuad(quad.map(|n| file.points[n as usize])).scaled_jacobian();
            assert_eq!(file.quads.iter().map(jacobian).fold(f64::INFINITY, f64::min), least, "{name} at {scale}");
        }
    }
}

#[test]
fn built_in_cases_have_scaled_jacobians_above_0() {
    assert_all_above_0(1.0);
}

#[test]
fn built_in_cases_at_size_scale_0_8_have_scaled_jacobians_above_0() {
    assert_all_above_0(0.8);
}

#[test]
fn built_in_cases_at_size_scale_0_64_have_scaled_jacobians_above_0() {
    assert_all_above_0(0.64);
}

#[test]
fn built_in_cases_at_size_scale_0_5_have_scaled_jacobians_above_0() {
    assert_all_above_0(0.5);
}
