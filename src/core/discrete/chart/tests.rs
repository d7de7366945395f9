use super::*;
use crate::core::discrete::features::ANGLE;
use crate::core::discrete::fixtures::{charted, cube, plate, sphere, three_half_planes, torus, tube};
use crate::core::kernel::predicates::orient;

/// The charts, checked to be valid.
fn valid(mesh: &Triangles, angle: f64, bound: StretchBound) -> Vec<Chart> {
    let found = charted(mesh, angle, bound);
    let mut owner = vec![u32::MAX; mesh.triangles.len()];
    for (number, chart) in found.iter().enumerate() {
        for (&t, local) in chart.triangles.iter().zip(&chart.local) {
            assert_eq!(owner[t as usize], u32::MAX, "a triangle of two charts");
            owner[t as usize] = number as u32;
            assert_eq!(local.map(|k| chart.points[k as usize]), mesh.triangles[t as usize]);
            let [a, b, c] = local.map(|k| chart.uv[k as usize]);
            assert!(orient(a, b, c) > 0.0);
        }
        // The areas of the triangles add up to that of the border polygons.
        let doubled = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
        let all: f64 =
            chart.local.iter().map(|t| t.map(|k| chart.uv[k as usize])).map(|[a, b, c]| doubled(a, b, c)).sum();
        let (mut polygons, mut first) = (0.0, 0);
        for &long in &chart.loops {
            let polygon = &chart.uv[first..first + long as usize];
            polygons += (0..polygon.len()).map(|k| polygon[k].perp_dot(polygon[(k + 1) % polygon.len()])).sum::<f64>();
            first += long as usize;
        }
        assert!((all - polygons).abs() < 1e-9 * polygons, "{all} {polygons}");
        assert!(chart.triangles.len() == 1 || bound.allows(chart.stretch), "{:?}", chart.stretch);
    }
    assert!(owner.iter().all(|&o| o != u32::MAX), "a triangle of no chart");
    found
}

#[test]
fn a_cube_has_a_chart_for_each_side_that_keeps_its_shape() {
    let found = valid(&cube(6), ANGLE, StretchBound::default());
    assert_eq!(found.len(), 6);
    assert!(found.iter().all(|c| c.stretch.shape < 1.001 && c.stretch.area < 1.001), "{:?}", found[0].stretch);
}

#[test]
fn closed_surfaces_are_cut_into_few_charts() {
    assert_eq!(valid(&sphere(10), ANGLE, StretchBound::default()).len(), 2);
    let found = valid(&torus(30, 20), ANGLE, StretchBound::default()).len();
    assert!((2..=4).contains(&found), "{found}");
}

#[test]
fn a_tube_is_slit_and_unrolled() {
    for (mesh, length) in [(tube(24, 10, 4.0), 4.0), (tube(12, 200, 100.0), 100.0)] {
        let found = valid(&mesh, ANGLE, StretchBound::default());
        assert_eq!(found.len(), 1);
        assert!(found[0].stretch.shape < 1.01 && found[0].stretch.area < 1.01, "{length}: {:?}", found[0].stretch);
    }
}

#[test]
fn a_plate_with_a_hole_keeps_it_and_a_tighter_bound_cuts_more() {
    let mut mesh = plate(9, 0.02);
    // The middle square.
    mesh.triangles.drain(80..82);
    mesh.region.truncate(160);
    let found = valid(&mesh, ANGLE, StretchBound::default());
    assert_eq!((found.len(), found[0].loops.as_slice()), (1, &[36, 4][..]));
    let whole = valid(&sphere(8), ANGLE, StretchBound { shape: 1.3, area: 1.7 }).len();
    assert!((3..60).contains(&whole), "{whole}");
}

#[test]
fn half_planes_that_branch_are_a_chart_each_and_a_plate_is_one() {
    assert_eq!(valid(&three_half_planes(), ANGLE, StretchBound::default()).len(), 3);
    assert_eq!(valid(&plate(20, 0.1), ANGLE, StretchBound::default()).len(), 1);
}

#[test]
fn a_fold_that_ends_inside_slits_its_chart() {
    // A plate with a crease from its left side to its middle.
    let mut mesh = plate(8, 0.0);
    for p in &mut mesh.points {
        p.z = (0.5 - p.x).max(0.0) * (p.y - 0.5).abs() * 2.0;
    }
    let found = valid(&mesh, 0.9, StretchBound { shape: 50.0, area: 1e4 });
    assert_eq!(found.len(), 1);
    let twice = found[0].points.len() - mesh.points.len();
    assert!((1..=4).contains(&twice), "{twice}");
}

#[test]
fn triangles_without_area_and_single_ones_have_charts_too() {
    let mut mesh = cube(2);
    let p = mesh.points[3];
    mesh.points[4] = p;
    let found = charted(&mesh, ANGLE, StretchBound::default());
    assert_eq!(found.iter().map(|c| c.triangles.len()).sum::<usize>(), mesh.triangles.len());
    let single = Triangles {
        points: mesh.points[..3].to_vec(),
        triangles: vec![[0, 1, 2]],
        region: vec![0],
        ..Triangles::default()
    };
    assert_eq!(valid(&single, ANGLE, StretchBound::default()).len(), 1);
}

#[test]
fn charts_are_deterministic() {
    let mesh = sphere(12);
    let charts = || charted(&mesh, ANGLE, StretchBound::default());
    assert_eq!(charts(), charts());
}
