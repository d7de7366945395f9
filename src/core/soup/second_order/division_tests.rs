use super::*;
use crate::core::soup::{Members, SecondOrder};

/// A point of the parabola z = x^2 and its square, 4 by 4 squares of side 1/4 as quadratic triangles.
fn parabola() -> MeshFile {
    let at = |i: u32, j: u32| {
        let [x, y] = [i, j].map(|k| f64::from(k) / 8.0);
        DVec3::new(x, y, x * x)
    };
    let node = |i: u32, j: u32| j / 2 * 5 + i / 2;
    let mut mesh = MeshFile::default();
    for (i, j) in (0..25).map(|k| (2 * (k % 5), 2 * (k / 5))) {
        mesh.points.push(at(i, j));
    }
    for (i, j) in (0..16).map(|k| (2 * (k % 4), 2 * (k / 4))) {
        for t in [[(i, j), (i + 2, j), (i + 2, j + 2)], [(i, j), (i + 2, j + 2), (i, j + 2)]] {
            mesh.triangles.push(t.map(|(i, j)| node(i, j)));
            for (p, q) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                let middle = at(u32::midpoint(p.0, q.0), u32::midpoint(p.1, q.1));
                mesh.second_order.sides.push((key(node(p.0, p.1), node(q.0, q.1)), middle));
            }
        }
    }
    mesh.second_order.sides.sort_by_key(|side| side.0);
    mesh.second_order.sides.dedup_by_key(|side| side.0);
    mesh
}

/// Sides that only one triangle has.
fn border(mesh: &MeshFile) -> usize {
    let mut all: Vec<[u32; 2]> = mesh.triangles.iter().flat_map(|&t| sides(t)).collect();
    all.sort_unstable();
    all.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).count()
}

#[test]
fn pieces_of_a_parabola_lie_on_it_and_fit_together() {
    let mut mesh = parabola();
    mesh.triangle_tags = (0..32).map(|k| 1 + k / 16).collect();
    mesh.members = vec![Members { dimension: 2, tag: 7, of: vec![3] }];
    let divided = mesh.divided_along_bends().unwrap();
    assert_eq!((divided.elements, divided.triangles, divided.is_coarse), (32, mesh.triangles.len(), false));
    assert!(mesh.points.iter().all(|p| (p.z - p.x * p.x).abs() < 1e-15));
    let mut area = 0.0;
    for &t in &mesh.triangles {
        let [a, b, c] = t.map(|k| mesh.points[k as usize]);
        let middles = [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0];
        assert!(middles.iter().all(|p| (p.z - p.x * p.x).abs() < 2.5e-4), "{a} {b} {c}");
        area += (b - a).truncate().perp_dot((c - a).truncate()) / 2.0;
    }
    assert!((area - 1.0).abs() < 1e-12, "{area}");
    // No hanging points: sides with one triangle are on the border alone, whose length they have.
    let on_border = |p: DVec3| p.x == 0.0 || p.x == 1.0 || p.y == 0.0 || p.y == 1.0;
    assert_eq!(border(&mesh), mesh.points.iter().filter(|p| on_border(**p)).count());
    // Region 2 is the half beyond y = 1/2; triangle 3 is that of the second square.
    for (k, (t, tag)) in mesh.triangles.iter().zip(&mesh.triangle_tags).enumerate() {
        let middle = t.iter().map(|&k| mesh.points[k as usize]).sum::<DVec3>() / 3.0;
        assert_eq!(*tag, if middle.y > 0.5 { 2 } else { 1 });
        let is_third = middle.y < 0.25 && (0.25..0.5).contains(&middle.x) && middle.y > middle.x - 0.25;
        assert_eq!(mesh.members[0].of.contains(&(k as u32)), is_third);
    }
    assert_eq!(mesh.describe_elements(&[0]), "triangle 1");
}

#[test]
fn a_straight_neighbour_and_a_line_follow_the_bend_of_a_shared_side() {
    // Two triangles above and below the side from 0 to 1, bent down; a polygon and a line at another bent side.
    let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let mut mesh = MeshFile {
        points: vec![p(0.0, 0.0), p(1.0, 0.0), p(0.5, 1.0), p(0.5, -1.0), p(2.0, 0.0), p(2.0, 1.0), p(1.0, 2.0)],
        triangles: vec![[0, 1, 2], [1, 0, 3]],
        polygons: vec![vec![1, 4, 5, 6, 2]],
        lines: vec![[2, 1], [0, 3], [1, 0]],
        line_tags: vec![5, 6, 7],
        ..MeshFile::default()
    };
    mesh.second_order.sides = vec![([0, 1], p(0.5, -0.1)), ([1, 2], p(0.85, 0.55))];
    let before = mesh.points.len();
    let divided = mesh.divided_along_bends().unwrap();
    assert_eq!((divided.elements, divided.lengths.len()), (2, mesh.points.len()));
    // The parabola from 0 to 1 through the node has y = -0.4 x (1 - x).
    let below: Vec<DVec3> = mesh.points[before..].iter().copied().filter(|p| p.y < 0.0).collect();
    assert!(below.len() >= 15 && below.iter().all(|p| (p.y + 0.4 * p.x * (1.0 - p.x)).abs() < 1e-15));
    let of = |tag: u32| mesh.line_tags.iter().filter(|own| **own == tag).count();
    assert_eq!([of(7), of(6)], [below.len() + 1, 1]);
    assert!(of(5) > 4 && mesh.polygons[0].len() == 4 + of(5));
    // The area between both outer sides of the triangles, less what the polygon gains.
    let area: f64 = mesh
        .triangles
        .iter()
        .map(|t| t.map(|k| mesh.points[k as usize].truncate()))
        .map(|[a, b, c]| (b - a).perp_dot(c - a) / 2.0)
        .sum();
    // A parabola has two thirds of the box of its chord and height.
    let bulge = 2.0 / 3.0 * (p(1.0, 0.0) - p(0.5, 1.0)).length() * {
        let across = (p(0.85, 0.55) - p(0.75, 0.5)).truncate();
        across.dot(glam::DVec2::new(1.0, 0.5).normalize())
    };
    assert!((area - (1.0 + bulge)).abs() < 1e-3, "{area} {bulge}");
    assert!(mesh.second_order.is_empty());
}

#[test]
fn quadrilaterals_of_8_and_9_nodes_follow_theirs() {
    let p = |x: f64, y: f64| DVec3::new(x, y, x * x + y * y);
    let corners = vec![p(0.0, 0.0), p(1.0, 0.0), p(1.0, 1.0), p(0.0, 1.0)];
    let sides = vec![([0, 1], p(0.5, 0.0)), ([0, 3], p(0.0, 0.5)), ([1, 2], p(1.0, 0.5)), ([2, 3], p(0.5, 1.0))];
    for centres in [Vec::new(), vec![([0, 1, 2, 3], p(0.5, 0.5))]] {
        let second_order = SecondOrder { sides: sides.clone(), centres };
        let mut mesh =
            MeshFile { points: corners.clone(), quads: vec![[0, 1, 2, 3]], second_order, ..MeshFile::default() };
        mesh.quad_tags = vec![4];
        let divided = mesh.divided_along_bends().unwrap();
        assert!(mesh.quads.is_empty() && mesh.triangle_tags == vec![4; divided.triangles]);
        // Serendipity has all terms of order 2, so both are the paraboloid.
        assert!(mesh.points.iter().all(|p| (p.z - p.x * p.x - p.y * p.y).abs() < 1e-14));
        for t in &mesh.triangles {
            let middle = t.iter().map(|&k| mesh.points[k as usize]).sum::<DVec3>() / 3.0;
            assert!((middle.z - middle.x * middle.x - middle.y * middle.y).abs() < 1.5e-3);
        }
    }
}

#[test]
fn what_is_straight_stays_and_what_is_wild_is_bounded() {
    let mut mesh = parabola();
    mesh.points.iter_mut().for_each(|p| p.z = 0.0);
    mesh.second_order.sides.iter_mut().for_each(|side| side.1.z = 0.0);
    let before = mesh.clone();
    assert!(mesh.divided_along_bends().is_none() && mesh == before);
    mesh.second_order.sides.iter_mut().for_each(|side| side.1.z = 1e9);
    let divided = mesh.divided_along_bends().unwrap();
    assert!(divided.is_coarse && divided.triangles <= 32 << (2 * LEVELS), "{}", divided.triangles);
}
