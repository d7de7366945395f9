use super::*;

/// What makes a mesh defective.
type Change = fn(&mut MeshFile);
/// The defects that are found, with how many there are of each.
type Found = &'static [(Defect, u64)];

/// `n` by `n` unit squares, translated by `at`.
fn squares(n: u32, at: DVec3) -> MeshFile {
    let mut mesh = MeshFile::default();
    for j in 0..=n {
        for i in 0..=n {
            mesh.points.push(at + DVec3::new(f64::from(i), f64::from(j), 0.0));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            mesh.quads.push([a, a + 1, a + n + 2, a + n + 1]);
        }
    }
    mesh
}

/// Both meshes in one file.
fn with(mut mesh: MeshFile, other: &MeshFile) -> MeshFile {
    let offset = mesh.points.len() as u32;
    mesh.points.extend(&other.points);
    mesh.quads.extend(other.quads.iter().map(|quad| quad.map(|node| node + offset)));
    mesh
}

/// A strip of `n` quadrilaterals around the origin over `turns` turns, its ends joined or not.
fn ring(n: u32, turns: f64, joined: bool) -> MeshFile {
    let mut mesh = MeshFile::default();
    let last = if joined { n } else { n + 1 };
    for i in 0..last {
        let angle = std::f64::consts::TAU * turns * f64::from(i) / f64::from(n);
        let (sin, cos) = libm::sincos(angle);
        for radius in [1.0, 2.0] {
            mesh.points.push(DVec3::new(radius * cos, radius * sin, 0.0));
        }
    }
    for i in 0..n {
        let (a, b) = (2 * i, 2 * ((i + 1) % last));
        mesh.quads.push([a, a + 1, b + 1, b]);
    }
    mesh
}

fn defects(mesh: &MeshFile) -> Vec<(Defect, u64)> {
    examine(mesh).findings.iter().map(|finding| (finding.defect, finding.count)).collect()
}

const SEAMS: Allow = Allow { triangles: false, seams: true, branching: false };

#[test]
fn a_grid_and_a_ring_are_sound_and_counted() {
    let soundness = examine(&squares(3, DVec3::ZERO));
    assert_eq!(soundness.verdict(Allow::default()), Ok(()));
    assert_eq!((soundness.edges, soundness.boundary_edges, soundness.boundary_loops), (24, 12, 1));
    assert_eq!((soundness.euler, soundness.components, soundness.planar), (1, 1, true));
    assert_eq!((soundness.area, soundness.boundary_length), (9.0, 12.0));
    let soundness = examine(&ring(12, 1.0, true));
    assert_eq!(soundness.findings, []);
    assert_eq!((soundness.boundary_loops, soundness.euler), (2, 0));
}

#[test]
fn single_defects_are_found_in_squares() {
    use Defect::*;
    let cases: [(u32, Change, Found); 10] = [
        (
            1,
            |mesh| {
                mesh.quads.push([0, 1, 2, 9]);
                mesh.points[0].x = f64::NAN;
            },
            &[(BadNode, 1), (NotFinite, 1)],
        ),
        (1, |mesh| *mesh = MeshFile::default(), &[(NoElements, 1)]),
        (2, |mesh| mesh.points.push(DVec3::new(0.5, 0.5, 0.0)), &[(OrphanNode, 1)]),
        (2, |mesh| mesh.quads.iter_mut().for_each(|quad| quad.reverse()), &[]),
        (2, |mesh| mesh.quads = vec![mesh.quads[0], mesh.quads[3]], &[(OrphanNode, 2), (PinchedNode, 1)]),
        (1, |mesh| mesh.points[3] = DVec3::new(0.4, 0.4, 0.0), &[(NotConvex, 1)]),
        (1, |mesh| mesh.points[3] = DVec3::new(0.5, 0.5, 0.0), &[(NotConvex, 1)]),
        // One unit in the last place beyond the diagonal.
        (1, |mesh| mesh.points[3] = DVec3::new(0.5f64.next_up(), 0.5, 0.0), &[]),
        (2, |mesh| mesh.points[8].z = 0.1, &[]),
        // Folded in space.
        (2, |mesh| mesh.points[8] = DVec3::new(1.2, 1.2, 0.1), &[(NotConvex, 1)]),
    ];
    for (i, (n, change, expected)) in cases.into_iter().enumerate() {
        let mut mesh = squares(n, DVec3::ZERO);
        change(&mut mesh);
        assert_eq!(defects(&mesh), expected, "case {i}");
    }
}

#[test]
fn defects_beside_others_are_counted() {
    use Defect::*;
    let cases: [(u32, Change, Defect, u64); 6] = [
        (2, |mesh| mesh.quads.push([1, 4, 3, 0]), DuplicateElement, 1),
        (2, |mesh| mesh.quads[0] = [0, 1, 1, 3], RepeatedNode, 1),
        (2, |mesh| mesh.quads[0].reverse(), OrientationConflict, 2),
        (2, |mesh| mesh.quads[0].reverse(), Inverted, 1),
        (1, |mesh| mesh.points[2..].copy_from_slice(&[-DVec3::X, 1e-12 * DVec3::Y]), ZeroArea, 1),
        (
            1,
            |mesh| {
                mesh.points.push(DVec3::new(0.5, 0.5, 0.0));
                mesh.quads = vec![[0, 1, 3, 4], [0, 4, 3, 2]];
            },
            Doublet,
            1,
        ),
    ];
    for (n, change, defect, count) in cases {
        let mut mesh = squares(n, DVec3::ZERO);
        change(&mut mesh);
        assert_eq!(examine(&mesh).count(defect), count, "{defect:?}");
    }
}

#[test]
fn triangles_and_other_elements_are_reported() {
    let mut mesh = squares(1, DVec3::ZERO);
    mesh.quads.clear();
    mesh.triangles = vec![[0, 1, 3], [0, 3, 2]];
    mesh.skipped = vec![("tetrahedron".into(), 3)];
    assert_eq!(defects(&mesh), [(Defect::OtherElements, 3), (Defect::Triangles, 2)]);
    mesh.skipped.clear();
    assert!(examine(&mesh).verdict(Allow::default()).is_err());
    assert!(examine(&mesh).verdict(Allow { triangles: true, ..Allow::default() }).is_ok());
}

#[test]
fn an_edge_of_three_elements_is_branching_and_allowed_on_demand() {
    let mut mesh = squares(1, DVec3::ZERO);
    mesh.points.extend([DVec3::new(0.0, 0.0, 1.0), DVec3::new(1.0, 0.0, 1.0)]);
    mesh.points.extend([DVec3::new(0.0, 0.0, -1.0), DVec3::new(1.0, 0.0, -1.0)]);
    mesh.quads.extend([[0, 1, 5, 4], [0, 1, 7, 6]]);
    assert_eq!(defects(&mesh), [(Defect::BranchingEdge, 1)]);
    assert!(examine(&mesh).verdict(Allow { branching: true, ..Allow::default() }).is_ok());
}

#[test]
fn closed_surfaces_that_touch_in_a_node_are_pinched() {
    // The node is not on a boundary.
    let cube = |at: DVec3| {
        let corner = |i: u32| at + DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        let quads = vec![[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        MeshFile { points: (0..8).map(corner).collect(), quads, ..MeshFile::default() }
    };
    let alone = cube(DVec3::ZERO);
    assert_eq!((examine(&alone).findings, examine(&alone).euler), (vec![], 2));
    let mut two = with(cube(DVec3::ZERO), &cube(DVec3::ONE));
    two.quads.iter_mut().flatten().for_each(|node| *node = if *node == 8 { 7 } else { *node });
    assert_eq!(defects(&two), [(Defect::OrphanNode, 1), (Defect::PinchedNode, 1)]);
}

#[test]
fn coincident_nodes_are_seams_on_the_boundary_and_defects_inside() {
    let mesh = with(squares(2, DVec3::ZERO), &squares(2, DVec3::new(2.0, 0.0, 0.0)));
    assert_eq!(defects(&mesh), [(Defect::SeamNode, 6)]);
    assert!(examine(&mesh).verdict(Allow::default()).is_err());
    assert!(examine(&mesh).verdict(SEAMS).is_ok());
    let mut mesh = squares(3, DVec3::ZERO);
    mesh.points[5] = mesh.points[6] + DVec3::new(1e-12, -1e-12, 0.0);
    assert_eq!(examine(&mesh).count(Defect::CoincidentNode), 2);
    assert!(examine(&mesh).verdict(SEAMS).is_err());
}

#[test]
fn a_node_within_an_edge_hangs() {
    let mut mesh = with(squares(2, DVec3::ZERO), &squares(1, DVec3::ZERO));
    for point in &mut mesh.points[9..] {
        *point = *point * 2.0 + DVec3::new(2.0, 0.0, 0.0);
    }
    let soundness = examine(&mesh);
    assert_eq!((soundness.count(Defect::HangingNode), soundness.count(Defect::SeamNode)), (1, 4));
    assert!(soundness.verdict(SEAMS).is_err());
}

#[test]
fn overlapping_meshes_are_found_though_their_areas_agree() {
    // A spiral of one turn and a half; a ring that turns twice; pieces inside, across, and on top of each other.
    assert_eq!(defects(&ring(18, 1.5, false)).last().map(|it| it.0), Some(Defect::Overlap));
    assert_eq!(examine(&ring(18, 0.9, false)).findings, []);
    assert!(examine(&ring(24, 2.0, true)).count(Defect::Overlap) > 0);
    let inside = with(squares(4, DVec3::ZERO), &squares(1, DVec3::new(1.3, 1.3, 0.0)));
    assert_eq!(defects(&inside)[0].0, Defect::Overlap);
    let across = with(squares(4, DVec3::ZERO), &squares(2, DVec3::new(3.3, 3.3, 0.0)));
    assert!(examine(&across).count(Defect::Overlap) > 0);
    let on_top = with(squares(2, DVec3::ZERO), &squares(2, DVec3::ZERO));
    assert!(examine(&on_top).count(Defect::Overlap) > 0);
    assert!(examine(&on_top).verdict(SEAMS).is_err());
    let beside = with(squares(2, DVec3::ZERO), &squares(2, DVec3::new(2.5, 0.0, 0.0)));
    assert_eq!(defects(&beside), []);
}

#[test]
fn a_piece_in_the_hole_of_another_does_not_overlap() {
    let mut inner = squares(1, DVec3::new(-0.5, -0.5, 0.0));
    assert_eq!(defects(&with(ring(12, 1.0, true), &inner)), []);
    inner.points.iter_mut().for_each(|p| *p *= 2.5);
    assert!(examine(&with(ring(12, 1.0, true), &inner)).count(Defect::Overlap) > 0);
}

#[test]
fn a_verdict_names_defects_counts_and_positions() {
    let mut mesh = squares(2, DVec3::ZERO);
    mesh.points[4] = DVec3::new(2.5, 1.0, 0.0);
    mesh.points.push(DVec3::new(7.0, 8.0, 0.0));
    let fault = examine(&mesh).verdict(Allow::default()).unwrap_err();
    assert_eq!(
        fault.to_string(),
        "The mesh is invalid: 1 node belongs to no element (node 10 at 7, 8, 0); 2 quadrilaterals are not \
         strictly convex (first element 2 at 1, 0, 0). Remove the unused nodes."
    );
}

#[test]
fn coordinates_at_the_ends_of_the_range_do_no_harm() {
    for scale in [1e308, 1e200, 1e-200, 1e-308] {
        let mut mesh = squares(2, DVec3::ZERO);
        mesh.points.iter_mut().for_each(|p| *p *= scale);
        examine(&mesh);
        mesh.points[4].z = scale;
        examine(&mesh);
    }
}
