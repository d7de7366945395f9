use super::*;

/// A grid of squares in two triangles each, every triangle with corners of its own, moved by at most `noise`.
fn soup(squares: u32, noise: f64, seed: u64) -> MeshFile {
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let mut mesh = MeshFile::default();
    for (i, j) in (0..squares).flat_map(|i| (0..squares).map(move |j| (i, j))) {
        for half in [[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]] {
            let first = mesh.points.len() as u32;
            for (x, y) in half {
                let p = DVec3::new(f64::from(i + x), f64::from(j + y), 0.0);
                mesh.points.push(p + noise * DVec3::new(random(), random(), random()) / 3.0_f64.sqrt());
            }
            mesh.triangles.push([first, first + 1, first + 2]);
        }
    }
    mesh
}

/// The first point within a distance of each, by comparing all.
fn by_comparing_all(mesh: &MeshFile, distance: f64) -> Vec<u32> {
    let near = |p: &DVec3| mesh.points.iter().position(|q| p.distance(*q) <= distance).unwrap() as u32;
    mesh.points.iter().map(near).collect()
}

#[test]
fn corners_of_a_soup_that_differ_by_noise_become_one() {
    for (seed, noise) in [(1, 1e-12), (2, 1e-7), (3, 1e-5), (4, 4e-4)] {
        let given = soup(9, noise, seed);
        let mut mesh = given.clone();
        let told = mesh.join_near(Weld::Auto, &Cancel::default());
        let expected = by_comparing_all(&given, 2.0 * noise);
        let corners = given.triangles.as_flattened().iter().map(|&k| expected[k as usize]);
        assert_eq!(mesh.triangles.as_flattened(), corners.collect::<Vec<_>>(), "{noise}");
        assert!(mesh.joined == given.points.len() - 100 && told.is_some(), "{told:?}");
        // The same by a distance.
        let mut mesh = given.clone();
        mesh.join_near(Weld::Within(2.0 * noise), &Cancel::default());
        assert_eq!(mesh.joined, given.points.len() - 100);
        let mut mesh = given.clone();
        assert!(mesh.join_near(Weld::Within(0.0), &Cancel::default()).is_none() && mesh == given);
    }
}

#[test]
fn gaps_are_told_and_what_is_exact_or_an_edge_is_left_alone() {
    let told = |mesh: &MeshFile| {
        let mut mesh = mesh.clone();
        mesh.join_near(Weld::Auto, &Cancel::default());
        let joined = mesh.joined;
        let (mesh, _) = mesh.triangulated();
        (joined, nearly_touching(&mesh.points, &mesh.triangles, &Cancel::default()))
    };
    // Points at one place are not near ones, whatever their number.
    assert_eq!(told(&soup(4, 0.0, 1)), (0, None));
    let gap = |gap: f64| {
        let mut mesh = MeshFile::default();
        for x in [0.0, 1.0 + gap] {
            let first = mesh.points.len() as u32;
            mesh.points
                .extend([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(u, v)| DVec3::new(x + u, v, 0.0)));
            mesh.quads.push([0, 1, 2, 3].map(|k| first + k));
        }
        mesh
    };
    assert_eq!(told(&gap(0.0)), (0, None));
    assert_eq!(told(&gap(1e-4)).0, 2);
    let close = "4 border points lie on or near elements without being joined to them (nearest 0.01 away): \
                 (1, 0, 0), (1, 1, 0), (1.01, 0, 0), ...";
    assert_eq!(told(&gap(0.01)), (0, Some(close.to_owned())));
    assert_eq!(told(&gap(0.2)), (0, None));
    // Thin elements are no gaps: their short edges are edges.
    let mut thin = gap(0.0);
    thin.points.iter_mut().for_each(|p| p.x *= 1e-7);
    assert_eq!(told(&thin), (0, None));
    // A plate that stands on the middle of another one.
    let mut mesh = gap(5.0);
    mesh.points[4..]
        .copy_from_slice(&[(0.2, 0.0), (0.8, 0.0), (0.8, 1.0), (0.2, 1.0)].map(|(x, z)| DVec3::new(x, 0.3, z)));
    let stands = "2 border points lie on or near elements without being joined to them (nearest 0 away): \
                  (0.2, 0.3, 0), (0.8, 0.3, 0)";
    assert_eq!(told(&mesh), (0, Some(stands.to_owned())));
}

#[test]
fn coordinates_of_few_digits_are_joined_by_their_precision() {
    // The two sides of a border, rounded to five digits apart from each other, with edges of 50 units.
    for (rounded, joined) in [(true, 21), (false, 0)] {
        let mut mesh = MeshFile::default();
        for side in [0.0, 1.0] {
            for (row, column) in (0..2).flat_map(|row| (0..21).map(move |column| (row, column))) {
                let x = 0.1 + 5e-4 * f64::from(column) + 1e-5 * side;
                let y = 5e-4 * (side + f64::from(row));
                let rounding =
                    |v: f64| if rounded { format!("{v:.5}").parse().unwrap() } else { v + 0.123_456_789_012e-6 };
                mesh.points.push(DVec3::new(rounding(x), rounding(y), 0.0));
            }
            let first = 42 * side as u32;
            mesh.quads.extend((0..20).map(|k| [k, k + 1, k + 22, k + 21].map(|k| first + k)));
        }
        mesh.join_near(Weld::Auto, &Cancel::default());
        assert_eq!(mesh.joined, joined);
    }
    let single = [DVec3::new(f64::from(0.1_f32), 3.0, f64::from(1e-7_f32))];
    assert_eq!(precision(single.into_iter()), 2.0 * 3.0 * f64::from(f32::EPSILON));
    assert_eq!(precision([DVec3::new(0.1, 1.0 / 3.0, 1.0)].into_iter()), 0.0);
    assert!((precision([DVec3::new(12.345_678, 0.1, 1.0)].into_iter()) / 2e-6 - 1.0).abs() < 1e-9);
}

#[test]
fn the_distance_from_a_triangle_is_that_of_its_nearest_sample() {
    let corners = [DVec3::new(0.1, 0.2, 0.3), DVec3::new(2.0, 0.1, -0.4), DVec3::new(0.7, 1.9, 0.5)];
    let samples: Vec<DVec3> = (0..=200)
        .flat_map(|i| (0..=200 - i).map(move |j| (f64::from(i) / 200.0, f64::from(j) / 200.0)))
        .map(|(u, v)| corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]))
        .collect();
    for k in 0..300 {
        let t = f64::from(k);
        let p = 2.0 * DVec3::new((t * 0.618).fract(), (t * 0.414).fract(), (t * 0.732).fract() - 0.5);
        let nearest = samples.iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
        let distance = distance_to_triangle(p, corners);
        assert!(distance <= nearest + 1e-12 && distance > nearest - 0.01, "{p}: {distance} and {nearest}");
    }
}
