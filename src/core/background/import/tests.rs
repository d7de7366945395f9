use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::core::background::discretise::tests::Uniform;
use crate::core::background::implied_metric::implied_metric;
use crate::core::background::triangulate::divide_and_triangulate;
use crate::core::geometry::fixtures::{built, square, square_with_hole};
use crate::core::kernel::Metric2;
use crate::core::soup::Group;

/// What makes a mesh defective.
type Change = fn(&mut MeshFile);

fn mesh(points: &[(f64, f64)], triangles: &[[u32; 3]]) -> MeshFile {
    MeshFile {
        points: points.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect(),
        triangles: triangles.to_vec(),
        ..MeshFile::default()
    }
}

/// A square of four triangles around its centre, node 4.
fn star() -> MeshFile {
    mesh(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.5, 0.5)], &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
}

/// The same with triangle 4 missing: three triangles, a loop of five.
fn odd_fan() -> MeshFile {
    let mut file = star();
    file.triangles.pop();
    file
}

/// A triangle in the middle of three others.
fn one_within_three() -> MeshFile {
    mesh(
        &[(0.0, 0.0), (2.0, 0.0), (1.0, 2.0), (1.0, 0.0), (1.5, 1.0), (0.5, 1.0)],
        &[[3, 4, 5], [0, 3, 5], [3, 1, 4], [5, 4, 2]],
    )
}

fn refusal(file: &MeshFile) -> String {
    import(file, false, None).unwrap_err().to_string()
}

#[test]
fn a_valid_mesh_is_imported_unchanged() {
    let imported = import(&star(), false, None).unwrap();
    assert_eq!(imported.set.triangles, star().triangles);
    assert_eq!(imported.set.uv.len(), 5);
    assert_eq!(imported.repairs, Vec::<String>::new());
    assert_eq!(imported.regions, [Named::tagged("region 0", 0)]);
    assert_eq!(imported.origin, [[0, 0], [1, 1], [2, 2], [3, 3], [4, 4]]);
}

#[test]
fn clockwise_and_duplicate_triangles_and_orphans_are_repaired_and_reported() {
    let mut file = star();
    file.points.push(DVec3::new(7.0, 7.0, 0.0));
    file.triangles[1].swap(0, 1);
    file.triangles.push([0, 3, 4]);
    let imported = import(&file, false, None).unwrap();
    assert_eq!(imported.set.triangles.len(), 4);
    assert_eq!(
        imported.repairs,
        ["1 unused point was removed", "1 duplicate triangle was removed", "1 clockwise triangle was reversed"]
    );
}

#[test]
fn quadrilaterals_and_polygons_among_triangles_are_cut_and_reported() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0], [1.5, 2.0]];
    let mut file = MeshFile {
        points: square.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec(),
        triangles: vec![[2, 5, 6]],
        quads: vec![[1, 4, 5, 2]],
        polygons: vec![vec![0, 1, 2, 6, 3]],
        ..MeshFile::default()
    };
    let imported = import(&file, false, None).unwrap();
    assert_eq!(imported.set.triangles.len(), 6);
    assert_eq!(imported.repairs, ["2 quadrilaterals and polygons were split into triangles"]);
    file.triangles.clear();
    file.quads.clear();
    assert!(import(&file, true, None).is_ok());
}

#[test]
fn what_cannot_be_repaired_is_refused() {
    let cases: [(Change, &str); 7] = [
        (
            |file| (file.quads, file.triangles) = (vec![[0, 1, 2, 3]; 12], vec![]),
            "already quadrilateral: all of its 12",
        ),
        (
            |file| (file.skipped, file.triangles) = (vec![("tetrahedron".to_owned(), 3)], vec![]),
            "no triangles, only 3 tetrahedron",
        ),
        (|file| file.points[2].x = f64::NAN, "Point 3 is at (NaN, 1, 0)"),
        (|file| file.triangles[2][1] = 9, "Triangle 3 refers to point 10 of 5"),
        (|file| file.triangles[2][1] = u32::MAX, "4294967296"),
        (
            |file| {
                file.points.extend([(0.2, 0.3), (3.0, 0.3), (3.0, 0.4)].map(|(x, y)| DVec3::new(x, y, 0.0)));
                file.triangles.push([5, 6, 7]);
            },
            "Triangles 1, 2, 4 and 5 overlap",
        ),
        (
            |file| {
                file.points.push(DVec3::new(0.6, 0.2, 0.0));
                file.triangles.push([4, 0, 5]);
            },
            "Triangles 1, 4 and 5 share one edge",
        ),
    ];
    for (change, said) in cases {
        let mut file = star();
        change(&mut file);
        let says = refusal(&file);
        assert!(says.contains(said), "{says}");
    }
    let folded = mesh(&[(0.0, 0.0), (1.0, 0.0), (0.5, 1.0), (0.5, 2.0)], &[[0, 1, 2], [0, 1, 3]]);
    assert!(refusal(&folded).contains("Triangles 1 and 2 overlap"));
}

#[test]
fn a_plane_may_have_any_height() {
    let mut file = star();
    file.points.iter_mut().for_each(|p| p.z = 3.0);
    assert!(import(&file, false, None).is_ok());
    file.points[4].z = 3.25;
    assert!(refusal(&file).contains("z ranges from 3 to 3.25"));
}

#[test]
fn flat_triangles_are_removed() {
    // One at the border, whose corner others share; one with a node twice; one whose corner the neighbour receives.
    for height in [0.0, 1e-9] {
        let mut file = star();
        file.points[4] = DVec3::new(0.5, height, 0.0);
        let imported = import(&file, true, None).unwrap();
        assert_eq!(imported.set.triangles.len(), 4);
        assert_eq!(imported.repairs[0], "1 degenerate triangle was removed");
    }
    let mut file = star();
    file.triangles.push([3, 3, 4]);
    assert_eq!(import(&file, false, None).unwrap().set.triangles.len(), 4);
    let mut file = star();
    file.points.push(DVec3::new(0.25, 0.25, 0.0));
    file.triangles[0] = [1, 4, 5];
    file.triangles.extend([[1, 5, 0], [0, 5, 4]]);
    file.lines = vec![[0, 4]];
    file.line_tags = vec![8];
    let imported = import(&file, true, None).unwrap();
    assert_eq!(imported.repairs[0], "1 degenerate triangle was removed");
    // The line runs along what its side has become.
    assert_eq!((imported.set.triangles.len(), imported.set.lines.len()), (6, 4));
}

#[test]
fn triangles_between_the_sides_of_a_crack_are_refused_by_their_numbers_in_the_file() {
    let mut file = star();
    file.points.push(DVec3::new(0.5, 0.5, 0.0));
    file.triangles.extend([[0, 4, 5], [4, 5, 2]]);
    file.counting.triangles = crate::core::soup::Count::From(11);
    let fault = import(&file, false, None).unwrap_err();
    let says = fault.to_string();
    assert!(says.contains("Triangles 15 and 16 are too flat: the first is without area"), "{says}");
    assert_eq!((fault.shapes.len(), fault.shapes[0].len()), (2, 3));
}

#[test]
fn hanging_nodes_are_connected_unless_there_is_a_gap() {
    // A square on top of the star, which has the middle of their common side.
    let mut file = star();
    file.points[2].y = 1.0;
    file.points.extend([(0.5, 1.0), (0.0, 2.0), (1.0, 2.0)].map(|(x, y)| DVec3::new(x, y, 0.0)));
    file.triangles.extend([[3, 5, 6], [5, 7, 6], [5, 2, 7]]);
    let imported = import(&file, true, None).unwrap();
    assert_eq!(imported.repairs[0], "1 hanging point was joined to the mesh");
    assert_eq!(imported.set.triangles.len(), 8);
    // The square has points of its own, at the ends of the side too.
    file.points.extend([file.points[3], file.points[2]]);
    file.triangles.truncate(4);
    file.triangles.extend([[8, 5, 6], [5, 7, 6], [5, 9, 7]]);
    let fault = import(&file, true, None).unwrap_err();
    assert!(fault.to_string().contains("Point 6 hangs on a side of another triangle"), "{fault}");
    assert_eq!(fault.shapes, [[DVec3::new(0.5, 1.0, 0.0)]]);
}

#[test]
fn pinched_nodes_are_split_and_so_are_their_points() {
    let mut file = star();
    file.triangles.extend([[2, 5, 6], [2, 6, 7]]);
    file.points.extend([(2.0, 1.0), (2.0, 2.0), (1.0, 2.0)].map(|(x, y)| DVec3::new(x, y, 0.0)));
    let imported = import(&file, false, None).unwrap();
    assert_eq!(imported.set.uv.len(), 9);
    assert_eq!(imported.set.point.iter().map(|p| p.0).max(), Some(8));
    assert_eq!(imported.repairs, ["1 node was split where triangles share only a point"]);
}

#[test]
fn several_components_are_all_kept() {
    let mut file = star();
    let shifted: Vec<DVec3> = file.points.iter().map(|p| *p + 5.0 * DVec3::X).collect();
    let more: Vec<[u32; 3]> = file.triangles.iter().map(|t| t.map(|n| n + 5)).collect();
    file.points.extend(shifted);
    file.triangles.extend(more);
    let imported = import(&file, false, None).unwrap();
    assert_eq!((imported.set.uv.len(), imported.set.triangles.len()), (10, 8));
}

#[test]
fn coincident_nodes_remain_the_two_sides_of_a_crack() {
    // The star with its edge from node 0 to the centre opened: node 5 is the other side of node 0.
    let mut file = star();
    file.points.push(DVec3::new(0.0, 0.0, 0.0));
    file.triangles[3] = [3, 5, 4];
    let imported = import(&file, false, None).unwrap();
    assert_eq!(imported.set.uv.len(), 6);
    assert_eq!(imported.set.point.iter().map(|p| p.0).max(), Some(5));
    assert_eq!(imported.repairs, ["1 coincident point was kept as the other side of a crack"]);
}

#[test]
fn regions_are_cut_apart_and_named() {
    let mut file = star();
    file.triangle_tags = vec![7, 7, 3, 3];
    file.groups = vec![Group { dimension: 2, tag: 7, name: "steel".to_owned() }];
    let imported = import(&file, false, None).unwrap();
    assert_eq!(imported.regions, [Named::tagged("region 3", 3), Named::tagged("steel", 7)]);
    assert_eq!(imported.set.region, [1, 1, 0, 0]);
    assert_eq!(imported.set.uv.len(), 8);
    assert_eq!(imported.set.point.iter().map(|p| p.0).max(), Some(4));
}

#[test]
fn an_odd_part_is_refused_with_a_loop_and_its_place() {
    let says = refusal(&odd_fan());
    assert!(
        says.contains("loop of 5 segments") && says.contains("with 3 triangles") && says.contains("Divide one"),
        "{says}"
    );
    // A soup of triangles: the remedy names the cause.
    let soup = mesh(&[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], &[[0, 1, 2], [3, 4, 5]]);
    assert!(refusal(&soup).contains("merge coincident points"));
}

#[test]
fn an_odd_part_is_divided_at_its_longest_boundary_segment_if_allowed() {
    let mut file = odd_fan();
    file.points[1].x = 2.0;
    let imported = import(&file, true, None).unwrap();
    assert_eq!(imported.set.triangles.len(), 4);
    assert_eq!(imported.set.uv[5], DVec2::new(1.0, 0.0));
    assert_eq!(imported.origin[5], [0, 1]);
    assert!(imported.repairs[0].contains("1 boundary segment was divided"));
    let metric: Vec<Metric3> = [1.0, 4.0, 1.0, 1.0, 1.0].map(Metric3::isotropic).to_vec();
    let middle = imported.at_nodes(&metric)[5];
    assert!((middle.xx - 1.0 / 4.0).abs() < 1e-12, "the geometric mean of the sizes: {middle:?}");
}

#[test]
fn odd_regions_share_as_few_divided_sides_as_possible() {
    // The one is of another region than the three around it, which meet only in points.
    let mut file = one_within_three();
    file.triangle_tags = vec![1, 2, 2, 2];
    let imported = import(&file, false, None).unwrap();
    assert_eq!(imported.repairs, ["3 sides between parts were divided to make triangle counts even"]);
    assert_eq!(imported.set.region.iter().filter(|region| **region == 0).count(), 4);
    file.triangle_tags.clear();
    assert!(import(&file, false, None).is_ok());
    // A strip of five squares; its regions have 1, 2, 2, 2, 2 and 1 triangles.
    let points: Vec<(f64, f64)> = (0..12).map(|k| (f64::from(k / 2), f64::from(k % 2))).collect();
    let halves: Vec<[u32; 3]> =
        (0..5).map(|k| 2 * k).flat_map(|k| [[k, k + 2, k + 1], [k + 2, k + 3, k + 1]]).collect();
    let strip = MeshFile { triangle_tags: (0..10).map(|t| (t + 3) / 2).collect(), ..mesh(&points, &halves) };
    let told = |split_odd| import(&strip, split_odd, None).unwrap().repairs;
    assert_eq!(told(false), ["5 sides between parts were divided to make triangle counts even"]);
    assert_eq!(told(true), ["2 boundary segments were divided to make triangle counts even"]);
}

#[test]
fn odd_loops_of_an_even_part_are_fine() {
    // A ring between two triangles: two loops of three, six triangles.
    let file = mesh(
        &[(0.0, 0.0), (9.0, 0.0), (0.0, 9.0), (2.0, 2.0), (4.0, 2.0), (2.0, 4.0)],
        &[[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]],
    );
    assert_eq!(import(&file, false, None).unwrap().set.triangles.len(), 6);
}

#[test]
fn lost_lines_inside_regions_are_reported() {
    let mut file = star();
    file.lines = vec![[0, 1], [4, 0]];
    assert_eq!(import(&file, false, None).unwrap().repairs, ["1 ungrouped line inside a region was ignored"]);
}

#[test]
fn lines_in_groups_are_kept_inside_regions_and_at_the_border() {
    let mut file = star();
    file.lines = vec![[1, 0], [4, 0], [4, 2]];
    file.line_tags = vec![9, 5, 5];
    file.groups = vec![Group { dimension: 1, tag: 5, name: "rib".to_owned() }];
    let Imported { set, lines, repairs, .. } = import(&file, false, None).unwrap();
    assert_eq!(lines, [Named::tagged("rib", 5), Named::tagged("line 9", 9)]);
    assert!(repairs.is_empty(), "{repairs:?}");
    // Both banks of the rib name its two sides; nodes on it are doubled, points are not.
    assert_eq!((set.lines.iter().filter(|line| line.1 == 0).count(), set.lines.len()), (4, 5));
    assert_eq!((set.uv.len(), set.point.iter().map(|p| p.0).max()), (8, Some(4)));
}

#[test]
fn odd_parts_on_both_sides_of_a_line_are_made_even_by_dividing_it() {
    // A ring of a line around the one.
    let mut file = one_within_three();
    file.lines = vec![[3, 4], [4, 5], [5, 3]];
    file.line_tags = vec![1; 3];
    // The three outside are separate parts, since they meet only in points: each shares a side with the one inside.
    let Imported { set, repairs, .. } = import(&file, false, None).unwrap();
    assert_eq!((set.triangles.len(), set.lines.len()), (10, 12));
    assert!(repairs[0].starts_with("3 "), "{repairs:?}");
    let firm = |t: &[u32; 3]| firm(set.uv[t[0] as usize], set.uv[t[1] as usize], set.uv[t[2] as usize]);
    assert!(set.triangles.iter().all(firm) && set.lines.iter().all(|line| line.1 == 0));
    // Two odd parts: the side between them is divided, even without `split_odd`.
    let mut file = star();
    file.triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 5, 4], [5, 6, 4], [6, 0, 4]];
    file.points.extend([DVec3::new(-0.1, 0.6, 0.0), DVec3::new(-0.1, 0.4, 0.0)]);
    (file.lines, file.line_tags) = (vec![[0, 4], [4, 3]], vec![4; 2]);
    let Imported { set, repairs, .. } = import(&file, false, None).unwrap();
    assert_eq!((set.triangles.len(), set.lines.len()), (8, 6));
    assert!(repairs[0].contains("divided"), "{repairs:?}");
}

#[test]
fn equilateral_triangles_imply_their_size_and_stretched_ones_their_stretch() {
    let height = 0.75_f64.sqrt();
    for stretch in [1.0, 1e-3] {
        let points: Vec<(f64, f64)> = (0..20)
            .map(|i| (f64::from(i % 5) + 0.5 * f64::from(i / 5), f64::from(i / 5) * height))
            .map(|(x, y)| (0.1 * x, 0.1 * stretch * y))
            .collect();
        let mut triangles = Vec::new();
        for (i, j) in (0..3).flat_map(|j| (0..4).map(move |i| (i, j))) {
            let a = 5 * j + i;
            triangles.extend([[a, a + 1, a + 5], [a + 1, a + 6, a + 5]]);
        }
        let set = import(&mesh(&points, &triangles), false, None).unwrap().set;
        for m in implied_metric(&set) {
            let (uu, vv) = (100.0, 100.0 / (stretch * stretch));
            assert!((m.uu / uu - 1.0).abs() < 1e-6 && (m.vv / vv - 1.0).abs() < 1e-6, "{m:?}");
            assert!(m.uv.abs() < 1e-6 * (uu * vv).sqrt());
        }
    }
}

#[test]
fn a_background_mesh_survives_export_and_import() {
    for specs in [square(), square_with_hole()] {
        let (_, set) = divide_and_triangulate(&built(specs), &Uniform(0.05)).unwrap();
        let file = MeshFile {
            points: set.uv.iter().map(|p| p.extend(0.0)).collect(),
            triangles: set.triangles.clone(),
            ..MeshFile::default()
        };
        let expected = TriangleSet { lines: Vec::new(), ..set.clone() };
        assert_eq!(import(&file, false, None).unwrap().set, expected);
        assert!(implied_metric(&set).iter().all(Metric2::is_spd));
    }
}

proptest! {
    /// Arbitrary input is imported or refused, without a panic.
    #[test]
    fn arbitrary_input_is_imported_or_refused(
        points in prop::collection::vec((0_i32..5, 0_i32..5), 0..12),
        triangles in prop::collection::vec([0_u32..13, 0_u32..13, 0_u32..13], 0..12),
        tags in prop::option::of(prop::collection::vec(0_u32..3, 12)),
        split in any::<bool>(),
    ) {
        let points: Vec<(f64, f64)> = points.iter().map(|&(x, y)| (f64::from(x), f64::from(y))).collect();
        let mut file = mesh(&points, &triangles);
        file.triangle_tags = tags.map(|t| t[..triangles.len()].to_vec()).unwrap_or_default();
        if let Ok(imported) = import(&file, split, None) {
            let set = &imported.set;
            let at = |node: u32| set.uv[node as usize];
            prop_assert!(set.triangles.iter().all(|&[a, b, c]| firm(at(a), at(b), at(c))));
            prop_assert_eq!(set.triangles.len() % 2, 0);
            prop_assert!(implied_metric(set).iter().all(Metric2::is_spd));
        }
    }
}
